"""Sampled curves: what may be done to their slopes."""

from __future__ import annotations

from collections.abc import Collection
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
