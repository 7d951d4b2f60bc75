"""A recording as the acoustic model hears it, whatever its loudness, channel and length."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.features import (
    FRAME_RATE,
    Doubles,
    Floats,
    NoiseRemoval,
    cepstra,
    spectra_of,
)
from lipwright.speech.held import frame_weights
from lipwright.speech.silence import speech_frames, speech_level

if TYPE_CHECKING:
    from lipwright.audio import Sound

_QUIET: Final = 0.05  # quantile of the levels that is taken for the noise floor
_LOUD_DB: Final = 88.0  # dB of mel power, the usual level of speech in 16-bit samples
_DEPTH_DB: Final = 60.0  # what lies deeper under the loud frames counts as so deep: digital zeros
_HISS_SHAPE: Final = 3.0  # of the gamma distribution of the power of noise in one filter
_MEAN_REACH: Final = 15.0  # s on both sides over which the mean of the cepstra is taken
_MEAN_MARGIN: Final = 0.5  # s of silence around speech that count as in the model's training
_MEAN_STEP: Final = 5.0  # s between two such means
_MEAN_WEIGHT: Final = 2.0  # s of speech for which the mean of the whole recording counts
_STRETCH: Final = 1500  # frames whose noise is removed at once
_LEAD: Final = 500  # frames before a stretch, to know the noise by

SILENT_DB: Final = 44.0  # dB of mel power; about -60 dB of full scale


def spectra(sound: Sound) -> Floats:
    """(T, 25) mel power."""
    blocks = [block.astype(np.float32) for block in spectra_of(sound)]
    return np.concatenate(blocks) if blocks else np.zeros((0, 25), np.float32)


def levels(power: Floats) -> Doubles:
    """(T,) dB of mel power, summed over the filters."""
    return np.asarray(10 * np.log10(power.sum(axis=1, dtype=np.float64) + 1e-4))


def dynamic_range(power: Floats) -> float:
    """How far loud frames of mel power (T, 25) rise over the quietest, in dB."""
    level = levels(power)
    return speech_level(level) - float(np.quantile(level, _QUIET))


def static_features(power: Floats) -> Floats:
    """Cepstra (T, 13) with the mean of speech taken off."""
    level = levels(power)
    gain = 10 ** ((_LOUD_DB - speech_level(level)) / 10)
    active = speech_frames(level, FRAME_RATE, _MEAN_MARGIN)
    static = cepstra(_without_noise(np.maximum(power * np.float32(gain), _hiss(power.shape))))
    return static - _speech_mean(static, active)


def _hiss(shape: tuple[int, ...]) -> Floats:
    """Mel power of faint noise: the model never heard digital silence, and takes it for sounds."""
    least = 10 ** ((_LOUD_DB - _DEPTH_DB) / 10) / shape[1]
    noise = np.random.default_rng(0).standard_gamma(_HISS_SHAPE, shape, np.float32)
    return noise * np.float32(least / _HISS_SHAPE)


def _without_noise(power: Floats) -> Floats:
    """The same with steady noise removed; long recordings in several stretches side by side."""
    if len(power) <= _STRETCH + _LEAD:
        return NoiseRemoval()(power[:, None])[:, 0].astype(np.float32)
    count = -(-len(power) // _STRETCH)
    clean = np.empty_like(power)
    rows = np.arange(-_LEAD, _STRETCH)[:, None] + _STRETCH * np.arange(count)
    side = np.abs(rows)  # before the start, the recording is mirrored
    side = np.minimum(side, len(power) - 1)
    for first in range(0, count, 32):
        some = side[:, first : first + 32]
        part = NoiseRemoval()(power[some])[_LEAD:]
        flat = part.transpose(1, 0, 2).reshape(-1, power.shape[1])
        start = first * _STRETCH
        stop = min(start + len(flat), len(power))
        clean[start:stop] = flat[: stop - start]
    return clean


def _speech_mean(static: Floats, active: npt.NDArray[np.bool_]) -> Floats:
    """(T, 13) mean of the cepstra of speech around each frame; a held vowel is no usual speech."""
    if not active.any():
        return np.zeros_like(static)
    share = active * frame_weights(static - static[active].mean(axis=0))
    total = np.zeros((len(static) + 1, static.shape[1]))
    np.cumsum(static * share[:, None], axis=0, out=total[1:], dtype=np.float64)
    count = np.concatenate([[0], np.cumsum(share, dtype=np.float64)])
    centres = np.arange(0, len(static) + _MEAN_STEP * FRAME_RATE, _MEAN_STEP * FRAME_RATE)
    low = np.clip(centres - _MEAN_REACH * FRAME_RATE, 0, len(static)).astype(int)
    high = np.clip(centres + _MEAN_REACH * FRAME_RATE, 0, len(static)).astype(int)
    weight = _MEAN_WEIGHT * FRAME_RATE
    overall = total[-1] / count[-1]
    means = (total[high] - total[low] + weight * overall) / (
        count[high] - count[low] + weight
    )[:, None]  # fmt: skip
    frames = np.arange(len(static))
    columns = [np.interp(frames, centres, column) for column in means.T]
    return np.stack(columns, axis=1).astype(np.float32)
