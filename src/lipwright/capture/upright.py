"""Decoded frames as upright RGB pictures with square pixels."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from av import VideoFrame
    from av.video.reformatter import VideoReformatter

Picture = npt.NDArray[np.uint8]
"""(height, width, 3), RGB, upright, square pixels"""


def upright(frame: VideoFrame, size: tuple[int, int]) -> Picture:
    """The picture of a frame, `size` (width, height) when upright."""
    turns, mirrored = orientation(frame)
    width, height = size[::-1] if turns % 2 else size
    square = _reformatter().reformat(frame, width, height, "rgb24")
    picture = np.asarray(square.to_ndarray(), np.uint8)
    picture = np.rot90(picture[:, ::-1] if mirrored else picture, turns)
    return np.ascontiguousarray(picture)


@cache
def _reformatter() -> VideoReformatter:
    """One for all frames: a frame's own would be made anew for each, in 13 times the time."""
    from av.video.reformatter import VideoReformatter

    return VideoReformatter()


def upright_size(frame: VideoFrame, aspect: Fraction | None) -> tuple[int, int]:
    """Width and height of the upright picture; `aspect` is a pixel's width over its height."""
    width, height = round(frame.width * float(aspect or 1)), frame.height
    return (height, width) if orientation(frame)[0] % 2 else (width, height)


def orientation(frame: VideoFrame) -> tuple[int, bool]:
    """What sets a frame upright: whether to mirror it, after that quarter turns to the left.

    Returns:
        the turns, counter-clockwise, 0 to 3, and whether to mirror left and right before them.
    """
    from av.sidedata.sidedata import Type

    matrix = cast("Any", frame.side_data).get(Type.DISPLAYMATRIX)  # its types know only names
    if matrix is None:
        return 0, False
    # Row by row (ISO 14496-12, 6.2.2): a pixel (x, y), y down, is shown at (ax + cy, bx + dy).
    a, b, _, c, d = np.frombuffer(bytes(matrix), np.int32)[:5].astype(float)
    mirrored = bool(a * d - b * c < 0)
    if mirrored:
        a, b = -a, -b
    return round(float(np.arctan2(-b, a)) / (np.pi / 2)) % 4, mirrored
