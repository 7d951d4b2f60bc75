"""American English, with the pronunciations of the CMU dictionary."""

from __future__ import annotations

import re
from functools import cached_property
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Pronunciation, SpokenWord
from lipwright.language.dictionary import Dictionary
from lipwright.language.english.pronounce import by_network, by_rule
from lipwright.language.english.text import Reader
from lipwright.language.lexicon import Lexicon

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

        Raises:
            LipwrightError: the word has no letters.
        """
        if dictionary and (ways := dictionary.lookup(word)):
            return tuple(Pronunciation(way, "dictionary") for way in ways)
        word = word.lower()
        if ways := self.lexicon.lookup(word):
            return tuple(Pronunciation(way, "lexicon") for way in ways)
        if ways := by_rule(word, self.lexicon):
            return tuple(Pronunciation(way, "rule") for way in ways)
        letters = "".join(_LETTERS.findall(word))
        if not letters:
            raise LipwrightError(
                f"{word!r} cannot be pronounced; spell it in letters, or add it to the dictionary"
            )
        return (Pronunciation(by_network(letters), "g2p"),)
