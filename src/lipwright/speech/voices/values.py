"""What every voice takes and gives: a script in, sound with phone times out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, Protocol

if TYPE_CHECKING:
    from lipwright.audio import Audio
    from lipwright.speech.aligner import Progress
    from lipwright.track import PhoneTrack

Emphasis = Literal["none", "reduced", "moderate", "strong"]
"""levels of the element `emphasis` of SSML 1.1; "moderate" where the text says nothing more"""

MIN_RATE: Final = 0.25
MAX_RATE: Final = 4.0


@dataclass(frozen=True)
class Piece:
    """A stretch of a script that is said in one manner.

    Raises:
        ValueError: nothing is said and no pause made, or a number is out of range.
    """

    text: str = ""
    """words as they are written; "" makes a pause alone"""
    phones: tuple[str, ...] = ()
    """symbols of the phone table that are said instead of what the text would give"""
    pause: float = 0.0
    """s of silence after it, 0 to 60"""
    emphasis: Emphasis | None = None
    rate: float = 1.0
    """times as fast as the voice by itself, MIN_RATE to MAX_RATE"""
    line: int = 1
    """of its first character in the source, from 1"""
    column: int = 1
    """of its first character in the source, from 1"""

    def __post_init__(self) -> None:
        """Check."""
        if not (self.text or self.phones or self.pause):
            raise ValueError("a piece that neither says anything nor pauses")
        if not 0 <= self.pause <= 60 or not MIN_RATE <= self.rate <= MAX_RATE:
            raise ValueError(f"a piece with a pause of {self.pause} s and the rate {self.rate}")


Script = tuple[Piece, ...]
"""what is said, in order; at least one piece says something"""


@dataclass(frozen=True)
class VoiceInfo:
    """A voice that can be asked for."""

    name: str
    """as `--voice` takes it: "hibari:heart", "espeak:sv" """
    language: str
    """ISO code, as `lipwright.language` knows it: "en", "en-gb", "sv" """
    about: str
    """one line for people"""


@dataclass(frozen=True, eq=False)
class Utterance:
    """What a voice has said."""

    audio: Audio
    track: PhoneTrack | None
    """from 0 to the end of the sound, with words, from the voice itself; None where the voice tells
    no times, so that its words must be aligned"""
    text: str
    """the words that were said, as they are written"""
    voice: str = ""
    """the name of who spoke"""
    timing: Literal["voice", "aligner"] = "voice"
    """who told the phone times"""


class Voice(Protocol):
    """A voice that is ready to speak."""

    @property
    def info(self) -> VoiceInfo:
        """Its name and language."""

    def speak(
        self, script: Script, source: str = "text", progress: Progress | None = None
    ) -> Utterance:
        """Say the script.

        Args:
            script: what is said.
            source: the script's name in errors.
            progress: told how far it is.

        Raises:
            LipwrightError: something in the script cannot be said; names its place.
        """


class VoiceBackEnd(Protocol):
    """Where voices come from."""

    @property
    def name(self) -> str:
        """What the user calls it: the part of a voice's name before the colon."""

    def is_available(self) -> bool:
        """Whether its packages are installed."""

    def remedy(self) -> str:
        """The command that installs what is missing."""

    def voices(self) -> Sequence[VoiceInfo]:
        """The voices that can be asked for now, without a download; the default first."""

    def open(self, voice: str, language: str | None) -> Voice:
        """The voice of that name, "" for the default of the language.

        Raises:
            LipwrightError: there is none; lists the known ones.
        """
