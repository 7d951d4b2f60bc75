"""Text to tokens: what stands between white space, with its place, before a language reads it."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, NoReturn

from lipwright.errors import LipwrightError

# "[laughs]", over several lines too, and the tags of marked-up text
_UNSPOKEN: Final = re.compile(r"\[[^\[\]]*\]|</?[A-Za-z][^<>\n]*>")
EDGE: Final = '"()[]{}<>*_~|\\^`,;:!?¡¿…'
"""punctuation that may stand around a word"""
SIGNS: Final = str.maketrans({
    **dict.fromkeys("‘’‛ʼʻ`´′", "'"), **dict.fromkeys("“”„‟«»″‹›", '"'), "⁄": "/",
    **dict.fromkeys("‐‑‒–—―−﹣－", "-"), **dict.fromkeys("™®©\u00ad", ""), "‚": ",",
})  # fmt: skip
"""signs of many shapes to the one that is looked up"""
LONGEST: Final = 500  # characters of a token; web addresses are the longest that are said
_GROUPED: Final = r"(?<!\S)[^\w\s]?\d{1,3}(?:[ \u00a0\u202f]\d{3})+(?!\d)\S*"
_TOKEN: Final = re.compile(r"\S+")
_TOKEN_GROUPED: Final = re.compile(rf"{_GROUPED}|\S+")


@dataclass(frozen=True)
class Token:
    """What stands between white space."""

    written: str
    line: int
    """from 1"""
    column: int
    """of the first character, from 1"""
    core: str
    """with plain signs, without punctuation around it but for last dots"""

    @property
    def bare(self) -> str:
        """The core without the dots at its end."""
        return self.core.rstrip(".")


def without_directions(text: str) -> str:
    """The text with spaces for stage directions and tags, so that all else keeps its place."""
    return _UNSPOKEN.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def split_text(
    text: str, source: str, grouped: bool = False, pattern: re.Pattern[str] | None = None
) -> Iterator[tuple[str, int, int]]:
    """Each token of `text` as written, its line and its column; stage directions are left out.

    With `grouped`, digits in threes with spaces between them are one token: "12 500". A `pattern`
    says itself what a token is.

    Raises:
        LipwrightError: a token is too long to be a word.
    """
    pattern = pattern or (_TOKEN_GROUPED if grouped else _TOKEN)
    for line, content in enumerate(without_directions(text).split("\n"), 1):
        for found in pattern.finditer(content):
            written, column = found[0], found.start() + 1
            if len(written) > LONGEST:
                raise LipwrightError(
                    f"{source}: line {line}, column {column}: a word of {len(written)} "
                    f"characters, more than {LONGEST}; put spaces between words"
                )
            yield written, line, column


def trim(core: str, is_amount: Callable[[str], object]) -> str:
    """A token without the punctuation around it; its last dots stay, and the sign of an amount."""
    core = core.strip(EDGE)
    while core != (inner := core.rstrip(EDGE)) or (core.endswith((".'", '."')) and len(core) > 1):
        core = inner[:-1] if core == inner else inner
    return core if is_amount(core) else core.lstrip(".-")


def refuse_foreign(
    written: str, place: str, column: int, is_foreign: Callable[[str], bool], language: str
) -> NoReturn:
    """Refuse a token with letters that a language lacks; names them and where they stand.

    Args:
        written: the token.
        place: where it stands: "text: line 3".
        column: of its first character, from 1.
        is_foreign: whether a character, as written, has such letters. A letter may fall apart when
            a token is made plain; what is named is what was written.
        language: in English.

    Raises:
        LipwrightError: always.
    """
    first = next((at for at, char in enumerate(written) if is_foreign(char)), 0)
    run = written[first : first + 12]
    foreign = "".join(filter(is_foreign, run))
    raise LipwrightError(
        f"{place}, column {column + first}: {foreign or run!r} is not in {language} letters; spell "
        "it in them, or choose the language of the text"
    )


def is_letter(char: str) -> bool:
    """Whether it is a letter of any alphabet."""
    return unicodedata.category(char) in ("Lu", "Ll", "Lt", "Lo")
