"""Timings of other programs: the phones stand where the file says, and what is wrong is named."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.phones import BILABIALS, PHONES, SILENCE, phone_distance
from lipwright.streams import STREAMS, azure, known_streams, polly, read_timings, rhubarb
from lipwright.streams.labels import ipa_sounds
from lipwright.streams.placing import distance_to, matched, paced
from lipwright.streams.times import Timed, mend
from lipwright.track import PhoneTrack

Reader = Callable[..., PhoneTrack]
"""file name, content and more for `read_timings` to a track"""


@pytest.fixture
def reading(tmp_path: Path) -> Reader:
    """Writes an example and reads it."""

    def read(name: str, content: object, **more: Any) -> PhoneTrack:
        path = tmp_path / name
        text = content if isinstance(content, str) else json.dumps(content, ensure_ascii=False)
        path.write_text(text, "utf-8")
        return read_timings(path, **more)

    return read


def starts(track: PhoneTrack) -> list[tuple[str, float]]:
    """Each phone and its start to the ms."""
    return [(phone, round(start, 3)) for phone, start, _ in track]


def words(track: PhoneTrack) -> list[tuple[str, str]]:
    """Each word and its phones."""
    return [(word.text, " ".join(track.phones[word.first : word.stop])) for word in track.words]


def said_times(*rows: tuple[str, float, float]) -> list[dict[str, object]]:
    return [{"word": word, "start": start, "end": end} for word, start, end in rows]


# Mary had a little lamb, from the developer guide of Amazon Polly; times are facts of its example.
POLLY = "\n".join(
    json.dumps({"time": time, "type": kind, "value": value})
    for time, kind, value in (
        (0, "sentence", "Mary had a little lamb."),
        (6, "word", "Mary"), (6, "viseme", "p"), (73, "viseme", "E"), (180, "viseme", "r"),
        (292, "viseme", "i"),
        (373, "word", "had"), (373, "viseme", "k"), (460, "viseme", "a"), (521, "viseme", "t"),
        (604, "word", "a"), (604, "viseme", "@"),
        (643, "word", "little"), (643, "viseme", "t"), (739, "viseme", "i"), (769, "viseme", "t"),
        (799, "viseme", "t"),
        (882, "word", "lamb"), (882, "viseme", "t"), (964, "viseme", "a"), (1082, "viseme", "p"),
        (1300, "viseme", "sil"),
    )
)  # fmt: skip

AZURE_VISEMES: list[dict[str, Any]] = [
    {"audioOffset": ms * 10_000, "visemeId": name, "animation": ""}
    for ms, name in (
        (50, 0), (100, 12), (150, 4), (200, 14), (250, 8), (450, 0), (700, 21), (780, 1),
        (900, 21), (1000, 0),
    )
]  # fmt: skip
AZURE_WORDS: list[dict[str, Any]] = [
    {"audioOffset": 1_000_000, "duration": 3_500_000, "text": "Hello",
     "boundaryType": "WordBoundary"},
    {"audioOffset": 4_500_000, "duration": 1_000_000, "text": ",",
     "boundaryType": "PunctuationBoundary"},
    {"audioOffset": 7_000_000, "duration": 3_000_000, "text": "map",
     "boundaryType": "WordBoundary"},
]  # fmt: skip
GOOGLE = {
    "results": [
        {"alternatives": [{"transcript": "Bob mumbles", "words": [
            {"startTime": "0.100s", "endTime": "0.400s", "word": "Bob"},
            {"startTime": "0.400s", "endTime": "1.100s", "word": "mumbles."},
        ]}], "languageCode": "en-us"}
    ]
}  # fmt: skip
KOKORO: list[dict[str, Any]] = [
    {"text": "Bob", "phonemes": "bˈɑb", "whitespace": " ", "start_ts": 0.2, "end_ts": 0.5},
    {"text": "made", "phonemes": "mˌAd", "whitespace": " ", "start_ts": 0.5, "end_ts": 0.8},
    {"text": "pie", "phonemes": "pˈI", "whitespace": "", "start_ts": 0.8, "end_ts": 1.1},
    {"text": ".", "phonemes": ".", "whitespace": "", "start_ts": None, "end_ts": None},
]
MFA = {
    "start": 0,
    "end": 1.2,
    "tiers": {
        "words": {"type": "interval", "entries": [[0.1, 0.6, "my"], [0.8, 1.1, "spam"]]},
        "phones": {"type": "interval", "entries": [
            [0.1, 0.3, "mʲ"], [0.3, 0.6, "aj"], [0.8, 0.9, "s"], [0.9, 0.95, "p"],
            [0.95, 1.0, "æ"], [1.0, 1.1, "m"],
        ]},
    },
}  # fmt: skip
WHISPERX = {
    "segments": [
        {"start": 0.1, "end": 2.0, "text": " My map 25 spam.", "words": [
            {"word": "My", "start": 0.1, "end": 0.3, "score": 0.9},
            {"word": "map", "start": 0.32, "end": 0.7, "score": 0.8},
            {"word": "25"},
            {"word": "spam.", "start": 1.4, "end": 2.0, "score": 0.7},
        ]},
    ],
    "language": "en",
}  # fmt: skip
CUES = (("X", 0.0, 0.05), ("D", 0.05, 0.27), ("A", 0.27, 0.31), ("B", 0.31, 0.43), ("X", 0.43, 0.6))
RHUBARB = {
    "metadata": {"soundFile": "hi.wav", "duration": 0.6},
    "mouthCues": [{"start": a, "end": b, "value": shape} for shape, a, b in CUES],
}
RHUBARB_TSV = "".join(f"{start:.2f}\t{shape}\n" for shape, start, _ in CUES) + "0.60\tX\n"
RHUBARB_XML = (
    '<?xml version="1.0" encoding="utf-8"?>\n<rhubarbResult>\n<metadata>\n'
    "<soundFile>hi.wav</soundFile><duration>0.60</duration></metadata>\n<mouthCues>\n"
    + "".join(f'<mouthCue start="{a}" end="{b}">{shape}</mouthCue>\n' for shape, a, b in CUES)
    + "</mouthCues></rhubarbResult>"
)


def eleven(text: str, step: float = 0.1) -> dict[str, Any]:
    """An answer in which each character lasts `step` s."""
    edges = [round(step * index, 3) for index in range(len(text) + 1)]
    layer = {
        "characters": list(text),
        "character_start_times_seconds": edges[:-1],
        "character_end_times_seconds": edges[1:],
    }
    return {"audio_base64": "", "alignment": layer, "normalized_alignment": None}


EXAMPLES: dict[str, Any] = {
    ".azure.json": AZURE_VISEMES + AZURE_WORDS,
    ".polly.json": POLLY,
    ".marks": POLLY,
    ".google.json": GOOGLE,
    ".elevenlabs.json": eleven("Maybe Bob."),
    ".kokoro.json": KOKORO,
    ".mfa.json": MFA,
    ".mfa.csv": "Begin,End,Label,Type,Speaker\n0.1,0.4,hello,words,ann\n0.1,0.2,B,phones,ann\n"
    "0.2,0.4,OW1,phones,ann\n",
    ".whisperx.json": WHISPERX,
    ".rhubarb.json": RHUBARB,
    ".rhubarb.tsv": RHUBARB_TSV,
    ".rhubarb.xml": RHUBARB_XML,
}


def test_every_layout_has_an_example_with_closures_where_it_fills_the_sound(
    reading: Reader,
) -> None:
    assert EXAMPLES.keys() == STREAMS.keys() == known_streams().keys()
    for suffix, content in EXAMPLES.items():
        track = reading(f"a{suffix}", content, duration=2.5)
        assert (track.start, track.end) == (0.0, 2.5), suffix
        assert BILABIALS & set(track.phones), suffix


@pytest.mark.parametrize("suffix", [s for s in EXAMPLES if s.endswith(".json")])
def test_the_keys_of_json_tell_its_layout(reading: Reader, suffix: str) -> None:
    named, guessed = (reading(name, EXAMPLES[suffix]) for name in (f"a{suffix}", "a.json"))
    assert starts(named) == starts(guessed)
    others = {entry.module for key, entry in STREAMS.items() if key.endswith(".json")}
    content = EXAMPLES[suffix]
    if not isinstance(content, str):
        fitting = {module for module in others if import_module(module).fits(content)}
        assert fitting == {STREAMS[suffix].module}


def test_marks_of_polly_put_the_phones_of_its_words_on_its_visemes(reading: Reader) -> None:
    track = reading("mary.marks", POLLY, duration=1.5)
    assert starts(track)[:8] == [
        ("sil", 0.0), ("M", 0.006), ("EH", 0.073), ("R", 0.18), ("IY", 0.292), ("HH", 0.373),
        ("AE", 0.46), ("D", 0.521),
    ]  # fmt: skip
    assert starts(track)[-4:] == [("L", 0.882), ("AE", 0.964), ("M", 1.082), ("sil", 1.3)]
    assert [word for word, _ in words(track)] == ["mary", "had", "a", "little", "lamb"]


def test_visemes_without_words_are_the_phones_that_stand_for_them(reading: Reader) -> None:
    track = reading("a.azure.json", AZURE_VISEMES)
    assert starts(track) == [
        ("sil", 0.05), ("HH", 0.1), ("EH", 0.15), ("L", 0.2), ("OW", 0.25), ("sil", 0.45),
        ("P", 0.7), ("AH", 0.78), ("P", 0.9), ("sil", 1.0),
    ]  # fmt: skip


def test_words_of_azure_tell_which_bilabial_it_is(reading: Reader) -> None:
    track = reading("a.azure.json", {"visemes": AZURE_VISEMES, "words": AZURE_WORDS})
    assert ("M", 0.7) in starts(track)
    assert ("AE", 0.78) in starts(track)
    assert words(track)[1] == ("map", "M AE P")


@pytest.mark.parametrize(
    ("offset", "name", "scale"),
    [("audio_offset", "viseme_id", 1), ("AudioOffset", "VisemeId", 1),
     ("privAudioOffset", "privVisemeId", 1), ("audioOffsetMs", "visemeId", 1e-4)],
)  # fmt: skip
def test_field_names_of_every_sdk_of_azure_count(
    reading: Reader, offset: str, name: str, scale: float
) -> None:
    rows = [{offset: e["audioOffset"] * scale, name: e["visemeId"]} for e in AZURE_VISEMES]
    assert starts(reading("a.azure.json", rows)) == starts(reading("b.azure.json", AZURE_VISEMES))


def test_durations_of_azure_may_be_time_spans(reading: Reader) -> None:
    rows = [{"AudioOffset": 1_000_000, "Duration": "00:00:00.4000000", "Text": "Bob"}]
    track = reading("a.azure.json", rows)
    assert track.phones == ("B", "AA", "B")
    assert (track.start, track.end) == pytest.approx((0.1, 0.5))


@pytest.mark.parametrize("names", [("m", "ae", "p"), ("m", "æ", "p"), ("", "", "")])
def test_phonemes_of_an_assessment_are_used_or_their_times(
    reading: Reader, names: tuple[str, ...]
) -> None:
    phonemes = [
        {"Phoneme": name, "Offset": 1_000_000 * (index + 1), "Duration": 900_000}
        for index, name in enumerate(names)
    ]
    word = {"Word": "map", "Offset": 1_000_000, "Duration": 3_000_000, "Phonemes": phonemes}
    gone = {"Word": "gone", "PronunciationAssessment": {"ErrorType": "Omission"}}
    track = reading("a.json", {"RecognitionStatus": "Success", "NBest": [{"Words": [word, gone]}]})
    assert starts(track) == [("M", 0.1), ("AE", 0.2), ("P", 0.3)]
    assert words(track) == [("map", "M AE P")]


def test_a_word_of_google_fills_its_time_and_silence_the_rest(reading: Reader) -> None:
    track = reading("a.google.json", GOOGLE, duration=1.5)
    assert words(track) == [("bob", "B AA B"), ("mumbles", "M AH M B AH L Z")]
    assert starts(track)[0] == ("sil", 0.0)
    assert starts(track)[-1] == ("sil", 1.1)
    assert track.word_span(track.words[1]) == pytest.approx((0.4, 1.1))


def test_marks_of_google_are_words_that_end_where_the_next_begins(reading: Reader) -> None:
    marks = [{"markName": "Bob", "timeSeconds": 0.1}, {"markName": "mumbles", "timeSeconds": 0.5}]
    track = reading("a.json", {"timepoints": marks}, duration=2.0)
    assert track.word_span(track.words[0]) == pytest.approx((0.1, 0.5))
    assert track.phones[-1] == SILENCE
    assert track.edges[-2] < 1.5
    with pytest.raises(LipwrightError, match="timepoint 1: the mark 'mark_1' is not a word"):
        reading("b.json", {"timepoints": [{"markName": "mark_1", "timeSeconds": 0}]})


def test_closures_stand_on_their_letters(reading: Reader) -> None:
    track = reading("a.elevenlabs.json", eleven("Maybe Bob bakes a map."))
    found = [(phone, round(at, 2)) for phone, at in starts(track) if phone in BILABIALS]
    assert found == [("M", 0.0), ("B", 0.3), ("B", 0.6), ("B", 0.8), ("B", 1.0), ("M", 1.8),
                     ("P", 2.0)]  # fmt: skip


def test_a_long_gap_between_letters_is_silence(reading: Reader) -> None:
    answer = eleven("map, map", 0.1)
    answer["alignment"]["character_end_times_seconds"][3] = 0.45
    track = reading("a.json", answer)
    assert track.phones == ("M", "AE", "P", SILENCE, "M", "AE", "P")
    assert track.edges[3:5] == pytest.approx([0.3, 0.5])


@pytest.mark.parametrize(
    ("language", "text", "expected"),
    [("sv", "Mamma bakar", ["M AA M AA", "B AA K AA XR"]), ("cmn", "妈妈", ["M AA M AA"])],
)
def test_letters_are_said_in_the_language(
    reading: Reader, language: str, text: str, expected: list[str]
) -> None:
    track = reading("a.json", eleven(text), language=language)
    said = " ".join(phones for _, phones in words(track))
    assert said == " ".join(expected)


def test_phonemes_of_kokoro_are_used(reading: Reader) -> None:
    track = reading("a.kokoro.json", KOKORO)
    assert words(track) == [("Bob", "B AA B"), ("made", "M EY D"), ("pie", "P AY")]
    assert track.stress[:3] == (None, 1, None)
    captions = [
        {"word": row["text"], "start_time": row["start_ts"], "end_time": row["end_ts"]}
        for row in KOKORO[:3]
    ]
    told = reading("b.json", {"audio": "", "audio_format": "mp3", "timestamps": captions})
    assert told.phones == track.phones


def test_a_word_that_whisperx_could_not_time_is_between_its_neighbours(reading: Reader) -> None:
    track = reading("a.whisperx.json", WHISPERX, duration=2.3)
    assert [word for word, _ in words(track)] == ["my", "map", "twenty", "five", "spam"]
    assert track.word_span(track.words[2])[0] == pytest.approx(0.7)
    assert track.word_span(track.words[3])[1] == pytest.approx(1.4)


@pytest.mark.parametrize(
    "content",
    [
        {"text": "x", "segments": [{"id": 0, "start": 0.1, "end": 1.1,
         "words": said_times((" Bob", 0.1, 0.4), (" mumbles.", 0.4, 1.1))}]},
        {"segments": [{"start": 0.1, "end": 1.1,
         "words": [[0.1, 0.4, " Bob", 0.9], [0.4, 1.1, " mumbles.", 0.8]]}]},
        {"task": "transcribe", "words": said_times(("Bob", 0.1, 0.4), ("mumbles", 0.4, 1.1))},
    ],
    ids=["openai-whisper", "faster-whisper tuples", "verbose_json"],
)  # fmt: skip
def test_whispers_of_all_kinds_are_read(reading: Reader, content: object) -> None:
    assert starts(reading("a.json", content)) == starts(reading("b.json", GOOGLE))


def test_letters_of_whisperx_are_used(reading: Reader) -> None:
    chars: list[dict[str, object]] = [
        {"char": c, "start": at, "end": at + 0.1, "score": 1.0}
        for c, at in (("m", 0.1), ("a", 0.2), ("p", 0.4))
    ]
    chars.append({"char": "."})
    segment = {"start": 0.1, "end": 0.5, "text": "map.", "words": [], "chars": chars}
    track = reading("a.json", {"segments": [segment]})
    assert starts(track) == [("M", 0.1), ("AE", 0.2), ("P", 0.4)]


def test_diphthongs_of_mfa_are_one_phone_and_gaps_are_silence(reading: Reader) -> None:
    track = reading("a.mfa.json", MFA)
    assert track.phones == ("M", "AY", SILENCE, "S", "P", "AE", "M")
    assert words(track) == [("my", "M AY"), ("spam", "S P AE M")]


def test_a_textgrid_of_mfa_is_read_in_its_language(tmp_path: Path) -> None:
    def textgrid(name: str, labels: str) -> Path:
        rows = [f'{i * 0.1}\n{(i + 1) * 0.1}\n"{label}"' for i, label in enumerate(labels.split())]
        head = 'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n1\n<exists>\n1\n'
        text = f'{head}"IntervalTier"\n"phones"\n0\n1\n{len(rows)}\n' + "\n".join(rows)
        path = tmp_path / name
        path.write_text(text, "utf-8")
        return path

    english = textgrid("en.TextGrid", "spn ɹ aj t mʲ ow n̩ tʃ ɾʲ ɫ")
    assert " ".join(read_timings(english).phones) == "sil R AY T M OW EN CH DX L"
    swedish = textgrid("sv.TextGrid", "r ʉː t̪ ɧ yː ɕ ɖ")
    assert " ".join(read_timings(swedish, language="sv").phones) == "XR UX T XH XIY XC XD"
    mandarin = textgrid("cmn.TextGrid", "tɕʰ y˥˩ ʂ ʐ̩˥˩ p aj˨˩˦")
    assert " ".join(read_timings(mandarin, language="cmn").phones) == "XTC XIY XS XRI P AY"
    plain = textgrid("arpa.TextGrid", "B AA1 B")
    assert read_timings(plain, language="sv").phones == ("B", "AA", "B")


@pytest.mark.parametrize(
    ("language", "labels"),
    [
        ("en", "aj aw b bʲ c cʰ cʷ d dʒ dʲ d̪ ej f fʲ h i iː j k kʰ kʷ l m mʲ m̩ n n̩ ow p pʰ pʲ pʷ "
               "s t tʃ tʰ tʲ tʷ t̪ v vʲ w z æ ç ð ŋ ɐ ɑ ɑː ɒ ɒː ɔj ə əw ɚ ɛ ɛː ɜː ɝ ɟ ɟʷ ɡ ɡʷ ɪ ɫ "
               "ɫ̩ ɲ ɹ ɾ ɾʲ ɾ̃ ʃ ʉ ʉː ʊ ʎ ʒ ʔ θ"),
        ("sv", "a b d̪ eː f h iː j k l̪ m n̪ oː p r s̪ t̪ uː v yː øː œ ŋ ɑː ɔ ɕ ɖ ɛ ɛː ɡ ɧ ɪ ɭ ɳ ɵ "
               "ʂ ʈ ʉː ʊ ʏ"),
        ("cmn", "a˥˩ aj˥˩ aw˧˥ e˥ ej˨˩˦ f i˥˩ j k kʰ l m n ŋ o˥ ow˥˩ p pʰ s t ts tsʰ tɕ tɕʰ tʰ u˥˩ "
                "w x y˥ z̩˥˩ ə˥ ɕ ɥ ʂ ʈʂ ʈʂʰ ʐ ʐ̩˥˩ ʔ"),
    ],
)  # fmt: skip
def test_every_label_of_mfa_dictionaries_is_a_sound(language: str, labels: str) -> None:
    for label in labels.split():
        sounds = ipa_sounds(label, language)
        assert 1 <= len(sounds) <= 2, label
        assert (label[0] in "mpb") == (sounds[0].phone in BILABIALS), label


def test_the_layouts_of_rhubarb_agree(reading: Reader) -> None:
    tracks = [
        reading(f"a{suffix}", EXAMPLES[suffix])
        for suffix in (".rhubarb.json", ".rhubarb.tsv", ".rhubarb.xml")
    ]
    expected = [("sil", 0.0), ("AA", 0.05), ("M", 0.27), ("S", 0.31), ("sil", 0.43)]
    assert starts(tracks[0]) == expected
    assert starts(tracks[0]) == starts(tracks[1]) == starts(tracks[2])
    assert {round(track.end, 3) for track in tracks} == {0.6}


@pytest.mark.parametrize("layout", [azure, polly, rhubarb])
def test_visemes_name_phones_of_the_table_and_bilabials_only_at_closures(layout: Any) -> None:
    for phones in layout.VISEMES.values():
        assert set(phones) <= PHONES.keys()
        assert len(set(phones) & BILABIALS) in (0, len(phones))
    closed = [phones for phones in layout.VISEMES.values() if set(phones) & BILABIALS]
    assert {"P", "B", "M"} <= set(closed[0])
    said = {phone for phones in layout.VISEMES.values() for phone in phones}
    assert all(distance_to(phone, tuple(said)) < 3.0 for phone in PHONES)


def best_by_trying(phones: list[str], labels: list[str]) -> float:
    """The lowest cost of all one-to-one placings: every order-keeping way, tried."""
    picks = itertools.combinations(range(len(labels)), len(phones))
    return min(sum(phone_distance(p, labels[i]) for p, i in zip(phones, pick, strict=True))
               for pick in picks)  # fmt: skip


@given(st.lists(st.sampled_from(["P", "AA", "S", "UW", "F", "L"]), min_size=1, max_size=6))
def test_phones_on_their_own_visemes_stand_exactly_there(phones: list[str]) -> None:
    units = [Timed(phone, 0.1 * i, 0.1 * (i + 1), "u") for i, phone in enumerate(phones)]
    assert best_by_trying(phones, phones) == 0
    edges = matched(phones, units, phone_distance)
    assert edges == pytest.approx([0.1 * i for i in range(len(phones) + 1)])


def test_vowels_of_a_long_word_are_held_and_consonants_are_not() -> None:
    edges = np.array(paced(("M", "AA", "P"), 0.0, 5.0))
    assert edges[0] == 0.0
    assert edges[-1] == 5.0
    assert np.diff(edges)[1] > 4.5


def test_rounding_of_times_is_mended() -> None:
    rows = [Timed("a", -0.02, 0.13, "1"), Timed("b", 0.1, 0.29, "2"), Timed("c", 0.3, 0.52, "3")]
    mended = mend(Path("a"), rows, 0.5)
    assert [(row.start, row.end) for row in mended] == [(0.0, 0.1), (0.1, 0.3), (0.3, 0.5)]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([("a", 0.5, 0.9), ("b", 0.3, 0.5)], r"word 2 \('b', 0.300 s\): starts before word 1"),
        ([("a", 0.1, 0.9), ("b", 0.3, 1.5)], r"word 2 .*overlaps word 1"),
        ([("a", -0.2, 0.9)], r"word 1 .*starts before the sound does"),
        ([("a", 0.5, 0.2)], r"word 1 .*before its start"),
        ([("a", 0.5, 2.5)], r"word 1 .*reaches 2.500 s, past the end of the sound \(2.000 s\)"),
    ],
)
def test_wrong_times_name_the_entry(
    reading: Reader, rows: list[tuple[str, float, float]], message: str
) -> None:
    with pytest.raises(LipwrightError, match=message):
        reading("a.whisperx.json", {"words": said_times(*rows)}, duration=2.0)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.json", {"a": 1}, "neither a phone track"),
        ("a.json", "{", r"line 1, column 2: not JSON"),
        ("a.json", '{"words": [{"word": "a", "start": NaN, "end": 1}]}', "word 1: 'start' is nan"),
        ("a.json", "[" * 100_000, "nested too deeply"),
        ("a.azure.json", {"FrameIndex": 0, "BlendShapes": [[0.1]]}, "frames of blend shapes"),
        ("a.azure.json", [{"audioOffset": 0, "visemeId": 22}], "viseme 1 .*no such viseme"),
        ("a.azure.json", [{"visemeId": 1}], "viseme 1: 'audioOffset' is missing"),
        ("a.azure.json", [{"audioOffset": i * 100, "visemeId": 1} for i in range(9)], "ticks"),
        ("a.azure.json", {}, "no viseme events"),
        ("a.marks", '{"time": 1, "type": "ssml", "value": "x"}', "no marks of the types"),
        ("a.marks", '{"time": 1, "type": "word", "value": "x"}\n{"time"', "line 2, column 8"),
        ("a.google.json", {"results": [{"alternatives": [{}]}]}, "enableWordTimeOffsets"),
        ("a.google.json", {}, "neither 'timepoints'"),
        ("a.elevenlabs.json", {"alignment": {"characters": ["a"]}}, "seconds' is missing"),
        ("a.elevenlabs.json", [], "chunks of a stream"),
        ("a.kokoro.json", {}, "neither 'tokens'"),
        ("a.mfa.json", {"tiers": {}}, "has no phones"),
        ("a.mfa.csv", "Begin,End,Label\n", "no column 'Type'"),
        ("a.mfa.csv", "Begin,End,Label,Type\n0,1,?!7,phones\n", "line 2 .*no phone of ARPABET"),
        ("a.whisperx.json", {"segments": []}, "word timestamps"),
        ("a.whisperx.json", {"words": said_times(("...", 0, 1))}, "no words that can be said"),
        ("a.rhubarb.json", {}, "'mouthCues' is missing"),
        ("a.rhubarb.tsv", "0.0 A B\n", "line 1: 3 columns"),
        ("a.rhubarb.tsv", "0.0\tQ\n", "line 1 .*no such viseme"),
        ("a.rhubarb.xml", "<a/>", "no rhubarbResult"),
        ("a.rhubarb.xml", "<a>", "line 1: not XML"),
        ("a.rhubarb.xml", '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "document type"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_in_one_line(
    reading: Reader, name: str, content: object, message: str
) -> None:
    with pytest.raises(LipwrightError, match=message) as raised:
        reading(name, content)
    assert "\n" not in str(raised.value)
    assert name in str(raised.value)


def test_a_word_of_another_language_is_named_by_its_entry(reading: Reader) -> None:
    rows = said_times(("hello", 0.1, 0.5), ("妈妈", 0.5, 1.0))
    with pytest.raises(LipwrightError, match=r"a\.json: word 2"):
        reading("a.json", {"words": rows})


SCALARS = st.one_of(
    st.none(), st.booleans(), st.floats(), st.integers(-(10**12), 10**12),
    st.sampled_from(["hello", "map", "", "0.5s", "p", "sil", "X", "A", "\ud800", "word", "viseme"]),
    st.text(max_size=3),
)  # fmt: skip
KEYS = st.sampled_from(
    ["audioOffset", "visemeId", "text", "duration", "NBest", "Words", "Word", "Offset", "Duration",
     "Phonemes", "Phoneme", "time", "type", "value", "timepoints", "markName", "timeSeconds",
     "results", "alternatives", "words", "word", "startTime", "endTime", "alignment", "characters",
     "character_start_times_seconds", "character_end_times_seconds", "tokens", "timestamps",
     "start_ts", "end_ts", "phonemes", "tiers", "phones", "entries", "segments", "chars", "char",
     "start", "end", "mouthCues", "format", "BlendShapes", "animation", "response"]
)  # fmt: skip
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=5),
    max_leaves=20,
)
JSON_SUFFIXES = [".json", *(suffix for suffix in STREAMS if suffix.endswith("json"))]


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(content=VALUES, suffix=st.sampled_from(JSON_SUFFIXES), duration=st.sampled_from([None, 1.0]))
def test_any_json_is_a_track_or_one_clear_error(
    tmp_path_factory: pytest.TempPathFactory, content: object, suffix: str, duration: float | None
) -> None:
    path = tmp_path_factory.getbasetemp() / f"fuzz{suffix}"
    path.write_text(json.dumps(content))
    assert_track_or_error(path, duration)


def assert_track_or_error(path: Path, duration: float | None) -> None:
    """What is read is a track, or else the error is one line."""
    problem = ""
    try:
        assert len(read_timings(path, duration=duration)) > 0
    except LipwrightError as error:
        problem = str(error)
    assert "\n" not in problem


def damaged(content: Any, where: int, value: object) -> Any:
    """A copy in which one value of those inside is another."""
    places: list[tuple[Any, Any]] = []
    copy = json.loads(content) if isinstance(content, str) else json.loads(json.dumps(content))

    def gather(inside: Any) -> None:
        items = inside.items() if isinstance(inside, dict) else enumerate(inside)
        for key, child in list(items):
            places.append((inside, key))
            if isinstance(child, dict | list):
                gather(child)

    gather(copy)
    owner, key = places[where % len(places)]
    owner[key] = value
    return copy


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    suffix=st.sampled_from([s for s in JSON_SUFFIXES if not isinstance(EXAMPLES.get(s, ""), str)]),
    where=st.integers(0, 10**6),
    value=VALUES,
)
def test_a_damaged_example_is_a_track_or_one_clear_error(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, where: int, value: object
) -> None:
    path = tmp_path_factory.getbasetemp() / f"damaged{suffix}"
    path.write_text(json.dumps(damaged(EXAMPLES[suffix], where, value)))
    assert_track_or_error(path, 2.5)
