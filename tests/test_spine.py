"""Spine skeletons, read by the layout that Esoteric Software publishes and by another tool."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export import Performance, export_all
from lipwright.retarget.shapes import choose_shapes
from lipwright.rig import Control, Rig, load_rig

RIG = load_rig("rhubarb")
SAID = [("X", 0.5), ("D", 0.2), ("A", 0.1), ("F", 0.2), ("X", 0.4)]


def spoken(fps: float = 60.0) -> Clip:
    names = [name for name, seconds in SAID for _ in range(round(seconds * fps))]
    return Clip(CANONICAL, fps, RIG.look_of([*names, "X"]))


def attached(skeleton: dict[str, Any], time: float) -> str:
    """What the mouth shows, by the rules of slots, skins and attachment timelines."""
    (slot,) = skeleton["slots"]
    assert slot["bone"] in {bone["name"] for bone in skeleton["bones"]}
    keys = skeleton["animations"]["speech"]["slots"][slot["name"]]["attachment"]
    times = [key.get("time", 0) for key in keys]
    assert times == sorted(set(times))
    shown = [key["name"] for key in keys if key.get("time", 0) <= time]
    name = shown[-1] if shown else slot["attachment"]
    (skin,) = skeleton["skins"]
    assert skin["name"] == "default"
    assert set(skin["attachments"][slot["name"]][name]) == {"width", "height"}
    return str(name)


def test_the_slot_shows_the_chosen_shapes_at_their_times(tmp_path: Path) -> None:
    path = tmp_path / "a.spine.json"
    export_all(path, Performance(spoken()))
    skeleton = json.loads(path.read_text("utf-8"))
    assert set(skeleton) == {"skeleton", "bones", "slots", "skins", "animations"}
    assert skeleton["skeleton"]["spine"].startswith("4.2.")
    for shape in choose_shapes(spoken(), RIG):
        for time in (shape.start + 1e-4, shape.end - 2e-4):
            assert attached(skeleton, time) == f"mouth_{shape.name.lower()}"
    assert skeleton["slots"][0]["attachment"] == "mouth_x"


def test_the_sound_starts_with_the_animation(tmp_path: Path) -> None:
    path = tmp_path / "a.spine.json"
    export_all(path, Performance(spoken(), audio="talk/hello.ogg"))
    skeleton = json.loads(path.read_text("utf-8"))
    (event,) = skeleton["animations"]["speech"]["events"]
    assert event["time"] == 0
    assert skeleton["events"][event["name"]] == {"audio": "hello.ogg"}


def test_another_tool_reads_the_same_switches(tmp_path: Path) -> None:
    peer = pytest.importorskip("openfacefx.export_spine", reason="the peer is not installed")
    path = tmp_path / "a.spine.json"
    export_all(path, Performance(spoken()))
    chosen = [
        (shape.start, f"mouth_{shape.name.lower()}") for shape in choose_shapes(spoken(), RIG)
    ]
    assert peer.read_spine_cues(str(path)) == chosen


def test_drawings_of_a_rig_of_ones_own_keep_their_names(tmp_path: Path) -> None:
    path = tmp_path / "a.spine.json"
    rig = Rig(
        "cat", (Control("Öh"), Control("Zu")), {}, looks={"Öh": {"jawOpen": 1}}, discrete=True
    )
    export_all(path, Performance(Clip(rig.names, 10.0, np.eye(2)[[1, 0, 0, 1, 1]]), rig=rig))
    skeleton = json.loads(path.read_text("utf-8"))
    keys = skeleton["animations"]["speech"]["slots"]["mouth"]["attachment"]
    assert keys == [
        {"time": 0, "name": "mouth_zu"}, {"time": 0.1, "name": "mouth_öh"},
        {"time": 0.3, "name": "mouth_zu"},
    ]  # fmt: skip
    assert skeleton["slots"][0]["attachment"] == "mouth_zu"


def test_drawings_that_differ_by_capitals_alone_are_refused(tmp_path: Path) -> None:
    rig = Rig("r", (Control("A"), Control("a")), {}, looks={"A": {"jawOpen": 1.0}}, discrete=True)
    performance = Performance(Clip(rig.names, 30.0, np.eye(2)), rig=rig)
    with pytest.raises(LipwrightError, match=r"a\.spine\.json: the drawings 'A' and 'a' are both"):
        export_all(tmp_path / "a.spine.json", performance)
    assert not list(tmp_path.iterdir())
