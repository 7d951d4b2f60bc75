"""Eyes and lids: blinks, small glances, and a gaze that stays where it was while the head turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.life.accents import Phrase
from lipwright.life.curves import Floats, add_pulse

# Bentivoglio et al. 1997, Movement Disorders 12(6): 150 people, 26 a minute in conversation and 17
# at rest. The spread of the intervals is ours: no two alike, rarely one soon after another.
TALKING: Final = 60 / 26  # s between blinks, on average
RESTING: Final = 60 / 17  # s between blinks where nothing is said
SPREAD: Final = 0.5  # standard deviation of their logarithm
SHORTEST: Final = 0.6  # s between the beginnings of two blinks
REACH: Final = 0.8  # s over which a blink waits, or hurries, for the end of a phrase
LATE: Final = 0.2  # s after that end by which it begins: "at the end and during pauses in speech"
# (Nakano and Kitazawa 2010, Experimental Brain Research 205)

# A lid takes about 0.1 s down and longer up (Stern et al. 1984, Psychophysiology 21); down is 40 to
# 47 % faster (Sforza et al. 2008, Ophthalmic and Physiological Optics 28).
CLOSING: Final = (0.07, 0.1)  # s
CLOSED: Final = (0.02, 0.05)  # s; at least a frame and a half, or no frame would show it
LONGEST: Final = 0.2  # s; where frames are farther apart some blinks fall between them
OPENING: Final = (0.13, 0.22)  # s
CHEEK: Final = 0.15  # eyeSquint at full closure: the lower lid comes to meet the upper one
DIP: Final = 1.5  # degrees that the eyes sink and rise again behind the lid

GLANCES: Final = 1.3  # s between two small movements of the eyes, on average
STILL: Final = 0.25  # s, the shortest fixation
GLANCE: Final = (1.0, 0.6)  # degrees to a side and up, standard deviation of where eyes rest
FARTHEST: Final = 2.5  # of these standard deviations
FLIGHT: Final = 0.035  # s that a glance of a few degrees takes (Carpenter 1988, "Movements of the
# Eyes": 21 ms and 2.2 ms a degree)

# Of our head and of ARKit's face: what an eye turns at full weight.
SIDEWAYS, UP, DOWN = 26.0, 12.0, 16.0  # degrees; a test measures them


@dataclass(frozen=True)
class Blink:
    """One closing of both eyes."""

    start: float
    """s"""
    shape: tuple[float, float, float]
    """s of closing, closed and opening"""


def plan_blinks(
    phrases: Sequence[Phrase], duration: float, fps: float, random: np.random.Generator
) -> list[Blink]:
    """Blinks over `duration` s, more often while something is said, most likely at its ends."""
    ends = np.array([phrase.end for phrase in phrases])
    starts = np.array([phrase.start for phrase in phrases])
    blinks: list[Blink] = []
    time = 0.0
    while True:
        index = int(np.searchsorted(starts, time, "right")) - 1
        speaking = index >= 0 and time < ends[index]
        mean = TALKING if speaking else RESTING
        wait = mean * float(np.exp(SPREAD * random.standard_normal() - SPREAD**2 / 2))
        late, *parts = random.random(4)
        begin = time + max(wait, SHORTEST)
        if len(ends):
            end = float(ends[np.abs(ends - begin).argmin()])
            if abs(end - begin) < REACH and end + LATE * late > time + SHORTEST:
                begin = end + LATE * float(late)
        closing, closed, opening = (
            low + share * (high - low)
            for share, (low, high) in zip(parts, (CLOSING, CLOSED, OPENING), strict=True)
        )
        shape = (closing, max(closed, min(1.5 / fps, LONGEST)), opening)
        if begin + sum(shape) > duration:
            return blinks
        blinks.append(Blink(begin, shape))
        time = begin


def lid_curve(blinks: Sequence[Blink], frames: int, fps: float) -> Floats:
    """(T,), how far the lids are shut, 0 to 1."""
    lids = np.zeros(frames)
    for blink in blinks:
        add_pulse(lids, fps, 1.0, blink.start, blink.shape)
    return lids.clip(0, 1)


def gaze_degrees(times: Floats, random: np.random.Generator) -> tuple[Floats, Floats]:
    """(T,) and (T,), where the eyes look to the own left and up, degrees, in small glances."""
    duration = float(times[-1]) + 1
    count = int(duration / STILL) + 2  # more cannot be
    where, when = random.spawn(2)  # so that longer times give the same beginning
    draws = where.standard_normal((count, 2)).clip(-FARTHEST, FARTHEST)
    waits = STILL + when.exponential(GLANCES - STILL, count)
    starts = np.concatenate([[0.0], np.cumsum(waits)])[: count + 1]
    used = int(np.searchsorted(starts, duration)) + 1
    knots = np.stack([starts[:used], starts[:used] + FLIGHT], axis=1).ravel()[1:-1]
    places = np.concatenate([[[0.0, 0.0]], draws])[: used - 1]
    sideways, up = (np.repeat(places[:, axis] * GLANCE[axis], 2) for axis in (0, 1))
    return np.interp(times, knots, sideways), np.interp(times, knots, up)


def eye_curves(sideways: Floats, up: Floats, lids: Floats) -> dict[str, Floats]:
    """Control to (T,) weights of both eyes that look some degrees to the own left and up."""
    up = up - DIP * lids
    left, right = ((sideways * sign).clip(0) / SIDEWAYS for sign in (1, -1))
    each = {
        "eyeLookOutLeft": left, "eyeLookInRight": left,
        "eyeLookOutRight": right, "eyeLookInLeft": right,
    }  # fmt: skip
    for side in ("Left", "Right"):
        each[f"eyeLookUp{side}"] = up.clip(0) / UP
        each[f"eyeLookDown{side}"] = (-up).clip(0) / DOWN
        each[f"eyeBlink{side}"] = lids
        each[f"eyeSquint{side}"] = CHEEK * lids
    return {name: curve.clip(0, 1) for name, curve in each.items()}


FULL_TURNS: Final = MappingProxyType({
    "eyeLookOutLeft": (SIDEWAYS, 0.0), "eyeLookInLeft": (-SIDEWAYS, 0.0),
    "eyeLookUpLeft": (0.0, UP), "eyeLookDownLeft": (0.0, -DOWN),
})  # fmt: skip
"""what the left eye turns at full weight, degrees to the own left and up"""
