from __future__ import annotations

import re
import unicodedata

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright import espeak
from lipwright.errors import LipwrightError
from lipwright.espeak.process import find_library
from lipwright.language.ipa import read_ipa
from lipwright.phones import BILABIALS, PHONES, SILENCE
from lipwright.speech.voices import find_voice
from lipwright.speech.voices.espeak import EspeakVoice, back_end
from lipwright.speech.voices.espeak_phones import MNEMONICS, mnemonics_of, phoneme_input
from lipwright.speech.voices.espeak_text import mandarin_text, plain_text
from lipwright.speech.voices.stretching import stretch
from lipwright.speech.voices.timeline import LEAST_CLOSURE, Stretch, Timed, Timeline
from lipwright.speech.voices.values import Piece, Utterance
from lipwright.track import PhoneTrack

pytestmark = pytest.mark.skipif(
    find_library() is None, reason="espeak-ng is not installed: pip install 'lipwright[espeak]'"
)

# The ten sentences of table 4.4 of the Swedish thesis, and the p, b and m that are said in each.
SWEDISH = (
    ("Det är en av de märkligaste motsättningarna hos honom.", "MMM"),
    ("Informationsteknik är man i stort behov av, menar han.", "MMBM"),
    ("Staten har satt löner långt under gällande villkor.", ""),
    ("En utmärkt men livsfarlig farkost i det iskalla vattnet.", "MM"),
    ("Skulle det då ha varit annorlunda?", ""),
    ("Ty om någon enda bestående sanning återstår, är barn liv.", "MBB"),
    ("Just därför kan det ju dra ut på tiden i flera år.", "P"),
    ("I början hade det mest varit hemmafruar.", "BMM"),
    ("Medan de åt och drack, blev de snart torra och varma igen.", "MBM"),
    ("Kantigheten återkommer i målningarnas annars helt motsatta uttryck.", "MMM"),
)
# Harvard sentences of list 1, 2 and 3 (IEEE 1969), the first with a closure in each.
ENGLISH = (
    ("The birch canoe slid on the smooth planks.", "BMP"),
    ("Glue the sheet to the dark blue background.", "BB"),
    ("These days a chicken leg is a rare dish.", ""),
    ("Rice is often served in round bowls.", "B"),
    ("The juice of lemons makes fine punch.", "MMP"),
    ("The box was thrown beside the parked truck.", "BBP"),
    ("The hogs were fed chopped corn and garbage.", "PB"),
    ("Four hours of steady work faced us.", ""),
    ("A large size in stockings is hard to sell.", ""),
    ("The boy was there when the sun rose.", "B"),
)
MANDARIN = (
    ("今天天气非常好，我们去公园散步吧。", "MBB"),
    ("我的名字叫王明，我是北京大学的学生。", "MMB"),
    ("妈妈买了八个苹果，爸爸不喜欢吃。", "MMMBPBBB"),
    ("女儿学习英语，儿子学习绿色能源。", ""),
    ("请把门关上，别忘了带雨伞。", "BMB"),
    ("春天到了，桃花开得非常漂亮。", "P"),
    ("他说普通话说得比我慢一点儿。", "PBM"),
    ("我们应该保护环境，爱护每一片森林。", "MBMP"),
    ("明天下午三点，我在图书馆门口等你。", "MM"),
    ("这本书的内容很丰富，值得慢慢品味。", "BMMP"),
)


def voice(name: str) -> EspeakVoice:
    return back_end().open(name, None)


def said(name: str, *pieces: Piece) -> Utterance:
    return voice(name).speak(pieces)


def track_of(name: str, *pieces: Piece) -> PhoneTrack:
    track = said(name, *pieces).track
    assert track is not None
    return track


def words_of(track: PhoneTrack) -> dict[str, str]:
    return {word.text: "-".join(track.phones[word.first : word.stop]) for word in track.words}


@pytest.mark.parametrize(("name", "text", "closures"), [
    *(("sv", *row) for row in SWEDISH), *(("en-us", *row) for row in ENGLISH),
    *(("cmn", *row) for row in MANDARIN),
])  # fmt: skip
def test_every_closure_is_in_the_track_and_lasts(name: str, text: str, closures: str) -> None:
    utterance = said(name, Piece(text))
    track = utterance.track
    assert track is not None
    assert "".join(phone for phone in track.phones if phone in BILABIALS) == closures
    assert all(end - start >= LEAST_CLOSURE - 1e-9 for phone, start, end in track
               if phone in BILABIALS)  # fmt: skip
    assert track.start == 0
    assert track.end == pytest.approx(utterance.audio.duration)
    assert track.phones[0] == track.phones[-1] == SILENCE
    assert utterance.text == text


@pytest.mark.parametrize("name", ["en-us", "sv", "de", "it", "nl", "cmn"])
def test_a_voiceless_closure_is_silent_and_its_burst_the_end_of_it(name: str) -> None:
    """The sound of p between vowels: silence from the edge on, then the burst, then a vowel."""
    pieces = [Piece("", phones) for phones in (("AA", "P", "AA"), ("IY", "P", "IY", "P", "AA"))]
    for piece in pieces:
        utterance = said(name, piece)
        track = utterance.track
        assert track is not None
        found = [span for span in track if span[0] == "P"]
        assert found
        for _, start, end in found:
            samples = np.abs(utterance.audio.read(start, end).samples)
            silent = np.argmax(samples > 0.003) / utterance.audio.rate
            assert 0.02 <= silent <= end - start
            before = np.abs(utterance.audio.read(start - 0.01, start).samples)
            assert before.max() > 0.003


@pytest.mark.parametrize("name", ["en-us", "sv", "de"])
def test_closures_with_voice_are_weaker_than_the_vowels_beside_them(name: str) -> None:
    utterance = said(name, Piece("", ("AA", "M", "AA", "B", "AA", "M", "IY", "B", "IY")))
    track = utterance.track
    assert track is not None

    def high(start: float, end: float) -> float:
        samples = utterance.audio.read(start, end).samples
        spectrum = np.abs(np.fft.rfft(samples * np.hanning(len(samples)))) ** 2
        hertz = np.fft.rfftfreq(len(samples), 1 / utterance.audio.rate)
        return float(10 * np.log10(spectrum[hertz > 500].sum() / len(samples) + 1e-12))

    spans = list(track)
    for index, (phone, start, end) in enumerate(spans):
        if phone in ("M", "B"):
            _, vowel_start, vowel_end = spans[index - 1]
            middle = (vowel_start + vowel_end) / 2
            shut = (start + min(end, start + 0.04)) / 2
            assert high(middle - 0.015, middle + 0.015) - high(shut - 0.015, shut + 0.015) > 4


def test_words_are_as_written_in_any_script_and_numbers_as_they_are_said() -> None:
    assert words_of(track_of("en-us", Piece("“Hello”, my 2 pubs: 10:30!"))) == {
        "Hello": "HH-AX-L-OW", "my": "M-AY", "two": "T-UW", "pubs": "P-AH-B-Z",
        "ten": "T-EH-N", "thirty": "TH-ER-DX-IY",
    }  # fmt: skip
    # Xiandai Hanyu Cidian: nǐhǎo, nǚ'ér, piàoliang.
    assert words_of(track_of("cmn", Piece("你好，女儿漂亮English。"))) == {
        "你好": "N-IY-HH-AW", "女儿": "N-XIY-ER", "漂亮": "P-Y-AW-L-Y-AA-NG",
        "English": "IH-NG-G-L-IH-SH",
    }  # fmt: skip
    assert words_of(track_of("cmn", Piece("nǐhǎo, nü3 lv4"))) == {
        "nǐhǎo": "N-IY-HH-AW", "nü3": "N-XIY", "lv4": "L-XIY",
    }  # fmt: skip
    # SAOL: sju, kära, köpt.
    swedish = words_of(track_of("sv", Piece("Sju kära köpt")))
    assert swedish["Sju"].startswith("XH-")
    assert swedish["kära"].startswith("XC-EH")
    assert "XEH-P-T" in swedish["köpt"]
    japanese = track_of("ja", Piece("こんにちは、ありがとう。"))
    assert [word.text for word in japanese.words] == ["こんにちは", "ありがとう"]


def test_words_that_espeak_says_as_one_are_parted() -> None:
    words = words_of(track_of("en-us", Piece("In the house — of the man I am to be, at a pub.")))
    assert list(words) == [
        "In",
        "the",
        "house",
        "of",
        "man",
        "I",
        "am",
        "to",
        "be",
        "at",
        "a",
        "pub",
    ]
    assert (words["of"], words["am"], words["be"], words["a"]) == ("AH-V", "AH-M", "B-IY", "AX")


def test_mandarin_text_is_pinyin_with_its_words() -> None:
    text = mandarin_text("女儿很漂亮。")
    assert re.sub(r"\s+", " ", text.text) == "nv3 er2 hen3 piao4 liang4 。"
    assert [text.words[span.word] for span in text.spans] == [
        "女儿", "女儿", "很", "漂亮", "漂亮",
    ]  # fmt: skip
    assert mandarin_text("").text == ""
    assert plain_text("a  b").words == ("a", "b")


@pytest.mark.parametrize("rate", [0.25, 0.5, 0.8, 1.25, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("name", ["sv", "en-us", "cmn"])
def test_rate_2_takes_half_the_time(name: str, rate: float) -> None:
    text = {"sv": SWEDISH[8][0], "en-us": ENGLISH[0][0], "cmn": MANDARIN[2][0]}[name]

    def lasts(rate: float) -> float:
        track = track_of(name, Piece(text, rate=rate))
        return float(track.edges[-2] - track.edges[1])

    assert lasts(1.0) / lasts(rate) == pytest.approx(rate, rel=0.05)


def test_at_any_rate_the_phones_are_the_same() -> None:
    def closures(rate: float) -> list[str]:
        phones = track_of("en-us", Piece(ENGLISH[4][0], rate=rate)).phones
        return [phone for phone in phones if phone in BILABIALS]

    assert closures(0.25) == closures(1.0) == closures(4.0)


def test_breaks_are_exact_and_nothing_else_is_between() -> None:
    track = track_of("sv", Piece("Hej", pause=0.5), Piece(pause=0.25), Piece("på dig.", pause=1.0),
                     Piece("Pappa."))  # fmt: skip
    gaps = [end - start for phone, start, end in track if phone == SILENCE]
    assert gaps[1:3] == pytest.approx([0.75, 1.0], abs=1e-4)
    assert [word.text for word in track.words] == ["Hej", "på", "dig", "Pappa"]


def test_pieces_of_one_clause_follow_without_a_pause() -> None:
    whole = (Piece("This is"), Piece("very", emphasis="strong"), Piece("good."))
    track = track_of("en-us", *whole)
    assert track.phones.count(SILENCE) == 2
    assert [word.text for word in track.words] == ["This", "is", "very", "good"]


def test_emphasis_makes_a_word_longer_and_louder_or_higher() -> None:
    def lasts(**options: str) -> float:
        track = track_of("en-us", Piece("map", **options))  # type: ignore[arg-type]
        return float(track.edges[-2] - track.edges[1])

    assert lasts(emphasis="strong") > 1.1 * lasts()
    assert lasts(emphasis="reduced") < lasts()


def test_every_phone_of_the_table_has_mnemonics_and_none_else() -> None:
    assert set(MNEMONICS) == set(PHONES) - {SILENCE}


@pytest.mark.parametrize("name", ["en-us", "sv", "de", "cmn-latn-pinyin"])
def test_phones_are_said_by_any_voice(name: str) -> None:
    for phone in PHONES:
        if phone != SILENCE:
            assert mnemonics_of(phone, name)
    for word in ("P R AY M ER", "B IY M", "M AA P AX", "sil B OW"):
        asked = tuple(word.split())
        phones = track_of(name, Piece("word", asked)).phones
        closures = [phone for phone in phones if phone in BILABIALS]
        assert closures == [phone for phone in asked if phone in BILABIALS]


# Swedish and Mandarin have these themselves; English says the nearest.
def test_phones_of_a_language_are_its_own() -> None:
    assert track_of("sv", Piece("sjö", ("XH", "XEY"))).phones[1:-1] == ("XH", "XEY")
    assert track_of("cmn", Piece("lü", ("L", "XIY"))).phones[1:-1] == ("L", "XIY")
    assert track_of("en-us", Piece("sjö", ("XH", "XEY"))).phones[1] == "SH"
    assert phoneme_input(("M", "AE", "P"), "en-us") == "[[m|'a|p]]"


def test_stress_is_told() -> None:
    track = track_of("en-us", Piece("tomato"))
    vowels = [stress for phone, stress in zip(track.phones, track.stress, strict=True)
              if PHONES[phone].is_vowel]  # fmt: skip
    assert vowels == [None, 1, None] or vowels[1] == 1


def test_progress_rises_to_the_end_sentence_by_sentence() -> None:
    shares: list[float] = []
    text = " ".join(row[0] for row in ENGLISH * 3)
    track = voice("en-us").speak((Piece(text),), progress=shares.append).track
    assert track is not None
    assert len(shares) > 3
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1, abs=0.1)
    assert len(track.words) == len(text.split())


def test_voices_are_named_by_language_and_timbre() -> None:
    names = [info.name for info in back_end().voices()]
    assert len(names) > 100
    assert len(set(names)) == len(names)
    assert names[0] == "espeak:en-us"
    assert {"espeak:sv", "espeak:en-gb", "espeak:cmn"} <= set(names)
    assert find_voice("espeak:sv+f2").info.language == "sv"
    assert find_voice("espeak:sv+f2").info.name == "espeak:sv+f2"
    assert find_voice(None, "sv").info.name == "espeak:sv"
    assert find_voice("espeak", "de").info.name == "espeak:de"
    assert find_voice("espeak:zh").info.name == "espeak:cmn"
    with pytest.raises(LipwrightError, match=r"espeak-ng has no voice 'xx'; use one of: .*sv"):
        find_voice("espeak:xx")
    with pytest.raises(LipwrightError, match="no dictionary of Faroese"):
        find_voice("espeak:fo")


@pytest.mark.parametrize("name", ["en-gb", "de", "es", "fr", "it", "nl", "pt", "pt-br", "ja", "vi",
                                  "hi", "ar", "ru", "fi", "yue", "sw"])  # fmt: skip
def test_other_languages_have_their_closures_too(name: str) -> None:
    text = {"ja": "まま、ぱぱ。", "hi": "मम पप", "ar": "ماما بابا", "ru": "мама папа",
            "yue": "媽媽爸爸"}.get(name, "mama papa")  # fmt: skip
    phones = track_of(name, Piece(text)).phones
    wanted = [sound.phone for sound in read_ipa(espeak.to_ipa(text, name))]
    closures = [phone for phone in phones if phone in BILABIALS]
    assert closures == [phone for phone in wanted if phone in BILABIALS]
    assert len(closures) == 4


@pytest.mark.parametrize("text", ["\0", "a\x1b", "\x7f", "\udc00"])
def test_control_characters_are_refused_with_their_place(text: str) -> None:
    with pytest.raises(LipwrightError, match=r"page: line 8, column \d: the character U\+00|DC00"):
        voice("sv").speak((Piece("ett\n" + text, line=7, column=5),), "page")


@pytest.mark.parametrize("text", ["...", "   ", "\n", "，。"])
def test_nothing_to_say_is_refused(text: str) -> None:
    with pytest.raises(LipwrightError, match="page: line 1: espeak-ng finds nothing to say"):
        voice("cmn").speak((Piece(text),), "page")


@pytest.mark.parametrize(("name", "text", "closures"), [
    ("en-us", "ma" * 600, 600), ("en-us", "mama, " * 150, 300), ("sv", "mama " * 150, 300),
    ("cmn", "妈" * 300, 300), ("cmn", "ma1 " * 300, 300), ("yue", "媽" * 300, 300),
    ("ja", "まま" * 200, 400),
])  # fmt: skip
def test_nothing_of_a_long_word_or_clause_is_dropped(name: str, text: str, closures: int) -> None:
    assert track_of(name, Piece(text)).phones.count("M") == closures


@pytest.mark.parametrize(("name", "text"), [
    ("th", "Bob สวัสดี Pam"), ("ja", "Bob まま Pam"), ("en-us", "Bob สวัสดี Pam"),
])  # fmt: skip
def test_words_of_mixed_scripts_stand_in_the_order_in_which_they_are_said(
    name: str, text: str
) -> None:
    words = [word.text for word in track_of(name, Piece(text)).words]
    assert (words[0], words[-1]) == (text.split(maxsplit=1)[0], text.rsplit(maxsplit=1)[-1])


@settings(max_examples=15)
@given(
    st.sampled_from(["en-us", "sv", "cmn", "de", "ja"]),
    st.text(st.characters(exclude_categories=("Cc", "Cs")), min_size=1, max_size=30),
)
def test_any_text_gives_a_track_or_nothing_to_say(name: str, text: str) -> None:
    try:
        utterance = said(name, Piece(text))
    except LipwrightError as error:
        assert "nothing to say" in str(error) or (name == "ja" and "kana" in str(error))  # noqa: PT017
        return
    track = utterance.track
    assert track is not None
    assert track.end == pytest.approx(utterance.audio.duration)
    assert all(not unicodedata.category(char).startswith("Z") for word in track.words
               for char in word.text)  # fmt: skip


@settings(max_examples=20)
@given(st.floats(0.4, 2.5), st.integers(2000, 30000))
def test_stretching_keeps_the_pitch_and_makes_the_length(factor: float, count: int) -> None:
    rate = 22050
    wave = np.sin(2 * np.pi * 220 * np.arange(count) / rate).astype(np.float32)
    made = stretch(wave, rate, factor)
    assert len(made) == round(count * factor)
    middle = made[len(made) // 4 : -len(made) // 4]
    crossings = np.count_nonzero(np.diff(np.signbit(middle)))
    assert crossings / len(middle) * rate / 2 == pytest.approx(220, rel=0.12)


def test_stretching_takes_what_is_at_t_to_factor_t() -> None:
    rate = 22050
    noise = np.random.default_rng(0).normal(0, 0.3, rate).astype(np.float32)
    noise[8000:12000] = 0
    for factor in (0.5, 1.7, 2.4):
        made = np.abs(stretch(noise, rate, factor))
        blocks = made[: len(made) // 100 * 100].reshape(-1, 100).max(1)
        quiet = np.flatnonzero(blocks[10:-10] < 1e-3) + 10
        assert quiet[0] * 100 / factor == pytest.approx(8000, abs=700)
        assert quiet[-1] * 100 / factor == pytest.approx(12000, abs=700)
    assert len(stretch(np.zeros(0, np.float32), rate, 2.0)) == 0
    assert not stretch(np.ones(100, np.float32), rate, 2.0).any()


def test_a_timeline_gives_phones_without_time_their_least() -> None:
    timeline = Timeline(1000)
    phones = (Timed("AA", 0, 1, 0), Timed("M", 200, None, 0), Timed("B", 200, None, 0))
    timeline.add(Stretch(np.ones(200, np.float32), phones, ("am",)))
    utterance = timeline.utterance("am")
    track = utterance.track
    assert track is not None
    assert track.phones == (SILENCE, "AA", "M", "B", SILENCE)
    np.testing.assert_allclose(track.edges, [0, 0.05, 0.19, 0.22, 0.25, 0.3])
    assert track.words[0].text == "am"
    with pytest.raises(ValueError, match="without phones"):
        Timeline(1000).utterance("")


def test_a_timeline_cuts_the_silence_before_a_break() -> None:
    timeline = Timeline(1000)
    phones = (Timed("AA", 0), Timed(SILENCE, 100))
    timeline.add(Stretch(np.ones(150, np.float32), phones, ()))
    timeline.end_speech()
    timeline.silence(0.2)
    timeline.end_speech()
    timeline.silence(0.3)
    timeline.add(Stretch(np.ones(100, np.float32), (Timed("M", 0),), ()))
    track = timeline.utterance("").track
    assert track is not None
    np.testing.assert_allclose(track.edges, [0, 0.05, 0.15, 0.45, 0.55, 0.6])
    assert len(timeline.audio()) == 500
