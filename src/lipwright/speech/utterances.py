"""Recognised phones in runs without long gaps, and which of those runs are speech at all.

The network hears a phone here and there in drums, music and noise, and is unsure of it. Such runs
are dropped, so that a mouth does not twitch. Laughter gives vowels, which may stay.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from typing import Final

import numpy as np

_GAP: Final = 0.6  # s between two phones of different utterances
_PAUSE: Final = 0.3  # s between two phones with a pause between them, probably
# Least mean probability of the phones of an utterance: this, and a share of that for each of its
# phones, since one or two are soon found in anything. Measured: speech 0.55 and more even under
# music as loud; drums 0.27, music 0.30 and, two phones of them, 0.47; laughter 0.39.
_LEAST_SURE: Final = 0.35
_LEAST_MORE: Final = 0.45

# Share of phones that are right against the mean probability of all: a line through twelve
# conditions of sound (clean, music and pink noise from 20 to 0 dB under it, telephone, clipped).
_SLOPE, _OFFSET = 1.27, -0.35

_WINDOW: Final = 5.0  # s that are judged together
# Confidence under which such a window is unsure. Of three recordings of bench/listening.py at a
# time, under it are 81 % with music as loud as the speech, 13 % 5 dB lower, 7 % as recorded.
_LEAST_PART: Final = 0.6
_FEWEST: Final = 12  # phones: a window with fewer tells nothing


@dataclass(frozen=True)
class TimedPhone:
    """A phone and when the network wrote it."""

    symbol: str
    time: float
    """s, about where it begins"""
    probability: float
    ends_word: bool


@dataclass(frozen=True)
class Utterance:
    """Phones without a long gap, at least one."""

    phones: tuple[TimedPhone, ...]

    @property
    def start(self) -> float:
        """The time of the first phone in s."""
        return self.phones[0].time

    @property
    def end(self) -> float:
        """The time of the last phone in s, about where that begins."""
        return self.phones[-1].time

    @property
    def is_speech(self) -> bool:
        """Whether the network is sure enough of it."""
        sure = float(np.mean([phone.probability for phone in self.phones]))
        return sure >= _LEAST_SURE + _LEAST_MORE / len(self.phones)

    def words(self) -> list[list[str]]:
        """Symbols in runs between which there may be a pause."""
        words: list[list[str]] = [[]]
        for index, phone in enumerate(self.phones):
            words[-1].append(phone.symbol)
            after = self.phones[index + 1 : index + 2]
            if after and (phone.ends_word or after[0].time - phone.time > _PAUSE):
                words.append([])
        return words


def utterances(phones: Iterable[TimedPhone]) -> list[Utterance]:
    """The phones, in the order of time, parted where there is a long gap."""
    runs: list[list[TimedPhone]] = []
    for phone in phones:
        if runs and phone.time - runs[-1][-1].time <= _GAP:
            runs[-1].append(phone)
        else:
            runs.append([phone])
    return [Utterance(tuple(run)) for run in runs]


def confidence(phones: Sequence[TimedPhone]) -> float:
    """0 to 1, the share of phones that is likely to be right, missing ones counted as wrong."""
    sure = float(np.mean([phone.probability for phone in phones]))
    return float(np.clip(_SLOPE * sure + _OFFSET, 0.0, 1.0))


def unsure_stretches(phones: Sequence[TimedPhone]) -> list[tuple[float, float, float]]:
    """Start and end in s, and the confidence, of stretches in which few phones are likely right."""
    windows = [list(some) for _, some in groupby(phones, lambda phone: int(phone.time / _WINDOW))]
    found = []
    for unsure, some in groupby(windows, _is_unsure):
        if unsure:
            run = list(chain.from_iterable(some))
            found.append((run[0].time, run[-1].time, confidence(run)))
    return found


def _is_unsure(window: Sequence[TimedPhone]) -> bool:
    return len(window) >= _FEWEST and confidence(window) < _LEAST_PART
