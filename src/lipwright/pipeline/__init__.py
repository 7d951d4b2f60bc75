"""From speech to motion: the column of verbs.

audio, words -> align -> track -> engine -> clip -> passes -> rig -> performance
audio        -> listen -> track
text         -> voice -> audio, track
"""

from __future__ import annotations

from lipwright.pipeline.animating import animate
from lipwright.pipeline.motion import animate_track
from lipwright.pipeline.options import AnimateOptions, PathLike, Report, moves_heads, rig_of
from lipwright.pipeline.saying import SayOptions, say
from lipwright.pipeline.values import Result
from lipwright.pipeline.words import (
    ALIGNMENT_RATE,
    AlignOptions,
    align_sound,
    align_speech,
    hear_sound,
    hear_speech,
    language_of,
)

__all__ = [
    "ALIGNMENT_RATE",
    "AlignOptions",
    "AnimateOptions",
    "PathLike",
    "Report",
    "Result",
    "SayOptions",
    "align_sound",
    "align_speech",
    "animate",
    "animate_track",
    "hear_sound",
    "hear_speech",
    "language_of",
    "moves_heads",
    "rig_of",
    "say",
]
