"""A whole training: a column of verbs from a dataset to a model's folder."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from datetime import date
from pathlib import Path
from typing import Any

from lipwright.dataset.folder import Dataset, open_dataset
from lipwright.dataset.lock import locked
from lipwright.dataset.recording import to_json
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
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
from lipwright.train.learner import LearnerConfig
from lipwright.train.loop import fit
from lipwright.train.measures import measure, predict_takes
from lipwright.train.place import (
    CARD_FILE,
    TRAINING,
    Trained,
    TrainOptions,
    licence_of,
    make_place,
    move,
)
from lipwright.train.plots import write_losses
from lipwright.train.run_learner import train_learner
from lipwright.train.takes import Report, read_corpus

Tell = Callable[[dict[str, Any]], None]


def train(
    path: Path | Dataset, config: Config | LearnerConfig, out: Path, options: TrainOptions,
    report: Report, tell: Tell,
) -> Trained:  # fmt: skip
    """Train a model on the dataset at `path`; the model lands in `out`, whole or not at all.

    Until then it is in the folder `part_of(out)`; what a training that was stopped has left
    there is gone on from.

    Args:
        path: of the dataset; or the dataset itself.
        config: of the network and its training, or of another learner.
        out: folder of the model.
        options: what else is asked.
        report: told of a stage and how much of it is done.
        tell: told of each epoch.

    Raises:
        LipwrightError: the dataset has not what is asked for, or `out` cannot be written or is
            there already.
    """
    dataset = path if isinstance(path, Dataset) else open_dataset(path)
    if isinstance(config, LearnerConfig):
        return train_learner(dataset, config, out, options, report)
    place = make_place(out, options)
    with locked(place, "model"):
        data = make_data(read_corpus(dataset, config, options.face, report), config)
        folder = place / TRAINING
        state = fit_in(folder, config, data, force=options.force, report=report, tell=tell)
        write_losses(folder / "losses.png", state.history)
        report("export", 0.0)
        metrics = _finish(config, data, state, place, options)
        report("export", 1.0)
    move(place, out, options)
    seconds = round(sum(epoch["seconds"] for epoch in state.history), 3)
    return Trained(out, state.history, metrics, seconds)


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
        split: measure(
            data.controls,
            data.scaling.spread,
            arrays.takes,
            predict_takes(config, data, state.members, arrays),
        )
        for split, arrays in (("validation", data.validation), ("test", data.test))
        if arrays is not None
    }
    licence = licence_of(data.corpus, options)
    facts = {"licence": licence, "data": describe_data(data.corpus), "metrics": metrics}
    write_model(place, config, data, state.members, facts)
    day = date.today().isoformat()  # the user's own day
    card = write_card(config, data, state.history, metrics, licence, day)
    (place / CARD_FILE).write_text(card, "utf-8")
    return metrics
