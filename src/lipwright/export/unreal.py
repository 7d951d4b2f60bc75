"""Unreal curve table as CSV (`.unreal.csv`): a curve a row, its times in the first line.

Layout (Unreal documentation, "Data Driven Gameplay Elements", curve tables, and what the editor's
"Export as CSV" writes): the first cell is `---`, the others of the first line are times, here in s;
each further line is the name of a curve and its value at each time. How values are joined,
constant, linear or cubic, is chosen in the dialogue of the import: choose linear. No tangents can
be kept, so that every frame is written.

Unreal drops spaces, commas and quotes from the names of curves and takes capitals for small
letters. Times have 1 us, values seven digits, as many as Unreal keeps.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.keytext import check_controls, key_rows
from lipwright.export.performance import ExportOptions, Output, Performance, text_output

CORNER: Final = "---"  # the first cell
DROPPED: Final = str.maketrans("", "", "\"' ,")  # from names of curves


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: there are no controls, or Unreal would take two names for one.
    """
    check_names(path, performance.clip)
    return [text_output(path, lambda: _lines(performance.clip))]


def check_names(path: Path, clip: Clip) -> None:
    """Refuse names of curves that Unreal cannot tell apart.

    Raises:
        LipwrightError: there are such, or no controls, or a name has a control character.
    """
    check_controls(path, clip, "an Unreal curve table")
    seen: dict[str, str] = {}
    for name in clip.names:
        kept = name.translate(DROPPED).casefold()
        if not kept or kept in seen:
            other = f"takes it for {seen[kept][:40]!r}" if kept else "keeps none of it"
            raise LipwrightError(
                f"{path}: the control {name[:40]!r}: Unreal {other}; rename it in the rig"
            )
        seen[kept] = name


def _lines(clip: Clip) -> Iterator[str]:
    yield f"{CORNER},{key_rows('%.6f,', clip.times)[:-1]}\n"
    for name in clip.names:
        cell = io.StringIO()
        csv.writer(cell, lineterminator="").writerow([name])
        yield f"{cell.getvalue()},{key_rows('%.7g,', clip.curve(name))[:-1]}\n"
