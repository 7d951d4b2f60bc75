"""Numbers as words, by num2words, in the forms that stand before nouns and as ordinals."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, Literal

from lipwright.language.tabled.values import Amounts

_DIGITS_AT_MOST: Final = 15  # longer numbers are read digit by digit
_CODE_FROM: Final = 7  # digits in a row: a telephone number or a code, unless it is round
_DECIMALS_AT_MOST: Final = 2  # digits that are read as one number
_ROMAN: Final = {"I": 1, "V": 5, "X": 10}
_SEPARATORS: Final = re.compile(r"[ '\u00a0\u202f]")

Gender = Literal["", "m", "f"]
"""of the noun behind a number; empty if there is none"""


@cache
def _said(number: int, kind: str, language: str) -> tuple[str, ...]:
    from num2words import num2words

    text = num2words(number, lang=language, to=kind)
    return tuple(re.sub(r"[-,]", " ", text.lower()).split())


def cardinal(number: int, amounts: Amounts, gender: Gender = "") -> list[str]:
    """A whole number; "one" agrees with the noun behind it."""
    words = list(_said(number, "cardinal", amounts.num2words))
    if gender and words[-1] in amounts.ones:
        words[-1] = amounts.ones[words[-1]][gender == "f"]
    return words


def ordinal(number: int, amounts: Amounts, gender: Gender = "m", ending: str = "") -> list[str]:
    """A rank, with another ending if one is given."""
    if number == 1 and amounts.first[0]:
        return [amounts.first[gender == "f"]]
    words = list(_said(number, "ordinal", amounts.num2words))
    if gender == "f":
        words = [re.sub("o$", "a", word) for word in words]
    return [*words[:-1], words[-1] + ending]


def year(number: int, amounts: Amounts) -> list[str]:
    """A number that looks like a year."""
    return list(_said(number, "year", amounts.num2words))


def digits(text: str, amounts: Amounts) -> list[str]:
    """Each digit by itself."""
    return [word for char in text if char.isdigit() for word in cardinal(int(char), amounts)]


def parse(text: str) -> tuple[str, str, bool]:
    """The whole digits, the decimals, and whether the whole was written in groups of three.

    Of "." and "," the last is the decimal sign, if both are there; a lone "." before three digits
    parts thousands, and "," does not.
    """
    text = _SEPARATORS.sub("'", text)
    last = max(text.rfind("."), text.rfind(","))
    if last < 0:
        return text.replace("'", ""), "", "'" in text
    sign = text[last]
    whole, _, decimals = text.rpartition(sign)
    grouped = re.fullmatch(r"[1-9]\d{0,2}(?:[.,']\d{3})*", whole) and len(decimals) == 3
    if (sign == "." and grouped and "," not in whole) or (text.count(sign) > 1 and grouped):
        whole, decimals = text, ""
    return re.sub(r"[.,']", "", whole), decimals, bool(re.search(r"[.,']", whole))


def number(text: str, amounts: Amounts, gender: Gender = "") -> list[str]:
    """Digits, perhaps grouped and with decimals."""
    whole, decimals, grouped = parse(text)
    is_code = len(whole) >= _CODE_FROM and not grouped and not whole.endswith("000")
    if (whole[0] == "0" and len(whole) > 1) or is_code or len(whole) > _DIGITS_AT_MOST:
        words = digits(whole, amounts)
    else:
        words = cardinal(int(whole), amounts, "" if decimals else gender)
    if not decimals:
        return words
    each = amounts.single_decimals or decimals[0] == "0" or len(decimals) > _DECIMALS_AT_MOST
    said = digits(decimals, amounts) if each else cardinal(int(decimals), amounts)
    return [*words, *amounts.comma.split(), *said]


def roman(text: str) -> int:
    """The value of a Roman numeral up to 39; 0 if it is not one."""
    if not text or not re.fullmatch(r"X{0,3}(?:IX|IV|V?I{0,3})", text):
        return 0
    values = [_ROMAN[char] for char in text]
    return sum(
        -value if value < behind else value
        for value, behind in zip(values, [*values[1:], 0], strict=True)
    )
