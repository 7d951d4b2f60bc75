"""The runs of bench/window_sweep.py as rows of a CSV, as tables, and as a picture."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from lipwright.files import write_whole


@dataclass(frozen=True)
class Row:
    """One finished run; its fields are the columns of the CSV."""

    features: str
    input_window: int
    output_window: int
    setting: str
    """targets, epochs, share of the recordings and seed; rows of other settings are other runs"""
    validation: float
    """mean squared error of the parameters"""
    validation_sd: float
    """the same, each over its standard deviation"""
    test: float
    test_sd: float
    test_r: float
    seconds: float
    """training, without evaluation"""

    @property
    def key(self) -> tuple[str, int, int, str]:
        """What was run."""
        return self.features, self.input_window, self.output_window, self.setting


def read_rows(path: Path) -> list[Row]:
    """The rows of a CSV; none where there is no file."""
    if not path.exists():
        return []
    kinds = {"str": str, "int": int, "float": float}
    with path.open(newline="", encoding="utf-8") as file:
        return [
            Row(**{field.name: kinds[str(field.type)](values[field.name]) for field in fields(Row)})
            for values in csv.DictReader(file)
        ]


def write_rows(path: Path, rows: Iterable[Row]) -> None:
    """All rows as CSV, whole or not at all."""
    with write_whole(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Row)])
        writer.writeheader()
        writer.writerows(asdict(row) for row in rows)


def grid_table(rows: list[Row], features: str) -> Iterator[str]:
    """Lines of a Markdown table of the test error: a line a Kx, a column a Ky."""
    found = {(row.input_window, row.output_window): row for row in rows if row.features == features}
    inputs, outputs = sorted({kx for kx, _ in found}), sorted({ky for _, ky in found})
    yield f"| {features}: Kx | " + " | ".join(f"Ky {ky}" for ky in outputs) + " |"
    yield "| --- |" + " --- |" * len(outputs)
    best = min(found.values(), key=lambda row: row.test_sd)
    for kx in inputs:
        cells = []
        for ky in outputs:
            row = found.get((kx, ky))
            cell = "" if row is None else f"{row.test_sd:.4f}"
            cells.append(f"**{cell}**" if row is best else cell)
        yield f"| {kx} | " + " | ".join(cells) + " |"


def draw(path: Path, rows: list[Row]) -> None:
    """Above, a heat map of the test error for each kind of features; below, its curves over Kx."""
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(row.features for row in rows))
    errors = [row.test_sd for row in rows]
    low, high = min(errors), max(errors)
    figure = Figure(figsize=(5.2 * len(names), 8.2), layout="constrained")
    axes = figure.subplots(2, len(names), squeeze=False)
    for column, name in enumerate(names):
        found = {(r.input_window, r.output_window): r.test_sd for r in rows if r.features == name}
        inputs, outputs = sorted({kx for kx, _ in found}), sorted({ky for _, ky in found})
        values = np.array([[found.get((kx, ky), np.nan) for kx in inputs] for ky in outputs])
        heat, curves = axes[:, column]
        image = heat.imshow(values, origin="lower", cmap="viridis", vmin=low, vmax=high)
        heat.set_xticks(range(len(inputs)), map(str, inputs))
        heat.set_yticks(range(len(outputs)), map(str, outputs))
        heat.set_title(f"{name} features")
        heat.set_xlabel("input window Kx, frames")
        heat.set_ylabel("output window Ky, frames")
        figure.colorbar(image, ax=heat, shrink=0.6)
        for index, ky in enumerate(outputs):
            shade = 0.15 + 0.7 * index / max(len(outputs) - 1, 1)
            curves.plot(inputs, values[index], color=(shade, 0.35, 1 - shade), label=f"Ky {ky}")
        curves.set_xticks(inputs)
        curves.set_ylim(low - 0.03 * (high - low), high)
        curves.set_xlabel("input window Kx, frames")
        curves.set_ylabel("mean squared error, test")
        curves.legend(fontsize=7, ncols=2)
    with write_whole(path) as part:
        figure.savefig(part, dpi=90, metadata={"Software": None})
