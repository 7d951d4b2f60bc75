"""The phone table: every ARPABET phone, and what other languages add; spelt, made and seen.

ARPABET after the TIMIT and CMU conventions, without stress digits. Place, manner, height and
backness follow the chart of the International Phonetic Association (2015) as used for American
English by Ladefoged and Johnson, "A Course in Phonetics". The common class is that of table 1
in Xu et al. 2013.

Sounds of Swedish and Mandarin that look or sound like none of ARPABET follow it. Their symbols
begin with X, as none of ARPABET does. Of a vowel, X is the same vowel with lips the other way:
XIY is IY with rounded lips, XOW is OW without. Of a consonant, X is the same one elsewhere: XT is T
with the tongue curled back. Made as the "Handbook of the International Phonetic Association" (1999)
has it for Swedish (Engstrand), and Lee and Zee (2003) for Mandarin; their places and manners are
the nearest by what is seen: retroflexes are alveolar (XS, XZ and XCH, with lips forward,
postalveolar), XC and XTC are alveolar too, as the teeth meet and the lips stay back, XH, which is
SH and a velar fricative at once, is postalveolar, and the trill XR is a flap.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from lipwright.errors import LipwrightError

SILENCE: Final = "sil"

Alphabet = Literal["arpabet", "ipa", "xsampa"]

COMMON: Final[tuple[str, ...]] = (
    "ah", "aa", "ao", "eh", "er", "ih", "w", "ow", "aw", "oy", "ay",
    "h", "r", "l", "z", "sh", "th", "f", "d", "kg", "bmp",
)  # fmt: skip
"""the 21 classes of the Common Phoneme Set (Xu et al. 2013, table 1)"""

# Ordered, so that a difference of position is a distance.
HEIGHTS: Final = ("low", "near-low", "low-mid", "mid", "high-mid", "near-high", "high")
BACKNESSES: Final = ("front", "central", "back")
PLACES: Final = (
    "bilabial", "labiodental", "dental", "alveolar", "postalveolar",
    "palatal", "velar", "labiovelar", "glottal",
)  # fmt: skip
MANNERS: Final = ("stop", "affricate", "fricative", "nasal", "flap", "lateral", "approximant")


@dataclass(frozen=True)
class Phone:
    """One row of the table."""

    symbol: str
    """ARPABET, `sil`, or X and more for what ARPABET lacks"""
    ipa: str
    """its usual IPA letters; empty for silence"""
    xsampa: str
    """the same in X-SAMPA"""
    example: str
    """a word with the phone's letters in capitals; the language follows if it is not English"""
    common: str
    """class of the Common Phoneme Set; empty for silence"""
    manner: str = ""
    """one of MANNERS; empty for vowels and silence"""
    place: str = ""
    """one of PLACES; empty for vowels and silence"""
    voiced: bool = True
    height: str = ""
    """one of HEIGHTS, of a diphthong's first part; empty for consonants"""
    backness: str = ""
    """one of BACKNESSES, of a diphthong's first part; empty for consonants"""
    rounded: bool = False
    """the lips are rounded somewhere in the phone"""
    parts: tuple[str, str] | None = None
    """the phones that a diphthong or affricate moves between"""

    @property
    def is_silence(self) -> bool:
        """Whether nothing is said."""
        return self.symbol == SILENCE

    @property
    def is_vowel(self) -> bool:
        """Whether it is a vowel or diphthong."""
        return bool(self.height)

    @property
    def is_diphthong(self) -> bool:
        """Whether it is a vowel that moves from one quality to another."""
        return self.is_vowel and self.parts is not None

    @property
    def is_consonant(self) -> bool:
        """Whether it is a consonant."""
        return bool(self.manner)


def _vowel(
    symbol: str, ipa: str, xsampa: str, example: str, common: str, height: str, backness: str,
    rounded: bool = False, parts: tuple[str, str] | None = None,
) -> Phone:  # fmt: skip
    return Phone(symbol, ipa, xsampa, example, common,
                 height=height, backness=backness, rounded=rounded, parts=parts)  # fmt: skip


def _consonant(
    symbol: str, ipa: str, xsampa: str, example: str, common: str, manner: str, place: str,
    voiced: bool, rounded: bool = False, parts: tuple[str, str] | None = None,
) -> Phone:  # fmt: skip
    return Phone(symbol, ipa, xsampa, example, common,
                 manner, place, voiced, rounded=rounded, parts=parts)  # fmt: skip


_ENGLISH: Final[tuple[Phone, ...]] = (
    Phone(SILENCE, "", "", "(silence)", "", voiced=False),
    # symbol, IPA, X-SAMPA, example, common class, height, backness, rounded, parts
    _vowel("AA", "ɑ", "A", "fAther", "aa", "low", "back"),
    _vowel("AE", "æ", "{", "cAt", "ah", "near-low", "front"),
    _vowel("AH", "ʌ", "V", "cUt", "ah", "low-mid", "central"),
    _vowel("AX", "ə", "@", "Ago", "ah", "mid", "central"),
    _vowel("AO", "ɔ", "O", "dOg", "ao", "low-mid", "back", True),
    _vowel("AW", "aʊ", "aU", "fOUl", "aw", "low", "central", True, ("AA", "UH")),
    _vowel("AXR", "ɚ", "@`", "lettER", "er", "mid", "central"),
    _vowel("AY", "aɪ", "aI", "bIte", "ay", "low", "central", False, ("AA", "IH")),
    _vowel("EH", "ɛ", "E", "pEt", "eh", "low-mid", "front"),
    _vowel("ER", "ɝ", "3`", "fUR", "er", "low-mid", "central"),
    _vowel("EY", "eɪ", "eI", "AtE", "eh", "high-mid", "front", False, ("EH", "IH")),
    _vowel("IH", "ɪ", "I", "fIll", "ih", "near-high", "front"),
    _vowel("IX", "ɨ", "1", "debIt", "ih", "high", "central"),
    _vowel("IY", "i", "i", "fEEl", "ih", "high", "front"),
    _vowel("OW", "oʊ", "oU", "gO", "ow", "high-mid", "back", True, ("AO", "UH")),
    _vowel("OY", "ɔɪ", "OI", "tOY", "oy", "low-mid", "back", True, ("AO", "IH")),
    _vowel("UH", "ʊ", "U", "bOOk", "w", "near-high", "back", True),
    _vowel("UW", "u", "u", "tOO", "w", "high", "back", True),
    _vowel("UX", "ʉ", "}", "dUde", "w", "high", "central", True),
    # symbol, IPA, X-SAMPA, example, common class, manner, place, voiced, rounded, parts
    _consonant("P", "p", "p", "Put", "bmp", "stop", "bilabial", False),
    _consonant("B", "b", "b", "Big", "bmp", "stop", "bilabial", True),
    _consonant("T", "t", "t", "Talk", "d", "stop", "alveolar", False),
    _consonant("D", "d", "d", "Dig", "d", "stop", "alveolar", True),
    _consonant("K", "k", "k", "Cut", "kg", "stop", "velar", False),
    _consonant("G", "ɡ", "g", "Gut", "kg", "stop", "velar", True),
    _consonant("Q", "ʔ", "?", "uh-oh (the catch)", "h", "stop", "glottal", False),
    _consonant("CH", "t͡ʃ", "tS", "CHin", "sh", "affricate", "postalveolar", False, True,
               ("T", "SH")),
    _consonant("JH", "d͡ʒ", "dZ", "Joy", "sh", "affricate", "postalveolar", True, True,
               ("D", "ZH")),
    _consonant("F", "f", "f", "Fork", "f", "fricative", "labiodental", False),
    _consonant("V", "v", "v", "Vat", "f", "fricative", "labiodental", True),
    _consonant("TH", "θ", "T", "THin", "th", "fricative", "dental", False),
    _consonant("DH", "ð", "D", "THen", "th", "fricative", "dental", True),
    _consonant("S", "s", "s", "Sit", "z", "fricative", "alveolar", False),
    _consonant("Z", "z", "z", "Zap", "z", "fricative", "alveolar", True),
    _consonant("SH", "ʃ", "S", "SHe", "sh", "fricative", "postalveolar", False, True),
    _consonant("ZH", "ʒ", "Z", "pleaSure", "sh", "fricative", "postalveolar", True, True),
    _consonant("HH", "h", "h", "Help", "h", "fricative", "glottal", False),
    _consonant("HV", "ɦ", "h\\", "aHead", "h", "fricative", "glottal", True),
    _consonant("M", "m", "m", "Mat", "bmp", "nasal", "bilabial", True),
    _consonant("EM", "m̩", "m=", "bottoM", "bmp", "nasal", "bilabial", True),
    _consonant("N", "n", "n", "No", "d", "nasal", "alveolar", True),
    _consonant("EN", "n̩", "n=", "buttON", "d", "nasal", "alveolar", True),
    _consonant("NG", "ŋ", "N", "siNG", "d", "nasal", "velar", True),
    _consonant("ENG", "ŋ̍", "N=", "washiNGton", "d", "nasal", "velar", True),
    _consonant("DX", "ɾ", "4", "buTTer", "d", "flap", "alveolar", True),
    _consonant("NX", "ɾ̃", "4~", "wiNNer", "d", "flap", "alveolar", True),
    _consonant("L", "l", "l", "Lid", "l", "lateral", "alveolar", True),
    _consonant("EL", "l̩", "l=", "bottLE", "l", "lateral", "alveolar", True),
    _consonant("R", "ɹ", "r\\", "Red", "r", "approximant", "postalveolar", True, True),
    _consonant("Y", "j", "j", "Yard", "sh", "approximant", "palatal", True),
    _consonant("W", "w", "w", "With", "w", "approximant", "labiovelar", True, True),
    _consonant("WH", "ʍ", "W", "WHich", "w", "approximant", "labiovelar", False, True),
)  # fmt: skip

# After the English rows, whose places in the table are those of models trained before.
_OTHERS: Final[tuple[Phone, ...]] = (
    # symbol, IPA, X-SAMPA, example, common class, height, backness, rounded
    _vowel("XIY", "y", "y", "nY (Swedish)", "w", "high", "front", True),
    _vowel("XIH", "ʏ", "Y", "nYtt (Swedish)", "w", "near-high", "front", True),
    _vowel("XEY", "ø", "2", "sÖt (Swedish)", "w", "high-mid", "front", True),
    _vowel("XEH", "œ", "9", "rÖtt (Swedish)", "ao", "low-mid", "front", True),
    _vowel("XOW", "ɤ", "7", "gE (Mandarin)", "ah", "high-mid", "back"),
    _vowel("XSI", "ɿ", "z=", "sI (Mandarin)", "z", "high", "central"),
    _vowel("XRI", "ʅ", "z`=", "shI (Mandarin)", "er", "high", "central"),
    # symbol, IPA, X-SAMPA, example, common class, manner, place, voiced, rounded, parts
    _consonant("XT", "ʈ", "t`", "koRT (Swedish)", "d", "stop", "alveolar", False),
    _consonant("XD", "ɖ", "d`", "boRD (Swedish)", "d", "stop", "alveolar", True),
    _consonant("XN", "ɳ", "n`", "baRN (Swedish)", "d", "nasal", "alveolar", True),
    _consonant("XL", "ɭ", "l`", "käRL (Swedish)", "l", "lateral", "alveolar", True),
    _consonant("XR", "r̪", "r_d", "Ris (Swedish)", "d", "flap", "alveolar", True),
    _consonant("XS", "ʂ", "s`", "foRS (Swedish)", "sh", "fricative", "postalveolar", False, True),
    _consonant("XZ", "ʐ", "z`", "Ri (Mandarin)", "sh", "fricative", "postalveolar", True, True),
    _consonant("XC", "ɕ", "s\\", "TJog (Swedish)", "z", "fricative", "alveolar", False),
    _consonant("XH", "ɧ", "x\\", "SJäl (Swedish)", "sh", "fricative", "postalveolar", False,
               True),
    _consonant("XTS", "t͡s", "ts", "Zai (Mandarin)", "z", "affricate", "alveolar", False,
               parts=("T", "S")),
    _consonant("XTC", "t͡ɕ", "ts\\", "Jia (Mandarin)", "z", "affricate", "alveolar", False,
               parts=("T", "XC")),
    _consonant("XCH", "ʈ͡ʂ", "ts`", "ZHong (Mandarin)", "sh", "affricate", "postalveolar",
               False, True, ("XT", "XS")),
)  # fmt: skip
_ROWS: Final = (*_ENGLISH, *_OTHERS)

PHONES: Final = MappingProxyType({phone.symbol: phone for phone in _ROWS})
"""symbol to row, in the order of the table"""

ARPABET: Final = frozenset(phone.symbol for phone in _ENGLISH)
"""the phones of English, and silence"""

BILABIALS: Final = frozenset(p.symbol for p in _ROWS if p.place == "bilabial")
"""the phones at which the lips touch"""

# Labels that tools write for silence, pauses and noise (MFA, Praat, HTK, Kaldi, TIMIT,
# pocketsphinx, espeak, MBROLA, FestVox, BAS).
SILENCE_LABELS: Final = frozenset(
    ("", "sil", "sp", "spn", "<sil>", "<p>", "<p:>", "<eps>", "_", "_:", "_;", "pau", "h#", "#h",
     "#", "ssil", "brth", "noise", "nsn", "lau", "{sl}", "{ns}", "-", "...", "epi", "<s>",
     "</s>", "++noise++", "[noise]", "<unk>", "[spn]", "[sil]")
)  # fmt: skip

# Other spellings for the same phone: transcribers differ, and British English has a few vowels
# that the table writes with their nearest American phone.
_IPA_ALSO: Final = MappingProxyType({
    "g": "G", "r": "R", "ɾ": "DX", "ʧ": "CH", "tʃ": "CH", "ʤ": "JH", "dʒ": "JH", "əʊ": "OW",
    "o": "AO", "e": "EH", "a": "AE", "ɐ": "AH", "ɒ": "AA", "ɜ": "ER", "ɝ": "ER", "əɹ": "AXR",
    "ɜɹ": "ER", "ɪə": "IH", "iə": "IY", "eə": "EH", "ɛə": "EH", "ʊə": "UH", "ᵻ": "IX", "ɵ": "UH",
    "ou": "OW", "ei": "EY", "ai": "AY", "au": "AW", "ɔi": "OY", "oi": "OY", "əl": "EL", "ən": "EN",
    "əm": "EM", "ɫ": "L", "ʌɪ": "AY", "aː": "AA", "ɛɪ": "EY", "æʊ": "AW", "ɑɪ": "AY", "ɑʊ": "AW",
    "l̩": "EL", "ɹ̩": "ER", "χ": "K", "x": "K", "ʲ": "Y", "i̯": "Y", "aɪə": "AY", "aʊə": "AW",
    "ɥ": "XIY", "z̩": "XSI", "ʐ̩": "XRI", "ɻ̩": "XRI", "ɻ": "XZ",
    "oːɹ": "AO", "ɔːɹ": "AO", "ɑːɹ": "AA", "ɛɹ": "EH", "ɪɹ": "IH", "ʊɹ": "UH",
})  # fmt: skip
_XSAMPA_ALSO: Final = MappingProxyType({
    "r": "R", "@U": "OW", "e": "EH", "a": "AE", "Q": "AA", "3": "ER", "3:": "ER", "A:": "AA",
    "i:": "IY", "u:": "UW", "O:": "AO", "I@": "IH", "i@": "IY", "e@": "EH", "E@": "EH", "U@": "UH",
    "@L": "EL", "I2": "IX", "a#": "AX", "I#": "IX", "0": "AA", "0#": "AX", "VI": "AY", "aa": "AE",
    "@2": "AX", "@5": "AX", "I2#": "IX", "a2": "AX", "eI": "EY", "EI": "EY", "t#": "DX", "t2": "T",
    "l#": "EL", "n-": "EN", "m-": "EM", "l-": "EL", "A@": "AA", "O@": "AO", "o@": "AO", "aI@": "AY",
    "aI3": "AY", "aU@": "AW", "i@3": "IH", "3r": "ER", "A#": "AA", "o": "AO", "oU#": "OW",
    "w#": "WH", "H": "XIY", "r\\`": "XZ",
    "h": "HH", "n^": "N", "tS;": "CH", "?": "Q", "d2": "D", "z2": "Z", "D2": "DH", "e2": "EH",
})  # fmt: skip
_MARKS: Final = str.maketrans("", "", "ˈˌˑː.‿͜͡'\"%,:;ʰ")  # stress, length, ties, aspiration


def _table(column: str, also: Iterable[tuple[str, str]]) -> MappingProxyType[str, str]:
    rows = {getattr(phone, column): phone.symbol for phone in _ROWS if not phone.is_silence}
    rows.update(also)
    bare = {spelling.translate(_MARKS): symbol for spelling, symbol in rows.items()}
    return MappingProxyType({**bare, **rows})


_SPELLINGS: Final = MappingProxyType({
    "ipa": _table("ipa", _IPA_ALSO.items()),
    "xsampa": _table("xsampa", _XSAMPA_ALSO.items()),
})  # fmt: skip


def is_silence_label(label: str) -> bool:
    """Whether a label of any tool means that nothing is said."""
    return label.strip().casefold() in SILENCE_LABELS


def parse_phone(label: str, alphabet: Alphabet = "arpabet") -> tuple[str, int | None]:
    """The symbol of a label and its stress (0, 1, 2, or None where the label has none).

    Raises:
        LipwrightError: the alphabet has no such phone.
    """
    text = label.strip()
    if is_silence_label(text):
        return SILENCE, None
    if alphabet == "arpabet":
        stress = int(text[-1]) if text[-1] in "012" and len(text) > 1 else None
        symbol = (text if stress is None else text[:-1]).upper()
        if symbol in PHONES:
            return symbol, stress
    else:
        stress = 1 if text[0] in "ˈ'\"" else 2 if text[0] in "ˌ,%" else None
        spellings = _SPELLINGS[alphabet]
        text = text.lstrip("ˈ'\"ˌ,%")
        symbol = spellings.get(text) or spellings.get(text.translate(_MARKS), "")
        if symbol:
            return symbol, stress
    raise LipwrightError(
        f"unknown {alphabet} phone {label!r}; 'lipwright phones' lists the known ones"
    )


def guess_alphabet(labels: Iterable[str]) -> Alphabet:
    """The alphabet that spells all `labels`: ARPABET, else IPA, else X-SAMPA.

    Raises:
        LipwrightError: no alphabet spells them all; names the first label that ARPABET lacks.
    """
    labels = list(dict.fromkeys(labels))
    first: LipwrightError | None = None
    for alphabet in ("arpabet", "ipa", "xsampa"):
        try:
            for label in labels:
                parse_phone(label, alphabet)
        except LipwrightError as error:
            first = first or error
        else:
            return alphabet
    assert first is not None  # each alphabet that is left failed
    raise first


def _position(scale: tuple[str, ...], one: str, other: str) -> float:
    return abs(scale.index(one) - scale.index(other)) / (len(scale) - 1)


# Weights of the distance: what is seen counts most (lips and jaw before tongue and voice).
_PLACE_GROUPS: Final = MappingProxyType({
    "bilabial": "lips shut", "labiodental": "lip to teeth", "dental": "tongue front",
    "alveolar": "tongue front", "postalveolar": "lips forward", "palatal": "tongue body",
    "velar": "tongue body", "labiovelar": "lips round", "glottal": "throat",
})  # fmt: skip


def phone_distance(one: str, other: str) -> float:
    """How differently two phones are made and seen; 0 for the same phone, at most about 6."""
    a, b = PHONES[one], PHONES[other]
    if a.symbol == b.symbol:
        return 0.0
    if a.is_silence or b.is_silence:
        return 6.0
    rounded = float(a.rounded != b.rounded)
    common = 0.5 * (a.common != b.common)
    if a.is_vowel != b.is_vowel:
        # A glide is a vowel that nobody holds: W is near UW, Y near IY.
        vowel, consonant = (a, b) if a.is_vowel else (b, a)
        glide = {"W": "UW", "WH": "UW", "Y": "IY", "R": "ER"}.get(consonant.symbol)
        return 5.0 if glide is None else 1.0 + phone_distance(glide, vowel.symbol)
    if a.is_vowel:
        moves = 0.8 * (a.is_diphthong != b.is_diphthong)
        if a.parts and b.parts:
            moves = 0.5 * phone_distance(a.parts[1], b.parts[1])
        return (
            1.5 * _position(HEIGHTS, a.height, b.height)
            + 0.6 * _position(BACKNESSES, a.backness, b.backness)
            + rounded + common + moves + 0.01
        )  # fmt: skip
    place = 0.0 if a.place == b.place else 0.4
    group = 1.2 * (_PLACE_GROUPS[a.place] != _PLACE_GROUPS[b.place])
    manner = 0.0 if a.manner == b.manner else 0.5
    return place + group + manner + 0.5 * rounded + common + 0.15 * (a.voiced != b.voiced) + 0.01


def nearest_phones(symbol: str, among: Iterable[str] | None = None) -> tuple[str, ...]:
    """The phones of `among` (default: all) from the most to the least alike, without `symbol`.

    An engine that never learnt a phone uses the first that it knows. Ties keep the table's order.

    Raises:
        KeyError: the table has no such phone.
    """
    if symbol not in PHONES:
        raise KeyError(f"the phone table has no {symbol!r}")
    wanted = PHONES.keys() if among is None else set(among)
    others = [phone for phone in PHONES if phone in wanted and phone != symbol]
    return tuple(sorted(others, key=lambda other: phone_distance(symbol, other)))
