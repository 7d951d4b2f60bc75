"""Passes: Clip to Clip, knowing what is said when. A list of callables that users can reorder.

    clip = apply_passes(clip, track, [intensity(1.2), smooth(), silence(), consonants()])

Each maker returns a `Pass`; `default_passes` is the list that `animate` uses. Their order matters:
what comes later wins, so closures come after everything that could open the lips.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from types import MappingProxyType
from typing import Final

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
from lipwright.passes.expression import closures_kept, expression, pose_clip
from lipwright.passes.intensities import CLASSES, intensities, parse_intensities
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
    "CLASSES", "CLOSERS", "MAX_FADE", "REQUIREMENTS", "SHUT", "SHUT_JAW", "SPEECH_LEAD",
    "SPEECH_TAIL", "SPEED_LIMIT", "UNSEEN", "Pass", "Requirement", "apply_passes", "bigram_passes",
    "closures_kept", "consonants", "constrain", "default_passes", "ease", "expression",
    "finishing_passes", "intensities", "intensity", "learnt_passes", "limit", "limit_poses",
    "parse_intensities", "parted", "pose_clip", "remove_valleys", "requirements_beside", "silence",
    "smooth", "soft_ceiling", "speech_share", "speed_limit", "strength",
]  # fmt: skip


def apply_passes(clip: Clip, track: PhoneTrack, passes: Iterable[Pass]) -> Clip:
    """The clip after each pass in turn."""
    for step in passes:
        clip = step(clip, track)
    return clip


_NONE: Final[Mapping[str, float]] = MappingProxyType({})


def default_passes(amount: float = 1.0, amounts: Mapping[str, float] = _NONE) -> list[Pass]:
    """What `animate` applies to the clip of an engine of rules.

    Args:
        amount: the intensity.
        amounts: that of controls, parts of the face and classes of phones; see `intensities`.
    """
    scaled = _scaled(amount, amounts)
    return [*scaled, smooth(), silence(), consonants(), speed_limit(), limit()]


def learnt_passes(
    amount: float,
    phones: Collection[str],
    controls: Collection[str],
    amounts: Mapping[str, float] = _NONE,
) -> list[Pass]:
    """What `animate` applies to the clip of an engine that learnt from a real face.

    Args:
        amount: the intensity.
        phones: that it learnt.
        controls: that it predicts.
        amounts: as in `default_passes`.
    """
    scaled, sounds = _scaled(amount, amounts), consonants(requirements_beside(phones, controls))
    return [*scaled, smooth(), silence(), parted(), sounds, speed_limit(), limit()]


def finishing_passes(amount: float = 1.0, amounts: Mapping[str, float] = _NONE) -> list[Pass]:
    """What `animate` applies to speech in which closures are made already, as in bigrams."""
    return [*map(closures_kept, _scaled(amount, amounts)), limit()]


def _scaled(amount: float, amounts: Mapping[str, float]) -> list[Pass]:
    return [intensity(amount), intensities(amounts)] if amounts else [intensity(amount)]
