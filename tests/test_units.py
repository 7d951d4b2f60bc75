"""Sounds of any language to units of the acoustic model: closed sets and known cases."""

import pytest

from lipwright.language import LANGUAGES, get_language
from lipwright.language.ipa import PHONE_OF
from lipwright.phones import ARPABET, PHONES, SILENCE
from lipwright.speech.acoustic import FILLERS, load_model
from lipwright.speech.units import all_units, letters_of, sounds, units_of


def known(units):
    spoken = set(load_model().base_phones) - FILLERS
    return bool(units) and {one for unit in units for one in unit.split("|")} <= spoken


def test_every_sound_of_the_tables_becomes_units_that_the_model_has():
    for ipa in sounds():
        assert known(units_of("AA", ipa)), ipa
        for language in LANGUAGES:
            assert known(units_of("AA", ipa, language)), (language, ipa)


def test_every_letter_of_ipa_has_a_row():
    assert {letters_of(letter) for letter in PHONE_OF} <= set(sounds())


@pytest.mark.parametrize("symbol", [symbol for symbol in PHONES if symbol != SILENCE])
def test_every_phone_of_the_table_becomes_units_and_english_ones_stay_themselves(symbol):
    units = units_of(symbol)
    assert known(units)
    if symbol in load_model().base_phones:
        assert symbol in ARPABET
        assert units == (symbol,)


@pytest.mark.parametrize("code", list(LANGUAGES))
def test_every_sound_of_a_language_becomes_units(code):
    for phoneme in get_language(code).inventory():
        for phone in phoneme.phones:
            assert known(units_of(phone, phoneme.ipa, code)), phoneme


def test_sounds_go_by_the_ear_where_phones_go_by_the_eye():
    assert "HH" in units_of("K", "x", "de")[0]  # German ach: K on the face, breath to the ear
    assert units_of("P", "p", "cmn") == ("B",)
    assert units_of("P", "pʰ", "cmn") == ("P",)
    assert units_of("XTS", "t͡s", "de") == ("T", "S")
    assert units_of("N", "ɲ", "es") == ("N", "Y")
    assert units_of("AY", "aɪ", "de") == ("AY",)
    assert units_of("HH", "ç", "de") != units_of("K", "c", "de")


def test_length_stress_and_ties_change_nothing():
    assert units_of("AA", "ˈɑː") == units_of("AA", "ɑ")
    assert units_of("CH", "t͡ʃ") == units_of("CH", "tʃ") == ("CH",)
    assert units_of("AO", "ɔ̃ː", "fr") == units_of("AO", "ɔ", "fr")


def test_a_pronunciation_has_one_row_of_units_a_phone():
    assert all_units(("XTS", "AA"), ("ts", "a"), "cmn") == (("T", "S"), ("AA|AH|AE",))
    assert all_units(("B", "IH"), (), "en") == (("B",), ("IH",))
