"""Google Cloud: marks of Text-to-Speech, words of Speech-to-Text, as JSON.

`timepoints` with `markName` and `timeSeconds` as in the reference of `text:synthesize` (v1beta1);
each mark is named by the word that follows it. `results`, `alternatives`, `words` with
`startTime` and `endTime` such as "1.400s" as in the reference of `WordInfo` (v1), or `startOffset`
and `endOffset` (v2); the answer of a long-running operation has them in `response`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.streams.source import (
    Fields,
    fields_of,
    first_key,
    list_of,
    read_content,
    seconds_of,
    text_of,
)
from lipwright.streams.times import Timed
from lipwright.streams.words import words_to_track
from lipwright.track import PhoneTrack

STARTS: Final = ("startTime", "startOffset", "start_time", "start_offset")
ENDS: Final = ("endTime", "endOffset", "end_time", "end_offset")
_COUNTED: Final = re.compile(r"(?:mark|word|m|w|t|timepoint)?[-_ ]?\d+", re.IGNORECASE)


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    if not isinstance(content, dict):
        return False
    inside = content.get("response", content)
    results = inside.get("results") if isinstance(inside, dict) else None
    return "timepoints" in content or (
        isinstance(results, list)
        and any(isinstance(row, dict) and "alternatives" in row for row in results)
    )


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of marks or words.

    Raises:
        LipwrightError: there are none, or marks are not named by words.
    """
    fields = fields_of(path, content, "the file")
    if "timepoints" in fields:
        return words_to_track(path, list(_marks(path, fields)), language, duration)
    inside = fields_of(path, fields.get("response", fields), "'response'")
    if "results" not in inside:
        raise LipwrightError(
            f"{path}: has neither 'timepoints' (Text-to-Speech with enableTimePointing) nor "
            "'results' (Speech-to-Text with enableWordTimeOffsets); save the whole answer"
        )
    return words_to_track(path, list(_words(path, inside)), language, duration)


def _marks(path: Path, fields: Fields) -> Iterator[Timed]:
    rows = list_of(path, fields["timepoints"], "'timepoints'")
    for number, value in enumerate(rows, 1):
        place = f"timepoint {number}"
        mark = fields_of(path, value, place)
        name = text_of(path, mark, "markName", place)
        if _COUNTED.fullmatch(name):
            raise LipwrightError(
                f"{path}: {place}: the mark {name[:24]!r} is not a word; name each mark of the "
                'SSML by the word that follows it: <mark name="hello"/>hello'
            )
        # Of JSON without zeros, as protocol buffers write it, the first time may be missing.
        start = seconds_of(path, mark.get("timeSeconds", 0), place, "timeSeconds")
        yield Timed(name, start, None, place)


def _words(path: Path, fields: Fields) -> Iterator[Timed]:
    number, lacking = 0, True
    for result in list_of(path, fields["results"], "'results'"):
        rows = list_of(
            path, fields_of(path, result, "a result").get("alternatives", []), "a result"
        )
        if not rows:
            continue
        best = fields_of(path, rows[0], "an alternative")
        for value in list_of(path, best.get("words", []), "'words'"):
            number, lacking = number + 1, False
            place = f"word {number}"
            word = fields_of(path, value, place)
            end = _time(path, word, ENDS, place)
            missing = first_key(word, STARTS) is None and end is not None
            start = 0.0 if missing and number == 1 else _time(path, word, STARTS, place)
            yield Timed(text_of(path, word, "word", place), start, end, place)
    if lacking:
        raise LipwrightError(
            f"{path}: its results have no 'words'; ask Speech-to-Text for enableWordTimeOffsets"
        )


def _time(path: Path, word: Fields, keys: tuple[str, ...], place: str) -> float:
    key = first_key(word, keys) or keys[0]
    value = word.get(key)
    if isinstance(value, dict):  # as the Python client prints it
        whole = seconds_of(path, value.get("seconds", 0), place, key)
        return whole + seconds_of(path, value.get("nanos", 0), place, key, 1e-9)
    return seconds_of(
        path, value.removesuffix("s") if isinstance(value, str) else value, place, key
    )
