"""The syllables of pinyin and their phones.

Which initials go with which finals is the table of Hanyu Pinyin (ISO 7098:2015), with the few
syllables of colloquial words that dictionaries add (den, nia, rua). Phones after Lee and Zee,
"Standard Chinese (Beijing)" (2003), by what is seen: aspiration is not, so that zh and ch are one.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

INITIALS: Final = MappingProxyType({
    "b": "B", "p": "P", "m": "M", "f": "F", "d": "D", "t": "T", "n": "N", "l": "L",
    "g": "G", "k": "K", "h": "HH", "j": "XTC", "q": "XTC", "x": "XC",
    "zh": "XCH", "ch": "XCH", "sh": "XS", "r": "XZ", "z": "XTS", "c": "XTS", "s": "S",
})  # fmt: skip
"""initial to its phone"""

_PALATAL: Final = frozenset("jqx")  # in front of which ü is written u

# final, its phones, and the initials that it follows
_FINALS: Final = (
    ("a", "AA", "b p m f d t n l g k h zh ch sh z c s"),  # mA
    ("o", "W AO", "b p m f"),  # bO, said buo
    ("o", "AO", "l"),  # lO
    ("e", "XOW", "m d t n l g k h zh ch sh r z c s"),  # hE
    ("ai", "AY", "b p m d t n l g k h zh ch sh z c s"),  # lAI
    ("ei", "EY", "b p m f d t n l g k h zh sh z c"),  # mEI
    ("ao", "AW", "b p m d t n l g k h zh ch sh r z c s"),  # hAO
    ("ou", "OW", "p m f d t n l g k h zh ch sh r z c s"),  # gOU
    ("an", "AA N", "b p m f d t n l g k h zh ch sh r z c s"),  # shAN
    ("en", "AX N", "b p m f d n g k h zh ch sh r z c s"),  # rEN
    ("ang", "AA NG", "b p m f d t n l g k h zh ch sh r z c s"),  # mANG
    ("eng", "AX NG", "b p m f d t n l g k h zh ch sh r z c s"),  # lENG
    ("ong", "UH NG", "d t n l g k h zh ch r z c s"),  # zhONG
    ("i", "IY", "b p m d t n l j q x"),  # nI
    ("i", "XRI", "zh ch sh r"),  # shI
    ("i", "XSI", "z c s"),  # sI
    ("ia", "Y AA", "d n l j q x"),  # jIA
    ("ie", "Y EH", "b p m d t n l j q x"),  # xIE
    ("iao", "Y AW", "b p m d t n l j q x"),  # xIAO
    ("iu", "Y OW", "m d n l j q x"),  # lIU
    ("ian", "Y EH N", "b p m d t n l j q x"),  # tIAN
    ("in", "IY N", "b p m n l j q x"),  # xIN
    ("iang", "Y AA NG", "n l j q x"),  # lIANG
    ("ing", "IY NG", "b p m d t n l j q x"),  # mING
    ("iong", "XIY UH NG", "j q x"),  # xIONG
    ("u", "UW", "b p m f d t n l g k h zh ch sh r z c s"),  # bU
    ("ua", "W AA", "g k h zh ch sh r"),  # huA
    ("uo", "W AO", "d t n l g k h zh ch sh r z c s"),  # wO
    ("uai", "W AY", "g k h zh ch sh"),  # kuAI
    ("ui", "W EY", "d t g k h zh ch sh r z c s"),  # shUI
    ("uan", "W AA N", "d t n l g k h zh ch sh r z c s"),  # lUAN
    ("un", "W AX N", "d t n l g k h zh ch sh r z c s"),  # chUN
    ("uang", "W AA NG", "g k h zh ch sh"),  # hUANG
    ("ü", "XIY", "n l j q x"),  # nÜ
    ("üe", "XIY EH", "n l j q x"),  # xUE
    ("üan", "XIY EH N", "j q x"),  # yUAN
    ("ün", "XIY N", "j q x"),  # yUN
)

# Syllables without an initial, as they are spelt.
_ALONE: Final = MappingProxyType({
    "a": "AA", "o": "AO", "e": "XOW", "ê": "EH", "ai": "AY", "ei": "EY", "ao": "AW", "ou": "OW",
    "an": "AA N", "en": "AX N", "ang": "AA NG", "eng": "AX NG", "er": "ER",
    "yi": "IY", "ya": "Y AA", "yo": "Y AO", "ye": "Y EH", "yao": "Y AW", "you": "Y OW",
    "yan": "Y EH N", "yin": "IY N", "yang": "Y AA NG", "ying": "IY NG", "yong": "XIY UH NG",
    "yu": "XIY", "yue": "XIY EH", "yuan": "XIY EH N", "yun": "XIY N",
    "yü": "XIY", "yüe": "XIY EH", "yüan": "XIY EH N", "yün": "XIY N",
    "wu": "UW", "wa": "W AA", "wo": "W AO", "wai": "W AY", "wei": "W EY", "wan": "W AA N",
    "wen": "W AX N", "wang": "W AA NG", "weng": "W AX NG",
})  # fmt: skip

INTERJECTIONS: Final = MappingProxyType({
    "m": ("M",), "n": ("N",), "ng": ("NG",), "hm": ("HH", "M"), "hng": ("HH", "NG"),
})  # fmt: skip
"""what is said alone, and never part of a word"""

# Behind which the r of erhua replaces what the tongue cannot do as well: hai'r is har.
_BEFORE_R: Final = MappingProxyType({
    ("AY",): ("AA",), ("EY",): (), ("AA", "N"): ("AA",), ("AX", "N"): (), ("EH", "N"): ("AA",),
    ("IY", "N"): ("IY",), ("XIY", "N"): ("XIY",), ("AA", "NG"): ("AA",), ("AX", "NG"): (),
    ("IY", "NG"): ("IY",), ("UH", "NG"): ("UH",), ("XSI",): (), ("XRI",): (),
})  # fmt: skip
ERHUA: Final = "r"


def _spelt() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each way to write a syllable, and its phones."""
    for final, phones, initials in _FINALS:
        for initial in initials.split():
            said = (INITIALS[initial], *phones.split())
            yield initial + final, said
            if final.startswith("ü") and initial in _PALATAL:
                yield initial + "u" + final[1:], said
            if final == "üe" and initial not in _PALATAL:
                yield initial + "ue", said  # "nue", as many type it
    for syllable, phones in _ALONE.items():
        yield syllable, tuple(phones.split())


SYLLABLES: Final = MappingProxyType(dict(_spelt()))
"""syllable, without tone and with ü as ü, to its phones"""


def with_erhua(phones: tuple[str, ...]) -> tuple[str, ...]:
    """The phones of a syllable with r at its end, as Beijing says "wan" in "wanr"."""
    for length in (2, 1):
        kept = _BEFORE_R.get(phones[-length:])
        if kept is not None and len(phones) > length:
            return (*phones[:-length], *kept, "AXR")
    if phones in _BEFORE_R:
        return (*_BEFORE_R[phones], "AXR")
    return (*phones, "AXR")


def syllable_phones(syllable: str) -> tuple[str, ...]:
    """The phones of a syllable or interjection without its tone; its r of erhua counts.

    Raises:
        KeyError: it is none.
    """
    for table in (SYLLABLES, INTERJECTIONS):
        if syllable in table:
            return table[syllable]
    return with_erhua(SYLLABLES[syllable.removesuffix(ERHUA)])


def is_syllable(text: str) -> bool:
    """Whether letters without a tone are one syllable, with or without erhua."""
    return text in SYLLABLES or (text.endswith(ERHUA) and text.removesuffix(ERHUA) in SYLLABLES)
