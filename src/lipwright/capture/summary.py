"""A dataset's recordings as the rows of its report, and what they come to together."""

from __future__ import annotations

import hashlib
import statistics
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

import numpy as np

from lipwright.capture.plots import Histogram, histogram
from lipwright.dataset.folder import CAPTURED, FAILED, REJECTED, Dataset
from lipwright.dataset.recording import Recording
from lipwright.errors import LipwrightError


@dataclass(frozen=True)
class Row:
    """A recording in the report's table; figures are None where they are not known."""

    name: str
    page: str
    """its page, as a quoted address; empty where it has none"""
    status: str
    split: str
    reasons: tuple[str, ...]
    """why it failed, was rejected or should be"""
    warnings: tuple[str, ...]
    seconds: float | None
    frames: int
    offset: float | None
    """s, trusted or not; None where nobody could tell"""
    trusted: bool
    r: float | None
    """agreement of lips and words at that offset"""
    figures: Mapping[str, float]
    """the numbers of its quality"""

    def figure(self, key: str) -> float | None:
        """A figure of its quality."""
        return self.figures.get(key)

    @property
    def advised(self) -> bool:
        """Captured, but with reasons to leave it out."""
        return self.status == CAPTURED and bool(self.reasons)


def page_name(name: str) -> str:
    """The file of a recording's page; a recording called `index` does not take the overview's."""
    if name.casefold() == "index":
        return f"{name}-{hashlib.sha256(name.encode()).hexdigest()[:8]}.html"
    return f"{name}.html"


def as_number(value: object) -> float | None:
    """`value` if it is a number; a file that somebody edited may hold anything."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if np.isfinite(value) else None


def texts(value: object) -> tuple[str, ...]:
    """The items of a list as text; nothing where it is none."""
    return tuple(map(str, value)) if isinstance(value, list | tuple) else ()


def mapping(value: object) -> Mapping[str, Any]:
    """`value` if it has keys; one without any where it has none."""
    return value if isinstance(value, Mapping) else {}


def read_row(dataset: Dataset, entry: Mapping[str, Any]) -> tuple[Row, Recording | None]:
    """A row of the table and, unless it failed, the recording."""
    name, recording = entry["name"], None
    reasons, warnings = texts(entry.get("reasons")), texts(entry.get("warnings"))
    status = entry["status"]
    if status != FAILED:
        try:
            recording = dataset.recording(name)
        except LipwrightError as error:
            reasons, status = (*reasons, str(error)), FAILED
    info = recording.info if recording else {}
    quality, offset = (mapping(info.get(key)) for key in ("quality", "offset"))
    advice = texts(info.get("reject"))
    row = Row(
        name=name,
        page=quote(page_name(name)) if recording else "",
        status=status,
        split=str(entry.get("split") or ""),
        reasons=tuple(dict.fromkeys((*reasons, *advice))),
        warnings=texts(info.get("warnings")) or warnings,
        seconds=recording.motion.duration if recording else None,
        frames=len(recording.motion) if recording else 0,
        offset=None if offset.get("r") is None else as_number(offset.get("seconds")),
        trusted=offset.get("trusted") is True,
        r=as_number(offset.get("r")),
        figures={k: n for k, v in quality.items() if (n := as_number(v)) is not None},
    )
    return row, recording


def title_of(dataset: Dataset) -> str:
    """The name of a dataset, or of its folder."""
    return str(dataset.manifest.get("name") or dataset.path.resolve().name)


def overview(dataset: Dataset, rows: Sequence[Row]) -> dict[str, Any]:
    """What the first page shows."""
    used = [row for row in rows if row.status == CAPTURED]
    offsets = [row.offset for row in used if row.offset is not None]
    return {
        "title": title_of(dataset),
        "licence": dataset.manifest.get("licence"),
        "maker": dataset.manifest.get("lipwright"),
        "rows": rows,
        "failed": [row for row in rows if row.status == FAILED],
        "rejected": [row for row in rows if row.status == REJECTED],
        "advised": [row for row in rows if row.advised],
        "used": used,
        "statuses": Counter(row.status for row in rows),
        "splits": Counter(row.split for row in used if row.split),
        "minutes": sum(row.seconds or 0.0 for row in used) / 60,
        "tracked": _pooled(used, lambda row: (row.figure("tracked"), row.frames)),
        "closures": closure_totals(used),
        "offset": statistics.median(offsets) if offsets else None,
        "warned": sum(bool(row.warnings) for row in rows),
        "histograms": _histograms(used),
    }


def _pooled(rows: Sequence[Row], pair: Callable[[Row], tuple[float | None, float]]) -> float | None:
    """The mean of a figure, weighted; None where no row has it."""
    pairs = [(value, weight) for value, weight in map(pair, rows) if value is not None]
    total = sum(weight for _, weight in pairs)
    return sum(value * weight for value, weight in pairs) / total if total else None


def closure_totals(rows: Sequence[Row]) -> dict[str, float | None]:
    """Bilabials seen, how many closed before and after smoothing, and those not seen."""
    keys = ("bilabials", "bilabials_closed_before", "bilabials_closed", "bilabials_unseen")
    sums = {key: sum(row.figure(key) or 0.0 for row in rows) for key in keys}
    seen = sums["bilabials"]
    return {
        **sums,
        "before": sums["bilabials_closed_before"] / seen if seen else None,
        "after": sums["bilabials_closed"] / seen if seen else None,
    }


def _histograms(rows: Sequence[Row]) -> list[Histogram]:
    def values(key: str) -> list[float]:
        return [value for row in rows if (value := row.figure(key)) is not None]

    offsets = [row.offset for row in rows if row.offset is not None]
    rs = [row.r for row in rows if row.r is not None]
    found = [
        histogram("Picture late by", offsets, unit="ms", scale=1000, decimals=0),
        histogram("Lips and words, r", rs),
        histogram("Confidence of the words", values("confidence")),
        histogram("Jitter, eye distances", values("jitter"), decimals=4),
        histogram("Loud opening, eye distances", values("opening")),
        histogram("Posed head, r", values("arkit_r"), decimals=3),
        histogram("Head turned by", values("turn_deg"), unit="°", decimals=0),
        histogram("Eyes apart by", values("eye_distance_px"), unit="px", decimals=0),
    ]
    return [item for item in found if item is not None]
