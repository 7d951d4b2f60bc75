"""Pieces of a recording that are heard one after the other, cut where it is quiet."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.features import FRAME_RATE

# The network's work grows with the square of a piece's length, and it hears worse in short ones:
# of the twenty sentences of hibari in bench/listening.py, 17 % of the phones were wrong in pieces
# of 4 to 10 s, 23 % in those of 1 to 2.5 s.
_SHORTEST, _LONGEST = 4.0, 10.0  # s
_SMOOTH: Final = 9  # frames over which the level is averaged: a pause, not the closure of a stop


def cut(level: npt.NDArray[np.float64], active: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and stop frame of each piece of levels in dB (T,), inside what is `active` (T,)."""
    padded = np.pad(level, _SMOOTH // 2, "edge")
    smooth = np.convolve(padded, np.full(_SMOOTH, 1 / _SMOOTH), "valid")
    edges = np.flatnonzero(np.diff(np.concatenate([[False], active, [False]]).astype(np.int8)))
    pieces = []
    for first, stop in edges.reshape(-1, 2).tolist():
        start = first
        while stop - start > _LONGEST * FRAME_RATE:
            low = start + round(_SHORTEST * FRAME_RATE)
            high = min(start + round(_LONGEST * FRAME_RATE), stop - round(_SHORTEST * FRAME_RATE))
            middle = low + int(smooth[low:high].argmin())
            pieces.append((start, middle))
            start = middle
        pieces.append((start, stop))
    return pieces
