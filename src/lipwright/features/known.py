"""Phones that a network never learnt, replaced by what looks like them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace

import numpy as np

from lipwright.phones import PHONES, SILENCE, nearest_phones
from lipwright.track import PhoneTrack


def has_own_mouth(phone: str) -> bool:
    """Whether a phone shapes the mouth; one that is made in the throat leaves it to others."""
    return PHONES[phone].place != "glottal"


def seen_phones(tracks: Iterable[PhoneTrack]) -> tuple[str, ...]:
    """The phones that tracks hold and that shape the mouth, in the order of the table; sil first.

    Sounds of the throat (HH) are left out: in a small corpus they stand next to few vowels, and
    a network would take the mouth of those for theirs.
    """
    seen = {SILENCE}.union(*(track.phones for track in tracks))
    return tuple(phone for phone in PHONES if phone in seen and has_own_mouth(phone))


def replacement(phone: str, known: Collection[str]) -> tuple[str, ...]:
    """One phone of `known` that looks like `phone`, or two for a diphthong of known parts."""
    row = PHONES[phone]
    if phone in known:
        return (phone,)
    if row.is_diphthong and row.parts and all(part in known for part in row.parts):
        return row.parts
    spoken = [other for other in known if other != SILENCE]
    return nearest_phones(phone, spoken or known)[:1]


def _lent(phones: tuple[str, ...], index: int) -> str:
    """Whose mouth a sound of the throat takes: the vowel or glide after it, or that before it."""
    around = (*phones[index + 1 : index + 2], *phones[max(index - 1, 0) : index])
    for other in around:
        if PHONES[other].is_vowel or PHONES[other].manner == "approximant":
            return other
    return phones[index]


def known_track(track: PhoneTrack, known: Collection[str]) -> PhoneTrack:
    """The track in phones of `known` alone, each as near to the true one as can be seen.

    A sound of the throat (HH) takes the mouth of the vowel after it, a diphthong is split in the
    middle into its parts where both are known, and any other phone becomes the nearest of the
    phone table. Every edge stays; words and stress stay with their phones.

    Args:
        track: any track.
        known: symbols of the phone table, at least one; silence only stands for silence.

    Raises:
        ValueError: nothing is known, or a symbol that the phone table lacks.
    """
    check_phones(known)
    if all(phone in known for phone in track.phones):
        return track
    phones: list[str] = []
    stress: list[int | None] = []
    edges = [track.start]
    place = [0]  # of each phone of the track, and of its end, among the new ones
    for index, (phone, start, end) in enumerate(track):
        unknown = phone not in known
        if unknown and not has_own_mouth(phone):
            parts = replacement(_lent(track.phones, index), known)[:1]
        else:
            parts = replacement(phone, known)
        phones += parts
        stress += [track.stress[index]] * len(parts)
        edges += [(start + end) / 2, end] if len(parts) == 2 else [end]
        place.append(len(phones))
    words = (replace(w, first=place[w.first], stop=place[w.stop]) for w in track.words)
    return PhoneTrack(tuple(phones), np.asarray(edges), tuple(words), tuple(stress))


def check_phones(phones: Collection[str]) -> None:
    """Refuse a set of phones that is empty, or has one that the phone table lacks.

    Raises:
        ValueError: names the first such phone.
    """
    if not phones:
        raise ValueError("no phones are known")
    for phone in phones:
        if phone not in PHONES:
            raise ValueError(f"the phone table has no {phone!r}")
