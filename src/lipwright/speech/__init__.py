"""Speech: forced alignment and voice activity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from lipwright.errors import LipwrightError
from lipwright.speech.aligner import Aligner, Alignment, Misfit, Progress

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.language import Dictionary, SpokenWord

__all__ = ["ALIGNERS", "Aligner", "Alignment", "Misfit", "Progress", "align", "get_aligner"]


def _sphinx() -> Aligner:
    from lipwright.speech.sphinx import SphinxAligner

    return SphinxAligner()


ALIGNERS: Final = MappingProxyType[str, Callable[[], Aligner]]({"sphinx": _sphinx})
"""name to what makes the back end"""


def get_aligner(name: str) -> Aligner:
    """The back end of that name.

    Raises:
        LipwrightError: there is none.
    """
    if name not in ALIGNERS:
        raise LipwrightError(f"unknown aligner {name!r}; use one of: {', '.join(ALIGNERS)}")
    return ALIGNERS[name]()


def align(
    audio: Sound,
    words: Sequence[SpokenWord],
    language: str = "en",
    dictionary: Dictionary | None = None,
    aligner: str = "sphinx",
    progress: Progress | None = None,
) -> Alignment:
    """Put `words` on the time axis of `audio`.

    Raises:
        LipwrightError: no such aligner or language, no words, silence, or words that do not fit.
    """
    backend = get_aligner(aligner)
    if not backend.is_available():
        raise LipwrightError(f"aligner {aligner!r} is not installed; run: pip install lipwright")
    if language not in backend.languages():
        known = ", ".join(backend.languages())
        raise LipwrightError(
            f"aligner {aligner!r} knows no {language!r}; it knows: {known}; "
            "give the phones and their times with --phones"
        )
    if not words:
        raise LipwrightError("the text has no words; give the words that are spoken")
    return backend.align(audio, words, language, dictionary, progress)
