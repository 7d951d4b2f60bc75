"""Godot 4 animation (`.tres`), a text resource of the type Animation, format 3.

Layout (Godot documentation, "TSCN file format", and the class Animation of Godot 4): a header
`[gd_resource type="Animation" format=3]`, a section `[resource]` with `length` and `step` in s and
the fields `type`, `path`, `interp` (1 is linear) and `keys` of each track, `tracks/N/...`. A
`blend_shape` track of the path `NODE:NAME` has the keys `time, transition, weight`, joined by
straight lines. With few keys (`--keys`) it is a `bezier` track of `NODE:blend_shapes/NAME`, whose
keys are `times` and `points`: the weight, then the handles before and after it as time and weight
relative to the key. NODE is that of a MeshInstance3D below the root node of the AnimationPlayer.

Bones of the rig are `position_3d` (m) and `rotation_3d` (quaternion x, y, z, w) tracks of
`Skeleton3D:NAME`, a key a frame, where the clip has a control of that kind. Turns of the head are
left out. Godot keeps times and weights in floats of 24 bits; here they have 1 us and seven digits,
points of `bezier` tracks six.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.export.bonemotion import (
    Floats,
    check_moves,
    moved_bones,
    scene_node,
    shape_names,
)
from lipwright.export.keytext import check_controls, is_smooth, key_rows, number
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.keys import KeyedCurve, keyed

SKELETON: Final = "Skeleton3D"  # the node, as Godot's importers call it
SHORTEST: Final = 0.001  # s, the least length of an animation in Godot
FREE: Final = 0  # a mode of handles
BALANCED: Final = 2  # the same, of handles that stay in a line
FORBIDDEN: Final = ":"  # it parts the names of a path


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: nothing moves, or a name has a control character or a colon.
    """
    check_controls(path, performance.clip, "a Godot animation", FORBIDDEN)
    check_moves(path, performance)
    return [text_output(path, lambda: _lines(path.stem, performance, options))]


def _lines(title: str, performance: Performance, options: ExportOptions) -> Iterator[str]:
    clip = performance.clip
    length = max(clip.duration, SHORTEST)
    yield f'[gd_resource type="Animation" format=3]\n\n[resource]\nresource_name = {_text(title)}\n'
    yield f"length = {_float(length)}\nstep = {_float(1 / clip.fps)}\n"
    for index, (kind, path, keys) in enumerate(_tracks(performance, options)):
        track = f"tracks/{index}"
        yield f'{track}/type = "{kind}"\n{track}/imported = false\n{track}/enabled = true\n'
        yield f"{track}/path = NodePath({_text(path)})\n"
        yield f"{track}/interp = 1\n{track}/loop_wrap = true\n{track}/keys = {keys}\n"


def _tracks(performance: Performance, options: ExportOptions) -> Iterator[tuple[str, str, str]]:
    """Type, path and keys of each track."""
    node = scene_node(options)
    shapes = keyed(performance.clip, options.keys, shape_names(performance))
    for name, curve in shapes.curves.items():
        if shapes.linear:
            keys = _packed(key_rows("%.6f, 1, %.7g, ", curve.times, curve.values))
            yield "blend_shape", f"{node}:{name}", keys
        else:
            yield "bezier", f"{node}:blend_shapes/{name}", _bezier_keys(curve)
    for bone in moved_bones(performance):
        path = f"{SKELETON}:{bone.name}"
        if bone.places is not None:
            yield "position_3d", path, _bone_keys(bone.places, performance.clip.fps)
        if bone.turns is not None:
            yield "rotation_3d", path, _bone_keys(bone.turns, performance.clip.fps)


def _bezier_keys(curve: KeyedCurve) -> str:
    """The keys with handles a third of the way to their neighbours."""
    third = np.diff(curve.times, prepend=curve.times[0], append=curve.times[-1]) / 3
    before, after = third[:-1], third[1:]
    points = key_rows(
        "%.6g, %.6g, %.6g, %.6g, %.6g, ",
        curve.values, -before, -before * curve.arriving, after, after * curve.leaving,
    )  # fmt: skip
    modes = key_rows("%d, ", np.where(is_smooth(curve), BALANCED, FREE)).removesuffix(", ")
    return (
        f'{{\n"handle_modes": PackedInt32Array({modes}),\n"points": {_packed(points)},\n'
        f'"times": {_packed(key_rows("%.6f, ", curve.times))}\n}}'
    )


def _bone_keys(values: Floats, fps: float) -> str:
    form = "%.6f, 1, " + "%.7g, " * values.shape[1]
    return _packed(key_rows(form, np.arange(len(values)) / fps, *values.T))


def _packed(numbers: str) -> str:
    return f"PackedFloat32Array({numbers.removesuffix(', ')})"


def _float(value: float) -> str:
    """A number that Godot does not take for a whole one."""
    text = number(value, 9)
    return text if {".", "e"} & set(text) else f"{text}.0"


def _text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
