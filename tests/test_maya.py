"""Curves and scripts for Maya, read back with readers of the documented forms."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engine_clips import BOUND, hermite, jaw_of_bones, waves
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, export_all, export_clip

# Maya documentation, currentUnit: frames a second of the named units.
RATES = {"game": 15, "film": 24, "pal": 25, "ntsc": 30, "show": 48, "palf": 50, "ntscf": 60}
RATES["sec"] = 1


class AnimFile:
    """Maya's "ANIM file format", version 1.1: words, each statement up to `;` or a brace."""

    def __init__(self, path: Path) -> None:
        text = re.sub(r"(//|#).*", "", path.read_text())
        self.statements = re.findall(r"[^;{}]+(?=[;{])|[{}]", text)
        self.place = 0
        self.header: dict[str, str] = {}
        self.curves: list[dict[str, Any]] = []
        while self.place < len(self.statements):
            words = self.take().split()
            if not words:
                continue
            if words[0] == "anim":
                full, leaf, node, row, children, index = words[1:]
                assert full.split(".")[-1] == leaf
                assert (row, children) == ("0", "0")
                assert self.take().split() == ["animData"]
                self.curves.append({"node": node, "name": leaf, "index": int(index), **self.data()})
            else:
                key, value = words
                self.header[key] = value
        assert self.header["animVersion"] == "1.1"
        self.rate = RATES[self.header["timeUnit"]]

    def take(self) -> str:
        self.place += 1
        return self.statements[self.place - 1].strip()

    def data(self) -> dict[str, Any]:
        found: dict[str, Any] = {}
        assert self.take() == "{"
        while (statement := self.take()) != "}":
            words = statement.split()
            if words == ["keys"]:
                assert self.take() == "{"
                found["keys"] = []
                while (row := self.take()) != "}":
                    if row:
                        found["keys"].append(row.split())
            elif words:
                found[words[0]] = words[1]
        return found


def maya_value(curve: dict[str, Any], rate: float, when: np.ndarray, turn: float) -> np.ndarray:
    """The curve at `when` s from tangents of angles; `turn` units of value are one of a tangent."""
    rows = curve["keys"]
    times = np.array([float(row[0]) for row in rows]) / rate
    values = np.array([float(row[1]) for row in rows])
    if rows[0][2] == "linear":
        assert all(row[2:] == ["linear", "linear", "1", "1", "0"] for row in rows)
        return np.interp(when, times, values)
    assert all(row[2:4] == ["fixed", "fixed"] and row[8] == row[10] == "1" for row in rows)
    before, after = (
        turn * np.tan(np.radians([float(row[column]) for row in rows])) for column in (7, 9)
    )
    return hermite(times, values, before, after, when)


@pytest.mark.parametrize(
    ("fps", "unit"),
    [(24, "film"), (25, "pal"), (30, "ntsc"), (60, "ntscf"), (59.94, "sec"), (100, "sec")],
)
def test_weights_come_back_in_a_unit_that_maya_names(tmp_path: Path, fps: float, unit: str) -> None:
    clip = waves("jawOpen", "mouthClose", fps=fps)
    export_clip(path := tmp_path / "a.maya.anim", clip)
    found = AnimFile(path)
    assert found.header["timeUnit"] == unit
    assert float(found.header["endTime"]) / found.rate == pytest.approx(clip.duration)
    assert [curve["index"] for curve in found.curves] == [0, 1, 2]
    for name, curve in zip(clip.names, found.curves, strict=True):
        assert (curve["node"], curve["name"]) == ("blendShape1", name)
        assert (curve["input"], curve["output"], curve["weighted"]) == ("time", "unitless", "0")
        times = np.array([float(row[0]) for row in curve["keys"]]) / found.rate
        np.testing.assert_allclose(times, clip.times[: len(times)], atol=1e-6)
        seen = maya_value(curve, found.rate, clip.times, 1)
        np.testing.assert_allclose(seen, clip.curve(name), atol=1e-5)


def test_few_keys_have_angles_and_keep_the_bound(tmp_path: Path) -> None:
    clip = waves("jawOpen", "mouthClose", frames=600)
    export_clip(path := tmp_path / "a.maya.anim", clip, options=ExportOptions(keys=BOUND))
    found = AnimFile(path)
    for name, curve in zip(clip.names, found.curves, strict=True):
        assert len(curve["keys"]) < len(clip) / 8
        seen = maya_value(curve, found.rate, clip.times, 1)
        assert np.abs(seen - clip.curve(name)).max() <= BOUND


class Script:
    """The part of MEL that the script uses: strings, setAttr on parts of arrays, two procedures."""

    def __init__(self, path: Path) -> None:
        text = path.read_text()
        assert text.count("{") == text.count("}")
        procedures, _, body = text.partition("string $lipwright_shapes = `lipwright_find_node`;\n")
        self.procedures = procedures
        self.rate = 0.0
        self.curves: dict[tuple[str, str], dict[str, Any]] = {}
        lines = body.splitlines()
        for number, line in enumerate(lines):
            if line.startswith("currentUnit -time $lipwright_unit"):
                self.report = "\n".join(lines[number:])
                break
            self.run(line)

    def run(self, line: str) -> None:
        if found := re.fullmatch(
            r"string \$\w+ = `currentUnit -query -(time|linear|angle)`;", line
        ):
            return
        if found := re.fullmatch(r"currentUnit -time (\w+) -linear cm -angle deg;", line):
            self.rate = RATES[found[1]]
        elif found := re.fullmatch(r'lipwright_begin "(\w+)" (\d);', line):
            self.open: dict[str, Any] = {"type": found[1], "tan": found[2]}
        elif found := re.fullmatch(r'lipwright_end ("\w+"|\$lipwright_shapes) "(\w+)";', line):
            self.curves[found[1].strip('"'), found[2]] = self.open
        else:
            form = r'setAttr -size (\d+) \(\$lipwright_curve \+ "\.(\w+)\[(\d+):(\d+)\]"\)([^;]*);'
            size, name, first, last, numbers = re.fullmatch(form, line).groups()
            rows = np.array(numbers.split(), float).reshape(int(size), -1)
            before = self.open.setdefault(name, np.zeros((0, rows.shape[1])))
            assert len(before) == int(first)
            assert len(rows) == int(last) + 1 - int(first) <= 250
            self.open[name] = np.concatenate([before, rows])


def script_value(
    curve: dict[str, Any], rate: float, when: np.ndarray, turn: float = 1
) -> np.ndarray:
    times, values = curve["ktv"][:, 0] / rate, curve["ktv"][:, 1]
    if curve["tan"] == "2":
        return np.interp(when, times, values)
    if len(times) == 1:
        return np.full(len(when), values[0])
    slopes = []
    for side in "io":
        x, y = curve[f"k{side}x"][:, 0], curve[f"k{side}y"][:, 0]
        np.testing.assert_allclose(np.hypot(x, y), 1, atol=1e-5)
        slopes.append(turn * y / x)
    return hermite(times, values, *slopes, when)


@pytest.mark.parametrize(("fps", "keys"), [(30, None), (59.94, None), (60, BOUND)])
def test_the_script_sets_the_curves(tmp_path: Path, fps: float, keys: float | None) -> None:
    clip = waves("jawOpen", "mouthClose", fps=fps, frames=600)
    export_clip(path := tmp_path / "a.mel", clip, options=ExportOptions(keys=keys))
    script = Script(path)
    assert [name for _, name in script.curves] == list(clip.names)
    for name in clip.names:
        curve = script.curves["$lipwright_shapes", name]
        assert curve["type"] == "animCurveTU"
        seen = script_value(curve, script.rate, clip.times)
        assert np.abs(seen - clip.curve(name)).max() <= (keys or 1e-5)
        if keys:
            assert len(curve["ktv"]) < len(clip) / 8


def test_the_script_says_what_is_missing_and_puts_the_units_back(tmp_path: Path) -> None:
    export_clip(path := tmp_path / "a.mel", waves("jawOpen"))
    script = Script(path)
    assert script.report.startswith(
        "currentUnit -time $lipwright_unit -linear $lipwright_length -angle $lipwright_angle;"
    )
    assert "$lipwright_missing" in script.report
    assert "`objExists $plug`" in script.procedures


@pytest.mark.parametrize("keys", [None, BOUND])
def test_joints_are_placed_in_centimetres_and_turned_in_degrees(
    tmp_path: Path, keys: float | None
) -> None:
    performance = jaw_of_bones()
    clip = performance.clip
    for suffix in (".maya.anim", ".mel"):
        path = tmp_path / f"a{suffix}"
        export_all(path, performance, options=ExportOptions(keys=keys))
        if suffix == ".mel":
            script = Script(path)
            curves = script.curves
            place, turn = curves["jaw", "translateZ"], curves["jaw", "rotateX"]
            assert (place["type"], turn["type"]) == ("animCurveTL", "animCurveTA")
            places = script_value(place, script.rate, clip.times)
            turns = script_value(turn, script.rate, clip.times, np.degrees(1))
        else:
            found = AnimFile(path)
            by_name = {(c["node"], c["name"]): c for c in found.curves}
            place, turn = by_name["jaw", "translateZ"], by_name["jaw", "rotateX"]
            assert (place["output"], turn["output"]) == ("linear", "angular")
            places = maya_value(place, found.rate, clip.times, 1)
            turns = maya_value(turn, found.rate, clip.times, np.degrees(1))
        bound = keys or 1e-5
        assert np.abs(places - 100 * (0.02 + clip.curve("jaw.tz"))).max() <= bound
        assert np.abs(turns - clip.curve("jaw.rx")).max() <= bound


@pytest.mark.parametrize("suffix", [".maya.anim", ".mel"])
def test_names_that_maya_cannot_have_are_refused(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    with pytest.raises(LipwrightError, match="'あ' has other letters; rename it in the rig"):
        export_clip(path, waves("あ"))
    with pytest.raises(LipwrightError, match="'jaw-Open' is 'jaw Open' to it too"):
        export_clip(path, waves("jaw Open", "jaw-Open"))
    with pytest.raises(LipwrightError, match="no blendshape and no bone"):
        export_clip(path, waves("headRoll", still=""))
    with pytest.raises(LipwrightError, match="no controls"):
        export_clip(path, Clip((), 60, np.zeros((3, 0))))
    assert not path.exists()
    export_clip(path, waves("Eyebrow Raise"))
    assert "Eyebrow_Raise" in path.read_text()
