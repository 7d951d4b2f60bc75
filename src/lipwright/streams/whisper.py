"""WhisperX, openai-whisper and faster-whisper: words with times, as JSON.

`segments` with `words` of `word`, `start` and `end` in s, as in whisperx/types.py
(`AlignedTranscriptionResult`) and as `transcribe(word_timestamps=True)` of openai-whisper and
faster-whisper gives them; or `words` alone, as the speech-to-text services of OpenAI
(`verbose_json`) and ElevenLabs answer. WhisperX leaves the times of words out that it could not
align, such as numbers. With `--return_char_alignments` its segments have `chars`, timed letters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from lipwright.streams.words import letters_to_track, words_to_track
from lipwright.track import PhoneTrack

WORDS: Final = ("words", "word_segments")
NAMES: Final = ("word", "text", "char")


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    if not isinstance(content, dict):
        return False
    rows = content.get(first_key(content, ("segments", *WORDS)) or "segments")
    return isinstance(rows, list) and any(
        isinstance(row, dict) and "start" in row and "end" in row for row in rows
    )


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of words, or of their letters where all segments have them.

    Raises:
        LipwrightError: there are no words with times, or one cannot be said.
    """
    fields = fields_of(path, content, "the file")
    rows = list_of(path, fields.get("segments", []), "'segments'")
    segments = [fields_of(path, row, f"segment {n}") for n, row in enumerate(rows, 1)]
    if segments and all(isinstance(segment.get("chars"), list) for segment in segments):
        return letters_to_track(path, list(_letters(path, segments)), language, duration)
    told = [row for segment in segments for row in _rows(path, segment, "words")]
    told = told or [row for key in WORDS for row in _rows(path, fields, key)]
    if not told:
        raise LipwrightError(
            f"{path}: has no 'words' with times; transcribe with word timestamps (whisper "
            "--word_timestamps True; WhisperX with alignment, not --no_align)"
        )
    return words_to_track(path, _timed(path, told, "word"), language, duration)


def _rows(path: Path, fields: Fields, key: str) -> list[Fields]:
    """The words of an object; a row of start, end and word is as faster-whisper's tuples dump."""
    found = []
    for number, row in enumerate(list_of(path, fields.get(key) or [], repr(key)), 1):
        is_tuple = isinstance(row, list) and len(row) >= 3
        value = dict(zip(("start", "end", "word"), row, strict=False)) if is_tuple else row
        word = fields_of(path, value, f"{key[:-1]} {number}")
        if word.get("type", "word") == "word":
            found.append(word)
    return found


def _letters(path: Path, segments: Sequence[Fields]) -> Iterator[Timed]:
    rows: list[Fields] = []
    for segment in segments:
        rows += [fields_of(path, row, "a character") for row in segment["chars"]]
        rows.append({"char": " "})
    yield from _timed(path, rows, "character")


def _timed(path: Path, rows: Sequence[Fields], what: str) -> list[Timed]:
    """The rows with times; one without begins where the one before it ends."""
    found: list[Timed] = []
    for number, row in enumerate(rows, 1):
        place = f"{what} {number}"
        key = first_key(row, NAMES) or NAMES[0]
        text = text_of(path, row, key, place) or " "
        if row.get("start") is None:
            before = found[-1] if found else None
            at = 0.0 if before is None else before.start if before.end is None else before.end
            found.append(Timed(text, at, at if what == "character" else None, place))
            continue
        start = seconds_of(path, row["start"], place, "start")
        end = None if row.get("end") is None else seconds_of(path, row["end"], place, "end")
        found.append(Timed(text, start, end, place))
    if all(row.get("start") is None for row in rows):
        raise LipwrightError(f"{path}: no {what} has a time; align it again")
    return found
