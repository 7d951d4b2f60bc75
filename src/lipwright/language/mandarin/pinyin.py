"""Written pinyin to syllables: tone marks, tone digits, apostrophes, and words without either."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from lipwright.language.mandarin.syllables import ERHUA, INTERJECTIONS, is_syllable

_TONE_MARKS: Final = frozenset("\u0304\u0301\u030c\u0306\u0300")  # 1 to 4; ă is typed for ǎ
_DIGITS: Final = frozenset("012345")  # 5 and 0 say that there is no tone
_BREAKS: Final = frozenset("'-")
_ALPHABET: Final = frozenset("abcdefghijklmnopqrstuvwxyzüê")
_LONGEST: Final = 7  # letters of a syllable: "zhuangr"
_VOWEL_FIRST: Final = frozenset("aoeê")


class NotPinyinError(ValueError):
    """Letters that are no syllable."""

    def __init__(self, what: str, column: int) -> None:
        """`what` is wrong with the character at `column`, from 0."""
        super().__init__(what)
        self.column = column


@dataclass(frozen=True)
class Letter:
    """One letter of pinyin, a tone digit, or what stands between syllables."""

    text: str
    column: int
    """of its character in what was written, from 0"""
    toned: bool = False
    """it has a tone mark"""


def syllables_of(written: str) -> list[str]:
    """The syllables of a word, without tones and with ü as ü.

    Where neither apostrophe nor tone digit parts them, no syllable but the first begins with a, o
    or e, as pinyin is written ("xian" is one, "xi'an" two), and else they are as few as can be.

    Raises:
        NotPinyinError: it is not pinyin; names the letters.
    """
    found: list[str] = []
    for run in _runs(_letters(written)):
        text = "".join(letter.text for letter in run)
        if text in INTERJECTIONS:
            found.append(text)
        else:
            found += _parted(run)
    return found


def _letters(written: str) -> list[Letter]:
    """What was written as letters: in lower case, ü for v and u:, without tone marks."""
    found: list[Letter] = []
    for column, char in enumerate(unicodedata.normalize("NFC", written.casefold())):
        parts = unicodedata.normalize("NFD", char)
        toned = not _TONE_MARKS.isdisjoint(parts)
        bare = "".join(part for part in parts if part not in _TONE_MARKS)
        text = "ü" if bare == "v" else unicodedata.normalize("NFC", bare)
        if found and not text:  # a mark that no single character holds
            found[-1] = replace(found[-1], toned=True)
        elif found and text == ":" and found[-1].text == "u":
            found[-1] = replace(found[-1], text="ü")
        elif text in _ALPHABET | _DIGITS | _BREAKS:
            found.append(Letter(text, column, toned))
        else:
            raise NotPinyinError(f"{char!r} is no letter of pinyin", column)
    return found


def _runs(letters: Sequence[Letter]) -> Iterator[list[Letter]]:
    """The letters between apostrophes, hyphens and tone digits; "hua1r" is "huar1"."""
    run: list[Letter] = []
    for index, letter in enumerate(letters):
        after = [other.text for other in letters[index + 1 : index + 3]]
        if letter.text in _DIGITS:
            if not run:
                raise NotPinyinError(f"no syllable stands before {letter.text!r}", letter.column)
            if after[:1] == [ERHUA] and (len(after) == 1 or after[1] not in _ALPHABET):
                continue
        if letter.text in _ALPHABET:
            run.append(letter)
        elif run:
            yield run
            run = []
    if run:
        yield run


def _parted(run: Sequence[Letter]) -> list[str]:
    """The syllables of letters with nothing between them."""
    count = len(run)
    # For each start: syllables that begin with a vowel there where none should, all syllables,
    # and the first one's length, of the best way to part what follows.
    best: list[tuple[int, int, int] | None] = [None] * count + [(0, 0, 0)]
    for start in reversed(range(count)):
        wrong = int(start > 0 and run[start].text in _VOWEL_FIRST)
        ways = [
            (rest[0] + wrong, rest[1] + 1, -length)
            for length in range(1, min(_LONGEST, count - start) + 1)
            if _is_one(run[start : start + length]) and (rest := best[start + length])
        ]
        best[start] = min(ways, default=None)
    if best[0] is None:
        raise _unknown(run)
    found, start = [], 0
    while start < count:
        way = best[start]
        assert way is not None  # the best way from 0 passes only through ways to the end
        found.append("".join(letter.text for letter in run[start : start - way[2]]))
        start -= way[2]
    return found


def _is_one(run: Sequence[Letter]) -> bool:
    toned = sum(letter.toned for letter in run)
    return toned <= 1 and is_syllable("".join(letter.text for letter in run))


def _unknown(run: Sequence[Letter]) -> NotPinyinError:
    """What is left behind the syllables from the start on, as far as they reach."""
    reached = {0}
    for start in range(len(run)):
        if start in reached:
            ends = range(start + 1, min(start + _LONGEST, len(run)) + 1)
            reached |= {end for end in ends if _is_one(run[start:end])}
    first = max(reached - {len(run)})
    rest = "".join(letter.text for letter in run[first:])
    whole = "".join(letter.text for letter in run)
    where = f" in {whole!r}" if first else ""
    return NotPinyinError(f"{rest!r}{where} is no syllable of pinyin", run[first].column)
