"""The hmm engine: planted models are found again, recordings learnt, damaged files refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.clip import frame_times
from lipwright.controls import CANONICAL
from lipwright.engines.hmm import (
    STATES,
    animate,
    contexts_of,
    open_network,
    predict_at,
    read_phones,
    state_edges,
    voice_of,
)
from lipwright.errors import LipwrightError
from lipwright.features import FeatureSet
from lipwright.network.arrays import ArrayModel
from lipwright.network.meta import ModelMeta
from lipwright.phones import PHONES
from lipwright.track import PhoneTrack
from lipwright.train.config import MisfitError
from lipwright.train.config_file import load_config
from lipwright.train.hmm import CONFIG, HmmConfig, fit
from lipwright.train.hmm_questions import all_questions, questions_of
from lipwright.train.hmm_states import align, evenly
from lipwright.train.hmm_trees import Grown, Statistics, Stopping, grow, log_likelihood, variances
from lipwright.train.takes import Corpus, Take

Floats = npt.NDArray[np.float64]

KNOWN = ("sil", "AA", "IY", "P", "S")
CONTROLS = ("jawOpen", "mouthPucker")
TARGETS = {"sil": (0.1, 0.3), "AA": (0.9, 0.2), "IY": (0.3, 0.0), "P": (0.0, 0.4), "S": (0.2, 0.1)}
AFTER_P = 0.3  # of the pucker, more where the phone before is a P


def said(seed: int, count: int = 10) -> PhoneTrack:
    rng = np.random.default_rng(seed)
    phones = ["sil"]
    while len(phones) < count:
        phones.append(str(rng.choice([p for p in KNOWN[1:] if p != phones[-1]])))
    lengths = rng.uniform(0.08, 0.25, count + 1)
    return PhoneTrack((*phones, "sil"), np.concatenate([[0], np.cumsum(lengths)]))


def planted_take(seed: int, noise: float = 0.02) -> Take:
    """Each phone has its own pose, with more pucker after P; a little smoothed."""
    track, rng = said(seed), np.random.default_rng(seed)
    times = frame_times(track.end, 100)
    number = np.clip(np.searchsorted(track.edges, times, "right") - 1, 0, len(track) - 1)
    values = np.array([TARGETS[track.phones[i]] for i in number])
    values[:, 1] += AFTER_P * np.array([i > 0 and track.phones[i - 1] == "P" for i in number])
    kernel = np.hanning(7)[1:-1] / np.hanning(7).sum()
    padded = np.pad(values, ((2, 2), (0, 0)), "edge")
    smooth = np.stack([np.convolve(c, kernel, "valid") for c in padded.T], 1)
    smooth += rng.normal(scale=noise, size=smooth.shape)
    rows = slice(None, None, 4)  # 25 frames a second
    valid = np.ones(len(times[rows]), bool)
    return Take(f"take{seed}", times[rows], smooth[rows].astype(np.float32), valid, track)


def corpus_of(takes: Sequence[Take]) -> Corpus:
    splits = {"train": tuple(takes), "validation": tuple(takes[:1]), "test": ()}
    return Corpus(splits, CONTROLS, 25.0, "planted", "", Path("planted"))


def config(**changes: Any) -> HmmConfig:
    return HmmConfig(**{"engine": "hmm", "name": "planted", "rate": 100.0, **changes})


def model_of(arrays: dict[str, Any], phones: tuple[str, ...] = KNOWN) -> ArrayModel:
    meta = ModelMeta(
        name="planted", kind="hmm", features=FeatureSet(("raw",), 1, 25, phones), output_window=1,
        controls=CONTROLS, target="arkit", licence="", data="", metrics={}, date="2026-01-01",
        files={"model.npz": "0" * 64, "golden.npz": "0" * 64},
    )  # fmt: skip
    return ArrayModel(Path("planted"), meta, MappingProxyType(arrays))


def silent(step: str, done: float) -> None:
    del step, done


def learnt(takes: Sequence[Take], **changes: Any) -> ArrayModel:
    fitted = fit(corpus_of(takes), config(**changes), silent)
    return model_of(dict(fitted.arrays), fitted.features.phones)


@pytest.fixture(scope="module")
def model() -> ArrayModel:
    """Of 40 planted recordings."""
    return learnt([planted_take(seed) for seed in range(40)])


class TestLearning:
    def test_few_recordings_are_given_back(self) -> None:
        takes = [planted_take(seed, noise=0) for seed in range(4)]
        model = learnt(takes, least=2, price=0.0)
        for take in takes:
            guess = predict_at(model, take.track, take.times)
            for real, found in zip(take.targets.T, guess.T, strict=True):
                assert np.corrcoef(real, found)[0, 1] > 0.97

    def test_planted_poses_are_found_again(self, model: ArrayModel) -> None:
        voice = voice_of(model)
        for phone in KNOWN:
            for before in ("P", "S"):
                if phone in (before, "sil"):
                    continue
                context = np.array([[KNOWN.index(p) for p in ("AA", before, phone, "AA", "IY")]])
                leaf = voice.states.find(voice.roots[2, context[:, 2]], context)[0]
                jaw, pucker = TARGETS[phone]
                want = (jaw, pucker + AFTER_P * (before == "P"))
                np.testing.assert_allclose(voice.means[leaf, 0], want, atol=0.04)

    def test_unheard_sentences_are_predicted(self, model: ArrayModel) -> None:
        for seed in range(100, 105):
            take = planted_take(seed, noise=0)
            guess = predict_at(model, take.track, take.times)
            for real, found in zip(take.targets.T, guess.T, strict=True):
                assert np.corrcoef(real, found)[0, 1] > 0.93

    def test_the_same_recordings_give_the_same_model(self) -> None:
        one, other = (learnt([planted_take(seed) for seed in range(6)]) for _ in range(2))
        assert all(other.arrays[k].tobytes() == a.tobytes() for k, a in one.arrays.items())

    @pytest.mark.parametrize("changes", [
        {"trees": "phone"}, {"rounds": 0}, {"observation": "video", "least": 12},
        {"observation": "visits", "least": 5}, {"phones": ("sil", "AA", "IY", "P", "S", "M")},
        {"phones": ("sil", "AA", "IY", "P", "S", "M"), "trees": "phone"},
    ])  # fmt: skip
    def test_every_choice_learns(self, changes: dict[str, Any]) -> None:
        takes = [planted_take(seed) for seed in range(12)]
        model = learnt(takes, **changes)
        guess = np.concatenate([predict_at(model, take.track, take.times) for take in takes])
        real = np.concatenate([take.targets for take in takes])
        assert np.corrcoef(real[:, 0], guess[:, 0])[0, 1] > 0.8

    def test_gaps_in_the_video_are_left_out(self) -> None:
        takes = [planted_take(seed) for seed in range(12)]
        for take in takes:
            take.valid[8:14] = False
            take.targets[8:14] = 99
        model = learnt(takes)
        assert np.abs(voice_of(model).means[:, 0]).max() < 2

    def test_recordings_without_a_face_are_one_clear_line(self) -> None:
        take = planted_take(0)
        take.valid[:] = np.arange(len(take.valid)) % 3 > 0
        with pytest.raises(LipwrightError, match=r"planted: no recording .* 4 frames in a row"):
            fit(corpus_of([take]), config(), silent)

    def test_the_shipped_configuration_is_whole(self) -> None:
        assert isinstance(load_config("hmm"), CONFIG)

    @pytest.mark.parametrize(
        "changes", [{"rate": 1.0}, {"least": 0}, {"price": -1.0}, {"rounds": -1}, {"floor": 0.0}]
    )
    def test_what_cannot_be_is_refused(self, changes: dict[str, Any]) -> None:
        with pytest.raises(MisfitError):
            config(**changes)


class TestTrees:
    def planted(self, rng: np.random.Generator) -> Statistics:
        """Data that hangs on whether the next phone is voiceless, and on nothing else."""
        contexts = np.array([rng.integers(0, len(KNOWN), 5) for _ in range(300)])
        hit = np.isin(contexts[:, 3], [KNOWN.index("P"), KNOWN.index("S")])
        values = rng.normal(size=(300, 20, 2)) + 3.0 * hit[:, None, None]
        table = np.concatenate(
            [np.full((300, 1), 20.0), values.sum(1), (values**2).sum(1)], axis=1
        )  # fmt: skip
        return Statistics(contexts, table)

    def test_the_planted_question_is_asked_and_no_other(self) -> None:
        data = self.planted(np.random.default_rng(1))
        grown = Grown(questions_of(KNOWN))
        grow(grown, data, np.full(2, 1e-3), Stopping(50, 1.0))
        assert len(grown.leaves) == 2
        assert grown.place[0] == 3
        asked = grown.questions.members[grown.asked[0]]
        assert {p for p, yes in zip(KNOWN, asked, strict=True) if yes} in (
            {"P", "S"}, {"sil", "AA", "IY"},
        )  # fmt: skip
        means = sorted(variances(np.array(grown.leaves), np.full(2, 1e-3))[0][:, 0])
        np.testing.assert_allclose(means, [0, 3], atol=0.1)

    def test_the_first_split_is_the_best_of_all_that_can_be_asked(self) -> None:
        rng = np.random.default_rng(2)
        contexts = rng.integers(0, len(KNOWN), (80, 5))
        values = rng.normal(size=(80, 3)) + 0.5 * contexts[:, 1:4]
        table = np.concatenate([np.ones((80, 1)), values, values**2], axis=1)
        floor, questions = np.full(3, 1e-3), questions_of(KNOWN)
        grown = Grown(questions)
        grow(grown, Statistics(contexts, table), floor, Stopping(10, 1.0, 0.0))

        def gain(place: int, asked: int) -> float:
            yes = questions.members[asked, contexts[:, place]]
            if min(yes.sum(), (~yes).sum()) < 10:
                return -np.inf
            return float(sum(
                -0.5 * len(v) * (np.log(v.var(0)) + 1).sum() for v in (values[yes], values[~yes])
            ))  # fmt: skip

        gains = {(p, q): gain(p, q) for p in range(5) for q in range(len(questions.names))}
        assert gains[grown.place[0], grown.asked[0]] == pytest.approx(max(gains.values()))

    def test_no_leaf_has_fewer_observations_than_asked(self) -> None:
        data = self.planted(np.random.default_rng(3))
        grown = Grown(questions_of(KNOWN))
        grow(grown, data, np.full(2, 1e-3), Stopping(200, 1.0, 0.0))
        assert min(leaf[0] for leaf in grown.leaves) >= 200
        assert len(grown.leaves) > 5

    def test_noise_is_not_split_by_the_criterion_and_is_without_it(self) -> None:
        rng = np.random.default_rng(4)
        contexts, values = rng.integers(0, len(KNOWN), (400, 5)), rng.normal(size=(400, 4))
        data = Statistics(contexts, np.concatenate([np.ones((400, 1)), values, values**2], 1))
        sizes = []
        for price in (1.0, 0.0):
            grown = Grown(questions_of(KNOWN))
            grow(grown, data, np.full(4, 1e-3), Stopping(20, 1.0, price))
            sizes.append(len(grown.leaves))
        assert sizes[0] == 1 < sizes[1]

    def test_the_likelihood_is_that_of_the_gaussian(self) -> None:
        values = np.random.default_rng(5).normal(size=(50, 3)) * [1, 2, 0.001]
        floor = np.full(3, 0.01)
        table = np.concatenate([[50], values.sum(0), (values**2).sum(0)])
        held = np.maximum(values.var(0), floor)
        each = -0.5 * (np.log(held) + (values - values.mean(0)) ** 2 / held)
        assert float(log_likelihood(table, floor)) == pytest.approx(each.sum())


class TestQuestions:
    def test_each_has_an_answer_and_some_phone_for_each(self) -> None:
        every = all_questions()
        assert len(set(every.names)) == len(every.names)
        assert every.members.shape == (len(every.names), len(PHONES))
        assert every.members.any(axis=1).all()
        assert not every.members.all(axis=1).any()
        assert len(every) == 5 * len(every.names)

    def test_those_of_a_corpus_are_different_sets(self) -> None:
        some = questions_of(KNOWN)
        assert len(np.unique(some.members, axis=0)) == len(some.names) <= 2 ** len(KNOWN) - 2
        lips = dict(zip(some.names, some.members, strict=True))["P"]
        assert lips.tolist() == [phone == "P" for phone in KNOWN]


class TestStates:
    @given(st.integers(0, 2**31), st.integers(STATES, 11))
    @settings(max_examples=40)
    def test_the_way_through_the_states_is_the_best_of_all(self, seed: int, count: int) -> None:
        scores = np.random.default_rng(seed).normal(size=(count, STATES))
        ways = [np.searchsorted(cut, np.arange(count), "right")
                for cut in combinations(range(1, count), STATES - 1)]  # fmt: skip
        best = max(ways, key=lambda way: scores[np.arange(count), way].sum())
        assert align(scores).tolist() == best.tolist()

    @pytest.mark.parametrize("count", range(1, 12))
    def test_even_states_rise_and_last_alike(self, count: int) -> None:
        states = evenly(count)
        assert (np.diff(states) >= 0).all()
        lasted = np.bincount(states, minlength=STATES)
        assert lasted.max() - lasted.min() <= 1
        if count < STATES:
            assert align(np.zeros((count, STATES))).tolist() == states.tolist()

    def test_states_share_the_length_of_their_phone(self) -> None:
        durations = np.array([[1, 1, 2, 1, 1], [1, 2, 3, 2, 2.0]]) / 10
        starts = state_edges(durations, np.array([0, 1.2, 1.7]), np.array([False, False]))
        np.testing.assert_allclose(starts[0], [0, 0.2, 0.4, 0.8, 1.0])
        np.testing.assert_allclose(starts[1], [1.2, 1.25, 1.35, 1.5, 1.6])

    def test_a_long_silence_stays_in_its_middle(self) -> None:
        durations = np.full((1, 5), 0.1)
        starts = state_edges(durations, np.array([0, 60.0]), np.array([True]))
        np.testing.assert_allclose(starts, [[0, 0.1, 0.2, 59.8, 59.9]])

    def test_a_quinphone_has_silence_beyond_the_ends(self) -> None:
        columns, edges = read_phones(PhoneTrack(("AA", "P"), np.array([0, 0.1, 0.3])), KNOWN)
        assert columns.tolist() == [0, 1, 3, 0]
        assert edges.tolist() == [0, 0, 0.1, 0.3, 0.3]
        assert contexts_of(columns)[1].tolist() == [0, 0, 1, 3, 0]


class TestAnimating:
    def test_parts_of_a_long_track_are_as_the_whole(self, model: ArrayModel) -> None:
        parts = [said(seed) for seed in range(40)]
        ends = np.cumsum([0, *(part.end for part in parts)])
        phones = tuple(p for part in parts for p in part.phones)
        edges = np.concatenate(
            [part.edges[:-1] + at for part, at in zip(parts, ends, strict=False)]
        )
        track = PhoneTrack(phones, np.append(edges, ends[-1]))
        times = frame_times(track.end, 30)
        whole = predict_at(model, track, times)
        for first in (0, 17, 300, 611):
            part = predict_at(model, track, times[first : first + 50])
            np.testing.assert_allclose(part, whole[first : first + 50], atol=1e-5)

    @pytest.mark.parametrize("fps", [0.1, 24, 60, 1000])
    def test_any_rate_and_any_track(self, model: ArrayModel, fps: float) -> None:
        tracks = (
            PhoneTrack(("AA",), np.array([0, 1.0])),
            PhoneTrack(("sil",), np.array([0, 0.4])),
            PhoneTrack(("P", "AA", "S") * 4, np.arange(13) * 0.01),
            PhoneTrack(("sil", "ZH", "OY", "HH", "XIY", "sil"), np.arange(7) * 0.2),
            PhoneTrack(("AA", "P"), np.array([2, 2.1, 2.2])),
        )
        for track in tracks:
            clip = animate(track, fps, model=model)
            assert clip.names == CANONICAL
            assert len(clip.values) == len(frame_times(track.end, fps))
            assert np.abs(clip.values).max() < 1.5

    def test_no_times_are_no_frames(self, model: ArrayModel) -> None:
        assert predict_at(model, said(0), np.empty(0)).shape == (0, 2)

    def test_it_ships_no_model(self) -> None:
        with pytest.raises(LipwrightError, match="the engine hmm needs a model"):
            open_network(None)


def spoil(name: str, change: Callable[[Any], Any]) -> Any:
    return pytest.param(name, change, id=name)


@pytest.mark.parametrize(("name", "change"), [
    spoil("state_branches", np.zeros_like), spoil("state_branches", lambda a: a + 10**6),
    spoil("state_leaf", lambda a: a + 10**6), spoil("state_leaf", lambda a: a - 10),
    spoil("state_place", lambda a: a + 5), spoil("state_roots", lambda a: a - 10**6),
    spoil("state_members", lambda a: a[:, :2]), spoil("duration_roots", lambda a: a + 10**6),
    spoil("duration_leaf", lambda a: a[:-1]), spoil("durations", np.zeros_like),
    spoil("deviations", np.zeros_like), spoil("deviations", lambda a: -a),
    spoil("means", lambda a: a * np.nan), spoil("means", lambda a: a.astype(int)),
    spoil("rate", lambda a: a * 0), spoil("rate", lambda a: a * 1e9),
])  # fmt: skip
def test_a_damaged_model_is_one_clear_line(
    model: ArrayModel, name: str, change: Callable[[Any], Any]
) -> None:
    arrays = {**model.arrays, name: change(np.asarray(model.arrays[name]))}
    with pytest.raises(LipwrightError, match=f"planted.*{name}") as caught:
        open_network(model_of(arrays))
    assert "\n" not in str(caught.value)
