"""Written characters: where words end, and how each character is read where it stands."""

from __future__ import annotations

from collections.abc import Container, Sequence
from functools import cache
from importlib.resources import files
from itertools import product
from types import MappingProxyType
from typing import Final

from lipwright.language.mandarin.pinyin import syllables_of
from lipwright.language.mandarin.polyphones import CONTEXTS, PHRASES, POLYPHONES, TWO_SYLLABLES
from lipwright.language.mandarin.syllables import ERHUA, INTERJECTIONS

Reading = tuple[str, ...]
"""syllables of pinyin without tones, with the r of erhua: ("huar",)"""

_LONGEST: Final = 10  # characters of the longest phrase of the lexicon
_SUFFIX: Final = "儿"
_BLOCKS: Final = (
    ("\u3007", "\u3007"), ("\u3400", "\u4dbf"), ("\u4e00", "\u9fff"), ("\uf900", "\ufaff"),
    ("\U00020000", "\U0003ffff"),
)  # fmt: skip
"""first and last characters of the blocks of Chinese characters (Unicode 15), and 〇"""
_MOST_WAYS: Final = 4  # readings of one word that are offered


def is_character(char: str) -> bool:
    """Whether it is a Chinese character, simplified, traditional or rare."""
    return any(first <= char <= last for first, last in _BLOCKS)


def is_readable(char: str) -> bool:
    """Whether the lexicon has a reading of the character."""
    return char in POLYPHONES or ord(char) in _lexicon()[1]


@cache
def _lexicon() -> tuple[dict[str, list[list[str]]], dict[int, str]]:
    """The phrases and the characters of pypinyin, which takes a third of a second to load."""
    from pypinyin.constants import PHRASES_DICT, PINYIN_DICT

    return PHRASES_DICT, PINYIN_DICT


@cache
def _simplified() -> MappingProxyType[int, str]:
    table = files(__package__).joinpath("simplified.txt").read_text(encoding="utf-8")
    rows = [row for row in table.split("\n") if row and not row.startswith("#")]
    return MappingProxyType({ord(row[0]): row[1] for row in rows})


def simplify(text: str) -> str:
    """The text in simplified characters, one for one, as far as phrases need them."""
    return text.translate(_simplified())


def segment(text: str, own: Container[str] = ()) -> list[str]:
    """The words of a run of characters: phrases of the lexicon and of `own`, else characters.

    Words of `own` go before all; then as few words as can be, of which as few as can be are
    characters by themselves; then the longest first, so that 使劲吹 is 使劲 + 吹 and not 使 + 劲吹.
    The 儿 of erhua joins the word before it.
    """
    phrases, _ = _lexicon()
    plain = simplify(text)
    count = len(text)
    # For each start: words, characters by themselves, and the first word's length below
    # zero, of the best way to part what follows; own words count for less than nothing.
    best: list[tuple[int, int, int]] = [(0, 0, 0)] * (count + 1)
    for start in reversed(range(count)):
        way = (best[start + 1][0] + 1, best[start + 1][1] + 1, -1)
        for length in range(1, min(_LONGEST, count - start) + 1):
            end = start + length
            if text[start:end] in own:
                way = min(way, (best[end][0] - 2 * length, best[end][1], -length))
            elif length > 1 and (
                plain[start:end] in phrases
                or text[start:end] in phrases
                or plain[start:end] in PHRASES
            ):
                way = min(way, (best[end][0] + 1, best[end][1], -length))
        best[start] = way
    words: list[str] = []
    start = 0
    while start < count:
        word = text[start : start - best[start][2]]
        if words and simplify(word) == _SUFFIX and word not in own and words[-1] not in own:
            words[-1] += word
        else:
            words.append(word)
        start -= best[start][2]
    return words


def readings(word: str, before: str = "", after: str = "") -> tuple[Reading, ...]:
    """The ways to read a word of characters between what stands around it, the likeliest first.

    Raises:
        KeyError: the lexicon has no reading of a character; the error has the character.
    """
    plain, before, after = simplify(word), simplify(before), simplify(after)
    if len(word) > 1 and plain.endswith(_SUFFIX) and not _is_two(before + plain):
        core = readings(word[:-1], before, after)
        merged = tuple((*way[:-1], way[-1] + ERHUA) for way in core if _takes_r(way[-1]))
        return (*merged, *((*way, "er") for way in core))[:_MOST_WAYS]
    if len(word) > 1 and (phrase := _phrase(word) or _phrase(plain)):
        return phrase
    each = [
        _character(word[at], plain[at], before + plain[:at], plain[at + 1 :] + after)
        for at in range(len(word))
    ]
    if len(word) == 1:
        return tuple((way,) for way in each[0])
    return tuple(product(*(ways[:1] for ways in each)))


def _is_two(text: str) -> bool:
    return text.endswith(TWO_SYLLABLES)


def _takes_r(syllable: str) -> bool:
    return syllable not in INTERJECTIONS and not syllable.endswith(ERHUA)


def _phrase(word: str) -> tuple[Reading, ...]:
    """The readings of a phrase of the lexicon; none if it lacks the phrase."""
    if ours := PHRASES.get(word):
        return (tuple(ours.split()),)
    found = _lexicon()[0].get(word)
    if not found:
        return ()
    ways = product(*([_bare(reading) for reading in syllable] for syllable in found))
    return tuple(_inner_erhua(word, way) for way in ways)[:_MOST_WAYS]


def _inner_erhua(word: str, way: Reading) -> Reading:
    """A phrase with 儿 within it, such as 哥儿们, with its r of erhua; 幼儿园 stays."""
    syllables: list[str] = []
    for at, syllable in enumerate(way):
        joins = at and word[at] in "儿兒" and not _is_two(simplify(word[: at + 1]))
        if joins and _takes_r(syllables[-1]):
            syllables[-1] += ERHUA
        else:
            syllables.append(syllable)
    return tuple(syllables)


def _character(char: str, plain: str, before: str, after: str) -> Sequence[str]:
    """The readings of one character where it stands."""
    usual = POLYPHONES.get(char, POLYPHONES.get(plain, "")).split()
    if not usual:
        found = _lexicon()[1]
        row = found.get(ord(plain)) or found.get(ord(char))
        if row is None:
            raise KeyError(char)
        return [_bare(row.partition(",")[0])]
    for only, left, right, reading in CONTEXTS:
        if only == plain and left.search(before) and right.match(after):
            return [reading, *(way for way in usual if way != reading)]
    return usual


@cache
def _bare(reading: str) -> str:
    """A reading of the lexicon without its tone."""
    (syllable,) = syllables_of(reading)
    return syllable
