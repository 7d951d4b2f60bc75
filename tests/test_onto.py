"""Curves on characters that others made: GLB, VRM 1.0 and 0.x, .gltf; and files that are broken."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from engine_clips import HELLO_CLIP, least_at_closures
from lipwright.clip import Clip
from lipwright.controls import ARKIT, CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all, read_clip
from lipwright.export.gltf_names import loose_name
from lipwright.export.onto import left_out, rig_for
from lipwright.face.turning import head_rotations
from lipwright.retarget import retarget
from lipwright.rig import load_rig
from lipwright.rig.file import RIGS
from made_gltf import character, from_glb, to_glb, vrm0, vrm1
from reading_gltf import Reader, reader

__all__ = ["reader"]

PRECISION = 1e-5
TIMES = [0.0, 0.3, 0.75, 1.0]
IN_FOLDER = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=80
)


def waves(*names: str, frames: int = 61) -> Clip:
    """One smooth curve a name, from 0 to 1."""
    times = np.arange(frames)[:, None] / 60
    return Clip(names, 60, 0.5 - 0.5 * np.cos(times * (2 + np.arange(len(names)))))


def animate(folder: Path, content: bytes, clip: Clip, **more: Any) -> bytes:
    """The GLB of a character with a clip."""
    rig = more.pop("rig", None)
    (folder / "character.glb").write_bytes(content)
    options = ExportOptions(onto=folder / "character.glb", **more)
    export_all([folder / "out.glb"], Performance(clip, rig=rig), options=options)
    return (folder / "out.glb").read_bytes()


def refused(folder: Path, content: bytes, clip: Clip | None = None) -> str:
    """The one line that refuses a character."""
    with pytest.raises(LipwrightError) as caught:
        animate(folder, content, clip or waves("jawOpen"))
    assert "\n" not in str(caught.value)
    return str(caught.value)


class TestNames:
    @pytest.mark.parametrize(
        "name",
        ["mouthSmileLeft", "MouthSmile_L", "mouth_smile_left", "Head.mouthSmileLeft",
         "blendShape1.mouthSmile_L", "ARKit_mouthSmileLeft", "mesh|mouthSmile.L",
         "mouthSmileL", "BS_MouthSmile L"],
    )  # fmt: skip
    def test_one_control_has_many_spellings(self, name: str) -> None:
        assert loose_name(name) == "mouthsmileleft"

    def test_no_two_canonical_controls_have_one_spelling(self) -> None:
        assert len(set(map(loose_name, CANONICAL))) == len(CANONICAL)

    @pytest.mark.parametrize("spelling", ["jawOpen", "Head.jawOpen", "Jaw_Open", "JAW OPEN"])
    def test_all_meshes_of_that_name_move(
        self, tmp_path: Path, reader: Reader, spelling: str
    ) -> None:
        clip = waves("jawOpen")
        content = to_glb(*character(["other", spelling], ["jawOpen"], ["none"]))
        reader.load(animate(tmp_path, content, clip))
        for state, row in zip(reader.call("sample", TIMES), clip.at(TIMES), strict=True):
            expected = [[0, row[0]], [row[0]], [0]]
            for weights, wanted in zip(state["weights"], expected, strict=True):
                assert weights == pytest.approx(wanted, abs=PRECISION)

    def test_the_exact_name_goes_before_one_like_it(self, tmp_path: Path) -> None:
        content = to_glb(*character(["JawOpen", "jawOpen"]))
        document, _ = from_glb(animate(tmp_path, content, waves("jawOpen")))
        assert len(document["animations"][0]["channels"]) == 1
        back = read_clip(tmp_path / "out.glb")
        assert back.curve("jawOpen").tolist() == waves("jawOpen").values[:, 0].tolist()
        assert not back.curve("JawOpen").any()

    def test_names_in_a_primitives_extras_count(self, tmp_path: Path) -> None:
        document, data = character(["jawOpen"])
        mesh = document["meshes"][0]
        mesh["primitives"][0]["extras"] = mesh.pop("extras")
        animate(tmp_path, to_glb(document, data), waves("jawOpen"))
        assert read_clip(tmp_path / "out.glb").names == ("jawOpen",)

    def test_what_does_not_move_keeps_its_weight(self, tmp_path: Path) -> None:
        document, data = character(["jawOpen", "smirk"])
        document["meshes"][0]["weights"] = [0.2, 0.7]
        animate(tmp_path, to_glb(document, data), waves("jawOpen"))
        back = read_clip(tmp_path / "out.glb")
        assert set(back.curve("smirk").tolist()) == {np.float32(0.7)}
        assert back.curve("jawOpen")[0] == 0

    def test_without_any_of_the_names_it_says_what_it_has(self, tmp_path: Path) -> None:
        names = [f"shape {n}" for n in range(20)]
        message = refused(tmp_path, to_glb(*character(names)), waves("x", "y"))
        assert "has none of the controls (x, y, ...); it has shape 0, shape 1, " in message
        assert "shape 11 and 8 more" in message
        assert "it has mesh0; " in refused(tmp_path, to_glb(*character([])), waves("x"))
        nameless = to_glb(*character(nodes=[{}]))
        assert "it has no names at all" in refused(tmp_path, nameless, waves("x"))


class TestRigs:
    @pytest.mark.parametrize("name", RIGS)
    def test_a_character_with_a_rigs_names_gets_that_rig(self, tmp_path: Path, name: str) -> None:
        rig = load_rig(name)
        shapes = [c for c in rig.names if c.rpartition(".")[2] not in BONE_CHANNELS]
        bones = list(dict.fromkeys(c.rpartition(".")[0] for c in set(rig.names) - set(shapes)))
        content = to_glb(*character(shapes, nodes=[{"name": bone} for bone in bones]))
        (tmp_path / "a.glb").write_bytes(content)
        found = rig_for(tmp_path / "a.glb")
        assert found is not None
        assert found == name or set(load_rig(found).names) >= set(rig.names)

    def test_canonical_curves_go_to_the_rig_that_the_file_has(self, tmp_path: Path) -> None:
        rig = load_rig("oculus")
        clip = waves(*ARKIT)
        animate(tmp_path, to_glb(*character([f"Head.{n}" for n in rig.names])), clip)
        back = read_clip(tmp_path / "out.glb")
        assert back.values == pytest.approx(retarget(clip, rig).values, abs=1e-6)

    def test_curves_of_a_named_rig_stay_as_they_are(self, tmp_path: Path) -> None:
        rig = load_rig("vrm1")
        clip = waves(*rig.names)
        animate(tmp_path, to_glb(*character(["aa", "jawOpen"])), clip, rig=rig)
        back = read_clip(tmp_path / "out.glb")
        assert back.curve("aa").tolist() == clip.curve("aa").tolist()
        assert not back.curve("jawOpen").any()

    def test_no_name_of_any_rig_is_none(self, tmp_path: Path) -> None:
        (tmp_path / "a.glb").write_bytes(to_glb(*character(["qqq"])))
        assert rig_for(tmp_path / "a.glb") is None


BONE_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")

BINDS_1 = {
    "aa": [{"node": 0, "index": 0, "weight": 1.0}, {"node": 1, "index": 1, "weight": 0.5}],
    "ou": [{"node": 0, "index": 1, "weight": 0.8}, {"node": 0, "index": 0, "weight": 0.25}],
    "blink": [{"node": 1, "index": 0, "weight": 1.0}],
}
GROUPS_0 = [
    {"name": "A", "presetName": "a", "binds": [
        {"mesh": 0, "index": 0, "weight": 100}, {"mesh": 1, "index": 1, "weight": 50}]},
    {"name": "U", "presetName": "u", "binds": [
        {"mesh": 0, "index": 1, "weight": 80}, {"mesh": 0, "index": 0, "weight": 25}]},
    {"name": "Blink", "presetName": "blink", "binds": [{"mesh": 1, "index": 0, "weight": 100}]},
]  # fmt: skip
SHAPES = (["M_A", "M_U"], ["E_Close", "E_A"])


class TestVrm:
    def test_expressions_of_vrm_1_move_what_three_vrm_moves(
        self, tmp_path: Path, reader: Reader
    ) -> None:
        self.compare(tmp_path, reader, vrm1(BINDS_1, *SHAPES), waves("aa", "ou", "blink"), "1")

    def test_expressions_of_vrm_0_move_what_three_vrm_moves(
        self, tmp_path: Path, reader: Reader
    ) -> None:
        clip = waves("A", "U", "Blink")
        names = {"A": "aa", "U": "ou", "Blink": "blink"}  # as three-vrm calls them
        self.compare(tmp_path, reader, vrm0(GROUPS_0, *SHAPES), clip, "0", names)

    @staticmethod
    def compare(
        folder: Path, reader: Reader, content: bytes, clip: Clip, version: str,
        names: dict[str, str] | None = None,
    ) -> None:  # fmt: skip
        rig = load_rig(f"vrm{version}")
        found = reader.load(animate(folder, content, clip, rig=rig))
        assert found["vrm"] == version
        states = reader.call("sample", TIMES)
        for state, row in zip(states, clip.at(TIMES), strict=True):
            values = {
                (names or {}).get(name, name): float(value)
                for name, value in zip(clip.names, row, strict=True)
            }
            for ours, theirs in zip(state["weights"], reader.call("express", values), strict=True):
                assert ours == pytest.approx(theirs, abs=PRECISION)
        assert any(max(weights) > 0.5 for state in states for weights in state["weights"])

    def test_canonical_curves_move_a_vrms_mouth(self, tmp_path: Path) -> None:
        animate(tmp_path, vrm1(BINDS_1, *SHAPES), waves(*ARKIT))
        assert read_clip(tmp_path / "out.glb").curve("M_A").max() > 0.1

    def test_a_custom_expression_named_like_a_control_moves(self, tmp_path: Path) -> None:
        custom = {"jawOpen": [{"node": 0, "index": 1, "weight": 1.0}]}
        content = vrm1({}, *SHAPES, **custom)
        animate(tmp_path, content, waves("jawOpen"))
        back = read_clip(tmp_path / "out.glb")
        assert back.curve("M_U").tolist() == waves("jawOpen").values[:, 0].tolist()

    def test_a_binary_expression_is_on_or_off(self, tmp_path: Path) -> None:
        document, data = from_glb(vrm1(BINDS_1, *SHAPES))
        document["extensions"]["VRMC_vrm"]["expressions"]["preset"]["aa"]["isBinary"] = True
        animate(tmp_path, to_glb(document, data), waves("aa"), rig=load_rig("vrm1"))
        assert set(read_clip(tmp_path / "out.glb").curve("M_A").tolist()) == {0.0, 1.0}

    @pytest.mark.parametrize(("version", "back"), [("1", False), ("0", True)])
    def test_the_head_turns_about_the_characters_own_axes(
        self, tmp_path: Path, reader: Reader, version: str, back: bool
    ) -> None:
        content = vrm1(BINDS_1, *SHAPES) if version == "1" else vrm0(GROUPS_0, *SHAPES)
        angles = np.array([[0, 0, 0], [0.4, 0.2, -0.3]])
        clip = Clip(("aa", "A", *HEAD_ANGLES), 60, np.hstack([np.zeros((2, 2)), angles]))
        reader.load(animate(tmp_path, content, clip, rig=load_rig(f"vrm{version}")))
        (state,) = reader.call("sample", [1 / 60])
        half_turn = np.diag([-1, 1, -1]) if back else np.eye(3)
        expected = half_turn @ head_rotations(angles[1]) @ half_turn
        found = Rotation.from_quat(state["turns"]["J_head"]).as_matrix()
        assert found == pytest.approx(expected, abs=1e-5)


class TestBones:
    def test_a_bone_moves_from_its_rest_in_its_parents_axes(
        self, tmp_path: Path, reader: Reader
    ) -> None:
        turn = Rotation.from_euler("xyz", [20, 30, 40], degrees=True)
        rest = Rotation.from_euler("xyz", [5, -10, 15], degrees=True)
        nodes = [
            {"name": "top", "rotation": turn.as_quat().tolist(), "scale": [2, 2, 2],
             "children": [1]},
            {"name": "jaw", "rotation": rest.as_quat().tolist(), "translation": [0, 0.1, 0]},
        ]  # fmt: skip
        names = tuple(f"jaw.{channel}" for channel in BONE_CHANNELS)
        row = np.array([0.01, 0.02, -0.03, 10.0, -20.0, 30.0])
        content = to_glb(*character(nodes=nodes))
        clip = Clip(names, 60, np.stack([row * 0, row]))
        reader.load(animate(tmp_path, content, clip))
        (state,) = reader.call("sample", [1 / 60])
        moved = Rotation.from_euler("xyz", row[3:], degrees=True)
        found = Rotation.from_quat(state["turns"]["jaw"])
        assert (found * (turn * moved * rest).inv()).magnitude() < 1e-5
        # In m of the scene: the parent is twice as large.
        expected = turn.apply(np.array([0, 0.2, 0]) + row[:3])
        assert state["places"]["jaw"] == pytest.approx(expected, abs=1e-6)
        back = read_clip(tmp_path / "out.glb")
        assert back.select(names).values == pytest.approx(clip.values, abs=1e-4)

    def test_few_keys_of_a_bone_are_within_tenths_of_mm_and_degrees(self, tmp_path: Path) -> None:
        times = np.arange(200)[:, None] / 60
        waves = np.sin(times * [2, 3, 4, 5]) * [0.02, 0.01, 15, 10]
        clip = Clip(("jaw.tx", "jaw.ty", "jaw.rx", "jaw.rz"), 60, waves)
        content = to_glb(*character(nodes=[{"name": "jaw", "scale": [1, 1, 1]}]))
        few = animate(tmp_path, content, clip, keys=0.05)
        back = read_clip(tmp_path / "out.glb").select(clip.names)
        off = np.abs(back.values - clip.values).max(axis=0)
        assert (off < [0.0005 + 1e-6, 0.0005 + 1e-6, 0.05, 0.05]).all()
        assert len(few) < len(animate(tmp_path, content, clip))

    def test_a_bone_that_rests_is_animated_too(self, tmp_path: Path) -> None:
        content = to_glb(*character(nodes=[{"name": "jaw"}]))
        clip = Clip(("jaw.rx",), 60, np.zeros((30, 1), np.float32))
        document, _ = from_glb(animate(tmp_path, content, clip))
        (channel,) = document["animations"][0]["channels"]  # glTF asks for at least one
        assert channel["target"] == {"node": 0, "path": "rotation"}
        back = read_clip(tmp_path / "out.glb")
        assert len(back) == len(clip)
        assert not back.values.any()

    def test_a_node_with_a_matrix_is_animated_from_where_it_was(
        self, tmp_path: Path, reader: Reader
    ) -> None:
        turn = Rotation.from_euler("xyz", [20, 30, 40], degrees=True)
        matrix = np.eye(4)
        matrix[:3, :3] = turn.as_matrix() * [1, 2, 3]
        matrix[:3, 3] = 0.1, 0.2, 0.3
        nodes = [{"name": "jaw", "matrix": matrix.T.ravel().tolist()}]
        clip = Clip(("jaw.tx", "jaw.ry"), 60, np.array([[0, 0], [0.5, 90]], np.float32))
        reader.load(animate(tmp_path, to_glb(*character(nodes=nodes)), clip))
        first, last = reader.call("sample", [0, 1 / 60])
        assert first["places"]["jaw"] == pytest.approx([0.1, 0.2, 0.3], abs=1e-6)
        assert (Rotation.from_quat(first["turns"]["jaw"]) * turn.inv()).magnitude() < 1e-5
        assert last["places"]["jaw"] == pytest.approx([0.6, 0.2, 0.3], abs=1e-6)

    def test_the_head_of_a_turned_skeleton_turns_about_the_scenes_axes(
        self, tmp_path: Path, reader: Reader
    ) -> None:
        up = Rotation.from_euler("xyz", [-90, 0, 30], degrees=True).as_quat().tolist()
        nodes = [
            {"name": "mixamorig:Neck", "rotation": up, "children": [2]},
            {"name": "mixamorig:Head", "rotation": up},
        ]
        angles = np.array([[0, 0, 0], [0.4, 0.2, -0.3]])
        clip = Clip(("jawOpen", *HEAD_ANGLES), 60, np.hstack([np.zeros((2, 1)), angles]))
        reader.load(animate(tmp_path, to_glb(*character(["jawOpen"], nodes=nodes)), clip))
        rest, last = (
            Rotation.from_quat(state["turns"]["mixamorigHead"])
            for state in reader.call("sample", [0, 1 / 60])
        )
        turn = (last * rest.inv()).as_matrix()
        assert turn == pytest.approx(head_rotations(angles[1]), abs=1e-5)
        back = read_clip(tmp_path / "out.glb")
        assert back.select(HEAD_ANGLES).values == pytest.approx(angles, abs=1e-5)


class TestTheRest:
    def test_nothing_that_was_there_changes(self, tmp_path: Path) -> None:
        document, data = character(["jawOpen"])
        document |= {
            "materials": [{"name": "m", "extensions": {"X_unknown": {"deep": [1, 2.5]}}}],
            "animations": [{"name": "old", "channels": [], "samplers": [], "extras": 3}],
            "extensions": {"X_unknown": {"a": None}}, "extensionsUsed": ["X_unknown"],
            "extras": {"who": "ü"}, "mystery": [True, {"b": 1e-7}], "cameras": [],
        }  # fmt: skip
        rest = struct.pack("<I4s", 4, b"OWN\0") + b"abcd"
        content = to_glb(document, data, rest)
        made = animate(tmp_path, content, waves("jawOpen"))
        after, binary = from_glb(made)
        for key, value in document.items():
            if isinstance(value, list) and key in {"animations", "accessors", "bufferViews"}:
                assert after[key][: len(value)] == value
            elif key != "buffers":
                assert after[key] == value
        assert list(after) == list(document)
        assert binary[: len(data)] == data
        assert made.endswith(rest)

    def test_pygltflib_reads_it_and_finds_the_old_beside_the_new(self, tmp_path: Path) -> None:
        animate(tmp_path, to_glb(*character(["jawOpen"])), waves("jawOpen"))
        document = pygltflib.GLTF2().load(str(tmp_path / "out.glb"))
        sampler = document.animations[0].samplers[0]
        view = document.bufferViews[document.accessors[sampler.output].bufferView]
        blob = document.binary_blob()[view.byteOffset :][: view.byteLength]
        assert np.frombuffer(blob, "<f4").tolist() == waves("jawOpen").values[:, 0].tolist()

    def test_a_file_without_data_gets_some(self, tmp_path: Path) -> None:
        document = {"asset": {"version": "2.0"}, "nodes": [{"name": "jaw"}]}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        content = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON") + text
        clip = Clip(("jaw.ty",), 60, np.array([[0], [0.5]], np.float32))
        animate(tmp_path, content, clip)
        assert read_clip(tmp_path / "out.glb").curve("jaw.ty").tolist() == [0, 0.5]

    def test_the_character_is_not_replaced(self, tmp_path: Path) -> None:
        (tmp_path / "a.glb").write_bytes(to_glb(*character(["jawOpen"])))
        options = ExportOptions(onto=tmp_path / "a.glb")
        with pytest.raises(LipwrightError, match=r"a\.glb: is the character itself; name another"):
            export_all([tmp_path / "a.glb"], Performance(waves("jawOpen")), options=options)


class TestGltf:
    def write(self, folder: Path, uri: str = "more/some%20data.bin") -> Path:
        document, data = character(["jawOpen"])
        (folder / "more").mkdir(parents=True)
        (folder / "more" / "some data.bin").write_bytes(data)
        (folder / "skin.png").write_bytes(b"\x89PNG\r\n\x1a\n...")
        document["buffers"][0]["uri"] = uri
        document["images"] = [{"uri": "skin.png", "name": "skin"}]
        (folder / "a.gltf").write_text(json.dumps(document))
        return folder / "a.gltf"

    def test_data_and_pictures_beside_it_come_into_the_glb(
        self, tmp_path: Path, reader: Reader
    ) -> None:
        source = self.write(tmp_path / "in")
        options = ExportOptions(onto=source)
        export_all([tmp_path / "out.glb"], Performance(waves("jawOpen")), options=options)
        document, binary = from_glb((tmp_path / "out.glb").read_bytes())
        (image,), (buffer,) = document["images"], document["buffers"]
        assert "uri" not in image | buffer
        view = document["bufferViews"][image["bufferView"]]
        assert binary[view["byteOffset"] :].startswith(b"\x89PNG")
        found = reader.load((tmp_path / "out.glb").read_bytes())
        assert found["meshes"][0]["targets"] == {"jawOpen": 0}

    def test_data_in_the_text_is_read(self, tmp_path: Path) -> None:
        document, data = character(["jawOpen"])
        coded = base64.b64encode(data).decode()
        document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{coded}"
        animate(tmp_path, json.dumps(document).encode(), waves("jawOpen"))
        assert read_clip(tmp_path / "out.glb").names == ("jawOpen",)

    @pytest.mark.parametrize(
        "uri",
        ["../secret.bin", "/etc/passwd", "more/../../secret.bin", "%2e%2e/secret.bin", "file:///x",
         "http://127.0.0.1/x", "..\\secret.bin", "link.bin", "C:/x", "~/x", "a\0b", ""],
    )  # fmt: skip
    def test_data_elsewhere_is_refused(self, tmp_path: Path, uri: str) -> None:
        (tmp_path / "secret.bin").write_bytes(bytes(1000))
        source = self.write(tmp_path / "in", uri)
        (tmp_path / "in" / "link.bin").symlink_to(tmp_path / "secret.bin")
        options = ExportOptions(onto=source)
        with pytest.raises(LipwrightError, match="outside its own folder"):
            export_all([tmp_path / "out.glb"], Performance(waves("jawOpen")), options=options)

    @pytest.mark.parametrize("uri", ["none.bin", "more", "data:;base64,####", "data:text/plain,x"])
    def test_data_that_is_missing_or_broken_is_refused(self, tmp_path: Path, uri: str) -> None:
        options = ExportOptions(onto=self.write(tmp_path / "in", uri))
        with pytest.raises(LipwrightError, match="buffer 0"):
            export_all([tmp_path / "out.glb"], Performance(waves("jawOpen")), options=options)


def changed(**changes: Any) -> bytes:
    document, data = character(["jawOpen"])
    return to_glb(document | changes, data)


GOOD = to_glb(*character(["jawOpen"]))
VIEW = {"buffer": 0, "byteOffset": 0, "byteLength": 36}
ACCESSOR = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}


class TestHostile:
    @pytest.mark.parametrize(
        ("content", "words"),
        [
            (b"", "is no GLB, VRM or .gltf"),
            (b"PK\3\4" + bytes(50), "is no GLB, VRM or .gltf"),
            (GOOD[:18], "is cut off after 18 bytes"),
            (GOOD[:200], "is cut off after 200 of"),
            (GOOD[:4] + b"\3\0\0\0" + GOOD[8:], "is a GLB of version 3, not 2"),
            (GOOD[:12] + b"\xff\xff\xff\x7f" + GOOD[16:], "a chunk reaches beyond the file's end"),
            (GOOD[:16] + b"JSOX" + GOOD[20:], "its first chunk is not JSON"),
            (GOOD[:20] + b"!" + GOOD[21:], "its JSON is broken"),
            (b"[" * 100_000, "is no GLB"),
            (b'{"a":' * 100_000, "its JSON is broken"),
            (b'{"asset": {"version": "2.0"}, "x": NaN}', "its JSON is broken: NaN is no number"),
            (b'{"asset": {"version": "2.0"}, "x": 1e999}', "its JSON is broken: 1e999"),
            (b'{"asset": {"version": "1.0"}}', "is of glTF '1.0', not 2.0"),
            (b'{"asset": {"version": "2.0", "minVersion": "2.1"}}', "is of glTF '2.1', not 2.0"),
            (b'{"asset": 3}', "is of glTF '', not 2.0"),
            (changed(nodes={"a": 1}), "'nodes' is not a list of objects"),
            (changed(nodes=[{"mesh": 7}]), "'mesh' is '7', not one of 1"),
            (changed(nodes=[{"mesh": True}]), "'mesh' is 'True'"),
            (changed(nodes=[{"mesh": 0, "children": [0]}]), "node 0 is its own ancestor"),
            (changed(nodes=[{"mesh": 0}, {"children": [0]}, {"children": [0]}]),
             "node 0 has two parents"),
            (changed(nodes=[{"mesh": 0, "scale": [1, 2]}]), "'scale' is not 3 numbers"),
            (changed(nodes=[{"mesh": 0, "weights": [1, 2]}]), "'weights' is not 1 numbers"),
            (changed(animations=3), "'animations' is not a list of objects"),
            (changed(bufferViews=[VIEW | {"byteLength": 10**30}]), "reaches beyond its buffer"),
            (changed(bufferViews=[VIEW | {"byteOffset": -4}]), "'byteOffset' is '-4'"),
            (changed(accessors=[ACCESSOR | {"count": 2**62}]), "reaches beyond its buffer view"),
            (changed(accessors=[ACCESSOR | {"bufferView": 9}]), "'bufferView' is '9', not one of"),
            (changed(accessors=[ACCESSOR | {"type": "VEC9"}]), "its type is unknown"),
            (changed(buffers=[{"byteLength": 10**15}]), "buffer 0 has 72 of 1000000000000000 byt"),
        ],
    )  # fmt: skip
    def test_it_is_refused_in_one_line(self, tmp_path: Path, content: bytes, words: str) -> None:
        message = refused(tmp_path, content)
        assert words in message
        assert "character.glb: " in message

    @pytest.mark.parametrize("name", ["none.glb", ".", "\0.glb"])
    def test_what_is_no_file_is_refused(self, tmp_path: Path, name: str) -> None:
        options = ExportOptions(onto=tmp_path / name)
        with pytest.raises(LipwrightError):
            export_all([tmp_path / "out.glb"], Performance(waves("jawOpen")), options=options)

    @IN_FOLDER
    @given(place=st.integers(0, len(GOOD) - 1), byte=st.integers(0, 255))
    def test_any_changed_byte_is_read_or_refused(
        self, tmp_path: Path, place: int, byte: int
    ) -> None:
        content = bytearray(GOOD)
        content[place] = byte
        try:
            animate(tmp_path, bytes(content), waves("jawOpen"))
        except LipwrightError as error:
            assert "\n" not in str(error)  # noqa: PT017  # either is right

    JUNK = (
        st.none() | st.booleans() | st.integers(-5, 10**20) | st.floats(allow_nan=False)
        | st.text(max_size=5) | st.lists(st.integers(-2, 9), max_size=4)
        | st.dictionaries(st.text(max_size=3), st.integers(0, 3), max_size=2)
    )  # fmt: skip

    @IN_FOLDER
    @given(data=st.data(), vrm=st.sampled_from([0, 1]))
    def test_any_changed_value_is_read_or_refused(
        self, tmp_path: Path, data: st.DataObject, vrm: int
    ) -> None:
        source = vrm1(BINDS_1, *SHAPES) if vrm else vrm0(GROUPS_0, *SHAPES)
        document, binary = from_glb(source)
        holder: Any = document
        while True:
            keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
            key = data.draw(st.sampled_from(keys))
            below = holder[key]
            if not isinstance(below, dict | list) or not below or data.draw(st.booleans()):
                break
            holder = below
        holder[key] = data.draw(self.JUNK)
        try:
            animate(tmp_path, to_glb(document, binary), waves("jawOpen", *HEAD_ANGLES))
        except LipwrightError as error:
            assert "\n" not in str(error)  # noqa: PT017  # either is right


class TestLips:
    @pytest.mark.parametrize("jaw", ["jawOpen", "Jaw_Open"])
    def test_a_jaw_alone_shuts_the_lips(self, tmp_path: Path, jaw: str) -> None:
        clip = read_clip(HELLO_CLIP)
        content = animate(tmp_path, to_glb(*character([jaw, "mouthSmileLeft"])), clip)
        (tmp_path / "a.glb").write_bytes(content)
        shown = read_clip(tmp_path / "a.glb").curve(jaw)
        wanted = np.maximum(0, clip.curve("jawOpen") - clip.curve("mouthClose"))
        assert shown == pytest.approx(wanted, abs=PRECISION)
        assert max(least_at_closures(shown)) < 0.02
        assert shown.max() > 0.2

    @pytest.mark.parametrize("rig", [None, "arkit"])
    def test_with_mouth_close_the_jaw_opens_alone(self, tmp_path: Path, rig: str | None) -> None:
        clip = read_clip(HELLO_CLIP)
        content = to_glb(*character(["jawOpen", "mouthClose"]))
        own = None if rig is None else load_rig(rig)
        (tmp_path / "a.glb").write_bytes(animate(tmp_path, content, clip, rig=own))
        shown = read_clip(tmp_path / "a.glb").curve("jawOpen")
        assert shown == pytest.approx(clip.curve("jawOpen"), abs=PRECISION)


class TestLeftOut:
    def test_it_is_what_moves_and_is_not_there(self, tmp_path: Path) -> None:
        clip = waves("jawOpen", "eyeBlinkLeft", "browInnerUp", "tongueRaise")
        still = clip.with_curves({"browInnerUp": np.full(len(clip), 0.5)})
        path = tmp_path / "simple.glb"
        path.write_bytes(to_glb(*character(["jawOpen", "mouthSmileLeft"])))
        assert left_out(path, Performance(still)) == ("eyeBlinkLeft", "tongueRaise")
        assert left_out(path, Performance(clip.select(["jawOpen"]))) == ()

    def test_lips_that_the_jaw_shuts_are_not_left_out(self, tmp_path: Path) -> None:
        path = tmp_path / "simple.glb"
        path.write_bytes(to_glb(*character(["jawOpen"])))
        assert left_out(path, Performance(waves("jawOpen", "mouthClose"))) == ()

    def test_after_retargeting_it_is_the_controls_of_the_characters_rig(
        self, tmp_path: Path
    ) -> None:
        path = tmp_path / "avatar.glb"
        names = [name for name in load_rig("oculus").names if name != "FF"]
        path.write_bytes(to_glb(*character(names)))
        assert left_out(path, Performance(read_clip(HELLO_CLIP))) == ("FF",)
