"""Phone CTM, as Kaldi and NIST write it: `file channel start duration phone [confidence]`.

Kaldi leaves silence out, so a gap between two phones is silence. The word-position ends of
Kaldi's phones (`_B`, `_I`, `_E`, `_S`) are dropped.
"""

from __future__ import annotations

import re
from pathlib import Path

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval, Joint, PathLike, intervals_to_track
from lipwright.formats.source import parse_number, read_text, text_lines
from lipwright.track import PhoneTrack

JOINT = Joint(tolerance=0.005, gaps="silence")  # s; half of Kaldi's frame, which rounds its times
DECIMALS = 6  # of s: microseconds

_POSITION = re.compile(r"(?<=.)_[BIES]$")


def read(path: Path, duration: float | None = None) -> PhoneTrack:
    """The track of the one utterance of a phone CTM.

    Raises:
        LipwrightError: a line lacks columns or a number, the file has several utterances, or
            phones overlap by more than 5 ms, are unknown or run past `duration` s.
    """
    intervals: list[Interval] = []
    utterance: tuple[str, str] | None = None
    for number, line in enumerate(text_lines(read_text(path)), 1):
        columns = line.split()
        if not columns or columns[0].startswith(";;"):
            continue
        place = f"line {number}"
        intervals.append(_parse_line(path, place, columns))
        utterance = utterance or (columns[0], columns[1])
        if utterance != (columns[0], columns[1]):
            raise LipwrightError(
                f"{path}: {place}: a second utterance, {' '.join(columns[:2])[:40]!r} after "
                f"{' '.join(utterance)[:40]!r}; keep one utterance and channel in a file"
            )
    return intervals_to_track(path, intervals, JOINT, duration=duration)


def _parse_line(path: PathLike, place: str, columns: list[str]) -> Interval:
    if not 5 <= len(columns) <= 6:
        raise LipwrightError(
            f"{path}: {place}: {len(columns)} columns; write 'file channel start duration phone', "
            "with or without a confidence"
        )
    start = parse_number(path, place, "the start", columns[2])
    length = parse_number(path, place, "the duration", columns[3])
    return Interval(start, start + length, _POSITION.sub("", columns[4]), place)


def to_text(path: Path, track: PhoneTrack) -> str:
    """One line a phone, silence too, with stress digits; words are not kept.

    Raises:
        LipwrightError: a phone is shorter than a microsecond.
    """
    name = "_".join(path.name.removesuffix(path.suffix).split()) or "utterance"
    edges = track.edges.round(DECIMALS)
    lines = []
    for index, (phone, mark) in enumerate(zip(track.phones, track.stress, strict=True)):
        start, length = edges[index], edges[index + 1] - edges[index]
        if length <= 0:
            raise LipwrightError(f"{path}: phone {index + 1} is too short for CTM; lengthen it")
        label = phone if mark is None else f"{phone}{mark}"
        lines.append(f"{name} 1 {start:.{DECIMALS}f} {length:.{DECIMALS}f} {label}\n")
    return "".join(lines)
