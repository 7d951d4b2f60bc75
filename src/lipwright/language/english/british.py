"""British English, with the pronunciations of a British lexicon."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Final

from lipwright.language.base import Phoneme, Pronunciation, Source, SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.english import English
from lipwright.language.english.british_text import BritishReader
from lipwright.language.english.pronounce import ending_phones, split_clitic
from lipwright.language.english.received import (
    ALSO,
    LETTERS,
    WEAK,
    BritishLexicon,
    Said,
    british_inventory,
    from_american,
    links_r,
    read_said,
    with_phones,
)
from lipwright.phones import PHONES

_STOPS: Final = tuple(',.;:!?…—–)"”')  # behind which nothing links
_R: Final = ("R", PHONES["R"].ipa, None)


class British:
    """The language with the code "en-gb"."""

    code = "en-gb"
    name = "British English"

    def __init__(self) -> None:
        """With American English for words that the British lexicon lacks, most of them names."""
        self._american = English()

    @cached_property
    def lexicon(self) -> BritishLexicon:
        """The British lexicon."""
        return BritishLexicon()

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text` as they are spoken, as `Language.normalize` describes it."""
        return BritishReader(self._american.lexicon, dictionary).read(text, source)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The ways to say a word by itself: the user's, else the lexicon's, else by rule.

        Raises:
            LipwrightError: the word has no letters.
        """
        word = word_key(word)
        if dictionary and (ways := dictionary.lookup(word)):
            return tuple(Pronunciation(way, "dictionary") for way in ways)
        base, ending = split_clitic(word)
        if not (ending and dictionary and base in dictionary):
            if known := self._known(word):
                return tuple(_pronunciation(way, "lexicon") for way in known)
            if not ending:
                return self._by_rule(word)
        return tuple(_with_ending(way, ending) for way in self.pronounce(base, dictionary))

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word where it stands.

        An r that is written at the end of a word is said before a vowel ("far away"); "the" and
        "to" have their full vowel there; and before a pause words are not weak.
        """
        alone = [self.pronounce(word.text, dictionary) for word in words]
        said = []
        for number, (word, ways) in enumerate(zip(words, alone, strict=True)):
            joined = number + 1 < len(words) and _joined(word, words[number + 1])
            after = alone[number + 1][0].phones[0] if joined else ""
            vowel = bool(after) and PHONES[after].is_vowel
            said.append(_placed(word.text, ways, joined=joined, vowel=vowel))
        return tuple(said)

    def inventory(self) -> tuple[Phoneme, ...]:
        """The vowels by Wells's keywords, and the consonants."""
        return british_inventory()

    def _known(self, word: str) -> tuple[Said, ...]:
        """The ways of tables and lexicon."""
        if len(word) == 1 and word in LETTERS and word != "a":
            found: tuple[Said, ...] = (read_said(LETTERS[word]),)
        else:
            found = self.lexicon.lookup(word)
        weak = tuple(map(read_said, WEAK.get(word, "").split()))
        also = tuple(map(read_said, ALSO.get(word, "").split()))
        return tuple(dict.fromkeys((*weak, *found, *also)))

    def _by_rule(self, word: str) -> tuple[Pronunciation, ...]:
        """The American ways of a word, as the British would say it."""
        ways = self._american.pronounce(word)
        return tuple({
            said: _pronunciation(said, "g2p" if way.source == "g2p" else "rule")
            for way in ways
            if (said := from_american(word, way.phones))
        }.values())  # fmt: skip


def _pronunciation(said: Said, source: Source) -> Pronunciation:
    phones, ipa, stress = zip(*said, strict=True)
    return Pronunciation(phones, source, ipa, stress if any(stress) else ())


def _said(way: Pronunciation) -> Said:
    count = len(way.phones)
    ipa = way.ipa or tuple(PHONES[phone].ipa for phone in way.phones)
    return tuple(zip(way.phones, ipa, way.stress or (None,) * count, strict=True))


def _with_ending(way: Pronunciation, ending: str) -> Pronunciation:
    source: Source = "g2p" if way.source == "g2p" else "rule"
    return _pronunciation(with_phones(_said(way), ending_phones(ending, way.phones[-1])), source)


def _joined(word: SpokenWord, after: SpokenWord) -> bool:
    """Whether two words are said without a pause between them."""
    if (word.line, word.column) == (after.line, after.column):
        return True
    dotted = word.written.rstrip(".").casefold() != word.text  # "Dr. Who"
    return not word.written.endswith(_STOPS) or (word.written.endswith(".") and dotted)


def _placed(
    word: str, ways: tuple[Pronunciation, ...], *, joined: bool, vowel: bool
) -> tuple[Pronunciation, ...]:
    """The ways to say a word before a vowel, a consonant or a pause."""
    if word in WEAK and not joined:
        weak = len(WEAK[word].split())
        ways = ways[weak:] + ways[:weak]
    if not vowel:
        return ways
    if word in ("the", "to", "do"):
        full = [way for way in ways if way.phones[-1] in ("IY", "UW")]
        ways = (*full, *(way for way in ways if way not in full))
    linked = tuple(
        _pronunciation((*_said(way), _R), way.source)
        for way in ways
        if links_r(word, _said(way)) and way.source != "dictionary"
    )
    return (*linked, *ways)


def make(code: str) -> British:
    """The language of `LANGUAGES`."""
    del code
    return British()
