"""Rhubarb Lip Sync: mouth cues as tab-separated values.

A line has the start in s and the shape, and the last one the end of the sound, as in
"Tab-separated values" of its README.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from lipwright.errors import LipwrightError
from lipwright.formats.source import parse_number, read_text, text_lines
from lipwright.streams.rhubarb import cues_to_track
from lipwright.streams.times import Timed
from lipwright.track import PhoneTrack


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; the language does not count.

    Raises:
        LipwrightError: a line is no cue, or its time is wrong.
    """
    cues: list[Timed] = []
    for number, line in enumerate(text_lines(read_text(path)), 1):
        if not line.strip():
            continue
        place, columns = f"line {number}", line.split()
        if len(columns) != 2:
            raise LipwrightError(
                f"{path}: {place}: {len(columns)} columns; write the time, a tab and the shape"
            )
        start = parse_number(path, place, "the time", columns[0])
        cues.append(Timed(columns[1], start, None, place))
    if len(cues) > 1:
        cues = [replace(one, end=other.start) for one, other in pairwise(cues)]
    return cues_to_track(path, cues, duration)
