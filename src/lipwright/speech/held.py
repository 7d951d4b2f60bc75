"""Sounds that are held for seconds, as in songs and slowed speech.

Each frame of a held vowel tells the same again. Where the model knows the sound only nearly, 500
such frames weigh more than all words around, and the search would rather drop those than hold a
vowel that scores badly. So the frames of a held sound weigh together as much as a long sound does.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.features import FRAME_RATE, Floats

_SMOOTH: Final = 0.2  # s over which vibrato and pitch are averaged
_REACH: Final = 0.3  # s on both sides over which a held sound stays the same
# Of smoothed cepstra, in their units. The least in 40 sentences of GRID is 22; in held vowels of
# espeak-ng the median is 5 to 18.
_MOST_CHANGE: Final = 20.0
_QUIET: Final = -11.5  # of the first cepstrum: 10 dB under the mean of speech
_FEWEST: Final = 10  # frames that stay the same, so that a long vowel of speech is none
_SLACK: Final = 20  # frames at both ends of a held sound that are not known to be of it
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
    # What is the same for `reach` around a frame is one sound, but for the half of what smooths it.
    sure = reach - smooth_frames // 2
    whole = np.zeros(len(static), np.bool_)
    for start, stop in runs(steady):
        if stop - start >= _FEWEST:
            whole[first + start - sure : first + stop + sure] = True
    for start, stop in runs(whole):
        weights[start:stop] = min(_WEIGHT * FRAME_RATE / (stop - start), 1.0)
    return weights


def runs(marks: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Start and stop of each stretch of True."""
    edges = np.flatnonzero(np.diff(np.pad(marks.astype(np.int8), 1)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def over_held(
    spans: Sequence[tuple[int, int]],
    vowels: Sequence[tuple[bool, bool]],
    weights: Floats,
    static: Floats,
) -> list[tuple[int, int]]:
    """Spans of words or phones, longer where the vowel at their edge goes on as the same sound.

    A search may take the rest of a vowel that scores badly for a pause: the mouth would rest.

    Args:
        spans: first and stop frames, in order, with gaps.
        vowels: whether each span begins, and ends, with a vowel.
        weights: (T,) `frame_weights`.
        static: (T, 13) cepstra.
    """
    sounds = [
        (first, last, static[first:last].mean(axis=0))
        for first, last in runs(np.asarray(weights < 1))
    ]
    firsts, lasts = [sound[0] for sound in sounds], [sound[1] for sound in sounds]
    found = [list(span) for span in spans]
    for index, (begins, ends) in enumerate(vowels):
        before = found[index - 1][1] if index else 0
        after = spans[index + 1][0] if index + 1 < len(spans) else len(weights)
        start, stop = spans[index]
        near = slice(bisect_left(lasts, start - _SLACK), bisect_right(firsts, stop + _SLACK))
        for first, last, mean in sounds[near]:
            if begins and first < start < last + _SLACK and _alike(static[start : start + 3], mean):
                found[index][0] = max(first, before)
            if ends and first - _SLACK < stop < last and _alike(static[stop - 3 : stop], mean):
                found[index][1] = min(last, after)
    return [(start, stop) for start, stop in found]


def _alike(frames: Floats, mean: Floats) -> bool:
    return bool(np.linalg.norm(frames.mean(axis=0) - mean) < 2 * _MOST_CHANGE)
