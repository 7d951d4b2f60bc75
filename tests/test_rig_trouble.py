"""What careless and malicious people do to rigs, curves, exporters and characters."""

from __future__ import annotations

import json
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.cli import run
from lipwright.errors import LipwrightError
from lipwright.export import read_clip
from lipwright.export.gltf_curves import shared_keys
from lipwright.export.gltf_file import read_gltf
from lipwright.export.gltf_names import Character
from lipwright.expressions import load_expression
from lipwright.face.shapes import load_reference_shape
from lipwright.rig import load_rig
from made_gltf import character, to_glb

RIG: dict[str, Any] = {
    "format": "lipwright-rig", "version": 1, "name": "hero", "source": "", "license": "",
    "controls": [{"name": "jaw"}, {"name": "a_L"}, {"name": "a_R"}], "mirror": [["a_L", "a_R"]],
    "mapping": {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": 1}}}},
}  # fmt: skip
HUGE = 10**400


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Files lie in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def rig_file(**changes: Any) -> str:
    Path("hero.json").write_text(json.dumps({**RIG, **changes}))
    return "hero.json"


def refusal(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line of a command that ends with status 2."""
    assert run(arguments) == 2
    line = capsys.readouterr().err.strip()
    assert "\n" not in line
    return line


def linear(**row: Any) -> dict[str, Any]:
    return {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": 1}, **row}}}


class TestRigs:
    @pytest.mark.parametrize(
        ("changes", "place"),
        [
            ({"controls": 3}, "'controls' is 3, not a list"),
            ({"controls": [{"name": "jaw", "high": HUGE}]}, "'controls' 1: 'high' is 1000"),
            ({"controls": [{"name": "jaw", "high": True}]}, "'controls' 1: 'high' is true"),
            ({"mirror": [7]}, "'mirror' 1 is 7, not a list"),
            ({"bones": [{"name": "jaw", "at": [HUGE, 0, 0]}]}, "'bones' 1: 'at' 1 is 1000"),
            ({"bones": [{"name": "jaw", "parent": None}]}, "'bones' 1: 'parent' is null, not text"),
            ({"mapping": linear(clamp=[0, HUGE])}, "'jaw': 'clamp' 2 is 1000"),
            ({"mapping": linear(ofset=0.1)}, "'ofset' is no field here; the fields are from, off"),
            ({"mapping": {**linear(), "reference": 7}}, "'mapping': 'reference' is 7, not text"),
            ({"lacks": {"tongueOut": ["x"]}}, "'lacks': 'tongueOut' is [\"x\"], not text"),
            ({"discrete": "no"}, "'discrete' is \"no\", not true or false"),
            ({"title": "\ud800"}, r"'title' has '\ud800', with a control character"),
            ({"controls": [{"name": "\x1b[2J"}]}, r"'name' has '\x1b[2J', with a control char"),
            ({"controls": [{"name": "a\nb"}]}, r"'name' has 'a\nb', with a control character"),
        ],
    )
    def test_a_field_of_the_wrong_kind_is_named_by_its_place(
        self, changes: dict[str, Any], place: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        line = refusal(["rigs", "check", rig_file(**changes)], capsys)
        assert line.startswith("lipwright: hero.json: is no rig: ")
        assert place in line

    def test_a_key_that_stands_twice_is_not_passed_over(self) -> None:
        text = json.dumps(RIG).replace('"controls": {', '"controls": {"jaw": {"from": {}}, ')
        Path("hero.json").write_text(text)
        with pytest.raises(LipwrightError, match=r"hero\.json: the key 'jaw' stands twice"):
            load_rig("hero.json")

    @pytest.mark.parametrize("load", [load_rig, load_reference_shape])
    def test_a_pipe_is_no_rig_and_is_not_waited_for(self, load: Any) -> None:
        os.mkfifo("pipe.json")
        with pytest.raises(LipwrightError, match=r"pipe\.json: is (a folder, device or|no file)"):
            load("pipe.json")


def clip_file(names: list[str], rows: list[list[float]], **fields: Any) -> str:
    content = {"format": "lipwright-clip", "version": 1, "fps": 60, **fields}
    Path("clip.json").write_text(json.dumps({**content, "names": names, "values": rows}))
    return "clip.json"


class TestCurves:
    @pytest.mark.parametrize("name", ["a\rb", "a\0b", "\u2028", "\ud83d", "\x1b[2J"])
    def test_names_that_no_file_can_hold_are_refused(
        self, name: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = clip_file([name], [[0.5]])
        line = refusal(["convert", path, "-o", "out.csv"], capsys)
        assert "clip.json: control 1, " in line
        assert "has a control character or a line's end in its name; rename it" in line
        assert not Path("out.csv").exists()

    @pytest.mark.parametrize("suffix", [".vrma", ".motion3.json", ".vmd", ".bvh"])
    def test_huge_values_end_with_the_range_of_the_rig(self, suffix: str) -> None:
        path = clip_file(["jawOpen", "mouthClose"], [[3e38, -3e38], [-3e38, 3e38]])
        assert run(["convert", path, "-o", f"out{suffix}"]) == 0

    @pytest.mark.parametrize("fps", [1e-6, 1e-300])
    def test_days_between_frames_are_refused_before_memory_is_taken(
        self, fps: float, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = clip_file(["jawOpen"], [[0.5], [0.2]], fps=fps)
        line = refusal(["convert", path, "-o", "out.vmd"], capsys)
        assert f"has {fps:g} frames a second; at least 0.1" in line

    def test_a_day_of_curves_is_converted_in_parts(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = clip_file(["jawOpen"], [[0.5]] * 9000, fps=0.1)
        line = refusal(["convert", path, "-o", "out.rhubarb.tsv"], capsys)
        assert "lasts 89990 s, with 1 controls at 0.1 frames a second; convert it in parts" in line

    def test_half_a_letter_in_a_word_is_refused(self, capsys: pytest.CaptureFixture[str]) -> None:
        word = {"text": "a\ud800", "first": 0, "stop": 1, "confidence": None}
        track = {"phones": ["AA"], "edges": [0, 0.1], "stress": [1], "words": [word]}
        path = clip_file(["jawOpen"], [[0.5]], track=track)
        line = refusal(["convert", path, "-o", "out.srt"], capsys)
        assert r"clip.json: word 'a\ud800' has a control character or half a letter" in line


class TestFewKeys:
    def test_lines_over_many_runs_hold_every_frame_of_all_curves(self) -> None:
        walk = np.random.default_rng(7).normal(0, 0.02, (3001, 3)).cumsum(axis=0)
        values = walk.astype(np.float32)
        keys = shared_keys(values, 0.1)
        assert keys[0] == 0
        assert keys[-1] == 3000
        assert len(keys) < 1000
        lines = [np.interp(np.arange(3001), keys, column[keys]) for column in values.T]
        assert np.abs(np.stack(lines, axis=1) - values).max() <= 0.1 + 1e-6


def test_an_expression_out_of_a_pipe_is_refused_and_not_waited_for() -> None:
    os.mkfifo("pipe.json")
    with pytest.raises(LipwrightError, match=r"pipe\.json: is a device or pipe"):
        load_expression("pipe.json")


class TestNewRigs:
    @pytest.mark.parametrize("given", [["--like", "vrm1"], ["--controls", "jaw"]])
    @pytest.mark.parametrize("name", ["", "a\nb", "\ud83d"])
    def test_a_name_that_is_none_is_refused(
        self, name: str, given: list[str], capsys: pytest.CaptureFixture[str]
    ) -> None:
        line = refusal(["rigs", "new", name, *given, "-o", "new.json"], capsys)
        assert "name" in line
        assert not Path("new.json").exists()

    def test_a_control_s_name_with_a_line_s_end_is_refused(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        line = refusal(["rigs", "new", "hero", "--controls", "a\nb,c", "-o", "new.json"], capsys)
        assert r"'a\nb' is no name" in line


def animated(*channels: dict[str, Any]) -> str:
    """The file of a character whose channels share a sampler of one weight."""
    document, data = character(["jawOpen"])
    start, places = len(data), len(document["accessors"])
    data += struct.pack("<4f", 0, 1, 0.25, 0.5)  # times, then weights
    for shift in (0, 8):
        view = {"buffer": 0, "byteOffset": start + shift, "byteLength": 8}
        document["accessors"].append(
            {"bufferView": len(document["bufferViews"]), "componentType": 5126, "count": 2,
             "type": "SCALAR"}
        )  # fmt: skip
        document["bufferViews"].append(view)
    document["buffers"][0]["byteLength"] = len(data)
    document["animations"] = [
        {"samplers": [{"input": places, "output": places + 1}],
         "channels": [{"sampler": 0, "target": target} for target in channels]}
    ]  # fmt: skip
    Path("face.glb").write_bytes(to_glb(document, data))
    return "face.glb"


WEIGHTS = {"node": 0, "path": "weights"}


class TestCharacters:
    @pytest.mark.parametrize("path", [[], {}, ["weights"], 7])
    def test_a_channel_of_no_path_is_passed_over(self, path: Any) -> None:
        clip = read_clip(animated(WEIGHTS, {"node": 0, "path": path}))
        assert clip.names == ("jawOpen",)
        assert clip.curve("jawOpen")[[0, -1]].tolist() == [0.25, 0.5]

    def test_a_sampler_of_two_paths_is_checked_for_both(self) -> None:
        path = animated(WEIGHTS, {"node": 0, "path": "translation"})
        with pytest.raises(LipwrightError, match=r"a sampler has 2 numbers for 2 keys of 3"):
            read_clip(path)

    @pytest.mark.parametrize("preset", [[], {}, 7, None])
    def test_a_group_of_vrm_0_without_a_preset_keeps_its_name(self, preset: Any) -> None:
        document, data = character(["jawOpen"])
        group = {"name": "Ah", "presetName": preset, "binds": [{"mesh": 0, "index": 0}]}
        document["extensions"] = {"VRM": {"blendShapeMaster": {"blendShapeGroups": [group]}}}
        Path("face.vrm").write_bytes(to_glb(document, data))
        assert "Ah" in Character(read_gltf("face.vrm")).names()


class TestEdits:
    @pytest.mark.parametrize(
        ("changes", "reason"),
        [
            ({"fps": 1e-300, "names": ["jawOpen"], "values": [[1], [2]]}, "has no 'fps'"),
            ({"fps": 60, "names": ["jawOpen"], "values": [[1e300]]}, "frame 0 is no list of num"),
            ({"fps": 60, "names": ["\ud800"], "values": [[1]]}, "rename it"),
        ],
    )
    def test_changes_that_no_curve_can_take_leave_the_output_as_it_was(
        self, changes: dict[str, Any], reason: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = clip_file(["jawOpen"], [[0.5], [0.2]])
        command = ["convert", path, "--edits", "my.edits.json", "-o", "out.json"]
        assert run(command) == 0
        before = Path("out.json").read_text()
        edits = json.loads(Path("my.edits.json").read_text())
        Path("my.edits.json").write_text(json.dumps({**edits, "changes": changes}))
        capsys.readouterr()
        assert reason in refusal(command, capsys)
        assert Path("out.json").read_text() == before
