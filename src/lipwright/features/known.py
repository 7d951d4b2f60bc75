"""Phones that a network never learnt, replaced by what looks like them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.phones import PHONES, SILENCE, nearest_phones
from lipwright.track import PhoneTrack


def has_own_mouth(phone: str) -> bool:
    """Whether a phone shapes the mouth; one that is made in the throat leaves it to others."""
    return PHONES[phone].place != "glottal"


def is_lent(phone: str, known: Collection[str]) -> bool:
    """Whether a phone that is not known takes the mouth of the phones beside it."""
    return phone not in known and not has_own_mouth(phone)


def seen_phones(tracks: Iterable[PhoneTrack]) -> tuple[str, ...]:
    """The phones that tracks hold and that shape the mouth, in the order of the table; sil first.

    Sounds of the throat (HH) are left out: in a small corpus they stand next to few vowels, and
    a network would take the mouth of those for theirs.
    """
    seen = {SILENCE}.union(*(track.phones for track in tracks))
    return tuple(phone for phone in PHONES if phone in seen and has_own_mouth(phone))


# Where the phone table's distance, which is of how phones are made, is not what is seen.
LOOKS_LIKE: Final = MappingProxyType({
    "NG": ("N",), "ENG": ("N",),  # G opens a syllable, NG and N close it; the tongue is not seen
    "NX": ("N",),  # as near as D, but as short and weak as N
    "IX": ("IH",),  # weak: not as spread as IY, which is as high
})  # fmt: skip

WEAKEST: Final = "AX"  # a mouth at ease: what the throat's sounds take where they stand alone


@cache
def replacement(phone: str, known: frozenset[str]) -> tuple[str, ...]:
    """One phone of `known` that looks like `phone`, or two for a diphthong of known parts."""
    row = PHONES[phone]
    if phone in known:
        return (phone,)
    if row.is_diphthong and row.parts and all(part in known for part in row.parts):
        return row.parts
    alike = tuple(other for other in LOOKS_LIKE.get(phone, ()) if other in known)
    return (alike or nearest_phones(phone, (known - {SILENCE}) or known))[:1]


def _lender(phones: tuple[str, ...], index: int) -> str:
    """Whose mouth a sound of the throat takes: of the phones beside it, best a vowel or glide."""
    beside = (*phones[index + 1 : index + 2], *phones[max(index - 1, 0) : index])
    rows = [PHONES[other] for other in beside if has_own_mouth(other) and other != SILENCE]
    open_ones = [row for row in rows if row.is_vowel or row.manner == "approximant"]
    return (open_ones or rows or [PHONES[WEAKEST]])[0].symbol


def lent_track(track: PhoneTrack, known: Collection[str]) -> PhoneTrack:
    """The track with sounds of the throat that are not known as the phones whose mouth they take.

    HH AE is AE AE, and HH alone is AX. Edges, words and stress stay.
    """
    if not any(is_lent(phone, known) for phone in track.phones):
        return track
    phones = (
        _lender(track.phones, index) if is_lent(phone, known) else phone
        for index, phone in enumerate(track.phones)
    )
    return replace(track, phones=tuple(phones))


def known_track(track: PhoneTrack, known: Collection[str]) -> PhoneTrack:
    """The track in phones of `known` alone, each as near to the true one as can be seen.

    A sound of the throat (HH) takes the mouth of the vowel beside it, best the next; a diphthong
    is split in the middle into its parts where both are known; any other phone becomes the nearest
    of the phone table. Every edge stays; words and stress stay with their phones.

    Args:
        track: any track.
        known: symbols of the phone table, at least one; silence only stands for silence.

    Raises:
        ValueError: nothing is known, or a symbol that the phone table lacks.
    """
    check_phones(known)
    mouths = frozenset(known)
    if mouths.issuperset(track.phones):
        return track
    phones: list[str] = []
    stress: list[int | None] = []
    edges = [track.start]
    place = [0]  # of each phone of the track, and of its end, among the new ones
    for index, (phone, start, end) in enumerate(lent_track(track, mouths)):
        parts = replacement(phone, mouths)
        if is_lent(track.phones[index], mouths):
            parts = parts[:1]  # on its way into a diphthong
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
