"""Search for a better configuration, over all points of a grid or at random.

What is done is kept in a file after each trial, and each trial keeps its checkpoint, so that the
same search goes on where it was killed.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any, Final

import optuna
from optuna.samplers import GridSampler, RandomSampler
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
from optuna.trial import FrozenTrial, Trial, TrialState

from lipwright.dataset.folder import open_dataset
from lipwright.dataset.lock import LOCK_FILE, locked
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.train.config import Config
from lipwright.train.config_file import override
from lipwright.train.data import make_data
from lipwright.train.journal import mend
from lipwright.train.plots import write_trials
from lipwright.train.run import fit_in
from lipwright.train.takes import Corpus, Report, read_corpus

JOURNAL_FILE: Final = "journal.log"
TABLE_FILE: Final = "trials.csv"
PLOT_FILE: Final = "trials.png"
FIGURES: Final = ("validation", "error", "epochs", "seconds", "problem")
PROBLEM: Final = "problem"


@dataclass(frozen=True)
class Choice:
    """One of some values, such as those of `input_window=5,11,21`."""

    key: str
    values: tuple[Any, ...]

    def suggest(self, trial: Trial) -> Any:
        """A value for a trial."""
        texts = [json.dumps(value) for value in self.values]
        return json.loads(trial.suggest_categorical(self.key, texts))


@dataclass(frozen=True)
class Range:
    """A number from `low` to `high`, such as that of `rates.first=1e-4:1e-2:log`."""

    key: str
    low: float
    high: float
    log: bool = False
    step: int | None = None
    """of whole numbers"""

    def suggest(self, trial: Trial) -> Any:
        """A value for a trial."""
        if self.step is not None:
            return trial.suggest_int(self.key, int(self.low), int(self.high), step=self.step)
        return trial.suggest_float(self.key, self.low, self.high, log=self.log)


def parse_choice(text: str) -> Choice:
    """`KEY=VALUE,VALUE,...`, values as in JSON; words need no quotation marks.

    Raises:
        LipwrightError: it is no such text.
    """
    key, sign, values = text.partition("=")
    if not sign or not values:
        raise LipwrightError(f"{text!r}: not KEY=VALUE,VALUE, such as input_window=5,11,21")
    try:
        return Choice(key, tuple(json.loads(f"[{values}]")))
    except ValueError:
        return Choice(key, tuple(value.strip() for value in values.split(",")))


def parse_range(text: str) -> Range:
    """`KEY=LOW:HIGH`, with `:log`, or with `:STEP` for whole numbers.

    Raises:
        LipwrightError: it is no such text.
    """
    key, _, values = text.partition("=")
    parts = values.split(":")
    kind = parts[2] if len(parts) == 3 else ""
    try:
        step = int(kind) if kind not in {"", "log"} else None
        found = Range(key, float(parts[0]), float(parts[1]), kind == "log", step)
        fits = len(parts) in {2, 3} and found.low < found.high and (step is None or step > 0)
        fits = fits and math.isfinite(found.high - found.low) and (not found.log or found.low > 0)
    except (ValueError, IndexError):
        fits = False
    if not fits:
        raise LipwrightError(
            f"{text!r}: not KEY=LOW:HIGH, such as rates.first=1e-4:1e-2:log or input_window=5:21:2"
        )
    return found


@dataclass(frozen=True)
class Search:
    """What to vary.

    Raises:
        LipwrightError: nothing, the same twice, or ranges in a grid.
    """

    choices: tuple[Choice, ...] = ()
    ranges: tuple[Range, ...] = ()
    trials: int | None = None
    """at random; None for all points of the grid"""

    def __post_init__(self) -> None:
        """Check."""
        if not self.keys:
            raise LipwrightError("nothing to vary; add --grid KEY=VALUE,VALUE")
        if len(set(self.keys)) < len(self.keys):
            raise LipwrightError(f"a key is varied twice among {', '.join(self.keys)}")
        if self.ranges and self.trials is None:
            raise LipwrightError("a range has no points of a grid; add --random N")

    @property
    def varied(self) -> tuple[Choice | Range, ...]:
        """Choices and ranges."""
        return (*self.choices, *self.ranges)

    @property
    def keys(self) -> tuple[str, ...]:
        """What varies."""
        return tuple(vary.key for vary in self.varied)

    def draw(self, trial: Trial) -> dict[str, Any]:
        """Key to value for a trial."""
        return {vary.key: vary.suggest(trial) for vary in self.varied}

    def check(self, config: Config, source: str) -> None:
        """Refuse points that are no configurations, before the first is trained.

        Raises:
            LipwrightError: there is one.
        """
        for values in product(*(choice.values for choice in self.choices)):
            point = dict(zip((choice.key for choice in self.choices), values, strict=True))
            override(config, point, source)
        for vary in self.ranges:
            if self.trials is not None:
                override(config, {vary.key: int(vary.low) if vary.step else vary.low}, source)


def tune(
    path: Path, config: Config, search: Search, out: Path, report: Report,
    tell: Callable[[dict[str, Any]], None], face: Path | None = None,
) -> list[dict[str, Any]]:  # fmt: skip
    """Train each configuration of a search; a table of them, best first, is kept in `out`.

    Args:
        path: of the dataset.
        config: what does not vary.
        search: what does.
        out: folder of the results.
        report: told how much is done.
        tell: told of each trial that is done.
        face: the reference face of shape and joint modes.

    Returns:
        A row a trial: the values, `validation` and the other FIGURES.

    Raises:
        LipwrightError: the dataset has not what is asked for, or `out` is of another search.
    """
    search.check(config, config.name)
    try:
        out.mkdir(parents=True, exist_ok=True)
        found = {path.name for path in out.iterdir()} - {LOCK_FILE}
    except OSError as error:
        raise LipwrightError(f"{out}: cannot be made: {error.strerror}") from error
    if found and JOURNAL_FILE not in found:
        raise LipwrightError(f"{out}: is a folder with other files; name a new folder")
    with locked(out, "search"):
        study = _open_study(out, config, search)
        runner = _Runner(path, config, search, out, face)
        total = search.trials or math.prod(len(choice.values) for choice in search.choices)
        while (done := len(_finished(study))) < total:
            report("tune", done / total)
            study.sampler = _sampler(search, config.seed, done)
            study.optimize(runner.run, n_trials=1)
            _write_table(out / TABLE_FILE, search, _rows(study, search))
            tell(_row(_finished(study)[-1], search))
        write_trials(out / PLOT_FILE, search.keys, _rows(study, search))
        report("tune", 1.0)
    return _rows(study, search)


def _sampler(search: Search, seed: int, done: int) -> optuna.samplers.BaseSampler:
    """What draws the next point: the same one after a kill."""
    if search.trials is not None:
        return RandomSampler(seed + done)
    grid = {c.key: [json.dumps(value) for value in c.values] for c in search.choices}
    return GridSampler(grid, seed)


def _open_study(out: Path, config: Config, search: Search) -> optuna.Study:
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    path = out / JOURNAL_FILE
    plain = json.dumps({"config": config.to_json(), "search": {**asdict(search), "trials": None}})
    try:
        mend(path)
        storage = JournalStorage(JournalFileBackend(str(path)))
        study = optuna.create_study(storage=storage, study_name="tune", load_if_exists=True)
        known = study.user_attrs.get("search")
    except (OSError, ValueError, KeyError) as error:
        raise LipwrightError(f"{path}: not readable; name another folder ({error})") from error
    if known is None:
        study.set_user_attr("search", plain)
    elif known != plain:
        raise LipwrightError(f"{out}: holds another search; name another folder")
    return study


class _Runner:
    """Trains what a trial draws."""

    def __init__(
        self, path: Path, config: Config, search: Search, out: Path, face: Path | None
    ) -> None:
        self.dataset, self.config, self.search = open_dataset(path), config, search
        self.out, self.face = out, face
        self.corpora: dict[Any, Corpus] = {}

    def run(self, trial: Trial) -> float:
        values = self.search.draw(trial)
        folder = self.out / "trials" / _name_of(values)
        try:
            config = override(self.config, values, self.config.name)
            data = make_data(self._corpus(config), config)
            folder.mkdir(parents=True, exist_ok=True)
            state = fit_in(folder, config, data)
        except LipwrightError as error:
            trial.set_user_attr(PROBLEM, str(error))
            raise optuna.TrialPruned from error
        best = min(state.history, key=lambda epoch: epoch["validation"])
        figures = {
            "error": best["error"], "epochs": len(state.history),
            "seconds": round(sum(epoch["seconds"] for epoch in state.history), 3),
        }  # fmt: skip
        for key, value in figures.items():
            trial.set_user_attr(key, value)
        shutil.rmtree(folder)
        return float(best["validation"])

    def _corpus(self, config: Config) -> Corpus:
        """The corpus, read once for all configurations that learn from the same."""
        key = (config.targets, config.controls, config.fps, "sound" in config.features)
        if key not in self.corpora:
            self.corpora = {key: read_corpus(self.dataset, config, self.face)}
        return self.corpora[key]


def _name_of(values: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:16]


def _finished(study: optuna.Study) -> list[FrozenTrial]:
    return study.get_trials(deepcopy=False, states=(TrialState.COMPLETE, TrialState.PRUNED))


def _rows(study: optuna.Study, search: Search) -> list[dict[str, Any]]:
    """All trials, best first; those that failed last."""
    rows = [_row(trial, search) for trial in _finished(study)]
    return sorted(rows, key=lambda row: (row["validation"] is None, row["validation"] or 0))


def _row(trial: FrozenTrial, search: Search) -> dict[str, Any]:
    chosen = {choice.key for choice in search.choices}
    values = {
        key: json.loads(value) if key in chosen else value for key, value in trial.params.items()
    }
    figures = {key: trial.user_attrs.get(key) for key in FIGURES}
    return {**values, **figures, "validation": trial.value}


def _write_table(path: Path, search: Search, rows: Sequence[Mapping[str, Any]]) -> None:
    with write_whole(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [*search.keys, *FIGURES])
        writer.writeheader()
        writer.writerows(rows)
