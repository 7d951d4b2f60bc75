"""From the probabilities of a recogniser to a row of phones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from lipwright.phones import BILABIALS
from lipwright.speech.features import Floats
from lipwright.speech.recogniser import NOTHING, WORD_END, symbols

# Probability under which a p, b or m is not believed: lips that shut where they should not are
# seen more than any other error. Of those below, one in ten was right (GRID, EMU, two voices).
_LEAST_LABIAL: Final = 0.4
_LEAST_OTHER: Final = 0.1  # probability from which the next best phone takes its place


@dataclass(frozen=True)
class RecognisedPhone:
    """A phone that the network wrote."""

    symbol: str
    """of the phone table"""
    frame: int
    """row of the network's output at which it is written"""
    probability: float
    """0 to 1, as the network sees it; about the share of such phones that are right"""
    ends_word: bool = False


def decode(log_probabilities: Floats) -> list[RecognisedPhone]:
    """The likeliest phones of (T, S) log-probabilities, in order."""
    names, _ = symbols()
    best = log_probabilities.argmax(axis=1)
    starts = np.flatnonzero(np.diff(best, prepend=-1)).tolist()
    found: list[RecognisedPhone] = []
    for start, stop in zip(starts, [*starts[1:], len(best)], strict=True):
        name = names[best[start]]
        if name == WORD_END and found:
            found[-1] = replace(found[-1], ends_word=True)
        elif name not in (WORD_END, NOTHING):
            phone = _believed(log_probabilities[start:stop].max(axis=0), int(best[start]), start)
            found += [] if phone is None else [phone]
    return found


def _believed(peaks: Floats, best: int, frame: int) -> RecognisedPhone | None:
    """The phone that is written there, or one that shuts no lips if it is not sure."""
    names, _ = symbols()
    if names[best] in BILABIALS and np.exp(peaks[best]) < _LEAST_LABIAL:
        others = [i for i, name in enumerate(names) if name not in (*BILABIALS, WORD_END, NOTHING)]
        best = max(others, key=lambda i: float(peaks[i]))
        if np.exp(peaks[best]) < _LEAST_OTHER:
            return None
    return RecognisedPhone(names[best], frame, min(float(np.exp(peaks[best])), 1.0))
