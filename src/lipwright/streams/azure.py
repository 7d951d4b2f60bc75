"""Azure Speech: events of speech synthesis, and detailed results of recognition, as JSON.

Events are those of the Speech SDK, `VisemeReceived` (audio offset, viseme ID 0 to 21, animation)
and `WordBoundary` (audio offset, duration, text, boundary type), as a list or in lists of an
object; the names of their fields count in the spelling of every language of the SDK. Times are
ticks of 100 ns. Published in "Get facial position with viseme" and "Get word boundary events" of
the Azure Speech documentation. The phones of a viseme ID are those of the enumeration SPVISEMES
(Speech API 5.4), which the table of "Speech phonetic alphabets" continues.

Results are `NBest`, `Words`, `Phonemes` of "Use pronunciation assessment", with `Offset` and
`Duration` in ticks; phonemes are named in the SAPI alphabet or in IPA.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval
from lipwright.phones import SILENCE
from lipwright.streams.labels import read_labels
from lipwright.streams.saying import give_room, say_words, span_intervals
from lipwright.streams.source import (
    Fields,
    brief,
    fields_of,
    first_key,
    list_of,
    read_content,
    seconds_of,
    text_of,
)
from lipwright.streams.times import Timed, mend
from lipwright.streams.visemes import visemes_to_track
from lipwright.streams.words import parts_to_track, words_to_track
from lipwright.track import PhoneTrack

TICK: Final = 1e-7  # s
FASTEST: Final = 0.002  # s a viseme; faster, the offsets are not ticks

VISEMES: Final = MappingProxyType({
    "0": (SILENCE,), "1": ("AH", "AE", "AX"), "2": ("AA",), "3": ("AO",), "4": ("EH", "EY", "UH"),
    "5": ("ER", "AXR"), "6": ("IY", "IH", "IX", "Y"), "7": ("UW", "W"), "8": ("OW",), "9": ("AW",),
    "10": ("OY",), "11": ("AY",), "12": ("HH",), "13": ("R",), "14": ("L",), "15": ("S", "Z"),
    "16": ("SH", "CH", "JH", "ZH"), "17": ("DH", "TH"), "18": ("F", "V"),
    "19": ("D", "T", "N", "TH"), "20": ("K", "G", "NG"), "21": ("P", "B", "M"),
})  # fmt: skip
"""viseme ID to phones, that which stands for it first"""

_CLOCK: Final = re.compile(r"(?:(\d+)\.)?(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)", re.ASCII)
_ISO: Final = re.compile(r"PT(?:(\d+)H)?(?:(\d+)M)?(?:(\d+(?:\.\d+)?)S)?", re.ASCII)


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    found = list(_objects(content))
    return any(
        "visemeid" in fields or "nbest" in fields or "blendshapes" in fields
        or ("audiooffset" in fields and "text" in fields)
        for fields in found
    )  # fmt: skip


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of events or results.

    Raises:
        LipwrightError: they are blend shapes, or lack a field; names the entry.
    """
    found = list(_objects(content))
    results = [fields for fields in found if "nbest" in fields]
    if results:
        return _results_to_track(path, results, language, duration)
    visemes = list(_visemes(path, found))
    words = list(_words(path, found))
    if visemes:
        return visemes_to_track(
            path, visemes, VISEMES, words=words, language=language, duration=duration
        )
    if any("blendshapes" in fields or _is_shapes(fields) for fields in found):
        raise LipwrightError(
            f"{path}: holds frames of blend shapes, which are curves, not phones; save the fields "
            'audio_offset and viseme_id of events without <mstts:viseme type="FacialExpression"/>'
        )
    if words:
        return words_to_track(path, words, language, duration)
    raise LipwrightError(
        f"{path}: has no viseme events (audioOffset, visemeId), word boundaries (audioOffset, "
        "text) or results (NBest); save the events of the Speech SDK, or the JSON of its result"
    )


def _objects(content: Any) -> Iterator[Fields]:
    """The events or results of a file; audio_offset, privAudioOffset and AudioOffset are one."""
    rows = content if isinstance(content, list) else [content]
    for row in rows:
        if not isinstance(row, dict):
            continue
        plain = {_plain(str(key)): value for key, value in row.items()}
        lists = [value for value in plain.values() if isinstance(value, list)]
        if "nbest" in plain or "visemeid" in plain or "blendshapes" in plain or not lists:
            yield plain
            continue
        for rows_inside in lists:
            for inside in rows_inside:
                if isinstance(inside, dict):
                    yield {_plain(str(key)): value for key, value in inside.items()}


def _plain(key: str) -> str:
    return key.replace("_", "").casefold().removeprefix("priv")


def _is_shapes(fields: Fields) -> bool:
    animation = fields.get("animation")
    return "BlendShapes" in animation if isinstance(animation, str) else isinstance(animation, dict)


def _visemes(path: Path, found: Sequence[Fields]) -> Iterator[Timed]:
    rows = [fields for fields in found if "visemeid" in fields and not _is_shapes(fields)]
    starts: list[float] = []
    for number, fields in enumerate(rows, 1):
        place = f"viseme {number}"
        start = _start(path, fields, place)
        starts.append(start)
        name = fields["visemeid"]
        label = name if isinstance(name, str) else str(name) if type(name) is int else brief(name)
        yield Timed(label, start, None, place)
    if len(starts) > 3 and 0 < max(starts) - min(starts) < FASTEST * len(starts):
        raise LipwrightError(
            f"{path}: {len(starts)} visemes in {max(starts) - min(starts):.4f} s; audioOffset "
            "counts ticks of 100 ns: save it as the SDK gives it, or name it audioOffsetMs"
        )


def _words(path: Path, found: Sequence[Fields]) -> Iterator[Timed]:
    number = 0
    for fields in found:
        kind = str(fields.get("boundarytype")).casefold()
        if "text" not in fields or "visemeid" in fields or "punct" in kind or "sentence" in kind:
            continue
        number += 1
        place = f"word {number}"
        start = _start(path, fields, place)
        key = first_key(fields, ("durationms", "duration", "audioduration"))
        length = None if key is None else _ticks(path, fields[key], place, key)
        end = None if length is None else start + length
        yield Timed(text_of(path, fields, "text", place), start, end, place)


def _start(path: Path, fields: Fields, place: str) -> float:
    key = first_key(fields, ("audiooffsetms", "audiooffset", "offset")) or "audioOffset"
    return _ticks(path, fields.get(key), place, key)


def _ticks(path: Path, value: Any, place: str, key: str) -> float:
    """A time in s: ticks, ms where the key says so, or a time span as .NET and Python write it."""
    if isinstance(value, str):
        clock, iso = _CLOCK.fullmatch(value), _ISO.fullmatch(value)
        if clock:
            days, hours, minutes, seconds = (float(part or 0) for part in clock.groups())
            value = (((days * 24 + hours) * 60 + minutes) * 60 + seconds) / TICK
        elif iso:
            hours, minutes, seconds = (float(part or 0) for part in iso.groups())
            value = ((hours * 60 + minutes) * 60 + seconds) / TICK
    return seconds_of(path, value, place, key, 1e-3 if key.endswith("ms") else TICK)


def _results_to_track(
    path: Path, results: Sequence[Fields], language: str, duration: float | None
) -> PhoneTrack:
    words: list[Timed] = []
    phonemes: list[list[Timed]] = []
    for result in results:
        best = list_of(path, result["nbest"], "'NBest'")
        if not best:
            continue
        top = _plain_fields(path, best[0], "'NBest'")
        for value in list_of(path, top.get("words"), "'Words' of 'NBest'"):
            place = f"word {len(words) + 1}"
            fields = _plain_fields(path, value, place)
            assessed = fields.get("pronunciationassessment")
            error = assessed.get("ErrorType") if isinstance(assessed, dict) else None
            if "Omission" not in (error, fields.get("errortype")):
                words.append(_entry(path, fields, "word", place))
                phonemes.append(_phonemes(path, fields, place))
    if not any(phonemes):
        return words_to_track(path, words, language, duration)
    mended = mend(path, words, duration)
    said = say_words(path, mended, language)
    parts: list[tuple[list[Interval], list[Interval]]] = []
    for word, ways, row in zip(mended, said, phonemes, strict=True):
        named = read_labels(mend(path, row, duration), language) if row else None
        if named:
            whole = Interval(named[0].start, named[-1].end, word.label, word.place)
            parts.append((named, [whole]))
        elif ways:
            span = give_room(path, [word], [ways], duration)[0]
            units = [unit for unit in mend(path, row, duration) if unit.end] if row else []
            parts.append(span_intervals(span, units, lambda *_: 0.0))
    return parts_to_track(path, parts, duration)


def _plain_fields(path: Path, value: Any, place: str) -> Fields:
    return {_plain(key): inside for key, inside in fields_of(path, value, place).items()}


def _phonemes(path: Path, fields: Fields, place: str) -> list[Timed]:
    rows = list_of(path, fields.get("phonemes") or [], f"{place}: 'Phonemes'")
    plain = [
        _plain_fields(path, row, f"{place}, phoneme {number}") for number, row in enumerate(rows, 1)
    ]
    if any(first_key(row, ("offset", "offsetinticks")) is None for row in plain):
        return []
    return [
        _entry(path, row, "phoneme", f"{place}, phoneme {number}")
        for number, row in enumerate(plain, 1)
    ]


def _entry(path: Path, fields: Fields, key: str, place: str) -> Timed:
    offset = first_key(fields, ("offsetinticks", "offset")) or "Offset"
    length = first_key(fields, ("durationinticks", "duration")) or "Duration"
    start = _ticks(path, fields.get(offset), place, offset)
    lasting = _ticks(path, fields.get(length), place, length)
    return Timed(text_of(path, fields, key, place), start, start + lasting, place)
