"""Squared error of models on held-out sentences: in parameters, vertices and pixels.

    python bench/error.py DATASET FACE.npz --models A B C
    python bench/error.py DATASET FACE.npz --models A B --split unseen

The errors of `lipwright.evaluate.errors`, as in figure 10 of Taylor et al. 2017, for models that
were taught the joint or the shape modes of a reference face, by themselves (`lipwright train
DATASET --targets joint`) or beside weights (`both`). `lipwright evaluate` measures more, and trains
what it measures; this is for models that are there, and for those of shape modes, which have no
pixels.

Each with its 95 % interval from a bootstrap over sentences, and what it is more than the first
model, where both see the same drawn sentences: as a share of the first's, of r as it is; p is of a
permutation test. Models that listen hear the recording's sound.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from lipwright.benchmark.motion import predict_recording, sound_of
from lipwright.clip import Clip
from lipwright.dataset.folder import open_dataset, sha256_of
from lipwright.dataset.recording import Recording
from lipwright.errors import LipwrightError
from lipwright.evaluate.errors import error_rows, load_truth
from lipwright.evaluate.intervals import compare, interval
from lipwright.evaluate.measures import MEASURES, Scores
from lipwright.face.reference_file import load_reference_face
from lipwright.files import write_whole
from lipwright.network import find_model
from lipwright.network.folder import read_meta

Figures = dict[str, dict[str, dict[str, float]]]


def predict(model: str | Path, recording: Recording) -> Clip:
    """What a model says of all frames of a recording, as curves of its own controls."""
    with sound_of(recording) as sound:
        return predict_recording(model, recording, sound)


def figures(found: Mapping[str, Scores]) -> Figures:
    """Model to measure to its figure, and to what it is more than the first model that has it."""
    rows: Figures = {model: {} for model in found}
    for name in MEASURES:
        having = {model: scores[name] for model, scores in found.items() if name in scores}
        for model, mine in having.items():
            whole = interval(mine)
            first = next(iter(having.values()))
            difference, low, high, p = compare(mine, first)
            unit = 1.0 if name == "face_r" else first.value
            rows[model][name] = {
                "mean": whole.value, "low": whole.low, "high": whole.high,
                "more": difference / unit, "more_low": low / unit, "more_high": high / unit, "p": p,
            }  # fmt: skip
    return rows


def table(rows: Figures) -> Iterator[str]:
    """Lines of a Markdown table."""
    yield "| model | measure | mean | 95 % | more than the first | 95 % | p |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for model, measures in rows.items():
        for name, row in measures.items():
            form = "+.3f" if name == "face_r" else "+.1%"
            more = f"{row['more']:{form}} | {row['more_low']:{form}} to {row['more_high']:{form}}"
            yield (f"| {model} | {name} | {row['mean']:.4g} | {row['low']:.4g} to {row['high']:.4g}"
                   f" | {more} | {row['p']:.4f} |")  # fmt: skip


def check_models(models: Sequence[str]) -> None:
    """Refuse models that were taught no modes.

    Raises:
        LipwrightError: one cannot be loaded, or was taught other targets.
    """
    for model in models:
        if read_meta(find_model(model)).target == "arkit":
            raise LipwrightError(
                f"{model}: was taught ARKit weights; train it with --targets joint, shape or both"
            )


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
    check_models(options.models)
    face_hash = sha256_of(options.face)
    recordings = [dataset.recording(name) for name in names]
    truths = [load_truth(recording, face_hash) for recording in recordings]
    found: dict[str, dict[str, Any]] = figures({
        model: error_rows(face, truths, [predict(model, each) for each in recordings])
        for model in options.models
    })  # fmt: skip
    print(f"{len(truths)} recordings ({options.split}), "
          f"{sum(len(t.times) for t in truths)} frames")  # fmt: skip
    print("\n".join(table(found)))
    if options.json:
        with write_whole(options.json) as part:
            part.write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
