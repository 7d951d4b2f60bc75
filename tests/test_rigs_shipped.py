"""The rigs that ship: closed sets, names of their documents, and lips that follow speech."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.controls import ARKIT, CANONICAL, MIRROR, both_sides
from lipwright.face.head import Head
from lipwright.pipeline import AnimateOptions, animate
from lipwright.retarget import apply_linear, retarget
from lipwright.rig import RIGS, LinearMapping, Rig, load_rig, rig_to_text
from lipwright.rig.describe import complaints, following, heard

ROOT = Path(__file__).resolve().parents[1]
HELLO = ROOT / "examples" / "hello.flac"
MAPPED = [name for name in RIGS if load_rig(name).mapping is not None]
LINEAR = [name for name in MAPPED if isinstance(load_rig(name).mapping, LinearMapping)]
HUMAN = [name for name in LINEAR if load_rig(name).looks and not load_rig(name).bones]
BILABIAL = ("P", "B", "M")


def text_of(name: str) -> str:
    return files("lipwright").joinpath("rigs", f"{name}.json").read_text("utf-8")


def posed(**weights: float) -> Clip:
    """One frame; names without their side mean both."""
    values = np.zeros((1, len(CANONICAL)), np.float32)
    for name, weight in weights.items():
        values[0, [CANONICAL.index(side) for side in both_sides(name)]] = weight
    return Clip(CANONICAL, 60, values)


def shown(rig: Rig, clip: Clip) -> Clip:
    """The clip as the rig's looks show it; drawings blended."""
    assert isinstance(rig.mapping, LinearMapping)
    return rig.to_canonical(apply_linear(clip, rig, rig.mapping))


class TestFiles:
    @pytest.mark.parametrize("name", RIGS)
    def test_a_file_is_what_saving_its_rig_writes(self, name: str) -> None:
        assert rig_to_text(load_rig(name)) == text_of(name)

    @pytest.mark.parametrize("name", RIGS)
    def test_a_rig_says_what_it_is_where_its_names_come_from_and_on_which_terms(
        self, name: str
    ) -> None:
        rig = load_rig(name)
        assert rig.title
        assert rig.source
        assert rig.license
        assert list(complaints(rig)) == []

    def test_every_file_is_in_the_list(self) -> None:
        folder = files("lipwright").joinpath("rigs")
        shipped = {path.name for path in folder.iterdir() if path.name.endswith(".json")}
        assert shipped == {f"{name}.json" for name in RIGS}

    @pytest.mark.parametrize("name", MAPPED)
    def test_every_canonical_control_moves_something_or_is_said_to_be_lacking(
        self, name: str
    ) -> None:
        rig = load_rig(name)
        lacking = {side for control in rig.lacks for side in both_sides(control)}
        assert heard(rig) | lacking == set(CANONICAL)
        assert heard(rig) & lacking == set()
        assert all(len(what.split()) > 1 for what in rig.lacks.values())

    @pytest.mark.parametrize("name", LINEAR)
    def test_a_mirrored_motion_moves_the_mirrored_controls(self, name: str) -> None:
        rig = load_rig(name)
        rng = np.random.default_rng(5)
        clip = Clip(CANONICAL, 60, rng.uniform(0, 0.7, (20, len(CANONICAL))).astype(np.float32))
        swapped = clip.select([MIRROR[control] for control in CANONICAL])
        mirrored = Clip(CANONICAL, 60, swapped.values)
        assert isinstance(rig.mapping, LinearMapping)
        one, other = (apply_linear(each, rig, rig.mapping) for each in (clip, mirrored))
        turned = {"ParamEyeBallX"} | {
            control for control in rig.names if re.search(r"\.(tx|ry|rz)$", control)
        }
        for control in rig.names:
            sign = -1 if control in turned else 1
            twin = rig.mirror.get(control, control)
            np.testing.assert_allclose(
                one.curve(control), sign * other.curve(twin), atol=2e-3, err_msg=control
            )


class TestNames:
    def test_oculus_has_the_15_visemes(self) -> None:
        assert " ".join(load_rig("oculus").names) == "sil PP FF TH DD kk CH SS nn RR aa E ih oh ou"

    def test_vrm_has_the_presets_that_three_vrm_knows(self) -> None:
        types = ROOT / "tests/web/node_modules/@pixiv/three-vrm-core/types/expressions"
        if not (types / "VRMExpressionPresetName.d.ts").is_file():
            pytest.skip("three-vrm is not installed: npm ci --prefix tests/web")
        text = (types / "VRMExpressionPresetName.d.ts").read_text("utf-8")
        presets = set(re.findall(r'readonly \w+: "(\w+)"', text))
        assert set(load_rig("vrm1").names) == presets

    def test_vrm_0_has_the_presets_of_its_specification(self) -> None:
        assert " ".join(sorted(load_rig("vrm0").names)) == (
            "A Angry Blink Blink_L Blink_R E Fun I Joy LookDown LookLeft LookRight LookUp Neutral "
            "O Sorrow U"
        )

    def test_drawn_mouths_have_the_shapes_of_rhubarb_and_of_papagayo(self) -> None:
        assert load_rig("rhubarb").names == tuple("ABCDEFGHX")
        names = " ".join(sorted(load_rig("preston-blair").names))
        assert names == "AI E FV L MBP O U WQ etc rest"
        assert [name for name in RIGS if load_rig(name).discrete] == ["preston-blair", "rhubarb"]

    def test_rocketbox_numbers_all_of_arkit(self) -> None:
        names = load_rig("rocketbox").names
        assert [int(name[3:5]) for name in names] == list(range(1, 53))
        assert {name[6:].casefold() for name in names} == {name.casefold() for name in ARKIT}

    def test_metahuman_curves_begin_as_they_do_in_unreal(self) -> None:
        assert all(name.startswith("CTRL_expressions_") for name in load_rig("metahuman").names)

    def test_live2d_eyes_rest_open(self) -> None:
        rests = {control.name: control.rest for control in load_rig("live2d").controls}
        assert {name for name, rest in rests.items() if rest} == {"ParamEyeLOpen", "ParamEyeROpen"}

    def test_names_of_mmd_fit_into_the_15_bytes_that_vmd_has_for_them(self) -> None:
        assert max(len(name.encode("shift_jis")) for name in load_rig("mmd").names) <= 15


class TestMotion:
    @pytest.mark.parametrize("name", MAPPED)
    def test_a_face_at_rest_is_a_rig_at_rest(self, name: str) -> None:
        rig = load_rig(name)
        if not isinstance(rig.mapping, LinearMapping):
            pytest.skip("follows modes of a reference face, whose mean is not at rest")
        moved = apply_linear(posed(), rig, rig.mapping)
        np.testing.assert_allclose(moved.values[0], rig.rest, atol=1e-6)

    @pytest.mark.parametrize(
        ("name", "both", "left", "right"),
        [
            ("vrm1", "blink", "blinkLeft", "blinkRight"),
            ("vrm0", "Blink", "Blink_L", "Blink_R"),
            ("mmd", "まばたき", "ウィンク２", "ｳｨﾝｸ２右"),
        ],
    )
    def test_a_blink_is_one_control_and_a_wink_another(
        self, name: str, both: str, left: str, right: str
    ) -> None:
        rig = load_rig(name)
        for weights, wanted in (
            ({"eyeBlink": 1.0}, (1.0, 0.0, 0.0)),
            ({"eyeBlinkLeft": 1.0}, (0.0, 1.0, 0.0)),
            ({"eyeBlinkRight": 1.0}, (0.0, 0.0, 1.0)),
            ({"eyeBlink": 0.5}, (0.25, 0.25, 0.25)),  # that add up to a half on either side
        ):
            moved = retarget(posed(**weights), rig)
            assert tuple(moved.select((both, left, right)).values[0]) == wanted

    def test_a_blink_shuts_the_eyes_of_live2d(self) -> None:
        moved = retarget(posed(eyeBlink=1.0), load_rig("live2d"))
        assert moved.select(("ParamEyeLOpen", "ParamEyeROpen")).values[0].tolist() == [0, 0]

    @pytest.mark.parametrize(
        ("name", "shut", "opened"),
        [
            ("oculus", ("sil", "PP"), ("nn", "ih", "E", "aa")),
            ("vrm1", ("neutral",), ("ou", "ih", "ee", "aa")),
            ("vrm0", ("Neutral",), ("U", "I", "E", "A")),
            ("mmd", ("ん",), ("う", "い", "え", "あ")),
            ("rhubarb", ("A", "X"), ("B", "C", "D")),
            ("rhubarb", ("X",), ("F", "E", "D")),
            ("rhubarb", ("X",), ("C", "H", "D")),  # as far open as C, not as far as D: the README
            ("preston-blair", ("MBP", "rest"), ("etc", "E", "AI")),
            ("preston-blair", ("WQ",), ("U", "O", "AI")),
        ],
    )
    def test_looks_are_shut_or_open_in_order(
        self, name: str, shut: tuple[str, ...], opened: tuple[str, ...], head: Head
    ) -> None:
        apertures = head.aperture_curve(load_rig(name).look_of((*shut, *opened)))
        assert max(apertures[: len(shut)]) < 0.005
        assert (np.diff(apertures[len(shut) :]) > 0).all()
        assert apertures[len(shut)] > 0.005

    @pytest.mark.parametrize("name", HUMAN)
    def test_smiles_open_no_lips(self, name: str, head: Head) -> None:
        rig = load_rig(name)
        closure = {"jawOpen": 0.2, "mouthClose": 0.2, "mouthPress": 0.25, "mouthRollUpper": 0.15}
        for weights in ({"mouthSmile": 0.8}, {**closure, "mouthSmile": 0.6}, closure):
            assert head.aperture_curve(shown(rig, posed(**weights)).values)[0] < 0.015

    @pytest.mark.parametrize("name", LINEAR)
    def test_a_rig_follows_with_controls_that_it_has(self, name: str) -> None:
        assert following(load_rig(name)) <= set(load_rig(name).names)


@pytest.fixture(scope="module")
def hello() -> tuple[Clip, list[tuple[float, float]]]:
    """The example, animated, and the spans of its p, b and m in s."""
    text = (ROOT / "examples" / "hello.txt").read_text("utf-8")
    spoken = animate(HELLO, text, options=AnimateOptions(fps=60)).performance
    assert spoken.track is not None
    edges = spoken.track.edges
    spans = [
        (float(edges[i]), float(edges[i + 1]))
        for i, phone in enumerate(spoken.track.phones)
        if phone in BILABIAL
    ]
    assert len(spans) >= 5
    return spoken.clip.select(CANONICAL), spans


class TestSpeech:
    @pytest.mark.parametrize("name", HUMAN)
    def test_lips_follow_those_of_the_head(
        self, name: str, hello: tuple[Clip, list[tuple[float, float]]], head: Head
    ) -> None:
        clip, _ = hello
        reference = head.aperture_curve(clip.values)
        estimated = head.aperture_curve(shown(load_rig(name), clip).values)
        assert np.corrcoef(reference, estimated)[0, 1] >= 0.97
        shut = reference < 0.05 * np.percentile(reference, 95)
        assert (estimated[shut] < 0.15 * np.percentile(estimated, 95)).all()

    @pytest.mark.parametrize("name", HUMAN)
    def test_lips_shut_at_every_bilabial(
        self, name: str, hello: tuple[Clip, list[tuple[float, float]]], head: Head
    ) -> None:
        clip, spans = hello
        estimated = head.aperture_curve(shown(load_rig(name), clip).values)
        limit = 0.15 * np.percentile(estimated, 95)
        for start, end in spans:
            frames = slice(int(start * clip.fps), int(np.ceil(end * clip.fps)) + 1)
            assert estimated[frames].min() < limit, (start, end)


class TestPage:
    page = (ROOT / "docs" / "rigs.md").read_text("utf-8")

    def test_it_lists_every_rig_with_its_number_of_controls(self) -> None:
        rows = re.findall(r"^\| `([\w-]+)` \| [^|]+ \| (\d+) \|", self.page, re.MULTILINE)
        assert {name: int(count) for name, count in rows} == {
            name: len(load_rig(name).controls) for name in RIGS
        }

    def test_its_example_is_a_rig_in_the_form_that_is_saved(self, tmp_path: Path) -> None:
        path = tmp_path / "puppet.json"
        path.write_text(self.page.split("```json\n")[1].split("```")[0], "utf-8")
        rig = load_rig(path)
        moved = retarget(posed(jawOpen=0.5, eyeBlinkLeft=1.0, jawLeft=1.0), rig)
        assert moved.values[0].tolist() == pytest.approx([0.85, 10.0, 0.0, 1.0])
        assert retarget(posed(jawOpen=1.0, mouthPucker=1.0), rig).curve("flap") == 0.9
