"""The thesis's changes of the data do what its formulas say, and can be undone."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.controls import ARKIT
from lipwright.dataset.recording import Motion, Recording
from lipwright.dataset.transforms import (
    PHONE_CLASSES,
    THESIS_CONTROLS,
    THESIS_PRUNED,
    TRANSFORMS,
    EditFrames,
    MergePhones,
    MergeSides,
    Prune,
    Resample,
    Sample,
    TimeShift,
    Transforms,
    ZeroCentre,
    build_transforms,
    sample_of,
    smape,
    unpredictable,
)
from lipwright.errors import LipwrightError
from lipwright.phones import PHONES
from lipwright.track import PhoneTrack

# The 18 that the thesis was left with, section 4.2.2.
THESIS_LEFT = """jawForward jawOpen mouthClose mouthFunnel mouthPucker mouthSmileSide
mouthDimpleSide mouthStretchSide mouthRollLower mouthRollUpper mouthShrugLower mouthShrugUpper
mouthPressSide mouthLowerDownSide mouthUpperUpSide cheekPuff cheekSquintSide noseSneerSide"""


@st.composite
def samples(draw: st.DrawFn, names: tuple[str, ...] = ("a", "bLeft", "bRight")) -> Sample:
    count = draw(st.integers(1, 12))
    numbers = st.floats(0, 1, width=32)
    values = draw(arrays(np.float32, (count, len(names)), elements=numbers))
    lost = draw(arrays(np.bool_, count)) & draw(st.booleans())
    values[lost] = np.nan
    labels = st.sampled_from(("AH", "IH", "IY", "G", "V", "sil"))
    phones = draw(st.lists(labels, min_size=count, max_size=count))
    fps = draw(st.sampled_from((25.0, 29.97, 30.0, 60.0)))
    return Sample(names, values, tuple(sorted(phones)), fps, draw(st.floats(-1, 1)))


def same(one: Sample, other: Sample, atol: float = 0.0) -> bool:
    return (
        (one.names, one.phones, one.fps, one.start)
        == (other.names, other.phones, other.fps, other.start)
        and one.values.shape == other.values.shape
        and np.allclose(one.values, other.values, rtol=0, atol=atol, equal_nan=True)
    )


def row(*values: float, phones: str = "", fps: float = 30.0) -> Sample:
    """One column."""
    labels = tuple(phones.split()) or ("AH",) * len(values)
    return Sample(("x",), np.array(values)[:, None], labels, fps)


def column(sample: Sample) -> list[float]:
    return [round(float(value), 6) for value in sample.values[:, 0]]


class TestSample:
    @pytest.mark.parametrize(
        ("change", "reason"),
        [
            ({"names": ("a", "a")}, "repeat"),
            ({"values": np.zeros((2, 3))}, "shape"),
            ({"values": np.zeros((0, 2)), "phones": ()}, "T > 0"),
            ({"phones": ("AH",)}, "1 phones for 2"),
            ({"fps": 0.0}, "fps"),
            ({"start": np.nan}, "start"),
        ],
    )
    def test_a_sample_cannot_be_wrong(self, change: dict[str, object], reason: str) -> None:
        good = {"names": ("a", "b"), "values": np.zeros((2, 2)), "phones": ("AH", "B"), "fps": 30.0}
        with pytest.raises(ValueError, match=reason):
            Sample(**{**good, **change})  # type: ignore[arg-type]

    def test_a_recording_gives_its_weights_with_the_phone_said_at_each_frame(
        self, tmp_path: Path
    ) -> None:
        weights = np.full((4, 52), 0.25, np.float32)
        motion = Motion(10.0, np.array([0, 1, 0, 0]), weights)
        track = PhoneTrack(("AH", "B"), np.array([0.0, 0.1, 0.24]))
        sample = sample_of(Recording("a", motion, track, 0.02, {}, tmp_path))
        assert sample.names == ARKIT
        # Frames are at 0.05, 0.15, ... s of the picture, which is 0.02 s late; then the track ends.
        assert np.allclose(sample.times, [0.03, 0.13, 0.23, 0.33])
        assert sample.phones == ("AH", "B", "B", "sil")
        assert sample.seen.tolist() == [True, False, True, True]

    def test_parameters_of_the_reference_face_make_samples_too(self, tmp_path: Path) -> None:
        motion = Motion(10.0, np.zeros(4), np.zeros((4, 52)))
        track = PhoneTrack(("AH",), np.array([0.0, 0.4]))
        recording = Recording("a", motion, track, 0.0, {}, tmp_path)
        with pytest.raises(LipwrightError, match="lipwright face fit"):
            sample_of(recording, "joint")
        np.savez(tmp_path / "face.npz", joint=np.ones((4, 2)), model=np.array("m"))
        sample = sample_of(recording, "joint")
        assert (sample.names, sample.values.sum()) == (("joint0", "joint1"), 8)
        with pytest.raises(LipwrightError, match="'model'"):
            sample_of(recording, "model")

    def test_columns_are_chosen_by_name(self) -> None:
        sample = Sample(("a", "b", "c"), [[1, 2, 3]], ("AH",), 30.0)
        assert sample.select(("c", "a")).values.tolist() == [[3, 1]]
        with pytest.raises(ValueError, match="column x"):
            sample.select(("x", "a"))

    def test_a_frame_without_a_face_spoils_no_frame_that_it_does_not_touch(self) -> None:
        values = row(1, np.nan, 3).at([0.0, 0.5, 1.0, 1.5, 2.0])[:, 0]
        assert np.isnan(values).tolist() == [False, True, True, True, False]


class TestMergingSides:
    PAIR = Sample(("jawRight", "jawLeft", "jawOpen"), [[0.2, 0.4, 0.5]], ("AH",), 30.0)

    def test_the_left_side_is_kept_as_in_the_thesis(self) -> None:
        merged, names = MergeSides().apply(self.PAIR)
        assert merged.names == ("jawSide", "jawOpen")
        assert np.allclose(merged.values, [[0.4, 0.5]])
        assert names == self.PAIR.names

    def test_the_mean_of_both_sides_is_an_option(self) -> None:
        merged, _ = MergeSides(keep="mean").apply(self.PAIR)
        assert np.allclose(merged.values, [[0.3, 0.5]])

    def test_undoing_writes_both_sides(self) -> None:
        merged, names = MergeSides().apply(self.PAIR)
        back = MergeSides().invert(merged, names)
        assert back.names == self.PAIR.names
        assert np.allclose(back.values, [[0.4, 0.4, 0.5]])

    def test_undoing_without_a_record_splits_every_side(self) -> None:
        back = MergeSides().invert(Sample(("xSide", "y"), [[0.4, 0.5]], ("AH",), 30.0))
        assert back.names == ("xLeft", "xRight", "y")
        assert np.allclose(back.values, [[0.4, 0.4, 0.5]])

    @given(samples())
    def test_a_symmetric_face_comes_back_unchanged(self, sample: Sample) -> None:
        twin = sample.with_values(sample.values[:, [0, 1, 1]])
        for keep in ("left", "mean"):
            assert same(MergeSides(keep).invert(*MergeSides(keep).apply(twin)), twin)

    @given(samples())
    def test_merging_what_was_split_is_the_identity(self, sample: Sample) -> None:
        merged, names = MergeSides().apply(sample)
        assert same(MergeSides().apply(MergeSides().invert(merged, names))[0], merged)

    def test_the_thesis_ends_with_its_18_controls(self) -> None:
        sample = Sample(ARKIT, np.zeros((1, 52)), ("AH",), 30.0).select(THESIS_CONTROLS)
        assert len(sample.names) == 32
        chain = Transforms((MergeSides(), Prune(THESIS_PRUNED)))
        left, records = chain.apply(sample)
        assert set(left.names) == set(THESIS_LEFT.split())
        assert chain.invert(left, records).names == THESIS_CONTROLS

    def test_a_column_that_is_there_already_is_not_overwritten(self) -> None:
        sample = Sample(("xLeft", "xRight", "xSide"), np.zeros((1, 3)), ("AH",), 30.0)
        with pytest.raises(ValueError, match="xSide"):
            MergeSides().apply(sample)

    def test_a_third_way_to_merge_is_refused(self) -> None:
        with pytest.raises(ValueError, match="right"):
            MergeSides(keep="right")  # type: ignore[arg-type]


class TestPruning:
    def test_smape_by_hand(self) -> None:
        reference = [[0.5, 0.0, 1.0, np.nan], [0.5, 0.0, 1.0, np.nan]]
        estimated = [[0.3, 0.0, 0.0, 0.5], [0.5, 0.0, 0.0, 0.5]]
        # |0.3 - 0.5| / 0.4 = 0.5 in one of two frames; nothing moves; at rest throughout; unseen.
        assert np.allclose(smape(reference, estimated), [0.25, 0, 2, np.nan], equal_nan=True)

    @given(samples(), samples())
    def test_smape_is_symmetric_and_from_0_to_2(self, one: Sample, other: Sample) -> None:
        count = min(len(one), len(other))
        a, b = one.values[:count], other.values[:count]
        assert np.array_equal(smape(a, b), smape(b, a), equal_nan=True)
        error = smape(a, b)
        assert ((error >= 0) & (error <= 2))[np.isfinite(error)].all()
        assert not np.nan_to_num(smape(a, a)).any()

    def test_smape_of_other_shapes_is_refused(self) -> None:
        with pytest.raises(ValueError, match="shapes"):
            smape(np.zeros((2, 3)), np.zeros((3, 3)))

    def test_a_column_goes_only_when_both_splits_fail_it(self) -> None:
        names = ("a", "b", "c", "d")
        found = unpredictable(names, [1.5, 1.5, 0.2, np.nan], [1.4, 0.2, 1.4, 1.9], 1.0)
        assert found == ("a",)
        with pytest.raises(ValueError, match="shapes"):
            unpredictable(names, [1.0], [1.0], 1.0)

    def test_pruned_columns_come_back_at_rest_or_at_their_mean(self) -> None:
        sample = Sample(("a", "b", "c"), [[0.1, 0.2, 0.3], [np.nan] * 3], ("AH", "AH"), 30.0)
        for prune, wanted in ((Prune(("b",)), 0.0), (Prune(("b",), (0.7,)), 0.7)):
            left, names = prune.apply(sample)
            assert left.names == ("a", "c")
            back = prune.invert(left, names)
            assert back.names == sample.names
            expected = np.float32([[0.1, wanted, 0.3], [np.nan] * 3])
            assert np.array_equal(back.values, expected, equal_nan=True)
            assert prune.invert(left).names == ("a", "c", "b")

    @given(samples())
    def test_pruning_what_was_put_back_is_the_identity(self, sample: Sample) -> None:
        prune = Prune(("bLeft", "nothing"))
        left, names = prune.apply(sample)
        assert same(prune.apply(prune.invert(left, names))[0], left)

    @pytest.mark.parametrize("bad", [{"names": "ab"}, {"names": ("a", "a")},
                                     {"names": ("a",), "at": (1.0, 2.0)},
                                     {"names": ("a",), "at": (np.inf,)}])  # fmt: skip
    def test_names_and_values_must_fit(self, bad: dict[str, object]) -> None:
        with pytest.raises(ValueError, match="name"):
            Prune(**bad)  # type: ignore[arg-type]


class TestZeroCentring:
    def test_the_formula_of_the_thesis_by_hand(self) -> None:
        # The line from 0.2 to 0.6 over five frames: 0.2, 0.3, 0.4, 0.5, 0.6.
        centred, ends = ZeroCentre().apply(row(0.2, 0.8, 0.4, 0.1, 0.6))
        assert column(centred) == [0.0, 0.5, 0.0, -0.4, 0.0]
        assert np.allclose(ends, [[0.2], [0.6]])

    def test_the_middle_frame_loses_half_of_both_ends(self) -> None:
        centred, _ = ZeroCentre().apply(row(0.2, 1.0, 0.6))
        assert column(centred) == [0.0, 0.6, 0.0]

    @given(samples())
    def test_undoing_is_the_identity(self, sample: Sample) -> None:
        assert same(ZeroCentre().invert(*ZeroCentre().apply(sample)), sample, atol=1e-6)

    @given(samples())
    def test_ends_are_zero_and_a_second_time_changes_nothing(self, sample: Sample) -> None:
        centred, _ = ZeroCentre().apply(sample)
        seen = centred.values[centred.seen]
        if len(seen):
            assert np.allclose(seen[[0, -1]], 0, atol=1e-6)
        assert same(ZeroCentre().apply(centred)[0], centred, atol=1e-6)

    def test_the_line_runs_between_frames_that_show_a_face(self) -> None:
        centred, _ = ZeroCentre().apply(row(np.nan, 0.2, 0.9, 0.4, np.nan))
        assert np.allclose(centred.values[1:4, 0], [0, 0.6, 0])

    def test_a_prediction_is_moved_to_the_poses_that_are_asked_for(self) -> None:
        moved = ZeroCentre().invert(row(0, 0.5, 0), [[0.2], [0.4]])
        assert column(moved) == [0.2, 0.8, 0.4]
        assert column(ZeroCentre().invert(row(0, 0.5, 0))) == [0, 0.5, 0]
        with pytest.raises(ValueError, match="ends"):
            ZeroCentre().invert(row(0, 0.5, 0), [0.2, 0.4])


class TestResampling:
    def test_30_of_60_frames_is_every_other(self) -> None:
        halved, _ = Resample(30).apply(row(0, 1, 2, 3, 4, phones="A B C D E", fps=60))
        assert (column(halved), halved.phones, halved.fps) == ([0, 2, 4], ("A", "C", "E"), 30)

    def test_between_frames_it_is_linear(self) -> None:
        found, _ = Resample(40).apply(row(0, 1, 4, 9, 16, fps=60))
        assert column(found) == [0, 2.5, 9]

    @given(samples())
    def test_frames_that_both_share_come_back_exactly(self, sample: Sample) -> None:
        doubled = Sample(sample.names, sample.values, sample.phones, 60.0, sample.start)
        back = Resample(30).invert(*Resample(30).apply(doubled))
        assert np.array_equal(back.values[::2], doubled.values[::2], equal_nan=True)
        assert (len(back), back.phones, back.fps) == (len(doubled), doubled.phones, 60.0)

    @given(samples(), st.sampled_from((30, 60, 90, 120)))
    def test_to_a_multiple_and_back_is_the_identity(self, sample: Sample, fps: float) -> None:
        slow = Sample(sample.names, sample.values, sample.phones, 30.0, sample.start)
        assert same(Resample(fps).invert(*Resample(fps).apply(slow)), slow)

    @given(samples(), st.floats(5, 200))
    def test_a_straight_line_stays_one_within_its_own_time(
        self, sample: Sample, fps: float
    ) -> None:
        line = sample.with_values(np.outer(sample.times, [1, 2, -1]))
        found, _ = Resample(fps).apply(line)
        assert np.allclose(found.values, np.outer(found.times, [1, 2, -1]), atol=1e-5)
        assert found.times[-1] <= line.times[-1] + 1e-6

    @pytest.mark.parametrize("fps", [0.0, -1.0, np.nan, np.inf])
    def test_a_rate_that_is_none_is_refused(self, fps: float) -> None:
        with pytest.raises(ValueError, match="fps"):
            Resample(fps)


class Planted(np.random.Generator):
    """A generator whose next number is known."""

    def __init__(self, *numbers: float) -> None:
        super().__init__(np.random.PCG64(0))
        self.numbers = numbers

    def uniform(self, low: float, high: float) -> float:  # type: ignore[override]
        return low + (high - low) * self.numbers[0]

    def random(self, count: int) -> np.ndarray:  # type: ignore[override]
        assert count == len(self.numbers)
        return np.array(self.numbers)


class TestTimeShift:
    def test_a_quarter_of_a_frame_later_is_linear_between_frames(self) -> None:
        shifted, shift = TimeShift().apply(row(0, 1, 0, 4), Planted(0.75))
        assert shift == 0.25
        assert column(shifted) == [0.25, 0.75, 1.0, 4.0]

    @given(samples(), st.integers(0, 99))
    def test_it_is_at_most_half_a_frame_and_keeps_phones(self, sample: Sample, seed: int) -> None:
        shifted, shift = TimeShift().apply(sample, np.random.default_rng(seed))
        assert shift is not None
        assert abs(shift) <= 0.5
        assert shifted.phones == sample.phones

    @given(samples(), st.integers(0, 99))
    def test_shifting_back_misses_by_the_second_difference(self, sample: Sample, seed: int) -> None:
        shifted, shift = TimeShift().apply(sample, np.random.default_rng(seed))
        back = TimeShift().invert(shifted, shift)
        x, w = sample.values.astype(float), abs(shift or 0)
        bend = x[2:] - 2 * x[1:-1] + x[:-2]
        expected = x[1:-1] + w * (1 - w) * bend
        found, defined = back.values[1:-1], np.isfinite(expected)
        inside = defined & np.isfinite(found)
        assert np.allclose(found[inside], expected[inside], atol=1e-5)

    def test_a_shift_of_more_than_half_a_frame_is_refused(self) -> None:
        with pytest.raises(ValueError, match=r"0\.6"):
            TimeShift(0.6)


class TestEditingFrames:
    HALF = EditFrames(insert=0.4, remove=0.4)

    def test_a_frame_that_is_put_in_is_the_mean_of_its_neighbours(self) -> None:
        edited, edits = self.HALF.apply(row(0, 1, phones="AH AH"), Planted(0.0, 0.5))
        assert (column(edited), edited.phones) == ([0, 0.5, 1], ("AH", "AH", "AH"))
        assert [edit.frame for edit in edits] == [1]

    def test_a_frame_that_is_taken_out_leaves_half_in_its_neighbours(self) -> None:
        edited, _ = self.HALF.apply(row(0, 1, 4), Planted(0.5, 0.99, 0.5))
        # 0.5 * 0 + 0.5 * 1 and 0.5 * 4 + 0.5 * 1.
        assert column(edited) == [0.5, 2.5]

    def test_nothing_happens_between_phones_or_at_the_ends(self) -> None:
        sample = row(0, 1, 2, 3, phones="A B B C")
        for number in (0.99, 1.0):
            assert same(self.HALF.apply(sample, Planted(*[number] * 4))[0], sample)
        edited, _ = self.HALF.apply(sample, Planted(0.0, 0.0, 0.0, 0.0))
        assert edited.phones == ("A", "B", "B", "B", "C")
        ends = row(0, 1, 2)
        assert same(self.HALF.apply(ends, Planted(0.99, 0.5, 0.99))[0], ends)

    @given(samples(), st.integers(0, 999))
    def test_undoing_is_the_identity_to_the_bit(self, sample: Sample, seed: int) -> None:
        edited, edits = self.HALF.apply(sample, np.random.default_rng(seed))
        assert same(self.HALF.invert(edited, edits), sample)

    @given(samples(), st.integers(0, 999))
    def test_no_phone_is_lost_or_moved(self, sample: Sample, seed: int) -> None:
        edited, _ = self.HALF.apply(sample, np.random.default_rng(seed))
        assert list(dict.fromkeys(edited.phones)) == list(dict.fromkeys(sample.phones))

    def test_as_often_as_the_probabilities_say(self) -> None:
        sample = row(*np.zeros(20_000))
        _, edits = EditFrames(insert=0.1, remove=0.2).apply(sample, np.random.default_rng(1))
        put_in = sum(edit.rows is None for edit in edits)
        assert abs(put_in / 20_000 - 0.1) < 0.01
        assert abs((len(edits) - put_in) / 20_000 - 0.2) < 0.01

    @pytest.mark.parametrize(("insert", "remove"), [(-0.1, 0), (0.6, 0.6), (np.nan, 0)])
    def test_probabilities_that_cannot_be_are_refused(self, insert: float, remove: float) -> None:
        with pytest.raises(ValueError, match="probabilities"):
            EditFrames(insert, remove)


class TestMergingPhones:
    def test_long_vowels_g_and_v_go_to_their_partners(self) -> None:
        merged, phones = MergePhones("swedish").apply(row(*[0] * 5, phones="iː g v s ɑː"))
        assert merged.phones == ("ɪ", "k", "f", "s", "a")
        assert MergePhones("swedish").invert(merged, phones).phones == ("iː", "g", "v", "s", "ɑː")
        english, _ = MergePhones().apply(row(*[0] * 4, phones="IY G V S"))
        assert english.phones == ("IH", "K", "F", "S")
        assert MergePhones().invert(english).phones == english.phones

    @given(samples())
    def test_undoing_is_the_identity_and_merging_twice_is_once(self, sample: Sample) -> None:
        merged, phones = MergePhones().apply(sample)
        assert same(MergePhones().invert(merged, phones), sample)
        assert same(MergePhones().apply(merged)[0], merged)

    def test_no_class_stands_for_another_and_english_is_in_the_phone_table(self) -> None:
        for table in PHONE_CLASSES.values():
            assert not set(table) & set(table.values())
        english = PHONE_CLASSES["english"]
        assert set(english) | set(english.values()) <= set(PHONES)
        long_vowels = {phone for phone in PHONE_CLASSES["swedish"] if phone.endswith("ː")}
        assert len(long_vowels) == 11

    def test_an_unknown_table_is_refused(self) -> None:
        with pytest.raises(ValueError, match="swedish"):
            MergePhones("danish")


ALL = Transforms((
    Resample(30), MergePhones(), MergeSides(), Prune(("a",), (0.5,)), ZeroCentre(), TimeShift(0.25),
    EditFrames(0.2, 0.2),
))  # fmt: skip


class TestChain:
    def test_steps_are_applied_in_order_and_undone_in_reverse(self) -> None:
        sample = row(0.2, 0.8, 0.4, 0.1, 0.6, phones="G G G G G", fps=60)
        chain = Transforms((Resample(30), ZeroCentre(), MergePhones()))
        changed, records = chain.apply(sample)
        assert (column(changed), changed.phones) == ([0, 0, 0], ("K", "K", "K"))
        assert column(chain.invert(changed, records)) == [0.2, 0.3, 0.4, 0.5, 0.6]

    @given(samples(), st.integers(0, 99))
    def test_a_chain_of_those_that_lose_nothing_is_the_identity(
        self, sample: Sample, seed: int
    ) -> None:
        chain = Transforms((MergePhones(), ZeroCentre(), EditFrames(0.3, 0.3)))
        changed, records = chain.apply(sample, np.random.default_rng(seed))
        assert same(chain.invert(changed, records), sample, atol=1e-6)

    @given(samples())
    def test_without_lots_the_random_ones_change_nothing(self, sample: Sample) -> None:
        chain = Transforms((TimeShift(), EditFrames(0.5, 0.5)))
        assert same(chain.apply(sample)[0], sample)

    @given(samples(), st.integers(0, 99))
    def test_the_same_seed_gives_the_same_sample(self, sample: Sample, seed: int) -> None:
        one, two = (ALL.apply(sample, np.random.default_rng(seed))[0] for _ in range(2))
        assert same(one, two)

    def test_json_tells_all_and_gives_the_same_chain_back(self) -> None:
        assert {step.kind for step in ALL.steps} == set(TRANSFORMS)
        assert build_transforms(json.loads(json.dumps(ALL.describe()))) == ALL

    def test_a_prediction_is_undone_without_records(self) -> None:
        chain = Transforms((MergeSides(), Prune(("jawSide",)), ZeroCentre()))
        back = chain.invert(Sample(("mouthSmileSide",), [[0.0], [0.5]], ("AH", "AH"), 30.0))
        assert back.names == ("mouthSmileLeft", "mouthSmileRight", "jawLeft", "jawRight")
        assert np.allclose(back.values[1], [0.5, 0.5, 0, 0])

    def test_records_must_be_one_for_each_step(self) -> None:
        with pytest.raises(ValueError, match="0 records for 1"):
            Transforms((ZeroCentre(),)).invert(row(0), ())

    @pytest.mark.parametrize(
        ("described", "reason"),
        [
            ({}, "m.json: not a list"),
            ([7], "step 1: kind None is not one of: merge-sides"),
            ([{"kind": []}], "step 1: kind"),
            ([{"kind": "zero-centre"}, {"kind": "warp"}], "step 2: kind 'warp'"),
            ([{"kind": "resample", "rate": 3}], "resample has no 'rate'; it has: fps"),
            ([{"kind": "resample", "fps": "x"}], "step 1: resample"),
            ([{"kind": "resample", "fps": 0}], "not above 0"),
            ([{"kind": "prune"}], "step 1: prune"),
        ],
    )
    def test_what_is_no_chain_is_refused_in_one_line(self, described: object, reason: str) -> None:
        with pytest.raises(LipwrightError) as caught:
            build_transforms(described, "m.json")
        assert reason in str(caught.value)
        assert "\n" not in str(caught.value)
