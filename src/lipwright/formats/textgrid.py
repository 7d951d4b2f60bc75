"""Praat TextGrid: long and short text form, tiers `phones` and `words`.

Own reader: praatio (MIT) names no interval in its errors and takes the number NaN or a missing
line for a malformed file as a whole; textgrid (MIT) stops quietly at such a line; others are GPL.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval, Joint, intervals_to_track
from lipwright.formats.source import decode_text, parse_number, read_bytes
from lipwright.track import PhoneTrack

JOINT = Joint(tolerance=0.001, gaps="error")  # Praat's neighbours share a time; others round it
PHONE_TIERS = ("phones", "phone", "phonemes", "phoneme", "segments")
WORD_TIERS = ("words", "word")

# As Praat reads: free-standing numbers, "strings" and <flags> count, all else is decoration.
_TOKEN = re.compile(
    r"""(?P<string>"[^"]*+(?:""[^"]*+)*+")|(?P<comment>![^\n\r]*)|(?P<word>[^\s"]+)|(?P<open>")"""
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_FLAG = re.compile(r"<\w*>")


@dataclass(frozen=True)
class _Tier:
    name: str
    intervals: list[Interval] = field(default_factory=list)


class _Tokens:
    """The numbers, strings and flags of a TextGrid, one after the other."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._text = text
        self._matches = _TOKEN.finditer(text)
        self._at = 0

    def error(self, place: str, wanted: str, found: str) -> LipwrightError:
        line = self._text.count("\n", 0, self._at) + 1
        return LipwrightError(
            f"{self._path}: line {line}: {place}: {wanted} is missing, found {found}; save the "
            "file again from Praat as a text file"
        )

    def _next(self, place: str, wanted: str) -> tuple[str, str]:
        """Kind and text of the next token that counts."""
        for match in self._matches:
            self._at = match.start()
            token = match.group()
            if match.lastgroup == "string":
                return "string", token[1:-1].replace('""', '"')
            if match.lastgroup == "open":
                raise self.error(place, "the quote that ends the text", "none")
            if match.lastgroup == "word":
                if _NUMBER.fullmatch(token):
                    return "number", token
                if _FLAG.fullmatch(token):
                    return "flag", token
        self._at = len(self._text)
        raise self.error(place, wanted, "the end of the file")

    def _take(self, kind: str, place: str, wanted: str) -> str:
        found, token = self._next(place, wanted)
        if found != kind:
            raise self.error(place, wanted, repr(token[:24]))
        return token

    def string(self, place: str, wanted: str) -> str:
        return self._take("string", place, wanted)

    def flag(self, place: str, wanted: str) -> str:
        return self._take("flag", place, wanted)

    def number(self, place: str, wanted: str) -> float:
        return parse_number(self._path, place, wanted, self._take("number", place, wanted))

    def count(self, place: str, wanted: str) -> int:
        number = self.number(place, wanted)
        if number < 0 or number != int(number):
            raise self.error(place, wanted, f"{number:g}")
        return int(number)


def read(path: Path, duration: float | None = None) -> PhoneTrack:
    """The track of a TextGrid's phone tier, with words where it has a word tier.

    Raises:
        LipwrightError: the file is no TextGrid in text form, has no phone tier, or its phones
            leave gaps, overlap, are unknown or run past `duration` s.
    """
    phones, words = read_intervals(path)
    return intervals_to_track(path, phones, JOINT, words=words, duration=duration)


def read_intervals(path: Path) -> tuple[list[Interval], list[Interval]]:
    """The phones and the words of a TextGrid, as labelled; without a word tier, no words.

    Raises:
        LipwrightError: the file is no TextGrid in text form or has no phone tier.
    """
    content = read_bytes(path)
    if content.startswith(b"ooBinaryFile"):
        raise LipwrightError(
            f"{path}: a binary TextGrid; open it in Praat and save it as a text file"
        )
    tiers = list(_read_tiers(_Tokens(path, decode_text(path, content))))
    phones = _find_phones(path, tiers)
    speaker = _split_name(phones.name)[0]
    words = [
        tier for tier in tiers
        if _split_name(tier.name)[0] == speaker and _split_name(tier.name)[1] in WORD_TIERS
    ]  # fmt: skip
    if not phones.intervals:
        raise LipwrightError(f"{path}: tier {phones.name!r} is empty; align the sound again")
    return phones.intervals, words[0].intervals if words else []


def _read_tiers(tokens: _Tokens) -> Iterator[_Tier]:
    """The interval tiers; point tiers are passed over."""
    kind = tokens.string("header", 'the file type "ooTextFile"')
    if not kind.startswith("ooTextFile"):
        raise tokens.error("header", 'the file type "ooTextFile"', repr(kind[:40]))
    kind = tokens.string("header", 'the object class "TextGrid"')
    if not kind.startswith("TextGrid"):
        raise tokens.error("header", 'the object class "TextGrid"', repr(kind[:40]))
    tokens.number("header", "the start time")
    tokens.number("header", "the end time")
    if tokens.flag("header", "the flag <exists>") != "<exists>":
        return
    for index in range(1, tokens.count("header", "the number of tiers") + 1):
        place = f"tier {index}"
        kind = tokens.string(place, "the tier's class")
        tier = _Tier(tokens.string(place, "the tier's name").strip())
        place = f"tier {tier.name[:40]!r}"
        tokens.number(place, "the tier's start time")
        tokens.number(place, "the tier's end time")
        size = tokens.count(place, "the number of intervals")
        if kind == "TextTier":
            for point in range(1, size + 1):
                tokens.number(f"{place}, point {point}", "the time")
                tokens.string(f"{place}, point {point}", "the text")
        elif kind == "IntervalTier":
            for number in range(1, size + 1):
                tier.intervals.append(_read_interval(tokens, f"{place}, interval {number}"))
            yield tier
        else:
            raise tokens.error(place, 'the class "IntervalTier" or "TextTier"', repr(kind[:40]))


def _read_interval(tokens: _Tokens, place: str) -> Interval:
    start = tokens.number(place, "the start time")
    end = tokens.number(place, "the end time")
    return Interval(start, end, tokens.string(place, "the text").strip(), place)


def _split_name(name: str) -> tuple[str, str]:
    """Speaker and kind of a tier; the Montreal Forced Aligner writes `speaker - phones`."""
    speaker, _, kind = name.rpartition(" - ")
    return speaker.strip(), kind.strip().casefold()


def _find_phones(path: Path, tiers: list[_Tier]) -> _Tier:
    for kind in PHONE_TIERS:
        found = [tier for tier in tiers if _split_name(tier.name)[1] == kind]
        if len(found) == 1:
            return found[0]
        if found:
            names = ", ".join(repr(tier.name[:40]) for tier in found[:8])
            raise LipwrightError(f"{path}: has several phone tiers ({names}); keep one of them")
    names = ", ".join(repr(tier.name[:40]) for tier in tiers[:8]) or "none"
    raise LipwrightError(
        f"{path}: has no interval tier {PHONE_TIERS[0]!r} (its interval tiers: {names}); rename "
        f"the one that holds the phones to {PHONE_TIERS[0]!r}"
    )


def to_text(path: Path, track: PhoneTrack) -> str:
    """The long form: tier `words` where the track has words, and tier `phones`.

    A vowel of known stress ends in its digit, as in `AA1`.
    """
    lines = []
    for indent, key, value in _fields(track):
        lines.append(" " * indent + (f"{key} {value}" if value else key))
    return "\n".join(lines) + "\n"


def to_short_text(path: Path, track: PhoneTrack) -> str:
    """The short form: the values of the long form, one a line."""
    fields = list(_fields(track))
    # Both forms start with the same lines; Praat knows the form by what follows.
    lines = [f"{key} {value}" for _, key, value in fields[:2]]
    lines += ["", *(value for _, _, value in fields[2:] if value)]
    return "\n".join(lines) + "\n"


def _fields(track: PhoneTrack) -> Iterator[tuple[int, str, str]]:
    """Indent, key and value of each line of the long form."""
    tiers = {"words": _word_rows(track), "phones": _phone_rows(track)}
    if not track.words:
        del tiers["words"]
    start, end = _number(track.start), _number(track.end)
    yield 0, "File type =", '"ooTextFile"'
    yield 0, "Object class =", '"TextGrid"'
    yield 0, "", ""
    yield 0, "xmin =", start
    yield 0, "xmax =", end
    yield 0, "tiers?", "<exists>"
    yield 0, "size =", str(len(tiers))
    yield 0, "item []:", ""
    for index, (name, rows) in enumerate(tiers.items(), 1):
        yield 4, f"item [{index}]:", ""
        yield 8, "class =", '"IntervalTier"'
        yield 8, "name =", f'"{name}"'
        yield 8, "xmin =", start
        yield 8, "xmax =", end
        yield 8, "intervals: size =", str(len(rows))
        for number, (row_start, row_end, label) in enumerate(rows, 1):
            yield 8, f"intervals [{number}]:", ""
            yield 12, "xmin =", _number(row_start)
            yield 12, "xmax =", _number(row_end)
            yield 12, "text =", '"' + label.replace('"', '""') + '"'


def _phone_rows(track: PhoneTrack) -> list[tuple[float, float, str]]:
    marks = ("" if mark is None else str(mark) for mark in track.stress)
    return [
        (start, end, phone + mark) for (phone, start, end), mark in zip(track, marks, strict=True)
    ]


def _word_rows(track: PhoneTrack) -> list[tuple[float, float, str]]:
    """The words and the empty intervals between them, from the track's start to its end."""
    rows: list[tuple[float, float, str]] = []
    at = track.start
    for word in track.words:
        start, end = track.word_span(word)
        if start > at:
            rows.append((at, start, ""))
        rows.append((start, end, word.text))
        at = end
    if track.end > at:
        rows.append((at, track.end, ""))
    return rows


def _number(seconds: float) -> str:
    """The shortest digits that read back as the same number."""
    return repr(float(seconds))
