"""Edges for phones that were recognised: the aligner's search, with phones for a transcript."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, chain, pairwise
from typing import Final

from lipwright.phones import PHONES
from lipwright.speech.fit import placed_words
from lipwright.speech.graph import build_graph
from lipwright.speech.held import over_held
from lipwright.speech.scores import Scores
from lipwright.speech.search import STRICT, Search, Segment
from lipwright.speech.units import Units, units_of

_LEAST_FRAMES: Final = 3  # of a phone: one a state


@dataclass(frozen=True)
class PlacedPhone:
    """A phone with its frames."""

    symbol: str
    start: int
    """frame of the acoustic features, 100 a second"""
    stop: int
    score: float
    """mean log-likelihood ratio a frame against any speech"""


def place_phones(
    words: Sequence[Sequence[str]], scores: Scores, start: int, stop: int
) -> list[PlacedPhone]:
    """The phones of `words` in frames `start` to `stop`; there may be pauses between words.

    Words that have no room there are left out from the end on.
    """
    kept: list[tuple[Sequence[str], list[Units]]] = []
    room = (stop - start) // _LEAST_FRAMES
    for word in words:
        units = [units_of(phone) for phone in word]
        room -= sum(map(len, units))
        if room >= 0:
            kept.append((word, units))
    if not kept:
        return []
    graph = build_graph(scores.model, [[list(chain.from_iterable(units))] for _, units in kept])
    path = Search(graph, scores, STRICT).run(start, stop, 0, to_end=True)
    placed = list(
        chain.from_iterable(
            _phones(*kept[word.index], word.segments) for word in placed_words(graph, path)
        )
    )
    spans = [(phone.start - start, phone.stop - start) for phone in placed]
    vowels = [(PHONES[phone.symbol].is_vowel,) * 2 for phone in placed]
    longer = over_held(spans, vowels, scores.weights[start:stop], scores.static[start:stop])
    return [
        replace(phone, start=start + first, stop=start + last)
        for phone, (first, last) in zip(placed, longer, strict=True)
    ]


def _phones(
    symbols: Sequence[str], units: Sequence[Units], segments: Sequence[Segment]
) -> Iterator[PlacedPhone]:
    """One phone for all units that it became."""
    bounds = accumulate(map(len, units), initial=0)
    for symbol, (first, last) in zip(symbols, pairwise(bounds), strict=True):
        parts = segments[first:last]
        start, stop = parts[0].start, parts[-1].stop
        yield PlacedPhone(symbol, start, stop, sum(p.score for p in parts) / (stop - start))
