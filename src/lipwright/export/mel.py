"""Maya script (`.mel`) that puts the curves onto a blendShape node, with no plug-in or Python.

Commands (Maya documentation, `createNode`, `setAttr`, `connectAttr`, and scenes that Maya saved):
each control becomes a node `animCurveTU` (joints: `animCurveTL` in cm, `animCurveTA` in degrees)
whose `.ktv` are times and values, written in blocks as Maya ASCII scenes have them. `.tan 2` is
linear; with few keys `.tan 1` is fixed, and `.kix`, `.kiy`, `.kox`, `.koy` are the directions of
the tangents before and after each key: seconds and units, cm or radians, of length 1.

The script takes the node that the global string `$lipwright_node` names, else the selected
blendShape node, else that of the selected mesh; it prints which attributes the node lacks. Curves
that drove them before stay in the scene, cut off. Times are in the clip's own rate, or in seconds
where Maya has no name for that; the scene's unit is put back at the end. Times have nine digits,
values seven, directions six. Turns of the head are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.export.keytext import is_smooth, key_rows, number
from lipwright.export.maya import MayaCurve, check_names, maya_curves, time_unit
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.keys import Floats

BLOCK: Final = 250  # keys a command; Maya's own scenes stay near it
KINDS: Final = {"unitless": "animCurveTU", "linear": "animCurveTL", "angular": "animCurveTA"}
"""unit of a curve to the type of its node"""

_PROCEDURES: Final = """\
global string $lipwright_node;
global string $lipwright_curve;
global string $lipwright_missing[];
clear $lipwright_missing;

global proc string lipwright_find_node() {
    global string $lipwright_node;
    if ($lipwright_node != "") {
        if (!`objExists $lipwright_node`)
            error ("Lipwright: there is no node " + $lipwright_node);
        return $lipwright_node;
    }
    string $found[] = `ls -selection -type blendShape`;
    if (!size($found)) {
        string $chosen[] = `ls -selection`;
        if (size($chosen)) {
            string $history[] = `listHistory -pruneDagObjects true $chosen`;
            if (size($history))
                $found = `ls -type blendShape $history`;
        }
    }
    if (!size($found))
        error "Lipwright: select the blendShape node, or the mesh that it deforms";
    return $found[0];
}

global proc lipwright_begin(string $type, int $tangents) {
    global string $lipwright_curve;
    $lipwright_curve = `createNode -skipSelect $type`;
    setAttr ($lipwright_curve + ".tan") $tangents;
    setAttr ($lipwright_curve + ".wgt") 0;
}

global proc lipwright_end(string $node, string $attribute) {
    global string $lipwright_curve;
    global string $lipwright_missing[];
    string $plug = $node + "." + $attribute;
    if (!`objExists $plug`) {
        $lipwright_missing[size($lipwright_missing)] = $plug;
        delete $lipwright_curve;
        return;
    }
    if (catch(`connectAttr -force ($lipwright_curve + ".output") $plug`)) {
        $lipwright_missing[size($lipwright_missing)] = $plug;
        delete $lipwright_curve;
        return;
    }
}

"""
_REPORT: Final = """\
currentUnit -time $lipwright_unit -linear $lipwright_length -angle $lipwright_angle;
if (size($lipwright_missing))
    warning ("Lipwright: not there, or locked: " + stringArrayToString($lipwright_missing, ", "));
else
    print "Lipwright: all curves are set\\n";
"""


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: nothing moves, or a name cannot be one of Maya.
    """
    check_names(path, performance)
    return [text_output(path, lambda: _lines(performance, options))]


def _lines(performance: Performance, options: ExportOptions) -> Iterator[str]:
    clip = performance.clip
    unit, rate = time_unit(clip.fps)
    yield f"// Lipwright: {clip.duration:.3f} s at {number(clip.fps)} frames a second.\n"
    yield "// Select the blendShape node, or the mesh that it deforms, and run this script.\n"
    yield _PROCEDURES
    yield "string $lipwright_shapes = `lipwright_find_node`;\n"
    for name, flag in (("unit", "time"), ("length", "linear"), ("angle", "angle")):
        yield f"string $lipwright_{name} = `currentUnit -query -{flag}`;\n"
    yield f"currentUnit -time {unit} -linear cm -angle deg;\n"
    for part in maya_curves(performance, options.keys):
        yield f'lipwright_begin "{KINDS[part.kind]}" {2 if options.keys is None else 1};\n'
        yield _set("ktv", part.curve.times * rate, part.curve.values)
        if options.keys is not None and len(part.curve) > 1:
            yield _tangents(part)
        node = f'"{part.node}"' if part.node else "$lipwright_shapes"
        yield f'lipwright_end {node} "{part.attribute}";\n'
    yield _REPORT


def _tangents(part: MayaCurve) -> str:
    lines = _set("ktl", is_smooth(part.curve).astype(np.float64))
    for side, slopes in (("i", part.curve.arriving), ("o", part.curve.leaving)):
        scaled = part.inner(slopes)
        length = np.hypot(1, scaled)
        lines += _set(f"k{side}x", 1 / length) + _set(f"k{side}y", scaled / length)
    return lines


def _set(attribute: str, *columns: Floats) -> str:
    """Commands that set an array attribute of the curve in blocks."""
    count = len(columns[0])
    form = " %.9g %.7g" if len(columns) == 2 else " %.6g"
    lines = []
    for first in range(0, count, BLOCK):
        last = min(first + BLOCK, count) - 1
        numbers = key_rows(form, *(column[first : last + 1] for column in columns))
        place = f'($lipwright_curve + ".{attribute}[{first}:{last}]")'
        lines.append(f"setAttr -size {last - first + 1} {place}{numbers};\n")
    return "".join(lines)
