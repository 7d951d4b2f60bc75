"""Live Link Face CSV, as Epic's app records it and Unreal imports it: 61 columns a frame.

52 ARKit weights and nine angles of head and eyes in radians, which stay at rest. The tongue
controls that ARKit lacks are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from lipwright.clip import Clip
from lipwright.controls import ARKIT
from lipwright.errors import LipwrightError
from lipwright.export.performance import (
    ExportOptions,
    Output,
    Performance,
    rounded_rows,
    text_output,
)

ANGLES: Final = (
    "HeadYaw", "HeadPitch", "HeadRoll",
    "LeftEyeYaw", "LeftEyePitch", "LeftEyeRoll",
    "RightEyeYaw", "RightEyePitch", "RightEyeRoll",
)  # fmt: skip
COLUMNS: Final = tuple(name[0].upper() + name[1:] for name in ARKIT) + ANGLES
APP_FPS: Final = 60  # the app's rate; frames of other rates fall between its frames
DECIMALS: Final = 8  # as the app writes them


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: the clip has no ARKit control.
    """
    clip = performance.clip
    if not set(clip.names) & set(ARKIT):
        raise LipwrightError(
            f"{path}: the curves have no ARKit controls, which Live Link Face needs; retarget them "
            "to the ARKit rig or export another format"
        )
    return [text_output(path, lambda: _lines(clip))]


def _lines(clip: Clip) -> Iterator[str]:
    values = clip.select(ARKIT).values.clip(0, 1)
    base = int(clip.fps) if clip.fps == int(clip.fps) <= APP_FPS else APP_FPS
    form = ",".join([f"%.{DECIMALS}f"] * len(COLUMNS)) + "\n"
    still = (0.0,) * len(ANGLES)
    yield ",".join(("Timecode", "BlendShapeCount", *COLUMNS)) + "\n"
    for time, row in zip(clip.times, rounded_rows(values, DECIMALS), strict=True):
        yield f"{timecode(time, base)},{len(COLUMNS)}," + form % (*row, *still)


def timecode(time: float, base: int) -> str:
    """`HH:MM:SS:FF.mmm` of `time` in s: frames of `base` a second and thousandths of a frame."""
    thousandths = round(time * base * 1000)
    frames, thousandths = divmod(thousandths, 1000)
    seconds, frames = divmod(frames, base)
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours:02}:{minutes:02}:{seconds:02}:{frames:02}.{thousandths:03}"
