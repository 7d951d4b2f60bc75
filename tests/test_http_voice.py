"""The plain-HTTP voice, against a real server on this machine."""

from __future__ import annotations

import base64
import io
import json
import re
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.speech.voices import Piece, find_voice, http_client
from lipwright.speech.voices.http_answer import read_sound, read_times

RATE = 16000
SECONDS = 1.0
Reply = tuple[int, dict[str, str], bytes]


def sound(seconds: float = SECONDS, kind: str = "WAV") -> str:
    noise = np.random.default_rng(1).standard_normal(round(seconds * RATE)) * 0.05
    file = io.BytesIO()
    soundfile.write(file, noise, RATE, format=kind)
    return base64.b64encode(file.getvalue()).decode()


AUDIO = sound()
PHONES = [
    {"phone": "sil", "start": 0.0, "end": 0.1},
    {"phone": "HH", "start": 0.1, "end": 0.2},
    {"phone": "AH0", "start": 0.2, "end": 0.3},
    {"phone": "L", "start": 0.3, "end": 0.4},
    {"phone": "OW1", "start": 0.4, "end": 0.7},
]
WORDS = [{"text": "Hello.", "start": 0.1, "end": 0.7}]


@dataclass
class Server:
    """What it will answer, and what it was asked."""

    reply: Callable[[dict[str, Any]], Reply]
    port: int = 0
    asked: list[dict[str, Any]] = field(default_factory=list)
    headers: list[dict[str, str]] = field(default_factory=list)
    paths: list[str] = field(default_factory=list)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/speak"


def answers(body: object, status: int = 200, **headers: str) -> Callable[[object], Reply]:
    content = body if isinstance(body, bytes) else json.dumps(body).encode()
    return lambda asked: (status, headers, content)


@contextmanager
def serving(reply: Callable[[dict[str, Any]], Reply]) -> Iterator[Server]:
    server = Server(reply)

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            asked = json.loads(body)
            server.asked.append(asked)
            server.headers.append(dict(self.headers))
            server.paths.append(self.path)
            status, headers, content = server.reply(asked)
            self.send_response(status)
            length = headers.pop("length", str(len(content)))
            for name, value in headers.items():
                self.send_header(name, value)
            self.send_header("Content-Length", length)
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *args: object) -> None:
            pass

    class Quiet(ThreadingHTTPServer):
        def handle_error(self, *args: object) -> None:
            pass  # the client has gone

    with Quiet(("127.0.0.1", 0), Handler) as http:
        server.port = http.server_address[1]
        thread = threading.Thread(target=http.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield server
        finally:
            http.shutdown()
            thread.join()


def spoken(server: Server, text: str = "Hello.", language: str | None = None) -> Any:
    return find_voice(server.url, language).speak((Piece(text),))


def refusal(server: Server) -> str:
    with pytest.raises(LipwrightError) as caught:
        spoken(server)
    message = str(caught.value)
    assert "\n" not in message
    assert "127.0.0.1" in message
    return message


def test_phones_of_the_answer_are_the_track() -> None:
    with serving(answers({"version": 1, "audio": AUDIO, "phones": PHONES, "words": WORDS})) as s:
        said = spoken(s)
    assert said.timing == "voice"
    assert said.track.phones == ("sil", "HH", "AH", "L", "OW", "sil")
    assert said.track.edges == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.7, 1.0])
    assert said.track.stress == (None, None, 0, None, 1, None)
    assert [(w.text, w.first, w.stop) for w in said.track.words] == [("Hello.", 1, 5)]
    assert said.audio.rate == RATE
    assert said.audio.duration == pytest.approx(SECONDS)


@pytest.mark.parametrize("kind", ["WAV", "FLAC", "OGG"])
def test_sound_may_be_of_any_common_format(kind: str) -> None:
    with serving(answers({"version": 1, "audio": sound(kind=kind), "phones": PHONES})) as s:
        assert spoken(s).audio.duration == pytest.approx(SECONDS, abs=0.02)


def test_ipa_is_read_with_its_stress_and_sounds_of_other_languages() -> None:
    rows = [
        {"phone": phone, "alphabet": "ipa", "start": n / 10, "end": (n + 1) / 10}
        for n, phone in enumerate(["h", "ə", "l", "ˈoʊ", "ɧ", "y"])
    ]
    with serving(answers({"version": 1, "audio": AUDIO, "phones": rows})) as s:
        said = spoken(s)
    assert said.track.phones == ("HH", "AX", "L", "OW", "XH", "XIY", "sil")
    assert said.track.stress[3] == 1


def test_one_alphabet_may_stand_for_all_phones() -> None:
    rows = [{"phone": "@U", "start": 0.2, "end": 0.5}]
    body = {"version": 1, "audio": AUDIO, "phones": rows, "alphabet": "xsampa"}
    with serving(answers(body)) as s:
        assert spoken(s).track.phones == ("sil", "OW", "sil")


def test_words_alone_get_their_phones_within_their_times() -> None:
    words = [
        {"text": "Maybe,", "start": 0.1, "end": 0.4}, {"text": ",", "start": 0.4, "end": 0.45},
        {"text": "Pam", "start": 0.5, "end": 0.8},
    ]  # fmt: skip
    with serving(answers({"version": 1, "audio": AUDIO, "words": words})) as s:
        track = spoken(s, "Maybe, Pam").track  # noise, which no aligner takes for these words
    assert track.phones == ("sil", "M", "EY", "B", "IY", "sil", "P", "AE", "M", "sil")
    assert [word.text for word in track.words] == ["Maybe,", "Pam"]
    assert track.word_span(track.words[0]) == pytest.approx((0.1, 0.4))
    assert track.word_span(track.words[1]) == pytest.approx((0.5, 0.8))


def test_an_answer_without_times_has_no_track() -> None:
    with serving(answers({"version": 1, "audio": AUDIO})) as s:
        assert spoken(s).track is None


def test_a_sound_that_cannot_be_aligned_names_the_voice() -> None:
    from lipwright.speech.voices import speak

    with serving(answers({"version": 1, "audio": AUDIO})) as s:
        name = re.escape(s.url)
        with pytest.raises(LipwrightError, match=f"{name} tells no times, and .* aligned"):
            speak(find_voice(s.url), (Piece("Hello there, and many more words than that."),))


def test_the_request_says_text_pieces_voice_language_and_rate() -> None:
    script = (
        Piece("Hello there,", pause=0.5, rate=1.2), Piece("tomato", ("T", "AX"), rate=1.2),
        Piece("now", emphasis="strong", rate=1.2),
    )  # fmt: skip
    with serving(answers({"version": 1, "audio": AUDIO, "phones": PHONES})) as s:
        find_voice(s.url + "?style=calm#Anna", "en").speak(script)
    asked = s.asked[0]
    assert s.paths == ["/speak?style=calm"]
    assert asked["version"] == 1
    assert asked["text"] == "Hello there, tomato now"
    assert (asked["voice"], asked["language"], asked["rate"]) == ("Anna", "en", 1.2)
    assert asked["pieces"][0] == {
        "text": "Hello there,", "phones": [], "pause": 0.5, "emphasis": None, "rate": 1.2,
    }  # fmt: skip
    assert asked["pieces"][1]["phones"] == ["T", "AX"]
    assert s.headers[0]["Content-Type"] == "application/json; charset=utf-8"
    assert "Authorization" not in s.headers[0]


def test_the_token_is_sent_and_never_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(http_client.TOKEN, "s3cret")
    with serving(answers(b"Bearer s3cret is no good", 401)) as s:
        message = refusal(s)
    assert s.headers[0]["Authorization"] == "Bearer s3cret"
    assert "s3cret" not in message
    assert "401" in message
    assert http_client.TOKEN in message


@pytest.mark.parametrize("token", ["bad\nvalue", "schlüssel"])
def test_a_token_that_no_header_takes_is_refused(
    token: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(http_client.TOKEN, token)
    with pytest.raises(LipwrightError, match=http_client.TOKEN) as caught:
        find_voice("http://127.0.0.1:9/").speak((Piece("Hi"),))
    assert token not in str(caught.value)


def test_the_token_does_not_cross_the_network_in_the_clear(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(http_client.TOKEN, "s3cret")
    with pytest.raises(LipwrightError, match="in the clear; use https"):
        find_voice("http://voices.example/").speak((Piece("Hi"),))


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (b"<html>", "does not answer in JSON"),
        (b"\xff\xfe", "does not answer in JSON"),
        (b'{"version": 1, "x": NaN}', "NaN is no number of JSON"),
        (b"[" * 100_000, "does not answer in JSON"),
        ([], "the answer is a list, not an object"),
        ({}, "'version' is missing, not 1"),
        ({"version": 2}, "'version' is 2, not 1"),
        ({"version": True}, "'version' is True, not 1"),
        ({"version": 1}, "'audio' is missing"),
        ({"version": 1, "audio": 7}, "'audio' is 7, not a string of base64"),
        ({"version": 1, "audio": "%%%"}, "'audio' is not base64"),
        ({"version": 1, "audio": ""}, "'audio' is empty"),
        ({"version": 1, "audio": "aGVsbG8gdGhlcmU="}, "'audio'"),
        ({"phones": {}}, "'phones' is an object, not a list"),
        ({"phones": [3]}, r"phones\[0\] is 3, not an object"),
        ({"phones": [{"start": 0, "end": 1}]}, r"phones\[0\].phone is missing"),
        ({"phones": [{"phone": "AA", "start": "0", "end": 1}]}, r"phones\[0\].start is '0'"),
        ({"phones": [{"phone": "AA", "start": -0.1, "end": 1}]}, r"phones\[0\] lasts from -0.1"),
        ({"phones": [{"phone": "AA", "start": 0.5, "end": 0.5}]}, r"phones\[0\] lasts from 0.5"),
        ({"phones": [{"phone": "AA", "start": 0.5, "end": 9}]}, "end of the sound"),
        ({"phones": [{"phone": "AA", "start": 0.5, "end": 10**400}]}, "not a number of seconds"),
        ({"phones": [{"phone": "AA", "start": 0.5, "end": 0.7},
                     {"phone": "AA", "start": 0.2, "end": 0.9}]}, r"phones\[1\] starts at 0.2"),
        ({"phones": [{"phone": "Å", "start": 0.5, "end": 0.7}]}, r"phones\[0\]: unknown arpabet"),
        ({"phones": [{"phone": "a", "start": 0.5, "end": 0.7, "alphabet": "x"}]},
         "unknown alphabet 'x'; use one of: arpabet, ipa, xsampa"),
        ({"phones": [{"phone": "sil", "start": 0.5, "end": 0.7}]}, "no phone of the answer"),
        ({"words": [{"text": "a\x07", "start": 0, "end": 1}]}, r"words\[0\].text"),
        ({"words": [{"text": "привет", "start": 0, "end": 1}]}, r"words\[0\]"),
    ],
)  # fmt: skip
def test_a_wrong_answer_is_refused_by_its_place(body: Any, told: str) -> None:
    if isinstance(body, dict) and {"phones", "words"} & body.keys():
        body = {"version": 1, "audio": AUDIO, **body}
    import re

    with serving(answers(body)) as s:
        assert re.search(told, refusal(s))


@pytest.mark.parametrize(
    ("status", "told"), [(404, "404.*correct the address"), (500, "500: broken"), (401, "401")]
)
def test_a_status_of_error_is_told(status: int, told: str) -> None:
    import re

    with serving(answers(b"broken\nhere", status)) as s:
        assert re.search(told, refusal(s))


def test_a_redirect_on_the_same_server_keeps_the_request() -> None:
    def reply(asked: dict[str, Any]) -> Reply:
        if len(s.asked) == 1:
            return 302, {"Location": "/elsewhere"}, b""
        return 200, {}, json.dumps({"version": 1, "audio": AUDIO, "phones": PHONES}).encode()

    with serving(reply) as s:
        spoken(s)
    assert s.paths == ["/speak", "/elsewhere"]
    assert s.asked[0] == s.asked[1]


@pytest.mark.parametrize("target", ["http://127.0.0.2:1/x", "file:///etc/passwd", "https://x.y/"])
def test_a_redirect_to_another_server_is_refused(target: str) -> None:
    with serving(answers(b"", 307, Location=target)) as s:
        message = refusal(s)
    assert "not allowed" in message or "307" in message


def test_redirects_in_a_circle_end() -> None:
    with serving(answers(b"", 302, Location="/speak")) as s:
        assert "302" in refusal(s)


def test_an_answer_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_client, "MOST_BYTES", 1 << 20)
    with serving(answers(b" " * (2 << 20))) as s:
        assert "more than 1 MB" in refusal(s)


def test_an_answer_that_is_cut_off_is_refused() -> None:
    with serving(answers(b"{}", length="100")) as s:
        message = refusal(s)
    assert "cut off" in message


def test_a_slow_server_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_client, "WAIT", 0.2)
    release = threading.Event()

    def reply(asked: dict[str, Any]) -> Reply:
        del asked
        release.wait(5)
        return 200, {}, b"{}"

    with serving(reply) as s:
        try:
            assert "did not answer within 0.2 s" in refusal(s)
        finally:
            release.set()


def test_no_server_is_told() -> None:
    with serving(answers({})) as s:
        pass
    assert "cannot be reached" in refusal(s)


@pytest.mark.parametrize(
    "address",
    [
        "http://",
        "http:///x",
        "http://[::1",
        "http://a:b/c",
        "http://a b/",
        "http://127.0.0.1:99999/",
    ],
)
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(LipwrightError, match="address"):
        find_voice(address)


def test_files_are_no_voice_servers() -> None:
    with pytest.raises(LipwrightError, match="not the address of a server"):
        http_client.read_address("file:///etc/passwd")


def test_a_password_in_the_address_is_refused_and_not_shown() -> None:
    with pytest.raises(LipwrightError, match="LIPWRIGHT_VOICE_TOKEN") as caught:
        find_voice("https://me:hunter2@voices.example/")
    assert "hunter2" not in str(caught.value)


@pytest.mark.parametrize(
    "address",
    [
        "http://me:hunter2@voices.example:bad/",
        "http://me:hunter2/x@voices.example/",
        "HTTPS://me:hunter2@voices.example/",
        "http:///say?key=hunter2",
        "http://[::1/?key=hunter2",
    ],
)
def test_secrets_of_what_is_no_address_are_not_shown(address: str) -> None:
    with pytest.raises(LipwrightError, match="address") as caught:
        find_voice(address)
    assert "hunter2" not in str(caught.value)


def test_the_name_of_a_voice_hides_the_query() -> None:
    assert find_voice("https://v.example/say?key=1#Anna").info.name == "https://v.example/say#Anna"


def test_a_file_that_is_hours_of_silence_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from lipwright.speech.voices import http_answer

    monkeypatch.setattr(http_answer, "MOST_SECONDS", 0.5)
    with pytest.raises(LipwrightError, match=r"lasts more than 0.5 s"):
        read_sound({"version": 1, "audio": AUDIO}, "server")


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(
        st.sampled_from(["text", "phone", "start", "end", "alphabet", "x"]), inner, max_size=5
    ),
    max_leaves=8,
)  # fmt: skip
ROW = st.fixed_dictionaries(
    {},
    optional={
        "text": st.text(max_size=5), "phone": st.sampled_from(["AA", "sil", "p", "ˈoʊ", "", "?"]),
        "start": st.floats(-1, 2), "end": st.floats(-1, 2),
        "alphabet": st.sampled_from(["ipa", "arpabet", "xsampa", None, 3]),
    },
)  # fmt: skip


@given(
    st.fixed_dictionaries(
        {"version": st.just(1), "audio": st.just(AUDIO)},
        optional={"words": JSON | st.lists(ROW, max_size=3),
                  "phones": JSON | st.lists(ROW, max_size=3), "alphabet": JSON},
    )
)  # fmt: skip
@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_any_answer_is_a_track_or_one_clear_line(answer: dict[str, Any]) -> None:
    refused = ""
    track = None
    try:
        track = read_times(answer, SECONDS, "en", "server")
    except LipwrightError as error:
        refused = str(error)
    assert "\n" not in refused
    assert track is None or track.edges[-1] == SECONDS


def test_the_example_server_is_a_voice() -> None:
    program = Path(__file__).parents[1] / "examples" / "http_voice_server.py"
    command = [sys.executable, str(program), "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            voice = find_voice(server.stdout.readline().strip(), "en")
            said = voice.speak((Piece("Maybe", pause=0.5), Piece("Pam", ("P", "AE", "M"))))
            with pytest.raises(LipwrightError, match=r"422.*the request: line 1, column 1"):
                voice.speak((Piece("привет"),))
        finally:
            server.terminate()
    assert said.timing == "voice"
    assert said.track.phones == ("sil", "M", "EY", "B", "IY", "sil", "P", "AE", "M", "sil")
    assert [word.text for word in said.track.words] == ["maybe", "Pam"]
    assert said.track.edges[6] - said.track.edges[5] == pytest.approx(0.5, abs=1e-4)
