"""MikuMikuDance motions, read by mmd-parser in Node.js and by another tool."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all
from lipwright.export.vmd import FPS, SMALLEST, line_keys
from lipwright.face.turning import head_rotations
from lipwright.retarget import retarget
from lipwright.rig import Bone, Control, Rig, load_rig

WEB = Path(__file__).parent / "web"
NEEDS_NODE = pytest.mark.skipif(
    shutil.which("node") is None or not (WEB / "node_modules" / "mmd-parser").is_dir(),
    reason="needs Node.js and: npm ci --prefix tests/web",
)
MMD = load_rig("mmd")


def parsed(path: Path, *, right_handed: bool = False) -> dict[str, Any]:
    command = ["node", str(WEB / "vmd.mjs"), str(path), "right" if right_handed else "left"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def played(found: dict[str, Any], name: str, times: np.ndarray) -> np.ndarray:
    """A morph as MikuMikuDance plays it: straight lines between its keys."""
    keys = sorted((m["frameNum"], m["weight"]) for m in found["morphs"] if m["morphName"] == name)
    frames, weights = zip(*keys, strict=True)
    return np.interp(times * 30, frames, weights)


def talking(fps: float = 60.0, seconds: float = 2.0) -> Clip:
    times = np.arange(round(seconds * fps) + 1) / fps
    clip = Clip(CANONICAL, fps, np.zeros((len(times), len(CANONICAL))))
    return clip.with_curves({
        "jawOpen": 0.3 + 0.3 * np.sin(7 * times), "mouthPucker": np.abs(np.sin(3 * times)),
        "eyeBlinkLeft": times > 1,
    })  # fmt: skip


@NEEDS_NODE
class TestParser:
    @pytest.mark.parametrize("fps", [24.0, 60.0])
    def test_morphs_play_as_the_curves_do(self, tmp_path: Path, fps: float) -> None:
        path = tmp_path / "a.vmd"
        clip = talking(fps)
        export_all(path, Performance(clip))
        found = parsed(path)
        assert found["metadata"]["magic"] == "Vocaloid Motion Data 0002"
        assert found["metadata"]["name"] == "Lipwright"
        assert {morph["morphName"] for morph in found["morphs"]} == set(MMD.names)
        moved = retarget(clip, MMD)
        times = np.arange(61) / 30
        for name in MMD.names:
            curve = np.interp(times, moved.times, moved.curve(name))
            assert played(found, name, times) == pytest.approx(curve, abs=SMALLEST + 1e-6), name
        counts = [found["metadata"][f"{what}Count"] for what in ("motion", "camera")]
        assert counts == [0, 0]

    def test_few_keys_stay_within_the_error(self, tmp_path: Path) -> None:
        path = tmp_path / "a.vmd"
        clip = talking()
        export_all(path, Performance(clip), options=ExportOptions(keys=0.01))
        found = parsed(path)
        moved = retarget(clip, MMD)
        times = np.arange(61) / 30
        for name in MMD.names:
            curve = np.interp(times, moved.times, moved.curve(name))
            assert played(found, name, times) == pytest.approx(curve, abs=0.01 + 1e-6), name
        assert sum(morph["morphName"] == "あ" for morph in found["morphs"]) < 0.7 * 61
        assert sum(morph["morphName"] == "怒り" for morph in found["morphs"]) == 1

    def test_turns_of_the_head_turn_its_bone(self, tmp_path: Path) -> None:
        path = tmp_path / "a.vmd"
        angles = np.array([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1], [0.3, -0.2, 0.1]])
        clip = Clip(("jawOpen", *HEAD_ANGLES), FPS, np.column_stack([np.zeros(5), angles]))
        export_all(path, Performance(clip))
        found = parsed(path, right_handed=True)["motions"]
        assert [(key["boneName"], key["frameNum"]) for key in found] == [
            ("頭", frame) for frame in range(5)
        ]
        forward = np.array([0, 0, 1.0])
        for key, want in zip(found, head_rotations(angles.astype(np.float32)), strict=True):
            x, y, z, w = key["rotation"]
            assert x * x + y * y + z * z + w * w == pytest.approx(1, abs=1e-6)
            axis = np.array([x, y, z])
            turned = forward + 2 * np.cross(axis, np.cross(axis, forward) + w * forward)
            assert turned == pytest.approx(want @ forward, abs=1e-5)
            assert key["interpolation"][:16] == [20] * 8 + [107] * 8


class TestPeer:
    def test_another_tool_reads_the_same_weights(self, tmp_path: Path) -> None:
        peer = pytest.importorskip("openfacefx.importers_vmd", reason="the peer is not installed")
        path = tmp_path / "a.vmd"
        export_all(path, Performance(talking(30.0)))
        track = peer.read_vmd(str(path))
        channels = {channel.name: channel for channel in track.channels}
        keys = [(key.time, key.value) for key in channels["aa"].keys]  # what it calls あ
        times, values = zip(*keys, strict=True)
        moved = retarget(talking(30.0), MMD)
        assert np.interp(moved.times, times, values) == pytest.approx(
            moved.curve("あ"), abs=SMALLEST + 1e-6
        )

    def test_the_file_is_as_long_as_its_counts_say(self, tmp_path: Path) -> None:
        path = tmp_path / "a.vmd"
        export_all(path, Performance(talking()))
        data = path.read_bytes()
        (bones,) = struct.unpack_from("<I", data, 50)
        (morphs,) = struct.unpack_from("<I", data, 54 + 111 * bones)
        assert len(data) == 58 + 111 * bones + 23 * morphs + 4 * 4


class TestLineKeys:
    @settings(max_examples=100, deadline=None)
    @given(st.integers(0, 2**32 - 1), st.integers(1, 80), st.sampled_from([1e-4, 0.01, 0.2]))
    def test_lines_between_keys_stay_within_the_error(
        self, seed: int, frames: int, error: float
    ) -> None:
        values = np.random.default_rng(seed).random(frames).cumsum() / 5
        keys = line_keys(values, error)
        assert keys == sorted(set(keys))
        assert np.interp(np.arange(frames), keys, values[keys]) == pytest.approx(
            values, abs=error + 1e-9
        )

    def test_a_straight_line_needs_its_ends_and_a_bend_one_more(self) -> None:
        assert line_keys(np.linspace(0, 1, 50), 1e-4) == [0, 49]
        bent = np.concatenate([np.linspace(0, 1, 20), np.ones(30)])
        assert line_keys(bent, 1e-4) == [0, 19, 49]
        assert line_keys(np.full(9, 0.5), 1e-4) == [0]


class TestTrouble:
    @pytest.mark.parametrize("name", ["mouthFunnelAndMore", "ｱｲｳｴｵｱｲｳｴｵｱｲｳｴｵｱ", "ȧ"])
    def test_names_that_do_not_fit_are_refused(self, tmp_path: Path, name: str) -> None:
        with pytest.raises(LipwrightError, match=r"a\.vmd: the control .* does not fit into 15"):
            export_all(tmp_path / "a.vmd", Performance(Clip((name,), 30.0, np.ones((3, 1)))))
        assert not list(tmp_path.iterdir())

    def test_bones_are_no_morphs(self, tmp_path: Path) -> None:
        names = ("jaw.rx", "jaw.tz")
        rig = Rig("r", tuple(Control(name, -9, 9) for name in names), {}, bones=(Bone("jaw"),))
        clip = Clip(names, 30.0, np.ones((3, 2)))
        with pytest.raises(LipwrightError, match=r"a\.vmd: the curves move bones alone"):
            export_all(tmp_path / "a.vmd", Performance(clip, rig=rig))
        assert not list(tmp_path.iterdir())

    def test_names_of_fifteen_bytes_fit(self, tmp_path: Path) -> None:
        path = tmp_path / "a.vmd"
        export_all(path, Performance(Clip(("あいうえおかきx",), 30.0, np.ones((3, 1)))))
        assert "あいうえおかきx".encode("cp932") in path.read_bytes()
