"""Our own JSON of a clip: names, rate and frames, and the phone track where there is one.

Version 1 has every frame. Version 2, which `--keys` makes, has keys: for each control the numbers
of its frames, the values there, and the slopes in units a second of the cubic Hermite spans
between them; `arriving` and `leaving` instead of `slopes` where a curve has a corner.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import MAX_FPS, Clip
from lipwright.controls import is_text
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
from lipwright.keys import KeyedCurve, bound_of, keyed

FORMAT: Final = "lipwright-clip"
VERSION: Final = 1
KEYED: Final = 2  # the version of files with keys
MAX_FRAMES: Final = 100_000_000  # 19 days at 60 fps
MAX_VALUES: Final = 2**26  # five hours of a face; a file of keys can ask for far more than it holds
DECIMALS: Final = 5  # of a weight; a hundred-thousandth of a movement is not seen


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file."""
    if options.keys is not None:
        bound = options.keys
        return [text_output(path, lambda: _keyed_lines(performance, bound))]
    return [text_output(path, lambda: _lines(performance))]


def _head_lines(performance: Performance, fields: dict[str, Any]) -> Iterator[str]:
    yield "{\n"
    if performance.track is not None:
        fields = {**fields, "track": track_to_json(performance.track)}
    for key, value in {"format": FORMAT, **fields}.items():
        yield f"  {dump(key)}: {dump(value)},\n"


def _keyed_lines(performance: Performance, bound: float) -> Iterator[str]:
    clip = performance.clip
    curves = keyed(clip, bound).curves
    fields = {"version": KEYED, "fps": clip.fps, "frames": len(clip)}
    yield from _head_lines(performance, fields)
    yield '  "keys": {'
    for index, (name, curve) in enumerate(curves.items()):
        keys = json.dumps(_keys(curve, clip.fps, bound_of(name, bound)), separators=(",", ":"))
        yield f"{',' if index else ''}\n    {dump(name)}: {keys}"
    yield "\n  }\n}\n"


def _keys(curve: KeyedCurve, fps: float, bound: float) -> dict[str, list[Any]]:
    # Values lose a hundredth of the bound at the most, and slopes two: an error of both slopes
    # moves the middle of a span by a quarter of the span's length times it.
    longest = float(np.diff(curve.times).max(initial=0.01))  # s
    decimals = max(math.ceil(math.log10(0.5 / (0.01 * bound))), 2)
    slope_decimals = max(math.ceil(math.log10(0.5 * longest / 4 / (0.02 * bound)) - 1e-9), 1)

    def rounded(values: npt.NDArray[np.float64], digits: int) -> list[float]:
        return (values.round(digits) + 0.0).tolist()

    keys: dict[str, list[Any]] = {
        "frames": np.rint(curve.times * fps).astype(int).tolist(),
        "values": rounded(curve.values, decimals),
    }
    if (curve.arriving[1:-1] == curve.leaving[1:-1]).all():
        ends = np.concatenate([curve.leaving[:1], curve.arriving[1:]])
        return {**keys, "slopes": rounded(ends, slope_decimals)}
    arriving, leaving = curve.arriving, curve.leaving
    return {**keys, "arriving": rounded(arriving, slope_decimals),
            "leaving": rounded(leaving, slope_decimals)}  # fmt: skip


def _lines(performance: Performance) -> Iterator[str]:
    clip = performance.clip
    fields = {"version": VERSION, "fps": clip.fps, "names": list(clip.names)}
    yield from _head_lines(performance, fields)
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
    content = parse_json(path, FORMAT, VERSION, KEYED)
    make = _keys_to_clip if content["version"] == KEYED else _json_to_clip
    clip = make(path, content)
    track = content.get("track")
    if track is None:
        return Performance(clip)
    if not isinstance(track, dict):
        raise LipwrightError(f"{path}: 'track' is not an object; correct it or leave it out")
    return Performance(clip, json_to_track(path, track))


def _rate(path: PathLike, content: dict[str, Any]) -> float:
    fps: Any = content.get("fps")
    if not is_number(fps) or not 0 < fps <= MAX_FPS:
        raise LipwrightError(
            f"{path}: 'fps' is {str(fps)[:24]}, not a rate up to {MAX_FPS:g} a second; correct it"
        )
    return float(fps)


def _keys_to_clip(path: PathLike, content: dict[str, Any]) -> Clip:
    fps, count, curves = _rate(path, content), content.get("frames"), content.get("keys")
    if isinstance(count, bool) or not isinstance(count, int) or not 0 < count <= MAX_FRAMES:
        raise LipwrightError(
            f"{path}: 'frames' is {str(count)[:24]}, not a number from 1 to {MAX_FRAMES:,}; "
            "correct it"
        )
    if not isinstance(curves, dict) or not curves:
        raise LipwrightError(f"{path}: 'keys' holds no curves by control; correct it")
    if count * len(curves) > MAX_VALUES:
        raise LipwrightError(f"{path}: {count:,} frames of {len(curves)} controls are too many")
    check_names(path, curves)
    times = np.arange(count) / fps
    columns = [_to_curve(path, name, keys, fps, count).at(times) for name, keys in curves.items()]
    values = np.stack(columns, axis=1)
    if (np.abs(values) > np.finfo(np.float32).max).any():
        raise LipwrightError(f"{path}: a curve is too steep to be followed; correct its slopes")
    try:
        return Clip(tuple(curves), fps, values.astype(np.float32))
    except ValueError as error:
        raise LipwrightError(f"{path}: {error}; correct it") from None


def _to_curve(path: PathLike, name: str, keys: Any, fps: float, count: int) -> KeyedCurve:
    """The keys of one control, whose frames are whole numbers or between them."""
    lists = dict(keys) if isinstance(keys, dict) else {}
    if "slopes" in lists:
        lists["arriving"] = lists["leaving"] = lists.pop("slopes")
    for key in ("frames", "values", "arriving", "leaving"):
        row = lists.get(key)
        if not isinstance(row, list) or not row or not all(map(is_number, row)):
            raise LipwrightError(
                f"{path}: the keys of {name[:40]!r} have no {key!r} that are numbers; correct them"
            )
    frames = np.array(lists["frames"], np.float64)
    if frames[0] < 0 or frames[-1] > count - 1:
        raise LipwrightError(
            f"{path}: keys of {name[:40]!r} are not within frames 0 to {count - 1}; correct them"
        )
    try:
        return KeyedCurve(frames / fps, lists["values"], lists["arriving"], lists["leaving"])
    except ValueError as error:
        raise LipwrightError(f"{path}: {name[:40]!r}: {error}; correct it") from None


def _json_to_clip(path: PathLike, content: dict[str, Any]) -> Clip:
    fps = _rate(path, content)
    names, rows = content.get("names"), content.get("values")
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


def check_names(path: PathLike, names: Iterable[str]) -> None:
    """Refuse names of curves that a clip or a file cannot have.

    Raises:
        LipwrightError: a name is empty, repeats, or has a control character or a line's end.
    """
    seen: set[str] = set()
    for number, name in enumerate(names, 1):
        if not name:
            raise LipwrightError(f"{path}: control {number} has no name; name it or delete it")
        if name in seen:
            raise LipwrightError(f"{path}: the control {name[:40]!r} stands twice; delete one")
        if not is_text(name):
            raise LipwrightError(
                f"{path}: control {number}, {name[:40]!a}, has a control character or a line's end "
                "in its name; rename it"
            )
        seen.add(name)


def make_clip(path: PathLike, names: list[str], fps: float, rows: list[list[float]]) -> Clip:
    """The clip of checked fields.

    Raises:
        LipwrightError: a name is none, or a value is too large.
    """
    check_names(path, names)
    values = np.array(rows, np.float64).reshape(len(rows), len(names))
    limit = float(np.finfo(np.float32).max)
    if (np.abs(values) > limit).any():
        frame, column = np.argwhere(np.abs(values) > limit)[0]
        raise LipwrightError(
            f"{path}: frame {frame}: {names[column][:40]!r} is too large a number; correct it"
        )
    return Clip(tuple(names), fps, values.astype(np.float32))


read = read_clip_json
