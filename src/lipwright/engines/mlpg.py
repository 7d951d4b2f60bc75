"""Maximum-likelihood parameter generation: the likeliest curves of a row of Gaussians.

Tokuda et al., "Speech parameter generation algorithms for HMM-based speech synthesis" (2000),
section 3.1: each frame has a Gaussian of a value, of its slope and of its bend; the curve that all
of them together find likeliest solves a linear system with five diagonals.

The solver is our own: LAPACK's (scipy.linalg.solveh_banded) takes one control at a time and needs
twice as long; the tests compare them. nnmnkwii has parameter generation too, but no wheels.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

Values = npt.NDArray[np.float64]

WINDOWS: Final = ((0.0, 1.0, 0.0), (-0.5, 0.0, 0.5), (1.0, -2.0, 1.0))
"""weights of the frame before, the frame and the frame after, for value, slope and bend; those
of HTS (Zen et al. 2007)"""


def with_deltas(values: npt.ArrayLike) -> Values:
    """(T - 2, 3, C), value, slope and bend of all but the first and last frames of (T, C).

    Slopes are a frame, bends a frame squared.
    """
    curve = np.asarray(values, np.float64)
    before, here, after = curve[:-2], curve[1:-1], curve[2:]
    return np.stack([a * before + b * here + c * after for a, b, c in WINDOWS], axis=1)


def likeliest(means: Values, precisions: Values) -> Values:
    """(T, C), the curves that the Gaussians of T frames find likeliest.

    The first and last frames have no frame on one side; what is asked of their slope and bend does
    not count.

    Args:
        means: (T, 3, C), of value, slope and bend.
        precisions: (T, 3, C), 1 / variance, of values above 0, of slopes and bends 0 or more.

    Raises:
        ValueError: the shapes differ, or a value has no precision.
        LinAlgError: precisions are too far apart for arithmetic.
    """
    if means.shape != precisions.shape or means.ndim != 3 or means.shape[1] != len(WINDOWS):
        raise ValueError(f"means {means.shape} and precisions {precisions.shape} are not (T, 3, C)")
    if not (precisions[:, 0] > 0).all() or (precisions[:, 1:] < 0).any():
        raise ValueError("a precision of a value is not above 0, or another is below 0")
    return _solve(*_system(means, precisions))


def _system(means: Values, precisions: Values) -> tuple[Values, Values]:
    """Diagonals (3, T, C), the main one first, and right sides (T, C) of W'PW y = W'Pm."""
    count, _, controls = means.shape
    bands = np.zeros((3, count, controls))
    bands[0] = precisions[:, 0]
    right = precisions[:, 0] * means[:, 0]
    for order in (1, 2):
        weights = WINDOWS[order]
        weight = precisions[1:-1, order]
        asked = weight * means[1:-1, order]
        for i, one in enumerate(weights):
            rows = slice(i, i + len(weight))
            if one:
                right[rows] += one * asked
            for j in range(i, len(weights)):
                if one * weights[j]:
                    bands[j - i, rows] += (one * weights[j]) * weight
    return bands, right


def _solve(bands: Values, right: Values) -> Values:
    """(T, C), of C systems of five diagonals side by side, each symmetric: LDL' of all at once.

    Args:
        bands: (3, T, C), the main diagonal and the two beside it.
        right: (T, C).
    """
    count = len(right)
    scale, near, far = bands  # become D, and the two diagonals of L
    solved = right.copy()
    with np.errstate(all="ignore"):
        for t in range(count):
            if t >= 2:
                solved[t] -= far[t - 2] * solved[t - 2]
                scale[t] -= far[t - 2] ** 2 * scale[t - 2]
            if t >= 1:
                solved[t] -= near[t - 1] * solved[t - 1]
                step = near[t - 1] * scale[t - 1]
                scale[t] -= near[t - 1] * step
                near[t] -= far[t - 1] * step
            near[t] /= scale[t]
            far[t] /= scale[t]
        solved /= scale
        for t in range(count - 2, -1, -1):
            solved[t] -= near[t] * solved[t + 1]
            if t < count - 2:
                solved[t] -= far[t] * solved[t + 2]
    if not ((scale > 0).all() and np.isfinite(solved).all()):
        raise np.linalg.LinAlgError("precisions are too far apart")
    return solved
