"""`Rig`: what a character lets us move, and how that follows canonical controls."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.errors import LipwrightError
from lipwright.rig.mapping import Mapped, unknown_controls

CHANNELS: Final = ("tx", "ty", "tz", "rx", "ry", "rz")
"""of a bone: translations in m along the axes of its parent, then rotations in degrees about the
same axes, applied in the order x, y, z"""
MAX_LOOK: Final = 100.0  # a weight; what is far beyond moves a face out of the picture


def as_weights(values: npt.NDArray[np.floating]) -> npt.NDArray[np.float32]:
    """Values as float32; what is beyond its range ends with it."""
    limit = np.finfo(np.float32).max
    return np.clip(values, -limit, limit).astype(np.float32)


@dataclass(frozen=True)
class Control:
    """One thing that a character lets us move.

    Raises:
        ValueError: no name, or low, rest and high are not finite or not in that order.
    """

    name: str
    """as the character's files call it"""
    low: float = 0.0
    """the least value, below `high`"""
    high: float = 1.0
    """the greatest value"""
    rest: float = 0.0
    """the value of the rest pose, from `low` to `high`"""

    def __post_init__(self) -> None:
        """Check."""
        if not self.name or not isinstance(self.name, str):
            raise ValueError("a control has no name")
        if not self.low <= self.rest <= self.high or not 0 < self.high - self.low < math.inf:
            raise ValueError(
                f"control {self.name!r}: rest {self.rest} is not within {self.low} to {self.high}"
            )


@dataclass(frozen=True)
class Bone:
    """A joint that moves what hangs on it; its controls are `NAME.tx` to `NAME.rz`.

    Raises:
        ValueError: no name, its own parent, or a place that is not three finite numbers.
    """

    name: str
    parent: str = ""
    """another bone of the rig; empty for none"""
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, where it is at rest: y up, z forward, +x to the character's own left, from the joint of
    head and neck"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        if not self.name or not isinstance(self.name, str) or self.parent == self.name:
            raise ValueError(f"a bone needs a name, and a parent that is not itself: {self.name!r}")
        if len(self.at) != 3 or not all(math.isfinite(number) for number in self.at):
            raise ValueError(f"the bone {self.name!r} is at {self.at}, not at three numbers of m")
        object.__setattr__(self, "at", tuple(map(float, self.at)))


@dataclass(frozen=True)
class Rig:
    """The controls of a character.

    Raises:
        ValueError: no controls, names that repeat, mirror pairs that are none, looks or a mapping
            of an unknown control or in other than canonical controls or out of range, or bones
            whose parents are unknown or form a circle.
    """

    name: str
    controls: tuple[Control, ...]
    """at least one, each name once"""
    mirror: Mapping[str, str]
    """control to that of the other side; controls of the middle are left out"""
    source: str = ""
    """where the names come from"""
    license: str = ""
    """terms of use, in a few words"""
    looks: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """control to what it looks like at 1 on a human face: canonical control (one without a side
    means both) to weight; empty for a creature that no human face can show"""
    title: str = ""
    """what it is, in a few words"""
    mapping: Mapped | None = None
    """how its controls follow canonical ones; None where nobody has said so"""
    lacks: Mapping[str, str] = field(default_factory=dict)
    """canonical control (one without a side means both) that the rig has no shape for, to what
    replaces it, in words"""
    discrete: bool = False
    """one control at a time shows, in full: drawn mouths"""
    bones: tuple[Bone, ...] = ()
    """of a rig that has some; parents stand before their children"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        names = [control.name for control in self.controls]
        if not self.name or not isinstance(self.name, str) or not names:
            raise ValueError("a rig has a name and at least one control")
        if len(set(names)) != len(names):
            raise ValueError(f"rig {self.name!r}: control names repeat")
        self._check_mirror(names)
        self._check_bones()
        if self.mapping is not None and (unknown := unknown_controls(self.mapping, names)):
            raise ValueError(
                f"rig {self.name!r}: the mapping moves {unknown[0]!r}, which is no control of it"
            )
        for name in self.lacks:
            if not set(both_sides(name)) <= set(CANONICAL):
                raise ValueError(
                    f"rig {self.name!r}: lacks {name!r}, which is no canonical control"
                )
        for control, look in self.looks.items():
            if control not in names:
                raise ValueError(f"rig {self.name!r}: {control!r} has a look and is no control")
            for name, weight in look.items():
                if not set(both_sides(name)) <= set(CANONICAL) or not abs(weight) <= MAX_LOOK:
                    raise ValueError(
                        f"rig {self.name!r}: the look of {control!r} has {name!r} at {weight}, "
                        f"which is no weight of a canonical control, at most {MAX_LOOK:.0f}"
                    )
        looks = {control: MappingProxyType(dict(look)) for control, look in self.looks.items()}
        object.__setattr__(self, "controls", tuple(self.controls))
        object.__setattr__(self, "mirror", MappingProxyType(dict(self.mirror)))
        object.__setattr__(self, "looks", MappingProxyType(looks))
        object.__setattr__(self, "lacks", MappingProxyType(dict(self.lacks)))
        object.__setattr__(self, "bones", tuple(self.bones))

    def _check_mirror(self, names: list[str]) -> None:
        for left, right in self.mirror.items():
            if left not in names or right not in names or left == right:
                raise ValueError(f"rig {self.name!r}: {left!r} and {right!r} are no mirror pair")
            if self.mirror.get(right) != left:
                chain = f"{left!r} to {right!r} to {self.mirror.get(right)!r}"
                raise ValueError(
                    f"rig {self.name!r}: the mirrors {chain} go round; {left!r} and {right!r} are "
                    "no mirror pair"
                )

    def _check_bones(self) -> None:
        before: set[str] = set()
        for bone in self.bones:
            if bone.name in before:
                raise ValueError(f"rig {self.name!r}: the bone {bone.name!r} stands twice")
            if bone.parent and bone.parent not in before:
                raise ValueError(
                    f"rig {self.name!r}: the parent {bone.parent!r} of the bone {bone.name!r} does "
                    "not stand before it"
                )
            before.add(bone.name)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the controls, in the rig's order."""
        return tuple(control.name for control in self.controls)

    @property
    def rest(self) -> npt.NDArray[np.float32]:
        """(C,), the rest pose."""
        return np.array([control.rest for control in self.controls], np.float32)

    def fit(self, clip: Clip) -> Clip:
        """The clip in this rig's controls and order, each within its range.

        Controls that the clip lacks are at rest; others are left out.
        """
        low = np.array([control.low for control in self.controls], np.float32)
        high = np.array([control.high for control in self.controls], np.float32)
        values = clip.select(self.names).values.copy()
        for column, control in enumerate(self.controls):
            if control.name not in clip.names:
                values[:, column] = control.rest
        return Clip(self.names, clip.fps, np.clip(values, low, high))

    def look_of(self, names: Iterable[str]) -> npt.NDArray[np.float32]:
        """(n, C), what each of n controls looks like at 1, in canonical controls."""
        table = np.zeros((len(names := tuple(names)), len(CANONICAL)), np.float32)
        for row, control in enumerate(names):
            for name, weight in self.looks.get(control, {}).items():
                for side in both_sides(name):
                    table[row, CANONICAL.index(side)] = weight
        return table

    def to_canonical(self, clip: Clip) -> Clip:
        """The clip as a human face shows it; controls without looks are not seen."""
        values = clip.values.astype(np.float64) @ self.look_of(clip.names)
        return Clip(CANONICAL, clip.fps, as_weights(values))

    def check_controls(self, names: Iterable[str], who: str) -> None:
        """Refuse names that the rig lacks.

        Raises:
            LipwrightError: there is one; names it, `who` asks for it, and what the rig has.
        """
        for name in names:
            if name not in self.names:
                raise LipwrightError(
                    f"{who} moves the pose {name!r}, which the rig {self.name!r} lacks; it has "
                    f"{', '.join(self.names)}"
                )
