"""`Surface`: the triangles of a character, as far as motion can be carried over to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from lipwright.face.mesh import Mesh

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

FLAT: Final = 1e-10  # of the square of the mesh's size; triangles of less area have no plane


@dataclass(frozen=True, eq=False)
class Surface:
    """A triangle mesh at rest, of one piece or several, in any unit.

    Raises:
        ValueError: it is empty, a number is not finite, or a triangle names a vertex that is not
            there.
    """

    vertices: Floats
    """(V, 3) as they are drawn: those on a seam of the texture stand twice"""
    triangles: Indices
    """(N, 3) vertex numbers, counter-clockwise seen from outside"""
    welds: Indices | None = None
    """(V,) the first vertex that is the same point of the surface; by default each is its own"""
    uvs: NDArray[np.float32] | None = None
    """(V, 2) places in the texture, v from its top row downwards, where there are any"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        vertices = np.array(self.vertices, np.float64)
        triangles = np.array(self.triangles, np.int64)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not len(vertices):
            raise ValueError("the mesh has no vertices")
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
            raise ValueError("the mesh has no triangles")
        if not np.isfinite(vertices).all():
            bad = int(np.argmin(np.isfinite(vertices).all(axis=1)))
            raise ValueError(f"vertex {bad} is at {_shown(vertices[bad])}, not at finite numbers")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            row = int(np.argmax(((triangles < 0) | (triangles >= len(vertices))).any(axis=1)))
            raise ValueError(
                f"triangle {row} names vertices {triangles[row].tolist()} of {len(vertices)}"
            )
        welds = np.arange(len(vertices)) if self.welds is None else np.array(self.welds, np.int64)
        for name, value in (("vertices", vertices), ("triangles", triangles), ("welds", welds)):
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    @cached_property
    def _joined(self) -> tuple[Indices, Indices]:
        assert self.welds is not None
        first, place_of = np.unique(self.welds, return_inverse=True)
        return first, place_of.astype(np.int64)

    @property
    def place_of(self) -> Indices:
        """(V,), which of the P places each vertex is at."""
        return self._joined[1]

    @cached_property
    def places(self) -> Floats:
        """(P, 3), the vertices without repetition."""
        return self.vertices[self._joined[0]]

    @cached_property
    def corners(self) -> Indices:
        """(N, 3), the triangles in numbers of `places`."""
        return self.place_of[self.triangles]

    def at_places(self, vertices: NDArray[np.floating[Any]]) -> Floats:
        """The places (P, 3) of vertices (V, 3) that may have moved."""
        return np.asarray(vertices, np.float64)[self._joined[0]]

    @cached_property
    def crosses(self) -> Floats:
        """(N, 3), normals of the triangles, twice as long as the triangles are large."""
        a, b, c = (self.places[self.corners[:, k]] for k in range(3))
        return np.asarray(np.cross(b - a, c - a), np.float64)

    @cached_property
    def areas(self) -> Floats:
        """(N,)."""
        return np.asarray(np.linalg.norm(self.crosses, axis=1) / 2)

    @cached_property
    def normals(self) -> Floats:
        """(N, 3), unit normals of the triangles; 0 for those without a plane."""
        lengths = np.maximum(2 * self.areas, np.finfo(float).tiny)[:, None]
        return np.where(self.flat[:, None], 0.0, self.crosses / lengths)

    @cached_property
    def place_normals(self) -> Floats:
        """(P, 3), unit normals at the places, weighted by area."""
        sums = np.zeros_like(self.places)
        for k in range(3):
            np.add.at(sums, self.corners[:, k], self.crosses)
        return sums / np.maximum(np.linalg.norm(sums, axis=1), np.finfo(float).tiny)[:, None]

    @cached_property
    def flat(self) -> NDArray[np.bool_]:
        """(N,), which triangles are degenerate: they have no plane."""
        return np.asarray(self.areas <= FLAT * self.size**2)

    @cached_property
    def centroids(self) -> Floats:
        """(N, 3), the middles of the triangles."""
        return np.asarray(self.places[self.corners].mean(axis=1))

    @cached_property
    def size(self) -> float:
        """The diagonal of the box around all triangles."""
        used = self.vertices[self.triangles].reshape(-1, 3)
        return float(np.linalg.norm(used.max(axis=0) - used.min(axis=0)))

    @cached_property
    def pieces(self) -> Indices:
        """(P,), the number of the connected piece that each place belongs to."""
        from scipy.sparse.csgraph import connected_components

        return np.asarray(connected_components(self._graph, directed=False)[1], np.int64)

    @cached_property
    def _graph(self) -> Any:
        from scipy.sparse import coo_array

        edges = self.edges
        count = len(self.places)
        return coo_array((np.ones(len(edges)), edges.T), shape=(count, count))

    @cached_property
    def _edges(self) -> tuple[Indices, Indices, Indices]:
        """Edges (E, 2) of places, the edge of each side (3N,), and the sides of each edge (E,)."""
        sides = self.corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        edges, which, counts = np.unique(
            np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True
        )
        return edges, which.reshape(-1), counts

    @property
    def edges(self) -> Indices:
        """(E, 2), pairs of places."""
        return self._edges[0]

    @cached_property
    def border(self) -> NDArray[np.bool_]:
        """(P,), which places lie on an edge that only one triangle has."""
        edges, _, counts = self._edges
        found = np.zeros(len(self.places), bool)
        found[edges[counts == 1]] = True
        return found

    @cached_property
    def neighbours(self) -> Indices:
        """(n, 2), pairs of triangles that share an edge."""
        _, which, counts = self._edges
        order = np.argsort(which, kind="stable")
        starts = np.cumsum(counts) - counts
        shared = starts[counts == 2]
        return np.stack([order[shared], order[shared + 1]], axis=1) // 3

    def check_manifold(self) -> None:
        """Make sure that every edge has at most two triangles.

        Raises:
            ValueError: one has more; the message says where.
        """
        edges, _, counts = self._edges
        if counts.max() > 2:
            worst = int(np.argmax(counts))
            a, b = edges[worst]
            vertex = int(np.flatnonzero(self.place_of == a)[0])
            other = int(np.flatnonzero(self.place_of == b)[0])
            raise ValueError(
                f"{int((counts > 2).sum())} edges have more than two triangles; the edge of "
                f"vertices {vertex} and {other} at {_shown(self.places[a])} has {counts[worst]}"
            )

    def check_usable(self) -> None:
        """Make sure that shapes can be computed for it.

        Raises:
            ValueError: no triangle has a plane, or the mesh is not manifold.
        """
        if self.flat.all():
            raise ValueError("all triangles are degenerate: none has an area")
        self.check_manifold()

    def loose(self) -> int:
        """How many vertices no triangle uses."""
        return len(self.vertices) - len(np.unique(self.triangles))


def weld_seams(vertices: Floats, triangles: Indices) -> Indices:
    """(V,) for each vertex the first at the same point with a normal to the same side.

    Lips that touch are not joined: their normals face each other.
    """
    _, first, place_of = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    place_of = place_of.reshape(-1)
    normals = Surface(vertices, triangles).place_normals
    welds = first[place_of]
    away = np.einsum("vc,vc->v", normals, normals[welds]) < 0
    # Those that face away from the first are joined among themselves.
    _, second, among = np.unique(place_of[away], return_index=True, return_inverse=True)
    welds[away] = np.flatnonzero(away)[second][among.reshape(-1)]
    return np.asarray(welds, np.int64)


def mesh_surface(mesh: Mesh, part_names: Sequence[str] | None = None) -> Surface:
    """The surface of a character of ours at rest, or of some of its parts.

    Its vertices are all of the mesh's, in their order, whichever parts are asked for.
    """
    kept = [p.triangles for p in mesh.parts if part_names is None or p.name in part_names]
    triangles = np.concatenate([mesh.triangles[run] for run in kept])
    # Cloth that was made of the skin below it is welded to that for its shading alone.
    here = (mesh.vertices == mesh.vertices[mesh.welds]).all(axis=1)
    welds = np.where(here, mesh.welds, np.arange(len(here)))
    return Surface(mesh.vertices.astype(np.float64), triangles.astype(np.int64), welds, mesh.uvs)


def _shown(point: Floats) -> str:
    return f"({', '.join(f'{float(value):.4g}' for value in point)})"
