"""Which of the faces in a picture is the speaker's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.landmarks import eye_centres, eye_distance

Face = npt.NDArray[np.float32]
"""(478, 3), pixels, x to the right, y down, z away from the camera in the same unit"""

# A head that is thrown about moves by 3 m/s, 2 eye distances in 1/25 s.
MOST_MOVED: Final = 2.0  # eye distances that a face may move in 1/25 s
MOST_GROWN: Final = 1.5  # times that its size may change in 1/25 s
MOVING_TIME: Final = 1 / 25  # s
SECOND_SIZE: Final = 0.4  # of the speaker's eye distance, from which on a face is a second one


@dataclass(frozen=True, eq=False)
class Seen:
    """What one picture shows."""

    face: Face | None
    """the speaker's, or None where it is lost"""
    is_crowd: bool
    """whether there is a second face"""


class Follower:
    """Picks the speaker's face from picture to picture, beginning with the largest.

    A face that jumps or changes its size as no head can is not the speaker's. What is possible
    grows with the time since the speaker was last seen, so that after a cut the next face is
    taken up again in a few frames, and a single wrong detection is not.
    """

    def __init__(self) -> None:
        """Nothing seen yet."""
        self._last: Face | None = None
        self._time = 0.0

    def follow(self, faces: Sequence[Face], time: float) -> Seen:
        """The speaker among the faces of the picture at `time` s, which rises from call to call."""
        sound = [face for face in faces if np.isfinite(face).all() and eye_distance(face) > 0]
        sound.sort(key=_size, reverse=True)
        if self._last is not None:
            waited = (time - self._time) / MOVING_TIME
            sound.sort(key=self._moved)
            face = next((face for face in sound if self._is_possible(face, waited)), None)
        else:
            face = sound[0] if sound else None
        if face is None:
            return Seen(None, False)
        self._last, self._time = face, time
        others = [other for other in sound if other is not face]
        return Seen(face, any(_is_second(other, face) for other in others))

    def _moved(self, face: Face) -> float:
        assert self._last is not None
        way = eye_centres(face).mean(0)[:2] - eye_centres(self._last).mean(0)[:2]
        return float(np.linalg.norm(way)) / _size(self._last)

    def _is_possible(self, face: Face, waited: float) -> bool:
        assert self._last is not None
        growth = abs(np.log(_size(face) / _size(self._last)))
        return self._moved(face) <= MOST_MOVED * max(waited, 1) and bool(
            growth <= np.log(MOST_GROWN) * max(waited, 1)
        )


def _size(face: Face) -> float:
    """The eyes' distance in depth as well, which turning the head does not shorten."""
    left, right = eye_centres(face)
    return float(np.linalg.norm(right - left))


def _is_second(other: Face, face: Face) -> bool:
    """Whether it is large enough, and not the same face found twice."""
    if _size(other) < SECOND_SIZE * _size(face):
        return False
    low = np.maximum(other[:, :2].min(0), face[:, :2].min(0))
    high = np.minimum(other[:, :2].max(0), face[:, :2].max(0))
    return bool((high <= low).any())
