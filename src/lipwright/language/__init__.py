"""Text to words to phones, one module a language."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from types import MappingProxyType
from typing import Final, cast

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
    "en-gb": "lipwright.language.english.british",
    "sv": "lipwright.language.swedish",
    "cmn": "lipwright.language.mandarin",
    "ja": "lipwright.language.japanese",
    **dict.fromkeys(("de", "es", "fr", "it", "nl", "pt"), "lipwright.language.tabled"),
})  # fmt: skip
"""code to the module that makes the language, by its function `make(code) -> Language`"""


_OTHERS: Final = "lipwright.language.espeaking"


@cache
def get_language(code: str) -> Language:
    """The language of that code; made once, as its lexicon remembers what it has found.

    One that is not in `LANGUAGES` is pronounced by espeak-ng, where that is installed.

    Raises:
        LipwrightError: there is none.
    """
    if code not in LANGUAGES:
        from lipwright.language.codes import resolve_code

        known = resolve_code(code)
        if known != code:
            return get_language(known)
    return cast(Language, import_module(LANGUAGES.get(code, _OTHERS)).make(code))
