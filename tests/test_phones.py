"""The phone table is closed, its spellings parse, and its distances order phones by their looks."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.phones import (
    ARPABET,
    BACKNESSES,
    COMMON,
    HEIGHTS,
    MANNERS,
    PHONES,
    PLACES,
    SILENCE,
    SILENCE_LABELS,
    Alphabet,
    Phone,
    guess_alphabet,
    is_silence_label,
    nearest_phones,
    parse_phone,
    phone_distance,
)

LANGUAGES = ("(Swedish)", "(Mandarin)")

# What each label meant, and which phones were nearest, when the table held English alone.
BEFORE = json.loads((Path(__file__).parent / "english_phones.json").read_text("utf-8"))

SPOKEN = tuple(phone for phone in PHONES.values() if not phone.is_silence)
symbols = st.sampled_from(tuple(PHONES))

# The CMU pronouncing dictionary, cmudict.phones.
CMU = (
    "AA", "AE", "AH", "AO", "AW", "AY", "B", "CH", "D", "DH", "EH", "ER", "EY", "F", "G", "HH",
    "IH", "IY", "JH", "K", "L", "M", "N", "NG", "OW", "OY", "P", "R", "S", "SH", "T", "TH", "UH",
    "UW", "V", "W", "Y", "Z", "ZH",
)  # fmt: skip

# Xu et al. 2013, table 1, row by row, in its own spelling ("h" is HH here).
XU_TABLE_1 = {
    "ah": "ae ah ax", "aa": "aa", "ao": "ao", "eh": "ey eh", "er": "er", "ih": "ih iy",
    "w": "w uw uh", "ow": "ow", "aw": "aw", "oy": "oy", "ay": "ay", "h": "h", "r": "r", "l": "l",
    "z": "s z", "sh": "sh ch jh zh y", "th": "th dh", "f": "f v", "d": "d t n ng", "kg": "k g",
    "bmp": "p b m",
}  # fmt: skip


class TestTable:
    def test_the_keys_are_the_symbols_and_silence_is_first(self) -> None:
        assert all(symbol == phone.symbol for symbol, phone in PHONES.items())
        assert next(iter(PHONES)) == SILENCE

    @pytest.mark.parametrize("phone", SPOKEN, ids=lambda phone: phone.symbol)
    def test_a_row_names_only_what_exists(self, phone: Phone) -> None:
        assert phone.common in COMMON
        assert re.fullmatch("[A-Z]{1,3}", phone.symbol)
        assert phone.symbol.startswith("X") == (phone.symbol not in ARPABET)
        assert phone.is_vowel != phone.is_consonant
        if phone.is_vowel:
            assert phone.height in HEIGHTS
            assert phone.backness in BACKNESSES
            assert not phone.place
            assert phone.voiced
        else:
            assert phone.manner in MANNERS
            assert phone.place in PLACES
            assert not phone.backness
        assert all(part in PHONES for part in phone.parts or ())

    @pytest.mark.parametrize("phone", SPOKEN, ids=lambda phone: phone.symbol)
    def test_the_example_marks_letters_of_a_word(self, phone: Phone) -> None:
        if phone.symbol == "Q":
            return  # English writes no letter for a glottal stop
        word, _, language = phone.example.partition(" ")
        assert word.isalpha()
        assert re.search("[a-zäö]", word)
        assert re.fullmatch("[A-ZÄÖ]+", "".join(letter for letter in word if letter.isupper()))
        assert language == "" if phone.symbol in ARPABET else language in LANGUAGES

    def test_silence_has_no_features(self) -> None:
        silence = PHONES[SILENCE]
        assert silence.is_silence
        assert not silence.is_vowel
        assert not silence.is_consonant
        assert not silence.common
        assert not silence.voiced
        assert not silence.rounded

    def test_diphthongs_are_vowels_of_two_vowels_and_affricates_stop_and_fricative(self) -> None:
        for phone in SPOKEN:
            if phone.is_diphthong:
                assert phone.parts is not None
                assert all(PHONES[part].is_vowel and not PHONES[part].parts for part in phone.parts)
            elif phone.parts is not None:
                assert phone.manner == "affricate"
                stop, fricative = (PHONES[part] for part in phone.parts)
                assert (stop.manner, fricative.manner) == ("stop", "fricative")
                assert stop.voiced == fricative.voiced == phone.voiced
            assert (phone.manner == "affricate") <= (phone.parts is not None)

    def test_the_diphthongs_are_those_of_american_english(self) -> None:
        moving = {phone.symbol for phone in SPOKEN if phone.is_diphthong}
        assert moving == {"AW", "AY", "EY", "OW", "OY"}

    def test_a_diphthong_is_rounded_where_one_of_its_parts_is(self) -> None:
        for phone in SPOKEN:
            if phone.is_diphthong:
                assert phone.rounded == any(PHONES[part].rounded for part in phone.parts or ())

    def test_consonants_that_differ_by_voice_alone_differ_by_nothing_else(self) -> None:
        pairs = ["P B", "T D", "K G", "F V", "TH DH", "S Z", "SH ZH", "CH JH", "HH HV", "WH W"]
        for pair in pairs:
            quiet, voiced = (PHONES[symbol] for symbol in pair.split())
            assert (quiet.voiced, voiced.voiced) == (False, True)
            assert (quiet.place, quiet.manner) == (voiced.place, voiced.manner)
            assert (quiet.rounded, quiet.common) == (voiced.rounded, voiced.common)

    def test_the_phones_of_the_cmu_dictionary_are_all_there(self) -> None:
        assert len(CMU) == 39
        assert set(CMU) < PHONES.keys()

    def test_the_common_classes_are_the_21_of_the_paper(self) -> None:
        assert len(COMMON) == 21
        assert set(COMMON) == XU_TABLE_1.keys()
        assert {phone.common for phone in SPOKEN} == set(COMMON)

    @pytest.mark.parametrize("common", XU_TABLE_1)
    def test_the_class_of_each_phone_is_that_of_the_papers_table_1(self, common: str) -> None:
        for label in XU_TABLE_1[common].split():
            assert PHONES["HH" if label == "h" else label.upper()].common == common

    def test_the_paper_maps_40_phonemes_and_every_cmu_phone(self) -> None:
        mapped = {label.upper() for row in XU_TABLE_1.values() for label in row.split()}
        assert len(mapped) == 40
        assert mapped - {"H", "AX"} == set(CMU) - {"HH"}


class TestSpellings:
    @pytest.mark.parametrize("alphabet", ["ipa", "xsampa"])
    def test_every_spelling_is_unique_and_parses_back(self, alphabet: Alphabet) -> None:
        spellings = [getattr(phone, alphabet) for phone in SPOKEN]
        assert len(set(spellings)) == len(SPOKEN)
        for phone, spelling in zip(SPOKEN, spellings, strict=True):
            assert parse_phone(spelling, alphabet) == (phone.symbol, None)

    @pytest.mark.parametrize("phone", SPOKEN, ids=lambda phone: phone.symbol)
    def test_arpabet_parses_in_any_case_with_any_stress(self, phone: Phone) -> None:
        assert parse_phone(phone.symbol) == (phone.symbol, None)
        assert parse_phone(phone.symbol.lower()) == (phone.symbol, None)
        for stress in (0, 1, 2):
            assert parse_phone(f" {phone.symbol}{stress}\n") == (phone.symbol, stress)

    @pytest.mark.parametrize("alphabet", ["arpabet", "ipa", "xsampa"])
    @pytest.mark.parametrize("label", sorted(SILENCE_LABELS))
    def test_silence_is_silence_in_every_alphabet(self, label: str, alphabet: Alphabet) -> None:
        assert parse_phone(f" {label.upper()} ", alphabet) == (SILENCE, None)
        assert is_silence_label(label)

    def test_no_silence_label_is_a_phone(self) -> None:
        assert not SILENCE_LABELS & {phone.symbol.lower() for phone in SPOKEN}
        assert not SILENCE_LABELS & {phone.ipa for phone in SPOKEN}
        assert not SILENCE_LABELS & {phone.xsampa for phone in SPOKEN}

    @pytest.mark.parametrize(
        ("label", "symbol", "stress"),
        [
            ("ˈæ", "AE", 1), ("ˌiː", "IY", 2), ("uː", "UW", None), ("ɑː", "AA", None),
            ("ɜː", "ER", None), ("ˈaɪ", "AY", 1), ("t͡ʃ", "CH", None), ("tʃ", "CH", None),
            ("t‿ʃ", "CH", None), ("d͜ʒ", "JH", None), ("ʤ", "JH", None), ("tʰ", "T", None),
            ("r", "R", None), ("g", "G", None), ("əʊ", "OW", None), ("ɫ", "L", None),
            ("ɪə", "IH", None), ("eɪ", "EY", None), ("e", "EH", None), ("ɐ", "AH", None),
        ],
    )  # fmt: skip
    def test_ipa_with_stress_length_ties_and_variants(
        self, label: str, symbol: str, stress: int | None
    ) -> None:
        assert parse_phone(label, "ipa") == (symbol, stress)

    @pytest.mark.parametrize(
        ("label", "symbol", "stress"),
        [
            ('"{', "AE", 1), ("%i:", "IY", 2), ("3:", "ER", None), ("@U", "OW", None),
            ("tS", "CH", None), ("r", "R", None), ("i@", "IY", None), ("'eI", "EY", 1),
            (",I", "IH", 2), ("S", "SH", None), ("D", "DH", None), ("?", "Q", None),
        ],
    )  # fmt: skip
    def test_xsampa_with_stress_length_and_variants(
        self, label: str, symbol: str, stress: int | None
    ) -> None:
        assert parse_phone(label, "xsampa") == (symbol, stress)

    @pytest.mark.parametrize(
        ("label", "alphabet"),
        [("XX", "arpabet"), ("AA3", "arpabet"), ("0", "arpabet"), ("AA 1", "arpabet"),
         ("ʘ", "ipa"), ("ˈ", "ipa"), ("AA", "ipa"), ("%", "xsampa"), ("ʃ", "xsampa")],
    )  # fmt: skip
    def test_an_unknown_label_is_named_with_its_alphabet_and_where_to_look(
        self, label: str, alphabet: Alphabet
    ) -> None:
        with pytest.raises(LipwrightError, match="lipwright phones") as caught:
            parse_phone(label, alphabet)
        assert repr(label) in str(caught.value)
        assert alphabet in str(caught.value)

    @given(st.text(max_size=6), st.sampled_from(["arpabet", "ipa", "xsampa"]))
    def test_any_text_is_a_phone_of_the_table_or_one_clear_line(
        self, label: str, alphabet: Alphabet
    ) -> None:
        message = ""
        symbol, stress = SILENCE, None
        try:
            symbol, stress = parse_phone(label, alphabet)
        except LipwrightError as error:
            message = str(error)
        assert symbol in PHONES
        assert stress in (None, 0, 1, 2)
        assert "\n" not in message


class TestAlphabet:
    @pytest.mark.parametrize("alphabet", ["arpabet", "ipa", "xsampa"])
    def test_a_whole_alphabet_is_told_from_the_others(self, alphabet: Alphabet) -> None:
        column = "symbol" if alphabet == "arpabet" else alphabet
        assert guess_alphabet(["sil", *(getattr(phone, column) for phone in SPOKEN)]) == alphabet

    @pytest.mark.parametrize(
        ("labels", "alphabet"),
        [
            ("HH AH0 L OW1", "arpabet"), ("hh ah l ow", "arpabet"), ("h ə l oʊ", "ipa"),
            ("h @ l @U", "xsampa"), ("D I s", "xsampa"), ("ð ɪ s", "ipa"), ("_ b _", "arpabet"),
            ("p b t", "arpabet"),
        ],
    )  # fmt: skip
    def test_words_are_told_apart(self, labels: str, alphabet: Alphabet) -> None:
        assert guess_alphabet(labels.split()) == alphabet

    def test_silence_alone_or_nothing_is_arpabet(self) -> None:
        assert guess_alphabet(["", "sp"]) == "arpabet"
        assert guess_alphabet([]) == "arpabet"

    @pytest.mark.parametrize("labels", [["AA1", "ə"], ["ə", "@"], ["OW1", "tS"]])
    def test_a_mixture_is_refused_and_the_first_label_that_is_not_arpabet_is_named(
        self, labels: list[str]
    ) -> None:
        first = next(label for label in labels if label.rstrip("012") not in PHONES)
        with pytest.raises(LipwrightError) as caught:
            guess_alphabet(labels)
        assert repr(first) in str(caught.value)


class TestOtherLanguages:
    """Sounds that ARPABET lacks; spellings are those of IPA transcribers and aligners."""

    # The vowels and consonants of Central Swedish, as aligners write them.
    @pytest.mark.parametrize(
        ("labels", "symbols"),
        [
            ("iː ɪ yː ʏ ʉː ɵ uː ʊ", "IY IH XIY XIH UX UH UW UH"),
            ("eː ɛ ɛː æː æ øː œ œː", "EH EH EH AE AE XEY XEH XEH"),
            ("oː ɔ ɑː a ə", "AO AO AA AE AX"),
            ("p b t d k ɡ f v s h", "P B T D K G F V S HH"), ("m n ŋ l r j", "M N NG L R Y"),
            ("ʈ ɖ ɳ ɭ ʂ ɕ ɧ r̪", "XT XD XN XL XS XC XH XR"),
        ],
    )  # fmt: skip
    def test_every_swedish_sound_is_in_the_table(self, labels: str, symbols: str) -> None:
        assert [parse_phone(label, "ipa")[0] for label in labels.split()] == symbols.split()

    @pytest.mark.parametrize(
        ("labels", "symbols"),
        [
            ("ts tsʰ t͡sʰ ʈʂ ʈʂʰ ʈ͡ʂʰ tɕ tɕʰ", "XTS XTS XTS XCH XCH XCH XTC XTC"),
            ("ʂ ʐ ɻ ɕ pʰ tʰ kʰ", "XS XZ XZ XC P T K"),
            ("y ɥ ɤ ɿ ʅ z̩ ʐ̩ ɚ", "XIY XIY XOW XSI XRI XSI XRI AXR"),
        ],
    )  # fmt: skip
    def test_every_mandarin_sound_is_in_the_table(self, labels: str, symbols: str) -> None:
        assert [parse_phone(label, "ipa")[0] for label in labels.split()] == symbols.split()

    def test_xsampa_spells_them_too(self) -> None:
        for labels, symbols in [
            ("y: Y 2: 9 7 H", "XIY XIH XEY XEH XOW XIY"),
            ("t` d` n` l` s` z` s\\ x\\", "XT XD XN XL XS XZ XC XH"),
            ("ts ts\\ ts`", "XTS XTC XCH"),
        ]:
            assert [parse_phone(one, "xsampa")[0] for one in labels.split()] == symbols.split()

    @pytest.mark.parametrize("alphabet", ["arpabet", "ipa", "xsampa"])
    def test_what_english_tools_write_means_what_it_meant_before(self, alphabet: Alphabet) -> None:
        for label, symbol in BEFORE[alphabet].items():
            assert parse_phone(label, alphabet)[0] == symbol

    def test_the_order_of_the_nearest_english_phones_is_as_before(self) -> None:
        assert tuple(PHONES)[: len(ARPABET)] == tuple(BEFORE["nearest"])
        for symbol, order in BEFORE["nearest"].items():
            assert nearest_phones(symbol, ARPABET) == tuple(order.split())

    @pytest.mark.parametrize(
        ("symbol", "good"),
        [
            ("XIY", "UX UW"), ("XIH", "UX UH"), ("XEY", "UX UH"), ("XEH", "AO"), ("XOW", "AX AH"),
            ("XSI", "IX IH"), ("XRI", "IX IH"), ("XT", "T"), ("XD", "D"), ("XN", "N"), ("XL", "L"),
            ("XR", "DX"), ("XS", "SH"), ("XZ", "ZH"), ("XC", "S"), ("XH", "SH"), ("XTS", "S"),
            ("XTC", "S"), ("XCH", "CH"),
        ],
    )  # fmt: skip
    def test_an_engine_that_knows_only_english_takes_what_looks_like_it(
        self, symbol: str, good: str
    ) -> None:
        assert nearest_phones(symbol, ARPABET)[0] in good.split()


class TestDistance:
    @given(symbols, symbols)
    def test_it_is_symmetric(self, one: str, other: str) -> None:
        assert phone_distance(one, other) == phone_distance(other, one)

    @given(symbols, symbols)
    def test_it_is_zero_for_the_same_phone_only(self, one: str, other: str) -> None:
        assert (phone_distance(one, other) == 0) == (one == other)
        assert 0 <= phone_distance(one, other) <= 6

    @given(symbols)
    def test_nearest_phones_rise_in_distance_and_leave_out_the_phone_itself(
        self, symbol: str
    ) -> None:
        order = nearest_phones(symbol)
        distances = [phone_distance(symbol, other) for other in order]
        assert distances == sorted(distances)
        assert set(order) == PHONES.keys() - {symbol}
        assert len(order) == len(PHONES) - 1

    @given(symbols, st.sets(symbols))
    def test_nearest_phones_are_only_those_allowed_in_the_same_order(
        self, symbol: str, among: set[str]
    ) -> None:
        wanted = tuple(other for other in nearest_phones(symbol) if other in among)
        assert nearest_phones(symbol, among) == wanted

    def test_an_unknown_phone_is_refused(self) -> None:
        with pytest.raises(KeyError, match="XX"):
            nearest_phones("XX")

    # GRID never has NG, SH, ZH, HH, OY, UH and ER; the others are in ARPABET but not in CMU's set.
    @pytest.mark.parametrize(
        ("missing", "good"),
        [
            ("NG", "K G"), ("SH", "CH JH"), ("ZH", "CH JH"), ("OY", "AO OW"), ("UH", "UW"),
            ("ER", "AH AX EH R"), ("UX", "UW"), ("IX", "IH IY"), ("AXR", "AX AH EH R"),
            ("EM", "M"), ("EN", "N"), ("EL", "L"), ("WH", "W"), ("DX", "D T N"), ("NX", "N D"),
            ("Y", "IY"), ("W", "UW"),
        ],
    )  # fmt: skip
    def test_what_grid_lacks_falls_back_on_a_phone_that_looks_like_it(
        self, missing: str, good: str
    ) -> None:
        lacks = {"NG", "SH", "ZH", "HH", "OY", "UH", "ER", missing}
        lacks |= {"UX", "IX", "AXR", "HV", "EM", "EN", "ENG", "EL", "WH", "DX", "NX", "Q"}
        assert nearest_phones(missing, ARPABET - lacks)[0] in good.split()

    def test_a_glottal_sound_never_falls_back_on_shut_lips(self) -> None:
        grid = set(CMU) - {"NG", "SH", "ZH", "HH", "OY", "UH", "ER"}
        for symbol in ("HH", "HV"):
            assert PHONES[nearest_phones(symbol, grid)[0]].place != "bilabial"

    def test_no_spoken_phone_is_nearest_to_silence(self) -> None:
        for phone in SPOKEN:
            assert nearest_phones(phone.symbol)[-1] == SILENCE

    @pytest.mark.parametrize("pair", ["P B", "F V", "S Z", "TH DH", "SH ZH", "CH JH", "T D"])
    def test_consonants_that_differ_by_voice_alone_are_nearest(self, pair: str) -> None:
        one, other = pair.split()
        assert nearest_phones(one, ARPABET)[0] == other
        assert nearest_phones(other, ARPABET)[0] == one
