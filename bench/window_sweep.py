"""How wide the windows should be, and what whole configurations reach.

    python bench/window_sweep.py DATASET FACE.npz --csv sweep.csv --table sweep.md --plot sweep.png
    python bench/window_sweep.py DATASET FACE.npz --configs window thesis lipwright --out MODELS

Figure 11 of Taylor et al. 2017: the error on held-out sentences for input windows Kx of 1 to 21
frames and output windows Ky of 1 to 15, with raw and with linguistic features. Every run is the
same small network (the thesis's two layers), learns from every third recording (`--every`), and
has the same few epochs and the same seed, so that the sweep ends in time: compare the windows, not
these errors with those of full trainings. A finished run is a row of the CSV, which is written
whole each time; started again, the sweep goes on where it was.

The error is that of the targets: mean squared error of the parameters of the reference face, as
they are, and each over its standard deviation ("_sd"); r is that of the lips' aperture, of
predicted and tracked vertices. `--configs` trains whole configurations with `lipwright train`'s
own code and tabulates the same, with their training times; a model that is there is not trained
again.
"""

from __future__ import annotations

import argparse
import itertools
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from error import figures, predict, table
from lipwright.clip import Clip
from lipwright.dataset.folder import Dataset, open_dataset, sha256_of
from lipwright.dataset.recording import Recording
from lipwright.evaluate.errors import Truth, error_rows, face_r, load_truth
from lipwright.face.faceclip import control_names
from lipwright.face.reference import ReferenceFace
from lipwright.face.reference_file import load_reference_face
from lipwright.files import write_whole
from lipwright.network.meta import META_FILE
from sweep_rows import Row, draw, grid_table, read_rows, write_rows

if TYPE_CHECKING:
    from lipwright.train.config import Config
    from lipwright.train.takes import Corpus

Targets = Literal["shape", "joint"]

INPUT_WINDOWS = tuple(range(1, 22, 2))  # frames, as in figure 11
OUTPUT_WINDOWS = tuple(range(1, 16, 2))
FEATURES = {"raw": ["raw"], "linguistic": ["raw", "spans", "attributes", "transitions"]}
SPLITS = ("validation", "test")

SMALL: dict[str, Any] = {
    "name": "sweep",
    "network": {
        "layers": [338, 270], "dropout": [0.3], "activation": "leaky_relu", "slope": 0.1,
        "init": "he",
    },
    "optimizer": {"kind": "adam"},
    "rates": {"first": 0.001, "schedule": "cosine"},
    "scaling": "each",
    "batch": 200,
    "patience": None,
}  # fmt: skip
"""the configuration of each run but its features, windows, targets and epochs"""


@dataclass(frozen=True, eq=False)
class Held:
    """What runs are judged by."""

    face: ReferenceFace
    truths: dict[str, list[Truth]]
    """split to its recordings"""
    recordings: dict[str, list[Recording]]
    """the same, whole"""


def hold(dataset: Dataset, face_file: Path, splits: Iterable[str]) -> Held:
    """The recordings of some splits with their parameters of a reference face."""
    known = sha256_of(face_file)
    recordings = {split: [dataset.recording(name) for name in dataset.names(split)]
                  for split in splits}  # fmt: skip
    truths = {split: [load_truth(one, known) for one in found]
              for split, found in recordings.items()}  # fmt: skip
    return Held(load_reference_face(face_file), truths, recordings)


def error_of(held: Held, split: str, predicted: list[Clip], targets: Targets) -> dict[str, float]:
    """Means over the frames of a split of `targets`, of the same over deviations, and of r."""
    sd, apart, rs = held.face.sd(targets), [], []
    for truth, clip in zip(held.truths[split], predicted, strict=True):
        real = (held.face.join(truth.parameters) if targets == "joint"
                else truth.parameters.shape)  # fmt: skip
        made = clip.select(control_names(held.face, targets)).values[truth.valid]
        apart.append(made - real / sd)
        rs.append(face_r(held.face, truth, clip))
    squares = np.square(np.concatenate(apart), dtype=np.float64)
    means = {targets: float((squares * sd**2).mean()), f"{targets}_sd": float(squares.mean())}
    return {**means, "r": float(np.nanmean(rs))}


def config_of(options: argparse.Namespace, features: str, kx: int, ky: int) -> Config:
    """The configuration of one run."""
    from lipwright.train.config_file import config_from

    own = {"features": FEATURES[features], "input_window": kx, "output_window": ky,
           "targets": options.targets, "epochs": options.epochs, "seed": options.seed}  # fmt: skip
    return config_from({**SMALL, **own}, "bench/window_sweep.py")


def setting_of(options: argparse.Namespace) -> str:
    """What all runs of a sweep share."""
    return (f"{options.targets}, {options.epochs} epochs, 1 of {options.every} recordings, "
            f"seed {options.seed}")  # fmt: skip


def read_part(options: argparse.Namespace) -> Corpus:
    """The dataset with every Nth of its recordings for training."""
    from lipwright.train.takes import read_corpus

    widest = config_of(options, "raw", max(options.inputs), max(options.outputs))
    corpus = read_corpus(open_dataset(options.dataset), widest, options.face)
    return replace(corpus, splits={**corpus.splits, "train": corpus.of("train")[:: options.every]})


def run(config: Config, corpus: Corpus, held: Held) -> dict[str, float]:
    """Train and judge: the figures of a row."""
    from lipwright.train.data import make_data
    from lipwright.train.measures import predict_takes
    from lipwright.train.run import fit_in

    begun = time.perf_counter()
    data = make_data(corpus, config)
    with tempfile.TemporaryDirectory() as folder:
        state = fit_in(Path(folder), config, data)
    figures = {"seconds": time.perf_counter() - begun}
    for split, arrays in (("validation", data.validation), ("test", data.test)):
        assert arrays is not None  # hold() found recordings of both
        rows = predict_takes(config, data, state.members, arrays)
        clips = [Clip(data.controls, corpus.fps, values) for values in rows]
        found = error_of(held, split, clips, config.targets)
        figures[split], figures[f"{split}_sd"] = (
            found[config.targets], found[f"{config.targets}_sd"]
        )  # fmt: skip
    return figures | {"test_r": found["r"]}


def run_sweep(options: argparse.Namespace) -> list[Row]:
    """All runs that the CSV lacks; the rows of this setting."""
    setting, rows = setting_of(options), read_rows(options.csv)
    done = {row.key for row in rows}
    wanted = list(itertools.product(options.features, options.inputs, options.outputs))
    missing = [place for place in wanted if (*place, setting) not in done]
    if missing:
        held = hold(open_dataset(options.dataset), options.face, SPLITS)
        corpus = read_part(options)
    for number, place in enumerate(missing, 1):
        row = Row(*place, setting, **run(config_of(options, *place), corpus, held))
        rows.append(row)
        write_rows(options.csv, rows)
        print(f"{number} of {len(missing)}: {row.features} Kx {row.input_window} Ky "
              f"{row.output_window}: {row.test_sd:.4f}, r {row.test_r:.3f}, {row.seconds:.0f} s",
              flush=True)  # fmt: skip
    return [row for row in rows if row.setting == setting and row.key[:3] in wanted]


# --- whole configurations ---


def train_configs(options: argparse.Namespace) -> dict[str, Path]:
    """Label to model folder of each configuration, trained where it is not there."""
    found = {}
    for config in options.configs:
        label = Path(config).stem
        found[label] = options.out / label
        if not (found[label] / META_FILE).exists():
            options.out.mkdir(parents=True, exist_ok=True)
            subprocess.run(
                [sys.executable, "-m", "lipwright", "train", str(options.dataset),
                 "--config", config, "--targets", options.targets, "--face", str(options.face),
                 "-o", str(found[label])],
                check=True,
            )  # fmt: skip
    return found


def training_time(folder: Path) -> tuple[int, float]:
    """Epochs and s of a training, of all members, by its log."""
    lines = (folder / "training" / "log.jsonl").read_text("utf-8").splitlines()
    epochs = [json.loads(line) for line in lines]
    return len(epochs), sum(epoch["seconds"] for epoch in epochs)


def compare_configs(options: argparse.Namespace) -> Iterator[str]:
    """Train, and the lines of two tables: of the trainings, and of their errors."""
    folders = train_configs(options)
    held = hold(open_dataset(options.dataset), options.face, ["test"])
    clips = {label: [predict(folder, one) for one in held.recordings["test"]]
             for label, folder in folders.items()}  # fmt: skip
    yield "| configuration | epochs | training, s | error | over deviations | r |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for label, predicted in clips.items():
        epochs, seconds = training_time(folders[label])
        errors = error_of(held, "test", predicted, options.targets)
        yield (f"| {label} | {epochs} | {seconds:.0f} | "
               + " | ".join(f"{error:.4g}" for error in errors.values()) + " |")  # fmt: skip
    yield ""
    yield from table(figures({
        label: error_rows(held.face, held.truths["test"], predicted)
        for label, predicted in clips.items()
    }))  # fmt: skip


def options_of() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("face", type=Path, help="the reference face, .npz")
    parser.add_argument("--targets", choices=["shape", "joint"], default="shape")
    parser.add_argument("--features", nargs="+", choices=list(FEATURES), default=list(FEATURES))
    parser.add_argument("--inputs", nargs="+", type=int, default=list(INPUT_WINDOWS))
    parser.add_argument("--outputs", nargs="+", type=int, default=list(OUTPUT_WINDOWS))
    parser.add_argument("--epochs", type=int, default=6)
    parser.add_argument("--every", type=int, default=3, help="learn from every Nth recording")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--csv", type=Path, default=Path("window-sweep.csv"))
    parser.add_argument("--table", type=Path, help="write the tables here, Markdown")
    parser.add_argument("--plot", type=Path, help="draw the figure, PNG")
    parser.add_argument("--configs", nargs="+", help="train these instead; names or files")
    parser.add_argument("--out", type=Path, default=Path("models"), help="folder of their models")
    return parser.parse_args()


def main() -> None:
    options = options_of()
    if options.configs:
        lines = list(compare_configs(options))
    else:
        rows = run_sweep(options)
        lines = [line for name in options.features for line in (*grid_table(rows, name), "")]
        lines += [f"{len(rows)} runs, {sum(row.seconds for row in rows):.0f} s of training; "
                  f"{rows[0].setting}"]  # fmt: skip
        if options.plot:
            draw(options.plot, rows)
    print("\n".join(lines))
    if options.table:
        with write_whole(options.table) as part:
            part.write_text("\n".join(lines) + "\n", "utf-8")


if __name__ == "__main__":
    main()
