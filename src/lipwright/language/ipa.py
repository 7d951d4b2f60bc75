"""Any IPA to the phone table, by what is seen: lip closure, rounding, jaw, then tongue.

`PHONE_OF` has every letter of the chart of the International Phonetic Association (2020 revision
of the 2015 chart; its consonants, non-pulmonic consonants, other symbols and vowels), and the
letters that dictionaries and espeak-ng write beside it. Only sounds at which both lips meet become
P, B or M. Diacritics, tones and lengths do not change the phone, unless `_MARKED` says so.

Where the table of a track file's labels (`phones.parse_phone`) differs, it reads English: there
"r" is the R of "red", here it is the trill, unless the language is said to be English.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.phones import PHONES

# fmt: off
PHONE_OF: Final = MappingProxyType({
    # plosives: Pin, Bin, Tin, Din, koRT (sv), boRD (sv), týK (cs ť), ďas (cs), Cat, Go, Qalb (ar)
    "p": "P", "b": "B", "t": "T", "d": "D", "ʈ": "XT", "ɖ": "XD", "c": "K", "ɟ": "G",
    "k": "K", "ɡ": "G", "g": "G", "q": "K", "ɢ": "G", "ʔ": "Q", "ʡ": "Q",
    # nasals: Map, triuMph (lip to teeth), Nap, baRN (sv), aÑo (es), siNG, hoN (ja)
    "m": "M", "ɱ": "V", "n": "N", "ɳ": "XN", "ɲ": "N", "ŋ": "NG", "ɴ": "NG",
    # trills and taps: peRRo (es), paRis (fr, old), peRo (es), baRī (hi), mangbetu (lips: ʙ)
    "ʙ": "B", "r": "XR", "ʀ": "G", "ⱱ": "V", "ɾ": "DX", "ɽ": "DX", "ɺ": "L", "ɼ": "XR",
    # fricatives: Fu (ja), haBa (es), Fan, Van, THin, THen, Sip, Zip, SHip, meaSure, foRS (sv),
    # Ri (zh), iCH (de), aYer (es), aCH (de), aGua (es), baCH (nl), Rue (fr), ḥā' and ʿayn (ar), Hat
    "ɸ": "F", "β": "V", "f": "F", "v": "V", "θ": "TH", "ð": "DH", "s": "S", "z": "Z",
    "ʃ": "SH", "ʒ": "ZH", "ʂ": "XS", "ʐ": "XZ", "ç": "Y", "ʝ": "Y", "x": "K", "ɣ": "G",
    "χ": "K", "ʁ": "G", "ħ": "HH", "ʕ": "HV", "h": "HH", "ɦ": "HV", "ʜ": "HH", "ʢ": "HV",
    "ɕ": "XC", "ʑ": "XC", "ɧ": "XH", "ɬ": "L", "ɮ": "L",
    # approximants: Wang (nl), Red, tamiL (ta), Yes, aGua (es, weak), Wet, WHich (Scots), Huit (fr)
    "ʋ": "V", "ɹ": "R", "ɻ": "XZ", "j": "Y", "ɰ": "G", "w": "W", "ʍ": "WH", "ɥ": "XIY",
    # laterals: Lip, käRL (sv), fiGLio (it), miLK (dark), mid-waghi (ʟ)
    "l": "L", "ɭ": "XL", "ʎ": "L", "ʟ": "L", "ɫ": "L",
    # clicks, at the lips, teeth, ridge, palate and side; implosives
    "ʘ": "P", "ǀ": "T", "ǃ": "T", "ǂ": "T", "ǁ": "L",
    "ɓ": "B", "ɗ": "D", "ᶑ": "XD", "ʄ": "G", "ɠ": "G", "ʛ": "G",
    # letters that are affricates
    "ʧ": "CH", "ʤ": "JH", "ʦ": "XTS", "ʨ": "XTC", "ʥ": "XTC",
    # vowels, from closed to open: front, central, back
    "i": "IY", "y": "XIY", "ɨ": "IX", "ʉ": "UX", "ɯ": "IX", "u": "UW",
    "ɪ": "IH", "ʏ": "XIH", "ᵻ": "IX", "ᵿ": "UH", "ʊ": "UH",
    "e": "EH", "ø": "XEY", "ɘ": "AX", "ɵ": "UH", "ɤ": "XOW", "o": "AO",
    "ə": "AX", "ɚ": "AXR",
    "ɛ": "EH", "œ": "XEH", "ɜ": "ER", "ɝ": "ER", "ɞ": "XEH", "ʌ": "AH", "ɔ": "AO",
    "æ": "AE", "ɐ": "AH",
    "a": "AA", "ɶ": "XEH", "ɑ": "AA", "ɒ": "AO",
    # vowels of sinologists: sI, shI, and both with rounded lips
    "ɿ": "XSI", "ʅ": "XRI", "ʮ": "UX", "ʯ": "UX",
})
"""letter to the phone that shows it"""

# Marks that make another phone of a letter: syllabic, non-syllabic (a glide), rhotic, nasal tap.
_SYLLABIC: Final = "\N{COMBINING VERTICAL LINE BELOW}"
_GLIDE: Final = "\N{COMBINING INVERTED BREVE BELOW}"
_NASAL: Final = "\N{COMBINING TILDE}"
_TIE: Final = "\N{COMBINING DOUBLE INVERTED BREVE}"
_MARKED: Final = MappingProxyType({
    "m" + _SYLLABIC: "EM", "n" + _SYLLABIC: "EN", "ŋ" + _SYLLABIC: "ENG", "l" + _SYLLABIC: "EL",
    "ɫ" + _SYLLABIC: "EL", "ɹ" + _SYLLABIC: "ER", "ɻ" + _SYLLABIC: "XRI", "ʐ" + _SYLLABIC: "XRI",
    "z" + _SYLLABIC: "XSI", "ə˞": "AXR", "ɜ˞": "ER", "ɾ" + _NASAL: "NX",
    "i" + _GLIDE: "Y", "ɪ" + _GLIDE: "Y", "u" + _GLIDE: "W", "ʊ" + _GLIDE: "W",
    "y" + _GLIDE: "XIY",
})

# Two letters that are one phone, tied or not; a tie is written where it makes the difference.
_PAIRS: Final = MappingProxyType({
    "tʃ": "CH", "dʒ": "JH", "ts": "XTS", "tɕ": "XTC", "dʑ": "XTC", "tʂ": "XCH", "ʈʂ": "XCH",
    "aɪ": "AY", "ai": "AY", "ʌɪ": "AY", "ɑɪ": "AY", "ɑi": "AY",
    "aʊ": "AW", "au": "AW", "æʊ": "AW", "ɑʊ": "AW", "ɑu": "AW",
    "eɪ": "EY", "ei": "EY", "ɛɪ": "EY", "ɛi": "EY",
    "oʊ": "OW", "ou": "OW", "əʊ": "OW", "ɔʊ": "OW", "ɔu": "OW",
    "ɔɪ": "OY", "oɪ": "OY", "oi": "OY", "ɔi": "OY",
    # the lips close and the tongue's back rises at once, as in igbo (ig)
    f"k{_TIE}p": "P", f"ɡ{_TIE}b": "B", f"ŋ{_TIE}m": "M",
})
# fmt: on

# Letters that the transcribers of a language use for another sound: Red, cAt (of late).
_BY_LANGUAGE: Final = MappingProxyType({
    "en": MappingProxyType({"r": "R", "a": "AE"}),
})  # fmt: skip

_STRESS: Final = MappingProxyType({"ˈ": 1, "ˌ": 2})
_TIES: Final = "\N{COMBINING DOUBLE INVERTED BREVE}\N{COMBINING DOUBLE BREVE BELOW}"
_LENGTHS: Final = "ːˑ:"  # kept in `Sound.ipa`, as it is a part of many phonemes

# What a raised letter adds as a sound of its own, once a letter stands before it: kʷ rounds.
_RAISED: Final = MappingProxyType({"ʷ": "W", "ᶣ": "XIY"})
# and where none does, as in the events of a voice that come one by one.
_ALONE: Final = MappingProxyType({"ʲ": "Y"})

# Tones, releases, phonations and secondary articulations: unseen.
_UNSEEN: Final = frozenset(
    "ʰʱʲˠˤᵝⁿᵐᵑˡᵊᵗᵏˀʼ'’ˁ˞ʻ`´^~₀₁₂₃₄₅₆₇₈₉⁰¹²³⁴⁵⁶⁷⁸⁹0123456789˥˦˧˨˩↗↘↑↓→ꜛꜜꜝˊˋˉˇˆ˗˔˕˖"
)
_BREAKS: Final = frozenset('.|‖‿_-–—/\\[](){}<>,;!?…¡¿"“”«»')
_SWITCH: Final = re.compile(r"\([a-z]{2,4}(?:-[A-Za-z0-9-]+)?\)")  # espeak's "(en)"

_CEDILLA: Final = "c\N{COMBINING CEDILLA}"


@dataclass(frozen=True)
class Sound:
    """One sound of a language and the phone that shows it."""

    ipa: str
    """as written, with its marks and length, without stress, tones and ties: "ɑː", "tʃ", "nʲ" """
    phone: str
    """symbol of the phone table"""
    stress: int | None = None
    """1 or 2 on the vowel or syllabic consonant behind a stress mark; None where none is written"""


@dataclass
class _Letter:
    """A base letter and what belongs to it."""

    base: str
    """with the marks that change its phone"""
    written: str
    stress: int | None
    """of the mark right before it"""
    follows: bool
    """whether nothing stands between it and the letter before"""
    tied: bool = False
    added: list[str] = field(default_factory=list)
    """raised letters that are sounds"""


def read_ipa(text: str, language: str = "") -> tuple[Sound, ...]:
    """The sounds of IPA of any language, one for each phone of the table.

    Diphthongs and affricates of the table are one sound with or without a tie; others are two.
    White space and punctuation only part sounds. Language switches of espeak-ng are left out.

    Args:
        text: IPA.
        language: the code of the language if it is known, as "r" is another sound in English.

    Raises:
        LipwrightError: a letter that is not of the IPA; names it and its place.
    """
    base = language.partition("-")[0].casefold()
    table = {**PHONE_OF, **_BY_LANGUAGE[base]} if base in _BY_LANGUAGE else PHONE_OF
    return _sounds(_letters(text), table)


def _letters(text: str) -> list[_Letter]:
    """The base letters with their marks."""
    plain = _SWITCH.sub(lambda found: " " * len(found[0]), text)
    letters: list[_Letter] = []
    stress: int | None = None
    joined = False
    for column, written in enumerate(plain, 1):
        for char in _decomposed(written):
            if char in PHONE_OF:
                letters.append(_Letter(char, char, stress, joined))
                stress, joined = None, True
            elif char in _STRESS:
                stress, joined = _STRESS[char], False
            elif char.isspace() or char in _BREAKS:
                joined = False
            elif char in _ALONE and not letters:
                letters.append(_Letter(char, char, None, False))
            elif not _mark(char, letters[-1] if letters else None):
                raise LipwrightError(
                    f"{_short(text)}: column {column}: {char!r} is no letter of the "
                    "International Phonetic Alphabet; write the sounds as its chart has them"
                )
    return letters


def _decomposed(char: str) -> str:
    """Letter and marks apart; the cedilla of ç is no mark."""
    parts = unicodedata.normalize("NFD", char)
    return "ç" + parts[len(_CEDILLA) :] if parts.startswith(_CEDILLA) else parts


def _mark(char: str, letter: _Letter | None) -> bool:
    """Put a mark on the letter before it; whether it is a mark."""
    if char in _UNSEEN or char in _LENGTHS or char in _RAISED or unicodedata.category(char) == "Mn":
        if letter is not None:
            _put(char, letter)
        return True
    return False


def _put(char: str, letter: _Letter) -> None:
    if char in _TIES:
        letter.tied = True
        return
    if char in _RAISED:
        letter.added.append(char)
    char = _SYLLABIC if char == "\N{COMBINING VERTICAL LINE ABOVE}" else char
    char = _GLIDE if char == "\N{COMBINING INVERTED BREVE}" else char
    if letter.base + char in _MARKED:
        letter.base += char
    if char in _LENGTHS:
        letter.written += "ˑ" if char == "ˑ" else "ː"
    elif char in "ʰʱʲˠˤʷᶣʼ˞" or unicodedata.category(char) == "Mn":
        letter.written += char


def _sounds(letters: list[_Letter], table: Mapping[str, str]) -> tuple[Sound, ...]:
    """The phones of letters; two that are one phone become one."""
    sounds: list[Sound] = []
    at, pending = 0, None
    while at < len(letters):
        letter = letters[at]
        pending = letter.stress or pending
        phone = _pair(letter, letters[at + 1]) if at + 1 < len(letters) else ""
        one = letters[at : at + 2] if phone else [letter]
        phone = phone or _MARKED.get(letter.base) or _ALONE.get(letter.base) or table[letter.base]
        carries = PHONES[phone].is_vowel or any(_SYLLABIC in part.written for part in one)
        written = "".join(part.written for part in one)
        sounds.append(Sound(written, phone, pending if carries else None))
        pending = None if carries else pending
        sounds += (Sound(raised, _RAISED[raised]) for raised in one[-1].added)
        at += len(one)
    return tuple(sounds)


def _pair(one: _Letter, other: _Letter) -> str:
    """The phone that two letters are together; empty if they are two."""
    if not other.follows or one.added:
        return ""
    bare = one.base[0], other.base[0]
    if other.base[0] != other.base and other.base[1:] != _GLIDE:
        return ""
    return (_PAIRS.get(_TIE.join(bare), "") if one.tied else "") or _PAIRS.get("".join(bare), "")


def _short(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")
