"""The user's own pronunciations in a script."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from lipwright.language import Dictionary, read_dictionary
from lipwright.speech.voices.values import Piece, Script

_TOKEN: Final = re.compile(r"\S+")
_EDGE: Final = "\"“”„‘’'«»()[]{}<>*_~,.;:!?…¡¿–—-"


def with_dictionary(script: Script, dictionary: Path) -> Script:
    """The same script in which words of a dictionary are said as it has them.

    Raises:
        LipwrightError: the dictionary cannot be read.
    """
    own = read_dictionary(dictionary)
    return tuple(part for piece in script for part in _parts(piece, own))


def _parts(piece: Piece, own: Dictionary) -> Iterator[Piece]:
    """A piece, cut around the words that the dictionary has."""
    if piece.phones or not piece.text:
        yield piece
        return
    cuts = [
        (found.start(), found.end(), own.lookup(found[0].strip(_EDGE)))
        for found in _TOKEN.finditer(piece.text)
        if found[0].strip(_EDGE) in own
    ]
    parts: list[Piece] = []
    done = 0
    for start, stop, ways in cuts:
        if piece.text[done:start].strip():
            parts.append(_at(piece, done, start))
        parts.append(replace(_at(piece, start, stop), phones=ways[0]))
        done = stop
    if piece.text[done:].strip():
        parts.append(_at(piece, done, len(piece.text)))
    yield from parts[:-1]
    yield replace(parts[-1], pause=piece.pause)


def _at(piece: Piece, start: int, stop: int) -> Piece:
    """The characters of a piece from `start` to `stop`, with their place."""
    before = piece.text[:start]
    lines = before.count("\n")
    column = start - before.rfind("\n") if lines else piece.column + start
    return replace(
        piece, text=piece.text[start:stop], pause=0.0, line=piece.line + lines, column=column
    )
