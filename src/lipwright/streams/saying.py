"""Words of a file as the language front end says them, with room to say them in."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval
from lipwright.language import Pronunciation, SpokenWord, get_language
from lipwright.streams.placing import Cost, matched, paced, usual_duration
from lipwright.streams.times import Timed

SHORTEST_PAUSE: Final = 0.1  # s; a stop is shut as long: a shorter gap between words is none
SLOWEST: Final = 2.0  # times the usual duration; a word whose end is not told lasts at most so long
TIGHTEST: Final = 0.03  # s; a word with less time is said together with its neighbour


@dataclass(frozen=True)
class Said:
    """A word, as it is said."""

    text: str
    way: Pronunciation


@dataclass(frozen=True)
class Span:
    """Words in a stretch of time."""

    words: tuple[Said, ...]
    """at least one"""
    start: float
    """s"""
    end: float
    """s, after the start"""
    place: str

    @property
    def phones(self) -> tuple[str, ...]:
        """Symbols of all the words."""
        return tuple(phone for word in self.words for phone in word.way.phones)


def say_text(
    path: Path, text: str, language: str, place: Callable[[int, int], str]
) -> list[tuple[SpokenWord, Said]]:
    """The words of a text and how they are said, where they stand.

    Args:
        path: the file, for errors.
        text: the words.
        language: ISO code.
        place: from line and column of the text to the entry of the file, for errors.

    Raises:
        LipwrightError: the language cannot say them; names the entry.
    """
    speaker = get_language(language)
    try:
        words = speaker.normalize(text, str(path))
        ways = speaker.pronounce_all(words)
    except LipwrightError as error:
        found = re.match(rf"{re.escape(str(path))}: line (\d+), column (\d+)", str(error))
        if found is None:
            raise
        where = place(int(found[1]), int(found[2]))
        raise LipwrightError(f"{path}: {where}{str(error)[found.end() :]}") from None
    return [(word, Said(word.text, way[0])) for word, way in zip(words, ways, strict=True)]


def say_words(path: Path, words: Sequence[Timed], language: str) -> list[tuple[Said, ...]]:
    """How each word is said; () for what is only punctuation.

    Raises:
        LipwrightError: the language cannot say them; names the word.
    """
    said: list[list[Said]] = [[] for _ in words]
    text = "\n".join(word.label for word in words)
    if not any(map(str.isalnum, text)):
        raise LipwrightError(f"{path}: holds no words that can be said; save it again with words")
    for word, way in say_text(path, text, language, lambda line, _: words[line - 1].place):
        said[word.line - 1].append(way)
    return [tuple(ways) for ways in said]


def give_room(
    path: Path, words: Sequence[Timed], said: Sequence[tuple[Said, ...]], duration: float | None
) -> list[Span]:
    """The stretches in which words are said; what has no time of its own joins a neighbour.

    Args:
        path: the file, for errors.
        words: mended, in order.
        said: for each of them; () is passed over.
        duration: of the sound in s, or None.

    Raises:
        LipwrightError: there is no time for any of them.
    """
    kept = [(word, ways) for word, ways in zip(words, said, strict=True) if ways]
    spans: list[Span] = []
    waiting: tuple[Said, ...] = ()
    start = None
    for index, (word, ways) in enumerate(kept):
        start = word.start if start is None else start
        waiting += ways
        after = kept[index + 1][0].start if index + 1 < len(kept) else None
        end = _end_of(word, start, waiting, after, duration)
        if end - start >= TIGHTEST:
            spans.append(Span(waiting, start, end, word.place))
            waiting, start = (), None
    if waiting and spans:
        last = spans.pop()
        spans.append(Span(last.words + waiting, last.start, last.end, last.place))
    if not spans:
        raise LipwrightError(f"{path}: its words last no time; save it again with their times")
    return spans


def _end_of(
    word: Timed, start: float, said: Sequence[Said], after: float | None, duration: float | None
) -> float:
    usual = sum(usual_duration(phone) for one in said for phone in one.way.phones)
    slowest = start + SLOWEST * usual if after is not None else start + usual
    limit = after if after is not None else duration if duration is not None else slowest
    end = word.end if word.end is not None and word.end > start else min(limit, slowest)
    if after is not None and after - end < SHORTEST_PAUSE:
        return after
    return end


def span_intervals(
    span: Span, units: Sequence[Timed] = (), cost: Cost | None = None
) -> tuple[list[Interval], list[Interval]]:
    """Phones and words of a span, on the units inside it where there are any."""
    if units and cost is not None:
        edges = matched(span.phones, units, cost)
    else:
        edges = paced(span.phones, span.start, span.end)
    phones: list[Interval] = []
    words: list[Interval] = []
    for word in span.words:
        first = len(phones)
        marks = word.way.stress or (None,) * len(word.way.phones)
        for phone, mark in zip(word.way.phones, marks, strict=True):
            start, end = edges[len(phones)], edges[len(phones) + 1]
            label = phone if mark is None else f"{phone}{mark}"
            phones.append(Interval(start, end, label, span.place))
        words.append(Interval(edges[first], edges[len(phones)], word.text, span.place))
    return phones, words
