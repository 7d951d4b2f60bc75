"""The static engine: one pose a viseme, and straight lines between them.

The plainest lip sync that there is, which every paper is compared with: phones that look alike
share a static viseme (Fisher 1968), here the classes of the Common Phoneme Set (Xu et al. 2013,
table 1). A phone's pose is reached in its middle, and all weights change evenly from one middle to
the next. Nothing is held but a long silence, in which the mouth is at rest until shortly before
the next sound.

Poses are in `static_poses.csv`, one row a class, fitted by bench/fit_visemes.py.
"""

from __future__ import annotations

from functools import cache
from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.audio import Sound
from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL
from lipwright.engines.visemes import Floats, Viseme, by_name, load_visemes, to_canonical
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

TABLE: Final = "static_poses.csv"
REST: Final = 0.1  # s inside each edge of a silence by which the mouth is at rest


def class_of(phone: str) -> str:
    """The viseme of a phone: its class of the Common Phoneme Set, or silence."""
    return PHONES[phone].common or SILENCE


@cache
def load_poses() -> MappingProxyType[str, Viseme]:
    """Class to its pose, from the table."""
    return MappingProxyType({name: rows[0] for name, rows in by_name(load_visemes(TABLE)).items()})


def keys(track: PhoneTrack) -> tuple[Floats, tuple[str, ...]]:
    """When which viseme is reached, (N,) rising times in s and N classes.

    A phone has one, in its middle; a silence longer than twice `REST` has two.
    """
    times: list[float] = []
    classes: list[str] = []
    for phone, start, end in track.padded(0, track.end):
        long = phone == SILENCE and end - start > 2 * REST
        times += [start + REST, end - REST] if long else [(start + end) / 2]
        classes += [class_of(phone)] * (2 if long else 1)
    return np.array(times), tuple(classes)


CHUNK_FRAMES: Final = 2048  # computed at once, so that an hour needs no more memory than a minute


def between(reached: Floats, poses: Floats, times: Floats) -> Floats:
    """(T, K), straight lines between poses (N, K) at the times `reached`, (N,) s; held outside."""
    after = np.clip(np.searchsorted(reached, times, side="right"), 1, max(len(reached) - 1, 1))
    after = np.minimum(after, len(reached) - 1)
    before = np.maximum(after - 1, 0)
    length = np.where(after > before, reached[after] - reached[before], 1.0)
    share = np.clip((times - reached[before]) / length, 0, 1)[:, None]
    return np.asarray((1 - share) * poses[before] + share * poses[after])


def animate(track: PhoneTrack, fps: float, audio: Sound | None = None) -> Clip:
    """The motion of a track, in the canonical controls; `audio` is not listened to."""
    del audio
    times = frame_times(track.end, fps)
    reached, classes = keys(track)
    table = load_poses()
    poses = np.array([table[name].pose() for name in classes])
    values = np.zeros((len(times), len(CANONICAL)), np.float32)
    for first in range(0, len(times), CHUNK_FRAMES):
        part = slice(first, first + CHUNK_FRAMES)
        values[part] = to_canonical(between(reached, poses, times[part]))
    return Clip(CANONICAL, fps, values)
