"""Blendshapes to bones: bone transforms and skin weights that come nearest to a mesh's blendshapes.

The alternation of Le and Deng 2012, Smooth Skinning Decomposition with Rigid Bones: weights with
the transforms held, transforms with the weights held. Bones are in a hierarchy and start where an
artist puts them, and the transforms of all bones are solved together as the channels of a rig, by
Gauss and Newton, instead of one bone after the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError
from lipwright.face.mesh import Mesh
from lipwright.face.skeleton import CHANNEL_COUNT, Floats, Placed, Skeleton
from lipwright.face.skinning import SkinnedMesh, spread
from lipwright.retarget.bone_weights import held_by_idle, solve_weights

STEPS: Final = 4  # of Gauss and Newton in each round; rotations of a face are small
PROBE: Final = (1e-4, 1e-4, 1e-4, 1e-2, 1e-2, 1e-2)  # m and degrees, of numeric derivatives
MOVES_M: Final = 2e-5  # m; what moves less in every blendshape does not move


@dataclass(frozen=True)
class Residual:
    """What bones cannot show of one blendshape."""

    shape: str
    rms_mm: float
    """over the vertices that the blendshape moves or the bones move"""
    worst_mm: float
    share: float
    """of the blendshape's motion, in the root mean square of the same vertices"""


@dataclass(frozen=True, eq=False)
class FitOptions:
    """Choices of a fit."""

    still: tuple[str, ...] = ()
    """bones that do not move; the last of them holds the rest of the face"""
    grips: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    """bone to the middle of what it carries, m; where it is, for bones that are left out"""
    follows: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """bone to the only blendshapes that move it; all do, for bones that are left out"""
    start: Floats | None = None
    """(C, B, 6) transforms to start from, instead of from the bones' grips"""
    rounds: int = 12
    """of weights and transforms"""
    ridge: float = 1e-3
    """how firmly the bones keep to rest: a share of what their vertices weigh"""
    importance: NDArray[np.floating] | None = None
    """(V,) how much each vertex counts; 1 by default"""


@dataclass(frozen=True, eq=False)
class BoneFit:
    """Bones that show blendshapes."""

    skinned: SkinnedMesh
    shapes: tuple[str, ...]
    """the C blendshapes that were fitted"""
    transforms: Floats
    """(C, B, 6) channels of the bones under each of them, in full"""
    residuals: tuple[Residual, ...]
    """one of each"""


def fit_bones(
    mesh: Mesh,
    bones: Iterable[Placed],
    shapes: Sequence[str] | None = None,
    options: FitOptions | None = None,
) -> BoneFit:
    """Skin weights, and a transform of each bone for each blendshape, that come nearest to it.

    Args:
        mesh: with blendshapes.
        bones: up to tens of them, parents before children, each where an artist would put it.
        shapes: the blendshapes to fit; by default all.
        options: choices.

    Raises:
        LipwrightError: the mesh has no such blendshape, or an option names no bone.
    """
    options = options or FitOptions()
    skeleton = Skeleton.of(bones)
    shapes = tuple(mesh.shape_names if shapes is None else shapes)
    _check_names(mesh.name, "blendshape", shapes, mesh.shape_names)
    named = (*options.still, *options.grips, *options.follows)
    _check_names("the skeleton", "bone", named, skeleton.names)
    targets = shape_targets(mesh, shapes)
    moving = np.flatnonzero(np.abs(targets - mesh.vertices).max(axis=(0, 2)) > MOVES_M)
    if not len(moving):
        raise LipwrightError(f"the {mesh.name}: none of {', '.join(shapes[:4])} moves it")
    free = _free(skeleton, shapes, options)
    counts = np.ones(len(moving)) if options.importance is None else options.importance[moving]
    solver = _Solver(mesh.vertices[moving], targets[:, moving], skeleton, options, free, counts)
    weights, transforms = solver.solve()
    whole = held_by_idle(len(mesh.vertices), skeleton.matrices(transforms))
    whole[moving] = weights
    skinned = SkinnedMesh(mesh, skeleton, whole)
    return BoneFit(skinned, shapes, transforms, residuals(skinned, shapes, transforms))


def _check_names(whose: str, kind: str, wanted: Iterable[str], known: Sequence[str]) -> None:
    for name in wanted:
        if name not in known:
            raise LipwrightError(
                f"{whose} has no {kind} {name!r}; it has {', '.join(known[:8])}"
                + (", ..." if len(known) > 8 else "")
            )


def _free(skeleton: Skeleton, shapes: Sequence[str], options: FitOptions) -> NDArray[np.bool_]:
    """(C, 6 B), which channels each blendshape may move."""
    moves = [
        [name not in options.still and shape in options.follows.get(name, shapes)
         for name in skeleton.names]
        for shape in shapes
    ]  # fmt: skip
    return np.repeat(np.array(moves), CHANNEL_COUNT, axis=1)


def shape_targets(mesh: Mesh, shapes: Sequence[str]) -> Floats:
    """(C, V, 3) m, the mesh under each of some blendshapes in full."""
    targets = np.tile(mesh.vertices.astype(np.float64), (len(shapes), 1, 1))
    for target, name in zip(targets, shapes, strict=True):
        moved, by = mesh.shape(name)
        target[moved] += by
    return targets


def residuals(
    skinned: SkinnedMesh, shapes: Sequence[str], transforms: Floats
) -> tuple[Residual, ...]:
    """What the bones cannot show of each blendshape under its transforms (C, B, 6)."""
    rest = skinned.mesh.vertices.astype(np.float64)
    rows = []
    for name, channels in zip(shapes, transforms, strict=True):
        target = shape_targets(skinned.mesh, [name])[0]
        posed = skinned.pose(channels).astype(np.float64)
        motion = np.linalg.norm(target - rest, axis=1)
        error = np.linalg.norm(posed - target, axis=1)
        seen = (motion > MOVES_M) | (error > MOVES_M)
        rms, size = (float(np.sqrt(np.mean(x[seen] ** 2))) if seen.any() else 0.0
                     for x in (error, motion))  # fmt: skip
        share = rms / size if size else 0.0
        rows.append(Residual(name, 1000 * rms, 1000 * float(error.max()), share))
    return tuple(rows)


class _Solver:
    """The alternation over the M vertices that move."""

    def __init__(
        self,
        rest: NDArray[np.float32],
        targets: Floats,
        skeleton: Skeleton,
        options: FitOptions,
        free: NDArray[np.bool_],
        importance: NDArray[np.floating],
    ) -> None:
        self._rest = rest.astype(np.float64)
        self._targets = targets
        self._skeleton = skeleton
        self._options = options
        self._free = free
        self._importance = importance.astype(np.float64)

    def solve(self) -> tuple[Floats, Floats]:
        """Weights (M, B) and transforms (C, B, 6)."""
        rest = np.zeros((len(self._targets), len(self._skeleton), CHANNEL_COUNT))
        given = self._options.start
        transforms = self._transforms(*self._grip(), rest) if given is None else given
        for _ in range(self._options.rounds):
            weights = solve_weights(self._rest, self._targets, self._skeleton, transforms)
            transforms = self._transforms(weights, self._importance, transforms)
        return weights, transforms

    def _grip(self) -> tuple[Floats, Floats]:
        """At first each vertex follows the bone whose grip is nearest, and counts if it is near."""
        grips = self._skeleton.at.copy()
        for name, place in self._options.grips.items():
            grips[self._skeleton.names.index(name)] = place
        movers = np.flatnonzero(self._free[:, ::CHANNEL_COUNT].any(axis=0))
        far = np.linalg.norm(self._rest[:, None] - grips[movers], axis=-1)
        between = np.linalg.norm(grips[movers][:, None] - grips[movers], axis=-1)
        np.fill_diagonal(between, np.inf)
        # A bone alone has nobody to share with.
        reach = np.where(np.isfinite(between.min(axis=1)), between.min(axis=1) / 2, far.max())
        nearest = far.argmin(axis=1)
        weights = np.zeros((len(self._rest), len(self._skeleton)))
        weights[np.arange(len(self._rest)), movers[nearest]] = 1.0
        near = np.exp(-0.5 * (far.min(axis=1) / reach[nearest]) ** 2)
        return weights, near * self._importance

    def _transforms(self, weights: Floats, counts: Floats, start: Floats) -> Floats:
        """(C, B, 6) that bring the vertices nearest to each target, from `start`."""
        basis = spread(self._rest, weights)
        ridge = self._ridge(weights, counts)
        solved = start.copy()
        for index, target in enumerate(self._targets):
            for _ in range(STEPS):
                solved[index] += self._step(
                    basis, target, counts, ridge, solved[index], self._free[index]
                )
        return solved

    def _ridge(self, weights: Floats, counts: Floats) -> Floats:
        """(6 B,) what keeping to rest weighs: m2 a m2, and a degree by what it moves vertices."""
        held = (counts[:, None] * weights**2)[:, :, None]
        lever = self._rest[:, None] - self._skeleton.at
        across = (lever**2).sum(axis=2, keepdims=True) - lever**2
        turning = np.radians(1.0) ** 2 * (held * across).sum(axis=0)
        moving = np.repeat(held.sum(axis=0), 3, axis=1)
        return np.asarray(
            self._options.ridge * np.concatenate([moving, turning], axis=1).ravel() + 1e-12
        )

    def _step(
        self,
        basis: Floats,
        target: Floats,
        counts: Floats,
        ridge: Floats,
        pose: Floats,
        free: NDArray[np.bool_],
    ) -> Floats:
        """(B, 6), one step of Gauss and Newton from the channels `pose` (B, 6)."""
        slopes = self._slopes(pose)[free]  # (n, B, 3, 4)
        flat = np.moveaxis(slopes, (0, 1, 3, 2), (3, 0, 1, 2)).reshape(basis.shape[1], -1)
        jacobian = (basis @ flat).reshape(3 * len(basis), -1)
        matrices = self._skeleton.matrices(pose)
        error = target - basis @ np.moveaxis(matrices, 1, 2).reshape(-1, 3)
        weighted = jacobian * np.repeat(counts, 3)[:, None]
        own = ridge[free]
        system = weighted.T @ jacobian + np.diag(own)
        side = weighted.T @ error.ravel() - own * pose.ravel()[free]
        step = np.zeros(pose.size)
        step[free] = np.linalg.solve(system, side)
        return step.reshape(pose.shape)

    def _slopes(self, pose: Floats) -> Floats:
        """(6 B, B, 3, 4), what each channel changes of the matrices."""
        probes = np.tile(PROBE, len(self._skeleton))
        either = np.diag(probes).reshape(-1, *pose.shape)
        ahead, behind = (self._skeleton.matrices(pose + s * either) for s in (1, -1))
        return np.asarray((ahead - behind) / (2 * probes[:, None, None, None]))
