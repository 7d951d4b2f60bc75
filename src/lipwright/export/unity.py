"""Unity animation clip (`.anim`), YAML as Unity writes it with "Force Text".

Layout (Unity manual, "Text-based scene files" and "YAML class ID reference"; clips that Unity
2018 and later saved): a document tagged `!u!74`, `AnimationClip`. `m_FloatCurves` has a curve a
blendshape: `attribute: blendShape.NAME`, `classID: 137` (SkinnedMeshRenderer), `path`, the names
of the objects from that of the Animator down to the renderer; keys have `time` in s, `value` in
percent (weights of 1 are 100), `inSlope` and `outSlope` in percent a second, of cubic Hermite
spans, and `tangentMode`: bit 0 broken, bits 1 to 4 the left and 5 to 8 the right mode (0 free,
2 linear). Bones of the rig are `m_PositionCurves` (m) and `m_RotationCurves` (quaternions), one key
a frame, where the clip has a control of that kind. Unity's axes are left-handed, so x is mirrored
as its importers of models do.

Unity makes `m_ClipBindingConstant` and `m_EditorCurves` itself from the curves when they are empty.
Turns of the head are left out. Numbers have seven digits, as many as Unity keeps; times 1 us.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.export.bonemotion import (
    BoneMotion,
    Floats,
    check_moves,
    moved_bones,
    scene_node,
    shape_names,
)
from lipwright.export.keytext import check_controls, is_smooth, key_rows, number
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.keys import KeyedClip, KeyedCurve, keyed

PERCENT: Final = 100.0  # of a Unity weight in a weight of 1
BROKEN: Final = 1  # in tangentMode, of a key whose sides have slopes of their own
LINEAR: Final = BROKEN | 2 << 1 | 2 << 5  # tangentMode
_PLAIN: Final = re.compile(r"[A-Za-z_][\w./-]*", re.ASCII)
_NOT_PLAIN: Final = frozenset({"null", "true", "false", "yes", "no", "on", "off", "y", "n"})

_HEAD: Final = """\
%YAML 1.1
%TAG !u! tag:unity3d.com,2011:
--- !u!74 &7400000
AnimationClip:
  m_ObjectHideFlags: 0
  m_CorrespondingSourceObject: {fileID: 0}
  m_PrefabInstance: {fileID: 0}
  m_PrefabAsset: {fileID: 0}
"""
_SETTINGS: Final = """\
  m_WrapMode: 0
  m_Bounds:
    m_Center: {x: 0, y: 0, z: 0}
    m_Extent: {x: 0, y: 0, z: 0}
  m_ClipBindingConstant:
    genericBindings: []
    pptrCurveMapping: []
  m_AnimationClipSettings:
    serializedVersion: 2
    m_AdditiveReferencePoseClip: {fileID: 0}
    m_AdditiveReferencePoseTime: 0
    m_StartTime: 0
"""
_TAIL: Final = """\
    m_OrientationOffsetY: 0
    m_Level: 0
    m_CycleOffset: 0
    m_HasAdditiveReferencePose: 0
    m_LoopTime: 0
    m_LoopBlend: 0
    m_LoopBlendOrientation: 0
    m_LoopBlendPositionY: 0
    m_LoopBlendPositionXZ: 0
    m_KeepOriginalOrientation: 0
    m_KeepOriginalPositionY: 1
    m_KeepOriginalPositionXZ: 0
    m_HeightFromFeet: 0
    m_Mirror: 0
  m_EditorCurves: []
  m_EulerEditorCurves: []
  m_HasGenericRootTransform: 0
  m_HasMotionFloatCurves: 0
  m_Events: []
"""
_CURVE: Final = "  - curve:\n      serializedVersion: 2\n      m_Curve:\n"
_CURVE_END: Final = "      m_PreInfinity: 2\n      m_PostInfinity: 2\n      m_RotationOrder: 4\n"


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: nothing moves, or a name has a control character.
    """
    check_controls(path, performance.clip, "a Unity clip")
    check_moves(path, performance)
    return [text_output(path, lambda: _lines(path.stem, performance, options))]


def _lines(title: str, performance: Performance, options: ExportOptions) -> Iterator[str]:
    clip = performance.clip
    bones = list(moved_bones(performance))
    yield f"{_HEAD}  m_Name: {yaml_text(title)}\n  serializedVersion: 6\n  m_Legacy: 0\n"
    yield "  m_Compressed: 0\n  m_UseHighQualityCurve: 1\n"
    yield from _section("m_RotationCurves", _turns(bones, clip.fps))
    yield "  m_CompressedRotationCurves: []\n  m_EulerCurves: []\n"
    yield from _section("m_PositionCurves", _places(bones, clip.fps))
    yield "  m_ScaleCurves: []\n"
    names = shape_names(performance)
    renderer = scene_node(options)
    shapes = keyed(clip, options.keys, names)
    yield from _section("m_FloatCurves", _shapes(shapes, renderer))
    yield f"  m_PPtrCurves: []\n  m_SampleRate: {number(clip.fps)}\n{_SETTINGS}"
    yield f"    m_StopTime: {clip.duration:.6f}\n{_TAIL}"


def _section(name: str, curves: Iterator[str]) -> Iterator[str]:
    empty = True
    for curve in curves:
        if empty:
            yield f"  {name}:\n"
        empty = False
        yield curve
    if empty:
        yield f"  {name}: []\n"


def _shapes(clip: KeyedClip, renderer: str) -> Iterator[str]:
    for name, curve in clip.curves.items():
        yield f"{_CURVE}{_float_keys(curve, clip.linear)}{_CURVE_END}"
        yield f"    attribute: {yaml_text(f'blendShape.{name}')}\n    path: {yaml_text(renderer)}\n"
        yield "    classID: 137\n    script: {fileID: 0}\n"


def _float_keys(curve: KeyedCurve, linear: bool) -> str:
    form = (
        "      - serializedVersion: 3\n        time: %.6f\n        value: %.7g\n"
        "        inSlope: %.7g\n        outSlope: %.7g\n        tangentMode: %d\n"
        "        weightedMode: 0\n        inWeight: 0.33333334\n        outWeight: 0.33333334\n"
    )
    columns = (PERCENT * c for c in (curve.values, curve.arriving, curve.leaving))
    modes = np.where(is_smooth(curve), 0, BROKEN)
    return key_rows(form, curve.times, *columns, np.full(len(curve), LINEAR) if linear else modes)


def _turns(bones: list[BoneMotion], fps: float) -> Iterator[str]:
    for bone in bones:
        if bone.turns is not None:
            yield _bone(bone, bone.turns * [1, -1, -1, 1], "xyzw", fps)


def _places(bones: list[BoneMotion], fps: float) -> Iterator[str]:
    for bone in bones:
        if bone.places is not None:
            yield _bone(bone, bone.places * [-1, 1, 1], "xyz", fps)


def _bone(bone: BoneMotion, values: Floats, axes: str, fps: float) -> str:
    """One key a frame of a bone's place or turn, joined by straight lines."""
    slopes = np.diff(values, axis=0) * fps
    still = np.zeros((1, len(axes)))
    arriving, leaving = np.concatenate([still, slopes]), np.concatenate([slopes, still])
    place = "{" + ", ".join(f"{axis}: %.7g" for axis in axes) + "}"
    third = "{" + ", ".join(f"{axis}: 0.33333334" for axis in axes) + "}"
    form = (
        f"      - serializedVersion: 3\n        time: %.6f\n        value: {place}\n"
        f"        inSlope: {place}\n        outSlope: {place}\n        tangentMode: 0\n"
        f"        weightedMode: 0\n        inWeight: {third}\n        outWeight: {third}\n"
    )
    columns: list[Floats] = [np.arange(len(values)) / fps]
    for table in (values, arriving, leaving):
        columns += list(table.T)
    keys = key_rows(form, *columns)
    return f"{_CURVE}{keys}{_CURVE_END}    path: {yaml_text(bone.path)}\n"


def yaml_text(text: str) -> str:
    """A YAML scalar that is read back as this text."""
    if _PLAIN.fullmatch(text) and text.casefold() not in _NOT_PLAIN:
        return text
    return json.dumps(text, ensure_ascii=False) if text else ""
