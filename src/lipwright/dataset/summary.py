"""What is in a dataset, in numbers."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from statistics import median
from typing import Any, Final

import numpy as np

from lipwright.dataset.folder import CAPTURED, Dataset
from lipwright.dataset.recording import (
    FACE_FILE,
    MOTION_FILE,
    PHONES_FILE,
    Flag,
    read_info,
)
from lipwright.errors import LipwrightError
from lipwright.formats import read_track
from lipwright.npz import BROKEN
from lipwright.phones import SILENCE

RARE: Final = 8  # phones that are shown as the least frequent


def summarise(dataset: Dataset) -> dict[str, Any]:
    """Counts over the usable recordings, as docs/dataset.md describes them under `info`.

    Raises:
        LipwrightError: a file is broken; names it.
    """
    entries = dataset.entries
    there = [_figures(dataset.folder(e["name"])) for e in entries if e["status"] == CAPTURED]
    phones: Counter[str] = sum((row["phones"] for row in there), Counter())
    spoken = Counter({phone: n for phone, n in phones.items() if phone != SILENCE})
    return {
        "name": dataset.manifest.get("name", ""),
        "licence": dataset.manifest.get("licence", ""),
        "recordings": len(entries),
        "statuses": count_values(entry["status"] for entry in entries),
        "splits": count_values(
            str(entry.get("split")) for entry in entries if entry["status"] == CAPTURED
        ),
        "seconds": round(sum(row["seconds"] for row in there), 3),
        "words": sum(row["words"] for row in there),
        "phones": sum(spoken.values()),
        "phone_counts": dict(sorted(phones.items(), key=lambda item: (-item[1], item[0]))),
        "frames": sum(row["frames"] for row in there),
        "fps": count_values(row["fps"] for row in there),
        **_tracking(there),
        "offset_ms": _spread([row["offset"] * 1000 for row in there if row["offset"] is not None]),
        "parameters": count_values(key for row in there for key in row["parameters"]),
        "trackers": count_values(row["tracker"] for row in there),
        "reasons": {
            e["name"]: "; ".join(map(str, e["reasons"]))
            for e in entries if e["status"] != CAPTURED and e.get("reasons")
        },
        "advised": sum(e["status"] == CAPTURED and bool(e.get("reasons")) for e in entries),
    }  # fmt: skip


def rarest(counts: Mapping[str, int], number: int = RARE) -> list[tuple[str, int]]:
    """The least frequent of the phones that occur, the rarest first; silence does not count."""
    rows = [(phone, count) for phone, count in counts.items() if phone != SILENCE]
    return sorted(rows, key=lambda row: (row[1], row[0]))[:number]


def count_values(values: Iterable[Any]) -> dict[str, int]:
    """How often each value occurs, in the order of their names."""
    return {str(value): count for value, count in sorted(Counter(values).items())}


def _tracking(rows: list[dict[str, Any]]) -> dict[str, Any]:
    filmed = sum(row["filmed"] for row in rows)
    bilabials = sum(row["bilabials"] for row in rows)
    closed = sum(row["closed"] for row in rows)
    return {
        "tracked": round(sum(row["valid"] for row in rows) / filmed, 6) if filmed else None,
        "bilabials": bilabials,
        "closures_kept": round(closed / bilabials, 6) if bilabials else None,
    }


def _spread(values: list[float]) -> dict[str, float] | None:
    """Least, median and greatest."""
    if not values:
        return None
    return {
        "least": round(min(values), 1),
        "median": round(median(values), 1),
        "greatest": round(max(values), 1),
    }


def _figures(folder: Path) -> dict[str, Any]:
    """The figures of one recording."""
    info = read_info(folder)
    track = read_track(folder / PHONES_FILE)
    fps, flags, arrays = _peek(folder / MOTION_FILE)
    seen = (flags & (Flag.LOST | Flag.DROPPED)) == 0
    quality, offset = (_table(info, key) for key in ("quality", "offset"))
    return {
        "seconds": len(flags) / fps,
        "words": len(track.words),
        "phones": Counter(track.phones),
        "frames": len(flags),
        "fps": f"{fps:g}",
        "tracker": str(info.get("tracker") or "unknown"),
        "filmed": int(((flags & Flag.DROPPED) == 0).sum()),
        "valid": int(seen.sum()),
        "bilabials": int(_number(quality.get("bilabials")) or 0),
        "closed": int(_number(quality.get("bilabials_closed")) or 0),
        "offset": _number(offset.get("seconds")) if offset.get("trusted") is True else None,
        "parameters": [*arrays, *_face_shapes(folder / FACE_FILE)],
    }


def _table(info: Mapping[str, Any], key: str) -> dict[str, Any]:
    value = info.get(key)
    return value if isinstance(value, dict) else {}


def _number(value: object) -> float | None:
    """`value` if it is a number, as figures that cannot be had are not."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if math.isfinite(value) else None


def _peek(path: Path) -> tuple[float, Any, list[str]]:
    """fps, flags and the names of the arrays, without reading the landmarks."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            names = [name for name in stored.files if name not in ("fps", "flags")]
            fps, flags = float(stored["fps"]), stored["flags"]
        if not 0 < fps < math.inf or flags.ndim != 1 or flags.dtype != np.uint8:
            raise ValueError("no frame rate, or no flags")
        return fps, flags, names  # noqa: TRY300  # what follows is for damaged files
    except BROKEN as error:
        raise LipwrightError(
            f"{path}: not a readable motion; see: lipwright dataset check"
        ) from error


def _face_shapes(path: Path) -> list[str]:
    """Such as "face shape 12"."""
    if not path.is_file():
        return []
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
    except BROKEN as error:
        raise LipwrightError(f"{path}: not readable; run: lipwright face fit") from error
    return [f"face {name} {a.shape[1]}" for name, a in arrays.items() if a.ndim == 2]
