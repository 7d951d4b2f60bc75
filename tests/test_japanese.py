"""Japanese in kana becomes the sounds of Tokyo, phone by phone."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.language import read_dictionary
from lipwright.language.base import SpokenWord
from lipwright.language.ipa import read_ipa
from lipwright.language.japanese import make
from lipwright.language.japanese.kana import MORAS, is_kana, sounds_of
from lipwright.phones import BILABIALS, PHONES

JAPANESE = make("ja")


def _phones(text: str) -> list[str]:
    words = JAPANESE.normalize(text)
    return [" ".join(ways[0].phones) for ways in JAPANESE.pronounce_all(words)]


# The example words of Wikipedia's key to its transcriptions, "Help:IPA/Japanese" (which follows
# Okada 1999 and Vance 2008), each with the sound that it stands for there.
@pytest.mark.parametrize(
    ("word", "romaji", "sounds", "sound"),
    [
        ("ばしょ", "basho", "b a ɕ o", "b"),
        ("ひと", "hito", "ç i t o", "ç"),
        ("した", "shita", "ɕ i t a", "ɕ"),
        ("いっしょ", "isshō", "i ɕ ɕ o", "ɕ"),
        ("どうも", "dōmo", "d oː m o", "d"),
        ("ずっと", "zutto", "dz ɯ t t o", "dz"),
        ("ぜんぜん", "zenzen", "dz e n dz e ɴ", "dz"),
        ("キッズ", "kizzu", "k i d dz ɯ", "dz"),
        ("あざ", "aza", "a z a", "z"),
        ("じぶん", "jibun", "dʑ i b ɯ ɴ", "dʑ"),
        ("じょじょ", "jojo", "dʑ o ʑ o", "ʑ"),
        ("エッジ", "ejji", "e d dʑ i", "dʑ"),
        ("みじかい", "mijikai", "m i ʑ i k a i", "ʑ"),
        ("ふじ", "fuji", "ɸ ɯ ʑ i", "ɸ"),
        ("がっこう", "gakkō", "ɡ a k k oː", "ɡ"),
        ("ぎんこう", "ginkō", "ɡ i ŋ k oː", "ŋ"),
        ("ほん", "hon", "h o ɴ", "h"),
        ("はは", "haha", "h a h a", "h"),
        ("やくしゃ", "yakusha", "j a k ɯ ɕ a", "j"),
        ("はっき", "hakki", "h a k k i", "k"),
        ("きょうかい", "kyōkai", "k j oː k a i", "k"),
        ("みかん", "mikan", "m i k a ɴ", "m"),
        ("せんぱい", "senpai", "s e m p a i", "m"),
        ("もんもん", "monmon", "m o m m o ɴ", "m"),
        ("なっとう", "nattō", "n a t t oː", "n"),
        ("かんたん", "kantan", "k a n t a ɴ", "n"),
        ("にわ", "niwa", "ɲ i w a", "ɲ"),
        ("こんにゃく", "konnyaku", "k o ɲ ɲ a k ɯ", "ɲ"),
        ("きんちょう", "kinchō", "k i ɲ tɕ oː", "ɲ"),
        ("りんご", "ringo", "ɾ i ŋ ɡ o", "ŋ"),
        ("なんきょく", "nankyoku", "n a ŋ k j o k ɯ", "ŋ"),
        ("にほん", "nihon", "ɲ i h o ɴ", "ɴ"),
        ("パン", "pan", "p a ɴ", "p"),
        ("たんぽぽ", "tanpopo", "t a m p o p o", "p"),
        ("はっぴょう", "happyō", "h a p p j oː", "p"),
        ("ろく", "roku", "ɾ o k ɯ", "ɾ"),
        ("そら", "sora", "s o ɾ a", "ɾ"),
        ("りょうり", "ryōri", "ɾ j oː ɾ i", "ɾ"),
        ("さっそう", "sassō", "s a s s oː", "s"),
        ("とって", "totte", "t o t t e", "t"),
        ("つなみ", "tsunami", "ts ɯ n a m i", "ts"),
        ("いっつい", "ittsui", "i t ts ɯ i", "ts"),
        ("ちかい", "chikai", "tɕ i k a i", "tɕ"),
        ("けっちゃく", "ketchaku", "k e t tɕ a k ɯ", "tɕ"),
        ("わさび", "wasabi", "w a s a b i", "w"),
        ("あつっ", "atsu'", "a ts ɯ ʔ", "ʔ"),
        ("える", "eru", "e ɾ ɯ", "e"),
        ("おに", "oni", "o ɲ i", "o"),
        ("うなぎ", "unagi", "ɯ n a ɡ i", "ɯ"),
        ("ひょうめい", "hyōmei", "ç oː m eː", "eː"),
        ("おじいさん", "ojiisan", "o ʑ iː s a ɴ", "iː"),
    ],
)
def test_sounds_of_the_key(word: str, romaji: str, sounds: str, sound: str) -> None:
    del romaji
    assert " ".join(sounds_of(word)) == sounds
    assert sound in sounds.split()


@pytest.mark.parametrize(
    ("text", "phones"),
    [
        ("こんにちは", "K AO N N IY XTC IY W AA"),
        ("ありがとう", "AA DX IY G AA T AO"),
        ("ふじさん", "F IX XC IY S AA NG"),
        ("つき", "XTS IX K IY"),
        ("しんぶん", "XC IY M B IX NG"),
        ("ぼくは", "B AO K IX W AA"),
        ("コーヒー", "K AO Y IY"),
        ("ありがとうございます", "AA DX IY G AA T AO G AO Z AA IY M AA S IX"),
    ],
)
def test_phones_of_words(text: str, phones: str) -> None:
    assert _phones(text) == [phones]


def test_hu_never_shuts_the_lips_and_u_never_rounds_them() -> None:
    for kana, sounds in MORAS.items():
        phones = [phone.phone for sound in sounds for phone in read_ipa(sound)]
        assert any(phone in BILABIALS for phone in phones) == any(s in "pbm" for s in sounds), kana
    assert not PHONES[read_ipa("ɯ")[0].phone].rounded


# Vance (2008), section 5.2: the nasal at the end of a syllable is made where the next sound is.
@pytest.mark.parametrize(
    ("words", "shut"),
    [
        ("さん ばい", True),
        ("さん まい", True),
        ("さん ぱい", True),
        ("さん かい", False),
        ("さん、まい", False),
        ("さん。 まい", False),
        ("さん にん", False),
        ("さん あい", False),
    ],
)
def test_n_before_lips_shuts_them_over_spaces_but_not_over_pauses(words: str, shut: bool) -> None:
    assert _phones(words)[0] == ("S AA M" if shut else _phones(words)[0])
    assert (_phones(words)[0][-1] == "M") == shut


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("わたし は", "wataɕi wa"),
        ("がっこう へ", "ɡakkoː e"),
        ("みず を", "mizɯ o"),
        ("わたしは", "wataɕiwa"),
        ("うちへ かえる", "ɯtɕie kaeɾɯ"),
        ("それでは", "soɾedewa"),
        ("こんばんは", "kombaɴwa"),
        ("ほんではありません", "hondewaːɾimaseɴ"),
        ("コーヒーは おいしい", "koːçiː wa oiɕiː"),
        ("ケーキをたべる", "keːki o tabeɾɯ"),
        ("はは", "haha"),
        ("ははは", "hahaha"),
        ("はな", "hana"),
        ("へや", "heja"),
        ("ハ", "ha"),
    ],
)
def test_particles_are_said_otherwise_than_written(text: str, said: str) -> None:
    words = JAPANESE.normalize(text)
    ways = JAPANESE.pronounce_all(words)
    assert " ".join("".join(way[0].ipa) for way in ways) == said


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("10", ["じゅう"]),
        ("300えん", ["さんびゃくえん"]),
        ("1,234", ["せんにひゃくさんじゅうよん"]),
        ("4じ 7じ 9じ", ["よじ", "しちじ", "くじ"]),
        ("10ぷん", ["じゅっぷん"]),
        ("1つ", ["ひとつ"]),
        ("2にん", ["ふたり"]),
        ("3.5", ["さんてんご"]),
        ("50%", ["ごじゅうパーセント"]),
        ("¥500", ["ごひゃくえん"]),
        ("007", ["ゼロゼロなな"]),
        ("10と 5", ["じゅうと", "ご"]),
        ("１２さい", ["じゅうにさい"]),
        ("8かい", ["はっかい"]),
        ("NHKの", ["エヌエイチケー", "の"]),
        ("ﾊﾟﾝﾀﾞ", ["パンダ"]),
        ("ねえ～", ["ねえー"]),
        ("「はい。」", ["はい"]),
        ("[laughs] はい", ["はい"]),
        ("はい😀！", ["はい"]),
    ],
)
def test_words_are_written_as_they_are_spoken(text: str, words: list[str]) -> None:
    assert [word.text for word in JAPANESE.normalize(text)] == words


def test_words_have_their_places() -> None:
    words = JAPANESE.normalize("はい、そうです。\n  パンを たべる")
    assert [(word.text, word.line, word.column) for word in words] == [
        ("はい", 1, 1), ("そうです", 1, 4), ("パン", 2, 3), ("を", 2, 3), ("たべる", 2, 7),
    ]  # fmt: skip


def test_words_in_latin_letters_are_english_among_kana() -> None:
    assert _phones("YouTubeで") == ["Y UW T Y UW B", "D EH"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "はい\nここに 敵が いる",
            r"a\.txt: line 2, column 5: '敵' is no kana, .* write the word in kana",
        ),
        ("人々", "'人' is no kana"),
        ("konnichiwa", "'konnichiwa' is in Latin letters; write Japanese in kana"),
        ("はい привет", "column 4: 'п' is no letter of Japanese"),
        ("", "has no words"),
        ("😀！", "has no words"),
        ("あ" * 100_000, "column 1: 100000 characters without a space"),
    ],
)
def test_what_is_not_kana_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(LipwrightError, match=message):
        JAPANESE.normalize(text, "a.txt")


def test_a_long_text_without_spaces_is_read() -> None:
    assert len(JAPANESE.normalize("はい、そうです。" * 5_000)) == 10_000


def test_the_users_dictionary_reads_characters(tmp_path: Path) -> None:
    path = tmp_path / "own.txt"
    path.write_text("敵 T EH K IY\n", encoding="utf-8")
    own = read_dictionary(path)
    words = JAPANESE.normalize("敵 です", dictionary=own)
    assert JAPANESE.pronounce_all(words, own)[0][0].phones == ("T", "EH", "K", "IY")


def test_a_word_that_is_not_kana_cannot_be_said() -> None:
    for word in ("敵", "", "ー"):
        with pytest.raises(LipwrightError):
            JAPANESE.pronounce(word)


def test_every_kana_has_sounds_and_every_sound_is_in_the_inventory() -> None:
    letters = {chr(point) for point in (*range(0x3041, 0x3097), *range(0x30A1, 0x30F7))}
    assert all(map(is_kana, letters))
    known = {row.ipa for row in JAPANESE.inventory()}
    for letter in letters:
        assert {*sounds_of(letter)} <= known, letter
    for sounds in MORAS.values():
        assert {*sounds} <= known
    for row in JAPANESE.inventory():
        assert row.phones
        assert {*row.phones} <= {*PHONES}


@given(st.lists(st.sampled_from([*MORAS, "ん", "っ", "ー"]), min_size=1, max_size=12).map("".join))
def test_any_kana_can_be_said_and_katakana_sounds_the_same(word: str) -> None:
    katakana = "".join(chr(ord(char) + 0x60) if char != "ー" else char for char in word)
    assert sounds_of(katakana) == sounds_of(word)
    if sounds_of(word):
        (way,) = JAPANESE.pronounce_all([SpokenWord(word, word, 1, 1)])[0]
        assert len(way.ipa) == len(way.phones)
