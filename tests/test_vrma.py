"""VRM animations as three-vrm plays them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine_clips import jaw_of_bones
from lipwright.clip import Clip
from lipwright.controls import ARKIT, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all, read_clip
from lipwright.export.vrma import GAZE, PRESETS, clip_to_vrma
from lipwright.face.turning import head_rotations
from lipwright.retarget import retarget
from lipwright.rig import Control, Rig, load_rig
from made_gltf import HUMANOID, from_glb
from reading_gltf import Reader, reader

__all__ = ["reader"]

KEYS = 0.01


def speech(frames: int = 91) -> Clip:
    """Canonical curves and turns of the head."""
    times = np.arange(frames)[:, None] / 60
    waves = 0.5 - 0.5 * np.cos(times * np.linspace(2, 9, len(ARKIT)))
    turns = 0.3 * np.sin(times * [2, 3, 4])
    return Clip(ARKIT + HEAD_ANGLES, 60, np.hstack([waves, turns]))


def written(folder: Path, performance: Performance, keys: float | None = None) -> bytes:
    export_all([folder / "a.vrma"], performance, options=ExportOptions(keys=keys))
    return (folder / "a.vrma").read_bytes()


def test_expressions_have_the_clips_times_and_weights(tmp_path: Path, reader: Reader) -> None:
    clip = retarget(speech(), load_rig("vrm1"))
    reader.load(written(tmp_path, Performance(speech())))
    (animation,) = reader.call("vrma")
    assert animation["duration"] == pytest.approx(clip.duration, abs=0.5 / clip.fps)
    assert set(animation["preset"]) == set(load_rig("vrm1").names) - GAZE
    assert not animation["custom"]
    for name, track in animation["preset"].items():
        curve = clip.curve(name)
        if np.ptp(curve) == 0:
            assert track["times"] == pytest.approx([0, clip.duration], abs=1e-6)
            assert set(track["values"]) == {curve[0]}
        else:
            assert track["times"] == pytest.approx(clip.times, abs=1e-6)
            assert track["values"] == curve.tolist()


def test_the_head_turns_as_the_clip_says(tmp_path: Path, reader: Reader) -> None:
    clip = speech()
    reader.load(written(tmp_path, Performance(clip)))
    (animation,) = reader.call("vrma")
    track = animation["rotation"]["head"]
    turns = Rotation.from_quat(np.reshape(track["values"], (-1, 4))).as_matrix()
    assert turns == pytest.approx(head_rotations(clip.select(HEAD_ANGLES).values), abs=1e-5)


def test_few_keys_stay_within_their_bound_and_are_fewer(tmp_path: Path, reader: Reader) -> None:
    clip = retarget(speech(150), load_rig("vrm1"))
    content = written(tmp_path, Performance(speech(150)), KEYS)
    reader.load(content)
    assert len(content) < len(clip_to_vrma(clip)) / 2
    states = reader.call("sample", clip.times[::3].tolist())
    for name in PRESETS & set(clip.names):
        shown = [state["places"][name][0] for state in states]
        assert shown == pytest.approx(clip.curve(name)[::3].clip(0, 1), abs=KEYS + 1e-5)


def test_it_has_the_bones_that_vrm_requires_in_a_t_pose(tmp_path: Path) -> None:
    document, _ = from_glb(written(tmp_path, Performance(speech(5))))
    extension = document["extensions"]["VRMC_vrm_animation"]
    bones = {bone: item["node"] for bone, item in extension["humanoid"]["humanBones"].items()}
    assert set(bones) >= set(HUMANOID)
    nodes = document["nodes"]
    above = {
        child: n for n, node in enumerate(document["nodes"]) for child in node.get("children", ())
    }

    def place(node: int | None) -> np.ndarray:
        if node is None:
            return np.zeros(3)
        return place(above.get(node)) + nodes[node]["translation"]

    heights = {bone: place(node) for bone, node in bones.items()}
    assert heights["head"][1] > heights["hips"][1] > heights["leftFoot"][1] > 0
    for side, sign in (("left", 1), ("right", -1)):
        arm = [heights[f"{side}{part}"] for part in ("UpperArm", "LowerArm", "Hand")]
        assert np.ptp([joint[1] for joint in arm]) == 0
        assert (np.diff([joint[0] * sign for joint in arm]) > 0).all()
    assert all("rotation" not in node for node in nodes)


@pytest.mark.parametrize("keys", [None, KEYS])
def test_it_reads_back(tmp_path: Path, keys: float | None) -> None:
    clip = retarget(speech(), load_rig("vrm1"))
    written(tmp_path, Performance(speech()), keys)
    back = read_clip(tmp_path / "a.vrma")
    assert set(back.names) == set(clip.names) - GAZE
    assert (back.fps, len(back)) == (clip.fps, len(clip))
    off = np.abs(back.values - clip.select(back.names).values).max()
    assert off < (keys or 0) + 1e-6


def test_other_names_are_custom_expressions(tmp_path: Path, reader: Reader) -> None:
    rig = Rig("own", (Control("wiggle"), Control("aa")), {})
    clip = Clip(("wiggle", "aa"), 30, np.array([[0, 1], [1.5, 0]], np.float32))
    reader.load(written(tmp_path, Performance(clip, rig=rig)))
    (animation,) = reader.call("vrma")
    assert animation["custom"]["wiggle"]["values"] == [0, 1]  # weights end at 1
    assert set(animation["preset"]) == {"aa"}


def test_curves_without_expressions_are_refused(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="have none of VRM's expressions"):
        written(tmp_path, Performance(Clip(("x",), 60, np.zeros((2, 1)))))


def test_bones_are_no_expressions(tmp_path: Path, reader: Reader) -> None:
    performance = jaw_of_bones()
    reader.load(written(tmp_path, performance))
    (animation,) = reader.call("vrma")
    assert set(animation["custom"]) == {"smile"}
    assert not animation["preset"]
    bones = [name for name in performance.clip.names if "." in name]
    alone = Performance(performance.clip.select(bones), rig=performance.rig)
    with pytest.raises(LipwrightError, match=r"b\.vrma: .* retarget them to the rig vrm1"):
        export_all([tmp_path / "b.vrma"], alone)
