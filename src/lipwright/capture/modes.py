"""Principal modes of variation, by scikit-learn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import MissingExtraError

Floats = npt.NDArray[np.float32]
_STILL: Final = (
    1e-4  # range of a column, below all that a face does in eye distances or grey levels
)
_EXACT: Final = 1000  # columns up to which all modes are found, not only the first


@dataclass(frozen=True, eq=False)
class Modes:
    """The first modes of some rows, and the variance of all."""

    mean: Floats
    """(D,)"""
    modes: Floats
    """(n, D), orthonormal; the largest entry of each is positive"""
    sd: Floats
    """(n,), falling"""
    share: float
    """of the variance that these modes hold, 0 to 1"""
    variance: float
    """of the rows, all columns together"""


def find_modes(rows: npt.NDArray[Any], share: float, most: int) -> Modes:
    """The fewest modes that hold a share of the variance.

    The same rows give the same modes.

    Args:
        rows: (R, D); many columns of float32 may be overwritten, to save memory.
        share: 0 to 1.
        most: modes at most, whatever the share.

    Raises:
        MissingExtraError: scikit-learn is not installed.
        ValueError: the rows do not vary.
    """
    try:
        from sklearn.decomposition import PCA
    except ImportError as error:
        raise MissingExtraError("scikit-learn, which finds the modes,", "capture") from error
    rows = np.asarray(rows)
    limit = min(most, len(rows) - 1, rows.shape[1])
    if limit < 1 or not np.ptp(rows, axis=0).max() > _STILL:
        raise ValueError("shapes or pixels do not vary")
    is_small = rows.shape[1] <= _EXACT
    solver = "covariance_eigh" if is_small else "randomized"
    fitted = PCA(limit, svd_solver=solver, random_state=0, copy=is_small).fit(
        rows.astype(np.float64 if is_small else np.float32, copy=False)
    )
    shares = np.cumsum(fitted.explained_variance_ratio_)
    count = min(int(np.searchsorted(shares, share - 1e-9)) + 1, limit)
    modes = fitted.components_[:count]
    largest = modes[np.arange(count), np.abs(modes).argmax(axis=1)]
    sd = np.sqrt(fitted.explained_variance_[:count])
    kept = sd > 1e-6 * sd[0]  # of rows without noise the last modes are rounding
    return Modes(
        mean=np.asarray(fitted.mean_, np.float32),
        modes=np.asarray(modes * np.sign(largest)[:, None], np.float32)[kept],
        sd=np.asarray(sd, np.float32)[kept],
        share=float(shares[count - 1]),
        variance=float(fitted.explained_variance_[0] / fitted.explained_variance_ratio_[0]),
    )
