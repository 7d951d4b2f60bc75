"""Text to the phonemes of a Piper voice, with the phones and the written words behind them.

A Piper voice reads the IPA of espeak-ng as it comes, code point by code point (NFD), with the
punctuation that ends each clause; a pad stands after each, and marks for begin and end around a
sentence (piper, phonemize_espeak.py and phoneme_ids.py, read for the order alone).
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Final, Literal

from lipwright import espeak
from lipwright.errors import LipwrightError
from lipwright.language.espeak_ipa import read_espeak
from lipwright.language.ipa import Sound
from lipwright.phones import PHONES, SILENCE, nearest_phones
from lipwright.speech.voices.espeak_text import bare_word
from lipwright.speech.voices.piper_config import BEGIN, END, PAD, SPACE, PiperConfig

Kind = Literal["edge", "sounds", "space", "pause"]

_SENTENCE_ENDS: Final = ".!?"
_CLAUSE_ENDS: Final = ",:;"
_LIKE: Final = str.maketrans("。！？，；：、…", ".!?,;:,.")
_STRESSES: Final = "ˈˌ"
# A word, or one character of a script without spaces.
_TOKEN: Final = re.compile(r"[\u2e80-\ua4cf\uf900-\ufaff]|[^\s\u2e80-\ua4cf\uf900-\ufaff]+")


@dataclass(frozen=True)
class Unit:
    """What the voice is given for one phoneme or mark."""

    kind: Kind
    ids: tuple[int, ...]
    """the model's numbers, with the pads behind them"""
    sounds: tuple[Sound, ...] = ()
    word: int | None = None
    """index of its word in the sentence"""


@dataclass(frozen=True)
class Sentence:
    """What the voice says in one go."""

    units: tuple[Unit, ...]
    words: tuple[str, ...]
    """as written"""
    text: str
    """as written"""


def sentences(text: str, config: PiperConfig) -> Iterator[Sentence]:
    """The sentences of a text.

    Raises:
        LipwrightError: espeak-ng is missing or has not the voice's language.
    """
    if config.phoneme_type == "text":
        yield from _spelled(text, config)
        return
    waiting: list[espeak.Clause] = []
    for clause in espeak.to_clauses(text, config.espeak_voice):
        waiting.append(clause)
        if _mark(clause.text) in _SENTENCE_ENDS:
            yield _sentence(waiting, config)
            waiting = []
    if any(clause.words for clause in waiting):
        yield _sentence(waiting, config)


def spoken_phones(phones: Sequence[str], word: str, config: PiperConfig) -> Sentence:
    """Phones of the table, or the nearest that the voice has letters for, as one word."""
    marks = _Marks(config)
    units = [marks.begin]
    for phone in phones:
        if phone == SILENCE:
            units.append(marks.pause(","))
            continue
        near = (one for one in (phone, *nearest_phones(phone)) if one != SILENCE)
        said = next((one for one in near if marks.knows(PHONES[one].ipa)), None)
        if said is not None:
            units.append(marks.unit(PHONES[said].ipa, PHONES[said].ipa, 0))
    return Sentence((*units, marks.pause("."), marks.end), (word,), word)


class _Marks:
    """A voice's numbers for phonemes and marks."""

    def __init__(self, config: PiperConfig) -> None:
        self._ids, self._clusters = config.ids, config.clusters
        self._language = config.espeak_voice
        self.begin = Unit("edge", (*config.ids[BEGIN], *config.ids[PAD]))
        self.end = Unit("edge", config.ids[END])
        self.space = Unit("space", self._numbers([SPACE]))

    def _numbers(self, letters: Sequence[str]) -> tuple[int, ...]:
        found: list[int] = []
        for letter in letters:
            if letter in self._ids:
                found += (*self._ids[letter], *self._ids[PAD])
        return tuple(found)

    def knows(self, ipa: str) -> bool:
        """Whether the voice has a number for each letter."""
        return all(letter in self._ids for letter in unicodedata.normalize("NFD", ipa))

    def pause(self, mark: str) -> Unit:
        return Unit("pause", self._numbers([mark, SPACE] if mark in _CLAUSE_ENDS else [mark]))

    def unit(self, raw: str, ipa: str, word: int | None) -> Unit:
        """A phoneme as espeak-ng writes it, and its IPA."""
        letters = list(unicodedata.normalize("NFD", raw))
        merged: list[str] = []
        for letter in letters:
            if (
                merged
                and merged[-1] + letter in self._clusters
                and merged[-1] + letter in self._ids
            ):
                merged[-1] += letter
            else:
                merged.append(letter)
        try:
            sounds = read_espeak(ipa, self._language)
        except LipwrightError:  # a mnemonic that is no IPA
            sounds = ()
        return Unit("sounds", self._numbers(merged), sounds, word)


def _sentence(clauses: Sequence[espeak.Clause], config: PiperConfig) -> Sentence:
    marks = _Marks(config)
    units, words = [marks.begin], list[str]()
    for clause in clauses:
        tokens = [found[0] for found in _TOKEN.finditer(clause.text)]
        owners = _owners(clause, tokens, config.espeak_voice)
        first = len(words)
        words += [bare_word(token) for token in tokens]
        place = 0
        for number, word in enumerate(clause.words):
            units += [marks.space] if number else []
            for raw, ipa in word:
                units.append(marks.unit(raw, ipa, first + owners[place] if tokens else None))
                place += 1
        units.append(marks.pause(_mark(clause.text) or "."))
    units = [unit for unit in units if unit.ids or unit.sounds]
    return Sentence((*units, marks.end), tuple(words), "".join(clause.text for clause in clauses))


def _owners(clause: espeak.Clause, tokens: Sequence[str], voice: str) -> list[int]:
    """The token that each phoneme of a clause belongs to."""
    alone = [espeak.to_clauses(token, voice) for token in tokens]
    by_token = [[word for part in parts for word in part.words] for parts in alone]
    if sum(map(len, by_token)) == len(clause.words):
        of_word = [token for token, words in enumerate(by_token) for _ in words]
        return [of_word[number] for number, word in enumerate(clause.words) for _ in word]
    apart = [(_plain(raw), token) for token, words in enumerate(by_token)
             for word in words for raw, _ in word]  # fmt: skip
    together = [_plain(raw) for word in clause.words for raw, _ in word]
    found: list[int | None] = [None] * len(together)
    matcher = SequenceMatcher(None, [raw for raw, _ in apart], together, autojunk=False)
    for here, there, size in matcher.get_matching_blocks():
        for step in range(size):
            found[there + step] = apart[here + step][1]
    last = next((owner for owner in found if owner is not None), 0)
    owners: list[int] = []
    for owner in found:
        last = last if owner is None else owner
        owners.append(last)
    return owners


def _plain(raw: str) -> str:
    return raw.lstrip(_STRESSES)


def _mark(text: str) -> str:
    """The punctuation that ends a clause, as Piper voices know it; "" for none."""
    for char in reversed(text.translate(_LIKE).rstrip()):
        if char in _SENTENCE_ENDS + _CLAUSE_ENDS:
            return char
        if char.isalnum():
            break
    return ""


def _spelled(text: str, config: PiperConfig) -> Iterator[Sentence]:
    """The sentences of a text for a voice that reads letters."""
    marks = _Marks(config)
    for part in re.split(r"(?<=[.!?])\s+", text):
        letters = [one for one in unicodedata.normalize("NFD", part.casefold().strip())
                   if one in config.ids]  # fmt: skip
        if letters:
            said = (marks.unit(letter, "", None) for letter in letters)
            yield Sentence((marks.begin, *said, marks.end), (), part)
