"""The real mouth of a recording and that of our head in pictures of the same framing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import MOUTH
from lipwright.capture.takes import find_video
from lipwright.capture.video import read_pictures
from lipwright.dataset.recording import Recording
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from lipwright.face.head import Head
    from lipwright.face.shading import Camera

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

TILE: Final = 192  # px, even
VIEW: Final = 1.6  # eye distances across a tile: the mouth at its widest, and the chin
LOWER: Final = 0.14  # eye distances from the mouth's corners down to the middle of a tile
DISTANCE: Final = 0.65  # m from the camera to the lips of our head, as its view of the mouth has it
SMOOTHED: Final = 0.4  # s over which the head's place is averaged, so that the cut-out is steady


@dataclass(frozen=True, eq=False)
class RealMouth:
    """A tracked video.

    Raises:
        ValueError: the arrays are not of the same frames, or fps is not above 0.
    """

    video: Path
    head_pose: npt.NDArray[np.floating]
    """(T, 3, 4), as `Motion` has it; NaN where the face was lost"""
    landmarks: npt.NDArray[np.floating]
    """(T, 478, 3), as `Motion` has it"""
    fps: float
    """frames a second"""
    start: float
    """s, when the picture begins on the clock of the sound"""

    def __post_init__(self) -> None:
        """Check."""
        frames = len(self.head_pose)
        if not frames or self.head_pose.shape != (frames, 3, 4):
            raise ValueError(f"head_pose has the shape {self.head_pose.shape}, not (T, 3, 4)")
        if self.landmarks.ndim != 3 or len(self.landmarks) != frames:
            raise ValueError(f"landmarks have the shape {self.landmarks.shape}, not (T, 478, 3)")
        if not self.fps > 0:
            raise ValueError(f"fps is {self.fps}, not above 0")

    @property
    def duration(self) -> float:
        """s, all frames."""
        return len(self.head_pose) / self.fps


def real_mouth(recording: Recording, videos: Path | None = None) -> RealMouth | None:
    """The tracked video of a recording; None where it was not tracked from one.

    Args:
        recording: of a dataset.
        videos: where to look for the video by its name, in this folder and all below.
    """
    motion, source = recording.motion, recording.info.get("source")
    video = source.get("video") if isinstance(source, dict) else None
    if motion.landmarks is None or motion.head_pose is None or not isinstance(video, dict):
        return None
    if not motion.valid.any() or not isinstance(video.get("path"), str):
        return None
    try:
        path = find_video(recording, video, videos)
    except LipwrightError:  # it is gone: the tile says so
        path = Path(video["path"]).with_name("")
    return RealMouth(path, motion.head_pose, motion.landmarks, motion.fps, recording.start)


def real_tiles(real: RealMouth, times: Floats) -> Iterator[Picture]:
    """A picture (TILE, TILE, 3) of the mouth at each of `times`; none where the video is gone.

    The cut-out follows the head but not the mouth, which moves in it.

    Args:
        real: the tracked video.
        times: s, on the clock of the video.

    Raises:
        LipwrightError: the video is there and cannot be read.
    """
    if not real.video.is_file() or not np.isfinite(real.head_pose).all(axis=(1, 2)).any():
        return
    from lipwright.face.warp import opencv

    cv2: Any = opencv()
    frames = np.floor((times - real.start) * real.fps + 1e-6).astype(int)
    frames = frames.clip(0, len(real.head_pose) - 1)
    cuts = _cuts(real)
    pictures = read_pictures(real.video)
    held, last = -1, None
    for frame in frames.tolist():
        while held < frame:
            following = next(pictures, None)
            if following is None:
                break
            held, last = following
        if last is not None:
            yield np.asarray(
                cv2.warpAffine(last, cuts[frame], (TILE, TILE), flags=cv2.INTER_LINEAR), np.uint8
            )


def _cuts(real: RealMouth) -> Floats:
    """(T, 2, 3) from pixels of the video to pixels of a tile, without the head's roll."""
    known = np.isfinite(real.head_pose).all(axis=(1, 2))
    mouth = np.median(np.asarray(real.landmarks, float)[known][:, list(MOUTH)].mean(axis=1), axis=0)
    poses = np.asarray(real.head_pose, float)[known]
    centres = np.einsum("tij,j->ti", poses[:, :2, :3], mouth) + poses[:, :2, 3]
    sizes = np.sqrt((poses[:, :, :3] ** 2).sum(axis=(1, 2)) / 3)  # px an eye distance
    rolls = np.arctan2(poses[:, 1, 0], poses[:, 0, 0])
    frames = np.arange(len(known))
    columns = [
        _steady(np.interp(frames, frames[known], column), real.fps)
        for column in (centres[:, 0], centres[:, 1], np.log(sizes), np.unwrap(rolls))
    ]
    x, y, sizes, rolls = (*columns[:2], np.exp(columns[2]), columns[3])
    scale = TILE / (VIEW * sizes)
    cos, sin = scale * np.cos(rolls), scale * np.sin(rolls)
    turn = np.stack([np.stack([cos, sin], -1), np.stack([-sin, cos], -1)], -2)
    middle = np.array([TILE / 2, TILE / 2 - LOWER / VIEW * TILE])
    shift = middle - np.einsum("tij,tj->ti", turn, np.stack([x, y], -1))
    return np.concatenate([turn, shift[..., None]], axis=-1)


def _steady(values: Floats, fps: float) -> Floats:
    """A moving average, its ends held."""
    half = round(SMOOTHED * fps / 2)
    padded = np.pad(values, half, mode="edge")
    return np.convolve(padded, np.full(2 * half + 1, 1 / (2 * half + 1)), mode="valid")


def head_camera(head: Head) -> Camera:
    """A camera that shows as much of our head, in its eye distances, as a tile of the real one."""
    from lipwright.face.head_landmarks import named_points
    from lipwright.face.shading import Camera

    points = named_points()
    corners = [
        point.weights @ head.vertices[point.vertices]
        for point in (points["lipCornerLeft"], points["lipCornerRight"])
    ]
    _, height, depth = np.mean(corners, axis=0).tolist()
    middle = height - LOWER * head.eye_distance
    field = 2 * math.degrees(math.atan(VIEW * head.eye_distance / 2 / DISTANCE))
    return Camera((0.0, middle, depth + DISTANCE), (0.0, middle, depth), field)
