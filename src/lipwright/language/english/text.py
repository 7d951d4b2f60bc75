"""English text to words as they are spoken."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.english import tables
from lipwright.language.english.amounts import magnitude_words, read_amount, unit_words
from lipwright.language.english.numbers import digits, number
from lipwright.language.tokens import (
    EDGE,
    SIGNS,
    Token,
    is_letter,
    refuse_foreign,
    split_text,
    trim,
)

_AREA_CODE: Final = re.compile(r"\(\d{3}\)", re.ASCII)
_MIXED: Final = re.compile(r"(?<=\d)(?=[¼-¾⅐-⅞])")  # between the 2 and the half of 2½
_RUN: Final = re.compile(r"'?[A-Za-z]+(?:'[A-Za-z]+)*'?|\d[\d,]*(?:\.\d+)?|[^\sA-Za-z\d]")
_INITIALS: Final = re.compile(r"(?:[A-Za-z]\.)+[A-Za-z]")
_DOMAINS: Final = "com|org|net|edu|gov|int|info|io|ai|dev|app|tv|co|uk|us|eu|de|fr|se|jp|cn"
_ADDRESS: Final = re.compile(
    rf"(?:\w+://.+|[\w.+-]+@[\w.-]+\.\w+|(?:[\w-]+\.)+(?:{_DOMAINS})(?:[/:?#].*)?)",
    re.ASCII | re.IGNORECASE,
)
_SCHEME: Final = re.compile(r"^\w+://")
_AMOUNT: Final = re.compile(rf"[.'+-]*[{re.escape(''.join(tables.CURRENCIES))}]?\.?\d", re.ASCII)
_INITIALISM: Final = 5  # letters; longer words in capitals are said as words
_UNSPEAKABLE: Final = 4  # letters; longer ones without vowels are interjections
_VOWELS: Final = frozenset("aeiouy")


class Reader:
    """Turns the tokens of one text into words."""

    def __init__(self, lexicon: Container[str], dictionary: Dictionary | None) -> None:
        """The words that there are: `dictionary` before `lexicon`."""
        self._lexicon = lexicon
        self._dictionary = dictionary or Dictionary({})
        self._shouting = False

    def read(self, text: str, source: str) -> tuple[SpokenWord, ...]:
        """The words of `text`, which errors call `source`.

        Raises:
            LipwrightError: there are no words, or letters that are not English.
        """
        tokens = self._tokens(text, source)
        self._shouting = not any(char.islower() for token in tokens for char in token.core)
        around = ["", *(token.bare for token in tokens), ""]
        words = [
            SpokenWord(word, token.written, token.line, token.column)
            for index, token in enumerate(tokens)
            for word in self._speak(token, around[index], around[index + 2])
        ]
        if not words:
            raise LipwrightError(f"{source}: has no words; give the words that are spoken")
        return tuple(words)

    def _tokens(self, text: str, source: str) -> list[Token]:
        tokens = []
        for written, line, column in split_text(text, source):
            if self._own(written):
                core = written
            else:
                core = trim(_to_ascii(written), _AMOUNT.match)
                if any(map(_is_foreign, core)):
                    place = f"{source}: line {line}"
                    refuse_foreign(written, place, column, _has_foreign, "English")
            tokens.append(Token(written, line, column, core))
        return tokens

    def _own(self, written: str) -> str | None:
        """The token, or the word in its punctuation, as the user's dictionary has it."""
        plain = word_key(written.translate(SIGNS))
        for word in (plain, plain.strip(EDGE), plain.strip(EDGE + ".'")):
            if word in self._dictionary or word.removesuffix("'s") in self._dictionary:
                return word
        return None

    def _speak(self, token: Token, before: str, after: str) -> list[str]:
        bare = token.bare
        if own := self._own(token.written):
            return [own]
        if not bare:
            return []
        for words in (
            self._special(token, before),
            self._short(token, before, after),
            magnitude_words(before, bare),
            unit_words(before, bare),
            read_amount(bare, after) if any(char.isdigit() for char in bare) else None,
        ):
            if words is not None:
                return words
        return self._runs(bare)

    def _special(self, token: Token, before: str) -> list[str] | None:
        """The words of an address, an area code, or a fraction behind a number; or None."""
        if _ADDRESS.fullmatch(token.bare):
            return self._address(token.bare)
        if _AREA_CODE.fullmatch(token.written):
            return digits(token.bare)
        if "/" in token.bare and before.isdigit():
            mixed = read_amount(f"{before} {token.bare}", "") or []
            return mixed[mixed.index("and") :] if "and" in mixed else None
        return None

    def _short(self, token: Token, before: str, after: str) -> list[str] | None:
        """The words of an abbreviation, or None."""
        bare, dotted = token.bare, token.core != token.bare
        lower = bare.lower()
        if lower in ("am", "pm") and before[-1:].isdigit():
            return list(lower)
        if lower == "st" and before[:1].isupper() and not after[:1].isupper():
            return ["street"]
        if lower in tables.ABBREVIATIONS:
            words, where = tables.ABBREVIATIONS[lower]
            capitals = bare[:1].isupper() and after[:1].isupper()
            if {
                "anywhere": True,
                "dot": dotted,
                "title": capitals and (dotted or not self._shouting),
                "dotted title": capitals and dotted,
                "number": after.lstrip("#")[:1].isdigit()
                and (dotted or lower not in self._lexicon),
            }[where]:
                return words.split()
        if _INITIALS.fullmatch(bare):
            return list(lower.replace(".", ""))
        if bare in tables.ROMAN and before[:1].isupper() and not self._shouting:
            return [tables.ROMAN[bare]]
        return None

    def _address(self, bare: str) -> list[str]:
        words: list[str] = []
        for run in _RUN.findall(_SCHEME.sub("", bare)):
            if run[0].isdigit():
                words += number(run)
            elif run == "www":
                words += "www"
            elif run in tables.ADDRESS_SYMBOLS:
                words += tables.ADDRESS_SYMBOLS[run].split()
            else:
                words += self._word(run)
        return words

    def _runs(self, bare: str) -> list[str]:
        """The letters, numbers and signs of a token, each by itself."""
        lower = bare.lower()
        if "-" in lower and lower in self._lexicon:
            parts = lower.split("-")
            if not all(part in self._lexicon for part in parts):
                return [lower]
        words: list[str] = []
        if "-" in bare and any(char.isdigit() for char in bare):  # "21st-century"
            for part in bare.split("-"):
                words += read_amount(part, "") or self._runs(part)
            return words
        runs = _RUN.findall(bare)
        for index, run in enumerate(runs):
            if run[0].isdigit():
                words += number(run.rstrip(","))
            elif run == "#":
                words += [_hash(runs, index)]
            elif run[-1].isalpha() or run[0].isalpha() or run[1:]:
                words += self._word(run)
            else:
                words += tables.SYMBOLS.get(run, "").split()
        return words

    def _word(self, run: str) -> list[str]:
        """Letters, perhaps with apostrophes, as words."""
        lower = run.lower()
        for word in (lower, lower.strip("'")):
            words, where = tables.ABBREVIATIONS.get(word, ("", "dot"))
            if where == "anywhere":
                return words.split()
        if lower in tables.LONE_UNITS:
            return tables.UNITS[lower][1].split()
        for word in (lower, lower.rstrip("'"), lower.lstrip("'"), lower.strip("'")):
            if word in self._dictionary or word in self._lexicon:
                return [word]
        return self._unknown_word(run.strip("'"))

    def _unknown_word(self, run: str) -> list[str]:
        """A word that no lexicon has, as it is or letter by letter."""
        lower = run.lower()
        ending = re.fullmatch(r"([A-Z]{2,})'?s", run)
        capitals = ending[1] if ending else run
        if 1 < len(capitals) <= _INITIALISM and capitals.isupper() and not self._shouting:
            letters = list(filter(str.isalpha, capitals.lower()))  # no apostrophe, as in A'A
            return [*letters[:-1], letters[-1] + "'s"] if ending else letters
        if len(lower) <= _UNSPEAKABLE and lower.isalpha() and not _VOWELS & set(lower):
            return list(lower)
        return [lower] if lower else []


def _hash(runs: list[str], index: int) -> str:
    """What "#" is in "#5", "C#" and "#lipsync"."""
    if runs[index + 1 : index + 2] and runs[index + 1][0].isdigit():
        return "number"
    if index and len(runs[index - 1]) == 1 and runs[index - 1].isalpha():
        return "sharp"
    return "hashtag"


def _to_ascii(written: str) -> str:
    """The token with plain signs, digits and letters without accents."""
    text = _MIXED.sub(" ", written.translate(SIGNS))
    text = unicodedata.normalize("NFKC", text).translate(SIGNS).translate(tables.LETTERS)
    text = unicodedata.normalize("NFKD", text)
    return "".join(
        str(unicodedata.decimal(char)) if char.isdecimal() else char
        for char in text
        if unicodedata.category(char) not in ("Mn", "Me", "Cf", "Cc", "Lm")
    )


def _is_foreign(char: str) -> bool:
    return not char.isascii() and is_letter(char)


def _has_foreign(char: str) -> bool:
    return any(map(_is_foreign, _to_ascii(char)))
