"""The closest points of a surface, among those that face the same way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.surface import Surface

Floats = NDArray[np.float64]

CANDIDATES: Final = 12  # triangles whose middles are nearest; one of them is taken as closest
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
        far = np.linalg.norm(on - points[:, None], axis=2)
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
    aa, bb, cc = ((ab * ab).sum(-1), (ab * ac).sum(-1), (ac * ac).sum(-1))
    d, e = (ab * ap).sum(-1), (ac * ap).sum(-1)
    determinant = np.maximum(aa * cc - bb * bb, np.finfo(float).tiny)
    v, w = (cc * d - bb * e) / determinant, (aa * e - bb * d) / determinant
    inside = np.stack([1 - v - w, v, w], axis=-1)
    best, least = inside, np.where((inside >= 0).all(-1), 0.0, np.inf)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        start, way = triangles[..., first, :], triangles[..., second, :] - triangles[..., first, :]
        length = np.maximum((way * way).sum(-1), np.finfo(float).tiny)
        share = np.clip(((points - start) * way).sum(-1) / length, 0, 1)
        far = ((start + share[..., None] * way - points) ** 2).sum(-1)
        weights = np.zeros_like(inside)
        weights[..., first], weights[..., second] = 1 - share, share
        nearer = far < least
        best = np.where(nearer[..., None], weights, best)
        least = np.where(nearer, far, least)
    return np.asarray((best[..., None] * triangles).sum(-2)), np.asarray(best)
