"""`Rig`: what a character lets us move. Those that ship are in `rigs/`, one JSON file each."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.errors import LipwrightError

RIGS: Final = ("arkit", "facefx", "smartbody")
"""names of the rigs that ship"""
MAX_LOOK: Final = 100.0  # a weight; what is far beyond moves a face out of the picture


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
class Rig:
    """The controls of a character.

    Raises:
        ValueError: no controls, names that repeat, a mirror pair of an unknown control, or looks
            of an unknown control, in other than canonical controls, or out of range.
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

    def __post_init__(self) -> None:
        """Check and freeze."""
        names = [control.name for control in self.controls]
        if not self.name or not isinstance(self.name, str) or not names:
            raise ValueError("a rig has a name and at least one control")
        if len(set(names)) != len(names):
            raise ValueError(f"rig {self.name!r}: control names repeat")
        for left, right in self.mirror.items():
            if left not in names or self.mirror.get(right) != left:
                raise ValueError(f"rig {self.name!r}: {left!r} and {right!r} are no mirror pair")
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
        return Clip(CANONICAL, clip.fps, clip.values @ self.look_of(clip.names))

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


def load_rig(name: str | Path) -> Rig:
    """A rig that ships, by name, or that of a JSON file.

    Raises:
        LipwrightError: no such rig, lists the known ones; or the file cannot be used.
    """
    if str(name) in RIGS:
        return _shipped(str(name))
    path = Path(name)
    if path.suffix != ".json" or "\0" in str(name):
        raise LipwrightError(
            f"no rig {str(name)!r}; the rigs are: {', '.join(RIGS)}, or name a .json file"
        )
    return read_rig(path)


@cache
def _shipped(name: str) -> Rig:
    data = json.loads(files("lipwright").joinpath("rigs", f"{name}.json").read_text("utf-8"))
    return _from_json(data)


MAX_RIG_BYTES: Final = 4_000_000  # a rig is names and a few numbers


def read_rig(path: Path) -> Rig:
    """The rig of a JSON file, in the form of those that ship.

    Raises:
        LipwrightError: the file cannot be read, or is no rig; says where and why.
    """
    try:
        if path.stat().st_size > MAX_RIG_BYTES:
            raise LipwrightError(f"{path}: over {MAX_RIG_BYTES:,} bytes, which is no rig")
        text = path.read_text("utf-8")
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read ({error.strerror}); name a rig") from error
    except UnicodeDecodeError as error:
        raise LipwrightError(f"{path}: is not UTF-8 text; name a rig's JSON file") from error
    try:
        return _from_json(json.loads(text))
    except json.JSONDecodeError as error:
        raise LipwrightError(
            f"{path}:{error.lineno}:{error.colno}: {error.msg}; a rig is a JSON file"
        ) from error
    except KeyError as error:
        raise LipwrightError(f"{path}: a rig needs {error}, and this one has none") from error
    except (TypeError, ValueError, AttributeError, RecursionError) as error:
        raise LipwrightError(
            f"{path}: is no rig ({error}); compare it with one that works"
        ) from error


def _from_json(data: Any) -> Rig:
    return Rig(
        name=data["name"],
        controls=tuple(Control(**control) for control in data["controls"]),
        mirror={**dict(data["mirror"]), **{b: a for a, b in data["mirror"]}},
        source=data["source"],
        license=data["license"],
        looks=data.get("looks", {}),
    )


def canonical_rig() -> Rig:
    """The rig that all engines speak: ARKit and the tongue controls."""
    rig = load_rig("arkit")
    assert rig.names == CANONICAL  # the file and the table are one set; a test proves it
    return rig
