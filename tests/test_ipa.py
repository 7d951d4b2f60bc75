"""Any IPA becomes phones of the table by what is seen, that of espeak-ng included."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright import espeak
from lipwright.errors import LipwrightError
from lipwright.language.espeak_ipa import SEPARATOR, read_espeak
from lipwright.language.ipa import PHONE_OF, Sound, read_ipa
from lipwright.phones import BILABIALS, PHONES, SILENCE, parse_phone

# The International Phonetic Alphabet, revised to 2020, as its chart prints it.
PULMONIC = "pbtdʈɖcɟkɡqɢʔmɱnɳɲŋɴʙrʀⱱɾɽɸβfvθðszʃʒʂʐçʝxɣχʁħʕhɦɬɮʋɹɻjɰlɭʎʟ"
NON_PULMONIC = "ʘǀǃǂǁɓɗʄɠʛ"
OTHER_SYMBOLS = "ʍwɥʜʢʡɕʑɺɧ"
UNROUNDED_VOWELS = "iɨɯɪeɘɤəɛɜʌæɐaɑ"
ROUNDED_VOWELS = "yʉuʏʊøɵoœɞɔɶɒ"
CHART = (*PULMONIC, *NON_PULMONIC, *OTHER_SYMBOLS, *UNROUNDED_VOWELS, *ROUNDED_VOWELS)
# Languages that espeak-ng names without the rules to read them, or without numbers.
WITHOUT_RULES = {"chr-us-qaaa-x-west", "cv", "fo", "kaa", "sjn", "xex"}
BILABIAL_CLOSURES = set("pbmʙʘɓ")
# Diacritics, as the chart prints them, on its own examples.
DIACRITICS = (
    "n̥ d̥ s̬ t̬ tʰ dʰ ɔ̹ ɔ̜ u̟ e̠ ë e̽ e̯ a˞ b̤ a̤ b̰ a̰ t̼ d̼ tʲ dʲ tˠ dˠ tˤ dˤ e̝ ɹ̝ e̞ β̞ e̘ e̙ t̪ d̪ t̺ d̺ "
    "t̻ d̻ ẽ dⁿ dˡ d̚ pʼ tʼ kʼ sʼ eː eˑ ĕ é ē è e̋ ȅ ě ê e᷄ e᷅ e᷈ e˥ e˦ e˧ e˨ e˩"
)


def _phones(text: str, language: str | None = None) -> str:
    sounds = read_ipa(text) if language is None else read_espeak(text, language)
    return " ".join(sound.phone for sound in sounds)


def phone_of(letter: str) -> str:
    (sound,) = read_ipa(letter)
    return sound.phone


@pytest.mark.parametrize("letter", CHART)
def test_every_letter_of_the_chart_is_one_phone(letter: str) -> None:
    assert read_ipa(letter) == (Sound(letter, PHONE_OF[letter]),)


def test_every_phone_that_a_letter_becomes_is_of_the_table() -> None:
    assert {*PHONE_OF.values()} <= {*PHONES} - {SILENCE}


@pytest.mark.parametrize("letter", CHART)
def test_lips_meet_only_at_what_is_made_with_both_lips_shut(letter: str) -> None:
    assert (phone_of(letter) in BILABIALS) == (letter in BILABIAL_CLOSURES)


@pytest.mark.parametrize("letter", [*ROUNDED_VOWELS, *UNROUNDED_VOWELS])
def test_vowels_keep_their_lips(letter: str) -> None:
    phone = PHONES[phone_of(letter)]
    assert phone.is_vowel
    assert phone.rounded == (letter in ROUNDED_VOWELS)
    assert not phone.is_diphthong


@pytest.mark.parametrize("letter", [*PULMONIC, *NON_PULMONIC])
def test_consonants_stay_consonants(letter: str) -> None:
    assert PHONES[phone_of(letter)].is_consonant


def test_the_labiodentals_touch_the_teeth() -> None:
    assert {PHONES[phone_of(letter)].place for letter in "fvʋⱱɱ"} == {"labiodental"}


@pytest.mark.parametrize("written", DIACRITICS.split())
def test_diacritics_of_the_chart_do_not_change_the_phone(written: str) -> None:
    letter = written[0] if written[0] in PHONE_OF else "e"  # one letter with its accent
    assert phone_of(written) == PHONE_OF[letter]


@pytest.mark.parametrize(
    ("written", "phones"),
    [
        ("tʷ", "T W"), ("dʷ", "D W"), ("n̩", "EN"), ("m̩", "EM"), ("l̩", "EL"), ("ŋ̍", "ENG"),
        ("ɹ̩", "ER"), ("ɫ", "L"), ("ə˞", "AXR"), ("ɾ̃", "NX"), ("i̯", "Y"), ("u̯", "W"),
        ("t͡s", "XTS"), ("k͡p", "P"), ("ɡ͡b", "B"), ("ŋ͡m", "M"), ("m̥", "M"), ("ⁿd", "D"),
    ],
)  # fmt: skip
def test_marks_that_are_seen_are_kept(written: str, phones: str) -> None:
    assert _phones(written) == phones


@pytest.mark.parametrize(
    ("written", "phones"),
    [
        ("t͡ʃaɪ̯", "CH AY"), ("tʃaɪ", "CH AY"), ("d͡ʒoʊ", "JH OW"), ("t͡ɕ", "XTC"), ("ʈ͡ʂ", "XCH"),
        ("haʊs", "HH AW S"), ("ɔʏ̯", "AO XIH"), ("p͡f", "P F"), ("d͡z", "D Z"), ("eu", "EH UW"),
        ("ia", "IY AA"), ("a.i", "AA IY"), ("aˈi", "AA IY"), ("a i", "AA IY"), ("dʲʒ", "JH"),
    ],
)  # fmt: skip
def test_two_letters_are_one_phone_where_the_table_has_it(written: str, phones: str) -> None:
    assert _phones(written) == phones


# Transcriptions of the Handbook of the International Phonetic Association (1999), "The North Wind
# and the Sun", first words: German, French, Spanish-like Galician, Japanese, Arabic, Turkish.
@pytest.mark.parametrize(
    ("written", "phones"),
    [
        ("aɪns ˈʃtʁɪtn̩", "AY N S SH T G IH T EN"),
        ("la biz e lə sɔlɛj", "L AA B IY Z EH L AX S AO L EH Y"),
        ("o ˈβento", "AO V EH N T AO"),
        ("kitakaze to taijoː", "K IY T AA K AA Z EH T AO T AY Y AO"),
        ("kaːnat riːħ", "K AA N AA T XR IY HH"),
        ("poiɾazla ɟyneʃ", "P OY DX AA Z L AA G XIY N EH SH"),
    ],
)
def test_narrow_transcriptions_are_read(written: str, phones: str) -> None:
    assert _phones(written) == phones


def test_letters_of_english_transcribers_are_their_own() -> None:
    assert [sound.phone for sound in read_ipa("rat", "en-GB")] == ["R", "AE", "T"]
    assert [sound.phone for sound in read_ipa("raɪt", "en")] == ["R", "AY", "T"]
    assert [sound.phone for sound in read_ipa("rat", "es")] == ["XR", "AA", "T"]


def test_sounds_keep_marks_and_length_and_stress_is_on_vowels() -> None:
    assert read_ipa("ˈnʲiːtˌa") == (
        Sound("nʲ", "N"),
        Sound("iː", "IY", 1),
        Sound("t", "T"),
        Sound("a", "AA", 2),
    )
    assert read_ipa("ˈtʃɾ̩n") == (Sound("tʃ", "CH"), Sound("ɾ̩", "DX", 1), Sound("n", "N"))


def test_unknown_letters_are_named_with_their_place() -> None:
    with pytest.raises(LipwrightError, match=r"'abЖd': column 3: 'Ж' is no letter"):
        read_ipa("abЖd")
    with pytest.raises(LipwrightError, match="column 2"):
        read_ipa("a😀")


def test_nothing_said_is_no_sounds() -> None:
    assert read_ipa("") == read_ipa(" . | ː (en) ") == ()


def test_letters_agree_with_the_labels_of_track_files() -> None:
    """Track files are English: there "r" is that of "red", "a" that of "cat", "ɒ" unrounded."""
    differ = {
        letter for letter in PHONE_OF
        if letter in "pbtdkɡmnŋfvθðszʃʒhɹjwlʔɾxχiɨuɪʊeoəɛɜʌɔæɐɑyʏøœɤɵʉɥɻɕɧʂʐʈɖɳɭraɒ"
        and parse_phone(letter, "ipa")[0] != phone_of(letter)
    }  # fmt: skip
    assert differ == {"r", "a", "ɒ"}
    for phone in PHONES.values():
        if not phone.is_silence:
            assert phone_of(phone.ipa) == phone.symbol


_WORDS = st.lists(st.sampled_from(CHART), min_size=1, max_size=8).map("".join)


@given(_WORDS, _WORDS)
def test_words_do_not_change_each_other(one: str, other: str) -> None:
    assert read_ipa(f"{one} {other}") == read_ipa(one) + read_ipa(other)


@given(_WORDS, st.sampled_from("ːˑ"), st.sampled_from("ˈˌ"))
def test_stress_and_length_never_change_phones(word: str, length: str, stress: str) -> None:
    plain = [sound.phone for sound in read_ipa(word)]
    assert [sound.phone for sound in read_ipa(stress + word)] == plain
    assert [sound.phone for sound in read_ipa(length.join([*word, ""]))] == plain


@given(_WORDS)
def test_ties_part_nothing_that_was_one(word: str) -> None:
    assert len(read_ipa("͡".join(word))) <= len(read_ipa(word))


@pytest.mark.parametrize(
    ("language", "written", "phones"),
    [
        ("cmn", "ts.h|ˈuɑ|5|ŋ", "XCH W AA NG"), ("cmn", "s.|ˈi.|ɜ", "XS XRI"),
        ("cmn", "tɕ|ˈiou|ɜ", "XTC Y OW"), ("cmn", "s|ˈi̪|5", "S XSI"),
        ("vi", "tʃiɜntʃˈam", "CH IY N CH AA M"),
        ("en-us", "bˈɜːd", "B ER D"),
        ("en-gb", "(en)hˈəʊl(sv)", "HH OW L"), ("sv", "sx|ˈɛː|l", "XH EH L"),
        ("ja", "fˈɯᵝ", "F IX"), ("yue", "s|ˈaa|7|m", "S AA M"), ("th", "t_h|a", "T AA"),
        ("th", "k|h|ˈa", "K AA"), ("yue", "h|ˈoeŋ|z|ˈoenɡ", "HH XEH NG XTS XEH NG"),
        ("ky", "ˈonbeS", "AO N B EH SH"), ("is", "tˈoʊl#f", "T OW L F"), ("da", "ˈ?a", "AA"),
        ("ta", "nʲˌeːɻʉ", "N EH XZ UX"), ("es", "nˈweβe", "N W EH V EH"),
        ("en-us", "bˈɑːɾəl", "B AA DX AX L"),
        ("hi", "c|ˈaː|b", "CH AA B"), ("sw", "m|ˈo|ɟ|a", "M AO JH AA"), ("tr", "c|e", "K EH"),
        ("en-us", "ɹˈoʊzᵻz", "R OW Z IX Z"), ("en-us", "ˈaɪʊ\N{REPLACEMENT CHARACTER}", "AY UH"),
    ],
)  # fmt: skip
def test_oddities_of_espeak_are_read(language: str, written: str, phones: str) -> None:
    assert _phones(written, language) == phones


@pytest.mark.skipif(not espeak.is_available(), reason="espeak-ng is not installed")
def test_all_that_espeak_speaks_can_be_read() -> None:
    numbers = " ".join(map(str, [*range(32), 45, 56, 67, 78, 89, 90, 100, 1000, 1_234_567]))
    letters = "a b c d e f g h i j k l m n o p q r s t u v w x y z"
    for language in espeak.languages():
        for text in espeak.words_to_ipa([numbers, letters], language.code, SEPARATOR):
            sounds = read_espeak(text, language.code)
            assert len(sounds) > 20 or language.code in WITHOUT_RULES
