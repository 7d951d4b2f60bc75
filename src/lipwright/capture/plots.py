"""The drawings of the quality report as numbers: what stands where, in pixels of an SVG.

The templates draw them, so that colours follow the reader's light or dark page.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.quality import bilabial_closures, loud_aperture
from lipwright.dataset.recording import Flag, Recording
from lipwright.evaluate.lips import CLOSED
from lipwright.phones import SILENCE

Floats = npt.NDArray[np.floating]

WIDTH: Final = 1000  # pixels of a row
LEFT: Final = 36  # pixels for the numbers of the axis
ROW_SECONDS: Final = 4.0  # at most
CURVE_TOP: Final = 12
CURVE_HEIGHT: Final = 150
PHONES_Y: Final = CURVE_TOP + CURVE_HEIGHT  # the lanes below the curves
WORDS_Y: Final = PHONES_Y + 18
TIMES_Y: Final = WORDS_Y + 20
ROW_HEIGHT: Final = TIMES_Y + 16
TICK: Final = 0.5  # s
NARROW: Final = 9.0  # pixels below which a phone has no room for its name

BINS: Final = 24
BAR: Final = 10  # pixels, width of a bar
HISTOGRAM_HEIGHT: Final = 72


@dataclass(frozen=True)
class Span:
    """A stretch of a row."""

    x: float
    width: float
    kind: str
    """the class that the style sheet colours"""
    text: str = ""
    hint: str = ""


@dataclass(frozen=True)
class PlotRow:
    """A few seconds of a recording."""

    curves: tuple[tuple[str, str], ...]
    """kind and path of each curve"""
    limit: float | None
    """y of the 15 % mark"""
    bands: tuple[Span, ...]
    """behind the curves: bilabials, lost and odd frames"""
    phones: tuple[Span, ...]
    words: tuple[Span, ...]
    ticks: tuple[tuple[float, str], ...]
    """x and label"""


Labelled = tuple[float, float, str, str]
"""start and end in s, kind and text"""


@dataclass(frozen=True)
class _Scale:
    start: float
    end: float
    top: float

    @property
    def pace(self) -> float:
        """Pixels a second."""
        return (WIDTH - LEFT) / (self.end - self.start)

    def x(self, time: float) -> float:
        """Pixels from the left, at most 0.05 off."""
        return round(LEFT + (time - self.start) * self.pace, 1)

    def y(self, value: float) -> float:
        return round(CURVE_TOP + CURVE_HEIGHT * (1 - value / self.top), 1)

    def span(self, start: float, end: float, kind: str, text: str = "", hint: str = "") -> Span:
        left, right = self.x(max(start, self.start)), self.x(min(end, self.end))
        return Span(left, round(right - left, 1), kind, text, hint)

    def inside(self, spans: Sequence[Labelled]) -> list[Labelled]:
        """Those of the spans that reach into the row."""
        return [span for span in spans if span[0] < self.end and span[1] > self.start]


def plot_rows(recording: Recording, head_aperture: Floats | None = None) -> list[PlotRow]:
    """The aperture of a recording over its phones, a few seconds a row.

    Args:
        recording: what to draw; one without landmarks has only the head's aperture.
        head_aperture: (T,), of the head posed by the ARKit weights.
    """
    motion, times = recording.motion, recording.times
    half = 0.5 / motion.fps
    start = min(times[0] - half, recording.track.start)
    end = max(times[-1] + half, recording.track.end)
    curves = [
        (kind, values)
        for kind, values in (
            ("smooth", motion.aperture), ("head", head_aperture), ("raw", motion.aperture_raw),
        )
        if values is not None and np.isfinite(values).any()
    ]  # fmt: skip
    top = 1.06 * max((float(np.nanmax(values)) for _, values in curves), default=0.0)
    bands = _bands(recording)
    words = [(*recording.track.word_span(word), "word", word.text)
             for word in recording.track.words]  # fmt: skip
    limit = None
    if motion.aperture is not None and np.isfinite(motion.aperture).any():
        limit = CLOSED * loud_aperture(motion.aperture)
    count = math.ceil((end - start) / ROW_SECONDS)
    edges = np.linspace(start, end, count + 1)
    return [
        PlotRow(
            curves=tuple((k, _path(recording.times, values, scale)) for k, values in curves),
            limit=None if limit is None else scale.y(limit),
            bands=tuple(scale.span(*band[:3], hint=band[3]) for band in scale.inside(bands)),
            phones=tuple(_phones(recording, scale)),
            words=tuple(scale.span(*word) for word in scale.inside(words)),
            ticks=tuple(_ticks(scale)),
        )
        for scale in (_Scale(float(a), float(b), max(top, 1e-6)) for a, b in pairwise(edges))
    ]


def _phones(recording: Recording, scale: _Scale) -> Iterator[Span]:
    track = recording.track
    first = max(int(np.searchsorted(track.edges, scale.start, side="right")) - 1, 0)
    stop = min(int(np.searchsorted(track.edges, scale.end)), len(track))
    for index in range(first, stop):
        phone, start, end = track.phones[index], track.edges[index], track.edges[index + 1]
        span = scale.span(start, end, "silence" if phone == SILENCE else "phone")
        name = phone if span.width >= NARROW else ""
        yield replace(span, text=name, hint=f"{phone} {start:.3f} to {end:.3f} s")


def _ticks(scale: _Scale) -> Iterator[tuple[float, str]]:
    for tick in range(math.ceil(scale.start / TICK), math.floor(scale.end / TICK) + 1):
        yield scale.x(tick * TICK), f"{tick * TICK:.1f}"


def _path(times: Floats, values: Floats, scale: _Scale) -> str:
    """An SVG path of the values in a row and the frame to either side; broken where lost."""
    first = max(int(np.searchsorted(times, scale.start)) - 1, 0)
    stop = int(np.searchsorted(times, scale.end)) + 1
    near = values[first:stop].astype(np.float64)
    across = LEFT + (times[first:stop] - scale.start) * scale.pace
    down = CURVE_TOP + CURVE_HEIGHT * (1 - near / scale.top)
    parts, pen = [], "M"
    for x, y in zip(across.round(1).tolist(), down.round(1).tolist(), strict=True):
        if math.isfinite(y):
            parts.append(f"{pen}{x} {y}")
            pen = "L"
        else:
            pen = "M"
    return "".join(parts)


def _bands(recording: Recording) -> list[Labelled]:
    """Start and end in s, kind and hint of what lies behind the curves."""
    motion, times = recording.motion, recording.times
    bands = []
    if motion.aperture is not None:
        found = bilabial_closures(motion.aperture, times, 1 / motion.fps, recording.track)
        for closure in found:
            if closure.share is None:
                kind, what = "unseen", "not seen"
            else:
                kind = "closed" if closure.closed else "unclosed"
                what = f"{closure.share:.0%} of the loud opening"
            bands.append((closure.start, closure.end, kind, f"{closure.phone}: {what}"))
    for flag, kind, hint in (
        (Flag.LOST, "lost", "no face"), (Flag.DROPPED, "dropped", "no frame"),
        (Flag.BLINK, "blink", "blink"), (Flag.CROWD, "crowd", "a second face"),
    ):  # fmt: skip
        edges = np.flatnonzero(np.diff((motion.flags & flag) != 0, prepend=False, append=False))
        for first, stop in edges.reshape(-1, 2):
            half = 0.5 / motion.fps
            bands.append((float(times[first] - half), float(times[stop - 1] + half), kind, hint))
    return bands


@dataclass(frozen=True)
class Histogram:
    """How often a figure has which value."""

    title: str
    bars: tuple[tuple[float, float, float, str], ...]
    """x, y, height and hint of each bar that has any"""
    width: int
    low: str
    """the label of the left end"""
    high: str
    count: int


def histogram(
    title: str, values: Sequence[float], *, unit: str = "", scale: float = 1.0, decimals: int = 2
) -> Histogram | None:
    """The distribution of `values` times `scale` in `unit`; None without values."""
    if not values:
        return None
    scaled = np.asarray(values, np.float64) * scale
    low, high = float(scaled.min()), float(scaled.max())
    if high - low < 10.0**-decimals:
        low, high = low - 0.5 * 10.0**-decimals, high + 0.5 * 10.0**-decimals
    counts, edges = np.histogram(scaled, bins=BINS, range=(low, high))
    bars = []
    for i, n in enumerate(counts.tolist()):
        if n:
            height = round(max(HISTOGRAM_HEIGHT * n / int(counts.max()), 1.5), 1)
            hint = f"{n} of {edges[i]:.{decimals}f} to {edges[i + 1]:.{decimals}f} {unit}".strip()
            bars.append((float(i * BAR), round(HISTOGRAM_HEIGHT - height, 1), height, hint))
    left, right = (f"{edge:.{decimals}f} {unit}".strip() for edge in (low, high))
    return Histogram(title, tuple(bars), BINS * BAR, left, right, len(values))
