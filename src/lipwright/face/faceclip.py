"""Parameters of a reference face as the curves of a clip, and back.

A control is a mode, numbered from 1: `joint1`, or `shape1`, `inner1`, `outer1`. Its value counts
standard deviations, so that 0 is the mean face and most of speech lies between -3 and 3.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.face.reference import PARTS, FaceParameters, Kind, ReferenceFace

KINDS: Final[tuple[Kind, ...]] = ("joint", *PARTS)
_CONTROL: Final = re.compile(r"(joint|shape|inner|outer)([1-9][0-9]*)")


def control_names(face: ReferenceFace, kind: Kind) -> tuple[str, ...]:
    """The names of a kind of modes."""
    return tuple(f"{kind}{number}" for number in range(1, len(face.sd(kind)) + 1))


def parameters_to_clip(
    face: ReferenceFace, parameters: FaceParameters, fps: float, *, joint: bool = True
) -> Clip:
    """The curves of parameters (T, ...), as joint modes or as those of shape and appearance.

    Raises:
        ValueError: a parameter is not finite, or fps is out of range.
    """
    kinds: tuple[Kind, ...] = ("joint",) if joint else PARTS
    values: list[npt.NDArray[np.float32]] = [
        (face.join(parameters) if kind == "joint" else getattr(parameters, kind)) / face.sd(kind)
        for kind in kinds
    ]
    names = tuple(name for kind in kinds for name in control_names(face, kind))
    return Clip(names, fps, np.concatenate(values, axis=1))


def clip_to_parameters(face: ReferenceFace, clip: Clip) -> FaceParameters:
    """The parameters (T, ...) of curves; modes that the clip lacks are at the mean.

    Raises:
        LipwrightError: the clip has controls that are no modes of this face, or joint modes beside
            others.
    """
    modes = {kind: dict.fromkeys(control_names(face, kind)) for kind in KINDS}
    for name in clip.names:
        match = _CONTROL.fullmatch(name)
        if match is None or name not in modes[_kind(match[1])]:
            sizes = ", ".join(f"{kind}1 to {kind}{len(modes[kind])}" for kind in KINDS)
            raise LipwrightError(f"no mode {name!r} in this reference face; it has {sizes}")
    used = {kind for kind in KINDS if any(name in modes[kind] for name in clip.names)}
    if "joint" in used and len(used) > 1:
        raise LipwrightError("the clip has joint modes beside others; keep either")
    found = {kind: clip.select(modes[kind]).values * face.sd(kind) for kind in KINDS}
    if "joint" in used:
        return face.split(found["joint"])
    return FaceParameters(found["shape"], found["inner"], found["outer"])


def _kind(text: str) -> Kind:
    return next(kind for kind in KINDS if kind == text)
