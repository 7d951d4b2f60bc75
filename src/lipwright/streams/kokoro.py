"""Kokoro: tokens of the package `kokoro`, or captioned speech of Kokoro-FastAPI, as JSON.

A token has `text`, `phonemes`, `start_ts` and `end_ts` in s (`MToken` of the g2p misaki, filled in
by `KPipeline`); a list of them, or an object with `tokens`. Captioned speech has `timestamps` with
`word`, `start_time` and `end_time` (`CaptionedSpeechResponse`), without phonemes. The letters of
phonemes are those of EN_PHONES.md of misaki: IPA, with a capital for each diphthong of English.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval
from lipwright.language.base import Pronunciation
from lipwright.language.codes import is_english
from lipwright.language.ipa import read_ipa
from lipwright.streams.saying import Said, give_room, span_intervals
from lipwright.streams.source import (
    Fields,
    fields_of,
    first_key,
    list_of,
    read_content,
    seconds_of,
    text_of,
)
from lipwright.streams.times import Timed, mend
from lipwright.streams.words import parts_to_track, words_to_track
from lipwright.track import PhoneTrack

ROWS: Final = ("tokens", "timestamps", "words")
STARTS: Final = ("start_ts", "start_time", "start")
ENDS: Final = ("end_ts", "end_time", "end")
WORDS: Final = ("text", "word")

MISAKI: Final = str.maketrans({
    "A": "eɪ", "I": "aɪ", "O": "oʊ", "Q": "əʊ", "W": "aʊ", "Y": "ɔɪ", "T": "ɾ", "ᵊ": "ə",
})  # fmt: skip
"""letters of misaki that are not of the IPA: AtE, bIte, gO, gO (Br.), fOUl, tOY, buTTer, bottlE"""


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    rows = content
    if isinstance(content, dict):
        rows = content.get(first_key(content, ROWS[:2]) or "tokens")
    return isinstance(rows, list) and any(
        isinstance(row, dict) and ("start_ts" in row or {"word", "start_time"} <= row.keys())
        for row in rows
    )


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of tokens; their phonemes are used where each word has them.

    Raises:
        LipwrightError: there are none with times, or a word cannot be said.
    """
    if isinstance(content, dict):
        key = first_key(content, ROWS)
        if key is None:
            raise LipwrightError(
                f"{path}: has neither 'tokens' (kokoro) nor 'timestamps' (Kokoro-FastAPI); save "
                "the tokens of each result, or the answer of /dev/captioned_speech"
            )
        content = content[key]
    words: list[Timed] = []
    phonemes: list[str] = []
    for number, value in enumerate(list_of(path, content, "the file"), 1):
        place = f"token {number}"
        fields = fields_of(path, value, place)
        key = first_key(fields, WORDS) or "text"
        text = text_of(path, fields, key, place)
        letters = fields.get("phonemes")
        if any(map(str.isalnum, text)):
            words.append(_timed(path, fields, text, place, words))
            phonemes.append(letters if isinstance(letters, str) else "")
    ways = [_read_phonemes(letters, language) for letters in phonemes]
    if not words or not all(ways):
        return words_to_track(path, words, language, duration)
    return _told_to_track(path, words, [way for way in ways if way], duration)


def _timed(path: Path, fields: Fields, text: str, place: str, before: list[Timed]) -> Timed:
    """A token; one without times follows the one before it."""
    start, end = first_key(fields, STARTS), first_key(fields, ENDS)
    if start is None and before:
        at = before[-1].end if before[-1].end is not None else before[-1].start
        return Timed(text, at, None, place)
    found = seconds_of(path, fields.get(start or STARTS[0]), place, start or STARTS[0])
    last = None if end is None else seconds_of(path, fields[end], place, end)
    return Timed(text, found, last, place)


def _read_phonemes(letters: str, language: str) -> Pronunciation | None:
    """The phones of a word, or None where they are not such letters."""
    try:
        sounds = read_ipa(letters.translate(MISAKI) if is_english(language) else letters, language)
    except LipwrightError:
        return None
    if not sounds:
        return None
    return Pronunciation(
        tuple(sound.phone for sound in sounds), "g2p", stress=tuple(s.stress for s in sounds)
    )


def _told_to_track(
    path: Path, words: list[Timed], ways: list[Pronunciation], duration: float | None
) -> PhoneTrack:
    mended = mend(path, words, duration)
    said = [
        (Said("_".join(word.label.split()), way),) for word, way in zip(mended, ways, strict=True)
    ]
    spans = give_room(path, mended, said, duration)
    parts: list[tuple[list[Interval], list[Interval]]] = [span_intervals(span) for span in spans]
    return parts_to_track(path, parts, duration)
