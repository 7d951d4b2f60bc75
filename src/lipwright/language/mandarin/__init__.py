"""Mandarin, written in characters, simplified or traditional, or in pinyin."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, Source, SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.mandarin.characters import is_character, readings
from lipwright.language.mandarin.pinyin import NotPinyinError, syllables_of
from lipwright.language.mandarin.syllables import inventory, syllable_sounds
from lipwright.language.mandarin.text import Reader, is_toned, remedy

_AROUND: Final = 8  # characters before and behind a word that may decide how it is read


class Mandarin:
    """The language with the code "cmn".

    Words stay as they are written, in characters ("你好") or pinyin ("ni3hao3", "nǐhǎo"), and
    numbers become characters ("二十二"), so that the words of a track can be read. Tones do not
    show on the face and are left out.
    """

    code = "cmn"
    name = "Mandarin"

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text`, as `Language.normalize` describes it.

        Words in Latin letters without tones are English where the text has characters, and
        pinyin where it has none.

        Raises:
            LipwrightError: there are no words, a character that the lexicon lacks, or something
                that is neither characters nor pinyin; names its place.
        """
        return Reader(dictionary).read(text, source)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The ways to say a word by itself: characters, pinyin, else as English says it.

        Raises:
            LipwrightError: a character that the lexicon lacks, or no letters.
        """
        return self._ways(word, "", "", dictionary, english_first=False)

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word, characters by what stands around them.

        As in `normalize`, words in Latin letters are English first where others are characters.

        Raises:
            LipwrightError: a character that the lexicon lacks, or a word without letters.
        """
        english_first = any(is_character(char) for word in words for char in word.text)
        around = _contexts(words)
        return tuple(
            self._ways(word.text, before, after, dictionary, english_first=english_first)
            for word, (before, after) in zip(words, around, strict=True)
        )

    def inventory(self) -> tuple[Phoneme, ...]:
        """Every sound of initials and finals, then the finals of several sounds."""
        return inventory()

    def _ways(
        self, word: str, before: str, after: str, dictionary: Dictionary | None, *,
        english_first: bool,
    ) -> tuple[Pronunciation, ...]:  # fmt: skip
        key = word_key(word)
        if dictionary and (ways := dictionary.lookup(key)):
            return tuple(Pronunciation(way, "dictionary") for way in ways)
        if key and all(map(is_character, key)):
            try:
                found = readings(key, before, after)
            except KeyError as error:
                raise LipwrightError(
                    f"{word!r}: {error.args[0]!r} has no reading in the lexicon; write its pinyin"
                ) from error
            return _distinct(_spoken(syllables, "lexicon") for syllables in found)
        try:
            syllables = syllables_of(key)
        except NotPinyinError as error:
            if english := _english(key):
                return english
            raise LipwrightError(f"{word!r}: {error}{remedy(word)}") from error
        if not syllables:
            raise LipwrightError(f"{word!r} has no letters")
        pinyin = (_spoken(syllables, "rule"),)
        if english_first and not is_toned(key):
            return (*_english(key), *pinyin)
        return pinyin


def make(code: str) -> Mandarin:
    """The language of `LANGUAGES`."""
    del code
    return Mandarin()


def _contexts(words: Sequence[SpokenWord]) -> list[tuple[str, str]]:
    """What is said before and behind each word without a mark between."""
    before: list[str] = []
    run = ""
    for word in words:
        before.append(run)
        run = (run + word.text)[-_AROUND:] if word.written.endswith(word.text) else ""
    after: list[str] = []
    run = ""
    for word in reversed(words):
        run = run if word.written.endswith(word.text) else ""
        after.append(run)
        run = (word.text + run)[:_AROUND]
    return list(zip(before, reversed(after), strict=True))


def _spoken(syllables: Sequence[str], source: Source) -> Pronunciation:
    rows = [syllable_sounds(syllable) for syllable in syllables]
    phones = tuple(phone for row in rows for phone in row[0])
    return Pronunciation(phones, source, tuple(sound for row in rows for sound in row[1]))


def _distinct(ways: Iterable[Pronunciation]) -> tuple[Pronunciation, ...]:
    return tuple({(way.phones, way.ipa): way for way in reversed(list(ways))}.values())[::-1]


def _english(word: str) -> tuple[Pronunciation, ...]:
    """The ways in which English says a word in its letters; a letter alone by its name."""
    from lipwright.language import get_language

    if not (word.isascii() and any(char.isalpha() for char in word)):
        return ()
    ways = get_language("en").pronounce(word)
    return ways[::-1] if word == "a" else ways
