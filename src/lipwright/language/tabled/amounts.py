"""Tokens with digits: money, times, dates, units, ordinals, ranges and plain numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cached_property
from re import Match
from typing import Final

from lipwright.language.tabled.numbers import (
    Gender,
    cardinal,
    digits,
    number,
    ordinal,
    parse,
    year,
)  # fmt: skip
from lipwright.language.tabled.values import Amounts

_NUMBER: Final = r"\d+(?:[., '\u00a0\u202f]\d+)*"
_SIGN: Final = r"(?P<sign>[-+]?)"
_PHONE: Final = re.compile(r"\+?\d+(?:[-/]\d+){2,}|\+\d[\d /]+|\d{3}-\d{4}|0\d+[-/]\d{3,}")
_LONGEST_ORDINAL: Final = 9  # digits

Rule = Callable[[Match[str], str, str], list[str]]


class AmountReader:
    """Reads the amounts of one language."""

    def __init__(self, amounts: Amounts) -> None:
        """The tables."""
        self.amounts = amounts

    def read(self, bare: str, before: str = "", after: str = "") -> list[str] | None:
        """The words of a token with digits, or None if it has no form that is known.

        `bare` is without punctuation around it; the tokens before and after may change it.
        """
        for pattern, rule in self._rules:
            if (found := pattern.fullmatch(bare)) and (words := rule(found, before, after)):
                return words
        return None

    def joins(self, bare: str, after: str) -> bool:
        """Whether the token after belongs to the number: its currency, unit or sign."""
        if not re.fullmatch(rf"[-+]?{_NUMBER}(?:-{_NUMBER})?", bare):
            return False
        return after in self.amounts.currencies or after in self.amounts.units or after == "%"

    def is_time(self, bare: str, after: str) -> bool:
        """Whether it is a time before the word for the hour: "10.30" before "Uhr"."""
        hour = after.lower() in self.amounts.hour_words
        return hour and bool(re.fullmatch(r"\d\d?[:.][0-5]\d", bare))

    def starts(self, bare: str, after: str) -> bool:
        """Whether it is a currency that stands before its number."""
        return bare in self.amounts.currencies and after[:1].isdigit()

    @cached_property
    def _nouns(self) -> frozenset[str]:
        """What the tables count."""
        forms = (*self.amounts.units.values(), *self.amounts.currencies.values())
        nouns = {noun for row in forms for noun in row} | set(self.amounts.hour_words)
        return frozenset(nouns - {""})

    @cached_property
    def _rules(self) -> tuple[tuple[re.Pattern[str], Rule], ...]:
        amounts = self.amounts
        sign = "|".join(map(re.escape, sorted(amounts.currencies, key=len, reverse=True)))
        unit = "|".join(map(re.escape, sorted(amounts.units, key=len, reverse=True)))
        ranks = "|".join(
            rf"(?P<{gender}{index}>{pattern})"
            for index, (pattern, gender) in enumerate(amounts.ordinals)
        )
        rules: tuple[tuple[str | re.Pattern[str], Rule], ...] = (
            (r"(?P<day>\d\d?)([./-])(?P<month>\d\d?)\2(?P<year>\d{4}|\d\d)", self._date),
            (r"(?P<year>\d{4})-(?P<month>\d\d)-(?P<day>\d\d)", self._date),
            (
                r"(?P<hour>[01]?\d|2[0-4])(?:[:hH](?P<minute>[0-5]\d)(?::[0-5]\d)?|[hH])h?",
                self._time,
            ),
            (r"(?P<hour>[01]?\d|2[0-4])\.(?P<minute>[0-5]\d)", self._dotted_time),
            (_PHONE, lambda found, *_: self._phone(found[0])),
            (rf"{_SIGN}(?P<before>{sign})?(?P<number>{_NUMBER})(?P<behind>{sign})?", self._money),
            (rf"{_SIGN}(?P<number>{_NUMBER})%", self._percent),
            (rf"{_SIGN}(?P<number>{_NUMBER})(?P<unit>{unit})", self._measure),
            (rf"(?P<from>{_NUMBER})-(?P<to>{_NUMBER}(?:%|{sign}|{unit})?)", self._range),
            (r"(?P<above>\d{1,4})/(?P<below>\d{1,4})", self._fraction),
            (rf"(?P<number>\d{{1,{_LONGEST_ORDINAL}}})(?:{ranks})", self._rank),
            (rf"{_SIGN}(?P<number>{_NUMBER})", self._number),
        )
        return tuple((re.compile(pattern), rule) for pattern, rule in rules)

    def _signed(self, found: Match[str], words: list[str]) -> list[str]:
        word = {"-": self.amounts.minus, "+": self.amounts.plus, "": ""}[found["sign"]]
        return word.split() + words

    def gender(self, noun: str) -> Gender:
        """Of what is counted."""
        return "f" if noun.split(maxsplit=1)[0] in self.amounts.feminine else "m"

    def _counted(self, text: str, one: str, many: str) -> list[str]:
        """A number and the unit that it counts."""
        noun = one if parse(text)[:2] == ("1", "") else many
        return [*number(text, self.amounts, self.gender(noun)), *noun.split()]

    def plain(self, text: str) -> list[str]:
        """A number, as a year if it looks like one."""
        if len(text) == 4 and text.isdigit() and 1100 <= int(text) < 2100:
            return year(int(text), self.amounts)
        return number(text, self.amounts)

    def _number(self, found: Match[str], before: str, after: str) -> list[str]:
        text = found["number"]
        if text.count(".") > 1 and not parse(text)[2]:
            return self._phone(text)
        del before
        if after.lower() in self._nouns:
            return self._signed(found, number(text, self.amounts, self.gender(after.lower())))
        return self._signed(found, self.plain(text))

    def _money(self, found: Match[str], before: str, after: str) -> list[str]:
        del before
        if bool(found["before"]) == bool(found["behind"]):
            return []
        one, many, cent, cents = self.amounts.currencies[found["before"] or found["behind"]]
        text = found["number"]
        whole, decimals, _ = parse(text)
        if after.lower() in self.amounts.magnitudes:  # which the reader leaves to this rule
            word = self.amounts.magnitudes[after.lower()]
            words = [*number(text, self.amounts, self.gender(word)), word]
            words += [*self.amounts.of.split(), *many.split()]
        elif len(decimals) == 2 and decimals != "00" and cents:
            part = self._counted(str(int(decimals)), cent, cents)
            if whole == "0":
                return self._signed(found, part)
            first = self._counted(whole, one, many)
            if "{cents}" in self.amounts.money:
                text = self.amounts.money.format(whole=" ".join(first), cents=" ".join(part))
            else:
                said = cardinal(int(decimals), self.amounts)
                text = self.amounts.money.format(whole=" ".join(first), number=" ".join(said))
            words = text.split()
        else:
            words = self._counted(whole if decimals == "00" else text, one, many)
        return self._signed(found, words)

    def _percent(self, found: Match[str], *_: str) -> list[str]:
        words = number(found["number"], self.amounts, "m")
        return self._signed(found, [*words, *self.amounts.percent.split()])

    def _measure(self, found: Match[str], *_: str) -> list[str]:
        one, many = self.amounts.units[found["unit"]]
        return self._signed(found, self._counted(found["number"], one, many))

    def _time(self, found: Match[str], *_: str) -> list[str]:
        amounts = self.amounts
        hours, minutes = int(found["hour"]), int(found["minute"] or 0)
        noun: Gender = "f" if amounts.feminine & set(amounts.hour_words) else "m"
        hour = " ".join(cardinal(hours, amounts, noun))
        form = amounts.time if minutes else amounts.hour
        if hours == 1 and len(amounts.hour_words) > 1 and amounts.hour_words[1] in form:
            form = form.replace(amounts.hour_words[1], amounts.hour_words[0])
        return form.format(hour=hour, minute=" ".join(cardinal(minutes, amounts))).split()

    def _dotted_time(self, found: Match[str], before: str, after: str) -> list[str]:
        return self._time(found, before) if after.lower() in self.amounts.hour_words else []

    def _date(self, found: Match[str], *_: str) -> list[str]:
        amounts = self.amounts
        day, month = int(found["day"]), int(found["month"])
        if not (1 <= day <= 31 and 1 <= month <= 12):
            return []
        if day == 1:
            said = amounts.first_day.split()
        elif amounts.day_is == "ordinal":
            said = ordinal(day, amounts, "m", "r")
        else:
            said = cardinal(day, amounts)
        years = int(found["year"])
        return amounts.date.format(
            day=" ".join(said),
            month=amounts.months[month - 1],
            year=" ".join(year(years, amounts) if years > 99 else number(found["year"], amounts)),
        ).split()

    def _range(self, found: Match[str], before: str, after: str) -> list[str]:
        first = self.plain(found["from"])
        last = self.read(found["to"], before, after)
        return [*first, *self.amounts.to.split(), *last] if last else []

    def _fraction(self, found: Match[str], *_: str) -> list[str]:
        if found[0] in self.amounts.fractions:
            return self.amounts.fractions[found[0]].split()
        above, below = self.plain(found["above"]), self.plain(found["below"])
        return [*above, *self.amounts.over.split(), *below]

    def _rank(self, found: Match[str], *_: str) -> list[str]:
        name = next(
            (name for name, text in found.groupdict().items() if text and name != "number"), "m"
        )
        return ordinal(int(found["number"]), self.amounts, "f" if name[0] == "f" else "m")

    def _phone(self, text: str) -> list[str]:
        plus = self.amounts.plus.split() if text.startswith("+") else []
        return plus + digits(text, self.amounts)
