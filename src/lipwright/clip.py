"""`Clip`: curves of named controls with one clock."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

MIN_FPS = 0.1  # frames a second; a slower clip has no motion, and a video no clock for it
MAX_FPS = 1000.0  # frames a second; more is a slip of the pen


def frame_times(duration: float, fps: float) -> npt.NDArray[np.float64]:
    """(T,) s, the times of the frames that cover `duration` s; the last is at or after its end.

    Raises:
        ValueError: the duration is negative or endless, or fps is not above 0 and at most 1000.
    """
    if not 0 <= duration < math.inf:
        raise ValueError(f"duration is {duration}, not a number of seconds from 0 on")
    _check_fps(fps)
    # A duration that is a whole number of frames must not gain one by rounding.
    return np.arange(math.ceil(duration * fps - 1e-6) + 1, dtype=np.float64) / fps


def _check_fps(fps: float) -> None:
    if not 0 < fps <= MAX_FPS:
        raise ValueError(f"fps is {fps}, not above 0 and at most {MAX_FPS:.0f}")


@dataclass(frozen=True, eq=False)
class Clip:
    """Curves of C controls, sampled at T frames; frame i is at i / fps seconds.

    Raises:
        ValueError: a name is empty or repeats, the shape does not match the names, a value is not
            finite, or fps is out of range.
    """

    names: tuple[str, ...]
    """C control names, each once"""
    fps: float
    """frames a second, above 0 and at most 1000"""
    values: npt.NDArray[np.float32]
    """(T, C), T at least 1; 0 at rest, 1 in full, read-only"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        names = tuple(self.names)
        values = np.array(self.values, dtype=np.float32)  # a copy: ours to freeze
        if isinstance(self.names, str) or not all(isinstance(n, str) and n for n in names):
            raise ValueError(f"control names are {self.names!r}, not a row of names")
        if len(set(names)) != len(names):
            repeated = sorted({name for name in names if names.count(name) > 1})
            raise ValueError(f"control names repeat: {', '.join(repeated)}")
        if values.ndim != 2 or values.shape[1] != len(names) or len(values) == 0:
            raise ValueError(f"values have the shape {values.shape}, not (T, {len(names)}), T > 0")
        if not np.isfinite(values).all():
            frame, column = np.argwhere(~np.isfinite(values))[0]
            raise ValueError(f"{names[column]} at frame {frame} is not a finite number")
        _check_fps(self.fps)
        values.setflags(write=False)
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "fps", float(self.fps))
        object.__setattr__(self, "values", values)

    def __len__(self) -> int:
        """The number of frames, T."""
        return len(self.values)

    @property
    def duration(self) -> float:
        """The time of the last frame in s."""
        return (len(self) - 1) / self.fps

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """(T,) in s."""
        return np.arange(len(self), dtype=np.float64) / self.fps

    def column(self, name: str) -> int:
        """The index of a control.

        Raises:
            KeyError: the clip has no such control.
        """
        try:
            return self.names.index(name)
        except ValueError:
            raise KeyError(f"no control {name!r}; the clip has {', '.join(self.names)}") from None

    def curve(self, name: str) -> npt.NDArray[np.float32]:
        """(T,), one control over time."""
        return self.values[:, self.column(name)]

    def with_values(self, values: npt.NDArray[np.floating]) -> Clip:
        """The same controls and clock with other values, (T', C)."""
        return replace(self, values=np.asarray(values, np.float32))

    def with_curves(self, curves: Mapping[str, npt.ArrayLike]) -> Clip:
        """The same clip with some curves, each (T,), replaced."""
        values = self.values.copy()
        for name, curve in curves.items():
            values[:, self.column(name)] = curve
        return self.with_values(values)

    def select(self, names: Iterable[str]) -> Clip:
        """The named controls, in that order; those that the clip lacks are at rest."""
        names = tuple(names)
        values = np.zeros((len(self), len(names)), np.float32)
        for column, name in enumerate(names):
            if name in self.names:
                values[:, column] = self.curve(name)
        return Clip(names, self.fps, values)

    def at(self, times: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """(len(times), C), linear between frames, held before the first and after the last."""
        position = np.clip(np.asarray(times, np.float64) * self.fps, 0, len(self) - 1)
        low = np.minimum(position.astype(np.int64), max(len(self) - 2, 0))
        high = np.minimum(low + 1, len(self) - 1)
        weight = (position - low)[:, None].astype(np.float32)
        return (1 - weight) * self.values[low] + weight * self.values[high]

    def resample(self, fps: float) -> Clip:
        """The same motion at another rate; linear between frames.

        Raises:
            ValueError: fps is not above 0 and at most 1000.
        """
        return Clip(self.names, fps, self.at(frame_times(self.duration, fps)))

    def retime(self, duration: float) -> Clip:
        """The same motion in another duration (s), at the same rate.

        Raises:
            ValueError: the duration is not positive, or endless.
        """
        if not 0 < duration < math.inf:
            raise ValueError(f"duration is {duration}, not above 0 s")
        times = frame_times(duration, self.fps)
        return self.with_values(self.at(times * (self.duration / duration)))

    def concatenate(self, other: Clip) -> Clip:
        """This clip and then `other`, which must have the same controls and rate.

        Raises:
            ValueError: controls or rates differ.
        """
        if other.names != self.names or other.fps != self.fps:
            raise ValueError("clips with other controls or another fps cannot be concatenated")
        return self.with_values(np.concatenate([self.values, other.values]))
