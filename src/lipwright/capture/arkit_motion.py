"""A recording of ARKit weights to a `Motion` at a constant rate, as the thesis does."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import MAX_FPS
from lipwright.controls import ARKIT
from lipwright.dataset.recording import Flag, Motion
from lipwright.export.arkit_recording import ArkitRecording

THESIS_FPS: Final = 30.0  # frames a second, Swedish visual speech 2018, section 4.2.1
MAX_STEP: Final = 1.5  # frames of the phone; a longer step is a gap
REACH: Final = 0.45  # frames of the phone; beside a gap a frame counts that far, not beyond
SHUT: Final = 0.5  # of both eyeBlink weights: the eyes are shut

_LIDS: Final = (ARKIT.index("eyeBlinkLeft"), ARKIT.index("eyeBlinkRight"))


def to_motion(recording: ArkitRecording, fps: float | None = THESIS_FPS) -> Motion:
    """The recording on an even grid, linear between its frames; None keeps the phone's rate.

    The first frame of the file is the first of the picture: it is shown from 0 to 1 / fps s of
    the phone, so that its middle is half a frame after the start. What lies in a gap of more than
    1.5 frames is DROPPED, what borders on a frame without a face is LOST; both are NaN.

    Raises:
        ValueError: fps is not above 0 and at most 1000.
    """
    fps = recording.fps if fps is None else fps
    if not 0 < fps <= MAX_FPS:
        raise ValueError(f"fps is {fps}, not above 0 and at most {MAX_FPS:.0f}")
    middles = recording.times - recording.times[0] + 0.5 / recording.fps
    count = max(round(recording.duration * fps), 1)
    grid = (np.arange(count) + 0.5) / fps
    before = np.clip(np.searchsorted(middles, grid, "right") - 1, 0, len(middles) - 2)
    after = before + 1
    share = ((grid - middles[before]) / (middles[after] - middles[before])).clip(0, 1)
    nearest = np.where(share < 0.5, before, after)
    distance = np.abs(grid - middles[nearest]) * recording.fps
    gap = (middles[after] - middles[before]) * recording.fps > MAX_STEP
    seen = recording.valid
    whole = gap | ~seen[before] | ~seen[after]  # one of the two frames, or none
    share = np.where(whole, nearest == after, share)
    dropped = gap & (distance > REACH)
    lost = ~dropped & whole & (~seen[nearest] | (~gap & (distance > REACH)))
    flags = np.where(dropped, Flag.DROPPED, 0) | np.where(lost, Flag.LOST, 0)
    values = _between(recording.values, before, share)
    shut = (values[:, _LIDS] > SHUT).all(axis=1) & (flags == 0)
    angles = recording.angles
    return Motion(
        fps=fps,
        flags=(flags | np.where(shut, Flag.BLINK, 0)).astype(np.uint8),
        arkit=values,
        angles=None if angles is None else _between(angles, before, share),
    )


def _between(
    values: npt.NDArray[np.float32], before: npt.NDArray[np.intp], share: npt.NDArray[np.float64]
) -> npt.NDArray[np.float32]:
    """(N, C), from frame `before` (share 0) to the next (share 1), which need no number at 0."""
    low, high, part = values[before], values[before + 1], share[:, None].astype(np.float32)
    mixed = (1 - part) * low + part * high
    return np.where(part == 0, low, np.where(part == 1, high, mixed))
