"""What a listener hears of speech beside its sounds: phrases, pauses, stressed words, questions."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import Final

import numpy as np

from lipwright.life.voice import Floats, Voice
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

PAUSE: Final = 0.2  # s of silence that part two phrases; stops close the mouth for less
APART: Final = 0.4  # s between accents: about the rhythm of stressed syllables
LEVEL_SPREAD: Final = 6.0  # dB over the phrase that count as one
PITCH_SPREAD: Final = 3.0  # semitones over the phrase that count as one
LENGTH_SPREAD: Final = 1.0  # doublings of the phrase's usual vowel that count as one
STRESSED: Final = 0.7  # for a vowel with primary stress
UNSTRESSED: Final = -0.7  # for one without
WEAK: Final = frozenset(("AX", "IX", "AXR"))  # vowels that never carry an accent
RISE: Final = 3.0  # semitones from the end's lowest pitch on that sound like a question
RISE_SPAN: Final = 0.5  # s before the end of a phrase in which it rises


@dataclass(frozen=True)
class Phrase:
    """Speech between two pauses."""

    start: float
    """s"""
    end: float
    """s"""
    rises: bool
    """whether its pitch rises at the end, as in a question"""


@dataclass(frozen=True)
class Accent:
    """A vowel that stands out."""

    time: float
    """s, where the vowel begins"""
    strength: float
    """0 to 1"""


@dataclass(frozen=True, eq=False)
class Prosody:
    """All that is heard of a track beside its sounds."""

    phrases: tuple[Phrase, ...]
    accents: tuple[Accent, ...]
    voice: Voice | None
    """None where there is no sound"""


def find_prosody(track: PhoneTrack, voice: Voice | None = None) -> Prosody:
    """The phrases and accents of a track."""
    return Prosody(tuple(find_phrases(track, voice)), tuple(find_accents(track, voice)), voice)


def find_phrases(track: PhoneTrack, voice: Voice | None = None) -> list[Phrase]:
    """The phrases of a track; without a voice none rises."""
    return [
        Phrase(start, end, voice is not None and _rises(voice, start, end))
        for start, end, _, _ in _runs(track)
    ]


def find_accents(track: PhoneTrack, voice: Voice | None = None) -> list[Accent]:
    """The vowels that stand out of their phrase by stress, loudness, pitch and length, in order.

    Each word has one at most, and they are at least `APART` s from each other: where two compete
    the stronger stays.
    """
    word_of = {
        index: number
        for number, word in enumerate(track.words)
        for index in range(word.first, word.stop)
    }
    found: list[Accent] = []
    durations = track.durations
    for _, _, first, stop in _runs(track):
        vowels = [i for i in range(first, stop) if PHONES[track.phones[i]].is_vowel]
        scores = _scores(track, durations, vowels, voice)
        best: dict[int, int] = {}
        for place, index in enumerate(vowels):
            word = word_of.get(index, -1 - index)
            if word not in best or scores[place] > scores[best[word]]:
                best[word] = place
        found += _apart(
            [
                Accent(float(track.edges[vowels[p]]), float(0.5 + 0.5 * np.tanh(scores[p])))
                for p in best.values()
            ]
        )
    return found


def _runs(track: PhoneTrack) -> Iterator[tuple[float, float, int, int]]:
    """Start, end (s), first and stop index of each run of phones without a pause."""
    silent = np.array([phone == SILENCE for phone in track.phones])
    parts = silent & (track.durations >= PAUSE)
    index = 0
    for pause, run in groupby(parts):
        first, index = index, index + len(tuple(run))
        spoken = first + np.flatnonzero(~silent[first:index])
        if not pause and len(spoken):
            begin, end = int(spoken[0]), int(spoken[-1]) + 1
            yield float(track.edges[begin]), float(track.edges[end]), begin, end


def _scores(
    track: PhoneTrack, durations: Floats, vowels: list[int], voice: Voice | None
) -> list[float]:
    """How much each vowel of a phrase stands out, around 0, of the order of 1."""
    if not vowels:
        return []
    lengths = durations[vowels]
    terms = [np.log2(lengths / np.median(lengths)) / LENGTH_SPREAD]
    stress = [track.stress[i] for i in vowels]
    if any(s is not None for s in stress):
        terms.append(np.array([STRESSED if s == 1 else UNSTRESSED for s in stress]))
    if voice is not None and len(voice.level):
        spans = [voice.span(track.edges[i], track.edges[i + 1]) for i in vowels]
        for heard, spread in ((voice.level, LEVEL_SPREAD), (voice.pitch, PITCH_SPREAD)):
            peaks = np.array([_peak(heard[span]) for span in spans])
            if np.isfinite(peaks).any():
                middle = np.nanmedian(peaks)
                terms.append(np.nan_to_num((peaks - middle) / spread))
    total = np.clip(terms, -1.5, 1.5).sum(axis=0)
    weak = np.array([track.phones[i] in WEAK for i in vowels])
    return np.where(weak, total - 1, total).tolist()


def _peak(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if len(known) else float("nan")


def _apart(accents: list[Accent]) -> list[Accent]:
    """The strongest accents that are at least `APART` s from each other, in order."""
    kept: list[Accent] = []
    times: list[float] = []
    for accent in sorted(accents, key=lambda a: (-a.strength, a.time)):
        place = bisect(times, accent.time)
        near = times[max(place - 1, 0) : place + 1]
        if all(abs(accent.time - time) >= APART for time in near):
            times.insert(place, accent.time)
            kept.append(accent)
    return sorted(kept, key=lambda a: a.time)


def _rises(voice: Voice, start: float, end: float) -> bool:
    """Whether the pitch at a phrase's end lies well over what it was just before."""
    last = voice.pitch[voice.span(max(start, end - RISE_SPAN), end)]
    heard = last[np.isfinite(last)]
    if len(heard) < 4:  # frames: too few to hear a melody
        return False
    return bool(np.median(heard[-3:]) - heard[:-2].min() >= RISE)
