"""Face landmarks of every frame of a video.

The tracker looks at each frame by itself: its own video mode smooths over time, which makes
the lips 12 to 20 ms late and hides closures.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from lipwright.capture.face_landmarker import FaceLandmarker
from lipwright.capture.following import Face, Follower
from lipwright.capture.timing import Grid
from lipwright.capture.upright import Picture
from lipwright.capture.video import Video, open_video, read_frames
from lipwright.dataset.recording import LANDMARKS, Flag
from lipwright.errors import LipwrightError

Progress = Callable[[float], None]
"""called with the share of the video that is done, 0 to 1"""

CROWD_SHARE: Final = 0.05  # of the frames in which a second face may be
LOST_SHARE: Final = 0.5  # of the frames in which the face may be lost
_NAMED: Final = 3  # spans that a message names
_JOINED: Final = 0.2  # s; spans with less between them are named as one


class FaceTracker(Protocol):
    """A back end: finds faces in one picture."""

    name: str
    """as in `TRACKERS`"""

    @staticmethod
    def version() -> str:
        """Of the program and of its model, for the record."""

    @staticmethod
    def is_available() -> bool:
        """Whether it is installed."""

    def track_frame(self, picture: Picture) -> list[Face]:
        """The landmarks of each face, (478, 3) in pixels; z in the unit of x."""


@dataclass(frozen=True, eq=False)
class LandmarkTrack:
    """The landmarks of one video; frame i of T is at (i + 0.5) / fps s after its start."""

    points: npt.NDArray[np.float32]
    """(T, 478, 3), pixels of the upright picture, x to the right, y down, z away from the camera;
    NaN where lost or dropped; read-only"""
    fps: float
    """frames a second"""
    flags: npt.NDArray[np.uint8]
    """(T,), bits of `Flag`: LOST, DROPPED, CROWD; read-only"""
    size: tuple[int, int]
    """width and height of the upright picture"""
    start: float = 0.0
    """s from the first sample of the file's own sound to the video's start; 0 without sound"""

    def __post_init__(self) -> None:
        """Freeze."""
        self.points.setflags(write=False)
        self.flags.setflags(write=False)

    def __len__(self) -> int:
        """The number of frames, T."""
        return len(self.points)

    @property
    def tracked(self) -> npt.NDArray[np.bool_]:
        """(T,), whether a face was found."""
        return ~np.isnan(self.points[:, 0, 0])

    def has(self, flag: Flag) -> npt.NDArray[np.bool_]:
        """(T,), whether the flag is set."""
        return (self.flags & flag).astype(bool)


class Tracker(FaceLandmarker):
    """The default back end, with the whole way for one video."""

    def track_video(self, path: str | os.PathLike[str] | Video) -> LandmarkTrack:
        """The landmarks of every frame; as the function `track_video`."""
        return track_video(path, self)


TRACKERS: Final = MappingProxyType({Tracker.name: Tracker})
"""name to back end"""


@lru_cache(maxsize=1)
def get_tracker(name: str = Tracker.name) -> FaceTracker:
    """The back end of a name, loaded once in a process.

    Raises:
        LipwrightError: there is no such back end, or it is not installed.
    """
    if name not in TRACKERS:
        raise LipwrightError(f"no tracker {name!r}; choose {', '.join(sorted(TRACKERS))}")
    return TRACKERS[name]()


def track_video(
    path: str | os.PathLike[str] | Video,
    tracker: FaceTracker,
    progress: Progress = lambda share: None,
) -> LandmarkTrack:
    """The landmarks of the speaker in every frame of a video.

    Raises:
        LipwrightError: as `open_video` and `read_frames`.
    """
    video = path if isinstance(path, Video) else open_video(path)
    count = len(video.times)
    points = np.full((count, LANDMARKS, 3), np.nan, np.float32)
    flags = np.full(count, Flag.DROPPED, np.uint8)  # until it is decoded
    follower = Follower()
    for index, picture in read_frames(video):
        seen = follower.follow(tracker.track_frame(picture), float(video.times[index]))
        flags[index] = Flag.LOST if seen.face is None else 0
        if seen.face is not None:
            points[index] = seen.face
        if seen.is_crowd:
            flags[index] |= Flag.CROWD
        progress((index + 1) / count)
    return LandmarkTrack(
        video.grid.mean(points), video.fps, _flags_on_grid(video.grid, flags), video.size,
        video.start,
    )  # fmt: skip


def _flags_on_grid(grid: Grid, flags: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """(T,), from the flags (N,) of the frames; a frame made of two is lost if one of them is."""
    dropped = grid.dropped | grid.any((flags & Flag.DROPPED).astype(bool))
    lost = grid.any((flags & Flag.LOST).astype(bool)) & ~dropped
    crowd = grid.any((flags & Flag.CROWD).astype(bool))
    marks = dropped * Flag.DROPPED | lost * Flag.LOST | (crowd & ~lost & ~dropped) * Flag.CROWD
    return np.asarray(marks, np.uint8)


def check_faces(track: LandmarkTrack, path: str | os.PathLike[str]) -> None:
    """Refuse a video that does not show one speaker.

    Raises:
        LipwrightError: no face in more than half of the frames, or a second one in more than 5 %.
    """
    count = max(int((~track.has(Flag.DROPPED)).sum()), 1)
    lost = int(track.has(Flag.LOST).sum()) / count
    if lost > LOST_SHARE:
        raise LipwrightError(
            f"{path}: no face in {_percent(lost)} of the frames ({_spans(track, Flag.LOST)}); "
            "record one speaker from the front, with light on the face"
        )
    if int(track.has(Flag.CROWD).sum()) / count > CROWD_SHARE:
        raise LipwrightError(
            f"{path}: two faces {_spans(track, Flag.CROWD)}; record or crop one speaker"
        )


def face_warnings(track: LandmarkTrack) -> list[str]:
    """One line for each thing that the user should know of a video that is used all the same."""
    found = []
    for flag, what in (
        (Flag.LOST, "the face is lost"),
        (Flag.DROPPED, "the video has no frames"),
        (Flag.CROWD, "a second face is in the picture"),
    ):
        if track.has(flag).any():
            found.append(f"{what} {_spans(track, flag)}")
    return found


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share < 0.995 or share == 1 else "over 99 %"


def _spans(track: LandmarkTrack, flag: Flag) -> str:
    """Where the flag is set, as "from 0.4 to 2.9 s", the first few of many."""
    frames = np.flatnonzero(track.has(flag))
    breaks = np.flatnonzero(np.diff(frames) > _JOINED * track.fps)
    firsts = frames[np.concatenate([[0], breaks + 1])] / track.fps
    ends = (frames[np.concatenate([breaks, [len(frames) - 1]])] + 1) / track.fps
    named = [
        f"from {a:.2f} to {b:.2f} s" for a, b in zip(firsts[:_NAMED], ends[:_NAMED], strict=True)
    ]
    more = [f"{len(firsts) - _NAMED} more times"] if len(firsts) > _NAMED else []
    *most, final = named + more
    return f"{', '.join(most)} and {final}" if most else final
