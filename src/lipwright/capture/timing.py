"""A constant frame rate for frames that were shown at any times."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

Seconds = npt.NDArray[np.float64]

USUAL_FPS: Final = (
    24000 / 1001, 24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 120000 / 1001,
    120.0,
)  # fmt: skip
SNAP: Final = 0.005  # share by which a usual rate may differ from the measured one
SAME: Final = 0.25  # intervals by which a frame may miss its place on the grid and be taken as is
LONGEST_STEP: Final = 1.5  # intervals between two frames that may still be interpolated
_UNSTEADY: Final = 0.02  # share by which the mean rate of steady frames may differ from the median
_ROUNDING: Final = 0.0006  # s by which rounding to ms moves the median interval, and a bit
_EMPTY: Final = 60.0  # s without frames, in all, that a video may have: longer is a broken clock


@dataclass(frozen=True, eq=False)
class Grid:
    """Which of N frames stand on a grid of T frames, frame i at (i + 0.5) / fps s.

    A grid frame is `before` where the weight is 0, else between `before` and `after`.
    """

    fps: float
    """frames a second"""
    before: npt.NDArray[np.int64]
    """(T,), index of a frame, -1 where the video has none"""
    after: npt.NDArray[np.int64]
    """(T,), index of a frame, -1 where the video has none"""
    weight: npt.NDArray[np.float64]
    """(T,), share of `after`, 0 to 1"""

    def __len__(self) -> int:
        """The number of frames of the grid, T."""
        return len(self.before)

    @property
    def nearest(self) -> npt.NDArray[np.int64]:
        """(T,), the frame that is nearer, -1 where the video has none."""
        return np.where(self.weight > 0.5, self.after, self.before)

    @property
    def dropped(self) -> npt.NDArray[np.bool_]:
        """(T,), where the video has no frame."""
        return self.before < 0

    def mean(self, values: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """(T, ...), the values (N, ...) of frames on the grid; NaN where there is none.

        A row that is taken as it is stays bit for bit; one of two NaN rows makes a NaN.
        """
        if np.array_equal(self.before, np.arange(len(values))) and not self.weight.any():
            return values
        taken = values[self.before]
        taken[self.dropped] = np.nan
        mixed = np.flatnonzero(self.weight > 0)
        share = self.weight[mixed].astype(np.float32)
        share = share.reshape(-1, *[1] * (values.ndim - 1))
        taken[mixed] = (1 - share) * taken[mixed] + share * values[self.after[mixed]]
        return taken

    def any(self, values: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        """(T,), whether (N,) is true of a frame that the grid frame is made of."""
        return ~self.dropped & (values[self.before] | ((self.weight > 0) & values[self.after]))


def frame_rate(times: Seconds) -> float:
    """Frames a second of frames at `times` (N,), N at least 2: the rate while they flow steadily.

    Found from the median interval; time stamps in whole ms are made up for by counting intervals
    over the whole video. A usual rate is taken where it fits as well.
    """
    steps = np.diff(times)
    interval = float(np.median(steps))
    whole = np.maximum(np.round(steps / interval), 1)
    counted = np.concatenate([[0.0], np.cumsum(whole)])
    fitted = float(np.polyfit(counted, times, 1)[0])
    if abs(fitted - interval) > max(_UNSTEADY * interval, _ROUNDING):
        fitted = interval
    usual = min(USUAL_FPS, key=lambda fps: abs(fps * fitted - 1))
    if abs(usual * fitted - 1) > SNAP:
        return 1 / fitted
    drift = abs(usual * fitted - 1) * counted[-1]
    # Two or three frames measure a rate badly; in a long video a rate a little off adds up.
    return usual if drift < SAME / 2 or fitted == interval else 1 / fitted


def make_grid(times: Seconds, fps: float) -> Grid:
    """The grid at `fps` for frames shown at `times` (N,), rising from 0 s.

    Raises:
        ValueError: the times jump, so that most of the grid would be empty.
    """
    place = times * fps  # where each frame stands on the grid, in intervals
    count = math.floor(place[-1] + SAME) + 1
    if count - len(times) > max(len(times), _EMPTY * fps):
        jump = int(np.argmax(np.diff(times)))
        raise ValueError(
            f"its time stamps jump by {times[jump + 1] - times[jump]:.0f} s at {times[jump]:.2f} s"
        )
    grid = np.arange(count, dtype=np.float64)
    after = np.clip(np.searchsorted(place, grid), 0, len(place) - 1)
    before = np.maximum(after - 1, 0)
    closest = np.where(grid - place[before] <= np.abs(place[after] - grid), before, after)
    taken = np.abs(place[closest] - grid) <= SAME
    width = place[after] - place[before]
    inside = (place[before] <= grid) & (grid <= place[after]) & (width > 0)
    mixed = ~taken & inside & (width <= LONGEST_STEP)
    share = (grid - place[before]) / np.where(width > 0, width, 1)
    first = np.where(taken, closest, np.where(mixed, before, -1))
    return Grid(
        fps,
        first.astype(np.int64),
        np.where(mixed, after, first).astype(np.int64),
        np.where(mixed, share, 0.0),
    )
