"""USD as Pixar's own library reads, poses and checks it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from engine_clips import jaw_of_bones
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all
from lipwright.export.usd import identifiers
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.face.neck import turn_shares, turned
from made_gltf import small_mesh

pytest.importorskip("pxr", reason="usd-core is not installed")

FRAMES = [0, 7, 20]


def talking(names: tuple[str, ...] = CANONICAL, frames: int = 31) -> Clip:
    times = np.arange(frames)[:, None] / 24
    weights = 0.5 - 0.5 * np.cos(times * np.linspace(2, 9, len(names)))
    turns = 0.3 * np.sin(times * [2, 3, 4])
    return Clip(names + HEAD_ANGLES, 24, np.hstack([weights, turns]))


def opened(path: Path, performance: Performance, **options: Any) -> Any:
    from pxr import Usd

    export_all([path], performance, options=ExportOptions(**options))
    return Usd.Stage.Open(str(path))


def animation_query(stage: Any) -> Any:
    from pxr import Usd, UsdSkel

    root = UsdSkel.Root(stage.GetDefaultPrim())
    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.TraverseInstanceProxies())
    skeleton = UsdSkel.Skeleton(stage.GetPrimAtPath("/Character/Skeleton"))
    return cache.GetSkelQuery(skeleton).GetAnimQuery()


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd"])
def test_weights_and_times_are_those_of_the_clip(tmp_path: Path, head: Head, suffix: str) -> None:
    del head
    clip = talking()
    stage = opened(tmp_path / f"a{suffix}", Performance(clip))
    assert stage.GetTimeCodesPerSecond() == clip.fps
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, len(clip) - 1)
    query = animation_query(stage)
    assert tuple(query.GetBlendShapeOrder()) == CANONICAL
    assert query.GetBlendShapeWeightTimeSamples() == list(range(len(clip)))
    for frame, row in enumerate(clip.values):
        assert list(query.ComputeBlendShapeWeights(frame)) == row[: len(CANONICAL)].tolist()


def test_points_are_those_of_the_mesh_in_every_pose(tmp_path: Path, head: Head) -> None:
    from pxr import Gf, UsdGeom, UsdSkel

    clip = talking()
    stage = opened(tmp_path / "a.usdc", Performance(clip))
    assert UsdSkel.BakeSkinning(
        UsdSkel.Root(stage.GetDefaultPrim()), Gf.Interval(FRAMES[0], FRAMES[-1])
    )
    prims = {part.name: UsdGeom.Mesh(stage.GetPrimAtPath(f"/Character/{part.name}"))
             for part in head.parts}  # fmt: skip
    for frame in FRAMES:
        row = clip.values[frame]
        expected = turned(head.pose(row[: len(CANONICAL)]), turn_shares(head), row[-3:])
        for part in head.parts:
            points = np.array(prims[part.name].GetPointsAttr().Get(frame))
            # What follows its joints as a whole is turned as a whole.
            place = prims[part.name].ComputeLocalToWorldTransform(frame)
            points = points @ np.array(place)[:3, :3]
            assert points == pytest.approx(expected[part.vertices], abs=1e-6)
            corners = np.array(prims[part.name].GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
            assert (corners + part.vertices.start == head.triangles[part.triangles]).all()


def test_units_axes_and_the_recording_are_there(tmp_path: Path, head: Head) -> None:
    from pxr import UsdGeom, UsdMedia

    del head
    soundfile.write(tmp_path / "talk.wav", np.zeros(1000), 8000)
    stage = opened(tmp_path / "a.usda", Performance(talking(), audio=tmp_path / "talk.wav"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    sound = UsdMedia.SpatialAudio(stage.GetPrimAtPath("/Character/Sound"))
    asset = sound.GetFilePathAttr().Get()
    assert asset.path == "talk.wav"
    assert Path(asset.resolvedPath) == tmp_path / "talk.wav"


def test_usds_own_validators_find_nothing(tmp_path: Path, head: Head) -> None:
    from pxr import UsdValidation

    del head
    stage = opened(tmp_path / "a.usdc", Performance(talking(frames=3)))
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 10
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    assert not [error.GetMessage() for error in errors]


def test_a_character_of_ones_own_is_shown(tmp_path: Path) -> None:
    from pxr import UsdSkel

    mesh: Mesh = small_mesh(("a b", "1", "a_b"))
    clip = talking(("a b", "a_b"))
    stage = opened(tmp_path / "a.usda", Performance(clip), character=mesh)
    binding = UsdSkel.BindingAPI(stage.GetPrimAtPath("/Character/skin"))
    names = list(binding.GetBlendShapesAttr().Get())
    assert set(names) <= {"a_b", "_1", "a_b_2"}
    assert tuple(animation_query(stage).GetBlendShapeOrder()) == ("a_b", "a_b_2")
    assert len(binding.GetBlendShapeTargetsRel().GetTargets()) == len(names)


def test_other_rigs_have_weights_alone(tmp_path: Path) -> None:
    clip = talking(("viseme_aa", "viseme_PP"))
    stage = opened(tmp_path / "a.usda", Performance(clip))
    query = animation_query(stage)
    assert tuple(query.GetBlendShapeOrder()) == ("viseme_aa", "viseme_PP")
    assert list(query.ComputeBlendShapeWeights(5)) == clip.values[5, :2].tolist()
    assert not [prim for prim in stage.Traverse() if prim.GetTypeName() == "Mesh"]


def test_names_are_identifiers_and_stay_apart() -> None:
    names = ("jawOpen", "jaw open", "jaw_open", "2nd", "あ", "い")
    assert list(identifiers(names).values()) == [
        "jawOpen", "jaw_open", "jaw_open_2", "_2nd", "_", "__2",
    ]  # fmt: skip


def test_curves_that_move_nothing_of_the_character_are_refused(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="have none of the blendshapes of the square"):
        opened(tmp_path / "a.usda", Performance(talking(("x",))), character=small_mesh())


def test_without_usd_it_says_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(LipwrightError, match=r"pip install 'lipwright\[usd\]'"):
        export_all([tmp_path / "a.usda"], Performance(talking()))
    assert not list(tmp_path.iterdir())


def test_bones_are_no_blendshapes(tmp_path: Path) -> None:
    performance = jaw_of_bones()
    query = animation_query(opened(tmp_path / "a.usda", performance))
    assert tuple(query.GetBlendShapeOrder()) == ("smile",)
    bones = [name for name in performance.clip.names if "." in name]
    alone = Performance(performance.clip.select(bones), rig=performance.rig)
    with pytest.raises(LipwrightError, match=r"b\.usda: the curves move bones alone.*GLB"):
        export_all([tmp_path / "b.usda"], alone)
    assert not (tmp_path / "b.usda").exists()
