"""What a network hears: loudness, the spectrum's shape, and which phones it sounds like.

Measured against the recording itself, so that neither the speaker's loudness nor the microphone
counts: levels from the level of loud speech, cepstra from their mean and spread in speech. The
likeness to phones comes from the aligner's acoustic model, which many speakers trained: it says
less than the spectrum about one voice, and the same about every voice.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.speech.acoustic import load_model
from lipwright.speech.features import (
    FRAME_CENTRE,
    FRAME_RATE,
    N_CEPSTRA,
    filter_corners,
    with_differences,
)
from lipwright.speech.recording import levels, spectra, static_features
from lipwright.speech.silence import speech_level

if TYPE_CHECKING:
    from lipwright.audio import Sound

Floats = npt.NDArray[np.float32]

LEVEL_SPAN: Final = 20.0  # dB that count as one
LEVEL_RANGE: Final = (-3.0, 1.0)  # of these, what is heard
CEPSTRUM_RANGE: Final = 4.0  # standard deviations
SPEECH_DEPTH: Final = 25.0  # dB under loud speech down to which frames show the speaker's spectrum
LEAST_SPREAD: Final = 1e-3  # of a cepstrum, under which it is constant
# A model of many Gaussians is too sure of itself: its log-likelihoods are scaled before they are
# turned into shares.
SURENESS: Final = 0.3
FEWEST: Final = 20  # frames of speech that tell of a speaker
_AT_ONCE: Final = 6000  # frames scored at a time, a minute


SOUNDS: Final[tuple[str, ...]] = (
    "+NSN+", "+SPN+", "AA", "AE", "AH", "AO", "AW", "AY", "B", "CH", "D", "DH", "EH", "ER", "EY",
    "F", "G", "HH", "IH", "IY", "JH", "K", "L", "M", "N", "NG", "OW", "OY", "P", "R", "S", "SH",
    "SIL", "T", "TH", "UH", "UW", "V", "W", "Y", "Z", "ZH",
)  # fmt: skip
"""the B base phones of the acoustic model: noises and a pause among them"""

SOUND_NAMES: Final[tuple[str, ...]] = (
    "level",
    "change of level",
    *(f"cepstrum {index}" for index in range(N_CEPSTRA)),
    *(f"sounds like {phone}" for phone in SOUNDS),
)
"""the columns of `sound_features`"""


@dataclass(frozen=True, eq=False)
class Hearing:
    """A sound as the acoustic model hears it, N frames a hundredth of a second apart."""

    level: npt.NDArray[np.float64]
    """(N,), dB"""
    cepstra: Floats
    """(N, 13)"""
    likelihoods: Floats
    """(N, B), of the best state of each sound"""


@dataclass(frozen=True, eq=False)
class SoundScale:
    """What a voice is measured by; of a recording, or kept from what a speaker said before."""

    loud: float
    """dB, the level of loud speech"""
    mean: npt.NDArray[np.float64]
    """(13,), of cepstra in speech"""
    spread: npt.NDArray[np.float64]
    """(13,), their standard deviation"""


def hear(sound: Sound, power: Floats | None = None) -> Hearing:
    """A sound as the acoustic model hears it.

    Args:
        sound: any.
        power: (N, 25), its mel power, where it was changed on the way; see `warped`.

    Raises:
        LipwrightError: the acoustic model cannot be read.
    """
    power = spectra(sound) if power is None else power
    if not len(power):
        empty = np.zeros((0, len(SOUNDS)), np.float32)
        return Hearing(np.zeros(0), np.zeros((0, N_CEPSTRA), np.float32), empty)
    cepstra = static_features(power)
    model = load_model()
    states = model.sequences[: len(model.base_phones)]  # (B, 3)
    heard = with_differences(cepstra)
    parts = [
        model.score(heard[first : first + _AT_ONCE], states.ravel())
        .reshape(-1, *states.shape)
        .max(axis=-1)
        for first in range(0, len(heard), _AT_ONCE)
    ]
    return Hearing(levels(power), cepstra, np.concatenate(parts))


def scale_of(hearing: Hearing) -> SoundScale:
    """What to measure a recording by: itself."""
    if not len(hearing.level):
        return SoundScale(0.0, np.zeros(N_CEPSTRA), np.ones(N_CEPSTRA))
    loud = speech_level(hearing.level)
    speech = hearing.level > loud - SPEECH_DEPTH
    if speech.sum() < FEWEST:
        return SoundScale(loud, np.zeros(N_CEPSTRA), np.ones(N_CEPSTRA))
    spoken = hearing.cepstra[speech].astype(np.float64)
    return SoundScale(loud, spoken.mean(axis=0), np.maximum(spoken.std(axis=0), LEAST_SPREAD))


def to_features(hearing: Hearing, times: npt.ArrayLike, scale: SoundScale | None = None) -> Floats:
    """(T, S), the columns of SOUND_NAMES at `times` (T,) in s; see `sound_features`."""
    scale = scale_of(hearing) if scale is None else scale
    clock = np.asarray(times, np.float64)
    if not len(hearing.level):
        return np.zeros((len(clock), len(SOUND_NAMES)), np.float32)
    return Clip(SOUND_NAMES, FRAME_RATE, _rows(hearing, scale)).at(clock - FRAME_CENTRE)


def _rows(hearing: Hearing, scale: SoundScale) -> Floats:
    """(N, S), the columns of SOUND_NAMES at the frames of `hearing`."""
    level = np.clip((hearing.level - scale.loud) / LEVEL_SPAN, *LEVEL_RANGE)
    change = np.diff(level, prepend=level[:1])
    spread = (hearing.cepstra - scale.mean.astype(np.float32)) / scale.spread.astype(np.float32)
    best = hearing.likelihoods.max(axis=1, keepdims=True)
    shares = np.exp(np.float32(SURENESS) * (hearing.likelihoods - best))
    shares /= shares.sum(axis=1, keepdims=True)
    heard = np.stack([level, change], axis=1).astype(np.float32)
    cepstra = np.clip(spread, -CEPSTRUM_RANGE, CEPSTRUM_RANGE)
    return np.concatenate([heard, cepstra, shares], axis=1)


def sound_features(sound: Sound, times: npt.ArrayLike, scale: SoundScale | None = None) -> Floats:
    """What is heard at some times.

    Args:
        sound: any; it is heard at 16 kHz.
        times: (T,), s; before the start and past the end the nearest frame counts.
        scale: what the voice is measured by; by default the recording itself, so that frames
            depend on all of it. A stream gives one that it knows beforehand.

    Returns:
        (T, S), the columns of SOUND_NAMES.

    Raises:
        LipwrightError: the acoustic model cannot be read.
    """
    return to_features(hear(sound), times, scale)


# --- other voices ---


def warped(power: Floats, factor: float) -> Floats:
    """Mel power (N, 25) of the same speech out of another throat.

    Vocal tract length perturbation: every formant at `factor` times its frequency. A grown man
    becomes a child at about 1.25.

    Raises:
        ValueError: the factor is not from 0.5 to 2.
    """
    if not 0.5 <= factor <= 2:
        raise ValueError(f"the factor is {factor}, not from 0.5 to 2")
    centres = filter_corners()[1:-1]
    count = len(centres)
    place = np.interp(centres / factor, centres, np.arange(count))
    lower = np.floor(place).astype(np.int64)
    upper = np.minimum(lower + 1, count - 1)
    weight = (place - lower).astype(np.float32)
    logs = np.log(np.maximum(power, np.float32(1e-4)))
    return np.asarray(np.exp((1 - weight) * logs[:, lower] + weight * logs[:, upper]), np.float32)
