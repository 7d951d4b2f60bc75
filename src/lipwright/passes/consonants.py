"""The pass that lays over the motion what each sound must look like."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from lipwright.clip import Clip
from lipwright.controls import both_sides
from lipwright.passes.kinds import Floats, Pass, ease
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

Mode = Literal["to", "at_least", "at_most"]


@dataclass(frozen=True)
class Requirement:
    """What a sound must look like, laid over the motion while it is said."""

    phones: tuple[str, ...]
    example: str
    controls: Mapping[str, tuple[Mode, float]]
    """control (without a side: both sides) to what it must be at full strength"""
    full: tuple[float, float] = (0.2, 0.6)
    """shares of the phone between which the requirement holds in full"""
    fade_in: float = 1.0
    """phone lengths in which it fades in before that"""
    fade_out: float = 1.0
    """phone lengths in which it fades out after that"""
    longest: float = 1.0
    """s; of a longer phone only so much counts: its beginning, or its end after a pause"""
    early: float = 0.0
    """s by which it comes earlier after a pause, where the lips part before the sound; at most
    the length of the pause"""


MAX_FADE = 0.09  # s; a long phone, as after a pause, is not closed earlier than a short one
SHUT_JAW = 0.05  # jawOpen that closed lips keep, cancelled by mouthClose


# The lips touch: the jaw is nearly up, and what it leaves open is closed.
SHUT: Final[Mapping[str, tuple[Mode, float]]] = MappingProxyType({
    "jawOpen": ("to", SHUT_JAW), "mouthClose": ("to", SHUT_JAW), "mouthPress": ("to", 0.25),
    "mouthLowerDown": ("to", 0.0), "mouthUpperUp": ("to", 0.0), "mouthFunnel": ("to", 0.0),
    "mouthRollLower": ("to", 0.0), "mouthShrugUpper": ("to", 0.0), "tongueOut": ("to", 0.0),
})  # fmt: skip

# In the order in which they are laid on: where two meet, the later wins, as lips must close even
# between rounded vowels (the order of priorities in Xu et al. 2013, section 2.2.2).
REQUIREMENTS: Final[tuple[Requirement, ...]] = (
    Requirement(("T", "D", "N", "EN", "DX", "NX", "XT", "XD", "XN", "XR", "XTS", "XTC"), "Ten",
                {"tongueRaise": ("at_least", 0.95)}),
    Requirement(("L", "EL", "XL"), "Lid",
                {"tongueRaise": ("at_least", 0.9)}),
    Requirement(("K", "G", "NG", "ENG"), "Kit", {"tongueBack": ("at_least", 0.95)}),
    Requirement(("TH", "DH"), "THin",
                {"tonguePress": ("at_least", 0.95), "tongueOut": ("at_least", 0.08),
                 "jawOpen": ("at_least", 0.04), "mouthLowerDown": ("at_least", 0.1)}),
    Requirement(("SH", "ZH", "CH", "JH", "XS", "XZ", "XCH", "XH"), "SHe",
                {"mouthFunnel": ("at_least", 0.35)}),
    Requirement(("UW", "UX", "UH", "XIY", "XIH", "XEY"), "tOO",
                {"mouthPucker": ("at_least", 0.45)}),
    Requirement(("OW", "AO", "OY", "XEH"), "gO",
                {"mouthFunnel": ("at_least", 0.2), "mouthPucker": ("at_least", 0.2)}),
    Requirement(("W", "WH"), "With",
                {"mouthPucker": ("at_least", 0.6), "jawOpen": ("at_most", 0.08)}),
    Requirement(("F", "V"), "Fork",
                {"jawOpen": ("at_most", 0.08), "mouthRollLower": ("to", 0.4),
                 "mouthUpperUp": ("at_least", 0.3), "mouthLowerDown": ("at_most", 0.0),
                 "mouthFunnel": ("at_most", 0.1)}),
    # When the real lips are shut, against the aligned phones of 1,144 closures of GRID speaker 1.
    Requirement(("M", "EM"), "Mat", SHUT, (0.6, 0.9), 0.5, 0.5),
    Requirement(("P", "B"), "Put", SHUT, (0.3, 0.5), 0.3, 0.3, longest=0.1, early=0.03),
)  # fmt: skip

# What a camera sees too little of, and so no network learns: the lip behind the teeth, and lips
# that are pushed towards it. None of these opens or shuts the lips by much.
UNSEEN: Final[tuple[Requirement, ...]] = (
    Requirement(("SH", "ZH", "CH", "JH", "XS", "XZ", "XCH", "XH"), "SHe",
                {"mouthPucker": ("at_least", 0.35), "mouthFunnel": ("at_least", 0.1)}),
    Requirement(("OW", "AO", "OY", "XEH"), "gO", {"mouthPucker": ("at_least", 0.4)}),
    Requirement(("UW", "UX", "UH", "XIY", "XIH", "XEY"), "tOO",
                {"mouthPucker": ("at_least", 0.55)}),
    Requirement(("W", "WH"), "With", {"mouthPucker": ("at_least", 0.6)}),
    Requirement(("F", "V"), "Fork", {"mouthRollLower": ("at_least", 0.4)}),
)  # fmt: skip


def requirements_beside(
    phones: Collection[str], controls: Collection[str]
) -> tuple[Requirement, ...]:
    """What an engine still needs that learnt some sounds from a real face.

    Closures stay as they are, for a mean never shuts the lips. Of the other sounds that it learnt,
    what its controls do not show (the tongue) and what no camera sees are laid over; of those that
    it never heard, everything. Sounds of one row look alike: who heard one knows them all.

    Args:
        phones: that it learnt.
        controls: that it predicts.
    """
    unseen = [r for r in UNSEEN if set(r.phones) & set(phones)]
    kept: list[Requirement] = []
    for requirement in REQUIREMENTS:
        hidden = {
            name: target
            for name, target in requirement.controls.items()
            if not set(both_sides(name)) & set(controls)
        }
        if requirement.controls is SHUT or not set(requirement.phones) & set(phones):
            kept.append(requirement)
        elif hidden:
            kept.append(replace(requirement, controls=hidden))
    return (*unseen, *kept)


def strength(
    requirement: Requirement, start: float, end: float, times: Floats,
    pause: float = 0.0, least: float = 0.0,
) -> Floats:  # fmt: skip
    """(T,), how far a requirement holds for a phone from `start` to `end` s; 0 to 1.

    `pause` is the length in s of the silence before the phone. The requirement holds in full for
    at least `least` s around the middle of its full strength.
    """
    length = min(end - start, requirement.longest)
    if pause > 0:
        start = end - length - min(requirement.early, pause)
    fade_in = min(requirement.fade_in * length, MAX_FADE)
    fade_out = min(requirement.fade_out * length, MAX_FADE)
    first, last = (start + share * length for share in requirement.full)
    eased = np.minimum(ease((times - first + fade_in) / fade_in),
                       ease((last + fade_out - times) / fade_out))  # fmt: skip
    return np.where(np.abs(times - (first + last) / 2) <= least / 2, 1.0, eased)


_TARGETS: Final[Mapping[Mode, Callable[[Floats, float], Floats]]] = {
    "to": np.full_like,
    "at_least": np.maximum,
    "at_most": np.minimum,
}


def consonants(requirements: Sequence[Requirement] = REQUIREMENTS) -> Pass:
    """Lay every sound's requirements over the motion, eased in and out around it."""
    wanted: dict[str, list[Requirement]] = {}
    for requirement in requirements:
        for phone in requirement.phones:
            wanted.setdefault(phone, []).append(requirement)
    order = {id(requirement): place for place, requirement in enumerate(requirements)}

    def overlay(clip: Clip, track: PhoneTrack) -> Clip:
        values, times = clip.values.astype(np.float64), clip.times
        # One frame holds in full, or a short closure would be lost between two.
        frame = 1.001 / clip.fps
        jobs = [
            (order[id(requirement)], index, requirement)
            for index, phone in enumerate(track.phones)
            for requirement in wanted.get(phone, ())
        ]
        for _, index, requirement in sorted(jobs, key=lambda job: job[:2]):
            start, end = track.edges[index], track.edges[index + 1]
            reach = MAX_FADE + frame
            first, stop = np.searchsorted(times, (start - reach, end + reach))
            silent = index > 0 and track.phones[index - 1] == SILENCE
            pause = start - track.edges[index - 1] if silent else 0.0
            weight = strength(requirement, start, end, times[first:stop], pause, frame)
            for control, (mode, value) in requirement.controls.items():
                for name in both_sides(control):
                    if name in clip.names:
                        column = values[first:stop, clip.column(name)]
                        column += weight * (_TARGETS[mode](column, value) - column)
        return clip.with_values(values)

    return overlay
