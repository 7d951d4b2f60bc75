"""Sounds that are held for seconds, as in songs and slowed speech.

Each frame of a held vowel tells the same again. Where the model knows the sound only nearly, 500
such frames weigh more than all words around, and the search would rather drop those than hold a
vowel that scores badly. So the frames of a held sound weigh together as much as a long sound does.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from lipwright.speech.features import FRAME_RATE, Floats

_SMOOTH: Final = 0.2  # s over which vibrato and pitch are averaged
_REACH: Final = 0.3  # s on both sides over which a held sound stays the same
# Of smoothed cepstra, in their units. The least in 40 sentences of GRID is 22; in held vowels of
# espeak-ng the median is 5 to 18.
_MOST_CHANGE: Final = 20.0
_QUIET: Final = -11.5  # of the first cepstrum: 10 dB under the mean of speech
_WEIGHT: Final = 0.3  # s of ordinary speech that a held stretch weighs as much as


def frame_weights(static: Floats) -> Floats:
    """(T,) how much each frame of cepstra (T, 13) counts: 1, less in sounds that are held."""
    weights = np.ones(len(static), np.float32)
    smooth_frames, reach = round(_SMOOTH * FRAME_RATE), round(_REACH * FRAME_RATE)
    if len(static) < smooth_frames + 2 * reach:
        return weights
    total = np.cumsum(np.pad(static.astype(np.float64), ((1, 0), (0, 0))), axis=0)
    smooth = (total[smooth_frames:] - total[:-smooth_frames]) / smooth_frames
    change = np.linalg.norm(smooth[2 * reach :] - smooth[: -2 * reach], axis=1)
    half = np.linalg.norm(smooth[reach:-reach] - smooth[: -2 * reach], axis=1)
    first = reach + smooth_frames // 2
    loud = static[first : first + len(change), 0] > _QUIET
    steady = (np.maximum(change, half) < _MOST_CHANGE) & loud
    for start, stop in _runs(steady):
        weights[first + start : first + stop] = min(_WEIGHT * FRAME_RATE / (stop - start), 1.0)
    return weights


def _runs(marks: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> list[tuple[int, int]]:
    """Start and stop of each stretch of True."""
    edges = np.flatnonzero(np.diff(np.pad(marks.astype(np.int8), 1)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
