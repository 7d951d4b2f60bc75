"""`BigramSet`: for pairs of phone classes, the curves that poses follow while the pair is said.

After Xu, Feng, Marsella and Shapiro, "A practical and configurable lip sync method for games"
(2013): section 2.1 for pairs, classes and poses, 2.2 for what the numbers of a set do.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Final, Literal, get_args

from lipwright.phones import PHONES, SILENCE, nearest_phones

Points = tuple[tuple[float, float], ...]
"""control points (time, value): times over both phones, 0 to 1 and never falling"""
Pair = tuple[str, str]
"""two classes, in the order in which they are said"""
Source = Literal["drawn", "fitted", "rule", "imported"]
Limiting = Literal["lower", "widen"]

SOURCES: Final[tuple[Source, ...]] = get_args(Source)
LIMITINGS: Final[tuple[Limiting, ...]] = get_args(Limiting)
MAX_OVERSHOOT: Final = 0.1  # of the normalised time; animators' points stray a little past 0 and 1
MAX_VALUE: Final = 10.0  # full poses, of a control point; more is a slip of the pen
PLUS: Final = " + "
"""stands between the two poses of a constraint, and in no name of a pose"""
OTHERWISE: Final = 2.0  # C of pairs of poses that nothing is said of; Xu et al. 2013, 2.2.2
SPEED_LIMIT: Final = 15.0  # full poses a second; Xu et al. 2013, section 2.2.3
SMOOTHING: Final = 0.05  # s, t_w of section 2.2.1, where it is the user's
SILENCE_REACH: Final = 0.12  # s; ours: the paper says nothing of pauses


def check_points(points: Points) -> None:
    """Refuse what is no row of control points.

    Raises:
        ValueError: no points, a number that is not finite, a time out of 0 to 1 (by more than
            MAX_OVERSHOOT), or before that of the last point, a value beyond MAX_VALUE.
    """
    if not points:
        raise ValueError("a curve has no control points")
    last = -math.inf
    for number, (time, value) in enumerate(points, start=1):
        if not (math.isfinite(time) and math.isfinite(value)):
            raise ValueError(f"control point {number} is ({time}, {value}), not finite")
        if not -MAX_OVERSHOOT <= time <= 1 + MAX_OVERSHOOT:
            raise ValueError(f"control point {number} is at {time:g}, not within 0 to 1")
        if abs(value) > MAX_VALUE:
            raise ValueError(
                f"control point {number} is at the value {value:g}; give -{MAX_VALUE:g} to "
                f"{MAX_VALUE:g}"
            )
        if time < last:
            raise ValueError(
                f"control point {number} is at {time:g}, before the last one at {last:g}; "
                "put them in order of time"
            )
        last = time


def check_pose_name(name: str) -> None:
    """Refuse what no file of a set could hold as the name of a pose.

    Raises:
        ValueError: it is empty, has spaces around it, letters that do not print, or a " + ".
    """
    if not name or name.strip() != name:
        raise ValueError(f"the pose {name[:40]!r} has no name, or spaces around it")
    if not name.isprintable() or PLUS in name:
        raise ValueError(f"{name[:40]!r} is no name of a pose; use letters that print, no {PLUS!r}")


@dataclass(frozen=True, eq=False)
class Bigram:
    """The curves of one pair.

    Raises:
        ValueError: control points that `check_points` refuses, an unknown source, or counts and
            variances below 0.
    """

    first: str
    """class of the first phone"""
    second: str
    """class of the second phone"""
    curves: Mapping[str, Points]
    """pose to its control points, over the time of both phones; other poses rest"""
    source: Source = "drawn"
    """drawn by hand, fitted to captures, made by rule, or imported from another format"""
    count: int = 0
    """how often the pair was heard in the captures that it was fitted to"""
    variance: Mapping[str, float] = field(default_factory=dict)
    """pose to the mean squared difference of those captures from the curve"""
    note: str = ""

    def __post_init__(self) -> None:
        """Check and freeze."""
        if self.source not in SOURCES:
            raise ValueError(f"source is {self.source!r}, not one of {', '.join(SOURCES)}")
        if self.count < 0:
            raise ValueError(f"count is {self.count}, below 0")
        for pose, value in self.variance.items():
            if not 0 <= value < math.inf:
                raise ValueError(f"variance of {pose!r} is {value}, not a number from 0 on")
        curves = {pose: tuple(points) for pose, points in self.curves.items()}
        for pose, points in curves.items():
            try:
                check_points(points)
            except ValueError as error:
                raise ValueError(f"{pose!r}: {error}") from error
        object.__setattr__(self, "curves", MappingProxyType(curves))
        object.__setattr__(self, "variance", MappingProxyType(dict(self.variance)))

    @property
    def pair(self) -> Pair:
        """Both classes."""
        return self.first, self.second


@dataclass(frozen=True)
class Pose:
    """A static pose of the face, moved by one curve.

    Raises:
        ValueError: a name that `check_pose_name` refuses, a priority that is not finite, or an
            unknown way of limiting.
    """

    name: str
    priority: float = 0.0
    """of two poses that exclude each other the one of less priority gives way"""
    limit: Limiting = "lower"
    """what the speed limit does with a peak that is reached too quickly: lower it, or widen it, as
    a closure must be"""

    def __post_init__(self) -> None:
        """Check."""
        check_pose_name(self.name)
        if not math.isfinite(self.priority):
            raise ValueError(f"the priority of {self.name!r} is {self.priority}, not finite")
        if self.limit not in LIMITINGS:
            raise ValueError(f"limit is {self.limit!r}, not one of {', '.join(LIMITINGS)}")


def constraint_key(one: str, other: str) -> Pair:
    """Two poses as a key of constraints, whichever comes first."""
    return (one, other) if one <= other else (other, one)


@dataclass(frozen=True, eq=False)
class BigramSet:
    """Everything that turns phones into curves of poses.

    Raises:
        ValueError: a class with an unknown phone, or a phone in two classes; a bigram, pose or
            constraint that names an unknown class or pose; a number out of range.
    """

    name: str
    language: str
    """ISO 639 code"""
    licence: str
    source: str
    """where it comes from, in a sentence"""
    rig: str
    """the rig whose controls the poses are: a name, or a path"""
    classes: Mapping[str, tuple[str, ...]]
    """phone class to its phones, symbols of the phone table"""
    poses: Mapping[str, Pose]
    """name to pose, in order"""
    bigrams: Mapping[Pair, Bigram]
    constraints: Mapping[Pair, float] = field(default_factory=dict)
    """`constraint_key` of two poses to C, the most that both reach together"""
    otherwise: float = OTHERWISE
    """C of all other pairs of poses"""
    smoothing: float = SMOOTHING
    """s, half of the window within which valleys are removed"""
    speed_limit: float = SPEED_LIMIT
    """full poses a second"""
    silence: float = SILENCE_REACH
    """s of a pause that the pairs at its ends reach into"""
    parent: str = ""
    """the set that this one inherits from; empty for none"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        _check_classes(self.classes)
        self._check_bigrams()
        for key, most in self.constraints.items():
            if key != constraint_key(*key) or key[0] == key[1] or not set(key) <= set(self.poses):
                raise ValueError(f"{key} is no constraint of two known poses")
            _check_range(f"C of {key[0]!r} and {key[1]!r}", most, 0.0)
        _check_range("C otherwise", self.otherwise, 0.0)
        _check_range("smoothing", self.smoothing, 0.0)
        _check_range("silence", self.silence, 0.0)
        if not 0 < self.speed_limit < math.inf:
            raise ValueError(f"the speed limit is {self.speed_limit}, not above 0")
        for name, value in (
            ("classes", {key: tuple(phones) for key, phones in self.classes.items()}),
            ("poses", dict(self.poses)),
            ("bigrams", dict(self.bigrams)),
            ("constraints", dict(self.constraints)),
        ):
            object.__setattr__(self, name, MappingProxyType(value))

    def _check_bigrams(self) -> None:
        for pair, bigram in self.bigrams.items():
            if bigram.pair != pair:
                raise ValueError(f"the bigram {bigram.pair} is filed under {pair}")
            for one in pair:
                if one not in self.classes:
                    raise ValueError(f"the bigram {' '.join(pair)!r} has the unknown class {one!r}")
            for pose in (*bigram.curves, *bigram.variance):
                if pose not in self.poses:
                    raise ValueError(f"the bigram {' '.join(pair)!r} has no such pose: {pose!r}")

    @cached_property
    def _holders(self) -> dict[str, str]:
        return {phone: name for name, phones in self.classes.items() for phone in phones}

    def class_of(self, phone: str) -> str:
        """The class that holds a phone, or else that of the most alike phone that has one.

        Silence is like nothing else: without a class of its own it is in class "".
        """
        if phone in self._holders:
            return self._holders[phone]
        voiced = [known for known in self._holders if known != SILENCE]
        if phone == SILENCE or not voiced:
            return ""
        return self._holders[nearest_phones(phone, voiced)[0]]

    def with_bigram(self, bigram: Bigram) -> BigramSet:
        """The same set with one pair changed or added.

        Raises:
            ValueError: as the constructor.
        """
        return replace(self, bigrams={**self.bigrams, bigram.pair: bigram})


def _check_classes(classes: Mapping[str, tuple[str, ...]]) -> None:
    holders: dict[str, str] = {}
    for name, phones in classes.items():
        if not name or name.split() != [name]:
            raise ValueError(f"the class {name!r} has no name, or white space in it")
        for phone in phones:
            if phone not in PHONES:
                raise ValueError(f"class {name!r} has the phone {phone!r}, unknown to us")
            if phone in holders:
                raise ValueError(f"{phone} is in the classes {holders[phone]!r} and {name!r}")
            holders[phone] = name


def _check_range(what: str, value: float, least: float) -> None:
    if not least <= value < math.inf:
        raise ValueError(f"{what} is {value}, not a number from {least:g} on")
