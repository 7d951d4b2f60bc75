"""Sounds in which nobody speaks, made by arithmetic, 16 kHz."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

RATE = 16000  # Hz
Samples = npt.NDArray[np.floating]


def _times(seconds: float) -> Samples:
    return np.arange(round(seconds * RATE)) / RATE


def _noise(seconds: float, seed: int = 0) -> Samples:
    return np.random.default_rng(seed).standard_normal(round(seconds * RATE))


def _band(samples: Samples, low: float, high: float) -> Samples:
    hz = np.fft.rfftfreq(len(samples), 1 / RATE)
    spectrum = np.fft.rfft(samples)
    spectrum[(hz < low) | (hz > high)] = 0
    kept = np.fft.irfft(spectrum, len(samples))
    return kept / kept.std()


def _voice(pitch: Samples, formants: Sequence[float], widths: Sequence[float]) -> Samples:
    """A sawtooth through resonances in Hz."""
    from scipy.signal import lfilter

    samples = 2 * ((np.cumsum(pitch) / RATE) % 1) - 1
    for hz, width in zip(formants, widths, strict=True):
        r = np.exp(-np.pi * width / RATE)
        samples = lfilter([1 - r], [1, -2 * r * np.cos(2 * np.pi * hz / RATE), r * r], samples)
    return np.asarray(samples / samples.std())


def pink_noise(seconds: float) -> Samples:
    """Equal power in each octave."""
    white = np.fft.rfft(_noise(seconds))
    hz = np.fft.rfftfreq(round(seconds * RATE), 1 / RATE)
    pink = np.fft.irfft(white / np.sqrt(np.maximum(hz, 20)), round(seconds * RATE))
    return 0.05 * pink / pink.std()


def breath(seconds: float) -> Samples:
    """Noise that swells and fades every 2.5 s."""
    t = _times(seconds)
    swell = np.clip(np.sin(2 * np.pi * t / 2.5), 0, 1) ** 2
    return 0.05 * _band(_noise(seconds), 300, 5000) * swell


def hum(seconds: float) -> Samples:
    """A voice through the nose."""
    t = _times(seconds)
    fade = np.clip(np.minimum(t, t[-1] - t) / 0.3, 0, 1)
    return 0.1 * fade * _voice(120 + 8 * np.sin(np.pi * t), (250, 1100, 2300), (80, 250, 300))


def laughter(seconds: float) -> Samples:
    """Four and a half bursts of voice a second, with breath between."""
    t = _times(seconds)
    beat, on = np.sin(2 * np.pi * 4.5 * t), t % 2.5 < 1.8
    voice = _voice(220 - 15 * t, (700, 1300, 2600), (60, 90, 120))
    air = _band(_noise(seconds), 500, 5000)
    return on * (0.1 * voice * np.clip(beat, 0, 1) ** 0.7 + 0.02 * air * np.clip(-beat, 0, 1))


def melody(seconds: float) -> Samples:
    """Sines, three a second."""
    t = _times(seconds)
    steps = np.array([0, 4, 7, 12, 7, 4, 5, 9])[(t / 0.35).astype(int) % 8]
    fade = np.minimum(1, (0.35 - t % 0.35) / 0.05)
    return 0.2 * fade * np.sin(2 * np.pi * np.cumsum(440 * 2 ** (steps / 12)) / RATE)


def tone(seconds: float) -> Samples:
    """300 Hz, held."""
    return 0.2 * np.sin(2 * np.pi * 300 * _times(seconds))


def drums(seconds: float) -> Samples:
    """Bass, snare and cymbal, four beats a second."""
    t = _times(0.25)
    bass = np.sin(2 * np.pi * (50 + 80 * np.exp(-40 * t)) * t) * np.exp(-18 * t)
    snare = 0.6 * _noise(0.25, 1) * np.exp(-25 * t)
    cymbal = 0.3 * np.diff(_noise(0.25, 2), prepend=0) * np.exp(-80 * t)
    bar = np.concatenate([bass + cymbal, cymbal, snare + cymbal, cymbal])
    return 0.2 * np.resize(bar, round(seconds * RATE))


def chords(seconds: float) -> Samples:
    """One a second, of six overtones a note."""
    t = _times(1.0)
    bars = [
        sum(
            np.sin(2 * np.pi * 196 * 2 ** (step / 12) * n * t) / n * np.exp(-1.2 * t)
            for step in steps
            for n in range(1, 7)
        )
        for steps in ((0, 4, 7), (9, 12, 16), (5, 9, 12), (7, 11, 14))
    ]
    return 0.05 * np.resize(np.concatenate(bars), round(seconds * RATE))


def music(seconds: float) -> Samples:
    """Chords and drums."""
    return chords(seconds) + 0.6 * drums(seconds)


def fiddle(seconds: float) -> Samples:
    """A bowed string with vibrato, one note a second."""
    t = _times(seconds)
    notes = np.array([220, 262, 330, 294, 247, 196])[t.astype(int) % 6]
    pitch = notes * (1 + 0.01 * np.sin(2 * np.pi * 5.5 * t))
    return 0.15 * _voice(pitch, (500, 1500, 2500), (60, 90, 120))


def clicks(seconds: float) -> Samples:
    """Twelve knocks."""
    samples = np.zeros(round(seconds * RATE))
    knock = 0.5 * _noise(0.01) * np.exp(-np.arange(160) / 30)
    for place in np.random.default_rng(3).integers(0, len(samples) - len(knock), 12):
        samples[place : place + len(knock)] += knock
    return samples


OTHER_SOUNDS = MappingProxyType[str, Callable[[float], Samples]]({
    "breath": breath, "hum": hum, "laughter": laughter, "pink noise": pink_noise,
    "melody": melody, "tone": tone, "drums": drums, "chords": chords, "music": music,
    "fiddle": fiddle, "clicks": clicks,
})  # fmt: skip
"""name to samples of so many seconds"""
