"""A phone track as arrays without an end: silence lies before and after it for ever."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

CODES: Final = MappingProxyType({symbol: code for code, symbol in enumerate(PHONES)})
"""symbol to its row in the phone table"""

# s; a frame this much before an edge is after it: times such as 3 / 25 and 0.12 differ in their
# last digits, and edges often lie on frames.
ROUNDING: Final = 1e-6


@dataclass(frozen=True, eq=False)
class Timeline:
    """Q phones in turn; silences that follow each other, and those outside, are one."""

    codes: Indices
    """(Q,), rows of the phone table; the first and the last are silence"""
    starts: Floats
    """(Q,), s, rising; the first is minus infinity"""

    @property
    def ends(self) -> Floats:
        """(Q,), s, rising; the last is infinity."""
        return np.append(self.starts[1:], np.inf)

    def at(self, times: npt.ArrayLike) -> Indices:
        """(T,), which of the Q phones is said at `times` (T,) in s."""
        found = np.searchsorted(self.starts, np.asarray(times, np.float64) + ROUNDING, "right")
        return np.asarray(found - 1, np.int64)


@lru_cache(maxsize=16)
def timeline(track: PhoneTrack) -> Timeline:
    """The timeline of a track; a track is never changed, so it is made once for each."""
    silence = CODES[SILENCE]
    codes = np.array([silence, *(CODES[phone] for phone in track.phones), silence], np.int64)
    starts = np.concatenate(([-np.inf], track.edges))
    pause = (codes[1:] == silence) & (codes[:-1] == silence)
    first = np.append(True, ~pause)  # silence after silence begins nothing
    codes, starts = codes[first], starts[first]
    codes.setflags(write=False)
    starts.setflags(write=False)
    return Timeline(codes, starts)
