"""A whole training: a column of verbs from a dataset to a model's folder."""

from __future__ import annotations

import json
import secrets
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any, Final

from lipwright.dataset.folder import open_dataset
from lipwright.dataset.lock import LOCK_FILE, locked
from lipwright.dataset.recording import to_json
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.network.meta import META_FILE
from lipwright.train.card import describe_data, write_card
from lipwright.train.checkpoint import (
    CHECKPOINT_FILE,
    Checkpoint,
    load_checkpoint,
    save_checkpoint,
)
from lipwright.train.config import Config
from lipwright.train.data import Data, make_data
from lipwright.train.export import write_model
from lipwright.train.loop import fit
from lipwright.train.measures import measure, predict_takes
from lipwright.train.plots import write_losses
from lipwright.train.takes import Report, read_corpus

Tell = Callable[[dict[str, Any]], None]

TRAINING: Final = "training"  # the part of a model's folder that running it does not need
CARD_FILE: Final = "card.md"


@dataclass(frozen=True)
class TrainOptions:
    """What is asked of a training besides its configuration."""

    face: Path | None = None
    """the reference face of shape and joint modes"""
    licence: str = ""
    """of the weights"""
    force: bool = False
    """replace a finished model, and a checkpoint that does not fit"""


@dataclass(frozen=True)
class Trained:
    """What came out."""

    folder: Path
    history: list[dict[str, Any]]
    metrics: dict[str, Any]
    """split to figures, as `measure` gives them"""


def part_of(out: Path) -> Path:
    """Where a model is made, before it takes its place.

    Raises:
        LipwrightError: the path has no name of its own, as `.` has none.
    """
    if out.name in {"", ".."}:
        raise LipwrightError(f"{out}: is no name of a new folder; give the model one")
    return out.with_name(f"{out.name}.part")


def train(
    path: Path, config: Config, out: Path, options: TrainOptions, report: Report, tell: Tell
) -> Trained:
    """Train a network on the dataset at `path`; the model lands in `out`, whole or not at all.

    Until then it is in the folder `part_of(out)`; what a training that was stopped has left
    there is gone on from.

    Args:
        path: of the dataset.
        config: of the network and its training.
        out: folder of the model.
        options: what else is asked.
        report: told of a stage and how much of it is done.
        tell: told of each epoch.

    Raises:
        LipwrightError: the dataset has not what is asked for, or `out` cannot be written or is
            there already.
    """
    dataset = open_dataset(path)
    place = _make_place(out, options)
    with locked(place, "model"):
        data = make_data(read_corpus(dataset, config, options.face, report), config)
        folder = place / TRAINING
        state = fit_in(folder, config, data, force=options.force, report=report, tell=tell)
        write_losses(folder / "losses.png", state.history)
        report("export", 0.0)
        metrics = _finish(config, data, state, place, options)
        report("export", 1.0)
    _move(place, out, options)
    return Trained(out, state.history, metrics)


def _make_place(out: Path, options: TrainOptions) -> Path:
    place = part_of(out)
    try:
        _refuse_others(out, options)
        (place / TRAINING).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LipwrightError(f"{place}: cannot be made: {error.strerror}") from error
    return place


def _refuse_others(out: Path, options: TrainOptions) -> None:
    """Leave alone what is not a model, or one that is to stay."""
    if out.exists() and not out.is_dir():
        raise LipwrightError(f"{out}: is a file; name a new folder")
    if (out / META_FILE).is_file():
        if not options.force:
            raise LipwrightError(f"{out}: is a finished model; add --force to replace it")
    elif out.is_dir() and any(out.iterdir()):
        raise LipwrightError(f"{out}: is a folder with other files; name a new folder")


def fit_in(
    folder: Path, config: Config, data: Data, *, force: bool = False,
    report: Report = lambda stage, share: None, tell: Tell = lambda epoch: None,
) -> Checkpoint:  # fmt: skip
    """Train, or go on; the state and a log are written to `folder` after each epoch.

    Args:
        folder: where; it is there.
        config: of the training.
        data: to learn from.
        force: start anew where the checkpoint in `folder` does not fit.
        report: told how far it is.
        tell: told of each epoch.

    Raises:
        LipwrightError: the checkpoint does not fit, or the loss grew beyond all bounds.
    """
    path, plain, digest = folder / CHECKPOINT_FILE, config.to_json(), data.corpus.digest()
    try:
        state = load_checkpoint(path, plain, digest)
    except LipwrightError:
        if not force:
            raise
        state = None
    state = state or Checkpoint(plain, digest)

    def keep(state: Checkpoint) -> None:
        save_checkpoint(path, state)
        write_log(folder, state.history)
        tell(state.history[-1])

    with write_whole(folder / "config.json") as part:
        part.write_text(to_json(plain), "utf-8")
    fit(config, data, state, report, keep)
    return state


def write_log(folder: Path, history: Sequence[dict[str, Any]]) -> None:
    """log.jsonl, a line an epoch."""
    with write_whole(folder / "log.jsonl") as part:
        part.write_text("".join(json.dumps(epoch) + "\n" for epoch in history), "utf-8")


def _finish(
    config: Config, data: Data, state: Checkpoint, place: Path, options: TrainOptions
) -> dict[str, Any]:
    """Write the model, its card and its figures into `place`."""
    metrics = {
        split: measure(data, arrays.takes, predict_takes(config, data, state.members, arrays))
        for split, arrays in (("validation", data.validation), ("test", data.test))
        if arrays is not None
    }
    licence = options.licence or (
        "that of whoever trained them; learnt from data under: "
        + (data.corpus.licence or "no licence named")
    )
    facts = {"licence": licence, "data": describe_data(data.corpus), "metrics": metrics}
    write_model(place, config, data, state.members, facts)
    day = date.today().isoformat()  # the user's own day
    card = write_card(config, data, state.history, metrics, licence, day)
    (place / CARD_FILE).write_text(card, "utf-8")
    return metrics


def _move(place: Path, out: Path, options: TrainOptions) -> None:
    """Put the finished folder in its place; hours may have passed since that was free."""
    try:
        _refuse_others(out, options)
        (place / LOCK_FILE).unlink(missing_ok=True)
        if out.is_dir() and any(out.iterdir()):
            old = out.with_name(f".{secrets.token_hex(4)}.old.{out.name[-60:]}")
            out.rename(old)
            place.rename(out)
            shutil.rmtree(old, ignore_errors=True)
        else:
            place.rename(out)
    except OSError as error:
        raise LipwrightError(f"{out}: cannot be put in its place: {error.strerror}") from error
