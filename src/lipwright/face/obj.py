"""Wavefront OBJ meshes and MakeHuman morph targets, as far as the head needs them."""

from __future__ import annotations

import gzip
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError


@dataclass(frozen=True, eq=False)
class Mesh:
    """A polygon mesh of quads with named groups of faces."""

    vertices: NDArray[np.float64]
    """(V, 3), in the unit of the file"""
    quads: NDArray[np.int64]
    """(F, 4), vertex numbers from 0"""
    groups: NDArray[np.str_]
    """(F,), the group of each face"""

    def vertices_of(self, *groups: str) -> NDArray[np.int64]:
        """(n,) sorted numbers of the vertices that faces of `groups` use."""
        return np.unique(self.quads[np.isin(self.groups, groups)])


def read_obj(data: bytes, name: str) -> Mesh:
    """The mesh in `data`; `name` is for messages.

    Raises:
        LipwrightError: a line is malformed, or a face is not a quad.
    """
    vertices: list[list[float]] = []
    quads: list[list[int]] = []
    groups: list[str] = []
    group = ""
    for number, line in enumerate(data.decode("utf-8").splitlines(), start=1):
        kind, *fields = line.split() or [""]
        try:
            if kind == "v":
                vertices.append([float(field) for field in fields[:3]])
            elif kind == "g":
                group = fields[0]
            elif kind == "f":
                a, b, c, d = (int(field.partition("/")[0]) - 1 for field in fields)
                quads.append([a, b, c, d])
                groups.append(group)
        except (ValueError, IndexError) as error:
            raise LipwrightError(
                f"{name}, line {number}: not understood: {line!r}; fetch the file again"
            ) from error
    return Mesh(np.array(vertices), np.array(quads), np.array(groups))


def read_target(data: bytes, vertex_count: int, name: str) -> NDArray[np.float64]:
    """Displacements (V, 3) of a MakeHuman target, plain or gzipped, in the unit of the mesh.

    Raises:
        LipwrightError: a line is malformed or names a vertex that the mesh lacks.
    """
    deltas = np.zeros((vertex_count, 3))
    text = gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data
    for number, line in enumerate(text.decode("utf-8").splitlines(), start=1):
        if not line.strip() or line.startswith("#"):
            continue
        try:
            vertex, x, y, z = line.split()
            deltas[int(vertex)] = float(x), float(y), float(z)
        except (ValueError, IndexError) as error:
            raise LipwrightError(
                f"{name}, line {number}: not understood: {line!r}; fetch the file again"
            ) from error
    return deltas
