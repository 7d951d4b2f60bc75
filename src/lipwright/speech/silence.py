"""Where somebody may be speaking: what rises over the noise floor of the recording."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

Doubles = npt.NDArray[np.float64]

_FLOOR_SHARE: Final = 0.1  # quantile of the levels that is taken for the noise floor
_PEAK_SHARE: Final = 0.999  # and for the loudest
_SPEECH_DEPTH: Final = 25.0  # dB under the loudest down to which frames tell the level of speech
_SPEECH_SHARE: Final = 0.8  # quantile of those
_RISE: Final = 0.25  # share of the way from floor to speech, in dB, at which speech begins
_LEAST_RISE: Final = 6.0  # dB, at least so much over the floor
MARGIN: Final = 0.25  # s around speech: weak beginnings and ends


def speech_level(levels: Doubles) -> float:
    """The level in dB of loud speech in levels (T,), however much of the recording is silent."""
    peak = np.quantile(levels, _PEAK_SHARE)
    return float(np.quantile(levels[levels >= peak - _SPEECH_DEPTH], _SPEECH_SHARE))


def speech_frames(
    levels: npt.ArrayLike, fps: float = 100.0, margin: float = MARGIN
) -> npt.NDArray[np.bool_]:
    """(T,) whether each frame of a level contour in dB is in speech or `margin` s from it.

    The threshold lies between the noise floor and the loud frames of the contour itself. A
    contour that hardly moves has no floor to tell from speech: all of it may be speech.
    """
    levels = np.asarray(levels, np.float64)
    if len(levels) == 0:
        return np.zeros(0, np.bool_)
    floor, speech = np.quantile(levels, _FLOOR_SHARE), speech_level(levels)
    threshold = floor + max(_RISE * (speech - floor), _LEAST_RISE)
    if threshold > speech:
        return np.ones(len(levels), np.bool_)
    reach = round(margin * fps)
    marks = np.pad((levels > threshold).astype(np.int64), reach)
    total = np.concatenate([[0], np.cumsum(marks)])
    return np.asarray(total[2 * reach + 1 :] - total[: -2 * reach - 1] > 0)
