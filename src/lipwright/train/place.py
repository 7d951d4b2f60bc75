"""Where a model is made, and how it takes its place: whole or not at all."""

from __future__ import annotations

import secrets
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from lipwright.dataset.lock import LOCK_FILE
from lipwright.errors import LipwrightError
from lipwright.network.meta import META_FILE
from lipwright.train.takes import Corpus

TRAINING: Final = "training"  # the part of a model's folder that running it does not need
CARD_FILE: Final = "card.md"


@dataclass(frozen=True)
class TrainOptions:
    """What is asked of a training besides its configuration."""

    face: Path | None = None
    """the reference face of shape and joint modes"""
    licence: str = ""
    """of the weights"""
    force: bool = False
    """replace a finished model, and a checkpoint that does not fit"""


@dataclass(frozen=True)
class Trained:
    """What came out."""

    folder: Path
    history: list[dict[str, Any]]
    metrics: dict[str, Any]
    """split to figures, as `measure` gives them"""
    seconds: float
    """that training took, without reading and export; of all its parts, where it was stopped"""


def part_of(out: Path) -> Path:
    """Where a model is made, before it takes its place.

    Raises:
        LipwrightError: the path has no name of its own, as `.` has none.
    """
    if out.name in {"", ".."}:
        raise LipwrightError(f"{out}: is no name of a new folder; give the model one")
    return out.with_name(f"{out.name}.part")


def make_place(out: Path, options: TrainOptions) -> Path:
    """The folder in which a model is made.

    Raises:
        LipwrightError: it cannot be made, or `out` is taken.
    """
    place = part_of(out)
    try:
        _refuse_others(out, options)
        (place / TRAINING).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LipwrightError(f"{place}: cannot be made: {error.strerror}") from error
    return place


def _refuse_others(out: Path, options: TrainOptions) -> None:
    """Leave alone what is not a model, or one that is to stay."""
    if out.exists() and not out.is_dir():
        raise LipwrightError(f"{out}: is a file; name a new folder")
    if (out / META_FILE).is_file():
        if not options.force:
            raise LipwrightError(f"{out}: is a finished model; add --force to replace it")
    elif out.is_dir() and any(out.iterdir()):
        raise LipwrightError(f"{out}: is a folder with other files; name a new folder")


def move(place: Path, out: Path, options: TrainOptions) -> None:
    """Put the finished folder in its place; hours may have passed since that was free."""
    try:
        _refuse_others(out, options)
        (place / LOCK_FILE).unlink(missing_ok=True)
        if out.is_dir() and any(out.iterdir()):
            old = out.with_name(f".{secrets.token_hex(4)}.old.{out.name[-60:]}")
            out.rename(old)
            place.rename(out)
            shutil.rmtree(old, ignore_errors=True)
        else:
            place.rename(out)
    except OSError as error:
        raise LipwrightError(f"{out}: cannot be put in its place: {error.strerror}") from error


def licence_of(corpus: Corpus, options: TrainOptions) -> str:
    """The licence of the weights, as it was given, or what can be said without."""
    return options.licence or (
        "that of whoever trained them; learnt from data under: "
        + (corpus.licence or "no licence named")
    )
