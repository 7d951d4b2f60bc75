"""The neck of our head: how far each vertex follows when the head turns."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.face.easing import smooth_step
from lipwright.face.head import Head
from lipwright.face.turning import head_rotations

# The neck leans: from under the chin it meets the head higher at the nape.
LEAN: Final = 0.35  # m down the neck for a metre towards the face
ROOT: Final = -0.105  # m, height above the joint, at its depth, up to which the neck stands still
TOP: Final = -0.045  # m, height from which all belongs to the head
STILL: Final = frozenset(("shirt",))  # parts that no turn of the head moves


def turn_shares(head: Head) -> npt.NDArray[np.float32]:
    """(V,), how far each vertex follows the head: 1 on it, 0 in the shirt, eased down the neck."""
    height = head.vertices[:, 1] + LEAN * head.vertices[:, 2]
    shares = np.ones(len(head.vertices), np.float32)
    for part in head.parts:
        if part.name in STILL:
            shares[part.vertices] = 0
        elif part.name == "skin":
            shares[part.vertices] = smooth_step(ROOT, TOP, height[part.vertices])
    return shares


def turned(
    vertices: npt.NDArray[np.float32], shares: npt.NDArray[np.float32], angles: npt.ArrayLike
) -> npt.NDArray[np.float32]:
    """The posed vertices (V, 3), m, under yaw, pitch and roll (3,) in radians, about the joint.

    Where `shares` (V,) is between 0 and 1 places are blended in a straight line, as skinned meshes
    are.
    """
    rotation = head_rotations(angles).astype(np.float32)
    return vertices + shares[:, None] * (vertices @ rotation.T - vertices)
