"""The lip figures give planted answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.evaluate.lips import (
    Aperture,
    LipScore,
    best_lag,
    closures,
    correlation,
    evaluate,
    false_closures,
    mistimed_closures,
    pool,
    real_closures,
    silence_share,
    speech_span,
    video_times,
)
from lipwright.track import PhoneTrack

NAN = float("nan")
FINE = np.arange(0, 3.0005, 0.001)  # s, times of an estimate at 1000 frames a second
VIDEO = video_times(75, 25)
SPEECH = PhoneTrack(("sil", "AA", "B", "AA", "M", "AA", "sil"),
                    np.array([0, 0.5, 1.0, 1.1, 1.8, 1.9, 2.5, 3.0]))  # fmt: skip


def wave(times: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """A motion that repeats nowhere within reach of a lag."""
    return 0.1 + 0.03 * np.sin(7 * times) + 0.03 * np.sin(17 * times + 1) + 0.01 * times


def shut_at(
    times: npt.NDArray[np.float64], spans: list[tuple[float, float]], level: float = 0.0
) -> Aperture:
    """An aperture of 0.2 that is `level` inside the spans."""
    values = np.full(len(times), 0.2)
    for start, end in spans:
        values[(times > start + 1e-9) & (times < end - 1e-9)] = level
    return Aperture(times, values)


OPEN_VIDEO = shut_at(VIDEO, [])
REAL = shut_at(VIDEO, [(1.0, 1.1), (1.8, 1.9)], 0.01)


class TestAperture:
    @pytest.mark.parametrize(
        ("times", "values"),
        [([0.0], [1.0]), ([0, 1], [1, 1, 1]), ([[0, 1]], [[1, 1]]), ([], [])],
    )
    def test_times_and_values_that_do_not_match_are_refused(
        self, times: list[float], values: list[float]
    ) -> None:
        with pytest.raises(ValueError, match="two or more"):
            Aperture(np.array(times), np.array(values))

    @pytest.mark.parametrize("times", [[0, 0], [1, 0], [0, NAN], [0, float("inf")]])
    def test_times_that_do_not_rise_are_refused(self, times: list[float]) -> None:
        with pytest.raises(ValueError, match="do not rise"):
            Aperture(np.array(times), np.array([1.0, 1.0]))

    @pytest.mark.parametrize("value", [-0.01, float("inf"), -float("inf")])
    def test_apertures_that_no_mouth_has_are_refused(self, value: float) -> None:
        with pytest.raises(ValueError, match="negative or infinite"):
            Aperture(np.array([0.0, 1.0]), np.array([0.1, value]))

    def test_a_video_without_a_face_is_refused(self) -> None:
        with pytest.raises(ValueError, match="the face is lost in every frame"):
            Aperture(np.array([0.0, 1.0]), np.array([NAN, NAN]))

    def test_it_is_a_copy_that_cannot_be_written(self) -> None:
        values = np.array([0.1, 0.2])
        aperture = Aperture(np.array([0.0, 1.0]), values)
        values[0] = 9
        assert aperture.values[0] == 0.1
        for array in (aperture.values, aperture.times):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1

    def test_lost_frames_are_bridged_and_the_ends_held(self) -> None:
        aperture = Aperture(np.arange(4.0), np.array([NAN, 0.2, NAN, 0.4]))
        assert aperture.at([-1, 0, 1, 2, 3, 9]) == pytest.approx([0.2, 0.2, 0.2, 0.3, 0.4, 0.4])

    def test_loud_is_the_95th_percentile_of_the_known_frames(self) -> None:
        values = np.concatenate([np.arange(101.0), [NAN] * 50])
        assert Aperture(np.arange(151.0), values).loud == 95

    def test_the_step_is_the_usual_one(self) -> None:
        assert Aperture(np.array([0, 0.04, 0.08, 0.2]), np.ones(4)).step == pytest.approx(0.04)

    def test_a_video_frame_is_at_the_middle_of_its_exposure(self) -> None:
        assert video_times(3, 25) == pytest.approx([0.02, 0.06, 0.10])
        assert video_times(0, 25).shape == (0,)


class TestSpan:
    def test_speech_is_from_the_first_to_the_last_sound(self) -> None:
        assert speech_span(SPEECH) == (0.5, 2.5)
        assert speech_span(PhoneTrack(("AA", "sil", "B"), np.arange(4.0))) == (0, 3)

    def test_a_track_of_silence_is_refused(self) -> None:
        with pytest.raises(ValueError, match="all silence"):
            speech_span(PhoneTrack(("sil",), np.arange(2.0)))


class TestCorrelation:
    REFERENCE = Aperture(VIDEO, wave(VIDEO))

    def test_a_curve_follows_itself_at_any_rate_and_gain(self) -> None:
        estimate = Aperture(FINE, 3 * wave(FINE) + 0.5)
        assert correlation(self.REFERENCE, estimate, SPEECH) == pytest.approx(1, abs=1e-5)

    def test_the_negative_of_a_curve_gives_minus_1(self) -> None:
        estimate = Aperture(FINE, 1 - wave(FINE))
        assert correlation(self.REFERENCE, estimate, SPEECH) == pytest.approx(-1, abs=1e-5)

    def test_it_is_numpys_correlation_of_the_frames_in_speech(self) -> None:
        random = np.random.default_rng(3)
        real, guess = random.random(75), random.random(75)
        inside = (VIDEO >= 0.5) & (VIDEO <= 2.5)
        r = correlation(Aperture(VIDEO, real), Aperture(VIDEO, guess), SPEECH)
        assert r == pytest.approx(np.corrcoef(real[inside], guess[inside])[0, 1])

    def test_what_happens_in_silence_does_not_count(self) -> None:
        values = wave(FINE)
        values[(FINE < 0.49) | (FINE > 2.51)] = 0.7
        estimate = Aperture(FINE, values)
        assert correlation(self.REFERENCE, estimate, SPEECH) == pytest.approx(1, abs=1e-5)

    def test_frames_without_a_face_do_not_count(self) -> None:
        values = wave(VIDEO)
        values[20:30] = NAN
        estimate = Aperture(FINE, np.where((FINE > 0.83) & (FINE < 1.17), 0.5, wave(FINE)))
        assert correlation(Aperture(VIDEO, values), estimate, SPEECH) == pytest.approx(1, abs=1e-5)

    @pytest.mark.parametrize("swap", [True, False])
    def test_a_mouth_that_does_not_move_has_no_r(self, swap: bool) -> None:
        still = Aperture(VIDEO, np.full(75, 0.1))
        pair = (still, self.REFERENCE) if swap else (self.REFERENCE, still)
        assert np.isnan(correlation(*pair, SPEECH))
        assert np.isnan(best_lag(*pair, SPEECH)[1])

    def test_two_frames_in_speech_are_too_few(self) -> None:
        short = PhoneTrack(("sil", "AA", "sil"), np.array([0, 1.0, 1.08, 3]))
        assert np.isnan(correlation(self.REFERENCE, self.REFERENCE, short))

    @given(st.integers(-30, 30))
    def test_a_planted_lag_is_found_positive_where_the_estimate_is_late(self, steps: int) -> None:
        late = steps * 0.005
        estimate = Aperture(FINE, wave(FINE - late))
        lag, r = best_lag(self.REFERENCE, estimate, SPEECH)
        assert lag == pytest.approx(late, abs=1e-9)
        assert r == pytest.approx(1, abs=1e-4)
        assert r >= correlation(self.REFERENCE, estimate, SPEECH)


class TestClosures:
    def test_real_closures_are_bilabials_whose_lips_nearly_close(self) -> None:
        found = real_closures(REAL, SPEECH)
        assert len(found) == 2
        assert 1.0 <= found[0] <= 1.1
        assert 1.8 <= found[1] <= 1.9

    def test_lips_that_stay_open_in_a_bilabial_are_no_closure(self) -> None:
        half = shut_at(VIDEO, [(1.0, 1.1), (1.8, 1.9)], 0.04)
        assert real_closures(half, SPEECH) == []
        assert closures(half, shut_at(FINE, []), SPEECH) == (0, 0)

    def test_lips_that_close_in_another_sound_are_no_closure(self) -> None:
        assert real_closures(shut_at(VIDEO, [(0.6, 0.8)]), SPEECH) == []

    @pytest.mark.parametrize("phone", ["P", "B", "M", "EM"])
    def test_every_bilabial_counts(self, phone: str) -> None:
        said = PhoneTrack(("AA", phone, "AA"), np.array([0, 1.0, 1.1, 3]))
        assert len(real_closures(REAL, said)) == 1

    def test_a_bilabial_between_two_video_frames_is_judged_by_the_nearest(self) -> None:
        said = PhoneTrack(("AA", "B", "AA"), np.array([0, 1.025, 1.055, 3]))
        assert real_closures(REAL, said) == [pytest.approx(1.06)] or real_closures(REAL, said) == [
            pytest.approx(1.02)
        ]

    def test_a_lost_frame_is_not_the_tightest(self) -> None:
        values = REAL.values.copy()
        values[25] = NAN  # 1.02 s
        assert len(real_closures(Aperture(VIDEO, values), SPEECH)) == 2

    def test_hits_and_misses_are_counted(self) -> None:
        for spans, hits in (
            ([(1.0, 1.1), (1.8, 1.9)], 2),
            ([(1.0, 1.1)], 1),
            ([(1.5, 1.6)], 0),
            ([], 0),
        ):
            assert closures(REAL, shut_at(FINE, spans), SPEECH) == (hits, 2)

    def test_a_closure_up_to_40_ms_beside_the_real_one_counts_and_a_later_one_does_not(
        self,
    ) -> None:
        moment = real_closures(REAL, SPEECH)[0]
        for offset, hits in ((-0.06, 0), (-0.038, 1), (0.0, 1), (0.038, 1), (0.06, 0)):
            time = moment + offset
            estimate = shut_at(FINE, [(time - 0.006, time + 0.006)])
            assert closures(REAL, estimate, SPEECH) == (hits, 2)

    def test_the_mark_is_15_percent_of_the_estimates_own_opening(self) -> None:
        for share, hits in ((0.14, 2), (0.16, 0)):
            estimate = shut_at(FINE, [(1.0, 1.1), (1.8, 1.9)], share * 0.2)
            assert closures(REAL, estimate, SPEECH) == (hits, 2)

    def test_a_mouth_that_never_opens_makes_no_closure(self) -> None:
        assert closures(REAL, Aperture(FINE, np.zeros(len(FINE))), SPEECH) == (0, 2)


class TestFalseClosures:
    @pytest.mark.parametrize(("length", "count"), [(0.025, 0), (0.035, 1), (0.3, 1)])
    @pytest.mark.parametrize("start", [1.3, 1.3012, 1.3025, 1.304])
    def test_shut_for_25_ms_is_none_and_for_35_ms_is_one(
        self, length: float, count: int, start: float
    ) -> None:
        times = np.arange(0, 3, 0.0001)
        estimate = shut_at(times, [(start, start + length)])
        assert false_closures(OPEN_VIDEO, estimate, SPEECH) == count

    def test_each_is_counted(self) -> None:
        estimate = shut_at(FINE, [(0.6, 0.7), (1.3, 1.4), (2.0, 2.1)])
        assert false_closures(OPEN_VIDEO, estimate, SPEECH) == 3

    def test_it_is_none_where_the_real_lips_are_not_surely_open(self) -> None:
        estimate = shut_at(FINE, [(1.02, 1.08), (1.3, 1.4)])
        assert false_closures(REAL, estimate, SPEECH) == 1

    def test_it_is_none_outside_speech(self) -> None:
        estimate = shut_at(FINE, [(0.1, 0.4), (2.6, 2.9)])
        assert false_closures(OPEN_VIDEO, estimate, SPEECH) == 0

    def test_it_is_none_where_the_real_lips_close_only_while_the_estimate_is_shut(self) -> None:
        real = shut_at(VIDEO, [(1.25, 1.35)], 0.02)
        assert false_closures(real, shut_at(FINE, [(1.2, 1.4)]), SPEECH) == 0
        assert false_closures(real, shut_at(FINE, [(1.45, 1.55)]), SPEECH) == 1

    def test_what_is_shut_too_long_is_mistimed_and_not_false(self) -> None:
        real = shut_at(VIDEO, [(1.25, 1.35)], 0.02)
        for span, count in (((1.29, 1.31), 0), ((1.29, 1.6), 1), ((1.1, 1.6), 2)):
            estimate = shut_at(FINE, [span])
            assert mistimed_closures(real, estimate, SPEECH) == count
            assert false_closures(real, estimate, SPEECH) == 0

    def test_nearly_shut_is_not_shut(self) -> None:
        for share, count in ((0.09, 1), (0.11, 0)):
            estimate = shut_at(FINE, [(1.3, 1.4)], share * 0.2)
            assert false_closures(OPEN_VIDEO, estimate, SPEECH) == count


class TestSilence:
    def test_a_planted_share_is_found(self) -> None:
        values = np.where((FINE <= 0.5) | (FINE >= 2.5), 0.03, 0.2)
        assert silence_share(Aperture(FINE, values), SPEECH) == pytest.approx(0.15, abs=0.001)

    def test_a_margin_leaves_out_what_is_beside_speech_and_not_the_ends_of_the_recording(
        self,
    ) -> None:
        values = np.where((FINE < 0.4) | (FINE > 2.6), 0.0, 0.2)
        estimate = Aperture(FINE, values)
        assert silence_share(estimate, SPEECH) == pytest.approx(0.2, abs=0.01)
        assert silence_share(estimate, SPEECH, margin=0.11) == 0

    def test_without_silence_a_face_in_it_or_any_opening_there_is_none(self) -> None:
        spoken = PhoneTrack(("AA",), np.array([0.0, 3.0]))
        assert np.isnan(silence_share(shut_at(FINE, []), spoken))
        lost = np.where((VIDEO < 0.51) | (VIDEO > 2.49), NAN, 0.2)
        assert np.isnan(silence_share(Aperture(VIDEO, lost), SPEECH))
        assert np.isnan(silence_share(Aperture(FINE, np.zeros(len(FINE))), SPEECH))

    def test_frames_without_a_face_do_not_count(self) -> None:
        values = np.where((VIDEO < 0.51) | (VIDEO > 2.49), 0.02, 0.2)
        values[:5] = NAN
        assert silence_share(Aperture(VIDEO, values), SPEECH) == pytest.approx(0.1)


class TestScores:
    def test_a_perfect_estimate_scores_perfectly(self) -> None:
        values = wave(FINE)
        for start, end in ((1.0, 1.1), (1.8, 1.9), (0, 0.5), (2.5, 3)):
            values[np.abs(FINE - (start + end) / 2) <= (end - start) / 2] = 0.0
        estimate = Aperture(FINE, values)
        real = Aperture(VIDEO, estimate.at(VIDEO))
        score = evaluate(real, estimate, SPEECH)
        assert score == LipScore(
            r=pytest.approx(1), r_best_lag=pytest.approx(1), lag=pytest.approx(0),
            closures_hit=2, closures_real=2, false_closures=0, speech=2.0,
            silence=pytest.approx(0, abs=1e-9),
        )  # fmt: skip

    ONE = LipScore(r=0.5, r_best_lag=0.6, lag=0.02, closures_hit=1, closures_real=2,
                   false_closures=1, speech=2.0, silence=0.1, mistimed_closures=2)  # fmt: skip

    def test_pooling_one_recording_gives_its_figures(self) -> None:
        assert pool([self.ONE]) == {
            "recordings": 1, "r": 0.5, "r_median": 0.5, "r_best_lag": 0.6, "lag_ms": 20,
            "closures_real": 2, "closures": 0.5, "false_closures_per_s": 0.5,
            "mistimed_closures_per_s": 1.0, "silence": 0.1,
        }  # fmt: skip

    def test_shares_and_rates_are_of_all_counts_and_the_rest_is_the_mean(self) -> None:
        other = LipScore(r=0.9, r_best_lag=0.9, lag=-0.02, closures_hit=8, closures_real=8,
                         false_closures=0, speech=8.0, silence=NAN)  # fmt: skip
        pooled = pool([self.ONE, other, replace(other, r=NAN, lag=0.0)])
        assert pooled["r"] == pytest.approx(0.7)
        assert pooled["r_median"] == pytest.approx(0.7)
        assert pooled["lag_ms"] == pytest.approx(0)
        assert pooled["closures"] == pytest.approx(17 / 18)
        assert pooled["false_closures_per_s"] == pytest.approx(1 / 18)
        assert pooled["silence"] == pytest.approx(0.1)

    def test_figures_that_no_recording_has_are_nan_without_a_warning(self) -> None:
        empty = replace(self.ONE, r=NAN, r_best_lag=NAN, silence=NAN, closures_real=0)
        pooled = pool([empty, empty])
        assert all(np.isnan(pooled[key]) for key in ("r", "r_median", "r_best_lag", "silence"))
        assert np.isnan(pooled["closures"])

    def test_pooling_nothing_is_refused(self) -> None:
        with pytest.raises(ValueError, match="no recordings"):
            pool([])
