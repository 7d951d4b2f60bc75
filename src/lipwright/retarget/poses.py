"""Rig-space retargeting: poses of a rig for the shape modes of a reference face.

Taylor et al. 2017, section 6. An artist sets the rig once for each of the first modes at -3 and +3
standard deviations; equation 2 says how much of each pose a frame has, equation 3 adds them up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.shapes import MEAN, SHUT, ReferenceShape, load_reference_shape
from lipwright.retarget.linear import apply_linear
from lipwright.rig import LinearMapping, PoseMapping, Rig, RigPose, canonical_rig
from lipwright.rig.mapping import MODES, SIGMA
from lipwright.rig.values import as_weights

Floats = npt.NDArray[np.float64]

NEARLY_SHUT: Final = 0.05
"""eye distances between the lips from which the poses alone say how open the mouth is; the mean
face has 0.062. Below it the rig nears its shut pose: between the mean and the pose of mode 1 that
shuts the mouth, the reference lips meet after a third of the way, and a rig after all of it"""
TOUCHING: Final = 0.01  # eye distances, up to which reference faces are drawn with shut lips


def pose_weights(p: npt.ArrayLike, poses: Sequence[RigPose]) -> Floats:
    """Equation 2: (T, n), how much of each of n poses p (T, M) standard deviations have.

    Modes beyond those of `p` are at the mean.
    """
    p = np.asarray(p, np.float64)
    weights = np.zeros((len(p), len(poses)))
    for column, pose in enumerate(poses):
        if pose.mode <= p.shape[1]:
            weights[:, column] = np.maximum(p[:, pose.mode - 1] / pose.sigma, 0.0)
    return weights


def apply_poses(clip: Clip, rig: Rig, mapping: PoseMapping) -> Clip:
    """Equation 3: the clip in the rig's controls, each within its range.

    Where the lips of the reference face come together, controls of the shut pose go there; controls
    with a row follow the canonical ones.

    Args:
        clip: canonical curves, or `shape1` and on in standard deviations of the mapping's
            reference.
        rig: what to move.
        mapping: its poses.

    Raises:
        LipwrightError: the clip has neither, or there is no such reference or mode of it.
    """
    shape = load_reference_shape(mapping.reference)
    check_modes(mapping, shape)
    mean = _controls(rig, mapping.mean, rig.rest.astype(np.float64))
    poses = [_controls(rig, pose.values, mean) for pose in mapping.poses]
    values = pose_weights(shape.parameters(clip), mapping.poses) @ (np.array(poses) - mean) + mean
    shut = np.array([name in mapping.shut for name in rig.names])
    if shut.any():
        share = (NEARLY_SHUT - shape.gap(clip)) / (NEARLY_SHUT - TOUCHING)
        values += np.clip(share, 0.0, 1.0)[:, None] * np.where(
            shut, _controls(rig, mapping.shut, mean) - values, 0.0
        )
    moved = Clip(rig.names, clip.fps, as_weights(values))
    if mapping.rows:
        besides = apply_linear(clip, rig, LinearMapping(mapping.rows))
        moved = moved.with_curves({name: besides.curve(name) for name in mapping.rows})
    return rig.fit(moved)


def check_modes(mapping: PoseMapping, shape: ReferenceShape) -> None:
    """Refuse poses of modes that the reference lacks.

    Raises:
        LipwrightError: there is one; names it.
    """
    for pose in mapping.poses:
        if pose.mode > len(shape):
            raise LipwrightError(
                f"a pose shows mode {pose.mode}, and {shape.name} has the modes 1 to {len(shape)}"
            )


def _controls(rig: Rig, values: Mapping[str, float], otherwise: Floats) -> Floats:
    """(C,), named values of the rig's controls, and `otherwise` (C,) for those left out."""
    row = otherwise.copy()
    for name, value in values.items():
        row[rig.names.index(name)] = value
    return row


@cache
def human_mapping(reference: str = PoseMapping.reference, modes: int = MODES) -> PoseMapping:
    """The poses of a reference on a human face: a mapping of the canonical rig.

    Raises:
        LipwrightError: there is no such reference.
    """
    human = load_reference_shape(reference).human
    poses = [
        RigPose(mode, sigma, {**dict.fromkeys(human[MEAN], 0.0), **human[label]})
        for mode in range(1, modes + 1)
        for sigma in (-SIGMA, SIGMA)
        if (label := f"mode{mode}{sigma:+g}") in human
    ]
    return PoseMapping(human[MEAN], tuple(poses), reference, human[SHUT])


def modes_to_canonical(clip: Clip, reference: str = PoseMapping.reference) -> Clip:
    """Curves of shape modes, `shape1` and on, as canonical controls: a model's face on any head.

    Raises:
        LipwrightError: the clip has no shape modes, or there is no such reference.
    """
    moved = apply_poses(clip, canonical_rig(), human_mapping(reference))
    return moved.select(CANONICAL)
