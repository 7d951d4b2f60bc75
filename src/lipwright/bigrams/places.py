"""Where in a JSON text a value stands; looked for only when something is wrong with it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from lipwright.errors import LipwrightError

Step = str | int
"""a key of an object, or a place in a list from 0"""

_SPACE: Final = re.compile(r"[ \t\r\n]*")
_DECODER: Final = json.JSONDecoder(strict=False, parse_int=float)


class Fault(ValueError):  # noqa: N818  # not an error yet: nobody knows in which file
    """Something wrong with a value, on the way to which `path` leads."""

    def __init__(self, path: Sequence[Step], message: str, *, of_key: bool = False) -> None:
        """`of_key`: the key is wrong, not the value behind it."""
        super().__init__(message)
        self.path = tuple(path)
        self.of_key = of_key

    def in_file(self, name: object, text: str) -> LipwrightError:
        """The same as an error of the file `name` with that text."""
        line, column = locate(text, self.path, of_key=self.of_key)
        return LipwrightError(f"{name}: line {line}, column {column}: {self}")


class Repeated(dict[str, Any]):
    """An object one of whose keys stands twice."""

    key: str = ""


@dataclass(frozen=True)
class _Item:
    """A member of an object or list."""

    step: Step
    at: int
    """offset of the key, or of the value in a list"""
    value: int
    """offset of the value"""


def locate(text: str, path: Sequence[Step], *, of_key: bool = False) -> tuple[int, int]:
    """Line and column, from 1, of the value that `path` leads to.

    Where a key stands twice the last one counts, as it does for `json`. A path that leads nowhere
    gives the place of the last value on its way.

    Args:
        text: valid JSON.
        path: keys and places, outermost first.
        of_key: the place of its key instead, where it has one.
    """
    at = value = _skip(text, 0)
    for step in path:
        found = None
        for item in _items(text, value):
            if item.step == step:
                found = item
                if isinstance(step, int):
                    break
        if found is None:
            return line_and_column(text, value)
        at, value = found.at, found.value
    return line_and_column(text, at if of_key else value)


def line_and_column(text: str, offset: int) -> tuple[int, int]:
    """Both from 1, whatever ends the lines."""
    before = text[:offset].replace("\r\n", "\n").replace("\r", "\n")
    return before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1


def find_repeated(content: object) -> tuple[Step, ...] | None:
    """The way to a key that stands twice, or None; `content` as parsed by `parse`."""
    waiting: list[tuple[tuple[Step, ...], object]] = [((), content)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, Repeated):
            return (*path, value.key)
        if isinstance(value, dict):
            waiting += [((*path, key), inner) for key, inner in value.items()]
        elif isinstance(value, list):
            waiting += [
                ((*path, place), inner)
                for place, inner in enumerate(value)
                if isinstance(inner, dict | list)
            ]
    return None


def parse(name: object, text: str) -> Any:
    """The value of a JSON text; no key of it stands twice.

    Numbers that are not finite, or that no float can hold, become infinite or not a number.

    Raises:
        LipwrightError: it is not JSON, is nested too deeply, or a key stands twice; names line
            and column.
    """
    repeated: list[Repeated] = []
    unique = partial(_unique, repeated)
    try:
        try:
            content = json.loads(text, object_pairs_hook=unique)
        except json.JSONDecodeError:
            raise
        except ValueError:  # a whole number of thousands of digits
            content = json.loads(text, object_pairs_hook=unique, parse_int=float)
    except json.JSONDecodeError as error:
        line, column = line_and_column(text, error.pos)
        raise LipwrightError(
            f"{name}: line {line}, column {column}: not JSON: {error.msg}; correct it"
        ) from None
    except RecursionError:
        raise LipwrightError(f"{name}: brackets are nested too deeply; correct it") from None
    if repeated and (path := find_repeated(content)):
        fault = Fault(path, f"{path[-1]!r} stands twice; delete one", of_key=True)
        raise fault.in_file(name, text)
    return content


def _unique(repeated: list[Repeated], pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The object of these members; one whose keys repeat is added to `repeated`."""
    found = dict(pairs)
    if len(found) == len(pairs):
        return found
    marked, seen = Repeated(found), set[str]()
    for key, _ in pairs:
        if key in seen:
            marked.key = key
        seen.add(key)
    repeated.append(marked)
    return marked


def _skip(text: str, offset: int) -> int:
    """The offset after white space."""
    found = _SPACE.match(text, offset)
    assert found is not None  # it matches nothing too
    return found.end()


def _items(text: str, offset: int) -> Iterator[_Item]:
    """The members of the object or list at `offset`; none of any other value."""
    if text[offset] not in "{[":
        return
    is_object = text[offset] == "{"
    place, offset = 0, _skip(text, offset + 1)
    while text[offset] not in "}]":
        at, step = offset, place
        if is_object:
            key, offset = _DECODER.raw_decode(text, offset)
            offset = _skip(text, _skip(text, offset) + 1)  # over the colon
            yield _Item(key, at, offset)
        else:
            yield _Item(step, at, offset)
        _, offset = _DECODER.raw_decode(text, offset)
        offset = _skip(text, offset)
        if text[offset] == ",":
            offset = _skip(text, offset + 1)
        place += 1
