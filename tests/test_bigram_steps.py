"""What is done to stitched curves: valleys, constraints, speed (Xu et al. 2013, 2.2.1 to 2.2.3)."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.bigrams.steps import constrained, maxima, without_valleys
from lipwright.bigrams.values import BigramSet, Pose, constraint_key
from lipwright.clip import Clip
from lipwright.curves import limited, lowered_to_slope, widened_to_slope
from lipwright.passes import apply_passes, bigram_passes, constrain, limit_poses, remove_valleys
from lipwright.track import PhoneTrack

quick = settings(deadline=None, max_examples=60)
PAUSE = PhoneTrack(("sil",), np.array([0.0, 1.0]))

curves_of_a_pose = arrays(
    np.float64, st.integers(1, 40), elements=st.sampled_from([0, 0.1, 0.2, 0.5, 0.5, 0.9, 1])
)
POSES = (
    Pose("open"), Pose("W", 1), Pose("ShCh", 3), Pose("FV", 4, "widen"), Pose("PBM", 5, "widen"),
)  # fmt: skip
LIMITS = {("PBM", "open"): 0.5, ("FV", "open"): 0.5, ("ShCh", "open"): 0.5}
poses_over_time = arrays(np.float64, (12, len(POSES)), elements=st.floats(0, 1))


def bigram_set(**changes: Any) -> BigramSet:
    fields: dict[str, Any] = {
        "name": "mine", "language": "en", "licence": "", "source": "", "rig": "facefx",
        "classes": {"a": ("AA",)}, "poses": {pose.name: pose for pose in POSES}, "bigrams": {},
        "constraints": LIMITS,
    }  # fmt: skip
    return BigramSet(**{**fields, **changes})


class TestValleys:
    def test_maxima_within_the_window_are_joined_as_worked_by_hand(self) -> None:
        # Maxima: 1 at 0.1 s, 0.6 at 0.3 s, 0.8 at 0.7 s. With t_w = 0.1 s the window is 0.2 s: the
        # first two are seen at once, and at 0.2 s (1 + 0.6) / 2 = 0.8 takes the valley's place.
        # From 0.3 to 0.7 s it is twice as far, and the valley stays.
        curve = [0, 1, 0.2, 0.6, 0, 0, 0, 0.8, 0]
        clip = Clip(("open",), 10, np.array(curve)[:, None])
        filled = remove_valleys(0.1)(clip, PAUSE)
        wanted = [0, 1, 0.8, 0.6, 0, 0, 0, 0.8, 0]
        assert filled.curve("open") == pytest.approx(wanted, abs=1e-6)

    def test_the_line_goes_from_one_maximum_to_the_other_as_worked_by_hand(self) -> None:
        # From 0.9 to 0.3 in 3 frames: 0.9 - 0.2 a frame.
        filled = without_valleys(np.array([0, 0.9, 0.1, 0, 0.3, 0]), window=3)
        assert filled == pytest.approx([0, 0.9, 0.7, 0.5, 0.3, 0])

    def test_a_maximum_below_the_line_of_its_neighbours_goes_where_the_window_sees_all(
        self,
    ) -> None:
        curve = np.array([0, 1, 0, 0.2, 0, 1, 0])
        # Window 2: lines from 1 to 0.2 and back; the two of height 1 are 4 apart.
        assert without_valleys(curve, 2) == pytest.approx([0, 1, 0.6, 0.2, 0.6, 1, 0])
        assert without_valleys(curve, 4) == pytest.approx([0, 1, 1, 1, 1, 1, 0])

    def test_a_level_maximum_is_one_at_both_ends(self) -> None:
        curve = np.array([0, 1, 1, 1, 0.5, 1, 0])
        assert maxima(curve).tolist() == [1, 3, 5]
        assert without_valleys(curve, 2) == pytest.approx([0, 1, 1, 1, 1, 1, 0])

    def test_a_curve_that_begins_or_ends_high_has_a_maximum_there(self) -> None:
        assert maxima(np.array([1, 0, 0.5])).tolist() == [0, 2]
        assert maxima(np.array([0.5, 0.5, 0.5])).tolist() == []

    @quick
    @given(curves_of_a_pose, st.floats(0, 12))
    def test_no_valley_is_left_within_the_window(
        self, curve: npt.NDArray[np.float64], window: float
    ) -> None:
        filled = without_valleys(curve, window)
        for one, other in itertools.pairwise(maxima(filled)):
            if other - one <= window:
                least = min(filled[one], filled[other])
                assert filled[one : other + 1].min() >= least - 1e-9

    @quick
    @given(curves_of_a_pose, st.floats(0, 12))
    def test_a_second_time_changes_nothing(
        self, curve: npt.NDArray[np.float64], window: float
    ) -> None:
        filled = without_valleys(curve, window)
        assert without_valleys(filled, window).tolist() == filled.tolist()

    @quick
    @given(curves_of_a_pose, st.floats(0, 12))
    def test_only_what_lies_between_two_maxima_within_the_window_changes(
        self, curve: npt.NDArray[np.float64], window: float
    ) -> None:
        filled = without_valleys(curve, window)
        tops = maxima(curve)
        assert set(maxima(filled)) <= set(tops)
        for frame in np.flatnonzero(np.abs(filled - curve) > 1e-9):
            assert any(
                one < frame < other and other - one <= window
                for one, other in itertools.combinations(tops, 2)
            )
        assert curve.min() <= filled.min()
        assert filled.max() <= curve.max()

    @quick
    @given(curves_of_a_pose)
    def test_without_a_window_nothing_changes(self, curve: npt.NDArray[np.float64]) -> None:
        assert without_valleys(curve, 0).tolist() == curve.tolist()


class TestConstraints:
    @pytest.mark.parametrize(
        ("open_", "shut", "wanted"),
        [
            (0.9, 0.3, 0.2),  # 0.9 + 0.3 > 0.5: open ends at C - c_a = 0.5 - 0.3
            (0.9, 1.0, 0.0),  # 0.5 - 1 is below rest
            (0.1, 0.2, 0.1),  # 0.1 + 0.2 is within C
            (0.3, 0.2, 0.3),  # just C
            (0.4, 0.0, 0.4),  # nothing to give way to
            (0.9, 0.0, 0.5),  # over C alone
        ],
    )
    def test_the_weaker_pose_gives_way_as_worked_by_hand(
        self, open_: float, shut: float, wanted: float
    ) -> None:
        # By the paper's formula, whose sign slipped, the first would end at 0.9 - (0.5 - 0.9 - 0.3)
        # = 1.6: not less but more.
        clip = Clip(("open", "PBM"), 60, np.array([[open_, shut]]))
        given_way = constrain(bigram_set())(clip, PAUSE)
        assert given_way.values[0] == pytest.approx([wanted, shut], abs=1e-6)

    def test_each_gives_way_to_what_is_final(self) -> None:
        # FV 0.9 has 0.5 - 0.8 = 0 beside PBM; open then has 0.5 beside FV, but 0.2 beside "hat".
        poses = [Pose("open"), Pose("FV", 4), Pose("PBM", 5), Pose("hat", 3)]
        limits = {("FV", "PBM"): 0.5, ("FV", "open"): 0.5, ("hat", "open"): 0.6}
        values = np.array([[0.9, 0.9, 0.8, 0.4]])
        found = constrained(values, poses, limits, otherwise=2.0)
        assert found[0] == pytest.approx([0.2, 0, 0.8, 0.4])

    def test_of_equals_the_first_stays(self) -> None:
        values = np.array([[0.4, 0.4]])
        found = constrained(values, [Pose("a"), Pose("b")], {("a", "b"): 0.5}, otherwise=2.0)
        assert found[0] == pytest.approx([0.4, 0.1])

    @quick
    @given(poses_over_time, st.floats(0, 2))
    def test_no_pair_exceeds_its_c_but_where_the_stronger_does_alone(
        self, values: npt.NDArray[np.float64], otherwise: float
    ) -> None:
        found = constrained(values, POSES, LIMITS, otherwise)
        for weak, strong in itertools.combinations(range(len(POSES)), 2):  # in order of priority
            key = constraint_key(POSES[weak].name, POSES[strong].name)
            together = found[:, weak] + found[:, strong]
            alone = np.maximum(LIMITS.get(key, otherwise), found[:, strong])
            assert (together <= alone + 1e-9).all()

    @quick
    @given(poses_over_time)
    def test_nothing_rises_the_strongest_stays_and_a_second_time_changes_nothing(
        self, values: npt.NDArray[np.float64]
    ) -> None:
        found = constrained(values, POSES, LIMITS, 1.0)
        assert (found <= values).all()
        assert (found >= 0).all()
        assert found[:, -1].tolist() == values[:, -1].tolist()
        assert constrained(found, POSES, LIMITS, 1.0).tolist() == found.tolist()

    @quick
    @given(poses_over_time, st.permutations(range(len(POSES))))
    def test_the_order_of_the_poses_does_not_matter(
        self, values: npt.NDArray[np.float64], order: list[int]
    ) -> None:
        found = constrained(values, POSES, LIMITS, 1.0)
        other = constrained(values[:, order], [POSES[c] for c in order], LIMITS, 1.0)
        assert other.tolist() == found[:, order].tolist()

    def test_curves_that_are_no_poses_of_the_set_stay(self) -> None:
        clip = Clip(("open", "brow", "PBM"), 60, np.array([[0.9, 0.9, 1.0]]))
        given_way = constrain(bigram_set(otherwise=0.0))(clip, PAUSE)
        assert given_way.values[0] == pytest.approx([0, 0.9, 1])


def steps_of(curve: npt.NDArray[np.floating]) -> float:
    return float(np.abs(np.diff(curve, axis=0)).max(initial=0))


class TestSpeedOfPoses:
    def test_slopes_are_limited_as_worked_by_hand(self) -> None:
        # 15 a second is 0.25 a frame at 60 fps: a pulse of 7 frames still reaches 1, that of one
        # frame 0.25. A closure keeps its height and begins three frames earlier.
        pulse = [0.0] + [1.0] * 7 + [0.0]
        alone = [0.0] * 4 + [1.0] + [0.0] * 4
        values = np.array([pulse, alone, alone]).T
        clip = Clip(("open", "W", "PBM"), 60, values)
        slow = limit_poses(bigram_set())(clip, PAUSE)
        assert slow.curve("open").tolist() == [0, 0.25, 0.5, 0.75, 1, 0.75, 0.5, 0.25, 0]
        assert slow.curve("W").tolist() == [0] * 4 + [0.25] + [0] * 4
        assert slow.curve("PBM").tolist() == [0, 0.25, 0.5, 0.75, 1, 0.75, 0.5, 0.25, 0]

    @quick
    @given(poses_over_time, st.floats(0.01, 1))
    def test_no_slope_exceeds_the_limit_and_a_second_time_changes_nothing(
        self, values: npt.NDArray[np.float64], step: float
    ) -> None:
        found = limited(values, step, widen=(3, 4))
        assert steps_of(found) <= step + 1e-8
        assert limited(found, step, widen=(3, 4)).tolist() == found.tolist()
        assert (found[:, :3] <= values[:, :3]).all()
        assert (found[:, 3:] >= values[:, 3:]).all()
        assert found[:, 3:].max(axis=0).tolist() == values[:, 3:].max(axis=0).tolist()

    @quick
    @given(curves_of_a_pose, st.floats(0.01, 1))
    def test_a_lowered_curve_is_the_highest_that_is_slow_enough(
        self, curve: npt.NDArray[np.float64], step: float
    ) -> None:
        # Another way: no frame is higher than any other frame and the way from there.
        frames = np.arange(len(curve))
        wanted = (curve + step * np.abs(frames[:, None] - frames)).min(axis=1)
        assert lowered_to_slope(curve, step) == pytest.approx(wanted, abs=1e-8)
        assert widened_to_slope(-curve, step) == pytest.approx(-wanted, abs=1e-8)

    def test_slow_curves_stay_as_they_are_beside_quick_ones(self) -> None:
        slow = 0.1 * np.sin(np.arange(300) / 40) ** 2
        quick_one = np.where(np.arange(300) == 7, 1.0, slow)
        found = limited(np.stack([slow, quick_one], axis=1), 0.01)
        assert found[:, 0].tolist() == slow.tolist()
        assert found[40:, 1].tolist() == slow[40:].tolist()


def test_the_passes_of_a_set_are_those_of_the_paper_in_its_order() -> None:
    bigrams = bigram_set(smoothing=0.05, speed_limit=6.0)
    rng = np.random.default_rng(0)
    clip = Clip(tuple(bigrams.poses), 60, rng.random((200, len(POSES)), np.float32))
    by_hand = remove_valleys(0.05)(clip, PAUSE)
    by_hand = constrain(bigrams)(by_hand, PAUSE)
    by_hand = limit_poses(bigrams)(by_hand, PAUSE)
    whole = apply_passes(clip, PAUSE, bigram_passes(bigrams))
    assert whole.values.tolist() == by_hand.values.tolist()
    assert steps_of(by_hand.values) <= 6 / 60 + 1e-6
