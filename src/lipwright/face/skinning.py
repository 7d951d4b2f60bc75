"""`SkinnedMesh`: a mesh that follows bones by linear blend skinning."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lipwright.face.mesh import Mesh
from lipwright.face.skeleton import Floats, Skeleton

MOST_BONES = 4  # that hold a vertex: one set of joints and weights of glTF 2.0, section 3.7.3.3


@dataclass(frozen=True, eq=False)
class SkinnedMesh:
    """A mesh at rest, bones, and how much each vertex follows each bone.

    Raises:
        ValueError: the weights do not fit, are negative, do not sum to 1, or more than four bones
            hold a vertex.
    """

    mesh: Mesh
    skeleton: Skeleton
    weights: Floats
    """(V, B), rows of at most four numbers above 0 that sum to 1"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        weights = np.array(self.weights, np.float64)
        shape = (len(self.mesh.vertices), len(self.skeleton))
        if weights.shape != shape:
            raise ValueError(f"skin weights have the shape {weights.shape}, not {shape}")
        if not (weights >= 0).all() or not np.allclose(weights.sum(axis=1), 1, atol=1e-6):
            raise ValueError("skin weights are negative or do not sum to 1")
        if (np.count_nonzero(weights, axis=1) > MOST_BONES).any():
            raise ValueError(f"more than {MOST_BONES} bones hold a vertex")
        weights.setflags(write=False)
        object.__setattr__(self, "weights", weights)

    def pose(
        self, channels: npt.ArrayLike, turn: npt.ArrayLike | None = None
    ) -> npt.NDArray[np.float32]:
        """The vertices (V, 3) in m under the channels of the bones.

        Args:
            channels: (B, 6), translations in m and rotations in degrees; see `Skeleton.joints`.
            turn: (3, 3), how the head is turned besides.

        Raises:
            ValueError: the channels have another shape.
        """
        values = np.asarray(channels, np.float64)
        if values.shape != (len(self.skeleton), 6):
            raise ValueError(f"channels have the shape {values.shape}, not {len(self.skeleton)}, 6")
        turns = None if turn is None else np.asarray(turn, np.float64)
        matrices = self.skeleton.matrices(values, turns)
        flat = np.moveaxis(matrices, 1, 2).reshape(-1, 3)  # (4 B, 3)
        return np.asarray(self._spread @ flat, np.float32)

    def pose_many(
        self, channels: npt.ArrayLike, turns: Floats | None = None
    ) -> Iterator[npt.NDArray[np.float32]]:
        """The vertices (V, 3) of one frame after the other.

        Args:
            channels: (T, B, 6).
            turns: (T, 3, 3), how the head is turned besides.
        """
        for frame, values in enumerate(np.asarray(channels, np.float64)):
            yield self.pose(values, None if turns is None else turns[frame])

    @cached_property
    def _spread(self) -> Floats:
        return spread(self.mesh.vertices, self.weights)


def spread(vertices: npt.NDArray[np.floating], weights: Floats) -> Floats:
    """(V, 4 B): times the bones' matrices (4 B, 3) it gives the posed vertices."""
    homogeneous = np.column_stack([vertices, np.ones(len(vertices))]).astype(np.float64)
    return (weights[:, :, None] * homogeneous[:, None, :]).reshape(len(vertices), -1)
