"""Fewer inputs: phones that look alike are one.

Input space reduction of the thesis, section 4.2.2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import ClassVar, Final

from lipwright.dataset.transforms.sample import Random, Sample

# "The best approach" of section 4.2.2: long vowels with their short versions, g with k, f with v.
# In IPA; the length of Swedish vowels after Engstrand, Handbook of the IPA (1999), "Swedish".
# The thesis names the rule and not the list.
_SWEDISH: Final = MappingProxyType({
    "iː": "ɪ",  # sil (strainer), sill (herring)
    "yː": "ʏ",  # syl (awl), syll (sleeper)
    "eː": "e",  # hel (whole), häll in speakers who keep /e/ apart
    "ɛː": "ɛ",  # säl (seal), säll (happy)
    "æː": "æ",  # här (here), herr (mister)
    "ɑː": "a",  # hal (slippery), hall (hall)
    "oː": "ɔ",  # mål (goal), moll (minor)
    "uː": "ʊ",  # bot (penance), bott (lived)
    "ʉː": "ɵ",  # ful (ugly), full (full)
    "øː": "œ",  # nöt (nut), nött (worn)
    "œː": "œ",  # öra (ear), förr (before)
    "g": "k",  # gal (crows), kal (bare)
    "ɡ": "k",  # the same, in the letter of the IPA
    "v": "f",  # var (was), far (father)
})  # fmt: skip

# The same rule for English. Long and short as in the broad transcription of Jones, "An Outline of
# English Phonetics", where these pairs differ by the mark of length only; in ARPABET.
_ENGLISH: Final = MappingProxyType({
    "IY": "IH",  # fEEl, fIll
    "UW": "UH",  # tOO, bOOk
    "UX": "UH",  # dUde, bOOk
    "ER": "AXR",  # fUR, lettER
    "G": "K",  # Gut, Cut
    "V": "F",  # Vat, Fork
})  # fmt: skip

PHONE_CLASSES: Final = MappingProxyType({"swedish": _SWEDISH, "english": _ENGLISH})
"""table to phone to the phone that stands for it; phones that it lacks stand for themselves"""


@dataclass(frozen=True)
class MergePhones:
    """Phones that look alike become one of them.

    Undoing brings back the recorded phones; without a record the one that stands for the class
    stays.
    """

    kind: ClassVar[str] = "merge-phones"
    table: str = "english"
    """one of PHONE_CLASSES"""

    def __post_init__(self) -> None:
        """Check."""
        if self.table not in PHONE_CLASSES:
            raise ValueError(f"table is {self.table!r}, not one of: {', '.join(PHONE_CLASSES)}")

    def apply(self, sample: Sample, random: Random | None = None) -> tuple[Sample, tuple[str, ...]]:
        """The sample with fewer phones; the old ones."""
        table = PHONE_CLASSES[self.table]
        merged = tuple(table.get(phone, phone) for phone in sample.phones)
        return replace(sample, phones=merged), sample.phones

    def invert(self, sample: Sample, record: tuple[str, ...] | None = None) -> Sample:
        """The sample with its old phones."""
        return sample if record is None else replace(sample, phones=record)
