"""Each pass has a law; the closures of speech are never lost."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL, GROUPS
from lipwright.engines.dominance import animate
from lipwright.errors import LipwrightError
from lipwright.passes import (
    CLOSERS,
    MAX_FADE,
    REQUIREMENTS,
    SHUT,
    SHUT_JAW,
    SPEECH_LEAD,
    SPEECH_TAIL,
    Pass,
    Requirement,
    apply_passes,
    consonants,
    default_passes,
    ease,
    intensity,
    limit,
    parted,
    requirements_beside,
    silence,
    smooth,
    speech_share,
    speed_limit,
    strength,
)
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

NAN, INFINITY = float("nan"), float("inf")
BILABIALS = ("P", "B", "M", "EM")
MOVED = GROUPS["jaw"] + GROUPS["lips"]
PARTS = [name for part in ("jaw", "lips", "tongue") for name in GROUPS[part]]
quick = settings(deadline=None, max_examples=40)

MAKERS: dict[str, Pass] = {
    "intensity": intensity(1.3),
    "smooth": smooth(),
    "silence": silence(),
    "consonants": consonants(),
    "speed_limit": speed_limit(),
    "limit": limit(),
}


def track(spelling: str, seconds: float = 0.1) -> PhoneTrack:
    """Phones of one duration; `AA:1.5` lasts 1.5 s."""
    phones, durations = [], []
    for item in spelling.split():
        phone, _, duration = item.partition(":")
        phones.append(phone)
        durations.append(float(duration or seconds))
    return PhoneTrack(tuple(phones), np.concatenate([[0], np.cumsum(durations)]))


@st.composite
def tracks(draw: st.DrawFn, shortest: float = 0.03, among: tuple[str, ...] = ()) -> PhoneTrack:
    choice = st.sampled_from(among or tuple(PHONES))
    phones = draw(st.lists(choice, min_size=1, max_size=10))
    lengths = st.floats(shortest, 0.3)
    durations = draw(st.lists(lengths, min_size=len(phones), max_size=len(phones)))
    return PhoneTrack(tuple(phones), np.concatenate([[0], np.cumsum(durations)]))


def flat(phones: PhoneTrack, fps: float = 60.0, value: float = 0.0) -> Clip:
    """Every control at one value, with the frames of a track."""
    frames = len(frame_times(phones.end, fps))
    return Clip(CANONICAL, fps, np.full((frames, len(CANONICAL)), value))


def wide_open(phones: PhoneTrack, fps: float = 60.0) -> Clip:
    """A mouth that never closes, with everything that parts the lips in full."""
    clip = flat(phones, fps)
    names = ("jawOpen", "mouthFunnel", "mouthLowerDownLeft", "mouthLowerDownRight",
             "mouthUpperUpLeft", "mouthUpperUpRight", "tongueOut")  # fmt: skip
    return clip.with_curves({name: np.ones(len(clip)) for name in names})


def noise(phones: PhoneTrack, fps: float = 60.0, seed: int = 0) -> Clip:
    clip = flat(phones, fps)
    values = np.random.default_rng(seed).random(clip.values.shape)
    return clip.with_values(values)


def openness(clip: Clip) -> npt.NDArray[np.float32]:
    """(T,), how far the lips are from touching: 0 where they touch."""
    gap = np.abs(clip.curve("jawOpen") - clip.curve("mouthClose"))
    for name in ("mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft",
                 "mouthUpperUpRight", "mouthFunnel"):  # fmt: skip
        gap = np.maximum(gap, clip.curve(name))
    return np.maximum(gap, clip.curve("jawOpen") - SHUT_JAW)


def middle_of(requirement: Requirement, start: float, end: float, pause: float) -> float:
    """The middle of what is held in full of a phone."""
    times = np.linspace(start - 0.2, end + 0.2, round((end - start + 0.4) * 4000))
    return float(times[strength(requirement, start, end, times, pause) > 1 - 1e-9].mean())


def required(phones: PhoneTrack, wanted: tuple[str, ...]) -> list[tuple[int, Requirement, float]]:
    """Index, requirement and middle of each of the wanted phones."""
    found = []
    for index, (phone, start, end) in enumerate(phones):
        for requirement in REQUIREMENTS:
            if phone in wanted and phone in requirement.phones:
                silent = index > 0 and phones.phones[index - 1] == SILENCE
                pause = start - phones.edges[index - 1] if silent else 0.0
                found.append((index, requirement, middle_of(requirement, start, end, pause)))
    return found


def sides(control: str) -> tuple[str, ...]:
    return (control,) if control in CANONICAL else (f"{control}Left", f"{control}Right")


class TestList:
    def test_the_default_order_lets_closures_win_over_all_that_could_open_the_lips(self) -> None:
        names = [step.__qualname__.partition(".")[0] for step in default_passes()]
        assert names == ["intensity", "smooth", "silence", "consonants", "speed_limit", "limit"]

    @pytest.mark.parametrize("name", MAKERS)
    @quick
    @given(tracks(), st.sampled_from([24.0, 30.0, 60.0]))
    def test_a_pass_keeps_names_rate_and_length_and_leaves_its_input(
        self, name: str, phones: PhoneTrack, fps: float
    ) -> None:
        clip = noise(phones, fps)
        before = clip.values.tobytes()
        after = MAKERS[name](clip, phones)
        assert (after.names, after.fps, len(after)) == (clip.names, clip.fps, len(clip))
        assert clip.values.tobytes() == before

    @pytest.mark.parametrize("name", MAKERS)
    def test_a_pass_works_on_clips_that_have_few_controls(self, name: str) -> None:
        phones = track("sil M AA sil")
        for names in (("jawOpen",), ("smile", "tongueOut"), ()):
            clip = Clip(names, 60, np.full((25, len(names)), 0.5))
            assert MAKERS[name](clip, phones).names == names

    @pytest.mark.parametrize("name", MAKERS)
    def test_a_pass_works_on_a_clip_of_one_frame(self, name: str) -> None:
        clip = Clip(CANONICAL, 60, np.full((1, len(CANONICAL)), 0.5))
        assert len(MAKERS[name](clip, track("M"))) == 1

    def test_passes_are_applied_in_the_order_of_the_list(self) -> None:
        phones = track("sil AA sil", 0.5)
        clip = flat(phones, value=0.5)

        def raise_jaw(clip: Clip, track: PhoneTrack) -> Clip:
            return clip.with_curves({"jawOpen": clip.curve("jawOpen") + 0.25})

        silent_last = apply_passes(clip, phones, [raise_jaw, silence()])
        silent_first = apply_passes(clip, phones, [silence(), raise_jaw])
        assert silent_last.curve("jawOpen")[0] == 0
        assert silent_first.curve("jawOpen")[0] == 0.25
        assert apply_passes(clip, phones, []) is clip


class TestIntensity:
    def test_1_is_the_identity(self) -> None:
        clip = noise(track("AA B"))
        assert intensity(1.0)(clip, track("AA B")).values.tolist() == clip.values.tolist()

    def test_a_half_halves_jaw_and_lips_and_leaves_the_rest(self) -> None:
        clip = noise(track("AA B"))
        half = intensity(0.5)(clip, track("AA B"))
        for name in CANONICAL:
            factor = 0.5 if name in MOVED else 1.0
            assert half.curve(name) == pytest.approx(factor * clip.curve(name), abs=1e-6)

    def test_0_is_rest(self) -> None:
        still = intensity(0.0)(noise(track("AA B")), track("AA B"))
        assert still.select(MOVED).values.max() == 0

    def test_one_and_a_half_scales_up_to_the_knee_and_bends_above_it(self) -> None:
        clip = Clip(("jawOpen",), 60, np.array([[0.2], [0.5], [0.6], [0.9]]))
        more = intensity(1.5)(clip, track("AA B")).curve("jawOpen")
        assert more[:2] == pytest.approx([0.3, 0.75])
        assert 0.8 < more[2] < 0.9
        assert 0.9 < more[3] < 1

    @example(value=1.0, one=1.0, other=1.1)
    @given(st.floats(0, 1, width=32), st.floats(0, 3), st.floats(0, 3))
    def test_more_never_moves_less_and_never_passes_the_full_range(
        self, value: float, one: float, other: float
    ) -> None:
        clip = Clip(("jawOpen",), 60, np.array([[value]]))
        less, more = (
            float(intensity(amount)(clip, track("AA")).values[0, 0])
            for amount in sorted((one, other))
        )
        assert 0 <= less <= more + 1e-6 <= 1 + 1e-6

    @given(st.floats(0, 1), st.floats(0, 1), st.floats(0, 3))
    def test_what_is_further_open_stays_further_open(
        self, one: float, other: float, amount: float
    ) -> None:
        clip = Clip(("jawOpen",), 60, np.array([sorted((one, other))]).T)
        low, high = intensity(amount)(clip, track("AA")).curve("jawOpen").tolist()
        assert low <= high + 1e-6

    @pytest.mark.parametrize("amount", [-1.0, -1e-9, 3.01, 9.0, NAN, INFINITY])
    def test_amounts_out_of_range_are_refused(self, amount: float) -> None:
        for make in (intensity, default_passes):
            with pytest.raises(LipwrightError, match="give a number from 0 to 3"):
                make(amount)


class TestSmooth:
    def test_constants_stay(self) -> None:
        clip = flat(track("AA B"), value=0.3)
        assert smooth()(clip, track("AA B")).values.tolist() == clip.values.tolist()

    @pytest.mark.parametrize("sigma", [0.012, 0.03, 0.1])
    @pytest.mark.parametrize("fps", [24.0, 60.0, 120.0])
    def test_an_impulse_keeps_its_sum_and_is_symmetric_around_its_frame(
        self, sigma: float, fps: float
    ) -> None:
        values = np.zeros((201, 1))
        values[100] = 1
        curve = smooth(sigma)(Clip(("jawOpen",), fps, values), track("AA")).curve("jawOpen")
        assert curve == pytest.approx(curve[::-1], abs=1e-7)
        assert curve.argmax() == 100
        assert curve.sum() == pytest.approx(1, abs=1e-5)
        assert (np.diff(curve[:101]) >= 0).all()

    def test_its_width_is_sigma(self) -> None:
        values = np.zeros((2001, 1))
        values[1000] = 1
        curve = smooth(0.03)(Clip(("jawOpen",), 1000, values), track("AA")).curve("jawOpen")
        steps = (np.arange(2001) - 1000) / 1000
        assert np.sqrt((curve * steps**2).sum()) == pytest.approx(0.03, rel=0.03)

    @given(arrays(np.float32, (40, 2), elements=st.floats(0, 1, width=32)))
    def test_it_commutes_with_time_reversal_and_stays_in_range(
        self, values: npt.NDArray[np.float32]
    ) -> None:
        clip = Clip(("jawOpen", "mouthClose"), 60, values)
        there = smooth(0.05)(clip, track("AA")).values
        back = smooth(0.05)(clip.with_values(values[::-1]), track("AA")).values[::-1]
        assert there == pytest.approx(back, abs=1e-6)
        assert values.min() - 1e-6 <= there.min()
        assert there.max() <= values.max() + 1e-6

    @pytest.mark.parametrize("sigma", [0.0, 0.001])
    def test_less_than_a_frame_is_the_identity(self, sigma: float) -> None:
        clip = noise(track("AA B"))
        assert smooth(sigma)(clip, track("AA B")).values.tolist() == clip.values.tolist()

    @pytest.mark.parametrize("sigma", [-0.01, NAN, INFINITY])
    def test_other_widths_are_refused(self, sigma: float) -> None:
        with pytest.raises(LipwrightError, match="give 0 or more"):
            smooth(sigma)


class TestSilence:
    PHONES = track("sil:1 AA:0.5 sil:1 B:0.2 AA:0.3 sil:1")

    def test_jaw_lips_and_tongue_rest_deep_in_silence(self) -> None:
        clip = silence()(flat(self.PHONES, value=0.5), self.PHONES)
        for start, end in ((0, 1 - SPEECH_LEAD), (1.5 + SPEECH_TAIL, 2.5 - SPEECH_LEAD),
                           (3 + SPEECH_TAIL, 9)):  # fmt: skip
            inside = (clip.times >= start) & (clip.times <= end)
            assert clip.select(PARTS).values[inside].max() == pytest.approx(0, abs=1e-6)

    def test_speech_and_the_rest_of_the_face_are_untouched(self) -> None:
        before = noise(self.PHONES)
        clip = silence()(before, self.PHONES)
        share = speech_share(self.PHONES, clip.times)
        spoken = ((clip.times >= 1) & (clip.times < 1.5)) | ((clip.times >= 2.5) & (clip.times < 3))
        assert (share[spoken] == 1).all()
        assert clip.values[spoken].tolist() == before.values[spoken].tolist()
        others = [name for name in CANONICAL if name not in PARTS]
        assert clip.select(others).values.tolist() == before.select(others).values.tolist()

    def test_the_mouth_opens_and_shuts_evenly_and_never_jumps(self) -> None:
        times = np.arange(0, 4, 0.001)
        share = speech_share(self.PHONES, times)
        assert np.abs(np.diff(share)).max() < 0.02
        assert (np.diff(share[:1000]) >= -1e-12).all()
        assert (np.diff(share[1500:2300]) <= 1e-12).all()

    def test_a_short_pause_shuts_the_mouth_only_in_part(self) -> None:
        phones = track("AA:0.5 sil:0.15 AA:0.5")
        share = speech_share(phones, np.linspace(0.5, 0.65, 100))
        assert 0.1 < share.min() < 1

    @quick
    @given(tracks(), st.floats(0.1, 0.9))
    def test_splitting_a_silence_in_two_changes_nothing(
        self, phones: PhoneTrack, where: float
    ) -> None:
        quiet = [index for index, phone in enumerate(phones.phones) if phone == SILENCE]
        if not quiet:
            return
        index = quiet[0]
        start, end = phones.edges[index], phones.edges[index + 1]
        split = PhoneTrack(
            (*phones.phones[:index], SILENCE, *phones.phones[index:]),
            np.insert(phones.edges, index + 1, start + where * (end - start)),
        )
        times = np.arange(0, phones.end + 0.1, 0.005)
        assert speech_share(split, times) == pytest.approx(speech_share(phones, times))

    def test_a_track_of_silence_alone_is_rest_to_the_last_frame(self) -> None:
        for spelling in ("sil:0.55", "sil:0.2 sil:0.35"):
            clip = silence()(flat(track(spelling), value=0.5), track(spelling))
            assert clip.select(PARTS).values.max() == 0

    def test_before_a_track_that_starts_late_the_mouth_rests(self) -> None:
        share = speech_share(track("AA:1").shifted(1.0), np.arange(0, 2, 0.1))
        assert share[:10].max() == 0
        assert share[10:].min() == 1

    @pytest.mark.parametrize(("lead", "tail"), [(0.0, 0.1), (0.1, 0.0), (-1.0, 0.1), (0.1, NAN)])
    def test_ramps_of_no_length_are_refused(self, lead: float, tail: float) -> None:
        with pytest.raises(LipwrightError, match="give numbers above 0"):
            silence(lead, tail)


class TestEase:
    def test_it_goes_from_0_to_1_and_holds_the_ends(self) -> None:
        assert ease([-5, 0, 0.5, 1, 5]) == pytest.approx([0, 0, 0.5, 1, 1], abs=1e-6)

    def test_it_never_falls_and_is_flat_at_its_ends(self) -> None:
        curve = ease(np.linspace(0, 1, 10_001))
        assert (np.diff(curve) >= 0).all()
        assert curve[10] < 1e-4
        assert 1 - curve[-11] < 1e-4

    @given(st.floats(0, 1))
    def test_it_is_the_parametric_curve_of_the_thesis(self, t: float) -> None:
        x = 3 / 2 * (1 - t) ** 2 * t + 3 / 2 * (1 - t) * t**2 + t**3
        y = 3 * (1 - t) * t**2 + t**3
        assert float(ease(x)) == pytest.approx(y, abs=1e-4)

    @given(st.floats(0, 1))
    def test_it_is_symmetric_around_its_middle(self, x: float) -> None:
        assert float(ease(x)) == pytest.approx(1 - float(ease(1 - x)), abs=1e-5)


class TestRequirements:
    def test_the_table_names_only_phones_and_controls_that_exist(self) -> None:
        for requirement in REQUIREMENTS:
            assert set(requirement.phones) <= PHONES.keys()
            for control, (mode, value) in requirement.controls.items():
                assert set(sides(control)) <= set(CANONICAL), control
                assert mode in ("to", "at_least", "at_most")
                assert 0 <= value <= 1

    def test_shares_and_fades_are_in_order(self) -> None:
        for requirement in REQUIREMENTS:
            assert 0 <= requirement.full[0] < requirement.full[1] <= 1
            assert min(requirement.fade_in, requirement.fade_out, requirement.longest) > 0

    def test_the_example_is_one_of_its_phones(self) -> None:
        for requirement in REQUIREMENTS:
            # "Ten" and "Kit" are T and K, whose own examples in the phone table are others.
            own = {"Ten": "T", "Kit": "K"}.get(requirement.example)
            examples = {PHONES[phone].example: phone for phone in requirement.phones}
            assert (own or examples[requirement.example]) in requirement.phones

    def test_no_phone_has_two_rows(self) -> None:
        phones = [phone for requirement in REQUIREMENTS for phone in requirement.phones]
        assert len(set(phones)) == len(phones)

    def test_every_consonant_made_with_lips_or_tongue_against_something_has_a_row(self) -> None:
        needed = {
            symbol
            for symbol, phone in PHONES.items()
            if phone.is_consonant
            and (
                phone.place in ("bilabial", "labiodental", "dental", "labiovelar")
                or phone.manner in ("stop", "affricate", "nasal", "flap", "lateral")
            )
            and phone.place != "glottal"
        }
        assert needed <= {phone for requirement in REQUIREMENTS for phone in requirement.phones}

    def test_every_bilabial_shuts_the_lips_and_comes_after_all_that_could_open_them(self) -> None:
        shut = [r for r in REQUIREMENTS if r.controls is SHUT]
        assert {phone for requirement in shut for phone in requirement.phones} == set(BILABIALS)
        assert list(REQUIREMENTS[-len(shut) :]) == shut
        assert SHUT["jawOpen"] == SHUT["mouthClose"]

    @given(st.sampled_from(REQUIREMENTS), st.floats(0.02, 3), st.floats(0, 1), st.floats(0, 0.1))
    def test_strength_is_a_share_in_full_around_the_middle_and_gone_outside(
        self, requirement: Requirement, length: float, pause: float, least: float
    ) -> None:
        middle = middle_of(requirement, 1, 1 + length, pause)
        reach = max(least / 2 - 1e-3, 0)
        times = np.array([1 - MAX_FADE - 0.051, middle - reach, middle, middle + reach,
                          1 + length + MAX_FADE + 0.051])  # fmt: skip
        weights = strength(requirement, 1, 1 + length, times, pause, least)
        assert weights == pytest.approx([0, 1, 1, 1, 0], abs=1e-4)


class TestConsonants:
    @pytest.mark.parametrize("fps", [60.0, 120.0])
    @quick
    @given(phones=tracks(shortest=0.04))
    def test_lips_touch_inside_every_bilabial_of_a_mouth_that_is_wide_open(
        self, fps: float, phones: PhoneTrack
    ) -> None:
        clip = consonants()(wide_open(phones, fps), phones)
        gap = openness(clip)
        for before, (phone, start, end) in zip((None, *phones.phones), phones, strict=False):
            if phone in BILABIALS:
                # After a pause the lips may have shut before the sound.
                first = start - 0.05 if before == SILENCE else start
                inside = (clip.times >= first) & (clip.times <= end)
                assert gap[inside].min() < 1e-3

    @pytest.mark.parametrize("fps", [12.0, 24.0, 29.97, 30.0, 60.0, 240.0])
    @quick
    @given(phones=tracks(shortest=0.02))
    def test_at_any_rate_the_frame_nearest_to_the_middle_of_a_closure_is_shut(
        self, fps: float, phones: PhoneTrack
    ) -> None:
        clip = consonants()(wide_open(phones, fps), phones)
        gap = openness(clip)
        for _, _, middle in required(phones, BILABIALS):
            # The middle is looked for on a grid of 0.25 ms: of two frames as near, either may be.
            away = np.abs(clip.times - middle)
            assert gap[away <= away.min() + 0.0005].min() < 1e-3

    @pytest.mark.parametrize("fps", [30.0, 60.0])
    @pytest.mark.parametrize("symbol", BILABIALS)
    def test_a_closure_of_30_ms_is_shut_wherever_it_falls_between_frames(
        self, symbol: str, fps: float
    ) -> None:
        for offset in np.linspace(0.2, 0.2 + 1 / fps, 23):
            phones = track(f"AA:{offset} {symbol}:0.03 AA:0.2")
            gap = openness(consonants()(wide_open(phones, fps), phones))
            assert gap.min() < 1e-3

    def test_lips_are_apart_again_beside_a_closure(self) -> None:
        phones = track("AA:0.3 B:0.08 AA:0.3")
        clip = consonants()(wide_open(phones), phones)
        for time in (0.0, 0.2, 0.48, 0.68):
            frame = np.abs(clip.times - time).argmin()
            assert clip.values[frame].tolist() == wide_open(phones).values[frame].tolist()

    def test_a_long_closure_after_a_pause_shuts_the_lips_at_its_end(self) -> None:
        phones = track("sil:0.3 P:0.5 AA:0.3")
        clip = consonants()(wide_open(phones), phones)
        shut = clip.times[openness(clip) < 1e-3]
        assert 0.65 < shut.min() <= shut.max() < 0.8

    @quick
    @given(phones=tracks(shortest=0.05), fps=st.sampled_from([24.0, 30.0, 60.0]))
    def test_at_the_nearest_frame_every_other_sound_has_what_it_needs_where_no_closure_is_near(
        self, phones: PhoneTrack, fps: float
    ) -> None:
        wanted = tuple(phone for phone in PHONES if phone not in BILABIALS)
        alone = PhoneTrack(
            tuple("AA" if phone in BILABIALS else phone for phone in phones.phones), phones.edges
        )
        clip = consonants()(flat(alone, fps, 0.5), alone)
        for index, requirement, middle in required(alone, wanted):
            near = alone.phones[max(index - 1, 0) : index + 2]
            rivals = {n for n in near if n not in requirement.phones and n not in ("AA", SILENCE)}
            frame = np.abs(clip.times - middle).argmin()
            for control, (mode, value) in requirement.controls.items():
                if rivals and mode != "at_least":
                    continue  # a later row may win
                if rivals & {"F", "V", "W", "WH"}:
                    continue
                for name in sides(control):
                    got = clip.curve(name)[frame]
                    if mode in ("at_least", "to"):
                        assert got >= value - 1e-3
                    if mode in ("at_most", "to"):
                        assert got <= value + 1e-3

    @pytest.mark.parametrize("fps", [24.0, 30.0, 60.0])
    @pytest.mark.parametrize(
        ("phones", "control", "least"),
        [
            ("T D N", "tongueRaise", 0.95), ("L EL", "tongueRaise", 0.9),
            ("K G NG", "tongueBack", 0.95), ("TH DH", "tonguePress", 0.95),
            ("W WH", "mouthPucker", 0.6), ("UW", "mouthPucker", 0.45),
            ("F V", "mouthRollLower", 0.4), ("F V", "mouthUpperUpLeft", 0.3),
            ("SH CH JH ZH", "mouthFunnel", 0.35), ("OW", "mouthPucker", 0.2),
        ],
    )  # fmt: skip
    def test_a_sound_between_vowels_shows_what_it_is_made_with(
        self, phones: str, control: str, least: float, fps: float
    ) -> None:
        for phone in phones.split():
            said = track(f"AA:0.3 {phone}:0.05 AA:0.3")
            curve = consonants()(flat(said, fps), said).curve(control)
            assert curve.max() >= least - 1e-3
            assert curve[0] == curve[-1] == 0

    def test_lips_that_round_further_than_required_are_left_alone(self) -> None:
        said = track("AA:0.3 W:0.1 AA:0.3")
        clip = flat(said).with_curves({"mouthPucker": np.full(43, 0.9)})
        assert set(consonants()(clip, said).curve("mouthPucker").tolist()) == {np.float32(0.9)}

    def test_the_jaw_is_nearly_shut_in_f_and_w(self) -> None:
        for phone in ("F", "V", "W", "WH"):
            said = track(f"AA:0.3 {phone}:0.08 AA:0.3")
            assert consonants()(wide_open(said), said).curve("jawOpen").min() <= 0.08 + 1e-3

    def test_vowels_and_silence_alone_change_nothing(self) -> None:
        said = track("sil AA IY EH sil")
        clip = noise(said)
        assert consonants()(clip, said).values.tolist() == clip.values.tolist()

    def test_a_users_requirement_takes_the_place_of_the_table(self) -> None:
        smile = Requirement(("IY",), "fEEl", {"mouthSmile": ("at_least", 0.7)})
        said = track("B IY B")
        clip = consonants([smile])(flat(said), said)
        assert clip.curve("mouthSmileLeft").max() == pytest.approx(0.7)
        assert clip.curve("mouthSmileRight").max() == pytest.approx(0.7)
        assert clip.select(["mouthClose", "mouthPressLeft"]).values.max() == 0


class TestSpeedLimit:
    @quick
    @given(
        arrays(np.float32, (30, 3), elements=st.floats(0, 1, width=32)),
        st.sampled_from([24.0, 60.0, 120.0]),
        st.sampled_from([2.0, 15.0, 50.0]),
    )
    def test_nothing_changes_faster_openers_never_rise_closers_never_fall_and_twice_is_once(
        self, values: npt.NDArray[np.float32], fps: float, speed: float
    ) -> None:
        clip = Clip(("jawOpen", "mouthClose", "mouthPressLeft"), fps, values)
        slow = speed_limit(speed)(clip, track("AA"))
        assert np.abs(np.diff(slow.values, axis=0)).max() <= speed / fps + 1e-6
        assert (slow.values[:, 0] <= values[:, 0] + 1e-6).all()
        assert (slow.values[:, 1:] >= values[:, 1:] - 1e-6).all()
        again = speed_limit(speed)(slow, track("AA"))
        assert again.values == pytest.approx(slow.values, abs=1e-6)

    def test_a_slow_motion_is_untouched(self) -> None:
        clip = Clip(("jawOpen",), 60, np.linspace(0, 1, 30)[:, None])
        assert speed_limit()(clip, track("AA")).values.tolist() == clip.values.tolist()

    def test_a_peak_becomes_the_highest_tent_under_it(self) -> None:
        values = np.zeros((9, 2))
        values[3:6] = 1
        slow = speed_limit(30)(Clip(("jawOpen", "mouthClose"), 60, values), track("AA"))
        assert slow.curve("jawOpen").tolist() == [0, 0, 0, 0.5, 1, 0.5, 0, 0, 0]
        assert slow.curve("mouthClose").tolist() == [0, 0, 0.5, 1, 1, 1, 0.5, 0, 0]

    def test_closers_are_canonical_controls(self) -> None:
        assert set(CANONICAL) >= CLOSERS

    @pytest.mark.parametrize("speed", [0.0, -1.0, NAN])
    def test_other_limits_are_refused(self, speed: float) -> None:
        with pytest.raises(LipwrightError, match="give a number above 0"):
            speed_limit(speed)


class TestLimit:
    def test_it_clips_and_leaves_what_is_within(self) -> None:
        clip = Clip(("a",), 60, np.array([[-1.0], [0.0], [0.4], [1.0], [7.0]]))
        assert limit()(clip, track("AA")).curve("a") == pytest.approx([0, 0, 0.4, 1, 1])
        assert limit(0.2, 0.3)(clip, track("AA")).curve("a") == pytest.approx(
            [0.2, 0.2, 0.3, 0.3, 0.3]
        )


class TestTogether:
    @pytest.mark.parametrize("amount", [0.5, 1.0, 1.5, 3.0])
    @quick
    @given(phones=tracks(), fps=st.sampled_from([24.0, 30.0, 60.0]))
    def test_the_default_passes_keep_every_closure_the_range_and_the_speed(
        self, amount: float, phones: PhoneTrack, fps: float
    ) -> None:
        passes = default_passes(amount)
        for before in (animate(phones, fps), wide_open(phones, fps)):
            clip = apply_passes(before, phones, passes)
            assert clip.values.min() >= 0
            assert clip.values.max() <= 1
            assert np.abs(np.diff(clip.values, axis=0)).max(initial=0) <= 15 / fps + 1e-5
            gap = openness(clip)
            for _, _, middle in required(phones, BILABIALS):
                assert gap[np.abs(clip.times - middle).argmin()] < 1e-3

    def test_a_pause_has_a_shut_mouth_and_a_resting_tongue(self) -> None:
        phones = track("sil:0.5 TH IH S sil:1 K AE T sil:0.5")
        clip = apply_passes(animate(phones, 60.0), phones, default_passes())
        quiet = (clip.times < 0.3) | ((clip.times > 1.05) & (clip.times < 1.6))
        assert clip.select(PARTS).values[quiet].max() < 1e-6


class TestWhatALearntEngineStillNeeds:
    def test_an_engine_of_rules_needs_everything(self) -> None:
        assert requirements_beside((), ()) == REQUIREMENTS

    def test_closures_stay_whatever_was_learnt(self) -> None:
        kept = requirements_beside(PHONES, CANONICAL)
        assert [r for r in kept if r.controls is SHUT] == [
            r for r in REQUIREMENTS if r.controls is SHUT
        ]

    def test_the_tongue_of_learnt_sounds_is_laid_over_and_their_lips_are_not(self) -> None:
        kept = requirements_beside(PHONES, ("jawOpen", *GROUPS["lips"]))
        of_t = [r for r in kept if "T" in r.phones]
        of_th = [r for r in kept if "TH" in r.phones]
        assert [set(r.controls) for r in of_t] == [{"tongueRaise"}]
        assert [set(r.controls) for r in of_th] == [{"tonguePress", "tongueOut"}]
        of_w = [r for r in kept if "W" in r.phones]
        assert [dict(r.controls) for r in of_w] == [{"mouthPucker": ("at_least", 0.6)}]

    def test_sounds_that_were_never_heard_have_all_of_theirs(self) -> None:
        kept = requirements_beside(("sil", "T", "AA"), CANONICAL)
        for phone in ("SH", "W", "F", "UW"):
            assert [r for r in kept if phone in r.phones] == [
                r for r in REQUIREMENTS if phone in r.phones
            ]

    def test_the_lip_of_a_learnt_f_still_goes_behind_the_teeth(self) -> None:
        kept = requirements_beside(PHONES, CANONICAL)
        assert any("F" in r.phones and "mouthRollLower" in r.controls for r in kept)


class TestPartedLips:
    CLOSED: ClassVar = {"jawOpen": 0.2, "mouthClose": 0.2}

    @staticmethod
    def gap(clip: Clip) -> npt.NDArray[np.float32]:
        return clip.curve("jawOpen") - clip.curve("mouthClose")

    def parted_clip(self, phones: tuple[str, ...], pose: dict[str, float]) -> Clip:
        track = PhoneTrack(phones, np.arange(len(phones) + 1) * 0.3)
        times = frame_times(track.end, 60)
        names = tuple(pose)
        clip = Clip(names, 60, np.tile(list(pose.values()), (len(times), 1)))
        return parted()(clip, track)

    def test_lips_that_no_sound_shuts_are_opened_a_little(self) -> None:
        clip = self.parted_clip(("sil", "AA", "sil"), self.CLOSED)
        said = (clip.times > 0.31) & (clip.times < 0.59)
        np.testing.assert_allclose(self.gap(clip)[said], 0.07, atol=1e-6)
        np.testing.assert_allclose(clip.curve("jawOpen")[said], 0.2, atol=1e-6)

    def test_a_jaw_that_is_up_goes_down_where_the_lips_hold_nothing_back(self) -> None:
        clip = self.parted_clip(("sil", "AA", "sil"), {"jawOpen": 0.0, "mouthClose": 0.0})
        assert self.gap(clip)[(clip.times > 0.31) & (clip.times < 0.59)].min() > 0.069

    def test_closures_and_silence_stay_shut(self) -> None:
        clip = self.parted_clip(("sil", "AA", "B", "AA"), self.CLOSED)
        shut = (clip.times < 0.29) | ((clip.times > 0.56) & (clip.times < 0.94))
        assert np.abs(self.gap(clip)[shut]).max() < 1e-6
        assert self.gap(clip)[(clip.times > 0.35) & (clip.times < 0.45)].min() > 0.069

    def test_lips_that_are_open_stay_as_they_are(self) -> None:
        pose = {"jawOpen": 0.3, "mouthClose": 0.1}
        clip = self.parted_clip(("AA", "T", "AA"), pose)
        np.testing.assert_allclose(self.gap(clip), 0.2, atol=1e-6)

    @pytest.mark.parametrize("least", [-0.1, 1.1, NAN])
    def test_a_share_out_of_range_is_refused(self, least: float) -> None:
        with pytest.raises(LipwrightError, match="parted lips keep"):
            parted(least)

    def test_it_does_nothing_the_second_time(self) -> None:
        track = PhoneTrack(("sil", "AA", "B", "AA"), np.arange(5) * 0.2)
        clip = Clip(("jawOpen", "mouthClose"), 60, np.full((49, 2), 0.1))
        once = parted()(clip, track)
        np.testing.assert_allclose(parted()(once, track).values, once.values, atol=1e-6)
