"""A whole training of a learner that is no network: from a dataset to a model's folder."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping
from datetime import date
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lipwright.dataset.folder import Dataset, sha256_of
from lipwright.dataset.lock import locked
from lipwright.dataset.recording import to_json
from lipwright.engines import ENGINES
from lipwright.engines.golden import FRAMES, check_model, golden_of
from lipwright.errors import LipwrightError
from lipwright.network.arrays import ArrayModel
from lipwright.network.meta import (
    ARRAYS_FILE,
    ENGINE_OF,
    GOLDEN_FILE,
    META_FILE,
    TARGETS,
    ModelMeta,
)
from lipwright.phones import SILENCE
from lipwright.train.card import FEW, describe_data, metric_lines
from lipwright.train.data import spread_of
from lipwright.train.learner import LEARNERS, Fitted, LearnerConfig, Report
from lipwright.train.measures import measure
from lipwright.train.place import (
    CARD_FILE,
    TRAINING,
    Trained,
    TrainOptions,
    licence_of,
    make_place,
    move,
)
from lipwright.train.takes import Corpus, read_corpus
from lipwright.version import VERSION

Values = npt.NDArray[np.float64]


def train_learner(
    dataset: Dataset, config: LearnerConfig, out: Path, options: TrainOptions, report: Report
) -> Trained:
    """Train a model on a dataset; it lands in `out`, whole or not at all.

    Raises:
        LipwrightError: as `train.run.train`.
    """
    place = make_place(out, options)
    with locked(place, "model"):
        begun = time.perf_counter()
        corpus = read_corpus(dataset, config, options.face, report)
        fitted: Fitted = import_module(LEARNERS[config.engine]).fit(corpus, config, report)
        seconds = round(time.perf_counter() - begun, 3)
        report("export", 0.0)
        try:
            (place / TRAINING / "config.json").write_text(to_json(config.to_json()), "utf-8")
            metrics = _write(place, corpus, config, fitted, options, seconds)
        except OSError as error:
            reason = error.strerror or error
            raise LipwrightError(f"{place}: cannot be written: {reason}") from error
        report("export", 1.0)
    move(place, out, options)
    return Trained(out, [], metrics, seconds)


def _write(
    place: Path, corpus: Corpus, config: LearnerConfig, fitted: Fitted, options: TrainOptions,
    seconds: float,
) -> dict[str, Any]:  # fmt: skip
    """The files of the model; its figures."""
    save_arrays(place / ARRAYS_FILE, fitted.arrays)
    engine = import_module(ENGINES[ENGINE_OF[fitted.kind]].module)
    licence = licence_of(corpus, options)

    def meta(metrics: dict[str, Any], golden: str) -> ModelMeta:
        return ModelMeta(
            name=config.name, kind=fitted.kind, features=fitted.features,
            output_window=fitted.output_window, controls=corpus.controls, target=config.targets,
            files={ARRAYS_FILE: sha256_of(place / ARRAYS_FILE), GOLDEN_FILE: golden},
            licence=licence, data=describe_data(corpus), metrics=metrics,
            date=date.today().isoformat(),  # the user's own day
        )  # fmt: skip

    model = ArrayModel(place, meta({}, "0" * 64), fitted.arrays)
    spread = spread_of(np.concatenate([take.targets[take.valid] for take in corpus.of("train")]))
    metrics = {
        split: measure(corpus.controls, spread, takes,
                       [engine.predict_at(model, take.track, take.times) for take in takes])
        for split, takes in (("validation", corpus.of("validation")), ("test", corpus.of("test")))
        if takes
    }  # fmt: skip
    first = corpus.of("validation")[0]
    times = first.times[:FRAMES]
    predicted = engine.predict_at(model, first.track, times)
    save_arrays(place / GOLDEN_FILE, golden_of(predicted, first.track, times))
    digest = sha256_of(place / GOLDEN_FILE)
    (place / META_FILE).write_text(to_json(meta(metrics, digest).to_json()), "utf-8")
    check_model(place)
    card = "\n".join(_card_lines(corpus, config, fitted, metrics, licence, seconds))
    (place / CARD_FILE).write_text(card, "utf-8")
    return metrics


def save_arrays(path: Path, arrays: Mapping[str, npt.ArrayLike]) -> None:
    """Write arrays as .npz; the same arrays give the same bytes."""
    named: dict[str, Any] = {name: np.asarray(array) for name, array in arrays.items()}
    np.savez_compressed(path, **named)


def _card_lines(
    corpus: Corpus, config: LearnerConfig, fitted: Fitted, metrics: dict[str, Any], licence: str,
    seconds: float,
) -> Iterator[str]:  # fmt: skip
    count = Counter(phone for take in corpus.of("train") for phone in take.track.phones)
    rare = [p for p in fitted.features.phones if p != SILENCE and count[p] < FEW]
    yield f"# {config.name}"
    yield ""
    yield (
        f"A model of the engine {config.engine} of Lipwright {VERSION}, from phones to "
        f"{TARGETS[config.targets]}: {len(corpus.controls)} controls. "
        f"Trained on {date.today().isoformat()}."
    )
    yield from ("", "## Data", "", f"- {describe_data(corpus)}")
    yield from ("", "## What was learnt", "", *(f"- {note}" for note in fitted.notes))
    yield from (f"- {seconds / 60:.1f} minutes in all; seed {config.seed}",)
    if config.comment:
        yield f"- {config.comment}"
    yield from ("", "## How well it does", "", *metric_lines(metrics))
    yield from ("", "## Licence of the weights", "", licence, "", "## Limits", "")
    yield "- It moves as the recorded speaker does, and hears nothing: phones and times only."
    yield f"- Heard fewer than {FEW} times in training: {', '.join(rare) or 'no phone'}."
    yield ""
