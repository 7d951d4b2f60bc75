"""The two heads that curves are measured on, with the ruler where the benchmarks find it."""

from __future__ import annotations

from pathlib import Path

from grid import CORPORA
from lipwright.evaluate.heads import Ruler, landmark_head, our_head
from lipwright.evaluate.heads import rulers as rulers_of

__all__ = ["Ruler", "our_head", "ruler_head", "rulers"]


def _ruler_file(corpora: Path) -> Path:
    return corpora / "rulers" / "ict-landmarks.npz"


def ruler_head(corpora: Path = CORPORA) -> Ruler:
    """The second head, seen from the front as a camera would."""
    return landmark_head(_ruler_file(corpora))


def rulers(corpora: Path = CORPORA) -> dict[str, Ruler]:
    """Name to ruler."""
    return rulers_of(_ruler_file(corpora))
