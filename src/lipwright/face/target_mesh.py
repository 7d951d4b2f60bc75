"""A character out of a surface and the blendshapes that were made for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.mesh import Mesh, Part
from lipwright.face.surface import Surface

MOVES: Final = 3e-4  # of a shape's greatest motion; smaller displacements are left out
CLAY: Final = (199, 168, 150)  # sRGB, of a character without colours


def character(
    surface: Surface,
    shape_names: Sequence[str] = (),
    deltas: NDArray[np.floating] | None = None,
    *,
    name: str = "character",
    source: str = "a mesh of the user's",
    license: str = "its maker's terms",  # noqa: A002  # as the field is called
) -> Mesh:
    """The surface as one part of plain clay, with blendshapes.

    Args:
        surface: at rest; the cameras of `shading` want it in metres, and heads at the origin.
        shape_names: of the C blendshapes.
        deltas: (C, V, 3), how far each moves the vertices.
        name: what it is, in a word.
        source: who made it.
        license: terms of use, in a few words.
    """
    count = len(surface.vertices)
    moved, moves = [], []
    for shape in np.zeros((0, count, 3)) if deltas is None else np.asarray(deltas, np.float64):
        far = np.linalg.norm(shape, axis=1)
        some = np.flatnonzero(far > max(MOVES * far.max(), np.finfo(np.float32).tiny))
        moved.append(some)
        moves.append(shape[some])
    uvs = np.full((count, 2), 0.5, np.float32) if surface.uvs is None else surface.uvs
    assert surface.welds is not None
    return Mesh(
        name=name,
        source=source,
        license=license,
        shape_names=tuple(shape_names),
        vertices=surface.vertices.astype(np.float32),
        triangles=surface.triangles.astype(np.int32),
        parts=(Part(name, "skin", slice(0, count), slice(0, len(surface.triangles))),),
        tints=np.ones((count, 3), np.float32),
        uvs=np.array(uvs, np.float32),
        texture=np.full((1, 1, 3), CLAY, np.uint8),
        welds=surface.welds.astype(np.int32),
        shape_starts=np.cumsum([0, *map(len, moved)]).astype(np.int32),
        shape_vertices=np.concatenate([np.zeros(0), *moved]).astype(np.int32),
        shape_deltas=np.concatenate([np.zeros((0, 3)), *moves]).astype(np.float32),
    )
