"""Text to words as they are spoken, by a language's tables."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.english.tables import LETTERS
from lipwright.language.tabled.amounts import AmountReader
from lipwright.language.tabled.lexicon import Lexicon
from lipwright.language.tabled.numbers import cardinal, ordinal, roman
from lipwright.language.tabled.values import Tables
from lipwright.language.tokens import (
    EDGE,
    SIGNS,
    Token,
    is_letter,
    refuse_foreign,
    split_text,
    trim,
)

_KEPT: Final = "ºª°€£"  # signs that normalisation would take apart
_INITIALISM: Final = 5  # letters; longer words in capitals are said as words
_ADDRESS: Final = re.compile(
    r"(?:\w+://.+|[\w.+-]+@[\w.-]+\.\w+|www\..+"
    r"|(?:[\w-]+\.)+(?:com|org|net|edu|gov|info|io|eu|de|at|ch|es|mx|ar|fr|be|it|nl|pt|br)(?:/.*)?)",
    re.ASCII | re.IGNORECASE,
)
_SCHEME: Final = re.compile(r"^\w+://")
# capitals that may be said as a word: consonants and vowels by turns, as in UNESCO
_SPEAKABLE: Final = re.compile(r"[bcdfgklmnprstvz]?(?:[aeiou]{1,2}[bcdfgklmnprstvz]{1,2})*[aeiou]?")


class Reader:
    """Turns the tokens of one text into words."""

    def __init__(
        self, tables: Tables, lexicons: Sequence[Lexicon], dictionary: Dictionary | None
    ) -> None:
        """The words that there are: `dictionary` before `lexicons`."""
        self._tables = tables
        self._lexicons = lexicons
        self._dictionary = dictionary or Dictionary({})
        self._amounts = AmountReader(tables.amounts)
        self._letters = frozenset(tables.letters)
        letter = f"a-zA-Z{tables.letters}{tables.letters.upper().replace('SS', '')}"
        self._runs = re.compile(
            rf"'?[{letter}]+(?:['-][{letter}]+)*'?|\d[\d.,]*\d|\d|[^\s{letter}\d]"
        )
        self._initials = re.compile(rf"(?:[{letter}]\.)+[{letter}]")
        signs = "".join(sign for sign in tables.amounts.currencies if len(sign) == 1)
        self._is_amount = re.compile(rf"[-+]*[{re.escape(signs)}]?\d").match
        self._shouting = False

    def read(self, text: str, source: str) -> tuple[SpokenWord, ...]:
        """The words of `text`, which errors call `source`.

        Raises:
            LipwrightError: there are no words, or letters that the language does not have.
        """
        tokens = [self._token(*place, source) for place in split_text(text, source, grouped=True)]
        self._shouting = not any(char.islower() for token in tokens for char in token.core)
        self._remember(tokens)
        words = [
            SpokenWord(word, token.written, token.line, token.column)
            for token, said in zip(tokens, self._said(tokens), strict=True)
            for word in said
        ]
        if not words:
            raise LipwrightError(f"{source}: has no words; give the words that are spoken")
        return tuple(words)

    def _token(self, written: str, line: int, column: int, source: str) -> Token:
        if self._own(written):
            return Token(written, line, column, written)
        core = trim(self._plain(written), self._is_amount)
        if not core.isascii() and any(is_letter(c) and not self._is_own(c) for c in core):
            place = f"{source}: line {line}"
            refuse_foreign(written, place, column, self._is_foreign, self._tables.name)
        return Token(written, line, column, core)

    def _is_own(self, char: str) -> bool:
        return char.isascii() or char.lower() in self._letters or char in _KEPT

    def _is_foreign(self, char: str) -> bool:
        return any(is_letter(part) and not self._is_own(part) for part in self._plain(char))

    def _plain(self, written: str) -> str:
        """The token with plain signs, digits and the language's letters."""
        text = unicodedata.normalize("NFC", written.translate(SIGNS))
        if text.isascii():
            return text
        done = []
        for char in text:
            if self._is_own(char):
                done.append(char)
                continue
            folded = unicodedata.normalize("NFKC", char).translate(SIGNS)
            if not all(map(self._is_own, folded)):
                folded = unicodedata.normalize("NFKD", folded.translate(LETTERS))
            done += (
                str(unicodedata.decimal(part)) if part.isdecimal() else part
                for part in folded
                if unicodedata.category(part) not in ("Mn", "Me", "Cf", "Cc", "Lm")
            )
        return "".join(done)

    def _remember(self, tokens: Sequence[Token]) -> None:
        """Look up all the words at once."""
        words = {run.lower() for token in tokens for run in self._runs.findall(token.core)}
        words |= {token.bare.lower() for token in tokens}
        words |= {part for word in words for part in re.split("[-']", word)}
        words |= {word.strip("'") for word in words}
        for lexicon in self._lexicons:
            lexicon.remember(words)

    def _own(self, written: str) -> str | None:
        """The token, or the word in its punctuation, as the user's dictionary has it."""
        if not len(self._dictionary):
            return None
        plain = word_key(written.translate(SIGNS))
        for word in (plain, plain.strip(EDGE), plain.strip(EDGE + ".'")):
            if word in self._dictionary:
                return word
        return None

    def _said(self, tokens: Sequence[Token]) -> list[list[str]]:
        said: list[list[str]] = []
        bares = ["", *(token.bare for token in tokens), "", ""]
        skip = False
        for at, token in enumerate(tokens):
            before, bare, after, then = bares[at : at + 4]
            if skip:
                said.append([])
                skip = False
                continue
            if own := self._own(token.written):
                said.append([own])
                continue
            joined = bare
            if token.core == bare and self._amounts.is_time(bare, after):
                skip, joined, after = True, bare.replace(".", ":"), then
            elif token.core == bare and self._amounts.joins(bare, after):
                skip, joined, after = True, bare + after, then
            elif token.core != bare and f"{bare}.{after}".lower() in self._tables.abbreviations:
                skip, joined, after = True, f"{bare}.{after}", then
            elif self._amounts.starts(bare, after):
                skip, joined, after = True, bare + after, then
            elif self._counts_millions(bare, after):
                skip = True
            said.append(self._speak(token, joined, before, after))
        return said

    def _counts_millions(self, bare: str, after: str) -> bool:
        amounts = self._tables.amounts
        return (
            after.lower() in amounts.magnitudes
            and any(char.isdigit() for char in bare)
            and any(sign in bare for sign in amounts.currencies if not sign.isalpha())
        )

    def _speak(self, token: Token, bare: str, before: str, after: str) -> list[str]:
        if not bare:
            return []
        dotted = token.core != token.bare and bare == token.bare
        for words in (
            self._address(bare),
            self._short(bare, dotted),
            self._ordinal(bare, dotted, before, after),
            self._amounts.read(bare, before, after) if re.search(r"\d", bare) else None,
        ):
            if words is not None:
                return words
        return self._pieces(bare)

    def _short(self, bare: str, dotted: bool) -> list[str] | None:
        """The words of an abbreviation, initials or a Roman numeral; or None."""
        lower = bare.lower()
        table = self._tables.abbreviations
        if dotted and f"{lower}." in table:
            return table[f"{lower}."].split()
        if lower in table:
            return table[lower].split()
        if self._initials.fullmatch(bare):
            return self._spell(bare.replace(".", ""))
        if len(bare) > 1 and not self._shouting and lower not in self._tables.spelt:
            value = roman(bare)
            if value:
                amounts = self._tables.amounts
                rank = amounts.roman == "ordinal" or (
                    amounts.roman == "ordinal to ten" and value <= 10
                )
                return ordinal(value, amounts) if rank else cardinal(value, amounts)
        return None

    def _ordinal(self, bare: str, dotted: bool, before: str, after: str) -> list[str] | None:
        """The words of "3." before a month or behind an article; of "XXe"; or None."""
        amounts = self._tables.amounts
        ending = amounts.ordinal_before.get(before.lower())
        if dotted and amounts.ordinal_before and re.fullmatch(r"\d{1,4}", bare):
            if ending is None and after.lower() in amounts.months:
                ending = amounts.ordinal_before[""]
            return None if ending is None else ordinal(int(bare), amounts, "m", ending)
        found = re.fullmatch(rf"([IVX]+)(?:{amounts.roman_ranks})", bare)
        if found and amounts.roman_ranks and (value := roman(found[1])):
            return ordinal(value, amounts)
        return None

    def _address(self, bare: str) -> list[str] | None:
        if not _ADDRESS.fullmatch(bare):
            return None
        words: list[str] = []
        for run in re.findall(r"[^\W\d_]+|\d+|.", _SCHEME.sub("", bare)):
            if run.isdigit():
                words += self._amounts.plain(run)
            elif run in self._tables.address:
                words += self._tables.address[run].split()
            elif run.lower() == "www":
                words += self._spell("www")
            elif run[0].isalpha():
                words += self._word(run)
        return words

    def _pieces(self, bare: str) -> list[str]:
        """The letters, numbers and signs of a token, each by itself."""
        words: list[str] = []
        if "-" in bare and any(char.isdigit() for char in bare):
            for part in filter(None, bare.split("-")):
                words += self._amounts.read(part) or self._pieces(part)
            return words
        for run in self._runs.findall(bare):
            if run[0].isdigit():
                words += self._amounts.plain(run)
            elif run in self._tables.symbols:
                words += self._tables.symbols[run].split()
            elif any(char.isalpha() for char in run):
                words += self._word(run)
        return words

    def _word(self, run: str) -> list[str]:
        """Letters, perhaps with hyphens and apostrophes, as words."""
        lower = run.lower()
        for word in (lower, lower.rstrip("'"), lower.lstrip("'"), lower.strip("'")):
            if self._is_known(word):
                return self._emphasis(run) or [word]
        if "-" in lower and not self._stays(lower):
            return [word for part in run.split("-") if part for word in self._word(part)]
        if "'" in lower.strip("'"):
            return [lower if self._has_clitic(lower) else lower.strip("'")]
        return self._emphasis(run) or self._unknown(lower.strip("'"))

    def _stays(self, lower: str) -> bool:
        pattern = self._tables.joined_by_hyphen
        return bool(pattern and pattern.search(lower))

    def _has_clitic(self, lower: str) -> bool:
        return any(
            lower.startswith(clitic) or lower.endswith(clitic) for clitic in self._tables.clitics
        )

    def _is_known(self, word: str) -> bool:
        return (
            word in self._dictionary
            or word in self._tables.said
            or word in self._tables.clitics
            or any(word in lexicon for lexicon in self._lexicons)
        )

    def _emphasis(self, run: str) -> list[str] | None:
        """The letters of an abbreviation in capitals; None if it is said as a word."""
        capitals = run.strip("'")
        if not (1 < len(capitals) <= _INITIALISM and capitals.isalpha() and capitals.isupper()):
            return None
        lower = capitals.lower()
        if lower in self._tables.spelt:
            return self._spell(lower)
        if self._shouting or self._is_known(lower):
            return None
        if len(lower) > 3 and _SPEAKABLE.fullmatch(lower):
            return None
        return self._spell(lower)

    def _unknown(self, lower: str) -> list[str]:
        """A word that no lexicon has; one without vowels is spelt."""
        plain = unicodedata.normalize("NFKD", lower)
        if not lower:
            return []
        if len(lower) <= _INITIALISM and not set("aeiouyæœø") & set(plain):
            return self._spell(lower)
        return [lower]

    def _spell(self, letters: str) -> list[str]:
        names = self._tables.letter_names
        words: list[str] = []
        for char in letters.lower():
            base = unicodedata.normalize("NFD", char)[0]
            words += names.get(char, names.get(base, "")).split()
        return words
