"""What espeak-ng is given to say, and which written word each part of it belongs to."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from lipwright.controls import is_text
from lipwright.errors import LipwrightError

MANDARIN: Final = "cmn-latn-pinyin"
"""the voice that reads pinyin; it reads other Latin letters as English"""
_TOKEN: Final = re.compile(r"\S+")
# Scripts without spaces, whose words only espeak-ng can tell apart.
UNSPACED: Final = re.compile("[\u0e00-\u0eff\u1000-\u109f\u1780-\u17ff\u2e80-\ua4cf\uf900-\ufaff]")
_HANZI: Final = re.compile("[\u3007\u3400-\u4dbf\u4e00-\u9fff\uf900-\ufaff\U00020000-\U0003ffff]+")
_LATIN: Final = re.compile(r"[^\W_\u3007\u3400-\u9fff\uf900-\ufaff\U00020000-\U0003ffff]+")
_TONES: Final = {"\u0304": "1", "\u0301": "2", "\u030c": "3", "\u0300": "4"}  # marks of pinyin
_TONE: Final = re.compile("[1-5\u0304\u0301\u030c\u0300]")
_NEUTRAL: Final = "5"


@dataclass(frozen=True)
class Span:
    """Characters of a text that belong to one word."""

    start: int
    stop: int
    word: int
    """index of the word; -1 where espeak-ng tells the words apart"""


@dataclass(frozen=True)
class SaidText:
    """What espeak-ng is given."""

    text: str
    spans: tuple[Span, ...]
    """in order"""
    words: tuple[str, ...]
    """as the user wrote them, without white space and the punctuation around them"""


def plain_text(text: str) -> SaidText:
    """A text as it is written; its words stand between spaces."""
    spans: list[Span] = []
    words: list[str] = []
    for found in _TOKEN.finditer(text):
        if UNSPACED.search(found[0]):
            spans.append(Span(found.start(), found.end(), -1))
        else:
            spans.append(Span(found.start(), found.end(), len(words)))
            words.append(bare_word(found[0]))
    return SaidText(text, tuple(spans), tuple(words))


def one_word(text: str, word: str) -> SaidText:
    """Anything that is said for one written word."""
    return SaidText(text, (Span(0, len(text), 0),), (word,))


def mandarin_text(text: str) -> SaidText:
    """Characters as pinyin, each syllable by itself; espeak-ng's own table of them has gaps."""
    words, owners = _mandarin_words(text)
    said, spans = "", []
    done = 0
    for start, stop, syllables in _syllables(text):
        said += text[done:start]
        for number, syllable in enumerate(syllables):
            place = start if len(syllables) != stop - start else start + number
            said += " " if said and not said[-1].isspace() else ""
            spans.append(Span(len(said), len(said) + len(syllable), owners[place]))
            said += syllable
        said += " " if stop < len(text) else ""
        done = stop
    said += text[done:]
    return SaidText(said, tuple(spans), tuple(words))


def _mandarin_words(text: str) -> tuple[list[str], list[int]]:
    """The words of our own text front end, and the word of each character."""
    from lipwright.language import get_language

    lines = text.split("\n")
    at = [0]
    for line in lines:
        at.append(at[-1] + len(line) + 1)
    try:
        found = get_language("cmn").normalize(text)
        begins = [(at[word.line - 1] + word.column - 1, word.written) for word in found]
    except LipwrightError:  # something that only espeak-ng can read
        begins = [(place.start(), place[0]) for place in _TOKEN.finditer(text)]
        begins = [(start + offset, char) for start, token in begins
                  for offset, char in enumerate(token)
                  if _HANZI.match(char)] or begins  # fmt: skip
    words: list[str] = []
    owners = [0] * len(text)
    starts = sorted(dict(begins).items())
    stops = [*(start for start, _ in starts), len(text)][1:]
    for (start, written), stop in zip(starts, stops, strict=False):
        owners[start:stop] = [len(words)] * (stop - start)
        words.append(bare_word(written))
    return words or ["?"], owners


def _syllables(text: str) -> Iterator[tuple[int, int, list[str]]]:
    """What is said otherwise than it is written, or is a word: start, end, and what to say."""
    from pypinyin import Style, lazy_pinyin

    has_characters = _HANZI.search(text) is not None
    parts = [*_HANZI.finditer(text), *_LATIN.finditer(text)]
    for part in sorted(parts, key=lambda one: one.start()):
        if _HANZI.match(part[0]):
            said = lazy_pinyin(part[0], style=Style.TONE3, neutral_tone_with_five=True)
        else:
            said = _pinyin(part[0], has_characters) or [part[0]]
        yield part.start(), part.end(), said


def _pinyin(token: str, has_characters: bool) -> list[str]:
    """The syllables of a token with their tones; none if it is not pinyin."""
    from lipwright.language.mandarin.pinyin import NotPinyinError, syllables_of

    apart = unicodedata.normalize("NFD", token)
    tones = _TONE.findall(apart)
    if not any(char.isalpha() for char in token) or (has_characters and not tones):
        return []
    try:
        syllables = syllables_of(token)
    except NotPinyinError:
        return []
    said = []
    for number, syllable in enumerate(syllables):
        tone = tones[number] if len(tones) == len(syllables) else "1"
        plain = syllable.replace("ü", "v").replace("ê", "ei")
        rolled = plain.endswith("r") and plain != "er"
        said.append((plain[:-1] if rolled else plain) + _TONES.get(tone, tone))
        if rolled:
            said.append("er" + _NEUTRAL)
    return said


def bare_word(token: str) -> str:
    """The word of a token, without the punctuation around it."""
    marks = {char for char in token if unicodedata.category(char)[0] == "P"}
    word = token.strip("".join(marks)) or token
    return word if is_text(word) and word.split() == [word] else "?"
