"""The tongue: its rest pose and the three shapes that speech needs and ARKit lacks."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.asset import Asset
from lipwright.face.easing import smooth_step
from lipwright.face.pieces import Piece
from lipwright.face.teeth import UPPER
from lipwright.face.topology import quads_to_triangles

SPEECH_JAW: Final = 0.15
"""the jawOpen at which the tongue's targets are met exactly: t, th and k in running speech"""

TIP_OUT_M: Final = 0.0030  # m that the tip passes the front of the upper teeth for "th"

Vectors = NDArray[np.float64]


def tongue_piece(asset: Asset) -> Piece:
    """The tongue, lower at rest than in the asset, with its authored shapes."""
    quads = asset.mesh.quads[asset.mesh.groups == "helper-tongue"]
    used, numbers = np.unique(quads, return_inverse=True)
    drawn = asset.mesh.vertices[used]
    shapes = {name: deltas[used] for name, deltas in asset.shapes.items()}
    rest = drawn + _rest_correction(drawn)
    shapes["tongueOut"] = shapes["tongueOut"] + drawn - rest  # it ends where it was drawn
    shapes |= _speech_shapes(rest, shapes["jawOpen"])
    return Piece(
        "tongue",
        "tongue",
        rest,
        quads_to_triangles(numbers.reshape(quads.shape)),
        shapes,
        tints=np.tile([0.50, 0.16, 0.15], (len(rest), 1)),
        source=used,
    )


def _along(rest: Vectors) -> NDArray[np.float64]:
    """How far each vertex is from the root (0) to the tip (1)."""
    depth = rest[:, 2]
    return np.asarray((depth - depth.min()) / (depth.max() - depth.min()))


def _rest_correction(drawn: Vectors) -> Vectors:
    """Lower the back of the tongue below the edges of the upper teeth."""
    along = _along(drawn)
    hump = smooth_step(0.0, 0.35, along) * (1 - 0.6 * smooth_step(0.55, 1.0, along))
    return np.stack([np.zeros_like(hump), -0.008 * hump, np.zeros_like(hump)], axis=1)


def _speech_shapes(rest: Vectors, jaw: Vectors) -> dict[str, Vectors]:
    """tongueRaise, tonguePress and tongueBack."""
    along = _along(rest)
    opened = rest + SPEECH_JAW * jaw
    return {
        "tongueRaise": _raised(along, rest, opened),
        "tonguePress": _pressed(along, opened),
        "tongueBack": _backed(along),
    }


def _underside(along: NDArray[np.float64], rest: Vectors) -> NDArray[np.float64]:
    """0 on the upper face of the tongue, 1 on its lower face, by slices along it."""
    slices = np.clip((along * 14).astype(int), 0, 13)
    filled = np.unique(slices)
    low = [rest[slices == s, 1].min() for s in filled]
    high = [rest[slices == s, 1].max() for s in filled]
    at = [along[slices == s].mean() for s in filled]
    floor, top = np.interp(along, at, low), np.interp(along, at, high)
    return np.asarray(np.clip((top - rest[:, 1]) / np.maximum(top - floor, 1e-6), 0, 1))


def _raised(along: NDArray[np.float64], rest: Vectors, opened: Vectors) -> Vectors:
    """The blade curls up until its tip meets the ridge; its lower face stays in sight."""
    ridge = np.array([0.0, UPPER.edge + 0.0045, _front() - 0.0105])
    tip = opened[np.argmax(rest[:, 2])]
    curl = smooth_step(0.45, 1.0, along) * (1 - 0.45 * _underside(along, rest))
    moves = curl[:, None] * (ridge - tip)
    moves[:, 0] = -0.12 * curl * rest[:, 0]  # a pointed tip leaves the sides open
    return np.asarray(moves)


def _pressed(along: NDArray[np.float64], opened: Vectors) -> Vectors:
    """The tip comes forward, flat, until it lies below the edge of the upper teeth."""
    reach = smooth_step(0.30, 1.0, along)
    moved = opened.copy()
    moved[:, 2] += reach * (_front() + TIP_OUT_M - opened[:, 2].max())
    moved[:, 0] *= 1 - 0.40 * reach
    between = smooth_step(_front() - 0.022, _front() - 0.010, moved[:, 2])
    flat = np.clip(moved[:, 1], UPPER.edge - 0.0058, UPPER.edge - 0.0012)
    moved[:, 1] += between * (flat - moved[:, 1])
    return moved - opened


def _backed(along: NDArray[np.float64]) -> Vectors:
    """The back rises to the soft palate and the tip draws back."""
    dorsum = smooth_step(0.0, 0.3, along) * (1 - smooth_step(0.3, 0.75, along))
    blade = smooth_step(0.35, 1.0, along)
    return np.stack([np.zeros_like(along), 0.017 * dorsum - 0.002 * blade, -0.006 * blade], axis=1)


def _front() -> float:
    """Z of the front of the upper teeth, m."""
    return UPPER.back + UPPER.depth
