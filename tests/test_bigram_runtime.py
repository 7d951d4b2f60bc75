"""From phones to curves of poses, as section 2.2 of Xu et al. 2013 has it.

What smoothing, constraints and the speed limit do to curves is in test_passes.py.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.missing import missing, stand_in
from lipwright.bigrams.runtime import pair_clips, spans, stitch
from lipwright.bigrams.spline import SAMPLES, basis, dense
from lipwright.bigrams.values import Bigram, BigramSet, Pair, Points, Pose
from lipwright.clip import Clip, frame_times
from lipwright.curves import Floats
from lipwright.engines.bigram import animate
from lipwright.face.head import Head
from lipwright.language.pace import spoken_track
from lipwright.passes import apply_passes, bigram_passes
from lipwright.phones import BILABIALS, SILENCE
from lipwright.pipeline import AnimateOptions, animate_track
from lipwright.track import PhoneTrack

SHIPPED = ("english", "mandarin", "swedish")
BESIDE = 0.04  # s around a phone in which its closure counts; one frame of video
LINE = "Bob may find five plump frogs, and my shy mum will show them to you."
EVEN = np.linspace(0, 1, SAMPLES)
quick = settings(deadline=None, max_examples=40)
shipped = lru_cache(load_bigrams)


def make_set(curves: Mapping[str, Mapping[str, Points]], **changes: Any) -> BigramSet:
    """A set of our own: "a i" and so on to the curves of that pair."""
    drawn = [Bigram(*_pair(name), poses) for name, poses in curves.items()]
    fields: dict[str, Any] = {
        "name": "mine", "language": "en", "licence": "CC0-1.0", "source": "a test",
        "rig": "facefx",
        "classes": {"a": ("AA",), "i": ("IY",), "d": ("D",), "bmp": ("B",), "sil": ("sil",)},
        "poses": {"open": Pose("open"), "W": Pose("W", 1.0), "PBM": Pose("PBM", 5.0, "widen")},
        "bigrams": {bigram.pair: bigram for bigram in drawn},
    }  # fmt: skip
    return BigramSet(**{**fields, **changes})


def _pair(name: str) -> Pair:
    first, second = name.split()
    return first, second


def track(spelling: str, *edges: float) -> PhoneTrack:
    return PhoneTrack(tuple(spelling.split()), np.array(edges))


def final(bigrams: BigramSet, phones: PhoneTrack, fps: float) -> Clip:
    """The curves of the poses after all that the set does to them."""
    return apply_passes(animate(phones, fps, None, bigrams), phones, bigram_passes(bigrams))


@st.composite
def points(draw: st.DrawFn, most: int = 12) -> Points:
    count = draw(st.integers(1, most))
    times = sorted(draw(st.lists(st.floats(0, 1), min_size=count, max_size=count)))
    return tuple((time, draw(st.floats(-0.2, 1.2))) for time in times)


# ---- the smooth curve of control points


def exact(control: Points, parameters: int) -> Floats:
    """(parameters, 2), scipy's clamped uniform cubic through the control polygon."""
    from scipy.interpolate import BSpline

    degree = min(3, len(control) - 1)
    knots = [0.0] * degree + np.linspace(0, 1, len(control) - degree + 1).tolist() + [1.0] * degree
    curve = BSpline(np.array(knots), np.array(control), degree)
    return np.asarray(curve(np.linspace(0, 1, parameters)), np.float64)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 9, 33])
def test_the_basis_is_that_of_scipy(count: int) -> None:
    for row, column in enumerate(basis(count).T):
        alone = tuple((0.0, float(other == row)) for other in range(count))
        assert column == pytest.approx(exact(alone, len(column))[:, 1], abs=1e-12)


@quick
@given(points())
def test_a_curve_is_scipys_in_time_as_in_value(control: Points) -> None:
    # Both coordinates are splines; between the parameters it is straight, which cuts curves short.
    wanted = exact(control, 4097)
    steps = np.diff(np.array(control), axis=0, prepend=[control[0]])
    assume((steps[1:, 0] > 0.05).all())
    found = np.interp(EVEN, wanted[:, 0], wanted[:, 1])
    assert dense(control) == pytest.approx(found, abs=0.01)


def test_a_curve_of_four_points_is_bernsteins() -> None:
    # With four points there is one span: 3 s (1-s)^2 v1 + 3 s^2 (1-s) v2 between ends at 0. Evenly
    # spaced points make time = s. At 1/4: 3/4 * 9/16 * 1 = 27/64; at 1/2: 3/8 * (1 + 0).
    curve = dense(((0.0, 0.0), (1 / 3, 1.0), (2 / 3, 0.0), (1.0, 0.0)))
    assert curve[[0, 16, 32, 64]] == pytest.approx([0, 27 / 64, 3 / 8, 0], abs=1e-9)


def test_two_points_are_a_line_and_one_is_level() -> None:
    assert dense(((0.0, 1.0), (1.0, 0.0))) == pytest.approx(1 - EVEN)
    assert set(dense(((0.3, 0.7),)).tolist()) == {0.7}


@quick
@given(points(), st.floats(-1, 1), st.floats(-1, 1))
def test_a_curve_stays_within_what_its_points_enclose(
    control: Points, right: float, up: float
) -> None:
    # A convex set is all that lies below its farthest point in every direction.
    curve = dense(control)
    (first, _), (last, _) = control[0], control[-1]
    inside = (first <= EVEN) & (last >= EVEN)
    farthest = max(right * time + up * value for time, value in control)
    assert (right * EVEN + up * curve)[inside].max(initial=farthest) <= farthest + 1e-9
    assert curve.min() >= min(value for _, value in control) - 1e-9
    assert curve.max() <= max(value for _, value in control) + 1e-9


@quick
@given(points())
def test_a_curve_begins_and_ends_in_its_outer_points_and_holds_them(control: Points) -> None:
    curve = dense(control)
    (first, at_first), (last, at_last) = control[0], control[-1]
    assert curve[first > EVEN] == pytest.approx(at_first)
    assert curve[last < EVEN] == pytest.approx(at_last)


@quick
@given(points())
def test_a_curve_is_nowhere_steeper_than_its_polygon(control: Points) -> None:
    gaps = np.diff(np.array(control), axis=0)
    assume((gaps[:, 0] > 1e-3).all())
    steepest = float(np.abs(gaps[:, 1] / gaps[:, 0]).max(initial=0))
    assert np.abs(np.diff(dense(control))).max() <= steepest / (SAMPLES - 1) + 1e-9


# ---- stitching


def test_stitching_as_worked_by_hand() -> None:
    # "a i" is over (t0, t2) = 0 to 0.4 s: open = 1 - t / 0.4. "i d" is over (t1, t3) = 0.2 to
    # 0.8 s: open = 0.6 (t - 0.2) / 0.6 = t - 0.2. Where both sound (0.2 to 0.4) the greater stays:
    # at 0.2 s 0.5 over 0, at 0.3 s 0.25 over 0.1, at 0.4 s 0.2 over 0.
    bigrams = make_set({"a i": {"open": ((0, 1), (1, 0))}, "i d": {"open": ((0, 0), (1, 0.6))}})
    clip = stitch(bigrams, track("AA IY D", 0, 0.2, 0.4, 0.8), fps=10)
    wanted = [1, 0.75, 0.5, 0.25, 0.2, 0.3, 0.4, 0.5, 0.6]
    assert clip.curve("open") == pytest.approx(wanted, abs=1e-6)
    assert not clip.curve("W").any()


def test_each_pair_is_over_the_time_of_both_phones() -> None:
    laid = spans(make_set({}), track("AA IY D IY", 0, 0.1, 0.3, 0.6, 1))
    assert [(span.pair, span.start, span.end) for span in laid] == [
        (("a", "i"), 0, 0.3), (("i", "d"), 0.1, 0.6), (("d", "i"), 0.3, 1),
    ]  # fmt: skip


@pytest.mark.parametrize("name", SHIPPED)
def test_stitching_is_the_maximum_of_both_pairs_at_every_frame(name: str) -> None:
    # Another way: frame by frame, from scipy's curves. No pause is cut and no peak is moved, which
    # the paper does not know.
    whole = shipped(name)
    lowered = {pose: replace(value, limit="lower") for pose, value in whole.poses.items()}
    bigrams = replace(whole, poses=lowered, silence=100.0)
    phones, fps = spoken_track(LINE), 50.0
    clip = stitch(bigrams, phones, fps)
    curves: dict[tuple[str, str], Floats] = {}
    wanted = np.zeros((len(clip), len(clip.names)))
    for index, pair in enumerate(itertools.pairwise(map(bigrams.class_of, phones.phones))):
        start, end = phones.edges[index], phones.edges[index + 2]
        bigram = stand_in(bigrams, pair)[0]
        for pose, control in (bigram.curves if bigram else {}).items():
            curve = curves.setdefault((str(pair), pose), exact(control, 1025))
            place = (clip.times - start) / (end - start)
            values = np.interp(place, curve[:, 0], curve[:, 1])
            held = (place >= -1e-9) & (place <= 1 + 1e-9)
            column = clip.column(pose)
            wanted[held, column] = np.maximum(wanted[held, column], values[held])
    assert clip.values == pytest.approx(wanted, abs=0.012)  # of a closure's ramp between samples
    assert float(np.abs(clip.values - wanted).mean()) < 5e-4


@quick
@given(st.lists(st.floats(0.03, 0.4), min_size=1, max_size=8), st.sampled_from([0.25, 0.5, 2, 4]))
def test_a_slower_track_has_the_same_curves_slower(lengths: list[float], slower: float) -> None:
    bigrams = replace(shipped("english"), silence=100.0)
    names = tuple(itertools.islice(itertools.cycle(("B", "AA", "sil", "IY", "SH")), len(lengths)))
    phones = PhoneTrack(names, np.cumsum([0.0, *lengths]))
    slow = phones.with_edges(phones.edges * slower)
    one, other = stitch(bigrams, phones, 60), stitch(bigrams, slow, 60 / slower)
    assert one.values == pytest.approx(other.values, abs=1e-5)


def test_the_peak_of_a_closure_is_put_on_the_nearest_frame_and_that_of_others_is_not() -> None:
    # 0.04 s of "bmp a" from 0.1 s on: the peak is in the middle, at 0.12 s; of the frames at 0.10
    # and 0.15 s the nearer one gets it whole.
    peak = ((0.0, 0.0), (0.5, 1.0), (0.5, 1.0), (0.5, 1.0), (1.0, 0.0))
    bigrams = make_set({"bmp a": {"PBM": peak, "open": peak}})
    clip = stitch(bigrams, track("B AA", 0.1, 0.12, 0.14), fps=20)
    assert clip.curve("PBM").tolist() == [0, 0, 1, 0]
    assert clip.curve("open").max() < 0.5


def test_the_curves_of_each_pair_are_its_own_and_as_long() -> None:
    bigrams = shipped("english")
    phones = track("sil M AA sil", 0, 0.5, 0.6, 0.8, 1.3)
    shown = pair_clips(bigrams, phones, 100)
    assert [span.pair for span, _ in shown if not span.within_pause] == [
        ("sil", "bmp"), ("bmp", "aa"), ("aa", "sil"),
    ]  # fmt: skip
    for span, clip in shown:
        assert clip.duration == pytest.approx(span.end - span.start, abs=0.011)
    (_, middle) = next(row for row in shown if row[0].pair == ("bmp", "aa"))
    curve = dense(bigrams.bigrams["bmp", "aa"].curves["PBM"])
    assert middle.curve("PBM")[:-1] == pytest.approx(
        np.interp(middle.times[:-1] / 0.3, EVEN, curve), abs=1e-6
    )


# ---- editing


def raised(bigrams: BigramSet, pair: Pair) -> BigramSet:
    """The set with other curves of one pair: each pose of the face as far again from rest."""
    bigram = bigrams.bigrams[pair]
    other = ((0.0, 0.0), (0.3, 0.9), (0.6, 0.4), (1.0, 0.0))
    curves = {pose: tuple((t, 1 - v) for t, v in points) for pose, points in bigram.curves.items()}
    return bigrams.with_bigram(replace(bigram, curves={**curves, "open": other, "tRoof": other}))


def reached(before: Clip, after: Clip, bigrams: BigramSet) -> npt.NDArray[np.bool_]:
    """(T,), the frames to which smoothing and the speed limit can carry a change of a pair.

    Maxima are joined over 2 t_w. A maximum that is level is one at both its ends or at neither:
    it carries a change from end to end. Speed is limited within the time that the whole height
    takes at l_max. Constraints carry a change to other poses and to no other frame.
    """
    reach = np.zeros(len(before), bool)
    for clip in (before, after):
        for old, new, column in zip(before.values.T, after.values.T, clip.values.T, strict=True):
            level = np.diff(column) == 0
            for frame in np.flatnonzero(old != new):
                first, last = max(frame - 1, 0), min(frame + 1, len(clip) - 1)
                while first > 0 and level[first - 1]:
                    first -= 1
                while last < len(level) and level[last]:
                    last += 1
                reach[first : last + 1] = True
    height = max(np.ptp(clip.values, axis=0).max() for clip in (before, after))
    seconds = 2 * bigrams.smoothing + height / bigrams.speed_limit
    frames = int(np.ceil(seconds * before.fps)) + 1
    return np.convolve(reach, np.ones(2 * frames + 1), "same") > 0


@pytest.mark.parametrize(
    "pair", [("bmp", "aa"), ("f", "ay"), ("sil", "bmp"), ("d", "d"), ("sh", "ow"), ("w", "sil")]
)
def test_editing_a_pair_changes_only_the_frames_where_it_sounds(pair: Pair) -> None:
    bigrams = shipped("english")
    phones = spoken_track(LINE)
    edited = raised(bigrams, pair)
    before, after = stitch(bigrams, phones, 60), stitch(edited, phones, 60)
    sounds = [span for span in spans(bigrams, phones) if span.pair == pair]
    assert sounds
    held = np.zeros(len(before), bool)
    for span in sounds:
        held |= (before.times >= span.start - 1e-6) & (before.times <= span.end + 1e-6)
    changed = (before.values != after.values).any(axis=1)
    assert changed.any()
    assert not changed[~held].any()
    reach = reached(before, after, bigrams)
    moved = final(bigrams, phones, 60).values != final(edited, phones, 60).values
    assert moved.any()
    assert not moved[~reach].any()
    assert not reach.all()
    assert reach.mean() < held.mean() + 0.2 * len(sounds)


@settings(quick, max_examples=12)
@given(st.integers(0, 2**32 - 1))
def test_no_edit_reaches_further_than_smoothing_and_the_speed_limit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bigrams = shipped(str(rng.choice(SHIPPED)))
    phones = random_track(rng, bigrams, 30)
    pair = next(s.pair for s in spans(bigrams, phones)[8:] if s.pair in bigrams.bigrams)
    edited = raised(bigrams, pair)
    before, after = stitch(bigrams, phones, 60), stitch(edited, phones, 60)
    moved = final(bigrams, phones, 60).values != final(edited, phones, 60).values
    assert not moved[~reached(before, after, bigrams)].any()


# ---- closures


def random_track(
    rng: np.random.Generator, bigrams: BigramSet, count: int, silence: bool = True
) -> PhoneTrack:
    """Phones of 30 to 200 ms, a quarter of them bilabial, with pauses of 30 ms to 1 s or none."""
    phones = sorted(phone for names in bigrams.classes.values() for phone in names)
    shut = [phone for phone in phones if phone in BILABIALS]
    said = [str(rng.choice(shut if rng.random() < 0.25 else phones)) for _ in range(count)]
    said = [phone for phone in said if silence or phone != SILENCE] or ["M"]
    lengths = [rng.uniform(0.03, 1 if phone == SILENCE else 0.2) for phone in said]
    return PhoneTrack(tuple(said), np.cumsum([0.0, *lengths]))


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("fps", [24, 25, 30, 50, 60])
def test_every_bilabial_shuts_the_lips(name: str, fps: float, head: Head) -> None:
    bigrams = shipped(name)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        phones = random_track(rng, bigrams, 60, silence=bool(seed % 2))
        poses = final(bigrams, phones, fps)
        shut = (poses.curve("PBM") >= 0.999) & (poses.curve("open") == 0)
        posed = animate_track(phones, AnimateOptions(bigrams=bigrams, fps=fps))
        aperture = head.aperture_curve(posed.values)
        narrow = aperture < 0.15 * np.percentile(aperture, 95)
        for phone, start, end in phones:
            if phone in BILABIALS:
                beside = (poses.times >= start - BESIDE) & (poses.times <= end + BESIDE)
                assert (shut & narrow)[beside].any(), (phone, start, end, seed)


# ---- pauses, gaps and lengths


def test_a_pause_is_reached_into_and_the_rest_of_it_rests() -> None:
    # With 0.1 s of silence, "sil a" is over 0.9 to 1.2 s and "a sil" over 1 to 1.3 s.
    level = {"open": ((0.0, 0.5), (1.0, 0.5))}
    bigrams = make_set({"sil a": level, "a sil": level}, silence=0.1)
    phones = track("sil AA sil", 0, 1, 1.2, 2)
    clip = stitch(bigrams, phones, fps=20)
    moving = np.flatnonzero(clip.curve("open"))
    assert clip.times[moving[[0, -1]]].tolist() == [0.9, 1.3]
    assert [s.pair for s in spans(bigrams, phones) if s.within_pause] == [("sil", "sil")] * 2


def test_the_pair_of_silence_with_itself_fills_the_middle_of_a_pause() -> None:
    breath = {"open": ((0.0, 0.25), (1.0, 0.25))}
    bigrams = make_set({"sil sil": breath}, silence=0.1)
    clip = stitch(bigrams, track("AA sil AA", 0, 0.2, 1.2, 1.4), fps=20)
    moving = np.flatnonzero(clip.curve("open"))
    assert clip.times[moving[[0, -1]]].tolist() == pytest.approx([0.3, 1.1])


def test_a_short_pause_is_held_by_the_pairs_on_both_sides() -> None:
    bigrams = make_set({}, silence=0.12)
    laid = spans(bigrams, track("AA sil IY", 0, 0.1, 0.25, 0.4))
    assert [(span.pair, span.start, span.end) for span in laid] == [
        (("a", "sil"), 0, pytest.approx(0.22)), (("sil", "i"), pytest.approx(0.13), 0.4),
    ]  # fmt: skip


@pytest.mark.parametrize("phone", ["sil", "AA", "M"])
def test_one_phone_is_no_pair_and_rests(phone: str) -> None:
    phones = track(phone, 0, 0.5)
    clip = final(shipped("english"), phones, 60)
    assert len(clip) == 31
    assert not clip.values.any()


def test_a_set_without_silence_rests_at_pauses() -> None:
    classes = {"a": ("AA",), "i": ("IY",)}
    bigrams = make_set({"a i": {"open": ((0, 1), (1, 1))}}, classes=classes)
    phones = track("sil AA IY sil", 0, 0.5, 0.6, 0.8, 1.5)
    clip = stitch(bigrams, phones, fps=10)
    assert clip.curve("open").tolist() == [0] * 5 + [1] * 4 + [0] * 7
    assert [pair for pair, _, _ in missing(bigrams, phones)] == [("", "a"), ("i", "")]


def test_a_track_that_begins_later_rests_before() -> None:
    bigrams = make_set({"a i": {"open": ((0, 1), (1, 1))}})
    clip = stitch(bigrams, track("AA IY", 0.5, 0.7, 1), fps=10)
    assert clip.curve("open").tolist() == [0] * 5 + [1] * 6


def test_a_missing_pair_is_played_as_the_most_alike_one_or_rests() -> None:
    level = {"open": ((0.0, 0.5), (1.0, 0.5))}
    bigrams = make_set({"a d": level})
    assert stitch(bigrams, track("IY D", 0, 0.1, 0.2), fps=10).curve("open").tolist() == [0.5] * 3
    assert not stitch(bigrams, track("D B", 0, 0.1, 0.2), fps=10).values.any()


@pytest.mark.parametrize("fps", [0.1, 1, 24, 59.94, 240, 1000])
def test_any_rate_gives_the_same_curves(fps: float) -> None:
    bigrams, phones = shipped("english"), spoken_track(LINE)
    poses = {name: replace(pose, limit="lower") for name, pose in bigrams.poses.items()}
    bigrams = replace(bigrams, poses=poses)
    clip, fine = stitch(bigrams, phones, fps), stitch(bigrams, phones, 1000)
    assert len(clip) == len(frame_times(phones.end, fps))
    here = np.rint(clip.times * 1000) < len(fine)
    wanted = fine.at(clip.times[here])
    assert float(np.abs(clip.values[here] - wanted).mean()) < 2e-3


def test_an_hour_is_its_minutes_one_after_the_other() -> None:
    bigrams = shipped("english")
    once = spoken_track(" ".join([LINE] * 10))
    step = np.ceil(once.end)  # whole frames
    phones = (*once.phones[:-1], SILENCE)
    lengths = np.diff([*once.edges[:-1], step])
    times = int(3600 / step)
    whole = PhoneTrack(phones * times, np.concatenate([[0.0], np.cumsum(np.tile(lengths, times))]))
    minute = final(bigrams, PhoneTrack(phones, np.concatenate([[0.0], np.cumsum(lengths)])), 60)
    hour = final(bigrams, whole, 60)
    frames = int(60 * step)
    parts = hour.values[: frames * times].reshape(times, frames, -1)
    assert np.abs(parts - minute.values[:frames]).max() < 1e-5


def test_the_same_track_gives_the_same_bytes() -> None:
    phones = spoken_track(LINE)
    once, again = (final(shipped("swedish"), phones, 60) for _ in range(2))
    assert once.values.tobytes() == again.values.tobytes()
