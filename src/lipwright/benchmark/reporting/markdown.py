"""The tables of a report as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from lipwright.benchmark.reporting.figures import ReportFigures, find_figures
from lipwright.benchmark.reporting.tables import (
    ALIKE,
    ALPHA,
    BRIDGED,
    Cell,
    View,
    ceiling_view,
    cost_view,
    head_views,
    heading_of,
    pass_view,
    score_view,
)
from lipwright.benchmark.values import Benchmark


def markdown_tables(benchmark: Benchmark) -> str:
    """All tables of a benchmark as Markdown."""
    return tables_as_markdown(find_figures(benchmark))


def tables_as_markdown(figures: ReportFigures) -> str:
    """All tables of figures that are known, as Markdown."""
    parts = [
        f"**bold**: the best. {ALIKE}: cannot be told from it (paired test, Holm, {ALPHA:g}). "
        f"{BRIDGED}: through the map from weights to modes. In brackets: 95 % intervals. "
        "`a of b`: over the first words alone, and what the speaker himself reaches there."
    ]
    for split in figures.splits:
        result = split.result
        parts.append(f"## {heading_of(result.name)}\n\n{text(result.about)}.")
        views = [score_view(figures, split, group) for group in ("error", "lips")]
        further = (ceiling_view(figures, split), *head_views(figures, split),
                   pass_view(figures, split))  # fmt: skip
        views += [view for view in further if view is not None]
        parts += [_markdown(view, level=3) for view in views if view.rows and view.columns]
    costs = cost_view(figures.benchmark)
    if costs is not None:
        parts.append(_markdown(costs, level=2))
    return "\n\n".join(parts) + "\n"


def _markdown(view: View, level: int) -> str:
    head = [view.first]
    for column in view.columns:
        unit = f" ({text(column.unit)})" if column.unit else ""
        head.append(f"{text(column.title)}{unit} {column.arrow}".strip())
    lines = [_line(head), _line(["---", *("---:" for _ in view.columns)])]
    lines += [_line([text(row.label), *map(_markdown_cell, row.cells)]) for row in view.rows]
    return f"{'#' * level} {text(view.title)}\n\n" + "\n".join(lines)


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _markdown_cell(cell: Cell) -> str:
    shown = f"**{cell.text}**" if cell.best and cell.text else text(cell.text)
    shown += f" {ALIKE}" if cell.alike else ""
    shown += f" ({cell.interval})" if cell.interval else ""
    return shown + (f"; {cell.note}" if cell.note else "")


_ESCAPES: Final[Mapping[int, str]] = str.maketrans({
    **{c: f"\\{c}" for c in "\\`*_[]|#"}, "<": "&lt;", ">": "&gt;", "&": "&amp;",
    "\n": " ", "\r": " ",
})  # fmt: skip


def text(words: str) -> str:
    """Words that Markdown shows as they are."""
    return words.translate(_ESCAPES)
