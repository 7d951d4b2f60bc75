"""Curve tables for Unreal, read back with csv and json."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from engine_clips import jaw_of_bones, waves
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, export_all, export_clip


def test_the_csv_has_times_in_its_first_line_and_a_curve_a_row(tmp_path: Path) -> None:
    clip = waves("jawOpen", "CTRL_expressions_jawOpen", "a, b", fps=59.94)
    export_clip(path := tmp_path / "a.unreal.csv", clip)
    with path.open(newline="") as file:
        (corner, *times), *rows = csv.reader(file)
    assert corner == "---"
    np.testing.assert_allclose(np.array(times, float), clip.times, atol=1e-6)
    assert tuple(row[0] for row in rows) == clip.names
    values = np.array([row[1:] for row in rows], float)
    np.testing.assert_allclose(values.T, clip.values, atol=1e-6)


def test_the_json_has_a_curve_an_object_with_times_as_keys(tmp_path: Path) -> None:
    clip = waves("jawOpen", 'mouth "close"', fps=23.976)
    export_clip(path := tmp_path / "a.unreal.json", clip)
    rows = json.loads(path.read_text())
    assert tuple(row.pop("Name") for row in rows) == clip.names
    for name, row in zip(clip.names, rows, strict=True):
        times = np.array(list(row), float)
        assert len(times) == (1 if name == "still" else len(clip))
        np.testing.assert_allclose(times, clip.times[: len(times)], atol=1e-6)
        np.testing.assert_allclose(list(row.values()), clip.curve(name)[: len(times)], atol=1e-6)


def test_every_frame_is_written_since_no_tangents_can_be(tmp_path: Path) -> None:
    clip = waves("jawOpen")
    for suffix in (".unreal.csv", ".unreal.json"):
        export_clip(tmp_path / f"all{suffix}", clip)
        export_clip(tmp_path / f"few{suffix}", clip, options=ExportOptions(keys=0.01))
        all_frames = (tmp_path / f"all{suffix}").read_text()
        assert (tmp_path / f"few{suffix}").read_text() == all_frames


def test_bones_are_curves_of_their_channels(tmp_path: Path) -> None:
    performance = jaw_of_bones()
    export_all(path := tmp_path / "a.unreal.json", performance)
    assert tuple(row["Name"] for row in json.loads(path.read_text())) == performance.clip.names


@pytest.mark.parametrize("suffix", [".unreal.csv", ".unreal.json"])
def test_names_that_unreal_takes_for_one_are_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    with pytest.raises(LipwrightError, match=r"'Jaw Open': Unreal takes it for 'jawOpen'; rename"):
        export_clip(path, waves("jawOpen", "Jaw Open"))
    with pytest.raises(LipwrightError, match="Unreal keeps none of it"):
        export_clip(path, waves(" '"))
    with pytest.raises(LipwrightError, match="no controls"):
        export_clip(path, Clip((), 60, np.zeros((3, 0))))
    assert not path.exists()
