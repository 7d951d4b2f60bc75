"""Our own JSON of a phone track: phones, edges, stress and words, nothing rounded or lost."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import PathLike, fit_track
from lipwright.formats.source import MAX_SECONDS, read_text
from lipwright.phones import PHONES
from lipwright.track import PhoneTrack, Word

FORMAT: Final = "lipwright-track"
VERSION: Final = 1


def read(path: Path, duration: float | None = None) -> PhoneTrack:
    """The track of our JSON.

    Raises:
        LipwrightError: the file is not such JSON; names the phone, edge or word that is wrong.
    """
    track = json_to_track(path, parse_json(path, FORMAT, VERSION))
    places = [f"phone {index}" for index in range(1, len(track) + 1)]
    return fit_track(path, track, places, duration)


def to_text(path: Path, track: PhoneTrack) -> str:
    """Our JSON, one line a field."""
    content = {"format": FORMAT, "version": VERSION, **track_to_json(track)}
    fields = (f"  {json.dumps(key)}: {dump(value)}" for key, value in content.items())
    return "{\n" + ",\n".join(fields) + "\n}\n"


def dump(value: Any) -> str:
    """JSON on one line, with letters of any script as they are."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def track_to_json(track: PhoneTrack) -> dict[str, Any]:
    """The fields of a track: `phones`, `edges`, `stress` and `words`."""
    return {
        "phones": list(track.phones),
        "edges": [float(edge) for edge in track.edges],
        "stress": list(track.stress),
        "words": [
            {"text": w.text, "first": w.first, "stop": w.stop, "confidence": w.confidence}
            for w in track.words
        ],
    }


def parse_json(path: PathLike, kind: str, *versions: int) -> dict[str, Any]:
    """The object that one of our files holds.

    Raises:
        LipwrightError: it is not JSON, repeats a key, or is of another kind or version.
    """

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key, value in pairs:
            if key in found:
                raise LipwrightError(f"{path}: the key {key[:24]!r} stands twice; delete one")
            found[key] = value
        return found

    def no_constant(name: str) -> float:
        raise LipwrightError(f"{path}: holds {name}, which is no number; correct it")

    text = read_text(path)
    try:
        content = json.loads(text, object_pairs_hook=unique, parse_constant=no_constant)
    except json.JSONDecodeError as error:
        raise LipwrightError(
            f"{path}: line {error.lineno}, column {error.colno}: not JSON: {error.msg}; correct it"
        ) from None
    except (RecursionError, ValueError):  # brackets without end; a number of thousands of digits
        raise LipwrightError(
            f"{path}: nested too deeply or a number too long; correct it"
        ) from None
    if not isinstance(content, dict) or content.get("format") != kind:
        found = content.get("format") if isinstance(content, dict) else None
        is_of = f"is of the format {str(found)[:24]!r}" if found else "names no format"
        raise LipwrightError(f'{path}: {is_of}; expected "format": "{kind}"')
    found = content.get("version")
    if isinstance(found, bool) or found not in versions:
        known = " or ".join(map(str, versions))
        raise LipwrightError(
            f"{path}: is of version {str(found)[:24]} of {kind}, not {known}; write it again with "
            "this version of Lipwright, or update Lipwright"
        )
    return content


def json_to_track(path: PathLike, content: dict[str, Any]) -> PhoneTrack:
    """The track of fields that `track_to_json` made, or that someone wrote by hand.

    Raises:
        LipwrightError: a field is missing, of the wrong kind or out of range.
    """
    phones = _list(path, content, "phones")
    for index, phone in enumerate(phones, 1):
        if not isinstance(phone, str) or phone not in PHONES:
            raise LipwrightError(
                f"{path}: phone {index} is {str(phone)[:24]!r}, not in the phone table; correct it "
                "('lipwright phones' lists the known ones)"
            )
    edges = _list(path, content, "edges")
    if len(edges) != len(phones) + 1:
        raise LipwrightError(
            f"{path}: has {len(edges)} edges for {len(phones)} phones; write {len(phones) + 1}"
        )
    for index, edge in enumerate(edges, 1):
        if not is_number(edge) or not 0 <= edge <= MAX_SECONDS:
            raise LipwrightError(
                f"{path}: edge {index} is {str(edge)[:24]}, not a time in s from 0 to "
                f"{MAX_SECONDS:g}; correct it"
            )
        if index > 1 and edge <= edges[index - 2]:
            raise LipwrightError(
                f"{path}: edge {index} ({edge:.3f} s) is not after the one before it; correct it"
            )
    words = tuple(
        _json_to_word(path, index, word)
        for index, word in enumerate(_list(path, content, "words", []), 1)
    )
    stress = _list(path, content, "stress", [])
    if any(not (mark is None or type(mark) is int) for mark in stress):
        raise LipwrightError(f"{path}: stress holds other than 0, 1, 2 and null; correct it")
    try:
        return PhoneTrack(tuple(phones), [float(edge) for edge in edges], words, tuple(stress))  # type: ignore[arg-type]  # it makes the array
    except ValueError as error:
        raise LipwrightError(f"{path}: {error}; correct it") from None


def is_number(value: object) -> bool:
    """Whether a value of JSON is a finite number (a truth value is not)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    # A whole number of hundreds of digits has no float.
    return math.isfinite(value) if isinstance(value, float) else abs(value) < 2**1023


def _list(
    path: PathLike, content: dict[str, Any], key: str, default: list[Any] | None = None
) -> list[Any]:
    value = content.get(key, default)
    if not isinstance(value, list):
        what = "is not a list" if key in content else "is missing"
        raise LipwrightError(f"{path}: {key!r} {what}; correct it")
    return value


def _json_to_word(path: PathLike, index: int, word: object) -> Word:
    fields = word if isinstance(word, dict) else {}
    text, first, stop = (fields.get(key) for key in ("text", "first", "stop"))
    confidence = fields.get("confidence")
    if (
        not isinstance(text, str)
        or type(first) is not int
        or type(stop) is not int
        or not (confidence is None or is_number(confidence))
    ):
        raise LipwrightError(
            f"{path}: word {index} is {str(word)[:40]!r}; write text, first, stop and, if known, "
            "confidence"
        )
    return Word(text, first, stop, None if confidence is None else confidence)
