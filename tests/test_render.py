"""Pictures of the head, by OpenGL and by software."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.png import encode_png, write_png
from lipwright.face.raster import barycentric, rasterise
from lipwright.face.render import Renderer, pose_weights, render_contact_sheet
from lipwright.face.shading import encode

SIZE = 192
POSES = {
    "rest": {},
    "open": {"jawOpen": 0.5, "mouthSmileLeft": 0.5, "mouthSmileRight": 0.5},
    "blink": {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0, "mouthPucker": 0.8},
}


@pytest.fixture(scope="session")
def gl_works(head: Head) -> bool:
    try:
        Renderer(head, 16, 16, "gl").close()
    except LipwrightError:
        return False
    return True


@pytest.fixture
def no_gl(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "moderngl", None)


@pytest.mark.parametrize("view", ["face", "mouth"])
@pytest.mark.parametrize("pose", POSES)
def test_both_backends_draw_the_same_picture(
    head: Head, gl_works: bool, pose: str, view: str
) -> None:
    if not gl_works:
        pytest.skip("there is no working OpenGL here")
    weights = pose_weights(**POSES[pose])
    with (
        Renderer(head, SIZE, SIZE, "gl", view) as gl,
        Renderer(head, SIZE, SIZE, "software", view) as software,
    ):
        difference = np.abs(gl.render(weights).astype(int) - software.render(weights))
    assert difference.mean() < 2.0
    assert np.quantile(difference, 0.95) < 12


def test_two_gl_renderers_do_not_disturb_each_other(head: Head, gl_works: bool) -> None:
    if not gl_works:
        pytest.skip("there is no working OpenGL here")
    weights = pose_weights()
    with Renderer(head, 64, 64, "gl") as alone:
        expected = alone.render(weights)
    with Renderer(head, 64, 64, "gl") as first, Renderer(head, 96, 48, "gl", "mouth") as second:
        second.render(weights)
        np.testing.assert_array_equal(first.render(weights), expected)


def test_auto_falls_back_to_software_without_gl(head: Head, no_gl: None) -> None:
    with Renderer(head, 64, 48) as renderer:
        assert renderer.backend == "software"
        assert renderer.render(pose_weights()).shape == (48, 64, 3)


def test_asking_for_gl_without_gl_is_one_clear_line(head: Head, no_gl: None) -> None:
    with pytest.raises(LipwrightError, match="OpenGL does not work here") as refused:
        Renderer(head, 64, 64, "gl")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(("width", "height"), [(160, 90), (90, 160), (101, 77)])
def test_pictures_of_any_shape_show_the_whole_face(head: Head, width: int, height: int) -> None:
    with Renderer(head, width, height, "software") as renderer:
        picture = renderer.render(pose_weights())
    assert picture.shape == (height, width, 3)
    assert picture.dtype == np.uint8
    reddish = picture[..., 0].astype(int) - picture[..., 2] > 30
    rows, columns = np.flatnonzero(reddish.any(axis=1)), np.flatnonzero(reddish.any(axis=0))
    assert 0 < rows.min() < rows.max() < height
    assert 0 < columns.min() < columns.max() < width - 1
    assert abs((columns.min() + columns.max()) / 2 - width / 2) < 0.05 * width


def test_the_same_pose_gives_the_same_picture_and_another_does_not(head: Head) -> None:
    with Renderer(head, 96, 96, "software") as renderer:
        rest, again = (renderer.render(pose_weights()) for _ in range(2))
        wide = renderer.render(pose_weights(jawOpen=0.6))
    np.testing.assert_array_equal(rest, again)
    assert np.abs(rest.astype(int) - wide).max() > 60


def test_the_open_mouth_is_dark_inside(head: Head) -> None:
    with Renderer(head, 128, 128, "software", "mouth") as renderer:
        shut = renderer.render(pose_weights()).astype(int)
        opened = renderer.render(pose_weights(jawOpen=1.0)).astype(int)
    middle = np.s_[56:76, 54:74]
    assert opened[middle].min() < 40 < shut[middle].mean()


def test_an_unknown_control_is_refused() -> None:
    with pytest.raises(ValueError, match="jawOpn"):
        pose_weights(jawOpn=1.0)


def test_a_contact_sheet_is_one_png_of_all_poses(head: Head, tmp_path: Path) -> None:
    path = tmp_path / "sheet.png"
    render_contact_sheet(head, [{}, {"jawOpen": 0.5}, {}], path, columns=2, size=48,
                         backend="software")  # fmt: skip
    assert decoded(path.read_bytes()).shape == (96, 96, 3)
    with pytest.raises(ValueError, match="at least one pose"):
        render_contact_sheet(head, [], path)


# --- PNG


def decoded(data: bytes) -> np.ndarray:
    """The pixels by FFmpeg, which shares no code with ours."""
    import av

    codec = av.CodecContext.create("png", "r")
    (frame,) = codec.decode(av.Packet(data))
    return frame.to_ndarray(format="rgb24")


@settings(max_examples=30, deadline=None)
@given(arrays.arrays(np.uint8, st.tuples(st.integers(1, 20), st.integers(1, 20), st.just(3))))
def test_png_files_hold_the_pixels_exactly(pixels: np.ndarray) -> None:
    np.testing.assert_array_equal(decoded(encode_png(pixels)), pixels)


@pytest.mark.parametrize("pixels", [
    np.zeros((2, 2), np.uint8), np.zeros((2, 2, 4), np.uint8), np.zeros((2, 2, 3)),
    np.zeros((0, 2, 3), np.uint8),
])  # fmt: skip
def test_what_is_no_picture_is_refused(pixels: np.ndarray, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not \\(H, W, 3\\) uint8"):
        write_png(tmp_path / "a.png", pixels)
    assert not list(tmp_path.iterdir())


def test_an_unwritable_png_is_one_clear_line(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="cannot be written"):
        write_png(tmp_path / "absent" / "a.png", np.zeros((2, 2, 3), np.uint8))


# --- rasteriser


@settings(max_examples=40, deadline=None)
@given(arrays.arrays(np.float32, (9, 3), elements=st.floats(-4, 20, width=16)))
def test_the_rasteriser_agrees_with_a_loop_over_pixels(points: np.ndarray) -> None:
    # Corners on odd sixteenths keep edges off the centres of pixels, where ties are arbitrary.
    points = points.copy()
    points[:, :2] = np.round(points[:, :2] * 16) / 16 + 1 / 61
    points[:, 2] += np.arange(9) * 7  # depths differ
    points[:, 2] = np.repeat(points[::3, 2], 3)  # and triangles are level
    triangles = np.arange(9, dtype=np.int32).reshape(3, 3)
    covered, chosen = rasterise(points.astype(np.float32), triangles, 16, 12)
    found = np.full(12 * 16, -1)
    found[covered] = chosen
    for place in range(12 * 16):
        centre = np.array([place % 16 + 0.5, place // 16 + 0.5])
        inside = [t for t in range(3) if is_inside(points[triangles[t], :2], centre)]
        best = min(inside, key=lambda t: points[3 * t, 2], default=-1)
        assert found[place] == best or is_near_edge(points, triangles, centre)


def is_inside(corners: np.ndarray, point: np.ndarray) -> bool:
    turns = turns_at(corners, point)
    return bool((turns > 0).all() or (turns < 0).all())


def turns_at(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    edges = np.roll(corners, -1, axis=0).astype(float) - corners
    away = point - corners
    return edges[:, 0] * away[:, 1] - edges[:, 1] * away[:, 0]


def is_near_edge(points: np.ndarray, triangles: np.ndarray, point: np.ndarray) -> bool:
    return any(np.abs(turns_at(points[t, :2], point)).min() < 1e-2 for t in triangles)


def test_barycentric_shares_give_back_the_place() -> None:
    points = np.array([[1, 1, 0], [14, 3, 0], [5, 11, 0]], np.float32)
    triangles = np.array([[0, 1, 2]], np.int32)
    covered, chosen = rasterise(points, triangles, 16, 12)
    shares = barycentric(points, triangles, covered, chosen, 16)
    np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-5)
    assert shares.min() >= -1e-5
    places = shares @ points[:, :2]
    np.testing.assert_allclose(places[:, 0], covered % 16 + 0.5, atol=1e-4)
    np.testing.assert_allclose(places[:, 1], covered // 16 + 0.5, atol=1e-4)


def test_the_fast_srgb_curve_is_within_a_step_of_the_standard() -> None:
    light = np.linspace(0, 1, 4001, dtype=np.float32)
    exact = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.abs(encode(light) - exact).max() < 1 / 255
