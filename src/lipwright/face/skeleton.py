"""`Skeleton`: bones in a hierarchy, and how their channels move them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, Self

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

CHANNEL_COUNT = 6  # of a bone: three of translation in m, then three of rotation in degrees
HEAD = "head"  # the bone that turns with the head


class Placed(Protocol):
    """A bone as rigs have it."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def parent(self) -> str:
        """The name of another bone that stands before it, or empty: the head."""

    @property
    def at(self) -> tuple[float, float, float]:
        """Where it is at rest, m."""


@dataclass(frozen=True, eq=False)
class Skeleton:
    """B bones, none of which is turned at rest.

    Raises:
        ValueError: there are no bones, a parent does not stand before its child, or the arrays do
            not fit together.
    """

    names: tuple[str, ...]
    """of the B bones"""
    parents: npt.NDArray[np.intp]
    """(B,) number of the parent, below the bone's own; -1 for the head"""
    at: Floats
    """(B, 3) m, where each is at rest"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        parents, at = np.array(self.parents, np.intp), np.array(self.at, np.float64)
        count = len(self.names)
        if not count or parents.shape != (count,) or at.shape != (count, 3):
            raise ValueError(f"{count} bones with parents {parents.shape} at {at.shape}")
        if (parents < -1).any() or (parents >= np.arange(count)).any():
            raise ValueError("the parent of a bone does not stand before it")
        for array in (parents, at):
            array.setflags(write=False)
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "parents", parents)
        object.__setattr__(self, "at", at)

    @classmethod
    def of(cls, bones: Iterable[Placed]) -> Self:
        """The skeleton of a rig's bones.

        Raises:
            ValueError: as the class, or a parent is unknown.
        """
        bones = tuple(bones)
        names = [bone.name for bone in bones]
        for bone in bones:
            if bone.parent and bone.parent not in names:
                raise ValueError(f"the parent {bone.parent!r} of {bone.name!r} is no bone")
        parents = [names.index(bone.parent) if bone.parent else -1 for bone in bones]
        places = np.array([bone.at for bone in bones], np.float64).reshape(len(bones), 3)
        return cls(tuple(names), np.array(parents, np.intp), places)

    def __len__(self) -> int:
        """The number of bones, B."""
        return len(self.names)

    @cached_property
    def offsets(self) -> Floats:
        """(B, 3) m, from the place of the parent (the origin, for a bone of the head)."""
        parents = np.vstack([self.at, np.zeros(3)])[self.parents]
        return np.asarray(self.at - parents)

    def joints(self, channels: npt.ArrayLike, turns: Floats | None = None) -> tuple[Floats, Floats]:
        """Rotation (..., B, 3, 3) and place (..., B, 3) in m of each bone in its parent.

        Args:
            channels: (..., B, 6): translation in m and rotation in degrees along and about the
                axes of the parent, rotated about x first, then y, then z.
            turns: (..., 3, 3), how the head is turned besides, about the place of its bone's
                parent.
        """
        values = np.asarray(channels, np.float64)
        rotations = rotation_matrices(values[..., 3:])
        places = self.offsets + values[..., :3]
        if turns is not None:
            bones = self.turning
            whole = np.asarray(turns, np.float64)[..., None, :, :]
            rotations[..., bones, :, :] = whole @ rotations[..., bones, :, :]
            places[..., bones, :] = (whole @ places[..., bones, :, None])[..., 0]
        return rotations, places

    @property
    def turning(self) -> list[int]:
        """Which bones turn with the head: that of this name, or else all that have no parent."""
        if HEAD in self.names:
            return [self.names.index(HEAD)]
        return np.flatnonzero(self.parents < 0).tolist()

    def matrices(self, channels: npt.ArrayLike, turns: Floats | None = None) -> Floats:
        """(..., B, 3, 4): what moves a point from where it is at rest to where the bone has it.

        Args:
            channels: as for `joints`.
            turns: as for `joints`.
        """
        rotations, places = self.joints(channels, turns)
        for bone, parent in enumerate(self.parents):
            if parent >= 0:
                whole = rotations[..., parent, :, :]
                moved = (whole @ places[..., bone, :, None])[..., 0]
                places[..., bone, :] = moved + places[..., parent, :]
                rotations[..., bone, :, :] = whole @ rotations[..., bone, :, :]
        shifts = places - (rotations @ self.at[:, :, None])[..., 0]
        return np.concatenate([rotations, shifts[..., None]], axis=-1)


def rotation_matrices(degrees: npt.ArrayLike) -> Floats:
    """(..., 3, 3) of rotations (..., 3) in degrees about fixed axes: x first, then y, then z."""
    angles = np.radians(np.asarray(degrees, np.float64))
    (sx, sy, sz), (cx, cy, cz) = (
        np.moveaxis(np.sin(angles), -1, 0),
        np.moveaxis(np.cos(angles), -1, 0),
    )
    rows = [
        [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
        [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
