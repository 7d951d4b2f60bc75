"""The answer of a voice server as sound and phone track; docs/voices.md has its schema."""

from __future__ import annotations

import base64
import binascii
import io
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final

import numpy as np

from lipwright.audio import Audio
from lipwright.controls import is_text
from lipwright.decode import decode
from lipwright.errors import LipwrightError
from lipwright.formats.intervals import PAST_END, Interval, Joint, intervals_to_track
from lipwright.language import get_language
from lipwright.language.pace import DURATIONS, kind_of
from lipwright.phones import PHONES, SILENCE, is_silence_label, parse_phone
from lipwright.track import PhoneTrack

VERSION: Final = 1
MOST_SECONDS: Final = 7200.0
ALPHABETS: Final = ("arpabet", "ipa", "xsampa")
_MEETING: Final = Joint(tolerance=0.02, gaps="silence")  # s; servers round to 10 ms
_SCHEMA: Final = "docs/voices.md has what a voice server answers"
_MOST_LABEL: Final = 60  # characters


def read_sound(answer: Any, source: str) -> Audio:
    """The sound of an answer.

    Raises:
        LipwrightError: it is of another version, or has no sound that can be decoded.
    """
    if not isinstance(answer, dict):
        raise _wrong(source, "the answer", "an object", answer)
    version = answer.get("version")
    if version != VERSION or isinstance(version, bool):
        raise LipwrightError(
            f"{source}: the answer's 'version' is {_short(version)}, not {VERSION}; {_SCHEMA}"
        )
    encoded = answer.get("audio")
    if not isinstance(encoded, str):
        raise _wrong(source, "'audio'", "a string of base64", encoded)
    try:
        content = base64.b64decode("".join(encoded.split()), validate=True)
    except (binascii.Error, ValueError):
        raise LipwrightError(f"{source}: 'audio' is not base64; {_SCHEMA}") from None
    if not content:
        raise LipwrightError(f"{source}: 'audio' is empty; {_SCHEMA}")
    blocks, rate, seconds = [], 0, 0.0
    for found, block in decode(io.BytesIO(content), f"{source}: 'audio'"):
        rate = found
        seconds += block.shape[1] / rate
        if seconds > MOST_SECONDS:  # a few bytes of FLAC are hours of silence
            raise LipwrightError(f"{source}: 'audio' lasts more than {MOST_SECONDS:g} s")
        blocks.append(block.mean(axis=0))
    if not rate:
        raise LipwrightError(f"{source}: 'audio' has no sound samples; {_SCHEMA}")
    return Audio(np.concatenate(blocks), rate)


def read_times(
    answer: dict[str, Any], duration: float, language: str, source: str
) -> PhoneTrack | None:
    """The phone track of an answer, or None if it has no times.

    Phones are taken as they are; where there are only words, their phones are placed in them.

    Args:
        answer: it has been checked to be an object.
        duration: of the sound in s.
        language: ISO code of the words.
        source: names the server in errors.

    Raises:
        LipwrightError: times that do not rise or lie outside the sound, unknown phones, or wrong
            types; names the entry.
    """
    words = _intervals(answer, "words", "text", duration, source)
    phones = _intervals(answer, "phones", "phone", duration, source)
    if phones:
        alphabets = [row.get("alphabet", answer.get("alphabet")) for row in answer["phones"]]
        found = list(_known_phones(phones, alphabets, language, source))
    elif words:
        found = list(_placed_phones(words, language, source))
    else:
        return None
    if not any(interval.label != SILENCE for interval in found):
        raise LipwrightError(f"{source}: no phone of the answer is said; {_SCHEMA}")
    spoken = [word for word in words if not is_silence_label(word.label)]
    return intervals_to_track(
        source, found, _MEETING, words=spoken, alphabet="arpabet", duration=duration
    )


def _intervals(
    answer: dict[str, Any], key: str, label: str, duration: float, source: str
) -> list[Interval]:
    """The rows of a list of times."""
    rows = answer.get(key)
    if rows is None:
        return []
    if not isinstance(rows, list):
        raise _wrong(source, f"'{key}'", "a list", rows)
    found = []
    for number, row in enumerate(rows):
        place = f"{key}[{number}]"
        if not isinstance(row, dict):
            raise _wrong(source, place, "an object", row)
        text = row.get(label)
        if not isinstance(text, str) or not is_text(text) or len(text) > _MOST_LABEL:
            raise _wrong(source, f"{place}.{label}", "a short string", text)
        start, end = (_seconds(row.get(name), f"{place}.{name}", source)
                      for name in ("start", "end"))  # fmt: skip
        if not 0 <= start < end <= duration + PAST_END:
            raise LipwrightError(
                f"{source}: {place} lasts from {start:g} to {end:g} s; times rise, from 0 to the "
                f"end of the sound ({duration:.3f} s)"
            )
        found.append(Interval(start, end, text.strip(), place))
    for before, after in pairwise(found):
        if after.start < before.end - _MEETING.tolerance or after.start <= before.start:
            raise LipwrightError(
                f"{source}: {after.place} starts at {after.start:g} s, before {before.place} "
                f"ends at {before.end:g} s; times rise"
            )
    return found


def _seconds(value: Any, place: str, source: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _wrong(source, place, "a number of seconds", value)
    try:
        return float(value)
    except OverflowError:
        raise _wrong(source, place, "a number of seconds", "a huge number") from None


def _known_phones(
    phones: Sequence[Interval], alphabets: Sequence[object], language: str, source: str
) -> Iterator[Interval]:
    """Labels of any alphabet as those of the phone table, with a stress digit."""
    for interval, alphabet in zip(phones, alphabets, strict=True):
        if alphabet is not None and alphabet not in ALPHABETS:
            raise LipwrightError(
                f"{source}: {interval.place}: unknown alphabet {_short(alphabet)}; use one of: "
                f"{', '.join(ALPHABETS)}"
            )
        try:
            labels = _labels(interval.label, alphabet or "arpabet", language)
        except LipwrightError as error:
            raise LipwrightError(f"{source}: {interval.place}: {error}") from None
        step = (interval.end - interval.start) / len(labels)
        for number, label in enumerate(labels):
            start = interval.start + number * step
            yield replace(interval, label=label, start=start, end=start + step)


def _labels(label: str, alphabet: object, language: str) -> list[str]:
    if alphabet == "ipa" and not is_silence_label(label):
        if language.partition("-")[0] == "en":
            try:
                phone, stress = parse_phone(label, "ipa")
            except LipwrightError:
                pass  # a sound of another language in a name
            else:
                return [_with_stress(phone, stress)]
        from lipwright.language.ipa import read_ipa

        return [_with_stress(sound.phone, sound.stress) for sound in read_ipa(label)]
    phone, stress = parse_phone(label, "xsampa" if alphabet == "xsampa" else "arpabet")
    return [_with_stress(phone, stress)]


def _with_stress(phone: str, stress: int | None) -> str:
    return phone if stress is None or not PHONES[phone].is_vowel else f"{phone}{stress}"


def _placed_phones(words: Sequence[Interval], language: str, source: str) -> Iterator[Interval]:
    """The phones of each word within its times, each as long as its kind lasts elsewhere."""
    front_end = get_language(language)
    for word in words:
        if is_silence_label(word.label) or not any(char.isalnum() for char in word.label):
            continue
        try:
            spoken = front_end.normalize(word.label, f"{source}: {word.place}")
        except LipwrightError as error:
            raise LipwrightError(f"{error}") from None
        ways = front_end.pronounce_all(spoken)
        phones = [phone for way in ways for phone in way[0].phones]
        lengths = np.array([DURATIONS[kind_of(PHONES[phone])] for phone in phones])
        shares = np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()
        edges = word.start + shares * (word.end - word.start)
        for phone, start, end in zip(phones, edges[:-1], edges[1:], strict=True):
            yield replace(word, label=phone, start=float(start), end=float(end))


def _wrong(source: str, place: str, wanted: str, found: object) -> LipwrightError:
    return LipwrightError(f"{source}: {place} is {_short(found)}, not {wanted}; {_SCHEMA}")


def _short(value: object) -> str:
    if value is None:
        return "missing"
    if isinstance(value, dict | list):
        return "a list" if isinstance(value, list) else "an object"
    text = ascii(value)
    return text if len(text) <= 40 else text[:40] + "..."
