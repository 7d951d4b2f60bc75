"""What every voice must refuse in a script."""

from __future__ import annotations

from lipwright.errors import LipwrightError
from lipwright.speech.voices.values import Piece


def check_text(piece: Piece, source: str) -> None:
    """Refuse what cannot be said.

    Raises:
        LipwrightError: a control character or half a letter; names its place.
    """
    line, column = piece.line, piece.column
    for char in piece.text:
        code = ord(char)
        if (code < 32 and char not in "\n\r\t") or 0x7F <= code < 0xA0 or 0xD800 <= code < 0xE000:
            raise LipwrightError(
                f"{source}: line {line}, column {column}: the character U+{code:04X} cannot be "
                "said; remove it"
            )
        line, column = (line + 1, 1) if char == "\n" else (line, column + 1)
