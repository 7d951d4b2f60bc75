"""British English text to words: dates day first, and "and" behind the hundreds."""

from __future__ import annotations

import re
from typing import Final

from lipwright.language.english import tables
from lipwright.language.english.numbers import cardinal, ordinal, year
from lipwright.language.english.text import Reader
from lipwright.language.tokens import Token

_DATE: Final = re.compile(
    r"(?P<day>0?[1-9]|[12]\d|3[01])(?P<mark>[-/.])(?P<month>0?[1-9]|1[012])(?P=mark)"
    r"(?P<year>\d{4}|\d\d)|"
    r"(?P<year_first>\d{4})-(?P<its_month>0[1-9]|1[012])-(?P<its_day>0[1-9]|[12]\d|3[01])",
    re.ASCII,
)
_DAY: Final = re.compile(r"(?P<day>[1-9]|[12]\d|3[01])(?:st|nd|rd|th)?", re.ASCII)
_SHORT_MONTHS: Final = tuple(month[:3] for month in tables.MONTHS)
_BELOW_HUNDRED: Final = frozenset(word for n in range(1, 100) for word in cardinal(n)) | {
    word for n in range(1, 100) for word in ordinal(n)
}
_LARGE: Final = frozenset(("hundred", "thousand", "million", "billion", "trillion"))


class BritishReader(Reader):
    """Turns the tokens of one text into words, as the British read them."""

    def _speak(self, token: Token, before: str, after: str) -> list[str]:
        bare = token.bare
        if found := _DATE.fullmatch(bare):
            return _date(found)
        if found := _DAY.fullmatch(bare):
            day = ordinal(int(found["day"]))
            if month(after):
                return ["the", *day, "of"]
            if month(before) and before[:1].isupper():
                return ["the", *day]
        if month(bare) and bare[:1].isupper() and _DAY.fullmatch(before):
            return [month(bare)]
        words = super()._speak(token, before, after)
        return with_and(words) if any(char.isdigit() for char in bare) else words


def month(word: str) -> str:
    """The month of a capitalised name or its abbreviation; else empty."""
    lower = word.rstrip(".").lower()
    if not word[:1].isupper():
        return ""
    if lower in tables.MONTHS:
        return lower
    short = "sep" if lower == "sept" else lower
    return tables.MONTHS[_SHORT_MONTHS.index(short)] if short in _SHORT_MONTHS else ""


def with_and(words: list[str]) -> list[str]:
    """A number with "and" before what is below a hundred: two hundred and five."""
    found: list[str] = []
    for at, word in enumerate(words):
        behind = found[-1] if found else ""
        last = not any(after in _LARGE for after in words[at + 1 : at + 3])
        if word in _BELOW_HUNDRED and (behind == "hundred" or (behind in _LARGE and last)):
            found.append("and")
        found.append(word)
    return found


def _date(found: re.Match[str]) -> list[str]:
    day = int(found["day"] or found["its_day"])
    number = int(found["month"] or found["its_month"])
    text = found["year"] or found["year_first"]
    whole = int(text) + (2000 if len(text) == 2 else 0)
    return ["the", *ordinal(day), "of", tables.MONTHS[number - 1], *with_and(year(whole))]
