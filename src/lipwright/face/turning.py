"""Turns of the head, from the angles of `controls.HEAD_ANGLES`."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import HEAD_ANGLES


def head_quaternions(angles: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Unit quaternions (..., 4), x y z w, of yaw, pitch and roll (..., 3) in radians.

    In the axes of heads (y up, z forward, +x to the character's own left), about the joint of head
    and neck: the head rolls, then nods, then turns.
    """
    half = np.asarray(angles, np.float64) / 2
    (sy, sp, sr), (cy, cp, cr) = np.moveaxis(np.sin(half), -1, 0), np.moveaxis(np.cos(half), -1, 0)
    sp = -sp  # pitch is up, and a turn about +x is down
    return np.stack(
        [
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
            cy * cp * sr - sy * sp * cr,
            cy * cp * cr + sy * sp * sr,
        ],
        axis=-1,
    )


def head_rotations(angles: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Rotation matrices (..., 3, 3) of yaw, pitch and roll (..., 3) in radians."""
    x, y, z, w = np.moveaxis(head_quaternions(angles), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def head_turns(clip: Clip) -> npt.NDArray[np.float32] | None:
    """(T, 3) yaw, pitch and roll of a clip in radians; None where it turns no head."""
    if not set(HEAD_ANGLES) & set(clip.names):
        return None
    return clip.select(HEAD_ANGLES).values
