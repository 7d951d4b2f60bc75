"""British pronunciations: a lexicon, weak forms, and American ones by rule.

The accent is that of Wells, "Longman Pronunciation Dictionary" (2008): no r but before vowels
(START ɑː, NURSE ɜː, NEAR ɪə), BATH with ɑː, LOT with a rounded ɒ, GOAT with əʊ, no flaps.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Final

from lipwright.language.base import Phoneme
from lipwright.phones import PHONES

Sound = tuple[str, str, int | None]
"""phone of the table, IPA, and stress of a vowel"""
Said = tuple[Sound, ...]

_VOWELS: Final = MappingProxyType(
    {
        # spelling of the lexicon: phone, IPA; Wells's keyword
        "iː": ("IY", "iː"),  # FLEECE
        "i": ("IY", "i"),  # happY
        "ɪ": ("IH", "ɪ"),  # KIT
        "ɛː": ("EH", "ɛː"),  # SQUARE
        "ɛ": ("EH", "ɛ"),  # DRESS
        "a": ("AE", "æ"),  # TRAP
        "ɑː": ("AA", "ɑː"),  # BATH PALM START
        "ɑ": ("AA", "ɑː"),
        "ɒ": ("AO", "ɒ"),  # LOT CLOTH, with rounded lips
        "ɔː": ("AO", "ɔː"),  # THOUGHT NORTH FORCE
        "ɔ": ("AO", "ɔː"),
        "ʊ": ("UH", "ʊ"),  # FOOT
        "uː": ("UW", "uː"),  # GOOSE
        "u": ("UW", "u"),  # thank yOU
        "ʌ": ("AH", "ʌ"),  # STRUT
        "ɜː": ("ER", "ɜː"),  # NURSE
        "ɜ": ("ER", "ɜː"),
        "əː": ("ER", "ɜː"),  # the same, weak: ExpERt
        "ə": ("AX", "ə"),  # commA lettER; of NEAR ɪə and CURE ʊə as well
        "ᵊ": ("AX", "ə"),  # buttOn, which may be left out
        "A": ("EY", "eɪ"),  # FACE
        "I": ("AY", "aɪ"),  # PRICE
        "Y": ("OY", "ɔɪ"),  # CHOICE
        "Q": ("OW", "əʊ"),  # GOAT
        "W": ("AW", "aʊ"),  # MOUTH
    }
)
_CONSONANTS: Final = MappingProxyType({
    "p": "P", "b": "B", "t": "T", "d": "D", "k": "K", "ɡ": "G", "ʧ": "CH", "ʤ": "JH", "f": "F",
    "v": "V", "θ": "TH", "ð": "DH", "s": "S", "z": "Z", "ʃ": "SH", "ʒ": "ZH", "h": "HH",
    "m": "M", "n": "N", "ŋ": "NG", "l": "L", "ɹ": "R", "j": "Y", "w": "W",
})  # fmt: skip
_STRESSES: Final = MappingProxyType({"ˈ": 1, "ˌ": 2})

LETTERS: Final = MappingProxyType({
    "a": "ˈA", "b": "bˈiː", "c": "sˈiː", "d": "dˈiː", "e": "ˈiː", "f": "ˈɛf", "g": "ʤˈiː",
    "h": "ˈAʧ", "i": "ˈI", "j": "ʤˈA", "k": "kˈA", "l": "ˈɛl", "m": "ˈɛm", "n": "ˈɛn", "o": "ˈQ",
    "p": "pˈiː", "q": "kjˈuː", "r": "ˈɑː", "s": "ˈɛs", "t": "tˈiː", "u": "jˈuː", "v": "vˈiː",
    "w": "dˈʌbᵊljuː", "x": "ˈɛks", "y": "wˈI", "z": "zˈɛd",
})  # fmt: skip
"""names of the letters, in the spelling of the lexicon"""

# Said so in running text, most usual first; Wells 2008.
WEAK: Final = MappingProxyType({
    "a": "ə", "an": "ən", "the": "ðə ði", "and": "ən ənd", "or": "ɔː ə", "but": "bət",
    "of": "əv", "to": "tə tu", "for": "fə", "from": "fɹəm", "at": "ət", "as": "əz", "than": "ðən",
    "that": "ðət", "some": "səm", "am": "əm", "are": "ə", "was": "wəz", "were": "wə",
    "been": "bɪn", "do": "də du", "does": "dəz", "have": "həv əv", "has": "həz əz",
    "had": "həd əd", "can": "kən", "could": "kəd", "should": "ʃəd", "would": "wəd", "must": "məst",
    "shall": "ʃəl", "he": "hi", "him": "hɪm ɪm", "his": "hɪz ɪz", "her": "hə ə", "she": "ʃi",
    "them": "ðəm", "us": "əs", "we": "wi", "me": "mi", "be": "bi", "you": "ju", "your": "jə",
})  # fmt: skip
# Other words of which the lexicon has no British way, or one way of two that are common.
ALSO: Final = MappingProxyType({
    "ate": "ˈɛt", "either": "ˈiːðə", "neither": "nˈiːðə", "schedule": "skˈɛdjuːl",
    "again": "əɡˈAn", "privacy": "pɹˈIvəsi", "garage": "ɡˈaɹɪʤ", "sure": "ʃˈɔː", "poor": "pˈʊə",
    "tour": "tˈɔː", "often": "ˈɒftən", "h": "hˈAʧ",
})  # fmt: skip

_LINKING: Final = frozenset(("AX", "AA", "AO", "ER", "EH"))  # that an r may follow


def read_said(text: str) -> Said:
    """The sounds of a spelling of the lexicon."""
    found: list[Sound] = []
    stress, at = 0, 0
    while at < len(text):
        char = text[at]
        pair = text[at : at + 2]
        at += 2 if pair in _VOWELS else 1
        if char in _STRESSES:
            stress = _STRESSES[char]
        elif vowel := _VOWELS.get(pair) or _VOWELS.get(char):
            found.append((*vowel, stress))
            stress = 0
        else:
            phone = _CONSONANTS[char]
            found.append((phone, PHONES[phone].ipa, None))
    return tuple(found)


def with_phones(said: Said, phones: tuple[str, ...]) -> Said:
    """The sounds and more of them behind, as endings have them."""
    return (*said, *(_plain(phone) for phone in phones))


def _plain(phone: str) -> Sound:
    """A sound of an ending: vowels are weak."""
    phone = {"AH": "AX", "ER": "AX"}.get(phone, phone)
    return (phone, PHONES[phone].ipa, 0 if PHONES[phone].is_vowel else None)


def links_r(word: str, said: Said) -> bool:
    """Whether an r that is written at the end of the word is said before a vowel."""
    phone, ipa, _ = said[-1]
    return word.endswith(("r", "re")) and phone in _LINKING and ipa != "ɛ"


class BritishLexicon:
    """The British lexicon that comes with hibari (87,000 words, and 110,000 of less care).

    It takes a quarter of a second to load, the second half when the first lacks a word.
    """

    @cached_property
    def _first(self) -> dict[str, str | dict[str, str | None]]:
        return _read("lexicon_gb_gold.json.gz")

    @cached_property
    def _second(self) -> dict[str, str | dict[str, str | None]]:
        return _read("lexicon_gb_silver.json.gz")

    def __contains__(self, word: object) -> bool:
        """Whether the lexicon has the word, given in lower case."""
        return isinstance(word, str) and bool(self.lookup(word))

    def lookup(self, word: str) -> tuple[Said, ...]:
        """The ways to say the word, given in lower case; none if it is missing."""
        spellings = (word, word.capitalize(), *([word.upper()] if len(word) > 1 else []))
        for table in ("_first", "_second"):
            for spelling in spellings:
                if entry := getattr(self, table).get(spelling):
                    rows = [entry] if isinstance(entry, str) else list(entry.values())
                    return tuple(dict.fromkeys(read_said(row) for row in rows if row))
        return ()


def _read(name: str) -> dict[str, str | dict[str, str | None]]:
    """A lexicon of hibari, without importing it, which would load what it speaks with."""
    spec = find_spec("hibari")
    assert spec is not None  # a core dependency
    assert spec.submodule_search_locations is not None
    packed = Path(spec.submodule_search_locations[0], "assets", name).read_bytes()
    entries: dict[str, str | dict[str, str | None]] = json.loads(gzip.decompress(packed))
    return entries


def from_american(word: str, phones: tuple[str, ...]) -> Said:
    """A way of the CMU dictionary as the British say it, by rule.

    The dictionary has no stress, so that ER and AH are weak in all syllables but the first.
    """
    return tuple(_british(word, phones))


def _british(word: str, phones: tuple[str, ...]) -> Iterator[Sound]:
    first = True
    for at, phone in enumerate(phones):
        after = phones[at + 1] if at + 1 < len(phones) else ""
        before_vowel = bool(after) and PHONES[after].is_vowel
        if not PHONES[phone].is_vowel:
            if phone != "R" or before_vowel:
                yield (phone, PHONES[phone].ipa, None)
            continue
        r_colour = after == "R" and (at + 2 == len(phones) or not PHONES[phones[at + 2]].is_vowel)
        yield from ((*sound, None) for sound in _british_vowel(word, phone, r_colour, first))
        if phone in ("ER", "AXR") and before_vowel:
            yield ("R", PHONES["R"].ipa, None)
        first = False


def _british_vowel(
    word: str, phone: str, r_colour: bool, first: bool
) -> tuple[tuple[str, str], ...]:
    """The sounds of an American vowel, with `r_colour` before an r that is not said."""
    if phone in ("ER", "AXR"):
        return (_VOWELS["ɜː"],) if first else (_VOWELS["ə"],)
    if r_colour and phone in ("IH", "IY", "UH", "UW"):
        return (_VOWELS["ɪ" if phone[0] == "I" else "ʊ"], _VOWELS["ə"])
    if r_colour and phone in ("EH", "EY", "AE"):
        return (_VOWELS["ɛː"],)
    if phone == "AA" and not r_colour and "o" in word:
        return (_VOWELS["ɒ"],)
    if phone == "AH":
        return (_VOWELS["ʌ" if first else "ə"],)
    return (_AMERICAN[phone],)


_AMERICAN: Final = MappingProxyType({
    **{vowel[0]: vowel for vowel in reversed(list(_VOWELS.values()))},
    "IX": ("IX", "ɪ"), "UX": ("UX", "uː"), "AO": ("AO", "ɔː"), "EH": ("EH", "ɛ"),
})  # fmt: skip


_EXAMPLES: Final = MappingProxyType({
    "iː": "flEEce", "i": "happY", "ɪ": "kIt", "ɛː": "squARE", "ɛ": "drEss", "a": "trAp",
    "ɑː": "pALm", "ɒ": "lOt", "ɔː": "thOUGHt", "ʊ": "fOOt", "uː": "gOOse", "u": "thank yOU",
    "ʌ": "strUt", "ɜː": "nURse", "ə": "commA", "A": "fAce", "I": "prIce", "Y": "chOIce",
    "Q": "gOAt", "W": "mOUth",
})  # fmt: skip
"""vowel of the lexicon to Wells's keyword, with its letters in capitals"""


def british_inventory() -> tuple[Phoneme, ...]:
    """The vowels by Wells's keywords, and the consonants."""
    vowels = [
        Phoneme(_VOWELS[vowel][1], (_VOWELS[vowel][0],), word) for vowel, word in _EXAMPLES.items()
    ]
    rows = [PHONES[phone] for phone in _CONSONANTS.values()]
    return (*vowels, *(Phoneme(row.ipa, (row.symbol,), row.example) for row in rows))
