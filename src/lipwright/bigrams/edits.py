"""Changes to one pair of a set's file; what is shipped, and what others wrote, is not touched."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from lipwright.bigrams.families import (
    Member,
    find_set,
    is_shipped,
    load_family,
    merge,
    moved,
)
from lipwright.bigrams.file import SetFile, editing, is_ours, read_set_text, save_set
from lipwright.bigrams.values import Bigram, BigramSet, Pair, Points, Source
from lipwright.errors import LipwrightError

PathLike = str | os.PathLike[str]


def edit_set(
    name_or_path: PathLike,
    change: Callable[[SetFile, BigramSet], SetFile],
    to: PathLike | None = None,
) -> BigramSet:
    """Change a set's file; others who edit it meanwhile wait.

    Args:
        name_or_path: the set.
        change: what the file says, and the set with all that it inherits, to what it shall say.
        to: another file to write to instead, which is not there yet; of a set that ships, it
            becomes a child.

    Returns:
        The changed set.

    Raises:
        LipwrightError: the set cannot be used or written, ships, or is of another format.
    """
    path = find_set(name_or_path)
    target = path if to is None else Path(to)
    if target.is_file():  # its own edits are not to be lost
        if not target.samefile(path):
            raise LipwrightError(
                f"{target}: is there already; edit that set, or name another file with -o"
            )
        to = None
    if is_shipped(target):
        raise LipwrightError(
            f"{name_or_path}: ships with Lipwright and is not changed; make a child of it with: "
            f"lipwright bigrams new NAME --parent {name_or_path} -o FILE"
        )
    with editing(path):
        if to is None and not is_ours(path, read_set_text(path)):
            raise LipwrightError(
                f"{path}: is of another format; write to another file with -o, or make a set of "
                "it with: lipwright bigrams import"
            )
        family = load_family(path)
        if is_shipped(path):  # its child has what is changed, and no copy of the rest
            name = "-".join(target.stem.split()) or path.stem
            family = (*family, Member(target, SetFile(name, parent=path.stem)))
        said = change(family[-1].said, merge(family))
        whole = merge([*family[:-1], Member(family[-1].path, said)])
        save_set(target, said if to is None else moved(said, family[-1].path, target))
    return whole


def with_curve(
    said: SetFile, whole: BigramSet, pair: Pair, pose: str, points: Points, source: Source = "drawn"
) -> SetFile:
    """A file with one curve of one pair changed or added.

    The file then has the whole pair, although it may have been its parent's. A drawn pair is no
    longer what captures gave: it loses their number and variance.

    Raises:
        LipwrightError: the set has no such class or pose, or the points are wrong.
    """
    _check(whole, pair, pose)
    old = whole.bigrams.get(pair) or Bigram(*pair, {})
    try:
        new = Bigram(*pair, {**old.curves, pose: points}, source, note=old.note)
    except ValueError as error:
        raise LipwrightError(f"{' '.join(pair)}: {error}") from None
    return with_bigram(said, replace(new, count=old.count) if source == "fitted" else new)


def without_curve(said: SetFile, whole: BigramSet, pair: Pair, pose: str) -> SetFile:
    """A file in which a pair leaves a pose at rest.

    Raises:
        LipwrightError: the pair has no such curve.
    """
    _check(whole, pair, pose)
    old = whole.bigrams.get(pair)
    if old is None or pose not in old.curves:
        raise LipwrightError(f"{' '.join(pair)}: has no curve of {pose!r} to take out")
    curves = {name: points for name, points in old.curves.items() if name != pose}
    variance = {name: value for name, value in old.variance.items() if name != pose}
    return with_bigram(said, replace(old, curves=curves, variance=variance))


def with_bigram(said: SetFile, bigram: Bigram) -> SetFile:
    """A file with a whole pair changed or added."""
    return replace(said, bigrams={**said.bigrams, bigram.pair: bigram})


def without_bigram(said: SetFile, pair: Pair) -> SetFile:
    """A file without a pair; that of the parent, if it has one, is then heard again.

    Raises:
        LipwrightError: the file has no such pair.
    """
    if pair not in said.bigrams:
        raise LipwrightError(f"{' '.join(pair)}: this file has no such pair to take out")
    return replace(said, bigrams={key: said.bigrams[key] for key in said.bigrams if key != pair})


def parse_pair(text: str) -> Pair:
    """Two classes with a space, such as "f ah".

    Raises:
        LipwrightError: it is none.
    """
    classes = text.split()
    if len(classes) != 2:
        raise LipwrightError(f'{text[:40]!r} is no pair; write two classes, such as "f ah"')
    return classes[0], classes[1]


def parse_points(text: str) -> Points:
    """Control points as "time value, time value".

    Raises:
        LipwrightError: they are none; `Bigram` checks their times.
    """
    points = []
    for number, part in enumerate(text.split(","), start=1):
        try:
            time, value = map(float, part.split())
        except ValueError:
            raise LipwrightError(
                f"control point {number} is {part.strip()[:40]!r}; write a time and a value, "
                'such as "0 0, 0.4 0.6, 1 0"'
            ) from None
        points.append((time, value))
    return tuple(points)


def _check(whole: BigramSet, pair: Pair, pose: str) -> None:
    for one in pair:
        if one not in whole.classes:
            raise LipwrightError(
                f"{whole.name}: no class {one[:40]!r}; the classes are: {', '.join(whole.classes)}"
            )
    if pose not in whole.poses:
        raise LipwrightError(
            f"{whole.name}: no pose {pose[:40]!r}; the poses are: {', '.join(whole.poses)}"
        )
