"""Rigs are closed, and fit clips to what they have."""

from __future__ import annotations

import json
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, MIRROR
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.rig import RIGS, Control, Rig, canonical_rig, load_rig, read_rig

NAN = float("nan")
INF = float("inf")
SMALL = Rig(
    "small",
    (Control("look", -1, 1), Control("open"), Control("lid", 0, 2, 1)),
    MappingProxyType({}),
)


class TestShipped:
    @pytest.mark.parametrize("name", RIGS)
    def test_every_rig_loads_and_says_where_it_comes_from(self, name: str) -> None:
        rig = load_rig(name)
        assert rig.name == name
        assert rig.source
        assert rig.license

    def test_the_arkit_rig_is_the_canonical_controls_in_order(self) -> None:
        assert canonical_rig().names == CANONICAL

    def test_its_mirror_pairs_are_those_of_the_canonical_controls(self) -> None:
        wanted = {name: other for name, other in MIRROR.items() if name != other}
        assert dict(canonical_rig().mirror) == wanted

    def test_its_controls_go_from_rest_at_0_to_1(self) -> None:
        for control in canonical_rig().controls:
            assert (control.low, control.rest, control.high) == (0, 0, 1)

    def test_an_unknown_rig_is_refused_with_the_known_ones(self) -> None:
        with pytest.raises(LipwrightError, match="no rig 'manga'; the rigs are: arkit"):
            load_rig("manga")

    def test_a_name_is_never_a_path(self) -> None:
        with pytest.raises(LipwrightError, match="no rig"):
            load_rig("../rigs/arkit")


class TestConstruction:
    @pytest.mark.parametrize(
        ("low", "high", "rest"),
        [
            (0, 1, 2),
            (0, 1, -1),
            (1, 0, 0.5),
            (1, 1, 1),
            (NAN, 1, 0),
            (0, NAN, 0),
            (0, 1, NAN),
            (0, INF, 0),
            (-INF, 1, 0),
        ],
    )
    def test_a_control_whose_rest_is_not_within_a_range_is_refused(
        self, low: float, high: float, rest: float
    ) -> None:
        with pytest.raises(ValueError, match="control 'a': rest"):
            Control("a", low, high, rest)

    def test_a_control_without_a_name_is_refused(self) -> None:
        with pytest.raises(ValueError, match="no name"):
            Control("")

    def test_a_rig_without_a_name_or_controls_is_refused(self) -> None:
        for name, controls in (("", (Control("a"),)), ("a", ())):
            with pytest.raises(ValueError, match="a name and at least one control"):
                Rig(name, controls, MappingProxyType({}))

    def test_names_that_repeat_are_refused(self) -> None:
        with pytest.raises(ValueError, match="names repeat"):
            Rig("a", (Control("x"), Control("x")), MappingProxyType({}))

    @pytest.mark.parametrize("mirror", [{"l": "r"}, {"l": "x", "x": "l"}, {"l": "r", "r": "m"}])
    def test_mirror_pairs_that_are_none_are_refused(self, mirror: dict[str, str]) -> None:
        controls = (Control("l"), Control("r"), Control("m"))
        with pytest.raises(ValueError, match="no mirror pair"):
            Rig("a", controls, MappingProxyType(mirror))

    def test_the_mirror_is_a_copy_that_cannot_be_written(self) -> None:
        pairs = {"l": "r", "r": "l"}
        rig = Rig("a", (Control("l"), Control("r")), MappingProxyType(pairs))
        pairs.clear()
        assert rig.mirror == {"l": "r", "r": "l"}
        with pytest.raises(TypeError):
            rig.mirror["l"] = "l"  # type: ignore[index]  # read-only


class TestFit:
    def test_it_orders_clips_leaves_out_and_fills_with_rest(self) -> None:
        clip = Clip(("open", "extra", "look"), 30, np.array([[2.0, 1, -3], [0.5, 1, 0.25]]))
        fitted = SMALL.fit(clip)
        assert fitted.names == ("look", "open", "lid")
        assert fitted.fps == 30
        assert fitted.values.tolist() == [[-1, 1, 1], [0.25, 0.5, 1]]
        assert clip.values[0, 0] == 2

    @given(arrays(np.float32, (4, 2), elements=st.floats(-5, 5, width=32)))
    def test_a_fitted_clip_is_in_range_and_fitting_again_changes_nothing(
        self, values: np.ndarray
    ) -> None:
        fitted = SMALL.fit(Clip(("lid", "look"), 60, values))
        for control in SMALL.controls:
            curve = fitted.curve(control.name)
            assert control.low <= curve.min()
            assert curve.max() <= control.high
        assert SMALL.fit(fitted).values.tolist() == fitted.values.tolist()
        assert set(fitted.curve("open").tolist()) == {0}

    def test_a_clip_of_the_rigs_own_controls_within_range_is_unchanged(self) -> None:
        values = np.random.default_rng(1).random((5, len(CANONICAL)), np.float32)
        clip = Clip(CANONICAL, 60, values)
        assert canonical_rig().fit(clip).values.tolist() == values.tolist()


LOOKS = {"gape": {"jawOpen": 1.0, "mouthSmile": 0.5}, "left": {"mouthSmileLeft": 1.0}}
ON_A_FACE = Rig("mouth", (Control("gape"), Control("left"), Control("ears")), {}, looks=LOOKS)


class TestLooks:
    def test_a_look_without_a_side_is_on_both(self) -> None:
        table = ON_A_FACE.look_of(("gape", "left"))
        seen = [
            {CANONICAL[column]: float(row[column]) for column in np.flatnonzero(row)}
            for row in table
        ]
        both = {"mouthSmileLeft": 0.5, "mouthSmileRight": 0.5}
        assert seen == [{"jawOpen": 1.0, **both}, {"mouthSmileLeft": 1.0}]

    def test_poses_add_up_on_the_face_and_what_has_no_look_is_not_seen(self) -> None:
        clip = Clip(("ears", "left", "gape"), 30, np.array([[1, 0.5, 0.4], [0, 0, 0]], np.float32))
        shown = ON_A_FACE.to_canonical(clip)
        assert shown.names == CANONICAL
        assert shown.fps == 30
        assert shown.curve("jawOpen").tolist() == pytest.approx([0.4, 0])
        assert shown.curve("mouthSmileLeft").tolist() == pytest.approx([0.7, 0])  # 0.5 + 0.4 / 2
        assert shown.curve("mouthSmileRight").tolist() == pytest.approx([0.2, 0])
        assert np.flatnonzero(shown.values.any(axis=0)).size == 3

    @pytest.mark.parametrize(
        ("looks", "reason"),
        [
            ({"hat": {"jawOpen": 1.0}}, "'hat' has a look and is no control"),
            ({"gape": {"jawOpenn": 1.0}}, "the look of 'gape' has 'jawOpenn' at 1.0"),
            ({"gape": {"jawOpen": NAN}}, "'jawOpen' at nan, which is no weight"),
            ({"gape": {"jawOpen": INF}}, "'jawOpen' at inf"),
        ],
    )
    def test_bad_looks_are_refused(self, looks: dict[str, dict[str, float]], reason: str) -> None:
        with pytest.raises(ValueError, match=reason):
            Rig("mouth", (Control("gape"),), {}, looks=looks)

    def test_looks_are_a_copy_that_cannot_be_written(self) -> None:
        looks = {"gape": {"jawOpen": 1.0}}
        rig = Rig("mouth", (Control("gape"),), {}, looks=looks)
        looks["gape"]["jawOpen"] = 0.0
        assert rig.looks["gape"]["jawOpen"] == 1
        with pytest.raises(TypeError):
            rig.looks["gape"]["jawOpen"] = 0.0  # type: ignore[index]  # read-only

    @pytest.mark.parametrize("name", ["facefx", "smartbody"])
    def test_the_shipped_looks_shut_the_lips_and_open_them(self, name: str, head: Head) -> None:
        rig = load_rig(name)
        shut, opened = {"facefx": ("PBM", "open"), "smartbody": ("bmp", "ah")}[name]
        clip = Clip((shut, opened), 30, np.eye(2, dtype=np.float32))
        apertures = head.aperture_curve(rig.to_canonical(clip).values)
        assert apertures[0] < 0.02 < 0.1 < apertures[1]

    def test_a_pose_that_the_rig_lacks_is_named_with_those_that_it_has(self) -> None:
        ON_A_FACE.check_controls(("ears", "gape"), "the set 'mine'")
        with pytest.raises(
            LipwrightError,
            match=r"^the set 'mine' moves the pose 'nose', which the rig 'mouth' lacks; it has "
            r"gape, left, ears$",
        ):
            ON_A_FACE.check_controls(("gape", "nose"), "the set 'mine'")


def rig_file(path: Path, **changes: Any) -> Path:
    fields: dict[str, Any] = {
        "name": "box", "controls": [{"name": "lid"}], "mirror": [], "source": "", "license": "",
    }  # fmt: skip
    fields.update(changes)
    path.write_text(json.dumps({key: value for key, value in fields.items() if value is not None}))
    return path


class TestFiles:
    def test_a_file_is_read_in_the_form_of_those_that_ship(self, tmp_path: Path) -> None:
        path = rig_file(
            tmp_path / "box.json",
            controls=[{"name": "lid", "high": 2}, {"name": "l"}, {"name": "r"}],
            mirror=[["l", "r"]], looks={"lid": {"jawOpen": 0.5}},
        )  # fmt: skip
        rig = load_rig(path)
        assert rig == read_rig(path)
        assert rig.controls[0] == Control("lid", 0, 2, 0)
        assert rig.mirror == {"l": "r", "r": "l"}
        assert rig.looks == {"lid": {"jawOpen": 0.5}}
        assert load_rig(str(path)).name == "box"

    @pytest.mark.parametrize(
        ("changes", "reason"),
        [
            ({"controls": None}, r"a rig needs 'controls', and this one has none"),
            ({"controls": []}, r"is no rig \(a rig has a name and at least one control\)"),
            ({"controls": [{"title": "lid"}]}, r"'controls' 1: 'title' is no field here"),
            ({"controls": 3}, r"is no rig"),
            ({"controls": [{"name": "lid", "high": "2"}]}, r"is no rig"),
            ({"controls": [{"name": "lid"}] * 2}, r"control names repeat"),
            ({"controls": [{"name": 7}]}, r"is no rig"),
            ({"name": 7}, r"is no rig"),
            ({"mirror": [["lid", "tail"]]}, r"no mirror pair"),
            ({"mirror": [["lid"]]}, r"is no rig"),
            ({"looks": {"nose": {"jawOpen": 1}}}, r"'nose' has a look and is no control"),
            ({"looks": {"lid": {"jaws": 1}}}, r"the look of 'lid' has 'jaws' at 1"),
            ({"looks": {"lid": {"jawOpen": "1"}}}, r"is no rig"),
            ({"looks": {"lid": {"jawOpen": NAN}}}, r"'lid': 'jawOpen' is NaN"),
            ({"looks": {"lid": {"jawOpen": 1e39}}}, r"'jawOpen' is 1e\+39"),
            ({"looks": ["lid"]}, r"is no rig"),
        ],
    )
    def test_what_is_no_rig_is_said_in_a_line(
        self, changes: dict[str, Any], reason: str, tmp_path: Path
    ) -> None:
        path = rig_file(tmp_path / "box.json", **changes)
        with pytest.raises(LipwrightError, match=reason) as refused:
            load_rig(path)
        assert str(refused.value).startswith(f"{path}: ")
        assert "\n" not in str(refused.value)

    @pytest.mark.parametrize("text", ["[]", "null", "3", '"rig"', "[" * 100_000, "{}"])
    def test_json_of_another_kind_is_no_rig(self, text: str, tmp_path: Path) -> None:
        path = tmp_path / "box.json"
        path.write_text(text)
        with pytest.raises(LipwrightError, match=r"is no rig|a rig needs|box.json:1:"):
            load_rig(path)

    def test_broken_json_is_named_with_line_and_column(self, tmp_path: Path) -> None:
        path = tmp_path / "box.json"
        path.write_text('{\n "name": }')
        with pytest.raises(LipwrightError, match=r"box\.json:2:10: Expecting value; a rig is a"):
            load_rig(path)

    def test_a_file_that_cannot_be_read_is_named(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match=r"none\.json: cannot be read \(No such file"):
            load_rig(tmp_path / "none.json")
        folder = tmp_path / "folder.json"
        folder.mkdir()
        with pytest.raises(LipwrightError, match=r"folder\.json: is a folder, device"):
            load_rig(folder)
        binary = tmp_path / "binary.json"
        binary.write_bytes(b"\xff\xfe\x00")
        with pytest.raises(LipwrightError, match=r"binary\.json: is not UTF-8 text"):
            load_rig(binary)

    def test_a_name_with_a_zero_byte_is_refused(self) -> None:
        with pytest.raises(LipwrightError, match="no rig"):
            load_rig("a\0.json")

    def test_a_huge_file_is_not_read(self, tmp_path: Path) -> None:
        path = tmp_path / "huge.json"
        with path.open("wb") as file:
            file.truncate(10**12)
        with pytest.raises(LipwrightError, match=r"huge\.json: over 4,000,000 bytes"):
            load_rig(path)
