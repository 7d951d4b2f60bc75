"""`Take`: what the reference face needs of a recording, its vertices and its pictures."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lipwright.capture.pose import to_picture
from lipwright.capture.video import read_pictures
from lipwright.dataset.folder import sha256_of
from lipwright.dataset.recording import INFO_FILE, Recording
from lipwright.errors import LipwrightError
from lipwright.face.reference import VISIBLE
from lipwright.face.vertices import LANDMARKS, aperture

Floats = npt.NDArray[np.float32]
Picture = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Take:
    """The 34 vertices of one recording over its T frames, and its video."""

    name: str
    split: str
    """train, validation or test"""
    points: Floats
    """(T, 34, 3) eye distances, without the head's pose; NaN where lost"""
    head_pose: Floats
    """(T, 3, 4), pixels (x, y, z) = head_pose @ (point, 1); NaN where lost"""
    video: Path

    def __len__(self) -> int:
        """The number of frames, T."""
        return len(self.points)

    @cached_property
    def at(self) -> Floats:
        """(T, 34, 2) pixels, the points in the picture."""
        return to_picture(self.points, self.head_pose)[..., :2]

    @cached_property
    def unit(self) -> Floats:
        """(T,) pixels an eye distance."""
        # Depth is in pixels too, so that turning the head does not shorten the axis.
        return np.asarray(np.linalg.norm(self.head_pose[..., 0], axis=-1))

    @property
    def shapes(self) -> Floats:
        """(T, 34, 2), the points seen from the front."""
        return self.points[..., :2]

    @property
    def valid(self) -> npt.NDArray[np.bool_]:
        """(T,), where a face was seen."""
        return np.asarray(np.isfinite(self.unit))

    @property
    def visible(self) -> npt.NDArray[np.bool_]:
        """(T,), where the inner mouth is seen."""
        return np.asarray(self.valid & (np.nan_to_num(aperture(self.shapes)) >= VISIBLE))

    def pictures(self, wanted: Collection[int] | None = None) -> Iterator[tuple[int, Picture]]:
        """Index and picture of the frames, or of those wanted, in which a face was seen.

        Raises:
            LipwrightError: the video cannot be read.
        """
        for index, picture in read_pictures(self.video, wanted):
            if index < len(self) and self.valid[index]:
                yield index, picture


def make_take(recording: Recording, split: str, videos: Path | None = None) -> Take | None:
    """The take of a recording; None where it has no landmarks or came without a video.

    Raises:
        LipwrightError: its video is missing or has changed.
    """
    motion = recording.motion
    if motion.landmarks is None or motion.head_pose is None:
        return None
    source = _video_source(recording)
    if source is None:
        return None
    points = motion.landmarks[:, LANDMARKS]
    return Take(
        recording.name, split, points, motion.head_pose, find_video(recording, source, videos)
    )


def _video_source(recording: Recording) -> dict[str, Any] | None:
    source = recording.info.get("source")
    video = source.get("video") if isinstance(source, dict) else None
    if not isinstance(video, dict) or not isinstance(video.get("path"), str):
        return None
    return video


def find_video(recording: Recording, source: dict[str, Any], videos: Path | None = None) -> Path:
    """The video that a recording was captured from, with the same bytes.

    Args:
        recording: of a dataset.
        source: path and sha256, as recording.json has them.
        videos: where to look for the file by its name, in this folder and all below.

    Raises:
        LipwrightError: it is missing, or another file lies in its place.
    """
    path, sha256 = Path(source["path"]), source.get("sha256")
    places = [path] if videos is None else _files_below(videos).get(path.name, [])
    changed = None
    for place in places:
        if place.is_file():
            if sha256 is None or sha256_of(place) == sha256:
                return place
            changed = place
    info = recording.folder / INFO_FILE
    if changed is not None:
        raise LipwrightError(
            f"{changed}: not the video that {info} was captured from; capture it again, or name "
            "the folder of the right one with --videos"
        )
    where = f"{path} does not exist" if videos is None else f"{path.name} is nowhere in {videos}"
    raise LipwrightError(f"{info}: its video {where}; name its folder with --videos")


@lru_cache(maxsize=1)
def _files_below(folder: Path) -> dict[str, list[Path]]:
    """File name to its places in a folder and all below."""
    found: dict[str, list[Path]] = {}
    for path in sorted(folder.rglob("*")):
        found.setdefault(path.name, []).append(path)
    return found
