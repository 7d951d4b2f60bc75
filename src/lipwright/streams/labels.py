"""Names of phones that other programs write: ARPABET, SAPI, IPA in the ways of each."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.formats.intervals import Interval
from lipwright.language.codes import is_english
from lipwright.language.ipa import Sound, read_ipa
from lipwright.phones import SILENCE, is_silence_label, parse_phone
from lipwright.streams.placing import paced
from lipwright.streams.times import Timed

# The phones of SAPI (Speech API 5.4, American English phonemes) that ARPABET spells otherwise.
_SAPI: Final = {"h": "HH"}

# MFA writes the ends of diphthongs as glides ("MFA phone set" of its models): aj is aɪ.
_GLIDE: Final = re.compile(r"(?<=[aæɑɐeɛəoɔʌ])([jw])(?=[ː˥˦˧˨˩]*$)")
_ENDS: Final = {"j": "ɪ", "w": "ʊ"}


def read_labels(
    phones: Sequence[Timed], language: str, *, silent: bool = False
) -> list[Interval] | None:
    """Phones of the table for labels that are all ARPABET (or SAPI) or all IPA.

    "y" is a consonant in one and a vowel in the other: in English files ARPABET is tried first, in
    others IPA, of which upper-case ARPABET is none. A label of several phones is shared
    among them by their usual durations.

    Args:
        phones: with ends.
        language: ISO code, as IPA is read.
        silent: whether labels of silence are known too.

    Returns:
        Intervals in ARPABET with stress, or None where a label is neither.
    """
    english = is_english(language)
    for names in (_arpabet, _ipa) if english else (_ipa, _arpabet):
        try:
            return [one for phone in phones for one in _shared(phone, names, language, silent)]
        except LipwrightError:
            continue
    return None


def is_arpabet(label: str) -> bool:
    """Whether ARPABET or SAPI spells a label."""
    try:
        _arpabet(label, "")
    except LipwrightError:
        return False
    return True


def ipa_sounds(label: str, language: str) -> tuple[Sound, ...]:
    """The sounds of one label in IPA, in the way of the Montreal Forced Aligner too.

    Raises:
        LipwrightError: it is none.
    """
    sounds = read_ipa(_GLIDE.sub(lambda found: _ENDS[found[0]], label), language)
    if not sounds:
        raise LipwrightError(f"{label!r} is no sound")
    return sounds


def _arpabet(label: str, language: str) -> list[tuple[str, int | None]]:
    return [parse_phone(_SAPI.get(label, label))]


def _ipa(label: str, language: str) -> list[tuple[str, int | None]]:
    return [(sound.phone, sound.stress) for sound in ipa_sounds(label, language)]


def _shared(phone: Timed, names: object, language: str, silent: bool) -> list[Interval]:
    assert phone.end is not None
    assert callable(names)
    if phone.end <= phone.start:
        return []
    if is_silence_label(phone.label):
        if not silent:
            raise LipwrightError("silence within a word")
        return [Interval(phone.start, phone.end, SILENCE, phone.place)]
    found: list[tuple[str, int | None]] = names(phone.label, language)
    edges = paced([symbol for symbol, _ in found], phone.start, phone.end)
    return [
        Interval(start, end, symbol if mark is None else f"{symbol}{mark}", phone.place)
        for (symbol, mark), start, end in zip(found, edges[:-1], edges[1:], strict=True)
    ]
