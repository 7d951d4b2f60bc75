"""SmartBody's sets as text: `createDiphone(...)` and `addKey(...)`, parsed and never executed.

SmartBody's users keep sets in Python scripts. Of such a script only these two calls are read,
wherever they stand; everything else in it is skipped.
"""

from __future__ import annotations

import ast
import json
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

from lipwright.bigrams.places import Fault, line_and_column
from lipwright.bigrams.smartbody import SILENT, Imported, class_name, curves_to_set, repeated_note
from lipwright.bigrams.values import BigramSet, Pair, check_points, check_pose_name
from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE

CREATE: Final = "createDiphone"
ADD: Final = "addKey"
UNNAMED: Final = "default"
"""the set of a pair that names none"""

LISTED: Final = 20  # sets, in an error
MAX_LETTERS: Final = 8_000_000  # twenty whole sets of a language; each million takes 4 s

_CALL: Final = re.compile(rf"\b(?:{CREATE}|{ADD})\s*\(")
_TOKEN: Final = re.compile(
    r"""(?P<space>[ \t\f\ufeff]+|\\\r?\n)|(?P<end>\r?\n|\r|;)|(?P<comment>\#[^\r\n]*)
    |(?P<string>(?:[rRbBuUfF]{0,2})(?:\"{3}(?:\\.|[^\\])*?\"{3}|'{3}(?:\\.|[^\\])*?'{3}
        |"(?:\\.|[^"\\\r\n])*"|'(?:\\.|[^'\\\r\n])*'))
    |(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)|(?P<sign>.)""",
    re.VERBOSE | re.DOTALL,
)


class _Token(NamedTuple):  # of which there are many
    kind: str
    text: str
    offset: int


@dataclass(frozen=True)
class _Call:
    """A call of one of the two, and what its value is given to or it is called on."""

    name: str
    arguments: tuple[str | float, ...]
    offset: int
    owner: str
    """the variable before the dot"""
    target: str
    """the variable before the sign of assignment"""


def is_smartbody_text(text: str) -> bool:
    """Whether a text has the calls of a set of SmartBody's, and is no JSON."""
    return not text.lstrip().startswith(("{", "[")) and _CALL.search(text) is not None


def text_to_set(path: object, text: str, name: str | None = None) -> Imported:
    """The set of SmartBody's as text.

    Args:
        path: names the file in errors.
        text: its content.
        name: the set that is wanted, where the text has several.

    Raises:
        LipwrightError: a call is wrong, names line and column; or the set is not there, lists
            those that are; or the text is too long.
    """
    if len(text) > MAX_LETTERS:
        raise LipwrightError(
            f"{path}: {len(text):,} letters of SmartBody's calls, over {MAX_LETTERS:,}; split it"
        )
    sets: dict[str, dict[Pair, dict[str, list[tuple[float, float]]]]] = {}
    notes: dict[str, list[str]] = {}
    current: tuple[str, Pair] | None = None
    variables: dict[str, tuple[str, Pair]] = {}
    for call in _calls(path, text):
        if call.name == CREATE:
            current = _created(path, text, call)
            pairs = sets.setdefault(current[0], {})
            if current[1] in pairs:
                notes.setdefault(current[0], []).append(repeated_note(current[1]))
            pairs[current[1]] = {}
            if call.target:
                variables[call.target] = current
            continue
        to = variables.get(call.owner, current)
        if to is None:
            raise _wrong(path, text, call.offset, f"{ADD} before any {CREATE}")
        pose, point = _key(path, text, call)
        points = sets[to[0]][to[1]].setdefault(pose, [])
        points.append(point)
        if reason := _out_of_place(points):
            raise _wrong(path, text, call.offset, f"the key is {reason}")
    chosen = _choose(path, list(sets), name)
    curves = {
        pair: {pose: tuple(points) for pose, points in drawn.items()}
        for pair, drawn in sets[chosen].items()
    }
    return curves_to_set(chosen, curves, notes.get(chosen, ()))


def _out_of_place(points: list[tuple[float, float]]) -> str:
    """What is wrong with the last of the points; empty if nothing is."""
    try:
        check_points(tuple(points[-2:]))
    except ValueError as error:
        return str(error).partition(" is ")[2]  # after the number of the point
    return ""


def set_to_text(bigrams: BigramSet) -> str:
    """A set as SmartBody reads it: a script that makes every pair."""
    lines = [
        f"# {' '.join(bigrams.source.split())}",
        f"# Licence: {' '.join(bigrams.licence.split())}",
        "diphones = scene.getDiphoneManager()",
    ]
    for pair, bigram in bigrams.bigrams.items():
        first, second = (_quoted(SILENT if one == SILENCE else one) for one in pair)
        lines += ["", f"diphone = diphones.{CREATE}({first}, {second}, {_quoted(bigrams.name)})"]
        lines += [
            f"diphone.{ADD}({_quoted(pose)}, {time:.6g}, {value:.6g})"
            for pose, points in bigram.curves.items()
            for time, value in points
        ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _choose(path: object, names: list[str], name: str | None) -> str:
    if name is None and len(names) == 1:
        return names[0]
    if name in names:
        assert name is not None
        return name
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    listed = (", ".join(names[:LISTED]) or "none") + more
    wrong = f"no set {name!r}" if name is not None else "several sets"
    raise LipwrightError(f"{path}: {wrong}; choose one of these with --name: {listed}")


def _created(path: object, text: str, call: _Call) -> tuple[str, Pair]:
    if len(call.arguments) not in (2, 3) or any(isinstance(a, float) for a in call.arguments):
        raise _wrong(path, text, call.offset, f'{CREATE} takes "class", "class" and "set"')
    first, second, *of = map(str, call.arguments)
    try:
        pair = class_name(first, ("from",)), class_name(second, ("to",))
    except Fault as fault:
        raise _wrong(path, text, call.offset, str(fault)) from None
    return of[0] if of else UNNAMED, pair


def _key(path: object, text: str, call: _Call) -> tuple[str, tuple[float, float]]:
    match call.arguments:
        case (str(pose), float(time), float(value)):
            try:
                check_pose_name(pose)
            except ValueError as error:
                raise _wrong(path, text, call.offset, str(error)) from None
            return pose, (time, value)
    raise _wrong(path, text, call.offset, f'{ADD} takes "pose", time and value')


def _calls(path: object, text: str) -> Iterator[_Call]:
    tokens = list(_tokens(text))
    start = 0  # of the statement
    place = 0
    while place < len(tokens):
        token = tokens[place]
        if token.kind == "end":
            start = place + 1
        is_call = token.kind == "name" and token.text in (CREATE, ADD) and _sign(tokens, place + 1)
        if is_call != "(" or (place > 0 and tokens[place - 1].text == "def"):
            place += 1
            continue
        arguments, after = _arguments(path, text, tokens, place + 2)
        named = place >= 2 and tokens[place - 1].text == "." and tokens[place - 2].kind == "name"
        given = tokens[start].kind == "name" and _sign(tokens, start + 1) == "="
        yield _Call(
            token.text,
            arguments,
            token.offset,
            owner=tokens[place - 2].text if named else "",
            target=tokens[start].text if given else "",
        )
        place = after


def _sign(tokens: list[_Token], place: int) -> str:
    """The sign at a place; empty where there is none."""
    is_there = place < len(tokens) and tokens[place].kind == "sign"
    return tokens[place].text if is_there else ""


def _tokens(text: str) -> Iterator[_Token]:
    """What a text is made of, without white space and comments."""
    for found in _TOKEN.finditer(text):
        kind = found.lastgroup or "sign"
        if kind not in ("space", "comment"):
            yield _Token(kind, found[0], found.start())


def _arguments(
    path: object, text: str, tokens: list[_Token], place: int
) -> tuple[tuple[str | float, ...], int]:
    """The values up to the bracket that ends a call, and the place after it."""
    values: list[str | float] = []
    factor, wants_value = 1.0, True
    for at in range(place, len(tokens)):
        token = tokens[at]
        if token.kind == "end" and token.text != ";":
            continue  # within brackets
        if token.text == ")" and factor == 1:
            return tuple(values), at + 1
        if wants_value and token.kind == "sign" and token.text in "+-" and factor == 1:
            factor = -1.0 if token.text == "-" else 1.0
        elif wants_value and token.kind == "number":
            values.append(factor * float(token.text))
            factor, wants_value = 1.0, False
        elif wants_value and token.kind == "string" and factor == 1:
            values.append(_string(path, text, token))
            wants_value = False
        elif not wants_value and token.text == ",":
            wants_value = True
        else:
            raise _wrong(
                path, text, token.offset, f"{token.text[:24]!r} is no plain text or number"
            )
    raise _wrong(path, text, tokens[place - 1].offset, "the bracket of this call never ends")


def _string(path: object, text: str, token: _Token) -> str:
    """The value of a string; only literals are read."""
    try:
        with warnings.catch_warnings():  # of a backslash that means nothing
            warnings.simplefilter("ignore")
            value = ast.literal_eval(token.text)
    except (ValueError, SyntaxError):
        value = None
    if not isinstance(value, str) or not value.isprintable() or not value.strip():
        raise _wrong(path, text, token.offset, f"{token.text[:40]} is no plain text")
    return value.strip()


def _wrong(path: object, text: str, offset: int, what: str) -> LipwrightError:
    line, column = line_and_column(text, offset)
    return LipwrightError(f"{path}: line {line}, column {column}: {what}; correct it")
