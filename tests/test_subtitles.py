"""Subtitles, read by FFmpeg, and WebVTT by Chromium too."""

from __future__ import annotations

import shutil
from itertools import pairwise
from pathlib import Path

import av
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import Performance, export_all
from lipwright.export.subtitles import LINE, LONGEST, READ, make_cues, srt_lines, vtt_lines
from lipwright.track import PhoneTrack, Word

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
CLIP = Clip(("jawOpen",), 30.0, np.zeros((300, 1)))

Read = list[tuple[float, float, str]]


def said(*words: tuple[str, float, float]) -> PhoneTrack:
    """A track of one vowel a word, with silence between those that do not meet."""
    phones: list[str] = []
    edges = [0.0]
    found = []
    for text, start, end in words:
        if start > edges[-1]:
            phones.append("sil")
            edges.append(start)
        found.append(Word(text, len(phones), len(phones) + 1))
        phones.append("AA")
        edges.append(end)
    return PhoneTrack(tuple(phones), np.array(edges), tuple(found))


def spoken(text: str, start: float = 0.5, each: float = 0.3) -> PhoneTrack:
    """The words of a text, one after the other."""
    words = text.split()
    return said(*((word, start + i * each, start + (i + 1) * each) for i, word in enumerate(words)))


def by_ffmpeg(path: Path) -> Read:
    found = []
    with av.open(str(path)) as container:
        stream = container.streams.subtitles[0]
        for packet in container.demux(stream):
            if packet.size:
                start = float(packet.pts * packet.time_base)
                text = bytes(packet).decode("utf-8")
                found.append((start, start + float(packet.duration * packet.time_base), text))
    return found


SENTENCE = spoken("tom & jerry <laugh> a > b and say so at length for as long as it takes them to")
PAUSES = said(
    ("hello", 0.578, 1.04), ("i", 1.728, 1.85), ("am", 1.85, 2.0004), ("one", 2.0004, 2.5),
    ("two", 4.0, 4.25), ("three", 4.25, 5.0),
)  # fmt: skip


class TestReaders:
    @pytest.mark.parametrize("suffix", [".srt", ".vtt"])
    @pytest.mark.parametrize("track", [SENTENCE, PAUSES], ids=["sentence", "pauses"])
    def test_ffmpeg_reads_all_words_at_their_times(
        self, tmp_path: Path, suffix: str, track: PhoneTrack
    ) -> None:
        path = tmp_path / f"a{suffix}"
        export_all(path, Performance(CLIP, track))
        found, cues = by_ffmpeg(path), make_cues(track)
        assert len(found) == len(cues)
        for (start, end, text), cue in zip(found, cues, strict=True):
            assert start == pytest.approx(cue.start, abs=0.0005 + 1e-9)
            assert end == pytest.approx(cue.end, abs=0.001 + 1e-9)
            lines = [" ".join(track.words[i].text for i in line) for line in cue.lines]
            if suffix == ".vtt":
                for letter, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;")):
                    lines = [line.replace(letter, entity) for line in lines]
            assert text.split("\n") == lines

    @pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
    def test_chromium_shows_the_words_of_webvtt(self) -> None:
        playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright")
        text = "".join(vtt_lines(SENTENCE, word_times=True))
        with playwright.sync_playwright() as player:
            browser = player.chromium.launch(
                executable_path=CHROMIUM, args=["--no-sandbox", "--headless"]
            )
            page = browser.new_page()
            found = page.evaluate(
                """(text) => new Promise((resolve, reject) => {
                    const video = document.createElement("video");
                    const track = document.createElement("track");
                    track.src = "data:text/vtt;charset=utf-8," + encodeURIComponent(text);
                    track.onload = () => resolve([...track.track.cues].map((cue) => [
                        cue.startTime, cue.endTime, cue.getCueAsHTML().textContent]));
                    track.onerror = () => reject(new Error("not read"));
                    video.append(track);
                    track.track.mode = "showing";
                    document.body.append(video);
                })""",
                text,
            )
            browser.close()
        cues = make_cues(SENTENCE)
        assert [cue[:2] for cue in found] == [
            pytest.approx([cue.start, cue.end], abs=0.001) for cue in cues
        ]
        words = " ".join(text.replace("\n", " ") for *_, text in found)
        assert words == " ".join(word.text for word in SENTENCE.words)


class TestText:
    def test_subrip_looks_like_this(self) -> None:
        assert "".join(srt_lines(PAUSES)) == (
            "1\n00:00:00,578 --> 00:00:01,578\nhello\n\n"
            "2\n00:00:01,728 --> 00:00:02,728\ni am one\n\n"
            "3\n00:00:04,000 --> 00:00:05,000\ntwo three\n\n"
        )

    def test_webvtt_looks_like_this_with_times_of_words_where_asked(self) -> None:
        text = "".join(vtt_lines(PAUSES, word_times=True))
        assert text.startswith("WEBVTT\n\n00:00:00.578 --> 00:00:01.578\nhello\n\n")
        assert "\ni <00:00:01.850>am <00:00:02.000>one\n" in text
        assert "<" not in "".join(vtt_lines(PAUSES))

    def test_an_arrow_is_no_time(self) -> None:
        track = said(("-->", 0.1, 0.5), ("so", 0.5, 0.9))
        assert "\n-> so\n" in "".join(srt_lines(track))
        assert "\n--&gt; so\n" in "".join(vtt_lines(track))

    def test_chinese_has_no_spaces_and_half_as_many_letters_a_line(self) -> None:
        track = spoken(" ".join(["你好", "世界", "我们"] * 12))
        texts = "".join(srt_lines(track)).split("\n")
        lines = [line for line in texts if line and ord(line[0]) > 255]
        assert "".join(lines) == "你好世界我们" * 12
        assert max(map(len, lines)) <= LINE / 2

    def test_hours_are_counted(self) -> None:
        track = said(("late", 3725.25, 3726.5))
        assert "01:02:05,250 --> 01:02:06,500" in "".join(srt_lines(track))


class TestCues:
    def test_they_end_at_full_stops_rather_than_within_a_phrase(self) -> None:
        track = spoken("This is the first sentence of them. And here, as ever, is the second one.")
        first, second = make_cues(track)
        assert [len(cue.lines) for cue in (first, second)] == [1, 1]
        assert sum(map(len, first.lines)) == 7

    def test_two_lines_are_about_as_long_as_each_other(self) -> None:
        (cue,) = make_cues(spoken("seven words of a line that is too long", each=0.2))
        assert len(cue.lines) == 1
        track = spoken("seven words of a line that is just too long now", each=0.2)
        (cue,) = make_cues(track)
        lengths = [len(" ".join(track.words[i].text for i in line)) for line in cue.lines]
        assert abs(lengths[0] - lengths[1]) <= 5

    @settings(max_examples=60, deadline=None)
    @given(st.integers(0, 2**32 - 1), st.integers(1, 80))
    def test_all_words_are_there_once_in_cues_that_fit_and_do_not_overlap(
        self, seed: int, count: int
    ) -> None:
        rng = np.random.default_rng(seed)
        words, now = [], 0.0
        for _ in range(count):
            now += float(rng.choice([0, 0, 0, 0.1, 0.4, 2.0]))
            end = now + float(rng.uniform(0.05, 0.6))
            words.append(
                ("x" * int(rng.integers(1, 12)) + str(rng.choice(["", "", ".", ","])), now, end)
            )
            now = end
        track = said(*words)
        cues = make_cues(track)
        assert [i for cue in cues for line in cue.lines for i in line] == list(range(count))
        for cue in cues:
            assert 1 <= len(cue.lines) <= 2
            for line in cue.lines:
                assert len(" ".join(words[i][0] for i in line)) <= LINE
            assert 0 < cue.end - cue.start <= LONGEST + 1e-9
            assert cue.start == words[cue.lines[0][0]][1]
        for before, after in pairwise(cues):
            assert before.end <= after.start

    def test_slow_speech_can_be_read(self) -> None:
        track = spoken("all of these words are said as slowly as they can be read by us", each=0.5)
        for cue in make_cues(track):
            text = " ".join(track.words[i].text for line in cue.lines for i in line)
            assert len(text) / (cue.end - cue.start) <= READ
            assert cue.end - cue.start >= 1.0

    def test_a_word_longer_than_a_line_stands_alone(self) -> None:
        long = "a" * 60
        cues = make_cues(said(("so", 0.1, 0.4), (long, 0.4, 1.4), ("then", 1.4, 1.8)))
        assert [cue.lines for cue in cues] == [((0,),), ((1,),), ((2,),)]


@pytest.mark.parametrize("suffix", [".srt", ".vtt"])
@pytest.mark.parametrize("track", [None, PhoneTrack(("AA",), np.array([0, 1.0]))])
def test_without_words_there_are_no_subtitles(
    tmp_path: Path, suffix: str, track: PhoneTrack | None
) -> None:
    with pytest.raises(LipwrightError, match="subtitles need words") as caught:
        export_all(tmp_path / f"a{suffix}", Performance(CLIP, track))
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
