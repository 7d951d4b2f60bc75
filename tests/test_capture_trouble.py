"""Capture in the hands of clumsy and hostile people: nothing of theirs is lost, nothing hangs."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import unicodedata
from pathlib import Path

import numpy as np
import pytest
import soundfile

from lipwright.capture.filling import filled, sweep
from lipwright.capture.job import CaptureOptions, Outcome, capture_recording
from lipwright.capture.run import capture
from lipwright.capture.sources import Source, find_sources
from lipwright.controls import ARKIT
from lipwright.dataset.folder import open_dataset
from lipwright.dataset.recording import from_json, to_json
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.formats import read_track, write_track

TEXTGRID_OF_A = """File type = "ooTextFile"
Object class = "TextGrid"

0
1
<exists>
1
"IntervalTier"
"phones"
0
1
3
0 0.3 "sil"
0.3 0.7 "AA"
0.7 1 "sil"
"""


def take(folder: Path, name: str = "a") -> Path:
    """A Live Link Face recording of 1 s with its sound and a phone track: quick to capture."""
    folder.mkdir(exist_ok=True)
    rows = ["Timecode,BlendShapeCount," + ",".join(key[0].upper() + key[1:] for key in ARKIT)]
    opens = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(60) / 60)
    for frame in range(60):
        weights = np.where(np.array(ARKIT) == "jawOpen", opens[frame], 0.0)
        values = ",".join(f"{weight:.5f}" for weight in weights)
        rows.append(f"10:00:00:{frame:02d}.000,52,{values}")
    (folder / f"{name}.csv").write_text("\n".join(rows) + "\n")
    sound = 0.1 * np.sin(np.arange(16000) / 10)
    soundfile.write(folder / f"{name}.wav", sound, 16000)
    (folder / f"{name}.TextGrid").write_text(TEXTGRID_OF_A)
    return folder / f"{name}.csv"


def source_of(face: Path) -> Source:
    [source] = find_sources([face], phones=face.parent)
    assert source.problem is None
    return source


@pytest.fixture
def place(tmp_path: Path, head: Head) -> tuple[Source, Path]:
    """A take, and the folder of a dataset in which it has been captured."""
    source, path = source_of(take(tmp_path / "takes")), tmp_path / "set"
    assert again(source, path).error is None
    return source, path


def again(source: Source, path: Path, **options: object) -> Outcome:
    (path / "recordings").mkdir(parents=True, exist_ok=True)
    return capture_recording(source, path, CaptureOptions(**options))  # type: ignore[arg-type]


def lipwright(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "lipwright", *map(str, arguments)]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=120)


def edit_phones(folder: Path) -> bytes:
    path = folder / "phones.TextGrid"
    track = read_track(path)
    edges = track.edges.copy()
    edges[1] += 0.05
    write_track(path, track.with_edges(edges))
    return path.read_bytes()


def test_edited_phones_outlive_every_later_capture(place: tuple[Source, Path]) -> None:
    source, path = place
    folder = path / "recordings" / "a"
    edited = edit_phones(folder)
    for fps in (24.0, 25.0, 30.0):
        outcome = again(source, path, fps=fps)
        assert outcome.fresh
        assert "the edited phones.TextGrid is kept" in outcome.warnings[-1]
        assert (folder / "phones.TextGrid").read_bytes() == edited
    (folder / "phones.TextGrid").unlink()
    assert not any("is kept" in line for line in again(source, path).warnings)
    assert (folder / "phones.TextGrid").read_bytes() != edited


def test_edited_phones_outlive_a_broken_recording_json(place: tuple[Source, Path]) -> None:
    source, path = place
    folder = path / "recordings" / "a"
    edited = edit_phones(folder)
    (folder / "recording.json").write_text("{")
    assert again(source, path).error is None
    assert (folder / "phones.TextGrid").read_bytes() == edited
    assert json.loads((folder / "recording.json").read_text())["name"] == "a"


def test_phones_that_were_edited_to_rubbish_are_refused_and_left(
    place: tuple[Source, Path],
) -> None:
    source, path = place
    file = path / "recordings" / "a" / "phones.TextGrid"
    file.write_text("rubbish")
    error = again(source, path).error
    assert error is not None
    assert str(file) in error
    assert error.endswith("or delete the file to align again")
    assert file.read_text() == "rubbish"


@pytest.mark.parametrize("file", ["motion.npz", "audio.flac"])
def test_a_damaged_file_is_made_anew_to_the_same_bytes(
    place: tuple[Source, Path], file: str
) -> None:
    source, path = place
    damaged = path / "recordings" / "a" / file
    whole = damaged.read_bytes()
    damaged.write_bytes(whole[: len(whole) // 2])
    assert again(source, path).fresh
    assert damaged.read_bytes() == whole
    assert not again(source, path).fresh


def test_what_the_user_put_beside_a_recording_stays(place: tuple[Source, Path]) -> None:
    source, path = place
    folder = path / "recordings" / "a"
    (folder / "notes.txt").write_text("years of work")
    (folder / "face.npz").write_text("of the motion that goes")
    assert again(source, path, fps=24.0).fresh
    assert (folder / "notes.txt").read_text() == "years of work"
    assert not (folder / "face.npz").exists()


@pytest.mark.parametrize("left", [("", "part"), ("part", "old"), ("", "old")])
def test_a_kill_at_any_step_of_a_replacement_loses_nothing(
    tmp_path: Path, left: tuple[str, str]
) -> None:
    places = {
        "": tmp_path / "x.old.y",
        "part": tmp_path / ".0123abcd.part.x.old.y",
        "old": tmp_path / ".0123abcd.old.x.old.y",
    }
    for place in left:
        places[place].mkdir()
    before = places["old" if "old" in left else ""]
    (before / "motion.npz").write_text("motion")
    (before / "notes.txt").write_text("notes")
    (tmp_path / ".git").mkdir()
    sweep(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [".git", "x.old.y"]
    assert (places[""] / "notes.txt").read_text() == "notes"


def test_a_link_in_the_place_of_a_recording_goes_and_what_it_names_stays(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("years of work")
    (tmp_path / "a").symlink_to("mine")
    with filled(tmp_path / "a") as part:
        (part / "motion.npz").write_text("new")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "mine"]
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["motion.npz"]
    assert (tmp_path / "mine" / "notes.txt").read_text() == "years of work"


def test_a_replacement_that_fails_leaves_what_was_there(tmp_path: Path) -> None:
    folder = tmp_path / "a"
    folder.mkdir()
    (folder / "motion.npz").write_text("old")
    with pytest.raises(LipwrightError, match="a: cannot be written: No space"), filled(folder):
        raise OSError(28, "No space left on device")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    assert (folder / "motion.npz").read_text() == "old"


def test_a_failure_inside_is_of_one_recording(
    place: tuple[Source, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    source, path = place

    def fail(*arguments: object) -> None:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr("lipwright.capture.job.estimate_offset", fail)
    error = again(source, path, fps=24.0).error
    assert error is not None
    assert "a.csv: failed inside (ZeroDivisionError: a bug); this is a bug" in error


def test_a_folder_of_recordings_that_are_not_ours_is_not_written_to(
    tmp_path: Path, head: Head
) -> None:
    source = source_of(take(tmp_path / "takes"))
    mine = tmp_path / "set" / "recordings" / "a"
    mine.mkdir(parents=True)
    (mine / "film.mov").write_text("years of work")
    with pytest.raises(LipwrightError, match="holds 'recordings/a' and is no dataset"):
        capture([source], tmp_path / "set", CaptureOptions())
    assert [path.name for path in mine.iterdir()] == ["film.mov"]


def test_a_file_is_no_folder_for_a_dataset(tmp_path: Path, head: Head) -> None:
    face = take(tmp_path / "takes")
    with pytest.raises(LipwrightError, match=r"a\.csv: is a file; name a new folder"):
        capture([source_of(face)], face, CaptureOptions())


def test_a_dataset_whose_manifest_was_deleted_is_taken_up_again(
    place: tuple[Source, Path], tmp_path: Path
) -> None:
    source, path = place
    arguments = (source.face, "--phones", source.face.parent, "-o", path)
    assert lipwright("capture", *arguments).returncode == 0
    manifest = (path / "dataset.json").read_bytes()
    (path / "dataset.json").write_text("{")
    with pytest.raises(LipwrightError, match="restore it, or delete it and capture again"):
        open_dataset(path)
    (path / "dataset.json").unlink()
    done = lipwright("capture", *arguments)
    assert done.returncode == 0, done.stderr
    assert (path / "dataset.json").read_bytes() == manifest


def test_names_that_are_no_utf_8_are_captured(tmp_path: Path, head: Head) -> None:
    name = os.fsdecode(b"caf\xe9\x1b[31m")
    plain = take(tmp_path / "takes")
    try:
        for suffix in (".csv", ".wav", ".TextGrid"):
            plain.with_suffix(suffix).rename(plain.with_name(name + suffix))
    except (OSError, UnicodeError):
        pytest.skip("this system has no such names")
    source = source_of(plain.with_name(f"{name}.csv"))
    assert source.name == "caf__[31m"
    assert again(source, tmp_path / "set").error is None
    info = json.loads(
        (tmp_path / "set" / "recordings" / source.name / "recording.json").read_text()
    )
    assert info["source"]["arkit"]["path"] == str(source.face)
    assert from_json(to_json([name])) == [name]


def test_accents_match_however_they_are_written(tmp_path: Path) -> None:
    composed, apart = (unicodedata.normalize(form, "élan") for form in ("NFC", "NFD"))
    for folder in "vw":
        (tmp_path / folder).mkdir()
    (tmp_path / "v" / f"{apart}.mp4").touch()
    (tmp_path / "w" / f"{composed}.txt").write_text("one")
    [source] = find_sources([tmp_path / "v"], transcripts=tmp_path / "w")
    assert source.text == "one"
    (tmp_path / "table").write_text(f"{composed}\ttwo\n")
    [source] = find_sources([tmp_path / "v"], transcripts=tmp_path / "table")
    assert source.text == "two"


def test_names_that_differ_in_capitals_only_are_refused_and_a_file_named_twice_is_one(
    tmp_path: Path,
) -> None:
    for folder in "vw":
        (tmp_path / folder).mkdir()
    (tmp_path / "v" / "a.mp4").touch()
    (tmp_path / "w" / "A.mov").touch()
    assert len(find_sources([tmp_path / "v" / "a.mp4", tmp_path / "v"])) == 1
    with pytest.raises(LipwrightError, match=r"two recordings are named 'a': .*a\.mp4, .*A\.mov"):
        find_sources([tmp_path / "v", tmp_path / "w"])


def test_the_file_of_the_same_capitals_comes_first(tmp_path: Path) -> None:
    (tmp_path / "A.mp4").touch()
    (tmp_path / "w").mkdir()
    (tmp_path / "w" / "A.txt").write_text("mine")
    (tmp_path / "w" / "a.txt").write_text("another's")
    if len(list((tmp_path / "w").iterdir())) < 2:
        pytest.skip("this disk does not tell capitals apart")
    assert find_sources([tmp_path / "A.mp4"], transcripts=tmp_path / "w")[0].text == "mine"


def test_a_table_with_two_texts_for_one_recording_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").touch()
    (tmp_path / "table").write_text("a\tone\nb\ttwo\na\tthree\n")
    with pytest.raises(LipwrightError, match=r"line 3: 'a' has other words at .*line 1; keep one"):
        find_sources([tmp_path / "a.mp4"], transcripts=tmp_path / "table")


def problem_of(*arguments: Path | None) -> str:
    face, *others = arguments
    assert face is not None
    [source] = find_sources([face], *others)
    assert source.problem is not None
    return source.problem


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_pipes_and_devices_are_refused_before_anything_waits_for_them(tmp_path: Path) -> None:
    video, pipe, words = tmp_path / "a.mp4", tmp_path / "pipe.mp4", tmp_path / "a.txt"
    video.touch()
    words.write_text("one")
    os.mkfifo(pipe)
    said = f"{pipe}: is a device or pipe; save it to a file"
    assert problem_of(pipe, None, words) == said
    assert problem_of(video, pipe, words) == f"{video}: {said}"
    assert problem_of(video, None, None, pipe) == f"{video}: {said}"
    assert "too long for a transcript" in problem_of(video, None, Path("/dev/zero"))


def test_links_to_nothing_and_names_that_are_too_long_are_told(tmp_path: Path) -> None:
    (tmp_path / "v").mkdir()
    (tmp_path / "v" / "a.mp4").symlink_to("nowhere.mp4")
    (tmp_path / "v" / "folder.mp4").mkdir()
    assert "a.mp4: no such file" in problem_of(tmp_path / "v", None, tmp_path)
    assert "no such file" in problem_of(Path("x" * 300 + ".mp4"), None, tmp_path)
    with pytest.raises(LipwrightError, match="--audio names nothing"):
        find_sources([tmp_path / "v"], Path("x" * 300))


def test_missing_phones_are_told_by_their_name(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").touch()
    said = problem_of(tmp_path / "a.mp4", None, None, tmp_path)
    assert said == f"{tmp_path / 'a.mp4'}: {tmp_path} has no a.TextGrid; add it"


def test_a_picture_that_outlasts_the_sound_is_told(tmp_path: Path, head: Head) -> None:
    face = take(tmp_path / "takes")
    soundfile.write(face.with_suffix(".wav"), 0.1 * np.sin(np.arange(47000) / 10), 16000)
    assert "they are not of one recording" in str(again(source_of(face), tmp_path / "set").error)


def test_an_interrupt_ends_with_status_1_and_says_what_is_kept(tmp_path: Path, head: Head) -> None:
    for index in range(40):
        take(tmp_path / "takes", f"take{index}")
    out = tmp_path / "set"
    command = ["capture", tmp_path / "takes", "--phones", tmp_path / "takes", "-o", out, "-j", "1"]
    with subprocess.Popen(
        [sys.executable, "-m", "lipwright", *map(str, command)], stderr=subprocess.PIPE, text=True
    ) as process:
        while not list(out.glob("recordings/take*/recording.json")):
            assert process.poll() is None
        process.send_signal(signal.SIGTERM)
        said = process.communicate(timeout=60)[1]
    assert process.returncode == 1
    assert said.splitlines()[-1] == (
        f"lipwright: interrupted; what was captured is kept in {out}; run the same command to go on"
    )
    kept = list(out.glob("recordings/take*"))
    assert 0 < len(kept) < 40
    assert all((folder / "recording.json").is_file() for folder in kept)
