"""Makes the table of `capture/pose.py`: the skull's landmarks on an upright, frontal head.

Every eighth GRID recording's tracked frames are moved onto their mean by similarities of the
skull's points, over and over; the mean is turned so that left and right are each other's mirror
images as nearly as they can be, and averaged with its mirror image. Prints the table.

    python bench/rigid_points.py
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import grid
from lipwright.capture.landmarks import eye_centres
from lipwright.capture.pose import fit_similarities, to_head

STEP = 8  # every so many recordings
ROUNDS = 5

# Landmarks of the skull's front that neither brows, lids, lips nor the jaw move much: of each side
# (left and right in the picture), then those of the middle.
SIDES = (
    (33, 263), (133, 362), (122, 351), (108, 337), (69, 299), (104, 333), (67, 297), (68, 298),
    (71, 301), (139, 368), (34, 264), (156, 383), (127, 356),
)  # fmt: skip
MIDDLE = (10, 151, 9, 168, 6, 197)
MIRRORED = np.arange(478)
for left, right in SIDES:
    MIRRORED[left], MIRRORED[right] = right, left

Floats = npt.NDArray[np.float64]


def rigid() -> list[int]:
    return sorted(MIDDLE + tuple(point for side in SIDES for point in side))


def unit(mean: Floats) -> Floats:
    """Origin and unit of the head's frame."""
    centres = eye_centres(mean)
    return (mean - centres.mean(0)) / np.linalg.norm(centres[1] - centres[0])


def mean_face() -> Floats:
    frames = np.concatenate([s.landmarks for s in grid.sentences()[::STEP]]).astype(float)
    frames = frames[np.isfinite(frames).all((1, 2))]
    mean = unit(frames.mean(0))
    chosen = rigid()
    for _ in range(ROUNDS):
        poses = fit_similarities(mean[chosen], frames[:, chosen])
        mean = unit(to_head(frames, poses).mean(0))
    return mean


def symmetric(face: Floats) -> Floats:
    """The rigid points, turned to the front, both sides alike."""
    from scipy.optimize import minimize
    from scipy.spatial.transform import Rotation

    chosen = rigid()

    def halves(turn: Floats) -> tuple[Floats, Floats]:
        turned = face @ Rotation.from_euler("yz", turn).as_matrix().T
        turned = turned - [turned[chosen, 0].mean(), 0, 0]
        return turned[chosen], (turned[MIRRORED] * [-1, 1, 1])[chosen]

    def difference(turn: Floats) -> float:
        one, other = halves(turn)
        return float(((one - other) ** 2).sum())

    best = minimize(difference, np.zeros(2)).x
    print(f"# turned by {np.degrees(best).round(2)} degrees; sides differ by "
          f"{np.sqrt(difference(best) / len(chosen)):.3f}")  # fmt: skip
    return np.mean(halves(best), axis=0)


if __name__ == "__main__":
    table = np.full((478, 3), np.nan)
    table[rigid()] = symmetric(mean_face())
    for index, point in zip(rigid(), unit(table)[rigid()], strict=True):
        x, y, z = (0.0 if abs(value) < 5e-4 else value for value in point)
        print(f"    {index}: ({x:.3f}, {y:.3f}, {z:.3f}),")
