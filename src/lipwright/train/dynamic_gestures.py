"""Visually salient gestures: where the motion of recordings is cut, and what each piece says."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import GROUPS
from lipwright.engines.dynamic_speech import Stretch, stretches
from lipwright.engines.dynamic_units import END

if TYPE_CHECKING:
    from lipwright.train.takes import Take

Floats = npt.NDArray[np.float64]

POSES: Final = 12  # N of a gesture, over its time: twice as many as its frames in the median
VISIBLE_MODES: Final = 24  # of the reference face; the others are small, and hardly the lips'
DECAY: Final = 0.85  # mode k deviates by about 1 / k**0.85 of the first (GRID s1: 622 to 17)
SEEN: Final = frozenset({"jaw", "lips"})  # groups of ARKit that are the visible articulators
MATTERS: Final = 0.05  # of the largest share of motion; smaller ones are no articulators
_MODE: Final = re.compile(r"[a-z]+([1-9][0-9]*)")


def visible_weights(controls: Sequence[str], spread: Floats) -> Floats:
    """(C,), what each control counts in speeds and distances of poses.

    Modes weigh as much as they move the reference face; weights of heads count as they are where
    there are no modes. The variance of all together is 1.

    Args:
        controls: C names.
        spread: (C,), their standard deviations.
    """
    modes = [_MODE.fullmatch(name) for name in controls]
    if any(modes):
        numbers = [int(mode[1]) if mode else 0 for mode in modes]
        weights = np.array([k**-DECAY if 0 < k <= VISIBLE_MODES else 0.0 for k in numbers])
    else:
        groups = [{group for group, names in GROUPS.items() if name in names} for name in controls]
        moving = spread > MATTERS * spread.max()
        seen = np.array([bool(found & SEEN) for found in groups])
        weights = (moving & seen if (moving & seen).any() else moving).astype(np.float64)
    total = np.sqrt(np.square(weights * spread).sum())
    return np.asarray(weights / (total or 1.0))


@dataclass(frozen=True, eq=False)
class Gesture:
    """One piece of a recording."""

    phones: tuple[int, ...]
    """that it says, whole or in part"""
    part: int
    """of its first phone that it begins with"""
    marks: Floats
    """(L + 1,), where in it each of its joints is: 0 and 1 at its ends"""
    ends: tuple[float, float]
    """how far its ends are from its first and last joint, in joints"""
    seconds: float
    """from its first to its last joint"""
    poses: npt.NDArray[np.float32]
    """(POSES, C), over its time"""
    frames: float
    """how long it is"""


def salient_frames(motion: Floats, fps: float, smooth_s: float, shortest_s: float) -> Floats:
    """The frames (B,) at which the visible articulators are slowest, of motion (T, D).

    Speed is the central difference, so it vanishes where they turn back.

    Args:
        motion: weighted, at even frames.
        fps: frames a second.
        smooth_s: standard deviation in s of the Gaussian that smooths it before.
        shortest_s: s between two; of nearer ones the slower stays.
    """
    from scipy.ndimage import gaussian_filter1d
    from scipy.signal import find_peaks

    if len(motion) < 3:
        return np.zeros(0)
    speed = speeds(gaussian_filter1d(motion, smooth_s * fps, axis=0) if smooth_s else motion)
    found, _ = find_peaks(-speed, distance=max(shortest_s * fps, 1))
    return np.asarray(found, np.float64)


def speeds(motion: Floats) -> Floats:
    """(T,), how fast motion (T, D) goes, by central differences."""
    return np.asarray(np.linalg.norm(np.gradient(motion, axis=0), axis=1))


def gestures_of(
    take: Take, visible: Floats, known: tuple[str, ...], fps: float, smooth_s: float,
    shortest_s: float,
) -> Iterator[Gesture]:  # fmt: skip
    """The gestures of a recording, stretch by stretch; those with frames without a face left out.

    Args:
        take: with C controls.
        visible: (C,), of `visible_weights`.
        known: the phones to say them in.
        fps: frames a second of the take.
        smooth_s: as `salient_frames`.
        shortest_s: as `salient_frames`.
    """
    motion = (take.targets * visible)[:, visible > 0]
    frames = salient_frames(motion, fps, smooth_s, shortest_s)
    salient = np.interp(frames, np.arange(len(take.times)), take.times)
    slowness = speeds(motion)[frames.astype(int)] if len(frames) else frames
    for stretch in stretches(take.track, known):
        if stretch.phones:
            yield from _gestures(take, stretch, salient, slowness, 1 / fps)


def _gestures(
    take: Take, stretch: Stretch, salient: Floats, slowness: Floats, frame_s: float
) -> Iterator[Gesture]:
    inside = (salient > stretch.edges[0]) & (salient < stretch.edges[-1])
    places = _one_a_joint(stretch, stretch.places(salient[inside]), slowness[inside])
    times = stretch.times(places)
    for (a, b), (start, end) in zip(pairwise(places), pairwise(times), strict=True):
        poses = _poses(take, start, end, frame_s)
        if poses is None:
            continue
        first, last = round(a), round(b)
        joints = stretch.times(np.arange(first, last + 1))
        marks = np.clip((joints - start) / (end - start), 0, 1)
        marks[0], marks[-1] = 0.0, 1.0
        phones, part = phones_between(stretch, first, last)
        ends = (float(np.clip(a - first, -END, END)), float(np.clip(b - last, -END, END)))
        yield Gesture(phones, part, marks, ends, float(joints[-1] - joints[0]), poses,
                      (end - start) / frame_s)  # fmt: skip


def phones_between(stretch: Stretch, first: int, last: int) -> tuple[tuple[int, ...], int]:
    """The phones between two joints, whole or in part, and the part that the first begins with."""
    parts = stretch.joints // len(stretch.phones)
    return stretch.phones[first // parts : (last - 1) // parts + 1], first % parts


def _one_a_joint(stretch: Stretch, places: Floats, slowness: Floats) -> Floats:
    """Places with those of the ends; of those that share a joint the slowest stays."""
    kept: dict[int, tuple[float, float]] = {}
    for place, speed in zip(places, slowness, strict=True):
        joint = round(place)
        if 0 < joint < stretch.joints and speed < kept.get(joint, (np.inf, 0.0))[0]:
            kept[joint] = (speed, place)
    inner = [place for _, (_, place) in sorted(kept.items())]
    return np.array([0.0, *inner, float(stretch.joints)])


def _poses(take: Take, start: float, end: float, frame_s: float) -> npt.NDArray[np.float32] | None:
    """(POSES, C) between two times, or None where a frame shows no face or there is none."""
    if start < take.times[0] - frame_s or end > take.times[-1] + frame_s:
        return None
    low = max(int(np.searchsorted(take.times, start, "right")) - 1, 0)
    high = int(np.searchsorted(take.times, end))
    if not take.valid[low : high + 1].all():
        return None
    wanted = np.linspace(start, end, POSES)
    near = slice(max(low - 1, 0), high + 2)
    place = np.interp(wanted, take.times[near], np.arange(len(take.times[near])))
    whole = np.minimum(place.astype(int), max(len(take.times[near]) - 2, 0))
    share = (place - whole)[:, None]
    values = take.targets[near]
    after = np.minimum(whole + 1, len(values) - 1)
    return np.asarray(values[whole] * (1 - share) + values[after] * share, np.float32)
