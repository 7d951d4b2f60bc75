"""Skin weights of a mesh for bones whose motion is known.

The weight step of Le and Deng 2012, Smooth Skinning Decomposition with Rigid Bones.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.face.skeleton import Floats, Skeleton
from lipwright.face.skinning import MOST_BONES

WHOLE: Final = 1e3  # times the motion of a vertex: how firmly its weights sum to 1
SMALLEST_M: Final = 1e-4  # m, the least motion that this is measured by
LEAST: Final = 1e-3  # a weight below it is not seen
IDLE: Final = 1e-9  # m, and of a rotation matrix: less is the rounding of zero


def solve_weights(
    vertices: npt.NDArray[np.floating], targets: Floats, skeleton: Skeleton, channels: Floats
) -> Floats:
    """(V, B) weights, at most four a vertex, with which bones come nearest to `targets`.

    Non-negative least squares for each vertex, and again among the four bones that hold it most. Of
    bones that never move the last one holds the rest of all vertices.

    Args:
        vertices: (V, 3) at rest, m.
        targets: (P, V, 3) m, the same vertices in P poses.
        skeleton: B bones.
        channels: (P, B, 6), where they are in these poses.
    """
    rest = np.asarray(vertices, np.float64)
    matrices = skeleton.matrices(channels)
    turned = np.einsum("pbij,vj->vpib", matrices[..., :3], rest)
    moved = turned + np.moveaxis(matrices[..., 3], 2, 1) - rest[:, None, :, None]
    wanted = np.moveaxis(np.asarray(targets, np.float64) - rest, 0, 1)
    moved = moved.reshape(len(rest), -1, len(skeleton))
    free = np.ones(len(skeleton), bool)
    free[np.flatnonzero(is_idle(matrices))[:-1]] = False
    # The same problem in as many rows as there are bones.
    basis, systems = np.linalg.qr(moved[..., free])
    sides = np.einsum("vrb,vr->vb", basis, wanted.reshape(len(rest), -1))
    weights = np.zeros((len(rest), len(skeleton)))
    weights[:, free] = [
        _weights_of_one(system, side) for system, side in zip(systems, sides, strict=True)
    ]
    return weights


def is_idle(matrices: Floats) -> npt.NDArray[np.bool_]:
    """(B,), which bones do not move in any of the poses with `matrices` (P, B, 3, 4)."""
    return np.asarray(np.abs(matrices - np.eye(3, 4)).max(axis=(0, 2, 3)) < IDLE)


def held_by_idle(count: int, matrices: Floats) -> Floats:
    """(count, B) weights of vertices that never move: the last idle bone holds them."""
    idle = np.flatnonzero(is_idle(matrices))
    weights = np.zeros((count, matrices.shape[1]))
    weights[:, idle[-1] if len(idle) else 0] = 1.0
    return weights


def _weights_of_one(system: Floats, side: Floats) -> Floats:
    """(B,) weights of one vertex with `system` (n, B) times them nearest to `side` (n,)."""
    firm = WHOLE * max(float(np.abs(system).max()), SMALLEST_M)
    system = np.vstack([system, np.full(system.shape[1], firm)])
    side = np.append(side, firm)
    weights = _shares(system, side, np.arange(system.shape[1]))
    held = np.flatnonzero(weights > LEAST)
    if len(held) > MOST_BONES:
        held = np.sort(np.argsort(weights, kind="stable")[-MOST_BONES:])
    return _shares(system, side, held)


def _shares(system: Floats, side: Floats, bones: npt.NDArray[np.intp]) -> Floats:
    """(B,) weights that are 0 but for `bones` and sum to 1."""
    from scipy.optimize import nnls

    weights = np.zeros(system.shape[1])
    weights[bones] = nnls(system[:, bones], side)[0]
    return np.asarray(weights / weights.sum())
