"""How a rig follows canonical controls: a linear mapping, or poses of a reference face.

Taylor et al. 2017, section 6, for the second.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from lipwright.controls import CANONICAL, both_sides

LARGEST: Final = 1e6  # a gain, an offset or a rig value; what is larger is a slip of the pen
MODES: Final = 4  # Taylor et al. 2017, section 6: the first four shape modes
SIGMA: Final = 3.0  # standard deviations, the same
SIGMAS: Final = (0.1, 100.0)  # of a pose, either way; nearer to the mean nothing can be told


def is_source(name: str) -> bool:
    """Whether a name is that of a canonical control, or of one without its side (both's mean)."""
    return set(both_sides(name)) <= set(CANONICAL)


def _check_numbers(where: str, numbers: Mapping[str, float]) -> None:
    for name, number in numbers.items():
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise TypeError(f"{where}: {name!r} is {number!r}, not a number")
        if not abs(number) <= LARGEST:
            raise ValueError(f"{where}: {name!r} is {number}, not a number up to {LARGEST:.0f}")


@dataclass(frozen=True)
class Row:
    """What one control of a rig is made of: the gains times canonical controls, and an offset.

    Raises:
        ValueError: a number is not finite, a source is no canonical control, or the clamp is
            empty.
    """

    gains: Mapping[str, float]
    """canonical control to gain; one without its side, as `mouthSmile`, is the mean of both"""
    offset: float = 0.0
    """added; the control's value where all sources rest"""
    clamp: tuple[float, float] | None = None
    """least and greatest value; by default the range of the control"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        _check_numbers("a row", {**self.gains, "offset": self.offset})
        for name in self.gains:
            if not is_source(name):
                raise ValueError(f"{name!r} is no canonical control; see lipwright rigs show arkit")
        if self.clamp is not None:
            low, high = self.clamp
            if not -math.inf < low < high < math.inf:
                raise ValueError(f"the clamp {low} to {high} is empty")
            object.__setattr__(self, "clamp", (float(low), float(high)))
        object.__setattr__(self, "gains", MappingProxyType(dict(self.gains)))


@dataclass(frozen=True)
class Corrective:
    """What is added to a control where several canonical controls act together.

    Raises:
        ValueError: fewer than two sources, one of them is no canonical control, or the gain is
            not finite.
    """

    control: str
    """the rig's"""
    of: tuple[str, ...]
    """at least two canonical controls, whose values are multiplied"""
    gain: float
    """times that product"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        _check_numbers("a corrective", {"gain": self.gain})
        if isinstance(self.of, str) or len(tuple(self.of)) < 2:
            raise ValueError(f"the corrective of {self.control!r} needs two sources or more")
        for name in self.of:
            if not is_source(name):
                raise ValueError(f"{name!r} is no canonical control")
        object.__setattr__(self, "of", tuple(self.of))


@dataclass(frozen=True)
class LinearMapping:
    """Named controls from canonical ones: gain, offset, clamp and correctives."""

    rows: Mapping[str, Row]
    """control of the rig to what it is made of; controls without a row rest"""
    correctives: tuple[Corrective, ...] = ()

    method = "linear"

    def __post_init__(self) -> None:
        """Freeze."""
        object.__setattr__(self, "rows", MappingProxyType(dict(self.rows)))
        object.__setattr__(self, "correctives", tuple(self.correctives))

    @property
    def controls(self) -> set[str]:
        """The controls of the rig that it moves."""
        return set(self.rows) | {corrective.control for corrective in self.correctives}

    @property
    def sources(self) -> set[str]:
        """The canonical controls that it hears."""
        names = [name for row in self.rows.values() for name in row.gains]
        names += [name for corrective in self.correctives for name in corrective.of]
        return {side for name in names for side in both_sides(name)}


@dataclass(frozen=True)
class RigPose:
    """One of the poses that an artist set: the rig where the reference face shows one mode.

    Raises:
        ValueError: the mode is below 1, sigma is near 0 or not finite, or a value is not finite.
    """

    mode: int
    """the shape mode of the reference face, from 1 on"""
    sigma: float
    """standard deviations from the mean, -3 or 3 in the paper"""
    values: Mapping[str, float]
    """control of the rig to its value; controls that are left out are as in the mean pose"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        if isinstance(self.mode, bool) or not isinstance(self.mode, int) or self.mode < 1:
            raise ValueError(f"the mode {self.mode!r} is no number from 1 on")
        if not SIGMAS[0] <= abs(self.sigma) <= SIGMAS[1]:
            raise ValueError(f"mode {self.mode}: sigma is {self.sigma}, not -3 or 3")
        _check_numbers(self.label, self.values)
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    @property
    def label(self) -> str:
        """The pose in words: `mode1-3` and `mode1+3` in the paper's set."""
        return f"mode{self.mode}{self.sigma:+g}"


@dataclass(frozen=True)
class PoseMapping:
    """Equations 2 and 3 of Taylor et al. 2017: poses of the rig for modes of a reference face.

    Raises:
        ValueError: no poses, a pose stands twice, or a row moves a control that poses move.
    """

    mean: Mapping[str, float]
    """r0: control of the rig to its value where the reference face is at its mean; controls that
    are left out rest"""
    poses: tuple[RigPose, ...]
    """usually eight: of each of the first four modes one either way"""
    reference: str = "grid-s1"
    """the reference shape whose modes they show; see `lipwright.face.shapes`"""
    shut: Mapping[str, float] = field(default_factory=dict)
    """control to its value where the lips of the reference face meet; controls that are left out
    follow the poses there too"""
    rows: Mapping[str, Row] = field(default_factory=dict)
    """control that no shape mode shows, of tongue, eyes or brows, to what it is made of"""

    method = "poses"

    def __post_init__(self) -> None:
        """Check and freeze."""
        _check_numbers("the mean pose", self.mean)
        sides = [(pose.mode, pose.sigma > 0) for pose in self.poses]
        if not sides:
            raise ValueError("a mapping by poses needs poses")
        for pose, side in zip(self.poses, sides, strict=True):
            if sides.count(side) > 1:
                raise ValueError(f"two poses show {pose.label[:-1]}...; keep one a side")
        _check_numbers("the shut pose", self.shut)
        if both := sorted(self._posed & set(self.rows)):
            raise ValueError(f"{both[0]!r} is moved by poses and by a row; keep one of them")
        for name in ("mean", "shut", "rows"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        object.__setattr__(self, "poses", tuple(self.poses))

    @property
    def _posed(self) -> set[str]:
        return set(self.mean) | set(self.shut).union(*(pose.values for pose in self.poses))

    @property
    def controls(self) -> set[str]:
        """The controls of the rig that it moves."""
        return self._posed | set(self.rows)


Mapped = LinearMapping | PoseMapping


def unknown_controls(mapping: Mapped, names: Iterable[str]) -> list[str]:
    """The controls that a mapping moves and the rig lacks, sorted."""
    return sorted(mapping.controls - set(names))
