"""Walks over a quad mesh: edge loops, enclosed regions, cuts."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]


class QuadGraph:
    """Which vertices of some quads are joined, and by which faces."""

    def __init__(self, quads: Indices) -> None:
        """Index `quads` (F, 4)."""
        self.quads = quads
        self.neighbours: dict[int, set[int]] = {}
        self.faces: dict[int, set[int]] = {}
        for face, quad in enumerate(quads.tolist()):
            for a, b in zip(quad, quad[1:] + quad[:1], strict=True):
                self.neighbours.setdefault(a, set()).add(b)
                self.neighbours.setdefault(b, set()).add(a)
                self.faces.setdefault(a, set()).add(face)

    def edge_loop(self, start: int, second: int) -> list[int]:
        """The closed edge loop from `start` over `second`: straight on at each crossing.

        Raises:
            ValueError: the loop meets a vertex that is no crossing of four edges.
        """
        loop = [start, second]
        while True:
            before, here = loop[-2:]
            beside = {
                int(vertex)
                for face in self.faces[before] & self.faces[here]
                for vertex in self.quads[face]
            }
            ahead = self.neighbours[here] - beside
            if len(ahead) != 1:
                raise ValueError(f"no edge loop through {start} and {second}: stuck at {here}")
            step = ahead.pop()
            if step == start:
                return loop
            loop.append(step)

    def enclosed(self, start: int, border: Iterable[int]) -> Indices:
        """The vertices reached from `start` without crossing `border`, the border left out."""
        fence = set(border)
        seen, queue = {start}, [start]
        while queue:
            for vertex in self.neighbours[queue.pop()] - seen - fence:
                seen.add(vertex)
                queue.append(vertex)
        return np.array(sorted(seen))

    def distances(
        self, start: Iterable[int], vertices: NDArray[np.float64], limit: float
    ) -> dict[int, float]:
        """Vertex to distance along edges from the nearest of `start`, for all within `limit`.

        `vertices` (V, 3) and distances are in the same unit.
        """
        found: dict[int, float] = {}
        queue = [(0.0, int(vertex)) for vertex in start]
        while queue:
            far, vertex = heapq.heappop(queue)
            if vertex in found:
                continue
            found[vertex] = far
            for other in self.neighbours[vertex] - found.keys():
                next_far = far + math.dist(vertices[vertex], vertices[other])
                if next_far <= limit:
                    heapq.heappush(queue, (next_far, other))
        return found


def quads_to_triangles(quads: Indices) -> Indices:
    """Two triangles (2F, 3) for each quad, in the same winding."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def clip_triangles(
    triangles: Indices, field: NDArray[np.float64]
) -> tuple[Indices, NDArray[np.int64], NDArray[np.float64]]:
    """Cut `triangles` where `field` (V,) changes its sign and keep the positive side.

    Returns:
        The triangles left, in new numbers; and for each new vertex the two old ones (n, 2) and
        the share (n,) of the second that make it.
    """
    corners: dict[tuple[int, int], int] = {}
    kept: list[list[int]] = []

    def corner(a: int, b: int) -> int:
        return corners.setdefault((min(a, b), max(a, b)), len(corners))

    for triangle in triangles.tolist():
        polygon: list[int] = []
        for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            if field[a] > 0:
                polygon.append(corner(a, a))
            if (field[a] > 0) != (field[b] > 0):
                polygon.append(corner(a, b))
        kept += [[polygon[0], polygon[i], polygon[i + 1]] for i in range(1, len(polygon) - 1)]
    pairs = np.array(list(corners))
    first, second = field[pairs].T
    whole = pairs[:, 0] == pairs[:, 1]
    share = np.where(whole, 0.0, first / np.where(whole, 1.0, first - second))
    return np.array(kept), pairs, share
