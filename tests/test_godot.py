"""Godot animations, read back with godot_parser."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from engine_clips import BOUND, jaw_of_bones, waves
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import ExportOptions, Performance, export_all, export_clip

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it calls its grammar library by older names
    godot_parser = pytest.importorskip("godot_parser", reason="godot-parser is not installed")


def read_godot(path: Path) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The fields of the animation, and those of each track."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        resource = godot_parser.load(str(path))
    header, section = resource.get_sections()
    assert header.header.attributes == {"type": "Animation", "format": 3}
    assert section.header.name == "resource"
    fields: dict[str, Any] = {}
    tracks: list[dict[str, Any]] = []
    for key, value in section.properties.items():
        if not key.startswith("tracks/"):
            fields[key] = value
            continue
        _, index, field = key.split("/")
        if field == "type":  # it must stand first: Godot makes the track when it reads it
            assert int(index) == len(tracks)
            tracks.append({})
        tracks[int(index)][field] = value
    for track in tracks:
        assert track["path"].name == "NodePath"
        track["path"] = track["path"].args[0]
    return fields, tracks


def table(packed: Any, columns: int) -> np.ndarray:
    assert packed.name == "PackedFloat32Array"
    return np.array(packed.args, float).reshape(-1, columns)


def bezier(keys: dict[str, Any], when: np.ndarray) -> np.ndarray:
    """The curve as Godot's documentation of Bezier tracks describes it, by solving for the time."""
    times, points = table(keys["times"], 1)[:, 0], table(keys["points"], 5)
    if len(times) == 1:
        return np.full(len(when), points[0, 0])
    seen = []
    for moment in when:
        left = int(np.clip(np.searchsorted(times, moment, side="right") - 1, 0, len(times) - 2))
        start, end = points[left], points[left + 1]
        xs = [0, start[3], times[left + 1] - times[left] + end[1], times[left + 1] - times[left]]
        ys = [start[0], start[0] + start[4], end[0] + end[2], end[0]]
        low, high = 0.0, 1.0
        for _ in range(50):
            u = (low + high) / 2
            weights = [(1 - u) ** 3, 3 * u * (1 - u) ** 2, 3 * u * u * (1 - u), u**3]
            low, high = (u, high) if np.dot(weights, xs) < moment - times[left] else (low, u)
        seen.append(np.dot(weights, ys))
    return np.array(seen)


def test_weights_come_back_at_the_times_of_the_frames(tmp_path: Path) -> None:
    clip = waves("jawOpen", "mouth/close", fps=29.97)
    export_clip(path := tmp_path / "a.tres", clip)
    fields, tracks = read_godot(path)
    assert fields["resource_name"] == "a"
    assert fields["length"] == pytest.approx(clip.duration, abs=1e-6)
    assert fields["step"] == pytest.approx(1 / 29.97)
    for name, track in zip(clip.names, tracks, strict=True):
        assert (track["type"], track["path"]) == ("blend_shape", f"head:{name}")
        assert (track["interp"], track["enabled"]) == (1, True)
        keys = table(track["keys"], 3)
        assert len(keys) == (1 if name == "still" else len(clip))
        np.testing.assert_allclose(keys[:, 0], clip.times[: len(keys)], atol=1e-6)
        np.testing.assert_array_equal(keys[:, 1], 1)
        np.testing.assert_allclose(keys[:, 2], clip.curve(name)[: len(keys)], atol=1e-6)


def test_few_keys_are_bezier_tracks_within_the_bound(tmp_path: Path) -> None:
    clip = waves("jawOpen", "mouthClose", frames=600)
    export_clip(path := tmp_path / "a.tres", clip, options=ExportOptions(keys=BOUND))
    for name, track in zip(clip.names, read_godot(path)[1], strict=True):
        assert (track["type"], track["path"]) == ("bezier", f"head:blend_shapes/{name}")
        keys = track["keys"]
        assert len(keys["handle_modes"].args) == len(keys["times"].args) < len(clip) / 8
        assert np.abs(bezier(keys, clip.times) - clip.curve(name)).max() <= BOUND


@pytest.mark.parametrize("name", ["口_あ", 'a "b" \\ c', "a b", "[x]", "tab, comma"])
def test_odd_names_come_back(tmp_path: Path, name: str) -> None:
    export_clip(path := tmp_path / "a.tres", waves(name, still=""))
    assert read_godot(path)[1][0]["path"] == f"head:{name}"


def test_bones_come_back_as_places_and_turns(tmp_path: Path) -> None:
    performance = jaw_of_bones()
    export_all(path := tmp_path / "a.tres", performance)
    clip = performance.clip
    tracks = {(t["type"], t["path"]): t["keys"] for t in read_godot(path)[1]}
    assert len(tracks) == 4  # the head only turns
    places = table(tracks["position_3d", "Skeleton3D:jaw"], 5)
    np.testing.assert_allclose(places[:, 2:4], [[0.01, -0.04]] * len(clip), atol=1e-7)
    np.testing.assert_allclose(places[:, 4], 0.02 + clip.curve("jaw.tz"), atol=1e-7)
    turns = table(tracks["rotation_3d", "Skeleton3D:jaw"], 6)
    z = Rotation.from_rotvec(np.outer(clip.curve("jaw.rz"), [0, 0, 1]), degrees=True)
    x = Rotation.from_rotvec(np.outer(clip.curve("jaw.rx"), [1, 0, 0]), degrees=True)
    seen = Rotation.from_quat(turns[:, 2:]).as_matrix()
    np.testing.assert_allclose(seen, (z * x).as_matrix(), atol=1e-6)
    assert table(tracks["rotation_3d", "Skeleton3D:head"], 6).tolist() == [[0, 1, 0, 0, 0, 1]]


def test_a_bone_that_only_moves_has_no_turns(tmp_path: Path) -> None:
    performance = jaw_of_bones()
    moved = Performance(performance.clip.select(["jaw.tz"]), rig=performance.rig)
    export_all(path := tmp_path / "a.tres", moved)
    assert [t["type"] for t in read_godot(path)[1]] == ["position_3d"]


def test_one_frame_has_a_length(tmp_path: Path) -> None:
    export_clip(path := tmp_path / "a.tres", waves("jawOpen", frames=1))
    assert read_godot(path)[0]["length"] == 0.001


def test_what_godot_cannot_hold_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.tres"
    with pytest.raises(LipwrightError, match=r"a\.tres: .*no controls"):
        export_clip(path, Clip((), 60, np.zeros((3, 0))))
    with pytest.raises(LipwrightError, match="cannot have ':' in the name of the control 'jaw:o'"):
        export_clip(path, waves("jaw:o"))
    with pytest.raises(LipwrightError, match="no blendshape and no bone"):
        export_clip(path, waves("headPitch", still=""))
