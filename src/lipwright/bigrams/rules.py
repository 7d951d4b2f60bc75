"""The curves of a pair from articulation, for pairs that nobody drew or recorded.

`pose_targets.csv` says where each phone class wants the poses and which articulators are its own.
What a class does not own is its neighbour's: in "do" the lips are round before the tongue leaves
the teeth. Of a closure (PBM, FV) nothing is shared, and what would open it rests while it lasts.

Control points are the polygon of a cubic B-spline, which meets the middle one of three equal
values: therefore each target is three points.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Final

from lipwright.bigrams.values import Bigram, Points
from lipwright.phones import SILENCE

ARTICULATORS: Final = MappingProxyType({
    "jaw": ("open",),
    "lips": ("W", "wide"),
    "tongue": ("tRoof", "tTeeth", "tBack"),
})  # fmt: skip
"""articulator to the FaceFX poses that it makes and that neighbours share; nobody shares ShCh, as
no jaw opens with it (C of open and ShCh, Xu et al. 2013, section 2.2.2)"""

CLOSURES: Final = MappingProxyType({
    "PBM": ("open", "W", "ShCh", "FV"),
    "FV": ("open", "ShCh", "PBM"),
})  # fmt: skip
"""closure to the poses that would open it"""

POSES: Final = ("open", "W", "ShCh", "PBM", "FV", "wide", "tRoof", "tTeeth", "tBack")

CLOSED: Final = 0.5  # a class whose closure is above this holds it
HOLD: Final = MappingProxyType({"PBM": (0.35, 0.65), "FV": (0.35, 0.65)})
"""shares of its phone between which a closure is whole; lips are shut over 30 to 50 % of p and b
and 60 to 90 % of m"""
MIDDLE: Final = (0.5,)  # of its phone, where a single target is met
PARTS: Final = (0.3, 0.7)  # of its phone, where the two targets of a diphthong are met
SPREAD: Final = 1 / 12  # of a phone, from the middle one of three equal points to the others
LEAST: Final = 0.015  # a curve that stays below is not seen, and left out
RAMP: Final = 0.1  # of the neighbour: how far a closure's ramp reaches into it


@dataclass(frozen=True)
class Target:
    """One row of the table: where a class, or one part of a diphthong, wants the face.

    Raises:
        ValueError: a value or share that is not within 0 to 1, a part that is not 0, 1 or 2.
    """

    name: str
    """the class"""
    part: int
    """0 for a whole phone, 1 and 2 for the halves of a diphthong"""
    example: str
    """a word with the phone's letters in capitals"""
    source: str
    values: Mapping[str, float]
    """pose to its value, for each of POSES"""
    shares: Mapping[str, float]
    """articulator to how far it is the class's own; its neighbour has the rest"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        if self.part not in (0, 1, 2):
            raise ValueError(f"{self.name}: part is {self.part}, not 0, 1 or 2")
        for key, value in (*self.values.items(), *self.shares.items()):
            if not 0 <= value <= 1:
                raise ValueError(f"{self.name}: {key} is {value}, not within 0 to 1")
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))
        object.__setattr__(self, "shares", MappingProxyType(dict(self.shares)))

    @property
    def closure(self) -> str:
        """The closure that it holds; empty if it holds none."""
        return next((pose for pose in CLOSURES if self.values[pose] > CLOSED), "")


Targets = Mapping[str, tuple[Target, ...]]
"""class to its one or two targets"""


@cache
def load_targets() -> Targets:
    """The table of targets."""
    text = files("lipwright.bigrams").joinpath("pose_targets.csv").read_text("utf-8")
    targets: dict[str, tuple[Target, ...]] = {}
    for row in csv.DictReader(line for line in text.splitlines() if not line.startswith("#")):
        target = Target(
            name=row["class"],
            part=int(row["part"]),
            example=row["example"],
            source=row["source"],
            values={pose: float(row[pose]) for pose in POSES},
            shares={articulator: float(row[f"own_{articulator}"]) for articulator in ARTICULATORS},
        )
        targets[target.name] = (*targets.get(target.name, ()), target)
    return MappingProxyType(targets)


def rule_curves(first: str, second: str, targets: Targets | None = None) -> dict[str, Points]:
    """The control points of a pair, over the time of both phones; poses that rest are left out.

    Curves begin and end at rest: the pairs on both sides, stitched by maximum, hold the face there.

    Args:
        first: class of the first phone.
        second: class of the second.
        targets: instead of the table that is shipped.

    Raises:
        KeyError: there is no target for a class.
    """
    targets = load_targets() if targets is None else targets
    before, after = targets[first], targets[second]
    curves = {}
    for pose in POSES:
        one = [(time / 2, value) for time, value in _half(before, after[0], pose, -1)]
        other = [(0.5 + time / 2, value) for time, value in _half(after, before[-1], pose, 0)]
        if max(value for _, value in (*one, *other)) >= LEAST:
            points = ((0.0, 0.0), *one, *other, (1.0, 0.0))
            curves[pose] = tuple((round(time, 4), round(value, 3)) for time, value in points)
    return curves


def rule_bigram(first: str, second: str) -> Bigram:
    """The pair by rule.

    Raises:
        KeyError: there is no target for a class.
    """
    return Bigram(first, second, rule_curves(first, second), source="rule")


def _half(
    parts: tuple[Target, ...], other: Target, pose: str, facing: int
) -> list[tuple[float, float]]:
    """The points of one phone, at times from 0 to 1 over it; part `facing` is beside `other`."""
    values = [target.values[pose] for target in parts]
    values[facing] = _shared(parts[facing], other, pose)
    closure = parts[0].closure
    if closure and pose in (closure, *CLOSURES[closure]):
        value = values[0] if pose == closure else 0.0
        return [point for time in HOLD[closure] for point in _three(time, value)]
    if other.closure == pose:  # its ramp, and no more
        return [(0.5, 0.0), (1 - RAMP, 0.0)] if facing else [(RAMP, 0.0), (0.5, 0.0)]
    times = PARTS if len(parts) > 1 else MIDDLE
    return [point for at, value in zip(times, values, strict=True) for point in _three(at, value)]


def _three(time: float, value: float) -> list[tuple[float, float]]:
    return [(time - SPREAD, value), (time, value), (time + SPREAD, value)]


def _shared(target: Target, other: Target, pose: str) -> float:
    """The value of a pose where the target shares its articulator with the neighbour `other`.

    Silence has no shape of its own to share: before and after it a phone looks as in the table.
    """
    if other.name == SILENCE:
        return target.values[pose]
    share = next((target.shares[a] for a, poses in ARTICULATORS.items() if pose in poses), 1.0)
    return share * target.values[pose] + (1 - share) * other.values[pose]
