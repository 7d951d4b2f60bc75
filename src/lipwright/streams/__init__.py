"""Phone times from other programs' files: speech services, recognisers, aligners.

Formats that are phone tracks themselves are in `lipwright.formats`; what is here tells visemes,
words or letters, of which phones are made.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, Protocol

from lipwright.formats import read_track
from lipwright.track import PhoneTrack


class _Read(Protocol):
    def __call__(self, path: Path, language: str, duration: float | None = None) -> PhoneTrack: ...


@dataclass(frozen=True)
class Stream:
    """One layout of timings."""

    about: str
    """one line for people"""
    read: _Read
    """language is the code of the words, from which phones are made where there are only words"""


STREAMS: Final = MappingProxyType[str, Stream]({})
"""suffix to layout"""


def known_streams() -> dict[str, str]:
    """Suffix of each layout, and what it is."""
    return {suffix: entry.about for suffix, entry in STREAMS.items()}


def read_timings(
    path: str | os.PathLike[str],
    format: str | None = None,  # noqa: A002  # as the command line calls it
    *,
    language: str = "en",
    duration: float | None = None,
) -> PhoneTrack:
    """The phone track of a file, or of another program's timings.

    Args:
        path: the file.
        format: a suffix of `STREAMS` or of the phone track formats, where the file's does not say.
        language: ISO code of the words.
        duration: of the sound in s; see `formats.read_track`.

    Raises:
        LipwrightError: the format is unknown or the file cannot be used; names file, place, time
            and remedy.
    """
    del language
    return read_track(path, format, duration=duration)
