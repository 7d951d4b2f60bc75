"""Exporting over files that people edit, without losing what they did.

A stop at any moment, even between two of the writes below, neither loses an edit nor applies it
twice: the edits' file always knows both what lies in the output and what is about to.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lipwright.clip import Clip
from lipwright.edits.file import load_edits, save_edits
from lipwright.edits.values import Edits
from lipwright.errors import LipwrightError
from lipwright.export import EXPORTERS, export_all, read_clip
from lipwright.export.performance import ExportOptions, PathLike, Performance
from lipwright.formats.suffixes import by_suffix


@dataclass(frozen=True)
class Kept:
    """What `export_with_edits` kept of the file that it replaced."""

    path: Path
    """the output whose curves people edit"""
    controls: tuple[str, ...]
    """those with edits, now and before"""
    seconds: float
    """how long any of them is edited, in all"""
    unrecorded: bool
    """nothing told what had been written; its differences from this result were taken"""


def edited_output(paths: Iterable[PathLike]) -> Path:
    """The first of the outputs that can be read back.

    Raises:
        LipwrightError: there is none.
    """
    for path in map(Path, paths):
        if by_suffix(EXPORTERS, path, None, "export").reads:
            return path
    known = ", ".join(suffix for suffix, entry in EXPORTERS.items() if entry.reads)
    raise LipwrightError(f"--edits needs an output that can be read back: {known}")


def export_with_edits(
    paths: Iterable[PathLike],
    performance: Performance,
    edits: PathLike,
    options: ExportOptions | None = None,
) -> Kept:
    """Export, with the edits that the first readable output and the edits' file hold.

    Args:
        paths: the files; the first that can be read back is the one that people edit.
        performance: the new automatic result.
        edits: the file that keeps the differences; it is made where it is missing.
        options: choices of single formats.

    Raises:
        LipwrightError: a file cannot be read or written; then no output was changed.
    """
    targets = [Path(path) for path in paths]
    output, place = edited_output(targets), Path(edits)
    state = load_edits(place) if place.exists() else Edits(track=performance.track)
    unrecorded = False
    if output.exists():
        unrecorded = not state.written
        if unrecorded:
            state = replace(state, written=(_read_back(output, performance, options),))
        state = state.gathered(read_clip(output))
        save_edits(state, place)
    moved = state.moved_to(performance.track)
    changed = replace(performance, clip=moved.applied(performance.clip))
    coming = _read_back(output, changed, options)
    # Until the output is in place it may be either; the phones tell that the edits have moved.
    save_edits(replace(moved, written=(*state.written, coming)), place)
    export_all(targets, changed, options=options)
    save_edits(replace(moved, written=(coming,)), place)
    return Kept(output, *_extent(moved.changes), unrecorded)


def _read_back(output: Path, performance: Performance, options: ExportOptions | None) -> Clip:
    """The curves that reading the output gives: its format rounds, and may leave controls out."""
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        path = Path(folder) / output.name
        export_all([path], performance, options=options)
        return read_clip(path)


def _extent(changes: Clip | None) -> tuple[tuple[str, ...], float]:
    if changes is None:
        return (), 0.0
    touched = np.abs(changes.values).max(axis=1) > 0
    return changes.names, float(touched.sum() / changes.fps)
