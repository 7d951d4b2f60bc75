"""Curves of one clock on another, while they are still being made.

Between two frames runs the monotone cubic of Fritsch and Butland, "A method for constructing
local monotone piecewise cubic interpolants" (1984): smooth, never beyond its neighbours, and known
as soon as the second frame after it is. It is SciPy's PchipInterpolator for even times, written
out here because importing that takes longer than animating a sentence.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Values = npt.NDArray[np.float32]

FRAMES_AHEAD = 2  # of the source's clock, that a value between two frames waits for


class Resampler:
    """Frames of one rate in, frames of another out; frame i of both is at i / rate s."""

    def __init__(self, source_fps: float, fps: float, controls: int) -> None:
        """From `source_fps` to `fps` frames a second, both above 0, of C controls."""
        self._source, self._fps = source_fps, fps
        self.nothing: Values = np.zeros((0, controls), np.float32)
        """(0, C), no frames"""
        self._kept = self.nothing
        self._first = 0  # the frame of the source that the kept ones begin with
        self._next = 0  # the frame to give

    @property
    def look_ahead(self) -> float:
        """How much of the source after a frame must be known to give it, in s."""
        return 0.0 if self._source == self._fps else FRAMES_AHEAD / self._source

    def add(self, values: Values) -> Values:
        """The frames (N', C) that follow from the source's next ones (N, C) and those before."""
        if self._source == self._fps:
            return values
        self._kept = np.concatenate([self._kept, values])
        known = self._first + len(self._kept) - FRAMES_AHEAD
        stop = max(math.ceil(known * self._fps / self._source - 1e-9), self._next)
        given = self._at(np.arange(self._next, stop))
        self._next = stop
        # The slope at a frame needs the one before it; the last slope, two of them.
        oldest = math.floor(stop * self._source / self._fps) - 1
        drop = max(min(oldest - self._first, len(self._kept) - 2 * FRAMES_AHEAD), 0)
        self._kept, self._first = self._kept[drop:], self._first + drop
        return given

    def end(self, duration: float) -> Values:
        """The rest of the frames that cover `duration` s; the source holds its last one."""
        count = math.ceil(duration * self._fps - 1e-6) + 1  # as frame_times
        return self._at(np.arange(self._next, count))

    def _at(self, frames: npt.NDArray[np.int64]) -> Values:
        if not (len(frames) and len(self._kept)):
            return self.nothing
        place = np.minimum(frames * (self._source / self._fps) - self._first, len(self._kept) - 1)
        return monotone_cubic(self._kept, place)


def monotone_cubic(values: Values, place: npt.ArrayLike) -> Values:
    """(len(place), C), between the rows of `values` (T, C), row i being at place i.

    Args:
        values: T at least 1.
        place: from 0 to T - 1.
    """
    place = np.asarray(place, np.float64)
    if len(values) == 1:
        return np.repeat(values, len(place), axis=0)
    low = np.clip(place.astype(np.int64), 0, len(values) - 2)
    u = (place - low)[:, None]
    slope = _slopes(values.astype(np.float64))
    start, end = values[low], values[low + 1]
    rise = u * u * (3 - 2 * u)
    bent = u * (1 - u) * ((1 - u) * slope[low] - u * slope[low + 1])
    return (start + rise * (end - start) + bent).astype(np.float32)


def _slopes(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(T, C), a frame: the harmonic mean of the steps beside each value, 0 at peaks."""
    step = np.diff(values, axis=0)
    slopes = np.zeros_like(values)
    before, after = step[:-1], step[1:]
    same = before * after > 0
    total = np.where(same, before + after, 1)
    slopes[1:-1] = np.where(same, 2 * before * after / total, 0)
    slopes[0] = _end_slope(step[0], step[min(1, len(step) - 1)])
    slopes[-1] = _end_slope(step[-1], step[max(len(step) - 2, 0)])
    return slopes


def _end_slope(
    near: npt.NDArray[np.float64], far: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """At the first or last value: of the parabola through three, unless it overshoots."""
    slope = (3 * near - far) / 2
    slope = np.where(slope * near <= 0, 0, slope)
    return np.where((near * far < 0) & (np.abs(slope) > 3 * np.abs(near)), 3 * near, slope)
