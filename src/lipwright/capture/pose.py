"""Landmarks without the head's pose.

The points of the skull's front are laid onto a fixed table of them by a similarity: rotation,
scale and translation. What remains is the face's own motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import eye_centres
from lipwright.capture.smooth import low_pass

Floats = npt.NDArray[np.float64]

CUTOFF: Final = 5.0  # Hz; heads nod slower, the noise of the tracked depth is faster

_PART: Final = 1000  # frames

RIGID: Final = MappingProxyType({
    6: (0.000, 0.082, -0.401),
    9: (0.000, -0.361, -0.372),
    10: (0.000, -0.953, -0.276),
    33: (-0.722, -0.018, 0.041),
    34: (-1.123, 0.075, 0.535),
    67: (-0.566, -0.894, -0.141),
    68: (-0.907, -0.508, 0.055),
    69: (-0.518, -0.665, -0.231),
    71: (-1.013, -0.349, 0.246),
    104: (-0.746, -0.614, -0.098),
    108: (-0.273, -0.673, -0.306),
    122: (-0.092, 0.107, -0.359),
    127: (-1.163, 0.064, 0.878),
    133: (-0.278, 0.018, -0.041),
    139: (-1.073, -0.157, 0.419),
    151: (0.000, -0.669, -0.330),
    156: (-0.997, -0.118, 0.174),
    168: (0.000, -0.056, -0.331),
    197: (0.000, 0.210, -0.480),
    263: (0.722, -0.018, 0.041),
    264: (1.123, 0.075, 0.535),
    297: (0.566, -0.894, -0.141),
    298: (0.907, -0.508, 0.055),
    299: (0.518, -0.665, -0.231),
    301: (1.013, -0.349, 0.246),
    333: (0.746, -0.614, -0.098),
    337: (0.273, -0.673, -0.306),
    351: (0.092, 0.107, -0.359),
    356: (1.163, 0.064, 0.878),
    362: (0.278, 0.018, -0.041),
    368: (1.073, -0.157, 0.419),
    383: (0.997, -0.118, 0.174),
})  # fmt: skip
"""landmark to its place on an upright, frontal head in the head's frame; made by
`bench/rigid_points.py`, the mean of 110 GRID recordings with both sides alike"""


def remove_pose(
    points: npt.NDArray[np.floating], fps: float
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Landmarks in the head's frame, and the head's place in the picture.

    Args:
        points: (T, 478, 3), pixels; NaN where the face is lost.
        fps: frames a second.

    Returns:
        landmarks (T, 478, 3): the origin midway between the eyes' centres, the unit their
        distance (both on average over the recording), x to the right in the picture, y down, z
        away from the camera; and poses (T, 3, 4): pixels = pose @ (landmark, 1).
    """
    table = np.array(list(RIGID.values()))
    skull = np.asarray(points[:, list(RIGID)], np.float64)
    poses = fit_similarities(table, skull)
    if not np.isfinite(poses).any():
        return np.array(points, np.float32), poses.astype(np.float32)
    poses = _steady(poses, table, skull, fps)
    # The speaker's skull is not the table's: origin and unit are those of the speaker's eyes.
    centres = np.nanmedian(to_head(eye_centres(points), poses), axis=0)
    origin, unit = centres.mean(axis=0), np.linalg.norm(centres[1] - centres[0])
    poses[:, :, 3] += np.einsum("tij,j->ti", poses[:, :, :3], origin)
    poses[:, :, :3] *= unit
    return to_head(points, poses), poses.astype(np.float32)


def to_head(
    points: npt.NDArray[np.floating], poses: npt.NDArray[np.floating]
) -> npt.NDArray[np.float32]:
    """Pixels (T, N, 3) in the head's frame of the poses (T, 3, 4)."""
    moved = np.empty(points.shape, np.float32)
    for part in _parts(len(points)):
        turns = np.asarray(poses[part, :, :3], np.float64)
        square = np.einsum("tij,tij->t", turns, turns) / 3  # of the scale
        centred = np.asarray(points[part], np.float64) - poses[part, None, :, 3]
        moved[part] = centred @ turns / square[:, None, None]
    return moved


def to_picture(
    landmarks: npt.NDArray[np.floating], poses: npt.NDArray[np.floating]
) -> npt.NDArray[np.float32]:
    """Landmarks (T, N, 3) of the head's frame in pixels; the inverse of `to_head`."""
    moved = np.empty(landmarks.shape, np.float32)
    for part in _parts(len(landmarks)):
        turns = np.asarray(poses[part, :, :3], np.float64)
        moved[part] = landmarks[part] @ turns.swapaxes(1, 2) + poses[part, None, :, 3]
    return moved


def _parts(frames: int) -> Iterator[slice]:
    """Spans of frames, so that an hour of them is never held twice in double precision."""
    for first in range(0, frames, _PART):
        yield slice(first, first + _PART)


def fit_similarities(reference_points: Floats, points: npt.NDArray[np.floating]) -> Floats:
    """(T, 3, 4), the similarities that lay the reference points (N, 3) onto points (T, N, 3).

    Least squares in closed form (Umeyama 1991, equations 39 to 43); NaN where a point is.
    """
    found = np.full((len(points), 3, 4), np.nan)
    known = np.isfinite(points).all(axis=(1, 2))
    seen = np.asarray(points[known], np.float64)
    base = reference_points - reference_points.mean(axis=0)
    centred = seen - seen.mean(axis=1, keepdims=True)
    u, stretch, vt = np.linalg.svd(np.einsum("tni,nj->tij", centred, base))
    sign = np.ones_like(stretch)
    sign[:, 2] = np.sign(np.linalg.det(u) * np.linalg.det(vt))  # a rotation, not a reflection
    scale = (stretch * sign).sum(axis=1) / (base**2).sum()
    found[known, :, :3] = scale[:, None, None] * np.einsum("tij,tj,tjk->tik", u, sign, vt)
    found[known, :, 3] = seen.mean(axis=1) - found[known, :, :3] @ reference_points.mean(axis=0)
    return found


def _steady(poses: Floats, table: Floats, points: Floats, fps: float) -> Floats:
    """The poses smoothed: rotation, scale, and the place of the skull's points."""
    from scipy.spatial.transform import Rotation

    known = np.isfinite(poses).all(axis=(1, 2))
    scales = np.cbrt(np.linalg.det(poses[known, :, :3]))
    rotations = Rotation.from_matrix(poses[known, :, :3] / scales[:, None, None])
    middle = rotations.mean()
    vectors = np.full((len(poses), 4), np.nan)
    vectors[known, :3] = (rotations * middle.inv()).as_rotvec()
    vectors[known, 3] = np.log(scales)
    steady_vectors = low_pass(vectors, fps, CUTOFF)[known]
    turns = (Rotation.from_rotvec(steady_vectors[:, :3]) * middle).as_matrix()
    steady = np.full_like(poses, np.nan)
    steady[known, :, :3] = turns * np.exp(steady_vectors[:, 3])[:, None, None]
    places = low_pass(points.mean(axis=1), fps, CUTOFF)[known]
    steady[known, :, 3] = places - steady[known, :, :3] @ table.mean(axis=0)
    return steady
