"""The hmm engine: hidden Markov models of phones in context, and the likeliest curves under them.

After HTS (Zen et al., "The HMM-based speech synthesis system version 2.0", 2007) as Taylor et al.
2017, section 8.1, use it for faces. A phone with the two before and the two after it has five
states in a row; decision trees choose each state's Gaussian of value, slope and bend, and how long
the states last, scaled to the phone's own length. Of the likeliest curve, mlpg.py.

The model's frames are at i / rate s of its own clock, finer than video, so that a short phone has
room for its states.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip, frame_times
from lipwright.engines.learnt import arrange, clip_names, open_arrays_of
from lipwright.engines.mlpg import likeliest
from lipwright.engines.resample import monotone_cubic
from lipwright.errors import LipwrightError
from lipwright.features.known import known_track
from lipwright.features.timeline import CODES, ROUNDING, timeline
from lipwright.network.arrays import ArrayModel
from lipwright.network.folder import REMEDY
from lipwright.network.meta import ARRAYS_FILE
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.audio import Sound

Values = npt.NDArray[np.float32]
Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

STATES: Final = 5  # a phone, Zen et al. 2007
REACH: Final = 2  # phones to each side: a quinphone
PLACES: Final = 2 * REACH + 1
MIDDLE: Final = STATES // 2
BLOCK: Final = 20.0  # s of motion at once, so that an hour needs no more memory than a minute
MARGIN: Final = 2.0  # s to each side of a block; what is said further away changes nothing in it
RATES: Final = (10.0, 1000.0)  # frames a second, least and most; less has no room for states


@dataclass(frozen=True, eq=False)
class Forest:
    """N nodes of decision trees; each asks a question, or is a leaf."""

    place: Indices
    """(N,), which phone of the quinphone the question is about: 0 two before, 2 the phone itself"""
    members: npt.NDArray[np.bool_]
    """(N, P), the phones for which its answer is yes"""
    branches: Indices
    """(N, 2), the nodes after no and yes, both later than the node; -1 at a leaf"""
    leaf: Indices
    """(N,), the number of a leaf; -1 elsewhere"""

    def find(self, roots: Indices, contexts: Indices) -> Indices:
        """(Q,), the leaf of each of Q quinphones.

        Args:
            roots: (Q,), the nodes to begin with.
            contexts: (Q, 5), phones as numbers from 0 to P - 1.
        """
        at = np.array(roots, np.int64)
        moving = np.flatnonzero(self.leaf[at] < 0)
        while len(moving):
            node = at[moving]
            yes = self.members[node, contexts[moving, self.place[node]]]
            at[moving] = self.branches[node, yes.astype(np.int64)]
            moving = moving[self.leaf[at[moving]] < 0]
        return self.leaf[at]


@dataclass(frozen=True, eq=False)
class Voice:
    """What the engine reads in a model."""

    phones: tuple[str, ...]
    """P that it knows, silence first"""
    rate: float
    """frames a second"""
    states: Forest
    roots: Indices
    """(5, P), of each state and phone"""
    means: Floats
    """(L, 3, C), of each leaf: value, slope and bend"""
    precisions: Floats
    """(L, 3, C), 1 / variance"""
    lengths: Forest
    length_roots: Indices
    """(P,), of each phone"""
    durations: Floats
    """(L', 5), s, of the five states"""


@dataclass(frozen=True, eq=False)
class Plan:
    """Which Gaussian is heard when."""

    starts: Floats
    """(5 Q,), s, not falling; the first holds before its start too"""
    leaves: Indices
    """(5 Q,)"""

    def at(self, times: Floats) -> Indices:
        """(T,), the leaf at each time in s."""
        found = np.searchsorted(self.starts, times + ROUNDING, "right") - 1
        return self.leaves[np.maximum(found, 0)]


def contexts_of(columns: Indices) -> Indices:
    """(Q, 5), each of Q phones with the two before and after it; beyond the ends is phone 0."""
    padded = np.pad(np.asarray(columns, np.int64), REACH)
    return np.lib.stride_tricks.sliding_window_view(padded, PLACES)


def read_phones(track: PhoneTrack, phones: tuple[str, ...]) -> tuple[Indices, Floats]:
    """The Q phones of a track as numbers (Q,), and their edges (Q + 1,) in s.

    The first and the last are silence; where the track itself has none, it lasts 0 s.
    """
    line = timeline(known_track(track, phones))
    column = np.zeros(len(CODES), np.int64)
    column[[CODES[phone] for phone in phones]] = np.arange(len(phones))
    edges = np.append(line.starts, np.inf)
    edges[0], edges[-1] = track.start, track.end
    return column[line.codes], edges


def state_edges(durations: Floats, edges: Floats, silent: npt.NDArray[np.bool_]) -> Floats:
    """(Q, 5), s, the starts of the states of Q phones.

    The states of a phone share its length as their durations are to each other. A silence that is
    longer than all of them stays in its middle state, so that the mouth closes and opens as fast
    after and before a long one.

    Args:
        durations: (Q, 5), s, above 0.
        edges: (Q + 1,), s, of the phones.
        silent: (Q,), which of them are silences.
    """
    length = np.diff(edges)
    own = durations.sum(axis=1)
    shares = durations * (length / own)[:, None]
    long = silent & (length > own)
    shares[long] = durations[long]
    shares[long, MIDDLE] += (length - own)[long]
    return edges[:-1, None] + np.cumsum(shares, axis=1) - shares


def plan(voice: Voice, track: PhoneTrack) -> Plan:
    """The Gaussians of a track, in turn."""
    columns, edges = read_phones(track, voice.phones)
    contexts = contexts_of(columns)
    spans = voice.durations[voice.lengths.find(voice.length_roots[columns], contexts)]
    leaves = [voice.states.find(roots[columns], contexts) for roots in voice.roots]
    starts = state_edges(spans, edges, columns == 0)
    return Plan(np.maximum.accumulate(starts.ravel()), np.stack(leaves, axis=1).ravel())


def _curves(model: ArrayModel, track: PhoneTrack, times: Floats) -> Iterator[Values]:
    """(T', C), the controls at rising times, block after block."""
    voice, place = voice_of(model), model.path / ARRAYS_FILE
    planned, margin = plan(voice, track), round(MARGIN * voice.rate)
    block = np.floor((times - times[:1]) / BLOCK)
    for part in np.split(times, np.flatnonzero(np.diff(block)) + 1):
        if not len(part):
            continue
        first = int(np.floor(part[0] * voice.rate)) - margin
        frames = np.arange(first, int(np.ceil(part[-1] * voice.rate)) + margin + 1)
        leaves = planned.at(frames / voice.rate)
        try:
            curves = likeliest(voice.means[leaves], voice.precisions[leaves])
        except np.linalg.LinAlgError as error:  # sound models never get here
            raise LipwrightError(f"{place}: 'deviations' are too far apart; {REMEDY}") from error
        yield monotone_cubic(curves.astype(np.float32), part * voice.rate - first)


def predict_at(
    model: ArrayModel, track: PhoneTrack, times: Floats, audio: Sound | None = None
) -> Values:
    """(T, C), the model's own controls at (T,) rising `times` in s; it hears nothing."""
    del audio
    nothing = np.zeros((0, len(model.meta.controls)), np.float32)
    return np.concatenate([nothing, *_curves(model, track, np.asarray(times, float))])


def animate(
    track: PhoneTrack,
    fps: float,
    audio: Sound | None = None,
    model: str | Path | ArrayModel | None = None,
) -> Clip:
    """The motion of a track, from 0 s to its end.

    Args:
        track: phones with times; those never learnt take the nearest known.
        fps: frames a second of the clip.
        audio: not heard.
        model: a model's folder; none ships.

    Returns:
        Canonical controls, or modes of a reference face where the model predicts those alone.
        Values are not clipped.

    Raises:
        LipwrightError: no model is named, or it cannot be used.
    """
    opened = open_network(model)
    curves = predict_at(opened, track, frame_times(track.end, fps), audio)
    return Clip(clip_names(opened), fps, arrange(opened, curves))


def open_network(model: str | Path | ArrayModel | None = None) -> ArrayModel:
    """The model, loaded once while its files stay as they are.

    Raises:
        LipwrightError: none is named, it cannot be used, or it is one of another engine.
    """
    opened = open_arrays_of(model, "hmm")
    voice_of(opened)
    return opened


@lru_cache(maxsize=4)
def voice_of(model: ArrayModel) -> Voice:
    """What a model says, checked.

    Raises:
        LipwrightError: it lacks an array, or has one that does not fit.
    """
    phones, controls = len(model.meta.features.phones), len(model.meta.controls)
    means = model.array("means", "f", (None, 3, controls)).astype(np.float64)
    deviations = model.array("deviations", "f", means.shape).astype(np.float64)
    durations = model.array("durations", "f", (None, STATES)).astype(np.float64)
    rate = float(model.array("rate", "f", (1,))[0])
    _need(model, "rate", RATES[0] <= rate <= RATES[1])
    _need(model, "deviations", bool((deviations > _LEAST).all() and (deviations < _MOST).all()))
    _need(model, "means", bool((np.abs(means) < _MOST).all()))
    _need(model, "durations", bool((durations > _LEAST).all() and (durations < _MOST).all()))
    states = _forest(model, "state", phones, len(means))
    lengths = _forest(model, "duration", phones, len(durations))
    return Voice(
        model.meta.features.phones, rate,
        states, _roots(model, "state", (STATES, phones), states), means, deviations**-2.0,
        lengths, _roots(model, "duration", (phones,), lengths), durations,
    )  # fmt: skip


_LEAST: Final = 1e-9  # of a deviation or duration that arithmetic can bear
_MOST: Final = 1e9


def _forest(model: ArrayModel, name: str, phones: int, leaves: int) -> Forest:
    """The trees of a model; every way through them ends at a leaf."""
    branches = model.array(f"{name}_branches", "i", (None, 2)).astype(np.int64)
    count = len(branches)
    leaf = model.array(f"{name}_leaf", "i", (count,)).astype(np.int64)
    place = model.array(f"{name}_place", "i", (count,)).astype(np.int64)
    members = model.array(f"{name}_members", "b", (count, phones))
    own = np.arange(count)[:, None]
    later = ((branches > own) & (branches < count)).all(axis=1)
    _need(model, f"{name}_leaf", bool((leaf >= -1).all() and (leaf < leaves).all()))
    _need(model, f"{name}_branches", bool((later | (leaf >= 0)).all()))
    _need(model, f"{name}_place", bool(((place >= 0) & (place < PLACES)).all()))
    return Forest(place, members, branches, leaf)


def _roots(model: ArrayModel, name: str, shape: tuple[int, ...], forest: Forest) -> Indices:
    roots = model.array(f"{name}_roots", "i", shape).astype(np.int64)
    _need(model, f"{name}_roots", bool(((roots >= 0) & (roots < len(forest.leaf))).all()))
    return roots


def _need(model: ArrayModel, name: str, fits: bool) -> None:
    if not fits:
        raise LipwrightError(
            f"{model.path / ARRAYS_FILE}: {name!r} has values that cannot be; {REMEDY}"
        )
