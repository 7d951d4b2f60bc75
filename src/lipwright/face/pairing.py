"""Which triangles of a target belong to which of our head, once that has its shape."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.face.closest import Finder
from lipwright.face.head_landmarks import LandmarkPairs
from lipwright.face.mesh import Mesh
from lipwright.face.partners import Partners, partners_of
from lipwright.face.surface import Surface

Floats = NDArray[np.float64]

FACING: Final = 0.3  # cosine between the normals of partners
LIMIT: Final = 0.12  # spreads of the landmarks: partners are nearer than this
NEAR_PIECE: Final = 0.6  # share of a piece's area that must lie that near to a part of the head
GROUPS: Final = {"skin": "face", "mouth": "face"}  # other parts are groups of their own


def find_partners(
    mesh: Mesh,
    source: Surface,
    placed: Floats,
    target: Surface,
    landmarks: LandmarkPairs,
    spread: float,
) -> Partners:
    """Partners by nearness: the head's triangles for each of the target's, and the other way.

    Each connected piece of the target belongs to one part of the head, so that an eye does not
    move with the lid before it; the piece of the landmarks is the face.

    Args:
        mesh: our head.
        source: its surface at rest.
        placed: (P, 3), the same in the shape of the target.
        target: the target.
        landmarks: where they are on both.
        spread: of the landmarks, in the target's unit.
    """
    shape = Surface(placed, source.corners)
    group_of = _groups(mesh, source)
    piece_of = target.pieces[target.corners[:, 0]]
    limit = LIMIT * spread
    belongs = _piece_groups(shape, group_of, target, piece_of, landmarks, limit)
    pairs: list[tuple[NDArray[np.int64], NDArray[np.int64], Floats]] = []
    for group in np.unique(belongs[belongs >= 0]):
        theirs, ours = belongs[piece_of] == group, group_of == group
        if target.flat[theirs].all():
            continue
        pairs.append(_nearest(target, theirs, shape, ours, limit))
        back = _nearest(shape, ours, target, theirs, limit)
        pairs.append((back[1], back[0], back[2]))
    shape_of_table = len(target.corners), len(source.corners)
    if not pairs:
        return partners_of(*(np.zeros(0, int), np.zeros(0, int), np.zeros(0)), shape_of_table)
    first, second, weights = (np.concatenate(column) for column in zip(*pairs, strict=True))
    return partners_of(first, second, weights, shape_of_table)


def _groups(mesh: Mesh, source: Surface) -> NDArray[np.int64]:
    """(N',), the number of the group that each triangle of the head is in."""
    names = [GROUPS.get(part.name, part.name) for part in mesh.parts]
    order = list(dict.fromkeys(names))
    part_of = np.zeros(len(mesh.vertices), np.int64)
    for part, name in zip(mesh.parts, names, strict=True):
        part_of[part.vertices] = order.index(name)
    return part_of[source.triangles[:, 0]]


def _nearest(
    of: Surface,
    mine: NDArray[np.bool_],
    on: Surface,
    among: NDArray[np.bool_],
    limit: float,
) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
    """Triangles of one surface, the nearest of another that face the same way, and weights."""
    triangles = np.flatnonzero(mine & ~of.flat)
    hits = Finder(on, among).closest(of.centroids[triangles], of.normals[triangles], FACING)
    kept = (hits.distances < limit) & ~hits.on_border
    first, second = triangles[kept], hits.triangles[kept]
    return first, second, np.minimum(of.areas[first], on.areas[second])


def _piece_groups(
    shape: Surface,
    group_of: NDArray[np.int64],
    target: Surface,
    piece_of: NDArray[np.int64],
    landmarks: LandmarkPairs,
    limit: float,
) -> NDArray[np.int64]:
    """For each piece of the target the group of the head that it is nearest to, or -1."""
    pieces = int(piece_of.max()) + 1
    areas = np.bincount(piece_of, target.areas, pieces)
    groups = np.unique(group_of)
    near = np.zeros((len(groups), pieces))
    usable = np.flatnonzero(~target.flat)
    for row, group in enumerate(groups):
        hits = Finder(shape, group_of == group).closest(
            target.centroids[usable], target.normals[usable], FACING
        )
        close = np.maximum(1 - hits.distances / limit, 0) * target.areas[usable]
        near[row] = np.bincount(piece_of[usable], close, pieces)
    share = near / np.maximum(areas, np.finfo(float).tiny)
    found = np.where(share.max(axis=0) > 1 - NEAR_PIECE, groups[np.argmax(share, axis=0)], -1)
    hits = Finder(target).closest(landmarks.points)
    mains, votes = np.unique(piece_of[hits.triangles], return_counts=True)
    found[mains[votes * 4 >= votes.max()]] = 0  # the skin comes first
    return np.asarray(found)
