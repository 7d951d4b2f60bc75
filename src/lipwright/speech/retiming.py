"""Edges for phones that were recognised: the aligner's search, with phones for a transcript."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from lipwright.speech.fit import placed_words
from lipwright.speech.graph import build_graph
from lipwright.speech.scores import Scores
from lipwright.speech.search import STRICT, Search
from lipwright.speech.units import units_of

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
    kept, room = [], (stop - start) // _LEAST_FRAMES
    for word in words:
        room -= len(word)
        if room >= 0:
            kept.append(tuple(word))
    if not kept:
        return []
    graph = build_graph(scores.model, [[_units(word)] for word in kept])
    path = Search(graph, scores, STRICT).run(start, stop, 0, to_end=True)
    return [
        PlacedPhone(symbol, part.start, part.stop, part.score / (part.stop - part.start))
        for word in placed_words(graph, path)
        for symbol, part in zip(kept[word.index], word.segments, strict=True)
    ]


def _units(word: Sequence[str]) -> list[str]:
    return [units_of(phone)[0] for phone in word]
