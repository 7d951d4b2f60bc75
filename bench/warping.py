"""Dynamic time warping: the phone times of a rendering of a text, moved to a recording of it.

A rendering by a voice that tells its phone times says the same sounds in the same order as the
recording. Both become rows of cepstra, and the cheapest way through both in parallel says which
frame of one sounds like which of the other (Sakoe and Chiba 1978, symmetric form 1 without slope
constraint). The way is searched in a band around a coarse one (as FastDTW, Salvador and Chan 2007),
so that memory grows with the length of the longer recording, not with its square.

The aligner does not use it. From one voice of espeak-ng to another it finds edges within 4 ms, as
both have the same formants; to people, and to voices of another make, it errs by 30 to 50 ms where
the units of the acoustic model err by 10 (docs/alignment.md). It is kept as what they are measured
against.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.features import Floats

Ints = npt.NDArray[np.intp]

BAND: Final = 40  # frames on each side of the coarse way
_SMALL: Final = 400  # frames up to which no coarser way is needed
_STEP_COST: Final = 0.3  # of a step in one row alone, as a share of the mean distance: keeps even


def warp(reference: Floats, other: Floats, band: int = BAND) -> Ints:
    """(T,) the frame of `other` that each frame of `reference` is beside; never falls.

    Args:
        reference: (T, D) rows of features, T at least 1.
        other: (U, D) rows of features in the same units, U at least 1.
        band: rows searched on each side of the coarse way.

    Raises:
        ValueError: one of them is empty.
    """
    if not len(reference) or not len(other):
        raise ValueError("nothing to warp")
    return _warp(reference, other, band)


def _warp(reference: Floats, other: Floats, band: int) -> Ints:
    if min(len(reference), len(other)) <= _SMALL:
        low = np.zeros(len(reference), np.intp)
        return _path(reference, other, low, np.full_like(low, len(other)))
    coarse = _warp(_halved(reference), _halved(other), band)
    frames = np.arange(len(reference))
    rough = np.interp(frames, 2 * np.arange(len(coarse)) + 0.5, 2 * coarse + 0.5)
    low = np.clip(np.floor(rough) - band, 0, len(other) - 1).astype(np.intp)
    high = np.clip(np.ceil(rough) + band + 1, 1, len(other)).astype(np.intp)
    low[0], high[-1] = 0, len(other)
    return _path(reference, other, low, np.maximum(high, low + 1))


def _halved(rows: Floats) -> Floats:
    even = rows[: len(rows) // 2 * 2]
    return np.asarray((even[::2] + even[1::2]) / 2, np.float32)


def _path(reference: Floats, other: Floats, low: Ints, high: Ints) -> Ints:
    """The cheapest way where frame t may be beside frames low[t] to high[t] of `other`."""
    steps: list[npt.NDArray[np.uint8]] = []
    before: npt.NDArray[np.float64] = np.zeros(0)
    extra = 0.0
    for row in range(len(reference)):
        distance = np.linalg.norm(other[low[row] : high[row]] - reference[row], axis=1)
        extra = _STEP_COST * float(distance.mean()) if row == 0 else extra
        if row == 0:
            before = np.cumsum(distance + extra, dtype=np.float64)
            steps.append(np.full(len(before), 2, np.uint8))
        else:
            before, step = _next(before, int(low[row] - low[row - 1]), distance, extra)
            steps.append(step)
    return _traced(steps, low)


def _next(
    before: npt.NDArray[np.float64], shift: int, distance: Floats, extra: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint8]]:
    """Costs of the next row and how each is reached: 0 straight down, 1 across both, 2 along."""
    count = len(distance)
    padded = np.full(count + 1, np.inf)  # before[shift - 1:] as long as it goes
    start = shift - 1
    source = before[max(start, 0) : max(start + count + 1, 0)]
    offset = max(-start, 0)
    padded[offset : offset + len(source)] = source
    down, across = padded[1:] + extra, padded[:-1]
    entry = np.minimum(down, across) + distance
    # Along the row: cost[j] = min over i <= j of entry[i] + the distances after i, up to j.
    total = np.cumsum(distance + extra)
    best = np.minimum.accumulate(np.where(np.isfinite(entry), entry - total, np.inf)) + total
    step = np.where(best < entry - 1e-9, 2, np.where(across <= down, 1, 0)).astype(np.uint8)
    return best, step


def _traced(steps: list[npt.NDArray[np.uint8]], low: Ints) -> Ints:
    beside = np.zeros(len(steps), np.intp)
    row, column = len(steps) - 1, int(low[-1]) + len(steps[-1]) - 1
    beside[row] = column
    while row > 0:
        step = steps[row][column - low[row]]
        if step == 2:
            column -= 1
            beside[row] = column
            continue
        row -= 1
        column -= int(step == 1)
        beside[row] = column
    return beside


def move_times(times: npt.ArrayLike, beside: Ints, frame_rate: float) -> npt.NDArray[np.float64]:
    """Times in s of the reference on the time axis of the other recording."""
    seconds = (np.asarray(beside) + 0.5) / frame_rate
    frames = np.asarray(times, np.float64) * frame_rate - 0.5
    return np.interp(frames, np.arange(len(beside)), seconds)
