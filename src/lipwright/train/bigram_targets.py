"""Captured faces as weights of poses: what phone bigrams are fitted to (Xu et al. 2013, 4.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT, CANONICAL, GROUPS
from lipwright.face.head import Head
from lipwright.rig import Rig

Floats = npt.NDArray[np.float64]

MOVED: Final = 0.02  # eye distances; vertices that no shape of the mouth moves further say nothing
APERTURE: Final = 10.0  # weight of the aperture's squared error; that of the vertices is about 1
RIDGE: Final = 1e-5  # cost of the square of a pose in full


class Projector:
    """Finds the weights of poses, from 0 on, under which the head is most like a captured one.

    Likeness is the squared distance of the head's vertices around the mouth, and of the aperture
    of the lips, which counts far more: lips must be as open as the speaker's.
    """

    def __init__(self, head: Head, rig: Rig, poses: Sequence[str]) -> None:
        """Prepare.

        Args:
            head: that the rig's looks are put on.
            rig: says how its poses look.
            poses: K of them, to be found.
        """
        self.rig, self.poses = rig, tuple(poses)
        mouth = [CANONICAL.index(name) for name in GROUPS["jaw"] + GROUPS["lips"]]
        shapes = np.zeros((len(CANONICAL), len(head.vertices), 3))
        for index in mouth:
            moved, by = head.shape(CANONICAL[index])
            shapes[index, moved] = by / head.eye_distance
        seen = np.linalg.norm(shapes, axis=2).max(axis=0) > MOVED
        rows = shapes[:, seen].reshape(len(CANONICAL), -1) / np.sqrt(seen.sum())
        opening = np.sqrt(APERTURE) * head.opening[:, None]
        self._effects = np.hstack([rows, opening])  # (canonical controls, what is compared)
        looks = rig.look_of(self.poses) @ self._effects
        self._root = np.linalg.cholesky(looks @ looks.T + RIDGE * np.eye(len(self.poses)))
        self._cross = np.linalg.solve(self._root, looks @ self._effects.T)

    def __call__(self, arkit: Floats, known: Mapping[str, Floats] | None = None) -> Floats:
        """(T, K), the weights.

        Args:
            arkit: (T, 52), captured.
            known: other poses of the rig to their weights (T,), which are there already.
        """
        from scipy.optimize import nnls

        controls = np.zeros((len(arkit), len(CANONICAL)))
        controls[:, : len(ARKIT)] = arkit
        for pose, weights in (known or {}).items():
            controls -= weights[:, None] * self.rig.look_of([pose])
        sides = controls @ self._cross.T
        return np.stack([nnls(self._root.T, side)[0] for side in sides])
