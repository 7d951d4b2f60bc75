"""Numbers and abbreviations of a script as words, for voices that would read them otherwise."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from typing import Final

from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.language import LANGUAGES, Language, SpokenWord, get_language
from lipwright.language.codes import resolve_code
from lipwright.speech.voices.values import Piece, Script

# Marks that stay behind a token that is replaced; its full stop may be that of a short form.
_PAUSES: Final = ",;:!?…、，；：！？"
_OWN_WRITING: Final = frozenset(("ja",))  # whose characters a voice may not know: ours are refused


def written_out(script: Script, code: str, source: str = "text") -> Script:
    """The script with what our text front end reads as other words than are written.

    "kl. 14.30" becomes "klockan fjorton trettio" in Swedish. Words stay as they are written, and
    so does what the front end cannot read, except Japanese characters, which it refuses.

    Args:
        script: what is said.
        code: of the voice's language.
        source: the script's name in errors.

    Raises:
        LipwrightError: Japanese text with characters that have no reading here.
    """
    known = resolve_code(code)
    if known not in LANGUAGES:
        return script
    language = get_language(known)
    return tuple(
        replace(piece, text=_spoken(piece, language, source))
        if piece.text.strip() and not piece.phones
        else piece
        for piece in script
    )


def _spoken(piece: Piece, language: Language, source: str) -> str:
    try:
        words = language.normalize(piece.text, source)
    except MissingExtraError:
        return piece.text
    except LipwrightError:
        if language.code in _OWN_WRITING and any(map(str.isalnum, piece.text)):
            raise
        return piece.text
    return _replaced(piece.text, words)


def _replaced(text: str, words: Sequence[SpokenWord]) -> str:
    """The text with each token that is said otherwise as the words that are said for it.

    What stands between tokens with words was said with the token before, as "km" behind "5".
    """
    begins = [0]
    for line in text.split("\n"):
        begins.append(begins[-1] + len(line) + 1)
    end = max((at for at, char in enumerate(text) if char.isalnum()), default=0)
    said, done = "", 0
    for (line, column, written), group in groupby(
        words, key=lambda word: (word.line, word.column, word.written)
    ):
        start = begins[line - 1] + column - 1
        stop = start + len(written)
        if start < done or text[start:stop] != written:
            return text  # parts of a token that cannot be told apart
        spoken = " ".join(word.text for word in group)
        said += _between(text[done:start])
        said += _token(written, spoken, last=stop > end)
        done = stop
    return said + _between(text[done:])


def _between(text: str) -> str:
    return "".join(char for char in text if char.isspace() or _is_mark(char))


def _token(written: str, spoken: str, *, last: bool) -> str:
    """A token as it is written where its word is the same, else its words and its pause."""
    marks = "".join(filter(_is_mark, written))
    if _letters(spoken) == _letters(written):
        return written
    tail = written[len(written.rstrip(marks)) :]
    return spoken + "".join(m for m in tail if m in _PAUSES or (last and m in ".。"))


def _letters(text: str) -> str:
    """By which a word is the same, with or without accents, capitals and apostrophes."""
    return "".join(filter(str.isalnum, unicodedata.normalize("NFKD", text.casefold())))


def _is_mark(char: str) -> bool:
    return unicodedata.category(char)[0] == "P"
