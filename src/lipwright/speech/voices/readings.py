"""What the elements `say-as` and `phoneme` of SSML make of their text.

`interpret-as` is not fixed by SSML 1.1; its values are those of the W3C note "SSML 1.0 say-as
attribute values" (2005) and those that Polly, Azure and Google have beside them.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE, is_silence_label, parse_phone

ALPHABETS: Final = MappingProxyType({
    "ipa": "ipa", "x-sampa": "xsampa", "xsampa": "xsampa", "x-arpabet": "arpabet",
    "arpabet": "arpabet", "x-cmu": "arpabet", "cmu": "arpabet", "cmu-arpabet": "arpabet",
})  # fmt: skip
"""as `alphabet` of the element `phoneme` is written to an alphabet of ours"""
READINGS: Final = (
    "characters", "spell-out", "verbatim", "digits", "telephone", "cardinal", "number", "ordinal",
    "date", "time", "fraction", "unit", "currency", "address",
)  # fmt: skip
"""values of `interpret-as`; those from "time" on are left to the language's own reading"""
_SPELT: Final = frozenset(("characters", "spell-out", "verbatim"))
_MONTHS: Final = (
    "January", "February", "March", "April", "May", "June", "July", "August", "September",
    "October", "November", "December",
)  # fmt: skip
_DATE_ORDERS: Final = ("mdy", "dmy", "ymd", "ydm", "md", "dm", "my", "ym", "y", "m", "d")
_LONGEST_XSAMPA: Final = 5  # characters of a phone with its marks
_SYLLABLES: Final = " .|-\t\n"  # between syllables and words of phonemes


def read_as(text: str, kind: str, form: str, language: str) -> str:
    """The text of a `say-as` as the language's front end says it.

    Args:
        text: as it is written.
        kind: one of READINGS.
        form: the attribute `format`.
        language: ISO code without region; "" is English.
    """
    text = text.strip()
    if kind in _SPELT:
        return _spelt(text)
    if kind == "digits":
        return " ".join(char for char in text if char.isalnum())
    if kind == "telephone":
        return _telephone(text, language)
    if kind == "ordinal":
        return _ordinal(text, language)
    if kind == "date":
        return _date(text, form.casefold(), language)
    cardinal = kind in ("cardinal", "number")
    return re.sub(r"(?<![\d.,])0+(?=\d)", "", text) if cardinal else text


def _spelt(text: str) -> str:
    """Letters and digits one by one."""
    parts = []
    for run in re.findall(r"[A-Za-z]+|[^\W]", text):
        parts.append("".join(f"{letter.upper()}." for letter in run) if run.isascii() and (
            run.isalpha()) else run)  # fmt: skip
    return " ".join(parts)


def _telephone(text: str, language: str) -> str:
    """Digits one by one, with a comma between groups."""
    groups = re.split(r"[^\w+]+", text.replace("+", " + "))
    said = ", ".join(" ".join(group) for group in groups if group)
    return said.replace("+, ", "plus " if language in ("", "en") else "+ ")


def _ordinal(text: str, language: str) -> str:
    if not re.fullmatch(r"[0-9]{1,12}", text):
        return text
    if language in ("", "en"):
        ending = "th" if text[-2:-1] == "1" else {"1": "st", "2": "nd", "3": "rd"}.get(
            text[-1], "th"
        )  # fmt: skip
        return text + ending
    from num2words import num2words

    try:
        return str(num2words(int(text), lang=language, to="ordinal"))
    except NotImplementedError:
        return text


def _date(text: str, form: str, language: str) -> str:
    """Day, month and year in words that English reads, or in ISO order for other languages."""
    numbers = re.findall(r"[0-9]+", text)
    if form not in _DATE_ORDERS:
        form = "ymd" if numbers and len(numbers[0]) == 4 else "mdy"
    if re.search(r"[^\W\d_]", text) or len(numbers) != len(form):
        return text
    found = dict(zip(form, map(int, numbers), strict=True))
    day, month, year = found.get("d"), found.get("m"), found.get("y")
    if (month is not None and not 1 <= month <= 12) or (day is not None and not 1 <= day <= 31):
        return text
    if language not in ("", "en"):
        rest = (str(part).zfill(2) for part in (year, month, day) if part is not None)
        return "-".join(rest)
    words = [_MONTHS[month - 1]] if month else []
    words += [_ordinal(str(day), "en")] if day else []
    words += [str(year)] if year is not None else []
    return " ".join(words)


def read_phones(text: str, alphabet: str) -> tuple[str, ...]:
    """The phones of the attribute `ph` of a `phoneme`.

    Args:
        text: as it is written.
        alphabet: "ipa", "xsampa" or "arpabet".

    Raises:
        LipwrightError: a sound that the alphabet does not have, or none at all.
    """
    if alphabet == "ipa":
        from lipwright.language.ipa import read_ipa

        phones = tuple(sound.phone for sound in read_ipa(text))
    elif alphabet == "arpabet":
        labels = [label for label in re.split(r"[\s.|-]+", text) if label]
        phones = tuple(parse_phone(label)[0] for label in labels)
    else:
        phones = tuple(_xsampa(text))
    phones = tuple(phone for phone in phones if phone != SILENCE)
    if not phones:
        raise LipwrightError(f"{text[:40]!r} has no phones")
    return phones


def _xsampa(text: str) -> list[str]:
    """The phones of X-SAMPA without spaces, the longest spelling first."""
    phones: list[str] = []
    place = 0
    while place < len(text):
        if text[place] in _SYLLABLES or text[place] in '"%':
            place += 1
            continue
        for size in range(_LONGEST_XSAMPA, 0, -1):
            label = text[place : place + size]
            if is_silence_label(label) or any(char in _SYLLABLES for char in label):
                continue
            try:
                phones.append(parse_phone(label, "xsampa")[0])
            except LipwrightError:
                continue
            place += len(label)
            break
        else:
            raise LipwrightError(
                f"{text[:40]!r}: column {place + 1}: X-SAMPA has no {text[place]!r} that is known"
            )
    return phones
