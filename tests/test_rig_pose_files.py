"""An artist's poses as files, and the commands that draw the reference and read the poses back."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
import pygltflib as gltf
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from lipwright.cli.rig_fitting import fit
from lipwright.cli.rig_poses import poses
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.glb import mesh_to_glb
from lipwright.export.gltf_character import read_character
from lipwright.export.gltf_poses import read_pose_frames
from lipwright.face.head import Head
from lipwright.face.shapes import load_reference_shape
from lipwright.retarget.pose_files import read_poses, table_to_csv, table_to_json
from lipwright.retarget.pose_table import PoseTable, pose_labels, to_mapping
from lipwright.retarget.poses import apply_poses
from lipwright.rig import Bone, Control, LinearMapping, PoseMapping, Rig, Row, load_rig, save_rig

EXAMPLES = Path(__file__).parents[1] / "examples"
CRAB = EXAMPLES / "crab" / "crab.rig.json"
TURNS = tuple(Control(f"jaw.{channel}", -30, 30) for channel in ("rx", "ry", "rz"))
RIG = Rig(
    "mixed",
    (Control("open"), Control("wide", -1, 1), Control("jaw.ty", -0.1, 0.1), *TURNS),
    {}, bones=(Bone("jaw"),),
)  # fmt: skip
LABELS = ("mean", *pose_labels(), "shut")


def planted(seed: int = 0) -> dict[str, dict[str, float]]:
    rng = np.random.default_rng(seed)
    return {
        label: {
            "open": round(float(rng.uniform(0, 1)), 3),
            "wide": round(float(rng.uniform(-1, 1)), 3),
            "jaw.ty": round(float(rng.uniform(-0.05, 0.05)), 4),
            **{c.name: round(float(rng.uniform(-20, 20)), 2) for c in TURNS},
        }
        for label in LABELS
    }


def invoke(command: click.Command, *words: str | Path) -> str:
    """What a command prints; what it refuses is raised."""
    result = CliRunner().invoke(command, list(map(str, words)))
    if result.exception is not None:
        raise result.exception
    return result.output


def written(folder: Path, table: PoseTable, suffix: str) -> Path:
    path = folder / f"poses{suffix}"
    names = [control.name for control in RIG.controls]
    text = table_to_json(table) if suffix == ".json" else table_to_csv(table, names)
    path.write_text(text, "utf-8")
    return path


def pose_values(mapping: PoseMapping) -> dict[str, dict[str, float]]:
    found = {pose.label: dict(pose.values) for pose in mapping.poses}
    return {"mean": dict(mapping.mean), **found, "shut": dict(mapping.shut)}


class TestTexts:
    @pytest.mark.parametrize("suffix", [".json", ".csv"])
    def test_poses_are_read_as_they_were_written(self, tmp_path: Path, suffix: str) -> None:
        path = written(tmp_path, PoseTable(planted()), suffix)
        mapping = read_poses(path, RIG)
        assert pose_values(mapping) == planted()
        assert [(p.mode, p.sigma) for p in mapping.poses[:3]] == [(1, -3), (1, 3), (2, -3)]

    @pytest.mark.parametrize("suffix", [".json", ".csv"])
    def test_what_is_left_out_stays_left_out(self, tmp_path: Path, suffix: str) -> None:
        table = {label: {} for label in LABELS} | {"mode1+3": {"open": 1.0}}
        assert pose_values(read_poses(written(tmp_path, PoseTable(table), suffix), RIG)) == table

    @pytest.mark.parametrize("mark", [";", "\t"])
    def test_tables_of_other_programs_are_read(self, tmp_path: Path, mark: str) -> None:
        lines = [mark.join(("pose", "open"))] + [f"{label}{mark}0.5" for label in LABELS[:-1]]
        lines[3] = f"mode1+3{mark}1"
        (tmp_path / "a.csv").write_text("\ufeff" + "\r\n".join([*lines, "", ""]), "utf-8")
        mapping = read_poses(tmp_path / "a.csv", RIG)
        assert pose_values(mapping)["mode1+3"] == {"open": 1.0}
        assert mapping.shut == {}

    def test_more_modes_are_read_too(self, tmp_path: Path) -> None:
        table = {label: {"open": 0.5} for label in pose_labels(6)}
        mapping = read_poses(written(tmp_path, PoseTable(table), ".json"), RIG)
        assert len(mapping.poses) == 12

    def test_other_deviations_than_three_are_read(self, tmp_path: Path) -> None:
        table = {label: {"open": 0.5} for label in pose_labels()}
        del table["mode2+3"]
        table["mode2+2.5"] = {"open": 0.75}
        mapping = read_poses(written(tmp_path, PoseTable(table), ".csv"), RIG)
        assert mapping.poses[3].sigma == 2.5

    def test_tongue_eyes_and_brows_keep_the_rows_that_the_rig_has(self) -> None:
        rows = {"wide": Row({"tongueOut": 1.0}), "open": Row({"jawOpen": 1.0})}
        rig = replace(RIG, mapping=LinearMapping(rows))
        table = PoseTable({label: {"jaw.rx": 3.0} for label in pose_labels()})
        assert dict(to_mapping(table, rig).rows) == {"wide": rows["wide"]}
        moved = PoseTable({label: {"wide": 0.5} for label in pose_labels()})
        assert dict(to_mapping(moved, rig).rows) == {}

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            ({"poses": {}}, "the pose mode1-3 is missing, and 7 more"),
            ({"version": 9}, "version 9.*pip install --upgrade lipwright"),
            ({"format": "lipwright-rig"}, "no file of poses; start from one of"),
            ({"mean": {"jow": 1}}, "mean: the rig 'mixed' has no control 'jow'; it has open, wide"),
            ({"mean": {"open": float("nan")}}, "mean: 'open' is nan, not a number"),
            ({"mean": {"open": "1"}}, "mean: 'open' is '1', not a number"),
            ({"mean": {"open": 100}}, "'open' is 100, and its range.* 0 to 1; change the pose"),
            ({"shut": [1]}, "'shut' is .1., not an object"),
            ({"pose": {}}, "the field 'pose' is unknown"),
            ({"reference": "grid"}, "no reference shape 'grid'; there are grid-s1"),
            ({"controls": {"jow": {"from": {}}}}, "controls: the rig 'mixed' has no control 'jow'"),
            ({"controls": {"open": {"from": {"jawOpen": 1}}}}, "moved by poses and by a row"),
        ],
    )
    def test_what_is_wrong_in_json_is_said_in_a_line(self, tmp_path, change, said) -> None:
        data = {**json.loads(table_to_json(PoseTable(planted()))), **change}
        (tmp_path / "a.json").write_text(json.dumps(data))
        with pytest.raises(LipwrightError, match=said) as caught:
            read_poses(tmp_path / "a.json", RIG)
        assert "\n" not in str(caught.value)
        assert str(tmp_path / "a.json") in str(caught.value)

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ('{"poses": {"mode1-3": {}, "mode1-3": {}}}', "'mode1-3' stands there twice"),
            ('{"poses": {"mode1-3": {}, "mode1-2": {}}}', "mode1-2 and mode1-3 are one pose twice"),
            ('{"poses": {"mode9+3": {}}}', "no pose 'mode9.3'; the poses are mean.* mode8.3"),
            ('{"poses": {"smile": {}}}', "no pose 'smile'"),
            ('{"poses": {"mode1+0.0001": {}}}', "sigma is 0.0001, not -3 or 3"),
            ('{"poses": {"mode1+' + "9" * 400 + '": {}}}', "sigma is inf"),
            ('{"mean": {"open": 1' + "0" * 400 + "}}", "a.json"),
            ('{"mean": {"open": -Infinity}}', "'open' is -inf, not a number"),
            ('{"poses": }', r"a\.json:1:11: Expecting value"),
            ("[]", "no file of poses"),
            ("[" * 100_000, "a.json"),
        ],
    )
    def test_broken_json_is_said_in_a_line(self, tmp_path, text, said) -> None:
        (tmp_path / "a.json").write_text(text)
        with pytest.raises(LipwrightError, match=said) as caught:
            read_poses(tmp_path / "a.json", RIG)
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize(
        ("text", "said"),
        [
            ("name,open\n", "the table's first column is not 'pose'"),
            ("", "the table's first column is not 'pose'"),
            ("pose,open,open\n", "line 1: the column 'open' stands there twice"),
            ("pose,open\nmode1-3,1\nmode1-3 ,1\n", "line 3: the pose 'mode1-3' stands there twice"),
            ("pose,open\nmode1-3,x\n", "line 2: 'open' is 'x', not a number"),
            ("pose,open\nmode1-3,inf\n", "line 2: 'open' is 'inf', not a number"),
            ("pose,open\nmode1-3,1,2\n", "line 2: 2 values for 1 controls"),
            ('pose,open\nmode1-3,"1', "a.csv"),
            ("pose,open\nmode1-3,1\n", "the pose mode1.3 is missing, and 6 more"),
        ],
    )
    def test_what_is_wrong_in_a_table_is_said_in_a_line(self, tmp_path, text, said) -> None:
        (tmp_path / "a.csv").write_text(text)
        with pytest.raises(LipwrightError, match=said) as caught:
            read_poses(tmp_path / "a.csv", RIG)
        assert "\n" not in str(caught.value)

    def test_an_empty_template_is_refused(self, tmp_path: Path) -> None:
        empty = PoseTable({label: {} for label in LABELS})
        with pytest.raises(LipwrightError, match="no pose moves anything"):
            read_poses(written(tmp_path, empty, ".json"), RIG)

    @pytest.mark.parametrize("name", ["none.json", "none.csv", "poses.txt", "."])
    def test_files_that_cannot_be_read_are_refused(self, tmp_path, monkeypatch, name) -> None:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(LipwrightError):
            read_poses(Path(name), RIG)


REST = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
PARENT_SCALE = 0.01  # a file in cm


def posed_glb(path: Path, frames: dict[str, dict[str, float]], times: np.ndarray) -> Path:
    """A GLB of two morph targets and a jaw bone in cm, each with an animation of its own."""
    data = bytearray()
    document = gltf.GLTF2(
        scene=0, scenes=[gltf.Scene(nodes=[0, 1])],
        nodes=[
            gltf.Node(name="face", mesh=0),
            gltf.Node(name="root", children=[2], scale=[PARENT_SCALE] * 3),
            gltf.Node(name="Jaw", translation=[1, 2, 3], rotation=REST.as_quat().tolist()),
        ],
        meshes=[gltf.Mesh(extras={"targetNames": ["Wide", "open"]}, primitives=[])],
    )  # fmt: skip

    def add(values: np.ndarray, kind: str) -> int:
        values = np.ascontiguousarray(values, np.float32)
        document.bufferViews.append(
            gltf.BufferView(buffer=0, byteOffset=len(data), byteLength=values.nbytes)
        )
        data.extend(values.tobytes())
        view = len(document.bufferViews) - 1
        count = len(values) if values.ndim > 1 else values.size
        document.accessors.append(
            gltf.Accessor(bufferView=view, componentType=5126, count=count, type=kind)
        )
        return len(document.accessors) - 1

    still = add(np.zeros((3, 3)), "VEC3")
    document.meshes[0].primitives.append(
        gltf.Primitive(
            attributes=gltf.Attributes(POSITION=still),
            targets=[gltf.Attributes(POSITION=still), gltf.Attributes(POSITION=still)],
        )
    )
    rows = list(frames.values())
    turns = Rotation.from_euler("xyz", [[r[c.name] for c in TURNS] for r in rows], degrees=True)
    places = np.array([[1, 2 + r["jaw.ty"] / PARENT_SCALE, 3] for r in rows])
    clock = add(times, "SCALAR")
    for name, parts in (
        ("shapes", [(0, "weights", np.array([[r["wide"], r["open"]] for r in rows]).ravel(),
                     "SCALAR")]),
        ("bones", [(2, "translation", places, "VEC3"),
                   (2, "rotation", (turns * REST).as_quat(), "VEC4")]),
    ):  # fmt: skip
        document.animations.append(
            gltf.Animation(
                name=name,
                samplers=[
                    gltf.AnimationSampler(input=clock, output=add(values, kind))
                    for _, _, values, kind in parts
                ],
                channels=[
                    gltf.AnimationChannel(
                        sampler=index, target=gltf.AnimationChannelTarget(node=node, path=where)
                    )
                    for index, (node, where, _, _) in enumerate(parts)
                ],
            )
        )
    document.buffers.append(gltf.Buffer(byteLength=len(data)))
    document.set_binary_blob(bytes(data))
    document.save(str(path))
    return path


def test_the_page_shows_the_file_of_the_crab(tmp_path: Path) -> None:
    page = (EXAMPLES.parent / "docs" / "rig-poses.md").read_text("utf-8")
    block = page.partition("```json\n")[2].partition("```")[0]
    (tmp_path / "a.json").write_text(block, "utf-8")
    rig = load_rig(CRAB)
    shown, there = (
        read_poses(path, rig) for path in (tmp_path / "a.json", CRAB.with_name("crab.poses.json"))
    )
    assert pose_values(shown) == pose_values(there)


class TestGlb:
    @pytest.mark.parametrize("count", [8, 9, 10])
    def test_frames_give_morph_targets_and_bones(self, tmp_path: Path, count: int) -> None:
        labels = {8: LABELS[1:-1], 9: LABELS[:-1], 10: LABELS}[count]
        frames = {label: planted()[label] for label in labels}
        path = posed_glb(tmp_path / "a.glb", frames, np.arange(count) / 24)
        save_rig(RIG, tmp_path / "mixed.json")
        printed = invoke(
            fit, tmp_path / "mixed.json", "--poses", path, "-o", tmp_path / "made.json"
        )
        assert "by 8 poses, which move 6 of its 6 controls" in printed
        assert ("without a shut pose" in printed) == (count < 10)
        made = load_rig(tmp_path / "made.json").mapping
        assert isinstance(made, PoseMapping)
        for label, values in pose_values(made).items():
            expected = frames.get(label, {})
            assert values == pytest.approx(expected, abs=2e-3), label

    def test_poses_a_second_are_read_from_a_baked_animation(self, tmp_path: Path) -> None:
        times = np.arange(9 * 24 - 23) / 24 + 1 / 24  # from frame 1 on, as programs count
        poses_s = list(planted().values())[:9]
        baked = {
            str(i): {
                key: (1 - i % 24 / 24) * poses_s[i // 24][key]
                + (i % 24 / 24) * poses_s[min(i // 24 + 1, 8)][key]
                for key in poses_s[0]
            }
            for i in range(len(times))
        }
        path = posed_glb(tmp_path / "a.glb", baked, times)
        frames = read_pose_frames(path, RIG, (8, 9, 10))
        expected = [[pose[name] for name in frames.names] for pose in poses_s]
        np.testing.assert_allclose(frames.values, expected, atol=2e-3)

    def test_another_number_of_frames_is_refused(self, tmp_path: Path) -> None:
        frames = {str(i): planted()["mean"] for i in range(5)}
        path = posed_glb(tmp_path / "a.glb", frames, np.arange(5) / 24)
        with pytest.raises(LipwrightError, match=r"keys at 5 times over 0\.2 s; set 8, 9 or 10"):
            read_pose_frames(path, RIG, (8, 9, 10))

    def test_a_file_without_the_targets_lists_what_it_has(self, tmp_path: Path) -> None:
        frames = {label: planted()[label] for label in pose_labels()}
        path = posed_glb(tmp_path / "a.glb", frames, np.arange(8) / 24)
        with pytest.raises(LipwrightError, match=r"'crab'.*it moves Wide, open, Jaw\.ty, Jaw\.rx"):
            read_pose_frames(path, load_rig(CRAB), (8, 9, 10))

    def test_a_name_that_is_alike_by_chance_and_still_is_no_pose(self, tmp_path, head) -> None:
        mean = load_reference_shape().human["mean"]["jawOpen"]
        opened = np.linspace(0, mean, 8, dtype=np.float32)[:, None]  # its tongueOut rests
        (tmp_path / "a.glb").write_bytes(mesh_to_glb(head, Clip(("jawOpen",), 1, opened)))
        with pytest.raises(LipwrightError, match=r"'crab'.*it moves jawOpen$"):
            read_pose_frames(tmp_path / "a.glb", load_rig(CRAB), (8, 9, 10))

    def test_frames_that_do_not_rest_are_out_of_range(self, tmp_path: Path) -> None:
        frames = {label: {**planted()[label], "open": 100.0} for label in LABELS}
        path = posed_glb(tmp_path / "a.glb", frames, np.arange(10) / 24)
        save_rig(RIG, tmp_path / "mixed.json")
        with pytest.raises(LipwrightError, match=r"a\.glb: mean: 'open' is 100, and its range"):
            invoke(fit, tmp_path / "mixed.json", "--poses", path, "-o", tmp_path / "b.json")
        assert not (tmp_path / "b.json").exists()

    @pytest.mark.parametrize("content", [b"", b"glTF", b"{}"])
    def test_what_is_no_glb_is_refused(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "a.glb").write_bytes(content)
        with pytest.raises(LipwrightError, match=r"a\.glb"):
            read_pose_frames(tmp_path / "a.glb", RIG, (8,))


class TestCommands:
    @pytest.fixture(scope="class")
    @staticmethod
    def sheet(tmp_path_factory: pytest.TempPathFactory, head: Head) -> Path:
        del head
        folder = tmp_path_factory.mktemp("poses") / "sheet"
        invoke(poses, "-o", folder)
        return folder

    def test_the_sheet_has_pictures_animation_and_templates(self, sheet: Path) -> None:
        assert {path.name for path in sheet.iterdir()} == {
            *(f"{label}.png" for label in LABELS), "sheet.png", "poses.glb", "poses.json",
            "poses.csv",
        }  # fmt: skip
        assert all(path.stat().st_mode & 0o444 == 0o444 for path in sheet.iterdir())
        assert len({(sheet / f"{label}.png").read_bytes() for label in LABELS}) == 10

    def test_its_own_animation_and_templates_give_its_own_poses(self, sheet: Path) -> None:
        human = load_reference_shape().human
        arkit = load_rig("arkit")
        expected = [human[label].get("jawOpen", 0.0) for label in LABELS]
        made = {}
        for name in ("poses.glb", "poses.json", "poses.csv"):
            out = sheet.parent / f"{name}.rig.json"
            invoke(fit, "arkit", "--poses", sheet / name, "-o", out)
            made[name] = load_rig(out).mapping
            values = pose_values(made[name])
            assert [values[label]["jawOpen"] for label in LABELS] == pytest.approx(expected)
            assert "eyeBlinkLeft" in made[name].rows
        clip = Clip(("shape1", "shape2"), 25, np.array([[1, 2], [2, -1], [0, 0]], np.float32))
        moved = [apply_poses(clip, arkit, mapping).values for mapping in made.values()]
        np.testing.assert_allclose(moved[0], moved[1], atol=1e-5)
        np.testing.assert_allclose(moved[1], moved[2], atol=1e-5)

    def test_the_template_of_a_rig_has_its_controls_and_no_values(self, tmp_path, head) -> None:
        del head
        invoke(poses, "-o", tmp_path / "crab", "--rig", CRAB, "--modes", "5")
        lines = (tmp_path / "crab" / "poses.csv").read_text().splitlines()
        assert lines[0].split(",")[1:] == list(load_rig(CRAB).names)
        assert lines[1] == "mean,,,,,,,,"
        assert len(lines) == 13

    def test_a_folder_that_is_there_is_left_as_it_was(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match="is there already; name a new folder"):
            invoke(poses, "-o", tmp_path)
        with pytest.raises(LipwrightError, match="9: grid-s1 has 8 shape modes"):
            invoke(poses, "-o", tmp_path / "new", "--modes", "9")
        with pytest.raises(LipwrightError, match="cannot be written"):
            invoke(poses, "-o", tmp_path / "none" / "new")
        assert not list(tmp_path.iterdir())

    def test_what_breaks_half_way_leaves_nothing(self, tmp_path, monkeypatch) -> None:
        def broken(*_: object) -> None:
            raise LipwrightError("no more paper")

        monkeypatch.setattr("lipwright.cli.rig_poses._write_templates", broken)
        monkeypatch.setattr("lipwright.cli.rig_poses._draw", lambda *_: None)
        with pytest.raises(LipwrightError, match="no more paper"):
            invoke(poses, "-o", tmp_path / "new")
        assert not list(tmp_path.iterdir())

    def test_a_rig_with_looks_is_fitted_to_them(self, tmp_path: Path, head: Head) -> None:
        del head
        printed = invoke(fit, "preston-blair", "-o", tmp_path / "made.json")
        assert "follows speech with" in printed
        made = load_rig(tmp_path / "made.json")
        assert isinstance(made.mapping, LinearMapping)

    @pytest.mark.parametrize(
        ("words", "said"),
        [
            (["-o", "a.txt"], "a rig is a JSON file"),
            (["-o", "a.json", "--poses", "b.json", "--mesh", "c.glb"], "two ways to fit"),
            (["-o", "a.json", "--poses", "a.json"], "a.json"),
            (["-o", "a.json", "--poses", "b.txt"], r"\.json, \.csv, \.glb"),
            (["-o", "a.json", "--mesh", "b.txt"], r"characters are read from \.glb"),
            (["-o", "a.json"], "nothing shows what the rig 'crab' looks like"),
        ],
    )
    def test_what_cannot_be_fitted_is_refused(
        self, tmp_path, monkeypatch, head, words, said
    ) -> None:
        del head
        monkeypatch.chdir(tmp_path)
        with pytest.raises(LipwrightError, match=said) as caught:
            invoke(fit, CRAB, *words)
        assert "\n" not in str(caught.value)
        assert not list(tmp_path.iterdir())

    def test_a_character_comes_back_as_it_was_exported(self, tmp_path: Path, head: Head) -> None:
        clip = Clip(("jawOpen",), 25, np.zeros((2, 1), np.float32))
        (tmp_path / "head.glb").write_bytes(mesh_to_glb(head, clip))
        found = read_character(tmp_path / "head.glb")
        assert found.shape_names == head.shape_names
        np.testing.assert_array_equal(found.triangles, head.triangles)
        weights = np.random.default_rng(0).uniform(0, 1, len(head.shape_names))
        np.testing.assert_allclose(found.pose(weights), head.pose(weights), atol=1e-3)
