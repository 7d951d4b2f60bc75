"""The scripts that texts are written in, and which languages are written in which.

Ranges after the Unicode Standard 16.0 (Scripts.txt), without the rare blocks.
"""

from __future__ import annotations

import unicodedata
from bisect import bisect_right
from collections import Counter
from types import MappingProxyType
from typing import Final

from lipwright.language.codes import NAMES

# first and last letter, script
_RANGES: Final = (
    (0x0041, 0x005A, "Latin"), (0x0061, 0x007A, "Latin"), (0x00C0, 0x024F, "Latin"),
    (0x0250, 0x02AF, "Latin"), (0x0370, 0x03FF, "Greek"), (0x0400, 0x052F, "Cyrillic"),
    (0x0531, 0x058F, "Armenian"), (0x0591, 0x05F4, "Hebrew"), (0x0600, 0x06FF, "Arabic"),
    (0x0750, 0x077F, "Arabic"), (0x08A0, 0x08FF, "Arabic"), (0x0900, 0x097F, "Devanagari"),
    (0x0980, 0x09FF, "Bengali"), (0x0A00, 0x0A7F, "Gurmukhi"), (0x0A80, 0x0AFF, "Gujarati"),
    (0x0B00, 0x0B7F, "Odia"), (0x0B80, 0x0BFF, "Tamil"), (0x0C00, 0x0C7F, "Telugu"),
    (0x0C80, 0x0CFF, "Kannada"), (0x0D00, 0x0D7F, "Malayalam"), (0x0D80, 0x0DFF, "Sinhala"),
    (0x0E00, 0x0E7F, "Thai"), (0x1000, 0x109F, "Burmese"), (0x10A0, 0x10FF, "Georgian"),
    (0x1100, 0x11FF, "Hangul"), (0x1200, 0x139F, "Ethiopic"), (0x13A0, 0x13FF, "Cherokee"),
    (0x1E00, 0x1EFF, "Latin"), (0x1F00, 0x1FFF, "Greek"), (0x3005, 0x3007, "Han"),
    (0x3041, 0x30FF, "Kana"), (0x3400, 0x4DBF, "Han"), (0x4E00, 0x9FFF, "Han"),
    (0xAC00, 0xD7AF, "Hangul"), (0xF8D0, 0xF8FF, "Klingon"), (0xF900, 0xFAFF, "Han"),
    (0xFB1D, 0xFB4F, "Hebrew"), (0xFB50, 0xFDFF, "Arabic"), (0xFE70, 0xFEFF, "Arabic"),
    (0xFF21, 0xFF5A, "Latin"), (0xFF66, 0xFF9F, "Kana"), (0x10450, 0x1047F, "Shavian"),
    (0x20000, 0x323AF, "Han"),
)  # fmt: skip
_STARTS: Final = tuple(first for first, _, _ in _RANGES)

# Languages that are not written in Latin letters; the others are.
_WRITTEN: Final = MappingProxyType({
    "cmn": "Han Latin", "ja": "Kana Han", "yue": "Han", "hak": "Latin Han", "ko": "Hangul",
    "ru": "Cyrillic", "ru-lv": "Cyrillic", "ru-cl": "Cyrillic", "uk": "Cyrillic",
    "be": "Cyrillic", "bg": "Cyrillic", "mk": "Cyrillic", "sr": "Cyrillic Latin",
    "bs": "Latin Cyrillic", "hr": "Latin Cyrillic", "ba": "Cyrillic", "cv": "Cyrillic",
    "kk": "Cyrillic Latin Arabic", "kaa": "Latin Cyrillic", "ky": "Cyrillic",
    "tt": "Cyrillic Latin", "nog": "Cyrillic", "uz": "Latin Cyrillic", "tk": "Latin Cyrillic",
    "az": "Latin Cyrillic", "ro": "Latin Cyrillic", "el": "Greek", "grc": "Greek",
    "hy": "Armenian", "hyw": "Armenian",
    "ka": "Georgian", "he": "Hebrew", "ar": "Arabic", "fa": "Arabic", "ur": "Arabic",
    "ug": "Arabic Latin Cyrillic", "sd": "Arabic Devanagari", "ku": "Latin Arabic",
    "ms": "Latin Arabic", "am": "Ethiopic", "ti": "Ethiopic", "hi": "Devanagari",
    "mr": "Devanagari", "ne": "Devanagari", "kok": "Devanagari Latin Kannada",
    "bn": "Bengali", "as": "Bengali", "bpy": "Bengali", "pa": "Gurmukhi Arabic",
    "gu": "Gujarati", "or": "Odia", "ta": "Tamil", "te": "Telugu", "kn": "Kannada",
    "ml": "Malayalam", "si": "Sinhala", "th": "Thai", "my": "Burmese", "shn": "Burmese",
    "chr-us-qaaa-x-west": "Cherokee", "piqd": "Klingon Latin", "en-shaw": "Shavian Latin",
})  # fmt: skip

SCRIPTS_OF: Final = MappingProxyType(
    {code: tuple(_WRITTEN.get(code, "Latin").split()) for code in NAMES}
)
"""code to the scripts that it is written in, the usual one first"""

USUAL: Final = MappingProxyType({
    "Latin": "en", "Han": "cmn", "Kana": "ja", "Cyrillic": "ru", "Arabic": "ar",
    "Devanagari": "hi", "Bengali": "bn", "Armenian": "hy", "Burmese": "my", "Ethiopic": "am",
    "Greek": "el", "Gurmukhi": "pa",
})  # fmt: skip
"""script to the language with the most speakers, where several are written in it"""

# Letters of Latin script in the room that one letter of these takes for the same words.
_WEIGHTS: Final = MappingProxyType({"Han": 3, "Kana": 2, "Hangul": 3})


def script_of(char: str) -> str:
    """The script of a letter; "" for what is none, such as a digit or an emoji."""
    point = ord(char)
    at = bisect_right(_STARTS, point) - 1
    if at < 0 or point > _RANGES[at][1]:
        return ""
    return _RANGES[at][2] if char.isalpha() or unicodedata.category(char) == "Co" else ""


def count_scripts(text: str) -> Counter[str]:
    """How much of a text is in each script, in letters of Latin script."""
    counts: Counter[str] = Counter()
    for char, times in Counter(text).items():
        if script := script_of(char):
            counts[script] += times * _WEIGHTS.get(script, 1)
    return counts
