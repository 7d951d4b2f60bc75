"""The phone strings that clusters of gestures carry: the units of a model."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.engines.dynamic_speech import PARTS
from lipwright.engines.dynamic_units import MAX_JOINTS, MAX_PHONES, REST, Key
from lipwright.train.dynamic_gestures import Gesture

Floats = npt.NDArray[np.float64]

LONGEST_CUT: Final = 2 * PARTS  # joints of what is cut out of gestures, for unheard strings
REST_SECONDS: Final = 0.1  # of silence where none was heard


@dataclass
class _Sum:
    """What the gestures of a cluster that say one string have in common."""

    cuts: int
    count: float = 0.0
    marks: Floats = field(default_factory=lambda: np.zeros(1))
    ends: Floats = field(default_factory=lambda: np.zeros(2))
    seconds: float = 0.0

    def add(self, marks: Floats, ends: tuple[float, float], seconds: float) -> None:
        self.count += 1
        self.marks = self.marks + marks
        self.ends = self.ends + ends
        self.seconds += math.log(seconds)


Sums = dict[tuple[Key, bool], dict[int, _Sum]]
"""phone string, and whether it is cut out of gestures: cluster to what it has of it"""


def unit_arrays(
    gestures: Sequence[Gesture], labels: Sequence[int], phones: int, candidates: int,
) -> dict[str, npt.NDArray[Any]]:  # fmt: skip
    """The arrays of a model that say which gesture can say what.

    Args:
        gestures: of all recordings.
        labels: the cluster of each, 0 to G - 2; as gestures of the model they follow the rest.
        phones: how many are known, sil being the first.
        candidates: clusters that are kept for a string, the most probable ones.
    """
    sizes = np.bincount(np.asarray(labels))
    sums: Sums = defaultdict(dict)
    for gesture, label in zip(gestures, labels, strict=True):
        _add_gesture(sums, gesture, label + 1)
    for part in range(PARTS):
        key = ((0,), part, 1)
        if (key, False) not in sums and (key, True) not in sums:
            resting = _Sum(2)
            resting.add(np.array([0.0, 1.0]), (0.0, 0.0), REST_SECONDS)
            sums[key, True][REST] = resting
    return _arrays(list(_rows(sums, np.array([1, *sizes]), candidates)), phones)


def _add_gesture(sums: Sums, gesture: Gesture, label: int) -> None:
    length = len(gesture.marks) - 1
    times = gesture.seconds
    for first in range(length):
        for last in range(first + 1, length + 1):
            whole = last - first == length
            if last - first > (MAX_JOINTS if whole else LONGEST_CUT):
                break
            start = gesture.part + first
            stop = gesture.part + last
            said = gesture.phones[start // PARTS : (stop - 1) // PARTS + 1]
            key = (said, start % PARTS, last - first)
            cuts = (first > 0) + (last < length)
            marks = gesture.marks[first : last + 1]
            seconds = times * max(marks[-1] - marks[0], 1e-3)
            ends = (gesture.ends[0] if first == 0 else 0.0,
                    gesture.ends[1] if last == length else 0.0)  # fmt: skip
            found = sums[key, not whole].setdefault(label, _Sum(cuts))
            found.cuts = min(found.cuts, cuts)
            found.add(marks, ends, seconds)


def _rows(
    sums: Sums, sizes: npt.NDArray[np.intp], candidates: int
) -> Iterator[tuple[Key, int, _Sum, float]]:
    """String, gesture, what they have in common and minus the logarithm of its probability."""
    for (key, _), clusters in sorted(sums.items()):
        costs = {label: -math.log(min(found.count / sizes[label], 1.0))
                 for label, found in clusters.items()}  # fmt: skip
        for label in sorted(clusters, key=lambda one: (-clusters[one].count, one))[:candidates]:
            yield key, label, clusters[label], costs[label]


def _arrays(rows: list[tuple[Key, int, _Sum, float]], phones: int) -> dict[str, Any]:
    keys = sorted({(key[0], key[1]) for key, _, _, _ in rows})
    place = {key: index for index, key in enumerate(keys)}
    strings = np.full((len(keys), MAX_PHONES), -1, np.int32)
    for index, (said, _) in enumerate(keys):
        assert max(said) < phones
        strings[index, : len(said)] = said
    marks = np.ones((len(rows), MAX_JOINTS + 1), np.float32)
    for index, (_, _, found, _) in enumerate(rows):
        mean = found.marks / found.count
        marks[index] = mean[-1]
        marks[index, : len(mean)] = mean
    return {
        "strings": strings, "parts": np.array([part for _, part in keys], np.int32),
        "string": np.array([place[key[:2]] for key, _, _, _ in rows], np.int32),
        "lengths": np.array([key[2] for key, _, _, _ in rows], np.int32),
        "gesture": np.array([label for _, label, _, _ in rows], np.int32),
        "marks": np.clip(np.maximum.accumulate(marks, axis=1), 0, 1),
        "ends": np.array([found.ends / found.count for _, _, found, _ in rows], np.float32),
        "costs": np.array([cost for _, _, _, cost in rows], np.float32),
        "seconds": np.array([found.seconds / found.count for _, _, found, _ in rows], np.float32),
        "cuts": np.array([found.cuts for _, _, found, _ in rows], np.int32),
    }  # fmt: skip
