"""`Partners`: which triangles of one surface move like which of another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError
from lipwright.face.surface import Surface


@dataclass(frozen=True, eq=False)
class Partners:
    """For each of N target triangles the source triangles that it moves like."""

    weights: Any
    """(N, N') sparse, from target to source triangles; a row sums to 1, or to 0 without partner"""

    @property
    def matched(self) -> NDArray[np.bool_]:
        """(N,), which target triangles have a partner."""
        return np.asarray(np.diff(self.weights.indptr) > 0)

    @property
    def alone(self) -> int:
        """How many target triangles have no partner."""
        return int((~self.matched).sum())


def partners_of(
    target_triangles: NDArray[np.int64],
    source_triangles: NDArray[np.int64],
    weights: NDArray[np.float64],
    shape: tuple[int, int],
) -> Partners:
    """Partners out of pairs of triangles (n,) each, with weights above 0.

    Args:
        target_triangles: numbers.
        source_triangles: numbers.
        weights: how much each pair counts among those of its target triangle.
        shape: how many triangles target and source have.
    """
    from scipy.sparse import coo_array, dia_array

    table = coo_array((weights, (target_triangles, source_triangles)), shape=shape).tocsr()
    table.sum_duplicates()
    sums = np.asarray(table.sum(axis=1)).ravel()
    scale = np.divide(1.0, sums, out=np.zeros_like(sums), where=sums > 0)
    return Partners((dia_array((scale[None], 0), shape=(shape[0], shape[0])) @ table).tocsr())


def same_topology(source: Surface, target: Surface, name: str = "the target") -> Partners:
    """Each triangle with that of the same number.

    Raises:
        LipwrightError: the numbers of vertices or triangles differ, or the triangles join other
            vertices.
    """
    for what, ours, theirs in (
        ("vertices", len(source.vertices), len(target.vertices)),
        ("triangles", len(source.triangles), len(target.triangles)),
    ):
        if ours != theirs:
            raise LipwrightError(
                f"{name}: has {theirs} {what} and the source has {ours}: not the same topology; "
                "give landmarks instead"
            )
    other = (source.triangles != target.triangles).any(axis=1)
    if other.any():
        row = int(np.argmax(other))
        raise LipwrightError(
            f"{name}: triangle {row} joins the vertices {target.triangles[row].tolist()}, in the "
            f"source {source.triangles[row].tolist()}: not the same topology; give landmarks "
            "instead"
        )
    usable = np.flatnonzero(~source.flat & ~target.flat)
    count = len(source.triangles)
    return partners_of(usable, usable, np.ones(len(usable)), (count, count))
