"""Rhubarb Lip Sync: mouth cues as JSON, and the phones that stand for its shapes.

`mouthCues` with `start`, `end` and `value`, shapes A to H and X, as in "Mouth shapes" and "JSON
format" of its README. Its shapes say nothing of words: each cue becomes the phone that looks most
like it, and A, at which the lips touch, a bilabial one.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from lipwright.phones import SILENCE
from lipwright.streams.source import fields_of, list_of, read_content, seconds_of, text_of
from lipwright.streams.times import Timed
from lipwright.streams.visemes import visemes_to_track
from lipwright.track import PhoneTrack

VISEMES: Final = MappingProxyType({
    "A": ("M", "B", "P"), "B": ("S", "K", "T", "IY"), "C": ("EH", "AE"), "D": ("AA",),
    "E": ("AO", "ER"), "F": ("UW", "OW", "W"), "G": ("F", "V"), "H": ("L",), "X": (SILENCE,),
})  # fmt: skip
"""shape to phones, that which stands for it first"""


def read(path: Path, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of a file; see `to_track`."""
    return to_track(path, read_content(path), language, duration)


def fits(content: Any) -> bool:
    """Whether the keys are those of this layout."""
    return isinstance(content, dict) and "mouthCues" in content


def to_track(path: Path, content: Any, language: str, duration: float | None = None) -> PhoneTrack:
    """The track of JSON; the language does not count.

    Raises:
        LipwrightError: it has no cues, or one lacks a field.
    """
    fields = fields_of(path, content, "the file")
    cues = []
    for number, value in enumerate(list_of(path, fields.get("mouthCues"), "'mouthCues'"), 1):
        place = f"cue {number}"
        cue = fields_of(path, value, place)
        start = seconds_of(path, cue.get("start"), place, "start")
        end = seconds_of(path, cue.get("end"), place, "end")
        cues.append(Timed(text_of(path, cue, "value", place), start, end, place))
    return cues_to_track(path, cues, duration)


def cues_to_track(path: Path, cues: Sequence[Timed], duration: float | None) -> PhoneTrack:
    """The track of cues.

    Raises:
        LipwrightError: there are none, a time is wrong or a shape unknown.
    """
    return visemes_to_track(path, cues, VISEMES, duration=duration)
