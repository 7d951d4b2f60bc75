"""Phone tracks to and from files."""

from __future__ import annotations

import csv
import json
import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lipwright.errors import LipwrightError
from lipwright.formats import TRACK_FORMATS, known_formats, read_track, write_track
from lipwright.phones import PHONES, is_silence_label
from lipwright.track import PhoneTrack, Word

CORPORA = Path(__file__).parents[2] / "shared" / "corpora"
SUFFIXES = tuple(TRACK_FORMATS)
WITH_WORDS = (".textgrid", ".short.textgrid", ".lab", ".json")
RESOLUTION = {".ctm": 1e-6, ".lab": 1e-7, ".pho": 1e-6}  # s; the others are exact
IN_FOLDER = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=60
)

HELLO = PhoneTrack(
    ("sil", "HH", "AH", "L", "OW", "sil"),
    np.array([0.0, 0.1, 0.2, 0.28, 0.35, 0.42, 0.6]),
    (Word("hello", 1, 5, 0.9),),
    (None, None, 0, None, 1, None),
)


def same(one: PhoneTrack, other: PhoneTrack, resolution: float = 0.0) -> bool:
    return one.phones == other.phones and bool(
        (np.abs(one.edges - other.edges) <= resolution).all()
    )


def bare_words(track: PhoneTrack) -> list[tuple[str, int, int]]:
    return [(word.text, word.first, word.stop) for word in track.words]


def grid(*intervals: tuple[object, object, str], tier: str = "phones", more: str = "") -> str:
    """A short TextGrid with one tier, from 0 to 1 s."""
    rows = "\n".join(f'{start}\n{end}\n"{label}"' for start, end, label in intervals)
    tiers = f'"IntervalTier"\n"{tier}"\n0\n1\n{len(intervals)}\n{rows}\n'
    count = 1 + more.count("Tier")
    head = f'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n1\n<exists>\n{count}\n'
    return head + tiers + more


def error_of(path: Path, content: str | bytes, **options: float) -> str:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(LipwrightError) as caught:
        read_track(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


def track_or_message(path: Path, duration: float | None) -> PhoneTrack | str:
    try:
        return read_track(path, duration=duration)
    except LipwrightError as error:
        return str(error)


words_of_any_script = st.text(
    st.characters(exclude_categories=("Cs", "Cc", "Zs", "Zl", "Zp")), min_size=1, max_size=8
).filter(lambda text: text.split() == [text] and not is_silence_label(text))


@st.composite
def tracks(draw: st.DrawFn) -> PhoneTrack:
    """Any valid track of phones of 1 ms or more, with words that neither start nor end silent."""
    phones = draw(st.lists(st.sampled_from(tuple(PHONES)), min_size=1, max_size=12))
    lengths = st.floats(0.001, 100.0, allow_nan=False)
    durations = draw(st.lists(lengths, min_size=len(phones), max_size=len(phones)))
    start = draw(st.sampled_from([0.0, 0.25, 3600.5]))
    stress = [
        draw(st.sampled_from([None, 0, 1, 2])) if PHONES[p].is_vowel else None for p in phones
    ]
    cuts = sorted(draw(st.sets(st.integers(0, len(phones)), max_size=6)))
    words = []
    for first, stop in pairwise(cuts):
        spoken = phones[first] != "sil" and phones[stop - 1] != "sil"
        if spoken and draw(st.booleans()):
            words.append(Word(draw(words_of_any_script), first, stop))
    edges = start + np.concatenate([[0.0], np.cumsum(durations)])
    return PhoneTrack(tuple(phones), edges, tuple(words), tuple(stress))


class TestRoundTrip:
    @pytest.mark.parametrize("suffix", SUFFIXES)
    @IN_FOLDER
    @given(track=tracks())
    def test_a_written_track_reads_back_as_the_same_track(
        self, tmp_path: Path, suffix: str, track: PhoneTrack
    ) -> None:
        path = tmp_path / f"speech{suffix}"
        write_track(path, track)
        back = read_track(path)
        wanted = track.padded(0.0, track.end) if suffix == ".pho" else track
        assert same(back, wanted, RESOLUTION.get(suffix, 0.0))
        if suffix in WITH_WORDS:
            assert bare_words(back) == bare_words(track)
        if suffix != ".pho":
            assert back.stress == track.stress

    def test_json_keeps_the_confidence_of_words(self, tmp_path: Path) -> None:
        write_track(tmp_path / "hello.json", HELLO)
        assert read_track(tmp_path / "hello.json").words == HELLO.words

    @pytest.mark.parametrize("suffix", SUFFIXES)
    def test_every_phone_of_the_table_survives_every_format(
        self, tmp_path: Path, suffix: str
    ) -> None:
        track = PhoneTrack(tuple(PHONES), np.arange(len(PHONES) + 1) / 10)
        write_track(tmp_path / f"all{suffix}", track)
        assert same(read_track(tmp_path / f"all{suffix}"), track, 1e-6)

    @pytest.mark.parametrize("suffix", [".ctm", ".lab", ".pho"])
    def test_a_phone_shorter_than_the_resolution_is_refused_and_nothing_written(
        self, tmp_path: Path, suffix: str
    ) -> None:
        track = PhoneTrack(("AA", "B"), np.array([0.0, 1e-9, 1.0]))
        with pytest.raises(LipwrightError, match="phone 1 is too short"):
            write_track(tmp_path / f"a{suffix}", track)
        assert list(tmp_path.iterdir()) == []


class TestChoice:
    def test_capitals_of_a_suffix_do_not_count(self, tmp_path: Path) -> None:
        write_track(tmp_path / "a.TextGrid", HELLO)
        assert "intervals [1]" in (tmp_path / "a.TextGrid").read_text()

    def test_the_longest_suffix_wins(self, tmp_path: Path) -> None:
        write_track(tmp_path / "a.short.TextGrid", HELLO)
        assert "intervals" not in (tmp_path / "a.short.TextGrid").read_text()

    def test_a_named_format_goes_before_the_suffix(self, tmp_path: Path) -> None:
        write_track(tmp_path / "a.txt", HELLO, "ctm")
        assert same(read_track(tmp_path / "a.txt", ".CTM"), HELLO, 1e-6)

    def test_the_ctm_names_the_recording_after_the_file(self, tmp_path: Path) -> None:
        write_track(tmp_path / "my speech.ctm", HELLO)
        assert (tmp_path / "my speech.ctm").read_text().startswith("my_speech 1 0.000000 ")

    @pytest.mark.parametrize("name", ["a.xyz", "a", ".ctm"])
    def test_an_unknown_suffix_lists_the_known_ones(self, tmp_path: Path, name: str) -> None:
        with pytest.raises(LipwrightError) as caught:
            read_track(tmp_path / name)
        assert all(suffix in str(caught.value) for suffix in known_formats())

    def test_an_unknown_format_lists_the_known_ones(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match=r"no phone track format 'elan'.*\.textgrid"):
            read_track(tmp_path / "a.ctm", "elan")


class TestFiles:
    def test_a_missing_file_is_named(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match=r"none\.ctm: no such file"):
            read_track(tmp_path / "none.ctm")

    def test_a_folder_is_refused(self, tmp_path: Path) -> None:
        (tmp_path / "a.ctm").mkdir()
        with pytest.raises(LipwrightError, match="is a folder"):
            read_track(tmp_path / "a.ctm")
        with pytest.raises(LipwrightError, match="is a folder"):
            write_track(tmp_path / "a.ctm", HELLO)

    def test_text_of_another_encoding_names_the_byte(self, tmp_path: Path) -> None:
        assert error_of(tmp_path / "a.lab", b"0 1 \xe9\n") == (
            "byte 4: not UTF-8 text; save the file as UTF-8"
        )

    @pytest.mark.parametrize("suffix", SUFFIXES)
    def test_an_empty_file_is_refused(self, tmp_path: Path, suffix: str) -> None:
        error_of(tmp_path / f"a{suffix}", b"")

    def test_a_word_with_a_control_character_is_refused_by_its_place(self, tmp_path: Path) -> None:
        path = tmp_path / "a.lab"
        path.write_text("0 1000000 HH 0 a\bb\n1000000 2000000 AH\n")
        with pytest.raises(
            LipwrightError, match=r"a\.lab: line 1 .* the word 'a\\x08b' has a control"
        ):
            read_track(path)

    def test_a_word_that_is_no_text_cannot_be_in_a_track(self) -> None:
        with pytest.raises(ValueError, match="has a control character or half a letter"):
            PhoneTrack(("AA",), np.array([0.0, 1.0]), (Word("\ud800", 0, 1),))


class TestSound:
    """The track over the whole of a sound."""

    @pytest.mark.parametrize("suffix", SUFFIXES)
    def test_silence_fills_what_the_file_does_not_cover(self, tmp_path: Path, suffix: str) -> None:
        track = PhoneTrack(("HH", "AH"), np.array([0.2, 0.3, 0.5]))
        write_track(tmp_path / f"a{suffix}", track)
        fitted = read_track(tmp_path / f"a{suffix}", duration=1.0)
        assert same(fitted, track.padded(0.0, 1.0), 1e-6)

    @pytest.mark.parametrize("suffix", SUFFIXES)
    def test_up_to_50_ms_past_the_end_are_cut(self, tmp_path: Path, suffix: str) -> None:
        write_track(tmp_path / f"a{suffix}", HELLO)
        fitted = read_track(tmp_path / f"a{suffix}", duration=0.56)
        assert fitted.phones == HELLO.phones
        assert fitted.end == 0.56

    @pytest.mark.parametrize("suffix", SUFFIXES)
    def test_more_is_an_error_that_names_place_and_time(self, tmp_path: Path, suffix: str) -> None:
        write_track(tmp_path / f"a{suffix}", HELLO)
        message = error_of(
            tmp_path / f"a{suffix}", (tmp_path / f"a{suffix}").read_bytes(), duration=0.36
        )
        assert re.search(r"(interval|line|phone) 5\b", message)
        assert "(0.350 s): ends at 0.420 s, past the end of the sound (0.360 s)" in message

    def test_a_word_whose_phones_are_all_cut_is_cut_too(self, tmp_path: Path) -> None:
        track = PhoneTrack(
            ("AA", "B"), np.array([0.0, 0.5, 0.53]), (Word("ah", 0, 1), Word("b", 1, 2))
        )
        write_track(tmp_path / "a.json", track)
        assert bare_words(read_track(tmp_path / "a.json", duration=0.5)) == [("ah", 0, 1)]

    @IN_FOLDER
    @given(track=tracks(), duration=st.floats(0.001, 2000.0))
    def test_a_fitted_track_covers_the_sound_exactly_or_is_refused(
        self, tmp_path: Path, track: PhoneTrack, duration: float
    ) -> None:
        write_track(tmp_path / "a.json", track)
        fitted = track_or_message(tmp_path / "a.json", duration)
        if isinstance(fitted, PhoneTrack):
            assert (fitted.start, fitted.end) == (0.0, duration)
        else:
            assert "past the end of the sound" in fitted
            assert track.end > duration


class TestTextGrid:
    @pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
    @pytest.mark.parametrize("suffix", [".textgrid", ".short.textgrid"])
    @pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
    def test_both_forms_read_in_every_encoding(
        self, tmp_path: Path, encoding: str, suffix: str, ending: str
    ) -> None:
        write_track(tmp_path / f"a{suffix}", HELLO)
        text = (tmp_path / f"a{suffix}").read_text(encoding="utf-8").replace("\n", ending)
        (tmp_path / f"b{suffix}").write_bytes(text.encode(encoding))
        back = read_track(tmp_path / f"b{suffix}")
        assert same(back, HELLO)
        assert bare_words(back) == [("hello", 1, 5)]

    def test_big_endian_utf_16_reads(self, tmp_path: Path) -> None:
        text = grid((0, 1, "ɑ"))
        (tmp_path / "a.TextGrid").write_bytes(b"\xfe\xff" + text.encode("utf-16-be"))
        assert read_track(tmp_path / "a.TextGrid").phones == ("AA",)

    @pytest.mark.parametrize(
        "tier", ["phones", "Phone", "PHONEMES", " segments ", "anna - phones", "a - b - Phones"]
    )
    def test_the_usual_names_of_a_phone_tier_are_known(self, tmp_path: Path, tier: str) -> None:
        (tmp_path / "a.TextGrid").write_text(grid((0, 0.5, "B"), (0.5, 1, "AA1"), tier=tier))
        assert read_track(tmp_path / "a.TextGrid").phones == ("B", "AA")

    def test_point_tiers_comments_and_decoration_are_passed_over(self, tmp_path: Path) -> None:
        points = '"TextTier"\n"bell "" tones"\n0\n1\n1\n0.5\n"H* ! <exists> 7"\n'
        text = grid((0, 1, "AA1"), more=points).replace(
            "\n0\n1\n<", '\n! "no" 5 <x>\nfrom 0 s to 1 [7] <', 1
        )
        (tmp_path / "a.TextGrid").write_text(text)
        assert read_track(tmp_path / "a.TextGrid").phones == ("AA",)

    def test_an_empty_label_is_silence(self, tmp_path: Path) -> None:
        (tmp_path / "a.TextGrid").write_text(grid((0, 0.5, ""), (0.5, 1, "AA1")))
        assert read_track(tmp_path / "a.TextGrid").phones == ("sil", "AA")

    @pytest.mark.parametrize("labels", [("HH", "ER1"), ("h", "ɝ"), ("h", "3`"), ("hh", "er0")])
    def test_the_alphabet_is_that_of_the_whole_tier(
        self, tmp_path: Path, labels: tuple[str, str]
    ) -> None:
        (tmp_path / "a.TextGrid").write_text(grid((0, 0.5, labels[0]), (0.5, 1, labels[1])))
        assert read_track(tmp_path / "a.TextGrid").phones == ("HH", "ER")

    def test_words_take_the_phones_whose_middle_they_span(self, tmp_path: Path) -> None:
        rows = '0\n0.43\n"New  York"\n0.43\n0.98\n"bee"\n0.98\n1\n"x"\n'
        words = f'"IntervalTier"\n"words"\n0\n1\n3\n{rows}'
        phones = grid((0, 0.4, "N"), (0.4, 0.7, "B"), (0.7, 1, "IY1"), more=words)
        (tmp_path / "a.TextGrid").write_text(phones)
        assert bare_words(read_track(tmp_path / "a.TextGrid")) == [
            ("New_York", 0, 1), ("bee", 1, 3),
        ]  # fmt: skip

    def test_the_words_of_the_phones_speaker_are_taken(self, tmp_path: Path) -> None:
        words = "".join(
            f'"IntervalTier"\n"{who} - words"\n0\n1\n1\n0\n1\n"{who}"\n' for who in ("bo", "anna")
        )
        (tmp_path / "a.TextGrid").write_text(grid((0, 1, "AA1"), tier="anna - phones", more=words))
        assert bare_words(read_track(tmp_path / "a.TextGrid")) == [("anna", 0, 1)]

    def test_times_that_differ_by_rounding_meet(self, tmp_path: Path) -> None:
        (tmp_path / "a.TextGrid").write_text(grid((0, 0.5, "B"), (0.5004, 1, "AA1")))
        assert read_track(tmp_path / "a.TextGrid").edges.tolist() == [0, 0.5004, 1]

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            (grid((0, 0.4, "B"), (0.5, 1, "AA1")),
             "tier 'phones', interval 2 (0.500 s): a gap of 0.100 s lies before it, after tier "
             "'phones', interval 1; close it, or label it as silence"),
            (grid((0, 0.5, "B"), (0.4, 1, "AA1")),
             "tier 'phones', interval 2 (0.400 s): overlaps tier 'phones', interval 1, which ends "
             "at 0.500 s; let each phone start where the last one ends"),
            (grid((0, 0.5, "B"), (0.5, 1, "QX")),
             "tier 'phones', interval 2 (0.500 s): unknown arpabet phone 'QX'; correct it "
             "('lipwright phones' lists the known ones)"),
            (grid((0, 0.3, "ɑ"), (0.3, 0.5, "ʃ"), (0.5, 1, "ᴥ")),
             "tier 'phones', interval 3 (0.500 s): unknown ipa phone 'ᴥ'; correct it "
             "('lipwright phones' lists the known ones)"),
            (grid((0.5, 0.5, "B")),
             "tier 'phones', interval 1 (0.500 s): ends at 0.500 s, not after its start; correct "
             "its times or delete it"),
            (grid((0, 1, "B"), tier="fones"),
             "has no interval tier 'phones' (its interval tiers: 'fones'); rename the one that "
             "holds the phones to 'phones'"),
            (grid((0, 1, "B"), more='"IntervalTier"\n"Phones"\n0\n1\n0\n'),
             "has several phone tiers ('phones', 'Phones'); keep one of them"),
            (grid(), "tier 'phones' is empty; align the sound again"),
            (grid((0, "x", "B")),
             "line 15: tier 'phones', interval 1: the end time is missing, found 'B'; save the "
             "file again from Praat as a text file"),
            (grid((0, 1, "B")).replace('"phones"\n0\n1\n1', '"phones"\n0\n1\n999999999'),
             "line 16: tier 'phones', interval 2: the start time is missing, found the end of the "
             "file; save the file again from Praat as a text file"),
            (grid((0, "1e308", "B")),
             "tier 'phones', interval 1: its times, 0 to 1e+308 s, are not between 0 and 1e+06 s; "
             "correct them"),
            (grid((0, "9" * 400, "B")),
             "tier 'phones', interval 1: the end time is '999999999999999999999999', not a number; "
             "correct it"),
            (grid((0, 1, "B")).replace('"B"', '"B'),
             "line 15: tier 'phones', interval 1: the quote that ends the text is missing, found "
             "none; save the file again from Praat as a text file"),
            ("0 1 B\n",
             "line 1: header: the file type \"ooTextFile\" is missing, found '0'; "
             "save the file again from Praat as a text file"),
        ],
    )  # fmt: skip
    def test_an_error_names_tier_interval_time_and_remedy(
        self, tmp_path: Path, text: str, expected: str
    ) -> None:
        assert error_of(tmp_path / "a.TextGrid", text) == expected

    def test_a_negative_time_is_refused(self, tmp_path: Path) -> None:
        assert "interval 1: its times, -1 to 1 s" in error_of(
            tmp_path / "a.TextGrid", grid((-1, 1, "B"))
        )

    def test_a_binary_file_is_named_as_such(self, tmp_path: Path) -> None:
        message = error_of(tmp_path / "a.TextGrid", b"ooBinaryFile\x08TextGrid\0\0")
        assert message == "a binary TextGrid; open it in Praat and save it as a text file"

    @pytest.mark.skipif(not CORPORA.is_dir(), reason="the shared corpora are not here")
    def test_labels_set_by_hand_survive_as_a_tier(self, tmp_path: Path) -> None:
        with (CORPORA / "aligned-phones" / "msajc012.tsv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file, delimiter="\t"))
        # The corpus writes w as ɥ; its neighbours overlap by its rounding, 50 µs.
        labels = [(row["start_s"], row["end_s"], row["ipa"].replace("ɥ", "w")) for row in rows]
        (tmp_path / "a.TextGrid").write_text(grid(*labels), encoding="utf-8")
        track = read_track(tmp_path / "a.TextGrid")
        assert len(track) == len(rows)
        assert track.edges[:-1].tolist() == [float(row["start_s"]) for row in rows]


class TestCtm:
    def test_a_gap_is_silence_and_kaldis_word_positions_are_dropped(self, tmp_path: Path) -> None:
        (tmp_path / "a.ctm").write_text(
            ";; made by Kaldi\nutt 1 0.10 0.20 HH_B 0.99\n\nutt 1 0.30 0.10 AY1_E\n"
            "utt 1 0.5 .1 AA0_S\n"
        )
        track = read_track(tmp_path / "a.ctm")
        assert track.phones == ("HH", "AY", "sil", "AA")
        assert track.edges == pytest.approx([0.1, 0.3, 0.4, 0.5, 0.6])
        assert track.stress == (None, 1, None, 0)

    def test_an_overlap_up_to_5_ms_is_rounding(self, tmp_path: Path) -> None:
        (tmp_path / "a.ctm").write_text("u 1 0 0.204 B\nu 1 0.2 0.1 AA1\n")
        assert read_track(tmp_path / "a.ctm").edges == pytest.approx([0, 0.2, 0.3])

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("u 1 0 0.21 B\nu 1 0.2 0.1 AA1\n",
             "line 2 (0.200 s): overlaps line 1, which ends at 0.210 s; let each phone start where "
             "the last one ends"),
            ("u 1 0 0.2 B\nv 1 0.2 0.1 AA1\n",
             "line 2: a second utterance, 'v 1' after 'u 1'; keep one utterance and channel in a "
             "file"),
            ("u 1 0 0.2\n",
             "line 1: 4 columns; write 'file channel start duration phone', with or without a "
             "confidence"),
            ("u 1 zero 0.2 B\n", "line 1: the start is 'zero', not a number; correct it"),
            ("u 1 0 nan B\n", "line 1: the duration is 'nan', not a number; correct it"),
            ("u 1 0 0 B\n",
             "line 1 (0.000 s): ends at 0.000 s, not after its start; correct its times or delete "
             "it"),
            (";; nothing\n", "holds no phones; align the sound again"),
        ],
    )  # fmt: skip
    def test_an_error_names_line_and_remedy(self, tmp_path: Path, text: str, expected: str) -> None:
        assert error_of(tmp_path / "a.ctm", text) == expected


class TestHtk:
    def test_units_of_100_ns_scores_words_and_windows_lines(self, tmp_path: Path) -> None:
        (tmp_path / "a.lab").write_bytes(
            b"0 2000000 sil -12.5 sil\r\n2000000 3000000 dh -3 the\r\n3000000 3500000 ah0 -4\r\n"
            b"3500000 3600000 sp -1\r\n3600000 5000000 k -3 cat\r\n"
        )
        track = read_track(tmp_path / "a.lab")
        assert track.phones == ("sil", "DH", "AH", "sil", "K")
        assert track.edges == pytest.approx([0, 0.2, 0.3, 0.35, 0.36, 0.5])
        assert bare_words(track) == [("the", 1, 3), ("cat", 4, 5)]

    def test_decimals_are_seconds(self, tmp_path: Path) -> None:
        (tmp_path / "a.lab").write_text("0 0.25 B b\n0.25 1 IY1\n")
        track = read_track(tmp_path / "a.lab")
        assert track.edges.tolist() == [0, 0.25, 1]
        assert bare_words(track) == [("b", 0, 2)]

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("0 1000000 B\n2000000 3000000 AA1\n",
             "line 2 (0.200 s): a gap of 0.100 s lies before it, after line 1; close it, or label "
             "it as silence"),
            ("0 1000000\n",
             "line 1: 2 columns; write 'start end phone', then a score and the word if there are "
             "any"),
            ("#!MLF!#\n",
             "line 1: a master label file; write one label file for each recording"),
            ("0 1e999 B\n", "line 1: the end is '1e999', not a number; correct it"),
        ],
    )  # fmt: skip
    def test_an_error_names_line_and_remedy(self, tmp_path: Path, text: str, expected: str) -> None:
        assert error_of(tmp_path / "a.lab", text) == expected


class TestMbrola:
    def test_pitch_comments_and_flush_marks_are_passed_over(self, tmp_path: Path) -> None:
        (tmp_path / "a.pho").write_text(
            "; hello\n_ 51 25 114\nh 62.5\n@ 48 10 120 90 115\nl 66\n@U 100\n_ 0\n#\n"
        )
        track = read_track(tmp_path / "a.pho")
        assert track.phones == ("sil", "HH", "AX", "L", "OW")
        assert track.edges == pytest.approx([0, 0.051, 0.1135, 0.1615, 0.2275, 0.3275])

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("_ 10\nh\n", "line 2: 'h' has no duration; write 'symbol milliseconds'"),
            ("_ 10\nh 0\n", "line 2: 'h' lasts 0 ms; give it a time above 0"),
            ("_ 10\nh -5\n", "line 2: 'h' lasts -5 ms; give it a time above 0"),
            ("_ 10\n&& 5\n",
             "line 2 (0.010 s): unknown arpabet phone '&&'; correct it ('lipwright phones' lists "
             "the known ones)"),
            ("_ 1e15\n",
             "line 1: its times, 0 to 1e+12 s, are not between 0 and 1e+06 s; correct them"),
        ],
    )  # fmt: skip
    def test_an_error_names_line_and_remedy(self, tmp_path: Path, text: str, expected: str) -> None:
        assert error_of(tmp_path / "a.pho", text) == expected


class TestJson:
    HEAD = '{"format": "lipwright-track", "version": 1, '

    def test_the_fields_that_may_be_left_out(self, tmp_path: Path) -> None:
        (tmp_path / "a.json").write_text(self.HEAD + '"phones": ["AA"], "edges": [0, 1]}')
        track = read_track(tmp_path / "a.json")
        assert (track.words, track.stress) == ((), (None,))

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("{", "line 1, column 2: not JSON: "),
            ("[" * 100_000, "nested too deeply or a number too long; correct it"),
            (HEAD + '"edges": [' + "9" * 5000 + "]}",
             "nested too deeply or a number too long; correct it"),
            ("[]", 'names no format; expected "format": "lipwright-track"'),
            ('{"format": "lipwright-clip"}',
             "is of the format 'lipwright-clip'; expected \"format\": \"lipwright-track\""),
            ('{"format": "lipwright-track", "version": 2}',
             "is of version 2 of lipwright-track, not 1; write it again with this version of "
             "Lipwright, or update Lipwright"),
            (HEAD + '"phones": ["AA"]}', "'edges' is missing; correct it"),
            (HEAD + '"phones": "AA"}', "'phones' is not a list; correct it"),
            (HEAD + '"phones": ["AA", "AA1"]}', "phone 2 is 'AA1', not in the phone table; "),
            (HEAD + '"phones": ["AA"], "edges": [0, NaN]}', "holds NaN, which is no number"),
            (HEAD + '"phones": ["AA"], "edges": [0, 1e999]}', "edge 2 is inf, not a time in s "),
            (HEAD + '"phones": ["AA"], "edges": [0, true]}', "edge 2 is True, not a time in s "),
            (HEAD + '"phones": ["AA"], "edges": [1, 0.5]}', "edge 2 (0.500 s) is not after the "),
            (HEAD + '"phones": ["AA"], "edges": [1]}', "has 1 edges for 1 phones; write 2"),
            (HEAD + '"phones": [], "edges": [0]}', "a phone track has at least one phone; "),
            (HEAD + '"phones": [], "phones": []}', "the key 'phones' stands twice; delete one"),
            (HEAD + '"phones": ["AA"], "edges": [0, 1], "stress": [true]}', "stress holds other "),
            (HEAD + '"phones": ["AA"], "edges": [0, 1], "words": [{"text": "a", "first": 0}]}',
             "word 1 is \"{'text': 'a', 'first': 0}\"; write text, first, stop and, if known, "),
            (HEAD + '"phones": ["AA"], "edges": [0, 1], '
             '"words": [{"text": "a", "first": 0, "stop": 2}]}',
             "word 'a' is out of order or out of the track; "),
        ],
    )  # fmt: skip
    def test_an_error_names_the_field_and_the_remedy(
        self, tmp_path: Path, text: str, expected: str
    ) -> None:
        assert error_of(tmp_path / "a.json", text).startswith(expected)


def read_or_refuse(path: Path, content: bytes, duration: float | None = None) -> None:
    """Whatever a file holds, it is a track or one clear line."""
    path.write_bytes(content)
    result = track_or_message(path, duration)
    if isinstance(result, str):
        assert result.startswith(f"{path}: ")
        assert "\n" not in result


NUMBERS = (
    "9" * 400,
    "nan",
    "-1",
    "1e308",
    "-1e308",
    "1e999",
    "999999999",
    "0",
    "",
    "٣",
    "1_0",
    "0x10",
    "−1",
)


@pytest.mark.parametrize("suffix", SUFFIXES)
class TestFuzz:
    @IN_FOLDER
    @given(content=st.binary(max_size=300))
    def test_any_bytes(self, tmp_path: Path, suffix: str, content: bytes) -> None:
        read_or_refuse(tmp_path / f"a{suffix}", content)

    @IN_FOLDER
    @given(content=st.text(max_size=300))
    def test_any_text(self, tmp_path: Path, suffix: str, content: str) -> None:
        read_or_refuse(tmp_path / f"a{suffix}", content.encode("utf-8", "replace"))

    @settings(IN_FOLDER, max_examples=200)
    @given(data=st.data())
    def test_a_valid_file_with_some_things_changed(
        self, tmp_path: Path, suffix: str, data: st.DataObject
    ) -> None:
        path = tmp_path / f"a{suffix}"
        write_track(path, HELLO)
        pieces = re.split(r"([-\w.]+)", path.read_text(encoding="utf-8"))
        for _ in range(data.draw(st.integers(1, 3))):
            at = data.draw(st.integers(0, len(pieces) - 1))
            change = data.draw(st.sampled_from(["drop", "twice", "number", "text"]))
            if change == "drop":
                pieces[at] = ""
            elif change == "twice":
                pieces[at] *= 2
            elif change == "number":
                pieces[at] = data.draw(st.sampled_from(NUMBERS))
            else:
                pieces[at] = data.draw(st.text(max_size=5))
        content = "".join(pieces).encode("utf-8", "replace")
        read_or_refuse(path, content, data.draw(st.sampled_from([None, 0.58, 5.0])))


@IN_FOLDER
@given(
    value=st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=4),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner),
        max_leaves=8,
    ),
    key=st.sampled_from(["phones", "edges", "stress", "words", "format", "version"]),
    at=st.integers(0, 5),
)
def test_any_json_value_in_any_field(tmp_path: Path, value: object, key: str, at: int) -> None:
    write_track(tmp_path / "a.json", HELLO)
    content = json.loads((tmp_path / "a.json").read_text())
    if isinstance(content[key], list) and at < len(content[key]):
        content[key][at] = value
    else:
        content[key] = value
    read_or_refuse(tmp_path / "a.json", json.dumps(content).encode())
