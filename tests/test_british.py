"""British English: Wells's keywords, links between words, dates; a closed set of sounds."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.language import Dictionary, get_language
from lipwright.language.base import Pronunciation
from lipwright.language.english.received import (
    ALSO,
    LETTERS,
    WEAK,
    BritishLexicon,
    from_american,
    read_said,
)
from lipwright.language.pace import spoken_track
from lipwright.phones import PHONES

GB = get_language("en-gb")
US = get_language("en")

# The keywords of Wells, "Accents of English" (1982), section 2.2, and words that the "Longman
# Pronunciation Dictionary" (2008) says otherwise than Americans do; received pronunciation.
WORDS = [
    # the standard lexical sets
    ("kit", "k ɪ t", "K IH T"), ("dress", "d ɹ ɛ s", "D R EH S"), ("trap", "t ɹ æ p", "T R AE P"),
    ("lot", "l ɒ t", "L AO T"), ("strut", "s t ɹ ʌ t", "S T R AH T"), ("foot", "f ʊ t", "F UH T"),
    ("bath", "b ɑː θ", "B AA TH"), ("cloth", "k l ɒ θ", "K L AO TH"), ("nurse", "n ɜː s", "N ER S"),
    ("fleece", "f l iː s", "F L IY S"), ("face", "f eɪ s", "F EY S"), ("palm", "p ɑː m", "P AA M"),
    ("thought", "θ ɔː t", "TH AO T"), ("goat", "ɡ əʊ t", "G OW T"), ("goose", "ɡ uː s", "G UW S"),
    ("price", "p ɹ aɪ s", "P R AY S"), ("choice", "t͡ʃ ɔɪ s", "CH OY S"),
    ("mouth", "m aʊ θ", "M AW TH"), ("near", "n ɪ ə", "N IH AX"),
    ("square", "s k w ɛː", "S K W EH"), ("start", "s t ɑː t", "S T AA T"),
    ("north", "n ɔː θ", "N AO TH"), ("force", "f ɔː s", "F AO S"), ("cure", "k j ʊ ə", "K Y UH AX"),
    ("happy", "h æ p i", "HH AE P IY"), ("letter", "l ɛ t ə", "L EH T AX"),
    ("comma", "k ɒ m ə", "K AO M AX"),
    # BATH
    ("dance", "d ɑː n s", "D AA N S"), ("laugh", "l ɑː f", "L AA F"), ("ask", "ɑː s k", "AA S K"),
    ("class", "k l ɑː s", "K L AA S"), ("after", "ɑː f t ə", "AA F T AX"),
    ("can't", "k ɑː n t", "K AA N T"), ("aunt", "ɑː n t", "AA N T"),
    # LOT is round, PALM is not
    ("bother", "b ɒ ð ə", "B AO DH AX"), ("father", "f ɑː ð ə", "F AA DH AX"),
    ("hot", "h ɒ t", "HH AO T"), ("what", "w ɒ t", "W AO T"), ("sorry", "s ɒ ɹ i", "S AO R IY"),
    # no r, no flap
    ("water", "w ɔː t ə", "W AO T AX"), ("better", "b ɛ t ə", "B EH T AX"),
    ("city", "s ɪ t i", "S IH T IY"), ("car", "k ɑː", "K AA"), ("four", "f ɔː", "F AO"),
    ("hair", "h ɛː", "HH EH"), ("here", "h ɪ ə", "HH IH AX"), ("bird", "b ɜː d", "B ER D"),
    ("very", "v ɛ ɹ i", "V EH R IY"), ("hurry", "h ʌ ɹ i", "HH AH R IY"),
    ("fire", "f aɪ ə", "F AY AX"), ("power", "p aʊ ə", "P AW AX"),
    ("idea", "aɪ d ɪ ə", "AY D IH AX"),
    # y behind t, d, n
    ("new", "n j uː", "N Y UW"), ("tune", "t j uː n", "T Y UW N"), ("due", "d j uː", "D Y UW"),
    # words by themselves
    ("schedule", "ʃ ɛ d j uː l", "SH EH D Y UW L"), ("tomato", "t ə m ɑː t əʊ", "T AX M AA T OW"),
    ("vase", "v ɑː z", "V AA Z"), ("lieutenant", "l ɛ f t ɛ n ə n t", "L EH F T EH N AX N T"),
    ("z", "z ɛ d", "Z EH D"), ("zed", "z ɛ d", "Z EH D"), ("leisure", "l ɛ ʒ ə", "L EH ZH AX"),
    ("privacy", "p ɹ ɪ v ə s i", "P R IH V AX S IY"), ("missile", "m ɪ s aɪ l", "M IH S AY L"),
    ("clerk", "k l ɑː k", "K L AA K"), ("derby", "d ɑː b i", "D AA B IY"),
    ("herb", "h ɜː b", "HH ER B"), ("route", "ɹ uː t", "R UW T"), ("shone", "ʃ ɒ n", "SH AO N"),
    ("vitamin", "v ɪ t ə m ɪ n", "V IH T AX M IH N"), ("ballet", "b æ l eɪ", "B AE L EY"),
    ("process", "p ɹ əʊ s ɛ s", "P R OW S EH S"), ("theatre", "θ ɪ ə t ə", "TH IH AX T AX"),
]  # fmt: skip


def said(text: str) -> str:
    """The sounds of a text in IPA: the first way of each word."""
    ways = GB.pronounce_all(GB.normalize(text))
    return " ".join("".join(way[0].ipa) for way in ways)


def spoken(text: str) -> str:
    """The words of a text as they are spoken."""
    return " ".join(word.text for word in GB.normalize(text))


class TestWords:
    @pytest.mark.parametrize(("word", "ipa", "phones"), WORDS, ids=[row[0] for row in WORDS])
    def test_words_are_said_as_dictionaries_of_received_pronunciation_say_them(
        self, word: str, ipa: str, phones: str
    ) -> None:
        first = GB.pronounce(word)[0]
        assert (" ".join(first.ipa), " ".join(first.phones)) == (ipa, phones)
        assert first.source == "lexicon"

    def test_lot_is_round_and_bath_is_not(self) -> None:
        (lot,), (bath,) = GB.pronounce("lot"), GB.pronounce("bath")
        assert PHONES[lot.phones[1]].rounded
        assert not PHONES[bath.phones[1]].rounded

    def test_stress_stands_on_vowels(self) -> None:
        (way,) = GB.pronounce("tomato")
        assert way.stress == (None, 0, None, 1, None, 0)
        for word, *_ in WORDS:
            for way in GB.pronounce(word):
                vowels = [PHONES[phone].is_vowel for phone in way.phones]
                assert [mark is not None for mark in way.stress] in (vowels, [])

    def test_every_letter_has_its_name(self) -> None:
        assert sorted(LETTERS) == list("abcdefghijklmnopqrstuvwxyz")
        assert [way.ipa for way in GB.pronounce("h")] == [("eɪ", "t͡ʃ"), ("h", "eɪ", "t͡ʃ")]
        assert ("eɪ",) in [way.ipa for way in GB.pronounce("a")]

    @pytest.mark.parametrize(
        ("word", "ipa"),
        [("melvin's", "m ɛ l v ɪ n z"), ("bath's", "b ɑː θ s"), ("vase's", "v ɑː z ɪ z"),
         ("he'll", "h iː l"), ("car'll", "k ɑː ə l")],
    )  # fmt: skip
    def test_endings_are_said_behind_any_word(self, word: str, ipa: str) -> None:
        assert ipa in [" ".join(way.ipa) for way in GB.pronounce(word)]

    def test_words_that_the_lexicon_lacks_are_american_ones_by_rule(self) -> None:
        (first, *_) = GB.pronounce("zorgleforth")
        assert first.source in ("g2p", "rule")
        assert GB.pronounce("hackworth")[0].source == "rule"

    @pytest.mark.parametrize(
        ("word", "american", "british"),
        [
            ("car", "K AA R", "K AA"), ("carry", "K AE R IY", "K AE R IY"),
            ("bird", "B ER D", "B ER D"), ("letter", "L EH T ER", "L EH T AX"),
            ("hurray", "HH ER EY", "HH ER R EY"), ("door", "D AO R", "D AO"),
            ("near", "N IH R", "N IH AX"), ("square", "S K W EH R", "S K W EH"),
            ("lot", "L AA T", "L AO T"), ("spa", "S P AA", "S P AA"), ("go", "G OW", "G OW"),
            ("cure", "K Y UH R", "K Y UH AX"), ("hero", "HH IH R OW", "HH IH R OW"),
        ],
    )  # fmt: skip
    def test_the_rule_drops_r_and_rounds_lot(self, word: str, american: str, british: str) -> None:
        sounds = from_american(word, tuple(american.split()))
        assert " ".join(phone for phone, _, _ in sounds) == british

    def test_the_users_words_go_first(self) -> None:
        own = Dictionary({"bath": (("B", "AE", "TH"),)})
        assert GB.pronounce("bath", own) == (Pronunciation(("B", "AE", "TH"), "dictionary"),)
        assert GB.pronounce("bath's", own)[0].phones == ("B", "AE", "TH", "S")
        words = GB.normalize("a bath", dictionary=own)
        assert GB.pronounce_all(words, own)[1][0].source == "dictionary"


class TestSentences:
    @pytest.mark.parametrize(
        ("text", "ipa"),
        [
            ("far away", "fɑːɹ əweɪ"), ("far, away", "fɑː əweɪ"), ("far behind", "fɑː bɪhaɪnd"),
            ("here and there", "hɪəɹ ən ðɛː"), ("the idea of it", "ði aɪdɪə əv ɪt"),
            ("the end of the day", "ði ɛnd əv ðə deɪ"), ("to eat", "tu iːt"), ("to go", "tə ɡəʊ"),
            ("more or less", "mɔːɹ ɔː lɛs"), ("What is it for?", "wɒt ɪz ɪt fɔː"),
            ("a cup for us all", "ə kʌp fəɹ əs ɔːl"), ("law and order", "lɔː ənd ɔːdə"),
        ],
    )  # fmt: skip
    def test_words_link_and_weaken_where_they_stand(self, text: str, ipa: str) -> None:
        ours = said(text)
        if text == "law and order":  # no r is written, so none is said
            assert "ɹ" not in ours
        else:
            assert ours == ipa

    def test_a_text_without_sound_is_paced_with_its_links(self) -> None:
        assert spoken_track("Far away.", "en-gb").phones[1:4] == ("F", "AA", "R")
        assert spoken_track("Far, away.", "en-gb").phones[1:4] == ("F", "AA", "sil")

    def test_a_linked_word_may_be_said_without_its_link(self) -> None:
        far, _ = GB.pronounce_all(GB.normalize("far away"))
        assert [way.phones for way in far] == [("F", "AA", "R"), ("F", "AA")]

    @pytest.mark.parametrize(
        ("written", "words"),
        [
            ("22/11/2024", "the twenty second of november twenty twenty four"),
            ("05.06.1999", "the fifth of june nineteen ninety nine"),
            ("1/2/24", "the first of february twenty twenty four"),
            ("2024-11-22", "the twenty second of november twenty twenty four"),
            ("22 November 2024", "the twenty second of november twenty twenty four"),
            ("on 5th May", "on the fifth of may"), ("May 5th", "may the fifth"),
            ("3 Sept. 1939", "the third of september nineteen thirty nine"),
            ("1/2 a pint", "one half a pint"), ("I may 5", "i may five"),
            ("£5.50", "five pounds and fifty pence"), ("£1", "one pound"),
            ("205", "two hundred and five"), ("1,001 nights", "one thousand and one nights"),
            ("1,234,567", "one million two hundred and thirty four thousand five hundred and "
             "sixty seven"),
            ("100 metres", "one hundred metres"), ("in 1905", "in nineteen oh five"),
            ("in 2007", "in two thousand and seven"),
            ("120,000", "one hundred and twenty thousand"),
            ("the 101st", "the one hundred and first"), ("Dr. Smith", "doctor smith"),
        ],
    )  # fmt: skip
    def test_dates_and_numbers_are_read_as_the_british_read_them(
        self, written: str, words: str
    ) -> None:
        assert spoken(written) == words

    def test_other_scripts_are_refused_with_their_place(self) -> None:
        with pytest.raises(LipwrightError, match=r"^t\.txt: line 2, column 3: '你好'"):
            GB.normalize("ok\n, 你好", "t.txt")

    @given(st.text(alphabet="aeirstRN .,'5/£-", max_size=20))
    def test_any_text_can_be_said_or_is_refused_in_one_line(self, text: str) -> None:
        try:
            words = GB.normalize(text)
        except LipwrightError as error:
            assert "\n" not in str(error)  # noqa: PT017  # text with words raises nothing
            return
        assert all(GB.pronounce_all(words))


class TestInventory:
    def test_every_sound_of_the_lexicon_is_in_the_inventory(self) -> None:
        rows = {(row.ipa, row.phones[0]) for row in GB.inventory()}
        entries = [*LETTERS.values(), *(way for row in WEAK.values() for way in row.split())]
        lexicon = BritishLexicon()
        for table in (lexicon._first, lexicon._second):
            for entry in table.values():
                entries += (
                    [entry] if isinstance(entry, str) else [way for way in entry.values() if way]
                )
        seen = {
            (ipa, phone)
            for entry in [*entries, *ALSO.values()]
            for phone, ipa, _ in read_said(entry)
        }
        assert seen == rows

    def test_rules_say_nothing_else(self) -> None:
        rows = {row.phones[0] for row in GB.inventory()}
        for phone in (row.phones[0] for row in US.inventory()):
            for around in ((phone,), (phone, "R"), (phone, "AA"), ("T", phone, "T")):
                sounds = {sound[0] for sound in from_american("word", around)}
                assert sounds <= rows | (OTHERS & {phone})

    def test_american_english_says_nothing_but_its_inventory(self) -> None:
        rows = {row.phones[0] for row in US.inventory()}
        data = US.lexicon._data
        data.seek(0)
        seen = {phone.decode() for line in iter(data.readline, b"") for phone in line.split()[1:]}
        assert seen <= rows
        words = ["smorgle", "xylograph", "quizzes", "lipwrights", "bluetoothing", "wrought'll"]
        assert {p for word in words for way in US.pronounce(word) for p in way.phones} <= rows


# What American English has in its table and neither its lexicon nor British English says.
OTHERS = {"IX", "UX", "Q", "HV", "EM", "EN", "ENG", "EL", "DX", "NX", "WH", "AXR"}
