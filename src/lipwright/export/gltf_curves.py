"""Curves as samplers of a glTF animation.

All weights of a mesh share one sampler, and so the times of their keys (glTF 2.0, section 3.11).
With few keys, one curve alone is CUBICSPLINE, and of several the smaller of two is written.
CUBICSPLINE has the keys of all curves, and every curve is resampled at the others' times, which
changes no cubic; a key is three numbers a curve. LINEAR has as few frames as keep all curves in
reach of straight lines; a key is one number. Twenty curves of speech together have keys nearly
everywhere, so that LINEAR wins there; slow or few curves are cubic. Times are float32: within
0.03 ms in a clip of ten minutes.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.gltf_store import Json, Store
from lipwright.keys import LANE, Frames, KeyedClip, KeyedCurve, keyed

Floats = npt.NDArray[np.float64]

KINDS: Final = {"weights": "SCALAR", "translation": "VEC3", "rotation": "VEC4"}
"""what a channel animates, to the type of its accessor"""
AHEAD: Final = 8  # frames to look ahead at first; a line over all curves of speech ends sooner
TRIED: Final = 3 * LANE  # frames that tell which of the two is smaller; fitting all takes seconds
MARK: Final = "lipwright"
"""in an animation's `extras`: the frames a second of the clip, which of several animations it is,
and the node that turns with the head"""


def check_clock(path: Path, clip: Clip) -> None:
    """Refuse what glTF's float32 times cannot tell apart.

    Raises:
        LipwrightError: two frames would be at one time.
    """
    if len(clip) > 1 and np.float32(clip.duration) == np.float32(clip.duration - 1 / clip.fps):
        raise LipwrightError(
            f"{path}: {clip.duration:.0f} s at {clip.fps:g} frames a second are too long for glTF, "
            "whose times are float32; lower the rate or cut the clip"
        )


class Animation:
    """An animation of a document, channel by channel."""

    def __init__(self, store: Store, name: str, fps: float, keys: float | None) -> None:
        """Add an animation called `name`, of curves at `fps`, with `keys` as in ExportOptions."""
        self.store = store
        self.fps = fps
        self.keys = keys
        self.mark: Json = {"fps": fps}
        self.body: Json = {
            "name": name, "channels": [], "samplers": [], "extras": {MARK: self.mark},
        }  # fmt: skip
        self._samplers: dict[tuple[str, bytes], int] = {}
        store.add("animations", self.body)

    def turn_head(self, node: int, quaternions: Floats) -> None:
        """Turn the node that moves with the head by `quaternions` (T, 4)."""
        self.mark["head"] = node
        self.animate(node, "rotation", quaternions)

    def animate(
        self, node: int, path: str, values: npt.NDArray[np.floating], unit: float = 1.0
    ) -> None:
        """Move a node's weights, translation or rotation by `values` (T, n).

        Curves that are equal share their data.

        Args:
            node: its number.
            path: a key of `KINDS`.
            values: as glTF has them; rotations are unit quaternions.
            unit: that of the bound of few keys, in that of the values; of rotations in radians.
        """
        stored = np.ascontiguousarray(values, np.float32)
        key = (path, stored.tobytes())
        if key not in self._samplers:
            self._samplers[key] = len(self.body["samplers"])
            # An error of e in each of four numbers of a unit quaternion turns by up to 4 e.
            error = self.keys and self.keys * (unit / 4 if path == "rotation" else unit)
            self.body["samplers"].append(_sampler(self.store, path, stored, self.fps, error))
        self.body["channels"].append(
            {"sampler": self._samplers[key], "target": {"node": node, "path": path}}
        )


def _sampler(
    store: Store, path: str, values: npt.NDArray[np.float32], fps: float, error: float | None
) -> Json:
    clip = Clip(tuple(map(str, range(values.shape[1]))), fps, values)
    interpolation, times = "LINEAR", clip.times
    if (np.ptp(values, axis=0) == 0).all():
        ends = [0, -1] if len(values) > 1 else [0]
        times, values = times[ends], values[ends]
    elif error is not None:
        alone = np.count_nonzero(np.ptp(values, axis=0)) == 1
        corners = [] if alone else shared_keys(values, error)
        if alone or _is_cubic_smaller(clip, error, corners):
            interpolation = "CUBICSPLINE"
            times, *parts = join_keys(keyed(clip, error))
            values = np.stack(parts, axis=1).astype(np.float32)
        else:
            times, values = times[corners], values[corners]
    size = 1 if path == "weights" else values.shape[-1]
    output = store.accessor(values.reshape(-1, size), KINDS[path])
    return {"input": store.times(times), "output": output, "interpolation": interpolation}


def _is_cubic_smaller(clip: Clip, error: float, corners: list[int]) -> bool:
    """Whether cubic keys take less than lines with these; of a long clip, in its middle."""
    first = max(len(clip) - TRIED, 0) // 2
    tried = clip.with_values(clip.values[first : first + TRIED])
    inside = np.array(corners)
    lines = np.count_nonzero((inside >= first) & (inside < first + TRIED))
    return bool(3 * len(join_keys(keyed(tried, error))[0]) < lines)


def shared_keys(values: npt.NDArray[np.float32], error: float) -> list[int]:
    """The frames of (T, C) that are enough for straight lines within `error` of all others.

    From each key the next is as far as one line a curve reaches: it must end at a frame's own
    values, and pass every frame between within `error`. All runs of `LANE` frames are gone through
    at once.
    """
    moving = values[:, np.ptp(values, axis=0) > 0].astype(np.float64)
    end = len(values) - 1
    frame: Frames = np.arange(0, max(end, 1), LANE)
    stop = np.minimum(frame + LANE, end)
    keys = [frame]
    while len(frame):
        frame = frame + _farthest(moving, error, frame, stop)
        keys.append(frame)
        frame, stop = frame[frame < stop], stop[frame < stop]
    return [int(key) for key in np.unique(np.concatenate(keys))]


def _farthest(values: Floats, error: float, frame: Frames, stop: Frames) -> Frames:
    """How far the lines from each of n frames of (T, C) reach, at most to `stop` (n,).

    All slopes count that pass each frame so far within `error`.
    """
    farthest = np.minimum(1, stop - frame)
    trying, ahead = np.flatnonzero(stop > frame), AHEAD
    while len(trying):
        steps = np.arange(1, ahead + 1)
        ends = frame[trying, None] + steps  # (n, ahead)
        inside = ends <= stop[trying, None]
        rows = values[np.minimum(ends, len(values) - 1)] - values[frame[trying], None]
        slopes = rows / steps[:, None]
        low = np.maximum.accumulate(slopes - error / steps[:, None], axis=1)
        high = np.minimum.accumulate(slopes + error / steps[:, None], axis=1)
        fits = ((slopes[:, 1:] >= low[:, :-1]) & (slopes[:, 1:] <= high[:, :-1])).all(axis=2)
        reached = np.where(fits & inside[:, 1:], steps[1:], 1).max(axis=1)
        farthest[trying] = reached
        ended = (low > high).any(axis=(1, 2)) | ~inside[:, -1]
        trying, ahead = trying[~ended], 2 * ahead
    return farthest


def join_keys(keys: KeyedClip) -> tuple[Floats, Floats, Floats, Floats]:
    """The same curves with keys at the same times.

    Returns:
        Times (K,) in s, from 0 to the clip's end; slopes before, values and slopes after the keys,
        each (K, C), slopes in units a second.
    """
    ends = np.array([0.0, keys.duration])
    times = np.unique(np.concatenate([ends, *(curve.times for curve in keys.curves.values())]))
    columns = [_at_keys(curve, times) for curve in keys.curves.values()]
    arriving, values, leaving = np.stack(columns, axis=-1)
    return times, arriving, values, leaving


def _at_keys(curve: KeyedCurve, times: Floats) -> Floats:
    """(3, K), the curve's slope before, its value and its slope after each of `times`."""
    return np.stack([slopes(curve, times, "left"), curve.at(times), slopes(curve, times, "right")])


def slopes(curve: KeyedCurve, times: Floats, side: str) -> Floats:
    """(n,) units a second, the slope of a curve on one side, "left" or "right", of `times`."""
    after = np.searchsorted(curve.times, times, side="right" if side == "right" else "left")
    inside = (after > 0) & (after < len(curve))  # before the first and after the last it holds
    left = np.clip(after - 1, 0, max(len(curve) - 2, 0))
    right = np.minimum(left + 1, len(curve) - 1)
    span = np.where(inside, curve.times[right] - curve.times[left], 1.0)
    u = (times - curve.times[left]) / span
    rise = (curve.values[right] - curve.values[left]) / span
    slope = (
        6 * u * (1 - u) * rise
        + (1 - u) * (1 - 3 * u) * curve.leaving[left]
        + u * (3 * u - 2) * curve.arriving[right]
    )
    return np.where(inside, slope, 0.0)


def continuous(quaternions: Floats) -> Floats:
    """(T, 4) unit quaternions that turn the same, each within half a turn of the one before."""
    flips = np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0
    signs = np.cumprod(np.concatenate([[1.0], np.where(flips, -1.0, 1.0)]))
    return np.asarray(quaternions * signs[:, None])


def multiply(first: npt.ArrayLike, second: npt.ArrayLike) -> Floats:
    """Quaternions (..., 4), x y z w, that turn by `second` and then by `first`."""
    a, b = np.asarray(first, np.float64), np.asarray(second, np.float64)
    (ax, ay, az, aw), (bx, by, bz, bw) = np.moveaxis(a, -1, 0), np.moveaxis(b, -1, 0)
    parts: Sequence[Floats] = [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
    return np.stack(np.broadcast_arrays(*parts), axis=-1)
