"""Rigs as files: JSON, in `rigs/` those that ship."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.rig.layout import check_layout, parse_rig
from lipwright.rig.mapping import (
    SIGMA,
    Corrective,
    LinearMapping,
    Mapped,
    PoseMapping,
    RigPose,
    Row,
)
from lipwright.rig.values import Bone, Control, Rig

FORMAT: Final = "lipwright-rig"
VERSION: Final = 1

RIGS: Final = (
    "arkit", "facefx", "smartbody", "oculus", "vrm1", "vrm0", "preston-blair", "rhubarb",
    "rocketbox", "cc4", "metahuman", "makehuman", "mmd", "live2d", "bones",
)  # fmt: skip
"""names of the rigs that ship"""


def load_rig(name: str | Path) -> Rig:
    """A rig that ships, by name, or that of a JSON file.

    Raises:
        LipwrightError: no such rig, lists the known ones; or the file cannot be used.
    """
    if str(name) in RIGS:
        return _shipped(str(name))
    path = Path(name)
    if path.suffix != ".json" or "\0" in str(name):
        raise LipwrightError(
            f"no rig {str(name)!r}; the rigs are: {', '.join(RIGS)}, or name a .json file"
        )
    return read_rig(path)


@cache
def _shipped(name: str) -> Rig:
    data = json.loads(files("lipwright").joinpath("rigs", f"{name}.json").read_text("utf-8"))
    return _from_json(data)


MAX_RIG_BYTES: Final = 4_000_000  # a rig is names and a few numbers


def read_rig(path: Path) -> Rig:
    """The rig of a JSON file, in the form of those that ship.

    Raises:
        LipwrightError: the file cannot be read, or is no rig; says where and why.
    """
    try:
        if path.exists() and not path.is_file():
            raise LipwrightError(f"{path}: is a folder, device or pipe; name a rig's JSON file")
        if path.stat().st_size > MAX_RIG_BYTES:
            raise LipwrightError(f"{path}: over {MAX_RIG_BYTES:,} bytes, which is no rig")
        text = path.read_text("utf-8")
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read ({error.strerror}); name a rig") from error
    except UnicodeDecodeError as error:
        raise LipwrightError(f"{path}: is not UTF-8 text; name a rig's JSON file") from error
    try:
        return _from_json(parse_rig(text))
    except json.JSONDecodeError as error:
        raise LipwrightError(
            f"{path}:{error.lineno}:{error.colno}: {error.msg}; a rig is a JSON file"
        ) from error
    except LipwrightError as error:
        raise LipwrightError(f"{path}: {error}") from error
    except KeyError as error:
        raise LipwrightError(f"{path}: a rig needs {error}, and this one has none") from error
    except (TypeError, ValueError, AttributeError, RecursionError) as error:
        raise LipwrightError(
            f"{path}: is no rig ({error}); compare it with one that works"
        ) from error


def _from_json(data: Any) -> Rig:
    _check_version(data)
    check_layout(data)
    mapping = data.get("mapping")
    return Rig(
        name=data["name"],
        controls=tuple(Control(**control) for control in data["controls"]),
        mirror=_mirror(data["mirror"]),
        source=data["source"],
        license=data["license"],
        looks=data.get("looks", {}),
        title=str(data.get("title", "")),
        mapping=None if mapping is None else _to_mapping(mapping),
        lacks={str(name): str(what) for name, what in data.get("lacks", {}).items()},
        discrete=bool(data.get("discrete", False)),
        bones=tuple(Bone(**bone) for bone in data.get("bones", ())),
    )


def _check_version(data: Any) -> None:
    if data.get("format", FORMAT) != FORMAT:
        raise LipwrightError(f"is a {str(data['format'])[:40]!r}, not a rig; name a rig's file")
    version = data.get("version", VERSION)
    if isinstance(version, bool) or not isinstance(version, int) or version < 1:
        raise LipwrightError(f"'version' is {str(version)[:24]!r}, not a number from 1 on")
    if version > VERSION:
        raise LipwrightError(
            f"is a rig of version {version}, and this Lipwright reads up to {VERSION}; run: "
            "pip install --upgrade lipwright"
        )


def _mirror(pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Pairs as a mapping both ways; what pairs twice keeps its first partner and is refused."""
    mirror: dict[str, str] = {}
    for left, right in pairs:
        mirror.setdefault(left, right)
        mirror.setdefault(right, left)
    return mirror


def _to_mapping(data: Any) -> Mapped:
    method = data["method"]
    if method == LinearMapping.method:
        return LinearMapping(
            _to_rows(data["controls"]),
            tuple(
                Corrective(row["control"], tuple(row["of"]), row["gain"])
                for row in data.get("correctives", ())
            ),
        )
    if method == PoseMapping.method:
        return PoseMapping(
            data["mean"],
            tuple(
                RigPose(pose["mode"], pose.get("sigma", SIGMA), pose["controls"])
                for pose in data["poses"]
            ),
            data.get("reference", PoseMapping.reference),
            data.get("shut", {}),
            _to_rows(data.get("controls", {})),
        )
    raise LipwrightError(
        f"the mapping's method is {str(method)[:24]!r}; the methods are: {LinearMapping.method}, "
        f"{PoseMapping.method}"
    )


def _to_rows(data: Any) -> dict[str, Row]:
    return {
        name: Row(row["from"], row.get("offset", 0.0), _clamp(row.get("clamp")))
        for name, row in data.items()
    }


def _clamp(ends: Any) -> tuple[float, float] | None:
    return None if ends is None else tuple(ends)


def save_rig(rig: Rig, path: str | Path) -> None:
    """Write a rig as JSON that people can edit, whole or not at all.

    Raises:
        LipwrightError: the file cannot be written.
    """
    with write_whole(path) as part:
        part.write_text(rig_to_text(rig), "utf-8")


def rig_to_text(rig: Rig) -> str:
    """The JSON of a rig: one control, look, row or pose a line."""
    return "{\n" + ",\n".join(_fields(rig)) + "\n}\n"


def _fields(rig: Rig) -> Iterator[str]:
    about = {"format": FORMAT, "version": VERSION, "name": rig.name, "title": rig.title,
             "source": rig.source, "license": rig.license}  # fmt: skip
    for key, value in about.items():
        yield f"  {_dump(key)}: {_dump(value)}"
    if rig.discrete:
        yield '  "discrete": true'
    yield _rows("controls", [_dump(_control(control)) for control in rig.controls])
    place = rig.names.index
    pairs = [pair for pair in rig.mirror.items() if place(pair[0]) < place(pair[1])]
    yield _rows("mirror", [_dump(pair) for pair in pairs])
    if rig.bones:
        bones = [{"name": b.name, "parent": b.parent, "at": b.at} for b in rig.bones]
        yield _rows("bones", [_dump(bone) for bone in bones])
    if rig.looks:
        yield _named("looks", {name: _dump(dict(look)) for name, look in rig.looks.items()})
    if rig.mapping is not None:
        yield _mapping_text(rig.mapping)
    if rig.lacks:
        yield _named("lacks", {name: _dump(what) for name, what in rig.lacks.items()})


def _control(control: Control) -> dict[str, Any]:
    fields = {"name": control.name, "low": control.low, "high": control.high, "rest": control.rest}
    usual = {"low": 0.0, "high": 1.0, "rest": 0.0}
    return {key: value for key, value in fields.items() if usual.get(key) != value}


def _mapping_text(mapping: Mapped) -> str:
    rows = {name: _dump(_row(row)) for name, row in mapping.rows.items()}
    if isinstance(mapping, LinearMapping):
        correctives = [
            _dump({"control": c.control, "of": c.of, "gain": c.gain}) for c in mapping.correctives
        ]
        inside = [_named("controls", rows, 4)]
        inside += [_rows("correctives", correctives, 4)] if correctives else []
    else:
        poses = [
            _dump({"mode": p.mode, "sigma": p.sigma, "controls": dict(p.values)})
            for p in mapping.poses
        ]
        inside = [
            f'    "reference": {_dump(mapping.reference)}',
            f'    "mean": {_dump(dict(mapping.mean))}',
            _rows("poses", poses, 4),
        ]
        inside += [f'    "shut": {_dump(dict(mapping.shut))}'] if mapping.shut else []
        inside += [_named("controls", rows, 4)] if rows else []
    return (
        f'  "mapping": {{\n    "method": {_dump(mapping.method)},\n' + ",\n".join(inside) + "\n  }"
    )


def _row(row: Row) -> dict[str, Any]:
    fields: dict[str, Any] = {"from": dict(row.gains)}
    if row.offset:
        fields["offset"] = row.offset
    if row.clamp is not None:
        fields["clamp"] = row.clamp
    return fields


def _rows(key: str, rows: list[str], indent: int = 2) -> str:
    pad = " " * indent
    if not rows:
        return f"{pad}{_dump(key)}: []"
    return f"{pad}{_dump(key)}: [\n" + ",\n".join(f"{pad}  {row}" for row in rows) + f"\n{pad}]"


def _named(key: str, rows: Mapping[str, str], indent: int = 2) -> str:
    pad = " " * indent
    lines = ",\n".join(f"{pad}  {_dump(name)}: {row}" for name, row in rows.items())
    return f"{pad}{_dump(key)}: {{\n{lines}\n{pad}}}" if rows else f"{pad}{_dump(key)}: {{}}"


def _dump(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def canonical_rig() -> Rig:
    """The rig that all engines speak: ARKit and the tongue controls."""
    rig = load_rig("arkit")
    assert rig.names == CANONICAL  # the file and the table are one set; a test proves it
    return rig
