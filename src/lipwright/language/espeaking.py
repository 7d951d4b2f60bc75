"""Any language that espeak-ng speaks, pronounced by its IPA.

espeak-ng reads numbers, abbreviations and foreign words itself, so that a token stays one word.
Its rules look at one word at a time here: what words do to each other is lost.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, SpokenWord
from lipwright.language.codes import NAMES, resolve_code
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.espeak_ipa import SEPARATOR, read_espeak
from lipwright.language.tokens import EDGE, SIGNS
from lipwright.language.unspaced import MARKS, split_unspaced
from lipwright.phones import PHONES

# Our codes that are not espeak-ng's, and its voice for them.
_VOICES: Final = MappingProxyType({
    "en": "en-us", "fr": "fr-fr", "pt": "pt-br", "cmn": "cmn-latn-pinyin",
})  # fmt: skip
_AT_ONCE: Final = 50_000  # characters of a request; espeak takes 100,000
_ACRONYM: Final = 5  # letters at most


class EspeakLanguage:
    """A language by espeak-ng; its words are the tokens of the text in lower case."""

    def __init__(self, code: str) -> None:
        """`code` is one of `codes.NAMES`."""
        self.code = code
        self.name = NAMES[code]
        self.voice = _VOICES.get(code, code)
        """espeak-ng's own code"""
        self._known: dict[str, tuple[Pronunciation, ...]] = {}

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text`, as `Language.normalize` describes it; numbers stay digits.

        Raises:
            LipwrightError: there are no words, or one is too long.
        """
        words = []
        for written, line, column in split_unspaced(text, source):
            if word := _word(written, dictionary):
                words.append(SpokenWord(word, written, line, column))
        if not words:
            raise LipwrightError(f"{source}: has no words; give the words that are spoken")
        return tuple(words)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The way to say a word, or the ways that the user's dictionary has.

        Raises:
            LipwrightError: espeak-ng says nothing for it.
            MissingExtraError: espeak-ng is not installed.
        """
        return self.pronounce_all([SpokenWord(word, word, 1, 1)], dictionary)[0]

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word by itself; one request for all that are new.

        Raises:
            LipwrightError: espeak-ng says nothing for a word; names its place.
            MissingExtraError: espeak-ng is not installed.
        """
        own = [dictionary.lookup(word.text) if dictionary else () for word in words]
        said = [_said(word) for word in words]
        self._learn(text for text, ways in zip(said, own, strict=True) if not ways)
        found = []
        for word, text, ways in zip(words, said, own, strict=True):
            if not (ways or self._known[text]):
                raise LipwrightError(
                    f"line {word.line}, column {word.column}: espeak-ng says nothing for "
                    f"{word.written[:40]!r} in {self.name}; leave it out, or give its phones in a "
                    "dictionary"
                )
            found.append(
                tuple(Pronunciation(way, "dictionary") for way in ways) or self._known[text]
            )
        return tuple(found)

    def inventory(self) -> tuple[Phoneme, ...]:
        """Empty: espeak-ng does not tell which of its phonemes a language may use."""
        return ()

    def _learn(self, texts: Iterable[str]) -> None:
        """Ask for the IPA of words that are not known yet."""
        from lipwright import espeak

        for batch in _batches([text for text in dict.fromkeys(texts) if text not in self._known]):
            heard = espeak.words_to_ipa(batch, self.voice, SEPARATOR)
            for text, ipa in zip(batch, heard, strict=True):
                self._known[text] = _pronunciations(ipa, self.voice)


def make(code: str) -> EspeakLanguage:
    """The language of any code, tag or name that `codes.resolve_code` knows.

    Raises:
        LipwrightError: there is no such language.
    """
    return EspeakLanguage(resolve_code(code))


def _word(written: str, dictionary: Dictionary | None) -> str:
    """The word in a token; empty where nothing in it is said."""
    plain = unicodedata.normalize("NFC", written.translate(SIGNS))
    core = "".join(char for char in plain if _is_said(char)).strip(EDGE + MARKS + ".-'「」『』")
    for key in (word_key(plain), word_key(core)):
        if dictionary and key and key in dictionary:
            return key
    return core.lower() if any(map(str.isalnum, core)) else ""


def _is_said(char: str) -> bool:
    """Whether it is no emoji, nor a mark that joins or colours them, nor a control character."""
    return unicodedata.category(char) not in ("So", "Sk", "Cc", "Cn", "Co", "Cs") and not (
        0xFE00 <= ord(char) <= 0xFE0F
    )


def _said(word: SpokenWord) -> str:
    """What espeak-ng is given: short words in capitals are spelt out, as they are written."""
    core = word.written.translate(SIGNS).strip(EDGE + MARKS + ".-'「」『』")
    is_acronym = core.isupper() and core.isalpha() and 1 < len(core) <= _ACRONYM
    return core if is_acronym and core.lower() == word.text else word.text


def _batches(texts: Sequence[str]) -> Iterator[list[str]]:
    batch: list[str] = []
    count = 0
    for text in texts:
        if batch and count + len(text) > _AT_ONCE:
            yield batch
            batch, count = [], 0
        batch.append(text)
        count += len(text) + 1
    if batch:
        yield batch


def _pronunciations(ipa: str, voice: str) -> tuple[Pronunciation, ...]:
    """The one way that espeak-ng says a word; none if it says nothing."""
    sounds = read_espeak(ipa, voice)
    if not sounds:
        return ()
    stress = tuple(
        0 if sound.stress is None and PHONES[sound.phone].is_vowel else sound.stress
        for sound in sounds
    )
    return (
        Pronunciation(
            tuple(sound.phone for sound in sounds), "g2p",
            tuple(sound.ipa for sound in sounds), stress,
        ),
    )  # fmt: skip
