"""Closed surfaces out of rings: balls, tubes, and whatever rings one thinks of."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vectors = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Form:
    """A closed surface."""

    vertices: Vectors
    """(V, 3) m: the R rings of N vertices each, then the two poles"""
    triangles: NDArray[np.int64]
    """(2 R N, 3), counter-clockwise seen from outside"""


def closed(rings: Vectors) -> Form:
    """The surface over `rings` (R, N, 3), with a pole in the middle of the first and the last."""
    rows, columns = rings.shape[:2]
    vertices = np.concatenate(
        [rings.reshape(-1, 3), rings[0].mean(axis=0)[None], rings[-1].mean(axis=0)[None]]
    )
    here = np.arange(columns)
    then = np.roll(here, -1)
    first, last = rows * columns, rows * columns + 1
    triangles = [np.column_stack([np.full(columns, first), then, here])]
    for row in range(rows - 1):
        a, b = row * columns, (row + 1) * columns
        triangles += [
            np.column_stack([a + here, a + then, b + here]),
            np.column_stack([a + then, b + then, b + here]),
        ]
    end = (rows - 1) * columns
    triangles.append(np.column_stack([np.full(columns, last), end + here, end + then]))
    faces = np.concatenate(triangles)
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    volume = np.einsum("nk,nk->", a, np.cross(b, c))
    return Form(vertices, faces if volume > 0 else faces[:, ::-1])


def directions(polar_deg: ArrayLike, columns: int) -> Vectors:
    """Unit vectors (R, columns, 3) at angles (R,) from +z."""
    polar = np.radians(np.asarray(polar_deg, np.float64))[:, None]
    around = 2 * np.pi * np.arange(columns) / columns
    flat = np.sin(polar)
    return np.stack(
        [flat * np.cos(around), flat * np.sin(around), np.cos(polar) + 0 * around], axis=-1
    )


def facing(direction: ArrayLike) -> Vectors:
    """The rotation (3, 3), for row vectors, that turns +z to `direction`."""
    z = np.asarray(direction, np.float64) / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.001], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def block(centre: ArrayLike, half: ArrayLike, *, power: float, columns: int = 20) -> Form:
    """A ball of half axes `half` (3,) m around `centre`, the more of a box the higher `power`."""
    rays = directions(np.linspace(8, 172, columns // 2 + 1), columns)
    size = (np.abs(rays) ** power).sum(axis=-1, keepdims=True) ** (1 / power)
    return closed(np.asarray(centre) + rays / size * np.asarray(half))


def bend(*points: ArrayLike, count: int = 14) -> Vectors:
    """(count, 3) along the Bezier curve with the control points `points` (3,)."""
    stack = [np.asarray(point, np.float64)[None] for point in points]
    share = np.linspace(0, 1, count)[:, None]
    while len(stack) > 1:
        stack = [(1 - share) * a + share * b for a, b in pairwise(stack)]
    return stack[0]


def tube(path: Vectors, wide: ArrayLike, high: ArrayLike | None = None, sides: int = 14) -> Form:
    """A tube along `path` (R, 3) with half axes `wide` and `high` (R,) m, both the same if alone.

    The wide axis lies level at the start.
    """
    wide = np.broadcast_to(np.asarray(wide, np.float64), len(path))
    high = wide if high is None else np.broadcast_to(np.asarray(high, np.float64), len(path))
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.empty_like(path)
    side = np.cross([0.03, 1.0, 0.02], along[0])
    for row, direction in enumerate(along):
        side = side - (side @ direction) * direction  # carried along without a twist
        across[row] = side / np.linalg.norm(side)
    upward = np.cross(along, across)
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = (
        path[:, None]
        + (wide[:, None] * np.cos(turn))[..., None] * across[:, None]
        + (high[:, None] * np.sin(turn))[..., None] * upward[:, None]
    )
    return closed(rings)


def rounded(radii: ArrayLike, share: float = 0.12) -> NDArray[np.float64]:
    """Radii (R,) that fall to almost nothing, as a ball's, over the last `share` of the way."""
    radii = np.asarray(radii, np.float64)
    place = np.linspace(0, 1, len(radii))
    end = np.clip((place - 1 + share) / share, 0, 1)
    return radii * np.sqrt(np.maximum(1 - end**2, 0.02))
