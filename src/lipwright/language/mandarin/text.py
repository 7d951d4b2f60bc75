"""Mandarin text to words: characters, pinyin, numbers, and words in Latin letters."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.mandarin.amounts import SIGNS, read_amount
from lipwright.language.mandarin.characters import is_character, is_readable, segment
from lipwright.language.mandarin.pinyin import NotPinyinError, syllables_of
from lipwright.language.tokens import LONGEST, without_directions

_MARKS: Final = "，。！？、；：…"  # no white space follows them
_TOKEN: Final = re.compile(f"[^\\s{_MARKS}]+[{_MARKS}]*[”’）》」]*")
_EDGE: Final = "\"“”„‟‘’'()（）[]{}<>《》「」『』【】〈〉〔〕*_~|,.;:!?-–—…·•" + _MARKS
_TAIL: Final = re.compile(f'[{re.escape(",.;:!?")}{_MARKS}"”’）)》」』】\\]]*')
_APOSTROPHES: Final = str.maketrans("’‘ʼʻ`´", "''''''")
_LATIN: Final = re.compile(
    "[A-Za-zÀ-ÖØ-öø-ɏ\u0300-\u036f]+(?:['’:.@/&_-]?[A-Za-z0-9À-ÖØ-öø-ɏ\u0300-\u036f]+)*"
)
_TONED: Final = re.compile("(?:[A-Za-zü:ê']*[a-zü][0-5])+(?:r[0-5]?)?|[a-z]+(?:[0-5][a-z]+)+[0-5]?")
_TONE_MARK: Final = re.compile("[\u0300\u0301\u0304\u030c]")
_BETWEEN_DIGITS: Final = re.compile(r"(?<=\d)：(?=\d)")
_WIDE_SIGNS: Final = str.maketrans({
    **dict.fromkeys("‐‑‒−﹣－", "-"), **dict.fromkeys("〜～∼", "~"), "⁄": "/", "￥": "¥",
})  # fmt: skip
_INITIALS: Final = 3  # letters, capitals that are said one by one: AI, KTV, OK


@dataclass(frozen=True)
class _Line:
    """One line in plain signs, and where each of its characters stands in what was written."""

    number: int
    written: str
    plain: str
    columns: tuple[int, ...]
    """of each character of `plain` in `written`, from 0; and of the end"""

    def written_at(self, start: int, end: int) -> str:
        """What was written between two places of `plain`, with the marks behind it."""
        last = max(self.columns[end], self.columns[start] + 1)  # one may be written for several
        tail = _TAIL.match(self.written, last)
        return self.written[self.columns[start] : tail.end() if tail else last]


class Reader:
    """Turns one text into words."""

    def __init__(self, dictionary: Dictionary | None) -> None:
        """The user's words go before all others."""
        self._dictionary = dictionary or Dictionary({})
        entries = self._dictionary.entries
        self._own = frozenset(word for word in entries if all(map(is_character, word)))
        self._own_characters = frozenset("".join(self._own))

    def read(self, text: str, source: str) -> tuple[SpokenWord, ...]:
        """The words of `text`, which errors call `source`.

        A text with characters may have words of other languages in Latin letters; one without
        is pinyin from end to end.

        Raises:
            LipwrightError: there are no words, or something that cannot be read; with its place.
        """
        text = without_directions(text)
        has_characters = any(is_character(char) for char in text)
        words: list[SpokenWord] = []
        for number, content in enumerate(text.split("\n"), 1):
            if has_characters:
                words += self._mixed(_line(number, content), source)
            else:
                words += self._pinyin(_line(number, content), source)
        if not words:
            raise LipwrightError(f"{source}: has no words; give the words that are spoken")
        return tuple(words)

    def _pinyin(self, line: _Line, source: str) -> Iterator[SpokenWord]:
        """The words of a line without characters: pinyin and numbers."""
        for found in _TOKEN.finditer(line.written):
            written, column = found[0], found.start() + 1
            for word in self._token(written, (source, line.number, column)):
                yield SpokenWord(word, written, line.number, column)

    def _token(self, written: str, place: tuple[str, int, int]) -> list[str]:
        """The words of a token of pinyin or digits; none if it is punctuation alone."""
        source, line, column = place
        if len(written) > LONGEST:
            raise LipwrightError(
                f"{source}: line {line}, column {column}: a word of {len(written)} characters, "
                f"more than {LONGEST}; put spaces between words"
            )
        plain = written.translate(_APOSTROPHES)
        for own in (word_key(plain), word_key(plain).strip(_EDGE)):
            if own in self._dictionary:
                return [own]
        core = plain.strip(_EDGE)
        digits = _line(line, core.strip()).plain
        amount = read_amount(digits, 0) if digits else None
        if amount and amount[1] == len(digits):
            return amount[0]
        try:
            syllables_of(core)
        except NotPinyinError as error:
            at = column + plain.index(core) + error.column
            raise LipwrightError(
                f"{source}: line {line}, column {at}: {error}{remedy(core)}"
            ) from error
        return [word_key(core)] if core else []

    def _mixed(self, line: _Line, source: str) -> Iterator[SpokenWord]:
        """The words of a line of a text with characters."""
        text, start = line.plain, 0
        while start < len(text):
            words, end = self._at(line, start, source)
            written = line.written_at(start, end)
            if is_character(text[start]):
                at = start
                for word in words:
                    own = line.written_at(at, at + len(word))
                    yield SpokenWord(word, own, line.number, line.columns[at] + 1)
                    at += len(word)
            else:
                for word in words:
                    yield SpokenWord(word, written, line.number, line.columns[start] + 1)
            start = end

    def _at(self, line: _Line, start: int, source: str) -> tuple[list[str], int]:
        """The words that begin at a place of the line, and where they end."""
        text = line.plain
        char = text[start]
        if is_character(char):
            end = start
            while end < len(text) and is_character(text[end]):
                if not is_readable(text[end]) and text[end] not in self._own_characters:
                    raise _unreadable(line, end, source)
                end += 1
            return segment(text[start:end], self._own), end
        if amount := read_amount(text, start):
            return amount
        if found := _LATIN.match(text, start):
            return self._latin(found[0], line, start, source), found.end()
        if char in SIGNS and not (char in "<>#" and text[start + 1 : start + 2] == char):
            return [SIGNS[char]], start + 1
        if unicodedata.category(char) in ("Lu", "Ll", "Lt", "Lo", "Lm"):
            raise _foreign(line, start, source)
        return [], start + 1

    def _latin(self, run: str, line: _Line, start: int, source: str) -> list[str]:
        """The words of Latin letters: pinyin where tones say so, else as English reads them."""
        from lipwright.language import get_language

        if len(run) > LONGEST:
            raise LipwrightError(
                f"{source}: line {line.number}, column {line.columns[start] + 1}: a word of "
                f"{len(run)} characters, more than {LONGEST}; put spaces between words"
            )
        plain = run.translate(_APOSTROPHES)
        if word_key(plain) in self._dictionary:
            return [word_key(plain)]
        if is_toned(plain):
            try:
                syllables_of(plain)
            except NotPinyinError:
                pass
            else:
                return [word_key(plain)]
        if plain.isupper() and plain.isalpha() and plain.isascii() and len(plain) <= _INITIALS:
            return list(plain.lower())
        words: list[str] = []
        for part in re.findall(r"\d+(?:\.\d+)?|\D+", plain):
            amount = read_amount(part, 0)
            if amount:
                words += amount[0]
            elif part.strip(_EDGE + "@/&"):
                words += [word.text for word in get_language("en").normalize(part, source)]
        return words


def is_toned(word: str) -> bool:
    """Whether a word in Latin letters has tones, as marks or digits."""
    decomposed = unicodedata.normalize("NFD", word)
    return bool(_TONE_MARK.search(decomposed) or _TONED.fullmatch(word))


def remedy(text: str) -> str:
    """What to do about text that is not pinyin."""
    if text.isdigit():
        return "; write numbers as they are said, as in 'san1'"
    return "; write syllables such as 'ni3 hao3' or 'nǐ hǎo', or characters"


def _line(number: int, written: str) -> _Line:
    """The line in half-width letters, digits and signs, without what is not seen."""
    parts: list[str] = []
    columns: list[int] = []
    for column, char in enumerate(_BETWEEN_DIGITS.sub(":", written)):
        plain = char if char.isascii() or char in _MARKS else _plain(char)
        if len(plain) > 1 and "/" in plain and parts and parts[-1].isdigit():  # the half of 2½
            plain = " " + plain
        parts += plain
        columns += [column] * len(plain)
    return _Line(number, written, "".join(parts), (*columns, len(written)))


@cache
def _plain(char: str) -> str:
    """A character in half width; empty if it only says how others are drawn."""
    if unicodedata.category(char) in ("Cf", "Cc", "Me") or unicodedata.name(char, "").startswith(
        "VARIATION"
    ):
        return ""
    return unicodedata.normalize("NFKC", char.translate(_WIDE_SIGNS)).translate(_WIDE_SIGNS)


def _unreadable(line: _Line, at: int, source: str) -> LipwrightError:
    return LipwrightError(
        f"{source}: line {line.number}, column {line.columns[at] + 1}: {line.plain[at]!r} has no "
        "reading in the lexicon; write its pinyin instead, or add its word to the dictionary"
    )


def _foreign(line: _Line, at: int, source: str) -> LipwrightError:
    run = line.plain[at : at + 12]
    foreign = "".join(char for char in run if _is_foreign(char))
    return LipwrightError(
        f"{source}: line {line.number}, column {line.columns[at] + 1}: {foreign!r} is neither "
        "Chinese characters nor pinyin; choose the language of the text"
    )


def _is_foreign(char: str) -> bool:
    return char.isalpha() and not is_character(char) and not _LATIN.match(char)
