"""ARKit's names as apps spell them: `EyeBlinkLeft`, `eyeBlink_L`, `blendShape1.eyeBlinkLeft`."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from lipwright.controls import ARKIT
from lipwright.errors import LipwrightError

ANGLES: Final = (
    "headYaw", "headPitch", "headRoll",
    "leftEyeYaw", "leftEyePitch", "leftEyeRoll",
    "rightEyeYaw", "rightEyePitch", "rightEyeRoll",
)  # fmt: skip
MIN_NAMES: Final = 10  # fewer of the 52 are another set of shapes with a few names in common

_NOTED: Final = 5  # names that a note lists


def plain_name(name: str) -> str:
    """`name` in lower case, without what is neither letter nor digit."""
    return re.sub(r"[\W_]+", "", name).casefold()


def _spellings(name: str) -> tuple[str, ...]:
    """Plain names that stand for the control; Apple's own text of eyeBlinkLeft is eyeBlink_L."""
    for side in ("Left", "Right"):
        if name.endswith(side):
            return plain_name(name), plain_name(name.removesuffix(side) + side[0])
    return (plain_name(name),)


_COLUMN: Final = {
    spelling: column for column, name in enumerate(ARKIT + ANGLES) for spelling in _spellings(name)
}
_IGNORED: Final = frozenset(("neutral", "basis"))  # the rest pose, as some apps list it too


@dataclass(frozen=True)
class NameMatch:
    """Which of a file's columns are which controls."""

    columns: tuple[int, ...]
    """columns of the file that are known"""
    targets: tuple[int, ...]
    """for each of them, its place in `ARKIT + ANGLES`"""
    notes: tuple[str, ...]
    """what is unknown or missing, for people"""

    @property
    def has_angles(self) -> bool:
        """Whether all nine angles are there."""
        return set(range(len(ARKIT), len(ARKIT) + len(ANGLES))) <= set(self.targets)


def control_column(name: str) -> int | None:
    """The place of a name in `ARKIT + ANGLES`; None where it is unknown."""
    found = _COLUMN.get(plain_name(name))
    return found if found is not None else _COLUMN.get(plain_name(re.split(r"[.:|/]", name)[-1]))


def match_names(path: str | os.PathLike[str], names: Sequence[str]) -> NameMatch:
    """Find the controls among `names`.

    Raises:
        LipwrightError: fewer than 10 are ARKit's, or two stand for one control.
    """
    known: dict[int, int] = {}
    unknown: list[str] = []
    for column, name in enumerate(names):
        target = control_column(name)
        if target is None:
            if plain_name(name) not in _IGNORED:
                unknown.append(name)
        elif target in known:
            raise LipwrightError(
                f"{path}: {names[known[target]][:40]!r} and {name[:40]!r} are the same control; "
                "delete one"
            )
        else:
            known[target] = column
    missing = [name for target, name in enumerate(ARKIT) if target not in known]
    if len(ARKIT) - len(missing) < MIN_NAMES:
        raise LipwrightError(
            f"{path}: {len(ARKIT) - len(missing)} of ARKit's {len(ARKIT)} names are there, fewer "
            f"than {MIN_NAMES}; export the recording with ARKit's names"
        )
    notes = (_note(missing, "missing and left at rest"), _note(unknown, "unknown and left out"))
    targets = tuple(sorted(known))
    return NameMatch(tuple(known[t] for t in targets), targets, tuple(filter(None, notes)))


def _note(names: list[str], what: str) -> str:
    if not names:
        return ""
    listed = ", ".join(name[:40] for name in names[:_NOTED])
    more = f" and {len(names) - _NOTED} more" if len(names) > _NOTED else ""
    return f"{what}: {listed}{more}"
