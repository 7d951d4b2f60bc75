"""The overlay engine: vowels eased into each other, and consonants laid over them.

The rule-based baseline of the 2018 thesis (sections 4.6.4 and 4.6.5), after MacNeilage and DeClerk
(1969) and Öhman (1967): a segment is a vowel or silence and all phones until the next. Its first
frame is an apex with the viseme of its vowel, and cubic Bezier curves ease from apex to apex. The
upper lip is lifted where something is said. Then each consonant's viseme is laid over what lies
beneath: in full where the consonant begins, faded in before and out after by the same curve.

Ours beyond the thesis, whose sentences are short and Swedish: a diphthong has two apexes, and
nothing eases for longer than `LONGEST_EASE`, so that slow speech and pauses are held.

Visemes are in `overlay_visemes.csv`, one row a phone, two a diphthong, fitted by
bench/fit_visemes.py: the thesis sought them by trial and error for the least squared error.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import groupby, pairwise
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Sound
from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL
from lipwright.curves import bezier_ease
from lipwright.engines.visemes import POSED, Floats, Viseme, by_name, load_visemes, to_canonical
from lipwright.phones import PHONES, SILENCE, nearest_phones
from lipwright.track import PhoneTrack

TABLE: Final = "overlay_visemes.csv"
TIMING: Final = ("hold", "fade_out")

EASE: Final = (0.5, 0.5)  # x of the control points of figure 4.7
LIP_EASE: Final = (0.6, 0.75)  # and of the upper lip's curve, section 4.6.5
FIVE_FRAMES: Final = 5 / 30  # s; the thesis's curves have 30 frames a second, section 4.2.1
FADE_IN: Final = 1.5  # phone lengths, section 4.6.5; that of fading out is in the table
UPPER_LIP: Final = 0.02  # of mouthUpperUp; the thesis names none, fits find 0 to 0.02

# Ours, for speech slower than the thesis's.
LONGEST_EASE: Final = 0.5  # s from apex to apex; a longer vowel keeps its viseme until then
LONGEST: Final = 0.06  # s of a consonant that its fades count; a longer one is held


@cache
def load_table() -> MappingProxyType[str, tuple[Viseme, ...]]:
    """Phone to its one or two visemes, from the table."""
    return by_name(load_visemes(TABLE, TIMING))


@cache
def visemes_of(phone: str) -> tuple[Viseme, ...]:
    """The visemes of a phone, or of the nearest phone of its kind that the table has."""
    table = load_table()
    if phone in table:
        return table[phone]
    kind = PHONES[phone].is_vowel
    return table[nearest_phones(phone, [p for p in table if PHONES[p].is_vowel == kind])[0]]


@dataclass(frozen=True)
class Apex:
    """A viseme and when it is reached."""

    time: float
    """s"""
    viseme: Viseme


def apexes(track: PhoneTrack) -> tuple[Apex, ...]:
    """The apexes of vowels and silences, in order; nothing is said before the track and after it.

    Before the first sound after a silence there is another apex of silence, five frames earlier,
    so that the mouth does not open all through the pause.
    """
    (rest,) = visemes_of(SILENCE)
    track = track.padded(0, track.end)
    found = [Apex(0.0, rest)] if PHONES[track.phones[0]].is_consonant else []
    for index, (phone, start, end) in enumerate(track):
        if PHONES[phone].is_consonant:
            continue
        parts = visemes_of(phone)
        length = (end - start) / len(parts)
        found += [Apex(start + at * length, part) for at, part in enumerate(parts)]
        audible = track.phones[index + 1 : index + 2] not in ((), (SILENCE,))
        if phone == SILENCE and audible and end - start > FIVE_FRAMES:
            found.append(Apex(end - FIVE_FRAMES, rest))
    return _held([*found, Apex(track.end, rest)])


def _held(found: list[Apex]) -> tuple[Apex, ...]:
    """The same, with an apex more where one is far from the next."""
    held = found[:1]
    for before, after in pairwise(found):
        if after.time - before.time > LONGEST_EASE:
            held.append(Apex(after.time - LONGEST_EASE, before.viseme))
        held.append(after)
    return tuple(held)


def eased(found: tuple[Apex, ...], times: Floats) -> tuple[npt.NDArray[np.intp], Floats]:
    """How each time lies between apexes: the index (T,) of the one before, the share of the next.

    The index is at most that of the last apex but one; all times after the last have a share of 1.
    """
    reached = np.array([apex.time for apex in found])
    before = np.clip(np.searchsorted(reached, times, side="right") - 1, 0, len(found) - 2)
    length = reached[before + 1] - reached[before]
    return before, bezier_ease((times - reached[before]) / length, *EASE)


def upper_lip(track: PhoneTrack, times: Floats) -> Floats:
    """(T,) how far speech lifts the upper lip, 0 to 1.

    It rises within five frames of the first sound and falls until the next silence; a vowel's own
    curve takes over where it is higher.
    """
    lifted = np.zeros(len(times))
    spoken = [phone != SILENCE for phone in track.phones]
    index = 0
    for said, run in groupby(spoken):
        first, index = index, index + len(tuple(run))
        start, end = float(track.edges[first]), float(track.edges[index])
        part = slice(*np.searchsorted(times, (start, end)))
        if said and part.start < part.stop:
            vowels = [at for at in range(first + 1, index) if PHONES[track.phones[at]].is_vowel]
            lifted[part] = _lift(np.array([start, *track.edges[vowels]]), end, times[part])
    return lifted


def _lift(starts: Floats, end: float, times: Floats) -> Floats:
    """(T,) the highest of curves that rise from `starts`, (S,) s, and all fall until `end` s."""
    peaks = starts + np.minimum(FIVE_FRAMES, (end - starts) / 2)
    # Of curves that fall to one end the last is the highest, and of those that rise the first.
    last = np.searchsorted(peaks, times, side="right") - 1
    rising = np.minimum(last + 1, len(starts) - 1)
    fall = bezier_ease((end - times) / (end - peaks[last]), *LIP_EASE)
    rise = bezier_ease((times - starts[rising]) / (peaks[rising] - starts[rising]), *LIP_EASE)
    return np.where(last < 0, rise, np.where(rising > last, np.maximum(fall, rise), fall))


@dataclass(frozen=True)
class Laid:
    """A consonant's viseme, and when it is laid over the vowels."""

    viseme: Viseme
    start: float
    """s, from which it is there in full"""
    stop: float
    """s, until which it is"""
    fade_in: float
    """s before that"""
    fade_out: float
    """s after that"""

    def strength(self, times: Floats) -> Floats:
        """(T,), 0 to 1."""
        risen = bezier_ease((times - self.start + self.fade_in) / self.fade_in, *EASE)
        left = bezier_ease((self.stop + self.fade_out - times) / self.fade_out, *EASE)
        return np.minimum(risen, left)


def laid_over(track: PhoneTrack) -> tuple[Laid, ...]:
    """The consonants' visemes in the order in which they are laid: that of the table.

    Where two meet the later wins: lips must shut, whatever is beside them.
    """
    order = {phone: at for at, phone in enumerate(load_table())}
    found: list[tuple[int, Laid]] = []
    for phone, start, end in track:
        if not PHONES[phone].is_consonant:
            continue
        (viseme,) = visemes_of(phone)
        length = min(end - start, LONGEST)
        held = end - start - length + viseme.timing["hold"] * length
        fades = FADE_IN * length, viseme.timing["fade_out"] * length
        found.append((order[viseme.name], Laid(viseme, start, start + held, *fades)))
    return tuple(laid for _, laid in sorted(found, key=lambda item: item[0]))


CHUNK_FRAMES: Final = 2048  # computed at once, so that an hour needs no more memory than a minute


def _chunk(
    between: tuple[Apex, ...], poses: Floats, over: tuple[Laid, ...], lip: Floats, times: Floats
) -> Floats:  # fmt: skip
    """(T, K) weights of POSED."""
    before, share = eased(between, times)
    posed = poses[before] + share[:, None] * (poses[before + 1] - poses[before])
    posed[:, POSED.index("mouthUpperUp")] += UPPER_LIP * lip
    for laid in over:
        first, stop = np.searchsorted(times, (laid.start - laid.fade_in, laid.stop + laid.fade_out))
        weight = laid.strength(times[first:stop])
        for control, value in laid.viseme.values.items():
            column = posed[first:stop, POSED.index(control)]
            column += weight * (value - column)
    return posed


def animate(track: PhoneTrack, fps: float, audio: Sound | None = None) -> Clip:
    """The motion of a track, in the canonical controls; `audio` is not listened to."""
    del audio
    times = frame_times(track.end, fps)
    between, over, lip = apexes(track), laid_over(track), upper_lip(track, times)
    poses = np.array([apex.viseme.pose() for apex in between])
    starts = np.array([laid.start - laid.fade_in for laid in over])
    stops = np.array([laid.stop + laid.fade_out for laid in over])
    values = np.zeros((len(times), len(CANONICAL)), np.float32)
    for first in range(0, len(times), CHUNK_FRAMES):
        part = slice(first, first + CHUNK_FRAMES)
        now = times[part]
        near = np.flatnonzero((starts < now[-1]) & (stops > now[0]))
        here = tuple(over[index] for index in near)
        values[part] = to_canonical(_chunk(between, poses, here, lip[part], now))
    return Clip(CANONICAL, fps, values)
