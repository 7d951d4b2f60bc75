"""`lipwright rigs transfer`, and the files that it reads and writes."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pygltflib
import pytest
from numpy.typing import NDArray

from lipwright.cli.rig_transfer import transfer
from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export.glb import mesh_to_glb
from lipwright.export.gltf_store import Store
from lipwright.export.gltf_surface import read_gltf_surface, with_blendshapes
from lipwright.export.surfaces import read_surface
from lipwright.face.head import Head
from lipwright.face.surface import Surface, mesh_surface
from lipwright.face.target_mesh import character

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
CHILD = ["examples/other-head.obj", "--landmarks", "examples/other-head.csv"]


def run(*arguments: object) -> None:
    transfer.main([str(argument) for argument in arguments], standalone_mode=False)


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, head: Head) -> Path:
    (tmp_path / "examples").symlink_to(EXAMPLES)
    monkeypatch.chdir(tmp_path)
    values = np.zeros((4, 3), np.float32)
    values[:, 0] = [0, 0.5, 1, 0.5]
    rows = "\n".join(f"{i / 25:.6f},{a},{b},{c}" for i, (a, b, c) in enumerate(values.tolist()))
    (tmp_path / "clip.csv").write_text(f"time,jawOpen,mouthPucker,headYaw\n{rows}\n")
    return tmp_path


@pytest.fixture(scope="module")
def head_glb(head: Head, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Our head as a user might keep it, without blendshapes of the lips."""
    path = tmp_path_factory.mktemp("head") / "own.glb"
    clip = Clip(("browInnerUp",), 10.0, np.ones((3, 1), np.float32))
    path.write_bytes(mesh_to_glb(head, clip, name="wave"))
    return path


def test_a_head_of_another_make_gets_named_blendshapes(
    place: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    run(*CHILD, "-o", "child.glb", "--controls", "jawOpen,mouthSmile,tongueOut")
    printed = capfd.readouterr().err.splitlines()
    assert printed[0].startswith("examples/other-head.obj: 4,590 points, 9,120 triangles, 3 pieces")
    assert printed[1] == "examples/other-head.csv: 34 landmarks"
    assert "mm from the mesh" in printed[2]
    assert printed[3] == "child.glb: 3 blendshapes; not on this mesh: tongueOut"
    found = pygltflib.GLTF2().load(str(place / "child.glb"))
    assert found.meshes[0].extras["targetNames"] == [
        "jawOpen", "mouthSmileLeft", "mouthSmileRight",
    ]  # fmt: skip
    assert len(found.meshes[0].primitives[0].targets) == 3


def test_a_clip_plays_on_it_and_every_frame_can_be_had_without_a_rig(
    place: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    run(*CHILD, "-o", "child.glb", "--controls", "jawOpen", "--clip", "clip.csv")
    found = pygltflib.GLTF2().load(str(place / "child.glb"))
    assert found.animations[0].channels[0].target.path == "weights"
    run(*CHILD, "-o", "child.pc2", "--clip", "clip.csv")
    assert capfd.readouterr().err.splitlines()[-1] == "child.pc2: 4 frames of 4,590 vertices"
    content = (place / "child.pc2").read_bytes()
    magic, version, vertices, start, rate, frames = struct.unpack_from("<12siiffi", content)
    assert (magic, version, vertices, start, rate, frames) == (
        b"POINTCACHE2\0", 1, 4590, 0.0, 1.0, 4,
    )  # fmt: skip
    moved = np.frombuffer(content, "<f4", offset=32).reshape(frames, vertices, 3)
    rest = read_surface("examples/other-head.obj").surface.vertices
    np.testing.assert_allclose(moved[0], rest, atol=1e-6)
    far = np.linalg.norm(moved - rest, axis=2).max(axis=1)
    assert far[2] > 0.02
    np.testing.assert_allclose(moved[1], moved[3], atol=1e-6)


def test_our_head_changed_gets_its_shapes_by_number_and_keeps_its_file(
    place: Path, head: Head, head_glb: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    run(head_glb, "--same-topology", "-o", "same.glb", "--controls", "jawOpen,tongueOut")
    assert "55 blendshapes" not in capfd.readouterr().err
    before, after = (pygltflib.GLTF2().load(str(p)) for p in (head_glb, place / "same.glb"))
    assert [m.name for m in after.materials] == [m.name for m in before.materials]
    assert len(after.images) == 1
    names = after.meshes[0].extras["targetNames"]
    assert names == list(CANONICAL)  # what was there stays, and is replaced where made anew
    assert after.meshes[0].weights == [0.0] * 55
    assert not after.animations  # it was of blendshapes
    index = names.index("jawOpen")
    sparse = after.accessors[after.meshes[0].primitives[0].targets[index]["POSITION"]].sparse
    skin = head.parts[0].vertices
    vertices, deltas = head.shape("jawOpen")
    farthest = np.linalg.norm(deltas[vertices < skin.stop], axis=1).max()
    view = after.bufferViews[sparse.values.bufferView]
    blob = after.binary_blob()[view.byteOffset :][: view.byteLength]
    stored = np.frombuffer(blob, np.float32).reshape(-1, 3)
    assert np.linalg.norm(stored, axis=1).max() == pytest.approx(farthest, abs=1e-6)


def test_a_surface_out_of_a_glb_is_the_head_that_went_in(head: Head, head_glb: Path) -> None:
    found, wanted = read_surface(head_glb).surface, mesh_surface(head)
    assert (found.triangles == wanted.triangles).all()
    np.testing.assert_allclose(found.vertices, wanted.vertices, atol=1e-7)
    assert found.uvs is not None
    np.testing.assert_allclose(found.uvs, head.uvs)
    assert len(np.unique(found.pieces)) == len(np.unique(wanted.pieces))


SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]], np.float32)
CORNERS = np.array([0, 1, 2, 0, 2, 3], np.uint32)


def square_glb(path: Path, **node: object) -> Path:
    """A square below a scaled and turned node, skinned where `node` says so."""
    store = Store()
    attributes = {"POSITION": store.accessor(SQUARE, "VEC3", bounds=True)}
    if "skin" in node:
        attributes["JOINTS_0"] = store.accessor(np.zeros((4, 4), np.uint32), "VEC4")
        attributes["WEIGHTS_0"] = store.accessor(
            np.tile(np.array([1, 0, 0, 0], np.float32), (4, 1)), "VEC4"
        )
        inverse = np.eye(4, dtype=np.float32)
        inverse[:3, :3] *= 3
        store.document["skins"] = [
            {"joints": [2], "inverseBindMatrices": store.accessor(inverse.reshape(1, 16), "MAT4")}
        ]
    indices = store.accessor(CORNERS, "SCALAR")
    store.document |= {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 2]}],
        "nodes": [
            {"scale": [2, 2, 2], "children": [1]},
            {"mesh": 0, "name": "sheet", "translation": [0, 0, 1],
             "rotation": [0, 0, 0.70710678, 0.70710678], **node},
            {"translation": [10, 0, 0]},
        ],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": indices}]}],
    }  # fmt: skip
    path.write_bytes(store.to_glb())
    return path


def test_nodes_and_skins_put_a_mesh_where_it_is_shown_and_shapes_where_it_is_kept(
    tmp_path: Path,
) -> None:
    deltas = np.zeros((4, 3))
    deltas[1] = [0.0, 6.0, 0.0]
    for node, corner, kept in (({}, [0, 2, 2], [3, 0, 0]), ({"skin": 0}, [13, 0, 0], [0, 2, 0])):
        path = square_glb(tmp_path / "square.glb", **node)
        mesh = read_gltf_surface(path)
        np.testing.assert_allclose(mesh.surface.vertices[1], corner, atol=1e-6)
        shaped = tmp_path / "shaped.glb"
        shaped.write_bytes(with_blendshapes(mesh, {"lift": deltas}))
        found = pygltflib.GLTF2().load(str(shaped))
        view = found.bufferViews[
            found.accessors[
                found.meshes[0].primitives[0].targets[0]["POSITION"]
            ].sparse.values.bufferView
        ]
        blob = found.binary_blob()[view.byteOffset :][: view.byteLength]
        np.testing.assert_allclose(np.frombuffer(blob, np.float32), kept, atol=1e-6)


def test_the_clay_character_moves_as_its_shapes_say() -> None:
    surface = Surface(SQUARE.astype(float), CORNERS.reshape(-1, 3).astype(np.int64))
    deltas = np.zeros((2, 4, 3))
    deltas[0, 2] = [0, 0, 1]
    mesh = character(surface, ("up", "still"), deltas)
    posed: NDArray[np.float32] = mesh.pose([0.5, 1.0])
    assert posed[2].tolist() == [1, 1, 0.5]
    assert len(mesh.shape("still")[0]) == 0


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["none.obj", "-o", "a.glb"], "none.obj: cannot be read: No such file"),
        (["a.ply", "-o", "a.glb"], "a.ply: meshes are read from .obj, .glb, .gltf, .vrm"),
        ([*CHILD, "-o", "a.fbx"], "a.fbx: name a file that ends in .glb or .pc2"),
        ([*CHILD, "-o", "a.pc2"], "a.pc2: a point cache holds motion; give curves with --clip"),
        ([*CHILD, "-o", "a.glb", "--controls", "smile"], "--controls: no control 'smileLeft'"),
        ([*CHILD, "-o", "a.glb", "--same-topology"], "--same-topology needs no --landmarks"),
        ([*CHILD, "-o", "a.glb", "--mesh", "face"], "an OBJ is read whole"),
        ([*CHILD[:1], "-o", "a.glb", "--same-topology"], "has 4590 vertices and the source has"),
        (["sheet.glb", "-o", "a.glb", "--mesh", "face"], "has no mesh 'face'; it has: sheet"),
        (["sheet.glb", "-o", "sheet.glb"], "sheet.glb: is also read"),
        (["fins.obj", "-o", "a.glb"], "fins.obj: 1 edges have more than two triangles; the edge of "
         "vertices 0 and 1 at .*; clean the mesh"),
        (["nan.obj", "-o", "a.glb"], r"nan.obj: vertex 1 is at \(nan, 0, 0\)"),
        (["cut.glb", "-o", "a.glb"], "cut.glb: "),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_told_in_one_line(
    place: Path, arguments: list[str], what: str
) -> None:
    square_glb(place / "sheet.glb")
    (place / "cut.glb").write_bytes((place / "sheet.glb").read_bytes()[:300])
    (place / "a.ply").write_text("ply\n")
    corners = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\n"
    (place / "fins.obj").write_text(corners + "f 1 2 3\nf 1 2 4\nf 1 2 5\n")
    (place / "nan.obj").write_text(corners.replace("0 0 1", "nan 0 0") + "f 1 2 3\n")
    with pytest.raises(LipwrightError, match=what) as caught:
        run(*arguments)
    assert "\n" not in str(caught.value)
    assert not (place / "a.glb").exists()


def test_other_kinds_of_glb_are_told(tmp_path: Path) -> None:
    path = square_glb(tmp_path / "square.glb")
    length = struct.unpack_from("<I", path.read_bytes(), 12)[0]
    whole = path.read_bytes()
    document = json.loads(whole[20 : 20 + length])
    for change, what in (
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "are compressed .KHR_draco"),
        ({"nodes": [{}]}, "shows no mesh"),
        ({"meshes": [{"primitives": [{**document["meshes"][0]["primitives"][0], "mode": 5}]}]},
         "drawn as strips"),
        ({"meshes": [{"primitives": [{"attributes": {}}]}]}, "POSITION|without positions"),
    ):  # fmt: skip
        store = Store(document | change, whole[28 + length :])
        path.write_bytes(store.to_glb())
        with pytest.raises(LipwrightError, match=what):
            read_surface(path)
