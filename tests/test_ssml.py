"""Scripts: plain text and SSML."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.speech.voices import Piece, read_script
from lipwright.speech.voices.readings import READINGS, read_as
from lipwright.speech.voices.ssml import MOST_CHARACTERS
from lipwright.speech.voices.ssml_elements import ELEMENTS, PARAGRAPH, RATES, STRENGTHS


def said(ssml: str) -> tuple[Piece, ...]:
    return read_script(f"<speak>{ssml}</speak>")


def one(ssml: str) -> Piece:
    (piece,) = said(ssml)
    return piece


def test_plain_text_is_one_piece_at_its_place() -> None:
    assert read_script("\n\n  Hello there.\nBob ") == (
        Piece("Hello there.\nBob", line=3, column=3),
    )


def test_a_byte_order_mark_and_line_ends_of_other_systems_are_read() -> None:
    assert read_script("\ufeffone\r\ntwo\rthree")[0].text == "one\ntwo\nthree"


def test_emoji_are_not_said_and_move_nothing() -> None:
    (piece,) = read_script("Hi 👩🏽‍🚀 and ❤️ you 1️⃣")
    assert piece.text.split() == ["Hi", "and", "you", "1"]
    assert piece.text.index("you") == "Hi 👩🏽‍🚀 and ❤️ you 1️⃣".index("you")


@pytest.mark.parametrize("text", ["😀", " 👍🏽 🇸🇪 ❤️ ", "<speak>🎉</speak>"])
def test_emoji_alone_are_refused(text: str) -> None:
    with pytest.raises(LipwrightError, match="nothing but emoji, which no voice says; give words"):
        read_script(text)


@pytest.mark.parametrize(
    "text",
    ["", "  \n ", "...!", "<speak/>", "<speak> </speak>", "<speak><break time='1s'/></speak>",
     "<speak><meta name='x'/><metadata>hidden</metadata></speak>", "<speak>?!</speak>"],
)  # fmt: skip
def test_what_says_nothing_is_refused(text: str) -> None:
    with pytest.raises(LipwrightError, match=r"^story: has no words; give the words"):
        read_script(text, "story")


@pytest.mark.parametrize("char", ["\0", "\a", "\x1b", "\x0b", "\x7f", "\x85", "\ud800", "\uffff"])
def test_control_characters_are_refused_by_their_place(char: str) -> None:
    code = f"U\\+{ord(char):04X}"
    with pytest.raises(LipwrightError, match=rf"^a.txt: line 2, column 3: .*{code}; remove it"):
        read_script(f"ok\nab{char}", "a.txt")


def test_texts_beyond_any_speech_are_refused() -> None:
    with pytest.raises(LipwrightError, match="say it in parts"):
        read_script("a" * (MOST_CHARACTERS + 1))


# Elements


def test_breaks_are_pauses_after_what_is_before() -> None:
    pieces = said("One <break time='250ms'/> two <break time='1.5s'/> three")
    assert [(piece.text, piece.pause) for piece in pieces] == [
        ("One", 0.25), ("two", 1.5), ("three", 0.0),
    ]  # fmt: skip


def test_breaks_add_up_and_may_come_first_and_last() -> None:
    pieces = said("<break time='1s'/><break time='1s'/>hi<break time='1s'/><break time='.5s'/>")
    assert [(piece.text, piece.pause) for piece in pieces] == [("", 2.0), ("hi", 1.5)]


@pytest.mark.parametrize("strength", STRENGTHS)
def test_strengths_of_breaks_rise(strength: str) -> None:
    assert said(f"a<break strength='{strength}'/>")[0].pause == STRENGTHS[strength]
    assert list(STRENGTHS.values()) == sorted(set(STRENGTHS.values()))


def test_a_break_without_anything_is_a_medium_one() -> None:
    assert said("a<break/>")[0].pause == STRENGTHS["medium"]


def test_paragraphs_and_sentences_end() -> None:
    pieces = said("<p><s>One</s><s>Two!</s></p>\n<p>Three</p>")
    assert [(piece.text, piece.pause) for piece in pieces] == [
        ("One.", 0.0), ("Two!", PARAGRAPH), ("Three.", 0.0),
    ]  # fmt: skip


def test_a_break_between_paragraphs_goes_before_their_own() -> None:
    assert said("<p>One</p><break time='100ms'/><p>Two</p>")[0].pause == 0.1
    assert said("<p>One</p><break strength='none'/><p>Two</p>")[0].pause == 0.0


def test_emphasis_has_its_level() -> None:
    pieces = said("a <emphasis>b</emphasis> <emphasis level='strong'>c</emphasis>")
    assert [piece.emphasis for piece in pieces] == [None, "moderate", "strong"]


@pytest.mark.parametrize(
    ("rate", "factor"),
    [("80%", 0.8), ("+50%", 1.5), ("-10%", 0.9), ("1.25", 1.25), ("2", 2.0), *RATES.items()],
)
def test_rates_are_factors(rate: str, factor: float) -> None:
    assert one(f"<prosody rate='{rate}'>a</prosody>").rate == pytest.approx(factor)


def test_rates_within_each_other_multiply_and_end() -> None:
    pieces = said("<prosody rate='50%'>a <prosody rate='150%'>b</prosody></prosody> c")
    assert [piece.rate for piece in pieces] == pytest.approx([0.5, 0.75, 1.0])


@pytest.mark.parametrize(
    ("alphabet", "ph"),
    [("ipa", "təˈmeɪtoʊ"), ("x-sampa", 't@"meItoU'), ("x-arpabet", "T AX0 M EY1 T OW0"),
     ("cmu", "T AX M EY T OW"), ("IPA", "tə.ˈmeɪ.toʊ")],
)  # fmt: skip
def test_phonemes_of_each_alphabet_are_phones(alphabet: str, ph: str) -> None:
    escaped = ph.replace('"', "&quot;")
    piece = one(f'<phoneme alphabet="{alphabet}" ph="{escaped}">tomato</phoneme>')
    assert piece.text == "tomato"
    assert piece.phones == ("T", "AX", "M", "EY", "T", "OW")


def test_phonemes_need_no_word() -> None:
    assert one("<phoneme ph='pa'/>").phones[0] == "P"


def test_sub_says_its_alias() -> None:
    assert one("<sub alias='doctor'>Dr</sub>").text == "doctor"


@pytest.mark.parametrize(
    ("kind", "form", "text", "read"),
    [
        ("characters", "", "AB12", "A.B. 1 2"),
        ("spell-out", "", "w3c", "W. 3 C."),
        ("digits", "", "1 234", "1 2 3 4"),
        ("telephone", "", "+46 (70) 12-3", "plus 4 6, 7 0, 1 2, 3"),
        ("cardinal", "", "007", "7"),
        ("cardinal", "", "1,050", "1,050"),
        ("ordinal", "", "3", "3rd"),
        ("ordinal", "", "112", "112th"),
        ("date", "mdy", "3/5/2024", "March 5th 2024"),
        ("date", "dmy", "3.5.2024", "May 3rd 2024"),
        ("date", "", "2024-03-05", "March 5th 2024"),
        ("date", "md", "12/24", "December 24th"),
        ("date", "mdy", "99/99/2024", "99/99/2024"),
        ("time", "", "10:30", "10:30"),
    ],
)
def test_say_as_reads(kind: str, form: str, text: str, read: str) -> None:
    assert one(f"<say-as interpret-as='{kind}' format='{form}'>{text}</say-as>").text == read


def test_ordinals_of_other_languages_are_theirs() -> None:
    (piece,) = read_script(
        "<speak xml:lang='sv-SE'><say-as interpret-as='ordinal'>3</say-as></speak>"
    )
    assert piece.text == "tredje"
    assert read_as("3", "date", "d", "sv") == "03"


@pytest.mark.parametrize("kind", READINGS)
@pytest.mark.parametrize("language", ["", "en", "sv", "xx"])
def test_say_as_leaves_what_it_cannot_read(kind: str, language: str) -> None:
    assert read_as("hello", kind, "mdy", language)


def test_marks_and_tokens_change_nothing() -> None:
    pieces = said("<mark name='x'/>one <token>two</token> <w>three</w>")
    assert [piece.text for piece in pieces] == ["one", "two", "three"]


def test_pieces_know_their_places() -> None:
    text = "<speak>\n  åäö <emphasis>b</emphasis>\n\n  c\n</speak>"
    assert [(p.text, p.line, p.column) for p in read_script(text)] == [
        ("åäö", 2, 3), ("b", 2, 17), ("c", 4, 3),
    ]  # fmt: skip


def test_empty_lines_part_text_and_keep_places() -> None:
    pieces = read_script("<speak>one\ntwo\n\n  three</speak>")
    assert [(p.text, p.line, p.column) for p in pieces] == [("one\ntwo", 1, 8), ("three", 4, 3)]


def test_a_declaration_comments_and_entities_of_xml_are_read() -> None:
    text = "<?xml version='1.0' encoding='latin-1'?><!-- a --><speak>R&amp;B &#233;</speak>"
    assert read_script(text)[0].text == "R&B é"


def test_elements_may_have_the_prefix_of_ssml() -> None:
    assert read_script("<ssml:speak>a<ssml:break time='1s'/></ssml:speak>")[0].pause == 1.0


# What is refused


@pytest.mark.parametrize(
    ("ssml", "told"),
    [
        ("a <foo/>", r"column 10: unknown element <foo>; use one of: speak, p, s"),
        ("<mstts:express-as>a</mstts:express-as>", "unknown element <mstts:express-as>"),
        ("<voice name='x'>a</voice>", "<voice> is not supported; choose the voice with --voice"),
        ("<audio src='x'/>a", "<audio> is not supported"),
        ("<lang xml:lang='fr'>a</lang>", "a voice says one language"),
        ("<break time='5'/>a", "write 500ms or 1.5s"),
        ("<break time='-5s'/>a", "write 500ms or 1.5s"),
        ("<break time='61s'/>a", "at most 60 s"),
        ("a<break time='40s'/><break time='40s'/>", "a pause of 80 s; at most 60 s"),
        ("<break strength='huge'/>a", "use one of: none, x-weak"),
        ("<emphasis level='very'>a</emphasis>", "use one of: none, reduced, moderate, strong"),
        ("<prosody rate='warp'>a</prosody>", "use one of: x-slow"),
        ("<prosody rate='-20'>a</prosody>", "use one of: x-slow"),
        ("<prosody rate='900%'>a</prosody>", "it may be 0.25 to 4"),
        ("<prosody duration='3s'>a</prosody>", "give a rate"),
        ("<phoneme>a</phoneme>", "has no phonemes"),
        ("<phoneme alphabet='x-pinyin' ph='ma1'>a</phoneme>", "use one of: ipa, x-sampa"),
        ("<phoneme alphabet='x-arpabet' ph='ZZ'>a</phoneme>", "unknown arpabet phone 'ZZ'"),
        ("<phoneme ph='ㅎ'>a</phoneme>", "International Phonetic Alphabet"),
        ("<phoneme alphabet='x-sampa' ph='&amp;'>a</phoneme>", "X-SAMPA has no '&'"),
        ("<phoneme ph='ˈˈ'>a</phoneme>", "line 1, column 8"),
        ("<phoneme ph='pa'>a<break/></phoneme>", "which holds text alone"),
        ("<sub>a</sub>", "has no alias"),
        ("<say-as interpret-as='rhyme'>a</say-as>", "use one of: characters"),
        ("a & b", "line 1, column 11: not well-formed"),
        ("a</p>", "not well-formed SSML: mismatched tag"),
        ("&lol;", "not well-formed SSML: undefined entity"),
        ("<p>" * 60, "more than 50 elements in each other"),
    ],
)
def test_what_is_not_supported_is_named_with_its_place(ssml: str, told: str) -> None:
    with pytest.raises(LipwrightError, match=told) as caught:
        read_script(f"<speak>{ssml}</speak>", "s.ssml")
    assert re.match(r"s\.ssml: line 1, column \d+: ", str(caught.value))


def test_a_text_without_end_is_refused() -> None:
    with pytest.raises(LipwrightError, match="line 2, column 3: not well-formed"):
        read_script("<speak>\nhe")


def test_laughs_are_not_multiplied_a_billion_times() -> None:
    entities = "".join(f"<!ENTITY l{n + 1} '{f'&l{n};' * 10}'>" for n in range(9))
    bomb = f"<!DOCTYPE x [<!ENTITY l0 'ha'>{entities}]><speak>&l9;</speak>"
    with pytest.raises(LipwrightError, match="declares a document type"):
        read_script(bomb)


def test_files_are_not_read_by_entities() -> None:
    text = "<!DOCTYPE speak [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><speak>&x;</speak>"
    with pytest.raises(LipwrightError, match="declares a document type"):
        read_script(text)


TAGS = [*ELEMENTS, "voice", "foo"]
PARTS = st.one_of(
    st.text(max_size=6),
    st.sampled_from(TAGS).map("<{}>".format),
    st.sampled_from(TAGS).map("</{}>".format),
    st.builds(
        "<{} {}='{}'/>".format, st.sampled_from(TAGS),
        st.sampled_from(["time", "strength", "level", "rate", "ph", "alphabet", "alias",
                         "interpret-as", "xml:lang", "format"]),
        st.sampled_from(["1s", "9", "ipa", "pʰa", "strong", "date", "x-sampa", "%", "1e9%", ""]),
    ),
    st.sampled_from(["<!--", "-->", "<![CDATA[", "]]>", "&amp;", "&#0;", "&#x9999999;", "<?x"]),
    st.sampled_from(["\n\n", "😀", "\x00"]),
)  # fmt: skip


@given(st.lists(PARTS, max_size=12).map("".join), st.booleans())
@settings(max_examples=150, deadline=None)
def test_any_text_is_a_script_or_one_clear_line(text: str, marked_up: bool) -> None:
    refused = ""
    script: tuple[Piece, ...] = ()
    try:
        script = read_script(f"<speak>{text}</speak>" if marked_up else text)
    except LipwrightError as error:
        refused = str(error)
    assert bool(script) != bool(refused)
    assert "\n" not in refused
    assert not script or any(piece.text or piece.phones for piece in script)
