"""Features of phone tracks: planted tracks by hand, second implementations, laws."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.features import KINDS, FeatureSet, known_track, seen_phones
from lipwright.features.known import LOOKS_LIKE, replacement
from lipwright.features.linguistic import (
    ATTRIBUTES,
    TRANSITIONS,
    attribute_table,
    attributes_of,
    transition_table,
    transitions_of,
)
from lipwright.features.spans import span_count, span_names
from lipwright.features.timeline import timeline
from lipwright.features.timing import SHORTEST, SIGHT, TIMING
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack, Word

DOCS = Path(__file__).resolve().parents[1] / "docs" / "features.md"
ALL = tuple(PHONES)
SILENT_KINDS = KINDS[:-1]
LAW = settings(max_examples=50, deadline=None)

# The phones of GRID's 51 words as the recordings of speaker 1 hold them, those of the throat out.
GRID = (
    "sil", "AA", "AE", "AH", "AO", "AW", "AY", "EH", "EY", "IH", "IY", "OW", "UW",
    "P", "B", "T", "D", "K", "G", "CH", "JH", "F", "V", "TH", "DH", "S", "Z", "M", "N",
    "L", "R", "Y", "W",
)  # fmt: skip


def track_of(text: str, start: float = 0.0, each: float = 0.1) -> PhoneTrack:
    phones = tuple(text.split())
    return PhoneTrack(phones, start + each * np.arange(len(phones) + 1))


def ones(features: FeatureSet, row: npt.NDArray[np.float32]) -> set[str]:
    return {features.names[column] for column in np.flatnonzero(row)}


@st.composite
def tracks(draw: st.DrawFn, phones: tuple[str, ...] = ALL) -> PhoneTrack:
    said = draw(st.lists(st.sampled_from(phones), min_size=1, max_size=10))
    lengths = draw(
        st.lists(st.integers(1, 25), min_size=len(said), max_size=len(said))
    )  # hundredths of a second, as aligners give them: edges lie on frames often
    start = draw(st.integers(0, 30))
    return PhoneTrack(tuple(said), np.cumsum([start, *lengths]) / 100)


@st.composite
def sets(draw: st.DrawFn, kinds: tuple[str, ...] = SILENT_KINDS) -> FeatureSet:
    chosen = draw(st.sets(st.sampled_from(kinds), min_size=1))
    known = draw(st.sets(st.sampled_from(ALL[1:]), min_size=1))
    return FeatureSet(
        tuple(kind for kind in KINDS if kind in chosen),
        draw(st.sampled_from((1, 3, 5, 11))),
        draw(st.sampled_from((10, 24, 25, 29.97, 60, 100))),
        (SILENCE, *sorted(known)),
    )


PLACES_OF_ROWS = st.none() | st.integers(-60, 60)


def clock(features: FeatureSet, track: PhoneTrack) -> npt.NDArray[np.float64]:
    return np.arange(int((track.end + 0.3) * features.fps) + 1) / features.fps


# --- each group, by hand ---


def test_raw_is_the_phone_of_each_frame() -> None:
    features = FeatureSet(("raw",), 3, 10, ("sil", "S", "IY"))
    track = track_of("sil S IY")
    values = features.frames(track, [0.05, 0.15, 0.25])
    assert values.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert values.dtype == np.float32
    middle = features.windows(track, [0.05, 0.15, 0.25])[1]
    assert ones(features, middle) == {"sil at frame 0", "S at frame 1", "IY at frame 2"}


def test_spans_are_the_frames_that_one_phone_lasts() -> None:
    features = FeatureSet(("spans",), 5, 25, ("sil", "S", "IY"))
    track = PhoneTrack(("sil", "S", "IY"), np.array([0, 0.04, 0.16, 0.4]))  # 1, 3 and 6 frames
    rows = features.windows(track, np.arange(10) / 25)
    assert ones(features, rows[2]) == {
        "sil spans frames 0 to 0", "S spans frames 1 to 3", "IY spans frames 4 to 4",
    }  # fmt: skip
    assert ones(features, rows[0]) == {"sil spans frames 0 to 2", "S spans frames 3 to 4"}
    assert ones(features, rows[6]) == {"IY spans frames 0 to 4"}


def test_the_same_phone_said_twice_is_two_spans_and_a_pause_in_two_parts_is_one() -> None:
    features = FeatureSet(("spans",), 3, 10, ("sil", "S"))
    twice = features.windows(track_of("S S S"), [0.05, 0.15, 0.25])[1]
    assert ones(features, twice) == {f"S spans frames {k} to {k}" for k in range(3)}
    pause = features.windows(track_of("sil sil sil"), [0.05, 0.15, 0.25])[1]
    assert ones(features, pause) == {"sil spans frames 0 to 2"}


def test_attributes_are_those_of_the_true_phone() -> None:
    features = FeatureSet(("attributes",), 1, 10, ("sil", "N"))
    rows = features.windows(track_of("sil NG OY"), [0.05, 0.15, 0.25])
    assert ones(features, rows[0]) == {"silence at frame 0"}
    assert ones(features, rows[1]) == {
        f"{name} at frame 0" for name in ("velar", "nasal", "consonant", "voiced", "class d")
    }
    assert ones(features, rows[2]) == {
        f"{name} at frame 0"
        for name in (
            "low-mid vowel", "back vowel", "vowel", "diphthong", "voiced", "rounded", "class oy",
        )
    }  # fmt: skip


def test_a_sound_of_the_throat_has_the_attributes_of_the_mouth_that_it_takes() -> None:
    kinds = ("attributes", "transitions")
    times = np.arange(0.05, 0.4, 0.1)
    hay, ay = track_of("sil HH OY sil"), track_of("sil OY OY sil")
    lent, own = (FeatureSet(kinds, 3, 10, phones) for phones in (("sil", "AO"), ("sil", "HH")))
    np.testing.assert_array_equal(lent.windows(hay, times), lent.windows(ay, times))
    assert "glottal at frame 1" in ones(own, own.windows(hay, times)[1])


def test_transitions_are_of_a_frame_and_the_next() -> None:
    features = FeatureSet(("transitions",), 3, 10, ("sil",))
    rows = features.windows(track_of("B IY N"), [0.05, 0.15, 0.25])
    assert ones(features, rows[1]) == {
        "bilabial to front vowel at frames 0 and 1",
        "stop to vowel at frames 0 and 1",
        "front vowel to dental or alveolar at frames 1 and 2",
        "vowel to nasal at frames 1 and 2",
        "tongue to silence at frames 2 and 3",
    }


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ("B", "B", {"same phone"}),
        ("sil", "sil", {"same phone"}),
        ("sil", "M", {"silence to lips"}),
        ("HH", "sil", {"throat to silence"}),
        ("sil", "AA", {"silence to vowel"}),
        ("S", "P", {"tongue to lips"}),
        ("K", "UW", {"palatal or velar to back vowel", "stop to vowel"}),
        ("AY", "F", {"front vowel to labiodental", "vowel to fricative"}),  # leaves from IH
        ("F", "AY", {"labiodental to central vowel", "fricative to vowel"}),
        ("AW", "IY", {"back vowel to front vowel"}),
        ("AH", "W", {"central vowel to labiovelar", "vowel to approximant"}),
    ],
)
def test_transitions_of_a_pair(one: str, other: str, expected: set[str]) -> None:
    assert set(transitions_of(PHONES[one], PHONES[other])) == expected


def test_timing_of_a_frame() -> None:
    track = PhoneTrack(("sil", "S", "IY", "sil"), np.array([0, 0.1, 0.3, 0.4, 0.6]))
    values = FeatureSet(("timing",), 1, 10, ("sil",)).frames(track, [0.15])[0]
    expected = {
        "position in the phone": 0.25,
        "log duration of the phone": np.log(0.2),
        # The silence goes on before the track; half a second is in sight.
        "log duration of the phone before": np.log(0.45),
        "log duration of the phone after": np.log(0.1),
        "seconds since the phone's start": 0.05,
        "seconds to the phone's end": 0.15,
        "log phones a second": np.log(3),
    }
    assert tuple(expected) == TIMING
    np.testing.assert_allclose(values, list(expected.values()), rtol=1e-6)


def test_timing_of_endless_silence_is_finite() -> None:
    values = FeatureSet(("timing",), 1, 10, ("sil",)).frames(track_of("sil"), np.arange(90) / 10)
    nothing = np.log(SHORTEST)
    expected = [0.5, np.log(2 * SIGHT), nothing, nothing, SIGHT, SIGHT, 0]
    np.testing.assert_allclose(values, np.tile(expected, (90, 1)), rtol=1e-6)


def test_sound_stands_beside_a_column_that_says_whether_it_is_heard() -> None:
    sound = pytest.importorskip("lipwright.features.sound", reason="no sound features here")
    features = FeatureSet(("raw", "sound"), 3, 10, ("sil", "S"))
    count = len(sound.SOUND_NAMES)
    assert features.frame_names == ("sil", "S", "sound", *sound.SOUND_NAMES)
    track, times = track_of("sil S"), [0.05, 0.15]
    heard = np.arange(2.0 * count).reshape(2, count)
    values = features.frames(track, times, heard)
    np.testing.assert_array_equal(values[:, 2], 1)
    np.testing.assert_array_equal(values[:, 3:], heard)
    assert not features.frames(track, times)[:, 2:].any()
    part = features.windows(track, times, heard, rows=slice(1, 2))
    np.testing.assert_array_equal(part, features.windows(track, times, heard)[1:])
    with pytest.raises(ValueError, match="sound has the shape"):
        features.frames(track, times, heard[:1])


# --- laws ---


@LAW
@given(tracks(), sets())
def test_windows_are_stacked_frames_with_the_end_frames_repeated(
    track: PhoneTrack, features: FeatureSet
) -> None:
    times = clock(features, track)
    frames, windows = features.frames(track, times), features.windows(track, times)
    assert frames.shape == (len(times), features.frame_size)
    assert windows.shape == (len(times), features.size)
    assert frames.dtype == windows.dtype == np.float32
    half = features.window // 2
    for row in range(len(times)):
        seen = [frames[min(max(row + k, 0), len(times) - 1)] for k in range(-half, half + 1)]
        np.testing.assert_array_equal(windows[row, : features.window * features.frame_size],
                                      np.concatenate(seen))  # fmt: skip


def slow_spans(features: FeatureSet, track: PhoneTrack, times: npt.ArrayLike) -> list[set[str]]:
    """Spans, frame by frame."""
    line = timeline(known_track(track, features.phones))
    run, half = line.at(times), features.window // 2
    found = []
    for row in range(len(run)):
        seen = [run[min(max(row + k, 0), len(run) - 1)] for k in range(-half, half + 1)]
        found.append({
            f"{ALL[line.codes[phone]]} spans frames {seen.index(phone)} to "
            f"{len(seen) - 1 - seen[::-1].index(phone)}"
            for phone in set(seen)
        })  # fmt: skip
    return found


@LAW
@given(tracks(), sets(("spans",)))
def test_spans_are_those_found_frame_by_frame_and_share_out_the_window(
    track: PhoneTrack, features: FeatureSet
) -> None:
    times = clock(features, track)
    windows = features.windows(track, times)
    for row, expected in zip(windows, slow_spans(features, track, times), strict=True):
        found = ones(features, row)
        assert found == expected
        frames: list[int] = []
        for name in found:
            j, k = (int(number) for number in re.findall(r"\d+", name))
            frames += range(j, k + 1)
        assert sorted(frames) == list(range(features.window))


@LAW
@given(tracks(), sets(("raw",)))
def test_each_frame_of_a_window_is_one_phone(track: PhoneTrack, features: FeatureSet) -> None:
    windows = features.windows(track, clock(features, track))
    each = windows.reshape(len(windows), features.window, -1).sum(axis=2)
    np.testing.assert_array_equal(each, 1)


@LAW
@given(tracks(), sets(), st.data())
def test_rows_of_windows_are_those_of_the_whole(
    track: PhoneTrack, features: FeatureSet, data: st.DataObject
) -> None:
    times = clock(features, track)
    rows = slice(*data.draw(st.tuples(PLACES_OF_ROWS, PLACES_OF_ROWS)))
    whole = features.windows(track, times)
    np.testing.assert_array_equal(features.windows(track, times, rows=rows), whole[rows])


@LAW
@given(tracks(), sets(("spans",)), st.data())
def test_indices_of_spans_are_where_the_ones_are(
    track: PhoneTrack, features: FeatureSet, data: st.DataObject
) -> None:
    times = clock(features, track)
    rows = slice(*data.draw(st.tuples(PLACES_OF_ROWS, PLACES_OF_ROWS)))
    row, column = features.span_indices(track, times, rows)
    expected = np.nonzero(features.windows(track, times, rows=rows))
    order = np.lexsort((column, row))
    np.testing.assert_array_equal(row[order], expected[0])
    np.testing.assert_array_equal(column[order], expected[1])


@LAW
@given(tracks(), sets(), st.integers(0, 50))
def test_a_frame_depends_on_its_time_alone(
    track: PhoneTrack, features: FeatureSet, first: int
) -> None:
    times = clock(features, track)
    later = times[first:]
    np.testing.assert_array_equal(
        features.frames(track, times)[first:], features.frames(track, later)
    )


@LAW
@given(tracks(), st.lists(st.sampled_from(ALL), min_size=1, max_size=4), sets())
def test_what_follows_a_track_changes_no_settled_frame(
    track: PhoneTrack, more: list[str], features: FeatureSet
) -> None:
    edges = np.append(track.edges, track.end + 0.1 * np.arange(1, len(more) + 1))
    longer = PhoneTrack((*track.phones, *more), edges)
    times = clock(features, track)
    times = times[times < features.settled(track)]
    np.testing.assert_array_equal(features.frames(track, times), features.frames(longer, times))


@LAW
@given(tracks(), sets(), st.integers(1, 200))
def test_a_later_track_has_the_same_frames_later(
    track: PhoneTrack, features: FeatureSet, frames: int
) -> None:
    times = clock(features, track)
    moved = track.shifted(frames / features.fps)
    np.testing.assert_allclose(
        features.frames(moved, times + frames / features.fps),
        features.frames(track, times),
        atol=1e-4,  # of the logarithm of a very short phone
    )


@LAW
@given(tracks(), sets())
def test_silence_around_a_track_changes_nothing(track: PhoneTrack, features: FeatureSet) -> None:
    times = clock(features, track)
    wider = track.padded(0, track.end + 1)
    np.testing.assert_array_equal(features.windows(wider, times), features.windows(track, times))


@LAW
@given(tracks(GRID), sets(("raw", "timing")))
def test_a_silence_parted_by_an_edge_is_one_silence(
    track: PhoneTrack, features: FeatureSet
) -> None:
    wider = track.padded(0, track.end + 1).padded(0, track.end + 2)
    times = clock(features, track)
    np.testing.assert_array_equal(features.windows(wider, times), features.windows(track, times))


def test_edges_on_frames_belong_to_the_later_phone_whatever_the_rounding() -> None:
    features = FeatureSet(("raw",), 1, 25, ("sil", "S", "T"))
    track = PhoneTrack(("S", "T") * 50, np.arange(101) * 0.12)
    for times in (np.arange(300) / 25, np.arange(300) * 0.04, np.cumsum(np.full(300, 0.04)) - 0.04):
        said = features.frames(track, times).argmax(axis=1)
        np.testing.assert_array_equal(said, 1 + np.arange(300) // 3 % 2)


def test_outside_of_the_track_is_silence() -> None:
    features = FeatureSet(("raw",), 1, 10, ("sil", "S"))
    said = features.frames(track_of("S", start=0.5, each=0.2), np.arange(12) / 10)[:, 1]
    np.testing.assert_array_equal(said, [0] * 5 + [1] * 2 + [0] * 5)


def test_no_frames_give_no_rows() -> None:
    features = FeatureSet(SILENT_KINDS, 11, 25, ("sil", "S"))
    assert features.frames(track_of("S"), []).shape == (0, features.frame_size)
    assert features.windows(track_of("S"), []).shape == (0, features.size)
    assert features.windows(track_of("S"), [0.0, 0.04], rows=slice(5, 9)).shape[0] == 0


# --- names and tables ---


@LAW
@given(sets())
def test_names_are_unique_and_as_many_as_columns(features: FeatureSet) -> None:
    assert len(set(features.frame_names)) == len(features.frame_names) == features.frame_size
    assert len(set(features.names)) == len(features.names) == features.size
    one = features.windows(track_of("S"), [0.0])
    assert one.shape == (1, features.size)


def test_every_attribute_is_of_some_phone_and_every_phone_has_only_known_ones() -> None:
    assert len(set(ATTRIBUTES)) == len(ATTRIBUTES)
    assert {name for phone in PHONES.values() for name in attributes_of(phone)} == set(ATTRIBUTES)
    assert attribute_table().any(axis=0).all()


def test_every_pair_of_phones_has_a_transition_and_every_transition_some_pair() -> None:
    assert len(set(TRANSITIONS)) == len(TRANSITIONS)
    rows = PHONES.values()
    pairs = [transitions_of(one, other) for one in rows for other in rows]
    assert all(pairs)
    assert {name for names in pairs for name in names} == set(TRANSITIONS)
    table = transition_table()
    assert table.any(axis=2).all()
    assert table.any(axis=(0, 1)).all()


def test_the_documented_counts_are_those_of_the_code() -> None:
    features = FeatureSet(SILENT_KINDS, 11, 25, GRID)
    counts = {
        "raw": len(GRID),
        "attributes": len(ATTRIBUTES),
        "transitions": len(TRANSITIONS),
        "timing": len(TIMING),
    }
    spans = len(GRID) * span_count(11)
    rows = dict(re.findall(r"^\| `(\w+)` \|.*\| ([\d,]+) \|$", DOCS.read_text("utf-8"), re.M))
    found = {kind: int(text.replace(",", "")) for kind, text in rows.items()}
    expected = {kind: 11 * count for kind, count in counts.items()} | {"spans": spans}
    assert {kind: found[kind] for kind in expected} == expected
    assert features.size == sum(expected.values())
    taylor = FeatureSet(KINDS[:4], 11, 25, GRID)
    assert f"**{taylor.size:,}**" in DOCS.read_text("utf-8")


def test_every_column_of_the_phones_is_documented() -> None:
    text = DOCS.read_text("utf-8")
    for name in (*ATTRIBUTES, *TRANSITIONS, *TIMING):
        assert f"`{name}`" in text, name


def test_spans_are_named_in_the_order_of_their_columns() -> None:
    assert span_names(("sil", "S"), 2) == (
        "sil spans frames 0 to 0", "sil spans frames 0 to 1", "sil spans frames 1 to 1",
        "S spans frames 0 to 0", "S spans frames 0 to 1", "S spans frames 1 to 1",
    )  # fmt: skip


# --- phones that were never learnt ---


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ("NG", "N"), ("SH", "CH"), ("ZH", "JH"), ("UH", "UW"), ("ER", "AH"), ("OY", "AO IH"),
        ("AX", "AH"), ("AXR", "AH"), ("IX", "IH"), ("UX", "UW"), ("EM", "M"), ("EN", "N"),
        ("ENG", "N"), ("DX", "D"), ("NX", "N"), ("EL", "L"), ("WH", "W"),
        ("HH AE T", "AE AE T"), ("HH AY", "AY AY"), ("HH OY", "AO AO IH"), ("HH W AY", "W W AY"),
        ("AH HH sil", "AH AH sil"), ("sil HH sil", "sil AH sil"), ("S HH T", "S T T"),
        ("AH Q AH", "AH AH AH"), ("sil HV", "sil AH"), ("HH HH IY", "AH IY IY"), ("HH ER", "AH AH"),
    ],
)  # fmt: skip
def test_a_network_that_learnt_grid_says_the_other_phones_so(said: str, expected: str) -> None:
    assert known_track(track_of(said), GRID).phones == tuple(expected.split())


def test_a_diphthong_is_split_in_the_middle_and_its_word_goes_with_it() -> None:
    track = PhoneTrack(
        ("sil", "T", "OY", "Z"), np.array([0, 0.2, 0.3, 0.5, 0.6]),
        (Word("toys", 1, 4),), (None, None, 1, None),
    )  # fmt: skip
    known = known_track(track, GRID)
    assert known.phones == ("sil", "T", "AO", "IH", "Z")
    np.testing.assert_allclose(known.edges, [0, 0.2, 0.3, 0.4, 0.5, 0.6])
    assert known.words == (Word("toys", 1, 5),)
    assert known.stress == (None, None, 1, 1, None)


@LAW
@given(tracks(), st.sets(st.sampled_from(ALL[1:]), min_size=1))
def test_known_tracks_hold_known_phones_keep_all_edges_and_never_fall_silent(
    track: PhoneTrack, spoken: set[str]
) -> None:
    known = known_track(track, {SILENCE, *spoken})
    assert set(known.phones) <= spoken | {SILENCE}
    assert set(track.edges) <= set(known.edges)
    middles = (track.edges[1:] + track.edges[:-1]) / 2
    said = [known.phones[i] for i in np.searchsorted(known.edges, middles, "right") - 1]
    for phone, other in zip(track.phones, said, strict=True):
        assert (phone == SILENCE) == (other == SILENCE)
        assert phone == other or phone not in spoken


def test_a_track_of_known_phones_stays_as_it_is() -> None:
    track = track_of("sil B IH N sil")
    assert known_track(track, GRID) is track


def test_the_looks_are_of_phones_of_the_table_and_sorts_that_fit() -> None:
    for phone, others in LOOKS_LIKE.items():
        for other in others:
            assert PHONES[other].is_vowel == PHONES[phone].is_vowel
            assert replacement(phone, frozenset((SILENCE, other, "W"))) == (other,)


def test_no_consonant_but_those_of_the_lips_becomes_one_that_shuts_them() -> None:
    shut = {phone for phone in ALL if PHONES[phone].place == "bilabial"}
    for phone in set(ALL) - shut:
        for around in ("AH {} AH", "sil {} sil", "S {} T"):
            said = known_track(track_of(around.format(phone)), GRID).phones
            assert not shut & set(said), (phone, said)


def test_seen_phones_are_in_the_order_of_the_table_without_those_of_the_throat() -> None:
    assert seen_phones([track_of("W HH IY"), track_of("S IY")]) == ("sil", "IY", "S", "W")
    assert seen_phones([]) == ("sil",)


# --- what is refused ---


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kinds": ("raw", "smell")}, "'smell'"),
        ({"kinds": ("spans", "raw")}, "in order"),
        ({"kinds": ("raw", "raw")}, "each once"),
        ({"kinds": ()}, "raw, spans"),
        ({"window": 4}, "4 frames"),
        ({"window": -1}, "-1 frames"),
        ({"window": 3.0}, "3.0 frames"),
        ({"window": True}, "True frames"),
        ({"fps": 0}, "fps is 0"),
        ({"fps": float("nan")}, "fps is nan"),
        ({"phones": ("sil", "QQ")}, "'QQ'"),
        ({"phones": ("S", "sil")}, "the first is not 'sil'"),
        ({"phones": ("sil", "S", "S")}, "repeat"),
        ({"phones": ()}, "no phones"),
    ],
)
def test_a_set_that_makes_no_sense_is_refused(change: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"kinds": ("raw",), "window": 3, "fps": 25, "phones": ("sil", "S")}
    FeatureSet(**good)
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        FeatureSet(**good | change)
    assert "\n" not in str(caught.value)


@LAW
@given(sets())
def test_a_set_comes_back_from_json(features: FeatureSet) -> None:
    assert FeatureSet.from_json(json.loads(json.dumps(features.to_json()))) == features


GOOD = FeatureSet(("raw", "timing"), 3, 25, ("sil", "S")).to_json()


@pytest.mark.parametrize(
    "bad",
    [
        None, [], "raw", {}, {**GOOD, "kinds": "raw"}, {**GOOD, "kinds": [1]},
        {**GOOD, "phones": ["sil", "QQ"]}, {**GOOD, "phones": None}, {**GOOD, "fps": "25"},
        {**GOOD, "fps": True}, {**GOOD, "fps": None}, {**GOOD, "window": 2},
        {**GOOD, "window": "3"}, {**GOOD, "frame": ["sil", "S"]}, {**GOOD, "frame": None},
        {key: GOOD[key] for key in GOOD if key != "frame"},
    ],
)  # fmt: skip
def test_json_that_is_no_set_is_refused_with_one_line(bad: Any) -> None:
    with pytest.raises(ValueError, match=r"\w") as caught:
        FeatureSet.from_json(bad)
    assert "\n" not in str(caught.value)


def test_columns_of_another_version_are_noticed() -> None:
    changed = {**GOOD, "frame": [*GOOD["frame"][:-1], "log words a second"]}
    with pytest.raises(ValueError, match="version"):
        FeatureSet.from_json(changed)


def test_unknown_phones_are_named() -> None:
    with pytest.raises(ValueError, match="'QQ'"):
        known_track(track_of("sil"), ("sil", "QQ"))
    with pytest.raises(ValueError, match="no phones"):
        known_track(track_of("sil"), ())


@pytest.mark.parametrize("times", [[0.0, 0.1, 0.3], [0.1, 0.0], [0.0, np.nan], [[0.0]]])
def test_times_off_the_clock_are_refused(times: Any) -> None:
    features = FeatureSet(("raw",), 3, 10, ("sil",))
    with pytest.raises(ValueError, match="times"):
        features.windows(track_of("sil"), times)


def test_rows_with_a_step_are_refused() -> None:
    features = FeatureSet(("raw",), 3, 10, ("sil",))
    with pytest.raises(ValueError, match="step"):
        features.windows(track_of("sil"), [0.0], rows=slice(None, None, 2))
