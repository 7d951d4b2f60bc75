"""The smooth curve that control points make."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.values import Points
from lipwright.curves import Floats

DEGREE: Final = 3
SAMPLES: Final = 65  # of a pair's curve; a pair of 0.3 s has one every 5 ms
PARAMETERS: Final = 4 * (SAMPLES - 1) + 1  # of the spline, before it is sampled evenly in time


@lru_cache(maxsize=64)
def basis(points: int, parameters: int = PARAMETERS) -> Floats:
    """(parameters, points), the clamped uniform B-spline basis at even parameters from 0 to 1.

    The degree is 3, or less than the number of points (Cox and de Boor's recursion).
    """
    degree = min(DEGREE, points - 1)
    spans = points - degree
    knots = np.concatenate([np.zeros(degree), np.linspace(0, 1, spans + 1), np.ones(degree)])
    at = np.linspace(0, 1, parameters)[:, None]
    inside = np.minimum((at * spans).astype(int), spans - 1) + degree  # the last span is closed
    table = (inside == np.arange(len(knots) - 1)).astype(np.float64)
    for order in range(1, degree + 1):
        lengths = knots[order:] - knots[:-order]
        share = np.divide(at - knots[:-order], lengths, where=lengths > 0,
                          out=np.zeros((parameters, len(lengths))))  # fmt: skip
        table = share[:, :-1] * table[:, :-1] + (1 - share[:, 1:]) * table[:, 1:]
    table.setflags(write=False)
    return table


def dense(points: Points, samples: int = SAMPLES) -> Floats:
    """(samples,), the curve at even normalised times from 0 to 1.

    The points are the control polygon of a clamped cubic B-spline (Xu et al. 2013, section 2.1.2),
    in time as in value: the curve begins at the first and ends at the last point, stays within
    what they enclose, and is nowhere steeper than their polygon. Before the first and after the
    last point it keeps their values.
    """
    table = basis(len(points)) @ np.asarray(points, np.float64)
    times = np.maximum.accumulate(table[:, 0])
    return np.interp(np.linspace(0, 1, samples), times, table[:, 1])


def between(place: Floats) -> tuple[npt.NDArray[np.int64], Floats]:
    """Where normalised times (n,) lie among the samples of a curve.

    Returns:
        (n,), the sample before each, below SAMPLES - 1; and (n, 1), the share of the one after it.
    """
    even = np.clip(place, 0, 1) * (SAMPLES - 1)
    low = np.minimum(even.astype(np.int64), SAMPLES - 2)
    return low, (even - low)[:, None]
