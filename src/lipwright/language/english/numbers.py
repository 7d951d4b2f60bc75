"""Numbers as English words, as Americans read them: without "and" after the hundreds."""

from __future__ import annotations

from typing import Final

_SMALL: Final = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen",
    "nineteen",
)  # fmt: skip
_TENS: Final = (
    "", "", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety",
)  # fmt: skip
_POWERS: Final = ((10**12, "trillion"), (10**9, "billion"), (10**6, "million"), (1000, "thousand"))
_ORDINALS: Final = {
    "one": "first", "two": "second", "three": "third", "five": "fifth", "eight": "eighth",
    "nine": "ninth", "twelve": "twelfth",
}  # fmt: skip
_DIGITS_AT_MOST: Final = 15  # 999 trillions; longer numbers are read digit by digit
_CODE_FROM: Final = 7  # digits without commas: a telephone number or a code, unless it is round


def digits(text: str) -> list[str]:
    """Each digit of `text` by itself: "007" is zero zero seven."""
    return [_SMALL[int(char)] for char in text if char.isdigit()]


def cardinal(number: int) -> list[str]:
    """A whole number from 0 to 999 trillions: 1234 is one thousand two hundred thirty four."""
    words: list[str] = []
    for power, name in _POWERS:
        if number >= power:
            words += [*cardinal(number // power), name]
            number %= power
    if number >= 100:
        words += [_SMALL[number // 100], "hundred"]
        number %= 100
    if number >= 20:
        words.append(_TENS[number // 10])
        number %= 10
        if not number:
            return words
    return words if words and not number else [*words, _SMALL[number]]


def ordinal(number: int) -> list[str]:
    """A rank: 22 is twenty second."""
    *first, last = cardinal(number)
    if last in _ORDINALS:
        return [*first, _ORDINALS[last]]
    return [*first, last.removesuffix("y") + "ieth" if last.endswith("y") else last + "th"]


def year(number: int) -> list[str]:
    """A number of four digits, read as a year: 1984 is nineteen eighty four."""
    century, rest = divmod(number, 100)
    if century % 10 == 0 and rest < 10:  # 1000, 2007
        return cardinal(number)
    if rest == 0:
        return [*cardinal(century), "hundred"]
    return [*cardinal(century), *(["oh"] if rest < 10 else []), *cardinal(rest)]


def decade(number: int) -> list[str]:
    """The years from `number` on, which ends in 0: 1990 is nineteen nineties, 80 is eighties."""
    *first, last = year(number) if number >= 1000 else cardinal(number)
    return [*first, last.removesuffix("y") + "ies" if last.endswith("y") else last + "s"]


def number(text: str) -> list[str]:
    """Digits, perhaps with commas and a decimal point: "1,234.5"."""
    whole, point, decimals = text.partition(".")
    plain = whole.replace(",", "")
    is_code = len(plain) >= _CODE_FROM and "," not in whole and not plain.endswith("000")
    if not plain:
        words = []
    elif (plain[0] == "0" and len(plain) > 1) or is_code or len(plain) > _DIGITS_AT_MOST:
        words = digits(plain)
    else:
        words = cardinal(int(plain))
    return [*words, "point", *digits(decimals)] if point and decimals else words


def fraction(above: int, below: int) -> list[str]:
    """A fraction below one: 3 and 4 are three quarters."""
    names = {2: ("half", "halves"), 4: ("quarter", "quarters")}
    one, many = names.get(below, (" ".join(ordinal(below)), " ".join(ordinal(below)) + "s"))
    return [*cardinal(above), *(one if above == 1 else many).split()]
