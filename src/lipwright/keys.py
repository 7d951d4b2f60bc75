"""Curves as few keys with tangents, for hand editing: what animators open and change.

Between two keys a curve is a cubic Hermite polynomial of time: values and slopes at both ends. The
Bezier handles of the same curve are a third of the way to the neighbour, along the slope.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip

Floats = npt.NDArray[np.float64]

STILL = 0.0  # what a control that never changes needs is one key


@dataclass(frozen=True, eq=False)
class KeyedCurve:
    """K keys of one control; before the first and after the last it holds.

    Raises:
        ValueError: no keys, lengths differ, times do not rise, or a number is not finite.
    """

    times: Floats
    """(K,) s, rising, each that of a frame"""
    values: Floats
    """(K,) units of the control"""
    arriving: Floats
    """(K,) units a second, the slope just before each key; 0 before the first"""
    leaving: Floats
    """(K,) units a second, the slope just after each key; 0 after the last"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        for field in fields(self):
            array = np.array(getattr(self, field.name), np.float64)
            array.setflags(write=False)
            object.__setattr__(self, field.name, array)
            if array.shape != self.times.shape or array.ndim != 1 or not len(array):
                raise ValueError(f"keys have {field.name} of the shape {array.shape}")
            if not np.isfinite(array).all():
                raise ValueError(f"keys have {field.name} that are no numbers")
        if (np.diff(self.times) <= 0).any():
            raise ValueError("times of keys do not rise")

    def __len__(self) -> int:
        """The number of keys, K."""
        return len(self.times)

    def at(self, times: npt.ArrayLike) -> Floats:
        """The curve at `times` in s."""
        when = np.clip(np.asarray(times, np.float64), self.times[0], self.times[-1])
        if len(self) == 1:
            return np.full(when.shape, self.values[0])
        left = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self) - 2)
        span = self.times[left + 1] - self.times[left]
        u = (when - self.times[left]) / span
        return np.asarray(
            hermite(u, self.values[left], self.values[left + 1],
                    span * self.leaving[left], span * self.arriving[left + 1])
        )  # fmt: skip


def hermite(u: Floats, start: Floats, end: Floats, out: Floats, into: Floats) -> Floats:
    """Cubic Hermite polynomials at `u`, 0 to 1; slopes `out` and `into` are per span."""
    s = 1 - u
    return np.asarray(
        s * s * (1 + 2 * u) * start + u * u * (3 - 2 * u) * end + u * s * (s * out - u * into)
    )


@dataclass(frozen=True, eq=False)
class KeyedClip:
    """Curves with one clock, each with keys of its own."""

    curves: dict[str, KeyedCurve]
    """control to its keys, in the clip's order"""
    fps: float
    """frames a second of the clip that they stand for"""
    frames: int
    """T of that clip; it lasts (T - 1) / fps"""
    linear: bool
    """one key a frame, joined by straight lines: nothing was left out"""

    @property
    def duration(self) -> float:
        """The time of the last frame in s."""
        return (self.frames - 1) / self.fps

    def to_clip(self) -> Clip:
        """The curves at every frame."""
        times = np.arange(self.frames) / self.fps
        columns = [curve.at(times) for curve in self.curves.values()]
        return Clip(tuple(self.curves), self.fps, np.stack(columns, axis=1).astype(np.float32))


def keyed(clip: Clip, error: float | None = None, names: Iterable[str] | None = None) -> KeyedClip:
    """The clip's curves as keys.

    A control that never changes gets one key.

    Args:
        clip: the curves.
        error: at every frame at the most this far from the clip, in units of the control; None for
            one key a frame, joined by straight lines.
        names: the controls to take; all of them by default.
    """
    chosen = clip.names if names is None else tuple(names)
    make = every_frame if error is None else lambda v, t: sparse_keys(v, t, error)
    curves = {}
    for name in chosen:
        values = clip.curve(name).astype(np.float64)
        if np.ptp(values) == 0 or len(values) == 1:
            zero = np.zeros(1)
            curves[name] = KeyedCurve(zero, values[:1], zero, zero)
        else:
            curves[name] = make(values, clip.times)
    return KeyedClip(curves, clip.fps, len(clip), linear=error is None)


def every_frame(values: Floats, times: Floats) -> KeyedCurve:
    """One key a frame; slopes are those of the straight lines between them."""
    slopes = np.diff(values) / np.diff(times)
    return KeyedCurve(times, values, np.concatenate([[0], slopes]), np.concatenate([slopes, [0]]))


def sparse_keys(values: Floats, times: Floats, error: float) -> KeyedCurve:
    """As few keys as keep the curve within `error` of `values` at all `times`."""
    return every_frame(values, times)  # TODO
