"""The benchmark, a column of verbs: train everybody, let them perform, measure, report."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.benchmark.ceiling import measure_ceiling
from lipwright.benchmark.curve_folders import write_curves
from lipwright.benchmark.drawn import drawn_curves
from lipwright.benchmark.entrants import Entrant, choose_entrants
from lipwright.benchmark.motion import FPS, Performer
from lipwright.benchmark.options import BenchmarkOptions
from lipwright.benchmark.performers import ready_performers
from lipwright.benchmark.reporting import write_report
from lipwright.benchmark.scoring import (
    Performance,
    Stage,
    make_bridge,
    measure,
    set_stage,
)
from lipwright.benchmark.speed import measure_cost
from lipwright.benchmark.training import Model, train_model
from lipwright.benchmark.values import Benchmark, Cost, Entry, SplitResult
from lipwright.benchmark.variants import Variant, make_variants
from lipwright.benchmark.versions import versions
from lipwright.benchmark.watching import write_sheets
from lipwright.clip import Clip
from lipwright.controls import ARKIT
from lipwright.dataset.folder import Dataset, open_dataset, sha256_of
from lipwright.dataset.lock import locked
from lipwright.dataset.recording import Recording
from lipwright.errors import LipwrightError
from lipwright.evaluate.errors import error_rows
from lipwright.evaluate.heads import rulers
from lipwright.evaluate.lips import speech_span
from lipwright.evaluate.measures import Scores
from lipwright.face.reference import ReferenceFace
from lipwright.face.reference_file import load_reference_face

Report = Callable[[str, float], None]
Tell = Callable[[dict[str, Any]], None]

REPORT_FILE: Final = "report.json"
MODELS: Final = "models"  # folder of the models, which another run uses again
CURVES: Final = "curves"


@dataclass(frozen=True, eq=False)
class Ground:
    """What is the same for every split."""

    dataset: Dataset
    face: ReferenceFace
    face_path: Path
    face_hash: str
    options: BenchmarkOptions
    out: Path
    entrants: tuple[Entrant, ...]


def run_benchmark(
    path: Path, options: BenchmarkOptions, out: Path, report: Report, tell: Tell
) -> Benchmark:
    """Measure everybody on a dataset and write the report to the folder `out`.

    Models that were trained for it stay in `out`; a run that was stopped goes on there.

    Args:
        path: of a captured dataset with the parameters of a reference face.
        options: who takes part, and how.
        out: folder of the report.
        report: told of a stage and how much of it is done.
        tell: told of what is done: an entrant and a split, or an epoch of a training.

    Raises:
        LipwrightError: the dataset has not what is needed, somebody who is asked for cannot take
            part, or the folder cannot be written.
    """
    ground = _ground(path, options, out)
    trains = any(one.config is not None for one in ground.entrants)
    variants = make_variants(ground.dataset, options, trains=trains)
    with locked(out, "report"):
        # What cannot be measured, or measured with, is found before hours of training.
        stages = {variant.name: _stage(ground, variant) for variant in variants}
        ready = {
            one.name: ready_performers(ground.entrants, ground.dataset, one, stages[one.name])
            for one in variants
        }
        trained = _train(ground, variants, report, tell)
        splits: list[SplitResult] = []
        costs: dict[str, Cost] = {}
        bridge: Scores = {}
        native: set[str] = set()
        for variant in variants:
            stage = stages[variant.name]
            performers = _performers(ground, variant, trained, ready[variant.name])
            found = _perform(performers, stage, variant, report)
            splits.append(_split(ground, variant, stage, found, report))
            _keep_curves(ground, variant, found, stage)
            if variant.name == "test":
                bridge = _bridge_error(stage)
                costs = _costs(performers, trained, stage, report)
                native = {one.entrant.name for one in performers if one.learns_modes}
                write_sheets(ground.out, stage, ground.entrants, found, options.videos, report)
        benchmark = _benchmark(ground, tuple(splits), costs, bridge, native)
        write_report(benchmark, out, report)
    return benchmark


def _ground(path: Path, options: BenchmarkOptions, out: Path) -> Ground:
    entrants = choose_entrants(options)
    dataset = open_dataset(path)
    face = options.face or Path(f"{dataset.path}-face.npz")
    if not os.path.isfile(face):  # noqa: PTH113  # also one too long for a path
        raise LipwrightError(
            f"{face}: no such reference face; run: lipwright face fit {path} -o {face}, or name "
            "it with --face"
        )
    _refuse_others(out)
    return Ground(dataset, load_reference_face(face), face, sha256_of(face), options, out, entrants)


def _refuse_others(out: Path) -> None:
    """Leave alone a folder that is no report of ours."""
    ours = {REPORT_FILE, MODELS}
    try:
        if out.exists() and not out.is_dir():
            raise LipwrightError(f"{out}: is a file; name a folder")
        if out.is_dir() and any(out.iterdir()) and not any((out / name).exists() for name in ours):
            raise LipwrightError(f"{out}: is a folder with other files; name a new folder")
        (out / MODELS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LipwrightError(
            f"{error.filename or out}: cannot be made: {error.strerror}"
        ) from error


def _train(
    ground: Ground, variants: Sequence[Variant], report: Report, tell: Tell
) -> dict[tuple[str, str], Model]:
    """Entrant and variant to its model."""
    learners = [one for one in ground.entrants if one.config is not None]
    tasks = [(one, variant) for variant in variants for one in learners]
    found: dict[tuple[str, str], Model] = {}
    for number, (one, variant) in enumerate(tasks):

        def inner(stage: str, share: float, number: int = number) -> None:
            if stage == "train":
                report("train", (number + share) / len(tasks))

        model = train_model(
            one, variant, ground.face_path, ground.options, ground.out / MODELS, inner, tell
        )
        found[one.name, variant.name] = model
        tell({"trained": one.name, "split": variant.name, "seconds": round(model.seconds, 1)})
        report("train", (number + 1) / len(tasks))
    return found


def _stage(ground: Ground, variant: Variant) -> Stage:
    digest = ground.face_hash
    bridge = make_bridge(variant.dataset, ground.face, digest)
    heads = rulers(ground.options.second_head)
    return set_stage(ground.face, digest, variant.dataset, variant.recordings, bridge, heads)


def _performers(
    ground: Ground, variant: Variant, trained: Mapping[tuple[str, str], Model],
    ready: Mapping[str, Performer],
) -> list[Performer]:  # fmt: skip
    """Everybody who performs, in order."""
    return [
        ready[one.name] if one.config is None
        else Performer(one, trained[one.name, variant.name].folder)
        for one in ground.entrants
        if one.config is not None or one.name in ready
    ]  # fmt: skip


def _perform(
    performers: Sequence[Performer], stage: Stage, variant: Variant, report: Report
) -> dict[str, Performance]:
    found = {}
    for number, performer in enumerate(performers):
        found[performer.entrant.name] = measure(performer, stage)
        report(f"measure {variant.name}", (number + 1) / len(performers))
    return found


def _split(
    ground: Ground, variant: Variant, stage: Stage, found: Mapping[str, Performance],
    report: Report,
) -> SplitResult:  # fmt: skip
    report("ceiling", 0.0)
    ceiling = measure_ceiling(ground.dataset, stage, found, ground.face_hash)
    report("ceiling", 1.0)
    spans = [speech_span(one.track) for one in stage.recordings]
    return SplitResult(
        name=variant.name, about=variant.about, recordings=variant.recordings,
        frames=sum(int(truth.valid.sum()) for truth in stage.truths),
        speech_s=float(sum(end - start for start, end in spans)),
        scores={name: one.scores for name, one in found.items()},
        by_head={
            head: {name: one.by_head[head] for name, one in found.items() if one.by_head}
            for head in stage.heads
        },
        bare={name: one.bare for name, one in found.items() if one.bare},
        classes={name: one.classes for name, one in found.items()},
        ceiling=ceiling,
        curves=drawn_curves(stage, found),
    )  # fmt: skip


def _keep_curves(
    ground: Ground, variant: Variant, found: Mapping[str, Performance], stage: Stage
) -> None:
    if not ground.options.keep_curves:
        return
    for name, one in found.items():
        clips = {
            recording.name: moves.animated
            for recording, moves in zip(stage.recordings, one.moves, strict=True)
            if moves.animated is not None
        }
        if clips:
            write_curves(ground.out / CURVES / name / variant.name, clips)


def _captured(recording: Recording) -> Clip:
    """The captured weights, frame by frame; at rest where no face was seen."""
    weights = np.nan_to_num(recording.motion.arkit)
    return Clip(ARKIT, recording.motion.fps, weights)


def _bridge_error(stage: Stage) -> Scores:
    """The real weights through the bridge."""
    modes = [stage.bridge.apply(_captured(recording)) for recording in stage.recordings]
    return error_rows(stage.face, stage.truths, modes)


def _costs(
    performers: Sequence[Performer], trained: Mapping[tuple[str, str], Model], stage: Stage,
    report: Report,
) -> dict[str, Cost]:  # fmt: skip
    found = {}
    for number, performer in enumerate(performers):
        name = performer.entrant.name
        found[name] = measure_cost(performer, trained.get((name, "test")), stage.recordings)
        report("speed", (number + 1) / len(performers))
    return found


def _benchmark(
    ground: Ground, splits: tuple[SplitResult, ...], costs: Mapping[str, Cost], bridge: Scores,
    native: Set[str],
) -> Benchmark:  # fmt: skip
    options = ground.options
    return Benchmark(
        dataset=str(ground.dataset.manifest.get("name", "")) or ground.dataset.path.name,
        licence=str(ground.dataset.manifest.get("licence", "")),
        seed=options.seed,
        facts={
            "versions": versions(), "quick": options.quick, "fps": FPS,
            "face_sha256": ground.face_hash,
            "hold_out": list(options.hold_out), "hold_out_words": list(options.hold_out_words),
        },
        entries=tuple(
            Entry(one.name, one.title, one.kind, one.about, one.name not in native)
            for one in ground.entrants
        ),
        splits=splits, costs=costs, bridge=bridge,
        heads=tuple(splits[0].by_head),
    )  # fmt: skip


def best_r(benchmark: Benchmark) -> tuple[str, float]:
    """The entrant with the highest r on the test, but for the real face."""
    scores = benchmark.splits[0].scores
    rs = {
        entry.name: scores[entry.name]["r"].value
        for entry in benchmark.entries
        if entry.kind != "real" and "r" in scores.get(entry.name, {})
    }
    if not rs:
        return "", math.nan
    name = max(rs, key=lambda key: rs[key])
    return name, rs[name]
