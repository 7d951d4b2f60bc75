"""From phones to the stitched curves of poses (Xu et al. 2013, section 2.2.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.missing import stand_in
from lipwright.bigrams.spline import SAMPLES, dense
from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.clip import Clip, frame_times
from lipwright.curves import Floats
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

CHUNK_PAIRS = 4096  # laid at once, so that hours need little more memory than their curves
LAYERS = 5


@dataclass(frozen=True)
class Span:
    """One pair in a track."""

    pair: Pair
    """classes"""
    start: float
    """s"""
    end: float
    """s, above `start`"""
    index: int
    """of its first phone"""
    within_pause: bool = False
    """it is the part of a pause that no sound reaches into"""

    @property
    def length(self) -> float:
        """s, above 0."""
        return self.end - self.start


def spans(bigrams: BigramSet, track: PhoneTrack) -> list[Span]:
    """The pairs of adjacent phones, each over the time of both.

    Of a pause, a pair holds what lies within `BigramSet.silence` of its sound; what is left
    between, the pair of silence with itself.
    """
    classes = [bigrams.class_of(phone) for phone in track.phones]
    edges = track.edges.tolist()
    silent = [phone == SILENCE for phone in track.phones]
    laid: list[Span] = []
    for index, name in enumerate(classes):
        start, end = edges[index], edges[index + 1]
        if silent[index]:
            left = start + bigrams.silence if index else start
            right = end - bigrams.silence if index + 1 < len(classes) else end
            if right > left:
                laid.append(Span((name, name), left, right, index, within_pause=True))
        if index + 1 < len(classes):
            after = edges[index + 2]
            start = max(start, end - bigrams.silence) if silent[index] else start
            after = min(after, end + bigrams.silence) if silent[index + 1] else after
            laid.append(Span((name, classes[index + 1]), start, after, index))
    return laid


@dataclass(frozen=True, eq=False)
class Sampled:
    """A pair's curves, evenly sampled."""

    values: Floats
    """(SAMPLES, K)"""
    peaks: Floats
    """(K,), greatest values"""
    peak_times: Floats
    """(K,), normalised times of those; of a level peak, the middle"""


def sampled(bigram: Bigram | None, poses: tuple[str, ...]) -> Sampled:
    """The curves of a pair; those that it lacks, and a missing pair, rest."""
    values = np.zeros((SAMPLES, len(poses)))
    for pose, points in (bigram.curves if bigram else {}).items():
        values[:, poses.index(pose)] = dense(points)
    peaks = values.max(axis=0)
    at_peak = [np.flatnonzero(column) for column in (values >= peaks - 1e-6).T]
    middle = [places[len(places) // 2] for places in at_peak]
    return Sampled(values, peaks, np.array(middle) / (SAMPLES - 1))


_kept = lru_cache(maxsize=8192)(sampled)


def stitch(bigrams: BigramSet, track: PhoneTrack, fps: float) -> Clip:
    """The curves of all poses from 0 s to the end of a track, stitched by maximum.

    At each time the greater of the curves of the two pairs that hold it stays. A peak of a pose
    whose peaks the speed limit keeps (a closure) is put on the nearest frame, so that none falls
    between two.
    """
    poses = tuple(bigrams.poses)
    values = np.full((len(frame_times(track.end, fps)), len(poses)), -np.inf)
    laid = spans(bigrams, track)
    for first in range(0, len(laid), CHUNK_PAIRS):
        _lay(values, laid[first : first + CHUNK_PAIRS], bigrams, fps)
    values[~np.isfinite(values)] = 0.0
    return Clip(poses, fps, values)


def _lay(values: Floats, laid: Sequence[Span], bigrams: BigramSet, fps: float) -> None:
    """Raise `values` (T, K) to the curves of the pairs."""
    poses = tuple(bigrams.poses)
    pairs = list(dict.fromkeys(span.pair for span in laid))
    tables = [_kept(stand_in(bigrams, pair)[0], poses) for pair in pairs]
    table = np.stack([one.values for one in tables])  # (U, SAMPLES, K)
    which = np.array([pairs.index(span.pair) for span in laid])
    start = np.array([span.start for span in laid])
    length = np.array([span.end for span in laid]) - start
    first = np.ceil(start * fps - 1e-6).astype(np.int64)
    last = np.floor((start + length) * fps + 1e-6).astype(np.int64)
    stop = np.minimum(last + 1, len(values))
    layer = _layers(laid)
    for number in range(LAYERS):
        chosen = np.flatnonzero((layer == number) & (stop > first))
        counts = (stop - first)[chosen]
        of = np.repeat(chosen, counts)
        frame = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first[of]
        place = np.clip((frame / fps - start[of]) / length[of], 0, 1) * (SAMPLES - 1)
        low = np.minimum(place.astype(np.int64), SAMPLES - 2)
        share = (place - low)[:, None]
        below, above = table[which[of], low], table[which[of], low + 1]
        values[frame] = np.maximum(values[frame], below + share * (above - below))
    _keep_peaks(values, bigrams, tables, which, (start, length, first, stop), fps)


def _layers(laid: Sequence[Span]) -> npt.NDArray[np.int64]:
    """(N,), layers of pairs that share no frame.

    A pair overlaps the pairs beside it and meets those after them; a pause with itself meets the
    pairs at its ends.
    """
    return np.array([LAYERS - 1 if span.within_pause else span.index % 4 for span in laid])


def _keep_peaks(
    values: Floats, bigrams: BigramSet, tables: Sequence[Sampled], which: npt.NDArray[np.int64],
    times: tuple[Floats, Floats, npt.NDArray[np.int64], npt.NDArray[np.int64]], fps: float,
) -> None:  # fmt: skip
    start, length, first, stop = times
    kept = [c for c, pose in enumerate(bigrams.poses.values()) if pose.limit == "widen"]
    if not kept:
        return
    peaks = np.stack([one.peaks[kept] for one in tables])[which]  # (N, kept)
    at = np.stack([one.peak_times[kept] for one in tables])[which]
    frame = np.rint((start[:, None] + at * length[:, None]) * fps).astype(np.int64)
    frame = np.clip(frame, first[:, None], np.maximum(stop - 1, first)[:, None])
    frame = np.minimum(frame, len(values) - 1)
    np.maximum.at(values, (frame, np.array(kept)[None, :]), peaks)


def pair_clips(bigrams: BigramSet, track: PhoneTrack, fps: float) -> list[tuple[Span, Clip]]:
    """Each pair and its own curves, as long as the pair, for looking at (figure 6)."""
    poses = tuple(bigrams.poses)
    found = []
    for span in spans(bigrams, track):
        curves = _kept(stand_in(bigrams, span.pair)[0], poses).values
        at = frame_times(span.end - span.start, fps) / (span.end - span.start)
        even = np.linspace(0, 1, SAMPLES)
        values = np.stack([np.interp(at, even, column) for column in curves.T], axis=1)
        found.append((span, Clip(poses, fps, values)))
    return found
