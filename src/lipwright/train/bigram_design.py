"""How the control points of phone bigrams make the frames of recordings: sparse tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.runtime import spans
from lipwright.bigrams.spline import SAMPLES, dense
from lipwright.bigrams.values import BigramSet, Pair
from lipwright.phones import SILENCE
from lipwright.train.bigram_heard import Heard
from lipwright.train.bigram_targets import Floats


class Design:
    """How the control points of all pairs make the frames of all recordings.

    Each frame is held by at most two pairs, one in each of two sparse tables; the curve is the
    greater of the two.
    """

    def __init__(
        self, takes: Sequence[Heard], base: BigramSet, pairs: Sequence[Pair], points: int
    ) -> None:
        """Lay all pairs over all frames."""
        from scipy.sparse import coo_matrix

        self.pairs = tuple(pairs)
        self.times = np.linspace(0, 1, points)
        self.table = unit_curves(points)
        self.points = points
        row_of = {pair: row for row, pair in enumerate(pairs)}
        layers: tuple[list[tuple[Floats, ...]], ...] = ([], [])
        members: dict[Pair, list[npt.NDArray[np.int64]]] = {pair: [] for pair in pairs}
        first = 0
        for take in takes:
            for span in spans(base, take.track):
                frames = np.flatnonzero((take.times >= span.start) & (take.times < span.end))
                row = row_of.get(span.pair)
                if row is None or not len(frames):
                    continue
                place = (take.times[frames] - span.start) / (span.end - span.start)
                weights = self._weights(place)
                columns = row * self.points + np.arange(self.points)
                cells = np.broadcast_arrays(frames[:, None] + first, columns[None, :], weights)
                layers[span.index % 2].append(tuple(cell.ravel() for cell in cells))
                members[span.pair].append(frames + first)
            first += len(take.times)
        self.ends = np.cumsum([len(take.times) for take in takes])
        self.members = {pair: np.concatenate([*lists, ()]).astype(np.int64)
                        for pair, lists in members.items()}  # fmt: skip
        shape = (first, len(pairs) * self.points)
        self.layers = []
        for cells_of in layers:
            frame, column, weight = (np.concatenate(part) for part in zip(*cells_of, strict=True))
            self.layers.append(coo_matrix((weight, (frame, column)), shape=shape).tocsr())

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
        even = place * (SAMPLES - 1)
        low = np.minimum(even.astype(np.int64), SAMPLES - 2)
        share = (even - low)[:, None]
        return (1 - share) * self.table[low] + share * self.table[low + 1]


def unit_curves(points: int) -> Floats:
    """(SAMPLES, points), the curve of each of evenly spaced control points alone."""
    times = np.linspace(0, 1, points)
    return np.stack([dense(tuple(zip(times, row, strict=True))) for row in np.eye(points)], axis=1)
