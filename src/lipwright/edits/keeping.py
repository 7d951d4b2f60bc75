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
from lipwright.export import CANONICAL_RIG, EXPORTERS, Exporter, export_all, read_clip
from lipwright.export.performance import ExportOptions, PathLike, Performance
from lipwright.formats.suffixes import by_suffix
from lipwright.rig import Rig


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
    put_back: bool
    """the file had lost all edits, as a run without them leaves it, and has them again"""


def edited_output(
    paths: Iterable[PathLike], rig: Rig | None = None, onto: PathLike | None = None,
    format: str | None = None,  # noqa: A002  # as the command line calls it
) -> Path:  # fmt: skip
    """The first of the outputs that can be read back in the controls of the curves.

    Args:
        paths: the outputs.
        rig: whose controls the curves are; None for canonical ones.
        onto: the character that a GLB animates, whose names are its own.
        format: a suffix for all of them, where theirs do not say it.

    Raises:
        LipwrightError: there is none.
    """
    for path in map(Path, paths):
        if _keeps_controls(by_suffix(EXPORTERS, path, format, "export"), rig, onto):
            return path
    known = ", ".join(
        suffix for suffix, entry in EXPORTERS.items() if _keeps_controls(entry, rig, onto)
    )
    raise LipwrightError(
        f"--edits needs an output that can be read back in the same controls: {known}"
    )


def _keeps_controls(exporter: Exporter, rig: Rig | None, onto: PathLike | None) -> bool:
    """Whether what is read back of an export has the controls that the curves had."""
    own = CANONICAL_RIG if rig is None else rig.name
    if exporter.shows:
        return exporter.reads and onto is None and (own == CANONICAL_RIG or bool(rig and rig.bones))
    return exporter.reads and exporter.rig in ("", own)


def export_with_edits(
    paths: Iterable[PathLike],
    performance: Performance,
    edits: PathLike,
    options: ExportOptions | None = None,
    *,
    format: str | None = None,  # noqa: A002  # as the command line calls it
) -> Kept:
    """Export, with the edits that the first readable output and the edits' file hold.

    Args:
        paths: the files; the first that can be read back is the one that people edit.
        performance: the new automatic result.
        edits: the file that keeps the differences; it is made where it is missing.
        options: choices of single formats.
        format: a suffix for all files, where theirs do not say it.

    Raises:
        LipwrightError: a file cannot be read or written; then no output was changed.
    """
    targets = [Path(path) for path in paths]
    onto = None if options is None else options.onto
    output, place = edited_output(targets, performance.rig, onto, format), Path(edits)
    state = load_edits(place) if place.exists() else Edits(track=performance.track)
    unrecorded = put_back = False
    if output.exists():
        unrecorded = not state.written
        if unrecorded:
            state = replace(state, written=(_read_back(output, performance, options, format),))
        found = read_clip(output, format)
        put_back = state.undone(state.news(found))
        state = state.gathered(found)
        save_edits(state, place)
    moved = state.moved_to(performance.track)
    changed = replace(performance, clip=moved.applied(performance.clip))
    coming = _read_back(output, changed, options, format)
    # Until the output is in place it may be either; the phones tell that the edits have moved.
    save_edits(replace(moved, written=(*state.written, coming)), place)
    export_all(targets, changed, format=format, options=options)
    save_edits(replace(moved, written=(coming,)), place)
    return Kept(output, *_extent(moved.changes), unrecorded, put_back)


def _read_back(
    output: Path, performance: Performance, options: ExportOptions | None,
    format: str | None,  # noqa: A002  # as the command line calls it
) -> Clip:  # fmt: skip
    """The curves that reading the output gives: its format rounds, and may leave controls out."""
    with tempfile.TemporaryDirectory(prefix="lipwright-") as folder:
        path = Path(folder) / output.name
        export_all([path], performance, format=format, options=options)
        return read_clip(path, format)


def _extent(changes: Clip | None) -> tuple[tuple[str, ...], float]:
    if changes is None:
        return (), 0.0
    touched = np.abs(changes.values).max(axis=1) > 0
    return changes.names, float(touched.sum() / changes.fps)
