"""The reference face laid over the video of a recording, as in Taylor et al. 2017, figure 7."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Audio, open_audio
from lipwright.capture.pixels import take_parameters
from lipwright.capture.pose import to_picture
from lipwright.capture.takes import Take
from lipwright.capture.video import open_video, read_pictures
from lipwright.clip import Clip
from lipwright.dataset.recording import Recording
from lipwright.errors import LipwrightError
from lipwright.export.mp4 import encode
from lipwright.export.performance import ExportOptions
from lipwright.face.faceclip import clip_to_parameters
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.vertices import N
from lipwright.face.warp import opencv
from lipwright.files import write_whole

Picture = npt.NDArray[np.uint8]
Light = npt.NDArray[np.float32]
Report = Callable[[int, int], None]

FEATHER: Final = 0.2  # eye distances over which the model passes into the video
LEAST_HEIGHT: Final = 480  # px; lower videos are enlarged by a whole number
MOST_WIDTH: Final = 2048  # px of one picture; wider videos are shrunk


def own_parameters(face: ReferenceFace, take: Take) -> tuple[FaceParameters, Light]:
    """The parameters (T, ...) of a take by this model, and its light (3,).

    Raises:
        LipwrightError: its video cannot be read.
    """
    regions = {"inner": face.inner, "outer": face.outer}
    return take_parameters(take, face.project_shape, regions)


def parameters_at_frames(face: ReferenceFace, recording: Recording, clip: Clip) -> FaceParameters:
    """The parameters of a clip of modes of the face at a recording's frames.

    Raises:
        LipwrightError: the clip has controls that are no modes of the face.
    """
    return clip_to_parameters(face, Clip(clip.names, clip.fps, clip.at(recording.times)))


def lay_over(
    face: ReferenceFace, picture: Picture, parameters: FaceParameters,
    points: npt.NDArray[np.floating], unit: float, light: Light,
) -> Picture:  # fmt: skip
    """A picture with the model's lower face in it.

    Args:
        face: the model.
        picture: (H, W, 3) sRGB.
        parameters: of one frame.
        points: (34, 2) pixels, where the vertices are to lie.
        unit: pixels an eye distance.
        light: of the recording, (3,).
    """
    height, width = picture.shape[:2]
    drawn, covered = face.draw(parameters, points, (width, height), light)
    cv2 = opencv()
    inwards = cv2.distanceTransform(covered.astype(np.uint8), cv2.DIST_L2, 5)
    share = np.clip(inwards / max(FEATHER * unit, 1.0), 0, 1)
    share = (share * share * (3 - 2 * share))[..., None]  # without an edge where it starts or ends
    return np.asarray(np.rint(share * drawn + (1 - share) * picture), np.uint8)


def overlay_pictures(
    face: ReferenceFace, take: Take, parameters: FaceParameters, light: Light
) -> Iterator[Picture]:
    """For each frame of the video, the video and beside it the same with the model laid over.

    Frames without a face show the video twice; frames that the video lacks show the last one.
    """
    known = np.isfinite(parameters.outer).all(axis=1) & take.valid
    depth = np.broadcast_to(face.depth[:, None], (len(take), N, 1))
    guessed = np.concatenate([face.points(parameters.shape), depth], -1)
    at = to_picture(guessed, take.head_pose)[..., :2]
    last: Picture | None = None
    done = 0
    for frame, picture in read_pictures(take.video):
        while last is not None and done < frame:
            yield last
            done += 1
        size, scale = shown_size((picture.shape[1], picture.shape[0]))
        original = opencv().resize(picture, size, interpolation=opencv().INTER_CUBIC)
        made = original
        if frame < len(take) and known[frame]:
            unit = float(take.unit[frame]) * scale
            made = lay_over(face, original, parameters[frame], at[frame] * scale, unit, light)
        last = np.hstack([original, made])
        yield last
        done = frame + 1


def shown_size(size: tuple[int, int]) -> tuple[tuple[int, int], float]:
    """Even width and height at which pictures of a size are shown, and how much larger that is."""
    width, height = size
    scale = float(max(math.ceil(LEAST_HEIGHT / height), 1))
    scale = min(scale, MOST_WIDTH / width)
    return (round(width * scale / 2) * 2, round(height * scale / 2) * 2), scale


def write_overlay(
    path: Path, face: ReferenceFace, recording: Recording, take: Take, parameters: FaceParameters,
    light: Light, report: Report | None = None,
) -> int:  # fmt: skip
    """Write an MP4 of the video, the model laid over it, and the sound; the number of frames.

    Raises:
        LipwrightError: the video or the sound cannot be read, or the MP4 not written.
    """
    import av

    video, count = open_video(take.video), 0
    (width, height), _ = shown_size(video.size)

    def pictures() -> Generator[Picture, None, None]:
        nonlocal count
        for picture in overlay_pictures(face, take, parameters, light):
            yield picture
            count += 1
            if report is not None:
                report(count, len(take))

    options = ExportOptions(size=(2 * width, height), title=recording.name)
    sound = _sound_of_picture(recording)
    with write_whole(path) as part:
        try:
            encode(part, pictures(), recording.motion.fps, options, sound)
        except av.FFmpegError as error:
            raise LipwrightError(f"{path}: cannot be encoded: {error.strerror}") from error
    return count


def _sound_of_picture(recording: Recording) -> Audio | None:
    """The sound from the first frame's start on, as long as the picture."""
    if recording.audio is None:
        return None
    motion = recording.motion
    start = float(recording.times[0]) - 0.5 / motion.fps
    with open_audio(recording.audio) as file:
        heard = file.read(start, max(start + motion.duration, start))
        silence = np.zeros(round(max(-start, 0) * file.rate), np.float32)
        return Audio(np.concatenate([silence, heard.samples]), file.rate)
