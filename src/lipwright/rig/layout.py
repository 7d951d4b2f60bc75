"""The layout of a rig's JSON: which fields there are, and of which kind.

What has another kind, or a name that no field has, is refused by its place before a rig is made of
it: a slip of the pen must not be passed over.
"""

from __future__ import annotations

import json
from typing import Any, Final

from lipwright.controls import is_text
from lipwright.errors import LipwrightError
from lipwright.rig.mapping import LARGEST

ANY: Final = "*"  # the key of an object whose fields are named by people
SHOWN: Final = 24  # letters of a value or name that is wrong

_WEIGHTS: Final = {ANY: float}
_ROWS: Final = {ANY: {"from": _WEIGHTS, "offset": float, "clamp": [float]}}
LAYOUT: Final[dict[str, Any]] = {
    "format": str,
    "version": int,
    "name": str,
    "title": str,
    "source": str,
    "license": str,
    "discrete": bool,
    "controls": [{"name": str, "low": float, "high": float, "rest": float}],
    "mirror": [[str]],
    "bones": [{"name": str, "parent": str, "at": [float]}],
    "looks": {ANY: _WEIGHTS},
    "lacks": {ANY: str},
    "mapping": {
        "method": str,
        "controls": _ROWS,
        "correctives": [{"control": str, "of": [str], "gain": float}],
        "reference": str,
        "mean": _WEIGHTS,
        "poses": [{"mode": int, "sigma": float, "controls": _WEIGHTS}],
        "shut": _WEIGHTS,
    },
}
"""field to its kind: a type, a list with the kind of its items, or an object of fields"""
_OPTIONAL: Final = frozenset({"mapping", "clamp"})  # null is the same as none
_WORDS: Final = {
    str: "text", int: "a whole number", float: f"a number up to {LARGEST:.0f}",
    bool: "true or false",
}  # fmt: skip


def parse_rig(text: str) -> dict[str, Any]:
    """The object of a rig's JSON; its version is not looked at.

    Raises:
        LipwrightError: a key stands twice in an object, or it is no object.
        ValueError: it is no JSON, or has a number of thousands of digits.
        RecursionError: it is nested too deeply.
    """
    data = json.loads(text, object_pairs_hook=_unique)
    if not isinstance(data, dict):
        raise LipwrightError(f"is no rig: it is {_short(data)}, not an object; name a rig's file")
    return data


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise LipwrightError(f"the key {key[:SHOWN]!r} stands twice in an object; delete one")
        found[key] = value
    return found


def check_layout(value: Any, kind: Any = LAYOUT, place: str = "") -> None:
    """Refuse a value that is not of a kind.

    Raises:
        LipwrightError: it is of another kind, has an unknown field, or text with what is none;
            names its place, such as `'controls' 3: 'low'`.
    """
    if isinstance(kind, dict) and isinstance(value, dict):
        _check_fields(value, kind, place)
    elif isinstance(kind, list) and isinstance(value, list):
        for number, item in enumerate(value, 1):
            check_layout(item, kind[0], f"{place} {number}")
    elif isinstance(kind, dict | list) or not _is_of(value, kind):
        what = "a list" if isinstance(kind, list) else _WORDS.get(kind, "an object")
        raise LipwrightError(f"is no rig: {place} is {_short(value)}, not {what}; correct it")
    elif isinstance(value, str):
        _check_text(value, place)


def _check_fields(value: dict[str, Any], kind: dict[str, Any], place: str) -> None:
    for key, item in value.items():
        _check_text(key, place or "a field")
        inside = f"{place}: {key[:SHOWN]!r}" if place else repr(key[:SHOWN])
        if key not in kind and ANY not in kind:
            raise LipwrightError(
                f"is no rig: {inside} is no field here; the fields are {', '.join(kind)}"
            )
        if item is not None or key not in _OPTIONAL:
            check_layout(item, kind.get(key, kind.get(ANY)), inside)


def _is_of(value: Any, kind: type) -> bool:
    if isinstance(value, bool) or kind is bool:
        return kind is bool and isinstance(value, bool)
    if kind is float:
        return isinstance(value, int | float) and abs(value) <= LARGEST
    return isinstance(value, kind)


def _check_text(text: str, place: str) -> None:
    if not is_text(text):
        raise LipwrightError(
            f"is no rig: {place} has {text[:SHOWN]!a}, with a control character or a line's "
            "end; correct it"
        )


def _short(value: Any) -> str:
    try:
        text = json.dumps(value)
    except ValueError:  # a number of thousands of digits
        text = "a long number"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
