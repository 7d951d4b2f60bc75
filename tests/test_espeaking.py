"""Any language that espeak-ng speaks has words, phones, sounds and stress."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from lipwright import espeak
from lipwright.errors import LipwrightError
from lipwright.language import get_language, read_dictionary
from lipwright.language.base import SpokenWord
from lipwright.language.codes import NAMES
from lipwright.language.espeaking import EspeakLanguage, make
from lipwright.phones import BILABIALS, PHONES
from test_cli import assert_refused, lipwright

needs_espeak = pytest.mark.skipif(
    not espeak.is_available(), reason="espeak-ng is not installed: pip install 'lipwright[espeak]'"
)


def _said(code: str, text: str) -> list[str]:
    language = make(code)
    ways = language.pronounce_all(language.normalize(text))
    return [" ".join(way[0].phones) for way in ways]


# Finnish after Suomi, Toivanen and Ylitalo, "Finnish sound structure" (2008): letters are sounds,
# doubled ones long. Polish after Jassem (2003), Journal of the IPA 33. Turkish after Zimmer and
# Orgun (1992), Journal of the IPA 22.
@needs_espeak
@pytest.mark.parametrize(
    ("code", "text", "phones"),
    [
        ("fi", "hyvää päivää", ["HH XIY V AE", "P AE IY V AE"]),
        ("fi", "pöytä", ["P XEY XIY T AE"]),
        ("pl", "dzień dobry", ["XTC EH N", "D AO B XR IX"]),
        ("pl", "mama", ["M AA M AA"]),
        ("tr", "güzel", ["G XIY Z AE L"]),
        ("ru", "мама", ["M AA M AA"]),
        ("ko", "엄마", ["AH M M AH"]),
        ("el", "μπαμπά", ["B AA B AA"]),
        ("hi", "चाय", ["CH AA Y"]),
    ],
)
def test_words_of_languages_far_apart(code: str, text: str, phones: list[str]) -> None:
    assert _said(code, text) == phones


@needs_espeak
def test_sounds_and_stress_stand_beside_the_phones() -> None:
    (way,) = make("fi").pronounce("kiitos")
    assert way.phones == ("K", "IY", "T", "AO", "S")
    assert way.ipa == ("k", "iː", "t", "o", "s")
    assert way.stress == (None, 1, None, 0, None)
    assert way.source == "g2p"


@needs_espeak
def test_words_have_places_and_no_punctuation() -> None:
    words = make("fi").normalize('Hei!\n "Mitä kuuluu?" – 25 😀 kissaa…')
    assert [(word.text, word.line, word.column) for word in words] == [
        ("hei", 1, 1), ("mitä", 2, 2), ("kuuluu", 2, 8), ("25", 2, 19), ("kissaa", 2, 24),
    ]  # fmt: skip
    assert words[1].written == '"Mitä'


@needs_espeak
def test_numbers_are_read_by_espeak() -> None:
    assert _said("pl", "7") == _said("pl", "siedem")


@needs_espeak
def test_full_stops_of_chinese_part_words() -> None:
    words = make("yue").normalize("你好。我唔知！")
    assert [(word.text, word.column) for word in words] == [("你好", 1), ("我唔知", 4)]


@needs_espeak
def test_short_words_in_capitals_are_spelt_out_or_said_as_espeak_knows_them() -> None:
    language = make("ru")
    words = language.normalize("СССР")
    assert words[0].text == "ссср"
    assert len(language.pronounce_all(words)[0][0].phones) > 6


@needs_espeak
def test_the_users_dictionary_comes_first(tmp_path: Path) -> None:
    path = tmp_path / "own.txt"
    path.write_text("kissa M AA M\n", encoding="utf-8")
    own = read_dictionary(path)
    language = make("fi")
    words = language.normalize("Kissa, talo", dictionary=own)
    ways = language.pronounce_all(words, own)
    assert ways[0][0].phones == ("M", "AA", "M")
    assert ways[0][0].source == "dictionary"
    assert ways[1][0].source == "g2p"


@needs_espeak
def test_many_words_are_asked_for_once() -> None:
    language = EspeakLanguage("fi")
    words = [SpokenWord(f"sana{index % 50}", "", 1, 1) for index in range(20_000)]
    ways = language.pronounce_all(words)
    assert ways[0] is ways[50]
    assert len({way[0].phones for way in ways}) == 50


@needs_espeak
def test_what_espeak_does_not_say_is_named_with_its_place() -> None:
    language = make("fo")  # listed by espeak-ng 1.52 without its rules
    words = language.normalize("Hey\n føroyar")
    with pytest.raises(LipwrightError, match=r"espeak-ng says nothing for 'Hey' in Faroese"):
        language.pronounce_all(words)


@pytest.mark.parametrize("text", ["", " \n", "!?", "😀 👍"])
def test_no_words_is_an_error(text: str) -> None:
    with pytest.raises(LipwrightError, match=r"a\.txt: has no words"):
        make("fi").normalize(text, "a.txt")


def test_a_token_too_long_to_be_a_word_is_an_error() -> None:
    with pytest.raises(LipwrightError, match="line 1, column 1"):
        make("fi").normalize("a" * 100_000)


def test_codes_and_names_make_a_language_and_others_do_not() -> None:
    assert (make("fin").code, make("Finnish").name) == ("fi", "Finnish")
    assert get_language("fi-FI").code == "fi"
    with pytest.raises(LipwrightError, match="unknown language 'tlhx'"):
        make("tlhx")


@needs_espeak
def test_every_language_has_a_voice_and_speaks_phones_of_the_table() -> None:
    voices = {language.code for language in espeak.languages()}
    for code in NAMES:
        language = make(code)
        assert language.voice in voices or code in ("py", "piqd"), code
        ways = language.pronounce_all([SpokenWord(str(n), str(n), 1, 1) for n in (1, 3)]) if (
            code not in ("fo", "kaa", "cv", "sjn", "chr-us-qaaa-x-west")
        ) else ()  # fmt: skip
        for way in ways:
            assert {*way[0].phones} <= {*PHONES}
            assert len(way[0].ipa) == len(way[0].phones)


@needs_espeak
@pytest.mark.parametrize(
    ("code", "word", "closures"),
    [
        ("fi", "pappa", 2), ("ru", "бабушка", 2), ("tr", "bambu", 3), ("ar", "باب", 2),
        ("hi", "मामा", 2),
    ],
)  # fmt: skip
def test_lips_shut_at_each_p_b_m(code: str, word: str, closures: int) -> None:
    (way,) = make(code).pronounce(word)
    assert sum(phone in BILABIALS for phone in way.phones) == closures


def test_a_missing_espeak_says_how_to_install_it() -> None:
    program = (
        "import sys; sys.modules['espeakng_loader'] = None\n"
        "import ctypes.util; ctypes.util.find_library = lambda name: None\n"
        "from lipwright.language.espeaking import make\n"
        "from lipwright.errors import LipwrightError\n"
        "try: make('fi').pronounce('hei')\n"
        "except LipwrightError as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "pip install 'lipwright[espeak]'" in done.stdout, done.stderr


def test_a_language_without_a_list_of_sounds_asks_for_a_text() -> None:
    assert_refused(lipwright("phones", "--language", "fi"), "Finnish", "give a text")
