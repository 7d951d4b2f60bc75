"""Numbers as Mandarin reads them, written in characters."""

from __future__ import annotations

from typing import Final

DIGITS: Final = "零一二三四五六七八九"
_UNITS: Final = ((10**8, "亿"), (10**4, "万"), (1000, "千"), (100, "百"), (10, "十"))
_TWOS: Final = frozenset("千万亿")  # behind which a first 2 is 两
DIGITS_AT_MOST: Final = 16  # of a cardinal; longer numbers are read digit by digit


def digits(text: str, *, phone: bool = False) -> str:
    """Each digit of `text` by itself; the 1 of a telephone number is yao: "119" is 幺幺九."""
    said = "".join(DIGITS[int(char)] for char in text if char.isdecimal())
    return said.replace("一", "幺") if phone else said


def cardinal(number: int) -> str:
    """A whole number below 10^16: 10086 is 一万零八十六, 2000 is 两千.

    2 is 两 where a number begins with 2 千, 万 or 亿, and 二 elsewhere.
    """
    said = _plain(number)
    if said.startswith("一十"):
        said = said[1:]
    return "两" + said[1:] if said[0] == "二" and said[1:2] in _TWOS else said


def _plain(number: int) -> str:
    """A whole number with each digit as it is written."""
    for unit, name in _UNITS:
        if number >= unit:
            above, rest = divmod(number, unit)
            zero = DIGITS[0] if rest * 10 < unit else ""
            return _plain(above) + name + (zero + _plain(rest) if rest else "")
    return DIGITS[number]


def number(text: str) -> str:
    """Digits, perhaps with commas and a decimal point: "1,234.5"."""
    whole, _, decimals = text.replace(",", "").partition(".")
    whole = whole or "0"
    is_code = (len(whole) > 1 and whole[0] == "0") or len(whole) > DIGITS_AT_MOST
    said = digits(whole) if is_code else cardinal(int(whole))
    return said + (f"点{digits(decimals)}" if decimals else "")
