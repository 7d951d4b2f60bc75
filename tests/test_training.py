"""Training: what is learnt, that it repeats, goes on after a kill, and what is written."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.cli import run
from lipwright.dataset.folder import open_dataset
from lipwright.network import check_golden, load_network
from lipwright.track import PhoneTrack

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")

from lipwright.train.batches import batches  # noqa: E402  # needs torch
from lipwright.train.checkpoint import Checkpoint, load_checkpoint  # noqa: E402
from lipwright.train.config import Config, Loss, Rates  # noqa: E402
from lipwright.train.config_file import config_from, load_config, override  # noqa: E402
from lipwright.train.data import Data, make_data  # noqa: E402
from lipwright.train.export import write_model  # noqa: E402
from lipwright.train.loop import (  # noqa: E402
    deterministic,
    fit,
    is_done,
    network_of,
    predict,
    rate_at,
)
from lipwright.train.losses import (  # noqa: E402
    motion_error,
    squared_error,
    total_loss,
    weight_norm,
)
from lipwright.train.measures import measure, predict_takes  # noqa: E402
from lipwright.train.networks import make_network  # noqa: E402
from lipwright.train.takes import Corpus, Take, read_corpus, resampled  # noqa: E402

pytestmark = pytest.mark.usefixtures("one_torch_thread")

SPOKEN = ("AA", "B", "S", "UW", "M")
FPS = 25.0


def some_track(random: np.random.Generator, seconds: float) -> PhoneTrack:
    lengths = random.uniform(0.05, 0.3, int(seconds / 0.1))
    edges = np.concatenate([[0.0], lengths.cumsum()])
    count = int(np.searchsorted(edges, seconds)) + 1
    phones = ("sil", *random.choice(SPOKEN, count - 2))
    return PhoneTrack(tuple(map(str, phones)), edges[:count])


Rule = Callable[[PhoneTrack, np.ndarray], np.ndarray]


def by_phone(track: PhoneTrack, times: np.ndarray) -> np.ndarray:
    """A control for each phone: a third of whether it is said now, and at the frames around."""
    phone = np.array(track.phones)[np.searchsorted(track.edges[1:-1], times, "right")]
    said = (phone[:, None] == np.array(SPOKEN)).astype(float)
    padded = np.pad(said, ((1, 1), (0, 0)), mode="edge")
    return (padded[:-2] + padded[1:-1] + padded[2:]) / 3


def noise(track: PhoneTrack, times: np.ndarray) -> np.ndarray:
    return np.random.default_rng(len(track)).normal(size=(len(times), 2))


def toy(rule: Rule = by_phone, takes: int = 8, seconds: float = 6.0) -> Corpus:
    """Recordings whose controls follow a rule."""
    random = np.random.default_rng(7)
    made = []
    for number in range(takes + 4):
        track = some_track(random, seconds)
        times = np.arange(int(seconds * FPS)) / FPS + 0.02
        targets = rule(track, times).astype(np.float32)
        valid = np.ones(len(times), bool)
        made.append(Take(f"take{number}", times, targets, valid, track))
    names = tuple(f"shape{column + 1}" for column in range(targets.shape[1]))
    splits = {"train": tuple(made[4:]), "validation": tuple(made[:2]), "test": tuple(made[2:4])}
    return Corpus(splits, names, FPS, "toy", "CC0", Path("toy"))


def config(**changes: Any) -> Config:
    small = {
        "name": "small", "targets": "shape", "features": ["raw"], "input_window": 5,
        "output_window": 3, "network": {"layers": [16], "dropout": [0.2]},
        "optimizer": {"kind": "adam"}, "rates": {"first": 0.01}, "batch": 32, "epochs": 3,
    }  # fmt: skip
    return override(config_from(small, "small"), changes, "changes")


CONV = {
    "network.kind": "conv", "network.layers": [8, 12], "network.kernels": [3, 5],
    "network.dilations": [1, 2], "network.activation": "leaky_relu", "input_window": 11,
    "output_window": 1, "batch": 4, "stretch": 20, "features": ["raw", "timing"],
}  # fmt: skip


def trained(chosen: Config, data: Data) -> Checkpoint:
    state = Checkpoint(chosen.to_json(), "toy")
    fit(chosen, data, state, lambda stage, share: None, lambda state: None)
    return state


def bits(state: Checkpoint) -> list[bytes]:
    return [weights[key].numpy().tobytes() for weights in state.members for key in sorted(weights)]


# --- configurations ---


def test_window_is_the_configuration_of_taylor_2017() -> None:
    window = load_config("window")
    assert (window.input_window, window.output_window, window.batch) == (11, 5, 100)
    assert window.network.layers == (3000, 3000, 3000)
    assert window.network.drops == (0.5, 0.5, 0.5)
    assert (window.network.activation, window.optimizer.kind) == ("tanh", "sgd")
    assert window.features == ("raw", "spans", "attributes", "transitions")
    assert window.loss == Loss(squared=1.0)


def test_thesis_is_the_configuration_of_table_4_2_and_section_4_3() -> None:
    thesis = load_config("thesis")
    assert (thesis.input_window, thesis.output_window, thesis.features) == (15, 15, ("raw",))
    assert (thesis.network.layers, thesis.network.drops) == ((338, 270), (0.6, 0.1))
    assert (thesis.network.activation, thesis.network.slope) == ("leaky_relu", 0.1)
    assert (thesis.network.init, thesis.optimizer.kind) == ("he", "adam")
    assert thesis.loss == Loss(squared=1.0, motion=1.0e-4, l2=1.8e-8)
    assert thesis.rates == Rates(first=1e-3, schedule="series", watches="train")
    assert thesis.patience == 10


def test_a_configuration_survives_json() -> None:
    for chosen in (config(), config(**CONV), load_config("window")):
        assert config_from(json.loads(json.dumps(chosen.to_json())), "again") == chosen


# --- windows ---


@pytest.mark.parametrize("features", [["raw"], ["raw", "spans", "attributes", "timing"]])
def test_windows_cut_for_a_batch_are_those_of_the_feature_set(features: list[str]) -> None:
    data = make_data(toy(takes=3), config(features=features, output_window=9))
    arrays, scaling = data.train, data.scaling
    whole = np.concatenate([data.features.windows(take.track, take.times) for take in arrays.takes])
    columns = data.features.window * data.features.frame_size
    whole[:, :columns] -= np.tile(scaling.input_mean, data.features.window)
    whole[:, :columns] /= np.tile(scaling.input_sd, data.features.window)
    chosen = torch.randperm(len(arrays))
    assert np.allclose(arrays.windows(chosen).numpy(), whole[chosen.numpy()], atol=1e-5)


def test_targets_past_the_ends_are_those_of_the_end_frames() -> None:
    data = make_data(toy(takes=2), config())
    controls, mask = data.train.reference(torch.tensor([0, len(data.train) - 1]), 1, 1)
    assert torch.equal(controls[0, 0], controls[0, 1])
    assert torch.equal(controls[1, 2], controls[1, 1])
    assert mask.all()


@pytest.mark.parametrize("changes", [{"batch": 32}, {"batch": 0}, CONV, CONV | {"batch": 0}])
def test_an_epoch_visits_every_frame(changes: dict[str, Any]) -> None:
    chosen = config(**changes)
    data = make_data(toy(takes=3), chosen)
    length = 20 if chosen.is_sequence else 1
    seen: set[int] = set()
    for batch in batches(data.train, chosen, np.random.default_rng(0)):
        for first in batch.tolist():
            take = np.searchsorted(data.train.starts, first, "right")
            assert first + length <= data.train.starts[take]
            seen.update(range(first, first + length))
    assert seen == set(range(len(data.train)))


# --- losses ---


def test_the_terms_of_the_loss_equal_their_formulas_in_numpy() -> None:
    random = np.random.default_rng(3)
    real, guess = random.normal(size=(2, 4, 6, 3)).astype(np.float32)
    mask = (random.random((4, 6)) > 0.3).astype(np.float32)
    squares, moves = [], []
    for n in range(4):
        for i in range(6):
            if mask[n, i]:
                squares.append(np.mean((real[n, i] - guess[n, i]) ** 2))
            if i < 5 and mask[n, i] and mask[n, i + 1]:
                y, z = real[n, i + 1] - real[n, i], guess[n, i + 1] - guess[n, i]
                moves.append(np.abs(y - z).sum())
    tensors = [torch.from_numpy(part) for part in (real, guess, mask)]
    assert squared_error(*tensors).item() == pytest.approx(np.mean(squares), rel=1e-5)
    assert motion_error(*tensors).item() == pytest.approx(np.mean(moves), rel=1e-5)


def test_the_l2_term_counts_all_weights_and_no_biases() -> None:
    network = make_network(config(), 10, 2)
    for part in network.parameters():
        torch.nn.init.constant_(part, 2.0)
    assert weight_norm(network).item() == pytest.approx(4 * (10 * 16 + 16 * 3 * 2))


def test_the_loss_is_the_weighted_sum_of_its_terms() -> None:
    network, random = make_network(config(), 10, 2), torch.Generator().manual_seed(1)
    real, guess = torch.rand(2, 5, 3, 2, generator=random)
    terms = (real, guess, torch.ones(5, 3))
    wanted = 2 * squared_error(*terms) + 3 * motion_error(*terms) + 0.5 * weight_norm(network)
    found = total_loss(Loss(squared=2, motion=3, l2=0.5), network, *terms)
    assert found.item() == pytest.approx(wanted.item())


def test_the_l2_term_keeps_weights_small() -> None:
    fits = [config(epochs=6), config(epochs=6, **{"loss.l2": 0.1})]
    data = make_data(toy(takes=3), fits[0])
    norms = [weight_norm(network_of(c, data, trained(c, data).members[0])) for c in fits]
    assert norms[1] < norms[0] / 2


# --- learning ---


def test_a_planted_linear_map_is_learnt_and_leaves_almost_no_error_on_the_test() -> None:
    chosen = config(
        epochs=60, **{"network.layers": [], "rates.schedule": "cosine", "rates.first": 0.02}
    )
    data = make_data(toy(takes=12), chosen)
    state = trained(chosen, data)
    assert data.test is not None
    figures = measure(
        data.controls,
        data.scaling.spread,
        data.test.takes,
        predict_takes(chosen, data, state.members, data.test),
    )
    assert figures["error"] < 1e-4
    assert figures["controls"]["shape1"]["r"] > 0.999


def test_convolutions_learn_the_same() -> None:
    chosen = config(**CONV, epochs=25, **{"network.dropout": [0.0], "rates.first": 0.02})
    data = make_data(toy(takes=6), chosen)
    assert min(epoch["error"] for epoch in trained(chosen, data).history) < 0.05


def test_frames_without_a_face_teach_nothing() -> None:
    corpus, chosen = toy(takes=3), config()
    lost = []
    for values in (0.0, 9.0):
        takes = []
        for take in corpus.of("train"):
            valid = np.arange(len(take.times)) % 40 > 9
            targets = np.where(valid[:, None], take.targets, values).astype(np.float32)
            takes.append(replace(take, valid=valid, targets=targets))
        splits = {**corpus.splits, "train": tuple(takes)}
        lost.append(bits(trained(chosen, make_data(replace(corpus, splits=splits), chosen))))
    assert lost[0] == lost[1]


def test_the_same_seed_gives_the_same_weights_and_another_seed_others() -> None:
    chosen = config(members=2)
    data = make_data(toy(takes=3), chosen)
    torch.manual_seed(5)
    first = trained(chosen, data)
    torch.manual_seed(6)
    assert bits(trained(chosen, data)) == bits(first)
    assert bits(trained(replace(chosen, seed=1), data)) != bits(first)
    one, other = first.members
    assert not torch.equal(one["layers.0.weight"], other["layers.0.weight"])


def test_training_leaves_torch_as_it_was() -> None:
    torch.manual_seed(5)
    wanted = torch.rand(3)
    torch.manual_seed(5)
    with deterministic():
        torch.rand(100)
    assert torch.equal(torch.rand(3), wanted)
    assert not torch.are_deterministic_algorithms_enabled()


@pytest.mark.parametrize("changes", [{}, CONV, {"members": 2}])
def test_training_that_stops_after_any_epoch_goes_on_to_the_same_weights(
    changes: dict[str, Any], tmp_path: Path
) -> None:
    from lipwright.train.run import fit_in

    class StopError(Exception):
        pass

    chosen = config(**changes, **{"optimizer.kind": "adamw", "rates.schedule": "series"})
    data = make_data(toy(takes=3), chosen)
    whole = fit_in(tmp_path, chosen, data)
    for after in range(len(whole.history)):
        folder = tmp_path / str(after)
        folder.mkdir()
        seen: list[Any] = []

        def stop(epoch: Any, after: int = after, seen: list[Any] = seen) -> None:
            seen.append(epoch)
            if len(seen) > after:
                raise StopError

        with pytest.raises(StopError):
            fit_in(folder, chosen, data, tell=stop)
        assert bits(fit_in(folder, chosen, data)) == bits(whole)


# --- rates and the end ---


def epochs_of(losses: list[float]) -> list[dict[str, Any]]:
    return [{"train": loss, "validation": loss} for loss in losses]


def test_the_rate_falls_along_the_series_of_the_thesis_whenever_the_loss_rises() -> None:
    series = Rates(first=1e-3, schedule="series")
    losses = [1.0]
    found = [rate_at(series, 9, epochs_of(losses))]
    for loss in (0.9, 0.95, 0.94, 0.96, 0.97, 0.98):
        losses.append(loss)
        found.append(rate_at(series, 9, epochs_of(losses)))
    assert found == pytest.approx([1e-3, 1e-3, 5e-4, 5e-4, 1e-4, 5e-5, 1e-5])


def test_other_schedules_stay_or_fall_to_zero() -> None:
    assert rate_at(Rates(first=0.3), 9, epochs_of([1, 2, 3])) == 0.3
    cosine = [rate_at(Rates(0.4, "cosine"), 4, epochs_of([1.0] * n)) for n in range(5)]
    assert cosine == pytest.approx([0.4, 0.3414213, 0.2, 0.0585786, 0.0])


def test_it_is_done_after_so_many_epochs_without_a_gain_or_at_the_last() -> None:
    chosen = config(patience=3, epochs=20)
    falling = [1.0, 0.8, 0.9, 0.9]
    assert not is_done(chosen, epochs_of(falling))
    assert is_done(chosen, epochs_of([*falling, 0.8]))
    assert not is_done(chosen, epochs_of([*falling, 0.7]))
    assert not is_done(replace(chosen, patience=None), epochs_of([*falling, 0.8]))
    assert is_done(chosen, epochs_of(list(np.linspace(1, 0, 20))))


def test_training_on_noise_stops_early_and_keeps_the_best_weights() -> None:
    chosen = config(epochs=200, patience=3, **{"network.dropout": [0.0]})
    data = make_data(toy(noise, takes=3), chosen)
    state = trained(chosen, data)
    losses = [epoch["validation"] for epoch in state.history]
    best = int(np.argmin(losses))
    assert len(losses) == best + 4 < 200
    network = network_of(chosen, data, state.members[0])
    guess = predict(network, data.validation)
    rows = data.validation.rows
    again = squared_error(
        data.validation.targets[rows][None], guess[None], torch.ones(1, len(rows))
    )
    assert again.item() == pytest.approx(losses[best], rel=1e-5)


# --- export ---


@pytest.mark.parametrize(
    "changes",
    [
        {"members": 2, "features": ["raw", "spans", "timing"]},
        {"scaling": "none", "network.activation": "leaky_relu", "network.init": "he"},
        {"network.layers": [], "scaling": "common"},
        CONV,
        CONV | {"members": 2},
    ],
)
def test_the_exported_graph_gives_what_torch_gives_for_features_as_they_come(
    changes: dict[str, Any], tmp_path: Path
) -> None:
    chosen = config(**changes)
    data = make_data(toy(takes=3), chosen)
    state = trained(chosen, data)
    facts = {"licence": "CC0", "data": "toy", "metrics": {}}
    write_model(tmp_path, chosen, data, state.members, facts)
    assert check_golden(tmp_path) < 1e-5
    network = load_network(tmp_path)
    take = data.validation.takes[1]
    wanted = predict_takes(chosen, data, state.members, data.validation)[1]
    if chosen.is_sequence:
        frames = data.features.frames(take.track, take.times)
        found = network.run(np.pad(frames, ((5, 5), (0, 0)), mode="edge")[None])[0]
    else:
        outputs = network.run(data.features.windows(take.track, take.times))
        found = averaged(outputs)
    assert np.abs(found - wanted).max() < 1e-5


def averaged(outputs: np.ndarray) -> np.ndarray:
    """Step 3 of Taylor et al. 2017, section 5, frame by frame."""
    count, width, _ = outputs.shape
    half = width // 2
    return np.stack([
        np.mean([outputs[n, t - n + half] for n in range(count) if abs(t - n) <= half], axis=0)
        for t in range(count)
    ])  # fmt: skip


# --- recordings ---


def test_targets_at_another_rate_are_between_those_around_and_lost_beside_lost_ones() -> None:
    take = toy(takes=2).of("train")[0]
    ramp = np.arange(len(take.times), dtype=np.float32)[:, None]
    valid = np.arange(len(take.times)) != 10
    finer = resampled(replace(take, targets=ramp, valid=valid), 50.0)
    assert len(finer.times) == 2 * len(take.times) - 1
    assert finer.targets[:19, 0] == pytest.approx(np.arange(19) / 2)
    assert np.flatnonzero(~finer.valid).tolist() == [19, 20, 21]


@pytest.fixture(scope="module")
def both(speakers: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recordings of both speakers: one each for training, validation and test."""
    place = tmp_path_factory.mktemp("training") / "both"
    assert run(["dataset", "merge", str(speakers / "anna"), str(speakers / "bert"),
                "-o", str(place)]) == 0  # fmt: skip
    assert run(["dataset", "split", str(place), "--test", "1", "--validation", "1"]) == 0
    return place


SMALL = {
    "name": "small", "features": ["raw", "spans"], "input_window": 5, "output_window": 3,
    "network": {"layers": [32], "dropout": [0.2]}, "optimizer": {"kind": "adam"},
    "rates": {"first": 0.01}, "batch": 10, "epochs": 3,
}  # fmt: skip


@pytest.fixture
def small(tmp_path: Path) -> Path:
    path = tmp_path / "small.json"
    path.write_text(json.dumps(SMALL))
    return path


def test_arkit_controls_are_those_of_the_lower_face_that_move(both: Path) -> None:
    corpus = read_corpus(open_dataset(both), config(targets="arkit"))
    assert "jawOpen" in corpus.controls
    assert not any(name.startswith(("eye", "brow")) for name in corpus.controls)
    named = config(targets="arkit", controls=["eyeBlinkLeft", "jawOpen"])
    assert read_corpus(open_dataset(both), named).controls == ("eyeBlinkLeft", "jawOpen")


def test_modes_count_standard_deviations_of_the_reference_face(
    speakers: Path, tmp_path: Path
) -> None:
    from lipwright.face.reference_file import load_reference_face

    place = tmp_path / "anna"
    shutil.copytree(speakers / "anna", place)
    assert run(["dataset", "split", str(place), "--test", "0", "--validation", "1"]) == 0
    dataset, face = open_dataset(place), speakers / "anna-face.npz"
    corpus = read_corpus(dataset, config(targets="joint"), face)
    take = corpus.of("train")[0]
    parameters = dataset.recording(take.name).face()
    assert parameters is not None
    wanted = parameters["joint"] / load_reference_face(face).sd("joint")
    columns = [int(name.removeprefix("joint")) - 1 for name in corpus.controls]
    assert np.allclose(take.targets[take.valid], wanted[:, columns][take.valid], atol=1e-5)


def test_the_command_writes_a_model_with_card_log_and_plot(
    both: Path, small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model"
    assert run(["train", str(both), "-c", str(small), "-o", str(out), "--licence", "CC0"]) == 0
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith("epoch 1: train ")
    assert said[-1].startswith(f"{out}: test error ")
    assert {path.name for path in out.iterdir()} == {
        "model.onnx", "meta.json", "golden.npz", "card.md", "training",
    }  # fmt: skip
    assert {path.name for path in (out / "training").iterdir()} == {
        "checkpoint.pt", "config.json", "log.jsonl", "losses.png",
    }  # fmt: skip
    assert not (tmp_path / "model.part").exists()
    network = load_network(out)
    assert (network.meta.licence, network.meta.target) == ("CC0", "arkit")
    assert network.meta.metrics["validation"]["controls"]["jawOpen"]["error"] > 0
    log = [json.loads(line) for line in (out / "training" / "log.jsonl").read_text().splitlines()]
    assert [epoch["epoch"] for epoch in log] == [1, 2, 3]
    card = (out / "card.md").read_text()
    assert "both: 1 recordings" in card
    assert "| test | 1 |" in card
    assert (out / "training" / "losses.png").read_bytes().startswith(b"\x89PNG")


def test_programs_are_told_of_each_epoch_as_json(
    both: Path, small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["train", str(both), "-c", str(small), "-o", str(tmp_path / "model")]
    assert run([*command, "--progress", "json", "--epochs", "2"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert [line["epoch"] for line in lines if "epoch" in line] == [1, 2]
    assert {line["stage"] for line in lines if "stage" in line} == {"read", "train", "export"}


def test_a_training_killed_in_the_middle_gives_the_same_model_by_the_same_command(
    both: Path, tmp_path: Path
) -> None:
    path = tmp_path / "wide.json"
    path.write_text(json.dumps({**SMALL, "network": {"layers": [300, 300]}, "epochs": 6,
                                "members": 2, "patience": None}))  # fmt: skip
    command = ["train", str(both), "-c", str(path), "--progress", "json"]
    assert run([*command, "-o", str(tmp_path / "whole")]) == 0
    again = [sys.executable, "-m", "lipwright", *command, "-o", str(tmp_path / "killed")]
    threads = {**os.environ, "OMP_NUM_THREADS": str(torch.get_num_threads())}
    with subprocess.Popen(again, stderr=subprocess.PIPE, text=True, env=threads) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if json.loads(line).get("epoch") == 3:
                os.kill(process.pid, signal.SIGKILL)
                break
    assert process.returncode == -signal.SIGKILL
    assert not (tmp_path / "killed").exists()
    assert run([*command, "-o", str(tmp_path / "killed")]) == 0
    model, other = (tmp_path / name / "model.onnx" for name in ("whole", "killed"))
    assert model.read_bytes() == other.read_bytes()
    states = [
        torch.load(tmp_path / name / "training" / "checkpoint.pt", weights_only=True)
        for name in ("whole", "killed")
    ]
    for one, two in zip(*(state["members"] for state in states), strict=True):
        assert all(torch.equal(one[key], two[key]) for key in one)
    epochs = [[(e["member"], e["epoch"], e["train"]) for e in s["history"]] for s in states]
    assert epochs[0] == epochs[1]


def test_a_finished_model_stays_unless_it_is_forced(
    both: Path, small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model"
    command = ["train", str(both), "-c", str(small), "-o", str(out), "--epochs", "1"]
    assert run(command) == 0
    before = (out / "model.onnx").read_bytes()
    capsys.readouterr()
    assert run([*command, "--seed", "4"]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line == f"lipwright: {out}: is a finished model; add --force to replace it"
    assert (out / "model.onnx").read_bytes() == before
    assert run([*command, "--seed", "4", "--force"]) == 0
    assert (out / "model.onnx").read_bytes() != before
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith("model")] == ["model"]


# --- search ---


def rows_of(out: Path) -> list[dict[str, str]]:
    with (out / "trials.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_grid_is_tried_point_by_point_and_listed_best_first(
    both: Path, small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "found"
    command = ["tune", str(both), "-c", str(small), "--epochs", "2", "-o", str(out),
               "--grid", "input_window=3,5", "--grid", "network.layers=[8],[8,8]"]  # fmt: skip
    assert run(command) == 0
    rows = rows_of(out)
    points = {(row["input_window"], row["network.layers"]) for row in rows}
    assert points == {("3", "[8]"), ("5", "[8]"), ("3", "[8, 8]"), ("5", "[8, 8]")}
    losses = [float(row["validation"]) for row in rows]
    assert losses == sorted(losses)
    assert (out / "trials.png").read_bytes().startswith(b"\x89PNG")
    capsys.readouterr()
    assert run(command) == 0  # nothing is left to try
    assert rows_of(out) == rows
    assert "4 trials; the best: " in capsys.readouterr().err


@pytest.mark.parametrize(
    "search", [["--grid", "seed=0,1,2"], ["--random", "3", "--range", "rates.first=1e-3:1e-1:log"]]
)
def test_a_search_that_stopped_goes_on_with_what_is_left(
    search: list[str], both: Path, small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from lipwright.cli import training

    class StopError(Exception):
        pass

    def stop(row: dict[str, Any], progress: str) -> None:
        raise StopError

    command = ["tune", str(both), "-c", str(small), "--epochs", "1", *search]
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert run([*command, "-o", str(whole)]) == 0
    with monkeypatch.context() as patched:
        patched.setattr(training, "_tell_trial", stop)
        assert run([*command, "-o", str(parts)]) == 1
    assert len(rows_of(parts)) == 1
    assert run([*command, "-o", str(parts)]) == 0
    times = [[{**row, "seconds": ""} for row in rows_of(out)] for out in (whole, parts)]
    assert times[0] == times[1]


def test_an_old_checkpoint_says_nothing_where_there_is_none(tmp_path: Path) -> None:
    assert load_checkpoint(tmp_path / "checkpoint.pt", {}, "") is None
