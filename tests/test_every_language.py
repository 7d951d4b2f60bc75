"""Every sound of every language reaches a mouth in every engine; the set is closed."""

from __future__ import annotations

import unicodedata

import numpy as np
import pytest

from lipwright.engines import ENGINES, engine_learnt, get_engine
from lipwright.engines.bigram import open_set
from lipwright.features.known import is_lent, replacement
from lipwright.language import LANGUAGES, Phoneme, get_language
from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.pipeline import AnimateOptions, animate_track
from lipwright.track import PhoneTrack

SOUNDS = [
    pytest.param(code, sound, id=f"{code}-{sound.ipa}")
    for code in LANGUAGES
    for sound in get_language(code).inventory()
]
USED = sorted({phone for case in SOUNDS for phone in case.values[1].phones})


def alone(*phones: str) -> PhoneTrack:
    """Phones of 0.15 s between silences."""
    row = (SILENCE, *phones, SILENCE)
    return PhoneTrack(row, 0.15 * np.arange(len(row) + 1))


@pytest.mark.parametrize(("code", "sound"), SOUNDS)
def test_a_sound_has_phones_of_the_table_and_an_example(code: str, sound: Phoneme) -> None:
    assert sound.phones
    assert all(phone in PHONES and phone != SILENCE for phone in sound.phones)
    assert sound.example
    assert unicodedata.normalize("NFC", sound.ipa)


@pytest.mark.parametrize(("code", "sound"), SOUNDS)
def test_only_sounds_of_two_lips_shut_them(code: str, sound: Phoneme) -> None:
    closes = bool(set(sound.phones) & BILABIALS)
    assert closes == bool(set(sound.ipa) & set("pbmɓ")), sound


@pytest.mark.parametrize("phone", USED)
def test_the_default_model_has_a_mouth_for_it(phone: str) -> None:
    known = frozenset(engine_learnt(None, None)[0])
    assert is_lent(phone, known) or all(other in known for other in replacement(phone, known))


@pytest.mark.parametrize("name", ["english", "swedish", "mandarin"])
def test_the_bigram_sets_have_a_class_for_it(name: str) -> None:
    bigrams = open_set(name)
    assert all(bigrams.class_of(phone) for phone in USED)


@pytest.mark.parametrize("engine", [name for name in ENGINES if ENGINES[name].ships])
def test_every_engine_moves_every_phone(engine: str) -> None:
    assert get_engine(engine)
    clip = animate_track(alone(*USED), AnimateOptions(engine=engine))
    assert np.isfinite(clip.values).all()
    assert (np.abs(clip.values).max(axis=0) > 0.1).sum() > 5


ROUND = [PHONES[phone] for phone in USED if PHONES[phone].rounded]


@pytest.mark.parametrize(
    "phone", [phone.symbol for phone in ROUND if phone.is_vowel and not phone.is_diphthong]
)
def test_rounded_vowels_are_round(phone: str) -> None:
    def rounding(symbol: str) -> float:
        clip = animate_track(alone(symbol))
        return float((clip.curve("mouthPucker") + clip.curve("mouthFunnel")).max())

    assert rounding(phone) > 2 * rounding("IY")
