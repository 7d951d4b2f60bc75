"""What every language offers: its words as they are spoken, and their pronunciations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from lipwright.language.dictionary import Dictionary
from lipwright.phones import PHONES, SILENCE

Source = Literal["dictionary", "lexicon", "rule", "g2p"]


@dataclass(frozen=True)
class SpokenWord:
    """One word as it is spoken; several may come from one written token, such as "10:30"."""

    text: str
    """as spoken, in lower case, without white space: "thirty" """
    written: str
    """the token that it comes from, as written: "10:30," """
    line: int
    """of the token, from 1"""
    column: int
    """of the token's first character, from 1"""


@dataclass(frozen=True)
class Pronunciation:
    """One way to say a word.

    Raises:
        ValueError: no phones, or one that the phone table lacks.
    """

    phones: tuple[str, ...]
    """symbols of the phone table, without silence"""
    source: Source
    """the user's dictionary, the lexicon, a rule on words of the lexicon, or
    grapheme-to-phoneme conversion"""
    ipa: tuple[str, ...] = ()
    """the sounds of the language behind `phones`, one for one, in IPA without stress, length kept:
    "x" where `phones` has K, which looks alike; () where the phones are the sounds"""
    stress: tuple[int | None, ...] = ()
    """one for each phone, as in a phone track; () is all None"""

    def __post_init__(self) -> None:
        """Check."""
        unknown = [phone for phone in self.phones if phone not in PHONES or phone == SILENCE]
        if unknown or not self.phones:
            raise ValueError(f"a pronunciation of the phones {self.phones}")
        for row in (self.ipa, self.stress):
            if row and len(row) != len(self.phones):
                raise ValueError(f"{row} beside the phones {self.phones}")


@dataclass(frozen=True)
class Phoneme:
    """One sound of a language and the phone that stands for it on a face."""

    ipa: str
    """as the language's text front end writes it, length mark included: "ɑː" """
    phones: tuple[str, ...]
    """symbols of the phone table that show it, most often one"""
    example: str
    """a word of the language, with the sound's letters in capitals: "gAta" """


class Language(Protocol):
    """Text to words to phones in one language."""

    @property
    def code(self) -> str:
        """ISO 639-1, such as "en"."""

    @property
    def name(self) -> str:
        """In English, such as "English"."""

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text` as they are spoken; numbers and abbreviations written out.

        A token of `dictionary` stays one word. `source` names the text in errors.

        Raises:
            LipwrightError: there are no words, or letters that the language does not have.
        """

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The ways to say a word of `normalize`, the most usual first; at least one.

        Raises:
            LipwrightError: the word has characters that cannot be spoken.
        """

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word where it stands, the most usual first; at least one each.

        Words change their neighbours: Swedish "har du" has one retroflex stop. A language whose
        words do not gives `each_alone`.

        Raises:
            LipwrightError: a word has characters that cannot be spoken.
        """

    def inventory(self) -> tuple[Phoneme, ...]:
        """Every sound that the language's pronunciations may have."""


def each_alone(
    language: Language, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
) -> tuple[tuple[Pronunciation, ...], ...]:
    """The ways to say each word, whatever its neighbours; for `Language.pronounce_all`."""
    ways = {text: language.pronounce(text, dictionary) for text in {word.text for word in words}}
    return tuple(ways[word.text] for word in words)
