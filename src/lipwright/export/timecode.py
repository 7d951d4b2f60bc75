"""Time codes to seconds: frames (`HH:MM:SS:FF.fff`) or milliseconds (`HH:MM:SS.mmm`)."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError

APP_RATE: Final = 60  # frames a second of Live Link Face's time code, also where it records at 30
USUAL_RATES: Final = (24, 25, 30, 48, 50, 60, 100, 120)
DAY: Final = 86400.0  # s
_MAX_FRAME: Final = 120  # a last field that reaches this counts milliseconds

_CODE: Final = re.compile(
    r"(\d{1,2})[:;](\d{1,2})[:;](\d{1,2})(?:([:;])(\d{1,3}(?:[.,]\d{1,9})?)|[.,](\d{1,9}))?"
)

Times = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TimeCode:
    """One time code, before it is known what its last field counts."""

    second: int
    """of the day"""
    last: float
    """the last field: frames, milliseconds, or the decimals of the second (0 to 1)"""
    layout: str
    """'decimal' (HH:MM:SS.mmm), 'milliseconds' (HH:MM:SS:mmm, three digits) or 'frames'"""
    drop: bool
    """written with ';', as drop-frame codes are"""


@dataclass(frozen=True, eq=False)
class Clock:
    """What a row of time codes says."""

    times: Times
    """(T,), s from midnight before the first; they run on over the next midnight"""
    layout: str
    """for people: what the last field counts"""
    assumed: bool
    """nothing in the file tells how many frames a second the codes count"""


def parse_timecode(path: str | os.PathLike[str], place: str, text: str) -> TimeCode:
    """The parts of a time code.

    Raises:
        LipwrightError: it is none; names `place`.
    """
    match = _CODE.fullmatch(text.strip()) if text.isascii() else None
    if match is None:
        raise LipwrightError(
            f"{path}: {place}: the time code is {text[:24]!r}, not HH:MM:SS:FF or HH:MM:SS.mmm; "
            "correct it"
        )
    hours, minutes, seconds = (int(match[n]) for n in (1, 2, 3))
    if hours > 23 or minutes > 59 or seconds > 59:
        raise LipwrightError(
            f"{path}: {place}: the time code is {text[:24]!r}, no time of a day; correct it"
        )
    second = (hours * 60 + minutes) * 60 + seconds
    if match[5] is None:
        return TimeCode(second, float(f"0.{match[6] or 0}"), "decimal", False)
    whole = re.split("[.,]", match[5])[0]
    layout = "milliseconds" if len(whole) == 3 else "frames"
    return TimeCode(second, float(match[5].replace(",", ".")), layout, ";" in text)


def codes_to_clock(codes: Sequence[TimeCode], rate: int | None = None) -> Clock:
    """Times of at least one code; `rate` is the frames that they count a second, if that is known.

    Codes of frames tell their rate where one second passes into the next: the last frame of the
    one, a step further, is the first of the other, and the difference is the rate.
    """
    seconds = np.array([code.second for code in codes], np.float64)
    last = np.array([code.last for code in codes], np.float64)
    if all(code.layout == "decimal" for code in codes):
        return Clock(_past_midnight(seconds + last, DAY), "milliseconds", False)
    if any(code.layout == "milliseconds" for code in codes) or last.max() >= _MAX_FRAME:
        return Clock(_past_midnight(seconds + last / 1000, DAY), "milliseconds", False)
    drop = any(code.drop for code in codes)
    found = rate or rate_of_codes(seconds, last, drop)
    known = found or max(APP_RATE, int(last.max()) + 1)
    assumed = found is None and bool(last.any())
    if drop and known in {30, 60}:
        frames = _frame_numbers(seconds, last, known)
        length = 1001 / (1000 * known)  # s, of a frame
        day = float(_frame_numbers(DAY, 0.0, known)) * length
        layout = f"{known} frames a second, drop-frame"
        return Clock(_past_midnight(frames * length, day), layout, assumed)
    times = _past_midnight(seconds + last / known, DAY)
    return Clock(times, f"{known} frames a second", assumed)


def _past_midnight(times: Times, day: float) -> Times:
    """Times of a day, going on over the end of the day."""
    return np.asarray(np.unwrap(times, period=day), np.float64)


def rate_of_codes(seconds: Times, frames: Times, drop: bool = False) -> int | None:
    """Frames a second that codes of `seconds` and `frames`, both (T,), count; None if unclear.

    Drop-frame codes skip some where a minute begins, so that those turns tell nothing.
    """
    passed = np.diff(seconds)
    steps = np.diff(frames)
    within = steps[(passed == 0) & (steps > 0)]
    turns = np.flatnonzero((passed == 1) & ~(drop & (seconds[1:] % 60 == 0)))
    if not len(within) or not len(turns):
        return None
    # The median: now and then a frame is missing just there.
    estimate = float(np.median(frames[turns] - frames[turns + 1])) + float(np.median(within))
    possible = [rate for rate in USUAL_RATES if rate > frames.max()]
    usual = min(possible, key=lambda rate: abs(rate - estimate), default=0)
    if abs(usual - estimate) <= 0.5:
        return usual
    whole = round(estimate)
    return whole if whole > frames.max() and abs(whole - estimate) <= 0.1 else None


def _frame_numbers(second: Times | float, frame: Times | float, rate: int) -> Times:
    """The number since midnight of frames with drop-frame codes (SMPTE ST 12-1).

    At 29.97 and 59.94 frames a second each minute but the tenth skips its first 2 or 4 codes.
    """
    minutes = np.floor_divide(second, 60)
    skipped = rate // 15 * (minutes - np.floor_divide(minutes, 10))
    return np.asarray(second * rate + frame - skipped, np.float64)
