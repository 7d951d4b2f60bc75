"""Head and brows: slow drift, nods and raised brows on accents, brows that rise with a question."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from lipwright.curves import limited
from lipwright.life.accents import Phrase, Prosody
from lipwright.life.curves import Floats, add_pulse, pulse, smooth_noise
from lipwright.life.voice import STEP, Voice
from lipwright.passes import ease

# Heads move with the pitch and the loudness of the voice (Munhall et al. 2004, Psychological
# Science 15) and come to rest in pauses (Hadar et al. 1983, Human Movement Science 2).
DRIFT: Final = (1.8, 1.1, 1.1)  # degrees, standard deviation of yaw, pitch and roll in speech
DRIFT_STEP: Final = 0.9  # s between two turns of the drift: most of it is under 0.6 Hz
IN_PAUSE: Final = 0.3  # share of it in pauses: nobody freezes
SETTLING: Final = 0.6  # s before and after speech in which it grows and goes
TREMOR: Final = 0.12  # degrees, standard deviation, about every axis
TREMOR_STEP: Final = 0.25  # s
MELODY: Final = 0.6  # degrees up for a semitone over the phrase's middle
MELODY_SPAN: Final = 0.15  # s, standard deviation of the smoothing of the pitch
MELODY_RANGE: Final = 6.0  # semitones either way; more is a mistake of the pitch

# A nod begins with the stressed word and is deepest after its accent; brows begin before and are
# highest with it (Kim, Cvejic and Davis 2014, Speech Communication 57).
NOD: Final = 2.6  # degrees down on the strongest accents
NOD_SHAPE: Final = (0.22, 0.0, 0.38)  # s down, there, and back
NOD_START: Final = 0.02  # s from the accent, when the melody has lifted the head
TILT: Final = 0.35  # standard deviation of what a nod adds to yaw and roll, for a degree of it
NODDED: Final = 0.45  # accents weaker than this have none

# Rapid rises of the brows come with rises of pitch in most cases, not in all (Guaitella et al.
# 2009, Language and Speech 52: 71 %), and begin some 60 ms before (Flecha-Garcia 2010, Speech
# Communication 52).
BROW: Final = 0.45  # of browInnerUp on the strongest accents
BROW_OUTER: Final = 0.7  # of that, of browOuterUp
BROW_SHAPE: Final = (0.16, 0.08, 0.4)  # s up, there, and down
BROW_START: Final = -0.16  # s from the accent: highest with it
RAISED: Final = 0.6  # accents weaker than this have none
WILLING: Final = 0.6  # share of the others that have one
QUESTION: Final = 0.4  # of browInnerUp while a phrase rises like a question
QUESTION_SHAPE: Final = (0.25, 0.35, 0.5)  # s
QUESTION_START: Final = -0.5  # s from the end of the phrase

LIMITS: Final = (9.0, 7.0, 6.0)  # degrees of yaw, pitch and roll that are approached, never passed
FASTEST: Final = 60.0  # degrees a second; what is faster turns less far
ENDS: Final = 0.5  # s in which the head comes from rest at first, and goes back to it at last


def speaking(phrases: Sequence[Phrase], times: Floats) -> Floats:
    """(T,), 1 in phrases, 0 far from them."""
    share = np.zeros(len(times))
    for phrase in phrases:
        first, stop = np.searchsorted(times, (phrase.start - SETTLING, phrase.end + SETTLING))
        inside = times[first:stop]
        away = np.maximum(phrase.start - inside, inside - phrase.end)
        share[first:stop] = np.maximum(share[first:stop], ease(1 - away / SETTLING))
    return share


def melody(phrases: Sequence[Phrase], voice: Voice, times: Floats) -> Floats:
    """(T,), semitones of the voice over the middle of each phrase, smooth; 0 where it is silent."""
    heard: Floats = np.zeros(len(voice.pitch))
    for phrase in phrases:
        span = voice.span(phrase.start, phrase.end)
        pitch = voice.pitch[span]
        if np.isfinite(pitch).any():
            heard[span] = np.nan_to_num(pitch - np.nanmedian(pitch))
    heard = heard.clip(-MELODY_RANGE, MELODY_RANGE)
    reach = np.arange(-round(3 * MELODY_SPAN / STEP), round(3 * MELODY_SPAN / STEP) + 1)
    weights = np.exp(-((reach * STEP / MELODY_SPAN) ** 2) / 2)
    smooth = np.convolve(np.pad(heard, len(reach) // 2), weights / weights.sum(), "valid")
    return np.interp(times, (np.arange(len(smooth)) + 0.5) * STEP, smooth, 0, 0)


def head_degrees(
    prosody: Prosody, times: Floats, fps: float, seed: Sequence[int], amount: float = 1.0
) -> Floats:
    """(T, 3), yaw, pitch and roll in degrees, from rest and back to it.

    Args:
        prosody: what is heard.
        times: (T,), s.
        fps: frames a second of `times`.
        seed: numbers from 0 on.
        amount: times the usual size.
    """
    drifts, nods = (np.random.default_rng((*seed, kind)) for kind in range(2))
    share = IN_PAUSE + (1 - IN_PAUSE) * speaking(prosody.phrases, times)
    angles = np.stack(
        [
            size * share * smooth_noise(times, DRIFT_STEP, drift)
            + TREMOR * smooth_noise(times, TREMOR_STEP, tremor)
            for size, (drift, tremor) in zip(
                DRIFT, zip(drifts.spawn(3), drifts.spawn(3), strict=True), strict=True
            )
        ],
        axis=1,
    )
    if prosody.voice is not None and len(prosody.voice.pitch):
        angles[:, 1] += MELODY * melody(prosody.phrases, prosody.voice, times)
    for accent in prosody.accents:
        tilts = nods.standard_normal(2).clip(-2, 2)
        if accent.strength >= NODDED:
            depth = NOD * accent.strength
            for axis, size in ((0, TILT * tilts[0]), (1, -1.0), (2, TILT * tilts[1])):
                start = accent.time + NOD_START
                add_pulse(angles[:, axis], fps, depth * size, start, NOD_SHAPE)
    limits = np.array(LIMITS)
    at_ends = pulse(times, 0.0, ENDS, max(float(times[-1]) - 2 * ENDS, 0.0), ENDS)
    within = amount * at_ends[:, None] * limits * np.tanh(angles / limits)
    return limited(within, FASTEST / fps)


def brow_curves(
    prosody: Prosody, frames: int, fps: float, seed: Sequence[int]
) -> dict[str, Floats]:
    """Control to (T,) weights; arguments as of `head_degrees`."""
    random = np.random.default_rng(tuple(seed))
    up: Floats = np.zeros(frames)
    for accent in prosody.accents:
        willing = random.random() < WILLING
        if willing and accent.strength >= RAISED:
            add_pulse(up, fps, BROW * accent.strength, accent.time + BROW_START, BROW_SHAPE)
    for phrase in prosody.phrases:
        if phrase.rises:
            add_pulse(up, fps, QUESTION, phrase.end + QUESTION_START, QUESTION_SHAPE)
    up = BROW * np.tanh(up / BROW)
    outer = BROW_OUTER * up
    return {"browInnerUp": up, "browOuterUpLeft": outer, "browOuterUpRight": outer}
