"""The lips of the asset: their contact, and where the mouth cavity begins."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.asset import Asset
from lipwright.face.topology import QuadGraph

# Vertices of MakeHuman's hm08 base mesh, in the numbers of its OBJ file less one.
CONTACT_UPPER: Final = 520  # the middle of the ring where the lips touch
CONTACT_NEXT: Final = 7267  # its neighbour to the left: the edge loop runs on from here
CAVITY_RING_UPPER: Final = 571  # three rings further in, out of sight
BORDER: Final = (455, 7214)  # two neighbours on the edge of the red
NOSE_TIP: Final = 5054
CAVITY_INNER: Final = 690  # deep in the mouth

LIP_PAIR_SOURCES: Final = np.array([[520, 523], [7268, 7264], [522, 517]])
"""(3, 2) upper and lower vertices of the contact ring: centre, left, right"""

SHUT: Final = (
    "mouthPress", "mouthRoll", "mouthPucker", "mouthSmile", "mouthFrown", "mouthDimple",
    "mouthStretch", "mouthLeft", "mouthRight",
)  # fmt: skip
"""beginnings of the names of shapes that leave shut lips shut"""

OVERLAP_M: Final = 0.0003  # m; closed lips press together
REACH_M: Final = 0.012  # m from the contact; the correction fades out over it


def contact_ring(body: QuadGraph) -> list[int]:
    """The ring of lip contact, from the middle of the upper lip leftwards and around."""
    return body.edge_loop(CONTACT_UPPER, CONTACT_NEXT)


def mouth_cavity(asset: Asset, body: QuadGraph) -> NDArray[np.int64]:
    """(n,) vertices of the mouth inside the ring that lies out of sight behind the lips."""
    start = CAVITY_RING_UPPER
    left = next(v for v in body.neighbours[start] if asset.mesh.vertices[v, 0] > 1e-4)
    return body.enclosed(CAVITY_INNER, body.edge_loop(start, left))


def close_lips(pose: NDArray[np.float64], body: QuadGraph) -> NDArray[np.float64]:
    """Displacements (V, 3) in m that bring the lips of `pose` (V, 3) into contact.

    Both lips move by half of what is missing at their place, less and less with the distance
    from the contact. Lips that already overlap stay as they are.
    """
    ring = contact_ring(body)
    corner = int(np.argmax(pose[ring, 0]))
    other = len(ring) - corner
    upper = ring[other:] + ring[: corner + 1]  # from the right corner to the left one
    lower = ring[corner : other + 1][::-1]
    right, left = pose[upper[0], 0], pose[upper[-1], 0]
    place = np.linspace(right, left, 81)
    above, below = (np.interp(place, pose[side, 0], pose[side, 1]) for side in (upper, lower))
    middle = (place - right) / (left - right) * 2 - 1
    missing = np.maximum(above - below + OVERLAP_M * (1 - middle**2), 0)
    far = [body.distances(side, pose, REACH_M) for side in (upper, lower)]
    moves = np.zeros_like(pose)
    for vertex in far[0].keys() | far[1].keys():
        to_upper, to_lower = (distances.get(vertex, REACH_M) for distances in far)
        fade = 1 - min(to_upper, to_lower) / REACH_M
        side = -0.5 if to_upper <= to_lower else 0.5
        by = np.interp(pose[vertex, 0], place, missing)
        moves[vertex, 1] = side * by * fade * fade * (3 - 2 * fade)
    moves[[upper[0], upper[-1]]] = 0.0
    return moves


def with_closed_lips(asset: Asset, body: QuadGraph) -> Asset:
    """The asset with lips that touch at rest and under the shapes that do not open them.

    The asset leaves a slit of up to half a millimetre at rest, and mouthPress, mouthRoll and
    others open it at the corners.
    """
    rest = asset.mesh.vertices + close_lips(asset.mesh.vertices, body)
    shapes = {
        name: deltas + close_lips(rest + deltas, body) if name.startswith(SHUT) else deltas
        for name, deltas in asset.shapes.items()
    }
    return replace(asset, mesh=replace(asset.mesh, vertices=rest), shapes=shapes)


def red_of_lips(body: QuadGraph, count: int) -> NDArray[np.float64]:
    """(count,), how much each vertex belongs to the red of the lips, 0 to 1."""
    red = np.zeros(count)
    border = body.edge_loop(*BORDER)
    outside = body.enclosed(NOSE_TIP, border)
    everything = body.enclosed(NOSE_TIP, ())
    red[everything] = 1.0
    red[outside] = 0.0
    red[border] = 0.5
    return red
