"""How much of the sky each vertex sees."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.raster import barycentric, rasterise

DIRECTIONS: Final = 72
MAP_SIDE: Final = 176  # px of the depth maps
BIAS_M: Final = 0.0012  # m; nearer surfaces do not shade each other

Vectors = NDArray[np.float64]


def sphere_directions(count: int) -> Vectors:
    """Unit vectors (count, 3) spread evenly over the sphere: a Fibonacci lattice."""
    index = np.arange(count) + 0.5
    height = 1 - 2 * index / count
    turn = np.pi * (1 + 5**0.5) * index
    flat = np.sqrt(1 - height**2)
    return np.column_stack([flat * np.cos(turn), height, flat * np.sin(turn)])


def openness(
    vertices: Vectors, normals: Vectors, triangles: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Share (V,) of the light from all around that reaches each vertex, weighted by cosine."""
    centre = (vertices.max(axis=0) + vertices.min(axis=0)) / 2
    radius = np.linalg.norm(vertices - centre, axis=1).max() * 1.01
    seen = np.zeros(len(vertices))
    total = np.zeros(len(vertices))
    for direction in sphere_directions(DIRECTIONS):
        cosine = np.maximum(normals @ direction, 0.0)
        seen += cosine * _visible(vertices - centre, triangles, direction, radius)
        total += cosine
    return np.asarray(seen / np.maximum(total, 1e-9))


def _visible(
    vertices: Vectors, triangles: NDArray[np.int32], direction: Vectors, radius: float
) -> NDArray[np.bool_]:
    """Which vertices nothing hides from `direction`."""
    right = np.cross(direction, [0.31, 0.77, 0.55])
    right /= np.linalg.norm(right)
    frame = np.stack([right, np.cross(direction, right), -direction])
    turned = vertices @ frame.T
    points = turned.copy()
    points[:, :2] = (points[:, :2] / radius + 1) * (MAP_SIDE / 2)
    points = points.astype(np.float32)
    covered, triangle = rasterise(points, triangles, MAP_SIDE, MAP_SIDE)
    shares = barycentric(points, triangles, covered, triangle, MAP_SIDE)
    depth = np.full(MAP_SIDE * MAP_SIDE, np.inf)
    depth[covered] = (points[triangles[triangle], 2] * shares).sum(axis=1)
    column, row = np.clip(points[:, :2].astype(int), 0, MAP_SIDE - 1).T
    return np.asarray(turned[:, 2] <= depth[row * MAP_SIDE + column] + BIAS_M)


def smoothed(values: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """(V,), each vertex's value averaged with those of its neighbours, twice."""
    for _ in range(2):
        means = values[triangles].mean(axis=1)
        sums, counts = np.zeros_like(values), np.zeros_like(values)
        for corner in range(3):
            np.add.at(sums, triangles[:, corner], means)
            np.add.at(counts, triangles[:, corner], 1.0)
        values = np.where(counts > 0, sums / np.maximum(counts, 1), values)
    return values


def unit_normals(
    vertices: NDArray[np.float64], triangles: NDArray[np.integer]
) -> NDArray[np.float64]:
    """Normals (V, 3) of unit length, weighted by area."""
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(sums, triangles[:, corner], faces)
    return np.asarray(sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-20))
