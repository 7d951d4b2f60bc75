"""German, Spanish, French, Italian, Dutch and Portuguese: one engine and a table for each."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from importlib import import_module
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Phoneme, Pronunciation, SpokenWord
from lipwright.language.dictionary import Dictionary
from lipwright.language.tabled.compounds import parts_of, split_compound
from lipwright.language.tabled.lexicon import Lexicon
from lipwright.language.tabled.sounds import finished, mended, phones_of, pronunciation
from lipwright.language.tabled.text import Reader
from lipwright.language.tabled.values import Place, Tables, Way

TABLES: Final = MappingProxyType({
    "de": "german", "es": "spanish", "fr": "french", "it": "italian", "nl": "dutch",
    "pt": "portuguese",
})  # fmt: skip
"""code to the module whose TABLES make the language"""

_PAUSE: Final = re.compile(r"[,.;:!?…)\]]['\"”’»]*$")
_LONGEST_WAYS: Final = 4  # of a word with parts that have several


class Tabled:
    """A language made of its tables."""

    def __init__(self, tables: Tables) -> None:
        """Its lexicon is opened when it is first needed."""
        self.tables = tables
        self.code = tables.code
        self.name = tables.name
        self._known: dict[str, tuple[Way, ...]] = {}

    @cached_property
    def lexicons(self) -> tuple[Lexicon, ...]:
        """The lexicons, the first asked first.

        Raises:
            MissingExtraError: their package is not installed.
        """
        tables = self.tables
        return tuple(Lexicon(tables.package, folder, self.name) for folder in tables.lexicons)

    def normalize(
        self, text: str, source: str = "text", dictionary: Dictionary | None = None
    ) -> tuple[SpokenWord, ...]:
        """The words of `text` as they are spoken, as `Language.normalize` describes it."""
        return Reader(self.tables, self.lexicons, dictionary).read(text, source)

    def pronounce(
        self, word: str, dictionary: Dictionary | None = None
    ) -> tuple[Pronunciation, ...]:
        """The ways to say a word: the user's, else the lexicon's, else by rule, else guessed.

        Raises:
            LipwrightError: the word has no letters.
        """
        if dictionary and (own := dictionary.lookup(word)):
            return tuple(Pronunciation(way, "dictionary") for way in own)
        return _distinct(self.ways(word))

    def pronounce_all(
        self, words: Sequence[SpokenWord], dictionary: Dictionary | None = None
    ) -> tuple[tuple[Pronunciation, ...], ...]:
        """The ways to say each word where it stands, as `Language.pronounce_all` describes it."""
        own = [dictionary.lookup(word.text) if dictionary else () for word in words]
        self._remember({word.text for word, ways in zip(words, own, strict=True) if not ways})
        alone = [
            () if ways else self.ways(word.text) for word, ways in zip(words, own, strict=True)
        ]
        said: list[tuple[Pronunciation, ...]] = []
        link = self.tables.link
        for at, word in enumerate(words):
            if own[at]:
                said.append(tuple(Pronunciation(way, "dictionary") for way in own[at]))
            elif link:
                said.append(_distinct(link(word.text, alone[at], _place(words, alone, at))))
            else:
                said.append(_distinct(alone[at]))
        return tuple(said)

    def inventory(self) -> tuple[Phoneme, ...]:
        """Every sound that the language's pronunciations may have."""
        sounds = self.tables.sounds.items()
        return tuple(Phoneme(sound, phones_of(sound), example) for sound, example in sounds)

    def ways(self, word: str) -> tuple[Way, ...]:
        """The ways to say a word, in the sounds of the language.

        Raises:
            LipwrightError: the word has no letters.
        """
        key = unicodedata.normalize("NFC", word).lower()
        if key not in self._known:
            self._known[key] = self._find(key)
        return self._known[key]

    def _remember(self, words: Iterable[str]) -> None:
        """Look up words, then the parts of those that are missing, in one search each."""
        fresh = {unicodedata.normalize("NFC", word).lower() for word in words}
        fresh = {word for word in fresh if word not in self._known}
        fresh |= {part for word in fresh for part in re.split("['-]", word)}
        self._search(fresh)
        if self.tables.links:
            missing = (word for word in fresh if not any(word in each for each in self.lexicons))
            self._search({part for word in missing for part in parts_of(word)})

    def _search(self, words: Iterable[str]) -> None:
        words = set(words)
        for lexicon in self.lexicons:
            lexicon.remember(words)

    def _find(self, word: str) -> tuple[Way, ...]:
        for find in (self._listed, self._parted, self._compound):
            if ways := find(word):
                return ways
        return self._guessed(word)

    def _finished(self, word: str, sounds: Iterable[str]) -> tuple[str, ...]:
        return finished(word, tuple(sounds), self.tables)

    def _listed(self, word: str) -> tuple[Way, ...]:
        """The ways of the table or the lexicons."""
        tables = self.tables
        if said := tables.said.get(word):
            return tuple(
                Way(self._finished(word, way.split()), "lexicon") for way in said.split(" / ")
            )
        for folder, lexicon in zip(tables.lexicons, self.lexicons, strict=True):
            ways = (mended(spelt, tables.mends[folder]) for spelt in lexicon.lookup(word))
            found = tuple(Way(self._finished(word, way), "lexicon") for way in ways if way)
            if found:
                return found
        return ()

    def _is_listed(self, word: str) -> bool:
        return word in self.tables.said or any(word in lexicon for lexicon in self.lexicons)

    def _parted(self, word: str) -> tuple[Way, ...]:
        """The ways of a word with an apostrophe or a hyphen, from its parts."""
        if not re.search(r"[^\W_]['-]|['-][^\W_]", word):
            return ()
        sounds: tuple[str, ...] = ()
        guessed = False
        for piece in self._pieces(word):
            if piece in self.tables.clitics:
                sounds += tuple(self.tables.clitics[piece].split())
            elif piece:
                way = self.ways(piece)[0]
                guessed = guessed or way.source == "g2p"
                sounds += way.sounds
        return (Way(_one_stress(sounds), "g2p" if guessed else "rule"),) if sounds else ()

    def _pieces(self, word: str) -> Iterator[str]:
        """The words and clitics between the hyphens and apostrophes of a word."""
        clitics = self.tables.clitics
        for part in word.split("-"):
            rest = part
            while "'" in rest:
                left, _, right = rest.partition("'")
                if f"{left}'" in clitics:
                    left, rest = f"{left}'", right
                elif f"'{right}" in clitics:
                    yield left
                    left, rest = f"'{right}", ""
                else:
                    rest = right
                yield left
            yield rest

    def _compound(self, word: str) -> tuple[Way, ...]:
        if not self.tables.links:
            return ()
        links = dict(self.tables.links)
        self._search(parts_of(word))
        parts = split_compound(word, self._is_listed, tuple(links))
        if not parts:
            return ()
        sounds: tuple[str, ...] = ()
        for at, (part, link) in enumerate(parts):
            way = self._listed(part)[0].sounds
            sounds += tuple(s.replace("ˈ", "ˌ") for s in way) if at else way
            sounds += tuple(links[link].split()) if link else ()
        return (Way(sounds, "rule"),)

    def _guessed(self, word: str) -> tuple[Way, ...]:
        letters = "".join(char for char in word if char.isalpha())
        if not letters:
            raise LipwrightError(
                f"{word!r} cannot be pronounced; spell it in letters, or add it to the dictionary"
            )
        tables = self.tables
        at = tables.lexicons.index(tables.guess_from) if tables.guess_from is not None else 0
        bare = unicodedata.normalize("NFD", letters) if tables.guess_plain else letters
        spelt = self.lexicons[at].guess("".join(char for char in bare if char.isalpha()))
        sounds = mended(spelt, tables.mends[tables.lexicons[at]])
        if not sounds:  # a lone mute letter is called by its name
            called = tables.letter_names
            bare = unicodedata.normalize("NFD", letters)
            names = " ".join(called.get(char, "") for char in (letters, *bare)).split()
            sounds = tuple(s for name in names for s in self.ways(name)[0].sounds)
        if not sounds:
            raise LipwrightError(
                f"{word!r} cannot be pronounced; spell it otherwise, or add it to the dictionary"
            )
        return (Way(self._finished(word, sounds), "g2p"),)


def _one_stress(sounds: tuple[str, ...]) -> tuple[str, ...]:
    """The sounds with the last main stress only; those before it become side stresses."""
    main = [at for at, sound in enumerate(sounds) if sound[0] == "ˈ"]
    return tuple("ˌ" + sound[1:] if at in main[:-1] else sound for at, sound in enumerate(sounds))


def _distinct(ways: Iterable[Way]) -> tuple[Pronunciation, ...]:
    """The pronunciations whose phones differ."""
    found: dict[tuple[str, ...], Pronunciation] = {}
    for way in ways:
        made = pronunciation(way)
        found.setdefault(made.phones, made)
    return tuple(found.values())


def _place(words: Sequence[SpokenWord], alone: Sequence[tuple[Way, ...]], at: int) -> Place:
    """The neighbours that the word touches."""

    def touches(one: int, other: int) -> bool:
        if one < 0 or other >= len(words):
            return False
        same = (words[one].line, words[one].column) == (words[other].line, words[other].column)
        return same or not _PAUSE.search(words[one].written)

    def sounds(other: int) -> tuple[str, ...]:
        return alone[other][0].sounds if alone[other] else ()

    before, after = touches(at - 1, at), touches(at, at + 1)
    return Place(
        words[at - 1].text if before else "", sounds(at - 1) if before else (),
        words[at + 1].text if after else "", sounds(at + 1) if after else (),
    )  # fmt: skip


def make(code: str) -> Tabled:
    """The language of `LANGUAGES`."""
    return Tabled(import_module(f"{__name__}.{TABLES[code]}").TABLES)
