"""Pairs by rule: targets are met, closures are exact, neighbours shape what a phone leaves free."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from lipwright.bigrams.rules import (
    ARTICULATORS,
    CLOSURES,
    POSES,
    Target,
    load_targets,
    rule_bigram,
    rule_curves,
)
from lipwright.bigrams.spline import SAMPLES, dense
from lipwright.curves import Floats
from lipwright.phones import COMMON, PHONES, SILENCE

TARGETS = load_targets()
PAIRS = tuple(itertools.product(TARGETS, TARGETS))
TIMES = np.linspace(0, 1, SAMPLES)
EXACT = 1e-3  # control points are written with three digits


def curves(first: str, second: str) -> dict[str, Floats]:
    """The sampled curves of a pair, of all poses."""
    points = rule_curves(first, second)
    return {pose: dense(points.get(pose, ((0, 0), (1, 0)))) for pose in POSES}


def at(values: Floats, time: float) -> float:
    """The curve at a normalised time."""
    return float(np.interp(time, TIMES, values))


class TestTable:
    def test_every_common_class_and_silence_has_targets(self) -> None:
        assert {*COMMON, SILENCE} <= TARGETS.keys()

    def test_parts_are_one_whole_or_two_halves_and_common_diphthongs_have_halves(self) -> None:
        for targets in TARGETS.values():
            assert tuple(target.part for target in targets) in ((0,), (1, 2))
        assert {name for name in COMMON if len(TARGETS[name]) == 2} == {"ay", "aw", "oy", "ow"}

    def test_every_pose_is_an_articulators_or_shared_with_no_neighbour(self) -> None:
        moved = [pose for poses in ARTICULATORS.values() for pose in poses]
        assert sorted([*moved, *CLOSURES, "ShCh"]) == sorted(POSES)

    def test_silence_rests(self) -> None:
        assert not any(TARGETS[SILENCE][0].values.values())

    def test_sources_name_phones_of_the_table(self) -> None:
        for target in itertools.chain(*TARGETS.values()):
            source, *names = target.source.split()
            assert source in ("fitted", "rule")
            assert set(names) <= PHONES.keys()
            assert bool(names) == (source == "fitted")

    @pytest.mark.parametrize(
        ("more", "less", "pose"),
        [("aa", "d", "open"), ("aa", "w", "open"), ("w", "ow", "W"), ("ih", "aa", "wide"),
         ("sh", "r", "ShCh"), ("d", "z", "tRoof"), ("th", "d", "tTeeth"), ("kg", "w", "tBack"),
         ("w", "d", "tBack"), ("bmp", "f", "PBM"), ("f", "bmp", "FV")],
    )  # fmt: skip
    def test_phones_differ_as_they_are_made(self, more: str, less: str, pose: str) -> None:
        assert TARGETS[more][-1].values[pose] > TARGETS[less][-1].values[pose]

    def test_a_value_out_of_range_and_a_third_part_are_refused(self) -> None:
        row = TARGETS["d"][0]
        with pytest.raises(ValueError, match=r"d: open is 1.5"):
            Target("d", 0, "", "rule", {**row.values, "open": 1.5}, row.shares)
        with pytest.raises(ValueError, match="part is 3"):
            Target("d", 3, "", "rule", row.values, row.shares)


class TestPairs:
    def test_curves_rest_at_both_ends_and_stay_in_range(self) -> None:
        for points in (points for pair in PAIRS for points in rule_curves(*pair).values()):
            assert points[0] == (0, 0)
            assert points[-1] == (1, 0)
            assert all(0 <= value <= 1 for _, value in points)

    def test_each_pair_is_a_valid_bigram_by_rule(self) -> None:
        for pair in PAIRS:
            bigram = rule_bigram(*pair)
            assert bigram.pair == pair
            assert bigram.source == "rule"

    def test_silence_alone_moves_nothing(self) -> None:
        assert rule_curves(SILENCE, SILENCE) == {}

    @pytest.mark.parametrize("name", TARGETS)
    def test_beside_silence_a_phone_meets_its_targets(self, name: str) -> None:
        into, out = curves(SILENCE, name), curves(name, SILENCE)
        times = (0.5,) if len(TARGETS[name]) == 1 else (0.3, 0.7)
        for target, time in zip(TARGETS[name], times, strict=True):
            for pose in POSES:
                assert at(into[pose], 0.5 + time / 2) == pytest.approx(
                    target.values[pose], abs=0.02
                )
                assert at(out[pose], time / 2) == pytest.approx(target.values[pose], abs=0.03)
                assert at(into[pose], 0.25) == pytest.approx(0, abs=0.03)

    @pytest.mark.parametrize("place", [0, 1])
    def test_closures_are_exact_and_nothing_opens_them(self, place: int) -> None:
        held = np.abs(TIMES - (place / 2 + 0.25)) <= 0.05  # the middle fifth of the phone
        for pair in PAIRS:
            target = TARGETS[pair[place]][0]
            if target.closure:
                found = curves(*pair)
                level = target.values[target.closure]
                np.testing.assert_allclose(found[target.closure][held], level, atol=EXACT)
                for pose in CLOSURES[target.closure]:
                    np.testing.assert_allclose(found[pose][held], 0, atol=EXACT)

    def test_lips_shut_fully_and_nearly_so_for_f(self) -> None:
        assert TARGETS["bmp"][0].values["PBM"] == 1
        assert TARGETS["f"][0].values["FV"] >= 0.9

    @pytest.mark.parametrize("pose", CLOSURES)
    def test_no_other_phone_borrows_a_closure_beyond_the_near_third_of_it(self, pose: str) -> None:
        for first, second in PAIRS:
            if pose in (TARGETS[first][0].closure, TARGETS[second][0].closure):
                found = curves(first, second)[pose]
                if TARGETS[first][0].closure != pose:
                    assert at(found, 0.25) < 0.03
                if TARGETS[second][0].closure != pose:
                    assert at(found, 0.75) < 0.03

    def test_what_is_direct_between_two_vowels_does_not_dip(self) -> None:
        open_jaw = curves("aa", "ih")["open"][16:49]  # from the middle of one to that of the other
        assert np.all(np.diff(open_jaw) <= EXACT)

    def test_halves_of_a_diphthong_come_in_order(self) -> None:
        found = curves("d", "aw")
        assert at(found["open"], 0.65) > at(found["open"], 0.85) + 0.25
        assert at(found["W"], 0.85) > at(found["W"], 0.65) + 0.3


class TestCoarticulation:
    @pytest.mark.parametrize("consonant", ["d", "kg", "l", "h", "z"])
    def test_lips_round_before_a_round_vowel_and_spread_before_a_spread_one(
        self, consonant: str
    ) -> None:
        assert at(curves(consonant, "ow")["W"], 0.25) > 0.2
        assert at(curves(consonant, "ih")["wide"], 0.25) > at(curves(consonant, "w")["wide"], 0.25)
        assert at(curves("w", consonant)["W"], 0.75) > 0.4

    def test_what_owns_its_lips_keeps_them(self) -> None:
        assert at(curves("sh", "ih")["wide"], 0.25) == pytest.approx(0, abs=EXACT)
        assert at(curves("sh", "ow")["ShCh"], 0.25) == pytest.approx(0.85, abs=EXACT)

    def test_the_tongue_of_a_consonant_is_its_own(self) -> None:
        for name, pose in (("d", "tRoof"), ("th", "tTeeth"), ("kg", "tBack")):
            for other in ("aa", "ih", "w"):
                assert at(curves(name, other)[pose], 0.25) == pytest.approx(1, abs=EXACT)
                assert at(curves(other, name)[pose], 0.75) == pytest.approx(1, abs=EXACT)

    def test_a_jaw_that_is_not_its_own_follows_the_vowel(self) -> None:
        assert at(curves("kg", "aa")["open"], 0.25) > at(curves("kg", "w")["open"], 0.25) + 0.2


def test_a_table_of_the_callers_is_used() -> None:
    row = TARGETS["aa"][0]
    wide_open = Target("aa", 0, "", "rule", {**row.values, "open": 1.0}, row.shares)
    points = rule_curves(SILENCE, "aa", {**TARGETS, "aa": (wide_open,)})["open"]
    assert max(value for _, value in points) == 1


def test_a_class_without_a_target_is_refused() -> None:
    with pytest.raises(KeyError, match="zz"):
        rule_curves("zz", "aa")
