"""`Clip` cannot be wrong, and its operations on time keep the motion."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.clip import Clip, frame_times

RATES = (24.0, 25.0, 29.97, 30.0, 50.0, 59.94, 60.0, 120.0)
rates = st.sampled_from(RATES)
NAN, INFINITY = float("nan"), float("inf")


@st.composite
def clips(draw: st.DrawFn, least: int = 1) -> Clip:
    columns = draw(st.integers(1, 3))
    frames = draw(st.integers(least, 40))
    values = draw(arrays(np.float32, (frames, columns), elements=st.floats(0, 1, width=32)))
    return Clip(("jawOpen", "mouthClose", "tongueOut")[:columns], draw(rates), values)


def ramp(frames: int = 11, fps: float = 10.0) -> Clip:
    """One control that rises evenly from 0 to 1, another that stays at a half."""
    values = np.stack([np.linspace(0, 1, frames), np.full(frames, 0.5)], axis=1)
    return Clip(("jawOpen", "mouthClose"), fps, values)


class TestFrameTimes:
    @given(st.floats(0, 1e4), st.one_of(rates, st.floats(0.1, 1000)))
    def test_the_last_frame_is_at_or_after_the_end_and_less_than_a_frame_after_it(
        self, duration: float, fps: float
    ) -> None:
        times = frame_times(duration, fps)
        assert times[0] == 0
        assert times[-1] >= duration - 1.01e-6 / fps
        assert times[-1] < duration + 1 / fps

    @given(st.integers(0, 200_000), rates)
    def test_a_whole_number_of_frames_gains_none(self, frames: int, fps: float) -> None:
        assert len(frame_times(frames / fps, fps)) == frames + 1
        assert len(frame_times(float(Fraction(frames) / Fraction(str(fps))), fps)) == frames + 1

    @pytest.mark.parametrize("fps", [24.0, 25.0, 30.0, 60.0, 120.0])
    @pytest.mark.parametrize("seconds", [0, 1, 2, 7, 60, 3600])
    def test_whole_seconds_gain_no_frame(self, seconds: int, fps: float) -> None:
        assert len(frame_times(float(seconds), fps)) == seconds * fps + 1

    @given(st.integers(1, 1000), rates)
    def test_frames_are_evenly_spaced_from_zero(self, frames: int, fps: float) -> None:
        assert frame_times(frames / fps, fps) == pytest.approx(np.arange(frames + 1) / fps)

    @pytest.mark.parametrize("fps", [0.0, -1.0, NAN, INFINITY, 1000.1])
    def test_rates_without_frames_are_refused(self, fps: float) -> None:
        with pytest.raises(ValueError, match="fps is"):
            frame_times(1.0, fps)

    @pytest.mark.parametrize("duration", [-0.1, NAN, INFINITY])
    def test_durations_without_frames_are_refused(self, duration: float) -> None:
        with pytest.raises(ValueError, match="duration is"):
            frame_times(duration, 60)


class TestConstruction:
    def test_a_clip_tells_what_it_was_given(self) -> None:
        clip = ramp()
        assert len(clip) == 11
        assert clip.duration == 1.0
        assert clip.times == pytest.approx(np.linspace(0, 1, 11))
        assert clip.values.dtype == np.float32
        assert clip.column("mouthClose") == 1
        assert clip.curve("mouthClose").tolist() == [0.5] * 11

    def test_values_are_a_copy_that_cannot_be_written(self) -> None:
        values = np.zeros((2, 1), np.float32)
        clip = Clip(("a",), 60, values)
        values[0] = 9
        assert clip.values[0] == 0
        for view in (clip.values, clip.curve("a")):
            with pytest.raises(ValueError, match="read-only"):
                view[0] = 1
        with pytest.raises(FrozenInstanceError):
            clip.fps = 30  # type: ignore[misc]  # frozen

    @pytest.mark.parametrize("names", ["ab", ("a", ""), ("a", 1)])
    def test_what_is_no_row_of_names_is_refused(self, names: Any) -> None:
        with pytest.raises(ValueError, match="not a row of names"):
            Clip(names, 60, np.zeros((2, 2)))

    def test_names_that_repeat_are_refused_and_named(self) -> None:
        with pytest.raises(ValueError, match="names repeat: a, b"):
            Clip(("b", "a", "b", "a", "c"), 60, np.zeros((1, 5)))

    @pytest.mark.parametrize("shape", [(0, 2), (3, 1), (3, 3), (3,), (3, 2, 1), ()])
    def test_values_of_another_shape_are_refused(self, shape: tuple[int, ...]) -> None:
        with pytest.raises(ValueError, match=r"not \(T, 2\)"):
            Clip(("a", "b"), 60, np.zeros(shape))

    @pytest.mark.parametrize("value", [NAN, INFINITY, -INFINITY])
    def test_a_value_that_is_no_number_is_refused_with_its_place(self, value: float) -> None:
        values = np.zeros((4, 2))
        values[2, 1] = value
        with pytest.raises(ValueError, match="b at frame 2 is not a finite number"):
            Clip(("a", "b"), 60, values)

    @given(st.floats())
    def test_any_rate_is_above_0_and_at_most_1000_or_refused(self, fps: float) -> None:
        if 0 < fps <= 1000:
            assert Clip(("a",), fps, np.zeros((1, 1))).fps == fps
        else:
            with pytest.raises(ValueError, match="fps is"):
                Clip(("a",), fps, np.zeros((1, 1)))

    def test_an_unknown_control_is_named_with_the_known_ones(self) -> None:
        with pytest.raises(KeyError, match=r"no control 'x'; the clip has jawOpen, mouthClose"):
            ramp().curve("x")


class TestValues:
    def test_replacing_curves_leaves_the_others_and_the_original(self) -> None:
        clip = ramp()
        other = clip.with_curves({"jawOpen": np.ones(11)})
        assert other.curve("jawOpen").tolist() == [1] * 11
        assert other.curve("mouthClose").tolist() == clip.curve("mouthClose").tolist()
        assert clip.curve("jawOpen")[0] == 0

    def test_replacing_an_unknown_curve_or_one_of_another_length_is_refused(self) -> None:
        with pytest.raises(KeyError, match="no control 'x'"):
            ramp().with_curves({"x": np.ones(11)})
        with pytest.raises(ValueError, match="broadcast"):
            ramp().with_curves({"jawOpen": np.ones(10)})

    def test_selecting_orders_and_fills_with_rest(self) -> None:
        clip = ramp().select(["tongueOut", "mouthClose"])
        assert clip.names == ("tongueOut", "mouthClose")
        assert clip.curve("tongueOut").tolist() == [0] * 11
        assert clip.curve("mouthClose").tolist() == [0.5] * 11


class TestTime:
    @given(clips())
    def test_at_the_frames_are_the_values(self, clip: Clip) -> None:
        assert clip.at(clip.times) == pytest.approx(clip.values, abs=1e-5)

    @given(clips(), arrays(np.float64, 5, elements=st.floats(-10, 10)))
    def test_between_frames_it_is_what_numpy_interpolates_and_the_ends_are_held(
        self, clip: Clip, times: npt.NDArray[np.float64]
    ) -> None:
        for column, name in enumerate(clip.names):
            wanted = np.interp(times, clip.times, clip.curve(name))
            assert clip.at(times)[:, column] == pytest.approx(wanted, abs=1e-5)

    def test_the_ends_are_held_exactly(self) -> None:
        held = ramp().at([-5.0, 0.0, 1.0, 9.0])[:, 0]
        assert held.tolist() == [0, 0, 1, 1]

    @given(clips(), st.integers(1, 4))
    def test_resampling_to_a_multiple_and_back_changes_nothing(
        self, clip: Clip, times: int
    ) -> None:
        back = clip.resample(clip.fps * times).resample(clip.fps)
        assert len(back) == len(clip)
        assert back.values == pytest.approx(clip.values, abs=1e-4)

    @given(clips(), rates)
    def test_resampling_keeps_ends_and_range(self, clip: Clip, fps: float) -> None:
        other = clip.resample(fps)
        assert other.fps == fps
        assert clip.duration - 1e-6 <= other.duration < clip.duration + 1 / fps
        assert other.values[0] == pytest.approx(clip.values[0], abs=1e-6)
        assert other.values[-1] == pytest.approx(clip.values[-1], abs=1e-3)
        assert other.values.max() <= clip.values.max() + 1e-6
        assert other.values.min() >= clip.values.min() - 1e-6

    def test_a_straight_ramp_stays_one_at_any_rate(self) -> None:
        for fps in RATES:
            other = ramp().resample(fps)
            wanted = np.minimum(other.times, 1)
            assert other.curve("jawOpen") == pytest.approx(wanted, abs=1e-6)

    @pytest.mark.parametrize("fps", [0.0, -1.0, NAN, INFINITY, 1001.0])
    def test_resampling_to_a_rate_without_frames_is_refused(self, fps: float) -> None:
        with pytest.raises(ValueError, match="fps is"):
            ramp().resample(fps)

    @given(clips(least=2), st.floats(0.05, 20))
    def test_retiming_stretches_the_motion(self, clip: Clip, duration: float) -> None:
        other = clip.retime(duration)
        assert other.fps == clip.fps
        assert duration - 1e-6 <= other.duration < duration + 1 / clip.fps
        wanted = clip.at(other.times * clip.duration / duration)
        assert other.values == pytest.approx(wanted, abs=1e-5)
        assert other.values[-1] == pytest.approx(clip.values[-1], abs=1e-3)

    def test_retiming_a_single_frame_holds_it(self) -> None:
        still = Clip(("a",), 10, np.full((1, 1), 0.25))
        assert still.retime(1.0).values.tolist() == [[0.25]] * 11

    @pytest.mark.parametrize("duration", [0.0, -1.0, NAN, INFINITY])
    def test_retiming_to_no_duration_is_refused(self, duration: float) -> None:
        with pytest.raises(ValueError, match="duration is"):
            ramp().retime(duration)

    @given(clips(), clips())
    def test_concatenating_is_one_after_the_other(self, one: Clip, other: Clip) -> None:
        if one.names != other.names or one.fps != other.fps:
            with pytest.raises(ValueError, match="cannot be concatenated"):
                one.concatenate(other)
        else:
            both = one.concatenate(other)
            assert both.values[: len(one)].tolist() == one.values.tolist()
            assert both.values[len(one) :].tolist() == other.values.tolist()
