"""Mouth cues as Rhubarb Lip Sync writes them, in XML (`.rhubarb.xml`).

The layout is that of the README of Rhubarb Lip Sync, section "XML format": the path of the sound,
its duration, and cues with start, end and shape. Each ends where the next one starts. Times are
seconds with two decimals, exact to 5 ms.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.sax.saxutils import escape  # writes only

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
    yield '<?xml version="1.0" encoding="utf-8"?>\n<rhubarbResult>\n  <metadata>\n'
    yield f"    <soundFile>{escape(sound)}</soundFile>\n"
    yield f"    <duration>{found[-1][1]}</duration>\n  </metadata>\n  <mouthCues>\n"
    for start, end, name in found:
        yield f'    <mouthCue start="{start}" end="{end}">{escape(name)}</mouthCue>\n'
    yield "  </mouthCues>\n</rhubarbResult>\n"
