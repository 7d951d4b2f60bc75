"""Our own head as GLB: what three.js makes of it, and what we read back."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all, read_clip
from lipwright.export.glb import mesh_to_glb
from lipwright.export.gltf_curves import join_keys, shared_keys, slopes
from lipwright.export.vrma import clip_to_vrma
from lipwright.face.head import Head
from lipwright.face.neck import turn_shares, turned
from lipwright.face.turning import head_rotations
from lipwright.keys import KeyedCurve, keyed
from lipwright.retarget import retarget
from lipwright.rig import load_rig
from made_gltf import small_head, small_mesh
from reading_gltf import WEB, Reader, reader

__all__ = ["reader"]

KEYS = 0.01
PRECISION = 1e-5


def talking(frames: int = 91, fps: float = 60.0, turns: bool = True) -> Clip:
    """Smooth motion of some controls, and of the head."""
    times = np.arange(frames) / fps
    names = CANONICAL + (HEAD_ANGLES if turns else ())
    clip = Clip(names, fps, np.zeros((frames, len(names)), np.float32))
    moved = ("jawOpen", "mouthClose", "mouthSmileLeft", "tongueRaise", "eyeBlinkRight")
    curves = {name: 0.5 - 0.5 * np.cos(times * (3 + 2 * place)) for place, name in enumerate(moved)}
    if turns:
        curves |= {
            name: 0.3 * np.sin(times * (2 + place)) for place, name in enumerate(HEAD_ANGLES)
        }
    return clip.with_curves(curves)


CLIP = talking()
SQUARE = small_head(CANONICAL)
TIMES = [0.0, 0.21, 0.5, 1.234, 1.5]


@pytest.fixture(scope="module")
def shown(head: Head, reader: Reader) -> dict[str, Any]:
    """Our head with `CLIP`, loaded."""
    return reader.load(mesh_to_glb(head, CLIP))


class TestThree:
    def test_it_loads_without_a_warning_and_names_every_blendshape(
        self, head: Head, shown: dict[str, Any]
    ) -> None:
        found = shown
        assert len(found["meshes"]) == len(head.parts)
        for mesh, part in zip(found["meshes"], head.parts, strict=True):
            assert mesh["targets"] == {name: place for place, name in enumerate(CANONICAL)}
            assert mesh["vertices"] == part.vertices.stop - part.vertices.start
        (animation,) = found["animations"]
        assert animation["duration"] == pytest.approx(CLIP.duration, abs=0.5 / CLIP.fps)
        times = animation["tracks"][0]["times"]
        assert times == pytest.approx(CLIP.times, abs=1e-6)

    def test_its_mixer_shows_the_clips_weights_and_turns(
        self, reader: Reader, shown: dict[str, Any]
    ) -> None:
        expected = CLIP.at(TIMES)
        for state, row in zip(reader.call("sample", TIMES), expected, strict=True):
            for weights in state["weights"]:
                assert weights == pytest.approx(row[: len(CANONICAL)], abs=PRECISION)
            turn = Rotation.from_quat(state["turns"]["Head"]).as_matrix()
            assert turn == pytest.approx(head_rotations(row[-3:]), abs=2e-5)

    def test_its_vertices_are_those_of_the_mesh(
        self, head: Head, reader: Reader, shown: dict[str, Any]
    ) -> None:
        weights = np.random.default_rng(7).uniform(0, 1, len(CANONICAL)).astype(np.float32)
        posed = reader.call("pose", weights.tolist())
        found = np.concatenate([np.reshape(part, (-1, 3)) for part in posed])
        assert found == pytest.approx(head.pose(weights), abs=1e-6)

    def test_neck_and_head_turn_as_in_our_videos(
        self, head: Head, reader: Reader, shown: dict[str, Any]
    ) -> None:
        row = CLIP.values[54]
        parts = reader.call("shown", 0.9)
        found = np.concatenate([np.reshape(part, (-1, 3)) for part in parts])
        expected = turned(head.pose(row[:55]), turn_shares(head), row[-3:])
        assert found == pytest.approx(expected, abs=2e-6)

    def test_another_character_has_no_joint(self, reader: Reader) -> None:
        found = reader.load(mesh_to_glb(small_mesh(CANONICAL), CLIP))
        assert [t["name"].rpartition(".")[2] for t in found["animations"][0]["tracks"]] == [
            "morphTargetInfluences"
        ]

    def test_few_keys_stay_within_their_bound(self, reader: Reader) -> None:
        found = reader.load(mesh_to_glb(SQUARE, CLIP, keys=KEYS))
        track = found["animations"][0]["tracks"][0]
        assert len(track["values"]) < 0.5 * CLIP.values[:, :55].size
        states = reader.call("sample", CLIP.times.tolist())
        for state, row in zip(states, CLIP.values, strict=True):
            assert state["weights"][0] == pytest.approx(row[:55], abs=KEYS + PRECISION)
            turn = Rotation.from_quat(state["turns"]["Head"])
            off = turn * Rotation.from_matrix(head_rotations(row[-3:])).inv()
            assert off.magnitude() < KEYS

    def test_slow_curves_are_cubic_splines(self, reader: Reader) -> None:
        slow = Clip(("jawOpen",), 60, 0.5 - 0.5 * np.cos(np.arange(241) / 120 * np.pi)[:, None])
        found = reader.load(mesh_to_glb(SQUARE, slow, keys=KEYS / 10))
        track = found["animations"][0]["tracks"][0]
        assert track["interpolation"] == "CUBICSPLINE"
        jaw = CANONICAL.index("jawOpen")
        states = reader.call("sample", slow.times.tolist())
        shown = [state["weights"][0][jaw] for state in states]
        assert shown == pytest.approx(slow.values[:, 0], abs=KEYS / 10 + PRECISION)


class TestBack:
    @pytest.mark.parametrize("fps", [24.0, 29.97, 60.0])
    def test_the_clip_comes_back(self, tmp_path: Path, fps: float) -> None:
        clip = talking(200, fps)
        (tmp_path / "a.glb").write_bytes(mesh_to_glb(SQUARE, clip))
        back = read_clip(tmp_path / "a.glb")
        assert (back.names, back.fps, len(back)) == (clip.names, fps, len(clip))
        assert back.values[:, :55].tolist() == clip.values[:, :55].tolist()
        assert back.values == pytest.approx(clip.values, abs=1e-6)

    def test_few_keys_come_back_within_their_bound(self, tmp_path: Path) -> None:
        (tmp_path / "a.glb").write_bytes(mesh_to_glb(SQUARE, CLIP, keys=KEYS))
        back = read_clip(tmp_path / "a.glb")
        assert back.values == pytest.approx(CLIP.values, abs=KEYS + PRECISION)

    def test_hours_from_the_start_no_frame_is_off(self, tmp_path: Path) -> None:
        clip = Clip(("jawOpen",), 60, np.random.default_rng(1).random((40_000, 1)))
        (tmp_path / "a.glb").write_bytes(mesh_to_glb(SQUARE, clip))
        back = read_clip(tmp_path / "a.glb")
        assert back.curve("jawOpen").tolist() == clip.values[:, 0].tolist()

    def test_a_clip_that_float32_times_cannot_hold_is_refused(self, tmp_path: Path) -> None:
        clip = Clip(("jawOpen",), 1000, np.zeros((20_000_000, 1), np.float32))
        with pytest.raises(LipwrightError, match="too long for glTF"):
            export_all([tmp_path / "a.glb"], Performance(clip))

    def test_a_glb_of_ours_is_animated_like_any_other(self, tmp_path: Path, reader: Reader) -> None:
        (tmp_path / "head.glb").write_bytes(mesh_to_glb(small_head(CANONICAL), talking(5)))
        options = ExportOptions(onto=tmp_path / "head.glb")
        export_all([tmp_path / "a.glb"], Performance(CLIP), options=options)
        found = reader.load((tmp_path / "a.glb").read_bytes())
        assert [a["name"] for a in found["animations"]] == ["speech", "a"]
        for state, row in zip(reader.call("sample", TIMES), CLIP.at(TIMES), strict=True):
            assert state["weights"][0] == pytest.approx(row[:55], abs=PRECISION)
        assert read_clip(tmp_path / "a.glb").values == pytest.approx(CLIP.values, abs=1e-6)


class TestKeys:
    def test_joined_keys_are_the_same_curves(self) -> None:
        clip = talking(300, turns=False).select(("jawOpen", "mouthClose", "eyeBlinkRight"))
        keys = keyed(clip, KEYS)
        times, arriving, values, leaving = join_keys(keys)
        assert set(times) == {t for c in keys.curves.values() for t in c.times} | {clip.duration}
        fine = np.linspace(0, clip.duration, 999)
        for column, curve in enumerate(keys.curves.values()):
            joined = KeyedCurve(times, *(a[:, column] for a in (values, arriving, leaving)))
            assert joined.at(fine) == pytest.approx(curve.at(fine), abs=1e-9)

    def test_slopes_are_those_of_scipys_splines(self) -> None:
        rng = np.random.default_rng(3)
        times, values, rates = np.cumsum(rng.uniform(0.1, 1, 6)), rng.random(6), rng.random(6)
        curve = KeyedCurve(times, values, np.r_[0, rates[1:]], np.r_[rates[:-1], 0])
        inside = rng.uniform(times[0], times[-1], 50)
        expected = CubicHermiteSpline(times, values, rates).derivative()(inside)
        assert slopes(curve, inside, "left") == pytest.approx(expected, abs=1e-9)
        assert slopes(curve, inside, "right") == pytest.approx(expected, abs=1e-9)
        around = np.array([times[0] - 1, times[-1] + 1])
        assert slopes(curve, around, "left").tolist() == [0, 0]

    def test_shared_keys_hold_every_frame_and_a_straight_line_needs_two(self) -> None:
        values = np.random.default_rng(5).normal(size=(400, 4)).cumsum(axis=0) * 0.01
        keys = shared_keys(values.astype(np.float32), 0.02)
        frames = np.arange(len(values))
        lines = [np.interp(frames, keys, column[keys]) for column in values.T]
        assert np.abs(np.transpose(lines) - values).max() <= 0.02 + 1e-6
        assert len(keys) < len(values) / 2
        line = np.linspace(0, 1, 50, dtype=np.float32)[:, None]
        assert shared_keys(line, 1e-3) == [0, 49]


def test_the_json_is_strict_and_the_chunks_are_aligned() -> None:
    content = mesh_to_glb(SQUARE, CLIP)
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", content)
    assert (magic, version, length, kind) == (b"glTF", 2, len(content), b"JSON")
    document = json.loads(content[20 : 20 + size])
    assert size % 4 == 0
    binary, kind = struct.unpack_from("<I4s", content, 20 + size)
    assert (kind, binary) == (b"BIN\0", document["buffers"][0]["byteLength"])
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= binary


def test_khronos_validator_finds_nothing_wrong(tmp_path: Path, head: Head) -> None:
    if shutil.which("node") is None or not (WEB / "node_modules" / "gltf-validator").is_dir():
        pytest.skip("gltf-validator is not installed; run: npm ci --prefix tests/web")
    slow = Clip(("jawOpen",), 60, 0.5 - 0.5 * np.cos(np.arange(241) / 120 * np.pi)[:, None])
    files = {
        "head.glb": mesh_to_glb(head, CLIP),
        "still.glb": mesh_to_glb(SQUARE, CLIP.select(CANONICAL)),
        "cubic.glb": mesh_to_glb(SQUARE, slow, keys=KEYS / 10),
        "a.vrma": clip_to_vrma(retarget(CLIP, load_rig("vrm1"))),
        "few.vrma": clip_to_vrma(retarget(CLIP, load_rig("vrm1")), keys=KEYS),
    }
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    options = ExportOptions(onto=tmp_path / "head.glb")
    export_all([tmp_path / "onto.glb"], Performance(CLIP), options=options)
    names = [*files, "onto.glb"]
    command = ["node", WEB / "validate.mjs", *(tmp_path / name for name in names)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert dict(zip(names, json.loads(run.stdout), strict=True)) == {name: [] for name in names}
