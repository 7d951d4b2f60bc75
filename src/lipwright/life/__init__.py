"""Life over speech: blinks, small glances, brows and head motion, driven by stress and pauses.

    clip = add_life(clip, track, audio, seed=1)

The same track, sound and seed give the same motion, another seed gives another. Where the sound
is not there, marks of stress and the lengths of vowels tell what stands out. What moves the mouth
is never touched. Rates and shapes are those of published measurements, named where they stand.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from lipwright.audio import Sound
from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.life.accents import (
    Accent,
    Phrase,
    Prosody,
    find_accents,
    find_phrases,
    find_prosody,
)
from lipwright.life.curves import Floats
from lipwright.life.eyes import Blink, eye_curves, gaze_degrees, lid_curve, plan_blinks
from lipwright.life.motion import brow_curves, head_degrees
from lipwright.life.voice import Voice, hear_voice
from lipwright.track import PhoneTrack

__all__ = [
    "MOST", "Accent", "Blink", "Phrase", "Prosody", "Voice", "add_life", "check_life",
    "find_accents", "find_phrases", "find_prosody", "hear_voice", "life",
]  # fmt: skip

MOST: Final = 2.0  # times the usual size
_BLINKS, _GAZE, _HEAD, _BROWS = range(4)  # each has random numbers of its own


def life(
    track: PhoneTrack,
    audio: Sound | None = None,
    fps: float = 60.0,
    seed: int = 0,
    amount: float = 1.0,
) -> Clip:
    """Eyes, lids, brows and head while a track is said, from 0 s to its end.

    Args:
        track: what is said when.
        audio: the sound of it, where there is one.
        fps: frames a second.
        seed: from 0 on.
        amount: of glances, brows and turns, 0 to 2; blinks shut the eyes at any above 0.

    Returns:
        Canonical controls of eyes and brows, and `HEAD_ANGLES` in radians.

    Raises:
        LipwrightError: seed or amount are out of range.
        ValueError: fps is out of range.
    """
    return _live(track, audio, frame_times(track.end, fps), fps, seed, amount)


def add_life(
    clip: Clip,
    track: PhoneTrack,
    audio: Sound | None = None,
    seed: int = 0,
    amount: float = 1.0,
) -> Clip:
    """A clip of canonical controls with life laid over it, and head angles.

    Life's w adds to the clip's s as s + w - s w, angles add up. Wide eyes shut for a blink.

    Raises:
        LipwrightError: the clip has no canonical control, or seed or amount are out of range.
    """
    if not set(clip.names) & set(CANONICAL):
        raise LipwrightError(
            "life moves canonical controls, and this clip has none; add it before retargeting"
        )
    living = _live(track, audio, clip.times, clip.fps, seed, amount)
    if amount == 0:
        return clip
    missing = tuple(name for name in living.names if name not in clip.names)
    whole = clip.select(clip.names + missing)
    curves = {}
    for name in living.names:
        before, added = whole.curve(name), living.curve(name)
        room = 1.0 if name in HEAD_ANGLES else 1 - before.clip(0, 1)
        curves[name] = before + room * added
    for side in ("Left", "Right"):
        if (wide := f"eyeWide{side}") in whole.names:
            curves[wide] = whole.curve(wide) * (1 - living.curve(f"eyeBlink{side}"))
    return whole.with_curves(curves)


def check_life(amount: float, seed: int) -> None:
    """Refuse what no life can be had of.

    Raises:
        LipwrightError: the seed is no whole number from 0 on, or the amount not from 0 to 2.
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise LipwrightError(f"the seed is {seed}; give a whole number from 0 on")
    if not 0 <= amount <= MOST:
        raise LipwrightError(f"the amount of life is {amount:g}; give a number from 0 to {MOST:g}")


def _live(
    track: PhoneTrack,
    audio: Sound | None,
    times: Floats,
    fps: float,
    seed: int,
    amount: float,
) -> Clip:
    check_life(amount, seed)
    prosody = find_prosody(track, None if audio is None else hear_voice(audio))
    blinks, gaze = (np.random.default_rng((seed, kind)) for kind in (_BLINKS, _GAZE))
    duration = float(times[-1])
    lids = lid_curve(plan_blinks(prosody.phrases, duration, fps, blinks), len(times), fps)
    angles = head_degrees(prosody, times, fps, (seed, _HEAD), amount)
    sideways, up = (amount * glance for glance in gaze_degrees(times, gaze))
    # The eyes stay on whom they look at while the head turns.
    curves = eye_curves(sideways - angles[:, 0], up - angles[:, 1], lids * (amount > 0))
    brows = brow_curves(prosody, len(times), fps, (seed, _BROWS))
    curves |= {name: amount * curve for name, curve in brows.items()}
    curves |= dict(zip(HEAD_ANGLES, np.radians(angles).T, strict=True))
    return Clip(tuple(curves), fps, np.stack(list(curves.values()), axis=1))
