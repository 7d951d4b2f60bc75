"""How long phones last and where in them a frame lies: numbers of our own network."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.features.timeline import CODES, ROUNDING, Floats, Timeline
from lipwright.phones import SILENCE

SIGHT: Final = 0.5  # s; no number depends on what is said further away from its frame
SHORTEST: Final = 0.01  # s, under the logarithm

TIMING: Final[tuple[str, ...]] = (
    "position in the phone",  # 0 at its start to 1 at its end
    "log duration of the phone",  # log s, of what lies in sight
    "log duration of the phone before",
    "log duration of the phone after",
    "seconds since the phone's start",  # at most SIGHT
    "seconds to the phone's end",
    "log phones a second",  # log(1 + phones that start in sight)
)
"""the columns of one frame"""


def _log(seconds: Floats) -> Floats:
    return np.log(np.maximum(seconds, SHORTEST))


def timing(line: Timeline, times: Floats) -> npt.NDArray[np.float32]:
    """(T, 7), the columns of TIMING at `times` (T,) in s, seen from half a second around each."""
    here = line.at(times)
    first, last = times - SIGHT, times + SIGHT
    before, after = np.maximum(here - 1, 0), np.minimum(here + 1, len(line.codes) - 1)
    starts, ends = line.starts, line.ends
    since = np.clip(times - starts[here], 0, SIGHT)
    left = np.clip(ends[here] - times, 0, SIGHT)
    duration = np.maximum(since + left, SHORTEST)
    earlier = np.where(here > 0, starts[here] - np.maximum(starts[before], first), 0)
    later = np.where(here < after, np.minimum(ends[after], last) - ends[here], 0)
    spoken = starts[line.codes != CODES[SILENCE]]
    seen = np.searchsorted(spoken, np.stack((first, last)) + ROUNDING, "right")
    rate = np.log1p((seen[1] - seen[0]) / (2 * SIGHT))
    columns = (since / duration, _log(duration), _log(earlier), _log(later), since, left, rate)
    return np.stack(columns, axis=1).astype(np.float32)
