"""Zero-phase smoothing of landmarks that keeps closures."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import aperture
from lipwright.evaluate.lips import LOUD_PERCENTILE, runs

Floats = npt.NDArray[np.float64]

__all__ = ["aperture", "low_pass", "runs", "smooth"]

CUTOFF: Final = 10.0  # Hz, where half of the power passes
DEEP: Final = 0.25  # of the loud aperture: a minimum that is lower by this than what is around it
AROUND: Final = 0.2  # s to either side in which it must be opened so far
FADE: Final = 0.02  # s to either side of a closure in which the raw landmarks fade out
_PART: Final = 32  # landmarks smoothed at once: in double precision an hour of all is 1.2 GB


def smooth(landmarks: npt.NDArray[np.floating], fps: float) -> npt.NDArray[np.float32]:
    """Landmarks (T, 478, 3) without jitter, without lag, and with their closures as they were.

    Where smoothing would open a deep minimum of the lips' aperture, that frame is kept as it is,
    and its neighbours within 20 ms partly; all else is smoothed.
    """
    smoothed = np.empty(landmarks.shape, np.float32)
    for first in range(0, landmarks.shape[1], _PART):
        part = slice(first, first + _PART)
        smoothed[:, part] = low_pass(landmarks[:, part], fps, CUTOFF)
    kept = _kept(aperture(landmarks), aperture(smoothed), fps)
    frames, share = np.flatnonzero(kept), kept[kept > 0, None, None]
    smoothed[frames] = share * landmarks[frames] + (1 - share) * smoothed[frames]
    return smoothed


def _kept(gaps: Floats, smoothed_gaps: Floats, fps: float) -> Floats:
    """(T,), the share 0 to 1 in which each frame is kept: 1 at deep minima that were opened."""
    weight = np.zeros(len(gaps))
    if not np.isfinite(gaps).any():
        return weight
    deep = DEEP * np.nanpercentile(gaps, LOUD_PERCENTILE)
    reach, fade = max(round(AROUND * fps), 1), FADE * fps
    for first, stop in runs(np.isfinite(gaps)):
        run = gaps[first:stop]
        padded = np.pad(run, 1, constant_values=np.inf)
        minima = np.flatnonzero((run <= padded[:-2]) & (run <= padded[2:]))
        for middle in minima:
            near = run[max(middle - reach, 0) : middle + reach + 1]
            is_opened = smoothed_gaps[first + middle] > run[middle]
            if not is_opened or near.max() - run[middle] < deep:
                continue
            distance = np.abs(np.arange(len(run)) - middle)
            weight[first:stop] = np.maximum(weight[first:stop], 1 - distance / max(fade, 1))
    return weight


def low_pass(values: npt.NDArray[np.floating], fps: float, cutoff: float) -> Floats:
    """Values (T, ...) without what moves faster than `cutoff` Hz; a Gaussian, so without lag.

    Each run of rows without NaN is smoothed by itself, held beyond its ends; rows with NaN stay.
    """
    from scipy.ndimage import gaussian_filter1d

    # |exp(-(2 pi f sigma)^2 / 2)|^2 = 1/2 at the cut-off.
    sigma = fps * np.sqrt(np.log(2)) / (2 * np.pi * cutoff)
    smoothed = np.array(values, np.float64)
    for first, stop in runs(np.isfinite(smoothed).reshape(len(smoothed), -1).all(axis=1)):
        smoothed[first:stop] = gaussian_filter1d(
            smoothed[first:stop], sigma, axis=0, mode="nearest"
        )
    return smoothed
