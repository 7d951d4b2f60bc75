"""From a path to words, and how well each of them fits the sound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Final

import numpy as np

from lipwright.speech.graph import FILLER_WORD, Graph
from lipwright.speech.search import Segment
from lipwright.speech.units import Units

if TYPE_CHECKING:
    from lipwright.language import SpokenWord

_EXTRA_FRAMES: Final = 10  # added to a word's frames: the mean of few frames says little
_USUAL: Final = 0.95  # median score of right words of clean speech, GRID
_ALLOWANCE: Final = 1.5  # for each unit that the median lies lower: noise also spreads scores
_MOST_ALLOWANCE: Final = 1.6  # the median is 1.0 lower in white noise at 10 dB

# Added for other languages than English, whose sounds the model knows only nearly: with it, right
# words of espeak-ng's Swedish, Mandarin and German voices that do not fit fall from 6 to 1 in 316.
FOREIGN_ALLOWANCE: Final = 1.0

LEAST_FIT: Final = -2.0  # adjusted score from which a word fits
WORST: Final = -20.0  # score of a word that has no room

# Confidence is logistic in the adjusted score. Scale and centre are those of a logistic
# regression on GRID speaker 1: 360 right words against 60 put in the place of others,
# area under the curve 0.97 on clean speech, 0.91 in babble and 0.85 in white noise at 10 dB.
_CENTRE: Final = -2.0
_SLOPE: Final = 1.0


@dataclass(frozen=True)
class SpokenRow:
    """A word of the transcript and the ways to say it."""

    word: SpokenWord
    phones: tuple[tuple[str, ...], ...]
    """symbols of the phone table, for each pronunciation"""
    units: tuple[tuple[Units, ...], ...]
    """for each pronunciation, the units of the acoustic model that each of its phones becomes"""

    @property
    def model_phones(self) -> tuple[tuple[str, ...], ...]:
        """The units of each pronunciation in a row."""
        return tuple(tuple(chain.from_iterable(way)) for way in self.units)


@dataclass(frozen=True)
class PlacedWord:
    """A word on the path."""

    index: int
    """in the transcript"""
    pronunciation: int
    """index among the ways to say it"""
    segments: tuple[Segment, ...]
    """one a unit of the acoustic model"""

    @property
    def start(self) -> int:
        """Its first frame."""
        return self.segments[0].start

    @property
    def stop(self) -> int:
        """The frame after its last."""
        return self.segments[-1].stop

    def moved(self, start: int, stop: int) -> PlacedWord:
        """The same with another first frame and stop; the score stays that of what was heard."""
        first, *rest = self.segments
        segments = [replace(first, start=start), *rest]
        segments[-1] = replace(segments[-1], stop=stop)
        return replace(self, segments=tuple(segments))

    @property
    def score(self) -> float:
        """Mean log-likelihood ratio a frame against any speech, short words drawn towards 0.

        Frames of held sounds count as little here as in the sum, or any text would fit a hum.
        """
        total = sum(segment.score for segment in self.segments)
        weight = sum(segment.weight for segment in self.segments)
        frames = self.stop - self.start
        return max(total / weight * frames / (frames + _EXTRA_FRAMES), WORST)


def placed_words(graph: Graph, path: Sequence[Segment], first: int = 0) -> list[PlacedWord]:
    """The words that a path goes through, in order; `first` is the index of the graph's first."""
    words: list[PlacedWord] = []
    run: list[Segment] = []
    for segment in path:
        number = int(graph.pronunciation[segment.node])
        if number == FILLER_WORD:
            continue
        if graph.position[segment.node] == 0:
            run = []
        run.append(segment)
        placed = PlacedWord(first + int(graph.hub[segment.node]), number, tuple(run))
        if len(run) > 1:
            words[-1] = placed
        else:
            words.append(placed)
    return words


def noise_allowance(scores: Sequence[float]) -> float:
    """What is added to each score, since noise lowers those of right words alike."""
    if not scores:
        return 0.0
    return float(np.clip(_ALLOWANCE * (_USUAL - np.median(scores)), 0.0, _MOST_ALLOWANCE))


def confidence(adjusted_score: float) -> float:
    """0 to 1, how likely it is that a word of that score is the right one."""
    return float(1 / (1 + np.exp(-_SLOPE * (adjusted_score - _CENTRE))))
