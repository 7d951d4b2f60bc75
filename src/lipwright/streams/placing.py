"""Phones within a stretch of time: by their usual durations, or on what a file times inside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.language.pace import DURATIONS, kind_of
from lipwright.phones import PHONES, phone_distance
from lipwright.streams.times import Timed

HELD: Final = 1.5  # times its usual duration; a consonant is not held longer while vowels can be
STEP: Final = 0.5  # cost of a phone without a viseme of its own, or the reverse; ours

Cost = Callable[[str, str], float]
"""how ill a phone suits a label, from 0"""


def usual_duration(phone: str) -> float:
    """Seconds that a phone lasts in fluent speech."""
    return DURATIONS[kind_of(PHONES[phone])]


def paced(phones: Sequence[str], start: float, end: float) -> list[float]:
    """The edges (s, one more than phones) by usual durations; in slow words, vowels take more."""
    lengths = np.array([usual_duration(phone) for phone in phones])
    vowels = np.array([PHONES[phone].is_vowel for phone in phones])
    factor = (end - start) / lengths.sum()
    if factor > HELD and vowels.any():
        consonants = HELD * lengths[~vowels].sum()
        lengths = lengths * np.where(
            vowels, (end - start - consonants) / lengths[vowels].sum(), HELD
        )
    else:
        lengths = lengths * factor
    edges = start + np.concatenate([[0.0], np.cumsum(lengths)])
    return [*edges[:-1].tolist(), end]


def matched(phones: Sequence[str], units: Sequence[Timed], cost: Cost) -> list[float]:
    """The edges (s, one more than phones) of phones on timed units that follow each other.

    Dynamic programming over the order-keeping ways to give each phone at least one unit and each
    unit at least one phone; phones that share a unit share its time by their usual durations.

    Args:
        phones: symbols of the phone table, at least one.
        units: with ends, each ending where the next starts; at least one.
        cost: of a phone on the label of a unit.
    """
    path = _cheapest_path(np.array([[cost(p, unit.label) for unit in units] for p in phones]))
    starts: dict[int, float] = {}
    for number, unit in enumerate(units):
        on_it = [phone for phone, at in path if at == number]
        assert unit.end is not None  # the caller has filled it in
        edges = paced([phones[phone] for phone in on_it], unit.start, unit.end)
        for phone, start in zip(on_it, edges, strict=False):
            starts.setdefault(phone, start)
    last = units[-1].end
    assert last is not None
    return [*(starts[phone] for phone in range(len(phones))), last]


def _cheapest_path(costs: npt.NDArray[np.float64]) -> list[tuple[int, int]]:
    """The cells (phone, unit) of the cheapest way from the first to the last of both."""
    rows, columns = costs.shape
    totals = np.full((rows + 1, columns + 1), np.inf)
    totals[0, 0] = 0.0
    for row in range(1, rows + 1):
        for column in range(1, columns + 1):
            aside = STEP + min(totals[row - 1, column], totals[row, column - 1])
            best = min(totals[row - 1, column - 1], aside)
            totals[row, column] = best + costs[row - 1, column - 1]
    row, column = rows, columns
    path = [(row - 1, column - 1)]
    while (row, column) != (1, 1):
        steps = {
            (row - 1, column - 1): totals[row - 1, column - 1],
            (row - 1, column): STEP + totals[row - 1, column],
            (row, column - 1): STEP + totals[row, column - 1],
        }
        row, column = min(steps, key=lambda cell: float(steps[cell]))
        path.append((row - 1, column - 1))
    return path[::-1]


@lru_cache(maxsize=8192)
def distance_to(phone: str, members: tuple[str, ...]) -> float:
    """How unlike a phone is to the most alike of `members`; a diphthong is as its parts are."""
    ways = (phone, *(PHONES[phone].parts or ()))
    return min(phone_distance(way, member) for way in ways for member in members)
