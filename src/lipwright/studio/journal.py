"""The journal: edits that are not in the set's file yet, beside it, so that no kill loses them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.dataset.folder import sha256_of
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.lock import held
from lipwright.studio.wire import bigram_to_json, checked_bigram, pair_key, split_key

FORMAT: Final = "lipwright-bigrams-unsaved"
VERSION: Final = 1
SUFFIX: Final = ".unsaved"
MAX_BYTES: Final = 64 * 1024 * 1024

Edits = Mapping[Pair, Bigram | None]
"""pair to what it shall be; None for that of the parent, or for nothing"""


@dataclass(frozen=True)
class Unsaved:
    """What a journal holds."""

    base: str
    """`digest` of the file that was edited"""
    edits: Edits


def journal_path(path: Path) -> Path:
    """Where the journal of a set's file lies."""
    return path.with_name(path.name + SUFFIX)


@contextmanager
def only_editor(path: Path) -> Iterator[None]:
    """Be the only editor of a set's file; the system ends it with the process.

    Raises:
        LipwrightError: another editor has the set open, or the folder cannot be written to.
    """
    place = path.with_name(f".{path.name}.editing")
    taken = f"{path}: another editor has it open; use that one, or end it"
    with held(place, f"{path}: cannot be edited here", taken):
        try:
            yield
        finally:
            place.unlink(missing_ok=True)


def digest(path: Path) -> str:
    """SHA-256 of a file in hexadecimal; "" where there is none.

    Raises:
        LipwrightError: it cannot be read.
    """
    return sha256_of(path) if path.exists() else ""


def write_journal(path: Path, base: str, edits: Edits) -> None:
    """Keep the edits of the set's file `path`; without any there is no journal.

    Raises:
        LipwrightError: it cannot be written.
    """
    journal = journal_path(path)
    if not edits:
        try:
            journal.unlink(missing_ok=True)
        except OSError as error:
            raise LipwrightError(f"{journal}: cannot be removed: {error.strerror}") from error
        return
    bigrams = {
        pair_key(pair): None if bigram is None else bigram_to_json(bigram)
        for pair, bigram in edits.items()
    }
    data = {"format": FORMAT, "version": VERSION, "base": base, "bigrams": bigrams}
    with write_whole(journal) as part:
        part.write_text(json.dumps(data, indent=1), "utf-8")


def read_journal(path: Path, bigrams: BigramSet) -> Unsaved | None:
    """The edits of the set's file `path` that were not saved; None where there are none.

    Raises:
        LipwrightError: the journal is damaged, or of another set.
    """
    journal = journal_path(path)
    try:
        if journal.stat().st_size > MAX_BYTES:
            raise LipwrightError(f"{journal}: too large for unsaved edits; move it away")
        data = json.loads(journal.read_text("utf-8"))
    except FileNotFoundError:
        return None
    except OSError as error:
        raise LipwrightError(f"{journal}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise LipwrightError(f"{journal}: damaged ({error}); move it away") from error
    try:
        return _unsaved(data, bigrams)
    except LipwrightError as error:
        raise LipwrightError(f"{journal}: {error}; mend it, or move it away") from error


def _unsaved(data: Any, bigrams: BigramSet) -> Unsaved:
    if not isinstance(data, dict) or data.get("format") != FORMAT or data.get("version") != VERSION:
        raise LipwrightError("holds no unsaved edits that this version knows")
    if not isinstance(data.get("bigrams"), dict) or not isinstance(data.get("base"), str):
        raise LipwrightError("has no bigrams, or does not say of which file")
    edits: dict[Pair, Bigram | None] = {}
    for key, value in data["bigrams"].items():
        pair = split_key(key)
        if value is not None and not isinstance(value, dict):
            raise LipwrightError(f"{key[:40]!r} is no bigram")
        edits[pair] = None if value is None else checked_bigram(bigrams, pair, value)
    return Unsaved(data["base"], edits)
