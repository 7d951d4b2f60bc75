"""Mouth cues as Rhubarb Lip Sync writes them, in JSON (`.rhubarb.json`).

The layout is that of the README of Rhubarb Lip Sync, section "JSON format": the path of the sound,
its duration, and cues with start, end and value. Each ends where the next one starts. Times are
seconds with two decimals, exact to 5 ms.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from lipwright.export.drawn import sound_name
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.export.rhubarb import Cue, rhubarb_cues


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves.
    """
    _, choose = rhubarb_cues(path, performance)
    return [text_output(path, lambda: _lines(choose(), sound_name(performance)))]


def _lines(found: list[Cue], sound: str) -> Iterator[str]:
    yield '{\n  "metadata": {\n'
    yield f'    "soundFile": {json.dumps(sound, ensure_ascii=False)},\n'
    yield f'    "duration": {found[-1][1]}\n  }},\n  "mouthCues": [\n'
    rows = [
        f'    {{ "start": {start}, "end": {end}, "value": {json.dumps(name)} }}'
        for start, end, name in found
    ]
    yield ",\n".join(rows)
    yield "\n  ]\n}\n"
