"""Unreal curve table as JSON (`.unreal.json`): a curve an object, its times as keys.

Layout (Unreal documentation, "Data Driven Gameplay Elements", and what the editor's "Export as
JSON" writes): a list of objects, each with the `Name` of the curve and, for each key, its time,
here in s, and its value. As in the CSV of `unreal`, the import asks how values are joined: choose
linear. A control that never changes has one key. Times have 1 us, values seven digits.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from lipwright.clip import Clip
from lipwright.export.keytext import key_rows
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.export.unreal import check_names
from lipwright.formats.jsontrack import dump
from lipwright.keys import keyed


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: there are no controls, or Unreal would take two names for one.
    """
    check_names(path, performance.clip)
    return [text_output(path, lambda: _lines(performance.clip))]


def _lines(clip: Clip) -> Iterator[str]:
    between = "[\n"
    for name, curve in keyed(clip).curves.items():
        keys = key_rows(', "%.6f": %.7g', curve.times, curve.values)
        yield f'{between}  {{"Name": {dump(name)}{keys}}}'
        between = ",\n"
    yield "\n]\n"
