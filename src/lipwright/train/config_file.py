"""Configurations out of JSON files, and with other values.

Those that ship are files of `configs/`. A file that names an `engine` is for the learner of that
name, other files are for networks.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Mapping
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from lipwright.dataset.recording import from_json
from lipwright.errors import LipwrightError
from lipwright.train.config import Config, MisfitError, need
from lipwright.train.learner import LEARNERS, LearnerConfig

Chosen = typing.TypeVar("Chosen", Config, LearnerConfig, Config | LearnerConfig)
"""a configuration that stays of its kind"""


def load_config(source: str) -> Config | LearnerConfig:
    """The configuration of a name in `configs/`, or of a JSON file.

    Raises:
        LipwrightError: there is none, or a key of it is unknown or has a value that cannot be.
    """
    shipped = _shipped()
    try:
        text = (shipped[source] if source in shipped else Path(source)).read_text("utf-8")
    except FileNotFoundError as error:
        known = ", ".join(shipped)
        raise LipwrightError(
            f"{source}: no such configuration; name a file, or: {known}"
        ) from error
    except (OSError, ValueError) as error:
        raise LipwrightError(f"{source}: cannot be read as text: {error}") from error
    try:
        values = from_json(text)
    except (ValueError, RecursionError) as error:
        raise LipwrightError(f"{source}: not JSON ({error})") from error
    return config_from(values, source)


def _shipped() -> dict[str, Path]:
    """Name to file of the configurations that come with the package."""
    folder = Path(str(files("lipwright.train"))) / "configs"
    return {path.stem: path for path in sorted(folder.glob("*.json"))}


def config_from(values: Any, source: str) -> Config | LearnerConfig:
    """The configuration that plain values say.

    Args:
        values: as JSON has them.
        source: named in errors.

    Raises:
        LipwrightError: a key is unknown or missing, or has a value that cannot be.
    """
    try:
        return _build(_kind_of(values), values, "")
    except MisfitError as error:
        raise LipwrightError(f"{source}: {error}") from error


def _kind_of(values: Any) -> type[Any]:
    engine = values.get("engine") if isinstance(values, dict) else None
    if engine is None:
        return Config
    known = isinstance(engine, str) and engine in LEARNERS
    need(known, "engine", f"is {engine!r}, not one of: {', '.join(LEARNERS)}")
    found: type[Any] = import_module(LEARNERS[engine]).CONFIG
    return found


def override(config: Chosen, changes: Mapping[str, Any], source: str) -> Chosen:
    """The configuration with other values.

    Args:
        config: what to change.
        changes: key, such as `network.layers`, to plain value.
        source: named in errors.

    Raises:
        LipwrightError: as `config_from`.
    """
    values = config.to_json()
    for key, value in changes.items():
        place = values
        *path, last = key.split(".")
        for part in path:
            inner = place.get(part)
            if not isinstance(inner, dict):
                raise LipwrightError(f"{source}: {key!r} is no key of a configuration")
            place = inner
        if last not in place:
            raise LipwrightError(f"{source}: {key!r} is no key of a configuration")
        place[last] = value
    changed: typing.Any = config_from(values, source)
    return changed


def _build(kind: Any, value: Any, key: str) -> Any:
    """`value` as the type `kind`, which a field of a configuration has."""
    if dataclasses.is_dataclass(kind):
        return _build_class(typing.cast(type[Any], kind), value, key)
    arguments = typing.get_args(kind)
    match typing.get_origin(kind):
        case types.UnionType:  # X | None
            return None if value is None else _build(arguments[0], value, key)
        case typing.Literal:
            choices = ", ".join(map(repr, arguments))
            need(value in arguments, key, f"is {value!r}, not one of: {choices}")
            return value
        case origin if origin is tuple:
            need(isinstance(value, list), key, f"is {value!r}, not a list")
            return tuple(_build(arguments[0], item, key) for item in value)
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    fits = isinstance(value, kind) and not (isinstance(value, bool) and kind is not bool)
    need(fits, key, f"is {value!r}, not {_NOUNS[kind]}")
    return value


_NOUNS: Final = {str: "text", int: "a whole number", float: "a number"}


def _build_class(kind: type[Any], value: Any, key: str) -> Any:
    before = f"{key}." if key else ""
    need(isinstance(value, dict), key or "the file", f"is {value!r}, not an object")
    hints = typing.get_type_hints(kind)
    for name in value:
        need(name in hints, before + name, f"is unknown; known are: {', '.join(hints)}")
    for field in dataclasses.fields(kind):
        optional = field.default is not dataclasses.MISSING
        need(optional or field.name in value, before + field.name, "is missing")
    built = {name: _build(hints[name], item, before + name) for name, item in value.items()}
    try:
        return kind(**built)
    except MisfitError as error:
        raise MisfitError(before + error.key, error.text) from error
