"""`PhoneTrack` cannot be wrong, and its operations keep phones, words and times together."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack, Word, join_tracks

HELLO = PhoneTrack(
    ("sil", "HH", "AH", "L", "OW", "sil", "Y", "UW"),
    np.array([0.0, 0.1, 0.2, 0.28, 0.35, 0.42, 0.6, 0.65, 0.8]),
    (Word("hello", 1, 5, 0.9), Word("you", 6, 8)),
    (None, None, 0, None, 1, None, None, 1),
)


@st.composite
def tracks(draw: st.DrawFn, start: float | None = None) -> PhoneTrack:
    phones = draw(st.lists(st.sampled_from(tuple(PHONES)), min_size=1, max_size=10))
    lengths = st.floats(0.001, 10, allow_nan=False)
    durations = draw(st.lists(lengths, min_size=len(phones), max_size=len(phones)))
    first = draw(st.floats(0, 100)) if start is None else start
    cuts = sorted(draw(st.sets(st.integers(0, len(phones)), max_size=6)))
    words = tuple(Word(f"w{a}", a, b) for a, b in pairwise(cuts))
    stress = tuple(draw(st.sampled_from([None, 0, 1, 2])) for _ in phones)
    edges = first + np.concatenate([[0.0], np.cumsum(durations)])
    return PhoneTrack(tuple(phones), edges, words, stress)


class TestConstruction:
    def test_a_track_tells_what_it_was_given(self) -> None:
        assert len(HELLO) == 8
        assert (HELLO.start, HELLO.end) == (0.0, 0.8)
        assert list(HELLO)[1] == ("HH", 0.1, 0.2)
        assert [start for _, start, _ in HELLO][1:] == [end for _, _, end in HELLO][:-1]
        assert HELLO.durations == pytest.approx(np.diff(HELLO.edges))
        assert HELLO.durations.sum() == pytest.approx(0.8)

    def test_lists_are_frozen_to_tuples_and_no_stress_is_none_for_each(self) -> None:
        words = [Word("a", 0, 1)]
        track = PhoneTrack(["AA", "B"], [0, 1, 2], words)  # type: ignore[arg-type]  # lists
        assert track.phones == ("AA", "B")
        assert track.words == tuple(words)
        assert track.stress == (None, None)
        assert track.edges.dtype == np.float64

    def test_edges_are_a_copy_that_cannot_be_written(self) -> None:
        edges = np.array([0.0, 1.0])
        track = PhoneTrack(("AA",), edges)
        edges[1] = 9.0
        assert track.end == 1.0
        with pytest.raises(ValueError, match="read-only"):
            track.edges[0] = 0.5

    def test_fields_cannot_be_replaced_in_place(self) -> None:
        with pytest.raises(FrozenInstanceError):
            HELLO.phones = ("AA",)  # type: ignore[misc]  # frozen

    def test_no_phones_are_refused(self) -> None:
        with pytest.raises(ValueError, match="at least one phone"):
            PhoneTrack((), np.array([0.0]))

    @pytest.mark.parametrize("phone", ["XX", "aa", "AA1", ""])
    def test_an_unknown_phone_is_refused_and_named(self, phone: str) -> None:
        with pytest.raises(ValueError, match="phone 1 is") as caught:
            PhoneTrack(("AA", phone), np.arange(3.0))
        assert repr(phone) in str(caught.value)

    @pytest.mark.parametrize("count", [0, 1, 2, 4])
    def test_another_number_of_edges_than_phones_and_one_is_refused(self, count: int) -> None:
        with pytest.raises(ValueError, match="2 phones"):
            PhoneTrack(("AA", "B"), np.arange(float(count)))

    def test_edges_of_two_axes_are_refused(self) -> None:
        with pytest.raises(ValueError, match="2 phones"):
            PhoneTrack(("AA", "B"), np.arange(3.0)[None])

    @given(st.lists(st.floats(), min_size=2, max_size=6))
    def test_any_edges_make_a_track_of_rising_times_or_are_refused(
        self, edges: list[float]
    ) -> None:
        phones = ("AA",) * (len(edges) - 1)
        good = all(np.isfinite(edges)) and edges[0] >= 0 and all(a < b for a, b in pairwise(edges))
        if good:
            assert PhoneTrack(phones, np.array(edges)).edges.tolist() == edges
        else:
            with pytest.raises(ValueError, match="rising times from 0 s on"):
                PhoneTrack(phones, np.array(edges))

    @pytest.mark.parametrize("stress", [(1,), (1, None, 0), (3, None), ("1", None), (-1, 0)])
    def test_stress_that_does_not_fit_is_refused(self, stress: tuple[int, ...]) -> None:
        with pytest.raises(ValueError, match="stress"):
            PhoneTrack(("AA", "B"), np.arange(3.0), (), stress)

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ([Word("a", -1, 1)], "out of order or out of the track"),
            ([Word("a", 0, 3)], "out of order or out of the track"),
            ([Word("a", 1, 1)], "out of order or out of the track"),
            ([Word("a", 0, 2), Word("b", 1, 2)], "'b' is out of order"),
            ([Word("b", 1, 2), Word("a", 0, 1)], "'a' is out of order"),
            ([Word("", 0, 1)], "empty or has white space"),
            ([Word("a b", 0, 1)], "empty or has white space"),
            ([Word("a\n", 0, 1)], "empty or has white space"),
            ([Word("a", 0, 1, 1.5)], "confidence"),
            ([Word("a", 0, 1, -0.1)], "confidence"),
            ([Word("a", 0, 1, float("nan"))], "confidence"),
        ],
    )
    def test_words_that_do_not_fit_are_refused(self, words: list[Word], message: str) -> None:
        with pytest.raises(ValueError, match=message):
            PhoneTrack(("AA", "B"), np.arange(3.0), tuple(words))


class TestWords:
    def test_the_span_of_a_word_is_from_its_first_to_its_last_edge(self) -> None:
        assert HELLO.word_span(HELLO.words[0]) == (0.1, 0.42)
        assert HELLO.word_span(HELLO.words[1]) == (0.6, 0.8)

    def test_a_phone_knows_its_word(self) -> None:
        hello, you = HELLO.words
        wanted = [None, hello, hello, hello, hello, None, you, you]
        assert [HELLO.word_at(index) for index in range(len(HELLO))] == wanted

    @given(tracks())
    def test_every_phone_of_a_word_is_in_its_span(self, track: PhoneTrack) -> None:
        for index, (_, start, end) in enumerate(track):
            word = track.word_at(index)
            if word is not None:
                first, last = track.word_span(word)
                assert first <= start < end <= last


class TestTimes:
    @given(tracks(), st.floats(0, 1000))
    def test_shifting_moves_every_edge_and_nothing_else(
        self, track: PhoneTrack, seconds: float
    ) -> None:
        moved = track.shifted(seconds)
        assert moved.edges == pytest.approx(track.edges + seconds)
        assert (moved.phones, moved.words, moved.stress) == (
            track.phones, track.words, track.stress,
        )  # fmt: skip

    def test_shifting_before_zero_is_refused(self) -> None:
        with pytest.raises(ValueError, match="from 0 s on"):
            HELLO.shifted(-0.01)

    def test_other_edges_keep_the_rest(self) -> None:
        moved = HELLO.with_edges(HELLO.edges * 2)
        assert moved.end == 1.6
        assert moved.words == HELLO.words
        with pytest.raises(ValueError, match="8 phones"):
            HELLO.with_edges([0.0, 1.0])

    @given(tracks(), st.floats(0, 200), st.floats(0, 200))
    def test_padding_adds_silence_around_and_never_takes_anything(
        self, track: PhoneTrack, start: float, end: float
    ) -> None:
        padded = track.padded(start, end)
        before = int(start < track.start)
        after = int(end > track.end)
        stop = len(padded) - after
        assert padded.phones[before:stop] == track.phones
        assert padded.stress[before:stop] == track.stress
        assert padded.edges[before : stop + 1].tolist() == track.edges.tolist()
        assert padded.phones == (SILENCE,) * before + track.phones + (SILENCE,) * after
        assert (padded.start, padded.end) == (min(start, track.start), max(end, track.end))
        spans = [padded.word_span(word) for word in padded.words]
        assert spans == [track.word_span(word) for word in track.words]

    def test_padding_inside_the_track_changes_nothing(self) -> None:
        assert HELLO.padded(0.3, 0.5).phones == HELLO.phones


class TestJoin:
    def test_tracks_that_meet_are_joined_without_silence(self) -> None:
        joined = join_tracks([HELLO, HELLO.shifted(0.8)])
        assert joined.phones == HELLO.phones * 2
        assert joined.end == pytest.approx(1.6)
        assert joined.words[2] == replace(HELLO.words[0], first=9, stop=13)

    def test_a_gap_becomes_silence(self) -> None:
        joined = join_tracks([HELLO, HELLO.shifted(1.0)])
        assert joined.phones == (*HELLO.phones, SILENCE, *HELLO.phones)
        assert joined.edges[8:10].tolist() == [0.8, 1.0]

    @given(st.lists(tracks(start=0.0), min_size=1, max_size=4), st.floats(0, 5))
    def test_words_and_times_survive_joining(self, parts: list[PhoneTrack], gap: float) -> None:
        placed: list[PhoneTrack] = []
        for part in parts:
            placed.append(part.shifted(placed[-1].end + gap if placed else gap))
        joined = join_tracks(placed)
        assert joined.start == placed[0].start
        assert joined.end == placed[-1].end
        spoken = [phone for phone in joined.phones if phone != SILENCE]
        assert spoken == [p for part in placed for p in part.phones if p != SILENCE]
        spans = [joined.word_span(word) for word in joined.words]
        wanted = [part.word_span(word) for part in placed for word in part.words]
        assert np.array(spans) == pytest.approx(np.array(wanted), abs=1e-8)
        stresses = [s for part in placed for s in part.stress if s is not None]
        assert [s for s in joined.stress if s is not None] == stresses

    def test_one_track_joins_to_itself(self) -> None:
        joined = join_tracks([HELLO])
        assert joined.phones == HELLO.phones
        assert joined.edges.tolist() == HELLO.edges.tolist()
        assert (joined.words, joined.stress) == (HELLO.words, HELLO.stress)

    def test_tracks_that_overlap_are_refused(self) -> None:
        with pytest.raises(ValueError, match=r"starts at 0\.7 s"):
            join_tracks([HELLO, HELLO.shifted(0.7)])

    def test_nothing_is_refused(self) -> None:
        with pytest.raises(ValueError, match="no tracks"):
            join_tracks([])
