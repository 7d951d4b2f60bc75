"""A rig in words: what it has, what it follows, what it lacks, what may be a slip."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from lipwright.controls import CANONICAL, GROUPS, both_sides
from lipwright.rig.mapping import Corrective, LinearMapping, PoseMapping, Row
from lipwright.rig.values import Control, Rig

SHOWN: Final = 8  # names in one line
_SIDED: Final = re.compile(r"(left|right|[._ ][lr])$", re.IGNORECASE)


def following(rig: Rig) -> set[str]:
    """The controls that follow canonical ones, or modes of a reference face."""
    if rig.mapping is not None:
        return rig.mapping.controls
    return set(rig.names) & set(CANONICAL)


def heard(rig: Rig) -> set[str]:
    """The canonical controls that a rig follows; with poses, those of jaw and lips."""
    if isinstance(rig.mapping, LinearMapping):
        return rig.mapping.sources
    if isinstance(rig.mapping, PoseMapping):
        named = {side for row in rig.mapping.rows.values() for name in row.gains
                 for side in both_sides(name)}  # fmt: skip
        return {*GROUPS["jaw"], *GROUPS["lips"], *named}
    return following(rig)


def describe(rig: Rig) -> Iterator[str]:
    """Lines that say all of it."""
    yield f"{rig.name}: {rig.title}" if rig.title else rig.name
    yield f"source: {rig.source}"
    yield f"terms: {rig.license}"
    if rig.discrete:
        yield "one control at a time shows, in full"
    for bone in rig.bones:
        place = ", ".join(f"{number:g}" for number in bone.at)
        yield f"bone {bone.name} of {bone.parent or 'the head'} at {place} m"
    yield f"{len(rig.controls)} controls:"
    for control in rig.controls:
        yield f"  {_control(rig, control)}"
    if isinstance(rig.mapping, PoseMapping):
        poses = ", ".join(pose.label for pose in rig.mapping.poses)
        yield f"follows poses of the reference face {rig.mapping.reference}: {poses}"
    if rig.lacks:
        yield "lacks:"
    for name, what in rig.lacks.items():
        yield f"  {name}: {what}"


def _control(rig: Rig, control: Control) -> str:
    parts = [f"{control.name}  {control.low:g} to {control.high:g}"]
    if control.rest:
        parts.append(f"rests at {control.rest:g}")
    if control.name in rig.mirror:
        parts.append(f"mirrors {rig.mirror[control.name]}")
    sums = _sums(rig, control.name)
    if sums:
        parts.append(f"= {sums}")
    elif control.name not in following(rig):
        parts.append("rests")
    return ", ".join(parts).replace(", =", " =")


def _sums(rig: Rig, control: str) -> str:
    rows = getattr(rig.mapping, "rows", {})
    row: Row | None = rows.get(control)
    terms = [] if row is None else [f"{gain:g} {name}" for name, gain in row.gains.items()]
    if row is not None and row.offset:
        terms.insert(0, f"{row.offset:g}")
    correctives: tuple[Corrective, ...] = getattr(rig.mapping, "correctives", ())
    terms += [f"{c.gain:g} {' x '.join(c.of)}" for c in correctives if c.control == control]
    text = " + ".join(terms).replace("+ -", "- ")
    if row is not None and row.clamp is not None and text:
        text += f", from {row.clamp[0]:g} to {row.clamp[1]:g}"
    return text


def complaints(rig: Rig) -> Iterator[str]:
    """What can be moved all the same and is perhaps not meant."""
    if not following(rig):
        yield "does not say how it follows speech; run: lipwright rigs fit"
        return
    lacking = {side for name in rig.lacks for side in both_sides(name)}
    silent = [name for name in CANONICAL if name not in heard(rig) | lacking]
    if silent and rig.mapping is not None:
        many = "controls move" if len(silent) > 1 else "control moves"
        yield (
            f"{len(silent)} canonical {many} nothing, and 'lacks' does not say so: "
            f"{_listed(silent)}"
        )
    if "jawOpen" in heard(rig) and "mouthClose" not in heard(rig) | lacking:
        yield "mouthClose moves nothing: the lips will not shut at p, b and m"
    if both := [name for name in CANONICAL if name in lacking & heard(rig)]:
        yield f"'lacks' has what the mapping follows: {_listed(both)}"
    yield from _unpaired(rig)
    yield from _clamped(rig)


def _unpaired(rig: Rig) -> Iterator[str]:
    """Names of one side whose other side is there, and no mirror pair."""
    lower = {name.casefold(): name for name in rig.names}
    for name in rig.names:
        if name in rig.mirror or not _SIDED.search(name):
            continue
        swapped = _SIDED.sub(lambda side: _other(side[0]), name).casefold()
        if swapped in lower and lower[swapped] > name:
            yield f"{name!r} and {lower[swapped]!r} look like two sides, and are no mirror pair"


def _other(side: str) -> str:
    swaps = {"left": "right", "right": "left", "l": "r", "r": "l"}
    key = side.casefold()
    return swaps[key] if key in swaps else side[:-1] + swaps[key[-1]]


def _clamped(rig: Rig) -> Iterator[str]:
    rows = getattr(rig.mapping, "rows", {})
    for control in rig.controls:
        row: Row | None = rows.get(control.name)
        if row is None or row.clamp is None:
            continue
        low, high = row.clamp
        if low < control.low or high > control.high:
            yield (
                f"{control.name!r} is clamped to {low:g} to {high:g}, and its range is "
                f"{control.low:g} to {control.high:g}"
            )


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more
