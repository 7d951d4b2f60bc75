"""`Contacts`: where the head's lips touch, and the same places of a target.

Gradients alone say little of how far two lips are apart, which lie next to each other in space and
far from each other on the surface. So the lips of the target are asked to part as far as ours do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.closest import Finder, closest_on_triangles
from lipwright.face.head import Head
from lipwright.face.surface import Surface

Floats = NDArray[np.float64]

NEAR_M: Final = 0.0015  # m; skin of both lips that is nearer touches
TALL_M: Final = 0.008  # m above and below the middle of the lips where contact is looked for
FACING: Final = 0.3  # cosine between a lip's normal and the way to the other lip
REACH: Final = 0.06  # spreads of the landmarks that the places may be from the target


@dataclass(frozen=True, eq=False)
class Contacts:
    """K pairs of touching points, upper less lower."""

    source: Any
    """(K, P') sparse: displacements of the source's places to how the pairs part"""
    target: Any
    """(K, P) sparse: the same of the target's places"""


def lip_contacts(
    head: Head, source: Surface, placed: Floats, target: Surface, spread: float
) -> Contacts:
    """The contacts of the head's lips that are on the target too.

    Args:
        head: our head.
        source: its surface at rest.
        placed: (P', 3), its places in the shape of the target.
        target: the target.
        spread: of the landmarks, in the target's unit.
    """
    upper, triangles, weights = _touching(head, source)
    shape = Surface(placed, source.corners)
    corners = source.corners[triangles]
    normals = shape.place_normals
    finder = Finder(target)
    above = finder.closest(placed[upper], normals[upper], FACING)
    under = (placed[corners] * weights[..., None]).sum(axis=1)
    below = finder.closest(under, shape.normals[triangles], FACING)
    kept = (above.distances < REACH * spread) & (below.distances < REACH * spread)
    kept &= ~above.on_border & ~below.on_border
    rows = source.corners[triangles[kept]], weights[kept]
    count = len(upper[kept])
    one = upper[kept, None], np.ones((count, 1))
    sides = []
    for hits in (above, below):
        found = target.corners[hits.triangles[kept]]
        shares = closest_on_triangles(hits.points[kept], target.places[found])[1]
        sides.append((found, shares))
    return Contacts(
        _difference(one, rows, len(source.places)),
        _difference(sides[0], sides[1], len(target.places)),
    )


def _touching(head: Head, source: Surface) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    """Places of the upper lip (K,), the triangles of the lower lip that they touch, and where."""
    lips = source.place_of[head.lip_pairs]
    middle = source.places[lips].mean(axis=(0, 1))
    wide = 0.03  # m to either side; corners are nearer
    near = (np.abs(source.places - middle) < [wide, TALL_M, wide]).all(axis=1)
    near &= source.pieces == source.pieces[lips[0, 0]]
    upper = np.flatnonzero(near & (source.place_normals[:, 1] < -FACING))
    lower = near[source.corners].all(axis=1) & (source.normals[:, 1] > FACING)
    if not len(upper) or not lower.any():
        return np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros((0, 3))
    hits = Finder(source, lower).closest(source.places[upper])
    kept = hits.distances < NEAR_M
    triangles = hits.triangles[kept]
    places = source.places[source.corners[triangles]]
    return upper[kept], triangles, closest_on_triangles(hits.points[kept], places)[1]


def _difference(
    first: tuple[NDArray[np.int64], Floats], second: tuple[NDArray[np.int64], Floats], places: int
) -> Any:
    """(K, places) sparse: the first points less the second, each a mix of places."""
    from scipy.sparse import csr_array

    count = len(first[0])
    columns = np.concatenate([first[0], second[0]], axis=1)
    values = np.concatenate([first[1], -second[1]], axis=1)
    rows = np.repeat(np.arange(count), columns.shape[1])
    return csr_array((values.ravel(), (rows, columns.ravel())), shape=(count, places))
