"""From a path to words: which fit the sound, how sure that is, and when they are said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE
from lipwright.speech.aligner import Alignment, Misfit
from lipwright.speech.features import FRAME_CENTRE, FRAME_RATE
from lipwright.speech.graph import FILLER_WORD
from lipwright.speech.search import Search, Segment
from lipwright.track import PhoneTrack, Word

if TYPE_CHECKING:
    from lipwright.language import SpokenWord

# An edge lies between the centres of two windows.
_EDGE_OFFSET: Final = FRAME_CENTRE - 0.5 / FRAME_RATE  # s


@dataclass(frozen=True)
class SpokenRow:
    """A word of the transcript and the ways to say it."""

    word: SpokenWord
    phones: tuple[tuple[str, ...], ...]
    """symbols of the phone table, for each pronunciation"""


@dataclass(frozen=True)
class PlacedWord:
    """A word on the path."""

    index: int
    """in the transcript"""
    segments: tuple[Segment, ...]
    """one a phone"""
    pronunciation: int

    @property
    def score(self) -> float:
        """Mean log-likelihood ratio a frame against any speech."""
        frames = self.segments[-1].stop - self.segments[0].start
        return sum(segment.score for segment in self.segments) / frames


def placed_words(search: Search, path: Sequence[Segment]) -> list[PlacedWord]:
    """The words that the path goes through, in order."""
    graph = search.graph
    words: list[PlacedWord] = []
    run: list[Segment] = []
    for segment in path:
        if graph.pronunciation[segment.node] == FILLER_WORD:
            continue
        if graph.position[segment.node] == 0:
            run = []
        run.append(segment)
        index, number = int(graph.hub[segment.node]), int(graph.pronunciation[segment.node])
        placed = PlacedWord(index, tuple(run), number)
        if words and words[-1].index == index:
            words[-1] = placed
        else:
            words.append(placed)
    return words


def confidence(score: float) -> float:
    """0 to 1, how likely it is that a word of that score is the right one."""
    return float(1 / (1 + np.exp(-score)))


def place_words(
    search: Search, path: Sequence[Segment], rows: Sequence[SpokenRow], duration: float
) -> Alignment:
    """The track of the words that fit, and those that do not."""
    placed = placed_words(search, path)
    if not placed:
        raise LipwrightError("the text does not fit the sound")
    phones: list[str] = []
    edges: list[float] = [0.0]
    words: list[Word] = []
    for word in placed:
        start = _time(word.segments[0].start, duration)
        if start > edges[-1]:
            phones.append(SILENCE)
            edges.append(start)
        first = len(phones)
        phones += rows[word.index].phones[word.pronunciation]
        edges += [_time(segment.stop, duration) for segment in word.segments]
        words.append(Word(rows[word.index].word.text, first, len(phones), confidence(word.score)))
    track = PhoneTrack(tuple(phones), np.asarray(edges), tuple(words)).padded(0.0, duration)
    known = {word.index for word in placed}
    missing = [
        Misfit(row.word.text, row.word.written, 0, 0, -20)
        for index, row in enumerate(rows)
        if index not in known
    ]
    return Alignment(track, tuple(missing))


def _time(frame: int, duration: float) -> float:
    return min(frame / FRAME_RATE + _EDGE_OFFSET, duration)
