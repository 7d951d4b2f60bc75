"""`lipwright rigs list`, `show`, `check` and `new`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pygltflib
import pytest

from engine_clips import HELLO_CLIP, least_at_closures
from lipwright.cli import run
from lipwright.controls import CANONICAL
from lipwright.export import read_clip
from lipwright.export.rig_guess import guess_rig
from lipwright.retarget import retarget
from lipwright.rig import RIGS, LinearMapping, Rig, load_rig, rig_to_text

NAN = float("nan")


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> list[str]:
    capsys.readouterr()
    assert run(["rigs", *arguments]) == 0
    return capsys.readouterr().out.splitlines()


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that a command says when it refuses."""
    capsys.readouterr()
    assert run(["rigs", *arguments]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def said(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What a command that ends well says on the side."""
    capsys.readouterr()
    assert run(["rigs", *arguments]) == 0
    return capsys.readouterr().err.splitlines()


def write(**changes: Any) -> str:
    """A rig's file that can be used, but for the changes; its name."""
    data: dict[str, Any] = {
        "format": "lipwright-rig", "version": 1, "name": "mine", "title": "", "source": "",
        "license": "", "controls": [{"name": "jaw"}, {"name": "smile_L"}, {"name": "smile_R"}],
        "mirror": [["smile_L", "smile_R"]],
        "mapping": {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": 1.0}}}},
    }  # fmt: skip
    data |= changes
    Path("mine.json").write_text(json.dumps(data), "utf-8")
    return "mine.json"


class TestListAndShow:
    def test_all_rigs_that_ship_are_listed(self, capsys: pytest.CaptureFixture[str]) -> None:
        lines = printed(["list"], capsys)
        assert [line.split()[0] for line in lines[1:]] == list(RIGS)
        table = json.loads("\n".join(printed(["list", "--json"], capsys)))
        assert table["oculus"]["controls"] == 15
        assert table["rhubarb"]["discrete"] is True
        assert table["arkit"]["follows"] == "itself"

    @pytest.mark.parametrize("name", RIGS)
    def test_every_rig_is_shown_with_what_it_lacks(
        self, name: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        rig = load_rig(name)
        lines = printed(["show", name], capsys)
        text = "\n".join(lines)
        assert all(control in text for control in rig.names)
        for control, what in rig.lacks.items():
            assert f"  {control}: {what}" in lines

    def test_show_says_range_rest_mirror_and_sum(self, capsys: pytest.CaptureFixture[str]) -> None:
        lines = printed(["show", "live2d"], capsys)
        assert (
            "  ParamEyeLOpen  0 to 1, rests at 1, mirrors ParamEyeROpen = 1 - 1 eyeBlinkLeft"
            in lines
        )
        wink = "  blinkLeft  0 to 1, mirrors blinkRight = 1 eyeBlinkLeft - 1 eyeBlinkLeft x "
        assert any(line.startswith(wink) for line in printed(["show", "vrm1"], capsys))

    def test_show_as_json_prints_the_file(self, capsys: pytest.CaptureFixture[str]) -> None:
        text = "\n".join(printed(["show", "vrm1", "--json"], capsys)) + "\n"
        assert text == rig_to_text(load_rig("vrm1"))
        Path("copy.json").write_text(text, "utf-8")
        assert load_rig("copy.json") == load_rig("vrm1")

    def test_an_unknown_rig_is_refused(self, capsys: pytest.CaptureFixture[str]) -> None:
        assert "no rig 'manga'; the rigs are: arkit" in refused(["show", "manga"], capsys)


class TestCheck:
    def test_rigs_that_ship_have_nothing_to_complain_of(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        lines = said(["check", *RIGS], capsys)
        assert len(lines) == len(RIGS)
        assert all(line.endswith("nothing to complain of") for line in lines)

    @pytest.mark.parametrize(
        ("changes", "reason"),
        [
            ({"mapping": {"method": "linear", "controls": {"tail": {"from": {}}}}},
             "the mapping moves 'tail', which is no control of it"),
            ({"mapping": {"method": "linear", "controls": {"jaw": {"from": {"jaws": 1}}}}},
             "'jaws' is no canonical control"),
            ({"mapping": {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": NAN}}}}},
             "'jawOpen' is NaN"),
            ({"mapping": {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": 1e9}}}}},
             "'jawOpen' is 1000000000.0"),
            ({"mapping": {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": "1"}}}}},
             "'jawOpen' is \"1\", not a number"),
            ({"mapping": {"method": "linear", "controls": {"jaw": {"from": {}, "clamp": [1, 0]}}}},
             "the clamp 1 to 0 is empty"),
            ({"mapping": {"method": "linear", "controls": {},
                          "correctives": [{"control": "jaw", "of": ["jawOpen"], "gain": 1}]}},
             "the corrective of 'jaw' needs two sources or more"),
            ({"mapping": {"method": "magic"}}, "the methods are: linear, poses"),
            ({"mapping": {}}, "a rig needs 'method', and this one has none"),
            ({"mapping": []}, "is no rig"),
            ({"mirror": [["smile_L", "smile_R"], ["smile_R", "jaw"], ["jaw", "smile_L"]]},
             "go round"),
            ({"mirror": [["smile_L", "tail"]]}, "are no mirror pair"),
            ({"controls": [{"name": "jaw", "high": NAN}]}, "'controls' 1: 'high' is NaN"),
            ({"controls": [{"name": "jaw", "low": 1, "high": 0}]}, "control 'jaw'"),
            ({"controls": [{"name": "jaw", "rest": 2}]}, "rest 2 is not within 0.0 to 1.0"),
            ({"controls": [{"name": "jaw"}] * 2, "mirror": []}, "control names repeat"),
            ({"lacks": {"tail": "nothing"}}, "lacks 'tail', which is no canonical control"),
            ({"looks": {"jaw": {"jawOpen": NAN}}}, "'jawOpen' is NaN"),
            ({"version": 2}, "is a rig of version 2, and this Lipwright reads up to 1"),
            ({"version": "new"}, "'version' is 'new'"),
            ({"format": "lipwright-clip"}, "is a 'lipwright-clip', not a rig"),
            ({"bones": [{"name": "jaw", "parent": "skull"}]},
             "the parent 'skull' of the bone 'jaw' does not stand before it"),
        ],
    )  # fmt: skip
    def test_a_rig_that_cannot_be_used_is_one_line(
        self, changes: dict[str, Any], reason: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = write(**changes)
        line = refused(["check", path], capsys)
        assert path in line
        assert reason in line

    def test_files_that_are_no_rigs_are_one_line_each(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        Path("text.json").write_text('{"name": ', "utf-8")
        Path("list.json").write_text("[]", "utf-8")
        Path("binary.json").write_bytes(b"\xff\xfe\x00")
        Path("folder.json").mkdir()
        names = ["text.json", "list.json", "binary.json", "folder.json", "none.json"]
        capsys.readouterr()
        assert run(["rigs", "check", *names, "arkit"]) == 2
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == len(names) + 1
        assert all(name in line for name, line in zip(names, lines, strict=False))
        assert "text.json:1:" in lines[0]

    def test_what_a_rig_does_not_say_is_a_warning(self, capsys: pytest.CaptureFixture[str]) -> None:
        lines = said(["check", write(mirror=[])], capsys)
        assert "54 canonical controls move nothing, and 'lacks' does not say so" in lines[0]
        assert "mouthClose moves nothing: the lips will not shut at p, b and m" in lines[1]
        assert "'smile_L' and 'smile_R' look like two sides, and are no mirror pair" in lines[2]
        assert lines[3] == "mine.json: 3 controls, 1 follow"

    def test_lips_that_do_not_shut_are_a_warning_until_lacks_says_so(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        lacks = {name: "nothing" for name in CANONICAL if name != "jawOpen"}
        assert not any("p, b and m" in x for x in said(["check", write(lacks=lacks)], capsys))
        del lacks["mouthClose"]
        lines = said(["check", write(lacks=lacks)], capsys)
        assert any("1 canonical control moves nothing, and" in line for line in lines)
        assert any("the lips will not shut" in line for line in lines)

    def test_what_is_lacking_and_followed_at_once_is_a_warning(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        lines = said(["check", write(lacks={"jawOpen": "nothing: it is stiff"})], capsys)
        assert any("'lacks' has what the mapping follows: jawOpen" in line for line in lines)

    def test_a_clamp_beyond_the_range_is_a_warning(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        row = {"from": {"jawOpen": 1.0}, "clamp": [0, 2]}
        lines = said(
            ["check", write(mapping={"method": "linear", "controls": {"jaw": row}})], capsys
        )
        assert any("'jaw' is clamped to 0 to 2, and its range is 0 to 1" in line for line in lines)

    def test_a_rig_without_a_mapping_is_told_how_to_get_one(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        lines = said(["check", write(mapping=None)], capsys)
        assert any(
            "does not say how it follows speech; run: lipwright rigs fit" in x for x in lines
        )


def rows_of(rig: Rig) -> dict[str, dict[str, float]]:
    assert isinstance(rig.mapping, LinearMapping)
    return {name: dict(row.gains) for name, row in rig.mapping.rows.items()}


class TestNew:
    def test_controls_are_taken_for_what_their_names_say(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        controls = "jaw_open, Smile_L,mouthSmile_R,EYEBLINKLEFT,tail"
        lines = said(["new", "hero", "--controls", controls, "-o", "hero.json"], capsys)
        rig = load_rig("hero.json")
        assert rig.names == ("jaw_open", "Smile_L", "mouthSmile_R", "EYEBLINKLEFT", "tail")
        rows = rows_of(rig)
        assert rows["jaw_open"] == {"jawOpen": 1.0, "mouthClose": -1.0}
        assert rows["mouthSmile_R"] == {"mouthSmileRight": 1.0}
        assert rows["EYEBLINKLEFT"] == {"eyeBlinkLeft": 1.0}
        assert rows["Smile_L"] == {"mouthSmileLeft": 1.0}
        assert "resting until you say what they follow: tail" in lines[1]
        assert (
            "no mouthClose, so the jaw shuts the lips: jaw_open = jawOpen - mouthClose" in lines[2]
        )
        clip = read_clip(HELLO_CLIP)
        least = least_at_closures(retarget(clip, rig).curve("jaw_open"))
        assert len(least) == 7
        assert max(least) < 0.02 < min(least_at_closures(clip.curve("jawOpen")))

    def test_a_jaw_beside_mouth_close_opens_alone(self) -> None:
        guess = guess_rig("hero", ["jawOpen", "mouth_close"])
        assert rows_of(guess.rig) == {"jawOpen": {"jawOpen": 1.0}, "mouth_close": {"mouthClose": 1}}
        assert not guess.shutting

    @pytest.mark.parametrize(
        ("names", "like"),
        [
            (load_rig("oculus").names, "oculus"),
            (load_rig("vrm1").names, "vrm1"),
            (load_rig("vrm0").names, "vrm0"),
            (load_rig("metahuman").names, "metahuman"),
            (load_rig("cc4").names, "cc4"),
            (load_rig("rhubarb").names, "rhubarb"),
            (tuple(f"blendShape1.{name}" for name in load_rig("rocketbox").names), "rocketbox"),
        ],
    )
    def test_names_of_a_rig_that_ships_are_known_again(
        self, names: tuple[str, ...], like: str
    ) -> None:
        guess = guess_rig("hero", names)
        moved = load_rig(like).mapping
        assert isinstance(moved, LinearMapping)
        assert len(guess.known) >= len(moved.controls)
        assert {rig for rig, _ in guess.known.values()} <= {like, "arkit"}

    def test_visemes_of_other_avatars_are_those_of_oculus(self) -> None:
        guess = guess_rig("rpm", [f"viseme_{v}" for v in ("PP", "FF", "aa", "E", "I", "O", "U")])
        assert [old for _, old in guess.known.values()] == [
            "PP", "FF", "aa", "E", "ih", "oh", "ou",
        ]  # fmt: skip

    def test_sides_are_paired(self) -> None:
        rig = guess_rig("hero", ["smile_L", "smile_R", "LeftEarUp", "RightEarUp", "jaw"]).rig
        assert dict(rig.mirror) == {
            "smile_L": "smile_R", "smile_R": "smile_L",
            "LeftEarUp": "RightEarUp", "RightEarUp": "LeftEarUp",
        }  # fmt: skip

    def test_like_alone_is_a_copy_to_change(self, capsys: pytest.CaptureFixture[str]) -> None:
        said(["new", "hero", "--like", "vrm1", "-o", "hero.json"], capsys)
        hero = load_rig("hero.json")
        assert hero.name == "hero"
        assert hero.mapping == load_rig("vrm1").mapping

    def test_like_limits_the_guesses(self, capsys: pytest.CaptureFixture[str]) -> None:
        said(["new", "hero", "--like", "vrm1", "--controls", "AA,jawOpen", "-o", "h.json"], capsys)
        assert set(rows_of(load_rig("h.json"))) == {"AA"}

    def test_morph_targets_of_a_character_become_controls(
        self, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert run(["rigs", "new", "x", "--controls", "jawOpen", "-o", "x.json"]) == 0
        gltf = pygltflib.GLTF2(
            scene=0, scenes=[pygltflib.Scene(nodes=[0])], nodes=[pygltflib.Node(mesh=0)],
            buffers=[pygltflib.Buffer(byteLength=36)],
            bufferViews=[pygltflib.BufferView(buffer=0, byteLength=36)],
            accessors=[pygltflib.Accessor(bufferView=0, componentType=5126, count=3, type="VEC3",
                                          min=[0, 0, 0], max=[0, 0, 0])],
            meshes=[pygltflib.Mesh(
                primitives=[pygltflib.Primitive(
                    attributes=pygltflib.Attributes(POSITION=0),
                    targets=[pygltflib.Attributes(POSITION=0)] * 2)],
                extras={"targetNames": ["jawOpen", "Fcl_MTH_O"]})],
        )  # fmt: skip
        gltf.set_binary_blob(bytes(36))
        gltf.save_binary("hero.glb")
        lines = said(["new", "hero", "--from", "hero.glb", "-o", "hero.json"], capsys)
        assert load_rig("hero.json").names == ("jawOpen", "Fcl_MTH_O")
        assert lines[0].startswith("hero.json: hero, 2 controls, 2 follow")

    @pytest.mark.parametrize(
        ("arguments", "reason"),
        [
            ([], "say what the controls are"),
            (["--controls", "a", "--from", "b.glb"], "say what the controls are"),
            (["--controls", "a,a"], "the controls have 'a' twice"),
            (["--controls", "a,,b"], "an empty name"),
            (["--from", "none.glb"], "none.glb"),
            (["--like", "manga"], "no rig 'manga'"),
        ],
    )
    def test_what_cannot_be_made_is_one_line(
        self, arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert reason in refused(["new", "hero", *arguments, "-o", "hero.json"], capsys)
        assert not Path("hero.json").exists()

    def test_a_file_that_is_there_is_kept(self, capsys: pytest.CaptureFixture[str]) -> None:
        Path("hero.json").write_text("mine", "utf-8")
        assert "is there already" in refused(
            ["new", "hero", "--like", "vrm1", "-o", "hero.json"], capsys
        )
        assert Path("hero.json").read_text("utf-8") == "mine"
        assert "a rig is a JSON file" in refused(
            ["new", "hero", "--like", "vrm1", "-o", "hero.glb"], capsys
        )
