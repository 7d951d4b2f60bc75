"""What a file says of one word, letter, phone or viseme, and the mending of its times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError

ROUNDING: Final = 0.05  # s; what overlaps, falls back or ends late by less is rounding
BRIEF: Final = 0.02  # s; a shorter gap is rounding too


@dataclass(frozen=True)
class Timed:
    """One entry of a file."""

    label: str
    """a word, letter, phone or viseme, as it stands in the file"""
    start: float
    """s"""
    end: float | None
    """s; None where the file does not tell it"""
    place: str
    """where it stands in the file: `word 3`"""

    @property
    def where(self) -> str:
        """Place, label and time, for an error."""
        return f"{self.place} ({self.label[:24]!a}, {self.start:.3f} s)"


def mend(path: Path, entries: Sequence[Timed], duration: float | None) -> list[Timed]:
    """The entries in order, without overlaps, between 0 s and the end of the sound.

    Args:
        path: the file, for errors.
        entries: in the order of the file.
        duration: of the sound in s, or None where that is not known.

    Raises:
        LipwrightError: there are none, or a time is wrong by `ROUNDING` or more.
    """
    if not entries:
        raise LipwrightError(f"{path}: tells no times; save it again from the program that made it")
    at, mended = 0.0, list[Timed]()
    for index, entry in enumerate(entries):
        if entry.start <= at - ROUNDING:
            raise _backwards(path, entry, entries[index - 1] if index else None)
        start = max(entry.start, at)
        end = entry.end
        if end is not None and end <= start - ROUNDING:
            raise LipwrightError(
                f"{path}: {entry.where}: ends at {end:.3f} s, before its start; correct its times"
            )
        at = start
        mended.append(replace(entry, start=start, end=None if end is None else max(end, start)))
    _check_overlaps(path, mended)
    joined = [_until(one, other.start) for one, other in pairwise(mended)] + mended[-1:]
    return [_within(path, entry, duration) for entry in joined]


def _backwards(path: Path, entry: Timed, before: Timed | None) -> LipwrightError:
    if before is None or entry.start < 0:
        return LipwrightError(
            f"{path}: {entry.where}: starts before the sound does; correct its time"
        )
    return LipwrightError(
        f"{path}: {entry.where}: starts before {before.where}, which stands before it; sort the "
        "entries by time, and keep the times of one sound and speaker in a file"
    )


def _check_overlaps(path: Path, entries: Sequence[Timed]) -> None:
    for one, other in pairwise(entries):
        if one.end is not None and one.end - other.start >= ROUNDING:
            raise LipwrightError(
                f"{path}: {other.where}: overlaps {one.where}, which ends at {one.end:.3f} s; "
                "correct the times, and keep those of one speaker in a file"
            )


def _until(entry: Timed, start: float) -> Timed:
    """The entry, which ends where the next one starts if it overlaps it or nearly meets it."""
    if entry.end is None or entry.end < start - BRIEF:
        return entry
    return replace(entry, end=start)


def _within(path: Path, entry: Timed, duration: float | None) -> Timed:
    if duration is None:
        return entry
    last = entry.start if entry.end is None else entry.end
    if last >= duration + ROUNDING:
        raise LipwrightError(
            f"{path}: {entry.where}: reaches {last:.3f} s, past the end of the sound "
            f"({duration:.3f} s); name the file of this sound, or correct the time"
        )
    end = None if entry.end is None else min(entry.end, duration)
    return replace(entry, start=min(entry.start, duration), end=end)
