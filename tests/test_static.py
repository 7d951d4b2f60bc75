"""The static engine: its table is closed, and it is straight lines between its poses."""

from __future__ import annotations

import csv
import tracemalloc
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL, both_sides
from lipwright.engines import static
from lipwright.engines.static import REST, TABLE, animate, class_of, keys, load_poses
from lipwright.engines.visemes import POSED
from lipwright.passes import SHUT
from lipwright.passes.openings import gaps
from lipwright.phones import COMMON, PHONES, SILENCE
from lipwright.track import PhoneTrack

quick = settings(deadline=None, max_examples=20)


def track(spelling: str, seconds: float = 0.1) -> PhoneTrack:
    """Phones of one duration; `AA:1.5` lasts 1.5 s."""
    pairs = [item.partition(":") for item in spelling.split()]
    durations = [float(duration or seconds) for _, _, duration in pairs]
    return PhoneTrack(tuple(phone for phone, _, _ in pairs), np.cumsum([0.0, *durations]))


@st.composite
def tracks(draw: st.DrawFn) -> PhoneTrack:
    phones = draw(st.lists(st.sampled_from(tuple(PHONES)), min_size=1, max_size=12))
    lengths = st.floats(0.01, 0.5)
    durations = draw(st.lists(lengths, min_size=len(phones), max_size=len(phones)))
    return PhoneTrack(tuple(phones), np.concatenate([[0], np.cumsum(durations)]))


def posed(clip: Clip) -> np.ndarray:
    """(T, K)."""
    return np.asarray(clip.select(both_sides(name)[0] for name in POSED).values)


class TestTable:
    def test_it_has_each_class_of_the_common_phoneme_set_and_silence_once(self) -> None:
        text = files("lipwright.engines").joinpath(TABLE).read_text("utf-8")
        rows = list(csv.DictReader(r for r in text.splitlines() if not r.startswith("#")))
        assert [row["name"] for row in rows] == [SILENCE, *COMMON]
        assert tuple(rows[0]) == ("name", "part", "example", "source", *POSED)
        for row in rows:
            assert row["example"]
            assert row["source"] in ("fitted", "rule")
            assert all(0 <= float(row[name]) <= 1 for name in POSED)

    @pytest.mark.parametrize("symbol", PHONES)
    def test_every_phone_has_a_pose(self, symbol: str) -> None:
        assert class_of(symbol) in load_poses()

    def test_silence_is_rest_and_lips_shut_where_they_touch(self) -> None:
        assert not load_poses()[SILENCE].pose().any()
        shut = load_poses()["bmp"].values
        assert {name: shut[name] for name in SHUT} == pytest.approx(
            {name: value for name, (_, value) in SHUT.items()}
        )

    def test_open_vowels_open_and_rounded_ones_round(self) -> None:
        poses = load_poses()
        assert poses["aa"].values["jawOpen"] > poses["w"].values["jawOpen"] + 0.05
        assert poses["w"].values["mouthPucker"] > poses["ih"].values["mouthPucker"] + 0.1
        assert poses["d"].values["tongueRaise"] > 0.5
        assert poses["kg"].values["tongueBack"] > 0.9


class TestMotion:
    @pytest.mark.parametrize("symbol", PHONES)
    def test_the_middle_of_a_phone_is_its_pose(self, symbol: str) -> None:
        clip = animate(track(f"sil {symbol} AA sil", 0.2), 10.0)
        assert posed(clip)[3] == pytest.approx(load_poses()[class_of(symbol)].pose(), abs=1e-6)

    @quick
    @given(tracks())
    def test_it_is_numpys_interpolation_between_them(self, said: PhoneTrack) -> None:
        reached, classes = keys(said)
        poses = np.array([load_poses()[name].pose() for name in classes])
        clip = animate(said, 60.0)
        wanted = np.stack([np.interp(clip.times, reached, column) for column in poses.T], axis=1)
        assert posed(clip) == pytest.approx(wanted, abs=1e-6)

    def test_only_long_silences_are_held(self) -> None:
        reached, classes = keys(track("sil:1 AA:0.4 sil:0.1 P:0.6 sil:0.5"))
        assert classes == (SILENCE, SILENCE, "aa", SILENCE, "bmp", SILENCE, SILENCE)
        assert reached == pytest.approx(
            [REST, 1 - REST, 1.2, 1.45, 1.8, 2.1 + REST, 2.6 - REST]
        )  # fmt: skip

    def test_lips_shut_in_the_middle_of_p(self) -> None:
        clip = animate(track("sil:0.3 AA:0.2 P:0.1 AA:0.2 sil:0.3"), 100.0)
        aperture = np.maximum(gaps(clip), 0).mean(axis=1)
        assert aperture[55] < 0.1 * aperture.max()
        assert aperture[40] > 0.9 * aperture.max()


class TestComputing:
    @quick
    @given(tracks(), st.sampled_from([0.1, 24.0, 1000.0]))
    def test_any_track_gives_weights_from_0_to_its_end(self, said: PhoneTrack, fps: float) -> None:
        clip = animate(said, fps)
        assert clip.names == CANONICAL
        assert len(clip) == len(frame_times(said.end, fps))
        assert clip.values.min() >= 0
        assert clip.values.max() <= 1

    @pytest.mark.parametrize("said", ["sil:2", "AA:0.01", "P:0.01"])
    def test_one_phone_is_one_pose(self, said: str) -> None:
        clip = animate(track(said), 60.0)
        assert (clip.values == clip.values[0]).all()

    def test_a_track_that_starts_late_is_at_rest_before_it(self) -> None:
        clip = animate(track("AA:0.2").shifted(1.0), 60.0)
        assert clip.values[:50].max() == 0
        assert clip.values[-1].max() > 0.05

    def test_computing_in_chunks_changes_nothing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        said = track("sil HH AH L OW W ER L D sil " * 20)
        whole = animate(said, 60.0)
        monkeypatch.setattr(static, "CHUNK_FRAMES", 97)
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
