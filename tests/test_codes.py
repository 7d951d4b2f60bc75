"""Codes, tags and names of languages mean one code of ours."""

from __future__ import annotations

import re

import pytest

from lipwright import espeak
from lipwright.errors import LipwrightError
from lipwright.language import LANGUAGES, get_language
from lipwright.language.codes import NAMES, OURS, resolve_code

# ISO 639-1, 639-2/T, 639-2/B (code tables of the Library of Congress) and English name.
ISO_639 = """
    en eng eng English / sv swe swe Swedish / de deu ger German / es spa spa Spanish
    fr fra fre French / it ita ita Italian / nl nld dut Dutch / pt por por Portuguese
    ja jpn jpn Japanese / fi fin fin Finnish / pl pol pol Polish / ru rus rus Russian
    cs ces cze Czech / el ell gre Greek / fa fas per Persian / is isl ice Icelandic
    ro ron rum Romanian / sk slk slo Slovak / sq sqi alb Albanian / hy hye arm Armenian
    eu eus baq Basque / my mya bur Burmese / ka kat geo Georgian / mk mkd mac Macedonian
    mi mri mao Maori / ms msa may Malay / cy cym wel Welsh / ko kor kor Korean
    tr tur tur Turkish / ar ara ara Arabic / hi hin hin Hindi / vi vie vie Vietnamese
    uk ukr ukr Ukrainian / hu hun hun Hungarian / da dan dan Danish / he heb heb Hebrew
    th tha tha Thai / ta tam tam Tamil / id ind ind Indonesian / sw swa swa Swahili
"""  # fmt: skip
ROWS = [row.split() for row in re.split(r"[/\n]", ISO_639) if row.strip()]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_every_code_and_name_of_iso_639_is_the_same_language(row: list[str]) -> None:
    assert {resolve_code(name) for name in row} == {row[0]}
    assert resolve_code(row[0].upper()) == resolve_code(f" {row[3].lower()} ") == row[0]


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("zh", "cmn"), ("zho", "cmn"), ("chi", "cmn"), ("cmn", "cmn"), ("zh-CN", "cmn"),
        ("mandarin", "cmn"), ("Chinese", "cmn"), ("zh-Hant-TW", "cmn"), ("cmn-Hans-CN", "cmn"),
        ("zh-HK", "yue"), ("zh-Hant-HK", "yue"), ("zh-yue", "yue"), ("Cantonese", "yue"),
        ("en-US", "en"), ("eng", "en"), ("en_US.UTF-8", "en"), ("en-GB", "en-gb"),
        ("en-uk", "en-gb"), ("British English", "en-gb"), ("en-AU", "en-gb"), ("en-CA", "en"),
        ("sv-SE", "sv"), ("sv_FI", "sv"), ("swe", "sv"), ("svenska", "sv"), ("pt-BR", "pt"),
        ("pt-PT", "pt"), ("de-AT", "de"), ("es-419", "es"), ("es-MX", "es"), ("fr-CA", "fr"),
        ("nb-NO", "nb"), ("no", "nb"), ("nn-NO", "nb"), ("norwegian", "nb"), ("sr-Latn-RS", "sr"),
        ("ar-EG", "ar"), ("iw", "he"), ("farsi", "fa"), ("vi-VN", "vi"), ("de-DE-1996", "de"),
        ("en-us-nyc", "en-us-nyc"), ("vi-vn-x-south", "vi-vn-x-south"), ("ca-valencia", "ca-va"),
        ("Māori", "mi"), ("en-GB-oxendict", "en-gb"), ("Scottish Gaelic", "gd"), ("ja-JP", "ja"),
    ],
)  # fmt: skip
def test_tags_and_names(name: str, code: str) -> None:
    assert resolve_code(name) == code


@pytest.mark.parametrize(
    "name",
    [
        "",
        "xx",
        "C",
        "auto",
        "english teacher",
        "de teacher",
        "😀",
        "zz-ZZ",
        "\x00",
        "-",
        "e" * 9999,
    ],
)
def test_an_unknown_language_lists_the_known_and_the_way_to_more(name: str) -> None:
    with pytest.raises(LipwrightError) as caught:
        resolve_code(name)
    message = str(caught.value)
    assert all(code in message for code in OURS)
    assert "pip install 'lipwright[espeak]'" in message
    assert "\n" not in message
    assert len(message) < 400


def test_a_slip_is_put_right() -> None:
    with pytest.raises(LipwrightError, match="did you mean 'swedish'"):
        resolve_code("Swedisch")


@pytest.mark.parametrize("code", NAMES)
def test_codes_and_names_mean_themselves(code: str) -> None:
    assert resolve_code(code) == code
    assert resolve_code(NAMES[code]) == code


def test_languages_of_the_registry_are_ours() -> None:
    assert {*LANGUAGES} <= {*OURS}
    assert len(NAMES) == len({*NAMES.values()})


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_language_has_the_code_that_it_is_asked_by(code: str) -> None:
    assert get_language(code).code == code


@pytest.mark.skipif(not espeak.is_available(), reason="espeak-ng is not installed")
def test_every_language_of_espeak_has_a_code() -> None:
    codes = {language.code for language in espeak.languages()}
    made = {"xex"}  # its test language
    for code in codes - made:
        assert resolve_code(code) in NAMES
    missing = {*NAMES} - codes - {*OURS}
    assert not missing
