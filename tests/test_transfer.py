"""Surfaces and deformation transfer: laws, a second implementation, and broken meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from lipwright.errors import LipwrightError
from lipwright.face.gradients import GradientMeter, surface_gradient
from lipwright.face.head import Head
from lipwright.face.partners import Partners, partners_of, same_topology
from lipwright.face.surface import Surface, mesh_surface, weld_seams
from lipwright.face.surface_obj import read_obj_surface
from lipwright.face.transfer import TransferSolver, best_similarity

Floats = NDArray[np.float64]
SHAPES = ("jawOpen", "mouthClose", "mouthSmileLeft", "eyeBlinkRight", "eyeLookUpLeft", "tongueOut")
METRE = 1e-6  # m, to which shapes are reproduced
TURN = Rotation.from_euler("xyz", [20, -35, 10], degrees=True).as_matrix()


def bowl(side: int = 5, seed: int = 3) -> Surface:
    """A small bent sheet, shaken."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side))
    points = np.stack([x.ravel(), y.ravel(), 0.4 * (x**2 - y * x).ravel()], axis=1)
    points += rng.normal(0, 0.03, points.shape)
    corner = np.arange(side * side).reshape(side, side)
    a, b, c, d = (
        c.ravel() for c in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    )
    return Surface(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


def bent(points: Floats, amount: float = 0.3) -> Floats:
    x, y, z = points.T
    turned = np.stack([x * np.cos(amount * y) - z * np.sin(amount * y), y * (1 + amount * x / 2),
                       x * np.sin(amount * y) + z * np.cos(amount * y)], axis=1)  # fmt: skip
    return np.asarray(turned)


def alike(source: Surface, target: Surface) -> TransferSolver:
    return TransferSolver(source, target, same_topology(source, target))


def shape_of(head: Head, name: str) -> Floats:
    found = np.zeros((len(head.vertices), 3))
    moved, by = head.shape(name)
    found[moved] = by
    return found


def moved_surface(surface: Surface, scale: float, turn: Floats, shift: Floats) -> Surface:
    return Surface(scale * surface.vertices @ turn.T + shift, surface.triangles, surface.welds)


@pytest.fixture(scope="module")
def own(head: Head) -> tuple[Surface, TransferSolver]:
    surface = mesh_surface(head)
    return surface, alike(surface, surface)


def test_onto_itself_the_head_keeps_its_shapes(
    head: Head, own: tuple[Surface, TransferSolver]
) -> None:
    for name, made in zip(SHAPES, own[1].blendshapes(head, SHAPES), strict=True):
        assert np.abs(made - shape_of(head, name)).max() < METRE, name


def test_at_rest_nothing_moves(head: Head, own: tuple[Surface, TransferSolver]) -> None:
    assert np.abs(own[1].displacements(head.vertices)).max() < 1e-9


@pytest.mark.parametrize(
    ("scale", "turn", "shift"),
    [(1.0, np.eye(3), [0.3, -2.0, 5.0]), (1.0, TURN, [0, 0, 0]), (17.5, np.eye(3), [0, 0, 0]),
     (0.02, TURN, [1.0, 2.0, 3.0])],
    ids=["shifted", "turned", "scaled", "all"],
)  # fmt: skip
def test_a_target_shifted_turned_and_scaled_has_shapes_turned_and_scaled(
    head: Head,
    own: tuple[Surface, TransferSolver],
    scale: float,
    turn: Floats,
    shift: list[float],
) -> None:
    source = own[0]
    solver = alike(source, moved_surface(source, scale, turn, np.array(shift)))
    assert solver.placement.scale == pytest.approx(scale)
    np.testing.assert_allclose(solver.placement.rotation, turn, atol=1e-9)
    for name, made in zip(SHAPES[:3], solver.blendshapes(head, SHAPES[:3]), strict=True):
        wanted = scale * shape_of(head, name) @ turn.T
        assert np.abs(made - wanted).max() < METRE * scale, name


def test_a_rigid_motion_of_the_source_is_the_same_motion_of_the_target() -> None:
    source = bowl()
    target = Surface(bent(source.vertices, 0.5), source.triangles)
    solver = alike(source, target)
    posed = source.vertices @ TURN.T + [3.0, 1.0, -2.0]
    made = solver.shape(posed)
    lengths = [np.linalg.norm(v[target.triangles] - v[target.triangles[:, [1, 2, 0]]], axis=2)
               for v in (target.vertices, made)]  # fmt: skip
    np.testing.assert_allclose(*lengths, atol=1e-9)


def test_poses_come_one_after_another_as_each_alone(head: Head) -> None:
    source = bowl()
    solver = alike(source, Surface(bent(source.vertices), source.triangles))
    poses = [bent(source.vertices, amount) for amount in (0.1, 0.2)]
    for frame, pose in zip(solver.frames(poses), poses, strict=True):
        assert (frame == solver.shape(pose)).all()


def dense_transfer(source: Surface, target: Surface, table: Floats, posed: Floats) -> Floats:
    """The paper's equations with all fourth vertices unknown, by dense least squares.

    Triangles are weighted by area; the placement must be the identity. The first vertex stays.
    """

    def frames(vertices: Floats, surface: Surface) -> Floats:
        a, b, c = (vertices[surface.triangles[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        fourth = normal / np.sqrt(np.linalg.norm(normal, axis=1))[:, None]
        return np.stack([b - a, c - a, fourth], axis=2)

    aims = frames(posed, source) @ np.linalg.inv(frames(source.vertices, source))
    inverse = np.linalg.inv(frames(target.vertices, target))
    count, n = len(target.vertices), len(target.triangles)
    rows, right = [np.eye(1, count + n)[0] * 1e3], [target.vertices[0] * 1e3]
    for j, (a, b, c) in enumerate(target.triangles):
        wanted = np.tensordot(table[j], aims, 1)
        for axis in range(3):
            row = np.zeros(count + n)
            for column, vertex in zip(inverse[j][:, axis], (b, c, count + j), strict=True):
                row[vertex] += column
                row[a] -= column
            weight = np.sqrt(target.areas[j])
            rows.append(weight * row)
            right.append(weight * wanted[:, axis])
    found = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
    return np.asarray(found[:count] - target.vertices)


def test_the_solver_agrees_with_the_papers_equations_solved_densely() -> None:
    source = bowl(6)
    target = Surface(bent(source.vertices, 0.25) * [1.1, 0.9, 1.3], source.triangles)
    solver = alike(source, target)
    posed = bent(source.vertices, -0.5)
    n = len(source.triangles)
    placed = solver.placement
    dense = dense_transfer(
        Surface(placed.apply(source.vertices), source.triangles), target, np.eye(n),
        placed.apply(posed),
    )  # fmt: skip
    made = solver.displacements(posed)
    difference = made - dense
    np.testing.assert_allclose(difference - difference.mean(axis=0), 0, atol=1e-8)


def test_the_shapes_of_mixed_partners_are_the_dense_ones_too() -> None:
    rng = np.random.default_rng(5)
    source, target = bowl(4), bowl(6, seed=9)
    n, m = len(target.triangles), len(source.triangles)
    first, second = np.repeat(np.arange(n), 2), rng.integers(0, m, 2 * n)
    partners = partners_of(first, second, rng.uniform(0.5, 1, 2 * n), (n, m))
    solver = TransferSolver(source, target, partners)
    placed = Surface(solver.placement.apply(source.vertices), source.triangles)
    posed = bent(source.vertices, 0.4)
    dense = dense_transfer(
        placed, target, partners.weights.toarray(), solver.placement.apply(posed)
    )
    difference = solver.displacements(posed) - dense
    np.testing.assert_allclose(difference - difference.mean(axis=0), 0, atol=1e-8)


def test_a_planted_stretch_comes_over_to_another_mesh() -> None:
    source, target = bowl(5), bowl(9, seed=4)
    stretch = np.array([[1.2, 0.1, 0.0], [0.0, 0.9, 0.0], [0.05, 0.0, 1.1]])
    n, m = len(target.triangles), len(source.triangles)
    nearest = np.linalg.norm(target.centroids[:, None] - source.centroids[None], axis=2).argmin(1)
    solver = TransferSolver(source, target, partners_of(np.arange(n), nearest, np.ones(n), (n, m)))
    turn = solver.placement.rotation  # the sheets differ, and are laid onto each other
    flat = source.vertices @ stretch.T
    wanted = target.vertices @ (turn @ stretch @ turn.T).T
    made = solver.shape(flat)
    # The fourth vertex does not stretch as the triangle does: what is along the sheet is exact.
    error = (made - made.mean(0)) - (wanted - wanted.mean(0))
    assert np.abs(error).max() < 0.03


def test_gradients_are_linear_in_their_result(own: tuple[Surface, TransferSolver]) -> None:
    solver = own[1]
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(2, len(own[0].triangles), 3, 3))
    made = [solver._poisson.solve(turned) for turned in (first, second, 2 * first - 3 * second)]
    np.testing.assert_allclose(made[2], 2 * made[0] - 3 * made[1], atol=1e-6)


def test_the_gradient_of_a_linear_function_is_its_slope_along_the_surface() -> None:
    surface, slope = bowl(), np.array([0.3, -2.0, 0.7])
    found = (surface_gradient(surface) @ (surface.places @ slope)).reshape(-1, 3)
    along = slope - (surface.normals @ slope)[:, None] * surface.normals
    np.testing.assert_allclose(found, along, atol=1e-12)


def test_gradients_measure_a_turn_as_that_turn() -> None:
    surface = bowl()
    found = GradientMeter(surface).gradients(surface.places @ TURN.T + 4)
    np.testing.assert_allclose(found, np.broadcast_to(TURN, found.shape), atol=1e-12)


def with_island(surface: Surface) -> Surface:
    """And a copy of it far off."""
    count = len(surface.vertices)
    return Surface(
        np.concatenate([surface.vertices, np.add(surface.vertices, [0.0, 0.0, 5.0])]),
        np.concatenate([surface.triangles, surface.triangles + count]),
    )


def test_triangles_without_partners_move_as_those_around_them() -> None:
    source = bowl(7)
    n = len(source.triangles)
    kept = np.setdiff1d(np.arange(n), [10, 11, 46, 47])
    solver = TransferSolver(source, source, partners_of(kept, kept, np.ones(len(kept)), (n, n)))
    posed = bent(source.vertices, 0.2)
    assert np.abs(solver.shape(posed) - posed).max() < 0.02


def test_a_piece_without_partners_follows_the_nearest_that_has_some() -> None:
    source, target = bowl(), with_island(bowl())
    n = len(source.triangles)
    partners = partners_of(np.arange(n), np.arange(n), np.ones(n), (2 * n, n))
    made = TransferSolver(source, target, partners).displacements(
        np.add(source.vertices, [1.0, 2.0, 3.0])
    )
    np.testing.assert_allclose(made, np.broadcast_to([1.0, 2.0, 3.0], made.shape), atol=1e-9)


def test_pieces_that_move_apart_do_so_on_the_target() -> None:
    source = with_island(bowl())
    posed = source.vertices.copy()
    posed[len(posed) // 2 :] += [0.5, 0.0, 0.0]
    target = moved_surface(source, 2.0, TURN, np.zeros(3))
    made = alike(source, target).displacements(posed)
    np.testing.assert_allclose(made, 2 * (posed - source.vertices) @ TURN.T, atol=1e-9)


def test_degenerate_triangles_are_left_out_and_their_vertices_follow() -> None:
    whole = bowl()
    line = np.array([[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [1.0, 0.0, 1.0]])
    count = len(whole.vertices)
    target = Surface(
        np.concatenate([whole.vertices, line]),
        np.concatenate([whole.triangles, [[count, count + 1, count + 2]]]),
    )
    n = len(whole.triangles)
    partners = partners_of(np.arange(n), np.arange(n), np.ones(n), (n + 1, n))
    made = TransferSolver(whole, target, partners).displacements(whole.vertices + 1.0)
    assert target.flat.sum() == 1
    np.testing.assert_allclose(made, 1.0, atol=1e-9)


def test_best_similarity_finds_what_was_planted_and_no_mirror_image() -> None:
    rng = np.random.default_rng(2)
    points = rng.normal(size=(20, 3))
    found = best_similarity(points, 3 * points @ TURN.T + 7, rng.uniform(0.1, 1, 20))
    np.testing.assert_allclose(found.apply(points), 3 * points @ TURN.T + 7, atol=1e-9)
    mirrored = best_similarity(points, points * [-1, 1, 1], np.ones(20))
    assert np.linalg.det(mirrored.rotation) == pytest.approx(1)
    with pytest.raises(ValueError, match="on one line"):
        best_similarity(np.outer(np.arange(4), [1.0, 2, 3]), points[:4], np.ones(4))


def test_other_topology_is_told_by_what_differs() -> None:
    source = bowl()
    for other, what in (
        (bowl(6), r"has 36 vertices and the source has 25"),
        (Surface(source.vertices, source.triangles[:-1]), r"has 31 triangles and .* has 32"),
        (
            Surface(source.vertices, source.triangles[:, [1, 2, 0]]),
            r"triangle 0 joins the vertices",
        ),
    ):
        with pytest.raises(LipwrightError, match=f"hero.glb: .*{what}") as caught:
            same_topology(source, other, "hero.glb")
        assert "\n" not in str(caught.value)


def test_no_partners_at_all_is_told() -> None:
    source = bowl()
    n = len(source.triangles)
    none = partners_of(np.zeros(0, int), np.zeros(0, int), np.zeros(0), (n, n))
    assert isinstance(none, Partners)
    assert none.alone == n
    with pytest.raises(LipwrightError, match="no triangle of the target has a partner"):
        TransferSolver(source, source, none)


@pytest.mark.parametrize(
    ("vertices", "triangles", "what"),
    [
        (np.zeros((0, 3)), [[0, 1, 2]], "no vertices"),
        (np.eye(3), np.zeros((0, 3)), "no triangles"),
        ([[0, 0, 0], [1, 0, np.nan], [0, 1, 0]], [[0, 1, 2]], r"vertex 1 is at \(1, 0, nan\)"),
        (np.eye(3), [[0, 1, 3]], r"triangle 0 names vertices \[0, 1, 3\] of 3"),
    ],
)
def test_a_surface_that_cannot_be_is_refused(
    vertices: Floats, triangles: NDArray[np.int64], what: str
) -> None:
    with pytest.raises(ValueError, match=what):
        Surface(np.array(vertices, float), np.array(triangles, int))


def test_an_edge_of_three_triangles_is_named_with_its_place() -> None:
    fins = Surface(
        np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0.0]]),
        np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
    )
    with pytest.raises(ValueError, match=r"vertices 0 and 1 at \(0, 0, 0\) has 3"):
        fins.check_usable()
    flat = Surface(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0.0]]), np.array([[0, 1, 2]]))
    with pytest.raises(ValueError, match="all triangles are degenerate"):
        flat.check_usable()


def test_seams_are_welded_and_lips_that_touch_are_not() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    seam = np.concatenate([square, np.add(square, [1, 0, 0])])
    quads = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    assert weld_seams(seam, quads).tolist() == [0, 1, 2, 3, 1, 5, 6, 2]
    lips = np.concatenate([square, square])  # the second faces down
    facing = np.array([[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]])
    assert weld_seams(lips, facing).tolist() == list(range(8))
    assert Surface(lips, facing, weld_seams(lips, facing)).pieces.max() == 1


OBJ = """\
# a pyramid with a base of four corners
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0.5 0.5 1
vt 0 0
vt 1 0.25
f 4/1 3/1 2/1 1/1
f 1/1 2/2 5/1
f -4/2/1 -3//2 -1
f 3 4 5
f 4 1 5
"""


def test_an_obj_keeps_its_vertex_numbers_and_splits_seams_after_them(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(OBJ)
    surface = read_obj_surface(path)
    assert surface.vertices[:5].tolist()[4] == [0.5, 0.5, 1]
    assert len(surface.places) == 5
    assert len(surface.triangles) == 6
    assert surface.corners[:2].tolist() == [[3, 2, 1], [3, 1, 0]]
    assert surface.corners[3].tolist() == [1, 2, 4]
    assert surface.uvs is not None
    assert surface.uvs[0].tolist() == [0, 1]  # counted from the top
    assert surface.uvs[surface.triangles[2, 1]].tolist() == [1, 0.75]
    surface.check_usable()
    assert not surface.border.any()


@pytest.mark.parametrize(
    ("text", "what"),
    [("v 1 2\nf 1 1 1\n", "line 1: not understood: 'v 1 2'"), ("v 0 0 0\nf 1 2 3\n", "line 2"),
     ("v 0 0 0\nf 1 1\n", "line 2"), ("v 0 0 0\n", "has no faces"), ("v 0 x 0\n", "line 1")],
)  # fmt: skip
def test_a_broken_obj_is_told_by_file_and_line(tmp_path: Path, text: str, what: str) -> None:
    path = tmp_path / "broken.obj"
    path.write_text(text)
    with pytest.raises(LipwrightError, match=f"broken.obj.*{what}"):
        read_obj_surface(path)
