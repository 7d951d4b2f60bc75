"""The quality report of a dataset: one page for all of it and one a recording, as plain HTML.

The pages need no network and no server. The same dataset gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

import numpy as np
import numpy.typing as npt

from lipwright.capture.observe import head_aperture
from lipwright.capture.plots import (
    CURVE_TOP,
    LEFT,
    PHONES_Y,
    ROW_HEIGHT,
    TIMES_Y,
    WIDTH,
    WORDS_Y,
    plot_rows,
)
from lipwright.capture.rejection import DEFAULT_LIMITS
from lipwright.capture.summary import (
    Row,
    as_number,
    mapping,
    overview,
    page_name,
    read_row,
    title_of,
)
from lipwright.dataset.folder import RECORDINGS, REPORT, Dataset, refuse_links
from lipwright.dataset.recording import PICTURE_FILE, Recording
from lipwright.errors import LipwrightError, MissingExtraError
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
    ("p, b, m seen", "bilabials", 0, "", 1), ("p, b, m not seen", "bilabials_unseen", 0, "", 1),
    ("p, b, m that close", "bilabials_closed", 0, "", 1),
    ("p, b, m that close before smoothing", "bilabials_closed_before", 0, "", 1),
    ("Mean share of the loud opening at p, b, m", "closure_share_after", 1, " %", 100),
    ("Mean share there before smoothing", "closure_share_before", 1, " %", 100),
    ("Words", "words", 0, "", 1), ("Words that do not fit the sound", "misfits", 0, "", 1),
    ("Confidence of the words", "confidence", 2, "", 1),
    ("Posed head follows the lips, r", "arkit_r", 3, "", 1),
    ("Gain of the posed head", "arkit_gain", 3, "", 1),
)  # fmt: skip
"""label, key of quality, decimals, unit and factor of each figure on a recording's page"""

SIZE: Final = {
    "width": WIDTH, "height": ROW_HEIGHT, "left": LEFT, "top": CURVE_TOP,
    "phones": PHONES_Y, "words": WORDS_Y, "times": TIMES_Y,
}  # fmt: skip

Progress = Callable[[float], None]
"""told which share is done, 0 to 1"""


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
    with write_whole(refuse_links(dataset.path, folder / STYLE)) as part:
        part.write_text((TEMPLATES / STYLE).read_text("utf-8"), "utf-8")
    rows = _write_pages(dataset, folder, environment, report)
    _write(folder / INDEX, environment.get_template(INDEX).render(**overview(dataset, rows)))
    _remove_stale(folder, {INDEX, *(page_name(row.name) for row in rows if row.page)})
    return folder / INDEX


def _write_pages(dataset: Dataset, folder: Path, environment: Any, report: Progress) -> list[Row]:
    """Write the page of each recording that has one; the rows of all."""
    template = environment.get_template("recording.html")
    entries = sorted(dataset.entries, key=lambda entry: str(entry["name"]))
    rows, earlier, waiting = [], "", None  # a page waits until the address of the next is known
    for index, entry in enumerate(entries):
        row, recording = read_row(dataset, entry)
        rows.append(row)
        if recording is not None:
            if waiting is not None:
                _write(waiting[0], template.render(**waiting[1], earlier=earlier, later=row.page))
                earlier = waiting[1]["row"].page
            waiting = (folder / page_name(row.name), _page(dataset, row, recording))
        report((index + 1) / len(entries))
    if waiting is not None:
        _write(waiting[0], template.render(**waiting[1], earlier=earlier, later=""))
    return rows


def _write(path: Path, text: str) -> None:
    with write_whole(refuse_links(path.parent.parent, path)) as part:
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
    environment.filters["shown"] = shown
    return environment


def shown(value: object, decimals: int = 2, unit: str = "", scale: float = 1.0) -> str:
    """A figure for people; a dash where there is none."""
    number = as_number(value)
    if number is None:
        return "–"
    return f"{number * scale:.{decimals}f}{unit}"


def _head_aperture(recording: Recording) -> npt.NDArray[np.float32] | None:
    """How the posed head's lips open; the report does without it where no head is installed."""
    try:
        return head_aperture(recording.motion.arkit)
    except LipwrightError:
        return None


def _page(dataset: Dataset, row: Row, recording: Recording) -> dict[str, Any]:
    """What the page of a recording shows."""
    info = recording.info
    picture = recording.folder / PICTURE_FILE
    address = quote(f"../{RECORDINGS}/{row.name}/{PICTURE_FILE}")
    files = {role: str(mapping(source).get("path", ""))
             for role, source in mapping(info.get("source")).items()}  # fmt: skip
    posed = _head_aperture(recording)
    unclosed = mapping(info.get("quality")).get("unclosed")
    return {
        "title": title_of(dataset),
        "row": row,
        "info": info,
        "rows": plot_rows(recording, posed),
        "curves": {"aperture": recording.motion.aperture is not None, "head": posed is not None},
        "picture": address if picture.is_file() else "",
        "words": _words(recording),
        "files": files,
        "unclosed": [c for c in map(mapping, unclosed if isinstance(unclosed, list) else ()) if c],
        "fps": recording.motion.fps,
    }


def _words(recording: Recording) -> list[dict[str, Any]]:
    """Text, start, end and confidence of each word; the track knows no confidence by itself."""
    told = recording.info.get("words")
    if isinstance(told, list) and told:
        return [{key: word.get(key) for key in ("text", "start", "end", "confidence")}
                for word in map(mapping, told)]  # fmt: skip
    track = recording.track
    spans = [track.word_span(word) for word in track.words]
    return [
        {"text": word.text, "start": start, "end": end, "confidence": word.confidence}
        for word, (start, end) in zip(track.words, spans, strict=True)
    ]
