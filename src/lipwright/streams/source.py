"""The JSON that other programs write, and what is wrong in it, with its place."""

from __future__ import annotations

import json
from collections.abc import Iterable
from contextlib import suppress
from json import JSONDecodeError
from pathlib import Path
from typing import Any, Final

from lipwright.controls import is_text
from lipwright.errors import LipwrightError
from lipwright.formats.jsontrack import is_number
from lipwright.formats.source import MAX_SECONDS, read_text, text_lines

MAX_CHARS: Final = 64 * 1024 * 1024  # an hour of MP3 in base64, which some services send along

Fields = dict[str, Any]


def read_content(path: Path) -> Any:
    """The value of a JSON file, or the list of those of a file with one a line.

    Raises:
        LipwrightError: it is neither, or too large; names line and column.
    """
    text = read_text(path)
    if len(text) > MAX_CHARS:
        raise LipwrightError(
            f"{path}: larger than {MAX_CHARS // 2**20} MB; take the sound out of it, and keep the "
            "times of one recording in a file"
        )
    try:
        return _parse(path, text)
    except JSONDecodeError as error:
        lines = [(n, line) for n, line in enumerate(text_lines(text), 1) if line.strip()]
        if error.msg != "Extra data" or len(lines) < 2:
            raise _not_json(path, error.lineno, error) from None
    return [_parse_line(path, number, line) for number, line in lines]


def _parse(path: Path, text: str) -> Any:
    try:
        return json.loads(text)
    except JSONDecodeError:
        raise
    except (RecursionError, ValueError):  # brackets without end; a number of thousands of digits
        raise LipwrightError(
            f"{path}: nested too deeply or a number too long; correct it"
        ) from None


def _parse_line(path: Path, number: int, line: str) -> Any:
    try:
        return _parse(path, line)
    except JSONDecodeError as error:
        raise _not_json(path, number, error) from None


def _not_json(path: Path, line: int, error: JSONDecodeError) -> LipwrightError:
    return LipwrightError(
        f"{path}: line {line}, column {error.colno}: not JSON: {error.msg}; save it again"
    )


def fields_of(path: Path, value: Any, place: str) -> Fields:
    """An object of the file.

    Raises:
        LipwrightError: it is something else.
    """
    if not isinstance(value, dict):
        raise LipwrightError(f"{path}: {place} is {brief(value)}, not an object; save it again")
    return value


def list_of(path: Path, value: Any, place: str) -> list[Any]:
    """A list of the file.

    Raises:
        LipwrightError: it is something else, or missing.
    """
    if not isinstance(value, list):
        found = "missing" if value is None else f"{brief(value)}, not a list"
        raise LipwrightError(f"{path}: {place} is {found}; save the whole answer of the program")
    return value


def text_of(path: Path, fields: Fields, key: str, place: str) -> str:
    """A text of an object.

    Raises:
        LipwrightError: it is missing, or has what cannot be written.
    """
    value = fields.get(key)
    if not isinstance(value, str):
        found = "missing" if value is None else f"{brief(value)}, not a text"
        raise LipwrightError(f"{path}: {place}: {key!r} is {found}; save it again")
    plain = " ".join(value.split())
    if not is_text(plain):
        raise LipwrightError(
            f"{path}: {place}: {key!r} has a control character or half a letter; delete it"
        )
    return plain


def seconds_of(path: Path, value: Any, place: str, what: str, unit: float = 1.0) -> float:
    """A time in s out of a number, or of digits in quotes, that counts `unit` s.

    Raises:
        LipwrightError: it is missing or no finite time; names `place` and `what` it should be.
    """
    if isinstance(value, str) and value.isascii() and "_" not in value:
        with suppress(ValueError):
            value = float(value)
    if value is None:
        raise LipwrightError(f"{path}: {place}: {what!r} is missing; save it again with times")
    if not is_number(value) or abs(value) * unit > MAX_SECONDS:
        raise LipwrightError(f"{path}: {place}: {what!r} is {brief(value)}, not a time; correct it")
    return float(value) * unit


def first_key(fields: Fields, keys: Iterable[str]) -> str | None:
    """The first of `keys` that an object has with a value."""
    return next((key for key in keys if fields.get(key) is not None), None)


def brief(value: Any) -> str:
    """A value, short enough for an error."""
    return ascii(value)[:24]
