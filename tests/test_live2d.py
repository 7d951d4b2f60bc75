"""Live2D motions, evaluated by the rules that Live2D publishes (CubismSpecs, motion3.json)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.export import ExportOptions, Performance, export_all
from lipwright.retarget import retarget
from lipwright.rig import load_rig

LIVE2D = load_rig("live2d")
POINTS = {0: 1, 1: 3, 2: 1, 3: 1}  # kind of segment to its points
META = {
    "Duration", "Fps", "Loop", "AreBeziersRestricted", "FadeInTime", "FadeOutTime", "CurveCount",
    "TotalSegmentCount", "TotalPointCount", "UserDataCount", "TotalUserDataSize",
}  # fmt: skip


class Curve:
    """One curve of a motion, read strictly."""

    def __init__(self, row: list[float]) -> None:
        self.points = [(row[0], row[1])]
        self.segments: list[tuple[int, list[tuple[float, float]]]] = []
        place = 2
        while place < len(row):
            kind = row[place]
            assert isinstance(kind, int)
            count = POINTS[kind]
            flat = row[place + 1 : place + 1 + 2 * count]
            assert len(flat) == 2 * count
            points = list(zip(flat[::2], flat[1::2], strict=True))
            self.segments.append((kind, [self.points[-1], *points]))
            self.points += points
            place += 1 + 2 * count
        assert self.segments  # players find no value in a curve without

    def at(self, time: float) -> float:
        for kind, points in self.segments:
            (start, first), (end, last) = points[0], points[-1]
            if time > end and points is not self.segments[-1][1]:
                continue
            u = min(max((time - start) / (end - start), 0.0), 1.0)
            if kind == 0:
                return first + u * (last - first)
            for third, handle in enumerate(points[1:3], 1):
                assert handle[0] == pytest.approx(start + third * (end - start) / 3, abs=2e-5)
            b, c = points[1][1], points[2][1]
            s = 1 - u
            return s**3 * first + 3 * s * s * u * b + 3 * s * u * u * c + u**3 * last
        raise AssertionError


def read(path: Path) -> tuple[dict[str, Any], dict[str, Curve]]:
    content = json.loads(path.read_text("utf-8"))
    assert set(content) == {"Version", "Meta", "Curves"}
    assert content["Version"] == 3
    meta = content["Meta"]
    assert set(meta) == META
    assert all(set(curve) == {"Target", "Id", "Segments"} for curve in content["Curves"])
    assert {curve["Target"] for curve in content["Curves"]} == {"Parameter"}
    curves = {curve["Id"]: Curve(curve["Segments"]) for curve in content["Curves"]}
    assert meta["CurveCount"] == len(curves) == len(content["Curves"])
    assert meta["TotalSegmentCount"] == sum(len(curve.segments) for curve in curves.values())
    assert meta["TotalPointCount"] == sum(len(curve.points) for curve in curves.values())
    assert all(curve.points[-1][0] <= meta["Duration"] for curve in curves.values())
    return meta, curves


def talking(seconds: float = 2.0, fps: float = 60.0) -> Clip:
    times = np.arange(round(seconds * fps) + 1) / fps
    clip = Clip(CANONICAL, fps, np.zeros((len(times), len(CANONICAL))))
    return clip.with_curves({
        "jawOpen": 0.2 + 0.2 * np.sin(7 * times), "mouthPucker": np.abs(np.sin(3 * times)),
        "eyeBlinkRight": np.clip(np.sin(2 * times), 0, 1),
    })  # fmt: skip


@pytest.mark.parametrize(("keys", "error"), [(None, 3e-5), (0.01, 0.0101)])
def test_parameters_play_as_the_curves_do(tmp_path: Path, keys: float | None, error: float) -> None:
    path = tmp_path / "a.motion3.json"
    export_all(path, Performance(talking()), options=ExportOptions(keys=keys))
    meta, curves = read(path)
    assert (meta["Duration"], meta["Fps"], meta["Loop"]) == (2.0, 60.0, False)
    moved = retarget(talking(), LIVE2D)
    for name, curve in curves.items():
        values = [curve.at(time) for time in moved.times]
        assert values == pytest.approx(moved.curve(name).tolist(), abs=error), name
    kinds = {
        kind for curve in curves.values() for kind, _ in curve.segments if len(curve.points) > 2
    }
    assert kinds == ({0} if keys is None else {1})


def test_few_keys_are_few(tmp_path: Path) -> None:
    paths = [tmp_path / "all.motion3.json", tmp_path / "few.motion3.json"]
    for path, keys in zip(paths, (None, 0.01), strict=True):
        export_all(path, Performance(talking()), options=ExportOptions(keys=keys))
    every, few = (read(path)[1]["ParamMouthOpenY"] for path in paths)
    assert len(few.segments) < len(every.segments) / 5


def test_what_rests_is_left_out_but_for_the_mouth_and_open_eyes_are_1(tmp_path: Path) -> None:
    path = tmp_path / "a.motion3.json"
    export_all(path, Performance(talking().with_curves({"mouthPucker": 0})))
    _, curves = read(path)
    assert set(curves) == {"ParamMouthForm", "ParamMouthOpenY", "ParamEyeROpen"}
    assert curves["ParamEyeROpen"].at(0) == 1
    assert {value for _, value in curves["ParamMouthForm"].points} == {0}


def test_turns_of_the_head_are_angles_in_degrees_towards_the_right_of_the_screen(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.motion3.json"
    still = talking(0.5)
    turned = still.select((*CANONICAL, "headYaw", "headPitch", "headRoll")).with_curves(
        {"headYaw": 0.2, "headPitch": -0.1, "headRoll": 1.0}
    )
    export_all(path, Performance(turned))
    _, curves = read(path)
    assert curves["ParamAngleX"].at(0.2) == pytest.approx(np.degrees(0.2), abs=1e-4)
    assert curves["ParamAngleY"].at(0.2) == pytest.approx(np.degrees(-0.1), abs=1e-4)
    assert curves["ParamAngleZ"].at(0.2) == -30  # as far as models go
    assert not {"headYaw", "headPitch", "headRoll"} & set(curves)


def test_one_frame_is_a_motion_too(tmp_path: Path) -> None:
    path = tmp_path / "a.motion3.json"
    export_all(path, Performance(talking(0.0)))
    meta, curves = read(path)
    assert meta["Duration"] == pytest.approx(1 / 60, abs=1e-4)
    assert curves["ParamMouthOpenY"].at(0) > 0


def test_curves_of_a_model_of_ones_own_keep_their_names(tmp_path: Path) -> None:
    path = tmp_path / "a.motion3.json"
    export_all(path, Performance(Clip(('Param"A"', "口"), 30.0, np.eye(2))))
    _, curves = read(path)
    assert set(curves) == {'Param"A"', "口"}
    assert curves["口"].at(1 / 60) == pytest.approx(0.5, abs=1e-3)
