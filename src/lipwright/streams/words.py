"""Phone tracks of files that time words, or the letters of words."""

from __future__ import annotations

import bisect
import unicodedata
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval, Joint, intervals_to_track
from lipwright.streams.placing import distance_to
from lipwright.streams.saying import Said, Span, give_room, say_text, say_words, span_intervals
from lipwright.streams.times import Timed, mend
from lipwright.track import PhoneTrack

JOINT: Final = Joint(tolerance=0.001, gaps="silence")
SHORTEST: Final = 0.001  # s; a shorter letter has no time

# The sounds that Latin letters most often stand for, in English and its neighbours: enough to tell
# which letter of a word a sound belongs to.
LETTERS: Final = MappingProxyType({
    "a": ("AE", "AA", "EY"), "b": ("B",), "c": ("K", "S"), "d": ("D",), "e": ("EH", "IY", "AX"),
    "f": ("F",), "g": ("G", "JH"), "h": ("HH",), "i": ("IH", "AY", "IY"), "j": ("JH", "Y"),
    "k": ("K",), "l": ("L",), "m": ("M",), "n": ("N", "NG"), "o": ("AO", "OW", "AA"), "p": ("P",),
    "q": ("K",), "r": ("R", "ER"), "s": ("S", "Z"), "t": ("T",), "u": ("AH", "UW", "UH"),
    "v": ("V",), "w": ("W", "V"), "x": ("K", "S"), "y": ("Y", "IY", "XIY"), "z": ("Z",),
})  # fmt: skip


def words_to_track(
    path: Path, words: Sequence[Timed], language: str, duration: float | None
) -> PhoneTrack:
    """The track of timed words; the phones of each are spread over its time.

    Raises:
        LipwrightError: a time is wrong, or the language cannot say a word; names the entry.
    """
    mended = mend(path, words, duration)
    spans = give_room(path, mended, say_words(path, mended, language), duration)
    return parts_to_track(path, [span_intervals(span) for span in spans], duration)


def parts_to_track(
    path: Path, parts: Sequence[tuple[list[Interval], list[Interval]]], duration: float | None
) -> PhoneTrack:
    """The track of phones and words that follow each other; gaps are silence."""
    return intervals_to_track(
        path,
        [phone for phones, _ in parts for phone in phones],
        JOINT,
        words=[word for _, words in parts for word in words],
        alphabet="arpabet",
        duration=duration,
    )


def letters_to_track(
    path: Path, letters: Sequence[Timed], language: str, duration: float | None
) -> PhoneTrack:
    """The track of timed letters, white space and marks among them.

    Raises:
        LipwrightError: a time is wrong, or the language cannot say a word; names the letter.
    """
    mended = mend(path, letters, duration)
    text = "".join(letter.label for letter in mended)
    if not any(map(str.isalnum, text)):
        raise LipwrightError(f"{path}: holds no words that can be said; save it again with words")
    owners = [index for index, letter in enumerate(mended) for _ in letter.label]
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)

    def at(line: int, column: int) -> int:
        return min(starts[line - 1] + column - 1, len(owners) - 1)

    tokens: dict[int, tuple[int, list[Said]]] = {}
    for word, said in say_text(
        path, text, language, lambda line, column: mended[owners[at(line, column)]].place
    ):
        first = at(word.line, word.column)
        tokens.setdefault(first, (len(word.written), []))[1].append(said)
    words: list[Timed] = []
    units: list[list[Timed]] = []
    for first, (length, _) in sorted(tokens.items()):
        inside = [mended[owner] for owner in sorted(set(owners[first : first + length]))]
        units.append([letter for letter in inside if letter.label.strip().isalnum()] or inside)
        end = units[-1][-1].end
        words.append(replace(units[-1][0], end=end, label=text[first : first + length]))
    ways = [tuple(said) for _, (_, said) in sorted(tokens.items())]
    spans = give_room(path, words, ways, duration)
    return parts_to_track(path, [_on_letters(span, words, units) for span in spans], duration)


def _on_letters(
    span: Span, words: Sequence[Timed], units: Sequence[Sequence[Timed]]
) -> tuple[list[Interval], list[Interval]]:
    """The phones of a span on the letters that are timed inside it."""
    first = bisect.bisect_left(words, span.start, key=lambda word: word.start)
    stop = bisect.bisect_left(words, span.end, key=lambda word: word.start)
    inside = [
        letter for row in units[first:stop] for letter in row
        if letter.end is not None and letter.end - letter.start > SHORTEST
    ]  # fmt: skip
    if not inside:
        return span_intervals(span)
    ends = [letter.start for letter in inside[1:]] + [span.end]
    gapless = [replace(one, end=end) for one, end in zip(inside, ends, strict=True)]
    return span_intervals(span, gapless, _letter_cost)


def _letter_cost(phone: str, letter: str) -> float:
    plain = unicodedata.normalize("NFD", letter.strip().casefold())[:1]
    sounds = LETTERS.get(plain)
    return 0.0 if sounds is None else distance_to(phone, sounds)
