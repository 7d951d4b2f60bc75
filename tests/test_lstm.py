"""The lstm engine: its network, its training, what it remembers, and what it refuses."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest

from lipwright.cli import run
from lipwright.clip import frame_times
from lipwright.controls import CANONICAL
from lipwright.engines import lstm, window
from lipwright.engines.window import CHUNK_FRAMES
from lipwright.errors import LipwrightError
from lipwright.network import Network, check_golden, load_network
from lipwright.track import PhoneTrack
from planted import change_meta, middle_frame, rehash

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")

from lipwright.train.batches import batches, examples, parts_of  # noqa: E402  # needs torch
from lipwright.train.checkpoint import Checkpoint  # noqa: E402
from lipwright.train.config import Config, MisfitError  # noqa: E402
from lipwright.train.config import Network as Shape  # noqa: E402
from lipwright.train.config_file import config_from, load_config  # noqa: E402
from lipwright.train.data import Data, make_data  # noqa: E402
from lipwright.train.export import write_model  # noqa: E402
from lipwright.train.loop import network_of, predict  # noqa: E402
from lipwright.train.losses import squared_error  # noqa: E402
from lipwright.train.measures import predict_takes  # noqa: E402
from lipwright.train.networks import Recurrent, make_network  # noqa: E402
from lipwright.train.run import fit_in  # noqa: E402
from lipwright.train.takes import Corpus, Take  # noqa: E402
from test_training import bits, config, noise, toy, trained  # noqa: E402

pytestmark = pytest.mark.usefixtures("one_torch_thread")

RECURRENT: dict[str, Any] = {
    "network.kind": "recurrent", "network.layers": [12, 16, 8], "input_window": 1,
    "output_window": 1, "batch": 3, "features": ["raw", "timing"],
}  # fmt: skip
FACTS: dict[str, Any] = {"licence": "CC0", "data": "toy", "metrics": {}}
FAR = 0.4  # s, 10 frames, from a mark to what it decides: no window of 11 frames sees both


def recurrent(**changes: Any) -> Config:
    return config(**{**RECURRENT, **changes})


def uneven(corpus: Corpus) -> Corpus:
    """The same recordings, each of another length."""
    splits = {
        split: tuple(
            replace(t, times=t.times[:n], targets=t.targets[:n], valid=t.valid[:n])
            for t, n in zip(takes, range(len(takes[0].times), 0, -37), strict=False)
        )
        for split, takes in corpus.splits.items()
    }
    return replace(corpus, splits=splits)


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Config, Data, Checkpoint]:
    """An exported network of arkit weights, after a few epochs."""
    folder = tmp_path_factory.mktemp("fitted")
    chosen = recurrent(targets="arkit", epochs=4, members=2)
    corpus = replace(toy(takes=4), controls=CANONICAL[:5])
    data = make_data(corpus, chosen)
    state = trained(chosen, data)
    write_model(folder, chosen, data, state.members, FACTS)
    return folder, chosen, data, state


@pytest.fixture
def folder(fitted: tuple[Path, Any, Any, Any]) -> Path:
    return fitted[0]


# --- configurations ---


def test_lstm_is_the_configuration_of_taylor_2017_section_8_1() -> None:
    chosen = load_config("lstm")
    assert isinstance(chosen, Config)
    assert chosen.network.layers == (500, 500, 500)
    assert chosen.network.drops == (0.5, 0.5, 0.5)
    assert (chosen.network.kind, chosen.batch) == ("recurrent", 10)
    network = make_network(chosen, 10, 2)
    assert isinstance(network, Recurrent)
    lstms = [part for part in network.modules() if isinstance(part, torch.nn.LSTM)]
    assert [part.hidden_size for part in lstms] == [250] * 4
    assert config_from(json.loads(json.dumps(chosen.to_json())), "again") == chosen


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layers": (8,)}, "2 or more, the first dense"),
        ({"layers": (8, 7)}, "of LSTMs are even"),
        ({"layers": (8, 8), "kernels": (3, 3)}, "are for networks of the kind 'conv'"),
    ],
)
def test_shapes_that_cannot_be_are_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(MisfitError, match=said):
        Shape(kind="recurrent", **changes)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"input_window": 3}, "must be 1"),
        ({"output_window": 3}, "'output_window' of a recurrent network is 1"),
        ({"features": ["raw", "spans"]}, "of a recurrent network have no 'spans'"),
        ({"features": ["raw", "sound"], "augment": {"deaf": 0.1}}, "'augment' needs a conv"),
    ],
)
def test_configurations_that_cannot_be_are_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(LipwrightError, match=said):
        recurrent(**changes)


# --- the network ---


def by_hand(network: Recurrent, frames: np.ndarray) -> np.ndarray:
    """The equations of Hochreiter and Schmidhuber with forget gates, one frame after another."""

    def sigmoid(x: np.ndarray) -> np.ndarray:
        return 1 / (1 + np.exp(-x))

    def one_way(part: torch.nn.LSTM, given: np.ndarray) -> np.ndarray:
        names = ("weight_ih_l0", "weight_hh_l0", "bias_ih_l0", "bias_hh_l0")
        w, r, *biases = [getattr(part, name).detach().double().numpy() for name in names]
        state = cell = np.zeros(part.hidden_size)
        found = []
        for frame in given:
            i, f, g, o = np.split(w @ frame + r @ state + sum(biases), 4)
            cell = sigmoid(f) * cell + sigmoid(i) * np.tanh(g)
            state = sigmoid(o) * np.tanh(cell)
            found.append(state)
        return np.array(found)

    def linear(part: torch.nn.Linear, given: np.ndarray) -> np.ndarray:
        weight, bias = (values.detach().double().numpy() for values in (part.weight, part.bias))
        return given @ weight.T + bias

    dense, *layers, last = [part for part in network.layers if list(part.parameters())]
    value = np.tanh(linear(dense, frames))
    for layer in layers:
        before, after = one_way(layer.ahead, value), one_way(layer.back, value[::-1])[::-1]
        value = np.concatenate([before, after], axis=1)
    return linear(last, value)


def test_the_network_is_the_equations_of_the_papers() -> None:
    torch.manual_seed(1)
    network = make_network(recurrent(), 6, 3).eval()
    assert isinstance(network, Recurrent)
    frames = np.random.default_rng(0).normal(size=(40, 6))
    with torch.no_grad():
        found = network(torch.from_numpy(frames[None].astype(np.float32)))[0].numpy()
        np.testing.assert_allclose(found, by_hand(network, frames), atol=1e-5)


def test_padding_changes_nothing_of_what_it_pads() -> None:
    torch.manual_seed(2)
    network = make_network(recurrent(), 6, 3).eval()
    frames, lengths = torch.randn(3, 20, 6), torch.tensor([20, 7, 1])
    with torch.no_grad():
        padded = network(frames, lengths)
        for row, length in enumerate(lengths.tolist()):
            alone = network(frames[row : row + 1, :length])[0]
            assert torch.allclose(padded[row, :length], alone, atol=1e-6)


def test_its_first_memory_is_kept_and_its_first_recurrence_turns() -> None:
    network = make_network(recurrent(), 6, 3)
    part = next(part for part in network.modules() if isinstance(part, torch.nn.LSTM))
    assert part.bias_ih_l0.view(4, -1).sum(dim=1).tolist() == [0, part.hidden_size, 0, 0]
    kept = part.weight_hh_l0.detach()
    assert torch.allclose(kept.T @ kept, torch.eye(part.hidden_size), atol=1e-5)


# --- batches ---


@pytest.mark.parametrize("longest", [500, 40])
def test_an_epoch_sees_each_frame_once_and_pads_with_what_counts_for_nothing(
    longest: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("lipwright.train.batches.LONGEST", longest)
    chosen = recurrent()
    data = make_data(uneven(toy(takes=4)), chosen)
    arrays, seen, scores = data.train, 0, 0.0
    for chosen_frames in batches(arrays, chosen, np.random.default_rng(0)):
        given = examples(arrays, chosen_frames, chosen, np.random.default_rng(0))
        inputs, lengths = given.inputs
        assert inputs.shape[1] == lengths.max() <= longest
        assert given.mask.sum(dim=1).tolist() == lengths.tolist()
        seen += int(given.mask.sum())
        scores += float((given.reference[:, :, 0] * given.mask).sum())
    assert seen == len(arrays)
    assert scores == pytest.approx(float(arrays.targets[arrays.rows][:, 0].sum()), abs=1e-3)
    parts = parts_of(arrays)
    assert set(arrays.starts) <= set(parts.tolist())
    assert (len(parts) == len(arrays.starts)) == (longest == 500)


def test_a_batch_of_uneven_recordings_has_the_loss_that_each_has_alone() -> None:
    chosen = recurrent(**{"network.dropout": [0.0]})
    data = make_data(uneven(toy(takes=3)), chosen)
    network = network_of(chosen, data).eval()
    starts = torch.tensor(data.train.starts[:-1])
    given = examples(data.train, starts, chosen, np.random.default_rng(0))
    with torch.no_grad():
        whole = squared_error(given.reference, network(*given.inputs), given.mask)
    alone = predict(network, data.train) - data.train.targets[data.train.rows]
    assert whole.item() == pytest.approx(alone.square().mean().item(), rel=1e-5)


# --- training ---


def test_it_fits_what_it_was_trained_on() -> None:
    """Noise follows from nothing: it can only be learnt by heart."""
    chosen = recurrent(
        epochs=100, patience=None,
        **{"network.layers": [16, 48, 48], "network.dropout": [0.0], "rates.first": 0.02,
           "rates.schedule": "one_cycle", "optimizer.longest": 1.0},
    )  # fmt: skip
    corpus = toy(noise, takes=2, seconds=2.0)
    splits = {**corpus.splits, "validation": corpus.of("train")}
    data = make_data(replace(corpus, splits=splits), chosen)
    assert trained(chosen, data).history[-1]["error"] < 0.02


def far_marks(takes: int) -> Corpus:
    """Recordings in which AA opens as the mark `FAR` before it says, and rounds as that after."""
    random = np.random.default_rng(11)
    made = []
    for number in range(takes + 8):
        marks = [str(mark) for mark in random.choice(["B", "M"], 2)]
        phones = ("sil", marks[0], "S", "AA", "S", marks[1], "sil")
        edges = np.cumsum([0.0, 0.1, 0.12, FAR, random.uniform(0.1, 0.3), FAR, 0.12, 0.1])
        times = np.arange(int(edges[-1] * 25)) / 25 + 0.02
        opens = np.array(phones)[np.searchsorted(edges[1:-1], times, "right")] == "AA"
        targets = np.stack([opens * (mark == "M") for mark in marks], axis=1).astype(np.float32)
        valid = np.ones(len(times), bool)
        made.append(Take(f"t{number}", times, targets, valid, PhoneTrack(phones, edges)))
    splits = {"train": tuple(made[8:]), "validation": tuple(made[:4]), "test": tuple(made[4:8])}
    return Corpus(splits, ("shape1", "shape2"), 25.0, "marks", "CC0", Path("marks"))


def error_of(chosen: Config, corpus: Corpus) -> float:
    """The mean squared error on the test, in variances."""
    data = make_data(corpus, chosen)
    state = trained(chosen, data)
    assert data.test is not None
    found = np.concatenate(predict_takes(chosen, data, state.members, data.test))
    real = np.concatenate([take.targets for take in data.test.takes])
    return float((np.square(found - real) / np.square(data.scaling.spread)).mean())


def test_it_remembers_a_phone_for_longer_than_a_window_sees() -> None:
    corpus = far_marks(48)
    memory = recurrent(
        features=["raw"], batch=5, epochs=18, patience=None,
        **{"network.layers": [8, 32, 32], "network.dropout": [0.0], "rates.first": 0.02,
           "rates.schedule": "one_cycle", "optimizer.longest": 1.0},
    )  # fmt: skip
    sliding = config(features=["raw"], input_window=11, output_window=1, epochs=10)
    assert error_of(memory, corpus) < 0.02
    assert error_of(sliding, corpus) > 0.3  # AA opens and rounds by half, whatever the marks


def test_the_same_seed_gives_the_same_weights_and_another_seed_others() -> None:
    chosen = recurrent()
    data = make_data(uneven(toy(takes=4)), chosen)
    torch.manual_seed(5)
    first = trained(chosen, data)
    torch.manual_seed(6)
    assert bits(trained(chosen, data)) == bits(first)
    assert bits(trained(replace(chosen, seed=1), data)) != bits(first)


def test_training_that_stops_goes_on_to_the_same_weights(tmp_path: Path) -> None:
    class StopError(Exception):
        pass

    def stop(epoch: Any) -> None:
        raise StopError

    chosen = recurrent(average=0.1, **{"rates.schedule": "one_cycle"})
    data = make_data(uneven(toy(takes=4)), chosen)
    (tmp_path / "whole").mkdir()
    whole = fit_in(tmp_path / "whole", chosen, data)
    for _ in range(chosen.epochs):
        with pytest.raises(StopError):
            fit_in(tmp_path, chosen, data, tell=stop)
    assert bits(fit_in(tmp_path, chosen, data)) == bits(whole)


def test_tune_varies_it(speakers: Path, tmp_path: Path) -> None:
    both = tmp_path / "both"
    parts = [str(speakers / name) for name in ("anna", "bert")]
    assert run(["dataset", "merge", *parts, "-o", str(both)]) == 0
    assert run(["dataset", "split", str(both), "--test", "1", "--validation", "1"]) == 0
    (tmp_path / "small.json").write_text(json.dumps(recurrent(targets="arkit", epochs=1).to_json()))
    varied = ["--grid", "network.layers=[8,8],[8,16,8]", "-o", str(tmp_path / "search")]
    assert run(["tune", str(both), "--config", str(tmp_path / "small.json"), *varied]) == 0
    assert len((tmp_path / "search" / "trials.csv").read_text().splitlines()) == 3


# --- export ---


def test_the_exported_graph_gives_what_torch_gives(
    fitted: tuple[Path, Config, Data, Checkpoint],
) -> None:
    folder, chosen, data, state = fitted
    assert check_golden(folder) < 1e-5
    network, take = load_network(folder), data.validation.takes[1]
    assert (network.meta.kind, network.meta.engine) == ("recurrent", "lstm")
    wanted = predict_takes(chosen, data, state.members, data.validation)[1]
    found = network.run(data.features.frames(take.track, take.times)[None])[0]
    assert np.abs(found - wanted).max() < 1e-5
    assert np.abs(lstm.predict_at(network, take.track, take.times) - wanted).max() < 1e-5


def copy_of(folder: Path, place: Path) -> Path:
    place.mkdir()
    for name in ("model.onnx", "golden.npz", "meta.json"):
        (place / name).write_bytes((folder / name).read_bytes())
    return place


def test_damaged_models_are_refused_in_a_line(folder: Path, tmp_path: Path) -> None:
    cut = copy_of(folder, tmp_path / "cut")
    (cut / "model.onnx").write_bytes((cut / "model.onnx").read_bytes()[:-100])
    with pytest.raises(LipwrightError, match="cut off, changed"):
        lstm.open_network(cut)
    rehash(cut)
    with pytest.raises(LipwrightError, match=r"model\.onnx: "):
        lstm.open_network(cut)


def test_a_recurrent_model_that_sees_windows_is_refused(folder: Path, tmp_path: Path) -> None:
    wide = copy_of(folder, tmp_path / "wide")
    features = json.loads((wide / "meta.json").read_text())["features"]
    change_meta(wide, features={**features, "window": 3})
    with pytest.raises(LipwrightError, match="recurrent network see 3 frames"):
        lstm.open_network(wide)


def test_a_graph_of_other_ports_is_refused(folder: Path, tmp_path: Path) -> None:
    other = copy_of(folder, tmp_path / "other")
    model = onnx.load(str(other / "model.onnx"))
    model.graph.input[0].type.tensor_type.shape.dim[2].dim_value += 1
    (other / "model.onnx").write_bytes(model.SerializeToString())
    rehash(other)
    with pytest.raises(LipwrightError, match=r"model\.onnx: "):
        lstm.open_network(other)


def test_a_model_of_another_engine_is_refused_both_ways(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="window"):
        lstm.open_network(middle_frame(tmp_path / "windows"))
    with pytest.raises(LipwrightError, match="lstm"):
        window.open_network(folder)


def test_without_a_model_it_says_how_to_train_one() -> None:
    with pytest.raises(LipwrightError, match="lipwright train DATASET --config lstm"):
        lstm.animate(PhoneTrack(("AA",), np.array([0.0, 1.0])), 25)


# --- the engine ---


def said(phones: str, each: float) -> PhoneTrack:
    names = tuple(phones.split())
    return PhoneTrack(names, np.arange(len(names) + 1) * each)


@pytest.mark.parametrize(
    "track",
    [said("AA", 1.0), said("sil", 1.0), said("AA", 0.004), said("AA B S " * 30, 0.01),
     said("sil TH ZH OY sil", 0.12)],
)  # fmt: skip
@pytest.mark.parametrize("fps", [0.1, 24, 25, 60, 1000])
def test_any_track_at_any_rate_is_animated(track: PhoneTrack, fps: float, folder: Path) -> None:
    clip = lstm.animate(track, fps, model=folder)
    assert clip.names == CANONICAL
    assert len(clip) == len(frame_times(track.end, fps))
    assert np.isfinite(clip.values).all()


def test_frames_of_its_own_rate_are_the_predictions(folder: Path) -> None:
    track, network = said("sil AA B S UW M sil", 0.21), load_network(folder)
    clip = lstm.animate(track, 25, model=network)
    frames = lstm.predict_at(network, track, frame_times(track.end, 25))
    assert clip.select(network.meta.controls).values.tobytes() == frames.tobytes()


def test_long_speech_in_parts_is_what_the_whole_gives(folder: Path) -> None:
    random = np.random.default_rng(4)
    track = said(" ".join(random.choice(["sil", "AA", "B", "S", "UW", "M"], 1500)), 0.11)
    network = load_network(folder)
    times = frame_times(track.end, 25)
    assert len(times) > 4 * CHUNK_FRAMES
    whole = network.run(network.meta.features.frames(track, times)[None])[0]
    assert np.abs(lstm.predict_at(network, track, times) - whole).max() < 1e-4


def test_no_run_is_longer_than_a_part(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    run_whole = Network.run

    def watch(self: Network, features: np.ndarray) -> np.ndarray:
        seen.append(features.shape[1])
        return run_whole(self, features)

    network = load_network(folder)
    monkeypatch.setattr(Network, "run", watch)
    lstm.animate(said("AA sil " * 500, 0.2), 60, model=network)
    assert max(seen) <= CHUNK_FRAMES + 2 * round(lstm.CONTEXT * 25)
    assert len(seen) == -(-len(frame_times(200.0, 25)) // CHUNK_FRAMES)
