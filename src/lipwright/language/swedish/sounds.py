"""The sounds of Swedish: the symbols of the thesis, each with its phones and an example.

"Visual speech in Swedish" (2018, the thesis) has 45 symbols: three for silence, pause and null,
each vowel long and short, and the retroflexes as sounds of their own. It does not list them; the
42 here are those of its example words and of SAMPA for Swedish (Wells 1997): 18 consonants, the
five that r makes of t d n s l, nine vowels each long and short, of which short e and short ä are
one, and ä before r, long and short. Long ö before r, as open as short ö, has a row of its own, as
in SAMPA ("9:"). Qualities after Engstrand, "Handbook of the International Phonetic Association"
(1999).

Inside this package a sound is its IPA, behind "ˈ" in the stressed syllable's vowel and behind "ˌ"
in that of later parts of a compound. "rː" is an r that stays: after a short vowel, written rr.
"""

from __future__ import annotations

from collections.abc import Iterable
from types import MappingProxyType
from typing import Final

from lipwright.language.base import Phoneme, Pronunciation, Source

STRESSES: Final = MappingProxyType({"ˈ": 1, "ˌ": 2})
"""mark before a vowel to the stress of a phone track"""

LONG_R: Final = "rː"

_TABLE: Final = (
    # IPA, X-SAMPA, phone, example
    ("iː", "i:", "IY", "sIl"),
    ("ɪ", "I", "IH", "sIll"),
    ("yː", "y:", "XIY", "sYl"),
    ("ʏ", "Y", "XIH", "sYll"),
    ("ʉː", "}:", "UX", "fUl"),
    ("ɵ", "8", "UH", "fUll"),
    ("eː", "e:", "EY", "hEl"),
    ("ɛː", "E:", "EH", "hÄl"),
    ("ɛ", "E", "EH", "hÄll"),
    ("æː", "{:", "AE", "hÄr"),
    ("æ", "{", "AE", "hErr"),
    ("øː", "2:", "XEY", "nÖt"),
    ("œ", "9", "XEH", "nÖtt"),
    ("œː", "9:", "XEH", "fÖr"),
    ("ɑː", "A:", "AA", "mAt"),
    ("a", "a", "AA", "mAtt"),
    ("oː", "o:", "OW", "mÅl"),
    ("ɔ", "O", "AO", "mOll"),
    ("uː", "u:", "UW", "bOt"),
    ("ʊ", "U", "UH", "bOtt"),
    ("p", "p", "P", "Pol"),
    ("b", "b", "B", "Bok"),
    ("t", "t", "T", "Tok"),
    ("d", "d", "D", "Dop"),
    ("k", "k", "K", "Kon"),
    ("ɡ", "g", "G", "God"),
    ("f", "f", "F", "Fot"),
    ("v", "v", "V", "Våt"),
    ("s", "s", "S", "Sot"),
    ("ɧ", "x\\", "XH", "SJu"),
    ("ɕ", "s\\", "XC", "TJock"),
    ("h", "h", "HH", "Hot"),
    ("m", "m", "M", "Mod"),
    ("n", "n", "N", "Nod"),
    ("ŋ", "N", "NG", "låNG"),
    ("l", "l", "L", "Lov"),
    ("r", "r", "XR", "Rov"),
    ("j", "j", "Y", "Jord"),
    ("ʈ", "t`", "XT", "paRTi"),
    ("ɖ", "d`", "XD", "noRD"),
    ("ɳ", "n`", "XN", "baRN"),
    ("ʂ", "s`", "XS", "toRSdag"),
    ("ɭ", "l`", "XL", "soRL"),
)  # fmt: skip

XSAMPA: Final = MappingProxyType({ipa: xsampa for ipa, xsampa, _, _ in _TABLE})
PHONE_OF: Final = MappingProxyType({ipa: phone for ipa, _, phone, _ in _TABLE})
INVENTORY: Final = tuple(Phoneme(ipa, (phone,), example) for ipa, _, phone, example in _TABLE)
ALSO_SPELT: Final = MappingProxyType({"œː": "øː"})
"""sounds that the thesis has no symbol for, to the symbol that it writes"""
SILENCES: Final = ("silence", "pause", "null")
"""the three symbols of the thesis that are no sounds, all `sil` on a face"""

SHORT_OF: Final = MappingProxyType({
    "iː": "ɪ", "yː": "ʏ", "ʉː": "ɵ", "eː": "ɛ", "ɛː": "ɛ", "æː": "æ", "øː": "œ", "œː": "œ",
    "ɑː": "a", "oː": "ɔ", "uː": "ʊ",
})  # fmt: skip
VOWELS: Final = frozenset(SHORT_OF) | frozenset(SHORT_OF.values())
LONG_VOWELS: Final = frozenset(SHORT_OF)


def plain(sound: str) -> str:
    """The sound without its stress."""
    return sound.lstrip("ˈˌ")


def is_vowel(sound: str) -> bool:
    """Whether a sound, perhaps with its stress, is a vowel."""
    return plain(sound) in VOWELS


def pronunciation(sounds: Iterable[str], source: Source) -> Pronunciation:
    """The sounds, each with its phone; r is r, long or not."""
    sounds = tuple("r" if sound == LONG_R else sound for sound in sounds)
    ipa = tuple(map(plain, sounds))
    return Pronunciation(
        tuple(PHONE_OF[sound] for sound in ipa),
        source,
        ipa,
        tuple(STRESSES.get(sound[0], 0) if is_vowel(sound) else None for sound in sounds),
    )
