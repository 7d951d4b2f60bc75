"""Where takes that begin with the same words share these, and one take in the time of another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.dataset.folder import Dataset
from lipwright.dataset.recording import PHONES_FILE
from lipwright.formats import read_track
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]

FIRST_WORDS: Final = 4  # that two takes share; of GRID's six, so that most sentences have a partner


@dataclass(frozen=True, eq=False)
class Shared:
    """Where the same words are in two takes.

    Raises:
        ValueError: the edges differ in number, are fewer than two, or fall.
    """

    own_edges: Floats
    """(E,) s, not falling: the edges of one take"""
    other_edges: Floats
    """(E,) s, not falling: the same edges in the other"""
    is_same: bool
    """whether the phones are the same, pauses among them"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        for name in ("own_edges", "other_edges"):
            array = np.array(getattr(self, name), np.float64)
            if array.ndim != 1 or len(array) < 2 or (np.diff(array) < 0).any():
                raise ValueError(f"{name} are not two or more times that do not fall")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if len(self.own_edges) != len(self.other_edges):
            raise ValueError("two takes with different numbers of edges")


def partners(
    words: Mapping[str, Sequence[str]], of: Sequence[str], count: int = FIRST_WORDS
) -> dict[str, tuple[str, ...]]:
    """The other recordings, of any split, whose first words are the same.

    Args:
        words: recording to its words, as written; capitals do not count.
        of: the recordings that are looked for partners.
        count: of the first words.

    Returns:
        Those of `of` that have a partner, in their order, to their partners in the order of
        `words`.
    """
    alike: dict[tuple[str, ...], list[str]] = {}
    for name, said in words.items():
        if len(said) >= count:
            alike.setdefault(_beginning(said, count), []).append(name)
    found = {
        name: tuple(one for one in alike.get(_beginning(words[name], count), ()) if one != name)
        for name in of
    }
    return {name: others for name, others in found.items() if others}


def _beginning(said: Sequence[str], count: int) -> tuple[str, ...]:
    return tuple(word.casefold() for word in said[:count])


def words_of(dataset: Dataset) -> dict[str, tuple[str, ...]]:
    """The words of every usable recording of a dataset, from its phones.

    Raises:
        LipwrightError: the phones of a recording cannot be read.
    """
    return {
        name: tuple(word.text for word in read_track(dataset.folder(name) / PHONES_FILE).words)
        for name in dataset.names()
    }


def first_words(track: PhoneTrack, count: int = FIRST_WORDS) -> PhoneTrack | None:
    """The part of a track with its first words; None where it has fewer, or they are silent."""
    if len(track.words) < count or count < 1:
        return None
    words = track.words[:count]
    first, stop = words[0].first, words[-1].stop
    if set(track.phones[first:stop]) == {SILENCE}:
        return None
    moved = tuple(replace(w, first=w.first - first, stop=w.stop - first) for w in words)
    return PhoneTrack(track.phones[first:stop], track.edges[first : stop + 1], moved)


def shared_span(own: PhoneTrack, other: PhoneTrack, count: int = FIRST_WORDS) -> Shared | None:
    """The edges that two tracks share in their first words, which are the same.

    Where a word is said otherwise or one take pauses, phones are matched word by word: others are
    stretched from match to match, one that only the other take has is skipped, and during one that
    it lacks it stands still.

    Returns:
        None where a track has no such words.
    """
    mine, theirs = first_words(own, count), first_words(other, count)
    if mine is None or theirs is None:
        return None
    edges = {(0, 0), (len(mine), len(theirs))}
    matcher = SequenceMatcher(None, _labels(mine), _labels(theirs), autojunk=False)
    for block in matcher.get_matching_blocks():
        if block.size:
            edges |= {(block.a + step, block.b + step) for step in range(block.size + 1)}
    places = np.array(sorted(edges))
    return Shared(
        mine.edges[places[:, 0]], theirs.edges[places[:, 1]], mine.phones == theirs.phones
    )


def _labels(track: PhoneTrack) -> list[tuple[int, str]]:
    """Each phone with the number of its word; what is between words belongs to the word before."""
    numbers = [sum(word.first <= index for word in track.words) for index in range(len(track))]
    return list(zip(numbers, track.phones, strict=True))


def times_in_other(shared: Shared, times: npt.ArrayLike) -> Floats:
    """(T,) s, the times in the other take of times in one; as fast outside the shared words."""
    at, own, other = np.asarray(times, np.float64), shared.own_edges, shared.other_edges
    inside = np.interp(at, own, other)
    return np.asarray(inside + np.minimum(at - own[0], 0) + np.maximum(at - own[-1], 0))


def warp(
    values: npt.NDArray[np.floating[Any]], times: Floats, shared: Shared, own_times: Floats
) -> Floats:  # fmt: skip
    """The other take's curves at the times of one take, piecewise linear between edges.

    Args:
        values: (T, C) of the other take.
        times: (T,) s, rising, its times.
        shared: the edges of both.
        own_times: (T',) s.

    Returns:
        (T', C), held before the first and after the last frame.
    """
    at = times_in_other(shared, own_times)
    return np.stack([np.interp(at, times, column) for column in values.T], axis=1)
