"""Phone tracks of files that time visemes, with or without the words that they belong to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval
from lipwright.phones import SILENCE
from lipwright.streams.placing import distance_to
from lipwright.streams.saying import SHORTEST_PAUSE, Span, give_room, say_words, span_intervals
from lipwright.streams.times import Timed, mend
from lipwright.streams.words import parts_to_track
from lipwright.track import PhoneTrack

LAST: Final = 0.15  # s; of a last viseme whose end nobody tells, about a vowel before a pause
EARLY: Final = 0.025  # s; a viseme may start so long before its word does

Visemes = Mapping[str, tuple[str, ...]]
"""name to the phones that look so, the one that stands for it first; silence is (SILENCE,)"""


def visemes_to_track(
    path: Path,
    visemes: Sequence[Timed],
    table: Visemes,
    *,
    words: Sequence[Timed] = (),
    language: str = "en",
    duration: float | None = None,
) -> PhoneTrack:
    """The track of timed visemes.

    With words, the phones of each stand on the visemes inside it. What no word accounts for is
    the phone that stands for its viseme.

    Raises:
        LipwrightError: a time is wrong, a viseme unknown, or the language cannot say a word.
    """
    for viseme in visemes:
        if viseme.label not in table:
            known = ", ".join(table)
            raise LipwrightError(
                f"{path}: {viseme.where}: no such viseme; the known ones are {known}"
            )
    row = _gapless(mend(path, visemes, duration), table, duration)
    if not row:
        raise LipwrightError(f"{path}: its visemes last no time; save it again with their times")
    if not words:
        return parts_to_track(path, [([_alone(v, table)], []) for v in row], duration)
    mended = mend(path, words, duration)
    spans = give_room(path, mended, say_words(path, mended, language), duration)
    owners = _owners(row, spans, table, [word for word in mended if word.end is not None])
    parts: list[tuple[list[Interval], list[Interval]]] = []
    for span, group in groupby(zip(_joined(spans, owners), row, strict=True), lambda one: one[0]):
        units = [viseme for _, viseme in group]
        if span is None:
            parts += [([_alone(viseme, table)], []) for viseme in units]
        else:
            cost = lambda phone, name: distance_to(phone, table[name])  # noqa: E731
            parts.append(span_intervals(span, units, cost))
    return parts_to_track(path, parts, duration)


def _gapless(row: Sequence[Timed], table: Visemes, duration: float | None) -> list[Timed]:
    """The visemes that last, each until the next one; short silences go to the one before."""
    found: list[Timed] = []
    for index, viseme in enumerate(row):
        end = row[index + 1].start if index + 1 < len(row) else _last_end(viseme, table, duration)
        length = end - viseme.start
        if found and (length < 0.001 or (_silent(viseme, table) and length < SHORTEST_PAUSE)):
            found[-1] = replace(found[-1], end=end)
        elif length > 0:
            found.append(replace(viseme, end=end))
    return found


def _last_end(viseme: Timed, table: Visemes, duration: float | None) -> float:
    if viseme.end is not None:
        return viseme.end
    if duration is None:
        return viseme.start + LAST
    return duration if _silent(viseme, table) else min(duration, viseme.start + LAST)


def _silent(viseme: Timed, table: Visemes) -> bool:
    return table[viseme.label] == (SILENCE,)


def _alone(viseme: Timed, table: Visemes) -> Interval:
    assert viseme.end is not None  # `_gapless` has filled it in
    return Interval(viseme.start, viseme.end, table[viseme.label][0], viseme.place)


def _owners(
    row: Sequence[Timed], spans: Sequence[Span], table: Visemes, ended: Sequence[Timed]
) -> list[int | None]:
    """The span that each viseme belongs to; a pause ends a word, and so does its known end."""
    owners: list[int | None] = []
    at, open_ = -1, False
    for viseme in row:
        while at + 1 < len(spans) and spans[at + 1].start <= viseme.start + EARLY:
            at, open_ = at + 1, True
        late = bool(ended) and at >= 0 and viseme.start > spans[at].end + SHORTEST_PAUSE
        open_ = open_ and not _silent(viseme, table) and not late
        owners.append(at if open_ else None)
    return owners


def _joined(spans: Sequence[Span], owners: Sequence[int | None]) -> list[Span | None]:
    """The span of each viseme, with the words of spans that have no viseme in the next that has."""
    having = sorted({owner for owner in owners if owner is not None})
    whole: dict[int, Span] = {}
    first = 0
    for owner in having:
        stop = len(spans) if owner == having[-1] else owner + 1
        words = tuple(word for span in spans[first:stop] for word in span.words)
        whole[owner] = replace(spans[owner], words=words)
        first = owner + 1
    return [None if owner is None else whole[owner] for owner in owners]
