"""Live2D Cubism motions, `NAME.motion3.json`, as Cubism Editor exports them, version 3.

The layout is that of Live2D's CubismSpecs, FileFormats/motion3.json: `Meta` with the duration in s,
fps and counts, and `Curves`, each with its target `Parameter`, the parameter's id and `Segments`, a
flat row of numbers: the first point (time in s, value), then for each segment its kind and points.
Kind 0 is a straight line with one point, kind 1 a cubic Bezier curve with two handles and the end.
Handles stand a third of the span off (`AreBeziersRestricted`). Times and values have five
decimals. A parameter that never changes has one straight segment, since players need one; eyes,
brows and angles that rest throughout are left out, so that other motions may move them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import HEAD_ANGLES
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.keys import KeyedCurve, keyed

VERSION: Final = 3
FADE: Final = 0.0  # s; lips must not fade in behind the sound
LINE, BEZIER = 0, 1
POINTS: Final = {LINE: 1, BEZIER: 3}
TURNS: Final = {
    "headYaw": ("ParamAngleX", 1.0),
    "headPitch": ("ParamAngleY", 1.0),
    "headRoll": ("ParamAngleZ", -1.0),
}
"""turn of the head to the standard parameter and its sign, in degrees; positive is to the right of
the screen (the character's left), and up: Live2D, Standard Parameter List"""
MOUTH: Final = "ParamMouth"
MOST_DEGREES: Final = 30.0  # either way, the same


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file."""
    clip = _with_angles(_moving(performance))
    return [text_output(path, lambda: _lines(clip, options.keys))]


def _moving(performance: Performance) -> Clip:
    """The clip without eyes, brows and turns that rest throughout: other motions may move them."""
    clip, rig = performance.clip, performance.rig
    if rig is None:
        return clip
    rest = {control.name: control.rest for control in rig.controls}
    return clip.select(
        name
        for name in clip.names
        if name.startswith(MOUTH) or (clip.curve(name) != rest.get(name, 0.0)).any()
    )


def _with_angles(clip: Clip) -> Clip:
    """The clip with turns of the head as parameters."""
    turned = {
        TURNS[name][0]: np.degrees(clip.curve(name) * TURNS[name][1]).clip(
            -MOST_DEGREES, MOST_DEGREES
        )
        for name in HEAD_ANGLES
        if name in clip.names
    }
    names = dict.fromkeys([name for name in clip.names if name not in HEAD_ANGLES] + [*turned])
    return clip.select(names).with_curves(turned) if turned else clip


def _lines(clip: Clip, error: float | None) -> Iterator[str]:
    keys = keyed(clip, error)
    kind = LINE if keys.linear else BEZIER
    end = max(keys.duration, 1 / clip.fps)
    segments = [max(len(curve) - 1, 1) for curve in keys.curves.values()]
    kinds = [kind if len(curve) > 1 else LINE for curve in keys.curves.values()]
    points = sum(1 + count * POINTS[each] for count, each in zip(segments, kinds, strict=True))
    meta = {
        "Duration": round(end, 5),
        "Fps": clip.fps,
        "Loop": False,
        "AreBeziersRestricted": True,
        "FadeInTime": FADE,
        "FadeOutTime": FADE,
        "CurveCount": len(keys.curves),
        "TotalSegmentCount": sum(segments),
        "TotalPointCount": points,
        "UserDataCount": 0,
        "TotalUserDataSize": 0,
    }
    yield f'{{\n  "Version": {VERSION},\n  "Meta": {json.dumps(meta)},\n  "Curves": [\n'
    last = len(keys.curves) - 1
    for index, (name, curve) in enumerate(keys.curves.items()):
        quoted = json.dumps(name, ensure_ascii=False)
        yield f'    {{"Target": "Parameter", "Id": {quoted}, "Segments": ['
        yield _segments(curve, kinds[index], end)
        yield "]}\n" if index == last else "]},\n"
    yield "  ]\n}\n"


def _segments(curve: KeyedCurve, kind: int, end: float) -> str:
    """The flat row of numbers, as text."""
    times, values = curve.times, curve.values + 0.0
    if len(curve) == 1:
        times, values = np.array([0.0, end]), np.repeat(values, 2)
    points = [times[1:], values[1:]]
    if kind == BEZIER:
        third = np.diff(times) / 3
        handles = [
            times[:-1] + third, values[:-1] + curve.leaving[:-1] * third,
            times[1:] - third, values[1:] - curve.arriving[1:] * third,
        ]  # fmt: skip
        points = handles + points
    form = f",{kind}" + ",%.5f,%.5f" * POINTS[kind]
    row = tuple(np.stack(points, axis=1).ravel().tolist())
    return f"{times[0]:.5f},{values[0]:.5f}" + form * (len(times) - 1) % row
