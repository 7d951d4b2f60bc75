"""Moho's switch data and Papagayo's files, read by their published layouts and by another tool."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.export import Performance, export_all
from lipwright.retarget.shapes import choose_shapes
from lipwright.rig import load_rig
from lipwright.track import PhoneTrack, Word

RIG = load_rig("preston-blair")
SAID = [("rest", 0.5), ("AI", 0.25), ("MBP", 0.1), ("AI", 0.2), ("rest", 0.9), ("U", 0.25),
        ("FV", 0.15), ("rest", 0.5)]  # fmt: skip
TRACK = PhoneTrack(
    ("sil", "AA", "M", "AA", "sil", "UW", "F", "sil"),
    np.array([0, 0.55, 0.75, 0.85, 1.0, 2.0, 2.2, 2.3, 2.85]),
    (Word("ah", 1, 2), Word("ma", 2, 4), Word("oof", 5, 7)),
)


def spoken(fps: float = 60.0) -> Clip:
    names = [name for name, seconds in SAID for _ in range(round(seconds * fps))]
    return Clip(CANONICAL, fps, RIG.look_of([*names, "rest"]))


def switches(path: Path) -> list[tuple[int, str]]:
    first, *lines = path.read_text("utf-8").splitlines()
    assert first == "MohoSwitch1"
    return [(int(frame), name) for frame, name in (line.split() for line in lines)]


@dataclass
class PapagayoWord:
    text: str
    first: int
    last: int
    phonemes: list[tuple[int, str]] = field(default_factory=list)


@dataclass
class Papagayo:
    """What Papagayo reads, line by line."""

    sound: str
    fps: int
    frames: int
    text: str
    phrases: list[tuple[str, int, int, list[PapagayoWord]]]

    def shown(self, frame: int) -> str:
        """As Papagayo plays it."""
        for _, first, last, words in self.phrases:
            for word in words if first <= frame <= last else []:
                if word.first <= frame <= word.last:
                    return [name for start, name in word.phonemes if start <= frame][-1]
        return "rest"


def read_papagayo(path: Path) -> Papagayo:
    lines = iter(path.read_text("utf-8").splitlines())

    def line(tabs: int) -> str:
        text = next(lines)
        assert text.startswith("\t" * tabs)
        assert not text.startswith("\t" * (tabs + 1))
        return text[tabs:]

    assert line(0) == "lipsync version 1"
    sound, fps, frames, voices = line(0), int(line(0)), int(line(0)), int(line(0))
    assert voices == 1
    assert line(1) == "Voice 1"
    found = Papagayo(sound, fps, frames, line(1), [])
    for _ in range(int(line(1))):
        text, first, last, words = line(2), int(line(2)), int(line(2)), []
        for _ in range(int(line(2))):
            name, start, end, count = line(3).split()
            words.append(PapagayoWord(name, int(start), int(end)))
            for _ in range(int(count)):
                frame, phoneme = line(4).split()
                words[-1].phonemes.append((int(frame), phoneme))
        found.phrases.append((text, first, last, words))
    assert next(lines, None) is None
    return found


class TestMoho:
    def test_frames_count_from_1_at_24_a_second_and_the_last_line_closes(
        self, tmp_path: Path
    ) -> None:
        path = tmp_path / "a.dat"
        export_all(path, Performance(spoken(), TRACK))
        *found, last = switches(path)
        chosen = choose_shapes(spoken(), RIG, TRACK)
        assert [name for _, name in found] == [name for name, _ in SAID]
        for (frame, name), shape in zip(found, chosen, strict=True):
            assert name == shape.name
            assert abs((frame - 1) / 24 - shape.start) <= 0.5 / 24 + 1e-9
        assert found[0][0] == 1
        assert last == (1 + round(2.85 * 24), "rest")

    @pytest.mark.parametrize(("fps", "drawn"), [(25.0, 25), (30.0, 30), (12.0, 24), (60.0, 24)])
    def test_slow_clips_keep_their_rate(self, tmp_path: Path, fps: float, drawn: int) -> None:
        path = tmp_path / "a.dat"
        export_all(path, Performance(spoken(fps), TRACK))
        assert abs(switches(path)[-1][0] - 1 - spoken(fps).duration * drawn) <= 0.5

    def test_drawings_of_another_rig_keep_their_names(self, tmp_path: Path) -> None:
        rig = load_rig("rhubarb")
        values = np.eye(len(rig.names))[[8] * 12 + [3] * 6 + [0] * 6 + [8] * 2]
        path = tmp_path / "a.dat"
        export_all(path, Performance(Clip(rig.names, 24.0, values), rig=rig))
        assert switches(path) == [(1, "X"), (13, "D"), (19, "A"), (25, "X"), (26, "X")]

    def test_another_tool_reads_the_same_switches(self, tmp_path: Path) -> None:
        peer = pytest.importorskip("openfacefx.importers", reason="the peer is not installed")
        path = tmp_path / "a.dat"
        export_all(path, Performance(spoken(), TRACK))
        intervals, _ = peer.parse_moho_dat(path.read_text("utf-8"), 24.0)
        ours = [((frame - 1) / 24, name) for frame, name in switches(path)[:-1]]
        assert [(start, name) for start, _, name in intervals][: len(ours)] == ours


class TestPapagayo:
    def test_phrases_part_at_pauses_and_words_hold_what_shows(self, tmp_path: Path) -> None:
        path = tmp_path / "a.pgo"
        export_all(path, Performance(spoken(), TRACK, tmp_path / "talk" / "hello.wav"))
        found = read_papagayo(path)
        assert (found.sound, found.fps, found.text) == ("talk/hello.wav", 24, "ah ma|oof")
        assert found.frames == 69  # 2.85 s
        assert [text for text, *_ in found.phrases] == ["ah ma", "oof"]
        words = [word for *_, words in found.phrases for word in words]
        for word, (start, end) in zip(
            words, [TRACK.word_span(word) for word in TRACK.words], strict=True
        ):
            assert word.first <= start * 24 + 0.5
            assert word.last + 1 >= end * 24 - 0.5
            assert word.phonemes[0][0] == word.first
        for before, after in pairwise(words):
            assert before.last < after.first

    def test_a_sound_elsewhere_has_its_whole_path(self, tmp_path: Path) -> None:
        (tmp_path / "out").mkdir()
        path = tmp_path / "out" / "a.pgo"
        export_all(path, Performance(spoken(), TRACK, tmp_path / "hello.wav"))
        assert read_papagayo(path).sound == (tmp_path / "hello.wav").resolve().as_posix()

    def test_what_papagayo_plays_is_what_was_chosen(self, tmp_path: Path) -> None:
        path = tmp_path / "a.pgo"
        export_all(path, Performance(spoken(), TRACK))
        found = read_papagayo(path)
        chosen = choose_shapes(spoken(), RIG, TRACK)
        for frame in range(found.frames):
            middle = (frame + 0.5) / 24
            shape = next(s for s in chosen if s.end > middle or s is chosen[-1])
            assert found.shown(frame) == shape.name, frame

    def test_without_words_all_is_one(self, tmp_path: Path) -> None:
        path = tmp_path / "a.pgo"
        export_all(path, Performance(spoken()))
        found = read_papagayo(path)
        assert found.sound == "a.wav"
        ((text, first, last, (word,)),) = found.phrases
        assert (text, first, last) == ("speech", 0, found.frames - 1)
        assert [name for _, name in word.phonemes] == [name for name, _ in SAID]

    def test_words_of_less_than_a_frame_and_beyond_the_end_do_not_overlap(
        self, tmp_path: Path
    ) -> None:
        track = PhoneTrack(
            ("AA",) * 40, np.linspace(0.5, 4.5, 41),
            tuple(Word(f"w{i}", i, i + 1) for i in range(40)),
        )  # fmt: skip
        squeezed = track.with_edges(0.5 + (track.edges - 0.5) * 0.1)
        for said in (track, squeezed):
            path = tmp_path / "a.pgo"
            export_all(path, Performance(spoken(), said))
            found = read_papagayo(path)
            words = [word for *_, words in found.phrases for word in words]
            assert all(word.first <= word.last < found.frames for word in words)
            assert all(b.last < a.first for b, a in pairwise(words))

    def test_another_tool_reads_the_same_phonemes(self, tmp_path: Path) -> None:
        peer = pytest.importorskip("openfacefx.importers", reason="the peer is not installed")
        path = tmp_path / "a.pgo"
        export_all(path, Performance(spoken(), TRACK))
        intervals, _, fps = peer.parse_pgo(path.read_text("utf-8"))
        assert fps == 24
        assert {name for *_, name in intervals} <= {name for name, _ in SAID}
