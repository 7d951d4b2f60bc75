"""Rhubarb Lip Sync's own outputs: read by the standard library and by another tool's readers."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export import Performance, export_all
from lipwright.export.rhubarb import cues
from lipwright.retarget.shapes import ShownShape, choose_shapes
from lipwright.rig import Control, Rig, load_rig
from lipwright.track import PhoneTrack

RHUBARB = load_rig("rhubarb")
SAID = [("X", 0.5), ("D", 0.2), ("A", 0.1), ("F", 0.17), ("G", 0.1), ("B", 0.13), ("X", 0.4)]
TRACK = PhoneTrack(("sil", "AA", "sil"), np.array([0, 0.5, 1.2, 1.6]))

Cue = tuple[float, float, str]


def spoken(fps: float = 100.0) -> Clip:
    """A face that shows Rhubarb's shapes one after the other."""
    names = [name for name, seconds in SAID for _ in range(round(seconds * fps))]
    looks = RHUBARB.look_of([*names, "X"])
    return Clip(CANONICAL, fps, looks)


def from_table(path: Path) -> list[Cue]:
    with path.open(encoding="utf-8", newline="") as file:
        rows = [(float(time), name) for time, name in csv.reader(file, delimiter="\t")]
    assert rows[-1][1] in "AX"
    return [(start, end, name) for (start, name), (end, _) in pairwise(rows)]


def from_xml(path: Path) -> list[Cue]:
    root = ElementTree.parse(path).getroot()
    assert root.tag == "rhubarbResult"
    assert [part.tag for part in root] == ["metadata", "mouthCues"]
    found = root.findall("mouthCues/mouthCue")
    assert len(found) == len(root[1])
    assert float(root.findtext("metadata/duration") or "") == float(found[-1].attrib["end"])
    return [(float(c.attrib["start"]), float(c.attrib["end"]), c.text or "") for c in found]


def from_json(path: Path) -> list[Cue]:
    content = json.loads(path.read_text("utf-8"))
    assert list(content) == ["metadata", "mouthCues"]
    assert content["metadata"]["duration"] == content["mouthCues"][-1]["end"]
    return [(cue["start"], cue["end"], cue["value"]) for cue in content["mouthCues"]]


READERS = {"tsv": from_table, "xml": from_xml, "json": from_json}


@pytest.mark.parametrize(("form", "read"), READERS.items())
class TestFormats:
    def test_cues_are_the_chosen_shapes_and_meet(
        self, tmp_path: Path, form: str, read: Callable[[Path], list[Cue]]
    ) -> None:
        path = tmp_path / f"a.rhubarb.{form}"
        export_all(path, Performance(spoken(), TRACK))
        found = read(path)
        assert [name for *_, name in found] == [name for name, _ in SAID]
        chosen = choose_shapes(spoken(), RHUBARB, TRACK)
        for (start, end, name), shape in zip(found, chosen, strict=True):
            assert (start, end) == pytest.approx((shape.start, shape.end), abs=0.005)
            assert name == shape.name
        assert found[0][0] == 0
        assert all(before[1] == after[0] for before, after in pairwise(found))
        assert found[-1][1] == pytest.approx(1.6)

    def test_another_tool_reads_the_same_cues(
        self, tmp_path: Path, form: str, read: Callable[[Path], list[Cue]]
    ) -> None:
        peer = pytest.importorskip("openfacefx.importers", reason="the peer is not installed")
        path = tmp_path / f"a.rhubarb.{form}"
        export_all(path, Performance(spoken(), TRACK))
        intervals, duration = getattr(peer, f"parse_rhubarb_{form}")(path.read_text("utf-8"))
        theirs = [(start, end, name) for start, end, name in intervals if end > start]
        assert theirs == read(path)
        assert duration == pytest.approx(1.6)

    def test_the_suffix_may_be_said_beside_the_name(
        self, tmp_path: Path, form: str, read: Callable[[Path], list[Cue]]
    ) -> None:
        path = tmp_path / "cues.txt"
        export_all(path, Performance(spoken(), TRACK), format=f"rhubarb.{form}")
        assert len(read(path)) == len(SAID)

    def test_curves_that_are_drawn_already_are_written_as_they_are(
        self, tmp_path: Path, form: str, read: Callable[[Path], list[Cue]]
    ) -> None:
        few = Rig("few", tuple(map(Control, "ABX")), {}, discrete=True)
        values = np.eye(3)[np.repeat([2, 1, 0, 2], [6, 6, 3, 9])]
        path = tmp_path / f"a.rhubarb.{form}"
        export_all(path, Performance(Clip(few.names, 24.0, values), rig=few))
        assert read(path) == [
            (0, 0.25, "X"), (0.25, 0.5, "B"), (0.5, 0.62, "A"), (0.62, 0.96, "X")
        ]  # fmt: skip


def test_the_path_of_the_sound_is_written_whatever_its_letters(tmp_path: Path) -> None:
    odd = tmp_path / 'a <b> & "c"\n\x01é\udcff.wav'
    paths = [tmp_path / "a.rhubarb.xml", tmp_path / "a.rhubarb.json"]
    export_all(paths, Performance(spoken(), TRACK, odd))
    root = ElementTree.parse(paths[0]).getroot()
    sound = json.loads(paths[1].read_text("utf-8"))["metadata"]["soundFile"]
    assert root.findtext("metadata/soundFile") == sound
    assert sound.endswith('a <b> & "c"\ufffd\ufffdé\ufffd.wav')


def test_shapes_shorter_than_a_hundredth_are_left_out() -> None:
    shown = [(0.0, 0.301, "X"), (0.301, 0.304, "D"), (0.304, 0.306, "A"), (0.306, 0.5, "D")]
    assert cues(tuple(ShownShape(*shape) for shape in shown)) == [
        ("0.00", "0.30", "X"), ("0.30", "0.31", "A"), ("0.31", "0.50", "D")
    ]  # fmt: skip


def test_other_rigs_go_by_what_they_look_like(tmp_path: Path) -> None:
    path = tmp_path / "a.rhubarb.json"
    rig = load_rig("preston-blair")
    said = [("rest", 12), ("AI", 9), ("MBP", 4), ("WQ", 9), ("rest", 12)]
    frames = [rig.names.index(name) for name, count in said for _ in range(count)]
    export_all(path, Performance(Clip(rig.names, 24.0, np.eye(len(rig.names))[frames]), rig=rig))
    assert [name for *_, name in from_json(path)] == ["X", "D", "A", "F", "X"]


def test_curves_without_a_mouth_are_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match=r"a\.rhubarb\.tsv: curves of claw\.\.\. move no"):
        export_all(tmp_path / "a.rhubarb.tsv", Performance(Clip(("claw",), 30, np.ones((3, 1)))))
