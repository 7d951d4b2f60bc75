"""MBROLA `.pho`, as espeak-ng writes it too: `symbol duration_ms [position pitch ...]`.

Symbols are X-SAMPA or a voice's own SAMPA, `_` is silence, lines from `;` on are comments and
`#` lines are flush marks. Time starts at 0. Pitch is not read.
"""

from __future__ import annotations

from pathlib import Path

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import (
    Interval,
    Joint,
    PathLike,
    intervals_to_track,
    unknown_labels,
)
from lipwright.formats.source import parse_number, read_text, text_lines
from lipwright.phones import PHONES, SILENCE, Alphabet, is_silence_label
from lipwright.track import PhoneTrack

JOINT = Joint(tolerance=0.0, gaps="error")  # durations alone leave no gap
DECIMALS = 3  # of ms: microseconds


def read(path: Path, duration: float | None = None) -> PhoneTrack:
    """The track of a phone file.

    Raises:
        LipwrightError: a line lacks its duration, or phones are unknown or run past `duration` s.
    """
    intervals: list[Interval] = []
    at = 0.0
    for number, line in enumerate(text_lines(read_text(path)), 1):
        columns = line.split()
        if not columns or columns[0] == "#" or columns[0].startswith(";"):
            continue
        place = f"line {number}"
        if len(columns) < 2:
            raise LipwrightError(
                f"{path}: {place}: {columns[0][:24]!r} has no duration; write 'symbol milliseconds'"
            )
        length = _parse_length(path, place, columns)
        if length > 0:
            intervals.append(Interval(at, at + length, columns[0], place))
            at += length
    unknown = unknown_labels((interval.label for interval in intervals), "xsampa")
    alphabet: Alphabet | None = None if unknown else "xsampa"
    return intervals_to_track(path, intervals, JOINT, alphabet=alphabet, duration=duration)


def _parse_length(path: PathLike, place: str, columns: list[str]) -> float:
    """The duration in s; silence may last nothing, as espeak-ng writes it."""
    length = parse_number(path, place, "the duration", columns[1]) / 1000
    if length < 0 or (length == 0 and not is_silence_label(columns[0])):
        raise LipwrightError(
            f"{path}: {place}: {columns[0][:24]!r} lasts {columns[1]} ms; give it a time above 0"
        )
    return length


def to_text(path: Path, track: PhoneTrack) -> str:
    """X-SAMPA symbols and durations; words, stress and pitch are not kept.

    A track that starts after 0 s gets silence before it.

    Raises:
        LipwrightError: a phone is shorter than a microsecond.
    """
    track = track.padded(0.0, track.end)
    edges = (track.edges * 1000).round(DECIMALS)
    lines = []
    for index, phone in enumerate(track.phones):
        length = edges[index + 1] - edges[index]
        if length <= 0:
            raise LipwrightError(f"{path}: phone {index + 1} is too short for MBROLA; lengthen it")
        symbol = "_" if phone == SILENCE else PHONES[phone].xsampa
        digits = f"{length:.{DECIMALS}f}".rstrip("0").rstrip(".")
        lines.append(f"{symbol} {digits}\n")
    return "".join(lines)
