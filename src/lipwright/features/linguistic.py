"""Attributes of phones and categories of transitions, generated from the phone table.

Questions about a frame as in Taylor et al. 2017, section 5.2: is the phone a nasal, are the
phones of this frame and the next a stop and a vowel. A column is 1 where the answer is yes.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.phones import BACKNESSES, COMMON, HEIGHTS, MANNERS, PHONES, PLACES, Phone

SAME: Final = "same phone"

# What is seen of a consonant is where it is made; places that look alike are one cluster.
CLUSTERS: Final = MappingProxyType({
    "bilabial": "bilabial", "labiodental": "labiodental", "dental": "dental or alveolar",
    "alveolar": "dental or alveolar", "postalveolar": "postalveolar",
    "palatal": "palatal or velar", "velar": "palatal or velar", "labiovelar": "labiovelar",
    "glottal": "glottal",
})  # fmt: skip
REGIONS: Final = MappingProxyType({
    "bilabial": "lips", "labiodental": "lips", "labiovelar": "lips",
    "dental": "tongue", "alveolar": "tongue", "postalveolar": "tongue", "palatal": "tongue",
    "velar": "tongue", "glottal": "throat",
})  # fmt: skip


def attributes_of(phone: Phone) -> tuple[str, ...]:
    """Names of the attributes that a phone has."""
    if phone.is_silence:
        return ("silence",)
    made = (
        (phone.place, phone.manner, "consonant")
        if phone.is_consonant
        else (f"{phone.height} vowel", f"{phone.backness} vowel", "vowel")
    )
    also = {"diphthong": phone.is_diphthong, "rounded": phone.rounded}
    voice = "voiced" if phone.voiced else "voiceless"
    return (*made, voice, *(name for name, true in also.items() if true), f"class {phone.common}")


def _attributes() -> Iterator[str]:
    yield from ("silence", "vowel", "diphthong", "consonant", "voiced", "voiceless", "rounded")
    yield from PLACES
    yield from MANNERS
    yield from (f"{height} vowel" for height in HEIGHTS)
    yield from (f"{backness} vowel" for backness in BACKNESSES)
    yield from (f"class {common}" for common in COMMON)


def _ends(phone: Phone, *, leaving: bool) -> tuple[str, str, str]:
    """Cluster, sort and region of the end of a phone that meets another."""
    if phone.is_silence:
        return "silence", "silence", "silence"
    if phone.is_consonant:
        return CLUSTERS[phone.place], phone.manner, REGIONS[phone.place]
    # A diphthong is left from its last part.
    last = PHONES[phone.parts[1]] if leaving and phone.parts else phone
    return f"{last.backness} vowel", "vowel", "vowel"


def transitions_of(one: Phone, other: Phone) -> tuple[str, ...]:
    """Names of the categories that a pair of phones falls into; at least one."""
    if one.symbol == other.symbol:
        return (SAME,)
    left, right = _ends(one, leaving=True), _ends(other, leaving=False)
    cluster, sort, region = (f"{a} to {b}" for a, b in zip(left, right, strict=True))
    if one.is_vowel and other.is_vowel:
        return (cluster,)
    if one.is_vowel or other.is_vowel:
        return (region,) if one.is_silence or other.is_silence else (cluster, sort)
    return (region,)


def _transitions() -> Iterator[str]:
    vowels = [f"{backness} vowel" for backness in BACKNESSES]
    clusters = tuple(dict.fromkeys(CLUSTERS.values()))
    regions = tuple(dict.fromkeys(REGIONS.values()))
    yield SAME
    yield from (f"{a} to {b}" for a in clusters for b in vowels)
    yield from (f"{a} to vowel" for a in MANNERS)
    yield from (f"{a} to {b}" for a in vowels for b in clusters)
    yield from (f"vowel to {b}" for b in MANNERS)
    yield from (f"{a} to {b}" for a in vowels for b in vowels)
    yield from (f"{a} to {b}" for a in regions for b in regions)
    yield from (f"silence to {b}" for b in (*regions, "vowel"))
    yield from (f"{a} to silence" for a in (*regions, "vowel"))


ATTRIBUTES: Final[tuple[str, ...]] = tuple(_attributes())
"""the columns of the attributes of one frame"""
TRANSITIONS: Final[tuple[str, ...]] = tuple(_transitions())
"""the columns of the transition from one frame to the next"""


@cache
def attribute_table() -> npt.NDArray[np.float32]:
    """(P, A) of 0 and 1: phone of the table, attribute; read-only."""
    rows = [[name in attributes_of(phone) for name in ATTRIBUTES] for phone in PHONES.values()]
    table = np.array(rows, np.float32)
    table.setflags(write=False)
    return table


@cache
def transition_table() -> npt.NDArray[np.float32]:
    """(P, P, B) of 0 and 1: phone, phone after it, category; read-only."""
    column = {name: index for index, name in enumerate(TRANSITIONS)}
    table = np.zeros((len(PHONES), len(PHONES), len(TRANSITIONS)), np.float32)
    for i, one in enumerate(PHONES.values()):
        for j, other in enumerate(PHONES.values()):
            table[i, j, [column[name] for name in transitions_of(one, other)]] = 1
    table.setflags(write=False)
    return table
