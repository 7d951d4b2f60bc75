"""Eyeballs and lashes, made to fit the lids of the asset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.asset import REFLECT, Asset
from lipwright.face.pieces import Piece
from lipwright.face.topology import Indices, QuadGraph

Vectors = NDArray[np.float64]

LID_MARGIN: Final = (6784, 6785)
"""two neighbours on the edge loop of the left lids, in the numbers of the base mesh"""
SOCKET_RING: Final = (7825, 7826)
"""two neighbours on a ring of the left socket that the eyeball always hides"""
SOCKET_INNER: Final = 8025

IRIS_DEG: Final = 21.5  # deg from the pole; an adult's iris is 11.8 mm wide
PUPIL_DEG: Final = 8.5  # deg; a pupil of 4 mm, as in room light
RINGS_DEG: Final = (4.0, PUPIL_DEG, 13.0, 17.5, IRIS_DEG, 25.0, 32.0, 42.0, 54.0, 68.0, 84.0, 102.0)
SPOKES: Final = 24

# Degrees at weight 1; ARKit's own faces turn their eyes about so far.
GAZE_DEG: Final[Mapping[str, tuple[float, float]]] = {
    "eyeLookDown": (16.0, 0.0),
    "eyeLookUp": (-12.0, 0.0),
    "eyeLookIn": (0.0, -26.0),
    "eyeLookOut": (0.0, 26.0),
}
"""control of the left eye to its turn about x (down) and about y (to the left)"""

EYE_TILE: Final = (0.0, 0.75, 0.25)
"""left, top and side of the square of the texture that the eyes share"""

LASHES: Final = {"upper": (48, 0.0066), "lower": (24, 0.0026)}
"""lid to number of lashes and their length in m"""
LASH_TINT: Final = (0.012, 0.008, 0.006)


def eye_sphere(asset: Asset) -> tuple[Vectors, float]:
    """Centre (3,) and radius in m of the left eyeball: the sphere nearest to the asset's eye."""
    drawn = asset.mesh.vertices[asset.mesh.vertices_of("helper-l-eye")]
    system = np.column_stack([2 * drawn, np.ones(len(drawn))])
    solution = np.linalg.lstsq(system, (drawn**2).sum(axis=1), rcond=None)[0]
    centre = solution[:3]
    return centre, float(np.sqrt(solution[3] + centre @ centre))


def socket(body: QuadGraph, mirror: Indices) -> Indices:
    """The vertices of both sockets that the eyeballs hide."""
    left = body.enclosed(SOCKET_INNER, body.edge_loop(*SOCKET_RING))
    return np.concatenate([left, mirror[left]])


def eye_pieces(asset: Asset, body: QuadGraph) -> list[Piece]:
    """Both eyeballs and the lashes of both eyes."""
    left_ball = _eyeball(asset)
    left_lashes = _lashes(asset, body)
    return [
        left_ball,
        _mirrored(left_ball, "eyeRight"),
        left_lashes,
        _mirrored(left_lashes, "lashesRight"),
    ]


def _mirrored(piece: Piece, name: str) -> Piece:
    """The same piece on the other side, moved by the controls of that side."""
    shapes = {
        shape.replace("Left", "Right"): deltas * REFLECT
        for shape, deltas in piece.shapes.items()
        if shape.endswith("Left")
    }
    middle = {s: d * REFLECT for s, d in piece.shapes.items() if not s.endswith(("Left", "Right"))}
    return Piece(
        name,
        piece.material,
        piece.vertices * REFLECT,
        piece.triangles[:, ::-1],
        shapes | middle,
        tints=piece.tints,
        uvs=piece.uvs,
    )


def _turn(about_x_deg: float, about_y_deg: float) -> Vectors:
    x, y = np.radians([about_x_deg, about_y_deg])
    pitch = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    yaw = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    return np.asarray(yaw @ pitch)


def _eyeball(asset: Asset) -> Piece:
    """The left eyeball, looking straight ahead, with the four turns of its gaze."""
    centre, radius = eye_sphere(asset)
    polar = np.radians(RINGS_DEG)[:, None]
    around = np.arange(SPOKES) * 2 * np.pi / SPOKES
    rings = np.stack(
        np.broadcast_arrays(
            np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)
        ),
        axis=-1,
    ).reshape(-1, 3)
    unit = np.vstack([[0.0, 0.0, 1.0], rings])
    angles = np.degrees(np.arccos(np.clip(unit[:, 2], -1, 1)))
    shapes = {
        f"{name}Left": unit @ (_turn(*turn) - np.eye(3)).T * radius
        for name, turn in GAZE_DEG.items()
    }
    shadow = 1 - 0.55 * np.clip((angles - 22) / 40, 0, 1)
    return Piece(
        "eyeLeft",
        "eye",
        centre + unit * radius,
        _cap_triangles(len(RINGS_DEG), SPOKES),
        shapes,
        tints=np.repeat(shadow[:, None], 3, axis=1),
        uvs=_eye_uvs(unit, angles),
    )


def _cap_triangles(rings: int, spokes: int) -> Indices:
    """Triangles of a pole and `rings` rings of `spokes` vertices."""
    here = np.arange(spokes)
    after = (here + 1) % spokes
    triangles = [np.column_stack([np.zeros(spokes, int), 1 + here, 1 + after])]
    for ring in range(rings - 1):
        inner, outer = 1 + ring * spokes, 1 + (ring + 1) * spokes
        triangles.append(np.column_stack([inner + here, outer + here, outer + after]))
        triangles.append(np.column_stack([inner + here, outer + after, inner + after]))
    return np.concatenate(triangles)


def _eye_uvs(unit: Vectors, angles: NDArray[np.float64]) -> Vectors:
    """Azimuthal map of the front of the eye into its tile: 90 deg at 0.48 of its side."""
    left, top, side = EYE_TILE
    flat = unit[:, :2] / np.maximum(np.linalg.norm(unit[:, :2], axis=1, keepdims=True), 1e-9)
    reach = np.minimum(angles, 92.0)[:, None] / 90 * 0.48
    return np.asarray((np.array([0.5, 0.5]) + flat * [1, -1] * reach) * side + [left, top])


def _lashes(asset: Asset, body: QuadGraph) -> Piece:
    """Lashes of the left eye: narrow blades that ride on the margin of the lids."""
    rest = asset.mesh.vertices
    loop = np.array(body.edge_loop(*LID_MARGIN))
    turn = int(np.argmin(rest[loop, 0]))  # the inner corner of the eye
    loop = np.roll(loop, -turn)
    far = int(np.argmax(rest[loop, 0]))
    sides = [loop[: far + 1], np.append(loop[far:], loop[0])[::-1]]
    if rest[sides[0], 1].mean() < rest[sides[1], 1].mean():
        sides.reverse()
    vertices: list[Vectors] = []
    shapes: dict[str, list[Vectors]] = {name: [] for name in asset.shapes}
    for lid, margin in zip(LASHES, sides, strict=True):
        count, length = LASHES[lid]
        up = 1.0 if lid == "upper" else -1.0
        for place in np.linspace(0.14, 0.92, count):
            blade, moves = _lash(asset, margin, float(place), length, up)
            vertices.append(blade)
            for name, deltas in moves.items():
                shapes[name].append(deltas)
    blades = np.arange(len(vertices))[:, None, None] * 5
    pattern = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]])
    stacked = {name: np.concatenate(deltas) for name, deltas in shapes.items()}
    points = np.concatenate(vertices)
    return Piece(
        "lashesLeft",
        "lash",
        points,
        (blades + pattern).reshape(-1, 3),
        {name: deltas for name, deltas in stacked.items() if np.abs(deltas).max() > 0},
        tints=np.tile(LASH_TINT, (len(points), 1)),
    )


def _lash(
    asset: Asset, margin: Indices, place: float, length: float, up: float
) -> tuple[Vectors, dict[str, Vectors]]:
    """One blade (5, 3), root to tip, at `place` of the margin, and what each shape does to it."""
    at = place * (len(margin) - 1)
    index = min(int(at), len(margin) - 2)
    share = np.array([1 - (at - index), at - index])
    pair = margin[index : index + 2]
    root = share @ asset.mesh.vertices[pair]
    length *= 1 + 0.16 * np.sin(997.0 * place)  # no two alike
    fan = (
        0.04 * np.sin(613.0 * place) + (place - 0.45) * 1.1
    )  # inner lashes lean to the nose, outer ones away from it
    scale = length * (0.45 + 0.55 * np.sin(np.pi * (0.15 + 0.65 * place)))
    out = np.array([fan * 0.75, 0.10 * up, 0.85]) * scale * 0.55
    rise = np.array([fan * 0.45, 0.62 * up, 0.25]) * scale * 0.75
    width = np.array([0.00026 if up > 0 else 0.00013, 0.0, 0.0])
    stem = np.array([0.0, -0.0003 * up, 0.0001])
    line = np.array([stem - width, stem + width, out * 0.7 + rise * 0.25 - width * 0.5,
                     out * 0.7 + rise * 0.25 + width * 0.5, out + rise])  # fmt: skip
    moves = {name: np.tile(share @ deltas[pair], (5, 1)) for name, deltas in asset.shapes.items()}
    if up > 0:  # the lashes of the upper lid point down when it shuts
        moves["eyeBlinkLeft"] = moves["eyeBlinkLeft"] + line @ (_turn(55.0, 0.0) - np.eye(3)).T
    return root + line, moves
