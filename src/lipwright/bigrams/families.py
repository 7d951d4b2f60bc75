"""Sets and the sets that they inherit from: `load_bigrams` merges a file with its parents."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, TypeVar

from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.file import load_set, read_set_text
from lipwright.bigrams.places import Fault
from lipwright.bigrams.values import (
    OTHERWISE,
    PLUS,
    SILENCE_REACH,
    SMOOTHING,
    SPEED_LIMIT,
    BigramSet,
    Pair,
    Pose,
    constraint_key,
)
from lipwright.errors import LipwrightError

PathLike = str | os.PathLike[str]

SETS: Final = Path(__file__).with_name("sets")
MAX_PARENTS: Final = 20
SUFFIX: Final = ".json"


@dataclass(frozen=True, eq=False)
class Member:
    """One file of a family."""

    path: Path
    said: SetFile


def shipped_sets() -> dict[str, Path]:
    """Name to file of the sets of this version."""
    return {path.stem: path for path in sorted(SETS.glob(f"*{SUFFIX}"))}


def find_set(name_or_path: PathLike) -> Path:
    """The file of a set, by the name of one that ships or by its path.

    Raises:
        LipwrightError: there is neither; lists the names.
    """
    shipped = shipped_sets()
    if isinstance(name_or_path, str) and name_or_path in shipped:
        return shipped[name_or_path]
    try:
        if Path(name_or_path).exists():
            return Path(name_or_path)
    except (OSError, ValueError):  # too long for a path, or not one
        pass
    raise LipwrightError(_no_set(name_or_path))


def is_shipped(path: PathLike) -> bool:
    """Whether a file is one of this version's own, which nobody edits."""
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(SETS))


def load_family(name_or_path: PathLike) -> tuple[Member, ...]:
    """The files of a set: the eldest parent first, the set itself last.

    Raises:
        LipwrightError: one cannot be used, the parents go in a circle, or there are too many.
    """
    path = find_set(name_or_path)
    members: list[Member] = []
    seen: dict[str, str] = {}
    while True:
        real = os.path.realpath(path)
        if real in seen:
            names = [*seen.values()]
            circle = [*names[list(seen).index(real) :], path.name]
            raise LipwrightError(
                f"{name_or_path}: the parents go in a circle: {' -> '.join(circle)}; "
                "take the parent out of one of them"
            )
        if len(seen) > MAX_PARENTS:
            raise LipwrightError(f"{name_or_path}: more than {MAX_PARENTS} parents; use fewer")
        seen[real] = path.name
        said = load_set(path)
        members.append(Member(path, said))
        if not said.parent:
            return tuple(reversed(members))
        path = _parent(members[-1])


def load_bigrams(name_or_path: PathLike) -> BigramSet:
    """A set with all that it inherits: shipped, by its name, or from a file of any kind we read.

    Raises:
        LipwrightError: as `load_family`, or a pair names an unknown class or pose; names file,
            line and column.
    """
    return merge(load_family(name_or_path))


def origins(members: Sequence[Member]) -> dict[Pair, str]:
    """Each pair of a family to the name of the set that it comes from."""
    return {pair: member.said.name for member in members for pair in member.said.bigrams}


def merge(members: Sequence[Member]) -> BigramSet:
    """One set out of a family; what a child says goes before what its parents say.

    Raises:
        LipwrightError: a file names a class or pose that neither it nor its parents have.
    """
    whole = SetFile("")
    rig = ""
    for member in members:
        said = member.said
        whole = _with_child(whole, said)
        rig = _rig_place(member) if said.rig else rig
        try:
            _check_names(said, whole)
        except Fault as fault:
            raise fault.in_file(member.path, read_set_text(member.path)) from None
    try:
        return to_bigrams(whole, rig)
    except ValueError as error:
        raise LipwrightError(f"{members[-1].path}: {error}; correct it") from error


def flatten(bigrams: BigramSet) -> SetFile:
    """A set with all that it has inherited, as one file without a parent."""
    return SetFile(
        name=bigrams.name,
        language=bigrams.language,
        licence=bigrams.licence,
        source=bigrams.source,
        rig=bigrams.rig,
        smoothing=bigrams.smoothing,
        speed_limit=bigrams.speed_limit,
        silence=bigrams.silence,
        classes=bigrams.classes,
        poses=bigrams.poses,
        constraints=bigrams.constraints,
        otherwise=bigrams.otherwise,
        bigrams=bigrams.bigrams,
    )


def moved(said: SetFile, old: PathLike, new: PathLike) -> SetFile:
    """What a file says, written to another place: its relative paths lead where they led."""

    def there(name: str, shipped: Mapping[str, object] | None = None) -> str:
        if not name or (name in shipped if shipped is not None else not _is_path(name)):
            return name
        target = os.path.realpath(Path(old).parent / name)
        return Path(os.path.relpath(target, os.path.realpath(Path(new).parent))).as_posix()

    return replace(
        said,
        parent=there(said.parent, shipped_sets()),
        rig=None if said.rig is None else there(said.rig),
    )


def _no_set(name: PathLike) -> str:
    shipped = shipped_sets()
    known = f"ships: {', '.join(shipped)}" if shipped else "ships none"
    return f"no set {str(name)[:200]!r}: no such file, and this version {known}; name a set"


def _parent(member: Member) -> Path:
    parent = member.said.parent
    shipped = shipped_sets()
    if parent in shipped:
        return shipped[parent]
    path = member.path.parent / parent
    with_text = path.is_file() if "\0" not in parent and len(parent) < 4096 else False
    if not with_text:
        fault = Fault(("parent",), _no_set(parent))
        raise fault.in_file(member.path, read_set_text(member.path))
    return path


def _is_path(rig: str) -> bool:
    """Whether a rig is named by its file, not by its name."""
    return rig.endswith(SUFFIX) or "/" in rig or os.sep in rig


def _rig_place(member: Member) -> str:
    rig = member.said.rig or ""
    return str(member.path.parent / rig) if _is_path(rig) else rig


_T = TypeVar("_T")


def _either(new: _T | None, old: _T | None) -> _T | None:
    return old if new is None else new


def _with_child(parent: SetFile, child: SetFile) -> SetFile:
    taken = {phone for phones in child.classes.values() for phone in phones}
    kept = {
        name: tuple(phone for phone in phones if phone not in taken)
        for name, phones in parent.classes.items()
    }

    return SetFile(
        name=child.name,
        language=_either(child.language, parent.language),
        licence=_either(child.licence, parent.licence),
        source=_either(child.source, parent.source),
        parent=child.parent,
        smoothing=_either(child.smoothing, parent.smoothing),
        speed_limit=_either(child.speed_limit, parent.speed_limit),
        silence=_either(child.silence, parent.silence),
        classes={**kept, **child.classes},
        poses={**parent.poses, **child.poses},
        constraints={
            constraint_key(*pair): most
            for said in (parent, child)
            for pair, most in said.constraints.items()
        },
        otherwise=_either(child.otherwise, parent.otherwise),
        bigrams={**parent.bigrams, **child.bigrams},
    )


def _check_names(said: SetFile, whole: SetFile) -> None:
    """Refuse classes and poses that `whole` lacks; the place is that in the file of `said`."""
    for pair, bigram in said.bigrams.items():
        key = " ".join(pair)
        for one in pair:
            if one not in whole.classes:
                raise Fault(("bigrams", key), f"{key!r} has the unknown class {one!r}", of_key=True)
        for field, names in (("curves", bigram.curves), ("variance", bigram.variance)):
            for pose in names:
                if pose not in whole.poses:
                    raise Fault(
                        ("bigrams", key, field, pose), _unknown_pose(pose, whole.poses), of_key=True
                    )
    for pair in said.constraints:
        for pose in pair:
            if pose not in whole.poses:
                raise Fault(
                    ("constraints", PLUS.join(pair)), _unknown_pose(pose, whole.poses), of_key=True
                )


def _unknown_pose(pose: str, poses: Mapping[str, Pose]) -> str:
    return f"unknown pose {pose[:40]!r}; known are: {', '.join(poses) or 'none'}"


def to_bigrams(whole: SetFile, rig: str) -> BigramSet:
    """A file that inherits nothing more as a set; what it leaves out is as usual.

    Raises:
        ValueError: it is no set.
    """
    return BigramSet(
        name=whole.name,
        language=whole.language or "",
        licence=whole.licence or "",
        source=whole.source or "",
        rig=rig,
        classes=whole.classes,
        poses=whole.poses,
        bigrams=whole.bigrams,
        constraints=whole.constraints,
        otherwise=OTHERWISE if whole.otherwise is None else whole.otherwise,
        smoothing=SMOOTHING if whole.smoothing is None else whole.smoothing,
        speed_limit=SPEED_LIMIT if whole.speed_limit is None else whole.speed_limit,
        silence=SILENCE_REACH if whole.silence is None else whole.silence,
        parent=whole.parent,
    )
