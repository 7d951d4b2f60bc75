"""`Rig`: what a character lets us move. The ARKit rig ships as `rigs/arkit.json`."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError

RIGS: Final = ("arkit",)
"""names of the rigs that ship"""


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
        if not self.name:
            raise ValueError("a control has no name")
        if not self.low <= self.rest <= self.high or not 0 < self.high - self.low < math.inf:
            raise ValueError(
                f"control {self.name!r}: rest {self.rest} is not within {self.low} to {self.high}"
            )


@dataclass(frozen=True)
class Rig:
    """The controls of a character.

    Raises:
        ValueError: no controls, names that repeat, or a mirror pair of an unknown control.
    """

    name: str
    controls: tuple[Control, ...]
    """at least one, each name once"""
    mirror: MappingProxyType[str, str]
    """control to that of the other side; controls of the middle are left out"""
    source: str = ""
    """where the names come from"""
    license: str = ""
    """terms of use, in a few words"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        names = [control.name for control in self.controls]
        if not self.name or not names:
            raise ValueError("a rig has a name and at least one control")
        if len(set(names)) != len(names):
            raise ValueError(f"rig {self.name!r}: control names repeat")
        for left, right in self.mirror.items():
            if left not in names or self.mirror.get(right) != left:
                raise ValueError(f"rig {self.name!r}: {left!r} and {right!r} are no mirror pair")
        object.__setattr__(self, "controls", tuple(self.controls))
        object.__setattr__(self, "mirror", MappingProxyType(dict(self.mirror)))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the controls, in the rig's order."""
        return tuple(control.name for control in self.controls)

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


@cache
def load_rig(name: str) -> Rig:
    """A rig that ships.

    Raises:
        LipwrightError: no such rig; lists the known ones.
    """
    if name not in RIGS:
        raise LipwrightError(f"no rig {name!r}; the rigs are: {', '.join(RIGS)}")
    data = json.loads(files("lipwright").joinpath("rigs", f"{name}.json").read_text("utf-8"))
    return Rig(
        name=data["name"],
        controls=tuple(Control(**control) for control in data["controls"]),
        mirror=MappingProxyType({**dict(data["mirror"]), **{b: a for a, b in data["mirror"]}}),
        source=data["source"],
        license=data["license"],
    )


def canonical_rig() -> Rig:
    """The rig that all engines speak: ARKit and the tongue controls."""
    rig = load_rig("arkit")
    assert rig.names == CANONICAL  # the file and the table are one set; a test proves it
    return rig
