"""Fewer and simpler outputs: one side of the face, no controls that nobody can predict.

Output space reduction and zero-centring of the thesis, section 4.2.2.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final, Literal

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT
from lipwright.dataset.transforms.sample import Random, Sample, Values

LEFT, RIGHT, SIDE = "Left", "Right", "Side"

# Table 4.1: what speech moves. Gaze is left out: eyeLookInLeft has its twin in eyeLookOutRight.
THESIS_CONTROLS: Final = tuple(
    name for name in ARKIT if name.startswith(("jaw", "mouth", "cheek", "noseSneer"))
)

# What the thesis removed after the merge (table 4.1, marked with asterisks).
THESIS_PRUNED: Final = ("jawSide", "mouthSide", "mouthFrownSide")


@dataclass(frozen=True)
class MergeSides:
    """Left and right become one: mouthSmileLeft and mouthSmileRight are mouthSmileSide.

    Undoing gives both sides the value of the one; without a record it splits all columns that end
    in "Side", left before right.
    """

    kind: ClassVar[str] = "merge-sides"
    keep: Literal["left", "mean"] = "left"
    """the left side, an arbitrary choice of the thesis, or the mean of both"""

    def __post_init__(self) -> None:
        """Check."""
        if self.keep not in ("left", "mean"):
            raise ValueError(f"keep is {self.keep!r}, not left or mean")

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, tuple[str, ...]]:
        """The sample with each pair as one column, where its first was; the old names."""
        columns: dict[str, Values] = {}
        for name in sample.names:
            merged = side_name(name, sample.names)
            if merged in columns:
                continue
            if merged != name and merged in sample.names:
                raise ValueError(f"there is a column {merged!r} already")
            columns[merged] = self._merged(sample, name, merged)
        values = np.stack(tuple(columns.values()), axis=1)
        return replace(sample, names=tuple(columns), values=values), sample.names

    def invert(self, sample: Sample, record: tuple[str, ...] | None = None) -> Sample:
        """Both sides with the value of the one."""
        names = record if record is not None else tuple(_split(sample.names))
        sources = [sample.names.index(side_name(name, names)) for name in names]
        return replace(sample, names=names, values=sample.values[:, sources])

    def _merged(self, sample: Sample, name: str, merged: str) -> Values:
        if merged == name:
            return sample.values[:, sample.names.index(name)]
        stem = merged.removesuffix(SIDE)
        left, right = (sample.values[:, sample.names.index(stem + s)] for s in (LEFT, RIGHT))
        return left if self.keep == "left" else (left + right) * np.float32(0.5)


def side_name(name: str, names: Sequence[str]) -> str:
    """The column that `name` merges into among `names`; itself where it has no other side."""
    for side, other in ((LEFT, RIGHT), (RIGHT, LEFT)):
        stem = name.removesuffix(side)
        if stem != name and stem + other in names:
            return stem + SIDE
    return name


def _split(names: Iterable[str]) -> Iterable[str]:
    for name in names:
        stem = name.removesuffix(SIDE)
        yield from (name,) if stem == name else (stem + LEFT, stem + RIGHT)


@dataclass(frozen=True)
class Prune:
    """Some columns are left out; undoing puts them back at rest, or at a mean that is given."""

    kind: ClassVar[str] = "prune"
    names: tuple[str, ...]
    """columns to leave out, those that a sample lacks are passed over"""
    at: tuple[float, ...] = ()
    """what each is put back at; () for 0, the rest pose"""

    def __post_init__(self) -> None:
        """Check."""
        at = tuple(float(value) for value in self.at) or (0.0,) * len(self.names)
        if isinstance(self.names, str) or len(set(self.names)) != len(self.names):
            raise ValueError(f"names are {self.names!r}, not a row of names, each once")
        if len(at) != len(self.names) or not np.isfinite(at).all():
            raise ValueError(f"{len(at)} values for {len(self.names)} names, or not finite ones")
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "at", at)

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, tuple[str, ...]]:
        """The sample without them; the old names."""
        kept = [i for i, name in enumerate(sample.names) if name not in self.names]
        names = tuple(sample.names[i] for i in kept)
        return replace(sample, names=names, values=sample.values[:, kept]), sample.names

    def invert(self, sample: Sample, record: tuple[str, ...] | None = None) -> Sample:
        """The columns put back, at the end where no record says the order."""
        names = record if record is not None else sample.names + self.names
        back = dict(zip(self.names, self.at, strict=True))
        values = np.empty((len(sample), len(names)), np.float32)
        for column, name in enumerate(names):
            if name in sample.names:
                values[:, column] = sample.values[:, sample.names.index(name)]
            else:
                values[:, column] = np.where(sample.seen, back[name], np.nan)
        return replace(sample, names=names, values=values)


def smape(reference: npt.ArrayLike, estimated: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """(C,), the symmetric mean absolute percentage error of each column of (T, C), as a share.

    The mean over the frames of |e - r| / ((|r| + |e|) / 2): 0 where they agree, 2 where one of
    them is at rest throughout. A frame with both at rest counts as 0, a frame without a face not
    at all; a column without frames is NaN.

    Raises:
        ValueError: the shapes differ, or are not (T, C).
    """
    r, e = np.asarray(reference, np.float64), np.asarray(estimated, np.float64)
    if r.ndim != 2 or r.shape != e.shape:
        raise ValueError(f"shapes {r.shape} and {e.shape}, not (T, C) both")
    seen = np.isfinite(r) & np.isfinite(e)
    size = np.where(seen, (np.abs(r) + np.abs(e)) / 2, 0.0)
    gap = np.where(seen, np.abs(e - r), 0.0)
    error = np.divide(gap, size, out=np.zeros_like(gap), where=size > 0)
    frames = seen.sum(axis=0).astype(np.float64)
    return np.divide(error.sum(axis=0), frames, out=np.full(len(frames), np.nan), where=frames > 0)


def unpredictable(
    names: Sequence[str], train: npt.ArrayLike, validation: npt.ArrayLike, threshold: float
) -> tuple[str, ...]:
    """The columns whose error (C,), as `smape` gives it, is over `threshold` in both splits.

    The thesis chose them by eye from a plot of both errors and gives no threshold.

    Raises:
        ValueError: the errors are not one for each name.
    """
    both = [np.asarray(errors, np.float64) for errors in (train, validation)]
    if any(errors.shape != (len(names),) for errors in both):
        raise ValueError(f"errors have the shapes {[e.shape for e in both]}, not ({len(names)},)")
    least = np.minimum(*both)
    return tuple(name for name, error in zip(names, least, strict=True) if error > threshold)


@dataclass(frozen=True)
class ZeroCentre:
    """First and last frame become zero: the line between their poses is taken off.

    x_f - (f / (n - 1) x_(n-1) + (1 - f / (n - 1)) x_0), section 4.2.2. Where the first or last
    frames show no face, the line runs between the first and the last that do. Undoing adds the
    line back; without a record it starts and ends at rest.
    """

    kind: ClassVar[str] = "zero-centre"

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, Values]:
        """The sample without its line; the first and last pose, (2, C)."""
        seen = np.flatnonzero(sample.seen)
        ends = sample.values[seen[[0, -1]]] if len(seen) else np.zeros_like(sample.values[[0, 0]])
        ends.setflags(write=False)
        return sample.with_values(sample.values - _line(sample, ends)), ends

    def invert(self, sample: Sample, record: npt.ArrayLike | None = None) -> Sample:
        """The sample with the line between the poses of `record`, (2, C)."""
        if record is None:
            return sample
        return sample.with_values(sample.values + _line(sample, np.asarray(record, np.float32)))


def _line(sample: Sample, ends: Values) -> npt.NDArray[np.float64]:
    """(T, C), straight from the first to the last pose."""
    if ends.shape != (2, len(sample.names)):
        raise ValueError(f"ends have the shape {ends.shape}, not (2, {len(sample.names)})")
    seen = np.flatnonzero(sample.seen)
    first, last = (seen[0], seen[-1]) if len(seen) else (0, 0)
    # One frame is both ends: its pose counts whole.
    share = (np.arange(len(sample)) - first) / max(last - first, 1)
    return share[:, None] * ends[1].astype(np.float64) + (1 - share[:, None]) * ends[0]
