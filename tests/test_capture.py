"""`lipwright capture` on real recordings: whole, repeatable, resumed, clear about what fails."""

from __future__ import annotations

import hashlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import numpy.typing as npt
import pytest

from lipwright.dataset.folder import open_dataset
from lipwright.dataset.recording import Flag
from lipwright.face.head import Head
from lipwright.formats import read_track, write_track

GRID = Path(__file__).parents[2] / "shared" / "corpora" / "grid-s1"
needs_grid = pytest.mark.skipif(not GRID.is_dir(), reason="the GRID recordings are not here")
pytestmark = [needs_grid, pytest.mark.usefixtures("head")]

WORDS = {
    "bbal6n": "bin blue at L six now",
    "lbaq4n": "lay blue at Q four now",
    "pbbi8n": "place blue by I eight now",
    "swwc5s": "set white with C five soon",
}
Frames = list[npt.NDArray[np.uint8]]


def grid_folder(place: Path, names: list[str]) -> list[str]:
    """Videos, sounds and words in three folders; the arguments that name them."""
    for part in ("video", "audio", "words"):
        (place / part).mkdir(parents=True)
    for name in names:
        (place / "video" / f"{name}.mp4").symlink_to(GRID / "video" / f"{name}.mp4")
        (place / "audio" / f"{name}.flac").symlink_to(GRID / "audio" / f"{name}.flac")
        (place / "words" / f"{name}.txt").write_text(WORDS[name])
    return [str(place / "video"), "--audio", str(place / "audio"),
            "--transcripts", str(place / "words")]  # fmt: skip


def lipwright(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "lipwright", *map(str, arguments)]
    return subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=300, **options
    )


def digests(folder: Path) -> dict[str, str]:
    """Every file's hash, by its path in the folder."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def grid_frames(name: str) -> Frames:
    with av.open(str(GRID / "video" / f"{name}.mp4")) as container:
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]


def write_video(path: Path, frames: Frames, fps: int = 25, sound: Path | None = None) -> Path:
    """An H.264 file of the frames, with the sound of a file if one is given."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=fps, options={"crf": "16"})
        stream.height, stream.width = frames[0].shape[:2]
        stream.pix_fmt = "yuv420p"
        voice = container.add_stream("aac", rate=16000) if sound else None
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="rgb24")))
        container.mux(stream.encode())
        if sound and voice:
            with av.open(str(sound)) as source:
                for block in source.decode(audio=0):
                    block.pts = None
                    container.mux(voice.encode(block))
            container.mux(voice.encode())
    return path


@pytest.fixture(scope="module")
def captured(tmp_path_factory: pytest.TempPathFactory, head: Head) -> tuple[Path, list[str]]:
    """Two recordings in a dataset, and the arguments that made it."""
    place = tmp_path_factory.mktemp("captured")
    arguments = grid_folder(place, ["bbal6n", "pbbi8n"])
    done = lipwright("capture", *arguments, "-o", place / "set", "--licence", "CC BY 4.0")
    assert done.returncode == 0, done.stderr
    assert "2 recordings captured, 0 failed" in done.stderr
    assert len(done.stderr.splitlines()) == 1, done.stderr
    return place / "set", arguments


def test_a_dataset_has_sound_words_phones_landmarks_weights_and_pictures(
    captured: tuple[Path, list[str]],
) -> None:
    dataset = open_dataset(captured[0])
    assert dataset.names() == ("bbal6n", "pbbi8n")
    assert dataset.manifest["licence"] == "CC BY 4.0"
    for name in dataset.names():
        recording = dataset.recording(name)
        motion = recording.motion
        assert motion.fps == 25
        assert len(motion) in (74, 75)
        assert motion.valid.all()
        assert motion.landmarks is not None
        eyes = motion.landmarks[:, [33, 133, 362, 263], :2].reshape(-1, 2, 2, 2).mean(2)
        assert np.linalg.norm(eyes[:, 1] - eyes[:, 0], axis=-1) == pytest.approx(1, abs=0.05)
        assert [word.text.lower() for word in recording.track.words] == WORDS[name].lower().split()
        assert recording.audio is not None
        assert (recording.folder / "contact.jpg").read_bytes().startswith(b"\xff\xd8")
        quality = recording.info["quality"]
        assert quality["arkit_r"] > 0.98
        assert 0.95 < quality["arkit_gain"] < 1.05
        for file, digest in dataset.entry(name)["files"].items():
            assert hashlib.sha256((recording.folder / file).read_bytes()).hexdigest() == digest
    page = (captured[0] / "report" / "index.html").read_text("utf-8")
    assert "bbal6n" in page
    assert (captured[0] / "report" / "bbal6n.html").is_file()


def test_capturing_again_elsewhere_one_at_a_time_gives_the_same_bytes(
    captured: tuple[Path, list[str]], tmp_path: Path
) -> None:
    dataset, arguments = captured
    done = lipwright(
        "capture", *arguments, "-o", tmp_path / "set", "-j", "1", "--licence", "CC BY 4.0"
    )
    assert done.returncode == 0, done.stderr
    assert digests(tmp_path / "set") == digests(dataset)


def test_what_is_captured_is_not_captured_again(captured: tuple[Path, list[str]]) -> None:
    dataset, arguments = captured
    before = {path: path.stat().st_mtime_ns for path in dataset.glob("recordings/*/*")}
    assert lipwright("capture", *arguments, "-o", dataset, "--licence", "CC BY 4.0").returncode == 0
    assert {path: path.stat().st_mtime_ns for path in dataset.glob("recordings/*/*")} == before


def wait_until(condition: Callable[[], bool], process: subprocess.Popen[bytes]) -> None:
    for _ in range(2400):
        if condition():
            return
        assert process.poll() is None, "it ended too soon"
        time.sleep(0.05)
    raise AssertionError("it never came")


def test_a_run_that_is_killed_goes_on_and_ends_as_if_it_had_not_been(tmp_path: Path) -> None:
    arguments = grid_folder(tmp_path, sorted(WORDS))
    command = ["capture", *arguments, "-j", "1", "-o"]
    whole = tmp_path / "1" / "set"
    killed = tmp_path / "2" / "set"
    assert lipwright(*command, whole).returncode == 0
    with subprocess.Popen(
        [sys.executable, "-m", "lipwright", *command, str(killed)], stderr=subprocess.DEVNULL
    ) as process:
        wait_until(lambda: len(list(killed.glob("recordings/[a-z]*/recording.json"))) >= 1, process)
        os.kill(process.pid, signal.SIGKILL)
    done = sorted(path.parent.name for path in killed.glob("recordings/[a-z]*/recording.json"))
    assert 1 <= len(done) < len(WORDS)
    times = {path: path.stat().st_mtime_ns for path in killed.glob("recordings/[a-z]*/*")}
    assert lipwright(*command, killed).returncode == 0
    assert {path: path.stat().st_mtime_ns for path in times} == times
    assert digests(killed) == digests(whole)


def test_two_captures_into_one_dataset_at_once_are_refused(
    captured: tuple[Path, list[str]], tmp_path: Path
) -> None:
    fcntl = pytest.importorskip("fcntl")
    dataset, arguments = captured
    with (dataset / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = lipwright("capture", *arguments, "-o", dataset)
    assert done.returncode == 2
    assert "another program is writing to this dataset" in done.stderr


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory, head: Head) -> tuple[Path, str]:
    """A run over one good video and one of each kind of bad ones; the dataset and what was said."""
    place = tmp_path_factory.mktemp("broken")
    videos, words = place / "videos", place / "words"
    videos.mkdir()
    words.mkdir()
    frames, sound = grid_frames("bbal6n"), GRID / "audio" / "bbal6n.flac"
    black = [np.zeros_like(frames[0])] * len(frames)
    write_video(videos / "good.mp4", frames, sound=sound)
    write_video(videos / "no_face.mp4", black, sound=sound)
    write_video(videos / "two.mp4", [np.hstack([f, f]) for f in frames], sound=sound)
    write_video(videos / "leaves.mp4", frames[:60] + black[60:], sound=sound)
    write_video(videos / "slow.mp4", frames[::12], fps=2, sound=sound)
    write_video(videos / "silent.mp4", frames)
    write_video(videos / "wordless.mp4", frames, sound=sound)
    data = (videos / "good.mp4").read_bytes()
    (videos / "corrupt.mp4").write_bytes(data[: len(data) // 2])
    (videos / "text.mp4").write_text("no video at all")
    (videos / "empty.mp4").write_bytes(b"")
    for video in videos.iterdir():
        if video.stem != "wordless":
            (words / f"{video.stem}.txt").write_text(WORDS["bbal6n"])
    done = lipwright("capture", videos, "-t", words, "-o", place / "set")
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    return place / "set", done.stderr


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("no_face", "no face in 100 % of the frames"),
        ("two", "two faces from 0.00 to"),
        ("slow", "2 frames a second are too few for speech; record at 24 or more"),
        ("silent", "no sound"),
        ("wordless", "has no wordless.txt; add it"),
        ("corrupt", ""),
        ("text", ""),
        ("empty", ""),
    ],
)
def test_each_bad_video_gets_one_line_that_names_it_and_is_in_the_report(
    broken: tuple[Path, str], name: str, said: str
) -> None:
    dataset, stderr = broken
    lines = [line for line in stderr.splitlines() if f"{name}.mp4" in line]
    assert len(lines) == 1, stderr
    assert lines[0].startswith("warning: not captured: ")
    assert said in lines[0]
    entry = open_dataset(dataset).entry(name)
    assert entry["status"] == "failed"
    assert [lines[0].removeprefix("warning: not captured: ")] == entry["reasons"]
    assert name in (dataset / "report" / "index.html").read_text("utf-8")
    assert not (dataset / "recordings" / name).exists()


def test_the_good_video_among_bad_ones_is_captured(broken: tuple[Path, str]) -> None:
    dataset, stderr = broken
    assert open_dataset(dataset).names() == ("good", "leaves")
    assert "2 recordings captured, 8 failed" in stderr


def test_a_face_that_leaves_is_marked_and_not_invented(broken: tuple[Path, str]) -> None:
    dataset, stderr = broken
    recording = open_dataset(dataset).recording("leaves")
    lost = (recording.motion.flags & Flag.LOST) != 0
    assert lost[61:].all()
    assert not lost[:59].any()
    assert recording.motion.landmarks is not None
    assert np.isnan(recording.motion.landmarks[lost]).all()
    assert np.isnan(recording.motion.arkit[lost]).all()
    assert "leaves.mp4: the face is lost from 2." in stderr
    assert any("tracked" in reason or "face" in reason for reason in recording.info["reject"])


def test_reject_leaves_out_what_the_report_advises_against(broken: tuple[Path, str]) -> None:
    dataset, _ = broken
    copy = dataset.parent / "rejected"
    shutil.copytree(dataset, copy)
    videos = dataset.parent / "videos"
    done = lipwright("capture", videos, "-t", dataset.parent / "words", "-o", copy, "--reject")
    assert done.returncode == 2
    assert open_dataset(copy).names() == ("good",)
    assert open_dataset(copy).names(usable=False) == open_dataset(dataset).names(usable=False)


def test_a_full_disk_is_one_line_for_each_recording_and_leaves_nothing_half(tmp_path: Path) -> None:
    arguments = grid_folder(tmp_path, ["bbal6n"])
    limit = 100_000  # bytes a file may have: the sound fits, the landmarks do not
    done = lipwright(
        "capture", *arguments, "-o", tmp_path / "set",
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    )  # fmt: skip
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "bbal6n" in done.stderr
    assert "cannot be written: File too large" in done.stderr
    assert list((tmp_path / "set" / "recordings").iterdir()) == []


def test_corrected_phones_are_kept_and_used_when_the_options_change(tmp_path: Path) -> None:
    arguments = grid_folder(tmp_path, ["bbal6n"])
    out = tmp_path / "set"
    assert lipwright("capture", *arguments, "-o", out).returncode == 0
    path = out / "recordings" / "bbal6n" / "phones.TextGrid"
    track = read_track(path)
    edges = track.edges.copy()
    edges[3] += 0.005
    write_track(path, track.with_edges(edges))
    edited = path.read_bytes()
    done = lipwright("capture", *arguments, "-o", out, "--asymmetric")
    assert done.returncode == 0, done.stderr
    assert "the edited phones.TextGrid is kept; delete it to align again" in done.stderr
    assert path.read_bytes() == edited
    info = json.loads((path.parent / "recording.json").read_text())
    assert info["options"]["tied"] is False


def test_phone_tracks_stand_in_for_words(captured: tuple[Path, list[str]], tmp_path: Path) -> None:
    dataset, _ = captured
    phones = tmp_path / "phones"
    phones.mkdir()
    shutil.copy(dataset / "recordings" / "bbal6n" / "phones.TextGrid", phones / "bbal6n.TextGrid")
    done = lipwright(
        "capture", GRID / "video" / "bbal6n.mp4", "--audio", GRID / "audio" / "bbal6n.flac",
        "--phones", phones, "-o", tmp_path / "set",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    track = open_dataset(tmp_path / "set").recording("bbal6n").track
    assert track.phones == open_dataset(dataset).recording("bbal6n").track.phones


def test_a_folder_that_is_no_dataset_is_not_written_to(tmp_path: Path) -> None:
    arguments = grid_folder(tmp_path, ["bbal6n"])
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.doc").write_text("years of work")
    done = lipwright("capture", *arguments, "-o", tmp_path / "mine")
    assert done.returncode == 2
    assert "holds 'thesis.doc' and is no dataset; name a new folder" in done.stderr
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.doc"]
