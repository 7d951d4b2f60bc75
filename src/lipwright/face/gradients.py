"""Deformation gradients of triangles, and gradients of functions on a surface."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lipwright.face.surface import Surface

Floats = NDArray[np.float64]


def triangle_frames(places: Floats, corners: NDArray[np.int64]) -> Floats:
    """(N, 3, 3), in columns two edges of each triangle and the way to its fourth vertex.

    The fourth vertex stands over the first by the cross product of the edges over the square root
    of its length, so that it scales with the triangle (Sumner and Popovic 2004, section 3).
    """
    x, y, z = np.ascontiguousarray(places.T)
    a, b, c = corners.T
    x1, y1, z1 = x[b] - x[a], y[b] - y[a], z[b] - z[a]
    x2, y2, z2 = x[c] - x[a], y[c] - y[a], z[c] - z[a]
    nx, ny, nz = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    length = np.maximum(nx * nx + ny * ny + nz * nz, np.finfo(float).tiny) ** 0.25
    rows = [x1, x2, nx / length, y1, y2, ny / length, z1, z2, nz / length]
    return np.stack(rows, axis=1).reshape(-1, 3, 3)


class GradientMeter:
    """Measures how the triangles of a surface are deformed in a pose."""

    def __init__(self, surface: Surface) -> None:
        """Invert the frames of the triangles at rest; degenerate ones count as not deformed."""
        self._corners = surface.corners
        self._flat = surface.flat
        frames = triangle_frames(surface.places, surface.corners)
        frames[self._flat] = np.eye(3)
        self._inverse = np.linalg.inv(frames)

    def gradients(self, places: Floats) -> Floats:
        """(N, 3, 3), what takes each triangle from rest to `places` (P, 3): S in the paper."""
        found = triangle_frames(places, self._corners) @ self._inverse
        found[self._flat] = np.eye(3)
        return np.asarray(found)


def surface_gradient(surface: Surface) -> Any:
    """(3N, P) sparse: a function at the places to its gradient in each triangle, x y z by turns.

    Of a function that changes along the surface only; rows of degenerate triangles are 0.
    """
    from scipy.sparse import csr_array

    good = np.flatnonzero(~surface.flat)
    corners, normals = surface.corners[good], surface.normals[good]
    twice = 2 * surface.areas[good][:, None]
    rows, columns, values = [], [], []
    for k in range(3):
        opposite = surface.places[corners[:, k - 1]] - surface.places[corners[:, k - 2]]
        rows.append((3 * good[:, None] + np.arange(3)).ravel())
        columns.append(np.repeat(corners[:, k], 3))
        values.append((np.cross(normals, opposite) / twice).ravel())
    shape = (3 * len(surface.corners), len(surface.places))
    where = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), where), shape=shape)
