"""Datasets from elsewhere, edited, damaged or captured into again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from lipwright.cli import run
from lipwright.dataset.folder import open_dataset
from lipwright.formats import read_track, write_track


def capture(place: Path, *more: str) -> int:
    videos, words = str(place / "videos"), str(place / "words")
    return run(["capture", videos, "-t", words, "-o", str(place / "anna"), *more])


def test_phones_that_were_corrected_and_accepted_stay_so_when_more_is_captured(
    workplace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = workplace / "anna" / "recordings" / "anna1" / "phones.TextGrid"
    track = read_track(path)
    edges = track.edges.copy()
    edges[2] += 0.004
    write_track(path, track.with_edges(edges))
    assert run(["dataset", "check", str(workplace / "anna"), "--accept"]) == 0
    assert "1 edited recording accepted" in capsys.readouterr().err
    assert capture(workplace) == 0
    capsys.readouterr()
    assert run(["dataset", "check", str(workplace / "anna")]) == 0
    assert "edited" not in capsys.readouterr().err


def test_what_an_earlier_run_left_out_stays_out_if_it_is_not_captured_again(
    workplace: Path,
) -> None:
    dataset = workplace / "anna"
    path = dataset / "dataset.json"
    manifest = json.loads(path.read_text())
    manifest["recordings"][0] |= {"status": "rejected", "reasons": ["the light is bad"]}
    path.write_text(json.dumps(manifest))
    videos = workplace / "bert-videos"
    assert run(["capture", str(videos), "-t", str(workplace / "words"), "-o", str(dataset)]) == 0
    assert open_dataset(dataset).names() == ("anna2", "bert1")
    assert open_dataset(dataset).entry("anna1")["reasons"] == ["the light is bad"]


@pytest.mark.parametrize("link", [".lock", "dataset.json", "report/index.html", "report"])
def test_a_link_in_a_dataset_does_not_lead_a_capture_out_of_it(
    workplace: Path, link: str, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = workplace / "mine"
    place = workplace / "anna" / link
    if place.is_dir():
        place.rename(mine)
    else:
        mine.write_bytes(place.read_bytes() + b" ")
        place.unlink()
    place.symlink_to(mine)
    before = (
        mine.read_bytes() if mine.is_file() else sorted(p.stat().st_mtime for p in mine.iterdir())
    )
    assert capture(workplace) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert str(workplace / "anna") in line
    after = (
        mine.read_bytes() if mine.is_file() else sorted(p.stat().st_mtime for p in mine.iterdir())
    )
    assert after == before


def test_damaged_arrays_are_one_line_of_info_and_of_check(
    workplace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = workplace / "anna" / "recordings" / "anna1" / "motion.npz"
    whole = path.read_bytes()
    half = bytearray(whole)
    half[len(half) // 2 : len(half) // 2 + 400] = bytes(400)
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    np.savez(path, **{**arrays, "fps": 0.0})
    endless = path.read_bytes()
    for damaged in (bytes(half), whole[: len(whole) // 2], b"", endless):
        path.write_bytes(damaged)
        for command in ("info", "check"):
            status = run(["dataset", command, str(workplace / "anna")])
            said = capsys.readouterr()
            assert "bug" not in said.err
            if status == 2:
                assert "motion.npz" in said.err + said.out
        assert status == 2


def test_captured_weights_of_our_own_head_follow_the_motion_that_drew_it(speakers: Path) -> None:
    for name in ("anna1", "anna2"):
        recording = open_dataset(speakers / "anna").recording(name)
        table = np.genfromtxt(speakers / f"{name}.csv", delimiter=",", names=True)
        played = np.interp(recording.times, table["time"], table["jawOpen"])
        jaw = recording.motion.arkit[:, 17]
        assert np.corrcoef(played, jaw)[0, 1] > 0.9
        assert recording.info["quality"]["tracked"] == 1


def test_corrected_phones_change_what_follows_from_them_and_stay_to_the_byte(
    workplace: Path,
) -> None:
    folder = workplace / "anna" / "recordings" / "anna1"
    path = folder / "phones.TextGrid"
    track = read_track(path)
    edges = track.edges.copy()
    edges[1:-1] += 0.05
    write_track(path, track.with_edges(edges), ".short.textgrid")
    edited = path.read_bytes()
    before = json.loads((folder / "recording.json").read_text())
    assert capture(workplace) == 0
    after = json.loads((folder / "recording.json").read_text())
    assert path.read_bytes() == edited
    assert after["edited_phones"] is True
    assert after["offset"]["seconds"] == pytest.approx(before["offset"]["seconds"] - 0.05, abs=0.02)
    times = {file: file.stat().st_mtime_ns for file in folder.iterdir()}
    assert capture(workplace) == 0
    assert {file: file.stat().st_mtime_ns for file in folder.iterdir()} == times
