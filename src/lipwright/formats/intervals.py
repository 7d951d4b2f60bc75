"""Labelled intervals as files hold them, and the phone track that they make."""

from __future__ import annotations

import bisect
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from lipwright.controls import is_text
from lipwright.errors import LipwrightError
from lipwright.formats.source import MAX_SECONDS
from lipwright.phones import (
    SILENCE,
    Alphabet,
    guess_alphabet,
    is_silence_label,
    parse_phone,
)
from lipwright.track import PhoneTrack, Word

PathLike = str | os.PathLike[str]

PAST_END = 0.05  # s; aligners pad the last frame, and lossy codecs lose a little of the end
SNAP = 0.0005  # s; less than this between the last edge and the sound's end is rounding
ALPHABETS: tuple[Alphabet, ...] = ("arpabet", "ipa", "xsampa")


@dataclass(frozen=True)
class Interval:
    """One labelled stretch of time."""

    start: float
    """s"""
    end: float
    """s"""
    label: str
    """as it stands in the file"""
    place: str
    """where it stands in the file: `line 12`"""

    @property
    def where(self) -> str:
        """Place and time, for an error."""
        return f"{self.place} ({self.start:.3f} s)"


@dataclass(frozen=True)
class Joint:
    """How a format's neighbouring intervals meet."""

    tolerance: float
    """s; a gap or overlap up to this is rounding"""
    gaps: Literal["error", "silence"]
    """what a longer gap is"""


def intervals_to_track(
    path: PathLike,
    intervals: Sequence[Interval],
    joint: Joint,
    *,
    words: Sequence[Interval] = (),
    alphabet: Alphabet | None = None,
    duration: float | None = None,
) -> PhoneTrack:
    """The phone track of the intervals of `path`.

    Args:
        path: the file, for errors.
        intervals: phones in order; an empty label is silence.
        joint: how they meet.
        words: words in order; one takes the phones whose middle it spans, and is left out where
            it spans none.
        alphabet: of the labels; guessed from all of them by default.
        duration: of the sound in s; see `fit_track`.

    Raises:
        LipwrightError: there are none, one is out of order, a gap or overlap, or unknown phones.
    """
    if not intervals:
        raise LipwrightError(f"{path}: holds no phones; align the sound again")
    for interval in intervals:
        _check_times(path, interval)
    phones, stress = _parse_labels(path, intervals, alphabet)
    edges, places = [intervals[0].start], [intervals[0].place]
    joined: list[tuple[str, int | None]] = [(phones[0], stress[0])]
    for index, (before, after) in enumerate(pairwise(intervals), 1):
        if _is_gap(path, before, after, joint):
            edges.append(before.end)
            joined.append((SILENCE, None))
            places.append(after.place)
        edges.append(after.start)
        joined.append((phones[index], stress[index]))
        places.append(after.place)
    edges.append(intervals[-1].end)
    track = PhoneTrack(
        tuple(phone for phone, _ in joined),
        np.asarray(edges),
        _assign_words(path, edges, words),
        tuple(mark for _, mark in joined),
    )
    return fit_track(path, track, places, duration)


def _check_times(path: PathLike, interval: Interval) -> None:
    if not 0 <= interval.start <= MAX_SECONDS or not interval.end <= MAX_SECONDS:
        raise LipwrightError(
            f"{path}: {interval.place}: its times, {interval.start:g} to {interval.end:g} s, are "
            f"not between 0 and {MAX_SECONDS:g} s; correct them"
        )
    if not interval.start < interval.end:
        raise LipwrightError(
            f"{path}: {interval.where}: ends at {interval.end:.3f} s, not after its start; "
            "correct its times or delete it"
        )


def _is_gap(path: PathLike, before: Interval, after: Interval, joint: Joint) -> bool:
    """Whether silence belongs between two neighbours."""
    gap = after.start - before.end
    if gap < -joint.tolerance or after.start <= before.start:
        raise LipwrightError(
            f"{path}: {after.where}: overlaps {before.place}, which ends at {before.end:.3f} s; "
            "let each phone start where the last one ends"
        )
    if gap > joint.tolerance and joint.gaps == "error":
        raise LipwrightError(
            f"{path}: {after.where}: a gap of {gap:.3f} s lies before it, after {before.place}; "
            "close it, or label it as silence"
        )
    return gap > joint.tolerance


def _parse_labels(
    path: PathLike, intervals: Sequence[Interval], alphabet: Alphabet | None
) -> tuple[list[str], list[int | None]]:
    labels = [interval.label for interval in intervals]
    if alphabet is None:
        alphabet = _closest_alphabet(labels)
    phones: list[str] = []
    stress: list[int | None] = []
    for interval in intervals:
        try:
            phone, mark = parse_phone(interval.label, alphabet)
        except LipwrightError:
            raise LipwrightError(
                f"{path}: {interval.where}: unknown {alphabet} phone {interval.label[:24]!r}; "
                "correct it ('lipwright phones' lists the known ones)"
            ) from None
        phones.append(phone)
        stress.append(mark)
    return phones, stress


def _closest_alphabet(labels: Iterable[str]) -> Alphabet:
    """The alphabet that spells all labels or, where none does, most of them."""
    labels = list(dict.fromkeys(labels))
    try:
        return guess_alphabet(labels)
    except LipwrightError:
        return min(ALPHABETS, key=lambda alphabet: len(unknown_labels(labels, alphabet)))


def unknown_labels(labels: Iterable[str], alphabet: Alphabet) -> list[str]:
    """Those of the labels that an alphabet lacks."""
    unknown = []
    for label in labels:
        try:
            parse_phone(label, alphabet)
        except LipwrightError:
            unknown.append(label)
    return unknown


def _assign_words(
    path: PathLike, edges: Sequence[float], words: Sequence[Interval]
) -> tuple[Word, ...]:
    # A word of a track has no white space; a tier may hold "New York".
    texts = ["_".join(word.label.split()) for word in words]
    for word, text in zip(words, texts, strict=True):
        _check_times(path, word)
        if not is_text(text):
            raise LipwrightError(
                f"{path}: {word.where}: the word {text[:24]!a} has a control character; delete it"
            )
    for before, after in pairwise(words):
        if after.start < before.start:
            raise LipwrightError(f"{path}: {after.where}: out of order; sort the words by time")
    starts = [word.start for word in words]
    runs: dict[int, tuple[int, int]] = {}  # word to its first phone and the one after its last
    for phone, (start, end) in enumerate(pairwise(edges)):
        middle = (start + end) / 2
        index = bisect.bisect_right(starts, middle) - 1
        if index >= 0 and middle < words[index].end and not is_silence_label(words[index].label):
            runs[index] = (runs.get(index, (phone, 0))[0], phone + 1)
    return tuple(Word(texts[index], *run) for index, run in sorted(runs.items()))


def fit_track(
    path: PathLike, track: PhoneTrack, places: Sequence[str], duration: float | None
) -> PhoneTrack:
    """The track over the whole of a sound, from 0 to `duration` s; unchanged if that is None.

    What reaches at most `PAST_END` past the end of the sound is cut there. What the track does
    not cover is silence.

    Args:
        path: the file, for errors.
        track: the track.
        places: where each phone stands in the file.
        duration: of the sound in s, above 0.

    Raises:
        LipwrightError: the track goes on after the sound; names the first phone that does.
    """
    if duration is None:
        return track
    late = int(np.searchsorted(track.edges[1:], duration + PAST_END, side="right"))
    count = int(np.searchsorted(track.edges[:-1], duration, side="left"))
    if late < len(track) or count == 0:
        late = late if late < len(track) else 0
        raise LipwrightError(
            f"{path}: {places[late]} ({track.edges[late]:.3f} s): ends at "
            f"{track.edges[late + 1]:.3f} s, past the end of the sound ({duration:.3f} s); name "
            "the file of this sound, or correct the time"
        )
    edges = np.minimum(track.edges[: count + 1], duration)
    if track.phones[count - 1] == SILENCE or duration - edges[-1] < SNAP:
        edges[-1] = duration
    if track.phones[0] == SILENCE or edges[0] < SNAP:
        edges[0] = 0.0
    words = tuple(
        replace(word, stop=min(word.stop, count)) for word in track.words if word.first < count
    )
    fitted = PhoneTrack(track.phones[:count], edges, words, track.stress[:count])
    return fitted.padded(0.0, duration)
