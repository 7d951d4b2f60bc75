"""Rigs of bones out of fits: gains, ranges, mirror pairs, and bones placed in other characters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.mesh import Mesh
from lipwright.face.skeleton import Floats
from lipwright.retarget.bones import BoneFit, FitOptions, fit_bones
from lipwright.retarget.skinned import shape_transforms
from lipwright.rig import Bone, Control, LinearMapping, Rig, Row
from lipwright.rig.values import CHANNELS

SEEN: Final = 1.5e-4  # of the mesh's height: a gain that moves nothing by this is not seen
ROOM: Final = 2.0  # times the largest gain: how far a channel goes
LEAST_MOVE: Final = 0.0125  # of the mesh's height, the least that a channel of translation goes
LEAST_TURN: Final = 10.0  # degrees, the same of rotation
SIDES: Final = ("_left", "_right")

ENOUGH: Final = 4  # blendshapes that tell where a face is
ROUNDS: Final = 6
RIDGE: Final = 1e-2  # lips that turn half round for a tenth of a millimetre are no use to artists
LIPS: Final = "lip_"  # how the names of bones of the lips begin
LIP_COUNT: Final = 10.0  # times the rest: a gap of a millimetre there is an open mouth
LIP_REACH: Final = (1.25, 2.0, 2.0)  # of how far the lips' bones are from their middle, each axis


def other_side(name: str) -> str:
    """The bone or channel of the other side; that of the middle is its own."""
    left, right = SIDES
    bone, dot, channel = name.partition(".")
    if bone.endswith(left):
        return bone.removesuffix(left) + right + dot + channel
    if bone.endswith(right):
        return bone.removesuffix(right) + left + dot + channel
    return name


def rig_of_bones(
    rig: Rig, bones: Sequence[Bone], shapes: Sequence[str], transforms: Floats, height: float
) -> Rig:
    """A rig with the transforms of bones as its gains.

    A gain that is too small to be seen is left out, and a channel goes twice as far as one
    blendshape takes it.

    Args:
        rig: what it is called, where it comes from and what it lacks.
        bones: B bones.
        shapes: C canonical controls.
        transforms: (C, B, 6), channels of the bones under each of them in full.
        height: of the mesh, m.
    """
    rows, controls = {}, []
    for number, bone in enumerate(bones):
        if not transforms[:, number].any():
            continue
        seen = SEEN * height
        turned = math.degrees(seen / _reach(bones, number, height))
        for column, channel in enumerate(CHANNELS):
            turns = channel.startswith("r")
            values = dict(zip(shapes, transforms[:, number, column].tolist(), strict=True))
            gains = _gains(values, turned if turns else seen)
            far = max([*map(abs, gains.values()), 0.0]) * ROOM
            high = _round_up(max(far, LEAST_TURN if turns else LEAST_MOVE * height))
            name = f"{bone.name}.{channel}"
            controls.append(Control(name, -high, high))
            if gains:
                rows[name] = Row(gains)
    names = [control.name for control in controls]
    mirror = {n: other_side(n) for n in names if other_side(n) != n and other_side(n) in names}
    return replace(
        rig, controls=tuple(controls), mirror=mirror, bones=tuple(bones),
        mapping=LinearMapping(rows), looks={},
    )  # fmt: skip


def _gains(values: Mapping[str, float], least: float) -> dict[str, float]:
    """The values that are seen, with as many decimals as are."""
    decimals = max(1 - math.floor(math.log10(least)), 0)
    return {name: round(value, decimals) for name, value in values.items() if abs(value) >= least}


def _reach(bones: Sequence[Bone], number: int, height: float) -> float:
    """How far a bone reaches, m: to its farthest child, or a twentieth of the mesh's height."""
    own = bones[number]
    children = [bone for bone in bones if bone.parent == own.name]
    return max([height / 20, *(math.dist(own.at, child.at) for child in children)])


def _round_up(value: float) -> float:
    """The next number of two digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / step - 1e-9) * step:.2g}")


def placed_bones(
    rig: Rig, home: Mesh, mesh: Mesh, shapes: Sequence[str]
) -> tuple[tuple[Bone, ...], float]:
    """A rig's bones where they belong in another character, and how much larger that is.

    Faces move where they are: the middles of what each blendshape moves, on the mesh `home` of the
    rig and on the other, tell size and place. Both must be upright and face along z.

    Raises:
        LipwrightError: the meshes share too few blendshapes.
    """
    if len(shapes) < ENOUGH:
        raise LipwrightError(
            f"{mesh.name}: has {len(shapes)} blendshapes of the {home.name}'s names, and at least "
            f"{ENOUGH} are needed to find its face; it has {', '.join(mesh.shape_names[:6])}"
        )
    ours, theirs = (np.array([_middle(m, name) for name in shapes]) for m in (home, mesh))
    spread = ours - ours.mean(axis=0)
    size = float((spread * (theirs - theirs.mean(axis=0))).sum() / (spread**2).sum())
    if not size > 0:
        raise LipwrightError(
            f"{mesh.name}: its blendshapes do not lie as those of an upright face that looks along "
            "z; turn it, or give a rig with bones of its own by --rig"
        )
    shift = theirs.mean(axis=0) - size * ours.mean(axis=0)
    return tuple(
        replace(bone, at=tuple((size * np.array(bone.at) + shift).round(6).tolist()))
        for bone in rig.bones
    ), size


def _middle(mesh: Mesh, name: str) -> Floats:
    """Where a blendshape moves the mesh, (3,)."""
    moved, by = mesh.shape(name)
    far = np.linalg.norm(by, axis=1).astype(np.float64)
    return np.asarray((mesh.vertices[moved] * far[:, None]).sum(axis=0) / far.sum())


def moving_shapes(mesh: Mesh, rig: Rig) -> tuple[str, ...]:
    """The blendshapes of a mesh that move it and that a rig hears: all, where it has no gains."""
    heard = rig.mapping.sources if isinstance(rig.mapping, LinearMapping) else set(CANONICAL)
    return tuple(name for name in mesh.shape_names if name in heard and len(mesh.shape(name)[0]))


def fit_character(mesh: Mesh, rig: Rig, bones: Sequence[Bone], size: float) -> tuple[BoneFit, Rig]:
    """The bones of a rig fitted to another character, and the rig that this makes.

    Args:
        mesh: with blendshapes of canonical names.
        rig: whose gains, where it has some, are what the fit starts from.
        bones: the same bones where they belong in the mesh.
        size: of the character, as a multiple of the one that the rig was made for.

    Raises:
        LipwrightError: the mesh has no blendshape that moves the rig.
    """
    shapes = moving_shapes(mesh, rig)
    if not shapes:
        raise LipwrightError(
            f"{mesh.name}: has none of the blendshapes that move the rig {rig.name!r}, such as "
            f"jawOpen; it has {', '.join(mesh.shape_names[:6])}"
        )
    start = None
    if isinstance(rig.mapping, LinearMapping):
        start = shape_transforms(rig, shapes)
        start[..., :3] *= size
    options = FitOptions(
        still=_still(rig), follows=_follows(rig), start=start, rounds=ROUNDS, ridge=RIDGE,
        importance=lip_importance(mesh, bones),
    )  # fmt: skip
    fit = fit_bones(mesh, bones, shapes, options)
    height = float(np.ptp(mesh.vertices[:, 1]))
    return fit, rig_of_bones(rig, bones, shapes, fit.transforms, height)


def _still(rig: Rig) -> tuple[str, ...]:
    moved = {control.name.partition(".")[0] for control in rig.controls}
    return tuple(bone.name for bone in rig.bones if bone.name not in moved)


def _follows(rig: Rig) -> Mapping[str, tuple[str, ...]]:
    """Bone to the blendshapes that move it in the rig."""
    if not isinstance(rig.mapping, LinearMapping):
        return {}
    found: dict[str, set[str]] = {bone.name: set() for bone in rig.bones}
    for control, row in rig.mapping.rows.items():
        found.setdefault(control.partition(".")[0], set()).update(row.gains)
    return {name: tuple(sorted(shapes)) for name, shapes in found.items()}


def lip_importance(mesh: Mesh, bones: Sequence[Bone]) -> Floats:
    """(V,) how much each vertex counts in a fit: those of the lips most."""
    places = np.array([bone.at for bone in bones if bone.name.startswith(LIPS)])
    counts = np.ones(len(mesh.vertices))
    if len(places) > 1:
        middle = places.mean(axis=0)
        reach = np.maximum(np.abs(places - middle).max(axis=0) * LIP_REACH, 1e-9)
        far = np.linalg.norm((mesh.vertices - middle) / reach, axis=1)
        counts += LIP_COUNT * np.exp(-0.5 * far**2)
    return counts
