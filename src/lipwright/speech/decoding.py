"""From the probabilities of a recogniser to a row of phones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lipwright.speech.features import Floats
from lipwright.speech.recogniser import NOTHING, WORD_END, symbols


@dataclass(frozen=True)
class RecognisedPhone:
    """A phone that the network wrote."""

    symbol: str
    """of the phone table"""
    frame: int
    """row of the network's output at which it is written"""
    probability: float
    """0 to 1, as the network sees it"""
    ends_word: bool = False


def decode(log_probabilities: Floats) -> list[RecognisedPhone]:
    """The likeliest phones of (T, S) log-probabilities, in order."""
    names, _ = symbols()
    best = log_probabilities.argmax(axis=1)
    starts = np.flatnonzero(np.diff(best, prepend=-1))
    found: list[RecognisedPhone] = []
    for start, stop in zip(starts, [*starts[1:], len(best)], strict=True):
        name = names[best[start]]
        if name == WORD_END and found:
            last = found[-1]
            found[-1] = RecognisedPhone(last.symbol, last.frame, last.probability, True)
        elif name not in (WORD_END, NOTHING):
            sure = float(np.exp(log_probabilities[start:stop, best[start]].max()))
            found.append(RecognisedPhone(name, int(start), min(sure, 1.0)))
    return found
