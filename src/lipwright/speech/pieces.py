"""Pieces of a recording that are heard one after the other, cut where it is quiet."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.features import FRAME_RATE

_SHORTEST, _LONGEST = 4.0, 10.0  # s
_SMOOTH: Final = 9  # frames over which the level is averaged: a pause, not the closure of a stop


def cut(level: npt.NDArray[np.float64], active: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and stop frame of each piece of levels in dB (T,), inside what is `active` (T,)."""
    smooth = np.convolve(
        np.pad(level, _SMOOTH // 2, "edge"), np.full(_SMOOTH, 1 / _SMOOTH), "valid"
    )
    edges = np.flatnonzero(np.diff(np.concatenate([[False], active, [False]]).astype(np.int8)))
    pieces = []
    for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        while stop - start > _LONGEST * FRAME_RATE:
            low = start + round(_SHORTEST * FRAME_RATE)
            high = min(start + round(_LONGEST * FRAME_RATE), stop - round(_SHORTEST * FRAME_RATE))
            middle = low + int(smooth[low : max(high, low + 1)].argmin())
            pieces.append((start, middle))
            start = middle
        pieces.append((start, stop))
    return pieces
