"""Unity clips, read back with a YAML parser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from engine_clips import BOUND, hermite, jaw_of_bones, waves
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all, export_clip


class UnityLoader(yaml.SafeLoader):
    """Knows the tags `!u!` of Unity's classes."""


UnityLoader.add_multi_constructor(
    "tag:unity3d.com,2011:",
    lambda loader, suffix, node: (int(suffix), loader.construct_mapping(node, deep=True)),
)


def read_unity(path: Path) -> dict[str, Any]:
    tag, document = yaml.load(path.read_text(), Loader=UnityLoader)
    assert tag == 74
    assert list(document) == ["AnimationClip"]
    return document["AnimationClip"]


def column(curve: dict[str, Any], field: str) -> np.ndarray:
    return np.array([key[field] for key in curve["curve"]["m_Curve"]])


def vectors(curve: dict[str, Any], field: str, axes: str) -> np.ndarray:
    return np.array([[key[field][a] for a in axes] for key in curve["curve"]["m_Curve"]])


def test_weights_come_back_in_percent_at_the_times_of_the_frames(tmp_path: Path) -> None:
    clip = waves("jawOpen", "mouthClose", fps=59.94)
    export_clip(path := tmp_path / "a take.anim", clip)
    found = read_unity(path)
    assert found["m_Name"] == "a take"
    assert found["m_SampleRate"] == pytest.approx(59.94)
    assert found["m_AnimationClipSettings"]["m_StopTime"] == pytest.approx(clip.duration, abs=1e-6)
    for name, curve in zip(clip.names, found["m_FloatCurves"], strict=True):
        assert curve["attribute"] == f"blendShape.{name}"
        assert (curve["classID"], curve["path"]) == (137, "head")
        times = column(curve, "time")
        np.testing.assert_allclose(
            column(curve, "value") / 100, clip.curve(name)[: len(times)], atol=1e-6
        )
        np.testing.assert_allclose(times, clip.times[: len(times)], atol=1e-6)
    assert [len(c["curve"]["m_Curve"]) for c in found["m_FloatCurves"]] == [150, 150, 1]


def test_every_frame_is_joined_by_straight_lines(tmp_path: Path) -> None:
    clip = waves("jawOpen", still="")
    export_clip(path := tmp_path / "a.anim", clip)
    curve = read_unity(path)["m_FloatCurves"][0]
    assert set(column(curve, "tangentMode")) == {69}  # broken, linear on both sides
    between = (clip.times[:-1] + clip.times[1:]) / 2
    slopes = [column(curve, field) for field in ("inSlope", "outSlope")]
    seen = hermite(column(curve, "time"), column(curve, "value"), *slopes, between)
    np.testing.assert_allclose(seen / 100, clip.at(between)[:, 0], atol=2e-6)


def test_few_keys_keep_the_bound(tmp_path: Path) -> None:
    clip = waves("jawOpen", "mouthClose", frames=600)
    export_clip(path := tmp_path / "a.anim", clip, options=ExportOptions(keys=BOUND))
    for name, curve in zip(clip.names, read_unity(path)["m_FloatCurves"], strict=True):
        keys = [column(curve, f) for f in ("time", "value", "inSlope", "outSlope")]
        assert len(keys[0]) < len(clip) / 8
        assert np.abs(hermite(*keys, clip.times) / 100 - clip.curve(name)).max() <= BOUND
        assert set(column(curve, "tangentMode")) <= {0, 1}


@pytest.mark.parametrize("name", ["口_あ", "a: b # c", "'\"\\", "- x", "yes", "{a}", "é", " a "])
def test_odd_names_come_back(tmp_path: Path, name: str) -> None:
    export_clip(path := tmp_path / "a.anim", waves(name, still=""))
    assert read_unity(path)["m_FloatCurves"][0]["attribute"] == f"blendShape.{name}"


def test_bones_come_back_in_left_handed_axes(tmp_path: Path) -> None:
    performance = jaw_of_bones()
    export_all(path := tmp_path / "a.anim", performance)
    found = read_unity(path)
    clip = performance.clip
    assert [c["attribute"] for c in found["m_FloatCurves"]] == ["blendShape.smile"]
    assert [c["path"] for c in found["m_RotationCurves"]] == ["head", "head/jaw"]
    places = vectors(found["m_PositionCurves"][0], "value", "xyz")
    np.testing.assert_allclose(places[:, :2], [[-0.01, -0.04]] * len(clip), atol=1e-7)
    np.testing.assert_allclose(places[:, 2], 0.02 + clip.curve("jaw.tz"), atol=1e-7)
    # A mirror at x = 0 turns our axes into Unity's: the matrix of each turn must be mirrored.
    mirror = np.diag([-1, 1, 1])
    seen = Rotation.from_quat(vectors(found["m_RotationCurves"][1], "value", "xyzw")).as_matrix()
    z = Rotation.from_rotvec(np.outer(clip.curve("jaw.rz"), [0, 0, 1]), degrees=True)
    x = Rotation.from_rotvec(np.outer(clip.curve("jaw.rx"), [1, 0, 0]), degrees=True)
    np.testing.assert_allclose(seen, mirror @ (z * x).as_matrix() @ mirror, atol=1e-6)
    assert len(found["m_RotationCurves"][0]["curve"]["m_Curve"]) == 1
    assert [c["path"] for c in found["m_PositionCurves"]] == ["head/jaw"]  # the head only turns


def test_a_bone_that_only_moves_has_no_turns(tmp_path: Path) -> None:
    performance = jaw_of_bones()
    moved = Performance(performance.clip.select(["jaw.tz"]), rig=performance.rig)
    export_all(path := tmp_path / "a.anim", moved)
    found = read_unity(path)
    assert [c["path"] for c in found["m_PositionCurves"]] == ["head/jaw"]
    assert not found["m_RotationCurves"]


def test_what_unity_cannot_hold_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.anim"
    with pytest.raises(LipwrightError, match=r"a\.anim: .*no controls"):
        export_clip(path, Clip((), 60, np.zeros((3, 0))))
    with pytest.raises(LipwrightError, match="no blendshape and no bone"):
        export_clip(path, waves("headYaw", still=""))
    with pytest.raises(LipwrightError, match=r"cannot have '\\n' in the name"):
        export_all(path, Performance(waves("jaw\nOpen")))
    assert not path.exists()
