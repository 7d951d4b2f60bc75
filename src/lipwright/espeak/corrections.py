"""Where espeak-ng 1.52 writes no IPA although it was asked for it.

Its phonemes have mnemonics in ASCII; where a language gives none in IPA, the mnemonic comes out,
letter by letter. These are the ones of Swedish and Mandarin (phsource/ph_swedish and ph_zh_pinyin
of its source), as the phones stand in "hanyu pinyin" and the "Handbook of the IPA" (1999).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

_MANDARIN: Final[Mapping[str, str]] = MappingProxyType({
    # Ba, Da, Ge: without voice, but soft, as the phone table and pinyin have them; Pa, Ta, Ka
    "p": "b̥", "t": "d̥", "k": "ɡ̊", "ph": "pʰ", "th": "tʰ", "kh": "kʰ",
    "tsh": "tsʰ", "ts.": "ʈʂ", "ts.h": "ʈʂʰ", "s.": "ʂ",  # Ca, ZHa, CHa, SHa
    "tɕh": "tɕʰ", "χ": "h",  # Qi, He
    "i.": "ʅ", "i̪": "ɿ", "ər": "ɝ",  # shI, sI, ER
    "iɑ": "jɑ", "iɑu": "jɑu", "iɛ": "jɛ", "io": "jʊ", "iou": "jou",  # jIA, jIAO, jIE, qIONG, jIU
    "onɡ": "ʊŋ", "uə": "wə", "uɑ": "wɑ", "ua": "wa", "uai": "wai",  # zhONG, chUN, guANG, guA, guAI
    "uei": "wei", "uo": "wo",  # guI, guO
    "yæ": "ɥɛ", "yɛ": "ɥɛ", "yu": "ɥʊ",  # yUAN, yUE, yONG
    "yə": "y", "yi": "y",  # yUN
    "n-": "n̩", "m-": "m̩", "ŋ-": "ŋ̍", "o-": "ɤ",
})  # fmt: skip

CORRECTIONS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType({
    "sv": MappingProxyType({"sx": "ɧ"}),  # SJuk
    "cmn": _MANDARIN,
    "cmn-latn-pinyin": _MANDARIN,
})  # fmt: skip
"""voice to what it writes for a phoneme, without stress, and the IPA"""

# Other languages' leftovers: capitals of Kirshenbaum's ASCII IPA ("Representing IPA phonetics in
# ASCII", 1993), of which IPA has none, and the marks that tell a language's variants apart.
_ASCII: Final = str.maketrans(
    {
        "A": "ɑ", "B": "β", "C": "ç", "D": "ð", "E": "ɛ", "G": "ɢ", "H": "ħ", "I": "ɪ", "J": "ɟ",
        "L": "ɫ", "M": "ɱ", "N": "ŋ", "O": "ɔ", "P": "ɸ", "Q": "ɣ", "R": "r", "S": "ʃ", "T": "θ",
        "U": "ʊ", "V": "ʌ", "W": "œ", "X": "χ", "Y": "ø", "Z": "ʒ", "@": "ə", "&": "æ", "#": "",
        "^": "", "*": "", "/": "", '"': "", "!": "", "%": "", "=": "",
    }
)  # fmt: skip
_STRESSED: Final = re.compile(r"([ˈˌ]*)(.*)", re.DOTALL)
# Tones are digits behind the vowel; 3 comes out as the letter that it is in Kirshenbaum's ASCII.
_TONE: Final = re.compile(r"(?<=[^ˈˌ])(?:[0-9]+ɜ?[0-9]*|ɜ[0-9]*)$")
_PALATALS: Final = (("n^", "ɲ"), ("l^", "ʎ"))  # before the mark is dropped
_VELAR: Final = re.compile(r"(?<=[^ˈˌ])nɡ$")  # behind a vowel: Cantonese gONG


def corrected(phoneme: str, code: str) -> str:
    """The IPA of one phoneme, with its stress mark, as the voice `code` wrote it."""
    match = _STRESSED.fullmatch(_TONE.sub("", phoneme))
    assert match is not None  # the pattern takes anything
    stress, bare = match[1], match[2]
    table = CORRECTIONS.get(code)
    if table and bare in table:
        return stress + table[bare]
    for mnemonic, ipa in _PALATALS:
        bare = bare.replace(mnemonic, ipa)
    return stress + _VELAR.sub("ŋ", bare).translate(_ASCII)
