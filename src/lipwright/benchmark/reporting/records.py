"""The figures as JSON and CSV, for programs.

report.json and all CSV files but costs.csv are the same bytes for the same rows: they hold no
dates, no times that something took and no paths. What differs from run to run is in costs.json.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from lipwright.benchmark.reporting.figures import Figure, Pair, ReportFigures, SplitFigures, Table
from lipwright.benchmark.values import Benchmark
from lipwright.dataset.recording import to_json
from lipwright.evaluate.measures import MEASURES, Rows
from lipwright.files import write_whole

DIGITS: Final = 6  # significant; an interval's ends are known to two or three
REPORT: Final = "report.json"
COSTS: Final = "costs.json"

Row = Sequence[object]


def write_records(figures: ReportFigures, folder: Path) -> None:
    """Write report.json, costs.json and the CSV files.

    Raises:
        LipwrightError: a file cannot be written.
    """
    _write(folder / REPORT, to_json(plain(_report(figures))))
    _write(folder / COSTS, to_json(plain(_costs(figures.benchmark))))
    for name, heading, rows in _csv_tables(figures):
        _write(folder / name, as_csv(heading, rows))


def _write(path: Path, text: str) -> None:
    with write_whole(path) as part:
        part.write_text(text, "utf-8", errors="replace", newline="\n")


def plain(value: Any) -> Any:
    """A value of JSON: keys sorted, numbers of six digits, None for what is no number."""
    if isinstance(value, Mapping):
        return {str(key): plain(value[key]) for key in sorted(value, key=str)}
    if isinstance(value, list | tuple | set | frozenset):
        ordered = sorted(value, key=str) if isinstance(value, set | frozenset) else value
        return [plain(item) for item in ordered]
    if hasattr(value, "tolist"):  # of numpy
        return plain(value.tolist())
    if isinstance(value, float):
        return rounded(value)
    return value if value is None or isinstance(value, bool | int | str) else str(value)


def rounded(value: float) -> float | None:
    """A number of six significant digits; None for what is none."""
    return float(f"{value:.{DIGITS}g}") + 0.0 if math.isfinite(value) else None


def _report(figures: ReportFigures) -> dict[str, Any]:
    benchmark = figures.benchmark
    return {
        "dataset": benchmark.dataset,
        "licence": benchmark.licence,
        "seed": benchmark.seed,
        "facts": benchmark.facts,
        "heads": benchmark.heads,
        "entries": [asdict(entry) for entry in benchmark.entries],
        "measures": {name: asdict(measure) for name, measure in MEASURES.items()},
        "bridge": {name: _figure(figure) for name, figure in figures.bridge.items()},
        "splits": {split.result.name: _split(split) for split in figures.splits},
    }


def _figure(figure: Figure) -> dict[str, Any]:
    return asdict(figure)


def _table(table: Table) -> dict[str, Any]:
    return {
        entry: {name: _figure(figure) for name, figure in figures.items()}
        for entry, figures in table.items()
    }


def _split(split: SplitFigures) -> dict[str, Any]:
    result = split.result
    return {
        "about": result.about,
        "recordings": result.recordings,
        "frames": result.frames,
        "speech_s": result.speech_s,
        "figures": _table(split.scores),
        "by_head": {head: _table(table) for head, table in split.by_head.items()},
        "bare": _table(split.bare),
        "classes": _classes(split),
        "ceiling": _ceiling(split),
        "pairs": {name: [asdict(pair) for pair in pairs] for name, pairs in split.pairs.items()},
        "values": _values(split),
    }


def _classes(split: SplitFigures) -> dict[str, Any]:
    return {
        entry: {
            name: {**_figure(figure), "frames": _frames(split, entry, name)}
            for name, figure in figures.items()
        }
        for entry, figures in split.classes.items()
    }  # fmt: skip


def _frames(split: SplitFigures, entry: str, name: str) -> float:
    """The frames of a class of phones."""
    return float(split.result.classes[entry][name].counts.sum())


def _ceiling(split: SplitFigures) -> dict[str, Any] | None:
    found, made = split.result.ceiling, split.ceiling
    if found is None or made is None:
        return None
    return {
        "words": found.words,
        "recordings": found.recordings,
        "partners": found.partners,
        "own": {name: _figure(figure) for name, figure in made.own.items()},
        "own_median_r": found.own_median_r,
        "mean_of_takes": {name: _figure(figure) for name, figure in made.mean_of_takes.items()},
        "entries": _table(made.entries),
    }


def _values(split: SplitFigures) -> dict[str, Any]:
    """Entry, measure and recording to its value."""
    names = split.result.recordings
    return {
        entry: {
            name: dict(zip(names, rows.each.tolist(), strict=True)) for name, rows in scores.items()
        }
        for entry, scores in split.result.scores.items()
    }


def _costs(benchmark: Benchmark) -> dict[str, Any]:
    return {name: asdict(cost) for name, cost in benchmark.costs.items()}


def _csv_tables(figures: ReportFigures) -> Iterator[tuple[str, Row, Iterator[Row]]]:
    """Name, heading and rows of each CSV file."""
    ends = ("value", "low", "high")
    yield ("figures.csv", ("split", "entry", "measure", "unit", *ends, "recordings"),
           _figure_rows(figures))  # fmt: skip
    yield ("recordings.csv", ("split", "recording", "entry", "measure", "value"),
           _recording_rows(figures))  # fmt: skip
    yield ("pairs.csv", ("split", "measure", "first", "second", "difference", "low", "high", "p",
                         "p_holm"), _pair_rows(figures))  # fmt: skip
    yield "classes.csv", ("split", "entry", "class", *ends, "frames"), _class_rows(figures)
    yield ("costs.csv", ("entry", "model_bytes", "training_s", "real_time"),
           ((entry, *asdict(cost).values()) for entry, cost in figures.benchmark.costs.items())
    )  # fmt: skip


def _figure_rows(figures: ReportFigures) -> Iterator[Row]:
    for split in figures.splits:
        for entry, table in split.scores.items():
            for name, figure in table.items():
                unit = MEASURES[name].unit
                ends = (figure.value, figure.low, figure.high)
                yield (split.result.name, entry, name, unit, *ends, figure.recordings)


def _recording_rows(figures: ReportFigures) -> Iterator[Row]:
    for split in figures.splits:
        each: dict[tuple[str, str], Rows] = {
            (entry, name): rows
            for entry, scores in split.result.scores.items() for name, rows in scores.items()
        }  # fmt: skip
        values = {key: rows.each.tolist() for key, rows in each.items()}
        for number, recording in enumerate(split.result.recordings):
            for (entry, name), column in values.items():
                yield split.result.name, recording, entry, name, column[number]


def _pair_rows(figures: ReportFigures) -> Iterator[Row]:
    for split in figures.splits:
        for name, pairs in split.pairs.items():
            yield from ((split.result.name, name, *_pair_cells(pair)) for pair in pairs)


def _pair_cells(pair: Pair) -> Row:
    return tuple(asdict(pair).values())


def _class_rows(figures: ReportFigures) -> Iterator[Row]:
    for split in figures.splits:
        for entry, table in split.classes.items():
            for name, figure in table.items():
                ends = (figure.value, figure.low, figure.high)
                yield (split.result.name, entry, name, *ends, _frames(split, entry, name))


def as_csv(heading: Row, rows: Iterator[Row]) -> str:
    """A table with commas; what is no number stays empty, and no text is a formula."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(heading)
    table.writerows([_cell(value) for value in row] for row in rows)
    return text.getvalue()


def _cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, float):
        number = rounded(value)
        return "" if number is None else f"{number:.{DIGITS}g}"
    if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r", "\n")):
        return f"'{value}"  # a spreadsheet would compute it
    return value
