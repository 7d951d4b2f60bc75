"""`lipwright say`: text to sound and motion, with the voices themselves."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from lipwright.audio import Audio, read_audio, write_wav, written_by
from lipwright.cli.inputs import read_text
from lipwright.cli.saying import _stem
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.espeak import is_available
from lipwright.export import read_clip
from lipwright.face.head import Head
from lipwright.formats import read_track
from lipwright.phones import BILABIALS
from lipwright.pipeline import AnimateOptions, SayOptions, say
from lipwright.speech.voices import BACK_ENDS, find_voice, get_back_end
from test_cli import assert_refused, lipwright

ROOT = Path(__file__).resolve().parents[1]
SWEDISH = (ROOT / "examples" / "swedish.txt").read_text("utf-8").split("\n")
needs_espeak = pytest.mark.skipif(
    not is_available(), reason="espeak-ng is missing: pip install 'lipwright[espeak]'"
)


def shut(head: Head, text: str, voice: SayOptions) -> list[bool]:
    """Of each bilabial of a text, whether the lips of the head meet at it."""
    result = say(text, voice=voice)
    gaps = head.aperture_curve(result.clip.select(CANONICAL).values)
    closed = gaps < 0.05 * np.percentile(gaps, 95)
    times = result.clip.times
    return [
        bool(closed[(times >= start - 0.02) & (times <= end + 0.02)].any())
        for phone, start, end in result.track
        if phone in BILABIALS
    ]


ENGLISH = "Please bring my blue map, Bob, and put the lamp back by the palm."


def test_the_lips_meet_at_every_bilabial_of_english(head: Head) -> None:
    meets = shut(head, ENGLISH, SayOptions())
    assert len(meets) == 15
    assert all(meets)


@needs_espeak
@pytest.mark.parametrize("line", [line for line in SWEDISH if line], ids=lambda line: line[:12])
def test_the_lips_meet_at_every_bilabial_of_the_swedish_examples(head: Head, line: str) -> None:
    meets = shut(head, line, SayOptions(language="sv"))
    assert len(meets) == sum(line.lower().replace("mm", "m").count(letter) for letter in "bmp")
    assert all(meets)


@needs_espeak
def test_the_lips_meet_at_every_bilabial_of_mandarin(head: Head) -> None:
    meets = shut(head, "妈妈不怕跑步,爸爸买面包。", SayOptions(language="cmn"))
    assert len(meets) == 11
    assert all(meets)


@needs_espeak
def test_front_vowels_of_swedish_are_as_round_as_its_back_vowels() -> None:
    def rounding(text: str, phones: tuple[str, ...]) -> float:
        result = say(text, voice=SayOptions(language="sv"))
        clip = result.clip
        round_ = clip.curve("mouthPucker") + clip.curve("mouthFunnel")
        spans = [(s, e) for phone, s, e in result.track if phone in phones]
        assert spans
        return min(float(round_[(clip.times >= s) & (clip.times <= e)].max()) for s, e in spans)

    assert rounding("Ny film i byn.", ("XIY",)) > 0.9 * rounding("En bok och en sko.", ("UW",))
    assert rounding("Söta höns.", ("XEY",)) > 0.9 * rounding("En bok och en sko.", ("UW",))


def test_the_command_writes_curves_phones_and_the_sound_beside_them(tmp_path: Path) -> None:
    run = lipwright(
        "say", "Hello there.", "-o", "hello.livelink.csv", "-o", "hello.TextGrid", cwd=tmp_path
    )
    assert run.returncode == 0, run.stderr
    sound = read_audio(tmp_path / "hello.wav")
    clip = read_clip(tmp_path / "hello.livelink.csv")
    track = read_track(tmp_path / "hello.TextGrid")
    assert [word.text for word in track.words] == ["hello", "there"]
    assert track.end == pytest.approx(sound.duration, abs=1e-3)
    assert len(clip.values) / clip.fps == pytest.approx(sound.duration, abs=0.05)


def test_a_head_that_speaks_has_its_sound_beside_it(head: Head, tmp_path: Path) -> None:
    del head
    for _ in range(2):
        run = lipwright("say", "Hello.", "-o", "hello.glb", "-o", "hello.csv", cwd=tmp_path)
        assert run.returncode == 0, run.stderr
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["hello.csv", "hello.glb", "hello.wav"]


def test_saying_the_same_twice_gives_the_same_files(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        run = lipwright("say", "Hello there.", "-o", "hello.csv", cwd=tmp_path / folder)
        assert run.returncode == 0, run.stderr
    for name in ("hello.csv", "hello.wav"):
        one, two = ((tmp_path / folder / name).read_bytes() for folder in ("one", "two"))
        assert one == two


def test_a_recording_of_the_users_is_not_replaced(tmp_path: Path) -> None:
    write_wav(tmp_path / "hello.wav", Audio(np.zeros(800, np.float32), 8000))
    before = (tmp_path / "hello.wav").read_bytes()
    run = lipwright("say", "Hello.", "-o", "hello.csv", cwd=tmp_path)
    assert_refused(run, "hello.wav", "was not made by Lipwright", "--sound")
    assert (tmp_path / "hello.wav").read_bytes() == before
    assert not (tmp_path / "hello.csv").exists()
    named = lipwright("say", "Hello.", "-o", "hello.csv", "--sound", "voice.flac", cwd=tmp_path)
    assert named.returncode == 0, named.stderr
    assert written_by(tmp_path / "voice.flac") == "Lipwright"


def test_its_own_sound_is_replaced(tmp_path: Path) -> None:
    for text in ("Hello.", "Hello, and good morning."):
        run = lipwright("say", text, "-o", "hello.csv", cwd=tmp_path)
        assert run.returncode == 0, run.stderr
    assert read_audio(tmp_path / "hello.wav").duration > 1.5


def test_names_that_no_file_can_have_are_refused(tmp_path: Path) -> None:
    assert_refused(lipwright("say", "Hello.", "-o", "a" * 300 + ".csv", cwd=tmp_path), "too long")
    run = lipwright("say", "Hello.", "-o", os.fsdecode(b"h\xe5ll.glb"), cwd=tmp_path)
    assert_refused(run, "not UTF-8")
    assert list(tmp_path.iterdir()) == []


def test_a_rate_of_two_takes_half_as_long() -> None:
    usual = say(ENGLISH).track.end
    assert say(ENGLISH, voice=SayOptions(rate=2.0)).track.end == pytest.approx(usual / 2, rel=0.1)


def test_the_users_dictionary_goes_before_the_voice(tmp_path: Path) -> None:
    own = tmp_path / "own.dict"
    own.write_text("data  D AA T AH\n", "utf-8")
    track = say("The data, please.", voice=SayOptions(dictionary=own)).track
    word = track.words[1]
    assert track.phones[word.first : word.stop] == ("D", "AA", "T", "AH")


def test_names_lose_the_longest_suffix() -> None:
    assert _stem(Path("a.b.livelink.csv")) == "a.b"
    assert _stem(Path("hello.csv")) == "hello"


@pytest.mark.parametrize(
    ("arguments", "needles"),
    [
        (("",), ("the text: has no words",)),
        (("   ",), ("the text: has no words",)),
        (("🙂🙂",), ("the text: has nothing but emoji",)),
        (("<speak></speak>",), ("the text: ", "has no words")),
        (("<speak>Hello",), ("line 1",)),
        (("Hello \x07 there",), ("control character",)),
        (("Привет, как дела?",), ("ru",)),
        (("Hello.", "--voice", "nobody"), ("unknown voice 'nobody'", "hibari:heart", "espeak")),
        (("Hello.", "--voice", "hibari:nobody"), ("nobody", "heart")),
        (("Hello.", "--voice", "espeak:tlh"), ("tlh",)),
        (("Hello.", "--voice", "piper:none.onnx"), ("none.onnx", "no such file")),
        (("Hello.", "--voice", "http://127.0.0.1:9/none"), ("127.0.0.1:9",)),
        (("Hello.", "--voice", "hibari", "-l", "sv"), ("hibari speaks English alone, not 'sv'",)),
        (("Hello.", "--language", "xx"), ("unknown language 'xx'",)),
        (("Hello.", "--rate", "0"), ("rate 0", "0.25")),
        (("Hello.", "--rate", "nan"), ("rate nan",)),
        (("Hello.", "--sound", "a.mp3"), ("a.mp3", ".wav or .flac")),
        (("none.txt",), ("none.txt", "no such file")),
        (("a " * 50_000,), ("100000 characters", "split")),
    ],
)  # fmt: skip
def test_what_cannot_be_said_is_refused(
    arguments: tuple[str, ...], needles: tuple[str, ...], tmp_path: Path
) -> None:
    run = lipwright("say", *arguments, "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, *needles)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", BACK_ENDS)
def test_every_back_end_answers_what_it_has(name: str) -> None:
    back_end = get_back_end(name)
    assert back_end.name == name
    assert back_end.remedy().startswith("pip install")
    if back_end.is_available():
        for info in back_end.voices():
            assert info.name.startswith(name)
            assert info.about


def test_a_missing_back_end_names_the_command_that_installs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from lipwright.speech.voices import espeak

    monkeypatch.setattr(type(espeak.back_end()), "is_available", lambda self: False)
    with pytest.raises(LipwrightError, match=r"espeak is not installed; run: pip install"):
        find_voice(None, "sv")


@pytest.mark.parametrize("name", ["hibari", "Hibari:heart", "HIBARI"])
def test_capitals_of_a_voices_kind_do_not_matter(name: str) -> None:
    assert find_voice(name).info.name == "hibari:heart"


@pytest.mark.parametrize("text", ["and/or", "1/0", "https://example.org/a?b", "...yes", "a/b.c"])
def test_words_with_slashes_are_no_files(text: str) -> None:
    assert read_text(text) == (text, "--text")


@pytest.mark.parametrize("path", ["none/hello.txt", "./hello", "../none/hello", "/none/x", "~/x"])
def test_paths_of_no_file_are_refused(path: str) -> None:
    with pytest.raises(LipwrightError, match="no such file"):
        read_text(path)


@needs_espeak
def test_the_list_of_voices_can_be_narrowed() -> None:
    run = lipwright("voices", "--language", "sv")
    assert run.returncode == 0
    rows = run.stdout.decode().splitlines()
    assert any(row.startswith("espeak:sv") for row in rows)
    assert not any(row.startswith("hibari") for row in rows)


def test_a_rig_and_a_bigram_set_follow_a_voice_too() -> None:
    options = AnimateOptions(bigrams="english", rig="facefx")
    assert "open" in say("Hello there.", options=options).clip.names
