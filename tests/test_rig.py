"""Rigs are closed, and fit clips to what they have."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, MIRROR
from lipwright.errors import LipwrightError
from lipwright.rig import RIGS, Control, Rig, canonical_rig, load_rig

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
