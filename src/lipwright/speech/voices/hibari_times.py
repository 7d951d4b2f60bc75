"""When hibari says each phone: the frames that its model gives each letter, set against its sound.

The letters' frames come late: the model tells when it has heard enough of a sound, as the Kokoro
voices do that it learnt from, whose own player moves the marks of words by 3 frames. What
bench/voice_lags.py measured stands beside each constant.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.phones import PHONES, SILENCE
from lipwright.speech.voices.misaki import PAUSES, STRESS, Sound

RATE: Final = 24000  # Hz
FRAME: Final = 600  # samples: two steps of `hibari.dsp.HOP`, one unit of the durations; 25 ms
LAG: Final = 0.050  # s, median lateness of edges inside words, bench/voice_lags.py
MARK: Final = 1  # frames of a stress mark that still belong to the consonant before it; as LAG
CLOSURE: Final = 0.050  # s that lips or tongue are shut before the first burst of a line
QUIET: Final = 35.0  # dB under the loud parts: silence, at pauses
LOUD: Final = 95  # percentile of the level that counts as loud
LEVEL_STEP: Final = 120  # samples, 5 ms
SHORTEST_PAUSE: Final = 0.06  # s; what is quiet for less is a stop's closure
LEAST: Final = 0.02  # s, of a phone whose edges have met
LEAST_AT_PAUSE: Final = 0.05  # s, of the phone before a pause

Edges = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Timed:
    """The phones of a line in its sound."""

    phones: tuple[str, ...]
    """P, silence first and last"""
    sounds: tuple[int | None, ...]
    """P, index of the line's sound, None of silence"""
    edges: Edges
    """(P + 1,), samples, rising from 0 to the end of the sound"""


def time_line(
    letters: str, sounds: tuple[Sound, ...], frames: npt.NDArray[np.int64],
    samples: npt.NDArray[np.float32],
) -> Timed:  # fmt: skip
    """Phones and silences with their edges.

    Args:
        letters: L letters of the line.
        sounds: its phones, in order.
        frames: (L + 2,), FRAMEs of each letter, and of the silence before and after.
        samples: (N,), the line's sound at RATE.
    """
    at = np.concatenate([[0.0], np.cumsum(frames)]) * FRAME / RATE - LAG  # s, of letter i at i + 1
    quiet = _quiet(samples)
    end = len(samples) / RATE
    starts, stops = [], []
    for sound in sounds:
        start = at[sound.first + 1]
        if letters[sound.first] in STRESS:
            start = at[sound.first + 1] + min(frames[sound.first + 1], MARK) * FRAME / RATE
        starts.append(start)
        stops.append(at[sound.stop + 1])
    phones, owners, edges = [SILENCE], list[int | None]([None]), [0.0]
    edges.append(_first(starts[0], sounds[0].phone, quiet))
    for number, sound in enumerate(sounds):
        phones.append(sound.phone)
        owners.append(number)
        if number + 1 == len(sounds):
            break
        between = letters[sound.stop : sounds[number + 1].first]
        pause = None
        if PAUSES.intersection(between):
            pause = _pause(edges[-1], starts[number + 1], sounds[number + 1].phone, quiet)
        if pause is None:
            edges.append((stops[number] + starts[number + 1]) / 2)
        else:
            edges += pause
            phones.append(SILENCE)
            owners.append(None)
    last = max(edges[-1] + LEAST_AT_PAUSE, _last_sound(quiet, end))
    edges += [last, end]
    phones.append(SILENCE)
    owners.append(None)
    return Timed(tuple(phones), tuple(owners), _rising(edges, len(samples)))


def _quiet(samples: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
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


def _rising(edges: list[float], count: int) -> Edges:
    """Samples from 0 to `count`, each phone LEAST long or more where there is room for all."""
    least = min(round(LEAST * RATE), count // len(edges))
    found = np.round(np.asarray(edges) * RATE).astype(np.int64)
    found[0], found[-1] = 0, count
    steps = np.arange(len(found)) * least
    found[:-1] = np.maximum.accumulate(found[:-1] - steps[:-1]) + steps[:-1]
    back = count - steps[::-1]
    return np.minimum(found, back)
