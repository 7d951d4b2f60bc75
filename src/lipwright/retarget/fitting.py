"""Fit a linear mapping: where a rig can be seen on a mesh, least squares says what moves it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import CANONICAL, GROUPS, MIRROR, both_sides
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.retarget.fit_poses import Sources, shut_poses, speech_poses
from lipwright.retarget.fit_solve import Floats, Problem, best_product, solve, solve_few
from lipwright.retarget.fit_view import View, displacements, size_of
from lipwright.rig import Corrective, LinearMapping, Rig, Row

SPEECH: Final = (*GROUPS["jaw"], *GROUPS["lips"], "cheekPuff", *GROUPS["tongue"])
"""the canonical controls that a mouth follows"""
ALONE: Final = 0.5  # weight of the poses of single controls against those of speech, which is 1
SHUT: Final = 0.5  # weight of closures beside which a face does something else, the same way
LOOKS: Final = 0.3  # weight of the looks of the rig as poses, the same way
SURE: Final = 300.0  # mm^2 for a control 1 off in its own look
HELPS: Final = 0.01  # share of the error; a corrective that helps less is not worth its line
ALIKE: Final = 0.1  # cosine; a control and a source that show less in common are not tried
SAME: Final = 0.8  # cosine; those that show as much stay together, however little speech needs it
OPENING: Final = 0.1  # of the control that opens the lips most; what opens less makes no way
SEEN: Final = 0.05  # of the range; what speech moves less has no correctives


@dataclass(frozen=True)
class FitOptions:
    """How a mapping is fitted.

    Raises:
        ValueError: the poses have another shape, or are not finite.
    """

    controls: Collection[str] | None = None
    """of the rig, that may move; by default all that are seen"""
    sources: Collection[str] = SPEECH
    """canonical controls that may move them"""
    poses: npt.NDArray[np.float64] | None = None
    """(N, C), canonical, what motion is like; by default speech, see `fit_poses`"""
    correctives: int = 0
    """at most so many"""
    ridge: float = 0.3
    """mm^2 for a gain of 1: what keeps controls that show the same from working against each
    other"""
    thrift: float = 1.0
    """mm^2 for a control at 1: what prefers few controls at once"""
    least: float = 0.05
    """gains below are dropped"""
    decimals: int = 2
    """of the gains"""

    def __post_init__(self) -> None:
        """Check."""
        if self.poses is None:
            return
        if self.poses.ndim != 2 or self.poses.shape[1] != len(CANONICAL) or not len(self.poses):
            raise ValueError(f"poses have the shape {self.poses.shape}, not (N, {len(CANONICAL)})")
        if not np.isfinite(self.poses).all():
            raise ValueError("poses are not finite")


OF_MESHES: Final = FitOptions(ridge=1e-4, thrift=0.0)
"""where blendshapes of meshes are fitted: what they show is known exactly, and a mesh that has
canonical blendshapes gets itself back"""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A mapping, and how well the rig follows with it."""

    mapping: LinearMapping
    controls: tuple[str, ...]
    """of the rig, that were fitted; some may have come out at rest"""
    left: Mapping[str, float]
    """canonical control to the share of its motion that the rig does not show: 0 all is shown, 1
    nothing"""
    error: float
    """mm, of the mean vertex over the poses, root mean square"""
    motion: float
    """mm, how far the poses move it, the same way"""


def fit_looks(rig: Rig, head: Head, options: FitOptions | None = None) -> Fitted:
    """The mapping of a rig of which is known what it looks like on a human face.

    Raises:
        LipwrightError: the rig has no looks, or a control is not in it.
    """
    options = options or FitOptions()
    names = _controls(rig, [name for name in rig.names if rig.looks.get(name)], options)
    displaced = displacements(head, CANONICAL)
    looks = rig.look_of(names).astype(np.float64)
    shown = np.asarray(np.tensordot(looks, displaced, axes=1), np.float64)
    return _fit(rig, names, displaced, shown, head, options, looks)


def fit_meshes(source: Mesh, target: Mesh, rig: Rig, options: FitOptions | None = None) -> Fitted:
    """The mapping of a rig whose controls are the blendshapes of a mesh like the source's.

    Args:
        source: a mesh with canonical blendshapes, as the head; lips are looked at on a `Head`.
        target: the character: vertex i is where vertex i of the source is.
        rig: the controls, named as the blendshapes of `target`.
        options: how; by default `OF_MESHES`.

    Raises:
        LipwrightError: the meshes do not correspond, a vertex is no number, or the meshes share no
            blendshapes with the rig or with canonical controls.
    """
    options = options or OF_MESHES
    _check_meshes(source, target)
    names = _controls(rig, [name for name in rig.names if name in target.shape_names], options)
    if not set(source.shape_names) & set(CANONICAL):
        raise LipwrightError(
            f"{source.name}: no blendshape of it is a canonical control; fit from the head"
        )
    displaced = displacements(source, CANONICAL)
    shown = displacements(target, names)
    size = size_of(source.vertices) / size_of(target.vertices)
    return _fit(rig, names, displaced, shown * size, source, options)


def _check_meshes(source: Mesh, target: Mesh) -> None:
    for mesh in (source, target):
        for numbers in (mesh.vertices, mesh.shape_deltas):
            if not np.isfinite(numbers).all():
                raise LipwrightError(f"{mesh.name}: a vertex is not finite; export the mesh anew")
    if len(source.vertices) != len(target.vertices):
        raise LipwrightError(
            f"{source.name} has {len(source.vertices)} vertices and {target.name} "
            f"{len(target.vertices)}: they do not correspond; run: lipwright rigs transfer"
        )
    if not np.array_equal(source.triangles, target.triangles):
        raise LipwrightError(
            f"{source.name} and {target.name} join their {len(source.vertices)} vertices by other "
            "triangles: they do not correspond; run: lipwright rigs transfer"
        )


def _controls(rig: Rig, seen: Sequence[str], options: FitOptions) -> tuple[str, ...]:
    if options.controls is not None:
        rig.check_controls(options.controls, "the fit")
        seen = [name for name in seen if name in set(options.controls)]
    if not seen:
        raise LipwrightError(
            f"nothing shows what the rig {rig.name!r} looks like; give its controls looks, or a "
            "mesh with blendshapes of their names"
        )
    return tuple(seen)


def _sources(rig: Rig, names: Sequence[str], allowed: Collection[str]) -> Sources:
    """By their side only for a rig that has sides."""
    chosen = [name for name in CANONICAL if name in set(allowed)]
    if any(name in rig.mirror for name in names):
        return Sources(tuple(chosen))
    both = dict.fromkeys(
        name if MIRROR[name] == name else name.removesuffix("Left").removesuffix("Right")
        for name in chosen
    )
    # A jaw or a mouth that moves to both sides at once stays where it is.
    return Sources(tuple(name for name in both if name not in ("jaw", "mouth")))


def _fit(
    rig: Rig, names: tuple[str, ...], displaced: Floats, shown: Floats, mesh: Mesh,
    options: FitOptions, looks: Floats | None = None,
) -> Fitted:  # fmt: skip
    sources = _sources(rig, names, options.sources)
    poses = speech_poses() if options.poses is None else np.asarray(options.poses, np.float64)
    alone = sources.alone()
    own = np.zeros((0, len(CANONICAL))) if looks is None else looks
    shares = ((poses, 1.0), (alone, ALONE), (shut_poses(), SHUT), (own, LOOKS))
    every = np.concatenate([part for part, _ in shares])
    weights = np.concatenate([np.full(len(p), share / max(len(p), 1)) for p, share in shares])
    known = np.zeros((len(every), len(names)))
    known[len(every) - len(own) :] = np.eye(len(names))[: len(own)]
    view = View.of(displaced, mesh)
    wanted, seen = _shortened(view.see(displaced), view.see(shown))
    problem = Problem(
        poses=sources.of(every),
        weights=weights / weights.sum(),
        shown=seen.T,
        wanted=every @ wanted,
        gaps=view.gaps(shown).T,
        wanted_gaps=every @ view.gaps(displaced),
        rest_gaps=view.rest,
        known=known,
        sure=np.where(known.any(axis=1), SURE, 0.0),
        low=np.array([c.low - c.rest for c in rig.controls if c.name in names]),
        high=np.array([c.high - c.rest for c in rig.controls if c.name in names]),
        ridge=options.ridge,
        thrift=options.thrift,
    )
    alike = _alike(problem, alone @ wanted)
    used = (np.abs(alike) > ALIKE) | _openers(problem)[:, None]
    gains = solve_few(problem, used, options.least, alike > SAME)
    problem, gains, products = _with_products(problem, gains, len(poses), options)
    gains = np.round(gains, options.decimals)
    mapping = _mapping(rig, names, sources.names, products, gains)
    return _result(problem, gains, names, mapping, sources, len(poses))


def _alike(problem: Problem, alone: Floats) -> Floats:
    """(K, P), cosines between what controls and what sources (P, F) show."""
    lengths = np.linalg.norm(problem.shown, axis=0)[:, None] * np.linalg.norm(alone, axis=1)
    return np.asarray(problem.shown.T @ alone.T / np.maximum(lengths, 1e-12))


def _openers(problem: Problem) -> npt.NDArray[np.bool_]:
    """(K,), controls that open the lips, and so can make way for what opens them too."""
    opening = problem.gaps.mean(axis=0) if len(problem.gaps) else np.zeros(len(problem.low))
    return np.asarray(opening > OPENING * opening.max(initial=0))


def _shortened(wanted: Floats, seen: Floats) -> tuple[Floats, Floats]:
    """(C, F) and (K, F) as (C, C + K) and (K, C + K): the same lengths and angles in less room."""
    short = np.asarray(np.linalg.qr(np.concatenate([wanted, seen]).T, mode="r"), np.float64).T
    return short[: len(wanted)], short[len(wanted) :]


def _with_products(
    problem: Problem, gains: Floats, speech: int, options: FitOptions
) -> tuple[Problem, Floats, list[tuple[int, int]]]:
    """The problem and its gains with the pairs of sources whose products help most."""
    common = np.flatnonzero(np.percentile(problem.poses[:speech], 95, axis=0) > SEEN)
    pairs = list(combinations_with_replacement(common.tolist(), 2))
    if not options.correctives or not pairs:
        return problem, gains, []
    products = np.stack([problem.poses[:, a] * problem.poses[:, b] for a, b in pairs], axis=1)
    chosen: list[tuple[int, int]] = []
    free = np.ones(len(gains), bool)
    for _ in range(options.correctives):
        product, control, helps = best_product(problem, gains, products, free)
        if helps < HELPS:
            break
        chosen.append(pairs[product])
        column = products[:, product : product + 1]
        problem = replace(problem, poses=np.concatenate([problem.poses, column], axis=1))
        used = np.pad(gains != 0, ((0, 0), (0, 1)))
        used[control, -1] = True
        gains = solve(problem, np.pad(gains, ((0, 0), (0, 1))), used)
    return problem, gains, chosen


def _mapping(
    rig: Rig, names: Sequence[str], sources: Sequence[str], products: Sequence[tuple[int, int]],
    gains: Floats,
) -> LinearMapping:  # fmt: skip
    rest = dict(zip(rig.names, rig.rest.tolist(), strict=True))
    rows = {
        name: Row(
            _joined(dict(zip(sources, row[: len(sources)].tolist(), strict=True))), rest[name]
        )
        for name, row in zip(names, gains, strict=True)
        if row[: len(sources)].any()
    }
    correctives = [
        Corrective(name, (sources[a], sources[b]), float(gain))
        for name, row in zip(names, gains, strict=True)
        for (a, b), gain in zip(products, row[len(sources) :], strict=True)
        if gain
    ]
    return LinearMapping(rows, tuple(correctives))


def _joined(gains: Mapping[str, float]) -> dict[str, float]:
    """Without zeros, and with two sides of the same gain as one name, the mean of both."""
    joined: dict[str, float] = {}
    for name, gain in gains.items():
        other = MIRROR.get(name, name)
        stem = name.removesuffix("Left").removesuffix("Right")
        if other != name and gain == gains.get(other) and stem not in ("jaw", "mouth"):
            joined[stem] = 2 * gain
        else:
            joined[name] = gain
    return {name: gain for name, gain in joined.items() if gain}


def _result(
    problem: Problem, gains: Floats, names: tuple[str, ...], mapping: LinearMapping,
    sources: Sources, speech: int,
) -> Fitted:  # fmt: skip
    off = problem.moved(gains) @ problem.shown.T - problem.wanted
    alone = slice(speech, speech + len(sources.names))
    lengths = np.linalg.norm(problem.wanted[alone], axis=1)
    shares = np.linalg.norm(off[alone], axis=1) / np.maximum(lengths, 1e-12)
    left = {
        side: round(float(share), 3)
        for name, share in zip(sources.names, shares, strict=True)
        for side in both_sides(name)
    }
    return Fitted(
        mapping,
        names,
        MappingProxyType(left),
        float(np.sqrt((off[:speech] ** 2).sum(axis=1).mean())),
        float(np.sqrt((problem.wanted[:speech] ** 2).sum(axis=1).mean())),
    )
