"""Which units of the English acoustic model sound most like a sound of any language.

The phone table of a track groups sounds by what a face does: German "ach" is K there, as the
tongue's back rises for both. A listener hears the breath of an H. So forced alignment starts from
the sounds themselves, in IPA, and each becomes one or more units of the model in a row. Where a
sound lies between English ones, and speakers differ, a unit is a choice: the aligner takes
whichever fits each moment best. The first of a choice is the one that was best alone where
`bench/acoustic_units.py` tried them on speech whose phone times are known; docs/alignment.md has
what choices gain.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from functools import cache
from types import MappingProxyType
from typing import Final

from lipwright.phones import ARPABET, PHONES

Units = tuple[str, ...]
"""names of base phones of the acoustic model, at least one, or choices of them: "IY|UW" """

# IPA, units, example or reason. Several letters are looked up whole before they are taken apart.
_VOWELS: Final = (
    ("i", "IY", "feel"),
    ("y", "IY|UW", "i with the lips of u; espeak-ng's is nearer i, English u is the fronted one"),
    ("ɨ", "IH|UH", "debit"),
    ("ʉ", "UW", "dude"),
    ("ɯ", "UH|UW", "u without its lips"),
    ("u", "UW|UH", "too; book, as monophthongs are further back"),
    ("ɪ", "IH|IY", "fill; closer than in English in most languages"),
    ("ʏ", "IH|UH|UW", "short i with lips"),
    ("ʊ", "UH|OW|UW", "book"),
    ("e", "IH|EY|IY", "the first half of ate, which closes on to i"),
    ("ø", "UH|ER|AH", "rounded and front of centre: the low third formant of fur, or book"),
    ("ɘ", "AH|IH", "a kind of schwa"),
    ("ɵ", "UH", "Swedish full: rounded and central"),
    ("ɤ", "AH|UH", "o without its lips"),
    ("o", "OW|AO|UH", "the first half of go, which closes on to u"),
    ("ə", "AH|UH", "ago; the model writes schwa as AH"),
    ("ɚ", "ER", "letter"),
    ("ɛ", "EH|AE", "pet"),
    ("œ", "AH|ER|UH", "as ø, more open"),
    ("ɜ", "ER", "British fur"),
    ("ɝ", "ER", "fur"),
    ("ɞ", "ER", "ɜ with lips"),
    ("ʌ", "AH", "cut"),
    ("ɔ", "AO|OW|AA", "dog"),
    ("æ", "AE|EH", "cat"),
    ("ɐ", "AH|AA", "between cut and father"),
    ("a", "AA|AH|AE", "the open vowel of most languages, between father, cut and cat"),
    ("ɶ", "AE", "a with lips"),
    ("ɑ", "AA|AO", "father"),
    ("ɒ", "AA|AO", "British dog"),
    ("ɿ", "IH|UH|Z", "Mandarin si: a buzz with a vowel in it"),
    ("ʅ", "IH|ER|UH", "Mandarin shi: the same, with the tongue curled"),
    ("ʮ", "UW", "ɿ with lips"), ("ʯ", "UW", "ʅ with lips"),
    ("ᵻ", "IH", "debit"), ("ᵿ", "UH", "its rounded sister"),
)  # fmt: skip
_DIPHTHONGS: Final = (
    ("aɪ", "AY", "bite"), ("ai", "AY", "bite"), ("ɑɪ", "AY", "bite"), ("ɑi", "AY", "bite"),
    ("aʊ", "AW", "foul"), ("au", "AW", "foul"), ("ɑʊ", "AW", "foul"), ("ɑu", "AW", "foul"),
    ("ʌʊ", "AW", "foul"), ("æʊ", "AW", "foul"), ("ʌu", "AW", "Dutch oud"),
    ("ʌɪ", "AY", "bite"),
    ("eɪ", "EY", "ate"), ("ei", "EY", "ate"), ("ɛɪ", "EY", "Dutch ei"), ("ɛi", "EY", "Dutch ei"),
    ("oʊ", "OW", "go"), ("ou", "OW", "go"), ("əʊ", "OW", "British go"),
    ("ɔɪ", "OY", "toy"), ("ɔi", "OY", "toy"), ("oɪ", "OY", "toy"), ("oi", "OY", "toy"),
    ("ɔø", "OY", "German neu"), ("ɔʏ", "OY", "German neu"), ("ɔy", "OY", "German neu"),
    ("œy", "AW", "Dutch ui"), ("ʌy", "AW", "Dutch ui"),
    ("ɪə", "IH", "British near"), ("iə", "IY", "near"), ("eə", "EH", "British square"),
    ("ɛə", "EH", "British square"), ("ʊə", "UH", "British cure"),
)  # fmt: skip
_CONSONANTS: Final = (
    ("p", "P", "put"), ("b", "B", "big"), ("t", "T", "talk"), ("d", "D", "dig"), ("k", "K", "cut"),
    ("ɡ", "G", "gut"), ("ʈ", "T", "Swedish kort"), ("ɖ", "D", "Swedish bord"),
    ("c", "K", "a k further forward"), ("ɟ", "G", "a g further forward"),
    ("q", "K", "a k further back"), ("ɢ", "G", "a g further back"),
    ("ʔ", "T|HH", "American button: a stop without a burst"),
    ("m", "M", "mat"), ("ɱ", "M", "comfort"), ("n", "N", "no"), ("ɳ", "N", "Swedish barn"),
    ("ɲ", "N Y", "canyon"), ("ŋ", "NG", "sing"), ("ɴ", "NG", "Japanese n before a pause"),
    ("ʙ", "B", "a trill of the lips"),
    ("r", "R|D|T", "a trill: the taps of D, or the weak r between vowels"),
    ("ʀ", "R|HH|G", "a trill of the uvula"),
    ("ɾ", "D|R", "American butter"), ("ɽ", "D|R|L", "Japanese r: a tap"),
    ("ɺ", "L|D|R", "Japanese r, with the sides open"),
    ("ɸ", "F|HH", "Japanese fu: an f of both lips"),
    ("β", "V|B|W", "Spanish lobo: a v of both lips"),
    ("f", "F", "fork"), ("v", "V|W", "vat; weak in many languages"), ("θ", "TH", "thin"),
    ("ð", "DH|D|V", "then; Spanish nada"),
    ("s", "S", "sit"), ("z", "Z", "zap"), ("ʃ", "SH", "she"), ("ʒ", "ZH", "pleasure"),
    ("ʂ", "SH|S", "Swedish fors, Mandarin shi"), ("ʐ", "ZH|R|Z", "Mandarin ri: a buzzing r"),
    ("ɕ", "SH|S", "Swedish tjog, Mandarin xi: between she and see"), ("ʑ", "ZH", "Japanese ji"),
    ("ɧ", "SH|HH|F", "Swedish själ: the low hiss of sh, further back"),
    ("ç", "HH|SH", "huge: the breath before a y"), ("ʝ", "Y", "Spanish yo"),
    ("x", "HH|K|SH", "Bach: breath at the tongue's back, no burst"),
    ("ɣ", "G|HH|W", "Spanish lago"),
    ("χ", "HH|K|SH", "as x, further back"), ("ʁ", "R|HH|G", "French rue, German rot"),
    ("ħ", "HH", "breath in the throat"), ("ʕ", "AA", "a narrow throat, near a vowel"),
    ("h", "HH", "help"), ("ɦ", "HH", "ahead"), ("ɬ", "SH", "Welsh ll"), ("ɮ", "L", "a buzzing l"),
    ("ʋ", "V|W", "Dutch wat"), ("ɹ", "R", "red"), ("ɻ", "R", "Mandarin er"), ("j", "Y", "yard"),
    ("ɰ", "G", "an open ɣ"), ("ɥ", "Y", "French huit"), ("w", "W", "with"), ("ʍ", "W", "which"),
    ("l", "L", "lid"), ("ɫ", "L", "dark l"), ("ɭ", "L", "Swedish Karl"), ("ʎ", "L Y", "million"),
    ("ʟ", "L", "an l at the tongue's back"),
    ("ʡ", "T", "a stop in the throat"), ("ⱱ", "V", "a flap of lip and teeth"),
    ("ɼ", "R", "a trill"), ("ʜ", "HH", "breath in the throat"), ("ʢ", "AA", "as ʕ"),
    ("ᶑ", "D", "a ɖ drawn in"), ("ʄ", "G", "a ɟ drawn in"), ("ʛ", "G", "a ɢ drawn in"),
    ("ɓ", "B", "a b drawn in"), ("ɗ", "D", "a d drawn in"), ("ɠ", "G", "a g drawn in"),
    ("ǀ", "T", "a click"), ("ǁ", "T", "a click"), ("ǃ", "T", "a click"), ("ǂ", "T", "a click"),
    ("ʘ", "P", "a click of the lips"),
)  # fmt: skip
_AFFRICATES: Final = (
    ("tʃ", "CH", "chin"), ("dʒ", "JH", "joy"), ("tɕ", "CH|JH", "Mandarin jia"),
    ("dʑ", "JH", "Japanese ji"), ("ʈʂ", "CH|JH", "Mandarin zhong"),
    ("ɖʐ", "JH", "its voiced sister"),
    ("ts", "T S", "cats"), ("dz", "D Z", "adze"), ("tr", "CH", "tree"),
    ("pf", "P F", "German Pfund"), ("tʂ", "CH|JH", "Mandarin zhong"), ("ʧ", "CH", "chin"),
    ("ʤ", "JH", "joy"), ("ʦ", "T S", "cats"), ("ʨ", "CH", "Mandarin jia"),
    ("ʥ", "JH", "Japanese ji"),
)  # fmt: skip

_TABLE: Final = MappingProxyType({
    unicodedata.normalize("NFD", ipa): tuple(units.split())
    for ipa, units, _ in (*_VOWELS, *_DIPHTHONGS, *_CONSONANTS, *_AFFRICATES)
})  # fmt: skip

# Language, IPA, units, why: the same letter stands for other sounds than in the table above.
_OF_LANGUAGE: Final = MappingProxyType({
    (language, ipa): tuple(units.split())
    for language, ipa, units, _ in (
        ("cmn", "p", "B", "no breath after it: an English b"), ("cmn", "pʰ", "P", "put"),
        ("cmn", "t", "D", "no breath after it"), ("cmn", "tʰ", "T", "talk"),
        ("cmn", "k", "G", "no breath after it"), ("cmn", "kʰ", "K", "cut"),
        ("cmn", "h", "HH|K|F|TH", "breath at the tongue's back"),
        ("cmn", "x", "HH|K|F|TH", "the same"), ("cmn", "χ", "HH|K|F|TH", "the same"),
        ("cmn", "tɕʰ", "T SH|S", "cheap, with a long hiss"),
        ("cmn", "ʈʂʰ", "T SH|S", "the same, with the tongue curled"),
    )
})  # fmt: skip

# What a symbol of the phone table sounds like where a pronunciation tells no more.
_OF_PHONE: Final = MappingProxyType({
    "AX": "AH", "AXR": "ER", "IX": "IH", "UX": "UW", "Q": "T", "HV": "HH", "EM": "M", "EN": "N",
    "ENG": "NG", "DX": "D", "NX": "N", "EL": "L", "WH": "W",
})  # fmt: skip

# Marks that make another sound of a letter: the cedilla of ç, nasal vowels, breath after stops.
_KEPT: Final = "\N{COMBINING CEDILLA}\N{COMBINING TILDE}ʰ"


def units_of(phone: str, ipa: str = "", language: str = "") -> Units:
    """The units of the acoustic model for one phone of a track.

    Args:
        phone: a symbol of the phone table, not silence.
        ipa: the sound behind it, if it is known; stress, length and tones do not count.
        language: ISO code of the language that it is a sound of.
    """
    return _units_of(phone, ipa, language)


@cache
def _units_of(phone: str, ipa: str, language: str) -> Units:
    found = _of_ipa(ipa, language)
    if found:
        return found
    if phone in _OF_PHONE:
        return (_OF_PHONE[phone],)
    return (phone,) if phone in ARPABET else _of_ipa(PHONES[phone].ipa, language)


def _of_ipa(ipa: str, language: str) -> Units:
    """The units of a sound in IPA; none if it has no letter that the tables know."""
    plain = letters_of(ipa)
    units: list[str] = []
    while plain:
        for length in range(len(plain), 0, -1):
            part = plain[:length]
            known = _OF_LANGUAGE.get((language, part)) or _TABLE.get(part)
            if known:
                units += known
                break
        plain = plain[length:]
    return tuple(units)


def letters_of(ipa: str) -> str:
    """What of a sound the tables go by: its letters and `_KEPT`; no stress, length, tones, ties."""
    parts = unicodedata.normalize("NFD", ipa.replace("g", "ɡ"))
    return "".join(c for c in parts if unicodedata.category(c) in ("Ll", "Lo") or c in _KEPT)


def all_units(phones: Sequence[str], ipa: Sequence[str], language: str) -> tuple[Units, ...]:
    """The units of each phone of a pronunciation; `ipa` is () or one sound a phone."""
    sounds = ipa or ("",) * len(phones)
    return tuple(units_of(p, s, language) for p, s in zip(phones, sounds, strict=True))


def sounds() -> tuple[str, ...]:
    """The sounds in IPA that the tables know by themselves."""
    return tuple(_TABLE)
