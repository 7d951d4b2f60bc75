"""The steps after stitching: valleys, constraints and speed (Xu et al. 2013, 2.2.1 to 2.2.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.values import Pair, Pose, constraint_key
from lipwright.curves import Floats

LEVEL: Final = 1e-9  # of a full pose; what differs by less is on one level


def maxima(curve: Floats) -> npt.NDArray[np.intp]:
    """Frames of the local maxima of a curve (T,), ends included; a level one has two."""
    moves = np.flatnonzero(np.abs(np.diff(curve)) > LEVEL)
    if not len(moves):
        return np.zeros(0, np.intp)
    rises = np.diff(curve)[moves] > 0
    # The level before move i runs from the end of the move before it.
    first = np.concatenate([[0], moves + 1])
    last = np.concatenate([moves, [len(curve) - 1]])
    tops = np.concatenate([[True], rises]) & np.concatenate([~rises, [True]])
    return np.unique(np.concatenate([first[tops], last[tops]]))


def without_valleys(curve: Floats, window: float) -> Floats:
    """The curve (T,) in which maxima at most `window` frames apart are joined by straight lines.

    Between two local maxima that are seen at once by a window of 2 t_w, the valley is filled
    (section 2.2.1, figure 8). Joining may leave a maximum below the line between its neighbours;
    it is done until there is none: a second time changes nothing.
    """
    filled = curve.copy()
    while True:
        tops = maxima(filled)
        near = np.flatnonzero(np.diff(tops) <= window + LEVEL)
        joined = False
        for one, other in zip(tops[near].tolist(), tops[near + 1].tolist(), strict=True):
            start, end = filled[one], filled[other]
            between = filled[one + 1 : other]
            if len(between) and between.min() < min(start, end) - LEVEL:
                between[:] = start + (end - start) * np.arange(1, other - one) / (other - one)
                joined = True
        if not joined:
            return filled


def constrained(
    values: Floats, poses: Sequence[Pose], constraints: Mapping[Pair, float], otherwise: float
) -> Floats:
    """The curves (T, K) in which no two poses exceed what they may reach together.

    Of two poses the one of less priority gives way: it ends at C - c_a, but not below rest
    (section 2.2.2; the paper's formula has a sign the wrong way round). Of equal ones the first
    stays. Poses are taken from the highest priority on, so that each gives way to what is final.

    Args:
        values: (T, K).
        poses: K of them.
        constraints: two poses, as `constraint_key` has them, to C.
        otherwise: C of all other pairs.
    """
    result = values.copy()
    highest = result.max(axis=0)
    order = sorted(range(len(poses)), key=lambda column: -poses[column].priority)
    for place, column in enumerate(order):
        for stronger in order[:place]:
            key = constraint_key(poses[column].name, poses[stronger].name)
            most = constraints.get(key, otherwise)
            if highest[column] + highest[stronger] > most:
                room = np.maximum(most - result[:, stronger], 0.0)
                np.minimum(result[:, column], room, out=result[:, column])
    return result
