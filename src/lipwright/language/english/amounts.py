"""Tokens with digits: money, times, dates, units, ranges and plain numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from re import Match
from typing import Final

from lipwright.language.english import tables
from lipwright.language.english.numbers import (
    cardinal,
    decade,
    digits,
    fraction,
    number,
    ordinal,
    year,
)  # fmt: skip

_NUMBER: Final = r"(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?|\.\d+"
_SIGN: Final = r"(?P<sign>[-+]?)"
_CURRENCY: Final = "[" + re.escape("".join(tables.CURRENCIES)) + "]"
_UNIT: Final = "|".join(re.escape(unit) for unit in sorted(tables.UNITS, key=len, reverse=True))
_SUFFIX: Final = "|".join(sorted(tables.MAGNITUDES, key=len, reverse=True))
_HALF_DAY: Final = r"(?P<half>[AaPp])\.?[Mm]"

Rule = Callable[["Match[str]", str], list[str]]


def read_amount(bare: str, after: str) -> list[str] | None:
    """The words of a token with digits, or None if it has no form that is known.

    `bare` is without punctuation around it; `after` is the next token, as "million" changes
    how "$3" is read.
    """
    for pattern, rule in _RULES:
        if found := pattern.fullmatch(bare):
            return rule(found, after)
    return None


def magnitude_words(before: str, bare: str) -> list[str] | None:
    """The words of "million" behind "$3"; None if it does not stand behind money."""
    found = _MONEY.fullmatch(before)
    if not found or found["suffix"] or bare not in tables.MAGNITUDES:
        return None
    return [tables.MAGNITUDES[bare], tables.CURRENCIES[_currency(found)][1]]


def unit_words(before: str, bare: str) -> list[str] | None:
    """The words of "kg" behind "5", or of a unit that is no word wherever it stands."""
    if bare in tables.UNITS and _PLAIN.fullmatch(before):
        one, many = tables.UNITS[bare]
        return (one if before == "1" else many).split()
    return tables.UNITS[bare][1].split() if bare in tables.LONE_UNITS else None


def _signed(found: Match[str], words: list[str]) -> list[str]:
    return {"-": ["minus"], "+": ["plus"], "": []}[found["sign"]] + words


def _plain(text: str, after: str = "") -> list[str]:
    """A number, as a year if it looks like one and counts nothing."""
    counts = after in tables.UNITS or after in tables.MAGNITUDES or after == "percent"
    if len(text) == 4 and text.isdigit() and 1010 <= int(text) < 2100 and not counts:
        return year(int(text))
    return number(text)


def _currency(found: Match[str]) -> str:
    return found["before"] or found["behind"]


def _money(found: Match[str], after: str) -> list[str]:
    one, many, cent, cents = tables.CURRENCIES[_currency(found)]
    whole, _, decimals = found["number"].partition(".")
    if found["suffix"]:
        words = [*number(found["number"]), tables.MAGNITUDES[found["suffix"]], many]
    elif after in tables.MAGNITUDES:  # which then names the currency
        words = number(found["number"])
    elif decimals and len(decimals) != 2:
        words = [*number(found["number"]), many]
    else:
        words = []
        if whole.strip("0,") or not decimals.strip("0"):
            words = [*number(whole), one if whole == "1" else many]
        if decimals.strip("0"):
            part = [*cardinal(int(decimals)), cent if int(decimals) == 1 else cents]
            words = [*words, "and", *part] if words else part
    return _signed(found, words)


def _time(found: Match[str], after: str) -> list[str]:
    hour, minute = int(found["hour"]), int(found["minute"])
    half = [found["half"].lower(), "m"] if found["half"] else []
    words = cardinal(hour)
    if minute:
        words += [*(["oh"] if minute < 10 else []), *cardinal(minute)]
    elif not half and not found["second"] and after[:1].lower() not in ("a", "p"):
        words.append("o'clock" if 0 < hour < 13 else "hundred")
    if found["second"]:
        words += ["and", *cardinal(int(found["second"])), "seconds"]
    return words + half


def _hour(found: Match[str], _: str) -> list[str]:
    return [*cardinal(int(found["hour"])), found["half"].lower(), "m"]


def _date(found: Match[str], _: str) -> list[str]:
    month = tables.MONTHS[int(found["month"]) - 1]
    return [month, *ordinal(int(found["day"])), *year(int(found["year"]))]


def _fraction(found: Match[str], _: str) -> list[str]:
    above, below = int(found["above"]), int(found["below"])
    whole = [*cardinal(int(found["whole"])), "and"] if found["whole"] else []
    if above < below and below in tables.DENOMINATORS:
        return whole + fraction(above, below)
    return [*whole, *_plain(found["above"]), *_plain(found["below"])]


def _range(found: Match[str], after: str) -> list[str]:
    unit = found["unit"] or ""
    words = [*_plain(found["from"], unit or after), "to", *_plain(found["to"], unit or after)]
    return words + (tables.UNITS[unit][1].split() if unit else [])


def _money_range(found: Match[str], after: str) -> list[str]:
    first, last = found["from"], found["currency"] + found["to"]
    return [*number(first), "to", *(read_amount(last, after) or [])]


def _measure(found: Match[str], _: str) -> list[str]:
    one, many = tables.UNITS[found["unit"]]
    words = number(found["number"])
    return _signed(found, words + (one if found["number"] == "1" else many).split())


def _ordinal(found: Match[str], _: str) -> list[str]:
    return ordinal(int(found["number"].replace(",", "")))


_MONEY: Final = re.compile(
    rf"{_SIGN}(?:(?P<before>{_CURRENCY})(?=[\d.])|(?=[\d.].*{_CURRENCY}))(?P<number>{_NUMBER})"
    rf"(?P<suffix>{_SUFFIX})?(?P<behind>{_CURRENCY})?",
    re.ASCII,
)
_PLAIN: Final = re.compile(rf"[-+]?(?:{_NUMBER})|\d+-\d+", re.ASCII)

_RULES: Final[tuple[tuple[re.Pattern[str], Rule], ...]] = tuple(
    (pattern if isinstance(pattern, re.Pattern) else re.compile(pattern, re.ASCII), rule)
    for pattern, rule in (
        (_MONEY, _money),
        (rf"(?P<hour>\d\d?):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d))?(?:{_HALF_DAY})?", _time),
        (rf"(?P<hour>\d\d?){_HALF_DAY}", _hour),
        (r"(?P<number>\d{1,3}(?:,\d{3}){1,4}|\d{1,15})(?:st|nd|rd|th|ST|ND|RD|TH)", _ordinal),
        (r"'?(?P<number>[1-9]0|[12]\d\d0)'?s", lambda found, _: decade(int(found["number"]))),
        (r"(?P<year>[1-9]\d{3})-(?P<month>0[1-9]|1[012])-(?P<day>0[1-9]|[12]\d|3[01])", _date),
        (r"\+?\d+(?:[-.]\d+){2,}|\d{3}-\d{4}", lambda found, _: _groups(found[0])),
        (rf"(?P<from>{_NUMBER})-(?P<to>{_NUMBER})(?P<unit>{_UNIT})?", _range),
        (rf"(?P<currency>{_CURRENCY})(?P<from>{_NUMBER})(?:{_SUFFIX})?-{_CURRENCY}?"
         rf"(?P<to>(?:{_NUMBER})(?:{_SUFFIX})?)", _money_range),
        (r"(?:(?P<whole>\d{1,15}) )?(?P<above>\d{1,4})/(?P<below>\d{1,4})", _fraction),
        (rf"{_SIGN}(?P<number>{_NUMBER})(?P<unit>{_UNIT})", _measure),
        (rf"{_SIGN}(?P<number>{_NUMBER})",
         lambda found, after: _signed(found, _plain(found["number"], after))),
        (r"#(?P<number>\d+)", lambda found, _: ["number", *number(found["number"])]),
    )
)  # fmt: skip


def _groups(text: str) -> list[str]:
    """A telephone number digit by digit, or a version such as 1.2.3 with its points."""
    if "-" in text or text.startswith("+"):
        return digits(text)
    first, *rest = text.split(".")
    return number(first) + [word for part in rest for word in ("point", *number(part))]
