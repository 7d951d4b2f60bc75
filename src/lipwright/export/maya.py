"""Maya animation curves (`.maya.anim`), the text that Maya's animImport plug-in reads.

Layout (Maya documentation, "ANIM file format", version 1.1): a header of `animVersion`,
`mayaVersion`, units, `startTime` and `endTime`; then a line `anim ATTRIBUTE LEAF NODE` with the
numbers row, children and index, and a block `animData` with `input`, `output`, `weighted`,
infinities and `keys`: time, value, types of the tangents before and after (`linear`, or `fixed`
with angles), three flags, and for `fixed` angle and weight before and after. The tangent of an
angle is the slope a second, in units, cm or radians.

Blendshapes are attributes of a blendShape node; animImport goes by what is selected. Bones of the
rig are `translate` (cm) and `rotate` (degrees) of joints of their names. Times are frames of the
rates that Maya has names for, else seconds, in nine digits; values have seven. Turns of the head
are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.export.bonemotion import bone_controls, check_moves, rest_place, shape_names
from lipwright.export.keytext import check_controls, is_smooth, key_rows, number
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.keys import Floats, KeyedCurve, keyed

NODE: Final = "blendShape1"  # as Maya calls the first one of a scene
CENTIMETRES: Final = 100.0  # in a metre
UNITS: Final = {
    15.0: "game", 24.0: "film", 25.0: "pal", 30.0: "ntsc", 48.0: "show", 50.0: "palf",
    60.0: "ntscf",
}  # fmt: skip
"""frames a second to Maya's name of the time unit"""
SECONDS: Final = "sec"  # the time unit of all other rates
_ATTRIBUTE: Final = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_JOINED: Final = str.maketrans(" -.", "___")


@dataclass(frozen=True)
class MayaCurve:
    """A control as Maya has it."""

    node: str
    """a joint; empty for the node of the blendshapes"""
    attribute: str
    kind: str
    """unitless, linear (cm) or angular (degrees)"""
    curve: KeyedCurve
    """in Maya's units"""

    def inner(self, slopes: Floats) -> Floats:
        """Slopes of the curve in the units of Maya's tangents, which have radians for degrees."""
        return np.asarray(np.radians(slopes) if self.kind == "angular" else slopes)


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: nothing moves, or a name cannot be one of Maya.
    """
    check_names(path, performance)
    return [text_output(path, lambda: _lines(performance, options))]


def check_names(path: Path, performance: Performance) -> None:
    """Refuse a performance whose controls cannot be attributes of Maya.

    Raises:
        LipwrightError: nothing moves, or a name has other than letters, digits and underscores, or
            two are the same once spaces, points and hyphens are underscores.
    """
    check_controls(path, performance.clip, "Maya")
    check_moves(path, performance)
    bones = {bone.name: bone.name for bone, _ in bone_controls(performance).values()}
    seen: dict[str, str] = {}
    for name in (*shape_names(performance), *bones):
        attribute = name.translate(_JOINED)
        if not _ATTRIBUTE.fullmatch(attribute) or attribute in seen:
            why = f"is {seen[attribute]!r} to it too" if attribute in seen else "has other letters"
            raise LipwrightError(
                f"{path}: names in Maya have Latin letters, digits and underscores, and "
                f"{name[:40]!r} {why}; rename it in the rig"
            )
        seen[attribute] = name


def time_unit(fps: float) -> tuple[str, float]:
    """Maya's name of the time unit for clips of a rate, and how many of it are a second."""
    return (UNITS[fps], fps) if fps in UNITS else (SECONDS, 1.0)


def maya_curves(performance: Performance, error: float | None) -> Iterator[MayaCurve]:
    """The curves as Maya has them: blendshapes, then joints."""
    clip = performance.clip
    for name, curve in keyed(clip, error, shape_names(performance)).curves.items():
        yield MayaCurve("", name.translate(_JOINED), "unitless", curve)
    bones = () if performance.rig is None else performance.rig.bones
    for name, (bone, channel) in bone_controls(performance).items():
        node = bone.name.translate(_JOINED)
        axis = channel[1].upper()
        curve = keyed(clip, error, [name]).curves[name]
        if channel[0] == "r":
            yield MayaCurve(node, f"rotate{axis}", "angular", curve)
        else:
            rest = float(rest_place(bone, bones)["XYZ".index(axis)])
            yield MayaCurve(node, f"translate{axis}", "linear", _placed(curve, rest))


def _placed(curve: KeyedCurve, rest: float) -> KeyedCurve:
    """A translation from rest in m as a place in cm."""
    return KeyedCurve(
        curve.times,
        CENTIMETRES * (rest + curve.values),
        CENTIMETRES * curve.arriving,
        CENTIMETRES * curve.leaving,
    )


def _lines(performance: Performance, options: ExportOptions) -> Iterator[str]:
    clip = performance.clip
    unit, rate = time_unit(clip.fps)
    yield f"animVersion 1.1;\nmayaVersion 2018;\ntimeUnit {unit};\nlinearUnit cm;\n"
    yield f"angularUnit deg;\nstartTime 0;\nendTime {number(clip.duration * rate, 12)};\n"
    index: dict[str, int] = {}
    for part in maya_curves(performance, options.keys):
        node = part.node or options.node or NODE
        place = index[node] = index.get(node, -1) + 1
        group = part.attribute[:-1]
        attribute = f"{group}.{part.attribute}" if part.node else part.attribute
        yield f"anim {attribute} {part.attribute} {node} 0 0 {place};\nanimData {{\n"
        yield f"  input time;\n  output {part.kind};\n  weighted 0;\n"
        yield "  preInfinity constant;\n  postInfinity constant;\n  keys {\n"
        yield _keys(part, rate, options.keys is None)
        yield "  }\n}\n"


def _keys(part: MayaCurve, rate: float, linear: bool) -> str:
    curve = part.curve
    times = curve.times * rate
    if linear:
        return key_rows("    %.9g %.7g linear linear 1 1 0;\n", times, curve.values)
    before, after = (
        np.degrees(np.arctan(part.inner(slopes))) for slopes in (curve.arriving, curve.leaving)
    )
    form = "    %.9g %.7g fixed fixed %d 1 0 %.7g 1 %.7g 1;\n"
    return key_rows(form, times, curve.values, is_smooth(curve), before, after)
