"""Squared error of the learnt engines after fewer recordings: what the order of figure 10 rests on.

    python bench/learning_curves.py DATASET FACE.npz -o FOLDER
    python bench/learning_curves.py DATASET FACE.npz -o FOLDER --counts 50 200 --engines hmm trees

Each engine is trained as the benchmark trains it, on the first N recordings for training (by the
order of the split), and measured on the test recordings against the reference face. Models are
kept in FOLDER; the same command goes on where it was stopped.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from lipwright.benchmark.entrants import USUAL
from lipwright.benchmark.motion import Performer
from lipwright.benchmark.options import BenchmarkOptions
from lipwright.benchmark.scoring import make_bridge
from lipwright.benchmark.training import train_model
from lipwright.benchmark.variants import Variant
from lipwright.dataset.folder import Dataset, open_dataset, sha256_of
from lipwright.dataset.splits import TRAIN, split_order
from lipwright.evaluate.errors import error_rows, load_truth
from lipwright.evaluate.measures import Scores
from lipwright.face.reference_file import load_reference_face

ENGINES = ("lipwright", "window", "trees", "hmm", "lstm", "dynamic")
SHOWN = ("joint_sd", "joint", "vertices", "inner", "outer", "face_r")


def fewer(dataset: Dataset, count: int) -> Dataset:
    """The dataset with the first `count` recordings for training."""
    kept = set(sorted(dataset.names(TRAIN), key=split_order)[:count])
    entries = [
        entry for entry in dataset.entries
        if entry.get("split") != TRAIN or entry["name"] in kept
    ]  # fmt: skip
    return Dataset(dataset.path, {**dataset.manifest, "recordings": entries})


def score(name: str, dataset: Dataset, face_path: Path, folder: Path) -> Scores:
    """Train one engine, and measure it."""
    face, face_hash = load_reference_face(face_path), sha256_of(face_path)
    variant = Variant("test", dataset, dataset.names("test"), "")
    model = train_model(
        USUAL[name], variant, face_path, BenchmarkOptions(), folder,
        lambda stage, share: None, lambda told: None,
    )  # fmt: skip
    recordings = [dataset.recording(one) for one in variant.recordings]
    performer = Performer(USUAL[name], model.folder)
    bridge = make_bridge(dataset, face, face_hash)
    modes = [performer.perform(recording, bridge).modes for recording in recordings]
    return error_rows(face, [load_truth(one, face_hash) for one in recordings], modes)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("face", type=Path)
    parser.add_argument("--counts", type=int, nargs="+", default=[100, 300])
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), choices=ENGINES)
    parser.add_argument("-o", "--output", type=Path, required=True)
    options = parser.parse_args()
    dataset = open_dataset(options.dataset)
    print("| engine | recordings | " + " | ".join(SHOWN) + " |")
    print("| --- | --- | " + " | ".join("---" for _ in SHOWN) + " |")
    for count in options.counts:
        for name in options.engines:
            folder = options.output / str(count)
            folder.mkdir(parents=True, exist_ok=True)
            rows = score(name, fewer(dataset, count), options.face, folder)
            figures = " | ".join(f"{rows[measure].value:.4g}" for measure in SHOWN)
            print(f"| {name} | {count} | {figures} |", flush=True)


if __name__ == "__main__":
    main()
