"""Plain text and SSML as scripts that voices say."""

from __future__ import annotations

import re
import unicodedata
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.speech.voices.ssml_elements import Reader
from lipwright.speech.voices.values import Piece, Script

MOST_CHARACTERS: Final = 1_000_000
_SPEAK: Final = re.compile(r"\s*(?:<\?xml|<!DOCTYPE|<!--|<(?:ssml:)?speak[\s/>])")
_TAG: Final = re.compile(r"<(?:ssml:)?speak\s[^>]*\bxml:lang\s*=\s*[\"']([A-Za-z0-9-]+)")
_EMOJI: Final = (
    "[\U0001f000-\U0001faff\u2600-\u27bf\u2b00-\u2bff\u2300-\u23ff]"
    "(?:[\ufe0e\ufe0f\u20e3\U0001f3fb-\U0001f3ff\U000e0020-\U000e007f]"
    "|\u200d[\U0001f000-\U0001faff\u2600-\u27bf\u2b00-\u2bff])*"
)
_PICTURES: Final = re.compile(rf"{_EMOJI}|[\ufe0e\ufe0f\u20e3]")


def language_tag(text: str) -> str:
    """What `xml:lang` of the outermost element says; "" where it is plain text or says nothing."""
    found = _TAG.search(text) if _SPEAK.match(text) else None
    return found[1] if found else ""


def read_script(text: str, source: str = "text", language: str | None = None) -> Script:
    """Plain text, or SSML where it begins with <speak, as a script.

    Emoji are not said.

    Args:
        text: what is said.
        source: its name in errors.
        language: ISO code of plain text, or of SSML whose `speak` has no `xml:lang`; for `say-as`.

    Raises:
        LipwrightError: nothing is said, there are control characters, or the SSML is not well
            formed or has what is not supported; names line, column and remedy.
    """
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > MOST_CHARACTERS:
        raise LipwrightError(
            f"{source}: {len(text)} characters, more than {MOST_CHARACTERS}; say it in parts"
        )
    _refuse_control(text, source)
    spoken = _PICTURES.sub(lambda found: " " * len(found[0]), text)
    script = Reader(source, language).read(spoken) if _SPEAK.match(text) else _plain(spoken)
    if any(piece.phones or _says(piece.text) for piece in script):
        return script
    if spoken != text:
        raise LipwrightError(f"{source}: has nothing but emoji, which no voice says; give words")
    raise LipwrightError(f"{source}: has no words; give the words that are spoken")


def _says(text: str) -> bool:
    return any(char.isalnum() for char in text)


def _refuse_control(text: str, source: str) -> None:
    for place, char in enumerate(text):
        kind = unicodedata.category(char) if not " " <= char <= "~" else ""
        if kind == "Cs" or (kind == "Cc" and char not in "\t\n") or char in "\ufffe\uffff":
            line, column = _place(text, place)
            what = "half a letter" if kind == "Cs" else "the control character"
            raise LipwrightError(
                f"{source}: line {line}, column {column}: {what} U+{ord(char):04X}; remove it"
            )


def _place(text: str, index: int) -> tuple[int, int]:
    """Line and column of a character, from 1."""
    return text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index)


def _plain(text: str) -> Script:
    stripped = text.strip()
    if not stripped:
        return ()
    line, column = _place(text, len(text) - len(text.lstrip()))
    return (Piece(stripped, line=line, column=column),)
