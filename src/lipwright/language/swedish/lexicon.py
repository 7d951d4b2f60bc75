"""The Swedish lexicon of gruut (MIT; 20,000 words after Lexin), with what it leaves out put back.

It writes no retroflexes: "bord" is b uː d, and "fors" f ɔ ɕ; and no open ä: "verk" is v a r k.
Where the letters have an r that the sounds lack, r is put back, and the rules of assimilation say
what becomes of it. Entries that say another word than they spell, such as the present tense for
the infinitive, are mended or left out.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import closing
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.swedish.assimilation import RETROFLEX
from lipwright.language.swedish.sounds import LONG_R, LONG_VOWELS, VOWELS, is_vowel, plain

Sounds = tuple[str, ...]

_SPELT: Final = MappingProxyType({
    "a": "a ɑː ɔ ɛ ɛj", "å": "oː ɔ", "ä": "ɛː ɛ a eː æ æː", "ö": "øː œ",
    "e": "ɛ eː a ɛː ɪ iː œ øː æ",
    "é": "eː ɛ", "è": "ɛː ɛ eː", "à": "a ɑː", "ü": "yː ʏ", "i": "iː ɪ j a", "o": "uː ʊ oː ɔ a œ øː",
    "u": "ʉː ɵ v ʊ uː a œ ɪ", "y": "yː ʏ ɪ j iː a", "b": "b p", "c": "s k ɕ ɧ", "d": "d t",
    "f": "f v", "g": "ɡ j ɧ k ŋ", "h": "h", "j": "j ɧ ɕ", "k": "k ɕ ɡ", "l": "l", "m": "m",
    "n": "n ŋ m", "p": "p b", "q": "k", "r": "r rː", "s": "s ɧ ɕ", "t": "t ɧ d s ɕ", "v": "v f",
    "w": "v", "x": "k s", "z": "s", "ç": "s", "ñ": "n",
})  # fmt: skip
"""letter to the sounds that it may stand for in this lexicon"""
_SOUNDS_OF: Final = {letter: frozenset(sounds.split()) for letter, sounds in _SPELT.items()}
_CONSONANTS: Final = frozenset("pbtdkɡfvshmnŋlrjɕɧ")
_RS: Final = ("r", LONG_R)
_UNHEARD: Final = 0.3  # cost of a letter without a sound
_UNSPELT: Final = 1.0  # cost of a sound without a letter
_TOO_FAR: Final = 2.5  # cost from which an entry is of another word
_TOO_FAR_SHORT: Final = 1.0  # the same for a short word that could be said: "ko" is not K.O.
_SHORT: Final = 3  # letters
_VOWEL_LETTERS: Final = frozenset("aeiouyåäö")


def align(word: str, sounds: Sequence[str]) -> tuple[float, tuple[int | None, ...]]:
    """How badly sounds fit letters, and for each sound its letter's place, or None.

    Dynamic programming over letters and sounds. Doubled letters and x, which is two sounds, cost
    nothing.
    """
    rows = [[(0.0, "")] * (len(sounds) + 1) for _ in range(len(word) + 1)]
    for i in range(len(word) + 1):
        for j in range(len(sounds) + 1):
            ways = []
            if i:
                free = (i > 1 and word[i - 1] == word[i - 2]) or word[i - 1] in "-h"
                ways.append((rows[i - 1][j][0] + (0.1 if free else _UNHEARD), "letter"))
            if j:
                free = i > 0 and word[i - 1] == "x" and sounds[j - 1] == "s"
                ways.append((rows[i][j - 1][0] + (0.0 if free else _UNSPELT), "sound"))
            if i and j:
                fits = plain(sounds[j - 1]) in _SOUNDS_OF.get(word[i - 1], ())
                ways.append((rows[i - 1][j - 1][0] + (0.0 if fits else 1.5), "both"))
            if ways:
                rows[i][j] = min(ways)
    cost = rows[-1][-1][0]
    places: list[int | None] = []
    i, j = len(word), len(sounds)
    while i or j:
        step = rows[i][j][1]
        if step != "letter":
            places.append(i - 1 if step == "both" else None)
        i -= step != "sound"
        j -= step != "letter"
    return cost, tuple(reversed(places))


def mend(word: str, written: str) -> Sounds | None:
    """The sounds of an entry with its r and stress in place; None where it says another word."""
    sounds = [sound.replace("²", "").replace("'", "ˈ") for sound in written.split() if sound != "²"]
    sounds = _infinitive(word, sounds)
    if not sounds or any(plain(sound) not in VOWELS | _CONSONANTS for sound in sounds):
        return None
    cost, places = align(word, sounds)
    if cost >= (_TOO_FAR_SHORT if len(word) <= _SHORT and set(word) & _VOWEL_LETTERS else _TOO_FAR):
        return None
    return stressed(_with_r(word, sounds, places))


def _infinitive(word: str, sounds: list[str]) -> list[str]:
    """The sounds of a verb as it is spelt, where the entry has those of its present tense."""
    before = plain(sounds[-2]) if len(sounds) > 1 else ""
    if sounds[-1] == "r" and before in VOWELS:
        if word.endswith("a") and before == "ɛ":
            return [*sounds[:-2], "a"]
        if word[-1] in "iouyåäö" or (word[-1] in "ae" and word[-2:-1] != "r"):
            return sounds[:-1]
    if word.endswith("a") and not is_vowel(sounds[-1]):
        return [*(sounds[:-2] if sounds[-2:] == ["ɛ", "r"] else sounds), "a"]
    if word.endswith("as") and sounds[-1] == "s" and before not in VOWELS:
        return [*sounds[:-1], "a", "s"]
    return sounds


def _with_r(word: str, sounds: Sequence[str], places: Sequence[int | None]) -> Sounds:
    """The sounds with the r that the letters have, ʂ as the s that it is, and "er" open."""
    done: list[str] = []
    letters: list[str] = []
    last = -1  # place of the last letter that was heard
    for written, place in zip(sounds, places, strict=True):
        sound = written
        skipped = "" if place is None else word[last + 1 : place]
        letter = "" if place is None else word[place]
        if sound == "ɕ" and (letter == "s" or skipped.startswith("r")):
            sound = "s"
        if sound in RETROFLEX and skipped.startswith("r") and done and done[-1] not in _RS:
            done.append(LONG_R if skipped.startswith("rr") else "r")
            letters.append("r")
        elif sound == "r" and "rr" in word[max(0, last) : (place or 0) + 2]:
            sound = LONG_R
        done.append(sound)
        letters.append(letter)
        last = last if place is None else place
    for index, (letter, follows) in enumerate(zip(letters, done[1:], strict=False)):
        if plain(done[index]) == "a" and letter in ("e", "ä") and follows in _RS:
            done[index] = done[index].replace("a", "æ")
    return tuple(done)


def stressed(sounds: Sequence[str]) -> Sounds:
    """The sounds with one main stress, and a lesser one on each long vowel behind it."""
    done = list(sounds)
    vowels = [index for index, sound in enumerate(done) if is_vowel(sound)]
    if vowels and not any(done[index][0] == "ˈ" for index in vowels):
        long = [index for index in vowels if plain(done[index]) in LONG_VOWELS]
        first = (long or vowels)[0]
        done[first] = "ˈ" + plain(done[first])
    main = next((index for index in vowels if done[index][0] == "ˈ"), len(done))
    for index in vowels:
        if index > main and (done[index][0] == "ˈ" or plain(done[index]) in LONG_VOWELS):
            done[index] = "ˌ" + plain(done[index])
    return tuple(done)


class SwedishLexicon:
    """Words in lower case to the ways to say them, as r and dentals were before they met."""

    @cached_property
    def _entries(self) -> Mapping[str, tuple[str, ...]]:
        """Every word with its ways as written.

        The file has no index: 20 searches cost as much as reading it all, and a compound takes
        dozens.

        Raises:
            LipwrightError: the package is not installed, or its file cannot be read.
        """
        package = find_spec("gruut_lang_sv")
        if package is None or package.origin is None:
            raise LipwrightError(
                "the Swedish lexicon is not installed; run: pip install gruut-lang-sv"
            )
        path = Path(package.origin).with_name("lexicon.db")
        entries: dict[str, list[str]] = {}
        try:
            with closing(sqlite3.connect(f"{path.as_uri()}?mode=ro&immutable=1", uri=True)) as base:
                for word, written in base.execute("SELECT word, phonemes FROM word_phonemes"):
                    entries.setdefault(word, []).append(written)
        except sqlite3.Error as error:
            raise LipwrightError(
                f"{path}: cannot be read: {error}; install gruut-lang-sv again"
            ) from error
        return {word: tuple(ways) for word, ways in entries.items()}

    def __init__(self, leave_out: Collection[str] = ()) -> None:
        """The lexicon without some words, so that rules can be measured on them."""
        self._left_out = frozenset(leave_out)
        self._found: dict[str, tuple[Sounds, ...]] = {}

    def __contains__(self, word: object) -> bool:
        """Whether the lexicon can say the word, given in lower case."""
        return isinstance(word, str) and bool(self.lookup(word))

    def words(self) -> Iterator[str]:
        """Every word that is written in it."""
        return iter(self._entries)

    def lookup(self, word: str) -> tuple[Sounds, ...]:
        """The ways to say the word, given in lower case; none if it is missing."""
        if word in self._left_out:
            return ()
        if word not in self._found:
            ways = (mend(word, written) for written in self._entries.get(word, ()))
            self._found[word] = tuple(dict.fromkeys(way for way in ways if way))
        return self._found[word]
