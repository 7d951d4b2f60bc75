"""Switch data of Moho, which OpenToonz reads too: the line `MohoSwitch1`, then `FRAME NAME` lines.

Frames count from 1, as Papagayo's export and Rhubarb Lip Sync's write them, at 24 a second, or at
the clip's rate where that is 24 to 30; each is nearest to its time. The names are Preston-Blair's,
which OpenToonz needs, or those of the drawn rig that the curves are in. The last line closes the
mouth at the end.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from lipwright.export.drawn import drawn_fps, drawn_shapes, shape_frames
from lipwright.export.performance import ExportOptions, Output, Performance, text_output
from lipwright.retarget.shapes import ShownShape, rest_shape

RIG: Final = "preston-blair"
FIRST_FRAME: Final = 1


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves.
    """
    rig, choose = drawn_shapes(path, performance, RIG)
    fps = drawn_fps(performance)
    return [text_output(path, lambda: _lines(choose(), fps, rest_shape(rig)))]


def _lines(shown: tuple[ShownShape, ...], fps: float, rest: str) -> Iterator[str]:
    frames = shape_frames(shown, fps)
    end = max(round(shown[-1].end * fps), frames[-1][0] + 1)
    yield "MohoSwitch1\n"
    for frame, name in [*frames, (end, rest)]:
        yield f"{frame + FIRST_FRAME} {name}\n"
