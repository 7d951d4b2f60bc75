"""The benchmark, small: real recordings, every engine, the whole report."""

from __future__ import annotations

import csv
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.cli import run
from lipwright.dataset.folder import open_dataset

pytest.importorskip("torch", reason="the benchmark trains networks: extra train")
pytest.importorskip("sklearn", reason="the benchmark trains trees: extra train")

ROOT = Path(__file__).resolve().parents[1]
CORPORA = ROOT.parent / "shared" / "corpora"
LEARNT = ("lipwright", "window", "trees", "hmm", "lstm", "dynamic")
RULES = ("bigram", "dominance", "overlay", "static", "smartbody")
ALL = {*LEARNT, *RULES, "default", "openfacefx", "captured"}

needs_grid = pytest.mark.skipif(
    not (CORPORA / "grid-s1").is_dir(), reason="needs the recordings of GRID in ../shared"
)


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory, head: object) -> Path:
    """What `python bench/benchmark.py --small` writes: the report, and the data beside it."""
    del head
    place = tmp_path_factory.mktemp("benchmark")
    command = [sys.executable, str(ROOT / "bench" / "benchmark.py"), "--small", "--videos", "1"]
    done = subprocess.run(
        [*command, "-o", "report"], cwd=place, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return place


def found_in(report: Path, split: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((report / "report.json").read_text("utf-8"))
    return dict(found["splits"][split])


def figures(report: Path, split: str) -> dict[str, Any]:
    return dict(found_in(report, split)["figures"])


@needs_grid
class TestSmall:
    def test_everybody_is_measured_on_held_out_sentences_and_unseen_words(
        self, small: Path
    ) -> None:
        test, unseen = (figures(small / "report", split) for split in ("test", "unseen"))
        assert set(test) == ALL
        assert set(unseen) == ALL - {"default"}, "it has heard these words"
        for rows in (*test.values(), *unseen.values()):
            for measure in ("joint_sd", "joint", "vertices", "inner", "outer", "r", "closures",
                            "false_closures", "silence", "lag"):  # fmt: skip
                row = rows[measure]
                assert row["value"] is None or row["low"] <= row["value"] <= row["high"], measure
            assert math.isfinite(rows["joint"]["value"])

    def test_the_real_face_follows_itself_and_engines_follow_it_somewhat(self, small: Path) -> None:
        test = figures(small / "report", "test")
        assert test["captured"]["r_best_lag"]["value"] > 0.95
        assert test["default"]["r"]["value"] > 0.7
        # Trained on 30 sentences in seconds: they must know when the mouth is open, no more.
        for name in (*LEARNT, *RULES, "openfacefx"):
            assert test[name]["r_best_lag"]["value"] > 0.3, name

    def test_what_learns_is_nearer_to_the_face_than_its_mean(self, small: Path) -> None:
        test = figures(small / "report", "test")
        for name in ("trees", "hmm", "lstm", "dynamic"):
            assert test[name]["shape"]["value"] < 0.8 * _still(small), name

    def test_the_speaker_against_himself_is_reported_with_everybody_on_the_same_words(
        self, small: Path
    ) -> None:
        ceiling = found_in(small / "report", "test")["ceiling"]
        assert ceiling["words"] == 4
        assert ceiling["own"]["r"]["value"] > 0.5
        assert set(ceiling["entries"]) == ALL

    def test_the_tables_agree_with_the_json(self, small: Path) -> None:
        report = small / "report"
        found = {split: figures(report, split) for split in ("test", "unseen")}
        with (report / "figures.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert {(row["split"], row["entry"]) for row in rows} == {
            (split, name) for split, entries in found.items() for name in entries
        }
        for row in rows:
            value = found[row["split"]][row["entry"]][row["measure"]]["value"]
            if row["value"]:
                assert float(row["value"]) == pytest.approx(value, rel=1e-4)
            else:
                assert value is None

    def test_the_page_and_a_video_are_there(self, small: Path) -> None:
        page = (small / "report" / "index.html").read_text("utf-8")
        assert all(name in page for name in ("HMM synthesis", "dynamic visemes", "OpenFaceFX"))
        (video,) = (small / "report" / "videos").glob("*.mp4")
        assert video.stat().st_size > 10_000

    def test_models_trained_anew_are_the_same_and_the_command_again_reports_the_same(
        self, small: Path, tmp_path: Path
    ) -> None:
        engines, out = "trees,hmm,dynamic,lstm", tmp_path / "report"
        command = _again(small, out, engines)
        assert run(command) == 0
        first = (out / "report.json").read_bytes()
        stamps = {path: path.stat().st_mtime_ns for path in out.glob("models/*/model.*")}
        assert len(stamps) == 2 * len(engines.split(","))
        for path in stamps:
            other = small / "report" / "models" / path.parent.name / path.name
            assert path.read_bytes() == other.read_bytes(), path.parent.name
        for split in ("test", "unseen"):
            one, two = figures(out, split), figures(small / "report", split)
            assert all(one[name] == two[name] for name in engines.split(","))
        assert run(command) == 0
        assert (out / "report.json").read_bytes() == first
        assert {path: path.stat().st_mtime_ns for path in stamps} == stamps


def _again(small: Path, out: Path, engines: str) -> list[str]:
    data = small / "report-data" / "grid"
    return [
        "evaluate", str(data), "--engines", engines,
        "--second-head", str(CORPORA / "rulers" / "ict-landmarks.npz"),
        "--hold-out", "???[mvy]??", "--quick", "--videos", "0", "-o", str(out),
    ]  # fmt: skip


def _still(small: Path) -> float:
    """The squared error of the mean face in shape modes, which are 0 there."""
    dataset = open_dataset(small / "report-data" / "grid")
    shapes = []
    for name in dataset.names("test"):
        recording = dataset.recording(name)
        face = recording.face()
        assert face is not None
        shapes.append(face["shape"][recording.valid & np.isfinite(face["joint"]).all(axis=1)])
    return float(np.square(np.concatenate(shapes)).mean())
