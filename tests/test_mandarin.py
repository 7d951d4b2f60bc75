"""Pinyin: syllables of the table and no others, however they are written, to phones we know."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.language import Dictionary, get_language
from lipwright.language.mandarin.pinyin import syllables_of
from lipwright.language.mandarin.syllables import (
    INITIALS,
    INTERJECTIONS,
    SYLLABLES,
    is_syllable,
    syllable_phones,
)
from lipwright.phones import PHONES, SILENCE

CMN = get_language("cmn")
MARKS = ("\u0304", "\u0301", "\u030c", "\u0300")
tones = st.integers(0, 4)
syllables = st.sampled_from(sorted(SYLLABLES))


def phones(word: str) -> str:
    """The phones of a word, as one text."""
    (way,) = CMN.pronounce(word)
    return " ".join(way.phones)


def marked(syllable: str, tone: int) -> str:
    """A syllable with the mark of a tone from 1 to 4 on the vowel that carries it."""
    place = next(
        (syllable.index(v) for v in ("a", "e", "ê", "ou") if v in syllable),
        max(index for index, letter in enumerate(syllable) if letter in "aoeêiuü"),
    )
    whole = syllable[: place + 1] + MARKS[tone - 1] + syllable[place + 1 :]
    return unicodedata.normalize("NFC", whole)


class TestTable:
    def test_there_are_about_as_many_syllables_as_dictionaries_have(self) -> None:
        # 400 and some (ISO 7098), the colloquial ones that dictionaries add, and the spellings of
        # ü behind j q x y, n and l.
        respelt = [s for s in SYLLABLES if s[0] in "jqxy" and "ü" in s] + ["lue", "nue"]
        assert 400 <= len(set(SYLLABLES) - set(respelt)) <= 430

    @pytest.mark.parametrize("syllable", sorted({*SYLLABLES, *INTERJECTIONS}))
    def test_each_has_phones_of_the_table_and_its_initial_first(self, syllable: str) -> None:
        said = syllable_phones(syllable)
        assert set(said) <= PHONES.keys() - {SILENCE}
        initials = [initial for initial in INITIALS if syllable.startswith(initial)]
        if initials and syllable not in INTERJECTIONS:
            assert said[0] == INITIALS[max(initials, key=len)]
            assert any(PHONES[phone].is_vowel for phone in said)

    @pytest.mark.parametrize("syllable", sorted(SYLLABLES))
    def test_erhua_ends_in_r_colour_and_keeps_the_initial(self, syllable: str) -> None:
        said = syllable_phones(f"{syllable}r")
        assert said[-1] == ("ER" if syllable == "e" else "AXR")  # "er" is a syllable of its own
        if syllable[0] in "bpmfdtnlgkhjqxzcsr":
            assert said[0] == SYLLABLES[syllable][0]
            assert len(said) >= 2

    @pytest.mark.parametrize(
        "text", ["", "r", "q", "bua", "fi", "jo", "rr", "xan", "sin", "lv", "err2"]
    )
    def test_other_letters_are_none(self, text: str) -> None:
        assert not is_syllable(text)


class TestWriting:
    @given(st.lists(st.tuples(syllables, tones), min_size=1, max_size=6))
    def test_tone_digits_part_any_syllables(self, said: list[tuple[str, int]]) -> None:
        written = "".join(f"{syllable}{tone}" for syllable, tone in said)
        assert syllables_of(written) == [syllable for syllable, _ in said]

    @given(st.lists(st.tuples(syllables, st.integers(1, 4)), min_size=1, max_size=6))
    def test_apostrophes_part_any_syllables_with_marks(self, said: list[tuple[str, int]]) -> None:
        written = "'".join(marked(*one) for one in said)
        assert syllables_of(written) == [syllable for syllable, _ in said]
        assert syllables_of(unicodedata.normalize("NFD", written).upper()) == syllables_of(written)

    @given(syllables, st.integers(1, 4))
    def test_u_with_dots_is_typed_in_three_ways(self, syllable: str, tone: int) -> None:
        for dots in ("v", "u:", "ü"):
            assert syllables_of(f"{syllable.replace('ü', dots)}{tone}") == [syllable]

    @pytest.mark.parametrize(
        ("word", "parts"),
        [
            ("nihao", "ni hao"), ("xian", "xian"), ("xi'an", "xi an"), ("Xīān", "xi an"),
            ("zhongguo", "zhong guo"), ("fangan", "fan gan"), ("fang'an", "fang an"),
            ("fāngàn", "fan gan"), ("tiananmen", "tian an men"), ("huaren", "hua ren"),
            ("nǚ'ér", "nü er"), ("er2zi5", "er zi"), ("hua1r", "huar"), ("huar1", "huar"),
            ("zhèr", "zher"), ("yihuir", "yi huir"), ("hua1ren2", "hua ren"), ("lve4", "lüe"),
            ("pu3tong1hua4", "pu tong hua"), ("dà-xué", "da xue"), ("ng", "ng"),
        ],
    )  # fmt: skip
    def test_words_part_as_pinyin_is_written(self, word: str, parts: str) -> None:
        assert syllables_of(word) == parts.split()

    @pytest.mark.parametrize(
        ("word", "said"),
        [
            ("ni3", "N IY"), ("hǎo", "HH AW"), ("nǚ", "N XIY"), ("xué", "XC XIY EH"),
            ("qu4", "XTC XIY"), ("qi4", "XTC IY"), ("si4", "S XSI"), ("shi4", "XS XRI"),
            ("zhi1", "XCH XRI"), ("yuan2", "XIY EH N"), ("wo3", "W AO"), ("bo1", "B W AO"),
            ("ge4", "G XOW"), ("ri4", "XZ XRI"), ("er4", "ER"), ("shui3", "XS W EY"),
            ("wanr2", "W AA AXR"), ("shir4", "XS AXR"), ("huangr", "HH W AA AXR"),
            ("lue4", "L XIY EH"),
        ],
    )  # fmt: skip
    def test_phones_of_syllables(self, word: str, said: str) -> None:
        assert phones(word) == said

    @given(syllables)
    def test_tones_are_left_out(self, syllable: str) -> None:
        assert len({phones(syllable), *(phones(f"{syllable}{tone}") for tone in range(6))}) == 1


class TestText:
    def test_words_know_where_they_stand(self) -> None:
        said = CMN.normalize("Nǐ hǎo，wǒ shì “Wang2”。\n  zai4jian4!")
        assert [word.text for word in said] == ["nǐ", "hǎo", "wǒ", "shì", "wang2", "zai4jian4"]
        places = [(word.line, word.column) for word in said]
        assert places == [(1, 1), (1, 4), (1, 8), (1, 11), (1, 15), (2, 3)]
        assert said[1].written == "hǎo，"

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("ni3 hax", r"line 1, column 7: 'x' in 'hax' is no syllable of pinyin"),
            ("a\nni3hao3 xqa", r"line 2, column 9: 'xqa' is no syllable"),
            ("hello", r"column 3: 'llo' in 'hello' is no syllable .* write syllables"),
            ("你好\n 再の见", r"line 2, column 3: 'の' is neither Chinese characters nor pinyin"),
            ("你好 мир", r"column 4: 'мир' is neither .* choose the language of the text"),
            ("一嗧", r"column 2: '嗧' has no reading in the lexicon; write its pinyin"),
            ("ni3 3x", r"column 5: no syllable stands before '3'; write syllables such as"),
            ("ge6", r"column 3: '6' is no letter of pinyin"), ("...", "has no words"),
            ("", "has no words"), ("ma" * 400, "a word of 800 characters, more than 500"),
        ],
    )  # fmt: skip
    def test_what_is_not_pinyin_is_refused_in_one_line_with_its_place(
        self, text: str, message: str
    ) -> None:
        with pytest.raises(LipwrightError, match=message) as caught:
            CMN.normalize(text, "line.txt")
        assert str(caught.value).startswith("line.txt: ")
        assert "\n" not in str(caught.value)

    @given(st.text(alphabet="abeghinorsuvxzüǎ1234' :你,\n", max_size=12))
    def test_any_text_is_words_with_phones_or_one_clear_line(self, text: str) -> None:
        try:
            words = CMN.normalize(text)
        except LipwrightError as error:
            assert "\n" not in str(error)  # noqa: PT017  # text that is pinyin raises nothing
            return
        for word in words:
            assert CMN.pronounce(word.text)[0].phones
        assert all(CMN.pronounce_all(words))

    def test_the_users_words_go_first(self) -> None:
        own = Dictionary({"ok": (("OW", "K", "EY"),)})
        (word,) = CMN.normalize("OK!", dictionary=own)
        (way,) = CMN.pronounce(word.text, own)
        assert (way.phones, way.source) == (("OW", "K", "EY"), "dictionary")
        with pytest.raises(LipwrightError, match="'ок': 'о' is no letter of pinyin"):
            CMN.pronounce("ок")  # in Cyrillic letters
