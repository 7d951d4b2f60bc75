"""What a fit looks at: the vertices of two meshes, and the lips of a head."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.retarget.fit_solve import Floats

LIPS: Final = 6.0  # weight of a mm of the lips' gap against a mm of the mean vertex
SHAPE: Final = 2.0  # weight of a mm of the lips' width and of their protrusion, the same way
TONGUE: Final = 1.0  # weight of the mean square of the tongue against that of all else
MILLIMETRES: Final = 1000.0  # in a m
MOVING: Final = 1e-5  # m; a vertex that no control moves further is not looked at


def displacements(mesh: Mesh, names: Sequence[str]) -> Floats:
    """(n, V, 3) m, what each named blendshape moves at 1; nothing where the mesh has none."""
    moved = np.zeros((len(names), len(mesh.vertices), 3))
    for row, name in enumerate(names):
        if name in mesh.shape_names:
            vertices, deltas = mesh.shape(name)
            moved[row, vertices] = deltas
    return moved


def size_of(vertices: npt.NDArray[np.floating]) -> float:
    """m, of all vertices (V, 3) together: what tells two characters' sizes apart."""
    return float(np.linalg.norm(vertices - vertices.mean(axis=0)))


@dataclass(frozen=True, eq=False)
class View:
    """What is looked at: vertices that move, and the lips where they are known."""

    moving: npt.NDArray[np.intp]
    """vertices"""
    lips: npt.NDArray[np.int32]
    """(pairs, 2), upper and lower inner-lip vertices: centre, left, right; or (0, 2)"""
    share: Floats
    """of each moving vertex; the tongue, small and hidden, counts as much as all the rest"""
    rest: Floats
    """(pairs,), the gap of each at rest, weighed"""

    @classmethod
    def of(cls, displaced: Floats, mesh: Mesh) -> View:
        """What to look at in displacements (n, V, 3) m of a mesh."""
        lips = mesh.lip_pairs if isinstance(mesh, Head) else np.zeros((0, 2), np.int32)
        moving = np.flatnonzero(np.abs(displaced).max(axis=(0, 2), initial=0) > MOVING)
        heights = mesh.vertices[lips, 1].astype(np.float64)
        tongues = [part.vertices for part in mesh.parts if part.name == "tongue"]
        inside = np.isin(moving, [v for span in tongues for v in range(span.start, span.stop)])
        share = np.where(inside, TONGUE / max(inside.sum(), 1), 1 / max((~inside).sum(), 1))
        return cls(moving, lips, share, (heights[:, 0] - heights[:, 1]) * MILLIMETRES * LIPS)

    def see(self, displaced: Floats) -> Floats:
        """(n, F) mm, of displacements (n, V, 3): the mean square over vertices, and the lips."""
        each = displaced[:, self.moving] * np.sqrt(self.share)[:, None]
        flat = each.reshape(len(displaced), -1)
        if not len(self.lips):
            return flat * MILLIMETRES
        ends = displaced[:, self.lips]  # (n, pairs, 2, 3)
        width = (ends[:, 1, :, 0] - ends[:, 2, :, 0]).mean(axis=1)
        forward = ends[..., 2].mean(axis=(1, 2))
        shape = np.stack([width, forward], axis=1) * SHAPE
        return np.concatenate([flat, shape], axis=1) * MILLIMETRES

    def gaps(self, displaced: Floats) -> Floats:
        """(n, pairs) mm, how far they open the lips, weighed."""
        ends = displaced[:, self.lips, 1]
        return np.asarray((ends[..., 0] - ends[..., 1]) * MILLIMETRES * LIPS)
