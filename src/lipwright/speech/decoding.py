"""From the probabilities of a recogniser to a row of phones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from lipwright.phones import BILABIALS
from lipwright.speech.features import Floats
from lipwright.speech.recogniser import NOTHING, WORD_END, symbols

# Probability under which a p, b or m is not believed: lips that shut where they should not are
# seen more than any other error. Of those below 0.4, one in ten was right (GRID, EMU, two voices).
_LEAST_LABIAL: Final = 0.45
_NEVER: Final = 1e-9  # probability
_LEAST_OTHER: Final = 0.1  # probability from which the next best phone takes its place


@dataclass(frozen=True)
class RecognisedPhone:
    """A phone that the network wrote."""

    symbol: str
    """of the phone table"""
    frame: int
    """row of the network's output at which it is written"""
    probability: float
    """0 to 1, as the network sees it; about the share of such phones that are right; of p, b and m,
    that it is any of them"""
    ends_word: bool = False


def decode(log_probabilities: Floats) -> list[RecognisedPhone]:
    """The likeliest phones of (T, S) log-probabilities, in order."""
    names, _ = symbols()
    rows = _labials_together(log_probabilities)
    best = rows.argmax(axis=1)
    starts = np.flatnonzero(np.diff(best, prepend=-1)).tolist()
    found: list[RecognisedPhone] = []
    for start, stop in zip(starts, [*starts[1:], len(best)], strict=True):
        name = names[best[start]]
        if name == WORD_END and found:
            found[-1] = replace(found[-1], ends_word=True)
        elif name not in (WORD_END, NOTHING):
            phone = _believed(rows[start:stop].max(axis=0), int(best[start]), start)
            found += [] if phone is None else [phone]
    return found


def _labials_together(log_probabilities: Floats) -> Floats:
    """The same where the likeliest of p, b and m has the probability of all of them.

    Lips do not show which of them it is, and the network often wavers between two.
    """
    names, _ = symbols()
    labials = [index for index, name in enumerate(names) if name in BILABIALS]
    rows = log_probabilities.copy()
    some = rows[:, labials]
    likeliest = np.arange(len(rows)), some.argmax(axis=1)
    together = np.log(np.exp(some).sum(axis=1))
    some[:] = np.log(_NEVER)
    some[likeliest] = together
    rows[:, labials] = some
    return rows


def _believed(peaks: Floats, best: int, frame: int) -> RecognisedPhone | None:
    """The phone that is written there, or one that shuts no lips if it is not sure."""
    names, _ = symbols()
    if names[best] in BILABIALS and np.exp(peaks[best]) < _LEAST_LABIAL:
        others = [i for i, name in enumerate(names) if name not in (*BILABIALS, WORD_END, NOTHING)]
        best = max(others, key=lambda i: float(peaks[i]))
        if np.exp(peaks[best]) < _LEAST_OTHER:
            return None
    return RecognisedPhone(names[best], frame, min(float(np.exp(peaks[best])), 1.0))
