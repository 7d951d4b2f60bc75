"""CSV table of bones: `time` in s, and six columns a bone.

What the MOTION of a BVH file holds, as a table with names, for engines and scripts that set bones
themselves. `NAME.x`, `NAME.y`, `NAME.z` are the place of the bone in its parent in m (at rest the
way from the parent's place to its own, unlike the controls `NAME.tx` of a clip, which are 0), and
`NAME.rx`, `NAME.ry`, `NAME.rz` its rotation in degrees about the axes of the parent, about x first,
then y, then z. y is up, z forward, +x to the character's own left. Turns of the head are in the
bone `head`. One row a frame.

Places are rounded to a thousandth of a millimetre, angles to a ten-thousandth of a degree, times to
a millionth of a second.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.face.skeleton import Floats, Skeleton
from lipwright.retarget.skinned import bone_channels, whole_turns
from lipwright.rig import Rig

COLUMNS: Final = ("x", "y", "z", "rx", "ry", "rz")
FORMAT: Final = ",".join(["%.6f"] * 3 + ["%.4f"] * 3)  # of a bone: m and degrees
BLOCK: Final = 2000  # frames that are formatted at once


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: the performance is in a rig without bones.
    """
    del options
    rig = rig_with_bones(path, performance)
    return [text_output(path, lambda: _lines(performance, rig))]


def rig_with_bones(path: Path, performance: Performance) -> Rig:
    """The rig of a performance.

    Raises:
        LipwrightError: it has no bones.
    """
    rig = performance.rig
    if rig is None or not rig.bones:
        whose = (
            "the curves are not those of bones" if rig is None else f"the rig {rig.name!r} has none"
        )
        raise LipwrightError(f"{path}: needs bones, and {whose}; retarget them with: --rig bones")
    return rig


def _lines(performance: Performance, rig: Rig) -> Iterator[str]:
    clip = performance.clip
    head = io.StringIO()
    writer = csv.writer(head, lineterminator="\n")
    writer.writerow(["time", *(f"{bone.name}.{c}" for bone in rig.bones for c in COLUMNS)])
    yield head.getvalue()
    form = "%.6f," + ",".join([FORMAT] * len(rig.bones)) + "\n"
    rows = np.column_stack([clip.times, bone_values(performance, rig).reshape(len(clip), -1)])
    for first in range(0, len(rows), BLOCK):
        block = rows[first : first + BLOCK]
        yield (form * len(block)) % tuple(block.ravel().tolist())


def bone_values(performance: Performance, rig: Rig) -> Floats:
    """(T, B, 6): places in the parent in m and rotations in degrees, with turns of the head."""
    clip = performance.clip
    channels, turns = bone_channels(clip, rig), whole_turns(clip)
    skeleton = Skeleton.of(rig.bones)
    values = channels.copy()
    values[..., :3] += skeleton.offsets
    if turns is not None:
        values[:, skeleton.turning] = _turned(skeleton, channels, turns)
    return values + 0.0  # no -0.0


def _turned(skeleton: Skeleton, channels: Floats, turns: Floats) -> Floats:
    """(T, n, 6) of the n bones that turn with the head."""
    from scipy.spatial.transform import Rotation

    rotations, places = (part[:, skeleton.turning] for part in skeleton.joints(channels, turns))
    angles = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_euler("xyz", degrees=True)
    unbroken = np.unwrap(angles.reshape(*places.shape), period=360.0, axis=0)
    return np.concatenate([places, unbroken], axis=-1)
