"""What every aligner takes and gives: audio and words in, phones with times out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.language import Dictionary, SpokenWord

Progress = Callable[[float], None]
"""called with the share of the work that is done, 0 to 1"""


@dataclass(frozen=True)
class Misfit:
    """A word of the transcript that does not fit the sound."""

    text: str
    """the word as it would be spoken"""
    written: str
    """as the transcript writes it: "2" for the spoken "two\""""
    start: float
    """s, where the word would be"""
    end: float
    """s, at or after `start`"""
    score: float
    """mean log-likelihood ratio a frame against any speech; the lower, the worse"""


@dataclass(frozen=True)
class Alignment:
    """Phones with times, and the words that could not be placed."""

    track: PhoneTrack
    """from 0 to the end of the audio, `sil` where nothing is said; a misfit is in it, with a low
    confidence, only where something else is said in its place"""
    misfits: tuple[Misfit, ...] = ()
    """in the order of the transcript"""
    unwritten: tuple[tuple[float, float], ...] = ()
    """start and end in s of what seems to be speech and has no words; `sil` in the track"""


class Aligner(Protocol):
    """A back end that puts a transcript on the time axis of its audio."""

    @property
    def name(self) -> str:
        """What the user calls it."""

    def is_available(self) -> bool:
        """Whether its packages and models are installed."""

    def languages(self) -> tuple[str, ...]:
        """Codes of the languages that it aligns, such as "en"."""

    def align(
        self,
        audio: Sound,
        words: Sequence[SpokenWord],
        language: str,
        dictionary: Dictionary | None = None,
        progress: Progress | None = None,
    ) -> Alignment:
        """Phones and words with times and confidences.

        Raises:
            LipwrightError: nothing is said, or the words do not fit the sound.
        """
