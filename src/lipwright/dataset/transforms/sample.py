"""`Sample`: what a network learns from, and what a transform of it looks like."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT
from lipwright.dataset.recording import Recording
from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

Values = npt.NDArray[np.float32]
Random = np.random.Generator


@dataclass(frozen=True, eq=False)
class Sample:
    """C numbers a frame, and the phone said in it; frame i of T is at start + i / fps s.

    A frame in which no face was seen is NaN in all columns.

    Raises:
        ValueError: names repeat, shapes do not match, or fps or start is no usable number.
    """

    names: tuple[str, ...]
    """C columns, each once"""
    values: Values
    """(T, C), T at least 1; read-only"""
    phones: tuple[str, ...]
    """T labels, of any alphabet"""
    fps: float
    """frames a second"""
    start: float = 0.0
    """s, the time of the first frame"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        names, phones = tuple(self.names), tuple(self.phones)
        values = np.array(self.values, np.float32)  # a copy: ours to freeze
        if len(set(names)) != len(names):
            raise ValueError("names of columns repeat")
        if values.ndim != 2 or values.shape[1] != len(names) or not len(values):
            raise ValueError(f"values have the shape {values.shape}, not (T, {len(names)}), T > 0")
        if len(phones) != len(values):
            raise ValueError(f"{len(phones)} phones for {len(values)} frames")
        if not (0 < self.fps < np.inf and np.isfinite(self.start)):
            raise ValueError(f"fps {self.fps} or start {self.start} is no usable number")
        values.setflags(write=False)
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "phones", phones)
        object.__setattr__(self, "values", values)

    def __len__(self) -> int:
        """The number of frames, T."""
        return len(self.values)

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """(T,) in s."""
        return self.start + np.arange(len(self), dtype=np.float64) / self.fps

    @property
    def seen(self) -> npt.NDArray[np.bool_]:
        """(T,), frames with numbers in all columns."""
        return np.asarray(np.isfinite(self.values).all(axis=1))

    def select(self, names: Iterable[str]) -> Sample:
        """The named columns, in that order.

        Raises:
            ValueError: there is no such column.
        """
        names = tuple(names)
        if missing := set(names) - set(self.names):
            raise ValueError(f"there is no column {', '.join(sorted(missing))}")
        columns = [self.names.index(name) for name in names]
        return replace(self, names=names, values=self.values[:, columns])

    def with_values(self, values: npt.ArrayLike) -> Sample:
        """The same frames with other values, (T, C)."""
        return replace(self, values=np.asarray(values, np.float32))

    def at(self, position: npt.ArrayLike) -> Values:
        """(N, C), linear between frames at `position` (N,) in frames, held outside.

        Only frames that count are asked: a frame without a face spoils no frame that it does not
        touch.
        """
        place = np.clip(np.asarray(position, np.float64), 0, len(self) - 1)
        nearest = np.rint(place)
        place = np.where(np.abs(place - nearest) < 1e-6, nearest, place)  # rounding of times
        low = np.floor(place).astype(np.int64)
        high = np.minimum(low + 1, len(self) - 1)
        weight = (place - low)[:, None]
        mixed = (1 - weight) * self.values[low] + weight * self.values[high]
        return np.where(weight == 0, self.values[low], mixed).astype(np.float32)

    def phones_at(self, position: npt.ArrayLike) -> tuple[str, ...]:
        """The phone of the frame nearest to each of `position` (N,), in frames."""
        place = np.ceil(np.asarray(position, np.float64) - 0.5 - 1e-6)  # between two: the earlier
        return tuple(self.phones[int(i)] for i in np.clip(place, 0, len(self) - 1))


class Transform(Protocol):
    """A change of samples that can be undone.

    A record holds what undoing needs and the transform does not know beforehand. Without it, as
    for the output of a network, `invert` does what its class says.
    """

    kind: ClassVar[str]
    """its name in JSON"""

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, Any]:
        """The changed sample, and the record of it.

        A transform that draws lots changes nothing without a generator: so do validation and test.
        """
        ...

    def invert(self, sample: Sample, record: Any = None) -> Sample:
        """The sample before the change."""
        ...


def phones_in(track: PhoneTrack, times: npt.ArrayLike) -> tuple[str, ...]:
    """The phone of a track at each of `times` (N,) in s; silence outside of the track."""
    index = np.searchsorted(track.edges, np.asarray(times, np.float64), side="right") - 1
    return tuple(track.phones[i] if 0 <= i < len(track) else SILENCE for i in index)


def sample_of(recording: Recording, part: str = "arkit") -> Sample:
    """What the face of a recording did, with the phone in the middle of each frame.

    Args:
        recording: the recording.
        part: `arkit` for the weights, or an array of face.npz: `shape`, `inner`, `outer`, `joint`.

    Raises:
        LipwrightError: the recording has no such part.
    """
    motion, times = recording.motion, recording.times
    names, values = ARKIT, motion.arkit
    if part != "arkit":
        values = (recording.face() or {}).get(part, np.empty(0, np.float32))
        if values.ndim != 2 or len(values) != len(motion):
            raise LipwrightError(
                f"{recording.folder}: has no {part!r} parameters; run: lipwright face fit"
            )
        names = tuple(f"{part}{mode}" for mode in range(values.shape[1]))
    return Sample(names, values, phones_in(recording.track, times), motion.fps, float(times[0]))
