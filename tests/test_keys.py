"""Few keys stand for a whole curve: within the bound at every frame, and with few to spare."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import gaussian_filter1d

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, export_clip, read_clip
from lipwright.keys import LANE, KeyedCurve, every_frame, kept_frames, keyed

RANDOM = np.random.default_rng(7)


def speech_like(frames: int = 900, controls: int = 3) -> Clip:
    """Curves about as smooth as those of speech at 60 fps, 0 to 1."""
    noise = np.random.default_rng(frames).normal(size=(frames, controls))
    noise = gaussian_filter1d(noise, 3.0, axis=0)
    values = np.clip(0.3 + noise / noise.std() * 0.25, 0, 1)
    return Clip(tuple(f"c{n}" for n in range(controls)), 60, values.astype(np.float32))


class TestCurve:
    def test_between_keys_it_is_scipys_cubic_hermite_spline(self) -> None:
        times = np.array([0, 0.4, 0.5, 1.7])
        values, slopes = RANDOM.normal(size=(2, 4))
        curve = KeyedCurve(times, values, slopes, slopes)
        at = np.linspace(0, 1.7, 101)
        assert curve.at(at) == pytest.approx(CubicHermiteSpline(times, values, slopes)(at))

    def test_it_holds_before_the_first_key_and_after_the_last(self) -> None:
        curve = KeyedCurve(*np.array([[1.0, 2.0], [3.0, 5.0], [0, 1], [1, 0]]))
        assert curve.at([0, 1, 2, 9]).tolist() == [3, 3, 5, 5]

    def test_one_key_is_a_constant(self) -> None:
        assert KeyedCurve([2.0], [0.5], [0.0], [0.0]).at([0, 2, 4]).tolist() == [0.5] * 3

    @pytest.mark.parametrize(
        ("times", "values", "reason"),
        [
            ([], [], "shape"),
            ([0, 1], [0], "shape"),
            ([0, 0], [0, 1], "do not rise"),
            ([1, 0], [0, 1], "do not rise"),
            ([0, np.nan], [0, 1], "no numbers"),
            ([0, 1], [0, np.inf], "no numbers"),
        ],
    )
    def test_keys_that_are_none_are_refused(
        self, times: list[float], values: list[float], reason: str
    ) -> None:
        zero = np.zeros(len(times))
        with pytest.raises(ValueError, match=reason):
            KeyedCurve(times, values, zero, zero)

    def test_its_arrays_are_copies_that_cannot_be_written(self) -> None:
        values = np.zeros(2)
        curve = every_frame(values, np.array([0.0, 1.0]))
        values[0] = 5
        assert curve.values[0] == 0
        with pytest.raises(ValueError, match="read-only"):
            curve.values[0] = 1


class TestEveryFrame:
    def test_one_key_a_frame_gives_the_clip_back_and_straight_lines_between(self) -> None:
        clip = speech_like()
        keys = keyed(clip)
        assert keys.linear
        assert keys.to_clip().values == pytest.approx(clip.values, abs=1e-6)
        middles = (np.arange(len(clip) - 1) + 0.5) / 60
        lines = np.interp(middles, clip.times, clip.curve("c1"))
        assert keys.curves["c1"].at(middles) == pytest.approx(lines, abs=1e-6)

    def test_a_control_that_never_moves_has_one_key(self) -> None:
        clip = Clip(("still", "moves"), 30, np.array([[0.5, 0], [0.5, 1], [0.5, 0]], np.float32))
        assert [len(curve) for curve in keyed(clip).curves.values()] == [1, 3]
        assert keyed(clip).to_clip().values.tolist() == clip.values.tolist()

    def test_a_clip_of_one_frame_has_one_key_a_control(self) -> None:
        clip = Clip(("a", "b"), 30, np.array([[0.25, 1]], np.float32))
        for error in (None, 0.01):
            keys = keyed(clip, error)
            assert keys.duration == 0
            assert keys.to_clip().values.tolist() == [[0.25, 1]]

    def test_controls_can_be_chosen_and_those_that_the_clip_lacks_rest(self) -> None:
        keys = keyed(speech_like(), names=("c2", "none"))
        assert tuple(keys.curves) == ("c2", "none")
        assert keys.curves["none"].values.tolist() == [0]


class TestSparse:
    @given(
        arrays(np.float32, st.tuples(st.integers(1, 60), st.just(2)),
               elements=st.floats(-1, 1, width=32)),
        st.sampled_from([0.3, 0.03, 0.003]),
    )  # fmt: skip
    def test_every_frame_is_within_the_bound_whatever_the_curve(
        self, values: np.ndarray, error: float
    ) -> None:
        clip = Clip(("a", "b"), 24, values)
        keys = keyed(clip, error)
        assert not keys.linear
        assert np.abs(keys.to_clip().values - clip.values).max() <= error
        for curve in keys.curves.values():
            frames = curve.times * 24
            assert frames == pytest.approx(np.rint(frames), abs=1e-9)
            assert (curve.arriving[1:-1] == curve.leaving[1:-1]).all()  # no corners to an animator

    def test_a_tighter_bound_keeps_more_keys(self) -> None:
        clip = speech_like()
        counts = [sum(map(len, keyed(clip, e).curves.values())) for e in (0.1, 0.01, 0.001)]
        assert counts == sorted(counts)
        assert counts[0] < counts[2]

    def test_the_number_of_keys_is_near_the_least_that_these_slopes_allow(self) -> None:
        """The least by dynamic programming over all pairs of frames, without runs and patience."""
        clip, error = speech_like(300, 1), 0.97 * 0.01
        values = clip.values[:, 0].astype(float)
        slopes = np.gradient(values)
        least = np.full(len(values), 10**6)
        least[-1] = 1
        for start in range(len(values) - 2, -1, -1):
            for end in range(start + 1, min(start + 60, len(values) - 1) + 1):
                spline = CubicHermiteSpline(
                    [start, end], values[[start, end]], slopes[[start, end]]
                )
                inside = np.arange(start, end + 1)
                if np.abs(spline(inside) - values[inside]).max() <= error:
                    least[start] = min(least[start], 1 + least[end])
        found = len(kept_frames(values[:, None], slopes[:, None], np.array([error]))[0])
        assert least[0] <= found <= 1.15 * least[0]
        # Keys that are fitted, rather than taken from the curve, are fewer still.
        assert len(keyed(clip, 0.01).curves["c0"]) < least[0]

    def test_long_clips_are_gone_through_in_runs_that_each_keep_the_bound(self) -> None:
        clip = speech_like(3 * LANE + 17)
        keys = keyed(clip, 0.01)
        assert np.abs(keys.to_clip().values - clip.values).max() <= 0.01
        assert keys.curves["c0"].times[-1] == pytest.approx(clip.duration)

    def test_the_bound_of_a_bones_place_is_in_centimetres(self) -> None:
        millimetre = np.sin(np.arange(60) / 5)[:, None].astype(np.float32) / 1000  # m
        clip = Clip(("lip.ty", "lip_y"), 60, np.hstack([millimetre, millimetre]))
        keys = keyed(clip, 0.01)
        assert [len(curve) > 1 for curve in keys.curves.values()] == [True, False]
        off = np.abs(keys.to_clip().values - clip.values).max(axis=0)
        assert off[0] <= 0.0001

    def test_a_control_that_moves_less_than_the_bound_has_one_key(self) -> None:
        values = np.zeros((20, 1), np.float32)
        values[10] = 0.018
        keys = keyed(Clip(("a",), 30, values), 0.01)
        assert keys.curves["a"].values.tolist() == pytest.approx([0.009])


class TestJson:
    """Keys in our own JSON, and back."""

    def test_what_is_read_back_is_within_the_bound(self, tmp_path: Path) -> None:
        clip = speech_like()
        for error in (0.1, 0.01, 0.0003):
            export_clip(tmp_path / "a.json", clip, options=ExportOptions(keys=error))
            back = read_clip(tmp_path / "a.json")
            assert (back.names, back.fps, len(back)) == (clip.names, clip.fps, len(clip))
            assert np.abs(back.values - clip.values).max() <= error

    def test_places_of_bones_and_slow_curves_are_within_it_too(self, tmp_path: Path) -> None:
        fast = speech_like(controls=2).values * [0.03, 1.0]
        for fps in (60, 5):
            clip = Clip(("jaw.ty", "jaw.rx"), fps, fast)
            for error in (0.1, 0.05, 0.01):
                export_clip(tmp_path / "a.json", clip, options=ExportOptions(keys=error))
                off = np.abs(read_clip(tmp_path / "a.json").values - clip.values).max(axis=0)
                assert (off <= [error / 100, error]).all()

    def test_the_file_is_that_of_version_2_with_lists_by_control(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.json", speech_like(), options=ExportOptions(keys=0.01))
        data = json.loads((tmp_path / "a.json").read_text())
        assert (data["format"], data["version"], data["frames"]) == ("lipwright-clip", 2, 900)
        keys = data["keys"]["c0"]
        assert set(keys) == {"frames", "values", "slopes"}
        assert len(keys["frames"]) == len(keys["values"]) == len(keys["slopes"]) < 300

    def test_a_corner_by_hand_has_two_slopes(self, tmp_path: Path) -> None:
        path = tmp_path / "a.json"
        content = {
            "format": "lipwright-clip", "version": 2, "fps": 10, "frames": 5,
            "keys": {"a": {"frames": [0, 2, 4], "values": [0, 1, 0],
                           "arriving": [0, 5, -5], "leaving": [5, -5, 0]}},
        }  # fmt: skip
        path.write_text(json.dumps(content))
        assert read_clip(path).curve("a").tolist() == pytest.approx([0, 0.5, 1, 0.5, 0])

    @pytest.mark.parametrize(
        ("change", "reason"),
        [
            ({"version": 3}, "is of version 3 of lipwright-clip, not 1 or 2"),
            ({"version": True}, "is of version True"),
            ({"frames": 0}, "'frames' is 0, not a number from 1 to"),
            ({"frames": 2.5}, "'frames' is 2.5"),
            ({"frames": 10**9}, "'frames' is 1000000000"),
            ({"keys": {}}, "'keys' holds no curves"),
            ({"keys": {"a": {"frames": [0], "values": [1]}}}, "of 'a' have no 'arriving'"),
            ({"keys": {"a": {"frames": [0], "values": ["x"], "slopes": [0]}}}, "no 'values'"),
            ({"keys": {"a": {"frames": [], "values": [], "slopes": []}}}, "no 'frames'"),
            ({"keys": {"a": {"frames": [0, 5], "values": [1, 1], "slopes": [0, 0]}}},
             "not within frames 0 to 4"),
            ({"keys": {"a": {"frames": [2, 1], "values": [1, 1], "slopes": [0, 0]}}},
             "'a': times of keys do not rise"),
            ({"keys": {"a": {"frames": [0, 1], "values": [1], "slopes": [0, 0]}}}, "shape"),
            ({"keys": {"": {"frames": [0], "values": [1], "slopes": [0]}}}, "has no name"),
            ({"keys": {"a": {"frames": [0, 4], "values": [0, 1e300], "slopes": [0, 0]}}}, "steep"),
        ],
    )  # fmt: skip
    def test_keys_that_cannot_be_are_refused_in_one_line(
        self, change: dict[str, object], reason: str, tmp_path: Path
    ) -> None:
        path = tmp_path / "a.json"
        keys = {"a": {"frames": [0, 4], "values": [0, 1], "slopes": [0, 0]}}
        content = {"format": "lipwright-clip", "version": 2, "fps": 10, "frames": 5, "keys": keys}
        path.write_text(json.dumps({**content, **change}))
        with pytest.raises(LipwrightError, match=reason) as refused:
            read_clip(path)
        assert str(refused.value).startswith(f"{path}: ")
        assert "\n" not in str(refused.value)

    @pytest.mark.parametrize("keys", [0, -0.1, float("nan"), float("inf")])
    def test_a_bound_that_is_none_is_refused(self, keys: float) -> None:
        with pytest.raises(LipwrightError, match="give a number above 0"):
            ExportOptions(keys=keys)
