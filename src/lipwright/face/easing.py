"""The smooth step that shapes, colours and shade are blended with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def smooth_step(low: float, high: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """0 below `low`, 1 above `high`, and a smooth cubic between; falls if `low` > `high`.

    The result has the shape of `x`.
    """
    share = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))
