"""The poses that a mapping is fitted to: what speech does with canonical controls."""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import CANONICAL
from lipwright.engines import engine_learnt, get_engine
from lipwright.passes import apply_passes, learnt_passes
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack

PHONE_SECONDS: Final = 0.12  # of ordinary running speech
POSES_FPS: Final = 4.0  # a pose for two phones


def every_pair() -> PhoneTrack:
    """English syllables: every consonant before every vowel, and a pause after each consonant."""
    english = [phone for name, phone in PHONES.items() if not name.startswith("X")]
    consonants = [phone.symbol for phone in english if phone.is_consonant]
    vowels = [phone.symbol for phone in english if phone.is_vowel]
    spoken: list[str] = []
    for row, consonant in enumerate(consonants):
        turned = vowels[row % len(vowels) :] + vowels[: row % len(vowels)]
        spoken += [SILENCE, *(phone for vowel in turned for phone in (consonant, vowel))]
    spoken.append(SILENCE)
    edges = np.arange(len(spoken) + 1, dtype=np.float64) * PHONE_SECONDS
    return PhoneTrack(tuple(spoken), edges)


TEACHERS: Final = ("window", "dominance")
"""engines: one moves as a recorded face does, one as articulation has it"""


@cache
def speech_poses() -> npt.NDArray[np.float64]:
    """(N, C), canonical controls while two engines speak `every_pair`; read-only."""
    track = every_pair()
    spoken = []
    for engine in TEACHERS:
        passes = learnt_passes(1.0, *engine_learnt(engine))
        clip = apply_passes(get_engine(engine)(track, POSES_FPS), track, passes)
        spoken.append(clip.select(CANONICAL).values.astype(np.float64))
    poses = np.concatenate(spoken)
    poses.setflags(write=False)
    return poses
