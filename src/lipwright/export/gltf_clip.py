"""The curves of a glTF animation: morph targets by name, bones by that of their node.

Read is the last animation that Lipwright wrote, or else the first that moves morph targets or
bones. Keys are sampled at the frames a second that its `extras` or the asset's `extras.fps` say, or
at 60, as glTF 2.0 (Appendix C) lays down for STEP, LINEAR and CUBICSPLINE. A bone's six controls
are its translation beside that at rest in m, and its rotation from that at rest in degrees, in the
axes of its parent; the node that Lipwright turned with the head gives the angles of the head. In a
VRM animation the x of an expression's node is its weight.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import MAX_FPS, Clip, frame_times
from lipwright.controls import HEAD_ANGLES
from lipwright.export.gltf_curves import MARK, multiply
from lipwright.export.gltf_file import GltfFile, is_number, read_gltf
from lipwright.export.gltf_names import Character
from lipwright.export.gltf_rest import Rests
from lipwright.export.gltf_store import Json
from lipwright.export.jsonclip import check_names
from lipwright.export.performance import PathLike
from lipwright.keys import hermite
from lipwright.rig.values import CHANNELS

Floats = npt.NDArray[np.float64]

VRMA: Final = "VRMC_vrm_animation"
USUAL_FPS: Final = 60.0  # of files that say none
MAX_VALUES: Final = 2**28  # of a clip, a gigabyte
ROUNDING: Final = 2.0**-23  # of a number as float32, twice the most
PATHS: Final = ("weights", "translation", "rotation")
INTERPOLATIONS: Final = ("LINEAR", "STEP", "CUBICSPLINE")


@dataclass(frozen=True, eq=False)
class _Sampler:
    times: Floats
    """(K,) s, rising"""
    keys: Floats
    """(K, n), or (K, 3, n) with slopes before and after"""
    interpolation: str

    def snapped(self, fps: float) -> _Sampler:
        """With the times of frames that float32 has rounded as they were."""
        frames = np.round(self.times * fps) / fps
        near = np.abs(frames - self.times) <= ROUNDING * np.abs(frames)
        return replace(self, times=np.where(near, frames, self.times))

    def at(self, times: Floats, turns: bool = False) -> Floats:
        """(T, n), held before the first key and after the last; `turns` are unit quaternions."""
        middle = self.keys[:, 1] if self.interpolation == "CUBICSPLINE" else self.keys
        if len(self.times) == 1:
            return np.repeat(middle, len(times), axis=0)
        when = np.clip(times, self.times[0], self.times[-1])
        left = np.searchsorted(self.times, when, side="right") - 1
        if self.interpolation == "STEP":
            return middle[left]
        left = np.clip(left, 0, len(self.times) - 2)
        span = (self.times[left + 1] - self.times[left])[:, None]
        u = np.clip((when - self.times[left])[:, None] / span, 0.0, 1.0)
        if self.interpolation == "CUBICSPLINE":
            out, into = self.keys[left, 2] * span, self.keys[left + 1, 0] * span
            return hermite(u, middle[left], middle[left + 1], out, into)
        if turns:
            return _slerp(u, middle[left], middle[left + 1])
        return (1 - u) * middle[left] + u * middle[left + 1]


def _slerp(u: Floats, start: Floats, end: Floats) -> Floats:
    """(T, 4), the shorter way round between unit quaternions."""
    cosine = np.sum(start * end, axis=1, keepdims=True)
    end = np.where(cosine < 0, -end, end)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    sine = np.sin(angle)
    near = sine < 1e-6
    safe = np.where(near, 1.0, sine)
    first = np.where(near, 1 - u, np.sin((1 - u) * angle) / safe)
    second = np.where(near, u, np.sin(u * angle) / safe)
    return np.asarray(first * start + second * end)


def read_clip_gltf(path: PathLike) -> Clip:
    """The clip of a GLB, `.gltf` or VRMA.

    Raises:
        LipwrightError: the file cannot be used, or moves nothing that has a name.
    """
    file = read_gltf(path)
    character = Character(file)
    animation = _choose(file)
    mark = file.table(MARK, file.table("extras", animation))
    samplers: dict[tuple[int, str, int], _Sampler] = {}
    channels: dict[tuple[int, str], _Sampler] = {}
    for channel in file.tables("channels", animation, "an animation: "):
        target = file.table("target", channel)
        if "node" not in target or target.get("path") not in PATHS:
            continue
        node = file.index(target, "node", len(character.nodes), "an animation")
        listed = file.tables("samplers", animation, "an animation: ")
        number = file.index(channel, "sampler", len(listed), "an animation")
        moved = str(target["path"])
        use = (number, moved, character.target_count(node))  # several channels may share a sampler
        if use not in samplers:
            samplers[use] = _sampler(file, listed[number], character, node, moved)
        channels[node, moved] = samplers[use]
    fps = _rate(file, mark)
    channels = {place: sampler.snapped(fps) for place, sampler in channels.items()}
    duration = max((sampler.times[-1] for sampler in channels.values()), default=0.0)
    if duration * fps * max(len(channels), 1) > MAX_VALUES:
        file.fail(f"its animation lasts {duration:.0f} s")
    times = frame_times(max(duration, 0.0), fps)
    curves = _curves(character, channels, times, mark.get("head"))
    if not curves:
        file.fail("its animations move no morph target or bone that has a name")
    check_names(path, curves)
    if len(curves) * len(times) > MAX_VALUES:
        file.fail(f"its animation has {len(curves)} curves of {duration:.0f} s")
    values = np.stack(list(curves.values()), axis=1)
    if not np.abs(values).max(initial=0) < 1e30:
        file.fail("its curves have values that are no numbers")
    return Clip(tuple(curves), fps, values.astype(np.float32))


def _choose(file: GltfFile) -> Json:
    moving = [
        animation
        for animation in file.tables("animations")
        if any(
            file.table("target", channel).get("path") in PATHS
            for channel in file.tables("channels", animation, "an animation: ")
        )
    ]
    if not moving:
        file.fail("it has no animation of morph targets or bones")
    ours = [item for item in moving if MARK in file.table("extras", item)]
    return ours[-1] if ours else moving[0]


def _rate(file: GltfFile, mark: Json) -> float:
    for holder in (mark, file.table("extras", file.table("asset"))):
        fps = holder.get("fps")
        if is_number(fps) and 0 < fps <= MAX_FPS:
            return float(fps)
    return USUAL_FPS


def _sampler(file: GltfFile, item: Json, character: Character, node: int, path: str) -> _Sampler:
    interpolation = item.get("interpolation", "LINEAR")
    if interpolation not in INTERPOLATIONS:
        file.fail(f"the interpolation {str(interpolation)[:24]!r} is unknown")
    count = len(file.tables("accessors"))
    times = file.accessor(file.index(item, "input", count, "a sampler"), "a sampler")[:, 0]
    keys = file.accessor(file.index(item, "output", count, "a sampler"), "a sampler")
    width = {"weights": character.target_count(node), "translation": 3, "rotation": 4}[path]
    rows = 3 * len(times) if interpolation == "CUBICSPLINE" else len(times)
    if not len(times) or keys.size != rows * width or not width:
        file.fail(f"a sampler has {keys.size} numbers for {len(times)} keys of {width}")
    if not (np.isfinite(times).all() and np.isfinite(keys).all() and (np.diff(times) > 0).all()):
        file.fail("a sampler's times do not rise, or its keys are no numbers")
    shape = (len(times), 3, width) if interpolation == "CUBICSPLINE" else (len(times), width)
    return _Sampler(times, keys.reshape(shape), interpolation)


def _curves(
    character: Character,
    channels: dict[tuple[int, str], _Sampler],
    times: Floats,
    head: object,
) -> dict[str, Floats]:
    """Control to its values (T,)."""
    curves: dict[str, Floats] = {}
    rests, expressions = Rests(character), _expressions(character)
    for (node, path), sampler in channels.items():
        values = sampler.at(times, turns=path == "rotation")
        name = character.file.name(character.nodes[node])
        if path == "weights":
            targets = character.targets[character.nodes[node]["mesh"]]
            for target, column in zip(targets, values.T, strict=True):
                if target:
                    curves.setdefault(target, column)
        elif path == "rotation" and node == head:
            angles = head_angles(_turned(values, rests, node))
            curves |= dict(zip(HEAD_ANGLES, angles.T, strict=True))
        elif path == "translation" and node in expressions:
            curves.setdefault(expressions[node], values[:, 0])
        elif name:
            three = (
                (values - rests.translation(node)) * rests.parent_scale(node)
                if path == "translation"
                else _degrees(_turned(values, rests, node, in_scene=False))
            )
            for channel, column in zip(
                CHANNELS[:3] if path == "translation" else CHANNELS[3:], three.T, strict=True
            ):
                curves.setdefault(f"{name}.{channel}", column)
    return curves


def _expressions(character: Character) -> dict[int, str]:
    """The nodes that stand for expressions in a VRM animation."""
    file = character.file
    both = file.table("expressions", file.table(VRMA, file.table("extensions")))
    return {
        file.index(item, "node", len(character.nodes), f"the expression {name[:40]!r}"): name
        for kind in ("custom", "preset")
        for name, item in file.table(kind, both).items()
        if name and isinstance(item, dict)
    }


def _turned(values: Floats, rests: Rests, node: int, in_scene: bool = True) -> Floats:
    """(T, 4), the turns from rest, about the axes of the scene or of the parent."""
    lengths = np.linalg.norm(values, axis=1, keepdims=True)
    if not lengths.min() > 0:
        rests.file.fail(f"node {node} has a rotation of length 0")
    turn = multiply(values / lengths, rests.rotation(node) * [-1, -1, -1, 1])
    if not in_scene:
        return turn
    parent = rests.parent_turn(node)
    return multiply(multiply(parent, turn), parent * [-1, -1, -1, 1])


def head_angles(turns: Floats) -> Floats:
    """(T, 3), yaw, pitch and roll in radians of unit quaternions; see `face.turning`."""
    x, y, z, w = turns.T
    yaw = np.arctan2(2 * (w * y + x * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * x - y * z), -1, 1))
    roll = np.arctan2(2 * (w * z + x * y), 1 - 2 * (x * x + z * z))
    return np.stack([yaw, -pitch, roll], axis=1)


def _degrees(turns: Floats) -> Floats:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_quat(turns).as_euler("xyz", degrees=True))
