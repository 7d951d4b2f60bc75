"""CSV of Epic's Live Link Face app, and tables of other apps with a time and ARKit's names.

The app writes `Timecode,BlendShapeCount,EyeBlinkLeft,...`: 52 weights and, since its second
year, nine angles in radians. Its time code counts 60 frames a second and thousandths of a
frame, also where the phone records 30 frames a second.
"""

from __future__ import annotations

import csv
import io
import os
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import ARKIT, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export.arkit_names import (
    MIN_NAMES,
    NameMatch,
    control_column,
    match_names,
    plain_name,
)
from lipwright.export.arkit_recording import ArkitRecording, FrameTable, table_to_recording
from lipwright.export.livelink import SIGNS
from lipwright.export.stamps import TIME_NAMES, Stamps, stamps_to_times
from lipwright.formats.source import decode_text, parse_number, read_text

APP: Final = "Live Link Face"
TIMECODE: Final = "timecode"
COUNT: Final = "blendshapecount"  # also written BlendshapeCount; 0 where the app saw no face

ROUNDING: Final = 1e-4  # s; finer than the app writes times, where frames are evenly spaced

_HEADER_BYTES: Final = 16384
_DELIMITERS: Final = (",", ";", "\t")  # the app's, Excel's where the decimal sign is a comma


@dataclass(frozen=True)
class _Columns:
    """Where things stand in a line."""

    header: tuple[str, ...]
    time: int
    count: int | None
    match: NameMatch


def is_live_link(path: str | os.PathLike[str]) -> bool:
    """Whether the first line of a file is that of a Live Link Face recording."""
    try:
        with Path(path).open("rb") as file:
            line = file.read(_HEADER_BYTES).partition(b"\n")[0]
        names = _header_cells(decode_text(path, line))
    except (OSError, ValueError, LipwrightError):
        return False
    known = {control_column(name) for name in names} & set(range(len(ARKIT)))
    return any(plain_name(name) == TIMECODE for name in names) and len(known) >= MIN_NAMES


def read_live_link(
    path: str | os.PathLike[str], timecode_fps: int | None = None, least_fps: float = 0.0
) -> ArkitRecording:
    """The recording of a CSV file.

    Args:
        path: the file.
        timecode_fps: frames a second that its time codes count; None finds it out.
        least_fps: frames a second of the phone, fewer are refused.

    Raises:
        LipwrightError: the header lacks a time or ARKit's names, a cell is wrong, or the frames
            are no recording; names line and column.
    """
    text = read_text(path)
    lines = _read_cells(path, text)
    _, header = next(lines, (0, []))
    if not header:
        raise LipwrightError(f"{path}: is empty; export the recording again")
    columns = _find_columns(path, [cell.strip() for cell in header])
    stamps = Stamps(path, timecode_fps, columns.header[columns.time])
    rows, places = array("d"), array("q")  # an hour of lists of numbers would take gigabytes
    notes: tuple[str, ...] = ()
    for (line, cells), (_, follower) in pairwise(chain(lines, [(0, list[str]())])):
        if not follower and _is_cut(path, text, line, cells, columns):
            notes = (f"the last line ({line}) is cut and left out",)
            break
        rows.extend(_row(path, line, cells, columns))
        places.append(line)
        stamps.add(f"line {line}", _cell(cells, columns.time))
    if not places:
        raise LipwrightError(f"{path}: has a header and no frames; export the recording again")
    clock = stamps_to_times(stamps)
    app = APP if plain_name(columns.header[columns.time]) == TIMECODE else "table"
    table = FrameTable(
        match=columns.match,
        times=clock.times,
        rows=np.array(rows).reshape(len(places), -1),
        places=np.array(places),
        unit="line",
        source=f"{app} CSV, {clock.layout}",
        timecode=clock.timecode,
        notes=(*notes, *clock.notes),
    )
    return table_to_recording(path, table, least_fps)


def read_clip_live_link(path: str | os.PathLike[str]) -> Clip:
    """A recording as a clip that starts with its first frame, at the phone's rate.

    Turns of the head come along where there are some. Frames off the even grid are sampled on it,
    and frames without a face or left out are filled, linearly.

    Raises:
        LipwrightError: as `read_live_link`.
    """
    recording = read_live_link(path)
    when = recording.times - recording.times[0]
    seen = recording.valid
    values, names = recording.values, ARKIT
    if recording.angles is not None:
        turns = recording.angles[:, : len(HEAD_ANGLES)] * np.array(SIGNS, np.float32)
        if np.nan_to_num(turns).any():
            values, names = np.concatenate([values, turns], axis=1), ARKIT + HEAD_ANGLES
    count = round(float(when[-1]) * recording.fps) + 1
    grid = np.arange(count) / recording.fps
    even = seen.all() and count == len(when) and np.abs(grid - when).max() < ROUNDING
    if not even:
        columns = [np.interp(grid, when[seen], column[seen]) for column in values.T]
        values = np.stack(columns, axis=1).astype(np.float32)
    return Clip(names, recording.fps, values)


def _header_cells(line: str) -> list[str]:
    delimiter = max(_DELIMITERS, key=line.count)
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]


def _read_cells(path: str | os.PathLike[str], text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of each line that is not empty."""
    delimiter = max(_DELIMITERS, key=text.partition("\n")[0].count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        for cells in reader:
            if any(map(str.strip, cells)):
                # Where a semicolon parts the cells, the decimal sign is a comma.
                yield (
                    reader.line_num,
                    [cell.replace(",", ".") for cell in cells] if delimiter == ";" else cells,
                )
    except csv.Error as error:
        raise LipwrightError(f"{path}: line {reader.line_num}: not CSV: {error}") from None


def _find_columns(path: str | os.PathLike[str], header: list[str]) -> _Columns:
    plain = [plain_name(name) for name in header]
    while plain and not plain[-1]:  # a comma at the end of each line
        plain.pop()
    time = next((plain.index(name) for name in (TIMECODE, *TIME_NAMES) if name in plain), None)
    if time is None:
        raise LipwrightError(
            f"{path}: line 1: no column 'Timecode', so no recording of ARKit weights; name a CSV "
            "of Live Link Face"
        )
    count = plain.index(COUNT) if COUNT in plain else None
    others = [
        index
        for index, name in enumerate(plain)
        if index not in {time, count} and name not in TIME_NAMES
    ]
    match = match_names(path, [header[index] for index in others])
    known = NameMatch(tuple(others[c] for c in match.columns), match.targets, match.notes)
    return _Columns(tuple(header[: len(plain)]), time, count, known)


def _cell(cells: list[str], column: int) -> str:
    return cells[column].strip() if column < len(cells) else ""


def _is_cut(
    path: str | os.PathLike[str], text: str, line: int, cells: list[str], columns: _Columns
) -> bool:
    """Whether the last line ends somewhere: the app was stopped, or the copy."""
    if text.endswith(("\n", "\r")):
        return len(cells) < len(columns.header) and not _is_lost(cells, columns)
    if not cells[-1].strip():
        return True
    try:
        _row(path, line, cells, columns)
        Stamps(path).add("", _cell(cells, columns.time))
    except LipwrightError:
        return True
    return False


def _is_lost(cells: list[str], columns: _Columns) -> bool:
    return columns.count is not None and _cell(cells, columns.count) in {"0", "0.0"}


def _row(
    path: str | os.PathLike[str], line: int, cells: list[str], columns: _Columns
) -> list[float]:
    """The known columns of a line; NaN where a cell is empty or the app saw no face."""
    wanted, width = columns.match.columns, len(columns.header)
    if _is_lost(cells, columns):
        return [np.nan] * len(wanted)
    if len(cells) < width or any(map(str.strip, cells[width:])):
        raise LipwrightError(
            f"{path}: line {line}: {len(cells)} columns, not {width} as in the header; correct it"
        )
    try:
        row = [float(cells[column]) for column in wanted]
    except ValueError:
        row = []
    # float() takes 1_000, inf and digits of every script; one look at the line rules them out.
    joined = "".join(cells)
    if row and joined.isascii() and "_" not in joined and "f" not in joined.casefold():
        return row
    names = columns.header
    return [_number(path, line, names[column], cells[column].strip()) for column in wanted]


def _number(path: str | os.PathLike[str], line: int, name: str, cell: str) -> float:
    if cell.casefold() in {"", "nan", "null", "none"}:
        return np.nan
    return parse_number(path, f"line {line}", name[:40], cell)
