"""The user's own pronunciations: one `WORD  P H O N E S` a line, as in the CMU dictionary."""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from lipwright.errors import LipwrightError
from lipwright.phones import SILENCE, parse_phone

_VARIANT = re.compile(r"(?<=.)\(\d+\)$")
_APOSTROPHES = str.maketrans("\u2018\u2019\u02bc\u02bb", "''''")


def word_key(word: str) -> str:
    """How a word is looked up: in lower case, composed, with a straight apostrophe."""
    return unicodedata.normalize("NFC", word.translate(_APOSTROPHES).casefold())


@dataclass(frozen=True)
class Dictionary:
    """Words and the ways to say them, which go before the lexicon."""

    entries: Mapping[str, tuple[tuple[str, ...], ...]]
    """word, as by `word_key`, to its pronunciations in symbols of the phone table"""

    def __post_init__(self) -> None:
        """Freeze."""
        object.__setattr__(self, "entries", MappingProxyType(dict(self.entries)))

    def __contains__(self, word: str) -> bool:
        """Whether the word is in it; case is ignored."""
        return word_key(word) in self.entries

    def __len__(self) -> int:
        """The number of words."""
        return len(self.entries)

    def lookup(self, word: str) -> tuple[tuple[str, ...], ...]:
        """The ways to say the word; none if it is not in the dictionary."""
        return self.entries.get(word_key(word), ())


def read_dictionary(path: str | os.PathLike[str]) -> Dictionary:
    """Read a pronunciation dictionary in the CMU format, UTF-8.

    Stress digits are allowed and ignored, and so is the number of a variant, as in `tomato(2)`.
    Lines from `#` or `;;;` on are comments.

    Raises:
        LipwrightError: the file cannot be read, or a line has no phones or an unknown one.
    """
    entries: dict[str, list[tuple[str, ...]]] = {}
    for number, line in enumerate(_read_text(path).split("\n"), 1):
        if line.lstrip().startswith(("#", ";;;")):
            continue
        word, *labels = re.split(r"\s#", line)[0].split() or [""]
        if not word:
            continue
        place = f"{path}: line {number}"
        if not labels:
            raise LipwrightError(f"{place}: {word!r} has no phones; write them after it")
        ways = entries.setdefault(word_key(_VARIANT.sub("", word)), [])
        phones = tuple(_symbol(label, place) for label in labels)
        if phones not in ways:
            ways.append(phones)
    return Dictionary({word: tuple(ways) for word, ways in entries.items()})


def _symbol(label: str, place: str) -> str:
    try:
        symbol, _ = parse_phone(label)
    except LipwrightError as error:
        raise LipwrightError(f"{place}: {error}") from error
    if symbol == SILENCE:
        raise LipwrightError(f"{place}: {label!r} is silence, which no word has; leave it out")
    return symbol


def _read_text(path: str | os.PathLike[str]) -> str:
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise LipwrightError(f"{path}: no such file; check the path") from error
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise LipwrightError(f"{path}: line {line}: not UTF-8; save the file as UTF-8") from error
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = getattr(error, "strerror", None) or error
        raise LipwrightError(f"{path}: cannot be read: {reason}; check the path") from error
