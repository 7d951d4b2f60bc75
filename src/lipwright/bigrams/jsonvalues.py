"""Values of JSON as what they should be, or a `Fault` that says where they are not."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from lipwright.bigrams.places import Fault, Step

Path = tuple[Step, ...]


def named(path: Path) -> str:
    """What a path leads to, for people: the innermost key."""
    keys = [step for step in path if isinstance(step, str)]
    return repr(keys[-1][:40]) if keys else "the file"


def member(fields: Mapping[str, Any], key: str, path: Path = ()) -> dict[str, Any]:
    """An object of objects, empty where it is left out."""
    return object_at(fields.get(key, {}), (*path, key))


def object_at(value: object, path: Path) -> dict[str, Any]:
    """A value that is an object."""
    if not isinstance(value, dict):
        raise Fault(path, f"{named(path)} is {kind_of(value)}, not an object in {{}}")
    return value


def check_keys(fields: Mapping[str, Any], known: tuple[str, ...], path: Path) -> None:
    """Refuse keys that nobody knows."""
    for key in fields:
        if key not in known:
            raise Fault(
                (*path, key), f"unknown key {key[:40]!r}; known are: {', '.join(known)}",
                of_key=True,
            )  # fmt: skip


def is_number(value: object) -> bool:
    """Whether a value is a finite number (a truth value is not)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number beyond every float
        return False


def number_at(value: object, path: Path) -> float:
    """A value that is a finite number."""
    if not is_number(value):
        raise Fault(path, f"{named(path)} is {shown(value)}, not a finite number")
    assert isinstance(value, int | float)
    return float(value)


def from_zero(fields: Mapping[str, Any], key: str, *, above: bool = False) -> float | None:
    """A number from 0 on, or above 0; None where it is left out."""
    if key not in fields:
        return None
    number = number_at(fields[key], (key,))
    if number < 0 or (above and number == 0):
        raise Fault(
            (key,), f"{key!r} is {number:g}; write a number {'above 0' if above else 'from 0 on'}"
        )
    return number


def text_at(value: object, path: Path) -> str:
    """A value that is a text."""
    if not isinstance(value, str):
        raise Fault(path, f"{named(path)} is {kind_of(value)}, not a text in quotes")
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        raise Fault(
            path, f"{named(path)} has half a letter (a lone surrogate); write it again"
        ) from None
    return value


def word_at(value: object, path: Path) -> str:
    """A value that is a text of one line, without spaces around it."""
    text = text_at(value, path)
    if not text.isprintable() or text.strip() != text or not text:
        raise Fault(
            path, f"{named(path)}: {text[:40]!r} is empty, or has letters that do not print"
        )
    return text


def kind_of(value: object) -> str:
    """What a value of JSON is, for people."""
    if value is None:
        return "null"
    kinds = {bool: "a truth value", int: "a number", float: "a number", str: "a text",
             list: "a list", dict: "an object"}  # fmt: skip
    for kind, words in kinds.items():
        if isinstance(value, kind):
            return words
    return "nothing known"


def shown(value: object) -> str:
    """A value in an error: short, and never nested."""
    if isinstance(value, str):
        return repr(value[:40])
    if isinstance(value, float) or type(value) is int:
        return f"{value:g}" if isinstance(value, float) or abs(value) < 1e15 else "a huge number"
    return kind_of(value)
