"""Numbers for people: as many digits as a column needs, and a dash where there is none."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from lipwright.benchmark.reporting.figures import Figure

DASH: Final = "–"
MINUS: Final = "−"
_SUPERSCRIPTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Scale:
    """How the numbers of one column are written."""

    exponent: int
    """of ten by which they are divided"""
    decimals: int

    @property
    def note(self) -> str:
        """What the heading says of the exponent; empty for none."""
        return f"× 10{str(self.exponent).translate(_SUPERSCRIPTS)}" if self.exponent else ""

    def unit(self, unit: str) -> str:
        """The unit with the exponent before it."""
        return f"{self.note} {unit}".strip()

    def shown(self, value: float) -> str:
        """One number."""
        if not math.isfinite(value):
            return DASH
        text = f"{value / 10.0**self.exponent:.{self.decimals}f}"
        if not text.strip("-0."):
            text = text.lstrip("-")
        return text.replace("-", MINUS)

    def interval(self, figure: Figure) -> str:
        """The ends of its interval; empty where there is none."""
        if not (math.isfinite(figure.low) and math.isfinite(figure.high)):
            return ""
        return f"{self.shown(figure.low)} to {self.shown(figure.high)}"


def scale_of(values: Iterable[float]) -> Scale:
    """Three digits of the least of some values, at most four of the largest.

    Where all are small they are divided by a power of a thousand.
    """
    sizes = [math.floor(math.log10(abs(value))) for value in values if 0 < abs(value) < math.inf]
    if not sizes:
        return Scale(0, 2)
    largest, least = max(sizes), min(sizes)
    exponent = 3 * math.floor(largest / 3) if largest < -2 else 0
    return Scale(exponent, max(min(2 - least, 3 - largest) + exponent, 0))


def shown_bytes(count: int | None) -> str:
    """A file's size."""
    if count is None:
        return DASH
    if count < 100_000:
        return f"{count / 1000:.1f} kB"
    return f"{count / 1e6:.1f} MB"


def shown_seconds(seconds: float | None) -> str:
    """How long something took."""
    if seconds is None:
        return DASH
    if seconds < 100:
        return f"{seconds:.1f} s"
    if seconds < 6000:
        return f"{seconds / 60:.1f} min"
    return f"{seconds / 3600:.1f} h"


def shown_p(p: float) -> str:
    """A probability."""
    if not math.isfinite(p):
        return DASH
    return "< 0.001" if p < 0.001 else f"{p:.3f}"
