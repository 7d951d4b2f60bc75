"""The five panels of a line, and the times that a text without a recording gets."""

from __future__ import annotations

import zlib
from pathlib import Path

import numpy as np
import pytest

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.runtime import stitch
from lipwright.bigrams.values import Bigram
from lipwright.cli import run
from lipwright.errors import LipwrightError
from lipwright.formats import write_track
from lipwright.language.pace import (
    COMMA,
    DURATIONS,
    EDGE_SILENCE,
    LAST_SYLLABLE,
    MAX_WORDS,
    STOP,
    kind_of,
    spoken_track,
)
from lipwright.phones import PHONES, SILENCE
from lipwright.studio.line import FPS, final_curves
from lipwright.studio.panels import run_steps, write_panels
from studio_server import write_set


def png_size(path: Path) -> tuple[int, int]:
    """Width and height; the picture is whole."""
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    place = 8
    while place < len(data):
        length = int.from_bytes(data[place : place + 4])
        chunk = data[place + 4 : place + 8 + length]
        assert zlib.crc32(chunk) == int.from_bytes(data[place + 8 + length :][:4])
        place += 12 + length
    return int.from_bytes(data[16:20]), int.from_bytes(data[20:24])


# ---- times of a text


def test_every_phone_has_a_kind_with_a_duration() -> None:
    said = [phone for phone in PHONES.values() if not phone.is_silence]
    assert {kind_of(phone) for phone in said} == set(DURATIONS)


def test_phones_last_as_their_kind_and_marks_make_pauses() -> None:
    track = spoken_track("Oh no, a cat")
    stretch = LAST_SYLLABLE
    assert track.phones == ("sil", "OW", "N", "OW", "sil", "AX", "K", "AE", "T", "sil") or (
        track.phones == ("sil", "OW", "N", "OW", "sil", "AH", "K", "AE", "T", "sil")
    )
    vowel = DURATIONS[kind_of(PHONES[track.phones[5]])]
    want = [
        EDGE_SILENCE, 0.16, 0.065, 0.16 * stretch, COMMA, vowel, 0.07, 0.11 * stretch,
        0.07 * stretch, EDGE_SILENCE,
    ]  # fmt: skip
    np.testing.assert_allclose(track.durations, want)
    assert [word.text for word in track.words] == ["oh", "no", "a", "cat"]


@pytest.mark.parametrize(
    ("text", "pauses"),
    [("Go. Stay.", [STOP]), ("Dr. Smith", []), ("go; stay!", [COMMA]), ("10:30, then", [COMMA]),
     ('"Go," he said', [COMMA]), ("Go... stay", [STOP]), ("go stay", [])],
)  # fmt: skip
def test_the_pauses_are_those_that_marks_ask_for(text: str, pauses: list[float]) -> None:
    track = spoken_track(text)
    inside = [end - start for phone, start, end in list(track)[1:-1] if phone == SILENCE]
    np.testing.assert_allclose(inside, pauses)


def test_too_many_words_are_refused() -> None:
    with pytest.raises(LipwrightError, match=f"the line: {MAX_WORDS + 1} words"):
        spoken_track("go " * (MAX_WORDS + 1), "en", "the line")


# ---- the panels


def test_the_last_panel_is_what_the_editor_and_the_engine_show(tmp_path: Path) -> None:
    bigrams = load_bigrams(write_set(tmp_path / "small.json"))
    track = spoken_track("Fat cat")
    steps = run_steps(bigrams, track, FPS)
    assert len(steps.clips) == 4
    np.testing.assert_array_equal(steps.clips[0].values, stitch(bigrams, track, FPS).values)
    np.testing.assert_array_equal(steps.clips[-1].values, final_curves(bigrams, track).values)


def test_the_first_panel_is_under_the_second(tmp_path: Path) -> None:
    bigrams = load_bigrams(write_set(tmp_path / "small.json"))
    steps = run_steps(bigrams, spoken_track("Fat cat"), 200.0)
    assert any(clip.values.any() for _, clip in steps.pairs)
    for span, clip in steps.pairs:
        inside = clip.times <= span.end - span.start
        stitched = steps.clips[0].at(span.start + clip.times[inside])
        assert (stitched >= clip.values[inside] - 0.08).all()  # half a frame of a steep curve


def test_a_picture_is_written_of_the_poses_that_move_most(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small, out = write_set(tmp_path / "small.json"), tmp_path / "fat.png"
    assert run(["bigrams", "plot", "Fat cat.", "--bigrams", str(small), "-o", str(out)]) == 0
    assert f"{out}: 8 phones, 1.1 s, " in capsys.readouterr().err
    width, height = png_size(out)
    assert width > 900
    assert height > 900
    drawn = write_panels(out, load_bigrams(small), spoken_track("Fat cat"))
    assert set(drawn) == {"open", "FV"}


def test_a_longer_line_has_a_wider_picture(tmp_path: Path) -> None:
    bigrams = load_bigrams(write_set(tmp_path / "small.json"))
    widths = []
    for name, text in (("a", "Fat cat"), ("b", "Fat cat, fat cat, fat cat, fat cat, fat cat")):
        write_panels(tmp_path / f"{name}.png", bigrams, spoken_track(text), ["open"])
        widths.append(png_size(tmp_path / f"{name}.png")[0])
    assert widths[1] > 1.5 * widths[0]


def test_a_phone_track_takes_the_place_of_a_text(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small, track = write_set(tmp_path / "small.json"), tmp_path / "a.TextGrid"
    write_track(track, spoken_track("Fat"))
    out = tmp_path / "a.png"
    command = ["bigrams", "plot", "--phones", str(track), "--bigrams", str(small), "-o", str(out)]
    assert run([*command, "--pose", "FV"]) == 0
    assert capsys.readouterr().err == f"{out}: 5 phones, 0.9 s, FV\n"


def test_a_set_without_curves_is_drawn_at_rest(tmp_path: Path) -> None:
    bigrams = load_bigrams(write_set(tmp_path / "small.json", bigrams={}))
    assert write_panels(tmp_path / "a.png", bigrams, spoken_track("Fat")) == ("open",)


def test_curves_of_one_point_and_beyond_one_are_drawn(tmp_path: Path) -> None:
    pairs = {("f", "ah"): Bigram("f", "ah", {"open": ((0.5, 1.6),), "W": ((0.0, -0.3),)})}
    bigrams = load_bigrams(write_set(tmp_path / "small.json", bigrams=pairs))
    assert "open" in write_panels(tmp_path / "a.png", bigrams, spoken_track("Fat"))


@pytest.mark.parametrize(
    ("arguments", "why"),
    [(["Fat", "--pose", "frown"], "small has no pose 'frown'; it has: open, FV, W"),
     (["Fat", "-o", "a.pdf"], "a.pdf: a picture is written as .png"),
     ([], "give either a text or its phones"),
     (["Fat", "--phones", "a.TextGrid"], "give either a text or its phones"),
     (["fat cat. " * 60], "draw at most 20 s at a time"),
     (["Fat", "--bigrams", "none"], "no set 'none'"),
     (["?"], "the text")],
)  # fmt: skip
def test_what_cannot_be_drawn_is_said_in_a_line(
    arguments: list[str], why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    write_set(tmp_path / "small.json")
    assert run(["bigrams", "plot", "--bigrams", "small.json", *arguments]) == 2
    error = capsys.readouterr().err
    assert why in error
    assert error.count("\n") == 1
    assert not list(tmp_path.glob("*.p*"))
