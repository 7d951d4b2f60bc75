"""What is seen of a face, from a video or from a phone's own tracking, on a constant frame rate."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import aperture as aperture_of
from lipwright.controls import ARKIT, CANONICAL
from lipwright.dataset.recording import Flag, Motion
from lipwright.evaluate.lips import Aperture
from lipwright.face.head import load_head
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.capture.tracker import Progress
    from lipwright.capture.video import Video

Floats = npt.NDArray[np.float32]

MARGIN = 0.1  # s beside speech in which lips may already move


@dataclass(frozen=True, eq=False)
class Observation:
    """T frames of a face, before anything is known of what it says.

    Either landmarks with their apertures and the head's pose, or ARKit weights.
    """

    fps: float
    flags: npt.NDArray[np.uint8]
    """(T,), bits of `Flag`"""
    start: float = 0.0
    """s, when the picture begins on the clock of the sound"""
    warnings: tuple[str, ...] = ()
    tracker: str = ""
    """the back end and its version, or the app"""
    landmarks: Floats | None = None
    """(T, 478, 3), smoothed, in the head's frame"""
    landmarks_raw: Floats | None = None
    """(T, 478, 3), the same before smoothing"""
    head_pose: Floats | None = None
    """(T, 3, 4)"""
    aperture: Floats | None = None
    """(T,), smoothed"""
    aperture_raw: Floats | None = None
    """(T,)"""
    arkit: Floats | None = None
    """(T, 52), where a phone has solved them"""
    angles: Floats | None = None
    """(T, 9), rad"""
    video: Video | None = field(default=None, repr=False)
    """where the pictures are"""

    @property
    def duration(self) -> float:
        """s, all frames."""
        return len(self.flags) / self.fps

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """(T,), s, the middles of the frames since the picture began."""
        return np.asarray((np.arange(len(self.flags)) + 0.5) / self.fps, np.float64)

    def lips(self) -> Aperture | None:
        """The aperture on the clock of the sound; None if it is nowhere known."""
        values = head_aperture(self.arkit) if self.aperture is None else self.aperture
        if values is None or len(values) < 2 or np.isnan(values).all():
            return None
        times = self.times + self.start
        return Aperture(times, values.astype(np.float64))

    def to_motion(self, track: PhoneTrack, lag: float, *, tied: bool) -> Motion:
        """The motion with its ARKit weights.

        Args:
            track: what is said; the face at rest is taken from its silence.
            lag: by how much the picture is late against the track, s.
            tied: left and right move alike.

        Raises:
            LipwrightError: the head that the weights are solved on is not installed.
        """
        arkit = self.arkit if self.arkit is not None else self._solve(track, lag, tied)
        return Motion(
            self.fps, self.flags, arkit, self.landmarks, self.head_pose, self.aperture,
            self.aperture_raw, self.angles,
        )  # fmt: skip

    def _solve(self, track: PhoneTrack, lag: float, tied: bool) -> Floats:
        from lipwright.capture.solve import SolveOptions, neutral_face, solve_arkit

        assert self.landmarks is not None  # or else the phone has solved
        assert self.aperture is not None
        quiet = _is_silent(track, self.times - lag)
        rest = neutral_face(self.landmarks, self.aperture, quiet)
        return solve_arkit(
            self.landmarks, self.aperture, load_head(), self.fps, rest, SolveOptions(tied=tied)
        )


def _is_silent(track: PhoneTrack, times: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """(T,), whether nothing is said within `MARGIN` of each time."""
    silent = np.ones(len(times), bool)
    for phone, start, end in track:
        if phone != SILENCE:
            silent &= (times < start - MARGIN) | (times > end + MARGIN)
    return silent


def head_aperture(arkit: Floats | None) -> Floats | None:
    """(T,), the aperture of our head under the weights (T, 52); NaN where they are.

    Raises:
        LipwrightError: the head is not installed.
    """
    if arkit is None:
        return None
    weights = np.zeros((len(arkit), len(CANONICAL)), np.float32)
    weights[:, [CANONICAL.index(name) for name in ARKIT]] = arkit
    return np.asarray(load_head().aperture_curve(weights), np.float32)


def observe_video(path: Path, tracker: str, progress: Progress = lambda share: None) -> Observation:
    """The face of a video.

    Args:
        path: the video.
        tracker: the back end's name.
        progress: told which share of the video is tracked.

    Raises:
        MissingExtraError: the extra `capture` is not installed.
        LipwrightError: the video cannot be used, or does not show one speaker.
    """
    from lipwright.capture.blinks import find_blinks
    from lipwright.capture.pose import remove_pose, to_picture
    from lipwright.capture.smooth import smooth
    from lipwright.capture.tracker import (
        check_faces,
        face_warnings,
        get_tracker,
        track_video,
    )
    from lipwright.capture.video import open_video

    back_end = get_tracker(tracker)
    video = open_video(path)
    seen = track_video(video, back_end, progress)
    check_faces(seen, path)
    raw, head_pose = remove_pose(seen.points, seen.fps)
    landmarks = smooth(raw, seen.fps)
    flags = seen.flags | np.where(find_blinks(landmarks, seen.fps), np.uint8(Flag.BLINK), 0)
    return Observation(
        fps=seen.fps,
        flags=flags.astype(np.uint8),
        start=seen.start,
        warnings=tuple(f"{path}: {line}" for line in face_warnings(seen)),
        tracker=f"{back_end.name} {back_end.version()}",
        landmarks=landmarks,
        landmarks_raw=raw,
        head_pose=head_pose,
        aperture=aperture_of(to_picture(landmarks, head_pose)).astype(np.float32),
        aperture_raw=aperture_of(seen.points).astype(np.float32),
        video=video,
    )


def observe_arkit(path: Path, fps: float | None) -> Observation:
    """The weights of a Live Link Face recording or of another app.

    Raises:
        LipwrightError: the file cannot be used.
    """
    from lipwright.capture.arkit_import import read_arkit
    from lipwright.capture.arkit_motion import to_motion

    recording = read_arkit(path)
    motion = to_motion(recording, fps)
    return Observation(
        fps=motion.fps,
        flags=motion.flags,
        warnings=tuple(f"{path}: {note}" for note in recording.notes),
        tracker=recording.source,
        arkit=motion.arkit,
        angles=motion.angles,
    )


def with_own_sound(seen: Observation) -> Observation:
    """The same face with a sound of its own file, which starts with the picture."""
    return replace(seen, start=0.0)


def contact_picture(
    seen: Observation, motion: Motion, track: PhoneTrack, lag: float
) -> bytes | None:
    """The bytes of a contact sheet; None where there are no pictures.

    Raises:
        MissingExtraError: the extra `capture` is not installed.
        LipwrightError: the video has changed meanwhile.
    """
    from lipwright.capture.pictures import choose_frames, contact_sheet, sheet_frames
    from lipwright.capture.video import read_pictures

    if seen.video is None:
        return None
    chosen = choose_frames(motion, track, lag)
    pictures = dict(read_pictures(seen.video, chosen))
    return contact_sheet(sheet_frames(motion, track, lag, pictures)) if pictures else None
