"""Rhubarb Lip Sync: mouth cues as XML.

`rhubarbResult`, `mouthCues`, `mouthCue` with the attributes `start` and `end`, as in "XML format"
of its README. A document type, which such a file does not have, is refused: it may name entities
that grow or other files.
"""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat  # entities never come to it, see `_refuse`

from lipwright.errors import LipwrightError
from lipwright.formats.source import read_text
from lipwright.streams.rhubarb import cues_to_track
from lipwright.streams.source import MAX_CHARS, seconds_of
from lipwright.streams.times import Timed
from lipwright.track import PhoneTrack


class _Cues:
    """The cues of a document, gathered as its elements go by."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.found: list[Timed] = []
        self.parser = expat.ParserCreate("utf-8")
        self.parser.buffer_text = True
        self.parser.StartDoctypeDeclHandler = self._refuse
        self.parser.StartElementHandler = self._open
        self.parser.EndElementHandler = self._close
        self.parser.CharacterDataHandler = self._text
        self._cue: tuple[dict[str, str], str] | None = None
        self._shape = ""
        self.root = ""

    def _refuse(self, *_: object) -> None:
        raise LipwrightError(
            f"{self.path}: line {self.parser.CurrentLineNumber}: has a document type; delete it"
        )

    def _open(self, name: str, attributes: dict[str, str]) -> None:
        self.root = self.root or name
        if name == "mouthCue":
            self._cue = attributes, f"line {self.parser.CurrentLineNumber}"
            self._shape = ""

    def _text(self, text: str) -> None:
        self._shape += text if self._cue else ""

    def _close(self, name: str) -> None:
        if name == "mouthCue" and self._cue:
            attributes, place = self._cue
            start = seconds_of(self.path, attributes.get("start"), place, "start")
            end = seconds_of(self.path, attributes.get("end"), place, "end")
            self.found.append(Timed(self._shape.strip(), start, end, place))
            self._cue = None


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; the language does not count.

    Raises:
        LipwrightError: it is no such XML, or a cue is wrong; names the line.
    """
    text = read_text(path)
    if len(text) > MAX_CHARS:
        raise LipwrightError(f"{path}: larger than {MAX_CHARS // 2**20} MB; name another file")
    cues = _Cues(path)
    try:
        cues.parser.Parse(text.encode("utf-8"), True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise LipwrightError(
            f"{path}: line {error.lineno}: not XML: {reason}; save it again from Rhubarb"
        ) from None
    if cues.root != "rhubarbResult" or not cues.found:
        raise LipwrightError(
            f"{path}: has no rhubarbResult with mouthCue elements; save it again from Rhubarb"
        )
    return cues_to_track(path, cues.found, duration)
