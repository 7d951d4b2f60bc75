"""What there is to capture: matched by stem, and clear about what is missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from lipwright.capture.sources import find_sources
from lipwright.controls import ARKIT
from lipwright.errors import LipwrightError


def touch(folder: Path, *names: str) -> Path:
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).write_text(f"words of {Path(name).stem}")
    return folder


def test_files_of_folders_match_by_stem_whatever_their_suffixes_and_capitals(
    tmp_path: Path,
) -> None:
    videos = touch(tmp_path / "v", "b.MOV", "a.mp4", "notes.pdf", ".hidden.mp4")
    sounds = touch(tmp_path / "s", "a.flac", "B.wav", "a.mp3")
    words = touch(tmp_path / "w", "a.txt", "b.txt", "c.txt")
    a, b = find_sources([videos], sounds, words)
    assert (a.name, a.face, a.audio, a.text) == (
        "a", videos / "a.mp4", sounds / "a.flac", "words of a",
    )  # fmt: skip
    assert (b.face, b.audio, b.text_source) == (
        videos / "b.MOV", sounds / "B.wav", str(words / "b.txt"),
    )  # fmt: skip
    assert a.problem is None
    assert b.is_video


def test_a_recording_without_words_sound_or_file_has_a_problem_and_the_others_have_none(
    tmp_path: Path,
) -> None:
    videos = touch(tmp_path / "v", "a.mp4", "b.mp4", "c.mp4")
    sounds = touch(tmp_path / "s", "a.wav", "c.wav")
    words = touch(tmp_path / "w", "a.txt", "b.txt")
    found = find_sources([videos, tmp_path / "gone.mp4"], sounds, words)
    problems = {source.name: source.problem for source in found}
    assert problems["a"] is None
    assert problems["b"] == f"{videos / 'b.mp4'}: {sounds} has no sound named b; add it"
    assert problems["c"] == f"{videos / 'c.mp4'}: {words} has no c.txt; add it"
    assert problems["gone"] == f"{tmp_path / 'gone.mp4'}: no such file; check the path"


def test_a_table_of_transcripts_has_a_line_a_recording_with_a_tab_or_bars(tmp_path: Path) -> None:
    videos = touch(tmp_path / "v", "a.mp4", "b.mp4", "c.mp4", "d.mp4")
    table = tmp_path / "lines.txt"
    table.write_text("a\tone two\nb.mp4\tthree\nc|Dr. Four|doctor four\n")
    a, b, c, d = find_sources([videos], None, table)
    assert [source.text for source in (a, b, c)] == ["one two", "three", "doctor four"]
    assert b.text_source == f"{table}: line 2"
    assert d.problem is not None
    assert f"{table} has no line for 'd'" in d.problem


def test_one_file_of_words_serves_one_recording_and_no_more(tmp_path: Path) -> None:
    videos = touch(tmp_path / "v", "a.mp4", "b.mp4")
    words = tmp_path / "w.txt"
    words.write_text("hello there")
    [source] = find_sources([videos / "a.mp4"], None, words)
    assert source.text == "hello there"
    with pytest.raises(LipwrightError, match="no line starts with a recording's name and a tab"):
        find_sources([videos], None, words)
    sound = videos / "a.mp4"
    with pytest.raises(LipwrightError, match="one file cannot serve 2 recordings; --audio takes"):
        find_sources([videos], sound, words)


def test_phone_tracks_need_no_words(tmp_path: Path) -> None:
    videos = touch(tmp_path / "v", "a.mp4", "b.mp4")
    phones = touch(tmp_path / "p", "a.TextGrid")
    a, b = find_sources([videos], phones=phones)
    assert a.phones == phones / "a.TextGrid"
    assert a.text is None
    assert a.problem is None
    assert b.problem is not None
    assert b.problem == f"{videos / 'b.mp4'}: {phones} has no b.TextGrid; add it"


def test_two_recordings_of_one_name_are_refused_at_once(tmp_path: Path) -> None:
    videos = touch(tmp_path / "v", "a.mp4", "a.mov")
    with pytest.raises(LipwrightError, match=r"two recordings are named 'a': .*; rename one"):
        find_sources([videos], None, videos)


def test_a_name_that_no_file_may_have_elsewhere_is_made_one(tmp_path: Path) -> None:
    videos = touch(tmp_path / "v", "a:b?.mp4")
    words = touch(tmp_path / "w", "a:b?.txt")
    [source] = find_sources([videos], None, words)
    assert source.name == "a_b_"
    assert source.problem is None


@pytest.mark.parametrize("option", ["audio", "transcripts", "phones"])
def test_an_option_that_names_nothing_is_refused_at_once(tmp_path: Path, option: str) -> None:
    videos = touch(tmp_path / "v", "a.mp4")
    with pytest.raises(LipwrightError, match=f"no such file or folder; --{option} names nothing"):
        find_sources([videos], **{option: tmp_path / "gone"})
    with pytest.raises(LipwrightError, match="nothing to capture"):
        find_sources([touch(tmp_path / "empty")])


def test_words_that_are_not_text_are_the_problem_of_their_recording(tmp_path: Path) -> None:
    videos = touch(tmp_path / "v", "a.mp4")
    words = touch(tmp_path / "w")
    (words / "a.txt").write_bytes(b"one\n\xff\xfe")
    [source] = find_sources([videos], None, words)
    assert source.problem == f"{words / 'a.txt'}: line 2: not UTF-8 text; save it as UTF-8"


def test_a_live_link_take_goes_with_its_movie_and_its_words_by_the_names_of_the_app(
    tmp_path: Path,
) -> None:
    takes = touch(tmp_path / "takes", "A_1_iPhone.mov", "A_1_iPhone.wav", "other.mp4")
    header = "Timecode,BlendShapeCount," + ",".join(name[0].upper() + name[1:] for name in ARKIT)
    for part in ("_cal", "_raw", "_neutral"):
        (takes / f"A_1_iPhone{part}.csv").write_text(header + "\n")
    words = touch(tmp_path / "words", "A_1.txt", "other.txt")
    take, other = find_sources([takes], None, words)
    assert (take.name, take.face.name) == ("A_1_iPhone", "A_1_iPhone_cal.csv")
    assert take.audio == takes / "A_1_iPhone.wav"
    assert take.text == "words of A_1"
    assert not take.is_video
    assert other.name == "other"
