"""Frames in which the eyes are shut."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import EYES, distance
from lipwright.evaluate.lips import runs

# Upper and lower lid, three pairs of each eye, in the order of `EYES`.
LIDS: Final = (
    ((160, 144), (159, 145), (158, 153)),
    ((385, 380), (386, 374), (387, 373)),
)
# Shares of the open eye, between the two heaps of the minima on 110 GRID recordings: blinks have
# theirs under 0.55 (half of them under 0.15), looking down and narrowing the eyes over 0.6.
SHUT: Final = 0.5
CLOSING: Final = 0.65
OPEN_PERCENTILE: Final = 80  # of the frames around, eyes are open most of the time
AROUND: Final = 10.0  # s to either side in which the open eye is looked for


def find_blinks(landmarks: npt.NDArray[np.floating], fps: float) -> npt.NDArray[np.bool_]:
    """(T,), whether the eyes are shut, closing or opening, of landmarks (T, 478, 3).

    Compared with how far they are open otherwise; False where the face is lost.
    """
    openness = eye_openness(landmarks)
    known = np.flatnonzero(~np.isnan(openness))
    blinks = np.zeros(len(openness), bool)
    if not len(known):
        return blinks
    share = openness / _open_level(openness, fps)
    for first, stop in runs(share < CLOSING):
        blinks[first:stop] = share[first:stop].min() < SHUT
    return blinks


def eye_openness(landmarks: npt.NDArray[np.floating]) -> npt.NDArray[np.float64]:
    """(T,), the lids' gap over the eye's width, mean of both eyes; NaN where the face is lost."""
    ratios = []
    for lids, (inner, outer) in zip(LIDS, EYES, strict=True):
        gaps = [distance(landmarks, upper, lower) for upper, lower in lids]
        ratios.append(np.mean(gaps, axis=0) / distance(landmarks, inner, outer))
    return np.asarray(np.mean(ratios, axis=0))


def _open_level(openness: npt.NDArray[np.float64], fps: float) -> npt.NDArray[np.float64]:
    """(T,), how far the eyes are open around each frame, found once a second."""
    centres, levels = [], []
    for centre in range(0, len(openness), max(round(fps), 1)):
        near = openness[max(centre - round(AROUND * fps), 0) : centre + round(AROUND * fps) + 1]
        if not np.isnan(near).all():
            centres.append(centre)
            levels.append(float(np.nanpercentile(near, OPEN_PERCENTILE)))
    return np.interp(np.arange(len(openness)), centres, levels)
