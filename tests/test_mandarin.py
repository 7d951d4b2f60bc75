"""Mandarin: pinyin and characters, however they are written, to phones and sounds we know."""

from __future__ import annotations

import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pypinyin.constants import PHRASES_DICT, PINYIN_DICT

from lipwright.errors import LipwrightError
from lipwright.language import Dictionary, get_language
from lipwright.language.ipa import read_ipa
from lipwright.language.mandarin.characters import segment, simplify
from lipwright.language.mandarin.numbers import cardinal
from lipwright.language.mandarin.pinyin import syllables_of
from lipwright.language.mandarin.polyphones import CONTEXTS, PHRASES, POLYPHONES
from lipwright.language.mandarin.syllables import (
    INITIAL_IPA,
    INITIALS,
    INTERJECTIONS,
    SYLLABLES,
    is_syllable,
    syllable_phones,
    syllable_sounds,
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


# Characters, their pinyin as the "Xiandai Hanyu Cidian" has it, and the phones.
WORDS = [
    # one reading
    ("你好", "nǐ hǎo", "N IY HH AW"), ("中国", "zhōng guó", "XCH UH NG G W AO"),
    ("北京", "běi jīng", "B EY XTC IY NG"), ("朋友", "péng you", "P AX NG Y OW"),
    ("谢谢", "xiè xie", "XC Y EH XC Y EH"), ("再见", "zài jiàn", "XTS AY XTC Y EH N"),
    ("女儿", "nǚ ér", "N XIY ER"), ("旅行", "lǚ xíng", "L XIY XC IY NG"),
    ("雨", "yǔ", "XIY"), ("去", "qù", "XTC XIY"), ("学生", "xué sheng", "XC XIY EH XS AX NG"),
    ("月亮", "yuè liang", "XIY EH L Y AA NG"), ("全", "quán", "XTC XIY EH N"),
    ("云", "yún", "XIY N"), ("熊", "xióng", "XC XIY UH NG"), ("四", "sì", "S XSI"),
    ("是", "shì", "XS XRI"), ("日", "rì", "XZ XRI"), ("二", "èr", "ER"), ("水", "shuǐ", "XS W EY"),
    ("春天", "chūn tiān", "XCH W AX N T Y EH N"), ("爸爸", "bà ba", "B AA B AA"),
    ("妈妈", "mā ma", "M AA M AA"), ("苹果", "píng guǒ", "P IY NG G W AO"),
    ("哥哥", "gē ge", "G XOW G XOW"), ("波", "bō", "B W AO"), ("翁", "wēng", "W AX NG"),
    # several, by the word
    ("银行", "yín háng", "IY N HH AA NG"), ("行走", "xíng zǒu", "XC IY NG XTS OW"),
    ("长大", "zhǎng dà", "XCH AA NG D AA"), ("长江", "cháng jiāng", "XCH AA NG XTC Y AA NG"),
    ("了解", "liǎo jiě", "L Y AW XTC Y EH"), ("受不了", "shòu bù liǎo", "XS OW B UW L Y AW"),
    ("睡着", "shuì zháo", "XS W EY XCH AW"), ("着急", "zháo jí", "XCH AW XTC IY"),
    ("着装", "zhuó zhuāng", "XCH W AO XCH W AA NG"), ("觉得", "jué de", "XTC XIY EH D XOW"),
    ("睡觉", "shuì jiào", "XS W EY XTC Y AW"), ("音乐", "yīn yuè", "IY N XIY EH"),
    ("快乐", "kuài lè", "K W AY L XOW"), ("重庆", "chóng qìng", "XCH UH NG XTC IY NG"),
    ("重要", "zhòng yào", "XCH UH NG Y AW"), ("成都", "chéng dū", "XCH AX NG D UW"),
    ("都是", "dōu shì", "D OW XS XRI"), ("还有", "hái yǒu", "HH AY Y OW"),
    ("还钱", "huán qián", "HH W AA N XTC Y EH N"), ("会计", "kuài jì", "K W AY XTC IY"),
    ("开会", "kāi huì", "K AY HH W EY"), ("便宜", "pián yi", "P Y EH N IY"),
    ("方便", "fāng biàn", "F AA NG B Y EH N"), ("角色", "jué sè", "XTC XIY EH S XOW"),
    ("效率", "xiào lǜ", "XC Y AW L XIY"), ("率领", "shuài lǐng", "XS W AY L IY NG"),
    ("西藏", "xī zàng", "XC IY XTS AA NG"), ("躲藏", "duǒ cáng", "D W AO XTS AA NG"),
    ("人参", "rén shēn", "XZ AX N XS AX N"), ("参加", "cān jiā", "XTS AA N XTC Y AA"),
    ("投降", "tóu xiáng", "T OW XC Y AA NG"), ("地方", "dì fāng", "D IY F AA NG"),
    ("校对", "jiào duì", "XTC Y AW D W EY"), ("弹琴", "tán qín", "T AA N XTC IY N"),
    ("谁", "shéi", "XS EY"), ("什么", "shén me", "XS AX N M XOW"), ("血", "xiě", "XC Y EH"),
    ("大夫", "dài fu", "D AY F UW"), ("似的", "shì de", "XS XRI D XOW"),
    # erhua
    ("花儿", "huār", "HH W AA AXR"), ("玩儿", "wánr", "W AA AXR"), ("这儿", "zhèr", "XCH XOW AXR"),
    ("一会儿", "yí huìr", "IY HH W AXR"), ("一点儿", "yì diǎnr", "IY D Y AA AXR"),
    ("儿子", "ér zi", "ER XTS XSI"), ("哥儿们", "gēr men", "G XOW AXR M AX N"),
    ("幼儿园", "yòu ér yuán", "Y OW ER XIY EH N"),
    # traditional
    ("銀行", "yín háng", "IY N HH AA NG"), ("長大", "zhǎng dà", "XCH AA NG D AA"),
    ("音樂", "yīn yuè", "IY N XIY EH"), ("重複", "chóng fù", "XCH UH NG F UW"),
    ("還錢", "huán qián", "HH W AA N XTC Y EH N"), ("睡覺", "shuì jiào", "XS W EY XTC Y AW"),
    ("為什麼", "wèi shén me", "W EY XS AX N M XOW"), ("頭髮", "tóu fa", "T OW F AA"),
]  # fmt: skip

# Sentences and their pinyin. The first seven are the passage of Lee and Zee (2003), "The north
# wind and the sun".
SENTENCES = [
    ("有一回，北风跟太阳正在那儿争论谁的本领大。",
     "yǒu yì huí běi fēng gēn tài yáng zhèng zài nàr zhēng lùn shéi de běn lǐng dà"),
    ("说着说着，来了一个过路的，身上穿了一件厚袍子。",
     "shuō zhe shuō zhe lái le yí ge guò lù de shēn shang chuān le yí jiàn hòu páo zi"),
    ("他们俩就商量好了，说，谁能先叫这个过路的把他的袍子脱下来，就算是他的本领大。",
     "tā men liǎ jiù shāng liang hǎo le shuō shéi néng xiān jiào zhè ge guò lù de bǎ tā de páo zi "
     "tuō xià lai jiù suàn shì tā de běn lǐng dà"),
    ("北风就使劲吹起来，拼命地吹。", "běi fēng jiù shǐ jìn chuī qǐ lai pīn mìng de chuī"),
    ("可是，他吹得越厉害，那个人就把他的袍子裹得越紧。",
     "kě shì tā chuī de yuè lì hai nà ge rén jiù bǎ tā de páo zi guǒ de yuè jǐn"),
    ("一会儿，太阳出来一晒，那个人马上就把袍子脱了下来。",
     "yí huìr tài yáng chū lai yí shài nà ge rén mǎ shàng jiù bǎ páo zi tuō le xià lai"),
    ("所以，北风不得不承认，还是太阳比他的本领大。",
     "suǒ yǐ běi fēng bù dé bù chéng rèn hái shi tài yáng bǐ tā de běn lǐng dà"),
    ("我得走了，你得好好学习。", "wǒ děi zǒu le nǐ děi hǎo hǎo xué xí"),
    ("他慢慢地走，跑得很快，头发很长。",
     "tā màn màn de zǒu pǎo de hěn kuài tóu fa hěn cháng"),
    ("他把钱还给了我，我还没睡着呢。", "tā bǎ qián huán gěi le wǒ wǒ hái méi shuì zháo ne"),
    ("請問，銀行怎麼走？我看著你。", "qǐng wèn yín háng zěn me zǒu wǒ kàn zhe nǐ"),
    ("小王在银行工作，行不行？", "xiǎo wáng zài yín háng gōng zuò xíng bu xíng"),
    ("我还了信用卡，这件事情得马上处理，明天得参加会议。",
     "wǒ huán le xìn yòng kǎ zhè jiàn shì qing děi mǎ shàng chǔ lǐ míng tiān děi cān jiā huì yì"),
    ("我调了一下音量，屏幕上出现了一行字。",
     "wǒ tiáo le yí xià yīn liàng píng mù shàng chū xiàn le yì háng zì"),
    ("他长得很高，是我们公司的董事长。",
     "tā zhǎng de hěn gāo shì wǒ men gōng sī de dǒng shì zhǎng"),
    ("孩子们高兴地跳着舞，模型的准确率提高了。",
     "hái zi men gāo xìng de tiào zhe wǔ mó xíng de zhǔn què lǜ tí gāo le"),
    ("臺灣的銀行還沒有開門，她的頭髮長得很長。",
     "tái wān de yín háng hái méi yǒu kāi mén tā de tóu fa zhǎng de hěn cháng"),
    ("地上有一个角，重新来。", "dì shàng yǒu yí ge jiǎo chóng xīn lái"),
]  # fmt: skip

# As written, and as spoken.
NUMBERS = [
    ("0 7 10 15 20 99", "零 七 十 十五 二十 九十九"), ("101 110 200", "一百零一 一百一十 二百"),
    ("1001 1010 2000 2222", "一千零一 一千零一十 两千 两千二百二十二"),
    ("10086 20012 100000", "一万零八十六 两万零一十二 十万"),
    ("1,234,567", "一百二十三万四千五百六十七"), ("100000001", "幺 零 零 零 零 零 零 零 幺"),
    ("2亿 3.5万", "两 亿 三点五 万"), ("007", "零零七"),
    ("３．１４ 0.5", "三点一四 零点五"), ("-5", "负 五"),
    ("2024年11月22日", "二零二四 年 十一 月 二十二 日"), ("1949-10-01", "一九四九 年 十 月 一 日"),
    ("2024/2/2", "二零二四 年 二 月 二 日"), ("1990-2000年", "一九九零 到 二零零零 年"),
    ("98年 08年 20年", "九八 年 零八 年 二十 年"),
    ("10:30 9:05 14:00 2:00", "十 点 三十 分 九 点 零五 分 十四 点 两 点"),
    ("10：30：05", "十 点 三十 分 五 秒"), ("3:2", "三 比 二"),
    ("50% 3.5％ 5%-10%", "百分之 五十 百分之 三点五 百分之 五 到 百分之 十"),
    ("¥100 ￥5.50 $3.5 €20", "一百 元 五 元 五 角 三点五 美元 二十 欧元"),
    ("¥2万 2000元", "两万 元 两千 元"), ("3/4 ½ 2½", "四 分之 三 二 分之 一 二 又 二 分之 一"),
    ("第2天 2天 2月 2号", "第 二 天 两 天 二 月 二 号"), ("2个 12个 2位", "两 个 十二 个 两 位"),
    ("2年级 2年 2点半", "二 年 级 两 年 两 点 半"), ("5kg 2 km 30℃", "五 公斤 两 公里 三十 摄氏度"),
    ("-5℃ 100㎡", "零下 五 摄氏度 一百 平方米"), ("5-10个", "五 到 十 个"),
    ("13812345678", "幺 三 八 幺 二 三 四 五 六 七 八"),
    ("拨打110", "拨 打 幺 幺 零"), ("010-12345678", "零 幺 零 幺 二 三 四 五 六 七 八"),
    ("1.2.3", "一 点 二 点 三"), ("A4纸 MP3 5G AI", "a 四 纸 m p 三 五 g a i"),
    ("R&B A+B=C", "r and b a 加 b 等于 c"),
]  # fmt: skip


def phones_of(pinyin: str) -> str:
    """The phones of syllables of pinyin with white space between them."""
    return " ".join(phone for word in pinyin.split() for phone in CMN.pronounce(word)[0].phones)


def said(text: str) -> str:
    """The phones of a text, as one text: the first way of each word."""
    ways = CMN.pronounce_all(CMN.normalize(text))
    return " ".join(phone for way in ways for phone in way[0].phones)


class TestCharacters:
    @pytest.mark.parametrize(("word", "pinyin", "expected"), WORDS, ids=[row[0] for row in WORDS])
    def test_words_are_read_as_the_dictionary_reads_them(
        self, word: str, pinyin: str, expected: str
    ) -> None:
        assert phones_of(pinyin) == expected
        assert said(word) == expected

    @pytest.mark.parametrize(("text", "pinyin"), SENTENCES, ids=[row[0][:8] for row in SENTENCES])
    def test_sentences_are_read_as_their_pinyin(self, text: str, pinyin: str) -> None:
        assert said(text) == phones_of(pinyin)

    @pytest.mark.parametrize(("text", "expected"), NUMBERS, ids=[row[0] for row in NUMBERS])
    def test_numbers_are_written_out_as_they_are_spoken(self, text: str, expected: str) -> None:
        words = CMN.normalize(f"{text}\n好")  # with a character, so that letters are not pinyin
        assert [word.text for word in words[:-1]] == expected.split()
        assert all(CMN.pronounce_all(words))

    @given(st.integers(0, 10**16 - 1))
    def test_a_number_can_be_read_back(self, number: int) -> None:
        assert number_of(cardinal(number)) == number

    def test_words_stay_in_characters_and_know_where_they_stand(self) -> None:
        words = CMN.normalize("“你好”，中国！\n 2个nǐhǎo，Bye")
        assert [(w.text, w.written, w.line, w.column) for w in words] == [
            ("你好", "你好”，", 1, 2), ("中国", "中国！", 1, 6), ("两", "2", 2, 2),
            ("个", "个", 2, 3), ("nǐhǎo", "nǐhǎo，", 2, 4), ("bye", "Bye", 2, 10),
        ]  # fmt: skip

    def test_words_end_where_fewest_characters_stand_alone(self) -> None:
        assert segment("南京长江大桥") == ["南京", "长江大桥"]
        assert segment("北风就使劲吹") == ["北风", "就", "使劲", "吹"]

    def test_latin_words_are_english_beside_characters_and_pinyin_with_tones(self) -> None:
        words = CMN.normalize("我can说hello，nǐhǎo，hao3")
        ways = [way[0] for way in CMN.pronounce_all(words)]
        assert [way.phones for way in ways[1:]] == [
            ("K", "AE", "N"), ("XS", "W", "AO"), ("HH", "AH", "L", "OW"),
            ("N", "IY", "HH", "AW"), ("HH", "AW"),
        ]  # fmt: skip

    def test_the_users_words_are_found_among_characters(self) -> None:
        own = Dictionary({"行长": (("HH", "AA", "NG", "XCH", "AA", "NG"),)})
        words = CMN.normalize("他是行长了", dictionary=own)
        assert [word.text for word in words] == ["他", "是", "行长", "了"]
        assert CMN.pronounce_all(words, own)[2][0].source == "dictionary"

    def test_what_is_not_said_is_left_out(self) -> None:
        words = CMN.normalize("你[笑]好\u200b😀吗\ufe0f？<b>对</b>")
        assert [word.text for word in words] == ["你", "好", "吗", "对"]

    def test_a_hundred_thousand_characters_are_read(self) -> None:
        text = "".join(row[0] for row in SENTENCES) * 410
        words = CMN.normalize(text[:100_000])
        assert len(CMN.pronounce_all(words)) == len(words) > 50_000

    @given(st.text(alphabet="你好行长得着了还儿一二0123.%¥-:/年月 aA,。\n", max_size=20))
    def test_any_mixed_text_is_words_with_phones_or_one_clear_line(self, text: str) -> None:
        try:
            words = CMN.normalize(text)
        except LipwrightError as error:
            assert "\n" not in str(error)  # noqa: PT017  # text that is Mandarin raises nothing
            return
        assert all(CMN.pronounce_all(words))
        for word in words:
            assert CMN.pronounce(word.text)


class TestSounds:
    @pytest.mark.parametrize(
        ("word", "sounds"),
        [
            ("ba1", "p a"), ("pa1", "pʰ a"), ("ji1", "t͡ɕ i"), ("qi1", "t͡ɕʰ i"),
            ("zhi1", "ʈ͡ʂ ʅ"), ("chi1", "ʈ͡ʂʰ ʅ"), ("zi1", "t͡s ɿ"), ("ci1", "t͡sʰ ɿ"),
            ("he1", "x ɤ"), ("shuo1", "ʂ w o"), ("xian1", "ɕ j ɛ n"), ("yuan2", "ɥ ɛ n"),
            ("lü4", "l y"), ("er4", "ɚ"), ("wanr2", "w a ɚ"), ("zhong1", "ʈ͡ʂ ʊ ŋ"),
        ],
    )  # fmt: skip
    def test_aspiration_is_kept_beside_phones_that_look_alike(self, word: str, sounds: str) -> None:
        (way,) = CMN.pronounce(word)
        assert way.ipa == tuple(sounds.split())

    def test_the_inventory_has_every_sound_and_final_of_every_syllable(self) -> None:
        rows = {(row.ipa, row.phones) for row in CMN.inventory()}
        for syllable in [*SYLLABLES, *(f"{s}r" for s in SYLLABLES), *INTERJECTIONS]:
            shown, sounds = syllable_sounds(syllable)
            singles = zip(sounds, shown, strict=True)
            assert {(sound, (phone,)) for sound, phone in singles} <= rows
            initial = sounds[0] in INITIAL_IPA.values() and sounds[0] not in "mnŋ"
            if syllable in SYLLABLES:
                final = ("".join(sounds[1:]), shown[1:]) if initial else None
                assert final is None or final in rows
        examples = [row.example for row in CMN.inventory()]
        assert all(any(char.isupper() for char in example) for example in examples)

    def test_each_sound_of_the_inventory_looks_like_its_phone(self) -> None:
        unvoiced = {"B": "P", "D": "T", "G": "K"}  # b is p without breath
        for row in CMN.inventory():
            if len(row.phones) == 1 and row.ipa not in ("ai", "ei", "au", "ou", "x", "j", "ɚ", "o"):
                (sound,) = read_ipa(row.ipa)
                assert sound.phone == unvoiced.get(row.phones[0], row.phones[0]), row

    def test_the_page_has_every_initial_and_final(self) -> None:
        page = (Path(__file__).parents[1] / "docs" / "mandarin.md").read_text(encoding="utf-8")
        rows = {tuple(row.strip("| ").split(" | ")[:3]) for row in page.split("\n") if "|" in row}
        for initial, phone in INITIALS.items():
            assert (initial, INITIAL_IPA[initial], phone) in rows
        finals = {(row[1], row[2]) for row in rows if len(row) == 3}
        several = {(row.ipa, " ".join(row.phones)) for row in CMN.inventory() if row.phones[1:]}
        assert several - finals == {("wʊŋ", "W UH NG")}  # wong: one rare character


class TestLexicon:
    def test_every_reading_of_the_lexicon_is_one_syllable(self) -> None:
        alone = {reading for row in PINYIN_DICT.values() for reading in row.split(",")}
        in_phrases = {s for phrase in PHRASES_DICT.values() for way in phrase for s in way}
        for reading in alone | in_phrases:
            assert len(syllables_of(reading)) == 1

    def test_readings_of_polyphones_look_different_and_the_lexicon_has_them(self) -> None:
        for char, row in POLYPHONES.items():
            ways = row.split()
            assert all(is_syllable(way) or way in INTERJECTIONS for way in ways), char
            assert len({syllable_sounds(way) for way in ways}) == len(ways), char
        known = [
            (char, way) for char, row in POLYPHONES.items() for way in row.split()
            if way not in {s for r in PINYIN_DICT[ord(char)].split(",") for s in syllables_of(r)}
        ]  # fmt: skip
        # How 嗯 and 诶 are heard, and the digit of telephone numbers, which some say as yi.
        assert known == [("嗯", "en"), ("诶", "ê"), ("幺", "yi")]

    def test_phrases_of_ours_have_a_syllable_for_each_character(self) -> None:
        for phrase, row in PHRASES.items():
            assert len(row.split()) == len(phrase)
            assert all(map(is_syllable, row.split()))
            lexicon = PHRASES_DICT.get(phrase, [])
            assert row != " ".join(syllables_of(ways[0])[0] for ways in lexicon)

    def test_contexts_choose_among_the_readings(self) -> None:
        for char, _, _, reading in CONTEXTS:
            assert reading in POLYPHONES[char].split(), char

    def test_simplified_characters_are_one_for_one_and_stay(self) -> None:
        text = "銀長還麼過說"
        assert simplify(text) == "银长还么过说"
        assert simplify(simplify(text)) == simplify(text)


def number_of(said: str) -> int:
    """The number that characters say; the other way round from `cardinal`."""
    for unit, value in (("亿", 10**8), ("万", 10**4), ("千", 1000), ("百", 100), ("十", 10)):
        above, found, below = said.rpartition(unit) if unit == "亿" else said.partition(unit)
        if found:
            return (number_of(above) if above else 1) * value + number_of(below)
    digits = "零一二三四五六七八九"
    return int("".join(str(digits.index("二" if c == "两" else c)) for c in said) or 0)
