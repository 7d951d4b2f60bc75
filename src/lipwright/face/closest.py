"""The closest points of a surface, among those that face the same way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.surface import Surface

Floats = NDArray[np.float64]

CANDIDATES: Final = 10  # triangles whose middles are nearest; one of them is taken as closest
ON_EDGE: Final = 1e-6  # of a barycentric weight


@dataclass(frozen=True, eq=False)
class Hits:
    """What was found for n points."""

    points: Floats
    """(n, 3) of the surface"""
    triangles: NDArray[np.int64]
    """(n,) numbers"""
    distances: Floats
    """(n,), infinite where nothing near faces the same way"""
    on_border: NDArray[np.bool_]
    """(n,), whether the point lies on a border of the surface"""


class Finder:
    """Looks for closest points on one surface."""

    def __init__(self, surface: Surface, among: NDArray[np.bool_] | None = None) -> None:
        """Index the triangles, or those `among` (N,), that are not degenerate."""
        from scipy.spatial import cKDTree

        self._surface = surface
        usable = ~surface.flat if among is None else among & ~surface.flat
        self._triangles = np.flatnonzero(usable)
        self._tree = cKDTree(surface.centroids[self._triangles])

    def closest(self, points: Floats, normals: Floats | None = None, least: float = 0.0) -> Hits:
        """The closest point of the surface for each of `points` (n, 3).

        Args:
            points: where to look from.
            normals: (n, 3), which way the points face, if that matters.
            least: cosine that the normals of point and triangle must have.
        """
        count = min(CANDIDATES, len(self._triangles))
        near = self._tree.query(points, k=count)[1].reshape(len(points), count)
        found = self._triangles[near]
        places = self._surface.places[self._surface.corners[found]]
        on, weights = closest_on_triangles(points[:, None], places)
        away = on - points[:, None]
        far = np.sqrt(_dot(away, away))
        if normals is not None:
            cosines = np.einsum("nkc,nc->nk", self._surface.normals[found], normals)
            far = np.where(cosines > least, far, np.inf)
        best = np.argmin(far, axis=1)
        rows = np.arange(len(points))
        chosen = found[rows, best]
        corners = self._surface.corners[chosen]
        inside = weights[rows, best] > ON_EDGE
        at_border = ~inside.all(axis=1) & (self._surface.border[corners] | ~inside).all(axis=1)
        return Hits(on[rows, best], chosen, far[rows, best], at_border)


def closest_on_triangles(points: Floats, triangles: Floats) -> tuple[Floats, Floats]:
    """The points of triangles (..., 3, 3) that are nearest to `points` (..., 3).

    Returns:
        The points (..., 3) and their barycentric weights (..., 3).
    """
    a, b, c = (triangles[..., k, :] for k in range(3))
    ab, ac, ap = b - a, c - a, points - a
    aa, bb, cc, d, e = _dot(ab, ab), _dot(ab, ac), _dot(ac, ac), _dot(ab, ap), _dot(ac, ap)
    tiny = np.finfo(float).tiny
    determinant = np.maximum(aa * cc - bb * bb, tiny)
    v, w = (cc * d - bb * e) / determinant, (aa * e - bb * d) / determinant
    inside = (v >= 0) & (w >= 0) & (v + w <= 1)
    # On the edges nearest is what is nearest to the foot of the perpendicular.
    least = np.where(inside, 0.0, np.inf)
    best = np.stack([1 - v - w, v, w], axis=-1)
    onto_bc = (e - d + aa - bb) / np.maximum(aa - 2 * bb + cc, tiny)  # from b to c
    for share, corner in (
        (np.clip(d / np.maximum(aa, tiny), 0, 1), 0),
        (np.clip(onto_bc, 0, 1), 1),
        (np.clip(e / np.maximum(cc, tiny), 0, 1), 2),
    ):
        y = share if corner == 0 else 1 - share if corner == 1 else 0.0
        z = 0.0 if corner == 0 else share
        far = _plane_distance(aa, bb, cc, y - v, z - w)
        nearer = ~inside & (far < least)
        least = np.where(nearer, far, least)
        best[..., 1] = np.where(nearer, y, best[..., 1])
        best[..., 2] = np.where(nearer, z, best[..., 2])
    best[..., 0] = 1 - best[..., 1] - best[..., 2]
    best = np.maximum(best, 0.0)
    found = a + best[..., 1:2] * ab + best[..., 2:] * ac
    return np.asarray(found), np.asarray(best)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("...c,...c->...", a, b))


def _plane_distance(aa: Floats, bb: Floats, cc: Floats, v: Floats, w: Floats) -> Floats:
    """The squared length of v ab + w ac, from the products of ab and ac."""
    return np.asarray(aa * v * v + 2 * bb * v * w + cc * w * w)
