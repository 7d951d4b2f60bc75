"""American English, with the pronunciations of the CMU dictionary."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, SpokenWord, each_alone
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.english.pronounce import (
    by_ending,
    by_network,
    by_parts,
    split_clitic,
    with_ending,
)
from lipwright.language.english.tables import ALSO_SAID
from lipwright.language.english.text import Reader
from lipwright.language.lexicon import Lexicon
from lipwright.phones import ARPABET, PHONES, SILENCE

_LETTERS: Final = re.compile(r"[a-z]+")


class English:
    """The language with the code "en"."""

    code = "en"
    name = "English"

    @cached_property
    def lexicon(self) -> Lexicon:
        """The CMU dictionary that comes with pocketsphinx."""
        from pocketsphinx import get_model_path

        return Lexicon(get_model_path("en-us/cmudict-en-us.dict"))

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text` as they are spoken, as `Language.normalize` describes it."""
        return Reader(self.lexicon, dictionary).read(text, source)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The ways to say a word: the user's, else the lexicon's, else by rule, else guessed.

        Where a rule is not sure, the guess is given beside it: the sound may tell.

        Raises:
            LipwrightError: the word has no letters.
        """
        word = word_key(word)
        if dictionary and (ways := dictionary.lookup(word)):
            return tuple(Pronunciation(way, "dictionary") for way in ways)
        base, ending = split_clitic(word)
        if ending and dictionary and base in dictionary:
            return self._with_ending(base, ending, dictionary)
        if ways := self.lexicon.lookup(word):
            also = tuple(tuple(way.split()) for way in ALSO_SAID.get(word, ()))
            fresh = tuple(way for way in also if way not in ways)
            return tuple(
                [Pronunciation(way, "lexicon") for way in ways]
                + [Pronunciation(way, "rule") for way in fresh]
            )
        if ending:
            return self._with_ending(base, ending, dictionary)
        if ways := by_ending(word, lambda base: self._known(base, dictionary)):
            return tuple(Pronunciation(way, "rule") for way in ways)
        return self._guessed(word)

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word, whatever its neighbours."""
        return each_alone(self, words, dictionary)

    def inventory(self) -> tuple[Phoneme, ...]:
        """The phones of ARPABET."""
        spoken = (PHONES[symbol] for symbol in PHONES if symbol in ARPABET - {SILENCE})
        return tuple(Phoneme(phone.ipa, (phone.symbol,), phone.example) for phone in spoken)

    def _known(self, word: str, dictionary: Dictionary | None) -> tuple[tuple[str, ...], ...]:
        ways = dictionary.lookup(word) if dictionary else ()
        return ways or self.lexicon.lookup(word)

    def _with_ending(
        self, base: str, ending: str, dictionary: Dictionary | None
    ) -> tuple[Pronunciation, ...]:
        return tuple(
            Pronunciation(with_ending(way.phones, ending), "g2p" if way.source == "g2p" else "rule")
            for way in self.pronounce(base, dictionary)
        )

    def _guessed(self, word: str) -> tuple[Pronunciation, ...]:
        letters = "".join(_LETTERS.findall(word))
        if not letters:
            raise LipwrightError(
                f"{word!r} cannot be pronounced; spell it in letters, or add it to the dictionary"
            )
        compound, sure = by_parts(letters, self.lexicon.lookup)
        guess = Pronunciation(by_network(letters), "g2p")
        if compound is None or compound == guess.phones:
            return (guess,)
        rule = Pronunciation(compound, "rule")
        return (rule, guess) if sure else (guess, rule)


def make(code: str) -> English:
    """The language of `LANGUAGES`."""
    del code
    return English()
