"""Teeth and gums, on the arches of the asset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.asset import Asset
from lipwright.face.pieces import Piece

Vectors = NDArray[np.float64]

SCALE: Final = 0.92  # of an adult's mean head to this one, by the distance of the eyes

# Mean widths and crown heights in mm from the middle outwards (Wheeler's Dental Anatomy).
UPPER_MM: Final = ((8.5, 10.5), (6.5, 9.0), (7.5, 10.0), (7.0, 8.5), (7.0, 8.5), (10.0, 7.5))
LOWER_MM: Final = ((5.0, 9.0), (5.5, 9.5), (7.0, 10.5), (7.0, 8.5), (7.0, 8.0), (11.0, 7.5))

IVORY: Final = np.array([0.80, 0.74, 0.62])
GUM: Final = np.array([0.42, 0.13, 0.12])
COLUMNS: Final = 4  # of vertices for each tooth


@dataclass(frozen=True)
class Arch:
    """A row of teeth along half an ellipse, seen from above."""

    name: str
    group: str
    """the asset's own teeth, whose motion it takes"""
    teeth_mm: tuple[tuple[float, float], ...]
    half_width: float
    """m"""
    depth: float
    """m from the molars to the front"""
    back: float
    """z of the molars, m"""
    edge: float
    """y of the front teeth's edge, m"""
    up: float
    """+1 if the roots point up"""
    rise: float
    """m that the edge of the molars lies above that of the front teeth"""


UPPER: Final = Arch("teethUpper", "helper-upper-teeth", UPPER_MM, 0.0305, 0.0450, 0.0470, -0.0303,
                    1.0, 0.0035)  # fmt: skip
LOWER: Final = Arch("teethLower", "helper-lower-teeth", LOWER_MM, 0.0285, 0.0425, 0.0470, -0.0287,
                    -1.0, 0.0030)  # fmt: skip

# Profile of a tooth from the gum over the edge to its back: height as a share of the crown and
# above it in m, how far it stands out in m, and how much of it is gum.
PROFILE: Final = (
    (1.0, 0.0070, -0.0012, 1.0),
    (1.0, 0.0010, 0.0004, 1.0),
    (1.0, -0.0002, 0.0000, 0.75),
    (0.86, 0.0, 0.0002, 0.0),
    (0.45, 0.0, 0.0004, 0.0),
    (0.10, 0.0, 0.0001, 0.0),
    (0.0, 0.0, -0.0006, 0.0),
    (0.04, 0.0, -0.0014, 0.0),
    (0.45, 0.0, -0.0032, 0.0),
    (1.0, 0.0, -0.0062, 0.6),
    (1.0, 0.0060, -0.0090, 1.0),
)


def teeth_pieces(asset: Asset) -> list[Piece]:
    """Both rows of teeth with their gums."""
    return [_teeth(asset, arch) for arch in (UPPER, LOWER)]


def _columns(arch: Arch) -> NDArray[np.float64]:
    """For each column: arc length from the middle in m, crown height in m, place in its tooth.

    The place runs from -1 to 1; columns between teeth have -1 or 1.
    """
    rows = []
    start = 0.0
    for width, height in arch.teeth_mm:
        size = width * SCALE / 1000
        for place in np.linspace(-1, 1, COLUMNS + 1)[:-1]:
            rows.append([start + (place + 1) / 2 * size, height * SCALE / 1000, place])
        start += size
    rows.append([start, arch.teeth_mm[-1][1] * SCALE / 1000, 1.0])
    half = np.array(rows)
    return np.concatenate([half[:0:-1] * [-1, 1, -1], half])


def _on_arch(arch: Arch, arc: NDArray[np.float64]) -> tuple[Vectors, Vectors]:
    """Points (n, 2) in x and z at arc lengths from the middle, and the outward normals."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 721)
    line = np.column_stack([arch.half_width * np.sin(turn), arch.depth * np.cos(turn)])
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.interp(arc, length - length[360], turn)
    points = np.column_stack([arch.half_width * np.sin(at), arch.back + arch.depth * np.cos(at)])
    normals = np.column_stack([np.sin(at) / arch.half_width, np.cos(at) / arch.depth])
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _teeth(asset: Asset, arch: Arch) -> Piece:
    arc, crown, place = _columns(arch).T
    points, normals = _on_arch(arch, arc)
    gap = np.abs(place) ** 4  # 1 between two teeth
    edge = arch.edge + arch.up * 0.0005 * gap + arch.rise * (np.abs(arc) / np.abs(arc).max()) ** 2
    rows, tints = [], []
    for share, above, out, gum in PROFILE:
        papilla = 1 - 0.20 * gap * (share > 0.8)  # the gum reaches down between the teeth
        height = edge + arch.up * (crown * share * papilla + above)
        stand = out - 0.0007 * gap * (gum < 0.7) - 0.0003 * place**2
        flat = points + normals * stand[:, None]
        rows.append(np.column_stack([flat[:, 0], height, flat[:, 1]]))
        ivory = IVORY * (1 - 0.45 * gap[:, None]) * (0.86 + 0.14 * (1 - share))
        tints.append(gum * GUM + (1 - gum) * ivory)
    vertices = np.concatenate(rows)
    depth = np.clip((vertices[:, 2] - arch.back) / arch.depth, 0, 1)
    shade = 0.35 + 0.65 * depth**0.7  # less light reaches the molars
    return Piece(
        arch.name,
        "teeth",
        vertices,
        _grid_triangles(len(PROFILE), len(arc), flip=arch.up < 0),
        _motion(asset, arch.group, vertices),
        tints=np.concatenate(tints) * shade[:, None],
    )


def _grid_triangles(rows: int, columns: int, *, flip: bool) -> NDArray[np.int64]:
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    a, b, c, d = corner, corner + 1, corner + columns, corner + columns + 1
    triangles = np.concatenate([np.column_stack([a, c, b]), np.column_stack([b, c, d])])
    return np.asarray(triangles[:, ::-1] if flip else triangles)


def _motion(asset: Asset, group: str, vertices: Vectors) -> dict[str, Vectors]:
    """What the jaw does to `vertices`: the affine motion nearest to the asset's teeth."""
    drawn = asset.mesh.vertices_of(group)
    system = np.column_stack([asset.mesh.vertices[drawn], np.ones(len(drawn))])
    ours = np.column_stack([vertices, np.ones(len(vertices))])
    shapes = {}
    for name in ("jawOpen", "jawForward", "jawLeft", "jawRight"):
        deltas = asset.shapes[name][drawn]
        if np.abs(deltas).max() > 0:
            shapes[name] = ours @ np.linalg.lstsq(system, deltas, rcond=None)[0]
    return shapes
