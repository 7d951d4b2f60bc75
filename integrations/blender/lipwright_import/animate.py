"""Puts the curves of a clip onto shape keys and bones, and its sound into the sequencer."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np

from .clipfile import ClipFile, Curve

CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")  # of a bone: m, then degrees, turned x, y, z
SOUNDS = (".wav", ".flac", ".ogg", ".mp3")
LINEAR, BEZIER = 1, 2  # numbers of Blender's interpolations
FREE, ALIGNED = 0, 3  # numbers of Blender's types of handles
WIDEST = 10.0  # of the range of a shape key; Blender has no wider one
# Lipwright's axes (y up, z forward) in Blender's (z up, -y forward), as glTF files come in.
AXES = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


@dataclass(frozen=True)
class Placing:
    """Where a clip goes in a scene."""

    start: int
    """frame of the scene"""
    set_rate: bool
    set_range: bool
    add_sound: bool


@dataclass
class Done:
    """What became of the controls of a clip."""

    moved: set[str] = field(default_factory=set)
    missing: list[str] = field(default_factory=list)
    silent: str = ""
    """why the sound is not there, where it should be"""


class Writer:
    """Makes actions for what moves; one for all where Blender has slots (4.4 and later)."""

    def __init__(self, name: str, start: float, rate: float) -> None:
        """Actions of this name; times in s become frames from `start` on at `rate` a second."""
        self.name, self.start, self.rate = name, start, rate
        self.action = None

    def curves(self, block):
        """The empty F-curves of a data block; the action that it had is kept in the file."""
        data = block.animation_data or block.animation_data_create()
        if data.action is not None:
            data.action.use_fake_user = True
        slots = "slots" in bpy.types.Action.bl_rna.properties
        if self.action is None or not slots:
            self.action = bpy.data.actions.new(self.name)
        data.action = self.action
        if not slots:
            return self.action.fcurves
        slot = self.action.slots.new(id_type=block.id_type, name=block.name)
        data.action_slot = slot
        layers = self.action.layers
        layer = layers[0] if len(layers) else layers.new(self.name)
        strip = layer.strips[0] if len(layer.strips) else layer.strips.new(type="KEYFRAME")
        return strip.channelbag(slot, ensure=True).fcurves

    def write(self, curves, path: str, curve: Curve, index: int = 0) -> None:
        """One F-curve, all its keys at once."""
        made = curves.new(path, index=index)
        points = made.keyframe_points
        count = len(curve.times)
        points.add(count)
        frames = self.start + curve.times * self.rate
        points.foreach_set("co", np.stack([frames, curve.values], axis=1).ravel())
        points.foreach_set(
            "interpolation", np.full(count, LINEAR if curve.slopes is None else BEZIER)
        )
        if curve.slopes is not None and count > 1:
            self._set_handles(points, curve)
        made.update()

    def _set_handles(self, points, curve: Curve) -> None:
        """A third of the way to the neighbours; outside the first and last key as inside."""
        frames = self.start + curve.times * self.rate
        slopes = curve.slopes.copy()
        slopes[0, 0], slopes[-1, 1] = slopes[0, 1], slopes[-1, 0]
        thirds = np.pad(np.diff(curve.times) / 3, 1, mode="edge")
        kinds = np.where(np.isclose(slopes[:, 0], slopes[:, 1]), ALIGNED, FREE)
        for side, reach, slope in (
            ("left", -thirds[:-1], slopes[:, 0]),
            ("right", thirds[1:], slopes[:, 1]),
        ):
            places = np.stack([frames + reach * self.rate, curve.values + reach * slope], axis=1)
            points.foreach_set(f"handle_{side}_type", kinds)
            points.foreach_set(f"handle_{side}", places.ravel())


def animate(context, clip: ClipFile, path: Path, placing: Placing) -> Done:
    """Animate what is selected."""
    scene = context.scene
    if placing.set_rate:
        scene.render.fps = max(round(clip.fps), 1)
        scene.render.fps_base = scene.render.fps / clip.fps
    rate = scene.render.fps / scene.render.fps_base
    writer = Writer(path.stem, placing.start, rate)
    done = Done()
    seen = set()
    for thing in context.selected_objects:
        keys = getattr(thing.data, "shape_keys", None)
        if keys is not None and keys.as_pointer() not in seen:
            seen.add(keys.as_pointer())
            done.moved |= _move_shapes(keys, clip, writer)
        if thing.type == "ARMATURE":
            done.moved |= _move_bones(thing, clip, writer)
    done.missing = [name for name in clip.curves if name not in done.moved]
    if done.moved:
        last = placing.start + (clip.frames - 1) / clip.fps * rate
        if placing.set_range:
            scene.frame_end = max(scene.frame_end, int(np.ceil(last)))
        if placing.add_sound:
            try:
                _add_sound(scene, path, placing.start)
            except RuntimeError as error:  # no such sound, or a Blender built without sound
                done.silent = str(error).strip().removeprefix("Error: ")
    return done


def matched(wanted: str, names) -> str | None:
    """The one of `names` that is meant; capitals, spaces and underscores need not be the same."""
    if wanted in names:
        return wanted
    same = [name for name in names if _bare(name) == _bare(wanted)]
    return same[0] if len(same) == 1 else None


def _bare(name: str) -> str:
    return "".join(letter for letter in name.casefold() if letter.isalnum())


def _move_shapes(keys, clip: ClipFile, writer: Writer) -> set[str]:
    shapes = {shape.name: shape for shape in keys.key_blocks if shape != keys.reference_key}
    found = {name: matched(name, shapes) for name in clip.curves}
    found = {name: shape for name, shape in found.items() if shape is not None}
    if not found:
        return set()
    curves = writer.curves(keys)
    taken = {}
    for name, shape in found.items():
        if taken.setdefault(shape, name) != name:
            continue  # two spellings of one shape key: the first has it
        curve, block = clip.curves[name], shapes[shape]
        # Blender holds the weight within the range of the slider.
        block.slider_min = max(min(block.slider_min, curve.values.min()), -WIDEST)
        block.slider_max = min(max(block.slider_max, curve.values.max()), WIDEST)
        writer.write(curves, f'key_blocks["{bpy.utils.escape_identifier(shape)}"].value', curve)
    return set(taken.values())


def _move_bones(armature, clip: ClipFile, writer: Writer) -> set[str]:
    """Bones by the channels `NAME.tx` to `NAME.rz`, one key a frame."""
    moved: set[str] = set()
    curves = None
    for name in dict.fromkeys(control.rpartition(".")[0] for control in clip.curves):
        channels = [f"{name}.{channel}" for channel in CHANNELS]
        bone = matched(name, armature.pose.bones.keys()) if name else None
        if bone is None or not set(channels) & set(clip.curves):
            continue
        curves = writer.curves(armature) if curves is None else curves
        times = np.arange(clip.frames) / clip.fps
        still = Curve(np.zeros(1), np.zeros(1))
        values = np.stack([clip.curves.get(c, still).at(times) for c in channels], axis=1)
        pose = armature.pose.bones[bone]
        pose.rotation_mode = "QUATERNION"
        path = f'pose.bones["{bpy.utils.escape_identifier(bone)}"]'
        rest = np.array(pose.bone.matrix_local.to_3x3()).T @ AXES
        for index, column in enumerate((values[:, :3] @ rest.T).T):
            writer.write(curves, f"{path}.location", Curve(times, column), index)
        for index, column in enumerate(_turns(values[:, 3:], rest).T):
            writer.write(curves, f"{path}.rotation_quaternion", Curve(times, column), index)
        moved |= set(channels) & set(clip.curves)
    return moved


def _turns(degrees: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """(T, 4) quaternions w, x, y, z in the axes of a bone, of turns about x, then y, then z."""
    total = np.tile([1.0, 0, 0, 0], (len(degrees), 1))
    for axis in range(3):
        half = np.radians(degrees[:, axis]) / 2
        turn = np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * rest[:, axis]], 1)
        total = _product(turn, total)
    return total


def _product(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Products of quaternions, (T, 4) each; the right one turns first."""
    w, v = left[:, :1], left[:, 1:]
    x, u = right[:, :1], right[:, 1:]
    real = w * x - (v * u).sum(axis=1, keepdims=True)
    return np.concatenate([real, w * u + x * v + np.cross(v, u)], axis=1)


def _add_sound(scene, path: Path, start: int) -> None:
    """The sound of the file's name, on a channel above all others, once."""
    sound = next((path.with_suffix(s) for s in SOUNDS if path.with_suffix(s).is_file()), None)
    if sound is None:
        return
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences  # 4.4, 4.2
    if any(strip.type == "SOUND" and strip.name == sound.name for strip in strips):
        return
    channel = max((strip.channel for strip in strips), default=0) + 1
    strips.new_sound(sound.name, str(sound), channel, start)
    scene.sync_mode = "AUDIO_SYNC"
