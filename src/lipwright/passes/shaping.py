"""Passes that know nothing of phones: intensity, smoothing, and limits of speed and range."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import GROUPS
from lipwright.curves import limited
from lipwright.errors import LipwrightError
from lipwright.passes.kinds import Pass
from lipwright.track import PhoneTrack

MAX_INTENSITY = 3.0
CEILING_KNEE = 0.8  # where a scaled control begins to bend towards its full range
SPEED_LIMIT = 15.0  # a second, full ranges; Xu et al. 2013, section 2.2.3
SMOOTHING = 0.012  # s, standard deviation; removes corners, keeps an 80 ms closure


def intensity(amount: float) -> Pass:
    """Scale the motion of jaw and lips: 0.5 mumbles, 1 changes nothing, 1.5 over-articulates.

    What would pass the full range bends towards it instead of being cut off, and more is never
    less: a control that is over the knee already bends from where it is. Closures and the
    tongue are made by later passes and stay as they are.

    Raises:
        LipwrightError: the amount is not from 0 to 3.
    """
    if not 0 <= amount <= MAX_INTENSITY:
        raise LipwrightError(f"intensity is {amount}; give a number from 0 to {MAX_INTENSITY:.0f}")

    def scale(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        if amount == 1:
            return clip
        values = clip.values.copy()
        columns = [clip.column(n) for n in GROUPS["jaw"] + GROUPS["lips"] if n in clip.names]
        moved = values[:, columns]
        knee = np.clip(moved, CEILING_KNEE, 1) if amount > 1 else 1.0
        values[:, columns] = soft_ceiling(amount * moved, knee)
        return clip.with_values(values)

    return scale


def soft_ceiling(
    values: npt.NDArray[np.float32], knee: npt.ArrayLike = CEILING_KNEE
) -> npt.NDArray[np.float32]:
    """Values up to `knee` (one, or one a value) as they are; above it they approach 1."""
    bend = np.asarray(knee, np.float64)
    room = np.maximum(1 - bend, 1e-9)
    bent = bend + room * (1 - np.exp(-np.maximum(values - bend, 0) / room))
    return np.where(values > bend, bent, values).astype(np.float32)


def smooth(sigma: float = SMOOTHING) -> Pass:
    """Smooth every control with a Gaussian of `sigma` s around each frame: nothing is delayed.

    Raises:
        LipwrightError: sigma is negative or endless.
    """
    if not 0 <= sigma < math.inf:
        raise LipwrightError(f"smoothing is {sigma} s; give 0 or more")

    def filtered(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        reach = round(3 * sigma * clip.fps)
        if reach == 0:
            return clip
        steps = np.arange(-reach, reach + 1) / (sigma * clip.fps)
        weights = np.exp(-(steps**2) / 2)
        weights /= weights.sum()
        padded = np.pad(clip.values.astype(np.float64), ((reach, reach), (0, 0)), mode="edge")
        moving = np.flatnonzero(np.ptp(clip.values, axis=0) > 0)
        values = clip.values.copy()
        for column in moving:
            values[:, column] = np.convolve(padded[:, column], weights, mode="valid")
        return clip.with_values(values)

    return filtered


# Controls that shut the mouth: where they must slow down, they start earlier rather than reach
# less, or a closure would be lost.
CLOSERS: Final = frozenset(
    ("mouthClose", "mouthPressLeft", "mouthPressRight", "mouthRollLower", "mouthRollUpper")
)


def speed_limit(per_second: float = SPEED_LIMIT, closers: Collection[str] = CLOSERS) -> Pass:
    """Let no control change faster than `per_second` full ranges a second.

    Peaks of controls that open the face are lowered, peaks of `closers` are widened; neither is
    delayed.

    Raises:
        LipwrightError: the limit is not above 0.
    """
    if not per_second > 0:
        raise LipwrightError(f"the speed limit is {per_second}; give a number above 0")

    def slow(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        shut = [column for column, name in enumerate(clip.names) if name in closers]
        return clip.with_values(
            limited(clip.values.astype(np.float64), per_second / clip.fps, shut)
        )

    return slow


def limit(low: float = 0.0, high: float = 1.0) -> Pass:
    """Keep every control within its range."""

    def bounded(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        return clip.with_values(np.clip(clip.values, low, high))

    return bounded
