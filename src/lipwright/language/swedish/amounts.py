"""Tokens with digits: money, times, dates, units, ranges, ordinals and plain numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from re import Match
from typing import Final

from lipwright.language.swedish import tables
from lipwright.language.swedish.numbers import cardinal, digits, number, ordinal, year

_NUMBER: Final = r"\d{1,3}(?:[. ]\d{3})+(?:,\d+)?|\d+(?:,\d+)?"
_SIGN: Final = r"(?P<sign>[-+]?)"
_UNIT: Final = "|".join(re.escape(unit) for unit in sorted(tables.UNITS, key=len, reverse=True))
_CURRENCY: Final = "[" + re.escape("".join(sorted(tables.CURRENCIES))) + "]"
_CARDINALS: Final = 16  # digits from which even a number in groups is read digit by digit
_YEAR: Final = re.compile(r"1[1-9]\d\d|20\d\d", re.ASCII)
_HOUR: Final = r"(?:[01]?\d|2[0-4])[.:][0-5]\d"
_CLOCK: Final = ("kl", "kl.", "klockan")

Rule = Callable[["Match[str]", str, str], list[str]]


def read_amount(bare: str, before: str = "", after: str = "") -> list[str] | None:
    """The words of a token with digits, or None if it has no form that is known.

    `before` and `after` are the tokens beside it: what is counted, a month, "kl".
    """
    for pattern, rule in _RULES:
        if found := pattern.fullmatch(bare):
            return rule(found, before, after)
    return None


def unit_words(before: str, bare: str) -> list[str] | None:
    """The words of "kg" behind "5", or of a unit that is no word wherever it stands."""
    if bare in tables.UNITS and _PLAIN.fullmatch(before):
        one, many, _ = tables.UNITS[bare]
        return (one if before == "1" else many).split()
    return tables.UNITS[bare][1].split() if bare in tables.LONE_UNITS else None


def _signed(found: Match[str], words: list[str]) -> list[str]:
    return {"-": ["minus"], "+": ["plus"], "": []}[found["sign"]] + words


def _is_common(unit: str) -> bool:
    """Whether one of it is "en"."""
    if unit in tables.UNITS:
        return tables.UNITS[unit][2]
    return unit in tables.COMMON


def _plain(text: str, after: str = "", before: str = "") -> list[str]:
    """A number: a date before a month, a year if it looks like one and counts nothing."""
    grouped, text = text, re.sub(r"[. ](?=\d{3})", "", text)
    if after.rstrip(".").lower() in _MONTHS and text.isdigit() and int(text) < 32:
        return ordinal(int(text))
    if before in _CLOCK and text.isdigit():
        return cardinal(int(text))
    counts = after in tables.UNITS or after in tables.COUNTED
    if grouped == text and not counts and _YEAR.fullmatch(text):
        return year(int(text))
    if grouped != text and "," not in text and len(text) < _CARDINALS:
        return cardinal(int(text), _is_common(after))
    return number(text, _is_common(after))


def _time(found: Match[str], before: str, _: str) -> list[str]:
    hour, minute = int(found["hour"]), int(found["minute"])
    words = cardinal(hour)
    if minute:
        words += [*(["noll"] if minute < 10 else []), *cardinal(minute)]
    elif before not in _CLOCK:
        words += ["noll", "noll"]
    return words + (cardinal(int(found["second"])) if found["second"] else [])


def _hours(found: Match[str], before: str, after: str) -> list[str]:
    first, last = (read_amount(found[name], before, after) or [] for name in ("from", "to"))
    return [*first, "till", *last]


def _date(found: Match[str], _: str, __: str) -> list[str]:
    month = tables.MONTHS[int(found["month"]) - 1]
    return [*ordinal(int(found["day"])), month, *year(int(found["year"]))]


def _ordinal(found: Match[str], _: str, __: str) -> list[str]:
    words = ordinal(int(found["number"]))
    masculine = found["end"] == "e" and words[-1].endswith(("första", "andra"))
    return [*words[:-1], words[-1][:-1] + "e"] if masculine else words


def _fraction(found: Match[str], before: str, _: str) -> list[str]:
    above, below = int(found["above"]), int(found["below"])
    if before == "den" and 0 < above < 32 and 0 < below < 13:
        return [*ordinal(above), "i", *ordinal(below)]
    if above < below and below in tables.DENOMINATORS:
        one, many = tables.DENOMINATORS[below]
        return ["en", one] if above == 1 else [*cardinal(above), many]
    return [*_plain(found["above"]), *_plain(found["below"])]


def _range(found: Match[str], before: str, after: str) -> list[str]:
    unit = found["unit"] or ""
    words = [*_plain(found["from"], unit or after, before), "till",
             *_plain(found["to"], unit or after, before)]  # fmt: skip
    return words + (tables.UNITS[unit][1].split() if unit else [])


def _measure(found: Match[str], _: str, __: str) -> list[str]:
    one, many, common = tables.UNITS[found["unit"]]
    words = number(re.sub(r"[. ](?=\d{3})", "", found["number"]), common)
    return _signed(found, words + (one if found["number"] == "1" else many).split())


def _money(found: Match[str], _: str, __: str) -> list[str]:
    return [*_plain(found["number"], found["currency"]), tables.UNITS[found["currency"]][1]]


def _dotted(found: Match[str], _: str, __: str) -> list[str]:
    """A version or a chapter, 1.2.3, with its points; or a number with a decimal point."""
    first, *rest = found[0].split(".")
    return number(first) + [word for part in rest for word in ("punkt", *number(part))]


def _decade(found: Match[str], _: str, __: str) -> list[str]:
    *first, last = _plain(found["number"])
    return [*first, last + "tal" + found["end"]]


_MONTHS: Final = frozenset((*tables.MONTHS, *(name[:3] for name in tables.MONTHS), "sept", "febr"))
_PLAIN: Final = re.compile(rf"[-+]?(?:{_NUMBER})|\d+-\d+", re.ASCII)

_RULES: Final[tuple[tuple[re.Pattern[str], Rule], ...]] = tuple(
    (re.compile(pattern, re.ASCII), rule)
    for pattern, rule in (
        (r"(?P<hour>[01]?\d|2[0-4])[.:](?P<minute>[0-5]\d)(?:[.:](?P<second>[0-5]\d))?", _time),
        (r"(?P<year>[1-9]\d{3})-(?P<month>0[1-9]|1[012])-(?P<day>0[1-9]|[12]\d|3[01])", _date),
        (r"(?P<number>\d{1,15}):?(?P<end>a|e)", _ordinal),
        (rf"(?P<from>{_HOUR})-(?P<to>{_HOUR})", _hours),
        (r"(?P<number>\d{1,2}):an", lambda found, _, __: [tables.NAMED_NUMBERS[found["number"]]]
         if found["number"] in tables.NAMED_NUMBERS else [*number(found["number"]), "an"]),
        (r"(?P<number>\d{2,4})-?tal(?P<end>et|ets|en|s|)", _decade),
        (r"\+\d[\d-]*|0\d{1,3}-\d+", lambda found, _, __: digits(found[0])),
        (rf"(?P<from>{_NUMBER})-(?P<to>{_NUMBER})(?P<unit>{_UNIT})?", _range),
        (r"(?P<above>\d{1,4})/(?P<below>\d{1,4})", _fraction),
        (rf"(?P<currency>{_CURRENCY})(?P<number>{_NUMBER})", _money),
        (rf"{_SIGN}(?P<number>{_NUMBER})(?P<unit>{_UNIT})", _measure),
        (rf"{_SIGN}(?P<number>{_NUMBER})",
         lambda found, before, after: _signed(found, _plain(found["number"], after, before))),
        (r"\d+(?:\.\d+)+", _dotted),
        (r"#(?P<number>\d+)", lambda found, _, __: ["nummer", *number(found["number"])]),
    )
)  # fmt: skip
