"""`Units`: the dynamic visemes of a model, and the phone strings that each can say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.engines.dynamic_path import Arcs
from lipwright.engines.dynamic_speech import PARTS, Stretch
from lipwright.errors import LipwrightError
from lipwright.network.arrays import ArrayModel
from lipwright.network.folder import REMEDY
from lipwright.network.meta import ARRAYS_FILE
from lipwright.phones import PHONES

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]
Key = tuple[tuple[int, ...], int, int]
"""phones (or their classes), the part of the first that it begins with, its length in joints"""

MAX_JOINTS: Final = 12  # of a unit; few gestures of GRID are longer
MAX_PHONES: Final = (MAX_JOINTS + PARTS - 2) // PARTS + 1
REST: Final = 0  # the gesture that stands still
LIMIT: Final = 1e6  # of any number of a model: sums of their squares must stay finite
SHORTEST_S: Final = 1e-6  # s, of a unit; nearer joints may be one number late in a long track
CHOICES: Final = 4096  # units of a string at most, which are all compared with all before them
END: Final = 0.4  # joints, of an end from its joint at most: two never cross


@dataclass(frozen=True, eq=False)
class Weights:
    """What the costs weigh against the probability of a phone string, whose weight is 1."""

    smoothness: float
    """of the squared distance of the poses at a joint"""
    rate: float
    """of the squared logarithm of the ratio of a unit's duration to its usual one"""
    cut: float
    """of each end that is cut inside a gesture"""
    alike: float
    """of each phone of a string that only looks alike"""


@dataclass(frozen=True, eq=False)
class Units:
    """G gestures of N poses and C controls; U ways to say a phone string with one of them."""

    phones: tuple[str, ...]
    """that the strings are made of"""
    gestures: npt.NDArray[np.float32]
    """(G, N, C), over the time of each; the first is at rest"""
    gesture: Indices
    """(U,), of each unit"""
    lengths: Indices
    """(U,), joints from its first to its last"""
    marks: Floats
    """(U, MAX_JOINTS + 1), where in its gesture each joint is, 0 to 1, rising; then the last"""
    ends: Floats
    """(U, 2), how far its ends are from its first and last joint, in joints, -END to END"""
    costs: Floats
    """(U,), minus the logarithm of the probability of the string"""
    seconds: Floats
    """(U,), the logarithm of its usual duration in s, from first to last joint"""
    cuts: Floats
    """(U,), how many of its ends are cuts inside its gesture, 0 to 2"""
    first: Floats
    """(U, D), the weighted pose of the visible articulators that it begins with"""
    last: Floats
    """(U, D), the one that it ends with"""
    rest: Floats
    """(D,), the one at rest"""
    strings: Mapping[Key, Indices]
    """the units of each phone string"""
    alike: Mapping[Key, Indices]
    """whole gestures by the classes of phones that look alike"""
    classes: tuple[int, ...]
    """(P,), the class of each phone"""
    weights: Weights

    def arcs(self, stretch: Stretch) -> Iterator[tuple[Arcs, Indices]]:
        """What may begin at each place of a stretch, and which units these are."""
        times = stretch.times(np.arange(stretch.joints + 1))
        classes = tuple(self.classes[phone] for phone in stretch.phones)
        for place in range(stretch.joints):
            chosen, stops, costs = self._units_at(stretch.phones, classes, place)
            seconds = np.log(np.maximum(times[stops] - times[place], SHORTEST_S))
            costs += self.costs[chosen] + self.weights.cut * self.cuts[chosen]
            costs += self.weights.rate * np.square(seconds - self.seconds[chosen])
            yield Arcs(stops, costs, self.first[chosen], self.last[chosen]), chosen

    def _units_at(
        self, phones: tuple[int, ...], classes: tuple[int, ...], place: int
    ) -> tuple[Indices, Indices, Floats]:
        """Units, the place where each stops, and what each costs for looking alike only."""
        found: list[tuple[Indices, int, float]] = []
        part, phone = place % PARTS, place // PARTS
        for length in range(1, min(MAX_JOINTS, PARTS * len(phones) - place) + 1):
            span = slice(phone, (place + length - 1) // PARTS + 1)
            exact = self.strings.get((phones[span], part, length))
            if exact is not None:
                found.append((exact, place + length, 0.0))
            if exact is None or self.cuts[exact].all():
                similar = self.alike.get((classes[span], part, length))
                if similar is not None:
                    extra = self.weights.alike * (span.stop - span.start)
                    found.append((similar, place + length, extra))
        sizes = [len(units) for units, _, _ in found]
        return (
            np.concatenate([units for units, _, _ in found]),
            np.repeat([stop for _, stop, _ in found], sizes),
            np.repeat([extra for _, _, extra in found], sizes),
        )


@lru_cache(maxsize=4)
def units_of(model: ArrayModel) -> Units:
    """The units of a model, checked.

    Raises:
        LipwrightError: an array is missing or of another shape, or has values that cannot be.
    """
    try:
        return make_units(_read(model), model.meta.features.phones)
    except ValueError as error:
        raise LipwrightError(f"{model.path / ARRAYS_FILE}: {error}; {REMEDY}") from None


def _read(model: ArrayModel) -> dict[str, npt.NDArray[Any]]:
    controls = len(model.meta.controls)
    wanted: dict[str, tuple[str, tuple[int | None, ...]]] = {
        "gestures": ("f", (None, None, controls)), "visible": ("f", (controls,)),
        "weights": ("f", (4,)), "gesture": ("i", (None,)), "lengths": ("i", (None,)),
        "string": ("i", (None,)), "marks": ("f", (None, MAX_JOINTS + 1)), "ends": ("f", (None, 2)),
        "costs": ("f", (None,)), "seconds": ("f", (None,)), "cuts": ("i", (None,)),
        "strings": ("i", (None, MAX_PHONES)), "parts": ("i", (None,)),
    }  # fmt: skip
    return {name: model.array(name, *form) for name, form in wanted.items()}


def make_units(arrays: Mapping[str, npt.NDArray[Any]], phones: tuple[str, ...]) -> Units:
    """The units of arrays that have the right kinds and shapes, checked for what they hold.

    Raises:
        ValueError: names an array whose values cannot be.
    """
    check_arrays(arrays, len(phones))
    names = sorted({PHONES[phone].common for phone in phones})
    classes = tuple(names.index(PHONES[phone].common) for phone in phones)
    marks, lengths = arrays["marks"].astype(np.float64), arrays["lengths"].astype(np.intp)
    shown = np.flatnonzero(arrays["visible"])
    seen = arrays["gestures"][:, :, shown] * arrays["visible"][shown].astype(np.float64)
    gesture = arrays["gesture"].astype(np.intp)
    strings, alike = _index(arrays, classes)
    if max(map(len, strings.values())) > CHOICES:
        raise ValueError(f"'strings' has more than {CHOICES} units for one string")
    last = marks[np.arange(len(marks)), lengths]
    for part in range(len(phones) * PARTS):
        if ((part // PARTS,), part % PARTS, 1) not in strings:
            raise ValueError(f"'strings' lacks a part of {phones[part // PARTS]}")
    return Units(
        phones, arrays["gestures"], gesture, lengths, marks, arrays["ends"].astype(np.float64),
        arrays["costs"].astype(np.float64), arrays["seconds"].astype(np.float64),
        arrays["cuts"].astype(np.float64), pose_at(seen, gesture, marks[:, 0]),
        pose_at(seen, gesture, last), seen[REST, 0], strings, alike, classes,
        Weights(*map(float, arrays["weights"])),
    )  # fmt: skip


def check_arrays(arrays: Mapping[str, npt.NDArray[Any]], phones: int) -> None:
    """Refuse what would point outside of an array, or run backwards.

    Raises:
        ValueError: names the array.
    """
    units, strings = len(arrays["gesture"]), len(arrays["strings"])

    def need(holds: Any, name: str) -> None:
        if not np.all(holds):
            raise ValueError(f"{name!r} has values that cannot be")

    for name, array in arrays.items():
        need(array.size > 0, name)
        need(np.abs(array.astype(np.float64)) <= LIMIT, name)
    for name in ("lengths", "string", "marks", "ends", "costs", "seconds", "cuts"):
        need(len(arrays[name]) == units, name)
    need(len(arrays["parts"]) == strings, "parts")
    need(arrays["gestures"].shape[1] >= 2, "gestures")
    need((arrays["gesture"] >= 0) & (arrays["gesture"] < len(arrays["gestures"])), "gesture")
    need((arrays["string"] >= 0) & (arrays["string"] < strings), "string")
    need((arrays["parts"] >= 0) & (arrays["parts"] < PARTS), "parts")
    need((arrays["lengths"] >= 1) & (arrays["lengths"] <= MAX_JOINTS), "lengths")
    need((arrays["cuts"] >= 0) & (arrays["cuts"] <= 2), "cuts")
    need((arrays["marks"] >= 0) & (arrays["marks"] <= 1), "marks")
    need(np.diff(arrays["marks"], axis=1) >= 0, "marks")
    need(np.abs(arrays["ends"]) <= END + 1e-6, "ends")
    need(arrays["weights"] >= 0, "weights")
    need(arrays["visible"] >= 0, "visible")
    need((arrays["strings"] >= -1) & (arrays["strings"] < phones), "strings")
    counts = (arrays["strings"] >= 0).sum(axis=1)
    spans = (arrays["parts"][arrays["string"]] + arrays["lengths"] - 1) // PARTS + 1
    need(spans == counts[arrays["string"]], "lengths")


def _index(
    arrays: Mapping[str, npt.NDArray[Any]], classes: tuple[int, ...]
) -> tuple[dict[Key, Indices], dict[Key, Indices]]:
    """Units by phone string, and whole gestures by classes of phones."""
    strings: dict[Key, list[int]] = {}
    alike: dict[Key, list[int]] = {}
    said = [tuple(int(p) for p in row if p >= 0) for row in arrays["strings"]]
    parts = arrays["parts"].tolist()
    rows = zip(arrays["string"].tolist(), arrays["lengths"].tolist(), arrays["cuts"].tolist(),
               strict=True)  # fmt: skip
    for unit, (string, length, cuts) in enumerate(rows):
        key = said[string], parts[string], length
        strings.setdefault(key, []).append(unit)
        if not cuts:
            similar = tuple(classes[phone] for phone in said[string]), parts[string], length
            alike.setdefault(similar, []).append(unit)
    return _frozen(strings), _frozen(alike)


def _frozen(index: Mapping[Key, list[int]]) -> dict[Key, Indices]:
    return {key: np.array(units[: CHOICES + 1], np.intp) for key, units in index.items()}


def pose_at(gestures: npt.NDArray[Any], which: Indices, place: Floats) -> Floats:
    """(U, D), of gestures (G, N, D), the poses at places (U,) from 0 to 1 of some (U,)."""
    poses = gestures.shape[1]
    low = np.minimum((place * (poses - 1)).astype(np.intp), poses - 2)
    share = (place * (poses - 1) - low)[:, None]
    mixed = gestures[which, low] * (1 - share) + gestures[which, low + 1] * share
    return np.asarray(mixed, np.float64)
