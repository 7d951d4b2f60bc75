"""Which state each frame of a recording is in, and what is seen there, for the hmm engine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from lipwright.engines.hmm import STATES, Voice, contexts_of, read_phones
from lipwright.engines.mlpg import with_deltas
from lipwright.features.timeline import ROUNDING
from lipwright.phones import SILENCE
from lipwright.train.takes import Take

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

LEAST_SEEN = 0.5  # of a phone; one of which the video shows less teaches nothing


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a recording in which the face is seen all the time."""

    times: Floats
    """(N,), s, of video frames"""
    values: Floats
    """(N, C)"""
    contexts: Indices
    """(Q, 5), of the phones of the whole recording"""
    edges: Floats
    """(Q + 1,), s"""

    def frames(self, rate: float) -> Floats:
        """(T, 3, C), value, slope and bend at `rate` frames a second, by a cubic spline.

        The first is 1 / rate after the first video frame.
        """
        return with_deltas(CubicSpline(self.times, self.values)(self._clock(rate)))

    def visits(self, rate: float) -> Iterator[tuple[int, int, int]]:
        """Number, first frame and end frame of each phone that is seen well enough."""
        inner = self._clock(rate)[1:-1]
        marks = np.searchsorted(inner, self.edges - ROUNDING)
        lengths = np.diff(self.edges) * rate
        for phone, (first, stop) in enumerate(pairwise(marks)):
            silent = self.contexts[phone, STATES // 2] == 0
            if stop - first >= max(1.0, 0.0 if silent else LEAST_SEEN * lengths[phone]):
                yield phone, int(first), int(stop)

    def _clock(self, rate: float) -> Floats:
        count = int((self.times[-1] - self.times[0]) * rate + ROUNDING) + 1
        return self.times[0] + np.arange(count) / rate


def pieces_of(takes: Sequence[Take], phones: tuple[str, ...]) -> Iterator[Piece]:
    """The parts of takes in which a face is seen; of at least 4 video frames, as splines need."""
    assert phones[0] == SILENCE
    for take in takes:
        columns, edges = read_phones(take.track, phones)
        contexts = contexts_of(columns)
        turns = np.flatnonzero(np.diff(take.valid, prepend=False, append=False))
        for first, stop in turns.reshape(-1, 2):
            if stop - first >= 4:
                rows = slice(first, stop)
                values = take.targets[rows].astype(np.float64)
                yield Piece(take.times[rows], values, contexts, edges)


def evenly(count: int) -> Indices:
    """(T,), the state of each of T frames where all last as long."""
    return np.asarray(((np.arange(count) + 0.5) * STATES / count).astype(np.int64))


def align(scores: Floats) -> Indices:
    """(T,), the likeliest way through the states of a phone (Viterbi).

    States follow each other and each has a frame; where there are fewer frames than states, they
    are dealt out evenly.

    Args:
        scores: (T, 5), log likelihood of each frame in each state.
    """
    count = len(scores)
    if count < STATES:
        return evenly(count)
    total = np.concatenate([np.zeros((1, STATES)), np.cumsum(scores, axis=0)])  # before frame t
    best = total[:, 0].copy()  # of the frames before t, all in state 0 (and later: up to state s)
    best[0] = -np.inf
    begins = np.zeros((STATES, count + 1), np.int64)
    for state in range(1, STATES):
        entered = best - total[:, state]  # state begins at t
        top = np.maximum.accumulate(entered)
        new = np.append(True, top[1:] > top[:-1])
        begins[state] = np.maximum.accumulate(np.where(new, np.arange(count + 1), 0))
        best = np.append(-np.inf, top[:-1] + total[1:, state])
        begins[state, 1:] = begins[state, :-1].copy()
    states, stop = np.zeros(count, np.int64), count
    for state in range(STATES - 1, 0, -1):
        first = begins[state, stop]
        states[first:stop], stop = state, first
    return states


def scores_of(voice: Voice, piece: Piece, frames: Floats) -> Floats:
    """(T, 5 Q), log likelihood of each frame in each state of each phone, but for a constant."""
    contexts = piece.contexts
    columns = contexts[:, STATES // 2]
    leaves = np.stack([voice.states.find(r[columns], contexts) for r in voice.roots], axis=1)
    chosen, place = np.unique(leaves, return_inverse=True)
    precision = voice.precisions[chosen].reshape(len(chosen), -1)
    mean = voice.means[chosen].reshape(len(chosen), -1)
    flat = frames.reshape(len(frames), -1)
    constant = (np.log(precision) - mean**2 * precision).sum(axis=1)
    found = flat @ (mean * precision).T + 0.5 * (constant - flat**2 @ precision.T)
    return np.asarray(found[:, place.ravel()])
