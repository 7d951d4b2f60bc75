"""The points of the tracker's face mesh that measures are taken of, and the lips' aperture.

Left and right of the mesh's numbering: the eye of 33 and 133 is the one on the left in the
picture, the character's right.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

LIP_PAIRS: Final = ((13, 14), (82, 87), (312, 317))  # inner lips, upper and lower
EYES: Final = ((33, 133), (362, 263))  # the corners of each eye
MOUTH: Final = (61, 291)  # the corners of the mouth

Points = npt.NDArray[np.floating]


def aperture(points: Points) -> npt.NDArray[np.float64]:
    """(T,), the lips' gap over the eyes' distance, of points (T, 478, 2 or 3) in the picture.

    Mean distance of three pairs of points on the inner lips, over the distance of the eyes'
    centres, both in x and y; NaN where a point is.
    """
    return np.mean([distance(points, *pair) for pair in LIP_PAIRS], axis=0) / eye_distance(points)


def mouth_width(points: Points) -> npt.NDArray[np.float64]:
    """(T,), the distance of the mouth's corners over that of the eyes, both in x and y."""
    return distance(points, *MOUTH) / eye_distance(points)


def distance(points: Points, one: int, other: int) -> npt.NDArray[np.float64]:
    """(T,), of two landmarks of points (T, 478, 2 or 3), in x and y."""
    way = np.asarray(points[:, one, :2], np.float64) - points[:, other, :2]
    return np.linalg.norm(way, axis=-1)


def eye_centres(points: Points) -> npt.NDArray[np.float64]:
    """(..., 2, 2 or 3), the middle of each eye's corners, of points (..., 478, 2 or 3)."""
    return np.stack(
        [np.asarray(points[..., list(pair), :], np.float64).mean(-2) for pair in EYES], -2
    )


def eye_distance(points: Points) -> npt.NDArray[np.float64]:
    """(...,), the distance of the eyes' centres in x and y."""
    centres = eye_centres(points)[..., :2]
    return np.linalg.norm(centres[..., 1, :] - centres[..., 0, :], axis=-1)
