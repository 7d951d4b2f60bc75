r"""Mouth cues as Rhubarb Lip Sync writes them, tab-separated (`.rhubarb.tsv`).

The layout is that of the README of Rhubarb Lip Sync, section "Output formats": a line of time and
shape a cue, `0.05\tD`, the first at 0.00, and a last line with the end of the recording and a
closed mouth. Shapes are A to H and X. Times are seconds with two decimals, exact to 5 ms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Final

from lipwright.export.drawn import drawn_shapes
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.retarget.shapes import ShownShape, rest_shape
from lipwright.rig import Rig

RIG: Final = "rhubarb"
SHAPES: Final = frozenset("ABCDEFGHX")
SCALE: Final = 100  # hundredths of a second

Cue = tuple[str, str, str]
"""start and end in s, as text, and shape"""


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves.
    """
    rig, choose = rhubarb_cues(path, performance)
    return [text_output(path, lambda: _lines(choose(), rest_shape(rig)))]


def rhubarb_cues(path: Path, performance: Performance) -> tuple[Rig, Callable[[], list[Cue]]]:
    """The rig whose shapes are Rhubarb's, and what makes the cues of a performance.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves.
    """
    own = performance.rig
    rig, choose = drawn_shapes(
        path, performance, RIG, own=own is not None and set(own.names) <= SHAPES
    )
    return rig, lambda: cues(choose())


def cues(shown: tuple[ShownShape, ...]) -> list[Cue]:
    """The shapes at hundredths of a second; what lasts none of them is left out."""
    starts: dict[int, str] = {}
    for shape in shown:
        starts[round(shape.start * SCALE)] = shape.name
    end = max(round(shown[-1].end * SCALE), max(starts) + 1)
    kept: list[tuple[int, str]] = []
    for start, name in starts.items():
        if not kept or kept[-1][1] != name:
            kept.append((start, name))
    edges = [start for start, _ in kept] + [end]
    times = [f"{edge / SCALE:.2f}" for edge in edges]
    return [
        (start, stop, name) for (start, stop), (_, name) in zip(pairwise(times), kept, strict=True)
    ]


def _lines(found: list[Cue], rest: str) -> Iterator[str]:
    for start, _, name in found:
        yield f"{start}\t{name}\n"
    yield f"{found[-1][1]}\t{rest}\n"
