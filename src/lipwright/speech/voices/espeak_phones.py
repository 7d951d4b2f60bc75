"""Phones of the table as phoneme mnemonics of a voice of espeak-ng.

Each language of espeak-ng has its own phonemes, and changes them by their neighbours. What a
mnemonic sounds like in a voice is asked of espeak-ng itself: it is said, and the IPA of its event
read. A phone is said by the first of its mnemonics that sounds like it, else by those of its parts,
else by those of the phone most like it that the voice has.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.espeak import speak
from lipwright.language.espeak_ipa import read_espeak
from lipwright.phones import PHONES, SILENCE, nearest_phones

# As in phsource/phonemes and the files of the languages of espeak-ng 1.52.
MNEMONICS: Final = MappingProxyType({
    "AA": "A: A a: 0 a", "AE": "a & aa", "AH": "V a#", "AX": "@ @2", "AO": "O: O o: o",
    "AW": "aU Au", "AXR": "3", "AY": "aI ai", "EH": "E E: e e:", "ER": "3: 3", "EY": "eI EI ei",
    "IH": "I", "IX": "I# i", "IY": "i: i", "OW": "oU ou", "OY": "OI", "UH": "U 8", "UW": "u: u",
    "UX": "u- u-:", "P": "p ph", "B": "b", "T": "t th", "D": "d", "K": "k kh", "G": "g", "Q": "?",
    "CH": "tS", "JH": "dZ", "F": "f", "V": "v v#", "TH": "T", "DH": "D", "S": "s", "Z": "z",
    "SH": "S", "ZH": "Z", "HH": "h", "HV": "h#", "M": "m", "EM": "m-", "N": "n", "EN": "n-",
    "NG": "N", "ENG": "N-", "DX": "* **", "NX": "n", "L": "l", "EL": "l- @L", "R": "r r-",
    "Y": "j", "W": "w", "WH": "w#", "XIY": "y: y", "XIH": "y I.", "XEY": "Y: Y", "XEH": "W W:",
    "XOW": "o-", "XSI": "i[", "XRI": "i.", "XT": "t.", "XD": "d.", "XN": "n.", "XL": "l.",
    "XR": "R r", "XS": "s. s;", "XZ": "z.", "XC": "S; s\\", "XH": "sx", "XTS": "ts",
    "XTC": "tS; t_s\\", "XCH": "ts.",
})  # fmt: skip
"""phone to the mnemonics that may say it, best first, with spaces between them"""
_SYLLABIC: Final = ("EM", "EN", "ENG", "EL")
_BEFORE_VOWEL: Final = "t"  # a consonant and a vowel that every voice has
_AFTER_CONSONANT: Final = "a"


@cache
def _heard(mnemonic: str, is_vowel: bool, voice: str) -> tuple[str, ...]:
    """The phones that a voice makes of a mnemonic; none if it does not know it."""
    around = (_BEFORE_VOWEL, mnemonic) if is_vowel else (mnemonic, _AFTER_CONSONANT)
    events = speak(f"[[{'|'.join(around)}]]", voice, phoneme_input=True).phones
    labels = [event.label for event in events if event.label]
    own = labels[1:] if is_vowel else labels[:-1]
    try:
        return tuple(sound.phone for label in own for sound in read_espeak(label, voice))
    except LipwrightError:  # a label that is no IPA
        return ()


@cache
def mnemonics_of(phone: str, voice: str) -> tuple[str, ...]:
    """The mnemonics of a voice, one after the other, that sound most like a phone of the table.

    Raises:
        LipwrightError: espeak-ng is missing, or has no such voice.
    """
    parts = PHONES[phone].parts
    for one in (phone, *nearest_phones(phone, MNEMONICS)):
        is_vowel = PHONES[one].is_vowel or one in _SYLLABIC
        for mnemonic in MNEMONICS[one].split():
            if _heard(mnemonic, is_vowel, voice) in ((one,), PHONES[one].parts):
                return (mnemonic,)
        if parts and one == phone:
            return tuple(said for part in parts for said in mnemonics_of(part, voice))
    raise LipwrightError(f"the voice espeak:{voice} cannot say the phone {phone}; name another")


def phoneme_input(phones: Sequence[str], voice: str) -> str:
    """What makes a voice say `phones`, in double brackets; its first vowel has the stress."""
    written, stressed = [], False
    for phone in phones:
        if phone == SILENCE:
            written.append("_:")
            continue
        first, *others = mnemonics_of(phone, voice)
        stress = "'" if PHONES[phone].is_vowel and not stressed else ""
        stressed = stressed or bool(stress)
        written += [stress + first, *others]
    return f"[[{'|'.join(written)}]]"
