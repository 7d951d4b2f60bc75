"""ElevenLabs: the answer of "Create speech with timing", as JSON.

`alignment` and `normalized_alignment` have `characters`, `character_start_times_seconds` and
`character_end_times_seconds` of one length each, as in the reference of
`text-to-speech/{voice_id}/with-timestamps`. The normalized text is what the voice has said
(numbers written out), so it goes before the other.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from lipwright.controls import is_text
from lipwright.errors import LipwrightError
from lipwright.streams.source import (
    Fields,
    brief,
    fields_of,
    first_key,
    list_of,
    read_content,
    seconds_of,
)
from lipwright.streams.times import Timed
from lipwright.streams.words import letters_to_track
from lipwright.track import PhoneTrack

LAYERS: Final = ("normalized_alignment", "alignment")
CHARACTERS: Final = "characters"
STARTS: Final = "character_start_times_seconds"
ENDS: Final = "character_end_times_seconds"


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    return isinstance(content, dict) and (
        STARTS in content
        or any(isinstance(content.get(key), dict) and STARTS in content[key] for key in LAYERS)
    )


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of an answer.

    Raises:
        LipwrightError: it has no characters with times, or the lists differ in length.
    """
    if isinstance(content, list):
        raise LipwrightError(
            f"{path}: holds {len(content)} chunks of a stream; save the one answer of "
            "/with-timestamps instead of /stream/with-timestamps"
        )
    fields = fields_of(path, content, "the file")
    layer = None if STARTS in fields else first_key(fields, LAYERS)
    if layer is None and STARTS not in fields:
        raise LipwrightError(
            f"{path}: has neither 'alignment' nor 'normalized_alignment'; save the answer of "
            "/v1/text-to-speech/{voice_id}/with-timestamps"
        )
    inside = fields if layer is None else fields_of(path, fields[layer], repr(layer))
    return letters_to_track(path, _letters(path, inside), language, duration)


def _letters(path: Path, fields: Fields) -> list[Timed]:
    rows = [list_of(path, fields.get(key), repr(key)) for key in (CHARACTERS, STARTS, ENDS)]
    letters, starts, ends = rows
    if not len(letters) == len(starts) == len(ends):
        raise LipwrightError(
            f"{path}: {len(letters)} characters, {len(starts)} start times and {len(ends)} end "
            "times; save the whole answer again"
        )
    found = []
    for number, (letter, start, end) in enumerate(zip(letters, starts, ends, strict=True), 1):
        place = f"character {number}"
        if not isinstance(letter, str) or not is_text(letter.replace("\n", " ")):
            raise LipwrightError(f"{path}: {place}: is {brief(letter)}, no character; correct it")
        found.append(
            Timed(
                letter,
                seconds_of(path, start, place, STARTS),
                seconds_of(path, end, place, ENDS),
                place,
            )
        )
    return found
