"""An artist's poses as files: JSON and CSV, and the templates to fill in.

JSON: an object with `mean`, `poses` (`mode1-3`, `mode1+3` and so on) and, where wanted, `shut`,
each with the rig's controls and their values; `controls` for what no mode shows, as in a rig's
file; `reference`. CSV: a table with the column `pose` and one of each control, one row a pose; an
empty cell is a control that is left out.

A control that the mean leaves out is at rest there; one that a pose leaves out is as in the mean;
one that `shut` leaves out follows the poses.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.face.shapes import MEAN, SHUT
from lipwright.retarget.pose_table import PoseTable, to_mapping
from lipwright.rig import MODES, PoseMapping, Rig, Row

FORMAT: Final = "lipwright-poses"
VERSION: Final = 1  # raise when the fields of the file change
MAX_BYTES: Final = 4_000_000  # a few poses are a few thousand numbers
SUFFIXES: Final = (".json", ".csv")
_FIELDS: Final = ("format", "version", "reference", "mean", "poses", "shut", "controls")


def read_poses(path: Path, rig: Rig, modes: int = MODES) -> PoseMapping:
    """The mapping that a JSON or CSV file of poses gives a rig.

    Args:
        path: the file.
        rig: whose controls it sets.
        modes: how many modes it must have both poses of; it may have more.

    Raises:
        LipwrightError: the file cannot be used; says where and why.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise LipwrightError(
            f"{path}: poses are read from {', '.join(SUFFIXES)}, .glb and .gltf files; name one"
        )
    text = _read(path)
    try:
        table = _from_json(text) if suffix == ".json" else _from_csv(text)
        return to_mapping(table, rig, modes)
    except json.JSONDecodeError as error:
        raise LipwrightError(
            f"{path}:{error.lineno}:{error.colno}: {error.msg}; poses are a JSON file"
        ) from error
    except (
        LipwrightError,
        csv.Error,
        ValueError,
        TypeError,
        RecursionError,
        OverflowError,
    ) as error:
        raise LipwrightError(f"{path}: {error}") from error


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise LipwrightError(f"{path}: over {MAX_BYTES:,} bytes, which are no poses")
        return path.read_text("utf-8-sig")
    except OSError as error:
        raise LipwrightError(
            f"{path}: cannot be read ({error.strerror}); name a file of poses"
        ) from error
    except UnicodeDecodeError as error:
        raise LipwrightError(f"{path}: is not UTF-8 text; name a file of poses") from error


def _from_json(text: str) -> PoseTable:
    data = json.loads(text, object_pairs_hook=_once)
    if not isinstance(data, dict) or data.get("format", FORMAT) != FORMAT:
        raise LipwrightError("is no file of poses; start from one of: lipwright rigs poses")
    version = data.get("version", VERSION)
    if isinstance(version, bool) or not isinstance(version, int) or not 1 <= version <= VERSION:
        raise LipwrightError(
            f"is a file of poses of version {str(version)[:24]}, and this Lipwright reads up to "
            f"{VERSION}; run: pip install --upgrade lipwright"
        )
    if unknown := sorted(set(data) - set(_FIELDS)):
        raise LipwrightError(f"the field {unknown[0]!r} is unknown; there are {', '.join(_FIELDS)}")
    poses = {MEAN: data.get("mean", {}), **_object(data, "poses"), SHUT: data.get("shut", {})}
    for label, values in poses.items():
        _object({label: values}, label)
    rows = {}
    for name, row in _object(data, "controls").items():
        clamp = row.get("clamp") if isinstance(row, dict) else None
        rows[name] = Row(
            _object({name: row}, name).get("from", {}), row.get("offset", 0.0),
            None if clamp is None else tuple(clamp),
        )  # fmt: skip
    return PoseTable(poses, str(data.get("reference", PoseMapping.reference)), rows)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    names = [name for name, _ in pairs]
    for name in names:
        if names.count(name) > 1:
            raise LipwrightError(f"{name!r} stands there twice; keep one of them")
    return dict(pairs)


def _object(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    found = data.get(key, {})
    if not isinstance(found, dict):
        raise LipwrightError(f"{key!r} is {str(found)[:24]}, not an object of names and values")
    return found


def _from_csv(text: str) -> PoseTable:
    mark = text[len("pose") : len("pose") + 1]
    delimiter = mark if mark in {";", "\t"} else ","
    rows = list(csv.reader(io.StringIO(text), strict=True, delimiter=delimiter))
    if not rows or not rows[0] or rows[0][0].strip() != "pose":
        raise LipwrightError("the table's first column is not 'pose'; see: lipwright rigs poses")
    names = [name.strip() for name in rows[0][1:]]
    if again := [name for name in names if names.count(name) > 1]:
        raise LipwrightError(f"line 1: the column {again[0]!r} stands there twice")
    poses: dict[str, dict[str, float]] = {}
    for line, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        label, *cells = (row[0].strip(), *row[1:])
        if label in poses:
            raise LipwrightError(f"line {line}: the pose {label!r} stands there twice; keep one")
        if len(cells) > len(names):
            raise LipwrightError(f"line {line}: {len(cells)} values for {len(names)} controls")
        poses[label] = {
            name: _number(cell, name, line)
            for name, cell in zip(names, cells, strict=False) if cell.strip()
        }  # fmt: skip
    return PoseTable(poses)


def _number(cell: str, name: str, line: int) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LipwrightError(f"line {line}: {name!r} is {cell.strip()[:24]!r}, not a number")
    return value


def table_to_json(table: PoseTable) -> str:
    """The JSON of poses: one a line."""

    def dump(value: Any) -> str:
        return json.dumps(value, ensure_ascii=False, allow_nan=False)

    ends = {key: dump(dict(table.poses.get(key, {}))) for key in (MEAN, SHUT)}
    between = ",\n".join(
        f"    {dump(label)}: {dump(dict(values))}"
        for label, values in table.poses.items() if label not in ends
    )  # fmt: skip
    return (
        f'{{\n  "format": {dump(FORMAT)},\n  "version": {VERSION},\n'
        f'  "reference": {dump(table.reference)},\n  "mean": {ends[MEAN]},\n'
        f'  "poses": {{\n{between}\n  }},\n  "shut": {ends[SHUT]}\n}}\n'
    )


def table_to_csv(table: PoseTable, names: Iterable[str]) -> str:
    """The CSV of poses, a column for each of `names`."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("pose", *(names := tuple(names))))
    for label, values in table.poses.items():
        writer.writerow((label, *(values.get(name, "") for name in names)))
    return text.getvalue()
