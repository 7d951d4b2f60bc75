"""Times for words that nobody has spoken yet, to look at: a plain rule, not a voice."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.language import get_language
from lipwright.language.base import SpokenWord
from lipwright.phones import PHONES, SILENCE, Phone
from lipwright.track import PhoneTrack, Word

MAX_WORDS: Final = 200  # a minute and a half; a longer text wants its recording

# s, ours: round figures of fluent American English, in the order of the inherent durations of
# Klatt, "Synthesis by rule of segmental durations in English sentences" (1979).
DURATIONS: Final = MappingProxyType({
    "diphthong": 0.16, "vowel": 0.11, "weak vowel": 0.06,
    "stop": 0.07, "affricate": 0.10, "fricative": 0.10, "voiced fricative": 0.06,
    "nasal": 0.065, "flap": 0.025, "lateral": 0.065, "approximant": 0.065,
})  # fmt: skip
"""kind of phone to s"""
WEAK_VOWELS: Final = frozenset(("AX", "AXR", "IX"))
LAST_SYLLABLE: Final = 1.4  # longer before a pause; Klatt 1979, rule 1, has it so
EDGE_SILENCE: Final = 0.25  # s, before the first and after the last word
COMMA, STOP = 0.18, 0.4  # s, the pause after a word with such a mark
_PAUSES: Final = MappingProxyType({
    **dict.fromkeys(",;:、，；：)", COMMA), **dict.fromkeys(".!?。！？…", STOP)
})  # fmt: skip


def kind_of(phone: Phone) -> str:
    """The kind by which `DURATIONS` knows a phone that is said."""
    if phone.is_vowel:
        weak = phone.symbol in WEAK_VOWELS
        return "weak vowel" if weak else "diphthong" if phone.is_diphthong else "vowel"
    if phone.manner == "fricative" and phone.voiced:
        return "voiced fricative"
    return phone.manner


def pause_after(word: SpokenWord) -> float:
    """Seconds of silence that the mark behind a word asks for; an abbreviation's stop is none."""
    mark = word.written.rstrip("\"'”’»)]")[-1:]
    if mark == "." and word.written.rstrip(".").casefold() != word.text:
        return 0.0
    return _PAUSES.get(mark, 0.0)


def _lengths(phones: Sequence[str], *, before_pause: bool) -> list[float]:
    lengths = [DURATIONS[kind_of(PHONES[phone])] for phone in phones]
    if before_pause:
        vowels = [place for place, phone in enumerate(phones) if PHONES[phone].is_vowel]
        for place in range(vowels[-1] if vowels else 0, len(phones)):
            lengths[place] *= LAST_SYLLABLE
    return lengths


def spoken_track(text: str, language: str = "en", source: str = "text") -> PhoneTrack:
    """The phones of `text` at times that a plain rule gives them, with silence around.

    Each kind of phone has its duration, the last syllable before a pause is longer, and marks
    make pauses. `source` names the text in errors.

    Raises:
        LipwrightError: no such language, no words or too many, or words that it cannot say.
    """
    speaker = get_language(language)
    said = speaker.normalize(text, source)
    if len(said) > MAX_WORDS:
        raise LipwrightError(f"{source}: {len(said)} words; give at most {MAX_WORDS}, a line")
    ways = speaker.pronounce_all(said)
    phones, lengths, words = [SILENCE], [EDGE_SILENCE], []
    for number, word in enumerate(said):
        of_token = number + 1 < len(said) and (word.line, word.column) == (
            said[number + 1].line, said[number + 1].column,
        )  # fmt: skip
        last = number + 1 == len(said)
        pause = EDGE_SILENCE if last else 0.0 if of_token else pause_after(word)
        way = ways[number][0].phones
        words.append(Word(word.text, len(phones), len(phones) + len(way)))
        phones += way
        lengths += _lengths(way, before_pause=pause > 0)
        if pause:
            phones.append(SILENCE)
            lengths.append(pause)
    return PhoneTrack(tuple(phones), np.cumsum([0.0, *lengths]), tuple(words))
