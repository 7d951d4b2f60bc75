"""Phone times from other programs' files: speech services, recognisers, aligners.

Formats that are phone tracks themselves are in `lipwright.formats`; what is here tells visemes,
words or letters, of which phones are made, or phones in a layout of its own.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, cast

from lipwright.errors import LipwrightError
from lipwright.formats import TRACK_FORMATS
from lipwright.formats.jsontrack import FORMAT
from lipwright.formats.suffixes import by_suffix
from lipwright.track import PhoneTrack

__all__ = ["STREAMS", "Stream", "known_streams", "read_timings"]

DEFAULT: Final = "en"


@dataclass(frozen=True)
class Stream:
    """One layout of timings."""

    about: str
    """one line for people"""
    module: str
    """with `read(path, language, duration)`; JSON too with `fits(content)` and
    `to_track(path, content, language, duration)`"""

    def read(self, path: Path, language: str, duration: float | None = None) -> PhoneTrack:
        """The track of a file; `language` is the code of its words, of which phones are made.

        Raises:
            LipwrightError: the file cannot be used; names the entry and the remedy.
        """
        return cast(PhoneTrack, import_module(self.module).read(path, language, duration))


STREAMS: Final = MappingProxyType({
    ".azure.json": Stream(
        "Azure Speech: viseme and word events, pronunciation assessment, recognition",
        "lipwright.streams.azure",
    ),
    ".polly.json": Stream("Amazon Polly speech marks", "lipwright.streams.polly"),
    ".marks": Stream("Amazon Polly speech marks", "lipwright.streams.polly"),
    ".google.json": Stream(
        "Google Cloud: marks of Text-to-Speech, words of Speech-to-Text",
        "lipwright.streams.google",
    ),
    ".elevenlabs.json": Stream("ElevenLabs speech with timestamps", "lipwright.streams.elevenlabs"),
    ".kokoro.json": Stream("Kokoro tokens or captioned speech", "lipwright.streams.kokoro"),
    ".mfa.json": Stream("Montreal Forced Aligner, JSON", "lipwright.streams.mfa"),
    ".mfa.csv": Stream("Montreal Forced Aligner, CSV", "lipwright.streams.mfa_csv"),
    ".whisperx.json": Stream(
        "WhisperX, openai-whisper and faster-whisper with word times", "lipwright.streams.whisper"
    ),
    ".rhubarb.json": Stream("Rhubarb Lip Sync cues, JSON", "lipwright.streams.rhubarb"),
    ".rhubarb.tsv": Stream("Rhubarb Lip Sync cues, TSV", "lipwright.streams.rhubarb_tsv"),
    ".rhubarb.xml": Stream("Rhubarb Lip Sync cues, XML", "lipwright.streams.rhubarb_xml"),
})  # fmt: skip
"""suffix to layout"""


def known_streams() -> dict[str, str]:
    """Suffix of each layout, and what it is."""
    return {suffix: entry.about for suffix, entry in STREAMS.items()}


def read_timings(
    path: str | os.PathLike[str],
    format: str | None = None,  # noqa: A002  # as the command line calls it
    *,
    language: str = DEFAULT,
    duration: float | None = None,
) -> PhoneTrack:
    """The phone track of a file, or of another program's timings.

    A `.json` of no known second suffix is known by its keys. A TextGrid in IPA is read as the
    Montreal Forced Aligner writes it where it is of another language than English, or has labels
    that `formats` does not know.

    Args:
        path: the file.
        format: a suffix of `STREAMS` or of the phone track formats, where the file's does not say.
        language: ISO code of the words.
        duration: of the sound in s; see `formats.read_track`.

    Raises:
        LipwrightError: the format is unknown or the file cannot be used; names file, place, time
            and remedy.
    """
    remedy = "give the file the suffix of what it is, one of {}"
    readers: dict[str, Callable[[Path], PhoneTrack]] = {}
    for suffix, entry in TRACK_FORMATS.items():
        readers[suffix] = lambda at, entry=entry: entry.read(at, duration)  # type: ignore[misc]
    for suffix, stream in STREAMS.items():
        readers[suffix] = lambda at, stream=stream: stream.read(at, language, duration)  # type: ignore[misc]
    readers[".json"] = lambda at: _read_json(at, language, duration)
    for suffix in (".textgrid", ".short.textgrid"):
        readers[suffix] = lambda at: _read_textgrid(at, language, duration)
    return by_suffix(readers, path, format, "phone track", remedy)(Path(path))


def _read_textgrid(path: Path, language: str, duration: float | None) -> PhoneTrack:
    from lipwright.streams import mfa

    return mfa.read_textgrid(path, language, duration)


def _read_json(path: Path, language: str, duration: float | None) -> PhoneTrack:
    """JSON whose suffix does not say what it is: our own, or what its keys fit."""
    from lipwright.streams.source import read_content

    content = read_content(path)
    if isinstance(content, dict) and "format" in content:
        return TRACK_FORMATS[".json"].read(path, duration)
    for suffix, stream in STREAMS.items():
        if suffix.endswith(".json"):
            layout: Any = import_module(stream.module)
            if layout.fits(content):
                return cast(PhoneTrack, layout.to_track(path, content, language, duration))
    known = ", ".join(suffix for suffix in STREAMS if suffix.endswith(".json"))
    raise LipwrightError(
        f'{path}: is neither a phone track (it has no "format": "{FORMAT}") nor a layout that '
        f"its keys tell; if it is one of {known}, give it that suffix to see what is missing"
    )
