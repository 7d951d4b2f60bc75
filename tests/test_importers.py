"""Curves out of files: what was exported, what others wrote, and what is broken."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from lipwright.clip import Clip
from lipwright.controls import ARKIT, CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export import EXPORTERS, export_clip, read_clip
from lipwright.export.glb import mesh_to_glb
from made_gltf import Json, character, from_glb, small_mesh, to_glb

IN_FOLDER = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=80
)
FLOATS = {"componentType": 5126}


def add(document: Json, data: bytes, values: np.ndarray, **more: Any) -> tuple[int, bytes]:
    """Another accessor of a document; its number and the data."""
    data += bytes(-len(data) % 4)
    view = {"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes}
    document["bufferViews"].append(view)
    kind = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[1 if values.ndim == 1 else values.shape[1]]
    accessor = {"bufferView": len(document["bufferViews"]) - 1, "count": len(values), "type": kind}
    document["accessors"].append(accessor | FLOATS | more)
    document["buffers"][0]["byteLength"] = len(data) + values.nbytes
    return len(document["accessors"]) - 1, data + values.tobytes()


def animated(
    interpolation: str, times: np.ndarray, keys: np.ndarray, path: str = "weights", **more: Any
) -> tuple[Json, bytes]:
    """A character whose jaw opens, or whose head moves, with given keys."""
    document, data = character(["jawOpen"], nodes=[{"name": "head"}])
    first, data = add(document, data, times.astype(np.float32))
    second, data = add(document, data, keys, **more)
    sampler = {"input": first, "output": second, "interpolation": interpolation}
    target = {"node": 0 if path == "weights" else 1, "path": path}
    document["animations"] = [
        {"channels": [{"sampler": 0, "target": target}], "samplers": [sampler]}
    ]
    return document, data


def read(folder: Path, document: Json, data: bytes) -> Clip:
    (folder / "a.glb").write_bytes(to_glb(document, data))
    return read_clip(folder / "a.glb")


UNEVEN = np.array([0.0, 0.13, 0.2, 0.71, 1.0])
VALUES = np.array([0.0, 0.5, 0.3, 1.0, 0.25], np.float32)
GRID = np.arange(61) / 60


class TestInterpolation:
    def test_linear_keys_are_joined_by_lines(self, tmp_path: Path) -> None:
        clip = read(tmp_path, *animated("LINEAR", UNEVEN, VALUES))
        assert (clip.names, clip.fps) == (("jawOpen",), 60)
        assert clip.values[:, 0] == pytest.approx(np.interp(GRID, UNEVEN, VALUES), abs=1e-6)

    def test_steps_hold(self, tmp_path: Path) -> None:
        clip = read(tmp_path, *animated("STEP", UNEVEN, VALUES))
        expected = VALUES[np.searchsorted(UNEVEN, GRID + 1e-6, side="right") - 1]
        assert clip.values[:, 0].tolist() == expected.tolist()

    def test_cubic_splines_are_scipys(self, tmp_path: Path) -> None:
        slopes = np.array([0.4, -1.0, 2.0, 0.0, 1.0], np.float32)
        keys = np.stack([slopes, VALUES, slopes], axis=1).ravel()
        clip = read(tmp_path, *animated("CUBICSPLINE", UNEVEN, keys))
        expected = CubicHermiteSpline(UNEVEN, VALUES, slopes)(GRID)
        assert clip.values[:, 0] == pytest.approx(expected, abs=1e-6)

    def test_rotations_are_scipys(self, tmp_path: Path) -> None:
        turns = Rotation.random(5, rng=np.random.default_rng(2))
        keys = turns.as_quat().astype(np.float32) * [[1], [-1], [1], [1], [-1]]  # the same turns
        clip = read(tmp_path, *animated("LINEAR", UNEVEN, keys.astype(np.float32), "rotation"))
        assert clip.names == ("head.rx", "head.ry", "head.rz")
        found = Rotation.from_euler("xyz", clip.values, degrees=True)
        assert (found * Slerp(UNEVEN, turns)(GRID).inv()).magnitude() == pytest.approx(0, abs=1e-5)

    def test_whole_numbers_stand_for_parts_of_one(self, tmp_path: Path) -> None:
        bytes_ = np.array([0, 51, 255, 102, 0], np.uint8)
        more = {"componentType": 5121, "normalized": True}
        clip = read(tmp_path, *animated("LINEAR", np.arange(5) / 60, bytes_, **more))
        assert clip.values[:, 0] == pytest.approx([0, 0.2, 1, 0.4, 0], abs=1e-6)

    def test_a_late_first_key_holds_before(self, tmp_path: Path) -> None:
        clip = read(tmp_path, *animated("LINEAR", UNEVEN + 0.5, VALUES[::-1].copy()))
        assert set(clip.values[:31, 0].tolist()) == {0.25}
        assert clip.duration == pytest.approx(1.5)

    def test_the_file_says_the_rate(self, tmp_path: Path) -> None:
        document, data = animated("LINEAR", UNEVEN, VALUES)
        document["asset"]["extras"] = {"fps": 24}
        assert read(tmp_path, document, data).fps == 24

    def test_sparse_keys_count(self, tmp_path: Path) -> None:
        document, data = animated("LINEAR", np.arange(5) / 60, VALUES)
        places = np.array([1, 3], np.float32).astype(np.uint16)
        at, data = add(document, data, places, componentType=5123)
        new, data = add(document, data, np.array([0.9, 0.8], np.float32))
        number = document["animations"][0]["samplers"][0]["output"]
        view = [document["accessors"][n]["bufferView"] for n in (at, new)]
        document["accessors"][number]["sparse"] = {
            "count": 2,
            "indices": {"bufferView": view[0], "componentType": 5123},
            "values": {"bufferView": view[1]},
        }
        clip = read(tmp_path, document, data)
        assert clip.values[:, 0] == pytest.approx([0, 0.9, 0.3, 0.8, 0.25], abs=1e-6)


def talking(fps: float, frames: int = 45, turns: bool = True) -> Clip:
    times = np.arange(frames)[:, None] / fps
    weights = 0.5 - 0.5 * np.cos(times * np.linspace(2, 9, len(CANONICAL)))
    angles = 0.3 * np.sin(times * [2, 3, 4])
    clip = Clip(CANONICAL + HEAD_ANGLES, fps, np.hstack([weights, angles]))
    return clip if turns else clip.select(CANONICAL)


CLIP = talking(60)
OURS = mesh_to_glb(small_mesh(), CLIP)


class TestHostile:
    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"interpolation": "WOBBLE"}, "the interpolation 'WOBBLE' is unknown"),
            ({"input": 99}, "'input' is '99', not one of 4"),
            ({"output": 0}, "a sampler has 9 numbers for 5 keys of 1"),
            ({"interpolation": "CUBICSPLINE"}, "a sampler has 5 numbers for 5 keys of 1"),
            ({"input": 3}, "a sampler's times do not rise"),
        ],
    )
    def test_broken_samplers_are_refused(self, tmp_path: Path, change: Json, words: str) -> None:
        document, data = animated("LINEAR", UNEVEN, VALUES)
        document["animations"][0]["samplers"][0] |= change
        with pytest.raises(LipwrightError, match=words) as caught:
            read(tmp_path, document, data)
        assert "\n" not in str(caught.value)

    def test_a_key_in_the_far_future_takes_no_memory(self, tmp_path: Path) -> None:
        late = np.array([0, 1, 2, 3, 3e38])
        with pytest.raises(LipwrightError, match="its animation lasts"):
            read(tmp_path, *animated("LINEAR", late, VALUES))

    def test_a_huge_accessor_without_data_takes_no_memory(self, tmp_path: Path) -> None:
        document, data = animated("LINEAR", UNEVEN, VALUES)
        for accessor in document["accessors"]:
            del accessor["bufferView"]
            accessor["count"] = 2**40
        with pytest.raises(LipwrightError, match="which no animation has"):
            read(tmp_path, document, data)

    @pytest.mark.parametrize("bad", [np.nan, np.inf])
    def test_what_is_no_number_is_refused(self, tmp_path: Path, bad: float) -> None:
        values = VALUES.copy()
        values[2] = bad
        with pytest.raises(LipwrightError, match="its keys are no numbers"):
            read(tmp_path, *animated("LINEAR", UNEVEN, values))

    def test_a_file_without_animation_says_so(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match="no animation of morph targets or bones"):
            read(tmp_path, *character(["jawOpen"]))

    @IN_FOLDER
    @given(data=st.data())
    def test_any_changed_value_is_read_or_refused(
        self, tmp_path: Path, data: st.DataObject
    ) -> None:
        document, binary = from_glb(OURS)
        holder: Any = document
        while True:
            keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
            key = data.draw(st.sampled_from(keys))
            below = holder[key]
            if not isinstance(below, dict | list) or not below or data.draw(st.booleans()):
                break
            holder = below
        holder[key] = data.draw(st.none() | st.integers(-3, 10**19) | st.text(max_size=3))
        try:
            read(tmp_path, document, binary)
        except LipwrightError as error:
            assert "\n" not in str(error)  # noqa: PT017  # either is right


class TestLiveLink:
    @pytest.mark.parametrize("fps", [12.0, 24.0, 29.97, 30.0, 50.0, 60.0])
    def test_a_written_clip_reads_back(self, tmp_path: Path, fps: float) -> None:
        clip = talking(fps, frames=80)  # below a second, its time codes may count 60 frames
        export_clip(tmp_path / "a.livelink.csv", clip)
        back = read_clip(tmp_path / "a.livelink.csv")
        assert back.names == ARKIT + HEAD_ANGLES
        assert back.fps == pytest.approx(fps, rel=1e-5)
        assert back.values == pytest.approx(clip.select(back.names).values, abs=1e-7)

    def test_a_head_that_stays_has_no_curves(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.livelink.csv", talking(60, turns=False))
        assert read_clip(tmp_path / "a.livelink.csv").names == ARKIT

    def test_missing_frames_are_filled(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.livelink.csv", CLIP)
        lines = (tmp_path / "a.livelink.csv").read_text().splitlines()
        lost = lines[11].split(",")
        lines[11] = ",".join([lost[0], "0", *[""] * 61])
        (tmp_path / "a.livelink.csv").write_text("\n".join(lines[:20] + lines[22:]) + "\n")
        back = read_clip(tmp_path / "a.livelink.csv")
        assert len(back) == len(CLIP)
        kept = np.setdiff1d(np.arange(len(CLIP)), [10, 19, 20])
        assert back.values[kept] == pytest.approx(CLIP.select(back.names).values[kept], abs=1e-4)
        middle = (back.values[9] + back.values[11]) / 2
        assert back.values[10] == pytest.approx(middle, abs=1e-4)

    def test_another_table_is_refused(self, tmp_path: Path) -> None:
        (tmp_path / "a.livelink.csv").write_text("a,b\n1,2\n")
        with pytest.raises(LipwrightError, match="no column 'Timecode'"):
            read_clip(tmp_path / "a.livelink.csv")


@pytest.mark.parametrize("suffix", [s for s, entry in EXPORTERS.items() if entry.reads])
def test_every_format_that_reads_gives_the_clip_back(tmp_path: Path, suffix: str) -> None:
    clip = talking(60, turns=False).select(ARKIT)
    if suffix == ".glb":
        (tmp_path / "a.glb").write_bytes(mesh_to_glb(small_mesh(ARKIT), clip))
    else:
        export_clip(tmp_path / f"a{suffix}", clip)
    back = read_clip(tmp_path / f"a{suffix}")
    assert (back.fps, len(back)) == (clip.fps, len(clip))
    if set(clip.names) <= set(back.names):  # other formats are written in a rig of their own
        assert back.select(clip.names).values == pytest.approx(clip.values, abs=1e-5)


def test_a_truncated_glb_is_refused_at_any_length(tmp_path: Path) -> None:
    content = mesh_to_glb(small_mesh(), CLIP)
    for length in [*range(0, 40), *range(40, len(content), 997)]:
        (tmp_path / "a.glb").write_bytes(content[:length])
        with pytest.raises(LipwrightError):
            read_clip(tmp_path / "a.glb")
    wrong = content[:8] + struct.pack("<I", len(content) + 4) + content[12:]
    (tmp_path / "a.glb").write_bytes(wrong)
    with pytest.raises(LipwrightError, match="is cut off after"):
        read_clip(tmp_path / "a.glb")
