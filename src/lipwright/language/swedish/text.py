"""Swedish text to words as they are spoken."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Sequence
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import SpokenWord
from lipwright.language.dictionary import Dictionary, word_key
from lipwright.language.swedish import tables
from lipwright.language.swedish.amounts import read_amount, unit_words
from lipwright.language.swedish.numbers import digits, number, ordinal
from lipwright.language.tokens import Token, is_letter, refuse_foreign, split_text

# "t ex", and numbers in groups of three, unless groups of two follow as in telephone numbers
_TOKEN: Final = re.compile(
    r"(?<!\S)(?i:t ex|bl a|s k|m m|m fl|fr o m|t o m|p g a|d v s|o s v|f d|m a o)"
    r"(?![^\s.,;:!?)])\S*"
    r"|(?<!\S)\d{1,3}(?:[ \xa0\u202f]\d{3})+(?!\d)(?! \d\d(?!\d))\S*|\S+"
)
_EDGE: Final = '"()[]{}<>*_~|\\^`,;!?…'
_SIGNS: Final = str.maketrans({
    **dict.fromkeys("‘’‛ʼʻ`´′", "'"), **dict.fromkeys("“”„‟«»″", '"'), "⁄": "/", "…": ".",
    **dict.fromkeys("‐‑‒–—―−﹣－", "-"), **dict.fromkeys("\xa0\u202f", " "),
    **dict.fromkeys("™®©", ""),
})  # fmt: skip
_KEPT: Final = "åäöéèüàÅÄÖÉÈÜÀ"
_LETTER: Final = f"[A-Za-z{_KEPT}]"
_RUN: Final = re.compile(rf"{_LETTER}+(?:'{_LETTER}+)*|\d+(?:,\d+)?|\S", re.ASCII)
_INITIALS: Final = re.compile(rf"(?:{_LETTER}\.)+{_LETTER}")
_ENDED: Final = re.compile(
    rf"(?P<letters>{_LETTER}+):(?P<end>s|n|ns|en|ens|er|erna|ar|arna|t|et|a|na)"
)
_ADDRESS: Final = re.compile(
    r"(?:\w+://.+|[\w.+-]+@[\w.-]+\.\w+|(?:[\w-]+\.)+(?:se|nu|com|org|net|eu|io|tv)(?:[/:?#].*)?)",
    re.IGNORECASE,
)
_SCHEME: Final = re.compile(r"^\w+://")
_VOWELS: Final = frozenset("aeiouyåäöéèüà")
_INITIALISM: Final = 5  # letters; longer words in capitals are said as words
_UNSPEAKABLE: Final = 4  # letters; longer ones without vowels are interjections
_PAUSE: Final = re.compile(r"[,;:!?.…)\]]['\"”’»)\]*_]*$")
_OPENED: Final = re.compile(r"[(\[\"“”«—–-]")


class _Token(Token):
    """What stands between white space, or a number with spaces between its thousands."""

    @property
    def bare(self) -> str:
        """The core without the dots and the colon at its end."""
        return self.core if self.core.endswith(":-") else self.core.rstrip(".:")


def is_pause(before: SpokenWord, after: SpokenWord) -> bool:
    """Whether a mark, an aside or an empty line stands between two words."""
    if (before.line, before.column) == (after.line, after.column):
        return False
    if after.line > before.line + 1 or _OPENED.match(after.written):
        return True
    gap = after.column - before.column - len(before.written)
    if after.line == before.line and gap > 2:
        return True
    return bool(_PAUSE.search(before.written)) and not _is_short(before.written)


def _is_short(written: str) -> bool:
    """Whether a last dot is that of an abbreviation."""
    lower = written.lower().strip('"()')
    return lower.endswith(".") and (
        lower in tables.ABBREVIATIONS or lower[:-1] in tables.ABBREVIATIONS
    )


class Reader:
    """Turns the tokens of one text into words."""

    def __init__(
        self, lookup: Callable[[str], Sequence[object]], dictionary: Dictionary | None
    ) -> None:
        """`lookup` knows the words that there are; those of `dictionary` come first."""
        self._lookup = lookup
        self._dictionary = dictionary or Dictionary({})
        self._shouting = False

    def read(self, text: str, source: str) -> tuple[SpokenWord, ...]:
        """The words of `text`, which errors call `source`.

        Raises:
            LipwrightError: there are no words, or letters that are not Swedish.
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

    def _tokens(self, text: str, source: str) -> list[_Token]:
        tokens = []
        for written, line, column in split_text(text, source, pattern=_TOKEN):
            core = written
            if not self._own(written):
                core = _trim(_to_swedish(written))
                if any(map(_is_foreign, core)):
                    place = f"{source}: line {line}"
                    refuse_foreign(written, place, column, _has_foreign, "Swedish")
            tokens.append(_Token(written, line, column, core))
        return tokens

    def _own(self, written: str) -> str | None:
        """The token, or the word in its punctuation, as the user's dictionary has it."""
        plain = word_key(written.translate(_SIGNS))
        for word in (plain, plain.strip(_EDGE), plain.strip(_EDGE + ".':")):
            if word in self._dictionary:
                return word
        return None

    def _speak(self, token: _Token, before: str, after: str) -> list[str]:
        bare = token.bare
        if own := self._own(token.written):
            return [own]
        if not bare:
            return []
        if _ADDRESS.fullmatch(bare):
            return self._address(bare)
        for words in (
            unit_words(before, bare),
            self._short(token, before),
            read_amount(bare, before, after) if any(char.isdecimal() for char in bare) else None,
        ):
            if words is not None:
                return words
        return self._runs(bare)

    def _short(self, token: _Token, before: str) -> list[str] | None:
        """The words of an abbreviation, a Roman number or letters with an ending, or None."""
        bare, lower = token.bare, token.bare.lower().replace(" ", ".")
        for form in (lower, lower + "." if token.core != bare else lower):
            if form in tables.ABBREVIATIONS:
                return tables.ABBREVIATIONS[form].split()
        if _INITIALS.fullmatch(bare):
            return list(lower.replace(".", ""))
        if bare in tables.ROMAN and before[:1].isupper() and not self._shouting:
            return ["den", *ordinal(tables.ROMAN[bare])]
        if found := _ENDED.fullmatch(bare):
            words = self._word(found["letters"])
            return [*words[:-1], f"{words[-1]}:{found['end']}"]
        return None

    def _address(self, bare: str) -> list[str]:
        words: list[str] = []
        for run in _RUN.findall(_SCHEME.sub("", bare)):
            if run[0].isdecimal():
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
        words: list[str] = []
        if "-" in bare and any(char.isdecimal() for char in bare):  # "80-talet", "3-årig"
            for part in bare.split("-"):
                words += (read_amount(part) if part[:1].isdecimal() else None) or self._runs(part)
            return words
        for run in _RUN.findall(bare):
            if run[0].isdecimal():
                words += digits(run) if len(run) > 15 else number(run)
            elif run == "#":
                words.append("hashtag")
            elif run in tables.SYMBOLS:
                words += tables.SYMBOLS[run].split()
            elif run[0].isalpha():
                words += self._word(run)
        return words

    def _word(self, run: str) -> list[str]:
        """Letters, perhaps with apostrophes, as words."""
        lower = run.lower()
        if lower in self._dictionary:
            return [lower]
        is_capital = 1 < len(run) <= _INITIALISM and run.isupper() and not self._shouting
        if is_capital and run not in tables.SAID_AS_WORDS:
            return list(lower)
        if self._lookup(lower):
            return [lower]
        if len(lower) <= _UNSPEAKABLE and not _VOWELS & set(lower):
            return [char for char in lower if char.isalpha()]
        return [lower]


def _to_swedish(written: str) -> str:
    """The token with plain signs and digits, and no accents but those of å, ä, ö, é, è, ü, à."""
    text = unicodedata.normalize("NFC", written.translate(_SIGNS)).translate(tables.LETTERS)
    plain = []
    for char in text:
        if char in _KEPT or char in "²³½¼¾":
            plain.append(char)
            continue
        for part in unicodedata.normalize("NFKD", char):
            if unicodedata.category(part) not in ("Mn", "Me", "Cf", "Cc", "Lm"):
                plain.append(str(unicodedata.decimal(part)) if part.isdecimal() else part)
    return "".join(plain).translate(_SIGNS)


def _trim(core: str) -> str:
    """The token without the punctuation around it; its last dots and its sign stay."""
    while core != (inner := core.strip(_EDGE).lstrip(":'").rstrip("'")):
        core = inner
    if not core.endswith(":-"):
        core = core.rstrip("-")
    return core if re.match(r"[+-]\d", core) else core.lstrip(".-")


def _is_foreign(char: str) -> bool:
    return is_letter(char) and not char.isascii() and char not in _KEPT


def _has_foreign(char: str) -> bool:
    return any(map(_is_foreign, _to_swedish(char)))
