"""An artist's poses out of a GLB: one a frame or one a second.

Any animations will do: those of morph weights and of nodes are taken together, as programs write
them apart. Each pose is what the keys say at its time; between them linear. Bones are `NAME.tx` to
`NAME.rz`: m and degrees from the node's rest in its parent's axes, as `gltf_clip` reads them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.gltf_curves import multiply
from lipwright.export.gltf_file import GltfFile, read_gltf
from lipwright.export.gltf_names import Character, loose_name
from lipwright.export.gltf_rest import Rests
from lipwright.export.gltf_store import Json
from lipwright.rig import CHANNELS, Rig

Floats = npt.NDArray[np.float64]

SAME: Final = 1e-4  # s; keys that are closer are at one time
LEAST: Final = 1e-6  # weights, m or degrees; what changes by less is still
LISTED: Final = 12  # names that an error lists
PATHS: Final = ("weights", "translation", "rotation")


@dataclass(frozen=True, eq=False)
class _Keys:
    """What one channel moves."""

    node: int
    path: str
    times: Floats
    """(K,) s, rising"""
    values: Floats
    """(K, n)"""

    def at(self, times: Floats) -> Floats:
        """(T, n), linear between keys, held before the first and after the last."""
        columns = [np.interp(times, self.times, column) for column in self.values.T]
        return np.stack(columns, axis=1)


def read_pose_frames(path: Path, rig: Rig, counts: tuple[int, ...]) -> Clip:
    """The frames of a GLB or `.gltf` in a rig's controls, one a pose.

    Args:
        path: the file.
        rig: whose controls are looked for by their names, letter by letter or else loosely.
        counts: how many poses there may be.

    Raises:
        LipwrightError: the file cannot be used, has another number of frames, or moves none of the
            rig's controls.
    """
    file = read_gltf(path)
    character = Character(file)
    channels = _channels(file, character)
    times = _pose_times(path, channels, counts)
    curves = _curves(character, channels, times)
    found = _matched(curves, rig)
    if not any(map(_changes, found.values())):
        moved = [name for name, curve in curves.items() if _changes(curve)]
        raise LipwrightError(
            f"{path}: moves none of the controls of the rig {rig.name!r} "
            f"({', '.join(rig.names[:4])}...); it moves {_listed(moved)}"
        )
    return Clip(tuple(found), 1.0, np.stack(list(found.values()), axis=1).astype(np.float32))


def _changes(curve: Floats) -> bool:
    return bool(np.ptp(curve) > LEAST)


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(names[:LISTED]) + more if names else "nothing that has a name"


def _channels(file: GltfFile, character: Character) -> list[_Keys]:
    found: dict[tuple[int, str], _Keys] = {}
    for animation in file.tables("animations"):
        samplers = file.tables("samplers", animation, "an animation: ")
        for channel in file.tables("channels", animation, "an animation: "):
            target = file.table("target", channel)
            if "node" not in target or target.get("path") not in PATHS:
                continue
            node = file.index(target, "node", len(character.nodes), "an animation")
            number = file.index(channel, "sampler", len(samplers), "an animation")
            keys = _keys(file, character, samplers[number], node, target["path"])
            found.setdefault((node, target["path"]), keys)
    if not found:
        file.fail("it has no animation of morph targets or bones")
    return list(found.values())


def _keys(file: GltfFile, character: Character, sampler: Json, node: int, path: str) -> _Keys:
    count = len(file.tables("accessors"))
    times = file.accessor(file.index(sampler, "input", count, "a sampler"), "a sampler").ravel()
    values = file.accessor(file.index(sampler, "output", count, "a sampler"), "a sampler")
    width = {"weights": character.target_count(node), "translation": 3, "rotation": 4}[path]
    parts = 3 if sampler.get("interpolation") == "CUBICSPLINE" else 1  # slope, value, slope
    if not len(times) or not width or values.size != parts * len(times) * width:
        file.fail(f"a sampler has {values.size} numbers for {len(times)} keys of {width}")
    if not (np.isfinite(times).all() and np.isfinite(values).all() and (np.diff(times) > 0).all()):
        file.fail("a sampler's times do not rise, or its keys are no numbers")
    return _Keys(node, path, times, values.reshape(len(times), parts, width)[:, parts // 2])


def _pose_times(path: Path, channels: list[_Keys], counts: tuple[int, ...]) -> Floats:
    """(n,) s: the times of the keys where there are as many as poses, or else every second."""
    times = np.unique(np.concatenate([keys.times for keys in channels]))
    times = times[np.concatenate([[True], np.diff(times) > SAME])]
    if len(times) in counts:
        return times
    seconds = round(times[-1] - times[0])
    # The last frame may be held for a while, or stand one before the next second.
    if seconds + 1 in counts:
        return np.asarray(times[0] + np.arange(seconds + 1))
    wanted = " or ".join((", ".join(map(str, counts[:-1])), str(counts[-1])))
    raise LipwrightError(
        f"{path}: has keys at {len(times)} times over {times[-1] - times[0]:.1f} s; set {wanted} "
        "poses, one a frame or one a second"
    )


def _curves(character: Character, channels: list[_Keys], times: Floats) -> dict[str, Floats]:
    """Morph target, or bone and channel, to its values (n,)."""
    rests = Rests(character)
    curves: dict[str, Floats] = {}
    for keys in channels:
        values = keys.at(times)
        node = character.nodes[keys.node]
        if keys.path == "weights":
            names: list[str] = list(character.targets[node["mesh"]])
        else:
            letter = slice(0, 3) if keys.path == "translation" else slice(3, 6)
            bone = character.file.name(node)
            names = [f"{bone}.{channel}" if bone else "" for channel in CHANNELS[letter]]
            values = _from_rest(rests, keys, values)
        for name, column in zip(names, values.T, strict=True):
            if name:
                curves.setdefault(name, column)
    return curves


def _from_rest(rests: Rests, keys: _Keys, values: Floats) -> Floats:
    """(n, 3) m or degrees that a node is moved or turned from its rest, in its parent's axes."""
    from scipy.spatial.transform import Rotation

    if keys.path == "translation":
        return (values - rests.translation(keys.node)) * rests.parent_scale(keys.node)
    lengths = np.linalg.norm(values, axis=1, keepdims=True)
    if not lengths.min() > 0:
        rests.file.fail(f"node {keys.node} has a rotation of length 0")
    turns = multiply(values / lengths, rests.rotation(keys.node) * [-1, -1, -1, 1])
    return np.asarray(Rotation.from_quat(turns).as_euler("xyz", degrees=True))


def _matched(curves: dict[str, Floats], rig: Rig) -> dict[str, Floats]:
    """The rig's controls that the file moves."""
    loose = {_loose(name): name for name in reversed(curves)}
    found = {}
    for control in rig.names:
        name = control if control in curves else loose.get(_loose(control))
        if name is not None:
            found[control] = curves[name]
    return found


def _loose(name: str) -> str:
    bone, _, channel = name.rpartition(".")
    return f"{loose_name(bone)}.{channel}" if channel in CHANNELS else loose_name(name)
