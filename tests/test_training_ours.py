"""The parts of training that our own configuration uses: gates, voices, lips, running means."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.controls import ARKIT, CANONICAL
from lipwright.face.head import Head
from lipwright.features.sound import SOUND_NAMES
from lipwright.network import check_golden, load_network, shipped_models
from lipwright.network.folder import read_meta

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")

from lipwright.errors import LipwrightError  # noqa: E402
from lipwright.train.augment import augmented  # noqa: E402
from lipwright.train.config import Augment, Config  # noqa: E402
from lipwright.train.config_file import load_config  # noqa: E402
from lipwright.train.data import Data, make_data  # noqa: E402
from lipwright.train.export import write_model  # noqa: E402
from lipwright.train.loop import halves, one_cycle  # noqa: E402
from lipwright.train.losses import APERTURE_UNIT, aperture_error  # noqa: E402
from lipwright.train.measures import predict_takes  # noqa: E402
from lipwright.train.takes import Corpus  # noqa: E402
from test_training import CONV, bits, config, some_track, toy, trained  # noqa: E402  # needs torch

pytestmark = pytest.mark.usefixtures("one_torch_thread")

GATED = CONV | {
    "network.kind": "gated", "network.layers": [8, 8], "network.kernels": [3, 5],
    "network.init": "torch",
}  # fmt: skip
HEARING = GATED | {
    "features": ["raw", "timing", "sound"], "average": 0.2, "rates.schedule": "one_cycle",
    "optimizer.kind": "adamw", "optimizer.longest": 1.0, "precision": "bfloat16",
    "augment": {"voices": [0.9, 1.2], "voiced": 0.5, "deaf": 0.3, "noise": 0.1},
}  # fmt: skip
SOUND = len(SOUND_NAMES)


def with_sound(corpus: Corpus) -> Corpus:
    """The takes with random sound: all 1 more in the first other voice, 2 in the second."""
    random = np.random.default_rng(3)

    def heard(take: Any) -> Any:
        sound = random.random((len(take.times), SOUND)).astype(np.float32)
        return replace(take, sound=sound, voices=(sound + 1, sound + 2))

    splits = {name: tuple(map(heard, takes)) for name, takes in corpus.splits.items()}
    return replace(corpus, splits=splits)


@pytest.fixture(scope="module")
def chosen() -> Config:
    return config(**HEARING)


@pytest.fixture(scope="module")
def data(chosen: Config) -> Data:
    return make_data(with_sound(toy(takes=3)), chosen)


# --- gated convolutions ---


@pytest.mark.parametrize("changes", [{}, {"members": 2}, {"network.kernels": [1, 7],
                                                          "input_window": 13}])  # fmt: skip
def test_the_exported_gates_give_what_torch_gives(changes: dict[str, Any], tmp_path: Path) -> None:
    gated = config(**(GATED | changes))
    toys = make_data(toy(takes=3), gated)
    state = trained(gated, toys)
    write_model(tmp_path, gated, toys, state.members, {"licence": "", "data": "", "metrics": {}})
    assert check_golden(tmp_path) < 1e-5
    take = toys.validation.takes[1]
    half = gated.input_window // 2
    frames = toys.features.frames(take.track, take.times)
    found = load_network(tmp_path).run(np.pad(frames, ((half, half), (0, 0)), mode="edge")[None])
    wanted = predict_takes(gated, toys, state.members, toys.validation)[1]
    assert np.abs(found[0] - wanted).max() < 1e-5


def test_gated_convolutions_learn_a_planted_map() -> None:
    gated = config(**(GATED | {"epochs": 40, "network.layers": [24, 24], "network.dropout": [0.0]}))
    toys = make_data(toy(), gated)
    error = trained(gated, toys).history[-1]["error"]
    assert error < 0.1


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"network.layers": [8, 12]}, "one size"),
        ({"network.kernels": [3, 4], "input_window": 9}, "odd"),
    ],
)
def test_gates_that_cannot_be_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(LipwrightError, match=words):
        config(**(GATED | changes))


# --- what is heard ---


def test_without_augmentation_sound_is_as_it_is(data: Data) -> None:
    where = torch.tensor([0, 40])
    plain = augmented(data.train, where, 10, Augment(), np.random.default_rng(0))
    assert torch.equal(plain, data.train.stretches(where, 10))


def test_each_example_has_one_voice_and_phones_stay(data: Data) -> None:
    where = torch.arange(0, 120)
    changed = augmented(
        data.train, where, 10, Augment(voices=(0.9, 1.2), voiced=0.5), np.random.default_rng(0)
    )
    plain = data.train.stretches(where, 10)
    assert torch.equal(changed[:, :, :-SOUND], plain[:, :, :-SOUND])
    shift = (changed - plain)[:, :, -SOUND:]
    assert torch.allclose(shift, shift[:, :1, :1].expand_as(shift), atol=1e-5)
    shares = np.bincount(shift[:, 0, 0].round().int().numpy(), minlength=3) / len(where)
    assert shares == pytest.approx([0.5, 0.25, 0.25], abs=0.15)


def test_the_deaf_hear_zeros_and_know_it(data: Data) -> None:
    where = torch.arange(0, 120)
    changed = augmented(data.train, where, 10, Augment(deaf=0.5), np.random.default_rng(0))
    deaf = changed[:, 0, -SOUND - 1] == 0
    assert 0.3 < deaf.float().mean() < 0.7
    assert (changed[deaf][:, :, -SOUND - 1 :] == 0).all()
    assert torch.equal(changed[~deaf], data.train.stretches(where, 10)[~deaf])


def test_noise_has_the_spread_asked_for(data: Data) -> None:
    where = torch.arange(0, 300, 3)
    changed = augmented(data.train, where, 10, Augment(noise=0.1), np.random.default_rng(0))
    added = (changed - data.train.stretches(where, 10))[:, :, -SOUND:]
    assert added.std().item() == pytest.approx(0.1 * 2**0.5, rel=0.05)


@pytest.mark.parametrize("deaf_takes", [1, 3])
def test_recordings_without_sound_are_learnt_from_as_phones_alone(
    deaf_takes: int, chosen: Config
) -> None:
    corpus = with_sound(toy(takes=3))
    takes = tuple(
        replace(take, sound=None, voices=()) if index < deaf_takes else take
        for index, take in enumerate(corpus.of("train"))
    )
    data = make_data(replace(corpus, splits={**corpus.splits, "train": takes}), chosen)
    where = torch.arange(0, len(takes[0].times) - 10)
    changed = augmented(data.train, where, 10, chosen.augment, np.random.default_rng(0))
    assert (changed[:, :, -SOUND:] == 0).all()
    trained(chosen, data)


def test_other_voices_need_sound_and_convolutions() -> None:
    with pytest.raises(LipwrightError, match="augment"):
        config(augment={"deaf": 0.1})


def test_a_network_that_was_deaf_at_times_runs_without_sound(
    chosen: Config, data: Data, tmp_path: Path
) -> None:
    state = trained(chosen, data)
    write_model(tmp_path, chosen, data, state.members, {"licence": "", "data": "", "metrics": {}})
    network, take = load_network(tmp_path), data.validation.takes[0]
    with_it, without = (
        network.run(data.features.frames(take.track, take.times, sound)[None])
        for sound in (take.sound, None)
    )
    assert np.isfinite(without).all()
    assert np.abs(with_it - without).max() > 1e-4


def test_the_same_seed_gives_the_same_weights_with_all_of_it(chosen: Config, data: Data) -> None:
    assert bits(trained(chosen, data)) == bits(trained(chosen, data))


def test_a_stop_after_any_epoch_ends_in_the_same_running_mean(
    chosen: Config, data: Data, tmp_path: Path
) -> None:
    from lipwright.train.run import fit_in

    class StopError(Exception):
        pass

    def stop(epoch: Any) -> None:
        raise StopError

    whole = fit_in(tmp_path, chosen, data)
    folder = tmp_path / "stopped"
    folder.mkdir()
    with pytest.raises(StopError):
        fit_in(folder, chosen, data, tell=stop)
    assert bits(fit_in(folder, chosen, data)) == bits(whole)


# --- columns that nothing teaches ---


def test_what_training_never_saw_does_not_move_the_mouth(tmp_path: Path) -> None:
    plain = config(features=["raw", "attributes"], **{"network.dropout": [0.0]})
    toys = make_data(toy(takes=3), plain)
    state = trained(plain, toys)
    write_model(tmp_path, plain, toys, state.members, {"licence": "", "data": "", "metrics": {}})
    network, names = load_network(tmp_path), toys.features.names
    velar = [index for index, name in enumerate(names) if name.startswith("velar")]
    assert velar
    track = some_track(np.random.default_rng(0), 2.0)
    rows = toys.features.windows(track, np.arange(20) / 25)
    changed = rows.copy()
    changed[:, velar] = 1
    np.testing.assert_array_equal(network.run(rows), network.run(changed))


# --- the lips in the loss ---


def test_the_lips_in_the_loss_are_those_of_the_head(head: Head) -> None:
    random = np.random.default_rng(0)
    weights = np.zeros((2, 5, len(CANONICAL)))
    weights[0, :, CANONICAL.index("jawOpen")] = random.uniform(0.2, 0.4, 5)
    weights[1, :, CANONICAL.index("jawOpen")] = random.uniform(0.2, 0.4, 5)
    weights[:, :, CANONICAL.index("mouthPucker")] = random.uniform(0, 0.3, (2, 5))
    real, guess = (head.aperture_curve(each) for each in weights)
    opening = torch.from_numpy(head.opening)
    found = aperture_error(*torch.from_numpy(weights)[:, None], torch.ones(1, 5), opening)
    assert found.item() == pytest.approx((((real - guess) / APERTURE_UNIT) ** 2).mean(), rel=1e-6)


def test_the_opening_is_what_each_control_adds_to_the_aperture(head: Head) -> None:
    ajar = np.zeros(len(CANONICAL))
    ajar[CANONICAL.index("jawOpen")] = 0.5
    for name in ("mouthFunnel", "mouthUpperUpLeft", "mouthShrugLower"):
        moved = ajar.copy()
        moved[CANONICAL.index(name)] = 0.1
        added = np.diff(head.aperture_curve(np.stack([ajar, moved])))[0]
        assert head.opening[CANONICAL.index(name)] * 0.1 == pytest.approx(added, abs=1e-9)


# --- the rate and the arithmetic ---


def test_one_cycle_rises_to_the_rate_and_falls_to_nothing(chosen: Config) -> None:
    epochs = np.linspace(0, chosen.epochs, 101)
    rates = [one_cycle(chosen, float(done)) for done in epochs]
    assert rates[0] == pytest.approx(chosen.rates.first / 25)
    assert int(np.argmax(rates)) == 10
    assert rates[10] == pytest.approx(chosen.rates.first)
    assert rates[-1] == pytest.approx(0)
    assert (np.diff(rates)[:10] > 0).all()
    assert (np.diff(rates)[10:] < 0).all()


def test_half_precision_is_used_only_where_it_is_asked_for(chosen: Config) -> None:
    assert not halves(replace(chosen, precision="float32"))
    assert isinstance(halves(chosen), bool)


# --- what ships ---


def test_the_default_model_is_what_its_configuration_makes() -> None:
    ours, meta = load_config("lipwright"), read_meta(shipped_models()["lipwright"])
    assert set(meta.features.kinds) == set(ours.features)
    assert meta.features.window == ours.input_window
    assert meta.features.fps == ours.fps
    assert set(meta.controls) <= set(ARKIT)
    assert "CC BY 4.0" in meta.data
    size = sum(path.stat().st_size for path in shipped_models()["lipwright"].iterdir())
    assert size < 10e6
