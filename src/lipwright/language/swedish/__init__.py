"""Central Standard Swedish: the lexicon of gruut, compounds by rule, other words guessed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, Source, SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.swedish.assimilation import RETROFLEX, assimilate, open_before_r
from lipwright.language.swedish.frequent import WAYS
from lipwright.language.swedish.guess import Field
from lipwright.language.swedish.lexicon import Sounds, SwedishLexicon
from lipwright.language.swedish.numbers import split_number
from lipwright.language.swedish.sounds import INVENTORY, pronunciation
from lipwright.language.swedish.text import Reader, is_pause
from lipwright.language.swedish.words import ENDINGS, Compounds, inflected, join_parts

_LETTERS: Final = re.compile(r"[^\W\d_]+")
_ENDED: Final = re.compile(r"(?P<base>[^\W\d_]+):(?P<end>[^\W\d_]+)")  # "tv:n"
_MUTE_H: Final = re.compile(r"(?<=[aeiouåäö])h(?=[lmnr])")  # of names: "Dahl", "Öhman"
_SON: Final = "sson"  # of names: "Svensson"
_SURE: Final = 0.95  # of a guess, from which it beats compounds; docs/swedish.md


@dataclass(frozen=True)
class _Way:
    """A way to say a word before it meets its neighbours."""

    sounds: Sounds
    """empty for the user's own"""
    source: Source
    phones: tuple[str, ...] = ()
    """the user's own"""


class Swedish:
    """The language with the code "sv"."""

    code = "sv"
    name = "Swedish"

    def __init__(
        self,
        lexicon: SwedishLexicon | None = None,
        field: Field | None = None,
        lookup_common: bool = True,
    ) -> None:
        """With another lexicon or field, or without the table of common words, to measure them.

        Nothing is read until a word is asked for.
        """
        self.lexicon = lexicon or SwedishLexicon()
        self._field = field or Field()
        self._common = WAYS if lookup_common else {}
        self._known: dict[str, tuple[_Way, ...]] = {}

    @cached_property
    def _compounds(self) -> Compounds:
        return Compounds(self._lookup)

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text` as they are spoken, as `Language.normalize` describes it."""
        return Reader(self._lookup, dictionary).read(text, source)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The ways to say a word: the user's, else the lexicon's, else by its parts, else guessed.

        Raises:
            LipwrightError: the word has no letters.
        """
        return _where_it_stands(self._with_source(word, dictionary), "", "")

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word where it stands: r and dentals meet over word edges.

        "har du" is hɑː ɖʉː, but not over a comma or a stop, nor after a long r. The words as they
        are alone are given behind, for a speaker who parts them.
        """
        ways = {text: self._with_source(text, dictionary) for text in {w.text for w in words}}
        rows = [ways[word.text] for word in words]
        ends = [_end(row) for row in rows]
        said = []
        for index, row in enumerate(rows):
            first, last = index == 0, index == len(rows) - 1
            before = "" if first or is_pause(words[index - 1], words[index]) else ends[index - 1]
            meets = not last and not is_pause(words[index], words[index + 1])
            follows = _start(rows[index + 1]) if meets else ""
            said.append(_where_it_stands(row, before, follows))
        return tuple(said)

    def inventory(self) -> tuple[Phoneme, ...]:
        """The 42 sounds of the thesis, and long ö before r."""
        return INVENTORY

    def _lookup(self, word: str) -> tuple[Sounds, ...]:
        if word in self._common:
            return tuple(tuple(way.split()) for way in self._common[word])
        return self.lexicon.lookup(word)

    def _with_source(self, word: str, dictionary: Dictionary | None) -> tuple[_Way, ...]:
        """The user's ways to say a word, or ours."""
        if dictionary and (ways := dictionary.lookup(word)):
            return tuple(_Way((), "dictionary", way) for way in ways)
        word = word_key(word)
        if word not in self._known:
            self._known[word] = tuple(_Way(*way) for way in self._ways(word))
        return self._known[word]

    def _ways(self, word: str) -> tuple[tuple[Sounds, Source], ...]:
        """The ways to say a word, before r and dentals meet."""
        if ways := self._lookup(word):
            return tuple((way, "lexicon") for way in ways)
        if parts := split_number(word):
            return ((join_parts(self._lookup(part)[0] for part in parts), "lexicon"),)
        if found := _ENDED.fullmatch(word):
            ending = tuple(ENDINGS.get(found["end"], "").split())
            return tuple(((*way, *ending), "rule") for way in self._lookup(found["base"]))
        letters = "".join(_LETTERS.findall(word))
        if not letters:
            raise LipwrightError(
                f"{word!r} cannot be pronounced; spell it in letters, or add it to the dictionary"
            )
        return self._unknown(letters)

    def _unknown(self, letters: str) -> tuple[tuple[Sounds, Source], ...]:
        """The ways to say a word that no lexicon has: guessed, unless a rule is surer."""
        if ways := inflected(letters, self._lookup):
            return tuple((way, "rule") for way in ways)
        if letters.endswith(_SON) and len(letters) > len(_SON) + 1:
            ((way, source), *_) = self._ways(letters.removesuffix(_SON))
            sounds = join_parts((way, ("s", "ɔ", "n")))
            return ((sounds, "g2p" if source == "g2p" else "rule"),)
        guess, sureness = self._field.guess(_MUTE_H.sub("", letters))
        compound = self._compounds.say(letters) if sureness < _SURE else None
        if not guess and not compound:
            raise LipwrightError(f"{letters!r} cannot be pronounced; add it to the dictionary")
        rules: tuple[tuple[Sounds, Source], ...] = ((compound, "rule"),) if compound else ()
        return (*rules, (guess, "g2p")) if guess else rules


def _end(row: Sequence[_Way]) -> str:
    """The last sound of a word's first way, as far as it curls the dentals behind it."""
    last = assimilate(row[0].sounds)[-1:]
    return last[0] if last else ""


def _start(row: Sequence[_Way]) -> str:
    """The first sound of a word's first way."""
    return row[0].sounds[0] if row[0].sounds else ""


def _where_it_stands(row: Sequence[_Way], before: str, follows: str) -> tuple[Pronunciation, ...]:
    """The ways of one word behind the sound `before` and before the sound `follows`, then alone."""
    said = []
    for one, other in ((before, follows), ("", "")):
        for way in row:
            if not way.sounds:
                said.append(Pronunciation(way.phones, way.source))
                continue
            sounds = open_before_r(assimilate(way.sounds, one))
            if other in RETROFLEX and sounds[-1] == "r" and len(sounds) > 1:
                sounds = sounds[:-1]
            said.append(pronunciation(sounds, way.source))
    apart: dict[tuple[tuple[str, ...], ...], Pronunciation] = {}
    for one_said in said:
        apart.setdefault((one_said.phones, one_said.ipa), one_said)
    return tuple(apart.values())


def make(code: str) -> Swedish:
    """The language of `LANGUAGES`."""
    del code
    return Swedish()
