"""What the acoustic model hears: mel spectra, with steady noise removed, then cepstra.

The numbers are those of the model's `feat.params` and of pocketsphinx's front end, which this
follows to the last digit: 25 mel filters from 130 to 6800 Hz over windows of 25.6 ms, tracking
of the noise floor in each filter, 13 liftered cepstra, their first and second differences.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from lipwright.audio import Sound

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
Power = npt.NDArray[np.floating]

RATE: Final = 16000  # Hz
HOP: Final = 160  # samples
FRAME_RATE: Final = RATE / HOP  # frames a second
WINDOW: Final = 410  # samples, wlen 0.025625 s
N_FILTERS: Final = 25
N_CEPSTRA: Final = 13

FRAME_CENTRE: Final = WINDOW / 2 / RATE  # s, the time that frame 0 tells about

_FFT: Final = 512
_PREEMPHASIS: Final = 0.97
_LOWEST_HZ, _HIGHEST_HZ = 130.0, 6800.0
_LIFTER: Final = 22
_FULL_SCALE: Final = 32768.0  # the model was trained on 16-bit samples
_LOG_FLOOR: Final = 1e-4

# Noise tracking, fe_noise.c of pocketsphinx: the noise follows the lower envelope of the
# smoothed power, and what stays near it, or in the shadow of a louder frame, is turned down.
_KEEP_POWER: Final = 0.7
_RISE, _FALL = 0.995, 0.5  # share that an envelope keeps where the power is over and under it
_FORGET_PEAK, _IN_SHADOW = 0.85, 0.2
_MAX_GAIN: Final = 20.0
_SPREAD: Final = 4  # filters on each side over which the gain is averaged


def filter_corners() -> Doubles:
    """(27,) Hz, evenly apart in mel: where filter k begins (k), peaks (k + 1) and ends (k + 2)."""
    low, high = (2595 * np.log10(1 + hz / 700) for hz in (_LOWEST_HZ, _HIGHEST_HZ))
    mel = low + (high - low) / (N_FILTERS + 1) * np.arange(N_FILTERS + 2)
    return np.asarray(700 * (10 ** (mel / 2595) - 1))


@lru_cache(maxsize=1)
def _filters() -> Doubles:
    """(257, 25) weights of the power spectrum in each mel filter, each of unit area."""
    step = RATE / _FFT
    corners = np.floor(filter_corners() / step + 0.5) * step
    left, centre, right = corners[:-2], corners[1:-1], corners[2:]
    hz = step * np.arange(_FFT // 2 + 1)[:, None]
    slopes = np.minimum((hz - left) / (centre - left), (right - hz) / (right - centre))
    return np.maximum(slopes, 0) * 2 / (right - left)


@lru_cache(maxsize=1)
def _to_cepstra() -> Doubles:
    """(25, 13) from log mel spectrum to liftered cepstra."""
    index = np.arange(N_CEPSTRA)
    basis = np.cos(np.pi * np.outer(np.arange(N_FILTERS) + 0.5, index) / N_FILTERS)
    scale = np.where(index == 0, np.sqrt(1 / N_FILTERS), np.sqrt(2 / N_FILTERS))
    return basis * scale * (1 + _LIFTER / 2 * np.sin(index * np.pi / _LIFTER))


def power_spectra(samples: Floats, before: float = 0.0, hop: int = HOP) -> Doubles:
    """(T, 25) mel power of the windows that fit into `samples`; `before` is the sample before."""
    scaled = samples.astype(np.float64) * _FULL_SCALE
    late = np.concatenate([[before * _FULL_SCALE], scaled[:-1]])
    windows = np.lib.stride_tricks.sliding_window_view(scaled - _PREEMPHASIS * late, WINDOW)[::hop]
    spectra = np.fft.rfft(windows * np.hamming(WINDOW), _FFT)
    return np.asarray((spectra.real**2 + spectra.imag**2) @ _filters())


class NoiseRemoval:
    """Turns down what does not rise over the noise floor; remembers the floor between blocks."""

    def __init__(self) -> None:
        """Nothing is known of the noise yet."""
        self._state: tuple[Doubles, Doubles, Doubles, Doubles] | None = None

    def __call__(self, spectra: Power) -> Doubles:
        """Mel power (T, ..., 25) with the noise removed, for the next T frames."""
        if self._state is None:
            first = spectra[0]
            self._state = first, first / _MAX_GAIN, first / _MAX_GAIN, np.zeros_like(first)
        power, noise, floor, peak = self._state
        gains = np.empty_like(spectra)
        for frame, raw in enumerate((1 - _KEEP_POWER) * spectra):
            power = _KEEP_POWER * power + raw
            noise = power + np.where(power >= noise, _RISE, _FALL) * (noise - power)
            signal = np.maximum(power - noise, 1.0)
            floor = signal + np.where(signal >= floor, _RISE, _FALL) * (floor - signal)
            peak = peak * _FORGET_PEAK
            heard = np.where(signal < _FORGET_PEAK * peak, peak * _IN_SHADOW, signal)
            peak = np.maximum(signal, peak)
            gains[frame] = np.maximum(heard, floor) / power
        self._state = power, noise, floor, peak
        np.clip(gains, 1 / _MAX_GAIN, _MAX_GAIN, out=gains)
        return spectra * _spread(gains)


def _spread(gains: Power) -> Doubles:
    total = np.concatenate([np.zeros_like(gains[..., :1]), np.cumsum(gains, axis=-1)], axis=-1)
    index = np.arange(N_FILTERS)
    low, high = np.maximum(index - _SPREAD, 0), np.minimum(index + _SPREAD + 1, N_FILTERS)
    return np.asarray((total[..., high] - total[..., low]) / (high - low))


def cepstra(spectra: Power) -> Floats:
    """(T, 13) liftered mel cepstra of mel power (T, 25)."""
    return (np.log(spectra + _LOG_FLOOR) @ _to_cepstra()).astype(np.float32)


def with_differences(static: Floats, reach: int = 1) -> Floats:
    """(T, 39): cepstra (T, 13) with their first and second differences, ends repeated.

    `reach` is the number of rows between frames that are 10 ms apart.
    """
    edge = 3 * reach
    padded = np.pad(static, ((edge, edge), (0, 0)), mode="edge")

    def at(shift: int) -> Floats:
        start = edge + shift * reach
        return padded[start : start + len(static)]

    first = at(2) - at(-2)
    second = (at(3) - at(-1)) - (at(1) - at(-3))
    return np.concatenate([static, first, second], axis=1)


def sample_blocks(sound: Sound, seconds: float = 10.0) -> Iterator[Floats]:
    """The samples of `sound` at 16 kHz, in pieces (n,)."""
    if sound.rate == RATE:
        yield from (block.samples for block in sound.blocks(seconds))
        return
    import soxr

    resampler = soxr.ResampleStream(sound.rate, RATE, 1, dtype="float32")
    for block in sound.blocks(seconds):
        yield resampler.resample_chunk(block.samples)
    yield resampler.resample_chunk(np.zeros(0, np.float32), last=True)


def spectra_of(sound: Sound) -> Iterator[Doubles]:
    """Mel power (T, 25) of the whole sound, in pieces; frame i starts at i * 10 ms.

    Zeros follow the sound, so that each of its samples is in a window.
    """
    kept: Floats = np.zeros(1, np.float32)  # the sample before, and samples of windows yet to come
    for samples in _with_tail(sample_blocks(sound)):
        kept = np.concatenate([kept, samples])
        count = (len(kept) - 1 - WINDOW) // HOP + 1
        if count > 0:
            used = 1 + (count - 1) * HOP + WINDOW
            yield power_spectra(kept[1:used], float(kept[0]))
            kept = kept[count * HOP :]


def _with_tail(blocks: Iterator[Floats]) -> Iterator[Floats]:
    yield from blocks
    yield np.zeros(WINDOW, np.float32)
