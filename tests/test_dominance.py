"""The dominance engine: its table is closed, planted answers, and the laws of coarticulation."""

from __future__ import annotations

import csv
import tracemalloc
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL, MIRROR
from lipwright.engines import DEFAULT, ENGINES, dominance, get_engine
from lipwright.engines.dominance import (
    ARTICULATORS,
    PULLS,
    TARGET_COLUMNS,
    Segments,
    Target,
    animate,
    load_targets,
    pulls,
    targets_of,
)
from lipwright.errors import LipwrightError
from lipwright.phones import ARPABET, PHONES
from lipwright.rig import load_rig
from lipwright.track import PhoneTrack

FPS = 100.0
quick = settings(deadline=None, max_examples=40)


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
    lengths = st.floats(0.02, longest)
    durations = draw(st.lists(lengths, min_size=len(phones), max_size=len(phones)))
    return PhoneTrack(tuple(phones), np.concatenate([[0], np.cumsum(durations)]))


def column_of(target: Target, name: str) -> float:
    """What a target wants of a canonical control, clipped to its range."""
    bare = name.removesuffix("Left").removesuffix("Right")
    for column in (name, bare):
        if column in TARGET_COLUMNS:
            return float(np.clip(target.values[TARGET_COLUMNS.index(column)], 0, 1))
    return 0.0


def value(clip: Clip, name: str, time: float) -> float:
    return float(clip.at([time])[0, clip.column(name)])


class TestRegistry:
    @pytest.mark.parametrize("name", [name for name in ENGINES if ENGINES[name].ships])
    def test_every_engine_is_there_and_animates_from_0_to_the_end(self, name: str) -> None:
        clip = get_engine(name)(track("sil HH AH L OW sil"), 60.0, None)
        assert clip.names == (load_rig("facefx").names if name == "bigram" else CANONICAL)
        assert clip.fps == 60
        assert len(clip) == len(frame_times(0.6, 60))
        assert ENGINES[name].summary

    def test_the_default_engine_is_registered(self) -> None:
        assert DEFAULT in ENGINES

    def test_an_unknown_engine_is_refused_with_the_known_ones(self) -> None:
        with pytest.raises(LipwrightError, match="no engine 'magic'; the engines are: dominance"):
            get_engine("magic")


class TestTable:
    def test_each_phone_has_one_row_and_each_diphthong_two(self) -> None:
        table = load_targets()
        assert set(table) == ARPABET  # what it lacks takes the targets of the nearest
        for symbol, targets in table.items():
            wanted = [1, 2] if PHONES[symbol].is_diphthong else [0]
            assert [target.part for target in targets] == wanted
            assert all(target.phone == symbol for target in targets)

    def test_the_columns_are_exactly_those_of_the_articulators(self) -> None:
        text = files("lipwright.engines").joinpath("dominance_targets.csv").read_text("utf-8")
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        header = next(csv.reader(lines))
        strengths = [f"pull_{articulator}" for articulator in ARTICULATORS]
        assert header == ["phone", "part", "example", "source", *TARGET_COLUMNS, *strengths]
        assert all(row.count(",") == len(header) - 1 for row in lines)

    def test_every_column_is_a_canonical_control_with_or_without_sides_in_one_articulator(
        self,
    ) -> None:
        assert len(set(TARGET_COLUMNS)) == len(TARGET_COLUMNS)
        for column in TARGET_COLUMNS:
            sides = (f"{column}Left", f"{column}Right")
            assert (column in CANONICAL) != all(side in CANONICAL for side in sides)
        assert set(PULLS) == set(ARTICULATORS)

    @pytest.mark.parametrize("symbol", load_targets())
    def test_targets_are_usable_numbers_with_a_source(self, symbol: str) -> None:
        for target in load_targets()[symbol]:
            assert np.isfinite(target.values).all()
            assert np.abs(target.values).max() <= 2
            assert np.isfinite(target.dominance).all()
            assert min(target.dominance) > 0
            assert target.source in ("fitted", "rule")
            assert target.example == PHONES[symbol].example

    @pytest.mark.parametrize(
        ("phones", "control"),
        [("T D N L", "tongueRaise"), ("K G NG", "tongueBack"), ("TH DH", "tonguePress")],
    )
    def test_consonants_own_the_tongue(self, phones: str, control: str) -> None:
        for phone in phones.split():
            (target,) = load_targets()[phone]
            assert column_of(target, control) >= 0.9

    def test_silence_is_rest(self) -> None:
        (target,) = load_targets()["sil"]
        assert max(map(abs, target.values)) == 0

    def test_lips_that_touch_open_less_than_any_vowel(self) -> None:
        jaw = {s: max(column_of(t, "jawOpen") for t in load_targets()[s]) for s in ARPABET}
        vowels = [jaw[symbol] for symbol in ARPABET if PHONES[symbol].is_vowel]
        assert max(jaw[symbol] for symbol in ("P", "B", "M", "EM")) < min(vowels)

    def test_pulls_have_usable_shapes(self) -> None:
        for pull in PULLS.values():
            assert min(*pull.rise, *pull.fall, pull.power) > 0
            assert 0 <= pull.plateau <= 1
            assert abs(pull.lead) < 0.1

    def test_a_phone_that_the_table_lacks_uses_the_nearest(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        table = {symbol: rows for symbol, rows in load_targets().items() if symbol != "M"}
        monkeypatch.setattr(dominance, "load_targets", lambda: table)
        (target,) = targets_of("M")
        assert target.phone in ("B", "EM", "P")
        assert len(animate(track("AA M AA"), FPS)) == 31


class TestPulls:
    @quick
    @given(tracks(), st.sampled_from(tuple(ARTICULATORS)))
    def test_they_are_shares_that_sum_to_1_at_every_time(
        self, phones: PhoneTrack, articulator: str
    ) -> None:
        segments = Segments.of(phones)
        times = np.linspace(-5, phones.end + 5, 200)
        share = pulls(segments, articulator, times)
        assert share.shape == (200, len(segments.targets))
        assert share.min() >= 0
        assert share.sum(axis=1) == pytest.approx(1)

    @quick
    @given(tracks())
    def test_segments_are_the_phones_with_diphthongs_in_halves(self, phones: PhoneTrack) -> None:
        segments = Segments.of(phones)
        wanted = [(part.phone, part) for symbol in phones.phones for part in targets_of(symbol)]
        assert [(t.phone, t) for t in segments.targets] == wanted
        assert segments.start[1:] == pytest.approx(segments.end[:-1])
        assert (segments.start[0], segments.end[-1]) == (phones.start, phones.end)

    @quick
    @given(tracks(longest=30), st.sampled_from(tuple(ARTICULATORS)))
    def test_in_its_middle_a_phone_longer_than_a_second_pulls_most(
        self, phones: PhoneTrack, articulator: str
    ) -> None:
        segments = Segments.of(phones)
        middles = (segments.start + segments.end) / 2 - PULLS[articulator].lead
        share = pulls(segments, articulator, middles)
        for index in np.flatnonzero(segments.end - segments.start > 1):
            assert share[index].argmax() == index
            assert share[index, index] > 0.5


class TestPlantedAnswers:
    @pytest.mark.parametrize("symbol", [s for s, p in PHONES.items() if not p.is_diphthong])
    def test_a_track_of_one_phone_is_its_target(self, symbol: str) -> None:
        (target,) = targets_of(symbol)
        clip = animate(track(symbol, 0.5), FPS)
        wanted = [column_of(target, name) for name in CANONICAL]
        assert clip.values == pytest.approx(np.tile(wanted, (51, 1)), abs=1e-6)

    @pytest.mark.parametrize("symbol", ["AA", "IY", "UW", "S", "M", "L", "TH"])
    @pytest.mark.parametrize("seconds", [1.0, 5.0, 40.0])
    def test_a_held_phone_reaches_its_target_in_its_middle(
        self, symbol: str, seconds: float
    ) -> None:
        clip = animate(track(f"sil B:0.08 {symbol}:{seconds} B:0.08 sil", 0.5), 30.0)
        (target,) = targets_of(symbol)
        for name in ("jawOpen", "mouthPucker", "mouthStretchLeft", "tongueRaise"):
            middle = value(clip, name, 0.58 + seconds / 2)
            assert middle == pytest.approx(column_of(target, name), abs=0.02)

    def test_a_held_vowel_stays_open_until_shortly_before_its_end(self) -> None:
        clip = animate(track("sil:0.5 AA:5 B sil:1"), FPS)
        (target,) = targets_of("AA")
        inside = clip.curve("jawOpen")[100:520]
        assert inside == pytest.approx(column_of(target, "jawOpen"), abs=0.02)

    def test_a_long_pause_stays_at_rest_until_shortly_before_the_sound(self) -> None:
        clip = animate(track("sil:30 AA:0.2 B AA sil:20 AA sil:5"), 30.0)
        for start, end in ((0, 29.5), (31.5, 49.8), (51.5, 55)):
            quiet = clip.curve("jawOpen")[round(start * 30) : round(end * 30)]
            assert quiet.max() < 0.03

    def test_both_sides_move_alike(self) -> None:
        clip = animate(track("sil S IY T UW sil"), FPS)
        for name in CANONICAL:
            if not name.startswith(("jaw", "eyeLook")):
                assert clip.curve(name).tolist() == clip.curve(MIRROR[name]).tolist()

    def test_what_speech_does_not_move_is_at_rest(self) -> None:
        clip = animate(track("sil W AH T sil"), FPS)
        still = [n for n in CANONICAL if n.startswith(("eye", "brow", "cheek", "nose"))]
        assert clip.select(still).values.max() == 0

    def test_a_track_that_starts_late_is_animated_from_0_s(self) -> None:
        clip = animate(track("AA B", start=1.0), FPS)
        assert clip.duration == pytest.approx(1.2)


class TestCoarticulation:
    @quick
    @given(tracks(), st.sampled_from([24.0, 30.0, 60.0]))
    def test_every_value_is_within_the_range_of_the_targets(
        self, phones: PhoneTrack, fps: float
    ) -> None:
        clip = animate(phones, fps)
        targets = [target for symbol in phones.phones for target in targets_of(symbol)]
        for name in CANONICAL:
            wanted = [column_of(target, name) for target in targets]
            assert min(wanted) - 1e-5 <= clip.curve(name).min()
            assert clip.curve(name).max() <= max(wanted) + 1e-5

    @pytest.mark.parametrize("word", ["B AA B", "M AE P", "F AY V", "P AO M", "T EH T"])
    def test_faster_speech_opens_the_jaw_less(self, word: str) -> None:
        peaks = [
            animate(track(f"sil:0.3 {word} sil:0.3", seconds), FPS).curve("jawOpen").max()
            for seconds in (0.3, 0.15, 0.075)
        ]
        assert peaks[0] > peaks[1] > peaks[2]

    def test_lips_round_before_the_vowel_where_the_consonants_leave_them_free(self) -> None:
        # "coo" and "key": during the K the lips already show which vowel comes.
        rounded, spread = (animate(track(f"sil:0.3 K {v} sil:0.3"), FPS) for v in ("UW", "IY"))
        middle_of_k = 0.35
        in_the_vowel = max(value(rounded, "mouthPucker", at) for at in (0.4, 0.45, 0.5))
        assert value(rounded, "mouthPucker", middle_of_k) > 0.25 * in_the_vowel
        assert value(rounded, "mouthPucker", middle_of_k) > 2 * value(
            spread, "mouthPucker", middle_of_k
        )

    def test_a_consonant_that_owns_the_lips_delays_the_rounding(self) -> None:
        free, owned = (animate(track(f"sil:0.3 {c} UW sil:0.3"), FPS) for c in ("K", "S"))
        assert value(owned, "mouthPucker", 0.35) < value(free, "mouthPucker", 0.35)

    def test_a_vowel_carries_over_into_the_consonant_after_it(self) -> None:
        after_uw, after_iy = (animate(track(f"sil:0.3 {v} K sil:0.3"), FPS) for v in ("UW", "IY"))
        assert value(after_uw, "mouthPucker", 0.45) > value(after_iy, "mouthPucker", 0.45) + 0.1

    @pytest.mark.parametrize("symbol", [s for s, p in PHONES.items() if p.is_diphthong])
    def test_diphthongs_move(self, symbol: str) -> None:
        clip = animate(track(f"sil:0.3 {symbol}:0.2 sil:0.3"), FPS)
        moved = [
            abs(value(clip, name, 0.35) - value(clip, name, 0.45))
            for name in ("jawOpen", "mouthPucker", "mouthFunnel", "mouthStretchLeft")
        ]
        # "ate" begins and ends with nearly the same lips.
        assert max(moved) > (0.005 if symbol == "EY" else 0.04)

    def test_ow_and_aw_end_less_open_and_oy_ends_less_rounded_than_they_begin(self) -> None:
        for symbol, name in (("OW", "jawOpen"), ("AW", "jawOpen"), ("OY", "mouthFunnel")):
            clip = animate(track(f"sil:0.3 {symbol}:0.2 sil:0.3"), FPS)
            assert value(clip, name, 0.45) < value(clip, name, 0.35) - 0.05

    @pytest.mark.parametrize("symbol", ["T", "D", "N", "L"])
    def test_the_tongue_rises_in_alveolars_between_vowels(self, symbol: str) -> None:
        clip = animate(track(f"sil AA {symbol} AA sil"), FPS)
        assert value(clip, "tongueRaise", 0.25) > 0.6
        assert value(clip, "tongueRaise", 0.25) > 1.5 * value(clip, "tongueRaise", 0.15)


class TestComputing:
    def test_the_same_track_gives_the_same_clip(self) -> None:
        phones = track("sil HH AH L OW W ER L D sil")
        assert animate(phones, FPS).values.tobytes() == animate(phones, FPS).values.tobytes()

    @pytest.mark.parametrize("longest", [0.2, 3.0, 20.0])
    def test_computing_in_chunks_changes_nothing(
        self, longest: float, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        random = np.random.default_rng(7)
        count = round(max(80, 60 / longest))
        phones = tuple(random.choice(tuple(PHONES), count))
        durations = random.uniform(0.03, longest, count)
        phone_track = PhoneTrack(phones, np.concatenate([[0], np.cumsum(durations)]))
        fps = max(2000 / phone_track.end, 5.0)
        in_chunks = animate(phone_track, fps)
        assert len(in_chunks) > 3 * dominance.CHUNK_FRAMES
        monkeypatch.setattr(dominance, "CHUNK_FRAMES", 10**7)
        assert in_chunks.values == pytest.approx(animate(phone_track, fps).values, abs=1e-3)

    def test_ten_minutes_need_little_memory(self) -> None:
        phones = track(" ".join(["sil:0.2 HH AH L OW W ER L D"] * 600))
        assert phones.end == pytest.approx(600)
        tracemalloc.start()
        try:
            clip = animate(phones, 30.0)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        assert len(clip) == 18001
        assert peak < 4 * clip.values.nbytes + 15e6
