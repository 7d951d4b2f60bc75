"""Text to words to phones, one module a language."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import MappingProxyType
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.language.base import Language, Pronunciation, SpokenWord
from lipwright.language.dictionary import Dictionary, read_dictionary

__all__ = [
    "LANGUAGES",
    "Dictionary",
    "Language",
    "Pronunciation",
    "SpokenWord",
    "get_language",
    "read_dictionary",
]


def _english() -> Language:
    from lipwright.language.english import English

    return English()


def _mandarin() -> Language:
    from lipwright.language.mandarin import Mandarin

    return Mandarin()


LANGUAGES: Final = MappingProxyType[str, Callable[[], Language]]({"en": _english, "cmn": _mandarin})
"""code to what makes the language"""


@cache
def get_language(code: str) -> Language:
    """The language of that code; made once, as its lexicon remembers what it has found.

    Raises:
        LipwrightError: there is none.
    """
    if code not in LANGUAGES:
        raise LipwrightError(
            f"unknown language {code!r}; use one of: {', '.join(LANGUAGES)}, or give phones"
        )
    return LANGUAGES[code]()
