"""What a language is made of: its tables."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

Mends = tuple[tuple[re.Pattern[str], str], ...]


def tokens_mended(*rules: tuple[str, str]) -> Mends:
    """Rules on sounds parted by spaces: each pattern begins and ends where a sound does.

    The stress mark in front of a sound stays out of it, so that a rule keeps the mark.
    """
    return tuple((re.compile(rf"(?<![^ ˈˌ])(?:{old})(?![^ ])"), new) for old, new in rules)


@dataclass(frozen=True)
class Way:
    """One way to say a word, in the sounds of the language."""

    sounds: tuple[str, ...]
    """rows of the language's inventory; a stress mark stands before its vowel: "ˈaː" """
    source: Literal["lexicon", "rule", "g2p"]


@dataclass(frozen=True)
class Place:
    """Where a word stands: what it touches without a pause."""

    before: str
    """the word before it; empty at the start and behind a pause"""
    before_sounds: tuple[str, ...]
    after: str
    """the word behind it; empty at the end and before a pause"""
    after_sounds: tuple[str, ...]


Link = Callable[[str, tuple[Way, ...], Place], tuple[Way, ...]]
"""the ways to say a word where it stands, from those to say it alone"""
Stress = Callable[[str, tuple[str, ...], tuple[int, ...]], int]
"""which of the vowels, by their places among the sounds of the word, bears the stress"""


@dataclass(frozen=True)
class Amounts:
    """How numbers are read."""

    num2words: str
    """the language's name in num2words"""
    comma: str
    """what is said for the decimal comma"""
    minus: str
    plus: str
    to: str
    """between the ends of a range"""
    over: str
    """between the numbers of a fraction that has no name"""
    percent: str
    months: tuple[str, ...]
    date: str
    """with {day}, {month} and {year}"""
    first_day: str
    """of a month"""
    day_is: Literal["cardinal", "ordinal"]
    time: str
    """with {hour} and {minute}"""
    hour: str
    """with {hour}, for the full hour"""
    hour_words: tuple[str, ...]
    """what may follow a time and is said within it"""
    money: str
    """with {whole} and {cents}, each with its unit"""
    currencies: Mapping[str, tuple[str, str, str, str]]
    """sign to one and several, whole and hundredth"""
    units: Mapping[str, tuple[str, str]]
    """behind a number, case as written, to one and several"""
    magnitudes: Mapping[str, str]
    """what may follow an amount of money, to its word"""
    of: str = ""
    """between a magnitude and what is counted"""
    ones: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """last word of a number to its forms before masculine and feminine nouns"""
    feminine: frozenset[str] = frozenset()
    """words of `currencies`, `units` and `hour_words` before which the feminine form stands"""
    ordinals: tuple[tuple[str, Literal["m", "f"]], ...] = ()
    """patterns behind a number that make it an ordinal, and its gender"""
    ordinal_before: Mapping[str, str] = field(default_factory=dict)
    """word before "3." that makes it an ordinal, to the ordinal's ending"""
    first: tuple[str, str] = ("", "")
    """the ordinal of 1, masculine and feminine, where num2words lacks one"""
    fractions: Mapping[str, str] = field(default_factory=dict)
    single_decimals: bool = False
    """decimals are read digit by digit"""
    roman: Literal["cardinal", "ordinal", "ordinal to ten"] = "cardinal"
    """how II to XXX are read"""
    roman_ranks: str = ""
    """pattern behind a Roman numeral that makes it an ordinal"""


@dataclass(frozen=True)
class Tables:
    """One language."""

    code: str
    name: str
    package: str
    """of its lexicon"""
    lexicons: tuple[str, ...]
    """folders of the package, the first asked first; the last one's g2p guesses"""
    letters: str
    """beyond a to z, in lower case"""
    sounds: Mapping[str, str]
    """every sound, in IPA, with an example word whose letters for it are in capitals"""
    vowels: str
    """letters of IPA that begin the vowels among the sounds"""
    mends: Mapping[str, Mends]
    """folder to what makes the lexicon's spelling that of `sounds`"""
    amounts: Amounts
    abbreviations: Mapping[str, str]
    """without last dot, in lower case, to what is said; a key that ends in a dot must have one"""
    symbols: Mapping[str, str]
    """a sign that stands alone or between words"""
    address: Mapping[str, str]
    """a sign in an e-mail or web address"""
    letter_names: Mapping[str, str]
    """how a letter is called when an abbreviation is spelt"""
    said: Mapping[str, str] = field(default_factory=dict)
    """words whose pronunciation the lexicon has wrong or lacks; ways parted by " / " """
    clitics: Mapping[str, str] = field(default_factory=dict)
    """what stands before or behind an apostrophe, with it, to its sounds"""
    spelt: frozenset[str] = frozenset()
    """abbreviations in capitals that are spelt although they look like words"""
    links: tuple[tuple[str, str], ...] = ()
    """letters between the parts of a compound and their sounds; none: no compounds"""
    joined_by_hyphen: re.Pattern[str] | None = None
    """words with hyphens that stay one"""
    stress: Stress | None = None
    """where the lexicon writes no stress"""
    finish: Callable[[str, tuple[str, ...]], tuple[str, ...]] | None = None
    """what is done to a word's sounds once their stress is known"""
    link: Link | None = None
    guess_from: str | None = None
    """folder of the g2p model; None is the first of `lexicons`"""
    guess_plain: bool = False
    """the g2p model knows no accents"""
