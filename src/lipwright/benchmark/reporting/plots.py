"""The drawings of a report as numbers: what stands where, in units of an SVG.

The templates draw them, so that colours follow the reader's light or dark page.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from lipwright.benchmark.reporting.figures import Figure, ReportFigures, SplitFigures
from lipwright.benchmark.reporting.numbers import Scale, scale_of
from lipwright.benchmark.reporting.summary import class_means
from lipwright.benchmark.reporting.tables import ARROWS, label_of
from lipwright.benchmark.values import Entry
from lipwright.evaluate.measures import MEASURES

FIGURE_10: Final = ("joint", "vertices", "inner")  # parameters, vertices, pixels
FURTHER: Final = ("joint_sd", "shape", "outer")
LIPS: Final = ("r", "closures", "false_closures")
TIMING: Final = ("silence", "lag", "face_r")

PANEL: Final = 300  # wide
BETWEEN: Final = 34  # of panels
ROW: Final = 24  # high
TOP: Final = 44  # above the rows: title and unit
BOTTOM: Final = 26  # below them: the axis
LETTER: Final = 7.2  # wide, of the labels at 13 px
LABEL_MOST: Final = 250
MARGIN: Final = 10
VALUE: Final = 56  # px for the number behind a dot
FROM_ZERO: Final = 1 / 3  # an axis starts at 0 where the least is below this of the most
TICKS: Final = 4  # about

CELL: Final = (58.0, 24.0)
SLANTED: Final = 96  # px for the names of classes, which are written aslant
LIGHT_TEXT: Final = 0.72  # share of the colour from which on text is light


@dataclass(frozen=True)
class Dot:
    """One entry's figure in a panel."""

    y: float
    x: float
    low: float
    high: float
    kind: str
    """the class that the style sheet colours"""
    hollow: bool
    """through the bridge"""
    text: str
    hint: str


@dataclass(frozen=True)
class Panel:
    """A measure."""

    left: float
    width: float
    title: str
    unit: str
    ticks: tuple[tuple[float, str], ...]
    dots: tuple[Dot, ...]
    ceiling: float | None = None
    """x of a dashed line"""


@dataclass(frozen=True)
class DotPlot:
    """Entries down, measures across."""

    name: str
    """of its file"""
    title: str
    width: float
    height: float
    bottom: float
    """y of the axis"""
    labels: tuple[tuple[float, str, str], ...]
    """y, text and kind"""
    label_right: float
    panels: tuple[Panel, ...]


@dataclass(frozen=True)
class HeatMap:
    """Entries down, classes of phones across."""

    name: str
    title: str
    width: float
    height: float
    labels: tuple[tuple[float, str], ...]
    label_right: float
    columns: tuple[tuple[float, str, str], ...]
    """x, name and count of frames"""
    cells: tuple[tuple[float, float, float, str, str, bool], ...]
    """x, y, share of the colour, text, hint, whether the text is to be light"""
    cell: tuple[float, float]
    """width and height"""
    top: float


def dot_plots(figures: ReportFigures, split: SplitFigures) -> Iterator[DotPlot]:
    """Figure 10 of Taylor et al. 2017, the further errors, and the lips."""
    name = split.result.name
    for part, title, names in (
        ("figure10", "Squared error in parameter, vertex and pixel space", FIGURE_10),
        ("errors", "Further squared errors", FURTHER), ("lips", "Against the tracked lips", LIPS),
        ("timing", "Silence, lag, and the aperture of the reference face", TIMING),
    ):  # fmt: skip
        shown = [one for one in names if any(one in row for row in split.scores.values())]
        if shown:
            yield _dot_plot(figures, split, f"{name}-{part}", title, shown)


def _dot_plot(
    figures: ReportFigures, split: SplitFigures, name: str, title: str, names: Sequence[str]
) -> DotPlot:
    entries = [entry for entry in figures.benchmark.entries
               if any(one in split.scores.get(entry.name, {}) for one in names)]  # fmt: skip
    right = _label_width([label_of(entry) for entry in entries])
    centres = {entry.name: TOP + ROW * (i + 0.5) for i, entry in enumerate(entries)}
    height = TOP + ROW * len(entries) + BOTTOM
    panels = [
        _panel(figures, split, one, right + BETWEEN / 2 + i * (PANEL + BETWEEN), centres)
        for i, one in enumerate(names)
    ]
    marked = any(MEASURES[one].group == "error" for one in names)
    labels = tuple(
        (centres[entry.name], label_of(entry) if marked else entry.title, entry.kind)
        for entry in entries
    )
    width = right + len(names) * (PANEL + BETWEEN)
    return DotPlot(name, title, width, height, height - BOTTOM, labels, right, tuple(panels))


def _label_width(labels: Sequence[str]) -> float:
    return min(max(map(len, labels), default=0) * LETTER + MARGIN, LABEL_MOST)


def _panel(
    figures: ReportFigures,
    split: SplitFigures,
    name: str,
    left: float,
    centres: Mapping[str, float],
) -> Panel:
    shown = {entry: split.scores[entry][name] for entry in centres
             if name in split.scores.get(entry, {})}  # fmt: skip
    own = split.ceiling.own.get(name) if split.ceiling is not None else None
    values = [x for figure in shown.values() for x in (figure.value, figure.low, figure.high)]
    axis = _axis([*values, *([own.value] if own is not None else [])], left)
    dots = tuple(
        _dot(entry, name, shown[entry.name], axis, centres[entry.name])
        for entry in figures.benchmark.entries
        if entry.name in shown and math.isfinite(shown[entry.name].value)
    )
    measure = MEASURES[name]
    ceiling = axis.x(own.value) if own is not None and math.isfinite(own.value) else None
    return Panel(
        left, PANEL, f"{measure.title} {ARROWS[measure.better]}", axis.scale.unit(measure.unit),
        axis.ticks(), dots, ceiling,
    )  # fmt: skip


def _dot(entry: Entry, name: str, figure: Figure, axis: _Axis, y: float) -> Dot:
    scale = axis.scale
    ends = [end if math.isfinite(end) else figure.value for end in (figure.low, figure.high)]
    hollow = entry.bridged and MEASURES[name].group == "error"
    interval = scale.interval(figure)
    hint = f"{entry.title}: {scale.shown(figure.value)}{f' ({interval})' if interval else ''}"
    return Dot(
        y, axis.x(figure.value), axis.x(ends[0]), axis.x(ends[1]), entry.kind, hollow,
        scale.shown(figure.value), hint,
    )  # fmt: skip


@dataclass(frozen=True)
class _Axis:
    low: float
    high: float
    left: float
    scale: Scale

    def x(self, value: float) -> float:
        """Pixels from the left, at most 0.05 off."""
        share = (value - self.low) / (self.high - self.low)
        return round(self.left + share * (PANEL - VALUE), 1)

    def ticks(self) -> tuple[tuple[float, str], ...]:
        """X and label of round numbers."""
        rough = (self.high - self.low) / TICKS
        size = 10.0 ** math.floor(math.log10(rough))
        step = next(m * size for m in (1, 2, 5, 10) if m * size >= rough * 0.999)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        exponent = self.scale.exponent
        decimals = max(-math.floor(math.log10(step / 10.0**exponent) + 1e-9), 0)
        shown = Scale(exponent, decimals)
        return tuple((self.x(i * step), shown.shown(i * step)) for i in range(first, last + 1))


def _axis(values: Sequence[float], left: float) -> _Axis:
    finite = [value for value in values if math.isfinite(value)]
    low, high = min(finite, default=0.0), max(finite, default=1.0)
    if 0 < low < FROM_ZERO * high:
        low = 0.0
    elif 0 > high > FROM_ZERO * low:
        high = 0.0
    if high - low <= 1e-12 * max(abs(high), abs(low), 1e-12):
        low, high = low - 0.5 * abs(low or 1.0), high + 0.5 * abs(high or 1.0)
    room = 0.04 * (high - low)
    return _Axis(low - (room if low else 0.0), high + room, left, scale_of(finite))


def heat_map(figures: ReportFigures, split: SplitFigures) -> HeatMap | None:
    """Error by class of phones, the hardest classes first; None without classes."""
    means = class_means(figures, split)
    names = sorted(means, key=lambda name: -means[name])
    entries = [entry for entry in figures.benchmark.entries if entry.name in split.classes]
    if not names or not entries:
        return None
    right, top = _label_width([label_of(entry) for entry in entries]), float(SLANTED)
    values = {
        (entry.name, name): figure.value
        for entry in entries for name, figure in split.classes[entry.name].items()
    }  # fmt: skip
    scale = scale_of(values.values())
    least, most = _range(values.values())
    cells = []
    for row, entry in enumerate(entries):
        for column, name in enumerate(names):
            value = values.get((entry.name, name), float("nan"))
            share = (value - least) / (most - least) if math.isfinite(value) else 0.0
            hint = f"{entry.title}, {name}: {scale.shown(value)}"
            cells.append((right + column * CELL[0], top + row * CELL[1], round(share, 3),
                          scale.shown(value), hint, share > LIGHT_TEXT))  # fmt: skip
    counts = {name: _frames(split, name) for name in names}
    return HeatMap(
        f"{split.result.name}-classes", "Error by class of phones",
        right + len(names) * CELL[0] + SLANTED * 0.8, top + len(entries) * CELL[1] + MARGIN,
        tuple((top + (i + 0.5) * CELL[1], label_of(entry)) for i, entry in enumerate(entries)),
        right,
        tuple((right + (i + 0.5) * CELL[0], name, f"{counts[name]:.0f} frames")
              for i, name in enumerate(names)),
        tuple(cells), CELL, top,
    )  # fmt: skip


def _range(values: Iterable[float]) -> tuple[float, float]:
    finite = [value for value in values if math.isfinite(value)]
    least, most = min(finite, default=0.0), max(finite, default=1.0)
    return least, most if most > least else least + 1.0


def _frames(split: SplitFigures, name: str) -> float:
    return max(
        (float(rows[name].counts.sum()) for rows in split.result.classes.values() if name in rows),
        default=0.0,
    )
