"""The IPA of espeak-ng, which is not quite IPA, to the phone table.

espeak-ng 1.52 makes its IPA from the mnemonics of its phonemes (docs/phonemes.md of its source).
Where no IPA was written down for one, the mnemonic's ASCII letters stay: "s." is a retroflex,
"kh" an aspirate. `espeak.corrections` mends what can be mended without knowing more than the
phoneme; here is the rest. Tones print their digit, of which "3" becomes "ɜ", as the mnemonic "3"
is also a vowel.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

from lipwright.espeak.corrections import corrected
from lipwright.language.ipa import Sound, read_ipa

SEPARATOR: Final = "|"
"""between phonemes, as `lipwright.espeak.to_ipa` takes it; espeak-ng itself never writes it"""

# Languages whose voices print tones: Mandarin, Cantonese, Hakka, Thai, Shan, Burmese, Vietnamese.
_TONAL: Final = frozenset({"cmn", "yue", "hak", "th", "shn", "my", "vi"})
# Languages that write aspiration as "h": those of them that aspirate, and Korean, Oriya, Tswana.
_ASPIRATES: Final = frozenset({"cmn", "yue", "hak", "th", "shn", "my", "ko", "or", "tn"})
_WRITE_NG: Final = frozenset({"yue", "my"})  # "nɡ" for ŋ, of which `espeak` mends some
_TONE_3: Final = re.compile("ɜ(?!ː)")  # the vowel of English "bird" is always long here
_ASPIRATION: Final = re.compile("(?<=[ptkscʂɕ])_?h")
# Thai and Shan write the mnemonic "k_h", which a separator may part.
_PARTED: Final = re.compile(f"(?<=[ptk]){re.escape(SEPARATOR)}h")

# Left-overs of mnemonics, in any language.
_EVERYWHERE: Final = (
    ("ts.", "ʈʂ"), ("s.", "ʂ"), ("z.", "ʐ"), ("r.", "ɽ"), ("K", "k"), ("Φ", "ɸ"), ("ε", "ɛ"),
    ("+", ""), ("\x01", ""),
    ("\N{REPLACEMENT CHARACTER}", ""),
)  # fmt: skip

# Phonemes of one language, whole.
_VIETNAMESE: Final = MappingProxyType({
    "u-": "ɯ", "o-": "əː", "cr": "ʈ", "e-": "e",  # tƯ, mƠ, TRe
})  # fmt: skip
_CANTONESE: Final = MappingProxyType({
    "aa": "aː", "aai": "aːi", "aau": "aːu", "aaŋ": "aːŋ", "eŋ": "ɛŋ", "iŋ": "ɪŋ", "oŋ": "ɔŋ",
    "uŋ": "ʊŋ", "oeŋ": "œŋ", "oe": "œ", "eo": "ɵ", "eoi": "ɵy", "yu": "y",
    "c": "tsʰ", "z": "ts",  # Ceoi and Zoeng of jyutping
})  # fmt: skip
# The palatal stops of India are said, and seen, as affricates: CHai, Jaya; of Swahili: moJa.
_AFFRICATES: Final = MappingProxyType({"c": "tʃ", "cʰ": "tʃʰ", "ɟ": "dʒ", "ɟʰ": "dʒʰ"})
_INDIC: Final = (
    "hi", "mr", "ur", "ne", "gu", "pa", "bn", "as", "or", "sd", "kok", "bpy", "ta", "te", "kn",
    "ml", "si",
)  # fmt: skip
_WHOLE: Final = MappingProxyType({
    **dict.fromkeys((*_INDIC, "sw"), _AFFRICATES),
    "hak": MappingProxyType({"i.": "i", "o-": "ɔ"}),
    "yue": _CANTONESE,
    "my": MappingProxyType({"hs": "sʰ", "ht": "tʰ", "ky": "tɕ"}),
    "ky": MappingProxyType({"oe": "ø", "oe:": "øː"}),
    "vi": _VIETNAMESE,
})  # fmt: skip

# A short vowel before another in a phoneme of Mandarin or Hakka is a glide: "iou", "uɑ", "yɛ".
_GLIDES: Final = MappingProxyType({"i": "j", "u": "w", "y": "ɥ"})
_GLIDING: Final = re.compile("^[iuy](?=[aeoɑəɛæ])")
_STOD: Final = re.compile("[?ʔ](?=[aeiouyøœæɑɔɛʌε])")  # Danish, printed before its vowel
_SPLIT: Final = re.compile(rf"[\s{re.escape(SEPARATOR)}]+")


def read_espeak(text: str, language: str = "") -> tuple[Sound, ...]:
    """The sounds of espeak-ng's IPA: a text with or without separators, or one phoneme.

    Args:
        text: as `lipwright.espeak.to_ipa` gives it, best with SEPARATOR, as aspirates and tones
            are known for certain then; or the label of a phone event.
        language: espeak-ng's code, such as "cmn-latn-pinyin"; "" reads what all share.

    Raises:
        LipwrightError: a letter that is not of the IPA.
    """
    base = language.casefold().partition("-")[0]
    text = _PARTED.sub("ʰ", text) if base in ("th", "shn") else text
    return tuple(
        sound
        for token in _SPLIT.split(text)
        if token
        for sound in read_ipa(_plain(token, base), base)
    )


def _plain(token: str, language: str) -> str:
    """A phoneme, or a word of them, in proper IPA with its stress mark."""
    token = corrected(token, language)
    mark = token[:1] if token[:1] in ("ˈ", "ˌ") else ""
    token = token[len(mark) :]
    if language in _TONAL:
        token = _TONE_3.sub("", token)
    if language == "da":
        token = _STOD.sub("", token)
    if language in _WRITE_NG:
        token = token.replace("nɡ", "ŋ")
    token = _WHOLE[language].get(token, token) if language in _WHOLE else token
    if language in ("cmn", "hak"):
        token = _GLIDING.sub(lambda found: _GLIDES[found[0]], token)
    for old, new in _EVERYWHERE:
        token = token.replace(old, new)
    if language in _ASPIRATES:
        token = _ASPIRATION.sub("ʰ", token)
    return mark + token
