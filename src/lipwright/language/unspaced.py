"""Text to tokens where no space need stand behind full stops and commas, as in Japanese."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.tokens import LONGEST, without_directions

MARKS: Final = "，。！？、；：…・·｡､।॥፣።،؛؟"
"""marks of scripts that need no space behind them"""
_CLOSING: Final = "」』）)】》〉”’\"'.,;:!?"
_TOKEN: Final = re.compile(f"[^\\s{MARKS}]+[{MARKS}{re.escape(_CLOSING)}]*")


def split_unspaced(text: str, source: str) -> Iterator[tuple[str, int, int]]:
    """Each token as written, its line and its column, both from 1; stage directions are left out.

    Raises:
        LipwrightError: a token is too long to be a word or a phrase.
    """
    for line, content in enumerate(without_directions(text).split("\n"), 1):
        for found in _TOKEN.finditer(content):
            written, column = found[0], found.start() + 1
            if len(written) > LONGEST:
                raise LipwrightError(
                    f"{source}: line {line}, column {column}: {len(written)} characters without a "
                    f"space or a full stop, more than {LONGEST}; put spaces between words"
                )
            yield written, line, column
