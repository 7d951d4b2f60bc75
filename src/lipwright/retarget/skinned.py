"""A rig's bones on a mesh: its channels over time, and the skin that follows them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.face.neck import turn_shares
from lipwright.face.skeleton import Floats, Skeleton
from lipwright.face.skinning import MOST_BONES, SkinnedMesh
from lipwright.face.turning import head_rotations, head_turns
from lipwright.retarget.bone_weights import held_by_idle, solve_weights
from lipwright.retarget.bones import MOVES_M, shape_targets
from lipwright.retarget.linear import apply_linear
from lipwright.rig import LinearMapping, Rig
from lipwright.rig.values import CHANNELS

BODY: Final = "body"  # the bone, where a rig has it, that stays when the head turns


def bone_channels(clip: Clip, rig: Rig) -> Floats:
    """(T, B, 6) of a clip in the controls of a rig with bones; what it lacks is at rest.

    Translations in m, then rotations in degrees; see `Skeleton.joints`.
    """
    names = [f"{bone.name}.{channel}" for bone in rig.bones for channel in CHANNELS]
    values = np.zeros((len(clip), len(names)))
    for column, name in enumerate(names):
        if name in clip.names:
            values[:, column] = clip.curve(name)
        elif name in rig.names:
            values[:, column] = rig.rest[rig.names.index(name)]
    return values.reshape(len(clip), len(rig.bones), len(CHANNELS))


def whole_turns(clip: Clip) -> Floats | None:
    """(T, 3, 3), how a clip turns the head; None where it does not."""
    angles = head_turns(clip)
    return None if angles is None else head_rotations(angles)


def shape_transforms(rig: Rig, shapes: Sequence[str]) -> Floats:
    """(C, B, 6) channels of a rig's bones under each of some canonical controls in full.

    Raises:
        LipwrightError: the rig has no bones, or does not say by gains how they follow speech.
    """
    if not rig.bones or not isinstance(rig.mapping, LinearMapping):
        raise LipwrightError(
            f"the rig {rig.name!r} has no bones that follow blendshapes; make such a rig with: "
            "lipwright rigs bones"
        )
    alone = np.eye(len(CANONICAL), dtype=np.float32)[[CANONICAL.index(name) for name in shapes]]
    clip = Clip(CANONICAL, 1.0, alone)
    return bone_channels(apply_linear(clip, rig, rig.mapping), rig)


def skin_mesh(mesh: Mesh, rig: Rig) -> SkinnedMesh:
    """A mesh on the bones of a rig, so that they come nearest to its blendshapes.

    What no bone moves hangs on the last bone that never moves, such as `head`. Where the rig has a
    bone `body` and the mesh is our head, that holds the shirt, and the neck with the head's bone.

    Args:
        mesh: with blendshapes of canonical names, such as the head.
        rig: with bones that lie in the mesh, and a mapping by gains.

    Raises:
        LipwrightError: the rig has no such bones, or the mesh no blendshape that moves them.
    """
    shapes = _heard(mesh, rig)
    transforms = shape_transforms(rig, shapes)
    skeleton = Skeleton.of(rig.bones)
    targets = shape_targets(mesh, shapes)
    moving = np.flatnonzero(np.abs(targets - mesh.vertices).max(axis=(0, 2)) > MOVES_M)
    weights = held_by_idle(len(mesh.vertices), skeleton.matrices(transforms))
    rest, wanted = mesh.vertices[moving], targets[:, moving]
    weights[moving] = solve_weights(rest, wanted, skeleton, transforms)
    if isinstance(mesh, Head) and BODY in skeleton.names:
        weights = _with_neck(weights, turn_shares(mesh), skeleton.names.index(BODY))
    return SkinnedMesh(mesh, skeleton, weights)


def _with_neck(weights: Floats, shares: npt.NDArray[np.float32], body: int) -> Floats:
    """The weights (V, B) times how far each vertex turns with the head; the rest is the body's."""
    shared = weights * shares[:, None]
    shared[:, body] += 1 - shares
    crowded = np.flatnonzero(np.count_nonzero(shared, axis=1) > MOST_BONES)
    least = np.where(shared[crowded] > 0, shared[crowded], np.inf).argmin(axis=1)
    shared[crowded, least] = 0.0
    return np.asarray(shared / shared.sum(axis=1, keepdims=True))


def _heard(mesh: Mesh, rig: Rig) -> tuple[str, ...]:
    """The blendshapes of a mesh that a rig's mapping hears."""
    sources = rig.mapping.sources if isinstance(rig.mapping, LinearMapping) else set(CANONICAL)
    shapes = tuple(name for name in mesh.shape_names if name in sources)
    if not shapes:
        raise LipwrightError(
            f"the {mesh.name} has no blendshape that moves the rig {rig.name!r}; it has "
            f"{', '.join(mesh.shape_names[:6]) or 'none'}"
        )
    return shapes


def posed_at(
    skinned: SkinnedMesh, rig: Rig, clip: Clip, times: npt.ArrayLike
) -> Iterator[npt.NDArray[np.float32]]:
    """The vertices (V, 3) in m at each of `times` in s, of a clip in the rig's controls."""
    drawn = clip.with_values(clip.at(times))
    return skinned.pose_many(bone_channels(drawn, rig), whole_turns(drawn))
