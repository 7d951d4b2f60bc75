"""Colour and shade of the pieces of the head."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.asset import Asset
from lipwright.face.easing import smooth_step
from lipwright.face.eyes import eye_sphere
from lipwright.face.lips import CONTACT_UPPER, NOSE_TIP, red_of_lips
from lipwright.face.occlusion import openness, smoothed, unit_normals
from lipwright.face.paint import Landmarks, hair_depth, paint_texture, skin_uvs
from lipwright.face.pieces import Piece
from lipwright.face.topology import QuadGraph

MOUTH_CORNER: Final = 7195  # of the left, in the numbers of the base mesh

HAIR_M: Final = 0.0050  # m; how far the hair stands off the scalp
NECKLINE_M: Final = -0.0985  # m; its height on the neck's axis
NECKLINE_SLOPE: Final = 0.46
NECK_HIDDEN_M: Final = 0.010  # m of skin that goes on under the shirt
CLOTH: Final = np.array([0.040, 0.075, 0.095])
HEM: Final = np.array([0.052, 0.095, 0.118])
CLOTH_M: Final = 0.0030  # m; how far the shirt stands off the skin
SHADED_JAW: Final = 0.45
"""the jawOpen under which the inside of the mouth is shaded"""
MOUTH_TINT: Final = (0.30, 0.085, 0.080)
OPEN_MOUTH: Final = ("mouth", "teethUpper", "teethLower", "tongue")


def dress_skin(skin: Piece, asset: Asset, body: QuadGraph) -> NDArray[np.uint8]:
    """Give `skin` its hair and its places in the texture, and return the texture (H, W, 3)."""
    rest = asset.mesh.vertices
    marks = Landmarks(
        eye=eye_sphere(asset)[0],
        nose_tip=rest[NOSE_TIP],
        mouth_corner=rest[MOUTH_CORNER],
        mouth=rest[CONTACT_UPPER],
    )
    lips = np.append(red_of_lips(body, len(rest)), 0.0)  # the last for vertices of the cut
    skin.uvs = skin_uvs(skin.vertices)
    texture = paint_texture(skin.vertices, skin.triangles, lips[skin.source], marks)
    normals = unit_normals(skin.vertices, skin.triangles)
    ear = np.abs(skin.vertices[:, 0]) > 0.0735
    stand = smooth_step(-0.002, 0.016, hair_depth(skin.vertices)) * HAIR_M * ~ear
    skin.vertices = skin.vertices + normals * stand[:, None]
    return texture


def neckline_depth(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """(V,) m that each vertex (V, 3) lies below the shirt's neckline: a plane, lower in front."""
    return np.asarray(NECKLINE_M - NECKLINE_SLOPE * vertices[:, 2] - vertices[:, 1])


def dress_shirt(shirt: Piece) -> None:
    """Lift `shirt` off the skin and colour it, with a hem along the neckline."""
    depth = neckline_depth(shirt.vertices)
    normals = unit_normals(shirt.vertices, shirt.triangles)
    stand = CLOTH_M * (1 - 0.35 * smooth_step(0.010, 0.014, depth))
    shirt.vertices = shirt.vertices + normals * stand[:, None]
    hem = smooth_step(0.014, 0.009, depth)
    shirt.tints = CLOTH + hem[:, None] * (HEM - CLOTH)


def shade(pieces: Sequence[Piece]) -> None:
    """Darken the tints of `pieces` where little light reaches them."""
    starts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    triangles = np.concatenate(
        [p.triangles + start for p, start in zip(pieces, starts, strict=False)]
    ).astype(np.int32)
    rest = np.concatenate([piece.vertices for piece in pieces])
    jaw = np.concatenate([p.shapes.get("jawOpen", np.zeros_like(p.vertices)) for p in pieces])
    closed, opened = (
        openness(pose, unit_normals(pose, triangles), triangles)
        for pose in (rest, rest + SHADED_JAW * jaw)
    )
    closed, opened = (smoothed(light, triangles) for light in (closed, opened))
    for piece, start in zip(pieces, starts, strict=False):
        span = slice(start, start + len(piece.vertices))
        if piece.material == "lash":
            continue
        if piece.material == "eye":
            light = 0.35 + 0.65 * closed[span]
        elif piece.name in OPEN_MOUTH:
            light = np.clip(1.5 * opened[span], 0.02, 1)
        else:
            light = np.clip(0.7 * closed[span] + 0.3 * opened[span], 0.06, 1)
        if piece.name == "tongue":
            reach = (piece.vertices[:, 2] - 0.03) / 0.05  # the blade comes forward into the light
            light = light**0.5 * (0.30 + 0.70 * np.clip(reach, 0, 1))
        if piece.name == "mouth":
            piece.tints = piece.tints * MOUTH_TINT
        # Light that skin scatters back into its folds is red.
        piece.tints = piece.tints * light[:, None] ** np.array([0.75, 0.95, 1.0])
