"""Passes over finished speech that never open a closure: an expression, and guarded passes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, GROUPS, HEAD_ANGLES, both_sides
from lipwright.errors import LipwrightError
from lipwright.passes.kinds import Floats, Pass, sides_of
from lipwright.passes.openings import OPENINGS, gaps, lips_held, shut_again
from lipwright.passes.resting import speech_share
from lipwright.track import PhoneTrack

MOST: Final = 2.0  # times an expression; more has no meaning on a face
IN_SPEECH: Final = 0.5  # share of an expression's mouth opening that is left while speech needs it
SETTLING: Final = 0.5  # s before and after speech in which the mouth takes on the expression
ROUNDING: Final = 0.6  # share of a wide or turned mouth that gives way to fully rounded lips

CORNERS: Final = frozenset(
    both for name in ("mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch", "cheekPuff")
    for both in (both_sides(name) if name != "cheekPuff" else (name,))
) | {"mouthLeft", "mouthRight"}  # fmt: skip
"""what shapes the mouth's corners and cheeks, and hardly opens it: kept in speech"""

MOUTH: Final = frozenset(
    name for name, row in OPENINGS.items() if max(map(abs, row)) > 0.01 and name not in CORNERS
) | set(GROUPS["tongue"])  # fmt: skip
"""what opens and shuts the mouth, and the tongue: speech comes first"""

_WIDE: Final = frozenset(
    name for name in CORNERS if name.startswith(("mouthSmile", "mouthDimple", "mouthStretch"))
)


def expression(layer: Clip | Mapping[str, float], amount: float = 1.0) -> Pass:
    """Lay an expression over speech: a pose, or a clip that moves.

    Upper face, cheeks and mouth corners show throughout; corners that widen the mouth give way to
    rounded lips. What opens or shuts the mouth shows in full where nothing is said, half of it in
    speech, and none of it where speech shuts the lips or holds one to the teeth: there the
    aperture stays what speech made of it. What corners take of the aperture of speech, the jaw
    gives back. The expression's e adds to the speech's s as s + e - s e, which never passes 1.

    Args:
        layer: canonical control, with or without its side, to weight, 0 to 1; or a clip of
            canonical controls, from the same first frame on. A shorter clip holds its last frame.
            Head angles of a clip add to those of the speech.
        amount: of the expression, 0 to 2; weights end at 1.

    Raises:
        LipwrightError: the amount or a weight is out of range, or a control is no canonical one.
    """
    if not 0 <= amount <= MOST:
        raise LipwrightError(f"the expression's amount is {amount:g}; give a number from 0 to 2")
    moving = layer if isinstance(layer, Clip) else pose_clip(layer)
    _check_names(moving.names)

    def show(clip: Clip, track: PhoneTrack) -> Clip:
        if amount == 0:
            return clip
        if not set(clip.names) & set(CANONICAL):
            raise LipwrightError(
                "an expression moves canonical controls, and this clip has none; lay it over "
                "speech before retargeting"
            )
        clip = _with_columns(clip, moving.names)
        speech = clip.values.astype(np.float64)
        added = np.zeros_like(speech)
        at = moving.at(clip.times).astype(np.float64)
        for column, name in enumerate(moving.names):
            added[:, clip.column(name)] = amount * at[:, column]
        return clip.with_values(_layered(clip, track, speech, added))

    return show


def pose_clip(pose: Mapping[str, float]) -> Clip:
    """A clip of one frame that holds a pose: control, with or without its side, to weight.

    Raises:
        LipwrightError: a control is no canonical one, or a weight is not from 0 to 1.
    """
    weights: dict[str, float] = {}
    for name, weight in pose.items():
        _check_names(sides := sides_of(name) or (name,))
        if not (math.isfinite(weight) and 0 <= weight <= 1):
            raise LipwrightError(
                f"the expression's {name} is {weight:g}; give a weight from 0 to 1"
            )
        weights.update(dict.fromkeys(sides, float(weight)))
    return Clip(tuple(weights), 1.0, np.array([list(weights.values())], np.float32))


def _check_names(names: tuple[str, ...]) -> None:
    unknown = [name for name in names if name not in CANONICAL + HEAD_ANGLES]
    if unknown:
        raise LipwrightError(
            f"the expression moves {unknown[0][:40]!r}, which is no canonical control; 'lipwright "
            "rigs show arkit' lists them"
        )


def _with_columns(clip: Clip, names: tuple[str, ...]) -> Clip:
    """The clip with columns at rest for what it lacks."""
    missing = tuple(name for name in names if name not in clip.names)
    return clip.select(clip.names + missing) if missing else clip


def _layered(clip: Clip, track: PhoneTrack, speech: Floats, added: Floats) -> Floats:
    """Speech (T, C) with what an expression adds (T, C)."""
    held = lips_held(clip, track)
    spoken = speech_share(track, clip.times, SETTLING, SETTLING)
    is_mouth, is_wide, is_angle = (
        np.array([name in kind for name in clip.names]) for kind in (MOUTH, _WIDE, HEAD_ANGLES)
    )
    rounded = clip.select(("mouthPucker", "mouthFunnel")).values.sum(axis=1).clip(0, 1)
    mouth = (1 - (1 - IN_SPEECH) * spoken) * (1 - held)
    shown = np.where(is_mouth, mouth[:, None], 1.0)
    shown *= np.where(is_wide, 1 - ROUNDING * rounded[:, None], 1.0)
    weights = shown * added.clip(0, 1) * (1 - speech.clip(0, 1))
    added = np.where(is_angle, added, weights)
    more = gaps(clip.with_values(added))
    return shut_again(speech + added, clip.names, more, held, spoken)


def closures_kept(step: Pass) -> Pass:
    """The pass `step`, and lips that stay shut where speech shuts them or holds one to the teeth.

    For passes that come when all closures are made. What they open there, `mouthClose` shuts.
    """

    def guarded(clip: Clip, track: PhoneTrack) -> Clip:
        after = step(clip, track)
        if after is clip:
            return clip
        more = gaps(after) - np.maximum(gaps(clip), 0)
        nothing = np.zeros(len(clip))
        values = after.values.astype(np.float64)
        held = lips_held(clip, track)
        return after.with_values(shut_again(values, after.names, more, held, nothing))

    return guarded
