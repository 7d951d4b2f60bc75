"""Maximum-likelihood parameter generation: the likeliest curves of a row of Gaussians.

Tokuda et al., "Speech parameter generation algorithms for HMM-based speech synthesis" (2000),
section 3.1: each frame has a Gaussian of a value, of its slope and of its bend; the curve that all
of them together find likeliest solves a linear system with five diagonals. SciPy solves it.
nnmnkwii has this function too, but ships no wheels.
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
    """
    if means.shape != precisions.shape or means.ndim != 3 or means.shape[1] != len(WINDOWS):
        raise ValueError(f"means {means.shape} and precisions {precisions.shape} are not (T, 3, C)")
    if not (precisions[:, 0] > 0).all() or (precisions[:, 1:] < 0).any():
        raise ValueError("a precision of a value is not above 0, or another is below 0")
    bands, right = _system(means, precisions)
    from scipy.linalg import solveh_banded

    curves = np.empty_like(right)
    for control in range(right.shape[1]):
        curves[:, control] = solveh_banded(
            np.ascontiguousarray(bands[:, :, control]), right[:, control],
            overwrite_ab=True, overwrite_b=True, lower=True, check_finite=False,
        )  # fmt: skip
    return curves


def _system(means: Values, precisions: Values) -> tuple[Values, Values]:
    """Diagonals (3, T, C), the main one first, and right side (T, C) of W'PW y = W'Pm."""
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
