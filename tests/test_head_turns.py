"""Heads that turn: the neck, the video, and the angles of Live Link Face."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lipwright.clip import Clip
from lipwright.controls import ARKIT, CANONICAL, HEAD_ANGLES
from lipwright.export import ExportOptions, export_clip
from lipwright.export.livelink_read import read_live_link
from lipwright.face.head import Head
from lipwright.face.neck import turn_shares, turned
from lipwright.face.render import Renderer, pose_weights
from lipwright.face.shading import CAMERAS

QUARTERS = ((0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.3), (-0.2, 0.1, -0.25))


def spoken(frames: int = 12, fps: float = 30.0) -> Clip:
    """Lips and head that move, in the canonical controls and angles."""
    rng = np.random.default_rng(5)
    values = np.concatenate(
        [rng.uniform(0, 1, (frames, len(CANONICAL))), rng.uniform(-0.3, 0.3, (frames, 3))], axis=1
    )
    return Clip(CANONICAL + HEAD_ANGLES, fps, values.astype(np.float32))


# --- the neck ---


def test_the_shirt_stays_the_face_turns_whole_and_the_neck_in_part(head: Head) -> None:
    shares = turn_shares(head)
    parts = {part.name: shares[part.vertices] for part in head.parts}
    assert (parts["shirt"] == 0).all()
    for name in ("eyeLeft", "eyeRight", "teethUpper", "teethLower", "tongue", "mouth"):
        assert (parts[name] == 1).all(), name
    assert (parts["skin"] == 0).any()
    assert ((parts["skin"] > 0) & (parts["skin"] < 1)).any()
    for name in ("jawOpen", "mouthFunnel", "eyeBlinkLeft"):
        moved, by = head.shape(name)
        much = moved[np.linalg.norm(by, axis=1) > 0.005]  # m; the throat follows the jaw a little
        assert shares[much].min() > 0.8, f"{name} moves the face"


@pytest.mark.parametrize("angles", QUARTERS)
def test_a_turned_face_keeps_its_shape_and_turns_about_the_joint(
    head: Head, angles: tuple[float, float, float]
) -> None:
    shares = turn_shares(head)
    face = shares == 1
    after = turned(head.vertices, shares, angles)[face].astype(np.float64)
    before = head.vertices[face].astype(np.float64)
    yaw, pitch, roll = angles
    expected = Rotation.from_euler("zxy", (roll, -pitch, yaw)).apply(before)
    assert np.abs(after - expected).max() < 1e-6
    assert np.abs(turned(head.vertices, shares, (0, 0, 0)) - head.vertices).max() == 0


def test_neighbours_on_the_neck_stay_neighbours(head: Head) -> None:
    shares = turn_shares(head)
    edges = np.concatenate([head.triangles[:, [0, 1]], head.triangles[:, [1, 2]]])
    steps = np.abs(np.diff(shares[edges], axis=1))
    assert steps.max() < 0.5, "no gap opens between two vertices of a triangle"


# --- pictures ---


def brightest_side(picture: np.ndarray) -> float:
    """Where the skin is, from -1 at the left edge of the picture to 1 at the right."""
    red = picture[: picture.shape[0] // 2, :, 0].astype(float)
    weight = (red > 120).sum(axis=0)
    return float((weight * np.linspace(-1, 1, len(weight))).sum() / weight.sum())


def test_yaw_turns_the_drawn_face_to_its_own_left(head: Head) -> None:
    with Renderer(head, 96, 96, "software") as renderer:
        rest = pose_weights()
        ahead = renderer.render(rest)
        assert (renderer.render(rest, (0, 0, 0)) == ahead).all()
        left, right = (brightest_side(renderer.render(rest, (yaw, 0, 0))) for yaw in (0.3, -0.3))
    # The character looks at us: its left is the right of the picture.
    assert left > brightest_side(ahead) + 0.03 > right + 0.06


def test_a_video_turns_the_head(head: Head, tmp_path: Path) -> None:
    import av

    still = Clip(("jawOpen", "headYaw"), 25, np.zeros((4, 2), np.float32))
    turning = still.with_curves({"headYaw": np.array([0.3, 0.3, 0.3, 0.3])})
    pictures = []
    for name, clip in (("still", still), ("turning", turning)):
        path = tmp_path / f"{name}.mp4"
        export_clip(path, clip, options=ExportOptions(size=(96, 96)))
        with av.open(str(path)) as video:
            pictures.append(next(video.decode(video=0)).to_ndarray(format="rgb24"))
    assert brightest_side(pictures[1]) > brightest_side(pictures[0]) + 0.03
    assert CAMERAS["face"].target[0] == 0  # or the comparison means nothing


# --- Live Link Face ---


def test_live_link_has_the_apps_signs(tmp_path: Path) -> None:
    clip = spoken()
    export_clip(tmp_path / "take.livelink.csv", clip)
    read = read_live_link(tmp_path / "take.livelink.csv")
    assert read.angles is not None
    yaw, pitch, roll = clip.select(HEAD_ANGLES).values.T
    assert np.allclose(read.angles[:, :3], np.stack([yaw, -pitch, roll], axis=1), atol=1e-7)
    assert not read.angles[:, 3:].any()
    assert np.allclose(read.values, clip.select(ARKIT).values, atol=1e-7)


def epic_rotator(angles: tuple[float, float, float]) -> tuple[float, float, float]:
    """Yaw, pitch and roll that Epic's plugin reports of a face anchor turned by our angles, rad.

    A second way to the signs, by its quaternions: a face anchor's rotation (right-handed, y up) in
    Unreal's axes (left-handed, z up), as a rotator, and mirrored back to the face's own sides.
    """
    yaw, pitch, roll = angles
    x, y, z, w = Rotation.from_euler("zxy", (roll, -pitch, yaw)).as_quat()
    x, y, z, w = -z, x, y, -w
    up = 2 * (z * x - w * y)
    around = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    lean = np.arctan2(-2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return -float(around), float(np.arcsin(up)), -float(lean)


@pytest.mark.parametrize("angles", QUARTERS)
def test_the_apps_signs_follow_from_its_source(angles: tuple[float, float, float]) -> None:
    yaw, pitch, roll = angles
    assert epic_rotator(angles) == pytest.approx((yaw, -pitch, roll), abs=1e-9)


def test_live_link_without_turns_keeps_still_angles(tmp_path: Path) -> None:
    export_clip(tmp_path / "take.livelink.csv", spoken().select(CANONICAL))
    read = read_live_link(tmp_path / "take.livelink.csv")
    assert read.angles is not None
    assert not read.angles.any()
