"""The Blender add-on, in a Python that has bpy.

That is this one, the one that LIPWRIGHT_BPY_PYTHON names, or .venv-bpy beside the tests.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tomllib
import wave as wavefile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine_clips import BOUND, jaw_of_bones, waves
from lipwright.export import ExportOptions, export_all, export_clip

ROOT = Path(__file__).parents[1]
ADDON = ROOT / "integrations" / "blender" / "lipwright_import"

# Runs in Blender: builds a scene, imports the clips that argv names, prints what came of them.
DRIVER = r"""
import json, sys
from pathlib import Path
import bpy
import numpy as np

sys.path.insert(0, sys.argv[1])
import lipwright_import

lipwright_import.register()
folder = Path(sys.argv[2])


def scene(fps=24):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = fps


def face(*names, name="face"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    for key in ("Basis", *names):
        thing.shape_key_add(name=key)
    thing.select_set(True)
    return thing


def load(file, **options):
    try:
        result = bpy.ops.import_anim.lipwright(filepath=str(folder / file), **options)
        return {"result": list(result), "error": ""}
    except RuntimeError as error:
        return {"result": ["CANCELLED"], "error": str(error)}


def curves(block):
    data = block.animation_data
    made = data.action
    if hasattr(data, "action_slot"):
        made = made.layers[0].strips[0].channelbag(data.action_slot)
    return {(f.data_path, f.array_index): f for f in made.fcurves}


def strips():
    editor = bpy.context.scene.sequence_editor
    return editor.strips if hasattr(editor, "strips") else editor.sequences


def told(block, name, frames):
    curve = curves(block)['key_blocks["%s"].value' % name, 0]
    return {
        "keys": len(curve.keyframe_points),
        "first": curve.keyframe_points[0].co[0],
        "kind": curve.keyframe_points[0].interpolation,
        "values": [curve.evaluate(frame) for frame in frames],
    }


found = {"hears": bpy.app.build_options.audaspace}
for file in ("every.json", "few.json"):
    scene(fps=24)
    thing = face("jawOpen", "Mouth_Close", "other")
    before = load(file, start=10)
    frames = 10 + np.arange(600) / 60 * 24
    keys = thing.data.shape_keys
    found[file] = before | {
        "jaw": told(keys, "jawOpen", frames),
        "mouth": told(keys, "Mouth_Close", frames),
        "action": keys.animation_data.action.name,
        "end": bpy.context.scene.frame_end,
        "fps": bpy.context.scene.render.fps / bpy.context.scene.render.fps_base,
        "strips": [
            (s.type, s.name, s.frame_final_start)
            for s in strips()
        ],
    }
    load(file, start=10)
    found[file]["strips_again"] = len(strips())

scene(fps=24)
thing = face("jawOpen")
found["rate"] = load("odd rate.json", set_rate=True) | {
    "fps": bpy.context.scene.render.fps / bpy.context.scene.render.fps_base,
    "values": told(thing.data.shape_keys, "jawOpen", 1 + np.arange(150)),
}

scene()
first, second = face("jawOpen", name="one"), face("mouthClose", name="two")
found["two"] = load("every.json") | {
    "slots": hasattr(first.data.shape_keys.animation_data, "action_slot"),
    "actions": [t.data.shape_keys.animation_data.action.name for t in (first, second)],
}

scene()
face("smile")
found["none"] = load("every.json")
scene()
face("jawOpen")
found["newer"] = load("newer.json")
found["wrong"] = load("wrong.json")
found["damaged"] = load("damaged.json")

scene(fps=30)
thing = face("wide")
block = thing.data.shape_keys.key_blocks["wide"]
load("wide.json")
found["wide"] = [block.slider_min, block.slider_max]

scene(fps=30)
data = bpy.data.armatures.new("rig")
puppet = bpy.data.objects.new("rig", data)
bpy.context.scene.collection.objects.link(puppet)
bpy.context.view_layer.objects.active = puppet
bpy.ops.object.mode_set(mode="EDIT")
head = data.edit_bones.new("head")
head.head, head.tail, head.roll = (0, 0, 0.1), (0, 0.02, 0.3), 0.4
jaw = data.edit_bones.new("jaw")
jaw.head, jaw.tail, jaw.roll, jaw.parent = (0.01, -0.02, 0.06), (0.0, -0.1, 0.02), 1.1, head
bpy.ops.object.mode_set(mode="OBJECT")
puppet.select_set(True)
face_too = face("smile")
result = load("bones.json", add_sound=False)
matrices = []
for frame in range(40):
    bpy.context.scene.frame_set(frame + 1)
    matrices.append([list(row) for row in puppet.pose.bones["jaw"].matrix])
found["bones"] = result | {
    "matrices": matrices,
    "rest": [list(row) for row in data.bones["jaw"].matrix_local],
    "smile": told(face_too.data.shape_keys, "smile", 1 + np.arange(40)),
}
lipwright_import.unregister()
(folder / "found.json").write_text(json.dumps(found))
"""


def blender_python() -> str:
    """The Python that has bpy."""
    named = os.environ.get("LIPWRIGHT_BPY_PYTHON")
    if named:
        return named
    if importlib.util.find_spec("bpy") is not None:
        return sys.executable
    beside = ROOT / ".venv-bpy" / "bin" / "python"
    if beside.exists():
        return str(beside)
    pytest.skip("bpy is not installed, and LIPWRIGHT_BPY_PYTHON names no Python that has it")


CLIP = waves("jawOpen", "mouthClose", frames=600, still="unknown")
ODD_RATE = waves("jawOpen", fps=29.97)
WIDE = waves("wide", fps=30, still="")


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the add-on made of clips."""
    program = blender_python()
    folder = tmp_path_factory.mktemp("blender")
    export_clip(folder / "every.json", CLIP)
    export_clip(folder / "few.json", CLIP, options=ExportOptions(keys=BOUND))
    export_clip(folder / "odd rate.json", ODD_RATE)
    export_clip(folder / "wide.json", WIDE.with_values(WIDE.values * 4 - 1))
    export_all(folder / "bones.json", jaw_of_bones())
    (folder / "newer.json").write_text('{"format": "lipwright-clip", "version": 3}')
    (folder / "wrong.json").write_text("[]")
    (folder / "damaged.json").write_text(
        '{"format": "lipwright-clip", "version": 1, "fps": 60, "names": ["a"], "values": [[1, 2]]}'
    )
    for name in ("every", "few"):
        with wavefile.open(str(folder / f"{name}.wav"), "wb") as sound:
            sound.setparams((1, 2, 16000, 0, "NONE", ""))
            sound.writeframes(bytes(32000 * 10))
    (folder / "driver.py").write_text(DRIVER)
    command = [program, "-W", "ignore", str(folder / "driver.py"), str(ADDON.parent), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((folder / "found.json").read_text())


@pytest.mark.parametrize(("file", "bound"), [("every.json", 1e-4), ("few.json", BOUND)])
def test_shape_keys_follow_the_clip_in_time_with_the_sound(
    found: dict[str, Any], file: str, bound: float
) -> None:
    told = found[file]
    assert told["result"] == ["FINISHED"]
    for name, control in (("jaw", "jawOpen"), ("mouth", "mouthClose")):
        assert np.abs(np.array(told[name]["values"]) - CLIP.curve(control)).max() <= bound
        assert told[name]["first"] == 10
    assert told["action"] == Path(file).stem
    assert (told["fps"], told["end"]) == (24, 250)
    strips = [["SOUND", f"{Path(file).stem}.wav", 10]] if found["hears"] else []
    assert told["strips"] == strips
    assert told["strips_again"] == len(strips)


def test_few_keys_stay_few_and_have_handles(found: dict[str, Any]) -> None:
    assert (found["every.json"]["jaw"]["keys"], found["every.json"]["jaw"]["kind"]) == (
        600,
        "LINEAR",
    )
    assert found["few.json"]["jaw"]["keys"] < 600 / 8
    assert found["few.json"]["jaw"]["kind"] == "BEZIER"


def test_the_scene_takes_the_rate_where_that_is_wanted(found: dict[str, Any]) -> None:
    told = found["rate"]
    assert told["fps"] == pytest.approx(29.97)
    np.testing.assert_allclose(told["values"]["values"], ODD_RATE.curve("jawOpen"), atol=1e-4)


def test_one_action_moves_all_objects(found: dict[str, Any]) -> None:
    one = found["two"]["slots"]  # Blender before 4.4 has an action for each
    assert found["two"]["actions"] == ["every", "every" if one else "every.001"]


def test_what_cannot_be_used_is_said_in_one_line(found: dict[str, Any]) -> None:
    for case, words in (
        ("none", "nothing that is selected has shape keys or bones of the names jawOpen"),
        ("newer", "newer.json: is of version 3; update this add-on"),
        ("wrong", "wrong.json: is no Lipwright clip"),
        ("damaged", "damaged.json: is damaged (its rows are not of one value a name)"),
    ):
        assert found[case]["result"] == ["CANCELLED"]
        assert words in found[case]["error"]


def test_the_range_of_a_shape_key_is_widened(found: dict[str, Any]) -> None:
    values = WIDE.values * 4 - 1
    np.testing.assert_allclose(found["wide"], [values.min(), values.max()], atol=1e-4)


def test_bones_move_in_the_axes_of_the_character(found: dict[str, Any]) -> None:
    clip = jaw_of_bones().clip
    ours = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # y up, z forward to z up, -y forward
    rest = np.array(found["bones"]["rest"])
    matrices = np.array(found["bones"]["matrices"])
    angles = np.stack([clip.curve("jaw.rx"), np.zeros(len(clip)), clip.curve("jaw.rz")], axis=1)
    turns = ours @ Rotation.from_euler("xyz", angles, degrees=True).as_matrix() @ ours.T
    np.testing.assert_allclose(matrices[:, :3, :3], turns @ rest[:3, :3], atol=1e-5)
    moves = np.stack([np.zeros(len(clip)), np.zeros(len(clip)), clip.curve("jaw.tz")], axis=1)
    np.testing.assert_allclose(matrices[:, :3, 3], rest[:3, 3] + moves @ ours.T, atol=1e-5)
    np.testing.assert_allclose(found["bones"]["smile"]["values"], clip.curve("smile"), atol=1e-4)


def test_the_manifest_names_the_add_on_and_its_licence() -> None:
    manifest = tomllib.loads((ADDON / "blender_manifest.toml").read_text())
    assert manifest["id"] == ADDON.name
    assert manifest["license"] == ["SPDX:Apache-2.0"]
    assert manifest["blender_version_min"] == "4.2.0"
    assert all(len(words) <= 64 for words in manifest["permissions"].values())
