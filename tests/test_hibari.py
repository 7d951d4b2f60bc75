"""The English voice: its phones, words, pauses and times."""

from __future__ import annotations

import gzip
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from lipwright.errors import LipwrightError
from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.speech.voices import Piece, Utterance, Voice, find_voice, get_back_end, read_script
from lipwright.speech.voices.hibari_times import LAG, MARK, time_line
from lipwright.speech.voices.misaki import LETTERS_OF, PHONE_OF, read_sounds, write_phones
from lipwright.speech.voices.onnx_outputs import input_of, with_output
from lipwright.track import PhoneTrack

PANGRAM = "Maybe Pam bought a big map, but Tim didn't."


@pytest.fixture(scope="module")
def voice() -> Voice:
    return find_voice("hibari")


@pytest.fixture(scope="module")
def said(voice: Voice) -> Utterance:
    return voice.speak((Piece(PANGRAM),))


def track_of(utterance: Utterance) -> PhoneTrack:
    assert utterance.track is not None
    return utterance.track


def phones_of(track: PhoneTrack, word: str) -> tuple[str, ...]:
    found = next(one for one in track.words if one.text == word)
    return track.phones[found.first : found.stop]


def silences(track: PhoneTrack) -> list[float]:
    return [end - start for phone, start, end in track if phone == SILENCE]


def test_phones_are_those_of_the_words(said: Utterance) -> None:
    track = track_of(said)
    assert phones_of(track, "maybe") == ("M", "EY", "B", "IY")
    assert phones_of(track, "pam") == ("P", "AE", "M")
    assert phones_of(track, "map") == ("M", "AE", "P")
    assert [word.text for word in track.words] == [
        "maybe", "pam", "bought", "a", "big", "map", "but", "tim", "didn't",
    ]  # fmt: skip
    assert said.timing == "voice"
    assert said.text == PANGRAM


def test_the_track_covers_the_sound_and_is_silent_at_both_ends(said: Utterance) -> None:
    track = track_of(said)
    assert track.start == 0
    assert track.end == said.audio.duration
    assert (track.phones[0], track.phones[-1]) == (SILENCE, SILENCE)
    samples, rate = said.audio.samples, said.audio.rate
    loud = np.abs(samples).max()
    for start, end in (track.edges[:2], track.edges[-2:]):
        assert np.abs(samples[round(start * rate) : round(end * rate)]).max() < 0.1 * loud


def test_a_comma_with_a_pause_is_silence(said: Utterance) -> None:
    track = track_of(said)
    place = next(word.stop for word in track.words if word.text == "map")
    assert track.phones[place] == SILENCE


def test_lips_are_shut_where_the_sound_is_weak(said: Utterance) -> None:
    track, rate = track_of(said), said.audio.rate
    # Above 500 Hz or so, where vowels are loud and voices through shut lips are not.
    treble = np.diff(said.audio.samples.astype(float))

    def power(index: int) -> float:
        first, stop = (round(edge * rate) for edge in track.edges[index : index + 2])
        return float(np.square(treble[first:stop]).mean())

    beside_vowels = [
        (index, other)
        for index, phone in enumerate(track.phones)
        for other in (index - 1, index + 1)
        if phone in BILABIALS and PHONES[track.phones[other]].is_vowel
    ]
    assert len(beside_vowels) >= 10
    assert all(power(index) < power(vowel) for index, vowel in beside_vowels)


def test_the_same_text_sounds_the_same_every_time(voice: Voice, said: Utterance) -> None:
    again = voice.speak((Piece(PANGRAM),))
    assert np.array_equal(again.audio.samples, said.audio.samples)
    assert np.array_equal(track_of(again).edges, track_of(said).edges)


def test_numbers_are_the_words_that_are_said(voice: Voice) -> None:
    track = track_of(voice.speak((Piece("Dr. Bob paid $42."),)))
    assert [word.text for word in track.words] == [
        "doctor", "bob", "paid", "forty", "two", "dollars",
    ]  # fmt: skip
    assert phones_of(track, "two") == ("T", "UW")


def test_letters_are_spelt(voice: Voice) -> None:
    track = track_of(voice.speak((Piece("Plan A.B. works"),)))
    assert phones_of(track, "a") == ("EY",)
    assert phones_of(track, "b") == ("B", "IY")


def test_threads_may_open_it_at_once() -> None:
    program = (
        "import concurrent.futures as c\n"
        "from lipwright.speech.voices import find_voice, read_script, speak\n"
        "def say(n): return len(speak(find_voice('hibari'), read_script('Hello.')).audio)\n"
        "with c.ThreadPoolExecutor(6) as pool: print(len(set(pool.map(say, range(6)))))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=120
    )
    assert (run.stdout, run.returncode) == ("1\n", 0), run.stderr


def test_words_beside_tags_are_said(voice: Voice) -> None:
    track = track_of(voice.speak((Piece("<i>Now</i> go<br>home."),)))
    assert [word.text for word in track.words] == ["now", "go", "home"]


def test_interjections_are_not_spelt(voice: Voice) -> None:
    track = track_of(voice.speak((Piece("Shh, be quiet."),)))
    assert phones_of(track, "shh")[0] == "SH"
    assert len(phones_of(track, "shh")) <= 2


@pytest.mark.parametrize("pause", [0.02, 0.25, 0.5, 3.0])
def test_breaks_last_exactly(voice: Voice, pause: float) -> None:
    track = track_of(voice.speak((Piece("Hello", pause=pause), Piece("Bob."))))
    assert silences(track)[1] == pytest.approx(pause, abs=1e-9)


def test_breaks_at_the_ends_are_silence(voice: Voice) -> None:
    script = (Piece(pause=1.5), Piece("Hello", pause=2.0))
    track = track_of(voice.speak(script))
    assert silences(track) == pytest.approx([1.5, 2.0], abs=1e-9)


def test_rate_shortens_the_speech(voice: Voice) -> None:
    slow, usual, fast = (
        track_of(voice.speak((Piece("Maybe a big map", rate=rate),))) for rate in (0.5, 1.0, 2.0)
    )

    def speech(track: PhoneTrack) -> float:
        return float(track.edges[-2] - track.edges[1])

    assert speech(slow) / speech(usual) == pytest.approx(2.0, rel=0.2)
    assert speech(fast) / speech(usual) == pytest.approx(0.5, rel=0.2)
    assert slow.phones == usual.phones == fast.phones


def test_extreme_rates_keep_every_phone(voice: Voice) -> None:
    for rate in (0.25, 4.0):
        track = track_of(voice.speak((Piece(PANGRAM, rate=rate),)))
        assert [p for p in track.phones if p in BILABIALS] == list("MBPMBBMPBM")
        assert np.diff(track.edges).min() >= 0.0149


def test_given_phones_are_kept_in_the_track_with_their_word(voice: Voice) -> None:
    script = (Piece("the"), Piece("ny", ("N", "XIY")), Piece(phones=("B", "AA", "M")))
    track = track_of(voice.speak(script))
    assert phones_of(track, "ny") == ("N", "XIY")
    assert [p for p in track.phones if p != SILENCE][-3:] == ["B", "AA", "M"]
    assert [word.text for word in track.words] == ["the", "ny"]


def test_emphasis_is_louder_and_higher_and_moves_nothing(voice: Voice) -> None:
    plain, strong = (
        voice.speak((Piece("a big"), Piece("map", emphasis=level), Piece("here")))
        for level in (None, "strong")
    )
    # The last sound alone ends where the sound does.
    assert np.array_equal(track_of(plain).edges[:-2], track_of(strong).edges[:-2])
    track = track_of(plain)
    word = next(one for one in track.words if one.text == "map")
    first, stop = (round(edge * plain.audio.rate) for edge in track.word_span(word))
    powers = [np.square(one.audio.samples[first:stop]).mean() for one in (plain, strong)]
    assert powers[1] > 1.2 * powers[0]


def test_marks_of_a_piece_alone_belong_to_the_word_before(voice: Voice) -> None:
    script = read_script("<speak>Hello <emphasis>Bob</emphasis>! Good day.</speak>")
    track = track_of(voice.speak(script))
    assert [word.text for word in track.words] == ["hello", "bob", "good", "day"]
    assert len(silences(track)) == 3


def test_letters_of_other_languages_are_refused_by_their_place(voice: Voice) -> None:
    script = read_script("<speak>Hello\n  <emphasis>привет</emphasis></speak>", "letter.ssml")
    with pytest.raises(LipwrightError, match=r"letter\.ssml: line 2, column 13"):
        voice.speak(script, "letter.ssml")


def test_long_sentences_are_said_whole(voice: Voice) -> None:
    text = " ".join(["maybe a map"] * 60)
    track = track_of(voice.speak((Piece(text),)))
    assert len(track.words) == 180
    assert track.phones.count("M") == 120


def test_progress_is_told(voice: Voice) -> None:
    shares: list[float] = []
    voice.speak((Piece("One. Two."),), progress=shares.append)
    assert shares == [0.5, 1.0]


def test_voices_are_listed_and_none_is_fetched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HIBARI_HOME", str(tmp_path))
    back_end = get_back_end("hibari")
    assert [info.name for info in back_end.voices()] == ["hibari:heart"]
    with pytest.raises(LipwrightError, match=r"not on this machine.*hibari --voice emma hello"):
        back_end.open("emma", None)
    with pytest.raises(LipwrightError, match=r"unknown voice 'hibari:bob'.*hibari:heart.*emma"):
        back_end.open("bob", None)
    assert not list(tmp_path.iterdir())


def test_a_voice_that_is_damaged_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HIBARI_HOME", str(tmp_path))
    damaged = tmp_path / "af_kore.int8.onnx"
    damaged.write_bytes(b"nothing")
    back_end = get_back_end("hibari")
    assert [info.name for info in back_end.voices()] == ["hibari:heart", "hibari:kore"]
    with pytest.raises(LipwrightError, match=r"af_kore.int8.onnx: not a voice of hibari"):
        back_end.open("kore", None)


def test_a_fetched_british_voice_speaks_british_english(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from hibari.voices import voice_path

    monkeypatch.setenv("HIBARI_HOME", str(tmp_path))
    # The American model under a British name: what is tested is the text front end.
    (tmp_path / "bf_emma.int8.onnx").write_bytes(Path(voice_path("heart")).read_bytes())
    british = find_voice("hibari:emma", "en-gb")
    assert british.info.language == "en-gb"
    assert phones_of(track_of(british.speak((Piece("a hot car"),))), "car") == ("K", "AA")


# The alphabet


def lexicons() -> Sequence[Path]:
    from hibari.tts import ASSETS

    return sorted(Path(ASSETS).glob("lexicon_*.json.gz"))


def test_every_letter_of_the_lexicons_has_a_phone() -> None:
    letters = set()
    for path in lexicons():
        with gzip.open(path, "rt", encoding="utf-8") as file:
            for entry in json.load(file).values():
                for spelling in entry.values() if isinstance(entry, dict) else [entry]:
                    letters |= set(spelling or "")
    assert len(lexicons()) == 4
    assert letters - set(PHONE_OF) == set("ˈˌː")


def test_tables_name_what_exists() -> None:
    assert set(PHONE_OF.values()) <= set(PHONES) - {SILENCE}
    assert set(LETTERS_OF) == set(PHONES) - {SILENCE}
    for letters in LETTERS_OF.values():
        assert read_sounds(letters)


def test_letters_are_read_with_stress_before_the_vowel() -> None:
    sounds = read_sounds("mˈAbi", word=3, start=10)
    assert [(s.phone, s.first, s.stop, s.stress, s.word) for s in sounds] == [
        ("M", 10, 11, None, 3), ("EY", 11, 13, 1, 3), ("B", 13, 14, None, 3), ("IY", 14, 15, 0, 3),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("letters", "phones"),
    [("fˈɜɹ", "F ER"), ("lˈɛTəɹ", "L EH DX AXR"), ("bˈɑːθ", "B AA TH"), ("ʧˈɪn", "CH IH N")],
)
def test_letters_of_two_and_length_marks_are_one_phone(letters: str, phones: str) -> None:
    assert " ".join(sound.phone for sound in read_sounds(letters)) == phones


def test_written_phones_are_read_again() -> None:
    english = tuple(dict.fromkeys(PHONE_OF.values()))
    letters, sounds = write_phones(english)
    assert tuple(sound.phone for sound in sounds) == english
    assert tuple(sound.phone for sound in read_sounds(letters)) == english


# Times


def test_edges_are_the_frames_less_the_lag() -> None:
    letters, rate, frame = "mˈAbi", 24000, 600
    frames = np.array([10, 4, 2, 6, 4, 8, 6])  # before, m, stress, A, b, i, after
    noise = np.random.default_rng(0).standard_normal(frames.sum() * frame).astype(np.float32)
    noise[: round((10 * 0.025 - LAG) * rate)] = 0
    noise[round((34 * 0.025 - LAG) * rate) :] = 0
    head, speech, tail = time_line(letters, tuple(read_sounds(letters)), frames, noise)
    starts = np.array([phone.start for phone in speech.phones]) / rate
    assert len(head) / rate == pytest.approx(0.250 - LAG, abs=0.006)
    assert starts == pytest.approx([0.0, 0.1 + MARK, 0.3, 0.4], abs=0.006)
    assert len(tail) / rate == pytest.approx(6 * 0.025 + LAG, abs=0.006)
    assert len(head) + len(speech.samples) + len(tail) == len(noise)


# The model's bytes


def field(number: int, content: bytes) -> bytes:
    assert len(content) < 128
    return bytes([number << 3 | 2, len(content)]) + content


def test_an_inner_value_becomes_an_output() -> None:
    onnx = pytest.importorskip("onnx", reason="onnx reads the model a second way")
    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    nodes = [helper.make_node("Neg", ["x"], ["inner"]), helper.make_node("Abs", ["inner"], ["y"])]
    ports = [[helper.make_tensor_value_info(name, kind, [2])] for name in "xy"]
    model = helper.make_model(helper.make_graph(nodes, "g", *ports)).SerializeToString()
    name = input_of(model, "Abs")
    assert name == "inner"
    found = onnx.load_model_from_string(with_output(model, name))
    assert [output.name for output in found.graph.output] == ["y", "inner"]
    assert [node.op_type for node in found.graph.node] == ["Neg", "Abs"]


@pytest.mark.parametrize(
    "content", [b"", b"nothing", b"\x3a\xff", field(7, field(1, b"\x22\x01X"))]
)
def test_bytes_without_the_node_are_refused(content: bytes) -> None:
    with pytest.raises(ValueError, match=r"not one|cut off|not an ONNX"):
        input_of(content, "CumSum")
