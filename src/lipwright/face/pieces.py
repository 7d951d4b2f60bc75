"""Pieces of a character under construction, and how they are put together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lipwright.controls import CANONICAL
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh, Part

MOVES_M = 2e-5  # m; smaller displacements are not stored

Vectors = NDArray[np.float64]


@dataclass
class Piece:
    """One part of a character before assembly, in m."""

    name: str
    material: str
    vertices: Vectors
    """(n, 3)"""
    triangles: NDArray[np.int64]
    """(m, 3), numbers within the piece"""
    shapes: Mapping[str, Vectors]
    """control to displacements (n, 3); controls that do not move the piece may be left out"""
    tints: Vectors = field(default_factory=lambda: np.ones((0, 3)))
    """(n, 3) linear RGB"""
    uvs: Vectors = field(default_factory=lambda: np.zeros((0, 2)))
    """(n, 2)"""
    source: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(n,) the vertex of the original mesh, or -1; equal sources are welded"""

    def __post_init__(self) -> None:
        """Fill in what was left out."""
        count = len(self.vertices)
        if not len(self.tints):
            self.tints = np.ones((count, 3))
        if not len(self.uvs):
            self.uvs = np.full((count, 2), 1.0)
        if not len(self.source):
            self.source = np.full(count, -1)


def weld(sources: NDArray[np.int64]) -> NDArray[np.int32]:
    """For each vertex the first that came from the same vertex of the original mesh."""
    first: dict[int, int] = {}
    welds = np.arange(len(sources), dtype=np.int32)
    for index, source in enumerate(sources):
        if source >= 0:
            welds[index] = first.setdefault(int(source), index)
    return welds


def _displacements(
    name: str, pieces: Sequence[Piece]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """The vertices (n,) of the whole character that a control moves, and how far (n, 3), m."""
    whole = np.concatenate(
        [piece.shapes.get(name, np.zeros_like(piece.vertices)) for piece in pieces]
    )
    moved = np.flatnonzero(np.abs(whole).max(axis=1) > MOVES_M)
    return moved, whole[moved]


def assemble(
    pieces: Sequence[Piece], texture: NDArray[np.uint8], lip_sources: NDArray[np.int64]
) -> Head:
    """The head made of `pieces`; `lip_sources` (3, 2) are vertices of the original mesh."""
    sources = np.concatenate([piece.source for piece in pieces])
    return Head(
        **_arrays(pieces, CANONICAL),
        texture=texture,
        welds=weld(sources),
        lip_pairs=np.array(
            [[int(np.flatnonzero(sources == s)[0]) for s in pair] for pair in lip_sources],
            np.int32,
        ),
    )


def assemble_mesh(
    pieces: Sequence[Piece],
    shape_names: tuple[str, ...],
    *,
    name: str,
    source: str,
    license: str,  # noqa: A002  # as the field is called
) -> Mesh:
    """A character of our own making, with no texture but the tints of its `pieces`.

    Args:
        pieces: its parts, none of which shares vertices with another.
        shape_names: the blendshapes, in order.
        name: what it is.
        source: who made it.
        license: terms of use.
    """
    arrays = _arrays(pieces, shape_names)
    return Mesh(
        **arrays,
        name=name,
        source=source,
        license=license,
        shape_names=shape_names,
        texture=np.full((1, 1, 3), 255, np.uint8),
        welds=np.arange(len(arrays["vertices"]), dtype=np.int32),
    )


def _arrays(pieces: Sequence[Piece], shape_names: Sequence[str]) -> dict[str, Any]:
    """Fields of a `Mesh` that the pieces determine."""
    vertex_edges = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    triangle_edges = np.cumsum([0, *(len(piece.triangles) for piece in pieces)])
    moved, deltas = zip(*(_displacements(name, pieces) for name in shape_names), strict=True)
    return {
        "vertices": np.concatenate([p.vertices for p in pieces]).astype(np.float32),
        "triangles": np.concatenate(
            [p.triangles + s for p, s in zip(pieces, vertex_edges, strict=False)]
        ).astype(np.int32),
        "parts": tuple(
            Part(
                piece.name,
                piece.material,
                slice(int(vertex_edges[i]), int(vertex_edges[i + 1])),
                slice(int(triangle_edges[i]), int(triangle_edges[i + 1])),
            )
            for i, piece in enumerate(pieces)
        ),
        "tints": np.concatenate([p.tints for p in pieces]).astype(np.float32),
        "uvs": np.concatenate([p.uvs for p in pieces]).astype(np.float32),
        "shape_starts": np.cumsum([0, *map(len, moved)]).astype(np.int32),
        "shape_vertices": np.concatenate(moved).astype(np.int32),
        "shape_deltas": np.concatenate(deltas).astype(np.float32),
    }
