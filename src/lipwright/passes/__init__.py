"""Passes: Clip to Clip, knowing what is said when. A list of callables that users can reorder.

    clip = apply_passes(clip, track, [intensity(1.2), smooth(), silence(), consonants()])

Each maker returns a `Pass`; `default_passes` is the list that `animate` uses. Their order matters:
what comes later wins, so closures come after everything that could open the lips.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from lipwright.clip import Clip
from lipwright.passes.consonants import (
    MAX_FADE,
    REQUIREMENTS,
    SHUT,
    SHUT_JAW,
    UNSEEN,
    Requirement,
    consonants,
    requirements_beside,
    strength,
)
from lipwright.passes.kinds import Pass, ease
from lipwright.passes.poses import bigram_passes, constrain, limit_poses, remove_valleys
from lipwright.passes.resting import SPEECH_LEAD, SPEECH_TAIL, parted, silence, speech_share
from lipwright.passes.shaping import (
    CLOSERS,
    SPEED_LIMIT,
    intensity,
    limit,
    smooth,
    soft_ceiling,
    speed_limit,
)
from lipwright.track import PhoneTrack

__all__ = [
    "CLOSERS", "MAX_FADE", "REQUIREMENTS", "SHUT", "SHUT_JAW", "SPEECH_LEAD", "SPEECH_TAIL",
    "SPEED_LIMIT", "UNSEEN", "Pass", "Requirement", "apply_passes", "bigram_passes", "consonants",
    "constrain", "default_passes", "ease", "intensity", "learnt_passes", "limit", "limit_poses",
    "parted", "remove_valleys", "requirements_beside", "silence", "smooth", "soft_ceiling",
    "speech_share", "speed_limit", "strength",
]  # fmt: skip


def apply_passes(clip: Clip, track: PhoneTrack, passes: Iterable[Pass]) -> Clip:
    """The clip after each pass in turn."""
    for step in passes:
        clip = step(clip, track)
    return clip


def default_passes(amount: float = 1.0) -> list[Pass]:
    """What `animate` applies to the clip of an engine of rules; `amount` is the intensity."""
    return [intensity(amount), smooth(), silence(), consonants(), speed_limit(), limit()]


def learnt_passes(amount: float, phones: Collection[str], controls: Collection[str]) -> list[Pass]:
    """What `animate` applies to the clip of an engine that learnt from a real face.

    Args:
        amount: the intensity.
        phones: that it learnt.
        controls: that it predicts.
    """
    sounds = consonants(requirements_beside(phones, controls))
    return [intensity(amount), smooth(), silence(), parted(), sounds, speed_limit(), limit()]
