"""The apertures of a recording as numbers: the real lips behind each entry's curve."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from lipwright.benchmark.values import Benchmark, Curves, Floats
from lipwright.phones import BILABIALS, SILENCE

WIDTH: Final = 1000  # px
CURVE: Final = 52  # high
LABEL: Final = 20  # above it
LANE: Final = 22  # of the phones
TIMES: Final = 20  # of the axis
TICK: Final = 0.5  # s
NARROW: Final = 10.0  # px below which a phone has no room for its name
MOST: Final = 1.3  # 95th percentiles; what is above is cut


@dataclass(frozen=True)
class Trace:
    """One entry."""

    top: float
    title: str
    kind: str
    path: str
    real: str
    """the area below the real lips"""


@dataclass(frozen=True)
class TracePlot:
    """A recording."""

    name: str
    """of its file"""
    recording: str
    text: str
    width: float
    height: float
    curve: float
    """height of a row's curve"""
    traces: tuple[Trace, ...]
    phones: tuple[tuple[float, float, str, str], ...]
    """x, width, name and kind: `closed` for p, b, m, `silence`, `phone`"""
    phones_y: float
    ticks: tuple[tuple[float, str], ...]


def trace_plot(benchmark: Benchmark, split: str, number: int, curves: Curves) -> TracePlot:
    """The curves of a recording over its phones.

    Args:
        benchmark: who takes part.
        split: its name.
        number: of the recording among those that are drawn.
        curves: of the recording.
    """
    start, end = _span(curves)
    pace = WIDTH / (end - start)
    across = (curves.times - start) * pace
    traces: list[Trace] = []
    for entry in benchmark.entries:
        if entry.name in curves.estimated:
            top = len(traces) * (LABEL + CURVE) + LABEL
            path = _path(across, curves.estimated[entry.name], top)
            real = _area(across, curves.real, top)
            traces.append(Trace(float(top), entry.title, entry.kind, path, real))
    phones_y = len(traces) * (LABEL + CURVE) + 4.0
    ticks = range(math.ceil(start / TICK), math.floor(end / TICK) + 1)
    return TracePlot(
        f"{split}-curves-{number}", curves.recording, curves.text.strip(), WIDTH,
        phones_y + LANE + TIMES, CURVE, tuple(traces), _phones(curves, start, end, pace), phones_y,
        tuple((round((t * TICK - start) * pace, 1), f"{t * TICK:.1f}") for t in ticks),
    )  # fmt: skip


def _span(curves: Curves) -> tuple[float, float]:
    start = min(float(curves.times[0]), float(curves.edges[0]))
    end = max(float(curves.times[-1]), float(curves.edges[-1]))
    return start, max(end, start + 0.1)


def _phones(
    curves: Curves, start: float, end: float, pace: float
) -> tuple[tuple[float, float, str, str], ...]:
    kinds: Mapping[str, str] = {SILENCE: "silence", **dict.fromkeys(BILABIALS, "closed")}
    found = []
    for phone, left, right in zip(curves.phones, curves.edges, curves.edges[1:], strict=False):
        x = round((max(float(left), start) - start) * pace, 1)
        width = round((min(float(right), end) - start) * pace - x, 1)
        found.append((x, width, phone if width >= NARROW else "", kinds.get(phone, "phone")))
    return tuple(found)


def _down(values: Floats, top: float) -> Floats:
    shares = np.clip(np.asarray(values, float), 0, MOST) / MOST
    return (top + CURVE * (1 - shares)).round(1)


def _path(across: Floats, values: Floats, top: float) -> str:
    """An SVG path, broken where there is no value."""
    parts, pen = [], "M"
    for x, y in zip(across.round(1).tolist(), _down(values, top).tolist(), strict=True):
        if math.isfinite(y):
            parts.append(f"{pen}{x} {y}")
            pen = "L"
        else:
            pen = "M"
    return "".join(parts)


def _area(across: Floats, values: Floats, top: float) -> str:
    """The area below a curve, in pieces where the face was lost."""
    bottom, parts = top + CURVE, []
    known = np.isfinite(np.asarray(values, float))
    turns = np.flatnonzero(np.diff(known, prepend=False, append=False))
    down = _down(values, top)
    for first, stop in turns.reshape(-1, 2):
        line = "L".join(
            f"{x} {y}" for x, y in zip(
                across[first:stop].round(1).tolist(), down[first:stop].tolist(), strict=True)
        )  # fmt: skip
        left, right = round(float(across[first]), 1), round(float(across[stop - 1]), 1)
        parts.append(f"M{left} {bottom}L{line}L{right} {bottom}Z")
    return "".join(parts)
