"""The parts of the benchmarks that measure, against planted answers."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from lipwright.audio import Audio
from lipwright.clip import Clip

ROOT = Path(__file__).resolve().parents[1]
GRID = ROOT.parent / "shared" / "corpora" / "grid-s1"
RATE = 16000
PITCH, FORMANTS = 120.0, (560.0, 1480.0, 2520.0)

needs_grid = pytest.mark.skipif(
    not GRID.is_dir(), reason="the GRID recordings are not beside the checkout"
)
needs_world = pytest.mark.skipif(
    importlib.util.find_spec("pyworld") is None, reason="the vocoder WORLD is not installed"
)


@pytest.fixture(scope="module", autouse=True)
def on_path() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "bench"))
        yield


def bench(name: str) -> ModuleType:
    return importlib.import_module(name)


# --- voices ---


def vowel(seconds: float = 0.8) -> Audio:
    """Pulses at PITCH through resonances at FORMANTS."""
    from scipy.signal import lfilter

    signal = np.zeros(round(seconds * RATE))
    signal[np.round(np.arange(0, len(signal) - 1, RATE / PITCH)).astype(int)] = 1
    for formant in FORMANTS:
        radius = np.exp(-np.pi * 60 / RATE)
        signal = lfilter([1], [1, -2 * radius * np.cos(2 * np.pi * formant / RATE), radius**2],
                         signal)  # fmt: skip
    return Audio((0.5 * signal / np.abs(signal).max()).astype(np.float32), RATE)


def pitch_of(audio: Audio) -> float:
    """Hz, by the highest peak of the autocorrelation between 60 and 500 Hz."""
    middle = audio.samples[len(audio) // 4 : -len(audio) // 4].astype(float)
    correlation = np.correlate(middle, middle, "full")[len(middle) - 1 :]
    low, high = RATE // 500, RATE // 60
    # Of the multiples of the period, which are as high, the first.
    best = correlation[low:high].max()
    peaks = [lag for lag in range(low, high) if correlation[lag] > 0.9 * best
             and correlation[lag] == correlation[lag - 2 : lag + 3].max()]  # fmt: skip
    return RATE / peaks[0]


def formants_of(audio: Audio, count: int = 3) -> list[float]:
    """Hz, by linear prediction: the sharpest resonances."""
    from scipy.linalg import solve_toeplitz

    middle = audio.samples[len(audio) // 4 : -len(audio) // 4].astype(float)
    middle = np.append(middle[0], middle[1:] - 0.5 * middle[:-1]) * np.hanning(len(middle))
    order = 2 * count + 4
    correlation = np.correlate(middle, middle, "full")[len(middle) - 1 :][: order + 1]
    predictor = solve_toeplitz(correlation[:-1] * (1 + 1e-6 * (np.arange(order) == 0)),
                               correlation[1:])  # fmt: skip
    roots = np.roots(np.append(1, -predictor))
    roots = roots[roots.imag > 0]
    sharp = sorted(roots, key=lambda root: -abs(root))[:count]
    return sorted(float(np.angle(root) * RATE / (2 * np.pi)) for root in sharp)


@needs_world
@pytest.mark.parametrize(("pitch", "formants"), [(0.8, 0.92), (1.0, 1.0), (1.5, 1.12), (1.9, 1.22)])
def test_a_vowel_in_another_voice_has_its_pitch_and_formants(pitch: float, formants: float) -> None:
    made = bench("voices").shift(vowel(), pitch, formants)
    assert pitch_of(vowel()) == pytest.approx(PITCH, rel=0.01)
    assert formants_of(vowel()) == pytest.approx(FORMANTS, rel=0.03)
    assert pitch_of(made) == pytest.approx(PITCH * pitch, rel=0.02)
    wanted = [formants * formant for formant in FORMANTS]
    # Harmonics of a high voice are far apart, and pull what is measured towards them.
    assert formants_of(made) == pytest.approx(wanted, rel=0.06)


@needs_world
def test_another_voice_keeps_time_and_does_not_clip() -> None:
    silence = np.zeros(RATE // 2, np.float32)
    spoken = Audio(np.concatenate([silence, 1.9 * vowel(0.5).samples, silence[:-7]]), RATE)
    made = bench("voices").shift(spoken, 1.5, 1.12)
    assert len(made) == len(spoken)
    assert np.abs(made.samples).max() <= 0.99
    loud = np.flatnonzero(np.abs(made.samples) > 0.05) / RATE
    assert loud.min() == pytest.approx(0.5, abs=0.02)
    assert loud.max() == pytest.approx(1.0, abs=0.03)


@needs_grid
def test_the_half_for_voices_is_half_of_the_train_split_and_none_of_the_others() -> None:
    pytest.importorskip("mediapipe", reason="the face tracker is not installed")
    sentences = bench("grid").sentences
    half = [sentence.name for sentence in bench("voices").half()]
    train = {sentence.name for sentence in sentences("train")}
    assert len(set(half)) == len(half) == len(train) // 2
    assert set(half) <= train


# --- phones ---


def test_the_chart_shows_each_phone_in_itself() -> None:
    from lipwright.phones import PHONES

    tiles = bench("phones_chart").tiles()
    assert {tile.phone for tile in tiles} == set(PHONES)
    for tile in tiles:
        spans = [(start, end) for phone, start, end in tile.track if phone == tile.phone]
        assert any(start < tile.time < end for start, end in spans)


@pytest.mark.parametrize(
    ("phone", "share", "oddities"),
    [
        ("M", 0.05, []),
        ("M", 0.3, ["M does not close"]),
        ("AA", 0.05, ["AA stays shut"]),
        ("AA", 0.5, []),
        ("S", 0.01, ["S is shut"]),
        ("F", 0.01, []),
        ("S", 0.2, []),
    ],
)
def test_an_aperture_that_a_phone_cannot_have_is_odd(
    phone: str, share: float, oddities: list[str]
) -> None:
    times = np.arange(0, 1, 1 / 60)
    inside = (times > 0.3) & (times < 0.7)
    curve = np.where(inside, share, 0.6 if phone == "M" else 0.0)
    assert bench("phones_chart").judge_phone(phone, 0.36, 0.64, times, curve) == oddities


def test_a_jump_is_odd_and_named() -> None:
    values = np.zeros((60, 2), np.float32)
    values[30:, 1] = 1
    clip = Clip(("jawOpen", "mouthFunnel"), 60, values)
    pair = bench("phones_chart").judge("S", "T", np.array([0.4, 0.5, 0.6]), clip, np.full(60, 0.5))
    assert pair.oddities == "mouthFunnel jumps"
    assert pair.speed == pytest.approx(60)


# --- errors ---


def test_models_are_compared_with_the_first_on_the_same_sentences() -> None:
    from lipwright.evaluate.measures import Rows

    error = bench("error")
    rng = np.random.default_rng(3)
    rows = Rows(rng.gamma(4, 1, 40) * 75, np.full(40, 75.0))
    found = error.figures({
        "first": {"joint": rows, "face_r": rows},
        "second": {"joint": Rows(0.9 * rows.sums, rows.counts), "face_r": rows},
    })  # fmt: skip
    mine, second = found["first"]["joint"], found["second"]["joint"]
    assert mine["low"] < mine["mean"] < mine["high"]
    # The same sentences are hard for both, so that the difference is surer than the means.
    assert second["more"] == pytest.approx(-0.1)
    assert mine["low"] / mine["mean"] == pytest.approx(-10 * second["more_high"])
    assert (found["second"]["face_r"]["more"], found["second"]["face_r"]["p"]) == (0, 1)
    assert len(list(error.table(found))) == 2 + 4


@pytest.fixture(scope="module")
def held(speakers: Path) -> tuple[ModuleType, Any, Any]:
    """bench/window_sweep.py, a reference face with a recording, and the recording's truth."""
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    from lipwright.dataset.folder import open_dataset, sha256_of
    from lipwright.evaluate.errors import load_truth
    from lipwright.face.reference_file import load_reference_face

    path = speakers / "anna-face.npz"
    recording = open_dataset(speakers / "anna").recording("anna1")
    truth = load_truth(recording, sha256_of(path))
    sweep = bench("window_sweep")
    face = load_reference_face(path)
    return sweep, sweep.Held(face, {"test": [truth]}, {"test": [recording]}), truth


@pytest.mark.parametrize("targets", ["shape", "joint"])
def test_the_sweep_s_error_is_that_of_its_targets(
    held: tuple[ModuleType, Any, Any], targets: str
) -> None:
    from lipwright.face.faceclip import control_names

    sweep, judged, truth = held
    face, real = judged.face, truth.parameters
    sd = face.sd(targets)
    values = np.zeros((len(truth.valid), len(sd)), np.float32)
    values[truth.valid] = (face.join(real) if targets == "joint" else real.shape) / sd
    values[:, 0] += 2
    clip = Clip(control_names(face, targets), 25, values)
    found = sweep.error_of(judged, "test", [clip], targets)
    assert found[f"{targets}_sd"] == pytest.approx(4 / len(sd), rel=1e-3)
    assert found[targets] == pytest.approx(4 * sd[0] ** 2 / len(sd), rel=1e-3)


# --- the window sweep ---


def test_rows_of_the_sweep_come_back_as_they_were_written(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    rows = bench("sweep_rows")
    made = [
        rows.Row(features, kx, ky, "seed 0", 0.1 / kx, 0.9, 0.2 / kx, 1 / (kx + ky), 0.7, 3.5)
        for features in ("raw", "linguistic") for kx in (1, 3) for ky in (1, 5)
    ]  # fmt: skip
    rows.write_rows(tmp_path / "sweep.csv", made)
    assert rows.read_rows(tmp_path / "sweep.csv") == made
    assert rows.read_rows(tmp_path / "none.csv") == []
    assert list(rows.grid_table(made, "raw"))[2:] == [
        "| 1 | 0.5000 | 0.1667 |",
        "| 3 | 0.2500 | **0.1250** |",
    ]
    rows.draw(tmp_path / "sweep.png", made)
    assert (tmp_path / "sweep.png").stat().st_size > 10_000


# --- speed ---


def test_a_network_s_work_is_two_operations_for_each_weight(tmp_path: Path) -> None:
    onnx = pytest.importorskip("onnx", reason="onnx is not installed")
    from onnx import TensorProto, helper, numpy_helper

    def weight(name: str, *shape: int) -> Any:
        return numpy_helper.from_array(np.zeros(shape, np.float32), name)

    graph = helper.make_graph(
        [
            helper.make_node("Conv", ["x", "k", "b"], ["y"]),
            helper.make_node("Gemm", ["y", "w", "c"], ["z"]),
            helper.make_node("Tanh", ["z"], ["t"]),
        ],
        "work",
        [helper.make_tensor_value_info("x", TensorProto.FLOAT, None)],
        [helper.make_tensor_value_info("t", TensorProto.FLOAT, None)],
        [weight("k", 8, 4, 3), weight("b", 8), weight("w", 8, 5), weight("c", 5)],
    )
    onnx.save(helper.make_model(graph), str(tmp_path / "model.onnx"))
    assert bench("network_speed").work_of(tmp_path / "model.onnx") == 2 * (8 * 4 * 3 + 8 * 5)
