"""The tongue: its rest pose and the three shapes that speech needs and ARKit lacks."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.asset import Asset
from lipwright.face.pieces import Piece
from lipwright.face.topology import quads_to_triangles

SPEECH_JAW: Final = 0.15
"""the jawOpen at which the tongue's targets are met exactly: t, th and k in running speech"""

Vectors = NDArray[np.float64]


def smooth_step(low: float, high: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """0 below `low`, 1 above `high`, and a smooth cubic between."""
    share = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3 - 2 * share))


def tongue_piece(asset: Asset) -> Piece:
    """The tongue, lower at rest than in the asset, with its authored shapes."""
    quads = asset.mesh.quads[asset.mesh.groups == "helper-tongue"]
    used, numbers = np.unique(quads, return_inverse=True)
    drawn = asset.mesh.vertices[used]
    shapes = {name: deltas[used] for name, deltas in asset.shapes.items()}
    rest = drawn + _rest_correction(drawn)
    shapes["tongueOut"] = shapes["tongueOut"] + drawn - rest  # it ends where it was drawn
    upper = asset.mesh.vertices[asset.mesh.vertices_of("helper-upper-teeth")]
    shapes |= _speech_shapes(rest, shapes["jawOpen"], upper)
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


def _speech_shapes(rest: Vectors, jaw: Vectors, upper_teeth: Vectors) -> dict[str, Vectors]:
    """tongueRaise, tonguePress and tongueBack."""
    along = _along(rest)
    tip = int(np.argmax(rest[:, 2]))
    opened = rest[tip] + SPEECH_JAW * jaw[tip]
    front = upper_teeth[np.argmax(upper_teeth[:, 2])]
    edge = upper_teeth[upper_teeth[:, 2] > front[2] - 0.004, 1].min()
    ridge = np.array([0.0, edge + 0.007, front[2] - 0.012])
    between = np.array([0.0, edge - 0.0025, front[2] + 0.002])
    blade = smooth_step(0.35, 1.0, along)
    raised = blade[:, None] * (ridge - opened)
    pressed = smooth_step(0.25, 1.0, along)[:, None] * (between - opened)
    dorsum = smooth_step(0.0, 0.3, along) * (1 - smooth_step(0.3, 0.75, along))
    back = np.stack([np.zeros_like(along), 0.019 * dorsum - 0.003 * blade, -0.006 * blade], axis=1)
    return {"tongueRaise": raised, "tonguePress": pressed, "tongueBack": back}
