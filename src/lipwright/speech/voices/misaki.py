"""The phoneme letters of Kokoro's family of voices, which hibari takes, and the phones they mean.

The alphabet is that of the g2p "misaki" (hexgrad, Apache-2.0, file EN_PHONES.md): IPA, with one
capital for each diphthong of English. Stress marks stand before the vowel, not the syllable.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from lipwright.phones import PHONES, SILENCE, nearest_phones

PRIMARY, SECONDARY = "ˈ", "ˌ"
STRESS: Final = MappingProxyType({PRIMARY: 1, SECONDARY: 2})
PAUSES: Final = frozenset(",;:.!?—…")
"""marks that make the voice pause, or say the sentence in another tone"""

# letters, phone, example; Br.: in British voices only
_ROWS: Final[tuple[tuple[str, str, str], ...]] = (
    ("ɜɹ", "ER", "fUR"), ("əɹ", "AXR", "lettER"),
    ("A", "EY", "AtE"), ("I", "AY", "bIte"), ("O", "OW", "gO"), ("Q", "OW", "gO (Br.)"),
    ("W", "AW", "fOUl"), ("Y", "OY", "tOY"),
    ("a", "AE", "cAt (Br.)"), ("i", "IY", "fEEl"), ("u", "UW", "tOO"), ("ɑ", "AA", "fAther"),
    ("ɒ", "AO", "dOg (Br.)"), ("æ", "AE", "cAt"), ("ə", "AX", "Ago"),
    ("ɐ", "AX", "A (the article)"), ("ᵊ", "AX", "bottlE"), ("ɔ", "AO", "dOg"),
    ("ɛ", "EH", "pEt"), ("ɜ", "ER", "fUR (Br.)"), ("ɪ", "IH", "fIll"),
    ("ᵻ", "IX", "boxEs"), ("ʊ", "UH", "bOOk"), ("ʌ", "AH", "cUt"),
    ("p", "P", "Put"), ("b", "B", "Big"), ("t", "T", "Talk"), ("d", "D", "Dig"),
    ("k", "K", "Cut"), ("ɡ", "G", "Gut"), ("ʔ", "Q", "uh-oh (the catch)"), ("T", "DX", "buTTer"),
    ("ɾ", "DX", "buTTer"), ("ʧ", "CH", "CHin"), ("ʤ", "JH", "Joy"), ("f", "F", "Fork"),
    ("v", "V", "Vat"), ("θ", "TH", "THin"), ("ð", "DH", "THen"), ("s", "S", "Sit"),
    ("z", "Z", "Zap"), ("ʃ", "SH", "SHe"), ("ʒ", "ZH", "pleaSure"), ("h", "HH", "Help"),
    ("m", "M", "Mat"), ("n", "N", "No"), ("ŋ", "NG", "siNG"),
    ("l", "L", "Lid"), ("ɹ", "R", "Red"), ("j", "Y", "Yard"), ("w", "W", "With"),
)  # fmt: skip
PHONE_OF: Final = MappingProxyType({letters: phone for letters, phone, _ in _ROWS})
"""letters, one or two, to the symbol of the phone table"""

_SAID_AS: Final = MappingProxyType({
    "EL": "ᵊl", "EM": "ᵊm", "EN": "ᵊn", "ENG": "ᵊŋ", "NX": "n", "HV": "h", "WH": "w", "UX": "u",
    "XTS": "ts", "XTC": "ʧ",
})  # fmt: skip


@dataclass(frozen=True)
class Sound:
    """A phone and the letters that ask for it."""

    phone: str
    """symbol of the phone table"""
    first: int
    """index of its first letter, which may be its stress mark"""
    stop: int
    """index after its last letter, its length mark included"""
    stress: int | None = None
    """1 primary, 2 secondary, 0 none; None of a consonant"""
    word: int | None = None
    """index of its word"""


def read_sounds(letters: str, word: int | None = None, start: int = 0) -> list[Sound]:
    """The phones of a word's letters; `start` is the place of the first one in the whole line."""
    sounds: list[Sound] = []
    place, first, stress = 0, 0, 0
    while place < len(letters):
        letter = letters[place]
        pair = letters[place : place + 2]
        found = pair if pair in PHONE_OF else letter if letter in PHONE_OF else ""
        if letter in STRESS:
            stress = STRESS[letter]
        elif found:
            stop = place + len(found)
            while stop < len(letters) and letters[stop] == "ː":
                stop += 1
            vowel = PHONES[PHONE_OF[found]].is_vowel
            marked = stress if vowel else None
            sounds.append(Sound(PHONE_OF[found], start + first, start + stop, marked, word))
            place, first, stress = stop, stop, 0 if vowel else stress
            continue
        place += 1
        if letter not in STRESS:
            first = place
    return sounds


def _letters_of_phones() -> dict[str, str]:
    letters = dict(_SAID_AS)
    for spelling, phone, example in _ROWS:
        if not example.endswith("(Br.)"):
            letters.setdefault(phone, spelling)
    for phone in PHONES:
        if phone != SILENCE and phone not in letters:
            letters[phone] = letters[nearest_phones(phone, letters)[0]]
    return letters


LETTERS_OF: Final = MappingProxyType(_letters_of_phones())
"""symbol of the phone table to the letters that sound most like it to an American voice"""


def write_phones(phones: tuple[str, ...]) -> tuple[str, tuple[Sound, ...]]:
    """The letters that say `phones`, the first full vowel stressed, and the phones themselves.

    The voice says its nearest sound to a phone that English lacks; the track keeps the phone.
    """
    vowels = [place for place, phone in enumerate(phones) if PHONES[phone].is_vowel]
    full = [place for place in vowels if phones[place] not in ("AX", "AXR", "IX")]
    stressed = (full or vowels or [-1])[0]
    letters, sounds = "", []
    for place, phone in enumerate(phones):
        if phone == SILENCE:
            letters += ", "
            continue
        first = len(letters)
        letters += (PRIMARY if place == stressed else "") + LETTERS_OF[phone]
        stress = int(place == stressed) if PHONES[phone].is_vowel else None
        sounds.append(Sound(phone, first, len(letters), stress))
    return letters, tuple(sounds)
