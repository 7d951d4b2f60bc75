"""Surfaces out of Wavefront OBJ files.

The format's published description ("Object Files", Wavefront Advanced Visualizer, appendix B1):
`v x y z`, `vt u v`, and `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`, numbered from 1, or
from the end with negative numbers. Polygons become fans of triangles; groups, materials, lines and
curves are passed over.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.face.surface import Surface

MAX_BYTES: Final = 2**29  # of a file; sculpted heads with millions of faces stay below


def read_obj_surface(path: Path) -> Surface:
    """The whole mesh of an OBJ file.

    Vertices keep the file's numbers, from 0; what seams of the texture split off comes after them.

    Raises:
        LipwrightError: a line is malformed, or there are no faces.
        ValueError: the mesh cannot be a surface.
        OSError: the file cannot be read.
    """
    if path.stat().st_size > MAX_BYTES:
        raise LipwrightError(f"{path}: larger than {MAX_BYTES // 2**20} MB; name another file")
    places: list[list[float]] = []
    uvs: list[list[float]] = []
    faces: list[list[tuple[int, int]]] = []
    with path.open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(file, start=1):
            kind, *fields = line.split() or [""]
            try:
                if kind == "v":
                    x, y, z = map(float, fields[:3])
                    places.append([x, y, z])
                elif kind == "vt":
                    uvs.append([float(fields[0]), float(fields[1]) if len(fields) > 1 else 0.0])
                elif kind == "f":
                    faces.append(_face(fields, len(places), len(uvs)))
            except (ValueError, IndexError) as error:
                raise LipwrightError(
                    f"{path}, line {number}: not understood: {line.strip()[:80]!r}"
                ) from error
    if not faces:
        raise LipwrightError(f"{path}: has no faces; name the OBJ of a mesh")
    return _obj_surface(places, uvs, faces)


def _face(fields: list[str], places: int, uvs: int) -> list[tuple[int, int]]:
    """Vertex and texture vertex of each corner, from 0; -1 for a corner without the latter."""
    corners = []
    for field in fields:
        vertex, _, rest = field.partition("/")
        uv = rest.partition("/")[0]
        corners.append((_number(vertex, places), _number(uv, uvs) if uv else -1))
    if len(corners) < 3:
        raise ValueError
    return corners


def _number(text: str, count: int) -> int:
    value = int(text)
    index = value - 1 if value > 0 else count + value
    if not 0 <= index < count:
        raise ValueError
    return index


def _obj_surface(
    places: list[list[float]], uvs: list[list[float]], faces: list[list[tuple[int, int]]]
) -> Surface:
    drawn: dict[tuple[int, int], int] = {}
    welds = list(range(len(places)))
    uv_of = [-1] * len(places)
    seen = [False] * len(places)
    for vertex, uv in (corner for face in faces for corner in face):
        if (vertex, uv) in drawn:
            continue
        if seen[vertex]:
            drawn[vertex, uv] = len(welds)
            welds.append(vertex)
            uv_of.append(uv)
        else:
            seen[vertex], drawn[vertex, uv], uv_of[vertex] = True, vertex, uv
    triangles = [
        [drawn[face[0]], drawn[face[i]], drawn[face[i + 1]]]
        for face in faces
        for i in range(1, len(face) - 1)
    ]
    texture = None
    if uvs:
        numbers = np.array(uv_of)
        texture = np.where(numbers[:, None] >= 0, np.array(uvs)[numbers], 0.0).astype(np.float32)
        texture[:, 1] = 1.0 - texture[:, 1]  # OBJ counts from the bottom row upwards
    return Surface(np.array(places)[welds], np.array(triangles), np.array(welds), texture)
