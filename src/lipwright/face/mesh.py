"""`Mesh`: what can be drawn and exported: surfaces with named blendshapes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lipwright.face.materials import MATERIALS, Material, srgb_to_linear


@dataclass(frozen=True)
class Part:
    """A run of vertices and triangles with one material."""

    name: str
    material_name: str
    vertices: slice
    """of the mesh's V vertices"""
    triangles: slice
    """of the mesh's triangles, which use only the part's own vertices"""

    @property
    def material(self) -> Material:
        """The material by its name."""
        return MATERIALS[self.material_name]


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A character at rest and its C blendshapes, which add up.

    In metres; y up, z forward, +x to the character's own left. The cameras of `shading` see what
    is about as large as a head. All arrays are read-only.
    """

    name: str
    """what it is, in a word"""
    source: str
    """who made it"""
    license: str
    """terms of use, in a few words"""
    shape_names: tuple[str, ...]
    """the names of the C blendshapes"""
    vertices: NDArray[np.float32]
    """(V, 3) at rest, m"""
    triangles: NDArray[np.int32]
    """(N, 3) vertex numbers, counter-clockwise seen from outside"""
    parts: tuple[Part, ...]
    """in order, covering all vertices and triangles"""
    tints: NDArray[np.float32]
    """(V, 3) linear RGB, 0 to 1, multiplied with the texture: shade and tone"""
    uvs: NDArray[np.float32]
    """(V, 2) places in the texture, 0 to 1, v from its top row downwards"""
    texture: NDArray[np.uint8]
    """(H, W, 3) sRGB"""
    welds: NDArray[np.int32]
    """(V,) the first vertex at the same place in the same surface, for smooth normals"""
    shape_starts: NDArray[np.int32]
    """(C + 1,) where each shape's displacements start in the two arrays below"""
    shape_vertices: NDArray[np.int32]
    """(D,) the vertices that move"""
    shape_deltas: NDArray[np.float32]
    """(D, 3) how far they move at weight 1, m"""

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def shape(self, name: str) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """The vertices that the blendshape `name` moves and their displacements (n, 3), m."""
        index = self.shape_names.index(name)
        span = slice(self.shape_starts[index], self.shape_starts[index + 1])
        return self.shape_vertices[span], self.shape_deltas[span]

    def pose(self, weights: ArrayLike) -> NDArray[np.float32]:
        """The vertices (V, 3) in m under `weights` (C,), one for each of `shape_names`.

        Raises:
            ValueError: there are more or fewer weights than blendshapes.
        """
        values = np.asarray(weights, np.float32)
        if values.shape != (len(self.shape_names),):
            count = len(self.shape_names)
            raise ValueError(f"weights have the shape {values.shape}, not ({count},)")
        posed = self.vertices.copy()
        for index in np.flatnonzero(values):
            span = slice(self.shape_starts[index], self.shape_starts[index + 1])
            posed[self.shape_vertices[span]] += values[index] * self.shape_deltas[span]
        return posed

    def pose_many(self, weights: ArrayLike) -> NDArray[np.float32]:
        """The vertices (T, V, 3) in m under the weights (T, C) of T frames."""
        return np.stack([self.pose(row) for row in np.asarray(weights, np.float32)])

    def normals(self, vertices: NDArray[np.floating]) -> NDArray[np.float32]:
        """Unit normals (V, 3) of the posed `vertices` (V, 3), weighted by area."""
        x, y, z = np.ascontiguousarray(vertices.T, np.float32)
        a, b, c = (self.triangles[:, k] for k in range(3))
        x1, y1, z1 = x[b] - x[a], y[b] - y[a], z[b] - z[a]
        x2, y2, z2 = x[c] - x[a], y[c] - y[a], z[c] - z[a]
        order, starts, place = self._corners
        sums = np.stack(
            [
                np.add.reduceat(face[order], starts)
                for face in (y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2)
            ],
            axis=1,
        )
        lengths = np.sqrt(np.einsum("vc,vc->v", sums, sums))
        return np.asarray((sums / np.maximum(lengths, 1e-20)[:, None])[place], np.float32)

    @cached_property
    def _corners(self) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
        """Triangles sorted by their welded corners, the start of each run, each vertex's run."""
        corners = self.welds[self.triangles].ravel()
        order = np.argsort(corners, kind="stable")
        used, starts = np.unique(corners[order], return_index=True)
        run = np.zeros(len(self.vertices), np.intp)
        run[used] = np.arange(len(used))
        return order // 3, starts, run[self.welds]

    @cached_property
    def rest_normals(self) -> NDArray[np.float32]:
        """Unit normals (V, 3) at rest."""
        return self.normals(self.vertices)

    @cached_property
    def colors(self) -> NDArray[np.float32]:
        """(V, 3) linear RGB, 0 to 1: texture times tint at each vertex, for untextured use."""
        height, width = self.texture.shape[:2]
        rows = np.clip(self.uvs[:, 1] * height, 0, height - 1).astype(int)
        columns = np.clip(self.uvs[:, 0] * width, 0, width - 1).astype(int)
        return np.asarray(srgb_to_linear(self.texture[rows, columns]) * self.tints, np.float32)
