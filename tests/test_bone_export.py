"""Bones in files: the skinned GLB, the table and BVH, read back by others' readers."""

from __future__ import annotations

import csv
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pygltflib
import pytest
from scipy.spatial.transform import Rotation

from engine_clips import jaw_of_bones
from lipwright.cli import run as cli
from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all, export_clip
from lipwright.export.bone_skin import with_bones
from lipwright.export.glb import mesh_to_glb
from lipwright.export.gltf_character import read_character
from lipwright.export.gltf_file import read_gltf
from lipwright.export.gltf_store import Store
from lipwright.export.gltf_surface import read_gltf_surface
from lipwright.export.skinned import most_held, skinned_glb
from lipwright.face.head import Head
from lipwright.face.neck import turn_shares, turned
from lipwright.face.skeleton import Skeleton
from lipwright.face.skinning import SkinnedMesh
from lipwright.retarget import retarget
from lipwright.retarget.bone_rig import moving_shapes, placed_bones
from lipwright.retarget.skinned import bone_channels, posed_at, skin_mesh, whole_turns
from lipwright.rig import Bone, Control, Rig, load_rig, save_rig
from made_gltf import small_mesh
from reading_gltf import Reader, reader

__all__ = ["reader"]

TIMES = [0.1, 0.55, 1.0]
RIG = load_rig("bones")


def talking(frames: int = 61, fps: float = 60.0) -> Clip:
    """Smooth motion of some canonical controls, and of the head."""
    times = np.arange(frames) / fps
    names = CANONICAL + HEAD_ANGLES
    clip = Clip(names, fps, np.zeros((frames, len(names)), np.float32))
    moved = ("jawOpen", "mouthClose", "mouthPucker", "mouthSmileLeft", "tonguePress")
    curves = {name: 0.3 - 0.3 * np.cos(times * (3 + 2 * i)) for i, name in enumerate(moved)}
    curves |= {name: 0.3 * np.sin(times * (2 + i)) for i, name in enumerate(HEAD_ANGLES)}
    return clip.with_curves(curves)


CLIP = retarget(talking(), RIG)
PERFORMANCE = Performance(CLIP, rig=RIG)


@pytest.fixture(scope="module")
def skinned(head: Head) -> SkinnedMesh:
    return skin_mesh(head, RIG)


@dataclass
class Bones:
    """`tests/web/bones.mjs` in the page of a reader."""

    reader: Reader

    def call(self, name: str, *arguments: Any) -> Any:
        script = "async (a) => (await import('/bones.mjs'))[a[0]](...a.slice(1))"
        return self.reader.page.evaluate(script, [name, *arguments])

    def load(self, content: bytes) -> Any:
        (self.reader.files / "bones.glb").write_bytes(content)
        return self.call("load", "/files/bones.glb")

    def posed_at(self, time: float) -> npt.NDArray[np.float64]:
        return np.reshape(self.call("posedAt", time), (-1, 3))


@pytest.fixture(scope="module")
def three(reader: Reader) -> Bones:
    return Bones(reader)


class TestThree:
    def test_each_vertex_is_where_ours_is_at_every_frame(
        self, three: Bones, skinned: SkinnedMesh
    ) -> None:
        three.load(skinned_glb(skinned, RIG, CLIP))
        ours = posed_at(skinned, RIG, CLIP, TIMES)
        for time, expected in zip(TIMES, ours, strict=True):
            np.testing.assert_allclose(three.posed_at(time), expected, atol=1e-5)
        assert np.abs(expected - skinned.mesh.vertices).max() > 0.005

    def test_few_keys_keep_the_vertices_within_their_bound(
        self, three: Bones, skinned: SkinnedMesh
    ) -> None:
        content = skinned_glb(skinned, RIG, CLIP, keys=0.01)
        three.load(content)
        for time, expected in zip(TIMES, posed_at(skinned, RIG, CLIP, TIMES), strict=True):
            np.testing.assert_allclose(three.posed_at(time), expected, atol=5e-4)
        assert len(content) < len(skinned_glb(skinned, RIG, CLIP))

    def test_the_bones_hang_on_each_other_as_in_the_rig(
        self, three: Bones, skinned: SkinnedMesh
    ) -> None:
        expected = [[bone.name, bone.parent or "head_bones"] for bone in RIG.bones]
        found = three.load(skinned_glb(skinned))
        assert found == [expected] * len(skinned.mesh.parts)

    def test_without_a_clip_the_mesh_is_at_rest(self, three: Bones, skinned: SkinnedMesh) -> None:
        three.load(skinned_glb(skinned))
        np.testing.assert_allclose(three.posed_at(0.0), skinned.mesh.vertices, atol=1e-6)

    def test_bvh_has_the_bones_and_where_they_are_at_each_frame(
        self, three: Bones, tmp_path: Path
    ) -> None:
        export_all([tmp_path / "x.bvh"], PERFORMANCE)
        (three.reader.files / "x.bvh").write_bytes((tmp_path / "x.bvh").read_bytes())
        found = three.call("readBvh", "/files/x.bvh")
        bones = {bone["name"]: bone for bone in found["bones"] if bone["name"] != "ENDSITE"}
        skeleton = Skeleton.of(RIG.bones)
        rotations, places = skeleton.joints(bone_channels(CLIP, RIG), whole_turns(CLIP))
        for number, bone in enumerate(RIG.bones):
            assert bones[bone.name]["parent"] == bone.parent
            offset = 100 * skeleton.offsets[number]
            np.testing.assert_allclose(bones[bone.name]["at"], offset, atol=1e-5)
            position = found["tracks"][f"{bone.name}.position"]
            np.testing.assert_allclose(position["times"], CLIP.times, atol=1e-6)
            moved = np.reshape(position["values"], (-1, 3)) - offset  # three.js adds it
            np.testing.assert_allclose(moved, 100 * places[:, number], atol=6e-4)
            turn = np.reshape(found["tracks"][f"{bone.name}.quaternion"]["values"], (-1, 4))
            between = Rotation.from_quat(turn) * Rotation.from_matrix(rotations[:, number]).inv()
            assert np.degrees(between.magnitude().max()) < 2e-3


@pytest.fixture(scope="module")
def other(head: Head, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Our head as the file of somebody, twice as large and elsewhere."""
    still = Clip(("jawOpen",), 30, np.zeros((1, 1), np.float32))
    path = tmp_path_factory.mktemp("other") / "other.glb"
    path.write_bytes(mesh_to_glb(head, still))
    file = read_gltf(path)
    file.document["nodes"][0] |= {"scale": [2.0] * 3, "translation": [0.5, 1.5, -0.25]}
    path.write_bytes(Store(file.document, file.buffers[0] or b"").to_glb())
    return path


class TestOthersFiles:
    def test_bones_move_a_character_of_any_size_as_in_three(
        self, three: Bones, skinned: SkinnedMesh, head: Head, other: Path, tmp_path: Path
    ) -> None:
        mesh = read_character(other)
        bones, size = placed_bones(RIG, head, mesh, moving_shapes(mesh, RIG))
        boned = SkinnedMesh(mesh, Skeleton.of(bones), skinned.weights)
        (tmp_path / "boned.glb").write_bytes(with_bones(read_gltf_surface(other), boned))
        rig = replace(RIG, name="other", bones=bones)
        moved = {name: size * CLIP.curve(name) for name in CLIP.names if ".t" in name}
        clip = CLIP.with_curves(moved)
        options = ExportOptions(onto=tmp_path / "boned.glb")
        export_all([tmp_path / "x.glb"], Performance(clip, rig=rig), options=options)
        three.load((tmp_path / "x.glb").read_bytes())
        for time, expected in zip(TIMES, posed_at(boned, rig, clip, TIMES), strict=True):
            np.testing.assert_allclose(three.posed_at(time), expected, atol=1e-4)

    def test_a_mesh_with_a_skin_is_refused(self, skinned: SkinnedMesh, tmp_path: Path) -> None:
        (tmp_path / "x.glb").write_bytes(skinned_glb(skinned))
        with pytest.raises(LipwrightError, match="has a skin already"):
            with_bones(read_gltf_surface(tmp_path / "x.glb"), skinned)


class TestCommand:
    def test_our_head_on_bones_with_what_is_left_of_each_blendshape(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str], head: Head
    ) -> None:
        del head
        assert cli(["rigs", "bones", "-o", str(tmp_path / "x.glb")]) == 0
        said = capsys.readouterr()
        about, _, *table = said.out.splitlines()
        assert about == "head: 7093 vertices on 12 bones"
        rows = [line.split() for line in table]
        heard = RIG.mapping.sources
        assert {row[0] for row in rows} == heard
        assert all(float(row[1]) < float(row[2]) < 10 for row in rows)
        assert pygltflib.GLTF2().load(str(tmp_path / "x.glb")).skins

    def test_a_character_with_bones_of_its_own_gets_a_rig_that_moves_it(
        self, tmp_path: Path
    ) -> None:
        path, out, rig = (tmp_path / name for name in ("in.glb", "out.glb", "rig.json"))
        mesh = small_mesh(("jawOpen", "mouthPucker"))
        path.write_bytes(mesh_to_glb(mesh, Clip(("jawOpen",), 30, np.zeros((1, 1)))))
        own = Rig(
            "own", (Control("jaw.rx", -90, 90),), {}, bones=(Bone("head"), Bone("jaw", "head"))
        )
        save_rig(own, tmp_path / "own.json")
        command = ["rigs", "bones", str(path), "--rig", str(tmp_path / "own.json")]
        assert cli([*command, "-o", str(out), "--save-rig", str(rig)]) == 0
        read = pygltflib.GLTF2().load(str(out))
        assert [read.nodes[joint].name for joint in read.skins[0].joints] == ["head", "jaw"]
        assert read.meshes[0].primitives[0].attributes.JOINTS_0 is not None
        assert load_rig(rig).mapping is not None

    @pytest.mark.parametrize(
        ("arguments", "said"),
        [
            (["-o", "x.png"], "x.png: name a file that ends in .glb"),
            (["--rig", "facefx"], "'facefx' has no bones"),
            (["missing.glb"], "missing.glb: no such file"),
        ],
    )
    def test_what_cannot_be_done_is_said_in_one_line(
        self, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str], head: Head
    ) -> None:
        del head
        assert cli(["rigs", "bones", *arguments]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1


class TestGlb:
    def test_pygltflib_reads_the_skin(self, skinned: SkinnedMesh, tmp_path: Path) -> None:
        (tmp_path / "x.glb").write_bytes(skinned_glb(skinned, RIG, CLIP, sound="x.wav"))
        read = pygltflib.GLTF2().load(str(tmp_path / "x.glb"))
        names = [read.nodes[joint].name for joint in read.skins[0].joints]
        assert names == [bone.name for bone in RIG.bones]
        assert read.nodes[0].skin == 0
        assert read.asset.extras["sound"] == "x.wav"
        paths = {(read.nodes[c.target.node].name, c.target.path)
                 for c in read.animations[0].channels}  # fmt: skip
        assert ("head", "rotation") in paths
        assert ("head", "translation") not in paths
        assert ("jaw", "rotation") in paths
        assert ("lip_upper_mid", "translation") in paths
        assert not [path for name, path in paths if name == "body"]

    def test_four_bones_at_most_hold_a_vertex_and_unused_ones_are_zero(self) -> None:
        weights = np.array([[0.0, 0.5, 0.0, 0.2, 0.3], [0.0, 0.0, 1.0, 0.0, 0.0]])
        joints, shares = most_held(weights)
        assert joints.tolist() == [[1, 4, 3, 0], [2, 0, 0, 0]]
        np.testing.assert_allclose(shares, [[0.5, 0.3, 0.2, 0], [1, 0, 0, 0]], atol=1e-7)

    def test_fewer_than_four_bones_will_do(self) -> None:
        joints, shares = most_held(np.array([[0.25, 0.75]]))
        assert joints.tolist() == [[1, 0, 0, 0]]
        assert shares.tolist() == [[0.75, 0.25, 0, 0]]

    def test_the_neck_follows_as_in_our_pictures(self, head: Head, skinned: SkinnedMesh) -> None:
        angles = [0.4, -0.2, 0.1]
        clip = Clip(HEAD_ANGLES, 30, np.array([angles]))
        (posed,) = posed_at(skinned, RIG, clip, [0.0])
        expected = turned(head.vertices, turn_shares(head), angles)
        np.testing.assert_allclose(posed, expected, atol=4e-4)  # where five bones met, four stay


class TestTable:
    def test_the_csv_module_reads_places_and_turns(self, tmp_path: Path) -> None:
        export_all([tmp_path / "x.bones.csv"], PERFORMANCE)
        with (tmp_path / "x.bones.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        skeleton = Skeleton.of(RIG.bones)
        rotations, places = skeleton.joints(bone_channels(CLIP, RIG), whole_turns(CLIP))
        times = [float(row["time"]) for row in rows]
        np.testing.assert_allclose(times, CLIP.times, atol=1e-6)
        for number, name in enumerate(skeleton.names):
            found = [[float(row[f"{name}.{axis}"]) for axis in "xyz"] for row in rows]
            np.testing.assert_allclose(found, places[:, number], atol=1e-6)
            angles = [[float(row[f"{name}.r{axis}"]) for axis in "xyz"] for row in rows]
            read = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
            np.testing.assert_allclose(read, rotations[:, number], atol=5e-6)

    def test_canonical_curves_are_retargeted_to_the_bones_that_ship(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.bones.csv", talking())
        export_all([tmp_path / "b.bones.csv"], PERFORMANCE)
        assert (tmp_path / "a.bones.csv").read_bytes() == (tmp_path / "b.bones.csv").read_bytes()

    @pytest.mark.parametrize("suffix", [".bones.csv", ".bvh"])
    def test_a_rig_without_bones_is_refused(self, suffix: str, tmp_path: Path) -> None:
        rig = load_rig("facefx")
        clip = Clip(("open",), 30, np.ones((2, 1)))
        plain = Rig("plain", (Control("open"),), {})
        with pytest.raises(LipwrightError, match=r"needs bones, and the rig 'plain' has none"):
            export_all([tmp_path / f"x{suffix}"], Performance(clip, rig=plain))
        assert rig.bones == ()

    def test_bvh_of_several_roots_has_one_above_them(self, tmp_path: Path) -> None:
        bones = (Bone("left ear"), Bone("right ear", "", (0.1, 0, 0)))
        rig = Rig("ears", (Control("left ear.rz", -90, 90),), {}, bones=bones)
        clip = Clip(("left ear.rz",), 10, np.array([[0.0], [45.0]]))
        export_all([tmp_path / "x.bvh"], Performance(clip, rig=rig))
        lines = (tmp_path / "x.bvh").read_text().splitlines()
        assert lines[1] == "ROOT root"
        assert [line.strip() for line in lines if "JOINT" in line] == [
            "JOINT left_ear", "JOINT right_ear",
        ]  # fmt: skip
        assert [float(n) for n in lines[-1].split()] == [0] * 9 + [45, 0, 0] + [10] + [0] * 5


def test_bones_that_follow_no_speech_are_refused_with_the_output_and_the_remedy(
    tmp_path: Path, head: Head
) -> None:
    del head
    with pytest.raises(LipwrightError, match=r"x\.glb: the rig .*--onto character\.glb"):
        export_all(tmp_path / "x.glb", jaw_of_bones())
    assert not list(tmp_path.iterdir())
