"""Mandarin, written in pinyin."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, SpokenWord, each_alone
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.mandarin.pinyin import NotPinyinError, syllables_of
from lipwright.language.mandarin.syllables import syllable_phones

_MARKS: Final = "，。！？、；：…"  # no white space follows them
_TOKEN: Final = re.compile(f"[^\\s{_MARKS}]+[{_MARKS}]*[”’）》」]*")
_EDGE: Final = "\"“”„‘’'()（）[]{}<>《》「」*_~|,.;:!?-–—…·" + _MARKS
_APOSTROPHES: Final = str.maketrans("’‘ʼʻ`´", "''''''")
_LONGEST: Final = 500  # characters of a token


class Mandarin:
    """The language with the code "cmn"; words are pinyin, such as "ni3hao3" or "nǐhǎo".

    Tones do not show on the face and are left out.
    """

    code = "cmn"
    name = "Mandarin (pinyin)"

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text`, as `Language.normalize` describes it.

        Raises:
            LipwrightError: there are no words, or something that is not pinyin; names its place.
        """
        words = []
        for line, content in enumerate(text.split("\n"), 1):
            for found in _TOKEN.finditer(content):
                word = _read(found[0], (source, line, found.start() + 1), dictionary)
                if word:
                    words.append(SpokenWord(word, found[0], line, found.start() + 1))
        if not words:
            raise LipwrightError(f"{source}: has no words; give the words that are spoken")
        return tuple(words)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The way to say a word of pinyin, or the ways that the user's dictionary has.

        Raises:
            LipwrightError: the word is not pinyin.
        """
        word = word_key(word)
        if dictionary and (ways := dictionary.lookup(word)):
            return tuple(Pronunciation(way, "dictionary") for way in ways)
        try:
            syllables = syllables_of(word)
        except NotPinyinError as error:
            raise LipwrightError(f"{word!r}: {error}{_remedy(word)}") from error
        if not syllables:
            raise LipwrightError(f"{word!r} has no letters")
        phones = [phone for syllable in syllables for phone in syllable_phones(syllable)]
        return (Pronunciation(tuple(phones), "rule"),)

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word, whatever its neighbours."""
        return each_alone(self, words, dictionary)

    def inventory(self) -> tuple[Phoneme, ...]:
        """The sounds of the initials and finals."""
        return ()


def make(code: str) -> Mandarin:
    """The language of `LANGUAGES`."""
    del code
    return Mandarin()


def _read(written: str, place: tuple[str, int, int], dictionary: Dictionary | None) -> str:
    """The word in a token; empty if it is punctuation alone."""
    source, line, column = place
    if len(written) > _LONGEST:
        raise LipwrightError(
            f"{source}: line {line}, column {column}: a word of {len(written)} characters, more "
            f"than {_LONGEST}; put spaces between words"
        )
    key = word_key(written.translate(_APOSTROPHES))
    for own in (key, key.strip(_EDGE)):
        if dictionary and own in dictionary:
            return own
    plain = written.translate(_APOSTROPHES)
    core = plain.strip(_EDGE)
    try:
        syllables_of(core)
    except NotPinyinError as error:
        at = column + plain.index(core) + error.column
        raise LipwrightError(
            f"{source}: line {line}, column {at}: {error}{_remedy(core)}"
        ) from error
    return word_key(core)


def _remedy(text: str) -> str:
    """What to do about text that is not pinyin."""
    if any(unicodedata.name(char, "").startswith("CJK") for char in text):
        return "; characters need a lexicon that is not there yet: write pinyin, as in 'ni3 hao3'"
    if text.isdigit():
        return "; write numbers as they are said, as in 'san1'"
    return "; write syllables such as 'ni3 hao3' or 'nǐ hǎo'"
