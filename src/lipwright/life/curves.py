"""The shapes of which life's curves are made: pulses of single events, and slow smooth noise."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lipwright.passes import ease

Floats = npt.NDArray[np.float64]


def pulse(times: Floats, start: float, rise: float, hold: float, fall: float) -> Floats:
    """(T,), a rise from 0 at `start` to 1 in `rise` s, there for `hold` s, and back in `fall` s."""
    up = ease((times - start) / rise)
    down = ease((start + rise + hold + fall - times) / fall)
    return np.minimum(up, down)


def add_pulse(
    curve: Floats, fps: float, size: float, start: float, shape: tuple[float, float, float]
) -> None:
    """Add a pulse of `size` to a curve (T,) in place; `shape` is rise, hold and fall in s."""
    first, stop = (max(int(time * fps), 0) for time in (start, start + sum(shape) + 2 / fps))
    times = np.arange(first, min(stop, len(curve))) / fps
    curve[first : first + len(times)] += size * pulse(times, start, *shape)


def smooth_noise(times: Floats, step: float, random: np.random.Generator) -> Floats:
    """(T,), noise of variance 1 without corners that changes over some `step` s.

    A cubic B-spline through random knots: its second derivative has no jumps. Longer `times` give
    the same beginning.
    """
    place = times / step
    low = np.floor(place).astype(np.int64)
    u = place - low
    knots = random.standard_normal(int(low[-1]) + 4)
    weights = np.stack(
        [(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3]
    )
    curve = (weights * knots[low + np.arange(4)[:, None]]).sum(axis=0)
    return np.asarray(curve / np.sqrt((weights**2).sum(axis=0)))
