"""Passes for what lies between sounds: silence, and lips that nothing shuts."""

from __future__ import annotations

from itertools import groupby
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import GROUPS
from lipwright.errors import LipwrightError
from lipwright.passes.kinds import Floats, Pass, ease
from lipwright.phones import BILABIALS, SILENCE
from lipwright.track import PhoneTrack

SPEECH_LEAD = 0.12  # s before the first sound in which the mouth begins to open
SPEECH_TAIL = 0.16  # s after the last sound by which it is shut

PARTED: Final = 0.07  # of jawOpen less mouthClose, that lips keep where no sound shuts them
NEAR_CLOSURE: Final = 0.06  # s before and after a closing sound in which lips may shut
PARTING: Final = 0.04  # s more, over which they are kept apart more and more


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
