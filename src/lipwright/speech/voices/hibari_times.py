"""When hibari says each phone: the frames that its model gives each letter, set against its sound.

The letters' frames come late: the model tells when it has heard enough of a sound, as the Kokoro
voices do that it learnt from, whose own player moves the marks of words by 3 frames. What
bench/voice_lags.py measured stands beside each constant.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.speech.voices.misaki import PAUSES, STRESS, Sound
from lipwright.speech.voices.timeline import (
    LEAST,
    LEAST_CLOSURE,
    Samples,
    Stretch,
    Timed,
)

RATE: Final = 24000  # Hz
FRAME: Final = 600  # samples: two steps of `hibari.dsp.HOP`, one unit of the durations; 25 ms
LAG: Final = 0.055  # s; without it edges come 50 ms late by the aligner, 54 ms by the sound
MARK: Final = 0.0125  # s of a stress mark that the consonant before has, but for b d g; as LAG
CLOSURE: Final = 0.050  # s that lips or tongue are shut before the first burst of a line
QUIET: Final = 35.0  # dB under the loud parts: silence, at pauses
LOUD: Final = 95  # percentile of the level that counts as loud
LEVEL_STEP: Final = 120  # samples, 5 ms
SHORTEST_PAUSE: Final = 0.06  # s; what is quiet for less is a stop's closure
LEAST_AT_PAUSE: Final = 0.05  # s, of the phone before a pause


def time_line(
    letters: str, sounds: tuple[Sound, ...], frames: npt.NDArray[np.int64], samples: Samples
) -> tuple[Samples, Stretch, Samples]:
    """The silence that a line begins with, its speech with phones, and the silence after it.

    Args:
        letters: L letters of the line.
        sounds: its phones, in order.
        frames: (L + 2,), FRAMEs of each letter, and of the silence before and after.
        samples: (N,), the line's sound at RATE.
    """
    at = np.concatenate([[0.0], np.cumsum(frames)]) * FRAME / RATE - LAG  # s, of letter i at i + 1
    starts = np.array([at[sound.first + 1] for sound in sounds])
    stops = np.array([at[sound.stop + 1] for sound in sounds])
    for place, sound in enumerate(sounds):
        if letters[sound.first] in STRESS and place and not _is_voiced_stop(sounds[place - 1]):
            starts[place] += MARK
            stops[place - 1] += MARK
    quiet = _quiet(samples)
    phones: list[Sound | None] = []
    edges = [_first(starts[0], sounds[0].phone, quiet)]
    for number, sound in enumerate(sounds[:-1]):
        phones.append(sound)
        following = sounds[number + 1]
        pause = None
        if PAUSES.intersection(letters[sound.stop : following.first]):
            pause = _pause(edges[-1], starts[number + 1], following.phone, quiet)
        if pause is None:
            edges.append((stops[number] + starts[number + 1]) / 2)  # half of the space between
        else:
            edges += pause
            phones.append(None)
    phones.append(sounds[-1])
    edges.append(max(edges[-1] + LEAST_AT_PAUSE, _last_sound(quiet, len(samples) / RATE)))
    found = _rising(edges, [LEAST if p is None else _least(p.phone) for p in phones], len(samples))
    first, last = found[0], found[-1]
    timed = tuple(
        Timed(SILENCE, start - first) if phone is None
        else Timed(phone.phone, start - first, phone.stress, phone.word)
        for phone, start in zip(phones, found[:-1], strict=True)
    )  # fmt: skip
    return samples[:first], Stretch(samples[first:last], timed, ()), samples[last:]


def _is_voiced_stop(sound: Sound) -> bool:
    phone = PHONES[sound.phone]
    return phone.manner == "stop" and phone.voiced


def _quiet(samples: Samples) -> npt.NDArray[np.float64]:
    """(Q, 2), start and end (s) of each stretch that is quiet for SHORTEST_PAUSE or more."""
    count = len(samples) // LEVEL_STEP
    power = np.square(samples[: count * LEVEL_STEP], dtype=np.float64).reshape(count, -1).mean(1)
    level = 10 * np.log10(power + 1e-12)
    below = level < np.percentile(level, LOUD) - QUIET
    turns = np.flatnonzero(np.diff(np.concatenate([[False], below, [False]]).astype(np.int8)))
    spans = turns.reshape(-1, 2) * (LEVEL_STEP / RATE)
    long = spans[:, 1] - spans[:, 0] >= SHORTEST_PAUSE
    return np.asarray(spans[long], np.float64)


def _closure(phone: str) -> float:
    return CLOSURE if PHONES[phone].manner in ("stop", "affricate") else 0.0


def _first(start: float, phone: str, quiet: npt.NDArray[np.float64]) -> float:
    """Where the first phone begins."""
    heard = quiet[0, 1] if len(quiet) and quiet[0, 0] == 0 else start
    return max(min(start, heard - _closure(phone)), LEAST)


def _last_sound(quiet: npt.NDArray[np.float64], end: float) -> float:
    """Where the sound ends that the last phone makes."""
    return float(quiet[-1, 0]) if len(quiet) and quiet[-1, 1] > end - 0.05 else end - LEAST


def _pause(
    before: float, start: float, phone: str, quiet: npt.NDArray[np.float64]
) -> list[float] | None:
    """Start and end of the silence between two phones, or None where there is none.

    Args:
        before: start of the phone before it.
        start: of the phone after it, by the model.
        phone: the one after it.
        quiet: as `_quiet` gives it.
    """
    inside = quiet[(quiet[:, 1] > before + LEAST_AT_PAUSE) & (quiet[:, 0] < start)]
    if not len(inside):
        return None
    longest = inside[np.argmax(inside[:, 1] - inside[:, 0])]
    opens = max(float(longest[0]), before + LEAST_AT_PAUSE)
    closes = min(start, float(longest[1]) - _closure(phone))
    return [opens, closes] if closes - opens >= LEAST else None


def _least(phone: str) -> float:
    return LEAST_CLOSURE if phone in BILABIALS else LEAST


def _rising(edges: list[float], leasts: list[float], count: int) -> list[int]:
    """Edges in samples, each phone as long as its least where `count` samples have room."""
    room = np.concatenate([[0.0], np.cumsum(leasts)]) * RATE
    room *= min(1.0, count / max(room[-1], 1.0))
    found = np.maximum.accumulate(np.asarray(edges) * RATE - room) + room
    found = np.minimum(found, count - room[-1] + room)
    return [round(edge) for edge in found]
