"""JSON of apps that record ARKit weights.

Three layouts are read: a table of names and rows (NVIDIA Audio2Face: `facsNames`, `weightMat`,
`exportFps`), a list of frames each with a time and its weights (phone apps), and our own clip.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.video import LEAST_FPS
from lipwright.clip import MAX_FPS
from lipwright.errors import LipwrightError
from lipwright.export.arkit_names import NameMatch, control_column, match_names, plain_name
from lipwright.export.arkit_recording import ArkitRecording, FrameTable, table_to_recording
from lipwright.export.jsonclip import FORMAT, read_clip_json
from lipwright.export.stamps import (
    TIME_NAMES,
    FrameTimes,
    Stamps,
    even_times,
    stamps_to_times,
)
from lipwright.formats.jsontrack import is_number
from lipwright.formats.source import read_text

PathLike = str | os.PathLike[str]
Fields = Mapping[str, Any]
_Names = tuple[str, ...]

# Plain names (`arkit_names.plain_name`) of fields, in the order in which they are looked for.
FPS_NAMES: Final[_Names] = ("exportfps", "fps", "framerate")
NAMES_NAMES: Final[_Names] = (
    "facsnames", "facenames", "blendshapenames", "blendshapekeys", "shapekeys", "shapenames",
    "names", "keys", "channels", "blendshapes",
)  # fmt: skip
ROWS_NAMES: Final[_Names] = (
    "weightmat", "blendshapevalues", "blendshapeweights", "weights", "values", "frames", "data",
)  # fmt: skip
FRAMES_NAMES: Final[_Names] = (
    "frames", "data", "samples", "records", "recording", "blendshapes",
)  # fmt: skip
WEIGHTS_NAMES: Final[_Names] = (
    "blendshapes", "blendshapeweights", "blendshapevalues", "weights", "values", "coefficients",
    "shapes", "facs", "w",
)  # fmt: skip
TIMES_NAMES: Final[_Names] = ("times", "timestamps", "timecodes")
NUMBER_NAMES: Final[_Names] = ("frame", "frameindex", "framenumber", "index", "frameid")
TRACKED_NAMES: Final[_Names] = (
    "istracked", "tracked", "facedetected", "facefound", "facepresent", "facevalid", "valid",
)  # fmt: skip
PAIR_NAMES: Final[_Names] = (
    "name", "key", "k", "categoryname", "shape", "blendshapelocation", "label",
)  # fmt: skip
PAIR_VALUES: Final[_Names] = ("value", "v", "score", "weight")


def read_arkit_json(path: PathLike, timecode_fps: int | None = None) -> ArkitRecording:
    """The recording of a JSON file.

    Args:
        path: the file.
        timecode_fps: frames a second that its time codes count, if it has such; None finds it out.

    Raises:
        LipwrightError: it is not JSON, of no layout that is known, or a frame is wrong; names
            line or frame.
    """
    content = _parse(path)
    if isinstance(content, dict) and content.get("format") == FORMAT:
        return _read_clip(path)
    fields = _plain(content) if isinstance(content, dict) else {}
    names = _names(fields)
    rows = next((fields[n] for n in ROWS_NAMES if names and _is_rows(fields.get(n))), None)
    if names and rows is not None:
        return _read_rows(path, fields, names, rows, timecode_fps)
    frames = content if isinstance(content, list) else _frames(fields)
    if not isinstance(frames, list) or not frames:
        raise LipwrightError(
            f"{path}: has neither names with rows of weights nor a list of frames; export the "
            "recording as one of the layouts in docs/capture.md"
        )
    return _read_frames(path, fields, names, frames, timecode_fps)


def _parse(path: PathLike) -> Any:
    text = read_text(path)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise LipwrightError(
            f"{path}: line {error.lineno}, column {error.colno}: not JSON: {error.msg}; correct it"
        ) from None
    except (RecursionError, ValueError):
        raise LipwrightError(
            f"{path}: nested too deeply or a number too long; correct it"
        ) from None


def _plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    """The fields by plain name; of two with the same, the first."""
    found: dict[str, Any] = {}
    for key, value in fields.items():
        found.setdefault(plain_name(key), value)
    return found


def _names(fields: Fields) -> list[str] | None:
    for key in NAMES_NAMES:
        names = fields.get(key)
        if isinstance(names, list) and names and all(isinstance(name, str) for name in names):
            return names
    return None


def _is_rows(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, list) for v in value)


def _frames(fields: Fields) -> Any:
    for key in FRAMES_NAMES:
        value = fields.get(key)
        if isinstance(value, list) and any(isinstance(frame, dict) for frame in value):
            return value
    return None


def _read_clip(path: PathLike) -> ArkitRecording:
    clip = read_clip_json(path)
    rows = clip.values.astype(np.float64)
    match = match_names(path, clip.names)
    return _recording(
        path, match, rows[:, match.columns], even_times(clip.fps, len(clip)), "Lipwright clip"
    )


def _read_rows(
    path: PathLike, fields: Fields, names: list[str], rows: list[list[Any]], code_fps: int | None
) -> ArkitRecording:
    for frame, row in enumerate(rows):
        _check_length(path, frame, row, names)
    match = match_names(path, names)
    values = np.stack([_numbers(path, frame, names, row) for frame, row in enumerate(rows)])
    fps = _fps(path, fields)
    key = next((k for k in (*TIMES_NAMES, *TIME_NAMES) if isinstance(fields.get(k), list)), None)
    if key is not None and len(fields[key]) == len(rows):
        times = _stamped(path, key, fields[key], code_fps or fps)
    elif fps is None:
        raise LipwrightError(f"{path}: neither 'fps' nor 'times' is there; add one")
    else:
        times = even_times(fps, len(rows))
    source = "Audio2Face JSON" if "facsnames" in fields else "JSON table"
    return _recording(path, match, values[:, match.columns], times, source)


def _read_frames(
    path: PathLike, fields: Fields, names: list[str] | None, frames: list[Any], code_fps: int | None
) -> ArkitRecording:
    for index, frame in enumerate(frames):
        if not isinstance(frame, dict):
            raise LipwrightError(
                f"{path}: frame {index} is {str(frame)[:24]!r}, not an object with a time and "
                "weights; correct it"
            )
    plain = [_plain(frame) for frame in frames]
    weights = [
        _frame_weights(path, index, frame, raw, names)
        for index, (frame, raw) in enumerate(zip(plain, frames, strict=True))
    ]
    found = list(dict.fromkeys(name for frame in weights if frame for name in frame))
    match = match_names(path, found)
    chosen = [found[column] for column in match.columns]
    values = np.full((len(frames), len(chosen)), np.nan)
    for index, frame in enumerate(weights):
        if frame is not None:  # a weight that a frame leaves out is at rest there
            row = [frame.get(name, 0.0) for name in chosen]
            values[index] = _numbers(path, index, chosen, row)
    kept = NameMatch(tuple(range(len(chosen))), match.targets, match.notes)
    times = _frame_times(path, fields, plain, code_fps)
    return _recording(path, kept, values, times, "JSON of frames")


def _frame_weights(
    path: PathLike, index: int, frame: Fields, raw: Mapping[str, Any], names: list[str] | None
) -> Mapping[str, Any] | None:
    """Name to weight; None where the app saw no face."""
    if any(frame.get(key) is False for key in TRACKED_NAMES):
        return None
    key = next((key for key in WEIGHTS_NAMES if key in frame), None)
    if key is None:  # the weights stand beside the time
        inline = {name: value for name, value in raw.items() if control_column(name) is not None}
        return inline or None
    weights = frame[key]
    if not weights:
        return None
    if isinstance(weights, dict):
        return weights
    if isinstance(weights, list) and all(isinstance(pair, dict) for pair in weights):
        return dict(_pair(path, index, pair) for pair in weights)
    if isinstance(weights, list) and names is not None:
        _check_length(path, index, weights, names)
        return dict(zip(names, weights, strict=True))
    what = "a list without names" if isinstance(weights, list) else f"{str(weights)[:24]!r}"
    raise LipwrightError(f"{path}: frame {index}: its weights are {what}; write names and weights")


def _pair(path: PathLike, index: int, pair: Mapping[str, Any]) -> tuple[str, Any]:
    fields = _plain(pair)
    name = next((fields[key] for key in PAIR_NAMES if key in fields), None)
    value = next((fields[key] for key in PAIR_VALUES if key in fields), None)
    if not isinstance(name, str) or value is None:
        raise LipwrightError(
            f"{path}: frame {index}: the weight {str(pair)[:40]!r} has no name or no value; "
            "correct it"
        )
    return name, value


def _frame_times(
    path: PathLike, fields: Fields, frames: Sequence[Fields], code_fps: int | None
) -> FrameTimes:
    fps = _fps(path, fields)
    keys = {key for frame in frames for key in frame}
    key = next((key for key in TIME_NAMES if key in keys), None)
    if key is not None:
        return _stamped(path, key, [frame.get(key) for frame in frames], code_fps or fps)
    if fps is None:
        raise LipwrightError(
            f"{path}: its frames have no time, and the file no 'fps'; add 'fps' or a 'timestamp' "
            "to each frame"
        )
    key = next((key for key in NUMBER_NAMES if key in keys), None)
    if key is None:
        return even_times(fps, len(frames))
    numbers = [_numbers(path, i, [key], [frame.get(key)]) for i, frame in enumerate(frames)]
    return FrameTimes(np.concatenate(numbers) / fps, f"{fps:g} frames a second, numbered")


def _stamped(path: PathLike, key: str, values: Sequence[Any], fps: float | None) -> FrameTimes:
    stamps = Stamps(path, fps, key)
    for frame, value in enumerate(values):
        stamps.add(f"frame {frame}", value)
    return stamps_to_times(stamps)


def _fps(path: PathLike, fields: Fields) -> float | None:
    key = next((key for key in FPS_NAMES if fields.get(key) is not None), None)
    if key is None:
        return None
    fps = fields[key]
    if not is_number(fps) or not 0 < fps <= MAX_FPS:
        raise LipwrightError(
            f"{path}: the rate is {str(fps)[:24]!r}, not a number up to {MAX_FPS:g} a second; "
            "correct it"
        )
    return float(fps)


def _check_length(path: PathLike, frame: int, row: Sequence[Any], names: Sequence[str]) -> None:
    if len(row) != len(names):
        raise LipwrightError(
            f"{path}: frame {frame} has {len(row)} weights, not one for each of the {len(names)} "
            "names; correct it"
        )


def _numbers(
    path: PathLike, frame: int, names: Sequence[str], row: Sequence[Any]
) -> npt.NDArray[np.float64]:
    """(D,) the finite numbers of a frame."""
    for name, value in zip(names, row, strict=True):
        if not is_number(value):
            raise LipwrightError(
                f"{path}: frame {frame}: {name[:40]} is {str(value)[:24]!r}, not a number; "
                "correct it"
            )
    return np.array(row, np.float64)


def _recording(
    path: PathLike,
    match: NameMatch,
    rows: npt.NDArray[np.float64],
    times: FrameTimes,
    source: str,
) -> ArkitRecording:
    table = FrameTable(
        match=match,
        times=times.times,
        rows=rows,
        places=np.arange(len(rows)),
        unit="frame",
        source=f"{source}, {times.layout}",
        timecode=times.timecode,
        notes=times.notes,
    )
    return table_to_recording(path, table, LEAST_FPS)
