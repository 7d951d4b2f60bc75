"""The fields of our file of phone bigrams: from JSON values to a `SetFile`, or a `Fault`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from lipwright.bigrams.curves import check_curve, read_points
from lipwright.bigrams.jsonvalues import (
    Path,
    check_keys,
    from_zero,
    kind_of,
    member,
    number_at,
    object_at,
    shown,
    text_at,
    word_at,
)
from lipwright.bigrams.places import Fault
from lipwright.bigrams.values import (
    LIMITINGS,
    PLUS,
    SOURCES,
    Bigram,
    Pair,
    Pose,
)
from lipwright.phones import PHONES

FORMAT: Final = "lipwright-bigrams"
VERSION: Final = 1  # raise when the layout changes
OTHERWISE_KEY: Final = "otherwise"

SET_KEYS: Final = (
    "format", "version", "name", "language", "licence", "source", "parent", "rig", "smoothing_s",
    "speed_limit", "silence_s", "classes", "poses", "constraints", "bigrams",
)  # fmt: skip
POSE_KEYS: Final = ("priority", "limit")
BIGRAM_KEYS: Final = ("source", "count", "note", "curves", "variance")


@dataclass(frozen=True, eq=False)
class SetFile:
    """What one file of phone bigrams says; None and what is missing come from the parent."""

    name: str
    language: str | None = None
    licence: str | None = None
    source: str | None = None
    parent: str = ""
    """name of a set that ships, or a path relative to this file; empty for none"""
    rig: str | None = None
    """name of a rig that ships, or a path relative to this file"""
    smoothing: float | None = None
    """s"""
    speed_limit: float | None = None
    """full poses a second"""
    silence: float | None = None
    """s"""
    classes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    poses: Mapping[str, Pose] = field(default_factory=dict)
    constraints: Mapping[Pair, float] = field(default_factory=dict)
    """two poses, in the order in which they are written, to C"""
    otherwise: float | None = None
    bigrams: Mapping[Pair, Bigram] = field(default_factory=dict)


def read_fields(content: object) -> SetFile:
    """The set of the value of our JSON, without a look at its parents.

    Raises:
        Fault: something in it is wrong.
    """
    fields = object_at(content, ())
    _check_format(fields)
    check_keys(fields, SET_KEYS, ())
    name = word_at(fields.get("name"), ("name",)) if "name" in fields else ""
    if not name:
        raise Fault((), 'has no "name"; give the set one')
    parent = word_at(fields["parent"], ("parent",)) if "parent" in fields else ""
    if not parent:
        for key in ("language", "licence", "source", "rig"):
            if key not in fields:
                raise Fault((), f'has no "{key}", nor a "parent" to inherit it from; write it')
    constraints, otherwise = _constraints(fields)
    return SetFile(
        name=name,
        **{key: text_at(fields[key], (key,)) if key in fields else None
           for key in ("language", "licence", "source")},
        parent=parent,
        rig=word_at(fields["rig"], ("rig",)) if "rig" in fields else None,
        smoothing=from_zero(fields, "smoothing_s"),
        speed_limit=from_zero(fields, "speed_limit", above=True),
        silence=from_zero(fields, "silence_s"),
        classes=_classes(fields),
        poses={pose: _pose(pose, value) for pose, value in member(fields, "poses").items()},
        constraints=constraints,
        otherwise=otherwise,
        bigrams=dict(_bigrams(fields)),
    )  # fmt: skip


def _check_format(fields: Mapping[str, Any]) -> None:
    if fields.get("format") != FORMAT:
        at: Path = ("format",) if "format" in fields else ()
        raise Fault(at, f'is no set of phone bigrams; expected "format": "{FORMAT}"')
    version = fields.get("version")
    if type(version) is not int or version < 1:
        raise Fault(("version",), f'has no version; expected "version": {VERSION}')
    if version > VERSION:
        raise Fault(
            ("version",),
            f"is of version {shown(version)}, and this Lipwright reads up to {VERSION}; update it",
        )


def _constraints(fields: Mapping[str, Any]) -> tuple[dict[Pair, float], float | None]:
    found: dict[Pair, float] = {}
    otherwise = None
    for key, value in member(fields, "constraints").items():
        path: Path = ("constraints", key)
        most = number_at(value, path)
        if most < 0:
            raise Fault(path, f"C of {key!r} is {most:g}, below 0; write 0 or more")
        if key == OTHERWISE_KEY:
            otherwise = most
            continue
        poses = key.split(PLUS)
        if len(poses) != 2 or poses[0] == poses[1] or not all(poses):
            raise Fault(path, f'{key!r} is not "POSE + POSE" or "{OTHERWISE_KEY}"', of_key=True)
        if (poses[1], poses[0]) in found:
            raise Fault(path, f"{key!r} stands twice; delete one", of_key=True)
        found[poses[0], poses[1]] = most
    return found, otherwise


def _classes(fields: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    found: dict[str, tuple[str, ...]] = {}
    holders: dict[str, str] = {}
    for name, phones in member(fields, "classes").items():
        if name.split() != [name] or not name.isprintable():
            raise Fault(
                ("classes", name), f"the class {name!r} is empty or has white space", of_key=True
            )
        if not isinstance(phones, list):
            raise Fault(("classes", name), f"{name!r} is {kind_of(phones)}, not a list of phones")
        for place, phone in enumerate(phones):
            path: Path = ("classes", name, place)
            if not isinstance(phone, str) or phone not in PHONES:
                raise Fault(
                    path,
                    f"{shown(phone)} is no phone of the phone table ('lipwright phones' lists it)",
                )
            if phone in holders:
                raise Fault(path, f"{phone} is in the class {holders[phone]!r} already")
            holders[phone] = name
        found[name] = tuple(phones)
    return found


def _pose(name: str, value: object) -> Pose:
    path: Path = ("poses", name)
    fields = object_at(value, path)
    check_keys(fields, POSE_KEYS, path)
    priority = number_at(fields.get("priority", 0), (*path, "priority"))
    limit = fields.get("limit", LIMITINGS[0])
    if limit not in LIMITINGS:
        raise Fault(
            (*path, "limit"),
            f"the limit of {name!r} is {shown(limit)}, not one of {', '.join(LIMITINGS)}",
        )
    try:
        return Pose(name, priority, limit)
    except ValueError as error:
        raise Fault(path, str(error), of_key=True) from None


def _bigrams(fields: Mapping[str, Any]) -> Iterable[tuple[Pair, Bigram]]:
    for key, value in member(fields, "bigrams").items():
        classes = key.split()
        if len(classes) != 2 or " ".join(classes) != key:
            raise Fault(
                ("bigrams", key),
                f'{key!r} is not two classes with a space between, such as "f ah"',
                of_key=True,
            )
        yield (classes[0], classes[1]), _bigram(classes[0], classes[1], value)


def _bigram(first: str, second: str, value: object) -> Bigram:
    path: Path = ("bigrams", f"{first} {second}")
    fields = object_at(value, path)
    check_keys(fields, BIGRAM_KEYS, path)
    source = fields.get("source", SOURCES[0])
    if source not in SOURCES:
        raise Fault(
            (*path, "source"),
            f"the source of {path[-1]!r} is {shown(source)}, not one of {', '.join(SOURCES)}",
        )
    count = fields.get("count", 0)
    if type(count) is not int or count < 0:
        raise Fault(
            (*path, "count"),
            f"the count of {path[-1]!r} is {shown(count)}, not a whole number from 0 on",
        )
    note = text_at(fields.get("note", ""), (*path, "note"))
    if not isinstance(fields.get("curves"), dict):
        raise Fault(path, f'{path[-1]!r} has no "curves"; write {{}} where every pose rests')
    variance = {}
    for pose, number in member(fields, "variance", path).items():
        variance[pose] = number_at(number, (*path, "variance", pose))
        if variance[pose] < 0:
            raise Fault((*path, "variance", pose), "a variance below 0")
    curves = {}
    for pose, rows in fields["curves"].items():
        curves[pose] = read_points(rows, (*path, "curves", pose))
    try:
        return Bigram(first, second, curves, source, count, variance, note)
    except ValueError:
        for pose, points in curves.items():
            check_curve(points, (*path, "curves", pose))
        raise  # nothing else is left to be wrong
