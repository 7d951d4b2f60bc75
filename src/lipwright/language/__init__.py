"""Text to words to phones, one module a language."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from types import MappingProxyType
from typing import Final, cast

from lipwright.errors import LipwrightError
from lipwright.language.base import Language, Phoneme, Pronunciation, SpokenWord
from lipwright.language.dictionary import Dictionary, read_dictionary

__all__ = [
    "LANGUAGES",
    "Dictionary",
    "Language",
    "Phoneme",
    "Pronunciation",
    "SpokenWord",
    "get_language",
    "read_dictionary",
]

LANGUAGES: Final = MappingProxyType({
    "en": "lipwright.language.english",
    "cmn": "lipwright.language.mandarin",
})  # fmt: skip
"""code to the module that makes the language, by its function `make(code) -> Language`"""


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
    return cast(Language, import_module(LANGUAGES[code]).make(code))
