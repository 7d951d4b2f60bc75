"""How the control points of phone bigrams make the frames of recordings: sparse tables."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.missing import stand_in
from lipwright.bigrams.runtime import Span, spans
from lipwright.bigrams.spline import SAMPLES, between, dense
from lipwright.bigrams.values import BigramSet, Pair
from lipwright.phones import SILENCE
from lipwright.train.bigram_heard import Heard
from lipwright.train.bigram_targets import Floats


class Design:
    """How the control points of all pairs make the frames of all recordings.

    Each frame is held by at most two pairs, one in each of two sparse tables, `layers` (frames,
    pairs * points); the curve is the greater of the two. `seams` (n, pairs * points) has a row for
    each beginning and end of a pair: how far its curve is over that of the pair beside it there,
    which is how far the stitched curve jumps.
    """

    def __init__(
        self, takes: Sequence[Heard], base: BigramSet, pairs: Sequence[Pair], points: int
    ) -> None:
        """Lay all pairs over all frames."""
        self.pairs = tuple(pairs)
        self.times = np.linspace(0, 1, points)
        self.table = unit_curves(points)
        self.points = points
        self._row_of = {pair: row for row, pair in enumerate(pairs)}
        layers, seams = (_Cells(), _Cells()), _Cells()
        self._others: list[tuple[Pair, npt.NDArray[np.int64], Floats]] = []
        members: dict[Pair, list[npt.NDArray[np.int64]]] = {pair: [] for pair in pairs}
        first = rows = 0
        for take in takes:
            laid = spans(base, take.track)
            for span in laid:
                frames = np.flatnonzero((take.times >= span.start) & (take.times < span.end))
                place = (take.times[frames] - span.start) / span.length
                if span.pair not in self._row_of:
                    self._others.append((span.pair, frames + first, place))
                    continue
                layers[span.index % 2].add(
                    frames + first, self._columns(span), self._weights(place)
                )
                members[span.pair].append(frames + first)
            for one, other in pairwise(span for span in laid if span.pair in self._row_of):
                if other.index == one.index + 1 and other.start < one.end:
                    self._seam(seams, rows, other, one, other.start)
                    self._seam(seams, rows + 1, one, other, one.end)
                    rows += 2
            first += len(take.times)
        self.ends = np.cumsum([len(take.times) for take in takes])
        self.members = {
            pair: np.concatenate([*lists, ()]).astype(np.int64) for pair, lists in members.items()
        }
        width = len(pairs) * points
        self.layers = tuple(cells.table((first, width)) for cells in layers)
        self.seams = seams.table((rows, width))

    def others(self, base: BigramSet, pose: str) -> Floats:
        """(frames,), the stitched curve of the pairs that are not fitted; 0 where all are."""
        even = np.linspace(0, 1, SAMPLES)
        stitched = np.zeros(self.ends[-1])
        for pair, frames, place in self._others:
            bigram, _ = stand_in(base, pair)
            if bigram is not None and pose in bigram.curves:
                curve = np.interp(place, even, dense(bigram.curves[pose]))
                stitched[frames] = np.maximum(stitched[frames], curve)
        return stitched

    def _columns(self, span: Span) -> npt.NDArray[np.int64]:
        return self._row_of[span.pair] * self.points + np.arange(self.points)

    def _seam(self, seams: _Cells, row: int, span: Span, beside: Span, time: float) -> None:
        """The row for where `span` begins or ends, at `time` s, within another pair."""
        rows = np.array([row])
        for which, sign in ((span, 1.0), (beside, -1.0)):
            place = np.array([(time - which.start) / which.length])
            seams.add(rows, self._columns(which), sign * self._weights(place))

    def rests(self) -> npt.NDArray[np.bool_]:
        """(pairs * points,), control points in a pause, where no other pair is to take over."""
        silent = np.zeros((len(self.pairs), self.points), bool)
        silent[:, 0] = [first == SILENCE for first, _ in self.pairs]
        silent[:, -1] = [second == SILENCE for _, second in self.pairs]
        return silent.ravel()

    def split(self, values: Floats) -> list[Floats]:
        """Values (frames,) of all recordings as those of each."""
        return np.split(values, self.ends[:-1])

    def control_points(self, base: BigramSet, pose: str) -> Floats:
        """(pairs * points,), what the curves of a set are at the times of the control points."""
        even = np.linspace(0, 1, SAMPLES)
        rows = []
        for pair in self.pairs:
            points = base.bigrams[pair].curves.get(pose, ((0.0, 0.0),))
            rows.append(np.interp(self.times, even, dense(points)))
        return np.concatenate(rows)

    def _weights(self, place: Floats) -> Floats:
        """(n, points), of the control points at normalised times."""
        low, share = between(place)
        return (1 - share) * self.table[low] + share * self.table[low + 1]


class _Cells:
    """The cells of a sparse table."""

    def __init__(self) -> None:
        self._parts: list[tuple[npt.NDArray[Any], ...]] = []

    def add(
        self, rows: npt.NDArray[np.int64], columns: npt.NDArray[np.int64], values: Floats
    ) -> None:
        """Add a block (rows, columns) of values."""
        cells = np.broadcast_arrays(rows[:, None], columns[None, :], values)
        self._parts.append(tuple(cell.ravel() for cell in cells))

    def table(self, shape: tuple[int, int]) -> Any:
        """The table, compressed by rows; cells of one place are added up."""
        from scipy.sparse import coo_matrix

        none: tuple[npt.NDArray[Any], ...] = (np.zeros(0, int), np.zeros(0, int), np.zeros(0))
        rows, columns, values = map(np.concatenate, zip(none, *self._parts, strict=True))
        return coo_matrix((values, (rows, columns)), shape=shape).tocsr()


def unit_curves(points: int) -> Floats:
    """(SAMPLES, points), the curve of each of evenly spaced control points alone."""
    times = np.linspace(0, 1, points)
    return np.stack([dense(tuple(zip(times, row, strict=True))) for row in np.eye(points)], axis=1)
