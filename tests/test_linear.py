"""Linear mappings: gains, clamps and correctives, and their fit by least squares."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.retarget import apply_linear, retarget
from lipwright.retarget.fit_poses import every_pair, speech_poses
from lipwright.retarget.fit_solve import Problem, best_product, solve, solve_few
from lipwright.retarget.fitting import OF_MESHES, SPEECH, FitOptions, fit_looks, fit_meshes
from lipwright.retarget.refitting import follows_speech, refitted
from lipwright.rig import Control, Corrective, LinearMapping, Rig, Row, canonical_rig, load_rig

Floats = npt.NDArray[np.float64]


def moving(**curves: list[float]) -> Clip:
    """Canonical curves at 10 frames a second; the others rest."""
    count = len(next(iter(curves.values())))
    clip = Clip(CANONICAL, 10, np.zeros((count, len(CANONICAL)), np.float32))
    return clip.with_curves(curves)


def box(*controls: Control, **rows: Row) -> tuple[Rig, LinearMapping]:
    mapping = LinearMapping(rows)
    return Rig(name="box", controls=controls, mirror={}, mapping=mapping), mapping


class TestApply:
    def test_a_control_is_its_offset_and_its_gains_within_its_clamp_and_range(self) -> None:
        rig, mapping = box(
            Control("lid", 0, 1, 0.25), Control("far", -2, 2), Control("still", 0, 1, 0.5),
            lid=Row({"jawOpen": 0.5}, 0.25, (0.0, 0.6)), far=Row({"jawOpen": -3.0}),
        )  # fmt: skip
        moved = apply_linear(moving(jawOpen=[0.0, 0.5, 1.0]), rig, mapping)
        np.testing.assert_allclose(moved.curve("lid"), [0.25, 0.5, 0.6], atol=1e-6)
        np.testing.assert_allclose(moved.curve("far"), [0.0, -1.5, -2.0], atol=1e-6)
        np.testing.assert_allclose(moved.curve("still"), 0.5)

    def test_a_source_without_its_side_is_the_mean_of_both(self) -> None:
        rig, mapping = box(Control("grin"), grin=Row({"mouthSmile": 1.0}))
        clip = moving(mouthSmileLeft=[0.2, 1.0], mouthSmileRight=[0.4, 0.0])
        np.testing.assert_allclose(
            apply_linear(clip, rig, mapping).curve("grin"), [0.3, 0.5], atol=1e-6
        )

    def test_a_corrective_adds_the_product_of_its_sources(self) -> None:
        mapping = LinearMapping(
            {"lid": Row({"jawOpen": 1.0})}, (Corrective("lid", ("jawOpen", "mouthClose"), -1.0),)
        )
        rig = Rig(name="box", controls=(Control("lid"),), mirror={}, mapping=mapping)
        clip = moving(jawOpen=[0.5, 0.5, 0.5], mouthClose=[0.0, 0.5, 1.0])
        np.testing.assert_allclose(retarget(clip, rig).curve("lid"), [0.5, 0.25, 0.0], atol=1e-6)

    def test_a_control_with_only_a_corrective_is_moved_from_its_rest(self) -> None:
        mapping = LinearMapping({}, (Corrective("lid", ("jawOpen", "mouthClose"), -0.4),))
        rig = Rig(name="box", controls=(Control("lid", 0, 1, 0.5),), mirror={}, mapping=mapping)
        clip = moving(jawOpen=[0.0, 1.0, 1.0], mouthClose=[0.0, 0.5, 1.0])
        np.testing.assert_allclose(retarget(clip, rig).curve("lid"), [0.5, 0.3, 0.1], atol=1e-6)

    def test_controls_in_range_are_linear_in_the_clip(self) -> None:
        rig, mapping = box(Control("a", -9, 9), a=Row({"jawOpen": 1.5, "mouthPucker": -0.5}))
        rng = np.random.default_rng(1)
        one, two = (rng.uniform(0, 1, (5, len(CANONICAL))).astype(np.float32) for _ in range(2))
        sums = [apply_linear(Clip(CANONICAL, 10, v), rig, mapping).values for v in (one, two)]
        both = apply_linear(Clip(CANONICAL, 10, one + two), rig, mapping).values
        np.testing.assert_allclose(both, sums[0] + sums[1], atol=1e-5)


def problem(poses: Floats, shown: Floats, wanted: Floats, **changes: object) -> Problem:
    """Least squares and nothing else: no gaps, no penalties, no limits."""
    controls = shown.shape[1]
    plain = Problem(
        poses=poses, weights=np.full(len(poses), 1 / len(poses)), shown=shown, wanted=wanted,
        gaps=np.zeros((0, controls)), wanted_gaps=np.zeros((len(poses), 0)), rest_gaps=np.zeros(0),
        known=np.zeros((len(poses), controls)), sure=np.zeros(len(poses)),
        low=np.full(controls, -1e3), high=np.full(controls, 1e3), ridge=0.0, thrift=0.0,
    )  # fmt: skip
    return replace(plain, **changes)  # type: ignore[arg-type]  # names of fields


class TestSolver:
    rng = np.random.default_rng(7)
    poses = rng.uniform(0, 1, (80, 4))
    shown = rng.normal(size=(12, 3))

    def test_without_limits_it_is_least_squares_as_numpy_has_it(self) -> None:
        wanted = self.rng.normal(size=(80, 12))
        gains = solve(
            problem(self.poses, self.shown, wanted), np.zeros((3, 4)), np.ones((3, 4), bool)
        )
        controls = np.linalg.lstsq(self.shown, wanted.T, rcond=None)[0]
        np.testing.assert_allclose(
            gains, np.linalg.lstsq(self.poses, controls.T, rcond=None)[0].T, atol=1e-6
        )

    def test_planted_gains_are_found_although_controls_stop_at_their_limits(self) -> None:
        planted = np.array([[2.0, 0, 0, -1.0], [0, 0.8, 0, 0], [0, -0.5, 1.5, 0]])
        moved = np.clip(self.poses @ planted.T, 0.0, 1.0)
        limited = problem(
            self.poses, self.shown, moved @ self.shown.T, low=np.zeros(3), high=np.ones(3)
        )
        gains = solve(limited, np.zeros((3, 4)), np.ones((3, 4), bool))
        np.testing.assert_allclose(gains, planted, atol=1e-3)

    def test_gains_that_do_not_matter_are_dropped_and_the_others_refitted(self) -> None:
        planted = np.array([[1.0, 0, 0, 0], [0, 0.7, 0, 0], [0, 0, 0, -0.4]])
        noise = self.rng.normal(scale=0.01, size=(80, 12))
        few = solve_few(
            problem(self.poses, self.shown, self.poses @ planted.T @ self.shown.T + noise),
            np.ones((3, 4), bool), 0.05,
        )  # fmt: skip
        assert ((few != 0) == (planted != 0)).all()
        np.testing.assert_allclose(few, planted, atol=0.02)

    def test_the_product_that_was_planted_helps_most(self) -> None:
        pairs = [(0, 1), (0, 2), (1, 3), (2, 3)]
        products = np.stack([self.poses[:, a] * self.poses[:, b] for a, b in pairs], axis=1)
        wanted = self.poses[:, :1] * self.shown[:, 0] + 0.6 * products[:, 2:3] * self.shown[:, 1]
        one = problem(self.poses, self.shown, wanted)
        gains = np.zeros((3, 4))
        gains[0, 0] = 1.0
        product, control, helps = best_product(one, gains, products, np.ones(3, bool))
        assert (product, control) == (2, 1)
        assert helps > 0.3

    def test_shut_lips_are_shut_however_hard_they_press(self) -> None:
        # The pose presses lips 5 below shut; a control that can only open them stays at rest.
        one = problem(
            np.ones((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)), gaps=np.ones((1, 1)),
            wanted_gaps=np.full((1, 1), -5.0), rest_gaps=np.zeros(1),
        )  # fmt: skip
        assert one.error(np.zeros((1, 1))) == 0.0
        assert one.error(np.full((1, 1), -2.0)) == 0.0
        assert one.error(np.full((1, 1), 2.0)) == 4.0


MOUTH = ("jawOpen", "mouthClose", "mouthPucker", "mouthFunnel")


@cache
def few_poses() -> Floats:
    """A part of speech, and each control by itself: enough for a test."""
    return np.concatenate([speech_poses()[::7], np.eye(len(CANONICAL))])


def character(head: Head, shapes: dict[str, npt.NDArray[np.float32]], **changes: object) -> Mesh:
    """The head's mesh with other blendshapes, each (V, 3)."""
    copied = {field.name: getattr(head, field.name) for field in fields(Mesh)}
    count = len(head.vertices)
    copied |= {
        "name": "target.glb",
        "shape_names": tuple(shapes),
        "shape_starts": np.arange(len(shapes) + 1, dtype=np.int32) * count,
        "shape_vertices": np.tile(np.arange(count, dtype=np.int32), len(shapes)),
        "shape_deltas": np.concatenate([*shapes.values()]),
    }
    return Mesh(**(copied | changes))


def shape_of(head: Head, **weights: float) -> npt.NDArray[np.float32]:
    """(V, 3), what canonical weights move."""
    row = [weights.get(name, 0.0) for name in CANONICAL]
    return head.pose(row) - head.vertices


def rig_of(*names: str) -> Rig:
    return Rig(name="mine", controls=tuple(Control(name, -4, 4) for name in names), mirror={})


def only(*names: str) -> Floats:
    """(200, C), poses in which only these controls move."""
    poses = np.zeros((200, len(CANONICAL)))
    columns = [CANONICAL.index(name) for name in names]
    poses[:, columns] = np.random.default_rng(3).uniform(0, 1, (200, len(columns)))
    return poses


EXACT = FitOptions(sources=MOUTH, poses=only(*MOUTH), ridge=1e-6, thrift=0.0)


class TestFit:
    def test_blendshapes_of_the_same_deformation_follow_it_in_full(self, head: Head) -> None:
        target = character(head, {name.upper(): shape_of(head, **{name: 1.0}) for name in MOUTH})
        fitted = fit_meshes(head, target, rig_of(*target.shape_names), EXACT)
        assert {k: dict(row.gains) for k, row in fitted.mapping.rows.items()} == {
            name.upper(): {name: 1.0} for name in MOUTH
        }
        assert fitted.left["jawOpen"] < 0.01
        assert fitted.left["mouthFunnel"] < 0.01

    def test_planted_mixtures_are_unmixed(self, head: Head) -> None:
        target = character(
            head,
            {
                "ajar": shape_of(head, jawOpen=0.5),
                "kiss": shape_of(head, mouthPucker=1.0, mouthFunnel=0.5),
                "flare": shape_of(head, mouthFunnel=1.0),
                "shut": shape_of(head, mouthClose=2.0),
            },
        )
        fitted = fit_meshes(head, target, rig_of(*target.shape_names), EXACT)
        rows = {name: dict(row.gains) for name, row in fitted.mapping.rows.items()}
        assert rows == {
            "ajar": {"jawOpen": 2.0},
            "kiss": {"mouthPucker": 1.0},
            "flare": {"mouthFunnel": 1.0, "mouthPucker": -0.5},
            "shut": {"mouthClose": 0.5},
        }

    def test_a_character_of_another_size_has_the_same_mapping(self, head: Head) -> None:
        shapes = {"jaw": shape_of(head, jawOpen=1.0) * 3}
        large = character(head, shapes, vertices=head.vertices * 3)
        fitted = fit_meshes(head, large, rig_of("jaw"), replace(EXACT, poses=only("jawOpen")))
        assert fitted.mapping.rows["jaw"].gains["jawOpen"] == pytest.approx(1.0, abs=0.01)

    def test_controls_that_rest_elsewhere_than_at_zero_are_offset(self, head: Head) -> None:
        rig = Rig(name="mine", controls=(Control("jaw", 0, 2, 1.0),), mirror={})
        target = character(head, {"jaw": shape_of(head, jawOpen=1.0)})
        options = replace(EXACT, poses=only("jawOpen") / 2)
        row = fit_meshes(head, target, rig, options).mapping.rows["jaw"]
        assert row.offset == 1.0
        assert row.gains["jawOpen"] == pytest.approx(1.0, abs=0.01)

    def test_a_rig_with_sides_follows_each_side(self, head: Head) -> None:
        target = character(
            head, {f"smile_{s[0]}": shape_of(head, **{f"mouthSmile{s}": 1.0}) for s in SIDES}
        )
        mirror = {"smile_L": "smile_R", "smile_R": "smile_L"}
        rig = replace(rig_of("smile_L", "smile_R"), mirror=mirror)
        smiles = ("mouthSmileLeft", "mouthSmileRight")
        options = replace(EXACT, sources=smiles, poses=only(*smiles))
        rows = fit_meshes(head, target, rig, options).mapping.rows
        assert dict(rows["smile_L"].gains) == {"mouthSmileLeft": pytest.approx(1.0, abs=0.03)}
        assert dict(rows["smile_R"].gains) == {"mouthSmileRight": pytest.approx(1.0, abs=0.03)}

    def test_looks_that_are_canonical_controls_are_followed_one_to_one(self, head: Head) -> None:
        rig = replace(rig_of("a", "b"), looks={"a": {"jawOpen": 1.0}, "b": {"mouthFunnel": 1.0}})
        rows = fit_looks(
            rig, head, replace(EXACT, poses=only("jawOpen", "mouthFunnel"))
        ).mapping.rows
        assert rows["a"].gains["jawOpen"] == pytest.approx(1.0, abs=0.02)
        assert rows["b"].gains["mouthFunnel"] == pytest.approx(1.0, abs=0.02)

    def test_correctives_are_found_where_they_help(self, head: Head) -> None:
        rig = load_rig("vrm1")
        options = FitOptions(controls=("aa", "ou"), poses=few_poses())
        poses = Clip(CANONICAL, 10, few_poses().astype(np.float32))
        wanted = head.aperture_curve(poses.values)
        off = []
        for count in (0, 2):
            mapping = fit_looks(rig, head, replace(options, correctives=count)).mapping
            assert bool(count) <= len(mapping.correctives) <= count
            seen = rig.to_canonical(apply_linear(poses, rig, mapping))
            off.append(float(((head.aperture_curve(seen.values) - wanted) ** 2).mean()))
        assert off[1] < off[0]

    def test_poses_in_which_nothing_moves_are_fitted_without_correctives(self, head: Head) -> None:
        still = FitOptions(controls=("aa",), poses=np.zeros((3, len(CANONICAL))), correctives=2)
        assert fit_looks(load_rig("vrm1"), head, still).mapping.correctives == ()

    def test_only_the_controls_that_may_move_do(self, head: Head) -> None:
        fitted = fit_looks(
            load_rig("vrm1"), head, FitOptions(controls=("aa", "ou"), poses=few_poses())
        )
        assert set(fitted.mapping.rows) == {"aa", "ou"}

    def test_a_mapping_that_ships_is_what_the_fit_gives(self, head: Head) -> None:
        rig = load_rig("facefx")
        assert isinstance(rig.mapping, LinearMapping)
        again = fit_looks(rig, head).mapping
        assert set(again.rows) == set(rig.mapping.rows)
        for name, row in again.rows.items():
            shipped = rig.mapping.rows[name].gains
            assert set(row.gains) == set(shipped)
            for source, gain in row.gains.items():
                assert gain == pytest.approx(shipped[source], abs=0.02)

    def test_the_fit_asks_for_every_pair_of_english_sounds_and_gets_speech(self) -> None:
        phones = every_pair().phones
        assert len(set(pairwise(phones))) > 400
        poses = speech_poses()
        assert poses.shape[1] == len(CANONICAL)
        assert 0 <= poses.min() <= poses.max() <= 1
        assert set(SPEECH) <= set(CANONICAL)


SIDES = ("Left", "Right")


class TestTrouble:
    def test_meshes_of_other_counts_name_both_and_the_remedy(self, head: Head) -> None:
        target = character(head, {"jaw": shape_of(head, jawOpen=1.0)})
        small = replace(target, vertices=target.vertices[:-1])
        with pytest.raises(LipwrightError, match=r"7093 .* 7092: .* lipwright rigs transfer"):
            fit_meshes(head, small, rig_of("jaw"))

    def test_meshes_joined_by_other_triangles_are_refused(self, head: Head) -> None:
        target = character(head, {"jaw": shape_of(head, jawOpen=1.0)})
        turned = replace(target, triangles=target.triangles[:, ::-1].copy())
        with pytest.raises(LipwrightError, match=r"other triangles.*lipwright rigs transfer"):
            fit_meshes(head, turned, rig_of("jaw"))

    def test_a_vertex_that_is_no_number_is_refused(self, head: Head) -> None:
        broken = shape_of(head, jawOpen=1.0)
        broken[12, 1] = np.nan
        with pytest.raises(LipwrightError, match=r"target\.glb: a vertex is not finite"):
            fit_meshes(head, character(head, {"jaw": broken}), rig_of("jaw"))

    def test_a_rig_that_nothing_shows_is_refused(self, head: Head) -> None:
        with pytest.raises(LipwrightError, match="nothing shows what the rig 'mine' looks like"):
            fit_looks(rig_of("jaw"), head)
        target = character(head, {"other": shape_of(head, jawOpen=1.0)})
        with pytest.raises(LipwrightError, match="nothing shows"):
            fit_meshes(head, target, rig_of("jaw"))

    def test_a_source_without_canonical_blendshapes_is_refused(self, head: Head) -> None:
        target = character(head, {"jaw": shape_of(head, jawOpen=1.0)})
        with pytest.raises(LipwrightError, match="no blendshape of it is a canonical control"):
            fit_meshes(target, target, rig_of("jaw"))

    def test_poses_of_another_shape_and_nan_are_refused(self) -> None:
        with pytest.raises(ValueError, match=r"the shape \(3, 52\), not \(N, 55\)"):
            FitOptions(poses=np.zeros((3, 52)))
        with pytest.raises(ValueError, match="not finite"):
            FitOptions(poses=np.full((3, 55), np.nan))

    def test_a_control_that_the_rig_lacks_is_refused(self, head: Head) -> None:
        with pytest.raises(LipwrightError, match="'tail', which the rig 'vrm1' lacks"):
            fit_looks(load_rig("vrm1"), head, FitOptions(controls=("tail",)))


class TestRefit:
    """What a fit leaves of a rig that follows something already."""

    def test_a_mesh_with_canonical_blendshapes_gets_itself_back(self, head: Head) -> None:
        rig = canonical_rig()
        fitted = fit_meshes(head, head, rig, replace(OF_MESHES, controls=SPEECH))
        assert {name: dict(row.gains) for name, row in fitted.mapping.rows.items()} == {
            name: {name: 1.0} for name in SPEECH
        }

    def test_eyes_keep_their_rows_and_moods_go_on_resting(self, head: Head) -> None:
        rig = load_rig("vrm1")
        chosen = follows_speech(rig)
        assert set(chosen) == {"aa", "ih", "ou", "ee", "oh"}
        again = refitted(rig, fit_looks(rig, head, FitOptions(controls=chosen)))
        assert isinstance(rig.mapping, LinearMapping)
        assert isinstance(again.mapping, LinearMapping)
        assert set(again.mapping.rows) == set(rig.mapping.rows)
        for name in ("blinkLeft", "lookUp"):
            assert again.mapping.rows[name] == rig.mapping.rows[name]
        assert again.mapping.correctives == rig.mapping.correctives

    def test_a_rig_that_follows_nothing_is_fitted_as_a_whole(self) -> None:
        rig = replace(load_rig("vrm1"), mapping=None)
        assert follows_speech(rig) == rig.names
