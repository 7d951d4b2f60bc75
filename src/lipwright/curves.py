"""Sampled curves: what may be done to their slopes, and the Bezier curves that ease."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

ROUNDING: Final = 1e-9  # of a full range; more than the ramps below round in an hour


def lowered_to_slope(values: Floats, step: float) -> Floats:
    """The highest curves under `values` that change by at most `step` from frame to frame.

    Peaks that are reached too quickly are lowered; nothing is delayed.

    Args:
        values: (T,) or (T, C).
        step: at least 0.
    """
    ramp = step * np.arange(len(values), dtype=np.float64)
    ramp = ramp.reshape(-1, *[1] * (values.ndim - 1))
    forward = np.minimum.accumulate(values - ramp) + ramp
    reverse = np.minimum.accumulate((values - ramp[::-1])[::-1])[::-1] + ramp[::-1]
    lowered = np.minimum(forward, reverse)
    # What is slow enough stays as it is, to the last digit.
    return np.where(values - lowered > ROUNDING, lowered, values)


def widened_to_slope(values: Floats, step: float) -> Floats:
    """The lowest curves over `values` that change by at most `step` from frame to frame.

    Peaks keep their height and begin earlier and end later, as closures must.
    """
    return -lowered_to_slope(-values, step)


def limited(values: Floats, step: float, widen: Collection[int] = ()) -> Floats:
    """The curves (T, K), none of which changes by more than `step` from frame to frame.

    Columns in `widen` keep their peaks and start earlier; peaks of the others are lowered.
    """
    result = values.copy()
    fast = np.abs(np.diff(values, axis=0)).max(axis=0, initial=0) > step
    widened = np.isin(np.arange(values.shape[1]), list(widen))
    if (lower := fast & ~widened).any():
        result[:, lower] = lowered_to_slope(values[:, lower], step)
    if (wider := fast & widened).any():
        result[:, wider] = widened_to_slope(values[:, wider], step)
    return result


def bezier_ease(x: npt.ArrayLike, first: float, second: float) -> Floats:
    """A cubic Bezier curve from (0, 0) to (1, 1) that is flat at both ends.

    Args:
        x: of any shape; below 0 counts as 0, above 1 as 1.
        first: x of the first control point, whose y is 0; 0 to 1.
        second: x of the second one, whose y is 1; 0 to 1.

    Returns:
        y of the shape of `x`, 0 to 1, right to 1e-5.
    """
    return np.interp(np.asarray(x, np.float64), *_bezier_table(first, second))


@cache
def _bezier_table(first: float, second: float) -> tuple[Floats, Floats]:
    t = np.linspace(0, 1, 257)
    x = 3 * first * (1 - t) ** 2 * t + 3 * second * (1 - t) * t**2 + t**3
    y = 3 * (1 - t) * t**2 + t**3
    return x, y
