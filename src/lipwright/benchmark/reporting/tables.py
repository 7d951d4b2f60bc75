"""The tables of a report, as rows of texts: the page and the Markdown draw the same."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from lipwright.benchmark.reporting.figures import (
    Figure,
    Figures,
    ReportFigures,
    SplitFigures,
    Table,
    badness,
)
from lipwright.benchmark.reporting.numbers import (
    DASH,
    Scale,
    scale_of,
    shown_bytes,
    shown_p,
    shown_seconds,
)
from lipwright.benchmark.values import Benchmark, Entry
from lipwright.evaluate.measures import MEASURES, Group

ALPHA: Final = 0.05  # below it a difference is called significant
BRIDGED: Final = "†"
ALIKE: Final = "≈"
CEILED: Final = ("face_r", "r", "r_best_lag")  # measures beside which the ceiling stands
ARROWS: Final = {"lower": "↓", "higher": "↑", "zero": "→ 0"}


@dataclass(frozen=True)
class Column:
    """The heading of a column of numbers."""

    title: str
    unit: str = ""
    arrow: str = ""
    """where it is better"""
    about: str = ""


@dataclass(frozen=True)
class Cell:
    """One figure."""

    text: str
    interval: str = ""
    note: str = ""
    """the ceiling beside it"""
    best: bool = False
    alike: bool = False
    """it cannot be told from the best"""
    hint: str = ""


@dataclass(frozen=True)
class Row:
    """A labelled row; `entry` is None for what is no entry."""

    label: str
    cells: tuple[Cell, ...]
    entry: Entry | None = None


@dataclass(frozen=True)
class View:
    """A table to be drawn."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    first: str = "Engine"
    """heading of the labels"""


def label_of(entry: Entry) -> str:
    """The entry's title, marked where its errors come through the bridge."""
    return f"{entry.title} {BRIDGED}" if entry.bridged else entry.title


def score_view(figures: ReportFigures, split: SplitFigures, group: Group) -> View:
    """Entries by the measures of a group, the best and those like it marked."""
    present = {name for row in split.scores.values() for name in row}
    names = [name for name, one in MEASURES.items() if one.group == group and name in present]
    title = {"error": "Against the reference face", "lips": "Against the tracked lips"}[group]
    bridge = figures.bridge if split.result.name == "test" else {}
    extra = [("the bridge alone", bridge)] if set(names) & set(bridge) else []
    return figures_view(figures, split.scores, names, title, split=split, extra=extra)


def figures_view(
    figures: ReportFigures, table: Table, names: Sequence[str], title: str, *,
    split: SplitFigures | None = None, extra: Sequence[tuple[str, Figures]] = (),
) -> View:  # fmt: skip
    """Entries by measures.

    Args:
        figures: all of them.
        table: the figures to show.
        names: the measures, in their order.
        title: of the table.
        split: whose comparisons mark what cannot be told from the best, and whose ceiling stands
            beside r.
        extra: further rows below.
    """
    shown = [*table.values(), *(row for _, row in extra)]
    scales = {name: scale_of(row[name].value for row in shown if name in row) for name in names}
    best = {name: figures.best(table, name) for name in names}
    errors = any(MEASURES[name].group == "error" for name in names)
    rows = [
        Row(label_of(entry) if errors else entry.title, tuple(
            _cell(figures, table, entry.name, name, scales[name], best[name], split)
            for name in names), entry)
        for entry in figures.benchmark.entries if entry.name in table
    ]  # fmt: skip
    for label, row in extra:
        rows.append(Row(label, tuple(_plain_cell(row.get(name), scales[name]) for name in names)))
    return View(title, tuple(_column(name, scales[name]) for name in names), tuple(rows))


def _column(name: str, scale: Scale) -> Column:
    measure = MEASURES[name]
    return Column(
        measure.title, scale.unit(measure.unit), ARROWS[measure.better], measure.about
    )  # fmt: skip


def _cell(
    figures: ReportFigures, table: Table, entry: str, name: str, scale: Scale, best: str | None,
    split: SplitFigures | None,
) -> Cell:  # fmt: skip
    figure = table[entry].get(name)
    if figure is None or not math.isfinite(figure.value):
        return Cell(DASH)
    pair = split.pair(name, entry, best) if split is not None and best is not None else None
    alike = pair is not None and not pair.p_holm < ALPHA
    hint = f"against the best p {shown_p(pair.p_holm)} after Holm" if pair is not None else ""
    note = _beside(split, entry, name, scale) if split is not None else ""
    return Cell(scale.shown(figure.value), scale.interval(figure), note, entry == best, alike, hint)


def _beside(split: SplitFigures, entry: str, name: str, scale: Scale) -> str:
    """An r over the words that the ceiling is over, and the ceiling."""
    if name not in CEILED or split.ceiling is None or split.result.ceiling is None:
        return ""
    own = split.ceiling.own.get(name)
    same = split.ceiling.entries.get(entry, {}).get(name)
    if own is None or not math.isfinite(own.value):
        return ""
    reached = scale.shown(same.value) if same is not None else DASH
    return f"{reached} of {scale.shown(own.value)}"


def _plain_cell(figure: Figure | None, scale: Scale) -> Cell:
    if figure is None or not math.isfinite(figure.value):
        return Cell(DASH)
    return Cell(scale.shown(figure.value), scale.interval(figure))


def head_views(figures: ReportFigures, split: SplitFigures) -> Iterator[View]:
    """The lips' measures on each head."""
    for head, table in split.by_head.items():
        yield figures_view(figures, table, _of_lips(table), f"On {head}")


def _of_lips(*tables: Table) -> list[str]:
    return [name for name in MEASURES if any(name in row for t in tables for row in t.values())]


def pass_view(figures: ReportFigures, split: SplitFigures) -> View | None:
    """With the passes of `animate` and without, on our head."""
    head = figures.benchmark.heads[0] if figures.benchmark.heads else ""
    dressed = split.by_head.get(head, {})
    if not split.bare or not dressed:
        return None
    names = _of_lips(split.bare)
    scales = {
        name: scale_of(row[name].value for table in (split.bare, dressed) for row in table.values()
                       if name in row) for name in names
    }  # fmt: skip
    rows = []
    for entry in figures.benchmark.entries:
        if entry.name in split.bare:
            for table, what in ((dressed, "with"), (split.bare, "without")):
                cells = (_plain_cell(table.get(entry.name, {}).get(n), scales[n]) for n in names)
                label = entry.title if what == "with" else ""
                rows.append(Row(label, (Cell(what), *cells), entry))
    columns = (Column("passes"), *(_column(name, scales[name]) for name in names))
    return View(f"With and without passes, on {head}", columns, tuple(rows))


def ceiling_view(figures: ReportFigures, split: SplitFigures) -> View | None:
    """The speaker himself, the mean of his takes, and every entry over the same words."""
    found = split.ceiling
    if found is None:
        return None
    names = [name for name in MEASURES if name in found.own]
    extra = [("the speaker, another take", found.own)]
    if found.mean_of_takes:
        extra.append(("the mean of his other takes", found.mean_of_takes))
    return figures_view(figures, found.entries, names, "The ceiling", extra=extra)


def cost_view(benchmark: Benchmark) -> View | None:
    """Size, training and speed."""
    if not benchmark.costs:
        return None
    rows = []
    for entry in benchmark.entries:
        cost = benchmark.costs.get(entry.name)
        if cost is not None:
            speed = DASH if cost.real_time is None else f"{cost.real_time:.3g} ×"
            texts = (shown_bytes(cost.model_bytes), shown_seconds(cost.training_s), speed)
            rows.append(Row(entry.title, tuple(map(Cell, texts)), entry))
    columns = (Column("model"), Column("training"), Column("speed", "real time, one core"))
    return View("Costs", columns, tuple(rows))


def pair_view(figures: ReportFigures, split: SplitFigures, name: str) -> View | None:
    """Each row's entry less each column's by one measure."""
    pairs = split.pairs.get(name, ())
    present = {one for pair in pairs for one in (pair.first, pair.second)}
    entries = [entry for entry in figures.benchmark.entries if entry.name in present]
    if len(entries) < 2:
        return None
    scale = scale_of(pair.difference for pair in pairs)
    rows = []
    for entry in entries:
        cells = [_difference(split, name, entry, other, scale) for other in entries]
        rows.append(Row(entry.title, tuple(cells), entry))
    columns = tuple(Column(entry.title) for entry in entries)
    unit = scale.unit(MEASURES[name].unit)
    title = f"{MEASURES[name].title}{f', {unit}' if unit else ''}"
    return View(title, columns, tuple(rows), "Row less column")


def _difference(
    split: SplitFigures, name: str, entry: Entry, other: Entry, scale: Scale
) -> Cell:  # fmt: skip
    pair = split.pair(name, entry.name, other.name)
    if entry is other or pair is None:
        return Cell("" if entry is other else DASH)
    interval = f"{scale.shown(pair.low)} to {scale.shown(pair.high)}"
    alike = not pair.p_holm < ALPHA
    hint = f"{interval}; p {shown_p(pair.p)}, {shown_p(pair.p_holm)} after Holm"
    better = is_better(split, name, entry.name, other.name)
    return Cell(scale.shown(pair.difference), "", "", better and not alike, alike, hint)


def is_better(split: SplitFigures, name: str, entry: str, other: str) -> bool:
    """Whether an entry is ahead of another by a measure."""
    one, two = split.scores[entry][name], split.scores[other][name]
    return badness(name, one.value) < badness(name, two.value)


def heading_of(split: str) -> str:
    """The title of a split."""
    return {"test": "Held-out sentences", "unseen": "Unseen words"}.get(split, split)
