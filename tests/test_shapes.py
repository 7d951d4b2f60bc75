"""Which drawing of a mouth shows when."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.phones import BILABIALS
from lipwright.pipeline import Result, animate
from lipwright.retarget import retarget
from lipwright.retarget.holding import cheapest_labels
from lipwright.retarget.seeing import SEEN, seen_of
from lipwright.retarget.shapes import (
    HOLD,
    STEP,
    ShownShape,
    choose_shapes,
    rest_shape,
    shape_curves,
    shown_shapes,
)
from lipwright.rig import Control, Rig, load_rig
from lipwright.track import PhoneTrack

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LOOKS = {
    "shut": {"mouthPress": 0.3},
    "wide": {"jawOpen": 0.4},
    "small": {"jawOpen": 0.1},
    "round": {"mouthPucker": 0.9, "jawOpen": 0.1},
    "teeth": {"mouthRollLower": 0.5, "jawOpen": 0.08},
    "rest": {},
}
DRAWN = Rig("drawn", tuple(map(Control, LOOKS)), {}, looks=LOOKS, discrete=True)
LIP_CORNER = 2244  # the left one, on the head; the other is its mirror image


def played(names: list[str], seconds: list[float], fps: float = 100.0, rig: Rig = DRAWN) -> Clip:
    """A face that shows the looks of shapes one after the other."""
    frames = np.repeat(names, np.round(np.array(seconds) * fps).astype(int))
    return Clip(CANONICAL, fps, rig.look_of([*frames, frames[-1]]))


def cost_of(labels: npt.NDArray[np.int64], costs: npt.NDArray[np.float64], switch: float) -> float:
    return float(
        costs[np.arange(len(labels)), labels].sum() + switch * np.count_nonzero(np.diff(labels))
    )


def shortest_run(labels: npt.NDArray[np.int64]) -> int:
    edges = np.concatenate([[0], np.flatnonzero(np.diff(labels)) + 1, [len(labels)]])
    return int(np.diff(edges).min())


@pytest.fixture(scope="module")
def hello() -> Result:
    return animate(EXAMPLES / "hello.flac", (EXAMPLES / "hello.txt").read_text("utf-8"))


class TestCheapestLabels:
    @settings(max_examples=150, deadline=None)
    @given(
        st.integers(0, 2**32 - 1), st.integers(1, 8), st.integers(1, 3), st.integers(1, 4),
        st.floats(0, 1),
    )  # fmt: skip
    def test_they_cost_no_more_than_any_row_that_holds_as_long(
        self, seed: int, steps: int, labels: int, hold: int, switch: float
    ) -> None:
        costs = np.random.default_rng(seed).random((steps, labels))
        every = map(np.array, product(range(labels), repeat=steps))
        allowed = [row for row in every if shortest_run(row) >= min(hold, steps)]
        found = cheapest_labels(costs, hold, switch)
        assert shortest_run(found) >= min(hold, steps)
        least = min(cost_of(row, costs, switch) for row in allowed)
        assert cost_of(found, costs, switch) == pytest.approx(least, abs=1e-9)

    @settings(max_examples=60, deadline=None)
    @given(st.integers(0, 2**32 - 1), st.floats(0, 1), st.floats(0.001, 1))
    def test_dearer_switches_are_never_more(self, seed: int, switch: float, more: float) -> None:
        costs = np.random.default_rng(seed).random((60, 4))
        switches = [
            np.count_nonzero(np.diff(cheapest_labels(costs, 3, dear)))
            for dear in (switch, switch + more)
        ]
        assert switches[1] <= switches[0]

    @settings(max_examples=60, deadline=None)
    @given(st.integers(0, 2**32 - 1), st.integers(1, 10))
    def test_holding_longer_is_never_cheaper(self, seed: int, hold: int) -> None:
        costs = np.random.default_rng(seed).random((60, 4))
        short, long = (
            cost_of(cheapest_labels(costs, h, 0.3), costs, 0.3) for h in (hold, hold + 1)
        )
        assert short <= long + 1e-9

    def test_costs_that_are_no_numbers_are_refused(self) -> None:
        with pytest.raises(ValueError, match="finite"):
            cheapest_labels([[0.0, np.nan]], 1, 0.0)


class TestChoice:
    def test_a_face_that_shows_the_shapes_themselves_gets_them_back(self) -> None:
        names = ["rest", "wide", "shut", "round", "teeth", "small", "wide", "rest"]
        seconds = [0.5, 0.2, 0.1, 0.15, 0.1, 0.2, 0.12, 0.4]
        shown = choose_shapes(played(names, seconds), DRAWN)
        assert [shape.name for shape in shown] == names
        starts = np.cumsum([0, *seconds[:-1]])
        assert [shape.start for shape in shown] == pytest.approx(starts, abs=STEP + 1e-9)

    @settings(max_examples=40, deadline=None)
    @given(st.integers(0, 2**32 - 1), st.integers(1, 300), st.sampled_from([24.0, 29.97, 60.0]))
    def test_any_clip_is_covered_without_gaps_by_drawings_that_hold(
        self, seed: int, frames: int, fps: float
    ) -> None:
        values = np.random.default_rng(seed).random((frames, len(CANONICAL))) ** 3
        clip = Clip(CANONICAL, fps, values)
        shown = choose_shapes(clip, DRAWN)
        assert shown[0].start == 0
        assert shown[-1].end == pytest.approx(max(clip.duration, STEP))
        for before, after in pairwise(shown):
            assert before.end == after.start
            assert before.name != after.name
            assert before.end == pytest.approx(round(before.end / STEP) * STEP)
        if clip.duration > 2 * HOLD:
            assert min(shape.end - shape.start for shape in shown) > HOLD - STEP

    def test_a_flicker_is_not_drawn_although_it_is_nearest_for_a_frame(self) -> None:
        clip = played(["wide", "small", "wide"], [0.3, 0.02, 0.3])
        assert [shape.name for shape in choose_shapes(clip, DRAWN)] == ["wide"]

    def test_a_closure_of_one_frame_shows_and_is_held(self) -> None:
        clip = played(["wide"] * 3, [0.3, 0.02, 0.3], fps=60)
        values = clip.values.copy()
        values[20] = DRAWN.look_of(["shut"])[0]
        shown = choose_shapes(clip.with_values(values), DRAWN)
        assert [shape.name for shape in shown] == ["wide", "shut", "wide"]
        assert shown[1].start <= 20 / 60 <= shown[1].end
        assert shown[1].end - shown[1].start == pytest.approx(HOLD)

    def test_with_phones_only_p_b_and_m_that_the_clip_shuts_must_show_shut_lips(self) -> None:
        clip = played(["wide"], [0.9], fps=60)
        values = clip.values.copy()
        values[[10, 25]] = 0  # in M and in W; the lips of B stay open
        track = PhoneTrack(
            ("AA", "M", "AA", "W", "AA", "B", "AA"),
            np.array([0, 0.12, 0.22, 0.38, 0.46, 0.6, 0.7, 0.9]),
        )
        shown = choose_shapes(clip.with_values(values), DRAWN, track)
        assert [shape.name for shape in shown] == ["wide", "shut", "wide"]
        assert shown[1].start <= 10 / 60 <= shown[1].end

    def test_pauses_rest_and_closures_of_speech_do_not(self) -> None:
        track = PhoneTrack(("sil", "AA", "M", "AA", "sil"), np.array([0, 0.5, 0.7, 0.9, 1.1, 1.6]))
        names = ["rest", "wide", "rest", "wide", "shut"]
        clip = played(names, [0.5, 0.2, 0.2, 0.2, 0.5])
        want = ["rest", "wide", "shut", "wide", "rest"]
        assert [shape.name for shape in choose_shapes(clip, DRAWN, track)] == want
        assert [shape.name for shape in choose_shapes(clip, DRAWN)] == want  # by how long they last

    @pytest.mark.parametrize("fps", [48.0, 72.0, 96.0, 120.0])
    def test_the_rate_of_the_clip_does_not_matter(self, fps: float) -> None:
        rng = np.random.default_rng(4)
        coarse = Clip(CANONICAL, 24.0, DRAWN.look_of(rng.choice(DRAWN.names, 40).repeat(3)))
        reference, other = (choose_shapes(clip, DRAWN) for clip in (coarse, coarse.resample(fps)))
        assert [shape.name for shape in reference] == [shape.name for shape in other]
        for one, two in zip(reference, other, strict=True):
            assert one.start == pytest.approx(two.start, abs=STEP + 1e-9)

    def test_round_lips_and_lips_on_teeth_are_no_closures_though_they_let_no_light_through(
        self,
    ) -> None:
        clip = played(["wide", "round", "wide", "teeth", "wide"], [0.2, 0.12, 0.2, 0.12, 0.2])
        dark = clip.with_curves({"jawOpen": np.where(clip.curve("jawOpen") > 0.2, 0.4, 0)})
        shown = choose_shapes(dark, DRAWN)
        assert [shape.name for shape in shown] == ["wide", "round", "wide", "teeth", "wide"]

    def test_a_mumbler_opens_the_widest_drawing_too(self) -> None:
        quiet = played(["small", "wide", "small"], [0.4, 0.4, 0.4])
        half = quiet.with_values(quiet.values / 2)
        assert "wide" in {shape.name for shape in choose_shapes(half, DRAWN)}

    def test_shapes_that_are_not_drawn_are_not_chosen(self) -> None:
        clip = played(["wide", "round", "teeth", "rest"], [0.3, 0.3, 0.3, 0.5])
        shown = choose_shapes(clip, DRAWN, names=("shut", "small", "wide"))
        assert {shape.name for shape in shown} <= {"shut", "small", "wide"}

    def test_the_drawing_of_pauses_is_told_by_its_name_or_else_by_its_look(self) -> None:
        assert rest_shape(load_rig("rhubarb")) == "X"
        assert rest_shape(load_rig("rhubarb"), "DCAB") == "A"
        looks = {"A": {"jawOpen": 0.8}, "M": {"mouthPress": 0.3}}
        controls = tuple(Control(name) for name in looks)
        assert rest_shape(Rig("vowels", controls, {}, looks=looks, discrete=True)) == "M"

    def test_a_single_drawing_shows_throughout(self) -> None:
        one = Rig("one", (Control("mouth"),), {}, looks={"mouth": {"jawOpen": 0.3}}, discrete=True)
        assert choose_shapes(played(["wide"], [0.3]), one) == (ShownShape(0.0, 0.3, "mouth"),)


class TestSpeech:
    @pytest.mark.parametrize(("rig", "shut"), [("rhubarb", "A"), ("preston-blair", "MBP")])
    def test_every_p_b_and_m_of_a_recording_shows_shut_lips(
        self, hello: Result, rig: str, shut: str
    ) -> None:
        shown = choose_shapes(hello.clip, load_rig(rig), hello.track)
        closures = [span for phone, *span in hello.track if phone in BILABIALS]
        assert len(closures) == 7
        for start, end in closures:
            assert any(s.name == shut and s.start < end and s.end > start for s in shown)

    def test_its_pauses_rest_and_its_speech_uses_most_drawings(self, hello: Result) -> None:
        shown = choose_shapes(hello.clip, load_rig("rhubarb"), hello.track)
        seconds = Counter[str]()
        for shape in shown:
            seconds[shape.name] += shape.end - shape.start
            if shape.name == "X":
                words = [hello.track.word_span(word) for word in hello.track.words]
                said = [min(shape.end, end) - max(shape.start, start) for start, end in words]
                assert max(said) < HOLD
        assert set(seconds) >= set("ACDEFGHX")
        assert 40 <= len(shown) <= 70  # 82 phones in 6 s of speech

    def test_far_fewer_drawings_than_by_frame_that_still_follow_the_lips(
        self, hello: Result
    ) -> None:
        rig, clip = load_rig("rhubarb"), hello.clip
        nearest = choose_shapes(clip, rig, hello.track, hold=STEP, switch=0.0)
        shown = choose_shapes(clip, rig, hello.track)
        assert len(shown) < 0.8 * len(nearest)
        drawn = rig.to_canonical(shape_curves(shown, rig, clip.fps, len(clip)))
        lips, seen = (seen_of(curves.values)[:, 0].clip(0) for curves in (clip, drawn))
        assert np.corrcoef(lips, seen)[0, 1] > 0.8


class TestCurves:
    def test_one_shape_at_a_time_is_in_full_and_comes_back(self) -> None:
        shown = (
            ShownShape(0.0, 0.31, "rest"), ShownShape(0.31, 0.5, "wide"),
            ShownShape(0.5, 1.0, "shut"),
        )  # fmt: skip
        curves = shape_curves(shown, DRAWN, 30.0, 31)
        assert curves.names == DRAWN.names
        assert (np.sort(curves.values, axis=1)[:, :-1] == 0).all()
        assert (curves.values.max(axis=1) == 1).all()
        back = shown_shapes(curves, DRAWN)
        assert [shape.name for shape in back] == ["rest", "wide", "shut"]
        for one, two in zip(shown, back, strict=True):
            assert abs(one.start - two.start) <= 0.5 / 30 + 1e-9
        assert back[-1].end == 1.0

    def test_retargeting_to_drawings_chooses_them(self, hello: Result) -> None:
        rig = load_rig("rhubarb")
        moved = retarget(hello.clip, rig, hello.track)
        chosen = choose_shapes(hello.clip, rig, hello.track)
        assert [shape.name for shape in shown_shapes(moved, rig)] == [s.name for s in chosen]

    def test_a_shape_that_never_shows_is_refused(self) -> None:
        with pytest.raises(ValueError, match=r"'A' shows from 1\.0 to 1\.0"):
            ShownShape(1.0, 1.0, "A")


class TestTable:
    def test_it_says_what_the_head_shows(self, head: Head) -> None:
        assert set(SEEN) == {n for n in SEEN if set(both_sides(n)) <= set(CANONICAL)}
        rest = head.vertices.astype(np.float64)
        right = np.abs(rest - rest[LIP_CORNER] * [-1, 1, 1]).sum(axis=1).argmin()
        upper, lower = head.lip_pairs.T
        for index, name in enumerate(CANONICAL):
            moved = np.zeros_like(rest)
            vertices, by = head.shape(name)
            moved[vertices] = by
            corners = moved[[LIP_CORNER, right]]
            seen = [
                (moved[upper, 1] - moved[lower, 1]).mean(),
                corners[0, 0] - corners[1, 0],
                moved[head.lip_pairs[0], 2].mean() - corners[:, 2].mean(),
            ] / np.float64(head.eye_distance)
            either = name.removesuffix("Left").removesuffix("Right")
            row = SEEN.get(name, SEEN.get(either, (0.0, 0.0, 0.0)))
            if name in SEEN or either in SEEN:
                assert seen == pytest.approx(row, abs=0.002), name
            else:
                assert np.abs(seen[:2]).max() < 0.03, f"{CANONICAL[index]} is seen too"


class TestTrouble:
    def test_a_rig_without_looks(self) -> None:
        blind = Rig("blind", (Control("A"), Control("B")), {}, discrete=True)
        with pytest.raises(LipwrightError, match="'blind' does not say what its shapes look like"):
            choose_shapes(played(["wide"], [0.3]), blind)

    def test_curves_that_move_no_mouth(self) -> None:
        with pytest.raises(LipwrightError, match=r"curves of bigJaw\.\.\. move no mouth"):
            choose_shapes(Clip(("bigJaw",), 30, np.zeros((3, 1))), DRAWN)

    def test_shapes_that_the_rig_lacks(self) -> None:
        with pytest.raises(LipwrightError, match="'Q', which the rig 'drawn' lacks"):
            choose_shapes(played(["wide"], [0.3]), DRAWN, names=("Q",))
