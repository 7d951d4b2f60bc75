"""Loudness and pitch of a voice, as its prominence is heard."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Sound, level_db

Floats = npt.NDArray[np.float64]

STEP: Final = 0.02  # s between frames
LOWEST: Final = 70.0  # Hz, a deep man's voice
HIGHEST: Final = 400.0  # Hz, a child's
LEAST_RATE: Final = 6000  # Hz, of the sound in which pitch is looked for
WINDOW: Final = 0.04  # s, nearly three periods of the lowest pitch
VOICED: Final = 0.5  # autocorrelation over which a frame has a pitch
OCTAVE_COST: Final = 0.06  # of it, or every second period would be taken for the pitch
QUIET: Final = 40.0  # dB under the loudest frame, from where on nothing is heard
BLOCK: Final = 60.0  # s of sound at a time


@dataclass(frozen=True, eq=False)
class Voice:
    """What is heard in N frames, `STEP` s apart; frame i is from i * STEP s on."""

    level: Floats
    """(N,), dBFS"""
    pitch: Floats
    """(N,), semitones over 1 Hz; NaN where there is none"""

    def span(self, start: float, end: float) -> slice:
        """The frames from `start` to `end` s, at least one where there are any."""
        first = max(int(start / STEP), 0)
        return slice(first, max(round(end / STEP), first + 1))


def hear_voice(sound: Sound) -> Voice:
    """Loudness and pitch of a sound."""
    level = level_db(sound, STEP).astype(np.float64)
    if not len(level):
        return Voice(level, np.zeros(0))
    heard = level >= level.max() - QUIET
    frames = round(BLOCK / STEP)
    pitch = np.full(len(level), np.nan)
    for index, (block, rate) in enumerate(_blocks(sound)):
        wanted = np.flatnonzero(heard[index * frames : (index + 1) * frames])
        pitch[index * frames + wanted] = _pitches(block, rate, wanted)
    return Voice(level, pitch)


def _blocks(sound: Sound) -> Iterator[tuple[Floats, float]]:
    """Pieces of a whole number of frames at a low rate, each as long as its last window."""
    every = max(sound.rate // LEAST_RATE, 1)
    for index in range(math.ceil(sound.duration / BLOCK)):
        start = index * BLOCK
        piece = sound.read(start, start + BLOCK + WINDOW)
        samples = piece.samples[: len(piece) // every * every].reshape(-1, every).mean(axis=1)
        yield samples.astype(np.float64), piece.rate / every


def _pitches(samples: Floats, rate: float, wanted: npt.NDArray[np.intp]) -> Floats:
    """(N,), the pitch of the wanted frames by autocorrelation, semitones; NaN without one."""
    length = round(WINDOW * rate)
    if rate < 4 * HIGHEST or not len(wanted):
        return np.full(len(wanted), np.nan)
    starts = np.round(wanted * STEP * rate).astype(np.int64)
    inside = starts + length <= len(samples)  # of the sound's last frames none has a whole window
    samples = np.pad(samples, (0, length))
    frames = np.lib.stride_tricks.sliding_window_view(samples, length)[starts].astype(np.float32)
    window = np.hanning(length).astype(np.float32)
    frames = (frames - frames.mean(axis=1, keepdims=True)) * window
    first, last = int(rate / HIGHEST), min(int(rate / LOWEST) + 1, length - 2)
    # The window's own fall is taken out, or low pitches would lose.
    fall = _correlation(window[None], last + 2)
    found = _correlation(frames, last + 2) / (fall / fall[:, :1])
    found /= np.maximum(found[:, :1], 1e-9)
    cost = OCTAVE_COST * np.log2(np.arange(first, last + 1) / first)
    lag = (found[:, first : last + 1] - cost).argmax(axis=1) + first
    row = np.arange(len(frames))
    before, best, after = (found[row, lag + step] for step in (-1, 0, 1))
    bend = before - 2 * best + after
    shift = np.where(bend < 0, (before - after) / (2 * np.where(bend < 0, bend, -1)), 0)
    semitones = 12 * np.log2(rate / (lag + shift.clip(-1, 1)))
    return np.where(inside & (best > VOICED), semitones, np.nan)


def _correlation(frames: npt.NDArray[np.float32], lags: int) -> npt.NDArray[np.float32]:
    """(N, lags), the autocorrelation of frames (N, W)."""
    size = 1 << (frames.shape[1] + lags - 1).bit_length()
    power = np.abs(np.fft.rfft(frames, size)) ** 2
    return np.fft.irfft(power, size)[:, :lags].astype(np.float32)
