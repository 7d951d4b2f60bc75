"""Curves as few keys with tangents, for hand editing: what animators open and change.

Between two keys a curve is a cubic Hermite polynomial of time: values and slopes at both ends. The
Bezier handles of the same curve are a third of the way to the neighbour, along the slope.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip

Floats = npt.NDArray[np.float64]
Frames = npt.NDArray[np.intp]


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

    A control that moves by no more than `error` gets one key.

    Args:
        clip: the curves.
        error: at every frame at the most this far from the clip, in units of the control, or in cm
            where a bone's place is in m; None for one key a frame, joined by straight lines.
        names: the controls to take; all of them by default.
    """
    chosen = clip.names if names is None else tuple(names)
    values = clip.select(chosen).values.astype(np.float64)
    low, high = values.min(axis=0), values.max(axis=0)
    bounds = np.array([0.0 if error is None else bound_of(name, error) for name in chosen])
    moving = np.flatnonzero(high - low > 2 * SHARE * bounds)
    if error is None:
        kept: list[Frames] = [np.arange(len(clip), dtype=np.intp)] * len(moving)
        slopes = np.zeros_like(values)
    else:
        slopes = np.gradient(values, axis=0) if len(clip) > 1 else np.zeros_like(values)
        kept = kept_frames(values[:, moving], slopes[:, moving], HEADROOM * bounds[moving])
    frames = dict(zip(moving.tolist(), kept, strict=True))
    curves = {}
    for column, name in enumerate(chosen):
        if column not in frames:
            middle = values[:1, column] if error is None else (low + high)[column : column + 1] / 2
            curves[name] = KeyedCurve(np.zeros(1), middle, np.zeros(1), np.zeros(1))
        elif error is None:
            curves[name] = every_frame(values[:, column], clip.times)
        else:
            fitted = fitted_keys(
                values[:, column], slopes[:, column], frames[column], SHARE * bounds[column]
            )
            curves[name] = _smooth(*fitted, clip.fps)
    return KeyedClip(curves, clip.fps, len(clip), linear=error is None)


_PLACES: Final = (".tx", ".ty", ".tz")  # channels of bones in m; see `rig.values.CHANNELS`
_CM: Final = 0.01  # m


def bound_of(name: str, error: float) -> float:
    """How far the keys of a control may be off, in its own unit; `error` is that of `keyed`."""
    return error * _CM if name.endswith(_PLACES) else error


def every_frame(values: Floats, times: Floats) -> KeyedCurve:
    """One key a frame; slopes are those of the straight lines between them."""
    slopes = np.diff(values) / np.diff(times)
    return KeyedCurve(times, values, np.concatenate([[0], slopes]), np.concatenate([slopes, [0]]))


def _smooth(frames: Frames, values: Floats, slopes: Floats, fps: float) -> KeyedCurve:
    arriving = slopes * fps
    leaving = arriving.copy()
    arriving[0] = leaving[-1] = 0.0
    return KeyedCurve(frames / fps, values, arriving, leaving)


SHARE: Final = 0.97  # of the bound; the rest is for the digits that files leave out
HEADROOM: Final = 1.45  # times the bound for the choice of keys: fitting them takes errors down
THIRD: Final = 3  # keys of which one is tried at a time: its neighbours hold the curve meanwhile
ROUNDS: Final = 4  # in which keys that are missed come back
TETHER: Final = 1e-4  # how much a key's value and slope are held to the curve's, against a frame's
LANE: Final = 600  # frames that are gone through in a row; each run of so many begins with a key
REACH: Final = 96  # frames from key to key at the most
PATIENCE: Final = 8  # spans in a row that do not fit, before longer ones are given up


def kept_frames(values: Floats, slopes: Floats, errors: Floats) -> list[Frames]:
    """The frames of each curve that become keys: from each the farthest that still fits.

    A span fits where the cubic through its ends with their slopes is within its error of all frames
    between. All curves are gone through at once, in runs of `LANE` frames.

    Args:
        values: (T, C).
        slopes: (T, C) a frame.
        errors: (C,) in units of the controls.

    Returns:
        For each of C curves its frames, rising, the first and the last among them.
    """
    count, controls = values.shape
    starts = np.arange(0, max(count - 1, 1), LANE)
    column = np.repeat(np.arange(controls), len(starts))
    frame = np.tile(starts, controls)
    stop = np.minimum(frame + LANE, count - 1)
    keys = [(column, frame)]
    while len(column):
        frame = frame + _farthest(values, slopes, errors, column, frame, stop)
        keys.append((column, frame))
        going = frame < stop
        column, frame, stop = column[going], frame[going], stop[going]
    columns, frames = (np.concatenate(parts) for parts in zip(*keys, strict=True))
    return [np.unique(frames[columns == control]) for control in range(controls)]


def _farthest(
    values: Floats, slopes: Floats, errors: Floats, column: Frames, frame: Frames, stop: Frames
) -> Frames:
    """For each of n starts the longest span, in frames, that fits; at least one frame."""
    best = np.minimum(1, stop - frame)
    trying = np.flatnonzero(stop - frame > 1)
    for length in range(2, REACH + 1):
        trying = trying[(stop - frame)[trying] >= length]
        trying = trying[length - best[trying] <= PATIENCE]
        if not len(trying):
            break
        c, start = column[trying, None], frame[trying, None]
        u = np.arange(1, length) / length
        ends = start + length
        curve = hermite(
            u, values[start, c], values[ends, c],
            length * slopes[start, c], length * slopes[ends, c],
        )  # fmt: skip
        off = np.abs(curve - values[start + np.arange(1, length), c]).max(axis=1)
        best[trying[off <= errors[column[trying]]]] = length
    return best


def fitted_keys(
    values: Floats, slopes: Floats, frames: Frames, error: float
) -> tuple[Frames, Floats, Floats]:
    """Keys whose values and slopes follow the curve best, and more of them where that is too far.

    Least squares over all frames, for all keys at once: what a key does reaches only its two spans,
    so that the equations are banded. A span that is farther from the curve than `error` is parted
    where it is farthest, until none is; then keys that are not missed go.

    Args:
        values: (T,).
        slopes: (T,) a frame; what is held to where the frames do not say.
        frames: (K,) first keys, the first and the last frame among them.
        error: in units of the control.

    Returns:
        The frames (K,), values (K,) and slopes (K,) a frame of the keys.
    """
    frames = _parted(values, slopes, frames, error)
    frames = _parted(values, slopes, _thinned(values, slopes, frames, error), error)
    solution, _ = _least_squares(values, slopes, frames)
    return frames, solution[0::2], solution[1::2]


def _parted(values: Floats, slopes: Floats, frames: Frames, error: float) -> Frames:
    """The keys, and one more in each span that is too far, where it is farthest, until none is."""
    while True:
        off = _least_squares(values, slopes, frames)[1]
        # A key's own frame counts for the spans on both sides: either may pull it away.
        worst = np.maximum(np.maximum.reduceat(off, frames[:-1]), off[frames[1:]])
        far = np.flatnonzero((worst > error) & (np.diff(frames) > 1))
        if not len(far):
            return frames
        spans = zip(frames[far] + 1, frames[far + 1], strict=True)
        more = [first + int(off[first:stop].argmax()) for first, stop in spans]
        frames = np.union1d(frames, np.array(more, np.intp))


def _thinned(values: Floats, slopes: Floats, frames: Frames, error: float) -> Frames:
    """The keys without those, of every third at a time, that can go and leave all frames near."""
    for first in range(1, 1 + THIRD):
        gone = np.arange(first, len(frames) - 1, THIRD)
        for _ in range(ROUNDS):
            fewer = np.delete(frames, gone)
            far = np.flatnonzero(_least_squares(values, slopes, fewer)[1] > error)
            if not len(far):
                frames = fewer
                break
            # Those on both sides of a frame that is too far come back.
            after = np.searchsorted(frames[gone], far)
            back = np.union1d(np.maximum(after - 1, 0), np.minimum(after, len(gone) - 1))
            gone = np.delete(gone, back)
    return frames


def _least_squares(values: Floats, slopes: Floats, frames: Frames) -> tuple[Floats, Floats]:
    """Values and slopes of the keys in turn (2 K,), and how far each frame is then off (T,)."""
    from scipy.linalg import solveh_banded

    span = np.repeat(np.arange(len(frames) - 1), np.diff(frames))
    span = np.append(span, len(frames) - 2)
    length = np.diff(frames)[span].astype(np.float64)
    u = (np.arange(len(values)) - frames[span]) / length
    zero, one = np.zeros_like(u), np.ones_like(u)
    parts = (
        hermite(u, one, zero, zero, zero), hermite(u, zero, zero, length, zero),
        hermite(u, zero, one, zero, zero), hermite(u, zero, zero, zero, length),
    )  # fmt: skip
    unknowns = 2 * len(frames)
    banded = np.zeros((4, unknowns))
    banded[0] = TETHER
    right = TETHER * np.stack([values[frames], slopes[frames]], axis=1).ravel()
    for i, part in enumerate(parts):
        right += np.bincount(2 * span + i, part * values, unknowns)
        for j in range(i, 4):
            banded[j - i] += np.bincount(2 * span + i, part * parts[j], unknowns)
    solution = np.asarray(solveh_banded(banded, right, lower=True))
    reached = sum(part * solution[2 * span + i] for i, part in enumerate(parts))
    return solution, np.abs(reached - values)
