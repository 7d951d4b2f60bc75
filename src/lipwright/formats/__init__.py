"""Phone tracks to and from files; one module a format."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final, Protocol

from lipwright.files import write_whole
from lipwright.formats import ctm, htk, jsontrack, mbrola, textgrid
from lipwright.formats.suffixes import by_suffix
from lipwright.track import PhoneTrack

__all__ = ["TRACK_FORMATS", "TrackFormat", "known_formats", "read_track", "write_track"]


class _Read(Protocol):
    def __call__(self, path: Path, duration: float | None = None) -> PhoneTrack: ...


class _ToText(Protocol):
    def __call__(self, path: Path, track: PhoneTrack) -> str: ...


@dataclass(frozen=True)
class TrackFormat:
    """One way to keep a phone track in a file."""

    about: str
    """one line for people"""
    read: _Read
    to_text: _ToText
    """the target's path is for names and errors; nothing is written"""


TRACK_FORMATS: Final = MappingProxyType({
    ".textgrid": TrackFormat("Praat TextGrid, text form", textgrid.read, textgrid.to_text),
    ".short.textgrid": TrackFormat(
        "Praat TextGrid, short text form", textgrid.read, textgrid.to_short_text
    ),
    ".ctm": TrackFormat("phone CTM of Kaldi and NIST", ctm.read, ctm.to_text),
    ".lab": TrackFormat("HTK label file", htk.read, htk.to_text),
    ".json": TrackFormat("Lipwright phone track", jsontrack.read, jsontrack.to_text),
    ".pho": TrackFormat("MBROLA and espeak-ng phones", mbrola.read, mbrola.to_text),
})  # fmt: skip
"""suffix to format"""


def known_formats() -> dict[str, str]:
    """Suffix of each phone track format, and what it is."""
    return {suffix: entry.about for suffix, entry in TRACK_FORMATS.items()}


def read_track(
    path: str | os.PathLike[str],
    format: str | None = None,  # noqa: A002  # as the command line calls it
    *,
    duration: float | None = None,
) -> PhoneTrack:
    """The phone track of a file.

    Args:
        path: the file.
        format: a suffix of `known_formats`, where that of the file does not say it.
        duration: of the sound in s: phones that end more than 50 ms after it are an error, and
            silence fills what the file does not cover.

    Raises:
        LipwrightError: the format is unknown or the file cannot be used; names file, place, time
            and remedy.
    """
    remedy = "give the file the suffix of what it is, one of {}"
    entry = by_suffix(TRACK_FORMATS, path, format, "phone track", remedy)
    return entry.read(Path(path), duration)


def write_track(
    path: str | os.PathLike[str],
    track: PhoneTrack,
    format: str | None = None,  # noqa: A002  # as the command line calls it
) -> None:
    """Write a phone track, whole or not at all.

    Args:
        path: the file; an older one is replaced.
        track: the track.
        format: a suffix of `known_formats`, where that of the file does not say it.

    Raises:
        LipwrightError: the format is unknown, cannot hold the track, or the file cannot be written.
    """
    entry = by_suffix(TRACK_FORMATS, path, format, "phone track")
    content = entry.to_text(Path(path), track).encode("utf-8")
    with write_whole(path) as part:
        part.write_bytes(content)
