"""The times of frames as apps write them: time codes, or numbers of some unit."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.export.timecode import TimeCode, codes_to_clock, parse_timecode
from lipwright.formats.jsontrack import is_number
from lipwright.formats.source import MAX_SECONDS

TIME_NAMES: Final[tuple[str, ...]] = (
    "timestamp", "time", "t", "ts", "seconds", "sec", "timestampms", "timems", "timestampns",
    "timens", "timestampus", "timestampseconds", "timesec", "ms", "timecode", "frametime",
)  # fmt: skip
UNITS: Final = {
    "milliseconds": (1e-3, ("ms", "msec", "millis", "milliseconds")),
    "microseconds": (1e-6, ("us", "usec", "micros", "microseconds")),
    "nanoseconds": (1e-9, ("ns", "nsec", "nanos", "nanoseconds")),
}
"""unit to its length in s and the ends of names that tell it"""
MAX_NUMBER: Final = 1e19  # nanoseconds since 1970 have 19 digits
ASSUMED_FPS: Final = 60.0  # of frame numbers without a rate: that of ARKit's face tracking


@dataclass
class Stamps:
    """The times of one file, gathered frame by frame; all time codes or all numbers."""

    path: str | os.PathLike[str]
    fps: float | None = None
    """frames a second that time codes or frame numbers count, where known"""
    name: str = ""
    """of the field that holds the times"""
    codes: list[TimeCode] = field(default_factory=list)
    numbers: list[float] = field(default_factory=list)
    first_code: str = ""

    def add(self, place: str, stamp: object) -> None:
        """Take the next frame's time.

        Raises:
            LipwrightError: it is neither, or of another kind than those before; names `place`.
        """
        number = _to_number(stamp)
        if number is not None and not self.codes:
            self.numbers.append(number)
            return
        if self.numbers or not isinstance(stamp, str):
            raise LipwrightError(
                f"{self.path}: {place}: the time is {str(stamp)[:24]!r}, not a "
                f"{'number' if self.numbers else 'time'}; correct it"
            )
        self.codes.append(parse_timecode(self.path, place, stamp))
        self.first_code = self.first_code or stamp.strip()


@dataclass(frozen=True, eq=False)
class FrameTimes:
    """Times in seconds and how they were read."""

    times: npt.NDArray[np.float64]
    """(T,), s"""
    layout: str
    """for people: how they were read"""
    notes: tuple[str, ...] = ()
    """what was assumed"""
    timecode: str = ""
    """the first time code, where there are time codes"""


def even_times(fps: float, count: int) -> FrameTimes:
    """The times of `count` frames at `fps` a second, from 0 on."""
    return FrameTimes(np.arange(count) / fps, f"{fps:g} frames a second")


def stamps_to_times(stamps: Stamps) -> FrameTimes:
    """Seconds of at least one stamp.

    Raises:
        LipwrightError: numbers are too large, or their unit is unclear.
    """
    if stamps.codes:
        whole = round(stamps.fps) if stamps.fps else None
        clock = codes_to_clock(stamps.codes, whole)
        note = f"time codes taken as {clock.layout}: the recording is too short to tell"
        return FrameTimes(
            clock.times,
            f"time code of {clock.layout}",
            (note,) if clock.assumed else (),
            stamps.first_code,
        )
    numbers = np.array(stamps.numbers, np.float64)
    found = _unit(stamps, numbers)
    # Absolute times of a day or an epoch: what counts is the time since the first frame.
    origin = numbers.min()
    times = (numbers - origin) * found.scale
    if times.max() > MAX_SECONDS:
        raise LipwrightError(
            f"{stamps.path}: its frames span {times.max():.0f} s as {found.unit}; correct the times"
        )
    if origin * found.scale <= MAX_SECONDS:
        times = numbers * found.scale
    return FrameTimes(times, f"times in {found.unit}", found.notes)


@dataclass(frozen=True)
class _Unit:
    unit: str
    scale: float
    """s"""
    notes: tuple[str, ...] = ()


def _unit(stamps: Stamps, numbers: npt.NDArray[np.float64]) -> _Unit:
    """The unit that the field's name tells, or that in which frames are 1 ms to 1 s apart."""
    lower = stamps.name.casefold()
    for unit, (scale, ends) in UNITS.items():
        if lower.endswith(ends):
            return _Unit(unit, scale)
    steps = np.diff(np.unique(numbers))
    step = float(np.sort(steps)[(len(steps) - 1) // 2]) if len(steps) else 0.0
    if step == 1 and not np.mod(numbers, 1).any():
        fps = stamps.fps or ASSUMED_FPS
        note = f"times taken as frame numbers of {fps:g} a second"
        return _Unit("frames", 1 / fps, () if stamps.fps else (note,))
    if step < 1 or lower.endswith(("sec", "seconds")):
        return _Unit("seconds", 1.0)
    for unit, (scale, _) in UNITS.items():
        if step < 1 / scale:
            return _Unit(unit, scale, (f"times taken as {unit}",))
    raise LipwrightError(
        f"{stamps.path}: its times are {step:g} apart, a second or more in any unit; correct them"
    )


def _to_number(stamp: object) -> float | None:
    if isinstance(stamp, str):
        if not stamp.isascii() or "_" in stamp:
            return None
    elif not is_number(stamp):
        return None
    try:
        number = float(stamp)  # type: ignore[arg-type]  # a number, or a text that may be one
    except ValueError:
        return None
    return number if abs(number) < MAX_NUMBER else None
