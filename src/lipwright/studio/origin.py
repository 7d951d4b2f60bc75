"""Which file an editor writes, and the set that it starts from."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from lipwright.bigrams.families import (
    SUFFIX,
    find_set,
    is_shipped,
    load_bigrams,
    load_family,
    merge,
)
from lipwright.bigrams.fields import FORMAT, SetFile
from lipwright.bigrams.file import read_set_text, save_set
from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.errors import LipwrightError
from lipwright.studio.journal import digest


@dataclass(frozen=True, eq=False)
class Origin:
    """A set's file as it is now, or as it will be when it is first saved."""

    path: Path
    """the file that is written"""
    content: SetFile
    """what it says"""
    digest: str
    """of the file; "" as long as there is none"""
    merged: BigramSet
    """with all that its parents say"""
    inherited: Mapping[Pair, Bigram]
    """the pairs of its parents"""

    def save(self, own: Mapping[Pair, Bigram]) -> Origin:
        """Write the file with these pairs of its own; what it is then.

        Raises:
            LipwrightError: it cannot be written.
        """
        save_set(self.path, replace(self.content, bigrams=dict(own)))
        return open_own(self.path)


def open_origin(name: str, out: Path | None) -> Origin:
    """What to edit: the user's own file, or a child set of what may not be written.

    Args:
        name: a set that ships, or a file.
        out: the child set to edit, which is made at the first save where there is none; by
            default a file of the user's is edited itself, and for another set `my-NAME.json`
            in this folder.

    Raises:
        LipwrightError: a set cannot be used, or `out` is no child of it.
    """
    place = find_set(name)
    if out is None and _is_own(place):
        return open_own(place)
    parent = load_bigrams(place)
    path = out if out is not None else Path(f"my-{parent.name}{SUFFIX}")
    if path.suffix.lower() != SUFFIX:
        raise LipwrightError(f"{path}: a set of phone bigrams is written as {SUFFIX}; name one")
    if not path.exists():
        return _new_child(path, place, parent)
    if path.samefile(place):
        raise LipwrightError(f"{path}: is the set itself; leave out -o to edit it")
    origin = open_own(path)
    family = load_family(path)
    if len(family) < 2 or not family[-2].path.samefile(place):
        raise LipwrightError(
            f"{path}: is no child of {name}, but of {origin.content.parent or 'no set'}; name "
            "another file with -o"
        )
    return origin


def open_own(path: Path) -> Origin:
    """The user's own file.

    Raises:
        LipwrightError: it cannot be used, or ships with Lipwright.
    """
    if is_shipped(path):
        raise LipwrightError(f"{path}: ships with Lipwright and is not edited; name another file")
    before = digest(path)
    family = load_family(path)
    if digest(path) != before:
        raise LipwrightError(f"{path}: is just being written; open it again")
    inherited = merge(family[:-1]).bigrams if len(family) > 1 else {}
    return Origin(path, family[-1].said, before, merge(family), inherited)


def _new_child(path: Path, place: Path, parent: BigramSet) -> Origin:
    if not path.absolute().parent.is_dir():
        raise LipwrightError(f"{path}: its folder does not exist; make it, or name another file")
    reference = Path(os.path.relpath(place, path.absolute().parent)).as_posix()
    if is_shipped(place):
        reference = place.stem
    content = SetFile(name=path.stem, parent=reference)
    merged = replace(parent, name=content.name, parent=reference)
    return Origin(path, content, "", merged, parent.bigrams)


def _is_own(path: Path) -> bool:
    """Whether it is the user's and in our own format; sets in those of others are only read."""
    return not is_shipped(path) and f'"{FORMAT}"' in read_set_text(path)
