"""Text to words to phones: English, the lexicon and the user's dictionary."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.language import LANGUAGES, Dictionary, get_language, read_dictionary
from lipwright.language.base import Pronunciation
from lipwright.language.english import tables
from lipwright.language.english.numbers import cardinal, ordinal, year
from lipwright.language.english.pronounce import with_ending
from lipwright.phones import PHONES, SILENCE

EN = get_language("en")

# As written, and as spoken.
SPOKEN = [
    # plain words
    ("Hello, world!", "hello world"),
    ("BIN BLUE AT F TWO NOW", "bin blue at f two now"),
    ("don't can't it's o'clock", "don't can't it's o'clock"),
    ("“Don’t,” she said—‘never’…", "don't she said never"),
    ("Get 'em 'til rock 'n' roll", "get 'em 'til rock 'n roll"),
    ("the dogs' 'quoted' tails", "the dogs' quoted tails"),
    ("well-known mother-in-law", "well known mother in law"),
    ("café naïve Zürich façade", "cafe naive zurich facade"),
    ("Øre straße Łódź", "ore strasse lodz"),
    ("either/or; and/or", "either or and or"),
    ("one\ntwo\r\nthree\tfour", "one two three four"),
    ("Hello [laughs] there [door\nslams]!", "hello there"),
    ("(softly) yes *no* _maybe_", "softly yes no maybe"),
    ("ｆｕｌｌ ｗｉｄｔｈ ﬁne", "full width fine"),
    ("so... what?! -- well", "so what well"),
    # whole numbers
    ("0 7 13 20 21 99", "zero seven thirteen twenty twenty one ninety nine"),
    ("100 101 110 999", "one hundred one hundred one one hundred ten nine hundred ninety nine"),
    ("1,234", "one thousand two hundred thirty four"),
    ("1,000,000", "one million"),
    ("2500000000", "two billion five hundred million"),
    ("3,000,000,000,001", "three trillion one"),
    ("12,345 people", "twelve thousand three hundred forty five people"),
    ("-5 and +3 and −2", "minus five and plus three and minus two"),
    ("٣ apples", "three apples"),
    # decimals
    ("3.14", "three point one four"),
    ("0.05 or .5", "zero point zero five or point five"),
    ("1,234.5", "one thousand two hundred thirty four point five"),
    ("version 1.2.3", "version one point two point three"),
    # ordinals
    ("1st 2nd 3rd 4th", "first second third fourth"),
    ("5th 8th 9th 12th 20th", "fifth eighth ninth twelfth twentieth"),
    ("the 22nd and 101st", "the twenty second and one hundred first"),
    # years, decades and dates
    ("in 1984", "in nineteen eighty four"),
    ("in 2007.", "in two thousand seven"),
    ("1900, 1905 and 2024", "nineteen hundred nineteen oh five and twenty twenty four"),
    ("1066", "ten sixty six"),
    ("the 1900s", "the nineteen hundreds"),
    ("the 1990s and '80s", "the nineteen nineties and eighties"),
    ("2000 2000s", "two thousand two thousands"),
    ("Jan. 5th, 2024-02-29", "january fifth february twenty ninth twenty twenty four"),
    # times
    ("10:30", "ten thirty"),
    ("7 pm", "seven p m"),
    ("at 7pm or 7:05 a.m.", "at seven p m or seven oh five a m"),
    ("9:00", "nine o'clock"),
    ("9:00 AM", "nine a m"),
    ("I am 7", "i am seven"),
    # money
    ("$5.50", "five dollars and fifty cents"),
    ("$1 $2", "one dollar two dollars"),
    ("£3", "three pounds"),
    ("20 €", "twenty euros"),
    ("20€ €20", "twenty euros twenty euros"),
    ("$0.99", "ninety nine cents"),
    ("£1.01", "one pound and one penny"),
    ("$1,000,000", "one million dollars"),
    ("$3.5 million", "three point five million dollars"),
    ("$5bn -$4", "five billion dollars minus four dollars"),
    ("¥500", "five hundred yen"),
    # percent, fractions, ranges, codes
    ("50% 2.5 %", "fifty percent two point five percent"),
    ("1/2 3/4 2/3", "one half three quarters two thirds"),
    ("½ cup, 2½ cups", "one half cup two and one half cups"),
    ("9/11 24/7", "nine eleven twenty four seven"),
    ("5-10 pages", "five to ten pages"),
    ("$20-30 or £1-£2m", "twenty to thirty dollars or one to two million pounds"),
    ("a 21st-century 3-year-old", "a twenty first century three year old"),
    ("8 1/2 cups", "eight and one half cups"),
    ("(555) 123-4567", "five five five one two three four five six seven"),
    ("<b>bold</b> <c.x>text</c>", "bold text"),
    ("1939–1945", "nineteen thirty nine to nineteen forty five"),
    ("5-10% 3-5kg", "five to ten percent three to five kilograms"),
    ("555-1234", "five five five one two three four"),
    ("+1 555-123-4567", "plus one five five five one two three four five six seven"),
    ("agent 007", "agent zero zero seven"),
    ("room 5551234", "room five five five one two three four"),
    # units
    ("5kg 5 kg 1 kg", "five kilograms five kilograms one kilogram"),
    ("10 cm by 3mm", "ten centimeters by three millimeters"),
    ("60 mph, 5km/h", "sixty miles per hour five kilometers per hour"),
    ("20°C or 68 °F", "twenty degrees celsius or sixty eight degrees fahrenheit"),
    ("48 kHz, 1500 km", "forty eight kilohertz one thousand five hundred kilometers"),
    ("many km", "many kilometers"),
    # abbreviations
    ("Dr. Smith, Mr. and Mrs. Jones", "doctor smith mister and missus jones"),
    ("Ms. Lee vs. Lee", "ms lee versus lee"),
    ("St. Mary on Main St. at noon", "saint mary on main street at noon"),
    ("cats, dogs, etc.", "cats dogs et cetera"),
    ("e.g. this, i.e. that", "for example this that is that"),
    ("No. 5, no. No, no 6", "number five no no no six"),
    ("The cat sat. The sun.", "the cat sat the sun"),
    ("Gen. Lee and Prof X", "general lee and professor x"),
    ("Gen Z ranks 5 in 10", "gen z ranks five in ten"),
    ("J. R. R. Tolkien, U.S.A.", "j r r tolkien u s a"),
    ("World War II", "world war two"),
    # capitals
    ("NASA and the FBI", "nasa and the fbi"),
    ("an XQJ and two XQJs", "an x q j and two x q j's"),
    ("a mp3 from the xkcd", "a m p three from the x k c d"),
    ("COVID-19 F-16 3D", "covid nineteen f sixteen three d"),
    # signs
    ("R&B, salt & pepper", "r and b salt and pepper"),
    ("2 + 2 = 4", "two plus two equals four"),
    ("#1 #lipsync C# C++", "number one hashtag lipsync c sharp c plus plus"),
    ("me@example.com", "me at example dot com"),
    ("https://www.example.org/a-b", "w w w dot example dot org slash a dash b"),
    ("3 × 4 ÷ 2", "three times four divided by two"),
    ("Hi 😀 there™", "hi there"),
    ("0DR 5x", "zero doctor five x"),
]  # fmt: skip


def spoken(text: str, dictionary: Dictionary | None = None) -> str:
    return " ".join(word.text for word in EN.normalize(text, dictionary=dictionary))


@pytest.mark.parametrize(("written", "expected"), SPOKEN, ids=[row[0][:30] for row in SPOKEN])
def test_text_is_written_out_as_it_is_spoken(written, expected):
    assert spoken(written) == expected


@pytest.mark.parametrize("written", [row[0] for row in SPOKEN], ids=[r[0][:30] for r in SPOKEN])
def test_normalised_words_stay_as_they_are(written):
    once = spoken(written)
    assert spoken(once) == once


def test_a_spoken_word_names_its_token_line_and_column():
    words = EN.normalize("At 10:30,\n  Dr. Who")
    assert [(w.text, w.written, w.line, w.column) for w in words] == [
        ("at", "At", 1, 1), ("ten", "10:30,", 1, 4), ("thirty", "10:30,", 1, 4),
        ("doctor", "Dr.", 2, 3), ("who", "Who", 2, 7),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "line", "column", "letters"),
    [("Привет", 1, 1, "Привет"), ("hello\n say 你好!", 2, 6, "你好"), ("an مرحبا", 1, 4, "مرحبا"),
     ("αβγ", 1, 1, "αβγ"), ("it is cаt", 1, 8, "а")],
)  # fmt: skip
def test_another_script_is_an_error_with_its_place(text, line, column, letters):
    with pytest.raises(LipwrightError) as caught:
        EN.normalize(text, "words.txt")
    message = str(caught.value)
    assert message.startswith(f"words.txt: line {line}, column {column}: {letters!r} ")
    assert "\n" not in message


@pytest.mark.parametrize("text", ["", " \n\t ", "...", "?! --", "[music]", "😀", "\ufeff"])
def test_text_without_words_is_an_error(text):
    with pytest.raises(LipwrightError, match=r"^words\.txt: has no words; "):
        EN.normalize(text, "words.txt")


def test_foreign_letters_in_a_stage_direction_do_not_matter():
    assert spoken("yes [смех] no") == "yes no"


WORDS = st.text("abcdeinorst'.-$%:/,1230", min_size=1, max_size=12)


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(max_size=40), st.lists(WORDS, max_size=6).map(" ".join)))
@example("'")
@example("0DR 1KM")
@example("1'")
@example("St. 5 St.")
@example(".'.")
@example("a.b.c.")
@example("#")
@example("a0A´A")
def test_any_text_gives_words_that_stay_and_can_be_said_or_a_clear_error(text):
    try:
        words = EN.normalize(text)
    except LipwrightError as error:
        if "\n" in str(error):
            pytest.fail(f"more than one line: {error}")
        return
    assert all(re.fullmatch(r"[a-z'-]*[a-z][a-z'-]*", word.text) for word in words)
    lines = text.split("\n")
    for word in words:
        assert lines[word.line - 1][word.column - 1 :].startswith(word.written)
    once = " ".join(word.text for word in words)
    assert spoken(once) == once
    for word in words[:2]:
        assert EN.pronounce(word.text)


SMALL = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
    "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen",
)  # fmt: skip
TENS = ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")


@given(st.integers(0, 10**15 - 1))
def test_cardinals_say_their_number(number):
    values = {word: value for value, word in enumerate(SMALL)}
    values |= {word: 10 * value for value, word in enumerate(TENS, 2)}
    powers = {"thousand": 10**3, "million": 10**6, "billion": 10**9, "trillion": 10**12}
    total = part = 0
    for word in cardinal(number):
        if word in powers:
            total, part = total + part * powers[word], 0
        else:
            part = part * 100 if word == "hundred" else part + values[word]
    assert total + part == number


@given(st.integers(1, 10**6))
def test_ordinals_differ_from_cardinals_in_the_last_word_only(number):
    assert ordinal(number)[:-1] == cardinal(number)[:-1]
    assert ordinal(number)[-1].endswith(("first", "second", "third", "th"))


def test_every_year_of_the_calendar_can_be_said():
    for number in range(1000, 2100):
        assert all(EN.pronounce(word)[0].source == "lexicon" for word in year(number))


def test_every_word_of_the_tables_is_in_the_lexicon():
    phrases = [words for words, _ in tables.ABBREVIATIONS.values()]
    phrases += [form for forms in tables.UNITS.values() for form in forms]
    phrases += [form for forms in tables.CURRENCIES.values() for form in forms]
    for table in (tables.MAGNITUDES, tables.SYMBOLS, tables.ADDRESS_SYMBOLS, tables.ROMAN):
        phrases += table.values()
    words = {word for phrase in (*phrases, *tables.MONTHS) for word in phrase.split()}
    guessed = {word for word in words if EN.pronounce(word)[0].source == "g2p"}
    assert guessed <= {"kilohertz", "gigahertz", "paisa", "paise"}  # which the network says well


@pytest.fixture(scope="module")
def lexicon_lines() -> dict[str, list[tuple[str, ...]]]:
    import pocketsphinx

    path = Path(pocketsphinx.get_model_path("en-us/cmudict-en-us.dict"))
    entries: dict[str, list[tuple[str, ...]]] = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        word, *phones = line.split()
        entries.setdefault(word.partition("(")[0], []).append(tuple(phones))
    return entries


def test_every_entry_of_the_lexicon_has_phones_of_the_table(lexicon_lines):
    assert len(lexicon_lines) > 120_000
    ways = [way for entry in lexicon_lines.values() for way in entry]
    assert all(ways)
    assert {phone for way in ways for phone in way} <= PHONES.keys() - {SILENCE}


def test_the_search_finds_what_reading_the_whole_lexicon_finds(lexicon_lines):
    words = list(lexicon_lines)
    for word in (words[0], words[-1], *words[::13], *(w for w in words if "'" in w)):
        assert EN.lexicon.lookup(word) == tuple(lexicon_lines[word])


def test_plurals_by_rule_are_those_of_the_lexicon(lexicon_lines):
    pairs = [(w, w + "s") for w in lexicon_lines if w.isalpha() and len(lexicon_lines[w]) == 1]
    pairs = [pair for pair in pairs if pair[1] in lexicon_lines and not pair[0].endswith("s")]
    agree = [with_ending(lexicon_lines[one][0], "s") in lexicon_lines[many] for one, many in pairs]
    assert len(agree) > 9000
    assert sum(agree) / len(agree) > 0.9  # the rest are homographs and proper names


@pytest.mark.parametrize("word", ["", "(", "zzzzzzz", "'", "aaaaaaaa", "blorptastic", "é"])
def test_the_search_finds_nothing_for_a_word_that_is_not_there(word):
    assert EN.lexicon.lookup(word) == ()


def test_all_variants_of_a_word_are_given():
    assert [way.phones for way in EN.pronounce("a")] == [("AH",), ("EY",)]
    assert {way.source for way in EN.pronounce("tomato")} == {"lexicon"}
    assert len(EN.pronounce("tomato")) == 2


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("lipwright", "L IH P R AY T"),  # two known words
        ("lipwright's", "L IH P R AY T S"),  # behind a voiceless phone
        ("lipwrights'", "L IH P R AY T S"),
        ("plasterphone's", "P L AE S T ER F OW N Z"),  # behind a voiced phone
        ("glitches", "G L IH CH IH Z"),  # behind a sibilant
        ("jukebox's", "JH UW K B AA K S IH Z"),
        ("lipwright'll", "L IH P R AY T AH L"),
        ("rebooting", "R IY B UW T IH NG"),
    ],
)
def test_endings_and_compounds_of_known_words_go_by_rule(word, phones):
    known = {" ".join(way.phones) for way in EN.pronounce(word)}
    assert phones in known


@pytest.mark.parametrize("word", ["blorptastic", "zhoosh", "x" * 40, "q", "aeiou" * 30, "b'zq"])
def test_any_other_word_is_guessed(word):
    for way in EN.pronounce(word):
        assert all(phone in PHONES for phone in way.phones)


def test_a_guess_sounds_like_the_word():
    assert EN.pronounce("blick")[0].phones == ("B", "L", "IH", "K")


def test_a_word_without_letters_cannot_be_pronounced():
    with pytest.raises(LipwrightError, match="'42' cannot be pronounced; "):
        EN.pronounce("42")


def write(tmp_path: Path, text: str | bytes) -> Path:
    path = tmp_path / "words.dict"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_the_users_dictionary_goes_before_the_lexicon(tmp_path):
    text = "\ufeff# ours\n;;; too\n\nTomato  T AH0 M AA1 T OW2 # British\n"
    text += "tomato(2) t ah m ey t ow\nR2-D2 AA R T UW D IY T UW\r\nCafé K AE F EY\n"
    path = write(tmp_path, text)
    dictionary = read_dictionary(path)
    assert len(dictionary) == 3
    ways = EN.pronounce("TOMATO", dictionary)
    assert [way.phones for way in ways] == [
        ("T", "AH", "M", "AA", "T", "OW"), ("T", "AH", "M", "EY", "T", "OW"),
    ]  # fmt: skip
    assert {way.source for way in ways} == {"dictionary"}
    assert (
        spoken("“R2-D2” eats a café’s tomato, r2-d2!", dictionary)
        == "r2-d2 eats a café's tomato r2-d2"
    )
    assert spoken("Café", dictionary) == "café"
    assert EN.pronounce("café", dictionary)[0].phones == ("K", "AE", "F", "EY")
    assert EN.pronounce("tomato")[0].source == "lexicon"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("good G UH D\nbad B AE QQ\n", "line 2: unknown arpabet phone 'QQ'"),
        ("\n\nlonely\n", "line 3: 'lonely' has no phones"),
        ("pause P sil Z\n", "line 1: 'sil' is silence"),
        (b"ok OW K EY\nna\xefve N AA IY V\n", "line 2: not UTF-8"),
    ],
)
def test_a_bad_dictionary_is_an_error_with_its_place(tmp_path, text, reason):
    path = write(tmp_path, text)
    with pytest.raises(LipwrightError) as caught:
        read_dictionary(path)
    assert str(caught.value).startswith(f"{path}: {reason}")


def test_a_missing_dictionary_and_a_folder_are_errors(tmp_path):
    with pytest.raises(LipwrightError, match="no such file"):
        read_dictionary(tmp_path / "none.dict")
    with pytest.raises(LipwrightError, match="cannot be read"):
        read_dictionary(tmp_path)
    with pytest.raises(LipwrightError, match="cannot be read"):
        read_dictionary("a\0b")


@settings(max_examples=200, deadline=None)
@given(data=st.one_of(st.binary(max_size=60), st.text("ABKs012() #;\n\t'é", max_size=60)))
def test_any_bytes_are_a_dictionary_or_a_clear_error(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "fuzz.dict"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    try:
        dictionary = read_dictionary(path)
    except LipwrightError as error:
        if "\n" in str(error):
            pytest.fail(f"more than one line: {error}")
        return
    for word in dictionary.entries:
        assert EN.pronounce(word, dictionary)[0].source == "dictionary"


def test_every_registered_language_knows_its_code():
    assert {code: get_language(code).code for code in LANGUAGES} == {
        code: code for code in LANGUAGES
    }


def test_an_unknown_language_lists_the_known_ones():
    with pytest.raises(LipwrightError, match="unknown language 'xyz'"):
        get_language("xyz")


@pytest.mark.parametrize("phones", [(), ("QQ",), ("B", SILENCE)])
def test_a_pronunciation_has_phones_of_the_table(phones):
    with pytest.raises(ValueError, match="a pronunciation of the phones"):
        Pronunciation(phones, "rule")
