"""The file of edits: JSON of the changes, the phones, and what was written last."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.clip import MAX_FPS, MIN_FPS, Clip
from lipwright.edits.values import Edits
from lipwright.errors import LipwrightError
from lipwright.export.jsonclip import check_names
from lipwright.export.performance import rounded_rows
from lipwright.files import write_whole
from lipwright.formats.jsontrack import dump, is_number, json_to_track, parse_json, track_to_json

FORMAT: Final = "lipwright-edits"
VERSION: Final = 1
LARGEST: Final = 1e30  # units of a control; sums of a few stay within float32
DECIMALS: Final = 7  # of units of a control: what float32 holds


def save_edits(edits: Edits, path: str | Path) -> None:
    """Write edits, whole or not at all.

    Raises:
        LipwrightError: the file cannot be written.
    """
    with write_whole(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        file.writelines(_lines(edits))


def _lines(edits: Edits) -> Iterator[str]:
    yield f'{{\n  "format": {dump(FORMAT)},\n  "version": {VERSION},\n'
    track = None if edits.track is None else track_to_json(edits.track)
    yield f'  "track": {dump(track)},\n  "changes": '
    if edits.changes is None:
        yield "null"
    else:
        yield from _clip_lines(edits.changes)
    yield ',\n  "written": ['
    for index, clip in enumerate(edits.written):
        yield "," if index else ""
        yield from _clip_lines(clip)
    yield "]\n}\n"


def _clip_lines(clip: Clip) -> Iterator[str]:
    yield f'{{\n    "fps": {clip.fps}, "names": {dump(list(clip.names))}, "values": ['
    for index, row in enumerate(rounded_rows(clip.values, DECIMALS)):
        yield f"{',' if index else ''}\n      {dump(row)}"
    yield "\n    ]}"


def load_edits(path: str | Path) -> Edits:
    """The edits of a file.

    Raises:
        LipwrightError: the file cannot be read or holds no edits; names the place.
    """
    content = parse_json(path, FORMAT, VERSION)
    track, changes, written = (content.get(key) for key in ("track", "changes", "written"))
    if not isinstance(written, list):
        raise LipwrightError(f"{path}: 'written' is no list of curves; correct it")
    if track is not None and not isinstance(track, dict):
        raise LipwrightError(f"{path}: 'track' is no object; correct it")
    return Edits(
        None if changes is None else _to_clip(path, "changes", changes),
        None if track is None else json_to_track(path, track),
        tuple(_to_clip(path, "written", clip) for clip in written),
    )


def _to_clip(path: str | Path, place: str, content: Any) -> Clip:
    fields: dict[str, Any] = content if isinstance(content, dict) else {}
    fps: Any = fields.get("fps")
    names: Any = fields.get("names")
    rows: Any = fields.get("values")
    if not is_number(fps) or not MIN_FPS <= fps <= MAX_FPS or not isinstance(rows, list):
        raise LipwrightError(f"{path}: {place!r} has no 'fps' or no 'values'; correct it")
    for frame, row in enumerate(rows):
        if not isinstance(row, list) or not all(is_number(v) and abs(v) < LARGEST for v in row):
            raise LipwrightError(f"{path}: {place!r}: frame {frame} is no list of numbers")
    if isinstance(names, list) and all(isinstance(name, str) for name in names):
        check_names(path, names)
    try:
        return Clip(tuple(names or ()), fps, np.array(rows, np.float64))
    except (TypeError, ValueError) as error:
        raise LipwrightError(f"{path}: {place!r} is no clip: {error}; correct it") from None
