"""Expressions for over speech: poses that ship, and those of files.

A pose is a JSON file of one object, canonical control (without its side: both sides) to weight, 0
to 1; it may stand in a field "pose" beside a "source". A moving expression is one of our own clips.
"""

from __future__ import annotations

import json
import math
import os
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import read_clip
from lipwright.formats.source import read_text
from lipwright.passes import pose_clip

EXPRESSIONS: Final = (
    "afraid", "angry", "contemptuous", "disgusted", "happy", "sad", "surprised", "thoughtful",
)  # fmt: skip
"""names of the expressions that ship"""

POSE: Final = "pose"  # the field of the weights, where others stand beside it
ABOUT: Final = ("name", "title", "source", "license")  # fields that may stand beside it


def load_expression(name: str | os.PathLike[str]) -> Clip:
    """An expression that ships, by name, or that of a file: a pose, or a clip in JSON or CSV.

    Returns:
        A clip of canonical controls, of one frame for a pose.

    Raises:
        LipwrightError: no such expression, lists those that ship; or the file cannot be used.
    """
    if str(name) in EXPRESSIONS:
        shipped = files("lipwright").joinpath("expressions", f"{name}.json")
        return pose_clip(json.loads(shipped.read_text("utf-8"))[POSE])
    path = Path(name)
    if path.suffix.lower() not in (".json", ".csv") or "\0" in str(name):
        raise LipwrightError(
            f"no expression {str(name)[:60]!r}; the expressions are: {', '.join(EXPRESSIONS)}, or "
            "name a .json file of a pose, or a clip in .json or .csv"
        )
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise LipwrightError(f"{path}: is a device or pipe; name a file of a pose or clip")
    pose = _pose_of(path) if path.suffix.lower() == ".json" else None
    try:
        clip = read_clip(path) if pose is None else pose_clip(pose)
        _check_controls(clip)
    except LipwrightError as error:
        text = str(error)
        raise LipwrightError(text if str(path) in text else f"{path}: {text}") from error
    return clip


def parse_expression(text: str) -> tuple[Clip, float]:
    """The expression and the amount of a text NAME, FILE, NAME=AMOUNT or FILE=AMOUNT.

    Raises:
        LipwrightError: as `load_expression`.
    """
    name, equals, number = text.rpartition("=")
    try:
        amount = float(number)
    except ValueError:
        return load_expression(text), 1.0
    return (load_expression(name), amount) if equals else (load_expression(text), 1.0)


def _pose_of(path: Path) -> dict[str, float] | None:
    """The weights of a pose's file; None where it is a clip, which has a format."""
    try:
        data: Any = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise LipwrightError(
            f"{path}:{error.lineno}:{error.colno}: {error.msg}; a pose is a JSON file"
        ) from error
    except RecursionError as error:
        raise LipwrightError(f"{path}: is nested too deeply for a pose; correct it") from error
    if not isinstance(data, dict):
        raise LipwrightError(f"{path}: is no object of controls and weights; correct it")
    if "format" in data:
        return None
    pose = data[POSE] if POSE in data and not set(data) - {POSE, *ABOUT} else data
    if not isinstance(pose, dict) or not pose:
        raise LipwrightError(f'{path}: has no weights; write such as {{"mouthSmile": 0.5}}')
    for control, weight in pose.items():
        number = isinstance(weight, int | float) and not isinstance(weight, bool)
        if not number or not math.isfinite(weight):
            raise LipwrightError(
                f"{path}: {control[:40]!r} is {str(weight)[:24]!r}, not a weight; correct it"
            )
    return pose


def _check_controls(clip: Clip) -> None:
    known = set(CANONICAL + HEAD_ANGLES)
    if unknown := [name for name in clip.names if name not in known]:
        raise LipwrightError(
            f"{unknown[0][:40]!r} is no canonical control; 'lipwright rigs show arkit' lists them"
        )
