"""The figures of a report: every measure of every entry with its interval, and the comparisons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from lipwright.benchmark.values import Benchmark, Ceiling, Entry, SplitResult
from lipwright.evaluate.intervals import compare_all, holm, interval
from lipwright.evaluate.measures import MEASURES, Rows, Scores

Report = Callable[[str, float], None]
"""told the stage, and which share of it is done"""


@dataclass(frozen=True)
class Figure:
    """A measure over some recordings."""

    value: float
    """NaN where no recording has it"""
    low: float
    """of the interval of 95 %; NaN where there is none"""
    high: float
    recordings: int
    """that have it"""


Figures = Mapping[str, Figure]
"""measure, or class of phones, to figure"""

Table = Mapping[str, Figures]
"""entry to figures"""


@dataclass(frozen=True)
class Pair:
    """Two entries by one measure on the same recordings."""

    first: str
    second: str
    difference: float
    """first less second, in the measure's unit"""
    low: float
    """of the interval of 95 %"""
    high: float
    p: float
    """of the paired test"""
    p_holm: float
    """after Holm's correction over all pairs of the measure"""


@dataclass(frozen=True)
class CeilingFigures:
    """The speaker against himself, and every entry over the same words."""

    own: Figures
    mean_of_takes: Figures
    entries: Table


@dataclass(frozen=True, eq=False)
class SplitFigures:
    """One split."""

    result: SplitResult
    scores: Table
    by_head: Mapping[str, Table]
    bare: Table
    classes: Table
    """entry to class of phones to figure"""
    ceiling: CeilingFigures | None
    pairs: Mapping[str, tuple[Pair, ...]]
    """measure to its comparisons; the real face is not compared"""

    def pair(self, measure: str, first: str, second: str) -> Pair | None:
        """A comparison, `first` less `second`, whichever way it is kept."""
        for pair in self.pairs.get(measure, ()):
            if (pair.first, pair.second) == (first, second):
                return pair
            if (pair.first, pair.second) == (second, first):
                return Pair(
                    first, second, -pair.difference, -pair.high, -pair.low, pair.p, pair.p_holm
                )
        return None


@dataclass(frozen=True, eq=False)
class ReportFigures:
    """All figures of a benchmark."""

    benchmark: Benchmark
    splits: tuple[SplitFigures, ...]
    bridge: Figures

    def best(self, table: Table, name: str) -> str | None:
        """Who is best by a measure among the entries of a table; the real face is no entrant."""
        found = {
            entry.name: table[entry.name][name].value
            for entry in rivals(self.benchmark)
            if name in table.get(entry.name, {}) and np.isfinite(table[entry.name][name].value)
        }
        return min(found, key=lambda entry: badness(name, found[entry])) if found else None


def badness(name: str, value: float) -> float:
    """How bad a value of a measure is; what is no measure is the error of a class."""
    better = MEASURES[name].better if name in MEASURES else "lower"
    return {"lower": value, "higher": -value, "zero": abs(value)}[better]


def rivals(benchmark: Benchmark) -> tuple[Entry, ...]:
    """The entries that are compared: all but the real face."""
    return tuple(entry for entry in benchmark.entries if entry.kind != "real")


def find_figures(benchmark: Benchmark, report: Report = lambda stage, share: None) -> ReportFigures:
    """All figures, intervals and comparisons of a benchmark; the same for the same rows and seed.

    Args:
        benchmark: what was measured.
        report: told how far it is.
    """
    seed = benchmark.seed
    splits = tuple(_split(split, benchmark, report) for split in benchmark.splits)
    return ReportFigures(benchmark, splits, _figures(benchmark.bridge, seed))


def _split(result: SplitResult, benchmark: Benchmark, report: Report) -> SplitFigures:
    stage, seed = f"intervals of {result.name}", benchmark.seed
    report(stage, 0.0)
    scores = _table(result.scores, seed)
    report(stage, 0.2)
    by_head = {head: _table(table, seed) for head, table in result.by_head.items()}
    bare = _table(result.bare, seed)
    report(stage, 0.4)
    classes = _table(result.classes, seed)
    ceiling = None if result.ceiling is None else _ceiling(result.ceiling, seed)
    report(stage, 0.6)
    pairs = {}
    for number, name in enumerate(MEASURES):
        pairs[name] = _pairs(result, name, benchmark)
        report(stage, 0.6 + 0.4 * (number + 1) / len(MEASURES))
    found = {name: made for name, made in pairs.items() if made}
    return SplitFigures(
        result, scores, MappingProxyType(by_head), bare, classes, ceiling, MappingProxyType(found)
    )


def _ceiling(ceiling: Ceiling, seed: int) -> CeilingFigures:
    return CeilingFigures(
        _figures(ceiling.own, seed),
        _figures(ceiling.mean_of_takes, seed),
        _table(ceiling.entries, seed),
    )


def _table(scores: Mapping[str, Scores] | Mapping[str, Mapping[str, Rows]], seed: int) -> Table:
    return MappingProxyType({name: _figures(rows, seed) for name, rows in scores.items()})


def _figures(scores: Scores, seed: int) -> Figures:
    return MappingProxyType({name: _figure(rows, seed) for name, rows in scores.items()})


def _figure(rows: Rows, seed: int) -> Figure:
    count = int((rows.counts > 0).sum())
    if not count:
        return Figure(float("nan"), float("nan"), float("nan"), 0)
    found = interval(rows, seed=seed)
    return Figure(rows.value, float(found.low), float(found.high), count)


def _pairs(result: SplitResult, name: str, benchmark: Benchmark) -> tuple[Pair, ...]:
    """All pairs of entries by one measure; none with one that has none of it."""
    rows = {
        entry.name: result.scores[entry.name][name]
        for entry in rivals(benchmark)
        if name in result.scores.get(entry.name, {})
    }
    having = {entry: one for entry, one in rows.items() if one.counts.any()}
    found = compare_all(having, benchmark.seed)
    adjusted = holm([one.p for one in found])
    return tuple(
        Pair(one.first, one.second, one.difference, one.low, one.high, one.p, p_holm)
        for one, p_holm in zip(found, adjusted, strict=True)
    )
