"""Audio2Face weights (`.a2f.json`), as NVIDIA's Audio2Face exports blendshapes.

Layout (NVIDIA Audio2Face documentation, "Blendshape Conversion", and files that it wrote):
`exportFps`, `trackPath` (the sound), `numPoses`, `numFrames`, `facsNames`, the names of the
blendshapes, and `weightMat`, a row of their weights a frame. The names are ARKit's 52; tongue
controls beyond them and turns of the head are left out. A weight has six decimals.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from lipwright.controls import ARKIT
from lipwright.errors import LipwrightError
from lipwright.export.performance import (
    ExportOptions,
    Output,
    Performance,
    rounded_rows,
    text_output,
)
from lipwright.formats.jsontrack import dump

DECIMALS: Final = 6  # of a weight


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: the clip has no ARKit control.
    """
    if not set(performance.clip.names) & set(ARKIT):
        raise LipwrightError(
            f"{path}: the curves have no ARKit controls, which Audio2Face's weights are; retarget "
            "them to the ARKit rig or export another format"
        )
    return [text_output(path, lambda: _lines(performance))]


def _lines(performance: Performance) -> Iterator[str]:
    clip = performance.clip
    sound = performance.audio_path
    fields = {
        "exportFps": int(clip.fps) if clip.fps == int(clip.fps) else clip.fps,
        "trackPath": "" if sound is None else sound.name,
        "numPoses": len(ARKIT),
        "numFrames": len(clip),
        "facsNames": list(ARKIT),
    }
    yield "{\n"
    for key, value in fields.items():
        yield f"  {dump(key)}: {dump(value)},\n"
    yield '  "weightMat": ['
    form = ", ".join([f"%.{DECIMALS}g"] * len(ARKIT))
    for index, row in enumerate(rounded_rows(clip.select(ARKIT).values.clip(0, 1), DECIMALS)):
        yield f"{',' if index else ''}\n    [{form % tuple(row)}]"
    yield "\n  ]\n}\n"
