"""CSV table of a clip: `time` in s and one column a control."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.clip import MAX_FPS, Clip
from lipwright.errors import LipwrightError
from lipwright.export.jsonclip import DECIMALS, make_clip
from lipwright.export.performance import (
    ExportOptions,
    Output,
    PathLike,
    Performance,
    rounded_rows,
    text_output,
)
from lipwright.formats.source import parse_number, read_text

TIME: Final = "time"
TIME_DECIMALS: Final = 6  # of s; a millionth tells 59.94 from 60 fps after two frames
USUAL_FPS: Final = (24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 100.0, 120.0)
LONE_FPS: Final = 60.0  # of a table with one frame, whose rate nothing tells


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file."""
    return [text_output(path, lambda: _lines(performance.clip))]


def _lines(clip: Clip) -> Iterator[str]:
    head = io.StringIO()
    csv.writer(head, lineterminator="\n").writerow([TIME, *clip.names])
    yield head.getvalue()
    form = ",".join([f"%.{TIME_DECIMALS}f"] + [f"%.{DECIMALS}f"] * len(clip.names)) + "\n"
    for time, row in zip(clip.times, rounded_rows(clip.values, DECIMALS), strict=True):
        yield form % (time, *row)


def read_clip_csv(path: PathLike) -> Clip:
    """The clip of a table as this module writes it.

    Raises:
        LipwrightError: a cell is missing or no number, or the times do not start at 0 or are not
            evenly spaced; names line and column.
    """
    table = _read_cells(path)
    if not table or not table[0][1] or table[0][1][0].strip().casefold() != TIME:
        raise LipwrightError(f"{path}: line 1: the first column is not {TIME!r}; add the header")
    names = [name.strip() for name in table[0][1][1:]]
    rows: list[list[float]] = []
    for line, cells in table[1:]:
        if len(cells) != len(names) + 1:
            raise LipwrightError(
                f"{path}: line {line}: {len(cells)} columns, not {len(names) + 1} as in the "
                "header; correct it"
            )
        rows.append(
            [
                parse_number(path, f"line {line}", f"column {column + 1}", cell.strip())
                for column, cell in enumerate(cells)
            ]
        )
    if not rows:
        raise LipwrightError(f"{path}: has a header and no frames; export the clip again")
    decimals = max(len(cells[0].strip().partition(".")[2]) for _, cells in table[1:])
    fps = _rate(path, [row[0] for row in rows], [line for line, _ in table[1:]], decimals)
    return make_clip(path, names, fps, [row[1:] for row in rows])


def _read_cells(path: PathLike) -> list[tuple[int, list[str]]]:
    """Line number and cells of each line that is not empty."""
    text = read_text(path)
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        return [(reader.line_num, cells) for cells in reader if cells]
    except csv.Error as error:
        raise LipwrightError(f"{path}: line {reader.line_num}: not CSV: {error}") from None


def _rate(path: PathLike, times: list[float], lines: list[int], decimals: int) -> float:
    """The frames a second of rising, evenly spaced times.

    Times are rounded to `decimals`, so that a usual rate, a whole one, or one of broadcast
    (59.94), is preferred where it fits as well.
    """
    if times[0] != 0:
        raise LipwrightError(
            f"{path}: line {lines[0]}: the time of the first frame is {times[0]:g} s, not 0; "
            "subtract it from all times"
        )
    if len(times) == 1:
        return LONE_FPS
    rounding = 10.0 ** -min(max(decimals, 1), 9)
    actual = np.asarray(times)
    if actual[-1] <= 0 or actual[-1] / (len(times) - 1) < 1 / MAX_FPS - rounding:
        raise LipwrightError(
            f"{path}: line {lines[-1]}: {len(times)} frames in {times[-1]:g} s are more than "
            f"{MAX_FPS:g} a second; times are in seconds"
        )
    estimate = min((len(times) - 1) / float(actual[-1]), MAX_FPS)
    usual = min(USUAL_FPS, key=lambda fps: abs(fps - estimate))
    broadcast = round(estimate * 1.001) / 1.001
    # Few digits are no leave to stagger: a tenth of a frame at most.
    rounding = min(rounding, 0.1 / estimate)
    worst = 0
    for fps in (usual, float(round(estimate)), broadcast, estimate):
        if 0 < fps <= MAX_FPS:
            errors = np.abs(actual - np.arange(len(times)) / fps)
            worst = int(errors.argmax())
            if errors[worst] <= rounding * 1.001:
                return fps
    raise LipwrightError(
        f"{path}: line {lines[worst]}: the time {times[worst]:g} s does not keep the even spacing "
        f"of {estimate:.3f} frames a second; resample the curves"
    )


read = read_clip_csv
