"""What is said in a recording that comes without words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from lipwright.speech.aligner import Alignment

Path = Literal["words", "phones"]


@dataclass(frozen=True, eq=False)
class Heard:
    """Phones with times, and how they were found."""

    alignment: Alignment
    path: Path
    """"words": words were recognised and aligned; "phones": phones were recognised and re-timed"""
    confidence: float
    """0 to 1, how far to trust it: what share of the phones is likely to be right"""
    text: str = ""
    """the words that were recognised; "" on the path of phones"""
    language: str = "en"
    """of the words"""
    notes: tuple[str, ...] = ()
    """what the user should know, a line each: "music from 3.2 to 7.9 s; the mouth follows it no
    further" """
