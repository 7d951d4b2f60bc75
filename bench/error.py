"""Squared error of models on held-out sentences: in parameters, vertices and pixels.

    python bench/error.py DATASET FACE.npz --models A B C
    python bench/error.py DATASET FACE.npz --models A B --split unseen

As in figure 10 of Taylor et al. 2017, for models that were taught the joint or the shape modes of
a reference face (`lipwright train DATASET --targets joint`). Each model predicts the frames of each
recording at their times; errors are means over frames and over what a frame has:

- joint_sd, shape_sd: each parameter over its standard deviation, so that all modes weigh alike
- joint, shape: parameters as they are, grey levels and eye distances; the large modes weigh most
- vertices: squared distance of the 34 vertices from the tracked ones, eye distances
- inner, outer: grey levels (0 to 255) of the two regions, drawn from the predicted and from the
  recording's own parameters; inner only where the inner mouth is seen
- r: correlation of the lips' aperture, of predicted and tracked vertices, in speech

Each with its 95 % interval from a bootstrap over sentences, and as a ratio to the first model (of
r, the difference), where both see the same drawn sentences. A model of shape modes has no pixels.
Models that listen hear the recording's sound.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lipwright.audio import open_audio
from lipwright.clip import Clip, frame_times
from lipwright.dataset.folder import Dataset, open_dataset, sha256_of
from lipwright.dataset.recording import Recording
from lipwright.engines.window import FrameMean, predict
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import Aperture, correlation
from lipwright.face.appearance import LUMA
from lipwright.face.faceclip import clip_to_parameters, control_names
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.reference_file import load_reference_face
from lipwright.face.vertices import LANDMARKS, REGIONS, aperture
from lipwright.files import write_whole
from lipwright.network import Network, load_network
from lipwright.pipeline import ALIGNMENT_RATE

DRAWS = 2000  # of the bootstrap
INTERVAL = (2.5, 97.5)  # percentiles
MEASURES = ("joint_sd", "joint", "shape_sd", "shape", "vertices", "inner", "outer", "r")
OF_SHAPE = ("shape_sd", "shape", "vertices", "r")  # what a model of shape modes has

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Truth:
    """What a held-out recording is compared with, in the T frames that show a face."""

    recording: Recording
    valid: npt.NDArray[np.bool_]
    """(all frames,)"""
    parameters: FaceParameters
    """(T, ...)"""
    points: npt.NDArray[np.float32]
    """(T, 34, 2) tracked vertices, eye distances"""
    visible: npt.NDArray[np.bool_]
    """(T,) where the inner mouth is seen"""


def load_truth(dataset: Dataset, name: str, model: str) -> Truth:
    """A recording with its parameters of the reference face whose file has the hash `model`.

    Raises:
        LipwrightError: it has none, or those of another face.
    """
    recording = dataset.recording(name)
    face, landmarks = recording.face(), recording.motion.landmarks
    if face is None or landmarks is None:
        raise LipwrightError(f"{recording.folder}: has no parameters; run: lipwright face fit")
    if str(face["model"]) != model:
        raise LipwrightError(f"{recording.folder}: has the parameters of another reference face")
    valid = recording.valid & np.isfinite(face["joint"]).all(axis=1)
    return Truth(
        recording, valid,
        FaceParameters(face["shape"][valid], face["inner"][valid], face["outer"][valid]),
        landmarks[valid][:, LANDMARKS, :2], face["inner_visible"][valid],
    )  # fmt: skip


def predict_recording(network: Network, recording: Recording) -> Clip:
    """What the network says of all frames of a recording, as curves of modes."""
    meta, audio, heard = network.meta, recording.audio, None
    length = recording.times[-1] - recording.times[0]
    times = recording.times[0] + frame_times(length, meta.features.fps)  # its own clock
    if audio is not None and "sound" in meta.features.kinds:
        from lipwright.features.sound import sound_features

        with open_audio(audio, ALIGNMENT_RATE) as sound:
            heard = sound_features(sound, times)
    mean = FrameMean(meta.output_window, len(meta.controls))
    windows = predict(network, recording.track, times, slice(None), heard)
    own = Clip(meta.controls, meta.features.fps, np.concatenate([mean.add(windows), mean.end()]))
    return Clip(meta.controls, recording.motion.fps, own.at(recording.times - times[0]))


def squared_errors(face: ReferenceFace, truth: Truth, clip: Clip) -> dict[str, Floats]:
    """Measure to the error of each frame that it counts, (T,) or fewer.

    Args:
        face: the model of both.
        truth: the recording.
        clip: curves of modes, one value for each frame of the recording.
    """
    whole = clip.with_values(clip.values[truth.valid])
    made, real = clip_to_parameters(face, whole), truth.parameters
    apart = made.shape - real.shape
    distances = np.square(face.points(made.shape) - truth.points).sum(axis=-1)  # (T, 34)
    found = {
        "shape_sd": np.square(apart / face.shape_sd),
        "shape": np.square(apart),
        "vertices": distances,
    }
    if not is_shape_only(clip):
        joint = whole.select(control_names(face, "joint")).values  # over standard deviations
        apart = joint - face.join(real) / face.joint_sd
        found |= {"joint_sd": np.square(apart), "joint": np.square(apart * face.joint_sd)}
        for region in REGIONS:
            shown = truth.visible if region == "inner" else np.ones(len(made.shape), bool)
            found[region] = np.square(_grey(face, region, made[shown])
                                      - _grey(face, region, real[shown]))  # fmt: skip
    return {name: values.mean(axis=1, dtype=np.float64) for name, values in found.items()}


def _grey(
    face: ReferenceFace, region: str, parameters: FaceParameters
) -> npt.NDArray[np.float32]:  # fmt: skip
    """(T, P) grey levels of a region."""
    pixels = getattr(face, region).pixels(getattr(parameters, region))
    return np.asarray(np.clip(pixels, 0, 255) @ LUMA)


def is_shape_only(clip: Clip) -> bool:
    """Whether the curves say nothing of the appearance."""
    return all(name.startswith("shape") for name in clip.names)


def lips_r(face: ReferenceFace, truth: Truth, clip: Clip) -> float:
    """Correlation of the aperture in speech."""
    times = truth.recording.times[truth.valid]
    made = clip_to_parameters(face, clip.with_values(clip.values[truth.valid]))
    tracked, estimated = aperture(truth.points), aperture(face.points(made.shape))
    return correlation(Aperture(times, tracked), Aperture(times, estimated), truth.recording.track)


@dataclass(frozen=True, eq=False)
class Rows:
    """A measure of S sentences: sums over frames, and the frames."""

    sums: Floats
    """(S,)"""
    counts: Floats
    """(S,)"""

    def means(self, draws: npt.NDArray[np.intp]) -> Floats:
        """(B,) the mean over all frames of each draw (B, S) of sentences."""
        return self.sums[draws].sum(axis=1) / np.maximum(self.counts[draws].sum(axis=1), 1e-9)


def measure(face: ReferenceFace, truths: list[Truth], network: Network) -> dict[str, Rows]:
    """Measure to its rows over all recordings."""
    sums: dict[str, list[float]] = {}
    counts: dict[str, list[int]] = {}
    for truth in truths:
        clip = predict_recording(network, truth.recording)
        frames = squared_errors(face, truth, clip)
        frames["r"] = np.array([lips_r(face, truth, clip)])
        frames["r"] = frames["r"][np.isfinite(frames["r"])]
        for name, values in frames.items():
            sums.setdefault(name, []).append(float(values.sum()))
            counts.setdefault(name, []).append(len(values))
    return {name: Rows(np.array(sums[name]), np.array(counts[name], float)) for name in sums}


def bootstrap(rows: Rows, first: Rows, seed: int = 0) -> dict[str, float]:
    """Mean, and ratio and difference to the mean of `first`, each with its interval.

    Both see the same drawn sentences.
    """
    count = len(rows.sums)
    every = np.arange(count)[None]
    draws = np.random.default_rng(seed).integers(count, size=(DRAWS, count))
    found = {}
    mine, others = (one.means(np.concatenate([every, draws])) for one in (rows, first))
    for name, values in (
        ("", mine), ("ratio_", mine / others), ("difference_", mine - others)
    ):  # fmt: skip
        low, high = np.percentile(values[1:], INTERVAL)
        found |= {f"{name}mean": values[0], f"{name}low": low, f"{name}high": high}
    return {name: float(value) for name, value in found.items()}


def figures(found: dict[str, dict[str, Rows]]) -> dict[str, dict[str, dict[str, float]]]:
    """Model to measure to figures; ratios are to the first model that has the measure."""
    firsts = {name: next(rows[name] for rows in found.values() if name in rows)
              for name in MEASURES if any(name in rows for rows in found.values())}  # fmt: skip
    return {
        model: {name: bootstrap(rows[name], first) for name, first in firsts.items()
                if name in rows}
        for model, rows in found.items()
    }  # fmt: skip


def table(rows: dict[str, dict[str, dict[str, float]]]) -> Iterator[str]:
    """Lines of a Markdown table."""
    yield "| model | measure | mean | 95 % | against the first | 95 % |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for model, measures in rows.items():
        for name, row in measures.items():
            kind, form = ("difference", "+.3f") if name == "r" else ("ratio", ".3f")
            mean, low, high = (row[f"{kind}_{part}"] for part in ("mean", "low", "high"))
            yield (f"| {model} | {name} | {row['mean']:.4g} | {row['low']:.4g} to {row['high']:.4g}"
                   f" | {mean:{form}} | {low:{form}} to {high:{form}} |")  # fmt: skip


def load_models(names: list[str]) -> dict[str, Network]:
    """Name to network.

    Raises:
        LipwrightError: one cannot be loaded, or was taught other targets.
    """
    networks = {name: load_network(name) for name in names}
    for name, network in networks.items():
        if network.meta.target == "arkit":
            raise LipwrightError(
                f"{name}: was taught ARKit weights; train it with --targets joint or shape"
            )
    return networks


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("face", type=Path, help="the reference face, .npz")
    parser.add_argument("--models", nargs="+", required=True)
    parser.add_argument("--split", default="test")
    parser.add_argument("--first", type=int, help="only the first N recordings")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    dataset, face = open_dataset(options.dataset), load_reference_face(options.face)
    names = dataset.names(options.split)[: options.first]
    if not names:
        raise SystemExit(f"{options.dataset}: no recordings in the split {options.split!r}")
    networks = load_models(options.models)
    face_hash = sha256_of(options.face)
    truths = [load_truth(dataset, name, face_hash) for name in names]
    found: dict[str, dict[str, Any]] = figures(
        {name: measure(face, truths, network) for name, network in networks.items()}
    )
    print(f"{len(truths)} recordings ({options.split}), "
          f"{sum(int(t.valid.sum()) for t in truths)} frames")  # fmt: skip
    print("\n".join(table(found)))
    if options.json:
        with write_whole(options.json) as part:
            part.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
