"""Numbers as Swedish words. num2words writes "förtiofem", "etttusen" and "tjugode", and no years.

What is below a million is one word by the book; here it is parted behind "tusen", as long numbers
mostly are.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

SMALL: Final = (
    "noll", "ett", "två", "tre", "fyra", "fem", "sex", "sju", "åtta", "nio", "tio", "elva", "tolv",
    "tretton", "fjorton", "femton", "sexton", "sjutton", "arton", "nitton",
)  # fmt: skip
TENS: Final = (
    "", "", "tjugo", "trettio", "fyrtio", "femtio", "sextio", "sjuttio", "åttio", "nittio",
)  # fmt: skip
_POWERS: Final = (
    (10**12, "biljon", "biljoner"), (10**9, "miljard", "miljarder"), (10**6, "miljon", "miljoner"),
)  # fmt: skip
_ORDINALS: Final = MappingProxyType({
    "noll": "nollte", "ett": "första", "två": "andra", "tre": "tredje", "fyra": "fjärde",
    "fem": "femte", "sex": "sjätte", "sju": "sjunde", "åtta": "åttonde", "nio": "nionde",
    "tio": "tionde", "elva": "elfte", "tolv": "tolfte", "hundra": "hundrade", "tusen": "tusende",
})  # fmt: skip
_RANKED: Final = MappingProxyType({
    **_ORDINALS,
    **{word: word + "de" for word in SMALL[13:]},
    **{word: word + "nde" for word in TENS[2:]},
})  # fmt: skip
_BY_LENGTH: Final = tuple(
    sorted({*_RANKED, *_RANKED.values(), "en", "hundra", "tusen"} - {"noll"}, key=len, reverse=True)
)
"""the parts of numbers, the longest first"""
_DIGITS_AT_MOST: Final = 15  # 999 biljoner; longer numbers are read digit by digit
_CODE_FROM: Final = 7  # digits without spaces: a telephone number or a code, unless it is round


def digits(text: str) -> list[str]:
    """Each digit of `text` by itself: "007" is noll noll sju."""
    return [SMALL[int(char)] for char in text if char.isdigit()]


def _hundreds(number: int) -> str:
    """A number from 1 to 999 as one word."""
    hundreds, rest = divmod(number, 100)
    word = "" if not hundreds else (SMALL[hundreds] if hundreds > 1 else "ett") + "hundra"
    if rest >= 20:
        word += TENS[rest // 10] + (SMALL[rest % 10] if rest % 10 else "")
    elif rest:
        word += SMALL[rest]
    return word


def cardinal(number: int, common: bool = False) -> list[str]:
    """A whole number from 0 to 999 biljoner; `common` ends in "en", as "tjugoen kronor" does."""
    words: list[str] = []
    for power, one, many in _POWERS:
        count, number = divmod(number, power)
        if count:
            words += ["en", one] if count == 1 else [*cardinal(count, common=True), many]
    thousands, rest = divmod(number, 1000)
    if thousands:
        words.append((_hundreds(thousands) + "tusen").replace("ttt", "tt"))
    if rest:
        words.append(_hundreds(rest))
    words = words or ["noll"]
    for long, short in (("ettusen", "tusen"), ("etthundra", "hundra")):
        if (words[0] == long and len(words) == 1) or words[0].startswith("etthundra"):
            words[0] = words[0].replace(long, short, 1)
    if common and words[-1].endswith("ett"):
        words[-1] = words[-1].removesuffix("ett") + "en"
    return words


def ordinal(number: int) -> list[str]:
    """A rank: 22 is tjugoandra."""
    *first, last = cardinal(number)
    if last in ("miljon", "miljard", "biljon"):
        return [*first, last + ("te" if last.endswith("n") else "e")]
    if last.endswith(("miljoner", "miljarder", "biljoner")):
        return [*first, last.removesuffix("er") + ("te" if "jon" in last else "e")]
    tail = next(part for part in sorted(_RANKED, key=len, reverse=True) if last.endswith(part))
    return [*first, last.removesuffix(tail) + _RANKED[tail]]


def year(number: int) -> list[str]:
    """A year: 1998 is nittonhundranittioåtta, 2007 tvåtusensju and 2024 tjugohundratjugofyra."""
    century, rest = divmod(number, 100)
    if not 11 <= century <= 20 or 2000 <= number < 2010:
        return ["".join(cardinal(number))]
    first = "tjugo" if century == 20 else SMALL[century]
    return [first + "hundra" + (_hundreds(rest) if rest else "")]


def number(text: str, common: bool = False) -> list[str]:
    """Digits, perhaps with a decimal comma: "1234,5"."""
    whole, comma, decimals = text.partition(",")
    is_code = len(whole) >= _CODE_FROM and not whole.endswith("000")
    if (whole[:1] == "0" and len(whole) > 1) or is_code or len(whole) > _DIGITS_AT_MOST:
        words = digits(whole)
    else:
        words = cardinal(int(whole or "0"), common and not comma)
    if not comma:
        return words
    short = len(decimals) == 2 and decimals[0] != "0"
    return [*words, "komma", *(cardinal(int(decimals)) if short else digits(decimals))]


def split_number(word: str) -> tuple[str, ...]:
    """The parts of a number that is one word, or () if it is none: nitton, hundra, nittio, åtta."""
    word = word.replace("ettusen", "etttusen")
    parts: list[str] = []
    while word:
        found = next((part for part in _BY_LENGTH if word.startswith(part)), None)
        if found is None:
            return ()
        parts.append(found)
        word = word[len(found) :]
    return tuple(parts) if len(parts) > 1 else ()
