"""The speaker against himself, with takes whose answers are planted."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.evaluate.ceiling import Himself, Recorded, himself, of_mean, span_scores
from lipwright.evaluate.errors import Truth
from lipwright.evaluate.lips import Aperture
from lipwright.evaluate.shared_words import (
    Shared,
    first_words,
    partners,
    shared_span,
    times_in_other,
    warp,
)
from lipwright.face.appearance import Appearance
from lipwright.face.faceclip import control_names
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.shapes import load_reference_shape
from lipwright.face.vertices import LOWER_INNER, TRIANGLES, N
from lipwright.face.warp import Grid
from lipwright.track import PhoneTrack, Word

FPS, FRAMES = 50.0, 150
Floats = np.ndarray[Any, Any]

SAID = (("bin", ("B", "IH", "N")), ("blue", ("B", "L", "UW")), ("at", ("AE", "T")),
        ("m", ("EH", "M")), ("now", ("N", "AW")))  # fmt: skip


def spoken(
    durations: Floats | None = None, start: float = 0.4, words: Any = SAID, pause: int | None = None
) -> PhoneTrack:
    """A track of words with silence around; a pause of 0.2 s before the word `pause`."""
    phones, lengths, found = ["sil"], [start], []
    for number, (text, sounds) in enumerate(words):
        if number == pause:
            phones.append("sil")
            lengths.append(0.2)
        found.append(Word(text, len(phones), len(phones) + len(sounds)))
        for sound in sounds:
            index = sum(phone != "sil" for phone in phones)
            phones.append(sound)
            lengths.append(0.15 if durations is None else float(durations[index]))
    edges = np.concatenate([[0], np.cumsum(lengths), [FRAMES / FPS]])
    return PhoneTrack((*phones, "sil"), edges, tuple(found))


def story(phase: Floats) -> Floats:
    """(T, 3) shape parameters over the number of phones passed, piecewise linear."""
    knots = np.random.default_rng(2).uniform(-1, 1, (60, 3)) * [0.3, 0.1, 0.05]
    at = np.arange(len(knots)) / 2
    curves = np.stack([np.interp(phase, at, column) for column in knots.T], axis=1)
    curves[:, 0] = np.abs(curves[:, 0]) + 0.05  # the lips stay apart
    return np.asarray(curves)


def take(
    face: ReferenceFace, track: PhoneTrack, name: str, offset: float = 0.0,
    noise: Floats | None = None,
) -> Recorded:  # fmt: skip
    """A take that says the story by its own edges; its picture is late by `offset` s."""
    video = (np.arange(FRAMES) + 0.5) / FPS
    times = video - offset
    spoken_edges = [edge for phone, edge, _ in track if phone != "sil"]
    stop = max(end for phone, _, end in track if phone != "sil")
    edges = np.array([*spoken_edges, stop])
    shape = story(np.interp(times, edges, np.arange(len(edges))))
    if noise is not None:
        shape = shape + noise
    parameters = FaceParameters(shape, np.zeros((FRAMES, 2)), np.zeros((FRAMES, 2)))
    opened = Aperture(video, np.abs(shape[:, 0]))
    truth = Truth(
        name, times, np.ones(FRAMES, bool), parameters, face.points(parameters.shape),
        np.ones(FRAMES, bool), track,
    )  # fmt: skip
    return Recorded(truth, opened, offset)


@pytest.fixture(scope="module")
def face() -> ReferenceFace:
    """Three modes of shape and two of either region, of few pixels."""
    mean, modes = planted_shape()
    parts = {}
    for region, scale in (("inner", (10.0, 30.0)), ("outer", (8.0, 8.0))):
        grid = Grid(mean, TRIANGLES[region], scale)
        patterns = np.random.default_rng(6).normal(size=(2, grid.count * 3))
        flat = np.linalg.qr(patterns.T)[0].T.reshape(2, grid.count, 3)
        grey = np.full((grid.count, 3), 120.0)
        parts[region] = Appearance(grid, grey, flat, np.array([20.0, 10.0]))
    return ReferenceFace(
        mean_shape=mean, depth=np.zeros(N), shape_modes=modes, shape_sd=np.array([0.3, 0.1, 0.05]),
        **parts, weight=1.0, joint_mean=np.zeros(7), joint_modes=np.eye(7),
        joint_sd=np.arange(7.0, 0, -1),
    )  # fmt: skip


def planted_shape() -> tuple[Floats, Floats]:
    """Vertices (34, 2) of the shipped face; modes (3, 34, 2), the first opens the lips."""
    mean = load_reference_shape().mean.astype(np.float64)
    opening = np.zeros((N, 2))
    opening[LOWER_INNER, 1] = 1
    sides, all_down = mean * [1, 0], np.tile([0.0, 1.0], (N, 1))
    flat = np.stack([opening, sides, all_down]).reshape(3, -1)
    modes = np.linalg.qr(flat.T)[0].T
    modes[0] *= np.sign(modes[0] @ flat[0])
    return mean, modes.reshape(3, N, 2)


def hurried() -> Floats:
    return np.random.default_rng(4).uniform(0.08, 0.22, 12)


def against(face: ReferenceFace, *takes: Recorded, count: int = 4) -> Himself:
    """The first take against the others."""
    named = {one.truth.name: one for one in takes}
    first, *others = named
    found = himself(face, named, {first: others}, count)
    assert found is not None
    return found


def test_partners_of_a_toy_list_begin_with_the_same_words_in_any_split() -> None:
    words = {
        "one": ["bin", "blue", "at", "M", "now"], "two": ["bin", "blue", "at", "m", "please"],
        "three": ["bin", "blue", "at", "n", "now"], "four": ["Bin", "blue", "at", "m"],
        "five": ["bin", "blue", "at"], "six": ["set", "red", "by", "k"],
    }  # fmt: skip
    assert partners(words, ["two", "three", "five", "one"]) == {
        "two": ("one", "four"), "one": ("two", "four"),
    }  # fmt: skip
    assert partners(words, ["five"], count=3) == {"five": ("one", "two", "three", "four")}


def test_the_first_words_of_a_track_leave_silence_and_later_words_out() -> None:
    track = spoken(pause=2)
    span = first_words(track)
    assert span is not None
    assert span.phones == ("B", "IH", "N", "B", "L", "UW", "sil", "AE", "T", "EH", "M")
    assert [word.text for word in span.words] == ["bin", "blue", "at", "m"]
    assert (span.start, span.end) == pytest.approx((0.4, 0.4 + 10 * 0.15 + 0.2))
    assert first_words(track, 6) is None
    assert first_words(PhoneTrack(("sil",), np.array([0.0, 1.0]), (Word("hm", 0, 1),)), 1) is None


def test_the_same_phones_share_all_their_edges() -> None:
    own, other = spoken(), spoken(hurried(), start=0.6)
    shared = shared_span(own, other)
    assert shared is not None
    assert shared.is_same
    assert shared.own_edges == pytest.approx(own.edges[1:12])
    assert shared.other_edges == pytest.approx(other.edges[1:12])


def test_a_pause_of_one_take_is_skipped_or_stood_still_in() -> None:
    plain, pausing = spoken(), spoken(pause=2)
    skipped, held = shared_span(plain, pausing), shared_span(pausing, plain)
    assert skipped is not None
    assert held is not None
    assert not skipped.is_same
    meeting = 0.4 + 6 * 0.15  # where "blue" meets "at" in the plain one
    before, after = times_in_other(skipped, [meeting - 1e-6, meeting + 1e-6])
    assert (before, after) == pytest.approx((meeting, meeting + 0.2), abs=1e-5)
    inside = times_in_other(held, np.linspace(meeting, meeting + 0.2, 5))
    assert inside == pytest.approx(np.full(5, meeting), abs=1e-9)


def test_a_word_said_otherwise_is_matched_at_the_phones_that_are_the_same() -> None:
    words = (("white", ("W", "AY", "T")), ("at", ("AE", "T")))
    others = (("white", ("HH", "W", "AY", "T")), ("at", ("AH", "T")))
    shared = shared_span(spoken(words=words), spoken(words=others), 2)
    assert shared is not None
    assert not shared.is_same
    edges = dict(zip(shared.own_edges.round(3), shared.other_edges.round(3), strict=True))
    assert edges[0.55] == 0.7  # W meets AY
    assert edges[0.85] == 1.0  # the words meet; AE stretched over AH
    assert edges[1.0] == 1.15


def test_outside_the_words_time_runs_as_fast() -> None:
    shared = Shared(np.array([1.0, 2.0]), np.array([3.0, 3.5]), True)
    assert times_in_other(shared, [0.5, 1.0, 1.5, 2.0, 2.5]) == pytest.approx(
        [2.5, 3, 3.25, 3.5, 4]
    )


def test_warped_curves_pass_their_edges_at_the_other_takes_edges() -> None:
    shared = Shared(np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.5, 3.0]), True)
    times = np.linspace(0, 3, 61)
    found = warp(np.stack([times, 2 * times], axis=1), times, shared, np.array([0.5, 1.0, 1.5]))
    assert found == pytest.approx(np.array([[0.25, 0.5], [0.5, 1.0], [1.75, 3.5]]))


def test_takes_that_differ_in_speed_only_are_the_same_after_warping(face: ReferenceFace) -> None:
    one, two = take(face, spoken(), "one"), take(face, spoken(hurried(), 0.6), "two")
    found = against(face, one, two)
    assert found.recordings == ("one",)
    assert found.own["r"].value > 0.98
    assert found.own["face_r"].value > 0.98
    assert found.own["lag"].value == pytest.approx(0, abs=5)
    # Straight on, without the warp, they are not alike.
    plain = replace(two, truth=replace(two.truth, track=one.truth.track))
    assert against(face, one, plain).own["r"].value < 0.5


def test_the_same_take_is_without_error(face: ReferenceFace) -> None:
    one, two = (take(face, spoken(), name) for name in ("one", "two"))
    found = against(face, one, two)
    assert found.median_r == pytest.approx(1)
    for name in ("joint_sd", "joint", "shape", "vertices", "inner", "outer"):
        assert found.own[name].value == pytest.approx(0, abs=1e-8), name
    # The frames of four words of ten phones of 0.15 s.
    assert found.own["joint"].counts == pytest.approx([75], abs=1)


def test_pictures_that_are_late_are_told_from_takes_that_differ(face: ReferenceFace) -> None:
    one = take(face, spoken(), "one", offset=-0.06)
    two = take(face, spoken(), "two", offset=0.06)
    (pair,) = against(face, one, two).pairs
    assert pair.r_on_sound > 0.98  # both offsets taken off
    assert pair.r_of_videos < pair.r < pair.r_on_sound  # two, one and no offset
    late = take(face, spoken(), "late", offset=0.06)
    (pair,) = against(face, late, two).pairs
    assert pair.r_of_videos == pytest.approx(1)  # both are late alike


def test_an_engine_that_repeats_the_partner_scores_what_the_speaker_does(
    face: ReferenceFace,
) -> None:
    noise = 0.1 * np.random.default_rng(0).normal(size=(FRAMES, 3))
    one = take(face, spoken(), "one", offset=0.04)
    two = take(face, spoken(), "two", noise=np.abs(noise))
    found = against(face, one, two)
    values = face.join(two.truth.parameters) / face.sd("joint")
    own = Clip(control_names(face, "joint"), FPS, values)
    at_frames = own.with_values(own.at(one.truth.times - two.truth.times[0]))
    scores = span_scores(face, [one], [at_frames], {"head": [two.lips]})
    assert scores.keys() == found.own.keys()
    for name, rows in scores.items():
        assert rows.value == pytest.approx(
            found.own[name].value, rel=0.02, abs=1e-6, nan_ok=True
        ), name


def test_the_mean_of_many_takes_is_nearer_than_one_by_the_formula(face: ReferenceFace) -> None:
    """Takes of the same story, each with noise of its own; r as planted."""
    rng = np.random.default_rng(1)
    takes = [
        take(face, spoken(), f"take{number}", noise=rng.normal(size=(FRAMES, 3)) * [0.06, 0, 0])
        for number in range(13)
    ]
    named = {one.truth.name: one for one in takes}
    alike = {name: [other for other in named if other != name] for name in list(named)[:5]}
    found = himself(face, named, alike)
    assert found is not None
    assert len(found.pairs) == 5 * 12
    one, mean = found.own["r"].value, found.mean_of_takes["r"].value
    assert 0.4 < one < 0.9
    assert mean == pytest.approx(of_mean(one, 12), abs=0.02)
    assert found.mean_of_takes["joint"].value < found.own["joint"].value


def test_of_mean_is_the_formula_at_its_ends() -> None:
    assert of_mean(0.79, 1) == pytest.approx(0.79)
    assert of_mean(0.79, math.inf) == pytest.approx(math.sqrt(0.79))
    assert of_mean(1, 3) == pytest.approx(1)


def test_rows_stay_in_step_where_recordings_have_different_numbers_of_partners(
    face: ReferenceFace,
) -> None:
    named = {name: take(face, spoken(), name) for name in ("a", "b", "c")}
    found = himself(face, named, {"a": ("b",), "b": ("a", "c"), "c": ("gone",)})
    assert found is not None
    assert found.recordings == ("a", "b")
    assert [(pair.recording, pair.partner) for pair in found.pairs] == [
        ("a", "b"), ("b", "a"), ("b", "c"),
    ]  # fmt: skip
    for name, rows in found.own.items():
        assert rows.sums.shape == found.mean_of_takes[name].sums.shape == (2,), name
    assert list(found.mean_of_takes["r"].counts) == [0, 1]


def test_without_partners_there_is_no_ceiling(face: ReferenceFace) -> None:
    one = take(face, spoken(), "one")
    assert himself(face, {"one": one}, {}) is None
    assert himself(face, {"one": one}, {"one": ("gone",)}) is None


def test_an_engine_that_moves_no_head_has_errors_only(face: ReferenceFace) -> None:
    one = take(face, spoken(), "one")
    values = face.join(one.truth.parameters) / face.sd("joint")
    clip = Clip(control_names(face, "joint"), FPS, values)
    found = span_scores(face, [one], [clip], {})
    assert found["face_r"].value == pytest.approx(1)
    assert "r" not in found
    assert set(span_scores(face, [one], [], {"head": [one.lips]})) >= {"r", "closures"}
    with pytest.raises(ValueError, match="words"):
        span_scores(face, [one], [clip], {}, count=9)


def test_edges_that_fall_or_differ_in_number_are_refused() -> None:
    for own, other in (([0, 1, 0.5], [0, 1, 2]), ([0, 1], [0, 1, 2]), ([0], [0])):
        with pytest.raises(ValueError, match=r"edges|times"):
            Shared(np.array(own, float), np.array(other, float), True)
