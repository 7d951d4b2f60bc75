"""The syllables of pinyin, their phones and their sounds.

Which initials go with which finals is the table of Hanyu Pinyin (ISO 7098:2015), with the
syllables of colloquial and rare words that dictionaries add (biang, den, fiao, nia, pia, rua).
Phones after Lee and Zee, "Standard Chinese (Beijing)" (2003), by what is seen: aspiration is not,
so that zh and ch are one. The sounds keep it. They are those of Lee and Zee, with the glides and
the syllabic consonants as dictionaries write them (j w ɥ, ɿ ʅ).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from types import MappingProxyType
from typing import Final

from lipwright.language.base import Phoneme

Row = tuple[tuple[str, ...], tuple[str, ...]]
"""phones, and the sounds behind them in IPA, one for one"""

INITIALS: Final = MappingProxyType({
    "b": "B", "p": "P", "m": "M", "f": "F", "d": "D", "t": "T", "n": "N", "l": "L",
    "g": "G", "k": "K", "h": "HH", "j": "XTC", "q": "XTC", "x": "XC",
    "zh": "XCH", "ch": "XCH", "sh": "XS", "r": "XZ", "z": "XTS", "c": "XTS", "s": "S",
})  # fmt: skip
"""initial to its phone"""

INITIAL_IPA: Final = MappingProxyType({
    "b": "p", "p": "pʰ", "m": "m", "f": "f", "d": "t", "t": "tʰ", "n": "n", "l": "l",
    "g": "k", "k": "kʰ", "h": "x", "j": "t͡ɕ", "q": "t͡ɕʰ", "x": "ɕ",
    "zh": "ʈ͡ʂ", "ch": "ʈ͡ʂʰ", "sh": "ʂ", "r": "ʐ", "z": "t͡s", "c": "t͡sʰ", "s": "s",
})  # fmt: skip
"""initial to its sound"""

_PALATAL: Final = frozenset("jqx")  # in front of which ü is written u

# final, its phones, its sounds, and the initials that it follows
_FINALS: Final = (
    ("a", "AA", "a", "b p m f d t n l g k h zh ch sh z c s"),  # mA
    ("o", "W AO", "w o", "b p m f"),  # bO, said buo
    ("o", "AO", "o", "l"),  # lO
    ("e", "XOW", "ɤ", "m d t n l g k h zh ch sh r z c s"),  # hE
    ("ai", "AY", "ai", "b p m d t n l g k h zh ch sh z c s"),  # lAI
    ("ei", "EY", "ei", "b p m f d t n l g k h zh sh z c s"),  # mEI
    ("ao", "AW", "au", "b p m d t n l g k h zh ch sh r z c s"),  # hAO
    ("ou", "OW", "ou", "p m f d t n l g k h zh ch sh r z c s"),  # gOU
    ("an", "AA N", "a n", "b p m f d t n l g k h zh ch sh r z c s"),  # shAN
    ("en", "AX N", "ə n", "b p m f d n l g k h zh ch sh r z c s"),  # rEN
    ("ang", "AA NG", "a ŋ", "b p m f d t n l g k h zh ch sh r z c s"),  # mANG
    ("eng", "AX NG", "ə ŋ", "b p m f d t n l g k h zh ch sh r z c s"),  # lENG
    ("ong", "UH NG", "ʊ ŋ", "b d t n l g k h zh ch r z c s"),  # zhONG
    ("i", "IY", "i", "b p m d t n l j q x"),  # nI
    ("i", "XRI", "ʅ", "zh ch sh r"),  # shI
    ("i", "XSI", "ɿ", "z c s"),  # sI
    ("ia", "Y AA", "j a", "p d n l j q x"),  # jIA
    ("ie", "Y EH", "j e", "b p m d t n l j q x"),  # xIE
    ("iao", "Y AW", "j au", "b p m f d t n l j q x"),  # xIAO
    ("iu", "Y OW", "j ou", "m d n l j q x"),  # lIU
    ("ian", "Y EH N", "j ɛ n", "b p m d t n l j q x"),  # tIAN
    ("in", "IY N", "i n", "b p m d n l j q x"),  # xIN
    ("iang", "Y AA NG", "j a ŋ", "b n l j q x"),  # lIANG
    ("ing", "IY NG", "i ŋ", "b p m d t n l j q x"),  # mING
    ("iong", "XIY UH NG", "y ʊ ŋ", "j q x"),  # xIONG
    ("u", "UW", "u", "b p m f d t n l g k h zh ch sh r z c s"),  # bU
    ("ua", "W AA", "w a", "g k h zh ch sh r"),  # huA
    ("uo", "W AO", "w o", "d t n l g k h zh ch sh r z c s"),  # wO
    ("uai", "W AY", "w ai", "g k h zh ch sh"),  # kuAI
    ("ui", "W EY", "w ei", "d t g k h zh ch sh r z c s"),  # shUI
    ("uan", "W AA N", "w a n", "d t n l g k h zh ch sh r z c s"),  # lUAN
    ("un", "W AX N", "w ə n", "d t n l g k h zh ch sh r z c s"),  # chUN
    ("uang", "W AA NG", "w a ŋ", "g k h zh ch sh"),  # hUANG
    ("ü", "XIY", "y", "n l j q x"),  # nÜ
    ("üe", "XIY EH", "ɥ e", "n l j q x"),  # xUE
    ("üan", "XIY EH N", "ɥ ɛ n", "j q x"),  # yUAN
    ("ün", "XIY N", "y n", "j q x"),  # yUN
)

# Syllables without an initial, as they are spelt: phones and sounds.
_ALONE: Final = MappingProxyType({
    "a": ("AA", "a"), "o": ("AO", "o"), "e": ("XOW", "ɤ"), "ê": ("EH", "ɛ"), "ai": ("AY", "ai"),
    "ei": ("EY", "ei"), "ao": ("AW", "au"), "ou": ("OW", "ou"), "an": ("AA N", "a n"),
    "en": ("AX N", "ə n"), "ang": ("AA NG", "a ŋ"), "eng": ("AX NG", "ə ŋ"), "er": ("ER", "ɚ"),
    "yi": ("IY", "i"), "ya": ("Y AA", "j a"), "yo": ("Y AO", "j o"), "ye": ("Y EH", "j e"),
    "yao": ("Y AW", "j au"), "you": ("Y OW", "j ou"),
    "yan": ("Y EH N", "j ɛ n"), "yin": ("IY N", "i n"), "yang": ("Y AA NG", "j a ŋ"),
    "ying": ("IY NG", "i ŋ"), "yong": ("XIY UH NG", "y ʊ ŋ"), "yu": ("XIY", "y"),
    "yue": ("XIY EH", "ɥ e"), "yuan": ("XIY EH N", "ɥ ɛ n"), "yun": ("XIY N", "y n"),
    "yü": ("XIY", "y"), "yüe": ("XIY EH", "ɥ e"), "yüan": ("XIY EH N", "ɥ ɛ n"),
    "yün": ("XIY N", "y n"), "wu": ("UW", "u"), "wa": ("W AA", "w a"), "wo": ("W AO", "w o"),
    "wai": ("W AY", "w ai"), "wei": ("W EY", "w ei"), "wan": ("W AA N", "w a n"),
    "wen": ("W AX N", "w ə n"), "wang": ("W AA NG", "w a ŋ"), "weng": ("W AX NG", "w ə ŋ"),
    "wong": ("W UH NG", "w ʊ ŋ"),
})  # fmt: skip

_INTERJECTIONS: Final = MappingProxyType({
    "m": ("M", "m"), "n": ("N", "n"), "ng": ("NG", "ŋ"), "hm": ("HH M", "x m"),
    "hng": ("HH NG", "x ŋ"),
})  # fmt: skip

# Behind which the r of erhua replaces what the tongue cannot do as well: hai'r is har. How many
# phones go, and what stands in their place, with its sound.
_BEFORE_R: Final = MappingProxyType({
    ("AY",): (("AA",), ("a",)), ("EY",): ((), ()), ("AA", "N"): (("AA",), ("a",)),
    ("AX", "N"): ((), ()), ("EH", "N"): (("AA",), ("a",)), ("IY", "N"): (("IY",), ("i",)),
    ("XIY", "N"): (("XIY",), ("y",)), ("AA", "NG"): (("AA",), ("a",)), ("AX", "NG"): ((), ()),
    ("IY", "NG"): (("IY",), ("i",)), ("UH", "NG"): (("UH",), ("ʊ",)), ("XSI",): ((), ()),
    ("XRI",): ((), ()),
})  # fmt: skip
ERHUA: Final = "r"
_R: Final = "AXR", "ɚ"


def _spelt() -> Iterator[tuple[str, Row]]:
    """Each way to write a syllable, its phones and its sounds."""
    for final, phones, ipa, initials in _FINALS:
        for initial in initials.split():
            said = (
                (INITIALS[initial], *phones.split()),
                (INITIAL_IPA[initial], *ipa.split()),
            )
            yield initial + final, said
            if final.startswith("ü") and initial in _PALATAL:
                yield initial + "u" + final[1:], said
            if final == "üe" and initial not in _PALATAL:
                yield initial + "ue", said  # "nue", as many type it
    for syllable, (phones, ipa) in _ALONE.items():
        yield syllable, (tuple(phones.split()), tuple(ipa.split()))


_ROWS: Final = MappingProxyType(dict(_spelt()))
_HUMMED: Final = MappingProxyType({
    syllable: (tuple(phones.split()), tuple(ipa.split()))
    for syllable, (phones, ipa) in _INTERJECTIONS.items()
})  # fmt: skip

SYLLABLES: Final = MappingProxyType({syllable: row[0] for syllable, row in _ROWS.items()})
"""syllable, without tone and with ü as ü, to its phones"""

INTERJECTIONS: Final = MappingProxyType({syllable: row[0] for syllable, row in _HUMMED.items()})
"""what is said alone, and never part of a word, to its phones"""


def _with_erhua(row: Row) -> Row:
    """A syllable with r at its end, as Beijing says "wan" in "wanr"."""
    phones, ipa = row
    for length in (2, 1):
        kept = _BEFORE_R.get(phones[-length:])
        if kept is not None and (len(phones) > length or length == len(phones)):
            return (*phones[:-length], *kept[0], _R[0]), (*ipa[:-length], *kept[1], _R[1])
    return (*phones, _R[0]), (*ipa, _R[1])


@cache
def syllable_sounds(syllable: str) -> Row:
    """The phones of a syllable or interjection without its tone, and its sounds in IPA.

    Its r of erhua counts.

    Raises:
        KeyError: it is none.
    """
    for table in (_ROWS, _HUMMED):
        if syllable in table:
            return table[syllable]
    return _with_erhua(_ROWS[syllable.removesuffix(ERHUA)])


def syllable_phones(syllable: str) -> tuple[str, ...]:
    """The phones of a syllable or interjection without its tone; its r of erhua counts.

    Raises:
        KeyError: it is none.
    """
    return syllable_sounds(syllable)[0]


def is_syllable(text: str) -> bool:
    """Whether letters without a tone are one syllable, with or without erhua."""
    return text in _ROWS or (text.endswith(ERHUA) and text.removesuffix(ERHUA) in _ROWS)


def inventory() -> tuple[Phoneme, ...]:
    """Every sound of initials and finals, then the finals of several sounds, with syllables."""
    finals: list[tuple[list[str], list[str], str]] = [
        (phones.split(), ipa.split(), initials.split()[0] + final.upper())
        for final, phones, ipa, initials in _FINALS
    ]
    finals += [(phones.split(), ipa.split(), s.upper()) for s, (phones, ipa) in _ALONE.items()]
    finals.append(([_R[0]], [_R[1]], "huaR"))
    sounds: list[tuple[str, tuple[str, ...], str]] = [
        (sound, (INITIALS[initial],), initial.upper() + _first_final(initial))
        for initial, sound in INITIAL_IPA.items()
    ]
    sounds += [
        (sound, (phone,), example)
        for phones, ipa, example in finals
        for phone, sound in zip(phones, ipa, strict=True)
    ]
    sounds += [("".join(ipa), tuple(phones), example) for phones, ipa, example in finals]
    found: dict[tuple[str, tuple[str, ...]], Phoneme] = {}
    for sound, shown, example in sounds:
        found.setdefault((sound, shown), Phoneme(sound, shown, example))
    return tuple(found.values())


def _first_final(initial: str) -> str:
    return next(final for final, _, _, initials in _FINALS if initial in initials.split())
