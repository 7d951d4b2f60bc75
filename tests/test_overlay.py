"""The overlay engine: its table is closed, planted answers, and what the thesis says of it."""

from __future__ import annotations

import csv
import tracemalloc
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL, MIRROR, both_sides
from lipwright.curves import bezier_ease
from lipwright.engines import overlay
from lipwright.engines.overlay import (
    EASE,
    FADE_IN,
    FIVE_FRAMES,
    LIP_EASE,
    LONGEST,
    LONGEST_EASE,
    TABLE,
    TIMING,
    UPPER_LIP,
    animate,
    apexes,
    laid_over,
    load_table,
    upper_lip,
    visemes_of,
)
from lipwright.engines.visemes import POSED
from lipwright.passes import SHUT
from lipwright.passes.openings import gaps
from lipwright.phones import ARPABET, BILABIALS, PHONES, SILENCE
from lipwright.track import PhoneTrack

FPS = 100.0
LIP = POSED.index("mouthUpperUp")
quick = settings(deadline=None, max_examples=20)
VOWELS = [symbol for symbol, phone in PHONES.items() if phone.is_vowel]
CONSONANTS = [symbol for symbol, phone in PHONES.items() if phone.is_consonant]


def track(spelling: str, seconds: float = 0.1, start: float = 0.0) -> PhoneTrack:
    """Phones of one duration; `AA:1.5` lasts 1.5 s."""
    phones, durations = [], []
    for item in spelling.split():
        phone, _, duration = item.partition(":")
        phones.append(phone)
        durations.append(float(duration or seconds))
    return PhoneTrack(tuple(phones), start + np.concatenate([[0], np.cumsum(durations)]))


@st.composite
def tracks(draw: st.DrawFn, longest: float = 0.4) -> PhoneTrack:
    phones = draw(st.lists(st.sampled_from(tuple(PHONES)), min_size=1, max_size=12))
    lengths = st.floats(0.01, longest)
    durations = draw(st.lists(lengths, min_size=len(phones), max_size=len(phones)))
    return PhoneTrack(tuple(phones), np.concatenate([[0], np.cumsum(durations)]))


def value(clip: Clip, control: str, time: float) -> float:
    return float(clip.at([time])[0, clip.column(both_sides(control)[0])])


def bezier(x: float, first: float, second: float) -> float:
    """The curve of figure 4.7 by de Casteljau, at the t where it has this x."""

    def point(t: float) -> np.ndarray:
        points = np.array([(0, 0), (first, 0), (second, 1), (1, 1)], float)
        while len(points) > 1:
            points = (1 - t) * points[:-1] + t * points[1:]
        return np.asarray(points[0])

    t = brentq(lambda t: point(t)[0] - x, 0, 1)
    return float(point(t)[1])


class TestTable:
    def test_every_english_phone_has_a_row_and_a_diphthong_two(self) -> None:
        table = load_table()
        assert set(table) == ARPABET
        for symbol, rows in table.items():
            assert [row.part for row in rows] == ([1, 2] if PHONES[symbol].is_diphthong else [0])

    @pytest.mark.parametrize("symbol", PHONES)
    def test_every_phone_has_visemes_of_its_kind(self, symbol: str) -> None:
        for viseme in visemes_of(symbol):
            assert PHONES[viseme.name].is_vowel == PHONES[symbol].is_vowel
            assert PHONES[viseme.name].is_consonant == PHONES[symbol].is_consonant

    def test_its_columns_are_those_that_are_read_and_its_weights_are_weights(self) -> None:
        text = files("lipwright.engines").joinpath(TABLE).read_text("utf-8")
        rows = list(csv.DictReader(r for r in text.splitlines() if not r.startswith("#")))
        assert tuple(rows[0]) == ("name", "part", "example", "source", *TIMING, *POSED)
        for row in rows:
            assert row["example"] == PHONES[row["name"]].example
            assert row["source"] in ("fitted", "rule")
            assert all(0 <= float(row[name]) <= 1 for name in POSED if row[name])
            assert 0 <= float(row["hold"]) <= 1
            assert float(row["fade_out"]) > 0

    def test_vowels_and_silence_say_all_and_silence_is_rest(self) -> None:
        for symbol, rows in load_table().items():
            if not PHONES[symbol].is_consonant:
                assert all(set(row.values) == set(POSED) for row in rows)
        assert not visemes_of(SILENCE)[0].pose().any()

    @pytest.mark.parametrize("symbol", sorted(BILABIALS))
    def test_closures_are_those_of_the_passes_and_come_last(self, symbol: str) -> None:
        (viseme,) = visemes_of(symbol)
        assert dict(viseme.values) == pytest.approx({k: v for k, (_, v) in SHUT.items()})
        assert set(list(load_table())[-len(BILABIALS) :]) == BILABIALS

    def test_alveolars_velars_and_dentals_move_the_tongue(self) -> None:
        for symbols, control in (("TDNL", "tongueRaise"), ("KG", "tongueBack")):
            for symbol in symbols:
                assert visemes_of(symbol)[0].values[control] > 0.7
        assert visemes_of("TH")[0].values["tonguePress"] > 0.7

    def test_open_vowels_open_and_rounded_ones_round(self) -> None:
        def net(symbol: str) -> float:
            pose = visemes_of(symbol)[0].values
            return pose["jawOpen"] - pose["mouthClose"]

        assert min(net("AA"), net("AE"), net("AY")) > net("UW") + 0.05
        for other in ("IY", "EH", "AE"):
            assert (visemes_of("UW")[0].values["mouthPucker"]
                    > visemes_of(other)[0].values["mouthPucker"] + 0.05)  # fmt: skip


class TestBezier:
    @pytest.mark.parametrize("points", [EASE, LIP_EASE])
    def test_the_curve_is_that_of_the_thesis(self, points: tuple[float, float]) -> None:
        for x in np.linspace(0.001, 0.999, 97):
            assert bezier_ease(x, *points) == pytest.approx(bezier(float(x), *points), abs=3e-5)

    def test_it_stays_at_its_ends(self) -> None:
        assert bezier_ease([-1, 0, 1, 9], *LIP_EASE).tolist() == [0, 0, 1, 1]


class TestVowels:
    @quick
    @given(st.lists(st.sampled_from([*VOWELS, SILENCE]), min_size=1, max_size=9),
           st.floats(0.05, 1.5))  # fmt: skip
    def test_without_consonants_each_apex_is_its_viseme(
        self, phones: list[str], seconds: float
    ) -> None:
        said = track(" ".join(phones), seconds)
        times = np.array([apex.time for apex in apexes(said)])
        clip = animate(said, 1000.0)
        lifted = UPPER_LIP * upper_lip(said, times)
        for time, lip, apex in zip(times, lifted, apexes(said), strict=True):
            wanted = apex.viseme.pose()
            wanted[LIP] += lip
            got = [value(clip, control, time) for control in POSED]
            assert got == pytest.approx(np.clip(wanted, 0, 1), abs=3e-3)

    def test_a_vowel_is_reached_in_its_first_frame(self) -> None:
        said = track("sil:0.5 AA:0.2 IY:0.2 sil:0.5")
        found = [(apex.viseme.name, round(apex.time, 4)) for apex in apexes(said)]
        assert found == [("sil", 0), ("sil", round(0.5 - FIVE_FRAMES, 4)), ("AA", 0.5),
                         ("IY", 0.7), ("sil", 0.9), ("sil", 1.4)]  # fmt: skip

    def test_half_way_between_apexes_is_half_way_between_visemes(self) -> None:
        clip = animate(track("AA:0.2 UW:0.2"), 1000.0)
        for control in ("jawOpen", "mouthPucker", "tongueBack"):
            ends = [visemes_of(v)[0].values[control] for v in ("AA", "UW")]
            assert value(clip, control, 0.1) == pytest.approx(np.mean(ends), abs=1e-3)
            share = bezier(0.25, *EASE)
            assert value(clip, control, 0.05) == pytest.approx(
                (1 - share) * ends[0] + share * ends[1], abs=1e-3
            )

    def test_vowels_meet_through_the_consonants_between_them(self) -> None:
        # Öhman 1967: k leaves the lips to the movement from one vowel to the other.
        through = animate(track("UW:0.1 HH:0.1 IY:0.2"), FPS)
        without = animate(track("UW:0.2 IY:0.2"), FPS)
        names = ("jawOpen", "mouthPucker", "mouthFunnel")
        assert through.select(names).values == pytest.approx(without.select(names).values, abs=1e-6)

    def test_the_mouth_opens_five_frames_before_the_first_sound(self) -> None:
        clip = animate(track("sil:3 HH:0.1 AA:0.3 sil:0.5"), FPS)
        still = round((3 - FIVE_FRAMES) * FPS)
        assert clip.values[: still + 1].max() == 0
        assert value(clip, "jawOpen", 3.0) > 0.01

    def test_a_long_vowel_is_held(self) -> None:
        clip = animate(track("AA:5 IY:0.2 sil"), FPS)
        opened = clip.curve("jawOpen")[: round((5 - LONGEST_EASE) * FPS)]
        assert opened == pytest.approx(visemes_of("AA")[0].values["jawOpen"], abs=1e-6)

    @pytest.mark.parametrize("symbol", [s for s, p in PHONES.items() if p.is_diphthong])
    def test_diphthongs_move(self, symbol: str) -> None:
        first, second = (viseme.pose() for viseme in visemes_of(symbol))
        assert np.abs(first - second).max() > 0.02


class TestUpperLip:
    def test_it_rises_within_five_frames_and_falls_until_the_silence(self) -> None:
        said = track("sil:0.5 S:0.2 T:0.8 sil:0.5")
        times = np.linspace(0, 2, 201)
        lifted = upper_lip(said, times)
        assert lifted[times <= 0.5].max() == 0
        assert lifted[times >= 1.5].max() == 0
        peak = times[lifted.argmax()]
        assert peak == pytest.approx(0.5 + FIVE_FRAMES, abs=0.01)
        assert lifted.max() == pytest.approx(1, abs=0.01)
        assert (np.diff(lifted[(times > peak) & (times < 1.5)]) <= 0).all()

    @quick
    @given(tracks(1.0))
    def test_it_is_the_highest_of_all_its_curves(self, said: PhoneTrack) -> None:
        times = np.arange(0, said.end, 0.003)
        wanted = np.zeros(len(times))
        spoken = [phone != SILENCE for phone in said.phones]
        for index, phone in enumerate(said.phones):
            begins = spoken[index] and (index == 0 or not spoken[index - 1])
            if not (begins or PHONES[phone].is_vowel):
                continue
            start = said.edges[index]
            end = next((said.edges[at] for at in range(index, len(said)) if not spoken[at]),
                       said.end)  # fmt: skip
            peak = start + min(FIVE_FRAMES, (end - start) / 2)
            rise = bezier_ease((times - start) / (peak - start), *LIP_EASE)
            fall = bezier_ease((end - times) / (end - peak), *LIP_EASE)
            wanted = np.maximum(wanted, np.minimum(rise, fall))
        assert upper_lip(said, times) == pytest.approx(wanted, abs=1e-9)


class TestConsonants:
    def test_a_consonant_fades_in_before_it_and_out_from_its_beginning(self) -> None:
        said = track("AA:0.4 T:0.06 AA:0.4")
        (laid,) = laid_over(said)
        (viseme,) = visemes_of("T")
        assert laid.start == pytest.approx(0.4)
        length = min(0.06, LONGEST)
        assert laid.fade_in == pytest.approx(FADE_IN * length)
        assert laid.fade_out == pytest.approx(viseme.timing["fade_out"] * length)
        assert laid.strength(np.array([0.4 - laid.fade_in, 0.4])) == pytest.approx([0, 1], abs=1e-9)
        clip = animate(said, 1000.0)
        assert value(clip, "tongueRaise", 0.4) == pytest.approx(
            viseme.values["tongueRaise"], abs=0.02
        )

    @pytest.mark.parametrize("symbol", CONSONANTS)
    def test_each_is_its_viseme_in_full_between_vowels(self, symbol: str) -> None:
        clip = animate(track(f"AA:0.3 {symbol}:0.1 AA:0.3"), 1000.0)
        for control, wanted in visemes_of(symbol)[0].values.items():
            assert value(clip, control, 0.3) == pytest.approx(wanted, abs=2e-3)

    @pytest.mark.parametrize("symbol", sorted(BILABIALS))
    @pytest.mark.parametrize("vowel", ["AA", "IY", "UW", "AY"])
    def test_lips_shut_at_closures_whatever_the_vowels_are(self, symbol: str, vowel: str) -> None:
        said = track(f"sil:0.3 {vowel}:0.15 {symbol}:0.08 {vowel}:0.15 sil:0.3")
        aperture = np.maximum(gaps(animate(said, 60.0)), 0).mean(axis=1)
        in_p = aperture[round(0.45 * 60) : round(0.53 * 60)]
        assert in_p.min() < 0.1 * np.percentile(aperture, 95)
        assert aperture[round(0.3 * 60) : round(0.4 * 60)].max() > 0.03

    def test_closures_win_over_their_neighbours(self) -> None:
        clip = animate(track("AA:0.2 S:0.05 P:0.05 R:0.05 AA:0.2"), 1000.0)
        assert value(clip, "jawOpen", 0.25) == pytest.approx(SHUT["jawOpen"][1], abs=2e-3)

    def test_a_long_consonant_is_held(self) -> None:
        clip = animate(track("AA:0.3 M:2 AA:0.3"), FPS)
        inside = clip.curve("jawOpen")[round(0.3 * FPS) : round(2.1 * FPS)]
        assert inside == pytest.approx(SHUT["jawOpen"][1], abs=1e-3)


class TestComputing:
    @quick
    @given(tracks(), st.sampled_from([0.1, 24.0, 60.0, 1000.0]))
    def test_any_track_gives_weights_from_0_to_its_end(self, said: PhoneTrack, fps: float) -> None:
        clip = animate(said, fps)
        assert clip.names == CANONICAL
        assert len(clip) == len(frame_times(said.end, fps))
        assert clip.values.min() >= 0
        assert clip.values.max() <= 1
        for name in POSED:
            left, *_ = both_sides(name)
            assert clip.curve(left).tolist() == clip.curve(MIRROR[left]).tolist()

    @pytest.mark.parametrize("said", ["sil:2", "AA:0.01", "P:0.01", "sil:0.01 M:0.01 sil:0.01"])
    def test_short_tracks_work(self, said: str) -> None:
        assert np.isfinite(animate(track(said), 60.0).values).all()

    def test_silence_is_rest(self) -> None:
        assert animate(track("sil sil sil:4"), 60.0).values.max() == 0

    def test_a_track_that_starts_late_is_animated_from_0_s(self) -> None:
        clip = animate(track("AA:0.2 B:0.1", start=1.0), FPS)
        assert clip.duration == pytest.approx(1.3)
        assert clip.values[: round((1 - FIVE_FRAMES) * FPS)].max() == 0
        assert value(clip, "jawOpen", 1.0) > 0.05

    def test_computing_in_chunks_changes_nothing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        random = np.random.default_rng(7)
        phones = tuple(random.choice(tuple(PHONES), 300))
        edges = np.concatenate([[0], np.cumsum(random.uniform(0.02, 0.5, 300))])
        said = PhoneTrack(phones, edges)
        whole = animate(said, 60.0)
        monkeypatch.setattr(overlay, "CHUNK_FRAMES", 97)
        assert animate(said, 60.0).values.tobytes() == whole.values.tobytes()

    def test_minutes_need_little_memory(self) -> None:
        said = track(" ".join(["HH AH L OW W ER L D"] * 200), 0.125)
        tracemalloc.start()
        try:
            clip = animate(said, 90.0)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert len(clip) == 18001
        assert peak < 3 * clip.values.nbytes + 15e6
