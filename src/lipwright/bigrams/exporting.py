"""Whole sets for other programs, by suffix."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType
from typing import Final

from lipwright.bigrams import file, smartbody_text
from lipwright.bigrams.families import flatten, moved
from lipwright.bigrams.values import BigramSet
from lipwright.errors import LipwrightError
from lipwright.files import write_whole

PathLike = str | os.PathLike[str]

COLUMNS: Final = ("first", "second", "source", "pose", "time", "value")


def _to_json(path: Path, bigrams: BigramSet) -> str:
    return file.set_to_text(moved(flatten(bigrams), Path("here"), path))


def _to_smartbody(path: Path, bigrams: BigramSet) -> str:
    del path
    return smartbody_text.set_to_text(bigrams)


def _to_csv(path: Path, bigrams: BigramSet) -> str:
    """A row a control point; a pair at rest has one row without a pose."""
    del path
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for pair in file.sorted_pairs(bigrams.bigrams, bigrams.classes):
        bigram = bigrams.bigrams[pair]
        rows = [
            (*pair, bigram.source, pose, f"{time:.6g}", f"{value:.6g}")
            for pose, points in bigram.curves.items()
            for time, value in points
        ]
        table.writerows(rows or [(*pair, bigram.source, "", "", "")])
    return text.getvalue()


EXPORTS: Final = MappingProxyType[str, Callable[[Path, BigramSet], str]]({
    ".json": _to_json, ".py": _to_smartbody, ".txt": _to_smartbody, ".csv": _to_csv,
})  # fmt: skip
"""suffix to the text of a set"""


def export_set(path: PathLike, bigrams: BigramSet) -> None:
    """Write a set as the suffix says, whole or not at all.

    Raises:
        LipwrightError: the suffix is unknown, or the file cannot be written.
    """
    target = Path(path)
    to_text = EXPORTS.get(target.suffix.lower())
    if to_text is None:
        raise LipwrightError(f"{path}: give it one of the suffixes {', '.join(EXPORTS)}")
    content = to_text(target, bigrams).encode("utf-8")
    with write_whole(target) as part:
        part.write_bytes(content)
