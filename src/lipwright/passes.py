"""Passes: Clip to Clip, knowing what is said when. A list of callables that users can reorder.

    clip = apply_passes(clip, track, [intensity(1.2), smooth(), silence(), consonants()])

Each maker returns a `Pass`; `default_passes` is the list that `animate` uses. Their order matters:
what comes later wins, so closures come after everything that could open the lips.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, GROUPS
from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]

Pass = Callable[[Clip, PhoneTrack], Clip]

MAX_INTENSITY = 3.0
CEILING_KNEE = 0.8  # where a scaled control begins to bend towards its full range
SPEED_LIMIT = 15.0  # a second, full ranges; Xu et al. 2013, section 2.2.3
SMOOTHING = 0.012  # s, standard deviation; removes corners, keeps an 80 ms closure
SPEECH_LEAD = 0.12  # s before the first sound in which the mouth begins to open
SPEECH_TAIL = 0.16  # s after the last sound by which it is shut


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


# --- ease curves ---


def _ease_table(first: float, second: float) -> tuple[Floats, Floats]:
    t = np.linspace(0, 1, 257)
    x = 3 * first * (1 - t) ** 2 * t + 3 * second * (1 - t) * t**2 + t**3
    y = 3 * (1 - t) * t**2 + t**3
    return x, y


_EASE = _ease_table(0.5, 0.5)


def ease(x: npt.ArrayLike) -> Floats:
    """The cubic Bezier curve of the 2018 thesis (section 4.6.5), flat at both ends.

    Values of the shape of `x`, from 0 (for x at or below 0) to 1 (for x at or above 1).
    """
    return np.interp(np.asarray(x, np.float64), *_EASE)


# --- intensity ---


def intensity(amount: float) -> Pass:
    """Scale the motion of jaw and lips: 0.5 mumbles, 1 changes nothing, 1.5 over-articulates.

    What would pass the full range bends towards it instead of being cut off, and more is never
    less: a control that is over the knee already bends from where it is. Closures and the
    tongue are made by later passes and stay as they are.

    Raises:
        LipwrightError: the amount is not from 0 to 3.
    """
    if not 0 <= amount <= MAX_INTENSITY:
        raise LipwrightError(f"intensity is {amount}; give a number from 0 to {MAX_INTENSITY:.0f}")

    def scale(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        if amount == 1:
            return clip
        values = clip.values.copy()
        columns = [clip.column(n) for n in GROUPS["jaw"] + GROUPS["lips"] if n in clip.names]
        moved = values[:, columns]
        knee = np.clip(moved, CEILING_KNEE, 1) if amount > 1 else 1.0
        values[:, columns] = soft_ceiling(amount * moved, knee)
        return clip.with_values(values)

    return scale


def soft_ceiling(
    values: npt.NDArray[np.float32], knee: npt.ArrayLike = CEILING_KNEE
) -> npt.NDArray[np.float32]:
    """Values up to `knee` (one, or one a value) as they are; above it they approach 1."""
    bend = np.asarray(knee, np.float64)
    room = np.maximum(1 - bend, 1e-9)
    bent = bend + room * (1 - np.exp(-np.maximum(values - bend, 0) / room))
    return np.where(values > bend, bent, values).astype(np.float32)


# --- smoothing ---


def smooth(sigma: float = SMOOTHING) -> Pass:
    """Smooth every control with a Gaussian of `sigma` s around each frame: nothing is delayed.

    Raises:
        LipwrightError: sigma is negative or endless.
    """
    if not 0 <= sigma < math.inf:
        raise LipwrightError(f"smoothing is {sigma} s; give 0 or more")

    def filtered(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        reach = round(3 * sigma * clip.fps)
        if reach == 0:
            return clip
        steps = np.arange(-reach, reach + 1) / (sigma * clip.fps)
        weights = np.exp(-(steps**2) / 2)
        weights /= weights.sum()
        padded = np.pad(clip.values.astype(np.float64), ((reach, reach), (0, 0)), mode="edge")
        moving = np.flatnonzero(np.ptp(clip.values, axis=0) > 0)
        values = clip.values.copy()
        for column in moving:
            values[:, column] = np.convolve(padded[:, column], weights, mode="valid")
        return clip.with_values(values)

    return filtered


# --- silence ---


def speech_share(
    track: PhoneTrack, times: Floats, lead: float = SPEECH_LEAD, tail: float = SPEECH_TAIL
) -> Floats:
    """(T,), 1 in speech, 0 deep in silence, eased over `lead` s before and `tail` s after."""
    share = np.ones(len(times))
    index = 0
    for phone, run in groupby(track.phones):  # silences that follow each other are one pause
        begin, index = index, index + len(tuple(run))
        if phone != SILENCE:
            continue
        start, end = track.edges[begin], track.edges[index]
        first, stop = np.searchsorted(times, (start, end), side="left")
        if index == len(track):
            stop = len(times)
        inside = times[first:stop]
        nothing = np.zeros(len(inside))
        after = ease(1 - (inside - start) / tail) if begin > 0 else nothing
        before = ease(1 - (end - inside) / lead) if index < len(track) else nothing
        share[first:stop] = np.maximum(after, before)
    share[times < track.start - 1e-9] = 0
    return share


def silence(lead: float = SPEECH_LEAD, tail: float = SPEECH_TAIL) -> Pass:
    """Bring jaw, lips and tongue to rest where nothing is said.

    A pause shorter than `lead` + `tail` s closes the mouth only in part.

    Raises:
        LipwrightError: lead or tail is not above 0.
    """
    if not (lead > 0 and tail > 0):
        raise LipwrightError(f"lead is {lead} s and tail {tail} s; give numbers above 0")

    def hush(clip: Clip, track: PhoneTrack) -> Clip:
        share = speech_share(track, clip.times, lead, tail).astype(np.float32)
        names = GROUPS["jaw"] + GROUPS["lips"] + GROUPS["tongue"]
        return clip.with_curves({n: clip.curve(n) * share for n in names if n in clip.names})

    return hush


# --- parted lips ---

BILABIALS: Final = frozenset(("P", "B", "M", "EM"))
PARTED: Final = 0.07  # of jawOpen less mouthClose, that lips keep where no sound shuts them
NEAR_CLOSURE: Final = 0.06  # s before and after a closing sound in which lips may shut
PARTING: Final = 0.04  # s more, over which they are kept apart more and more


def parted(least: float = PARTED) -> Pass:
    """Keep the lips from shutting where no sound shuts them, as the mean of a network may do.

    Raises:
        LipwrightError: `least` is not from 0 to 1.
    """
    if not 0 <= least <= 1:
        raise LipwrightError(f"parted lips keep {least} of the jaw; give a number from 0 to 1")

    def open_up(clip: Clip, track: PhoneTrack) -> Clip:
        if not {"jawOpen", "mouthClose"} <= set(clip.names):
            return clip
        times = clip.times
        share = np.where(_said(track, times), 1.0, 0.0)
        for phone, start, end in track:
            if phone in BILABIALS:
                away = np.maximum(start - times, times - end) - NEAR_CLOSURE
                share = np.minimum(share, ease(away / PARTING))
        jaw, close = (clip.curve(name).astype(np.float64) for name in ("jawOpen", "mouthClose"))
        missing = np.maximum(least * share - (jaw - close), 0)
        back = np.minimum(missing, np.maximum(close, 0))
        return clip.with_curves({"jawOpen": jaw + missing - back, "mouthClose": close - back})

    return open_up


def _said(track: PhoneTrack, times: Floats) -> npt.NDArray[np.bool_]:
    """(T,), whether a phone is said at each time."""
    spoken = np.array([phone != SILENCE for phone in track.phones])
    index = np.searchsorted(track.edges, times, side="right") - 1
    inside = (index >= 0) & (index < len(track))
    return inside & spoken[np.clip(index, 0, len(track) - 1)]


# --- consonants ---

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
    Requirement(("T", "D", "N", "EN", "DX", "NX"), "Ten",
                {"tongueRaise": ("at_least", 0.95)}),
    Requirement(("L", "EL"), "Lid",
                {"tongueRaise": ("at_least", 0.9)}),
    Requirement(("K", "G", "NG", "ENG"), "Kit", {"tongueBack": ("at_least", 0.95)}),
    Requirement(("TH", "DH"), "THin",
                {"tonguePress": ("at_least", 0.95), "tongueOut": ("at_least", 0.08),
                 "jawOpen": ("at_least", 0.04), "mouthLowerDown": ("at_least", 0.1)}),
    Requirement(("SH", "ZH", "CH", "JH"), "SHe", {"mouthFunnel": ("at_least", 0.35)}),
    Requirement(("UW", "UX", "UH"), "tOO", {"mouthPucker": ("at_least", 0.45)}),
    Requirement(("OW", "AO", "OY"), "gO",
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
    Requirement(("SH", "ZH", "CH", "JH"), "SHe",
                {"mouthPucker": ("at_least", 0.35), "mouthFunnel": ("at_least", 0.1)}),
    Requirement(("OW", "AO", "OY"), "gO", {"mouthPucker": ("at_least", 0.4)}),
    Requirement(("UW", "UX", "UH"), "tOO", {"mouthPucker": ("at_least", 0.55)}),
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
            if not set(_sides(name)) & set(controls)
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


def _sides(name: str) -> tuple[str, ...]:
    return (name,) if name in CANONICAL else (f"{name}Left", f"{name}Right")


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
                for name in _sides(control):
                    if name in clip.names:
                        column = values[first:stop, clip.column(name)]
                        column += weight * (_TARGETS[mode](column, value) - column)
        return clip.with_values(values)

    return overlay


# --- limits ---

# Controls that shut the mouth: where they must slow down, they start earlier rather than reach
# less, or a closure would be lost.
CLOSERS: Final = frozenset(
    ("mouthClose", "mouthPressLeft", "mouthPressRight", "mouthRollLower", "mouthRollUpper")
)


def speed_limit(per_second: float = SPEED_LIMIT) -> Pass:
    """Let no control change faster than `per_second` full ranges a second.

    Peaks of controls that open the face are lowered, peaks of those that close it are widened;
    neither is delayed.

    Raises:
        LipwrightError: the limit is not above 0.
    """
    if not per_second > 0:
        raise LipwrightError(f"the speed limit is {per_second}; give a number above 0")

    def slow(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        step = per_second / clip.fps
        values = clip.values.astype(np.float64)
        fast = np.flatnonzero(np.abs(np.diff(values, axis=0)).max(axis=0, initial=0) > step)
        for column in fast:
            sign = -1.0 if clip.names[column] in CLOSERS else 1.0
            values[:, column] = sign * _lipschitz_below(sign * values[:, column], step)
        return clip.with_values(values)

    return slow


def _lipschitz_below(curve: Floats, step: float) -> Floats:
    """The highest curve under `curve` that changes by at most `step` a frame."""
    ramp = step * np.arange(len(curve))
    forward = np.minimum.accumulate(curve - ramp) + ramp
    reverse = np.minimum.accumulate((curve - ramp[::-1])[::-1])[::-1] + ramp[::-1]
    return np.minimum(forward, reverse)


def limit(low: float = 0.0, high: float = 1.0) -> Pass:
    """Keep every control within its range."""

    def bounded(clip: Clip, track: PhoneTrack) -> Clip:
        del track
        return clip.with_values(np.clip(clip.values, low, high))

    return bounded
