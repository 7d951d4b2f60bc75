"""The engine trees: what it learns, that it is what scikit-learn says, and that it always ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from lipwright.clip import frame_times
from lipwright.controls import CANONICAL
from lipwright.engines import trees, window
from lipwright.engines.trees import LEAF, MAX_DEPTH, Forest, animate, open_network, predict_at
from lipwright.errors import LipwrightError
from lipwright.network.arrays import ArrayModel
from lipwright.network.meta import ModelMeta
from lipwright.phones import PHONES
from lipwright.track import PhoneTrack

pytest.importorskip("sklearn", reason="the extra `train` is not installed")

from sklearn.ensemble import RandomForestRegressor  # needs the extra
from sklearn.tree import DecisionTreeRegressor

from lipwright.train import trees as learner
from lipwright.train.config_file import config_from, load_config
from lipwright.train.learner import Fitted
from lipwright.train.takes import Corpus, Take
from lipwright.train.trees import TreesConfig, fit, flatten, join, motions, see

FPS = 25.0
SPOKEN = ("AA", "IY", "UW", "B", "M", "S", "T", "K")
CONTROLS = ("jawOpen", "mouthClose", "mouthPucker")

Floats = npt.NDArray[np.float64]
Rule = Callable[[PhoneTrack, Floats], Floats]


def some_track(random: np.random.Generator, seconds: float) -> PhoneTrack:
    count = int(seconds / 0.13)
    edges = np.concatenate([[0.0], random.uniform(0.06, 0.2, count).cumsum()])
    phones = random.choice(SPOKEN, count)
    return PhoneTrack(("sil", *map(str, phones[1:-1]), "sil"), edges * seconds / edges[-1])


def said(track: PhoneTrack, times: Floats) -> list[str]:
    """The phone at each of `times`; past the ends, that of the ends."""
    return [track.phones[i] for i in np.searchsorted(track.edges[1:-1], times, "right")]


def toy(rule: Rule, takes: int = 12, seconds: float = 8.0) -> Corpus:
    """Recordings whose controls follow a rule; two for validation."""
    random = np.random.default_rng(5)
    made = []
    for number in range(takes):
        track = some_track(random, seconds)
        times = np.arange(int(seconds * FPS)) / FPS + 0.013
        targets = rule(track, times).astype(np.float32)
        made.append(Take(f"take{number}", times, targets, np.ones(len(times), bool), track))
    splits = {"train": tuple(made[2:]), "validation": tuple(made[:2]), "test": ()}
    return Corpus(splits, CONTROLS[: targets.shape[1]], FPS, "toy", "CC0", Path("toy"))


def noise(track: PhoneTrack, times: Floats) -> Floats:
    seed = int(track.edges[1] * 1e9)
    return np.random.default_rng(seed).uniform(size=(len(times), 3))


def ahead(track: PhoneTrack, times: Floats) -> Floats:
    """Controls that follow a phone 4 frames later, an attribute 3 earlier, and a change of sort.

    The middle one moves a thousandth as much as the others.
    """
    later, earlier = said(track, times + 4 / FPS), said(track, times - 3 / FPS)
    now, after = said(track, times), said(track, times + 1 / FPS)
    vowel = [PHONES[phone].is_vowel for phone in now]
    return np.stack([
        [phone == "UW" for phone in later],
        [1e-3 * (PHONES[phone].place == "bilabial") for phone in earlier],
        [was and PHONES[phone].is_consonant for was, phone in zip(vowel, after, strict=True)],
    ], axis=1).astype(np.float64)  # fmt: skip


def config(**changes: Any) -> TreesConfig:
    return TreesConfig(**{"engine": "trees", "name": "small", "min_leaf": 1, **changes})


def learn(corpus: Corpus, **changes: Any) -> Fitted:
    return fit(corpus, config(**changes), lambda stage, share: None)


def model_of(fitted: Fitted, controls: tuple[str, ...] = CONTROLS) -> ArrayModel:
    meta = ModelMeta(
        name="toy", kind="trees", features=fitted.features, output_window=fitted.output_window,
        controls=controls, target="arkit", licence="CC0", data="toy", metrics={},
        files=dict.fromkeys(("model.npz", "golden.npz"), "0" * 64), date="2018-01-31",
    )  # fmt: skip
    return ArrayModel(Path("toy"), meta, fitted.arrays)


def errors(corpus: Corpus, model: ArrayModel, split: str) -> Floats:
    """(C,) mean squared error over the variance of each control."""
    takes = corpus.of(split)
    guess = np.concatenate([predict_at(model, take.track, take.times) for take in takes])
    real = np.concatenate([take.targets for take in takes]).astype(np.float64)
    return np.asarray(np.square(guess - real).mean(axis=0) / real.var(axis=0))


@pytest.fixture(scope="module")
def forest() -> tuple[ArrayModel, Corpus]:
    corpus = toy(ahead, takes=8)
    return model_of(learn(corpus, min_leaf=4, trees=3, columns=0.5)), corpus


# --- what it learns ---


def test_one_tree_of_single_windows_fits_its_training_almost_exactly() -> None:
    corpus = toy(noise, takes=5)
    assert errors(corpus, model_of(learn(corpus)), "train").max() < 0.005


def test_leaves_of_ten_windows_do_not_fit_noise() -> None:
    corpus = toy(noise, takes=5)
    model = model_of(learn(corpus, min_leaf=10))
    assert errors(corpus, model, "train").min() > 0.5


@pytest.mark.parametrize("shape", [{}, {"trees": 6, "columns": 0.33}], ids=["tree", "forest"])
def test_it_recovers_rules_of_phones_frames_away_whatever_their_size(shape: dict[str, Any]) -> None:
    corpus = toy(ahead, takes=40)
    model = model_of(learn(corpus, min_leaf=10, output_window=1, **shape))
    limit = 0.25 if shape else 0.02
    assert errors(corpus, model, "validation").max() < limit


def test_windows_of_motion_cost_a_rule_little() -> None:
    corpus = toy(ahead, takes=40)
    found = errors(corpus, model_of(learn(corpus, min_leaf=10)), "validation")
    assert found.max() < 0.35  # a window that begins 6 frames before what it sees has to guess
    assert found[1] < 0.1  # what was said before is in the window of all five


def test_what_lies_beyond_the_window_cannot_be_known() -> None:
    def far(track: PhoneTrack, times: Floats) -> Floats:
        return np.array([[phone == "UW"] for phone in said(track, times + 6 / FPS)], np.float64)

    corpus = toy(far, takes=30)
    narrow, wide = (
        errors(corpus, model_of(learn(corpus, input_window=w, output_window=1, min_leaf=5),
                                CONTROLS[:1]), "validation")[0]
        for w in (11, 13)
    )  # fmt: skip
    assert wide < 0.05
    assert narrow > 0.2


def test_frames_without_a_face_teach_nothing() -> None:
    corpus = toy(ahead, takes=6)
    for take in corpus.of("train"):
        take.valid[40:60] = False
        take.targets[40:60] = 1e6
    fitted = learn(corpus)
    assert np.abs(fitted.arrays["leaves"]).max() < 1.001


def test_past_the_ends_the_end_frames_repeat() -> None:
    targets = np.arange(4, dtype=np.float32)[:, None]
    track = PhoneTrack(("sil",), np.array([0.0, 1.0]))
    take = Take("one", np.arange(4) / FPS, targets, np.array([True, True, True, False]), track)
    assert motions(take, 3)[:, :, 0].tolist() == [[0, 0, 1], [0, 1, 2]]


def test_too_few_windows_are_refused_in_one_line() -> None:
    corpus = toy(ahead, takes=3, seconds=2.0)
    with pytest.raises(LipwrightError, match=r"toy: 50 windows .* lower 'min_leaf'") as caught:
        learn(corpus, min_leaf=26)
    assert "\n" not in str(caught.value)


def test_the_same_seed_gives_the_same_trees_however_many_grow_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    corpus, found = toy(ahead, takes=5), []
    for cores, seed in ((1, 0), (3, 0), (1, 1)):
        monkeypatch.setattr(learner, "_cores", lambda cores=cores: cores)
        arrays = learn(corpus, trees=4, columns=0.3, seed=seed, min_leaf=3).arrays
        found.append([arrays[name].tobytes() for name in sorted(arrays)])
    assert found[0] == found[1]
    assert found[0] != found[2]


# --- a second implementation ---


@pytest.mark.parametrize("trees", [1, 4])
def test_predictions_are_those_of_scikit_learn(trees: int) -> None:
    random = np.random.default_rng(1)
    windows = random.normal(size=(600, 12)).astype(np.float32)
    windows[:, 6:] = windows[:, 6:] > 0
    motion = (windows[:, :3, None] * windows[:, None, 6:8]).reshape(600, 6)
    motion += random.normal(0, 0.1, (600, 6))
    if trees == 1:
        reference: Any = DecisionTreeRegressor(min_samples_leaf=3, random_state=0)
        grown = [reference.fit(windows, motion)]
    else:
        reference = RandomForestRegressor(trees, min_samples_leaf=3, random_state=0)
        grown = reference.fit(windows, motion).estimators_
    seen = 2 * np.arange(12)  # every other column of those of a window
    parts = [flatten(tree.tree_, seen, (3, 2)) for tree in grown]
    arrays = join(parts)
    found = Forest(**{**arrays, "leaves": arrays["leaves"].astype(np.float32)}, width=24)

    asked = np.concatenate([windows, random.normal(size=(400, 12)).astype(np.float32)])
    for tree in grown:  # values right at the thresholds, and beside them
        inner = np.flatnonzero(tree.tree_.children_left >= 0)[:50]
        for step in (-np.inf, 0, np.inf):
            edge = random.normal(size=(len(inner), 12)).astype(np.float32)
            at = tree.tree_.threshold[inner].astype(np.float32)
            at = at if step == 0 else np.nextafter(at, np.float32(step))
            edge[np.arange(len(inner)), tree.tree_.feature[inner]] = at
            asked = np.concatenate([asked, edge])
    wide = np.full((len(asked), 24), np.float32(9))
    wide[:, seen] = asked
    expected = reference.predict(asked).reshape(-1, 3, 2)
    np.testing.assert_allclose(found.run(wide), expected, atol=1e-6)


def test_the_engine_says_what_scikit_learn_says_of_the_whole_training() -> None:
    corpus = toy(ahead, takes=6)
    fitted = learn(corpus, min_leaf=7)
    track, takes = corpus.of("validation")[0].track, corpus.of("train")
    windows, seen = see(takes, fitted.features, 5)
    motion = np.concatenate([motions(take, 5) for take in takes])
    spread = motion.reshape(-1, 3).std(axis=0)
    # Where two questions part the windows alike, the seed says which is asked.
    draw = int(np.random.default_rng((0, 0)).integers(2**31))
    tree = DecisionTreeRegressor(min_samples_leaf=7, random_state=draw)
    tree.fit(windows, ((motion - motion.mean(axis=(0, 1))) / spread).reshape(len(motion), -1))
    times = frame_times(track.end, FPS)
    asked = fitted.features.windows(track, times)[:, seen]
    found = tree.predict(asked).reshape(-1, 5, 3) * spread + motion.mean(axis=(0, 1))
    by_hand = [
        np.mean([found[w, f - w + 2] for w in range(len(times)) if abs(f - w) <= 2], axis=0)
        for f in range(len(times))
    ]
    np.testing.assert_allclose(
        predict_at(model_of(fitted), track, times), by_hand, rtol=0, atol=1e-6
    )


# --- running ---


@pytest.mark.parametrize("fps", [0.1, 1, 24, 25, 29.97, 60, 1000])
def test_any_rate_covers_the_track(fps: float, forest: tuple[ArrayModel, Corpus]) -> None:
    model, corpus = forest
    track = corpus.of("validation")[0].track
    clip = animate(track, fps, model=model)
    assert (clip.names, len(clip)) == (CANONICAL, len(frame_times(track.end, fps)))
    assert -0.01 <= clip.values.min() <= clip.values.max() <= 1.01
    assert not clip.select([n for n in CANONICAL if n not in CONTROLS]).values.any()


def test_at_its_own_rate_a_clip_is_what_it_predicts(forest: tuple[ArrayModel, Corpus]) -> None:
    model, corpus = forest
    track = corpus.of("validation")[0].track
    clip = animate(track, FPS, model=model)
    own = predict_at(model, track, frame_times(track.end, FPS))
    assert clip.select(CONTROLS).values.tobytes() == own.tobytes()


def test_parts_of_a_long_track_give_what_the_whole_gives(
    forest: tuple[ArrayModel, Corpus], monkeypatch: pytest.MonkeyPatch
) -> None:
    model, corpus = forest
    track = corpus.of("validation")[0].track
    whole = animate(track, 60, model=model)
    monkeypatch.setattr(window, "CHUNK_FRAMES", 7)
    np.testing.assert_allclose(animate(track, 60, model=model).values, whole.values, atol=1e-6)


@pytest.mark.parametrize(
    ("phones", "each"),
    [("AA", 0.3), ("sil", 2.0), ("sil sil sil", 0.2), ("sil HH ZH OY NG sil", 0.1),
     ("sil B AA M IY S UW T sil", 0.01), ("AA", 0.001)],
)  # fmt: skip
def test_any_track_is_said(phones: str, each: float, forest: tuple[ArrayModel, Corpus]) -> None:
    symbols = tuple(phones.split())
    track = PhoneTrack(symbols, np.arange(len(symbols) + 1) * each)
    clip = animate(track, 60, model=forest[0])
    assert len(clip) == len(frame_times(track.end, 60))
    assert np.isfinite(clip.values).all()


def test_a_phone_never_heard_moves_like_the_nearest(forest: tuple[ArrayModel, Corpus]) -> None:
    model, _ = forest
    raw = model_of(learn(toy(ahead, takes=5), features=("raw",), min_leaf=3))
    edges = np.arange(4) * 0.2
    one, other = (animate(PhoneTrack(("sil", p, "sil"), edges), 25, model=raw) for p in ("P", "B"))
    assert one.values.tobytes() == other.values.tobytes()
    assert np.isfinite(predict_at(model, PhoneTrack(("ZH",), [0, 1]), frame_times(1.0, FPS))).all()


def test_without_a_model_it_says_how_to_train_one() -> None:
    with pytest.raises(LipwrightError, match="lipwright train DATASET --config trees"):
        animate(PhoneTrack(("sil",), [0, 1]), 25)


# --- arrays of a stranger ---

GOOD: dict[str, npt.NDArray[Any]] = {
    "roots": np.array([0, 3]),
    "columns": np.array([1, LEAF, LEAF, LEAF]),
    "thresholds": np.array([0.5, 0, 0, 0], np.float32),
    "low": np.array([1, 0, 1, 1]),
    "high": np.array([2, 0, 0, 0]),
    "leaves": np.array([[[1.0]], [[3.0]]], np.float32),
}


def test_two_small_trees_by_hand() -> None:
    found = Forest(**GOOD, width=2)
    asked = np.array([[0, 0], [0, 0.5], [0, 1]], np.float32)
    assert found.find(asked).tolist() == [[0, 1], [0, 1], [1, 1]]
    assert found.run(asked).ravel().tolist() == [2, 2, 3]
    assert found.run(asked[:0]).shape == (0, 1, 1)


@pytest.mark.parametrize(
    ("name", "values", "reason"),
    [
        ("low", [0, 0, 1, 1], "before its parent"),  # a circle of one
        ("low", [4, 0, 1, 1], "'children'"),
        ("low", [-1, 0, 1, 1], "'children'"),
        ("low", [2, 0, 1, 1], "of two others, or of none"),
        ("low", [1, 2, 1, 1], "'leaves'"),
        ("low", [1, -1, 1, 1], "'leaves'"),
        ("high", [2**40, 0, 0, 0], "'children'"),
        ("columns", [2, LEAF, LEAF, LEAF], "'columns'"),
        ("columns", [-2, LEAF, LEAF, LEAF], "'columns'"),
        ("columns", [1, 0, LEAF, LEAF], "before its parent"),
        ("roots", [0, 4], "'roots'"),
        ("roots", [0, -1], "'roots'"),
        ("roots", [0, 0], "of two others, or of none"),
        ("roots", [0], "of two others, or of none"),
        ("roots", [], "no tree"),
    ],
)
def test_arrays_that_are_no_trees_are_refused(name: str, values: list[int], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        Forest(**{**GOOD, name: np.array(values, np.int64)}, width=2)


def test_a_chain_without_end_is_refused() -> None:
    def chain(depth: int) -> Forest:
        asks = np.arange(depth)
        nodes = 2 * depth + 1
        columns = np.full(nodes, LEAF)
        columns[2 * asks] = 0
        low, high = np.zeros((2, nodes), np.int64)
        low[2 * asks], high[2 * asks] = 2 * asks + 1, 2 * asks + 2
        return Forest(
            np.zeros(1, np.int64), columns, np.zeros(nodes, np.float32), low, high,
            np.zeros((1, 1, 1), np.float32), 1,
        )  # fmt: skip

    assert chain(MAX_DEPTH).run(np.ones((1, 1), np.float32)).shape == (1, 1, 1)
    with pytest.raises(ValueError, match=f"more than {MAX_DEPTH} questions"):
        chain(MAX_DEPTH + 1)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("low", lambda a: a[:-1]),
        ("columns", lambda a: a.astype(np.float32)),
        ("roots", lambda a: a[:, None]),
        ("leaves", lambda a: a[:, :1]),
        ("leaves", lambda a: np.full_like(a, np.nan)),
        ("thresholds", lambda a: np.full_like(a, np.inf)),
        ("high", lambda a: a * 0),
        ("columns", lambda a: a * 0 + 10**6),
        ("roots", None),
    ],
)
def test_damaged_arrays_are_one_line(
    name: str, change: Callable[[Any], Any] | None, forest: tuple[ArrayModel, Corpus]
) -> None:
    model, _ = forest
    arrays = dict(model.arrays)
    if change is None:
        del arrays[name]
    else:
        arrays[name] = change(arrays[name])
    broken = ArrayModel(model.path, model.meta, arrays)
    with pytest.raises(LipwrightError, match=r"model\.npz: .*train anew") as caught:
        open_network(broken)
    assert "\n" not in str(caught.value)


def test_trees_do_not_listen(forest: tuple[ArrayModel, Corpus]) -> None:
    model, _ = forest
    kinds = (*model.meta.features.kinds, "sound")
    meta = replace(model.meta, features=replace(model.meta.features, kinds=kinds))
    with pytest.raises(LipwrightError, match="listens"):
        trees.open_network(ArrayModel(model.path, meta, model.arrays))


# --- configurations ---


def test_what_ships_has_the_sizes_of_the_paper() -> None:
    found = load_config("trees")
    assert isinstance(found, TreesConfig)
    assert (found.input_window, found.output_window, found.min_leaf) == (11, 5, 10)
    assert config_from(found.to_json(), "again") == found


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"trees": 0}, "'trees' is 0, not 1 to 1000"),
        ({"min_leaf": 0}, "'min_leaf' is 0"),
        ({"min_leaf": 2.5}, "'min_leaf' is 2.5, not a whole number"),
        ({"input_window": 10}, "'input_window' is 10, not odd"),
        ({"output_window": 4}, "'output_window' is 4, not odd"),
        ({"columns": 0}, "'columns' must be above 0"),
        ({"columns": 1.5}, "'columns' must be above 0 and at most 1"),
        ({"features": ["sound"]}, "'features' has 'sound', not one of: raw"),
        ({"features": []}, "'features' must name one"),
        ({"features": ["raw", "raw"]}, "'features' has a name twice"),
        ({"leaf": 3}, "'leaf' is unknown; known are: .*min_leaf"),
        ({"phones": ["AA"]}, "'phones' must have 'sil'"),
        ({"phones": ["sil", "XX"]}, "'phones' has 'XX'"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(LipwrightError, match=f"^my.json: {reason}"):
        config_from({"engine": "trees", "name": "mine", **changes}, "my.json")
