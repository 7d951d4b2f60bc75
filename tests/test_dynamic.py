"""Dynamic visemes: gestures are found, clustered, chosen and joined as they should be."""

from __future__ import annotations

from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pytest

from lipwright.engines.dynamic import animate, curves, pieces, predict_at
from lipwright.engines.dynamic_path import Arcs, cheapest_cover
from lipwright.engines.dynamic_speech import MARGIN_S, PARTS, stretches
from lipwright.engines.dynamic_units import make_units, units_of
from lipwright.errors import LipwrightError
from lipwright.network.arrays import ArrayModel
from lipwright.network.meta import ModelMeta
from lipwright.phones import PHONES
from lipwright.track import PhoneTrack
from lipwright.train.dynamic import DynamicConfig, cluster, fit
from lipwright.train.dynamic_gestures import gestures_of, salient_frames, visible_weights
from lipwright.train.learner import Fitted
from lipwright.train.takes import Corpus, Take

CONTROLS = ("jawOpen", "mouthPucker", "mouthFunnel")
FPS = 50.0
REST_POSE = np.zeros(3)
TARGETS = {
    "B": (0.0, 0.2, 0.1),
    "AA": (0.9, 0.1, 0.2),
    "IY": (0.4, 0.0, 0.6),
    "UW": (0.2, 0.9, 0.5),
}
"""phone to the pose in its middle, where a planted face turns back"""


def planted(phones: tuple[str, ...], seconds: float = 0.16, name: str = "toy") -> Take:
    """A recording whose face moves from middle to middle of its phones along half cosines."""
    said = ("sil", *phones, "sil")
    lengths = np.array([0.7, *([seconds] * len(phones)), 0.7])
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    times = np.arange(int(edges[-1] * FPS)) / FPS
    middles = (edges[1:-2] + edges[2:-1]) / 2
    knots = np.array([edges[1] - 0.08, *middles, edges[-2] + 0.08])
    poses = np.array([REST_POSE, *(TARGETS[phone] for phone in phones), REST_POSE])
    place = np.interp(times, knots, np.arange(len(knots)))
    low = np.minimum(place.astype(int), len(knots) - 2)
    share = ((1 - np.cos(np.pi * (place - low))) / 2)[:, None]
    values = poses[low] * (1 - share) + poses[low + 1] * share
    valid = np.ones(len(times), bool)
    return Take(name, times, values.astype(np.float32), valid, PhoneTrack(said, edges))


def words(count: int, seed: int, length: int = 6) -> list[tuple[str, ...]]:
    """Rows of phones, no phone after itself."""
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(count):
        row = [str(rng.choice(list(TARGETS)))]
        while len(row) < length:
            row.append(str(rng.choice([phone for phone in TARGETS if phone != row[-1]])))
        rows.append(tuple(row))
    return rows


def corpus_of(train: list[Take], validation: list[Take] | None = None) -> Corpus:
    splits = {"train": tuple(train), "validation": tuple(validation or train[:2]), "test": ()}
    return Corpus(splits, CONTROLS, FPS, "toy", "", Path("toy"))


def config(**changes: object) -> DynamicConfig:
    values = {"engine": "dynamic", "name": "toy", "smooth_s": 0.0, "starts": 2, **changes}
    return DynamicConfig(**values)


def learn(corpus: Corpus, **changes: object) -> Fitted:
    pytest.importorskip("sklearn")
    return fit(corpus, config(**changes), lambda stage, share: None)


def model_of(fitted: Fitted) -> ArrayModel:
    meta = ModelMeta(
        "toy", "dynamic", fitted.features, 1, CONTROLS, "arkit",
        {"model.npz": "0" * 64, "golden.npz": "0" * 64}, "", "", {}, "2020-01-01",
    )  # fmt: skip
    return ArrayModel(Path("toy"), meta, fitted.arrays)


@pytest.fixture(scope="module")
def toy() -> ArrayModel:
    """Learnt from planted recordings."""
    takes = [planted(row) for row in words(60, 1)]
    return model_of(learn(corpus_of(takes), clusters=40))


def r_of(take: Take, model: ArrayModel) -> float:
    made = predict_at(model, take.track, take.times)
    return float(np.corrcoef(made.ravel(), take.targets.ravel())[0, 1])


def random_arcs(rng: np.random.Generator, last: int) -> list[Arcs]:
    """Units with random costs and poses, one to the next place at least."""
    arcs = []
    for place in range(last):
        stops = np.append(rng.integers(place + 1, last + 1, size=3), place + 1)
        first, last_pose = rng.normal(size=(2, 4, 2))
        arcs.append(Arcs(stops, rng.uniform(0, 3, size=4), first, last_pose))
    return arcs


def brute_force(
    arcs: list[Arcs], smoothness: float, before: np.ndarray | None, after: np.ndarray | None
) -> tuple[float, list[tuple[int, int]]]:
    """The least cost of all covers, and the cover."""
    best: tuple[float, list[tuple[int, int]]] = (np.inf, [])
    waiting = [(0, before, 0.0, [])]
    while waiting:
        place, pose, cost, path = waiting.pop()
        if place == len(arcs):
            if after is not None:
                cost += smoothness * np.square(pose - after).sum()
            best = min(best, (cost, path), key=lambda one: one[0])
            continue
        here = arcs[place]
        for row, stop in enumerate(here.stops):
            jump = 0.0 if pose is None else smoothness * np.square(pose - here.first[row]).sum()
            waiting.append((int(stop), here.last[row], cost + here.costs[row] + jump,
                            [*path, (place, row)]))  # fmt: skip
    return best


@pytest.mark.parametrize(("seed", "joined"), list(product(range(12), (False, True))))
def test_the_dynamic_programme_finds_what_brute_force_finds(seed, joined):
    rng = np.random.default_rng(seed)
    arcs = random_arcs(rng, 5)
    before, after = rng.normal(size=(2, 2)) if joined else (None, None)
    cost, path = brute_force(arcs, 0.7, before, after)
    assert np.isfinite(cost)
    assert cheapest_cover(arcs, 0.7, before, after, beam=1000) == path


def test_a_stretch_that_no_units_cover_is_refused():
    nothing = Arcs(np.zeros(0, int), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2)))
    with pytest.raises(ValueError, match="no row of units"):
        cheapest_cover([nothing], 1.0)


def test_segmentation_finds_the_planted_turns():
    pytest.importorskip("scipy")
    rows = words(10, 3)
    for row in rows:
        take = planted(row)
        middles = (take.track.edges[1:-2] + take.track.edges[2:-1]) / 2
        found = salient_frames(take.targets.astype(float), FPS, 0.0, 0.06) / FPS
        nearest = np.abs(found[:, None] - middles).min(axis=0)
        assert nearest.max() <= 1.01 / FPS  # every turn, to a frame
        inside = (found > middles[0] - 0.03) & (found < middles[-1] + 0.03)
        assert inside.sum() == len(middles)  # and no other


def test_clustering_finds_the_planted_classes():
    pytest.importorskip("sklearn")
    known = ("sil", *TARGETS)
    takes = [planted(row) for row in words(30, 4)]
    visible = visible_weights(CONTROLS, np.concatenate([t.targets for t in takes]).std(axis=0))
    gestures = [
        gesture
        for take in takes
        for gesture in gestures_of(take, visible, known, FPS, 0.0, 0.06)
        if len(gesture.phones) == 2 and 0 not in gesture.phones
    ]
    true = {gesture.phones for gesture in gestures}
    assert len(true) == 12  # from each of four phones to each other
    labels = cluster(gestures, visible, config(clusters=12, starts=10))
    pairs = {(gesture.phones, label) for gesture, label in zip(gestures, labels, strict=True)}
    assert len(pairs) == 12  # one cluster to a class


def test_it_finds_the_planted_motion_of_rows_of_phones_it_never_heard(toy):
    heard = set(words(60, 1))
    fresh = [row for row in words(20, 9, length=8) if row not in heard]
    assert min(r_of(planted(row), toy) for row in fresh) > 0.95


def test_it_finds_the_planted_motion_at_another_rate_of_speech(toy):
    assert min(r_of(planted(row, seconds=0.22), toy) for row in words(10, 11)) > 0.93


def test_with_one_cluster_a_gesture_it_repeats_its_recordings():
    rng = np.random.default_rng(0)
    takes = [planted(row) for row in words(8, 5)]
    own = []
    for take in takes:  # a recording's own way to say each phone, so that strings are not alike
        noise = rng.normal(scale=0.15, size=(len(take.times) // 8 + 2, 3))
        places = np.arange(len(take.times)) / 8
        added = [np.interp(places, np.arange(len(noise)), column) for column in noise.T]
        own.append(Take(take.name, take.times, take.targets + np.float32(np.transpose(added)),
                        take.valid, take.track))  # fmt: skip
    model = model_of(learn(corpus_of(own), clusters=100_000, candidates=100))
    speech = [np.flatnonzero((t.times > t.track.edges[1]) & (t.times < t.track.edges[-2]))
              for t in own]  # fmt: skip
    made = [predict_at(model, take.track, take.times) for take in own]
    pooled = [np.concatenate([v[i].ravel() for v, i in zip(values, speech, strict=True)])
              for values in (made, [take.targets for take in own])]  # fmt: skip
    assert np.corrcoef(*pooled)[0, 1] > 0.95


def test_the_same_recordings_give_the_same_arrays():
    corpus = corpus_of([planted(row) for row in words(12, 6)])
    one, other = learn(corpus, clusters=20), learn(corpus, clusters=20)
    assert all(np.array_equal(one.arrays[name], other.arrays[name]) for name in one.arrays)


@pytest.mark.parametrize(
    ("phones", "lengths"),
    [
        (("sil",), (2.0,)),
        (("sil",), (0.01,)),
        (("AA",), (0.3,)),
        (("AA",), (0.001,)),
        (("ZH", "XSI", "OY", "HH"), (0.1, 0.2, 0.3, 0.1)),
        (("HH",), (5.0,)),
        (("B", "AA") * 300, (0.01,) * 600),
        (("AA", "sil", "B", "sil", "IY"), (0.1, 40.0, 0.1, 0.1, 90.0)),
        (tuple(PHONES), (0.08,) * len(PHONES)),
    ],
)
@pytest.mark.parametrize("fps", [0.1, 25.0, 1000.0])
def test_any_track_gives_finite_motion_of_its_length(toy, phones, lengths, fps):
    track = PhoneTrack(phones, 0.05 + np.concatenate([[0.0], np.cumsum(lengths)]))
    if track.end * fps > 20_000:
        track = PhoneTrack(phones[:1], track.edges[:2])
    clip = animate(track, fps, model=toy)
    assert np.isfinite(clip.values).all()
    assert (len(clip.values) - 1) / fps >= track.end - 1e-6
    assert np.abs(clip.values).max() < 2


def test_frames_do_not_depend_on_which_are_asked_for(toy):
    take = planted(words(1, 7, length=20)[0])
    whole = predict_at(toy, take.track, take.times)
    part = predict_at(toy, take.track, take.times[31:44])
    np.testing.assert_array_equal(part, whole[31:44])
    outside = predict_at(toy, take.track, np.array([-5.0, take.track.end, 1e6]))
    assert np.isfinite(outside).all()
    np.testing.assert_allclose(outside[1], outside[2])


def test_motion_does_not_jump_where_gestures_meet(toy):
    take = planted(words(1, 8, length=30)[0])
    units = units_of(toy)
    said = list(pieces(units, take.track))
    assert len(said) > 10
    for before, after in pairwise(said):
        assert before.times[-1] == after.times[0]
    meets = np.array([piece.times[0] for piece in said[1:]])
    beside = np.sort(np.concatenate([meets - 1e-7, meets + 1e-7]))
    values = curves(units, said, beside)
    assert np.abs(values[1::2] - values[::2]).max() < 1e-3


def test_pieces_follow_each_other_through_batches(toy):
    row = words(1, 12, length=700)[0]
    take = planted(row)
    assert len(list(pieces(units_of(toy), take.track))) > 256
    assert r_of(take, toy) > 0.95


def test_stretches_cover_a_track_without_gaps_and_rest_in_long_silences():
    track = PhoneTrack(("sil", "AA", "B", "sil", "sil", "IY"), [0.1, 1.2, 1.3, 1.5, 3.0, 3.1, 3.2])
    found = list(stretches(track, ("sil", "AA", "B", "IY")))
    assert found[0].edges[0] == 0.1
    assert found[-1].edges[-1] == 3.2
    for before, after in pairwise(found):
        assert before.edges[-1] == after.edges[0]
    assert [bool(stretch.phones) for stretch in found] == [False, True, False, True]
    np.testing.assert_allclose(found[1].edges[[0, -1]], [1.2 - MARGIN_S, 1.5 + MARGIN_S])
    places = np.arange(found[1].joints + 1)
    assert found[1].joints == PARTS * 4
    np.testing.assert_allclose(found[1].places(found[1].times(places)), places)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("gesture", 1000), ("gesture", -1), ("string", -2), ("string", 10**6), ("lengths", 0),
        ("lengths", 100), ("parts", PARTS), ("strings", 99), ("marks", 3.0), ("ends", 1.0),
        ("weights", -1.0), ("costs", 1e30), ("cuts", 3), ("seconds", -1e30), ("visible", -1.0),
        ("strings", -1),
    ],
)  # fmt: skip
def test_a_model_with_values_that_cannot_be_is_one_clear_line(toy, name, value):
    arrays = dict(toy.arrays)
    arrays[name] = arrays[name].copy()
    arrays[name].flat[0] = value
    damaged = ArrayModel(toy.path, toy.meta, arrays)
    with pytest.raises(LipwrightError, match=r"model\.npz") as caught:
        units_of(damaged)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["gestures", "strings", "marks"])
def test_a_model_that_lacks_an_array_or_has_it_empty_is_refused(toy, name):
    kept = {other: array for other, array in toy.arrays.items() if other != name}
    for arrays in (kept, {**kept, name: toy.arrays[name][:0]}):
        with pytest.raises(LipwrightError, match=name):
            units_of(ArrayModel(toy.path, toy.meta, arrays))


def test_a_model_that_cannot_say_a_phone_is_refused(toy):
    with pytest.raises(ValueError, match="lacks a part of OY"):
        make_units(toy.arrays, (*toy.meta.features.phones, "OY"))


def test_modes_weigh_by_their_size_and_weights_of_heads_as_they_are():
    modes = visible_weights(("joint1", "joint2", "jawOpen"), np.array([1.0, 1.0, 0.1]))
    assert modes[0] > modes[1] > modes[2] == 0
    head = visible_weights(("jawOpen", "eyeBlinkLeft", "mouthPucker"), np.array([0.1, 0.3, 0.1]))
    assert head[0] == head[2] > head[1] == 0


def test_the_weights_are_the_best_that_were_tried():
    corpus = corpus_of([planted(row) for row in words(12, 6)], [planted(words(1, 13)[0])])
    tried = learn(corpus, clusters=20, smoothness=(900.0, 4.0), rate=(4.0, 1.0))
    lines = [note for note in tried.notes if note.startswith("weights")]
    assert len(lines) >= 3
    best = min(lines, key=lambda line: float(line.split()[-1]))
    assert best.startswith("weights smoothness {:g}, rate {:g},".format(*tried.arrays["weights"]))


def test_a_model_with_endless_choices_for_a_string_is_refused(toy):
    arrays = dict(toy.arrays)
    for name in ("gesture", "string", "lengths", "marks", "ends", "costs", "seconds", "cuts"):
        arrays[name] = np.repeat(arrays[name], 5000, axis=0)[:200_000]
    with pytest.raises(ValueError, match="more than 4096"):
        make_units(arrays, toy.meta.features.phones)


def test_phones_too_short_for_the_clock_give_finite_motion(toy):
    late = 36_000.0
    edges = [0.0, late, np.nextafter(late, np.inf), late + 0.2, late + 0.9]
    track = PhoneTrack(("sil", "B", "AA", "sil"), edges)
    values = predict_at(toy, track, late + np.arange(-50, 50) / FPS)
    assert np.isfinite(values).all()


def test_too_little_to_learn_from_is_one_clear_line():
    silent = PhoneTrack(("sil",), [0.0, 3.0])
    times = np.arange(100) / FPS
    take = Take("still", times, np.zeros((100, 3), np.float32), np.ones(100, bool), silent)
    with pytest.raises(LipwrightError, match="gestures"):
        learn(corpus_of([take]))
