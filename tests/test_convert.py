"""`lipwright convert`, and the options of whom curves are for, as a user gives them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from lipwright.controls import CANONICAL
from lipwright.export import read_clip
from lipwright.rig import load_rig
from test_cli import HELLO, assert_refused, lipwright

CLIP = HELLO.with_name("hello.clip.json")


def convert(folder: Path, *arguments: object) -> str:
    run = lipwright("convert", *arguments, cwd=folder)
    assert run.returncode == 0, run.stderr.decode()
    return run.stderr.decode()


class TestConvert:
    def test_curves_for_another_rig_in_another_format(self, tmp_path: Path) -> None:
        said = convert(tmp_path, CLIP, "--rig", "oculus", "-o", "a.csv", "-o", "a.rhubarb.tsv")
        assert "a.csv: 9.3 s, 15 controls\n" in said
        assert read_clip(tmp_path / "a.csv").names == load_rig("oculus").names
        assert (tmp_path / "a.rhubarb.tsv").read_text().startswith("0.00\tX\n")

    def test_a_round_trip_through_live_link_keeps_the_weights(self, tmp_path: Path) -> None:
        convert(tmp_path, CLIP, "-o", "a.livelink.csv")
        convert(tmp_path, "a.livelink.csv", "-o", "b.csv")
        before, after = read_clip(CLIP), read_clip(tmp_path / "b.csv")
        names = tuple(name for name in after.names if name in before.names)
        assert len(names) == 52
        assert after.fps == 60
        assert after.select(names).values == pytest.approx(
            before.select(names).values.clip(0, 1), abs=1e-5
        )

    def test_curves_of_a_rig_are_shown_as_they_look(self, tmp_path: Path) -> None:
        convert(tmp_path, CLIP, "--rig", "vrm1", "-o", "v.csv")
        convert(tmp_path, "v.csv", "--of-rig", "vrm1", "-o", "v.livelink.csv")
        before = read_clip(CLIP).curve("jawOpen")
        after = read_clip(tmp_path / "v.livelink.csv").curve("jawOpen")
        assert np.corrcoef(before, after)[0, 1] > 0.9

    def test_another_rate_and_the_phones_of_the_file(self, tmp_path: Path) -> None:
        convert(tmp_path, CLIP, "--fps", "30", "-o", "a.json")
        data = json.loads((tmp_path / "a.json").read_text())
        assert data["fps"] == 30
        assert data["track"]["words"][0]["text"] == "hello"

    def test_few_keys_make_the_file_smaller(self, tmp_path: Path) -> None:
        convert(tmp_path, CLIP, "-o", "every.json")
        convert(tmp_path, CLIP, "--keys", "0.01", "-o", "few.json")
        every, few = ((tmp_path / f"{n}.json").stat().st_size for n in ("every", "few"))
        assert every > 6 * few
        assert np.abs(
            read_clip(tmp_path / "few.json").values - read_clip(tmp_path / "every.json").values
        ).max() <= 0.01  # fmt: skip

    def test_edits_survive_a_later_run(self, tmp_path: Path) -> None:
        arguments = (CLIP, "-o", "a.csv", "--edits", "a.edits.json")
        convert(tmp_path, *arguments)
        lines = (tmp_path / "a.csv").read_text().splitlines()
        column = lines[0].split(",").index("browInnerUp")
        cells = lines[200].split(",")
        cells[column] = "0.75000"
        lines[200] = ",".join(cells)
        (tmp_path / "a.csv").write_text("\n".join(lines) + "\n")
        said = convert(tmp_path, *arguments)
        assert "a.csv: kept edits of 0.0 s in browInnerUp" in said
        assert read_clip(tmp_path / "a.csv").curve("browInnerUp")[199] == pytest.approx(0.75)

    def test_bones_become_a_skinned_head(self, tmp_path: Path) -> None:
        convert(tmp_path, CLIP, "--rig", "bones", "-o", "b.glb")
        data = (tmp_path / "b.glb").read_bytes()
        document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
        assert document["skins"]
        names = {node.get("name") for node in document["nodes"]}
        assert {bone.name for bone in load_rig("bones").bones} <= names

    def test_curves_that_a_character_lacks_are_named(self, tmp_path: Path) -> None:
        convert(tmp_path, CLIP, "-o", "head.glb")
        data = (tmp_path / "head.glb").read_bytes()
        (tmp_path / "odd.glb").write_bytes(data.replace(b'"mouthFunnel"', b'"mouthFunnex"'))
        said = convert(tmp_path, CLIP, "--onto", "odd.glb", "-o", "out.glb")
        assert "warning: odd.glb has no mouthFunnel; left out: 1 of the curves\n" in said
        assert "warning" not in convert(tmp_path, CLIP, "--onto", "head.glb", "-o", "out.glb")


class TestRefused:
    """One line, status 2, and no file."""

    @pytest.mark.parametrize(
        ("arguments", "needles"),
        [
            ((CLIP,), ("no output; name one with -o",)),
            ((CLIP, "-o", "a.csv", "--rig", "manga"), ("no rig 'manga'; the rigs are: arkit",)),
            ((CLIP, "-o", "a.csv", "--rig", "none.json"), ("none.json: cannot be read",)),
            ((CLIP, "-o", "a.csv", "--keys", "0"), ("keys within 0", "such as 0.01")),
            ((CLIP, "-o", "a.csv", "--fps", "0"), ("fps is 0",)),
            ((CLIP, "-o", "a.csv", "--onto", "x.glb"), ("--onto x.glb: only a GLB has",)),
            ((CLIP, "-o", "a.glb", "--onto", "x.glb"), ("x.glb",)),
            ((CLIP, "-o", "a.mp4", "--edits", "e.json"), ("--edits needs an output that can be",)),
            ((CLIP, "-o", "a.csv", "--of-rig", "vrm1"), ("has none of the controls of the rig",)),
            (("none.json", "-o", "a.csv"), ("none.json",)),
            (("x.a2f.json", "-o", "a.csv"), ("x.a2f.json: cannot be read back as a clip",)),
            (("-", "-o", "a.csv"), ("readable are .json, .csv, .livelink.csv",)),
            ((CLIP, "-o", "a.xyz"), ("a.xyz", ".livelink.csv")),
            ((CLIP, "-o", CLIP), ("is also read",)),
            ((CLIP, "-o", "a.mp4", "--size", "7x7"), ("7 x 7",)),
        ],
    )
    def test_what_cannot_be_done(
        self, arguments: tuple[object, ...], needles: tuple[str, ...], tmp_path: Path
    ) -> None:
        assert_refused(lipwright("convert", *arguments, cwd=tmp_path), *needles)
        assert list(tmp_path.iterdir()) == []

    def test_a_rig_that_no_head_shows_has_no_video(self, tmp_path: Path) -> None:
        crab = HELLO.parent / "crab" / "crab.rig.json"
        run = lipwright("convert", CLIP, "--rig", crab, "-o", "a.mp4", cwd=tmp_path)
        assert_refused(run, "a.mp4: the rig 'crab' does not say how it looks on a human face")
        run = lipwright("convert", CLIP, "--rig", crab, "-o", "a.csv", cwd=tmp_path)
        assert run.returncode == 0
        assert read_clip(tmp_path / "a.csv").names == load_rig(crab).names

    def test_unknown_curves_are_not_put_on_a_head(self, tmp_path: Path) -> None:
        (tmp_path / "odd.csv").write_text("time,lid\n0,0\n0.1,1\n")
        run = lipwright("convert", "odd.csv", "-o", "a.glb", cwd=tmp_path)
        assert_refused(run, "a.glb: odd.csv has curves of lid", "--of-rig")
        assert not (tmp_path / "a.glb").exists()


class TestAnimate:
    """`animate` takes the same options, and layers."""

    @pytest.mark.parametrize(
        ("arguments", "needle"),
        [
            (("--expression", "smug"), "no expression 'smug'; the expressions are: afraid"),
            (("--expression", "happy=9"), "9"),
            (("--intensity", "ears=2"), "nothing called 'ears' has an intensity"),
            (("--intensity", "4"), "intensity is 4"),
            (("--life", "--seed", "-1"), "the seed is -1"),
            (("--rig", "manga"), "no rig 'manga'"),
        ],
    )
    def test_layers_that_cannot_be_are_refused_before_any_work(
        self, arguments: tuple[str, ...], needle: str, tmp_path: Path
    ) -> None:
        run = lipwright(
            "animate", HELLO, "--text", "hello", "-o", "a.csv", *arguments, cwd=tmp_path
        )
        assert_refused(run, needle)
        assert list(tmp_path.iterdir()) == []

    def test_life_and_an_expression_lie_over_the_speech(self, tmp_path: Path) -> None:
        track = tmp_path / "a.json"
        convert(tmp_path, CLIP, "-o", track)
        track.write_text(
            json.dumps({"format": "lipwright-track", "version": 1,
                        **json.loads(track.read_text())["track"]})
        )  # fmt: skip
        common = ("animate", HELLO, "--phones", track)
        for name, more in {
            "plain": (), "live": ("--life", "--seed", "3"), "same": ("--life", "--seed", "3"),
            "other": ("--life", "--seed", "4"), "happy": ("--expression", "happy=0.7"),
        }.items():  # fmt: skip
            run = lipwright(*common, *more, "-o", f"{name}.csv", cwd=tmp_path)
            assert run.returncode == 0, run.stderr.decode()
        plain, live = (read_clip(tmp_path / f"{name}.csv") for name in ("plain", "live"))
        assert live.curve("eyeBlinkLeft").max() > 0.9
        assert live.curve("headPitch").std() > 0.001
        mouth = tuple(name for name in CANONICAL if name.startswith(("jaw", "mouth")))
        assert live.select(mouth).values.tolist() == plain.select(mouth).values.tolist()
        assert (tmp_path / "same.csv").read_bytes() == (tmp_path / "live.csv").read_bytes()
        assert (tmp_path / "other.csv").read_bytes() != (tmp_path / "live.csv").read_bytes()
        happy = read_clip(tmp_path / "happy.csv")
        assert happy.curve("mouthSmileLeft").mean() > plain.curve("mouthSmileLeft").mean() + 0.1
