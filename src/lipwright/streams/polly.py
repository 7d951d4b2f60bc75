"""Amazon Polly: speech marks, one JSON object a line.

Fields as in "Speech mark output" of the Amazon Polly developer guide: `time` in ms, `type` of
sentence, word, viseme or ssml, `value`, and for words `start` and `end` in bytes of the text. The
phones of a viseme are those of its "Phoneme and viseme tables for supported languages" (Spanish
has B and J, Italian J as well); where Polly has one name for sounds that look alike, that which
stands for it is the most frequent.
"""

from __future__ import annotations

from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE
from lipwright.streams.source import fields_of, read_content, seconds_of, text_of
from lipwright.streams.times import Timed
from lipwright.streams.visemes import visemes_to_track
from lipwright.streams.words import words_to_track
from lipwright.track import PhoneTrack

MS: Final = 1e-3  # s

VISEMES: Final = MappingProxyType({
    "sil": (SILENCE,), "p": ("P", "B", "M"), "t": ("T", "D", "N", "L", "DX", "XR"),
    "S": ("SH", "ZH", "CH", "JH"), "T": ("TH", "DH"), "f": ("F", "V"),
    "k": ("K", "G", "NG", "HH", "Q"), "i": ("IY", "IH", "Y"), "r": ("R",), "s": ("S", "Z"),
    "u": ("UW", "UH", "W", "XIY"), "@": ("AX", "AXR"), "a": ("AE", "AA", "AY", "AW"),
    "e": ("EY",), "E": ("EH", "ER", "AH"), "o": ("OW",), "O": ("AO", "OY"), "l": ("L",),
    "B": ("B",), "J": ("Y", "L", "N"), "x": ("K",),
})  # fmt: skip
"""viseme to phones, that which stands for it first"""


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    rows = content if isinstance(content, list) else [content]
    return bool(rows) and all(
        isinstance(row, dict) and {"time", "type", "value"} <= row.keys() for row in rows
    )


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of speech marks.

    Raises:
        LipwrightError: there are neither visemes nor words, or a mark lacks a field.
    """
    rows = content if isinstance(content, list) else [content]
    visemes: list[Timed] = []
    words: list[Timed] = []
    for number, value in enumerate(rows, 1):
        place = f"mark {number}"
        fields = fields_of(path, value, place)
        kind = fields.get("type")
        if kind not in ("viseme", "word"):
            continue
        start = seconds_of(path, fields.get("time"), place, "time", MS)
        mark = Timed(text_of(path, fields, "value", place), start, None, place)
        (visemes if kind == "viseme" else words).append(mark)
    if visemes:
        return visemes_to_track(
            path, visemes, VISEMES, words=words, language=language, duration=duration
        )
    if not words:
        raise LipwrightError(
            f"{path}: has no marks of the types viseme and word; ask Polly for both, with "
            '--speech-mark-types \'["viseme", "word"]\''
        )
    return words_to_track(path, words, language, duration)
