"""Which pairs of phones a track needs, and what stands in for those that a set lacks.

After Xu et al. 2013, section 4.3: a set may be drawn in part, as far as a sentence needs it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import pairwise
from math import inf
from typing import Final
from weakref import WeakKeyDictionary

from lipwright.bigrams.values import Bigram, BigramSet, Pair
from lipwright.phones import SILENCE, phone_distance
from lipwright.track import PhoneTrack

UNLIKE: Final = 5.0  # `phone_distance` of a vowel and a consonant that is no glide

StandIn = tuple[Bigram | None, Pair | None]

_found: WeakKeyDictionary[BigramSet, dict[Pair, StandIn]] = WeakKeyDictionary()


def needed_pairs(bigrams: BigramSet, tracks: Iterable[PhoneTrack]) -> Counter[Pair]:
    """How often each pair of classes is said; silences that follow each other are one."""
    return Counter(pair for track in tracks for pair in pairwise(_classes(bigrams, track.phones)))


def _classes(bigrams: BigramSet, phones: Iterable[str]) -> Iterator[str]:
    last = ""
    for phone in phones:
        if not phone == last == SILENCE:
            yield bigrams.class_of(phone)
        last = phone


def stand_in(bigrams: BigramSet, pair: Pair) -> StandIn:
    """The bigram to play for a pair of classes, and whose it is.

    That is the pair itself; or else the pair of the most alike classes that the set has, with one
    side changed before both are; or else (None, None): every pose rests. A silence never stands
    in for a sound, nor a sound for a silence; nor a consonant for a vowel, but for glides.
    """
    found = _found.setdefault(bigrams, {})
    if pair not in found:
        found[pair] = _search(bigrams, pair)
    return found[pair]


def missing(bigrams: BigramSet, track: PhoneTrack) -> list[tuple[Pair, int, Pair | None]]:
    """The pairs that a track needs and the set lacks, most frequent first.

    Returns:
        Pair, how often the track has it, and the pair that stands in for it, or None for rest.
    """
    needed = needed_pairs(bigrams, [track])
    rows = sorted(needed.items(), key=lambda row: (-row[1], row[0]))
    return [
        (pair, count, stand_in(bigrams, pair)[1])
        for pair, count in rows
        if pair not in bigrams.bigrams
    ]


def _search(bigrams: BigramSet, pair: Pair) -> StandIn:
    if pair in bigrams.bigrams:
        return bigrams.bigrams[pair], pair
    for other in _candidates(tuple(bigrams.classes.items()), pair):
        if other in bigrams.bigrams:
            return bigrams.bigrams[other], other
    return None, None


@lru_cache(maxsize=1024)
def _candidates(classes: tuple[tuple[str, tuple[str, ...]], ...], pair: Pair) -> tuple[Pair, ...]:
    """The pairs that may stand in for one, the most alike first."""
    first, second = (_alike(classes, one) for one in pair)
    one_side = [(distance, (other, pair[1])) for other, distance in first.items()]
    one_side += [(distance, (pair[0], other)) for other, distance in second.items()]
    both = [
        (near + nearer, (one, other))
        for one, near in first.items()
        for other, nearer in second.items()
    ]
    return tuple(other for _, other in (*sorted(one_side), *sorted(both)))


@lru_cache(maxsize=4096)
def _alike(classes: tuple[tuple[str, tuple[str, ...]], ...], name: str) -> dict[str, float]:
    """Every other class that may stand in for one, to its distance; least of their phones'."""
    phones = dict(classes).get(name, ())
    if not phones:
        return {}
    silent = SILENCE in phones
    distances = {
        other: min((_distance(a, b) for a in phones for b in theirs), default=inf)
        for other, theirs in classes
        if other != name and (SILENCE in theirs) == silent
    }
    return {other: distance for other, distance in distances.items() if distance < UNLIKE}


_distance = lru_cache(maxsize=None)(phone_distance)
