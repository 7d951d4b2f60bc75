"""`Result`: a performance, and how it came about."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from lipwright.clip import Clip
from lipwright.export.performance import Performance
from lipwright.speech import Alignment
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.speech.listening import Heard
    from lipwright.speech.voices import Utterance


@dataclass(frozen=True, eq=False)
class Result:
    """What `animate` gives: the performance, and what was odd on the way."""

    performance: Performance
    alignment: Alignment | None = field(default=None)
    """None where a phone track was given, or a voice told its own times"""
    heard: Heard | None = field(default=None)
    """how the phones were found where no words were given"""
    utterance: Utterance | None = field(default=None)
    """what a voice has said, of `say`"""
    notes: tuple[str, ...] = ()
    """what the user should know, a line each"""

    @property
    def clip(self) -> Clip:
        """The curves."""
        return self.performance.clip

    @property
    def track(self) -> PhoneTrack:
        """The phones that they follow."""
        assert self.performance.track is not None  # animate always sets it
        return self.performance.track
