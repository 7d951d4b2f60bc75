"""Japanese, written in kana."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.ipa import read_ipa
from lipwright.language.japanese.kana import is_kana, sounds_of, to_hiragana
from lipwright.language.japanese.text import read_text

# Sound to a word in Hepburn's spelling that has it.
_EXAMPLES: Final = MappingProxyType({
    "a": "Ame", "i": "Inu", "ɯ": "Ushi", "e": "Eki", "o": "Oto", "aː": "okAAsan", "iː": "onIIsan",
    "ɯː": "kUUki", "eː": "onEEsan", "oː": "tOOkyoo", "p": "Pan", "b": "Boku", "t": "Te",
    "d": "Denwa", "k": "Kasa", "ɡ": "Gohan", "ʔ": "aQ (cut short)", "m": "Mizu", "n": "Neko",
    "ɲ": "Niwa", "ŋ": "giNkoo", "ɴ": "hoN", "ɾ": "Ringo", "ɸ": "Fuyu", "s": "Sakura", "z": "kaZoku",
    "ɕ": "SHima", "ʑ": "kaJi", "ç": "Hito", "h": "Hana", "ts": "TSuki", "dz": "Zoo", "tɕ": "CHizu",
    "dʑ": "Jikan", "j": "Yama", "w": "Watashi",
})  # fmt: skip

_PHRASES: Final = MappingProxyType({"こんにちは": "こんにちわ", "こんばんは": "こんばんわ"})
_PARTICLES: Final = MappingProxyType({"は": "わ", "へ": "え"})
# Words whose last は or へ is no particle: laughter, and the word for mother.
_NO_PARTICLE: Final = re.compile("[は]+|[へ]+|はは")
_NEGATED: Final = re.compile("では(?=な|あり|あった)")  # dewa nai, dewa arimasen
_REMEMBERED: Final = 20_000  # words
_PAUSE: Final = re.compile("[，。！？、；：…｡､,.;:!?」』）)]$")


class Japanese:
    """The language with the code "ja"; words are kana, numbers too.

    は and へ are particles, said wa and e, where they stand alone, end a word with spaces around
    it, or follow katakana.
    """

    code = "ja"
    name = "Japanese (kana)"

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text`, as `Language.normalize` describes it.

        Raises:
            LipwrightError: there are no words, or a character that is not kana; names its place.
        """
        return read_text(text, source, dictionary)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The way to say a word of kana by itself, or the ways of the user's dictionary.

        Raises:
            LipwrightError: the word is not kana.
        """
        return _ways(word, "", dictionary)

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word; n at its end takes the place of the next word's first sound.

        Raises:
            LipwrightError: a word is not kana.
        """
        said: list[tuple[Pronunciation, ...]] = []
        following, place = "", (0, 0)
        for word in reversed(words):
            if (word.line, word.column) != place and _PAUSE.search(word.written):
                following = ""
            ways = _ways(word.text, following, dictionary)
            said.append(ways)
            following, place = (*ways[0].ipa, "")[0], (word.line, word.column)
        return tuple(reversed(said))

    def inventory(self) -> tuple[Phoneme, ...]:
        """Every sound of the moras, with its length and what n becomes."""
        return tuple(
            Phoneme(sound, tuple(row.phone for row in read_ipa(sound)), example)
            for sound, example in _EXAMPLES.items()
        )


def make(code: str) -> Japanese:
    """The language of `LANGUAGES`."""
    del code
    return Japanese()


def _ways(word: str, following: str, dictionary: Dictionary | None) -> tuple[Pronunciation, ...]:
    key = word_key(word)
    if dictionary and (own := dictionary.lookup(key)):
        return tuple(Pronunciation(way, "dictionary") for way in own)
    if key.isascii() and any(map(str.isalpha, key)):
        from lipwright.language import get_language

        return get_language("en").pronounce(key)
    if not key or not all(map(is_kana, key)):
        raise LipwrightError(f"{word[:40]!r} is not kana; write it in hiragana or katakana")
    return _kana_ways(key, following)


@lru_cache(_REMEMBERED)
def _kana_ways(key: str, following: str) -> tuple[Pronunciation, ...]:
    """The way to say kana before the sound that follows."""
    sounds = [
        sound
        for written in sounds_of(_with_particles(key), following)
        for sound in read_ipa(written)
    ]
    if not sounds:
        raise LipwrightError(f"{key[:40]!r} has no sound of its own")
    return (
        Pronunciation(
            tuple(sound.phone for sound in sounds), "rule", tuple(sound.ipa for sound in sounds)
        ),
    )


def _with_particles(word: str) -> str:
    """Hiragana as it is said: は and へ as particles, and greetings that end in one."""
    said = to_hiragana(word)
    if word != said:
        return said  # katakana has no particles
    for phrase, spoken in _PHRASES.items():
        said = said.replace(phrase, spoken)
    said = _NEGATED.sub("でわ", said)
    is_particle = len(said) == 1 or not _NO_PARTICLE.fullmatch(said)
    return said[:-1] + _PARTICLES.get(said[-1], said[-1]) if is_particle else said
