"""`lipwright train` and `lipwright tune`."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

from lipwright.cli.progress import keeps, progress_option, progress_report, say
from lipwright.errors import LipwrightError, MissingExtraError

TRAIN_EXAMPLES = """\b
Examples:
  lipwright train anna --config thesis --epochs 2 -o anna-model
    epoch 1: train 0.08749, validation 0.004411, rate 0.001, 8.2 s
    epoch 2: train 0.03368, validation 0.004876, rate 0.001, 8.7 s
\b
  lipwright train anna --config lipwright -o anna-model --force
  lipwright train grid --config window --targets joint -o grid-joint
  lipwright train grid --config mine.json --seed 2 --epochs 30 -o second
\b
Train again what was interrupted by the same command: it goes on, with the same result.
"""

config_option = click.option(
    "--config", "-c", default="window", show_default=True,
    help="Name of a configuration (window, thesis, lipwright, lstm, trees, hmm, dynamic), or file.",
)  # fmt: skip
targets_option = click.option(
    "--targets", type=click.Choice(["arkit", "shape", "joint", "both"]), help="What to predict."
)
dataset_argument = click.argument("path", metavar="DATASET", type=Path)
face_option = click.option(
    "--face", type=Path, help="Reference face of the modes.  [default: DATASET-face.npz]"
)


@click.command(epilog=TRAIN_EXAMPLES)
@dataset_argument
@config_option
@click.option("-o", "--output", "out", type=Path, required=True, help="Folder of the model.")
@click.option(
    "--targets", type=click.Choice(["arkit", "shape", "joint", "both"]), help="What to predict."
)
@click.option("--seed", type=click.IntRange(0), help="Another number gives another network.")
@click.option("--epochs", type=click.IntRange(1), help="The most passes over the data.")
@click.option("--fps", type=click.FloatRange(1, 1000), help="Frames a second of the network.")
@click.option("--name", help="Name of the model; else that of the configuration.")
@face_option
@click.option("--licence", default="", help="Licence of the weights, for card and meta.json.")
@click.option("--force", is_flag=True, help="Replace a finished model, or start anew.")
@progress_option
def train(
    path: Path, config: str, out: Path, targets: str | None, seed: int | None,
    epochs: int | None, fps: float | None, name: str | None, face: Path | None, licence: str,
    force: bool, progress: str,
) -> None:  # fmt: skip
    """Train a model that moves a face as the recordings of a dataset do."""
    _need_extra()
    from lipwright.train.config import Config
    from lipwright.train.config_file import load_config, override
    from lipwright.train.place import TrainOptions, part_of
    from lipwright.train.run import train as run

    given = {"targets": targets, "seed": seed, "epochs": epochs, "fps": fps, "name": name}
    changes = {key: value for key, value in given.items() if value is not None}
    chosen = override(load_config(config), changes, config)
    if isinstance(chosen, Config):  # the other learners begin anew
        keeps(f"what was learnt is kept in {part_of(out)}; run the same command to go on")
    with progress_report(progress) as report:
        trained = run(
            path, chosen, out, TrainOptions(face, licence, force), report,
            tell=lambda epoch: _tell(epoch, progress),
        )  # fmt: skip
    if progress != "json":
        figures = list(trained.metrics.items())[-1]
        say(f"{out}: {_said(*figures)}; see {out / 'card.md'}")


def _said(split: str, figures: dict[str, Any]) -> str:
    error, r = figures["error"], figures["aperture_r"]
    lips = "" if r is None else f", lips r {r:.3f}"
    return f"{split} error {error:.3f}{lips}"


def _tell(epoch: dict[str, Any], progress: str) -> None:
    if progress == "json":
        say(json.dumps(epoch))
    elif progress == "auto":
        say(
            f"epoch {epoch['epoch']}: train {epoch['train']:.4g}, validation "
            f"{epoch['validation']:.4g}, rate {epoch['rate']:g}, {epoch['seconds']:.1f} s"
        )


def _need_extra() -> None:
    """Refuse to begin without the packages of the extra.

    Raises:
        MissingExtraError: one is not installed.
    """
    for package in ("torch", "onnx", "optuna", "matplotlib"):
        if find_spec(package) is None:
            raise MissingExtraError(f"{package}, which training needs,", "train")


TUNE_EXAMPLES = """\b
Examples:
  lipwright tune anna --config thesis --epochs 2 --grid input_window=5,15 -o windows
    input_window 15, validation 0.004411, error 2.176, epochs 2, seconds 0.816
    input_window 5, validation 0.00447, error 2.626, epochs 2, seconds 9.327
\b
  lipwright tune grid --config thesis --grid input_window=5,11,21 --grid seed=0,1 -o windows
  lipwright tune grid --random 20 --range rates.first=1e-4:1e-1:log -o rates
  lipwright tune grid --grid "network.layers=[300],[300,300]" --epochs 10 -o sizes
\b
The results are in trials.csv, best first, and in trials.png. An interrupted search goes on by the
same command.
"""


@click.command(epilog=TUNE_EXAMPLES)
@dataset_argument
@config_option
@click.option("--grid", multiple=True, help="KEY=VALUE,VALUE: values to try, as in JSON.")
@click.option("--range", "ranges", multiple=True, help="KEY=LOW:HIGH, :log or :STEP, at random.")
@click.option("--random", "trials", type=click.IntRange(1), help="So many trials at random.")
@click.option("-o", "--output", "out", type=Path, required=True, help="Folder of the results.")
@click.option("--epochs", type=click.IntRange(1), help="The most passes over the data, of each.")
@click.option(
    "--targets", type=click.Choice(["arkit", "shape", "joint", "both"]), help="What to predict."
)
@face_option
@progress_option
def tune(
    path: Path, config: str, grid: tuple[str, ...], ranges: tuple[str, ...], trials: int | None,
    out: Path, epochs: int | None, targets: str | None, face: Path | None, progress: str,
) -> None:  # fmt: skip
    """Train many configurations and list them by their validation loss."""
    _need_extra()
    from lipwright.train.config import Config
    from lipwright.train.config_file import load_config, override
    from lipwright.train.tune import Search, parse_choice, parse_range
    from lipwright.train.tune import tune as run

    given = {"epochs": epochs, "targets": targets}
    changes = {key: value for key, value in given.items() if value is not None}
    loaded = load_config(config)
    if not isinstance(loaded, Config):
        raise LipwrightError(f"{config}: only networks are tuned; name the configuration of one")
    chosen = override(loaded, changes, config)
    search = Search(tuple(map(parse_choice, grid)), tuple(map(parse_range, ranges)), trials)
    keeps(f"trials that were done are kept in {out}; run the same command to go on")
    with progress_report(progress) as report:
        rows = run(
            path, chosen, search, out, report, lambda row: _tell_trial(row, progress), face
        )  # fmt: skip
    if progress != "json":
        say(f"{out}: {len(rows)} trials; the best: {_values(rows[0])}")


def _tell_trial(row: dict[str, Any], progress: str) -> None:
    if progress == "json":
        say(json.dumps(row))
    elif progress == "auto":
        say(_values(row))


def _values(row: dict[str, Any]) -> str:
    known = {key: value for key, value in row.items() if value is not None}
    return ", ".join(
        f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in known.items()
    )
