"""The quality report of a dataset: one page for all of it and one a recording, as plain HTML.

The pages need no network and no server. The same dataset gives the same bytes.
"""

from __future__ import annotations

import hashlib
import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

import numpy as np
import numpy.typing as npt

from lipwright.capture.plots import (
    CURVE_TOP,
    LEFT,
    PHONES_Y,
    ROW_HEIGHT,
    TIMES_Y,
    WIDTH,
    WORDS_Y,
    Histogram,
    histogram,
    plot_rows,
)
from lipwright.capture.rejection import DEFAULT_LIMITS
from lipwright.controls import CANONICAL
from lipwright.dataset.folder import CAPTURED, FAILED, RECORDINGS, REJECTED, REPORT, Dataset
from lipwright.dataset.recording import PICTURE_FILE, Recording
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.face.head import Head, load_head
from lipwright.files import write_whole

INDEX: Final = "index.html"
STYLE: Final = "report.css"
MARK: Final = '<meta name="generator" content="Lipwright">'  # by this we know our own old pages
TEMPLATES: Final = Path(__file__).with_name("templates")

COLUMNS: Final = (
    ("Name", False), ("Status", False), ("Split", False), ("s", True), ("Tracked %", True),
    ("Late ms", True), ("r", True), ("Confidence", True), ("Jitter", True), ("Closed", True),
    ("Turn °", True), ("Reasons and warnings", False),
)  # fmt: skip
"""heading of each column of the overview, and whether it holds numbers"""

FIGURES: Final = (
    ("Frames with a face", "tracked", 1, " %", 100), ("Frames missing", "dropped", 0, "", 1),
    ("Frames with a second face", "second_face", 1, " %", 100), ("Blinks", "blinks", 0, "", 1),
    ("Eyes apart by", "eye_distance_px", 0, " px", 1),
    ("Largest turn of the head", "turn_deg", 0, "°", 1),
    ("Jitter of lips at rest, eye distances", "jitter", 4, "", 1),
    ("Loud opening, eye distances", "opening", 3, "", 1),
    ("p, b, m seen", "bilabials", 0, "", 1), ("not seen", "bilabials_unseen", 0, "", 1),
    ("that close", "bilabials_closed", 0, "", 1),
    ("that closed before smoothing", "bilabials_closed_before", 0, "", 1),
    ("Mean opening at p, b, m", "closure_share_after", 1, " %", 100),
    ("before smoothing", "closure_share_before", 1, " %", 100),
    ("Words", "words", 0, "", 1), ("Words that do not fit the sound", "misfits", 0, "", 1),
    ("Confidence of the words", "confidence", 2, "", 1),
    ("Posed head follows the lips, r", "arkit_r", 3, "", 1),
    ("with a gain of", "arkit_gain", 3, "", 1),
)  # fmt: skip
"""label, key of quality, decimals, unit and factor of each figure on a recording's page"""

SIZE: Final = {
    "width": WIDTH, "height": ROW_HEIGHT, "left": LEFT, "top": CURVE_TOP,
    "phones": PHONES_Y, "words": WORDS_Y, "times": TIMES_Y,
}  # fmt: skip

Progress = Callable[[float], None]
"""told which share is done, 0 to 1"""


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
    """s, trusted or not"""
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


def write_report(dataset: Dataset, report: Progress = lambda share: None) -> Path:
    """Write `report/` of a dataset, and remove the pages of recordings that are gone.

    Args:
        dataset: a dataset as it lies on the disk.
        report: told how far it is.

    Returns:
        The path of index.html.

    Raises:
        LipwrightError: a page cannot be written.
        MissingExtraError: the extra `capture` is not installed.
    """
    environment = _environment()
    folder = dataset.path / REPORT
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise LipwrightError(f"{folder}: cannot be made: {error.strerror}") from error
    head = _head()
    entries = sorted(dataset.entries, key=lambda entry: str(entry["name"]))
    rows = []
    with write_whole(folder / STYLE) as part:
        part.write_text((TEMPLATES / STYLE).read_text("utf-8"), "utf-8")
    for index, entry in enumerate(entries):
        row, recording = _read(dataset, entry)
        if row.page:
            near = [entries[i]["name"] if 0 <= i < len(entries) else None
                    for i in (index - 1, index + 1)]  # fmt: skip
            page = environment.get_template("recording.html").render(
                **_page(dataset, row, recording, head), near=near
            )
            _write(folder / page_name(row.name), page)
        rows.append(row)
        report((index + 1) / len(entries))
    _write(folder / INDEX, environment.get_template(INDEX).render(**_overview(dataset, rows)))
    _remove_stale(folder, {INDEX, *(page_name(row.name) for row in rows if row.page)})
    return folder / INDEX


def page_name(name: str) -> str:
    """The file of a recording's page; a recording called `index` does not take the overview's."""
    if name.casefold() == "index":
        return f"{name}-{hashlib.sha256(name.encode()).hexdigest()[:8]}.html"
    return f"{name}.html"


def _write(path: Path, text: str) -> None:
    with write_whole(path) as part:
        part.write_text(text, "utf-8", errors="replace", newline="\n")


def _remove_stale(folder: Path, present: Iterable[str]) -> None:
    for path in sorted(folder.glob("*.html")):
        if path.name not in present and path.is_file():
            with path.open("rb") as file:
                if MARK.encode() in file.read(400):
                    path.unlink(missing_ok=True)


def _environment() -> Any:
    try:
        import jinja2
    except ImportError as error:
        raise MissingExtraError("what writes the quality report", "capture") from error
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {
        "mark": MARK, "style": STYLE, "columns": COLUMNS, "figures": FIGURES, "size": SIZE,
        "unsure": DEFAULT_LIMITS.confidence,
    }  # fmt: skip
    environment.filters |= {"address": lambda name: quote(page_name(name)), "shown": shown}
    return environment


def shown(value: object, decimals: int = 2, unit: str = "", scale: float = 1.0) -> str:
    """A figure for people; a dash where there is none."""
    number = as_number(value)
    if number is None:
        return "–"
    return f"{number * scale:.{decimals}f}{unit}"


def as_number(value: object) -> float | None:
    """`value` if it is a number; a file that somebody edited may hold anything."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if np.isfinite(value) else None


def _texts(value: object) -> tuple[str, ...]:
    return tuple(map(str, value)) if isinstance(value, list | tuple) else ()


def _read(dataset: Dataset, entry: Mapping[str, Any]) -> tuple[Row, Recording | None]:
    """A row of the table and, unless it failed, the recording."""
    name, recording = entry["name"], None
    reasons, warnings = _texts(entry.get("reasons")), _texts(entry.get("warnings"))
    status = entry["status"]
    if status != FAILED:
        try:
            recording = dataset.recording(name)
        except LipwrightError as error:
            reasons, status = (*reasons, str(error)), FAILED
    info = recording.info if recording else {}
    quality, offset = (_mapping(info.get(key)) for key in ("quality", "offset"))
    advice = _texts(info.get("reject"))
    row = Row(
        name=name,
        page=quote(page_name(name)) if recording else "",
        status=status,
        split=str(entry.get("split") or ""),
        reasons=tuple(dict.fromkeys((*reasons, *advice))),
        warnings=_texts(info.get("warnings")) or warnings,
        seconds=recording.motion.duration if recording else None,
        frames=len(recording.motion) if recording else 0,
        offset=as_number(offset.get("seconds")),
        trusted=offset.get("trusted") is True,
        r=as_number(offset.get("r")),
        figures={k: n for k, v in quality.items() if (n := as_number(v)) is not None},
    )
    return row, recording


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _head() -> Head | None:
    """The head, to show how the posed lips follow; the report does without it if need be."""
    try:
        return load_head()
    except LipwrightError:
        return None


def _head_aperture(head: Head | None, recording: Recording) -> npt.NDArray[np.float64] | None:
    if head is None:
        return None
    arkit = recording.motion.arkit
    missing = np.zeros((len(arkit), len(CANONICAL) - arkit.shape[1]))  # the tongue's controls
    return head.aperture_curve(np.concatenate([arkit, missing], axis=1))


def _page(
    dataset: Dataset, row: Row, recording: Recording | None, head: Head | None
) -> dict[str, Any]:
    """What the page of a recording shows."""
    assert recording is not None
    info = recording.info
    picture = recording.folder / PICTURE_FILE
    address = quote(f"../{RECORDINGS}/{row.name}/{PICTURE_FILE}")
    files = {role: str(_mapping(source).get("path", ""))
             for role, source in _mapping(info.get("source")).items()}  # fmt: skip
    unclosed = _mapping(info.get("quality")).get("unclosed")
    return {
        "title": _title(dataset),
        "row": row,
        "info": info,
        "rows": plot_rows(recording, _head_aperture(head, recording)),
        "curves": {"aperture": recording.motion.aperture is not None, "head": head is not None},
        "picture": address if picture.is_file() else "",
        "words": _words(recording),
        "files": files,
        "unclosed": unclosed if isinstance(unclosed, list) else [],
        "fps": recording.motion.fps,
    }


def _words(recording: Recording) -> list[dict[str, Any]]:
    """Text, start, end and confidence of each word; the track knows no confidence by itself."""
    told = recording.info.get("words")
    if isinstance(told, list) and told:
        return [{key: word.get(key) for key in ("text", "start", "end", "confidence")}
                for word in map(_mapping, told)]  # fmt: skip
    track = recording.track
    spans = [track.word_span(word) for word in track.words]
    return [
        {"text": word.text, "start": start, "end": end, "confidence": word.confidence}
        for word, (start, end) in zip(track.words, spans, strict=True)
    ]


def _title(dataset: Dataset) -> str:
    return str(dataset.manifest.get("name") or dataset.path.resolve().name)


def _overview(dataset: Dataset, rows: Sequence[Row]) -> dict[str, Any]:
    """What the first page shows."""
    used = [row for row in rows if row.status == CAPTURED]
    offsets = [row.offset for row in used if row.offset is not None]
    return {
        "title": _title(dataset),
        "manifest": dataset.manifest,
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
