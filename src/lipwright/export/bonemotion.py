"""What of a performance moves blendshapes, and what moves bones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export.performance import ExportOptions, Performance
from lipwright.rig import CHANNELS, Bone

Floats = npt.NDArray[np.float64]

HEAD_NODE = "head"  # of our own head, as GLB calls it


@dataclass(frozen=True, eq=False)
class BoneMotion:
    """A bone in the axes of its parent: y up, z forward, +x to the character's own left."""

    path: str
    """the names from the root bone down to it, with / between them"""
    places: Floats | None
    """(T, 3) m; (1, 3) where it stays; None where no control of the clip is a translation of it"""
    turns: Floats | None
    """(T, 4) unit quaternions x, y, z, w; (1, 4) where it stays; None as with `places`"""

    @property
    def name(self) -> str:
        """Of the bone."""
        return self.path.rpartition("/")[2]


def scene_node(options: ExportOptions) -> str:
    """The name of the node that has the blendshapes: that of the character that a GLB shows."""
    own = HEAD_NODE if options.character is None else options.character.name
    return options.node or own


def bone_controls(performance: Performance) -> dict[str, tuple[Bone, str]]:
    """Control to its bone and channel, of the bones that the rig knows."""
    bones = () if performance.rig is None else performance.rig.bones
    known = {f"{bone.name}.{channel}": (bone, channel) for bone in bones for channel in CHANNELS}
    return {name: known[name] for name in performance.clip.names if name in known}


def shape_names(performance: Performance) -> tuple[str, ...]:
    """The controls that are blendshapes: neither bones nor turns of the head."""
    others = {*bone_controls(performance), *HEAD_ANGLES}
    return tuple(name for name in performance.clip.names if name not in others)


def without_bones(performance: Performance) -> Clip:
    """The clip without the controls of bones; turns of the head stay."""
    bones = bone_controls(performance)
    return performance.clip.select(n for n in performance.clip.names if n not in bones)


def check_moves(path: Path, performance: Performance) -> None:
    """Refuse a performance that moves neither a blendshape nor a bone.

    Raises:
        LipwrightError: it does not.
    """
    if not shape_names(performance) and not bone_controls(performance):
        raise LipwrightError(
            f"{path}: the curves move no blendshape and no bone; export them as CSV, or retarget "
            "them to a rig that has some"
        )


def rest_place(bone: Bone, bones: tuple[Bone, ...]) -> Floats:
    """(3,) m, where a bone is at rest in the axes of its parent."""
    parents = {other.name: np.array(other.at) for other in bones}
    return np.asarray(np.array(bone.at) - parents.get(bone.parent, np.zeros(3)))


def moved_bones(performance: Performance) -> Iterator[BoneMotion]:
    """The bones that the curves move, in the rig's order."""
    channels = bone_controls(performance)
    bones = () if performance.rig is None else performance.rig.bones
    paths: dict[str, str] = {}
    for bone in bones:
        above = paths.get(bone.parent)
        paths[bone.name] = f"{above}/{bone.name}" if above else bone.name
        kinds = {channel[0] for own, channel in channels.values() if own is bone}
        if kinds:
            values = _channels(performance, bone)
            yield BoneMotion(
                paths[bone.name],
                rest_place(bone, bones) + values[:, :3] if "t" in kinds else None,
                _turns(values[:, 3:]) if "r" in kinds else None,
            )


def _channels(performance: Performance, bone: Bone) -> Floats:
    """(T, 6) translations in m and rotations in degrees; (1, 6) where the bone stays."""
    clip = performance.clip.select([f"{bone.name}.{channel}" for channel in CHANNELS])
    values = clip.values.astype(np.float64)
    return values[:1] if (values == values[0]).all() else values


def _turns(angles: Floats) -> Floats:
    """(T, 4) quaternions of (T, 3) degrees."""
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_euler("xyz", angles, degrees=True).as_quat()
    # Two quaternions turn alike; neighbours on one side do not go the long way round.
    flips = np.cumprod(np.where((turns[1:] * turns[:-1]).sum(axis=1) < 0, -1.0, 1.0))
    turns[1:] *= flips[:, None]
    return np.asarray(turns)
