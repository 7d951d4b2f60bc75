"""HTK label file: `start end phone [score] [word]`, times in units of 100 ns.

Where a time has a decimal point, all times of the file are seconds. A word stands on the line
of its first phone and lasts to the next line with a word; silence at its end is not its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval, Joint, PathLike, intervals_to_track
from lipwright.formats.source import parse_number, read_text, text_lines
from lipwright.phones import is_silence_label
from lipwright.track import PhoneTrack

UNITS = 10_000_000  # 100 ns in a second (The HTK Book, section 6.2)
JOINT = Joint(tolerance=0.001, gaps="error")  # as TextGrid: labels share their times
NO_WORD = "-"  # ends the word before where no silence does

_MASTER = "#!MLF!#"


@dataclass(frozen=True)
class _Line:
    start: str
    end: str
    phone: str
    word: str | None
    place: str


def read(path: Path, duration: float | None = None) -> PhoneTrack:
    """The track of a label file.

    Raises:
        LipwrightError: a line lacks columns or a number, or phones leave gaps, overlap, are
            unknown or run past `duration` s.
    """
    lines = [
        _parse_line(path, f"line {number}", line.split())
        for number, line in enumerate(text_lines(read_text(path)), 1)
        if line.strip()
    ]
    decimal = any("." in time for line in lines for time in (line.start, line.end))
    scale = 1 if decimal else UNITS
    intervals = [
        Interval(
            parse_number(path, line.place, "the start", line.start) / scale,
            parse_number(path, line.place, "the end", line.end) / scale,
            line.phone,
            line.place,
        )
        for line in lines
    ]
    words = _word_intervals(lines, intervals)
    return intervals_to_track(path, intervals, JOINT, words=words, duration=duration)


def _parse_line(path: PathLike, place: str, columns: list[str]) -> _Line:
    if columns[0] == _MASTER:
        raise LipwrightError(
            f"{path}: {place}: a master label file; write one label file for each recording"
        )
    if len(columns) < 3:
        raise LipwrightError(
            f"{path}: {place}: {len(columns)} columns; write 'start end phone', then a score and "
            "the word if there are any"
        )
    rest = columns[3:]
    if rest and _is_number(rest[0]):
        rest = rest[1:]
    return _Line(columns[0], columns[1], columns[2], rest[0] if rest else None, place)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _word_intervals(lines: list[_Line], intervals: list[Interval]) -> list[Interval]:
    """The words in time, without the silence at their ends."""
    starts = [index for index, line in enumerate(lines) if line.word is not None]
    words = []
    for first, stop in pairwise([*starts, len(lines)]):
        label = lines[first].word or ""
        last = stop - 1
        while last > first and is_silence_label(lines[last].phone):
            last -= 1
        if not is_silence_label(label):
            span = intervals[first].start, intervals[last].end
            words.append(Interval(*span, label, lines[first].place))
    return words


def to_text(path: Path, track: PhoneTrack) -> str:
    """One line a phone, with stress digits, a score of 0 and the word where one starts.

    Raises:
        LipwrightError: a phone is shorter than 100 ns.
    """
    units = [round(float(edge) * UNITS) for edge in track.edges]
    firsts = {word.first: word.text for word in track.words}
    ends = {word.stop for word in track.words}
    lines = []
    for index, (phone, mark) in enumerate(zip(track.phones, track.stress, strict=True)):
        if units[index + 1] <= units[index]:
            raise LipwrightError(f"{path}: phone {index + 1} is too short for HTK; lengthen it")
        label = phone if mark is None else f"{phone}{mark}"
        word = firsts.get(index, NO_WORD if index in ends else None)
        tail = "" if word is None else f" 0 {word}"
        lines.append(f"{units[index]} {units[index + 1]} {label}{tail}\n")
    return "".join(lines)
