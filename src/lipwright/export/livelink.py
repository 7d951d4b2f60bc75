"""Live Link Face CSV, as Epic's app records it and Unreal imports it: 61 columns a frame.

52 ARKit weights and nine angles in radians: yaw, pitch and roll of the head, and those of the eyes,
which stay at rest. The tongue controls that ARKit lacks are left out.

The head's angles are those of Apple's face anchor (+x to the face's own left, y up, z out of the
face), turned by the right-hand rule, which Epic's plugin AppleARKitFaceSupport gives on
(`ToFTransform` of AppleARKitConversion.h, then `ToBlendShapeMap`): HeadYaw to the own left and
HeadRoll with the crown to the own right, as in our angles, and HeadPitch down, as ours is not.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import ARKIT, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export.performance import (
    ExportOptions,
    Output,
    PathLike,
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
SIGNS: Final = (1.0, -1.0, 1.0)  # of yaw, pitch and roll, for ours


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
    weights = clip.select(ARKIT).values.clip(0, 1)
    turns = clip.select(HEAD_ANGLES).values * np.array(SIGNS, np.float32)
    values = np.concatenate([weights, turns], axis=1)
    base = int(clip.fps) if clip.fps == int(clip.fps) <= APP_FPS else APP_FPS
    form = ",".join([f"%.{DECIMALS}f"] * len(COLUMNS)) + "\n"
    still = (0.0,) * (len(ANGLES) - len(HEAD_ANGLES))
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


def read(path: PathLike) -> Clip:
    """The clip of a recording, also of the app's own; see `livelink_read`."""
    from lipwright.export.livelink_read import read_clip_live_link

    return read_clip_live_link(path)
