"""From phones to the stitched curves of poses (Xu et al. 2013, section 2.2.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.missing import stand_in
from lipwright.bigrams.spline import SAMPLES, between, dense
from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.clip import Clip, frame_times
from lipwright.curves import Floats
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

CHUNK_PAIRS = 4096  # laid at once, so that hours need little more memory than their curves
PAUSES = 4  # layer of pauses; pairs are in the layers before it, in turn
LAYERS = PAUSES + 1


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
    kept = [c for c, pose in enumerate(bigrams.poses.values()) if pose.limit == "widen"]
    values = np.full((len(frame_times(track.end, fps)), len(poses)), -np.inf)
    every = spans(bigrams, track)
    for first in range(0, len(every), CHUNK_PAIRS):
        laid = _Laid.of(every[first : first + CHUNK_PAIRS], bigrams, fps, len(values))
        for layer in range(LAYERS):
            laid.raise_curves(values, layer)
        laid.keep_peaks(values, kept)
    values[~np.isfinite(values)] = 0.0
    return Clip(poses, fps, values)


@dataclass(frozen=True, eq=False)
class _Laid:
    """N pairs on the frames of a clip."""

    fps: float
    values: Floats
    """(U, SAMPLES, K), curves of the pairs that there are"""
    peaks: Floats  # (U, K)
    peak_times: Floats  # (U, K)
    which: npt.NDArray[np.int64]  # (N,) of those U
    layer: npt.NDArray[np.int64]  # (N,), 0 to LAYERS - 1; pairs of one layer share no frame
    start: Floats  # (N,) s
    length: Floats  # (N,) s
    first: npt.NDArray[np.int64]  # (N,) frames
    stop: npt.NDArray[np.int64]  # (N,) frames, after the last one

    @classmethod
    def of(cls, laid: Sequence[Span], bigrams: BigramSet, fps: float, frames: int) -> _Laid:
        """A pair overlaps those beside it and meets those after them; a pause what is around it."""
        places = {pair: n for n, pair in enumerate(dict.fromkeys(span.pair for span in laid))}
        poses = tuple(bigrams.poses)
        start = np.array([span.start for span in laid])
        end = np.array([span.end for span in laid])
        last = np.floor(end * fps + 1e-6).astype(np.int64)
        tables = [_kept(stand_in(bigrams, pair)[0], poses) for pair in places]
        return cls(
            fps=fps,
            values=np.stack([one.values for one in tables]),
            peaks=np.stack([one.peaks for one in tables]),
            peak_times=np.stack([one.peak_times for one in tables]),
            which=np.array([places[span.pair] for span in laid]),
            layer=np.array([PAUSES if span.within_pause else span.index % PAUSES for span in laid]),
            start=start,
            length=end - start,
            first=np.ceil(start * fps - 1e-6).astype(np.int64),
            stop=np.minimum(last + 1, frames),
        )

    def raise_curves(self, values: Floats, layer: int) -> None:
        """Raise `values` (T, K) to the curves of the pairs of a layer."""
        chosen = np.flatnonzero((self.layer == layer) & (self.stop > self.first))
        counts = (self.stop - self.first)[chosen]
        of = np.repeat(chosen, counts)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        frame = within + self.first[of]
        low, share = between((frame / self.fps - self.start[of]) / self.length[of])
        below, above = self.values[self.which[of], low], self.values[self.which[of], low + 1]
        values[frame] = np.maximum(values[frame], below + share * (above - below))

    def keep_peaks(self, values: Floats, kept: Sequence[int]) -> None:
        """Raise the frame nearest to each peak of the columns `kept` to that peak."""
        columns = np.array(kept, np.int64)
        peaks, at = (table[self.which][:, columns] for table in (self.peaks, self.peak_times))
        frame = np.rint((self.start[:, None] + at * self.length[:, None]) * self.fps)
        last = np.maximum(self.stop - 1, self.first)
        frame = np.clip(frame.astype(np.int64), self.first[:, None], last[:, None])
        np.maximum.at(values, (np.minimum(frame, len(values) - 1), columns[None, :]), peaks)


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
