"""Other frames: another rate, a shift by less than a frame, frames put in and taken out.

Sections 4.2.1 (rate) and 4.2.2 (data augmentation) of the thesis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from lipwright.dataset.transforms.sample import Random, Sample, Values


@dataclass(frozen=True)
class OwnFrames:
    """The frames of a sample before it was resampled."""

    fps: float
    """frames a second"""
    phones: tuple[str, ...]
    """T labels"""


@dataclass(frozen=True)
class Resample:
    """Another frame rate, linear between frames; the first frame keeps its time.

    Of 60 frames a second every other is one of 30. Undoing brings back the rate, the phones and
    the frames that both share exactly, the rest on straight lines; without a record it does
    nothing.
    """

    kind: ClassVar[str] = "resample"
    fps: float = 30.0
    """frames a second, section 4.2.1"""

    def __post_init__(self) -> None:
        """Check."""
        if not 0 < self.fps < math.inf:
            raise ValueError(f"fps is {self.fps}, not above 0")

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, OwnFrames]:
        """The sample at the new rate, within its own time; the old frames."""
        count = math.floor((len(sample) - 1) / sample.fps * self.fps + 1e-6) + 1
        position = np.arange(count) * (sample.fps / self.fps)
        changed = replace(
            sample,
            values=sample.at(position),
            phones=sample.phones_at(position),
            fps=self.fps,
        )
        return changed, OwnFrames(sample.fps, sample.phones)

    def invert(self, sample: Sample, record: OwnFrames | None = None) -> Sample:
        """The sample at the old rate; past its last frame the pose is held."""
        if record is None:
            return sample
        position = np.arange(len(record.phones)) * (sample.fps / record.fps)
        values = sample.at(position)
        return replace(sample, values=values, phones=record.phones, fps=record.fps)


@dataclass(frozen=True)
class TimeShift:
    """The poses a random part of a frame earlier or later, linear between frames.

    After Karras et al. 2017; each frame keeps its phone. Undoing shifts back, which is exact on
    straight lines and else smooths by w (1 - w) times the second difference, for a shift by w.
    """

    kind: ClassVar[str] = "time-shift"
    most: float = 0.5
    """frames, section 4.2.2"""

    def __post_init__(self) -> None:
        """Check."""
        if not 0 <= self.most <= 0.5:
            raise ValueError(f"most is {self.most}, not from 0 to 0.5 frames")

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, float | None]:
        """The shifted sample, and the shift in frames."""
        if random is None:
            return sample, None
        shift = float(random.uniform(-self.most, self.most))
        return _shifted(sample, shift), shift

    def invert(self, sample: Sample, record: float | None = None) -> Sample:
        """The sample shifted back."""
        return sample if record is None else _shifted(sample, -record)


def _shifted(sample: Sample, shift: float) -> Sample:
    return sample.with_values(sample.at(np.arange(len(sample)) + shift))


@dataclass(frozen=True, eq=False)
class Edit:
    """One frame put in or taken out."""

    frame: int
    """its index in the sample with it"""
    phone: str
    """of the frame"""
    rows: Values | None
    """(3, C), of a frame that was taken out: it and its neighbours before; None if it was put in"""


@dataclass(frozen=True)
class EditFrames:
    """Frames put in and taken out at random, inside of a phone only.

    A frame that is put in is the mean of its neighbours, which have the same phone. A frame that
    is taken out leaves half of itself in both neighbours: y = 0.5 y + 0.5 y_i; never the first or
    the last, and only between frames of its own phone, so that no phone is lost. Undoing brings
    back what the record holds, exactly; without a record it does nothing.
    """

    kind: ClassVar[str] = "edit-frames"
    insert: float = 0.05
    """probability for each pair of neighbours"""
    remove: float = 0.05
    """probability for each frame"""

    def __post_init__(self) -> None:
        """Check."""
        if not 0 <= min(self.insert, self.remove) <= self.insert + self.remove <= 1:
            raise ValueError(
                f"probabilities {self.insert} and {self.remove} are not from 0 to 1 together"
            )

    def apply(
        self, sample: Sample, random: Random | None = None
    ) -> tuple[Sample, tuple[Edit, ...]]:
        """The edited sample, and its edits in the order in which they were made."""
        edits: list[Edit] = []
        if random is None:
            return sample, ()
        rows, phones = list(sample.values), list(sample.phones)
        frame = 0
        for draw in random.random(len(sample)):
            if draw < self.insert and _may_insert(rows, phones, frame):
                edits.append(_insert(rows, phones, frame + 1))
                frame += 1
            elif draw >= 1 - self.remove and _may_remove(rows, phones, frame):
                edits.append(_remove(rows, phones, frame))
                frame -= 1
            frame += 1
        return replace(sample, values=np.stack(rows), phones=tuple(phones)), tuple(edits)

    def invert(self, sample: Sample, record: tuple[Edit, ...] | None = None) -> Sample:
        """The sample before the edits."""
        rows, phones = list(sample.values), list(sample.phones)
        for edit in reversed(record or ()):
            if edit.rows is None:
                del rows[edit.frame], phones[edit.frame]
            else:
                rows[edit.frame - 1 : edit.frame + 1] = list(edit.rows)
                phones.insert(edit.frame, edit.phone)
        return replace(sample, values=np.stack(rows), phones=tuple(phones))


def _seen(rows: list[Values]) -> bool:
    return bool(np.isfinite(rows).all())


def _may_insert(rows: list[Values], phones: list[str], frame: int) -> bool:
    """Whether a frame may come after `frame`."""
    around = slice(frame, frame + 2)
    return frame + 1 < len(rows) and len(set(phones[around])) == 1 and _seen(rows[around])


def _may_remove(rows: list[Values], phones: list[str], frame: int) -> bool:
    around = slice(frame - 1, frame + 2)
    inside = 0 < frame < len(rows) - 1
    return inside and len(set(phones[around])) == 1 and _seen(rows[around])


def _insert(rows: list[Values], phones: list[str], frame: int) -> Edit:
    rows.insert(frame, 0.5 * rows[frame - 1] + 0.5 * rows[frame])
    phones.insert(frame, phones[frame - 1])
    return Edit(frame, phones[frame], None)


def _remove(rows: list[Values], phones: list[str], frame: int) -> Edit:
    before = np.stack(rows[frame - 1 : frame + 2])
    before.setflags(write=False)
    edit = Edit(frame, phones[frame], before)
    rows[frame - 1] = 0.5 * before[0] + 0.5 * before[1]
    rows[frame + 1] = 0.5 * before[2] + 0.5 * before[1]
    del rows[frame], phones[frame]
    return edit
