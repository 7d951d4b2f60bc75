"""What espeak-ng gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


@dataclass(frozen=True)
class EspeakLanguage:
    """A voice of espeak-ng by the language that it speaks."""

    code: str
    """as `to_ipa` and `speak` take it, in lower case: "sv", "en-gb", "cmn-latn-pinyin" """
    name: str
    """in English, such as "Swedish" """
    codes: tuple[str, ...]
    """every language code that the voice gives itself, the main one first"""
    identifier: str
    """its file, such as "gmq/sv" """


@dataclass(frozen=True)
class Clause:
    """A part of a text between two marks of punctuation."""

    text: str
    """as given, with the punctuation and the white space at its end"""
    words: tuple[tuple[tuple[str, str], ...], ...]
    """each phoneme of each word, as espeak-ng writes it and in IPA"""


@dataclass(frozen=True)
class PhoneEvent:
    """Where espeak-ng says that a sound begins."""

    start: float
    """s"""
    label: str
    """IPA with stress and length marks, or a mnemonic where these were asked for; "" a pause. Up
    to 8 bytes of UTF-8; longer IPA ends there"""
    position: int
    """of the word that it belongs to: index of the character in the text"""


@dataclass(frozen=True)
class WordEvent:
    """Where espeak-ng says that a word begins."""

    start: float
    """s"""
    position: int
    """index of its first character in the text"""
    length: int
    """characters"""


@dataclass(frozen=True, eq=False)
class Speech:
    """What espeak-ng has said."""

    samples: npt.NDArray[np.float32]
    """(N,), full scale is 1; read-only"""
    rate: int
    """samples a second"""
    phones: tuple[PhoneEvent, ...]
    """in order of their starts"""
    words: tuple[WordEvent, ...]
    """in order of their starts"""
