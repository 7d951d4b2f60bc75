"""`ArkitRecording`: the weights that a phone recorded, with the times that it wrote."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import MAX_FPS
from lipwright.controls import ARKIT
from lipwright.errors import LipwrightError
from lipwright.export.arkit_names import ANGLES, NameMatch

USUAL_FPS: Final = (
    24000 / 1001, 24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 100.0, 120.0,
)  # fmt: skip
FPS_TOLERANCE: Final = 0.005  # share by which a phone's clock may miss a usual rate
MAX_BACKWARDS: Final = 0.1  # s; frames that far out of order are sorted, more is another take
MAX_GAP: Final = 60.0  # s without a frame; more is another take
MAX_SPAN: Final = 6 * 3600.0  # s; phones are full or empty before
LOWEST, HIGHEST = -1.0, 2.0  # a weight beyond is a slip or another scale
FULL_PERCENT: Final = 110.0  # the largest weight of a file in percent, with some overshoot
SMALLEST_STEP: Final = 1e-6  # s; frames closer together are the same frame
FULL_TURN: Final = 2 * math.pi  # rad; a larger angle of the head is in degrees
MAX_DEGREES: Final = 360.0


@dataclass(frozen=True, eq=False)
class ArkitRecording:
    """Weights of T frames as a phone recorded them.

    Raises:
        ValueError: the shapes do not match, the times do not rise, or no frame is valid.
    """

    fps: float
    """frames a second of the phone"""
    times: npt.NDArray[np.float64]
    """(T,), s as in the file (time codes: from midnight), rising; a missing frame leaves a gap"""
    values: npt.NDArray[np.float32]
    """(T, 52), 0 to 1, in the order of `controls.ARKIT`; NaN in frames without a face"""
    angles: npt.NDArray[np.float32] | None = None
    """(T, 9), rad: yaw, pitch and roll of the head, of the left eye, of the right eye"""
    timecode: str = ""
    """the time code of the first frame, as the file writes it"""
    source: str = ""
    """the app or layout"""
    notes: tuple[str, ...] = ()
    """what was assumed, repaired or left out, for people"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        times = np.array(self.times, np.float64)
        values = np.array(self.values, np.float32)
        if times.ndim != 1 or len(times) < 2 or values.shape != (len(times), len(ARKIT)):
            raise ValueError(f"times {times.shape} and values {values.shape} do not match")
        if not (np.diff(times) > 0).all() or not 0 < self.fps <= MAX_FPS:
            raise ValueError("times do not rise, or fps is out of range")
        if np.isnan(values).any(axis=1).all():
            raise ValueError("no frame is valid")
        angles = None if self.angles is None else np.array(self.angles, np.float32)
        if angles is not None and angles.shape != (len(times), len(ANGLES)):
            raise ValueError(f"angles {angles.shape} do not match")
        for name, array in (("times", times), ("values", values), ("angles", angles)):
            if array is None:
                continue
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        """The number of frames in the file, T."""
        return len(self.times)

    @property
    def valid(self) -> npt.NDArray[np.bool_]:
        """(T,), where a face was seen."""
        return np.asarray(np.isfinite(self.values).all(axis=1))

    @property
    def duration(self) -> float:
        """In s, from the start of the first frame to the end of the last."""
        return float(self.times[-1] - self.times[0]) + 1 / self.fps


@dataclass(frozen=True, eq=False)
class FrameTable:
    """The frames of a file as they stand in it, T rows of D known columns."""

    match: NameMatch
    """which columns they are"""
    times: npt.NDArray[np.float64]
    """(T,), s"""
    rows: npt.NDArray[np.float64]
    """(T, D), NaN where the file has no value"""
    places: npt.NDArray[np.int64]
    """(T,), the line or frame of the file"""
    unit: str
    """'line' or 'frame'"""
    source: str
    timecode: str = ""
    notes: tuple[str, ...] = field(default=())


def table_to_recording(
    path: str | os.PathLike[str], table: FrameTable, least_fps: float = 0.0
) -> ArkitRecording:
    """Sorted, checked and clamped frames.

    Args:
        path: the file, for errors.
        table: its frames.
        least_fps: frames a second, fewer are refused.

    Raises:
        LipwrightError: there are too few frames or none with a face, times jump, or a value is no
            weight; names line or frame.
    """
    kept, notes = _order(path, table)
    times, places = table.times[kept], table.places[kept]
    if len(times) < 2:
        raise LipwrightError(
            f"{path}: has {_frames(len(times))} with a time of its own; a recording needs two or "
            "more"
        )
    _check_times(path, table.unit, times, places)
    full = np.zeros((len(times), len(ARKIT) + len(ANGLES)))
    full[:, table.match.targets] = table.rows[kept]
    values, of_values = _weights(path, table.unit, full[:, : len(ARKIT)], places)
    lost: npt.NDArray[np.bool_] = np.asarray(np.isnan(values).any(axis=1))
    if lost.all():
        raise LipwrightError(f"{path}: no frame has a face; record again")
    values[lost] = np.nan
    if lost.any():
        of_values = (*of_values, f"{_frames(int(lost.sum()))} without a face")
    angles, of_angles = _angles(table.match, full[:, len(ARKIT) :], lost)
    return ArkitRecording(
        fps=_frame_rate(path, times, least_fps),
        times=times,
        values=values.astype(np.float32),
        angles=angles,
        timecode=table.timecode,
        source=table.source,
        notes=(*table.match.notes, *table.notes, *notes, *of_values, *of_angles),
    )


def _frames(count: int) -> str:
    return "1 frame" if count == 1 else f"{count} frames"


def _order(
    path: str | os.PathLike[str], table: FrameTable
) -> tuple[npt.NDArray[np.int64], tuple[str, ...]]:
    """Rows by time, each time once, and what was odd."""
    times = table.times
    back = np.maximum.accumulate(times) - times if len(times) else times
    if (back > MAX_BACKWARDS).any():
        row = int(np.flatnonzero(back > MAX_BACKWARDS)[0])
        raise LipwrightError(
            f"{path}: {table.unit} {table.places[row]}: the time goes back by {back[row]:.3f} s; "
            "cut the file there"
        )
    order = np.argsort(times, kind="stable")
    # A repeated time that has a face in one row only: that row counts.
    faceless = np.isnan(table.rows[order]).any(axis=1)
    group = np.cumsum(np.diff(times[order], prepend=-np.inf) > SMALLEST_STEP)
    order = order[np.lexsort((np.arange(len(order)), faceless, group))]
    kept = order[np.unique(np.sort(group), return_index=True)[1]]
    late, again = int((back > SMALLEST_STEP).sum()), len(times) - len(kept)
    return kept, tuple(
        note
        for count, note in (
            (late, f"{_frames(late)} out of order, sorted by time"),
            (again, f"{_frames(again)} with a repeated time left out"),
        )
        if count
    )


def _check_times(
    path: str | os.PathLike[str],
    unit: str,
    times: npt.NDArray[np.float64],
    places: npt.NDArray[np.int64],
) -> None:
    steps = np.diff(times)
    if steps.max() > MAX_GAP:
        row = int(steps.argmax()) + 1
        raise LipwrightError(
            f"{path}: {unit} {places[row]}: {steps[row - 1]:.1f} s without a frame before it; cut "
            "the file there"
        )
    if times[-1] - times[0] > MAX_SPAN:
        raise LipwrightError(
            f"{path}: spans {(times[-1] - times[0]) / 3600:.1f} hours; correct the times or cut it"
        )


def _weights(
    path: str | os.PathLike[str],
    unit: str,
    values: npt.NDArray[np.float64],
    places: npt.NDArray[np.int64],
) -> tuple[npt.NDArray[np.float64], tuple[str, ...]]:
    """(T, 52), 0 to 1, and what was done to them."""
    notes: tuple[str, ...] = ()
    known = values[~np.isnan(values).any(axis=1)]
    largest = known.max(axis=1) if len(known) else np.zeros(1)
    # Eyes and brows are never all at rest: most frames of a file in percent pass 2.
    if HIGHEST < largest.max() <= FULL_PERCENT and np.median(largest) > HIGHEST:
        values = values / 100
        notes = ("weights in percent, divided by 100",)
    wrong = (values < LOWEST) | (values > HIGHEST)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise LipwrightError(
            f"{path}: {unit} {places[row]}: {ARKIT[column]} is {values[row, column]:g}, no weight "
            "from 0 to 1; correct it"
        )
    outside = int(((values < -1e-6) | (values > 1 + 1e-6)).sum())
    if outside:
        what = "1 value" if outside == 1 else f"{outside} values"
        notes = (*notes, f"{what} outside 0 to 1, clamped")
    return values.clip(0, 1), notes


def _angles(
    match: NameMatch, angles: npt.NDArray[np.float64], lost: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.float32] | None, tuple[str, ...]]:
    if not match.has_angles:
        return None, ()
    angles[lost] = np.nan
    if np.isnan(angles[~lost]).any():
        return None, ("angles of head and eyes are incomplete and left out",)
    largest = float(np.abs(angles[~lost]).max())
    if largest > MAX_DEGREES:
        return None, ("angles of head and eyes are beyond a full turn and left out",)
    if largest > FULL_TURN:
        return np.radians(angles).astype(np.float32), ("angles in degrees, turned to radians",)
    return angles.astype(np.float32), ()


def _frame_rate(
    path: str | os.PathLike[str], times: npt.NDArray[np.float64], least_fps: float
) -> float:
    """The phone's frames a second: a usual rate where the mean step without gaps fits one."""
    steps = np.diff(times)
    middle = float(np.sort(steps)[(len(steps) - 1) // 2])
    # Times in whole milliseconds: the mean is exact where the median is not.
    fps = 1 / float(steps[(steps > 0.5 * middle) & (steps < 1.5 * middle)].mean())
    if fps < least_fps:
        raise LipwrightError(
            f"{path}: {fps:.3g} frames a second are too few for speech; record at 30 or more"
        )
    if fps > MAX_FPS * (1 + FPS_TOLERANCE):
        raise LipwrightError(
            f"{path}: {fps:.0f} frames a second are more than {MAX_FPS:.0f}; correct the times"
        )
    usual = min(USUAL_FPS, key=lambda rate: abs(rate - fps))
    return usual if abs(usual - fps) <= FPS_TOLERANCE * usual else min(float(f"{fps:.6g}"), MAX_FPS)
