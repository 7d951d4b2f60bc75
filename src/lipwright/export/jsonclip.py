"""Our own JSON of a clip: names, rate and frames, and the phone track where there is one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.clip import MAX_FPS, Clip
from lipwright.errors import LipwrightError
from lipwright.export.performance import (
    ExportOptions,
    Output,
    PathLike,
    Performance,
    rounded_rows,
    text_output,
)
from lipwright.formats.jsontrack import dump, is_number, json_to_track, parse_json, track_to_json

FORMAT: Final = "lipwright-clip"
VERSION: Final = 1
DECIMALS: Final = 5  # of a weight; a hundred-thousandth of a movement is not seen


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file."""
    return [text_output(path, lambda: _lines(performance))]


def _lines(performance: Performance) -> Iterator[str]:
    clip = performance.clip
    fields = {"format": FORMAT, "version": VERSION, "fps": clip.fps, "names": list(clip.names)}
    if performance.track is not None:
        fields["track"] = track_to_json(performance.track)
    yield "{\n"
    for key, value in fields.items():
        yield f"  {dump(key)}: {dump(value)},\n"
    # One frame a line keeps the file fit for people and for diff.
    yield '  "values": ['
    for index, row in enumerate(rounded_rows(clip.values, DECIMALS)):
        yield f"{',' if index else ''}\n    {dump(row)}"
    yield "\n  ]\n}\n"


def read_clip_json(path: PathLike) -> Clip:
    """The clip of our JSON.

    Raises:
        LipwrightError: the file is not such JSON; names the field, frame or control.
    """
    return read_performance_json(path).clip


def read_performance_json(path: PathLike) -> Performance:
    """The clip of our JSON and, where it has one, the track.

    Raises:
        LipwrightError: the file is not such JSON; names the field, frame or control.
    """
    content = parse_json(path, FORMAT, VERSION)
    clip = _json_to_clip(path, content)
    track = content.get("track")
    if track is None:
        return Performance(clip)
    if not isinstance(track, dict):
        raise LipwrightError(f"{path}: 'track' is not an object; correct it or leave it out")
    return Performance(clip, json_to_track(path, track))


def _json_to_clip(path: PathLike, content: dict[str, Any]) -> Clip:
    fps: Any = content.get("fps")
    names, rows = content.get("names"), content.get("values")
    if not is_number(fps) or not 0 < fps <= MAX_FPS:
        raise LipwrightError(
            f"{path}: 'fps' is {str(fps)[:24]}, not a rate up to {MAX_FPS:g} a second; correct it"
        )
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise LipwrightError(f"{path}: 'names' is not a list of control names; correct it")
    if not isinstance(rows, list) or not rows:
        raise LipwrightError(f"{path}: 'values' is not a list of frames; correct it")
    for frame, row in enumerate(rows):
        _check_row(path, frame, row, names)
    return make_clip(path, names, fps, rows)


def _check_row(path: PathLike, frame: int, row: object, names: list[str]) -> None:
    if not isinstance(row, list) or len(row) != len(names):
        found = f"{len(row)} values" if isinstance(row, list) else repr(row)[:24]
        raise LipwrightError(
            f"{path}: frame {frame} has {found}, not one for each of the {len(names)} controls; "
            "correct it"
        )
    for name, value in zip(names, row, strict=True):
        if not is_number(value):
            raise LipwrightError(
                f"{path}: frame {frame}: {name[:40]!r} is {str(value)[:24]!r}, not a number; "
                "correct it"
            )


def make_clip(path: PathLike, names: list[str], fps: float, rows: list[list[float]]) -> Clip:
    """The clip of checked fields.

    Raises:
        LipwrightError: a name is empty or repeats, or a value is too large.
    """
    seen: set[str] = set()
    for number, name in enumerate(names, 1):
        if not name:
            raise LipwrightError(f"{path}: control {number} has no name; name it or delete it")
        if name in seen:
            raise LipwrightError(f"{path}: the control {name[:40]!r} stands twice; delete one")
        seen.add(name)
    values = np.array(rows, np.float64).reshape(len(rows), len(names))
    limit = float(np.finfo(np.float32).max)
    if (np.abs(values) > limit).any():
        frame, column = np.argwhere(np.abs(values) > limit)[0]
        raise LipwrightError(
            f"{path}: frame {frame}: {names[column][:40]!r} is too large a number; correct it"
        )
    return Clip(tuple(names), fps, values.astype(np.float32))


read = read_clip_json
