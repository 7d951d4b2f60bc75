"""Poses of a rig for the shape modes of a reference face."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, MIRROR
from lipwright.errors import LipwrightError
from lipwright.face.appearance import Appearance
from lipwright.face.head import Head
from lipwright.face.reference import ReferenceFace
from lipwright.face.shapes import (
    MEAN,
    ReferenceShape,
    lip_gap,
    load_reference_shape,
    shape_to_text,
    to_shape_modes,
)
from lipwright.face.vertices import TRIANGLES
from lipwright.face.warp import Grid
from lipwright.phones import BILABIALS
from lipwright.pipeline import AnimateOptions, Result, animate
from lipwright.retarget.poses import (
    NEARLY_SHUT,
    apply_poses,
    human_mapping,
    modes_to_canonical,
    pose_weights,
)
from lipwright.rig import Control, PoseMapping, Rig, RigPose, Row, canonical_rig, load_rig, save_rig

EXAMPLES = Path(__file__).parents[1] / "examples"
NAMES = ("open", "wide", "jaw.rx")
SIDES = [(mode, sigma) for mode in (1, 2, 3, 4) for sigma in (-3.0, 3.0)]
SHIPPED = load_reference_shape()

numbers = st.floats(-1, 1, width=32)
values = st.dictionaries(st.sampled_from(NAMES), numbers)


@st.composite
def mappings(draw: st.DrawFn) -> PoseMapping:
    poses = [RigPose(mode, sigma, draw(values)) for mode, sigma in SIDES]
    return PoseMapping(draw(values), tuple(draw(st.permutations(poses))))


def creature(mapping: PoseMapping | None = None) -> Rig:
    controls = tuple(Control(name, -1000.0, 1000.0, 0.25) for name in NAMES)
    return Rig("creature", controls, {}, mapping=mapping)


def modes_clip(*rows: list[float]) -> Clip:
    return Clip(("shape1", "shape2", "shape3", "shape4"), 25, np.array(rows, np.float32))


def shown(mapping: PoseMapping, *rows: list[float]) -> np.ndarray:
    return apply_poses(modes_clip(*rows), creature(), mapping).values


def row_of(given_values: dict[str, float], otherwise: np.ndarray) -> np.ndarray:
    return np.array([given_values.get(n, o) for n, o in zip(NAMES, otherwise, strict=True)])


def other_face() -> ReferenceFace:
    """A face that has the first two modes of the shipped one in other units, and larger."""
    parts = {}
    for region, scale in (("inner", (20.0, 60.0)), ("outer", (20.0, 20.0))):
        grid = Grid(SHIPPED.mean.astype(np.float32), TRIANGLES[region], scale)
        size = grid.count * 3
        modes = np.full((1, grid.count, 3), 1 / np.sqrt(size))
        parts[region] = Appearance(grid, np.full((grid.count, 3), 99.0), modes, np.ones(1))
    joint = np.zeros((2, 4))
    joint[0, 0] = joint[1, 1] = 1.0
    return ReferenceFace(
        mean_shape=SHIPPED.mean * 1.1, depth=np.zeros(34), shape_modes=SHIPPED.modes[:2],
        shape_sd=SHIPPED.sd[:2], **parts, weight=100.0, joint_mean=np.zeros(4),
        joint_modes=joint, joint_sd=100 * SHIPPED.sd[:2],
    )  # fmt: skip


@pytest.fixture(scope="module")
def talking() -> Result:
    text = (EXAMPLES / "hello.txt").read_text("utf-8")
    return animate(EXAMPLES / "hello.flac", text, options=AnimateOptions(fps=50))


class TestEquations:
    @given(mappings())
    def test_the_mean_pose_maps_to_r0_and_what_it_leaves_out_rests(self, mapping) -> None:
        expected = row_of(mapping.mean, np.full(3, 0.25))
        np.testing.assert_allclose(shown(mapping, [0, 0, 0, 0])[0], expected, atol=1e-6)

    @given(mappings())
    def test_each_of_the_eight_poses_maps_to_itself_and_what_it_leaves_out_to_r0(
        self, mapping
    ) -> None:
        mean = row_of(mapping.mean, np.full(3, 0.25))
        for pose in mapping.poses:
            p = [0.0] * 4
            p[pose.mode - 1] = pose.sigma
            np.testing.assert_allclose(
                shown(mapping, p)[0], row_of(pose.values, mean), atol=1e-6, err_msg=pose.label
            )

    @given(
        mappings(),
        st.lists(st.sampled_from([-1.0, 1.0]), min_size=4, max_size=4),
        st.lists(st.floats(0, 6), min_size=8, max_size=8),
        st.floats(0, 1),
    )
    def test_it_is_linear_within_a_sign(self, mapping, signs, sizes, share) -> None:
        a, b = np.array(sizes[:4]) * signs, np.array(sizes[4:]) * signs
        between = shown(mapping, list(share * a + (1 - share) * b))[0]
        ends = shown(mapping, list(a), list(b))
        np.testing.assert_allclose(between, share * ends[0] + (1 - share) * ends[1], atol=1e-4)

    @given(mappings(), st.lists(st.floats(-6, 6), min_size=4, max_size=4))
    def test_the_order_of_poses_does_not_matter(self, mapping, p) -> None:
        turned = PoseMapping(mapping.mean, mapping.poses[::-1])
        np.testing.assert_allclose(shown(mapping, p), shown(turned, p), atol=1e-5)

    def test_equations_2_and_3_as_the_paper_writes_them(self) -> None:
        rng = np.random.default_rng(1)
        p, r0 = rng.normal(0, 2, (50, 4)), rng.uniform(-1, 1, 3)
        poses = rng.uniform(-1, 1, (8, 3))
        expected = []
        for frame in p * SHIPPED.sd[:4]:
            w = [max(frame[k - 1] / (u * SHIPPED.sd[k - 1]), 0) for k, u in SIDES]
            expected.append((poses - r0).T @ np.array(w) + r0)
        named = [
            RigPose(mode, sigma, dict(zip(NAMES, row, strict=True)))
            for (mode, sigma), row in zip(SIDES, poses, strict=True)
        ]
        mapping = PoseMapping(dict(zip(NAMES, r0, strict=True)), tuple(named))
        found = apply_poses(modes_clip(*p.tolist()), creature(), mapping)
        np.testing.assert_allclose(found.values, expected, atol=1e-5)

    def test_poses_may_be_set_at_other_deviations_and_for_more_modes(self) -> None:
        poses = [RigPose(1, 2.0, {"open": 1.0}), RigPose(6, -1.5, {"wide": 1.0})]
        p = np.zeros((1, 8))
        p[0, 0], p[0, 5] = 1.0, -3.0
        assert pose_weights(p, poses).tolist() == [[0.5, 2.0]]
        assert pose_weights(p[:, :4], poses).tolist() == [[0.5, 0.0]]

    def test_the_rig_stays_within_its_ranges(self) -> None:
        mapping = PoseMapping({}, (RigPose(1, 3.0, {"open": 1.0}),))
        rig = Rig("narrow", (Control("open", 0, 0.5),), {})
        assert apply_poses(modes_clip([30, 0, 0, 0]), rig, mapping).values.tolist() == [[0.5]]

    def test_a_mode_that_the_reference_lacks_is_named(self) -> None:
        mapping = PoseMapping({}, (RigPose(9, 3.0, {"open": 1.0}),))
        with pytest.raises(LipwrightError, match=r"mode 9.*grid-s1 has the modes 1 to 8"):
            apply_poses(modes_clip([0, 0, 0, 0]), creature(), mapping)

    def test_curves_that_show_no_modes_are_refused_by_name(self) -> None:
        clip = Clip(("joint1",), 25, np.zeros((1, 1), np.float32))
        with pytest.raises(LipwrightError, match=r"joint1.*shape1 to shape8"):
            apply_poses(clip, creature(), PoseMapping({}, (RigPose(1, 3.0, {}),)))


class TestShutLips:
    mapping = PoseMapping(
        {"open": 0.5}, (RigPose(1, -3, {"open": 0.1, "wide": -1.0}), RigPose(1, 3, {"open": 1.0})),
        shut={"open": -0.2},
    )  # fmt: skip

    def test_where_the_reference_lips_meet_the_shut_pose_holds_what_it_names(self) -> None:
        rest = Clip(CANONICAL, 25, np.zeros((1, len(CANONICAL)), np.float32))
        found = apply_poses(rest, creature(), self.mapping)
        assert found.curve("open")[0] == pytest.approx(-0.2)
        assert found.curve("wide")[0] == pytest.approx(0.25 + SHIPPED.offset[0] / -3 * -1.25)

    def test_where_they_are_apart_the_poses_alone_speak(self) -> None:
        clip = Clip(("jawOpen",), 25, np.array([[0.0], [0.05], [0.1], [0.5]], np.float32))
        gap = SHIPPED.gap(clip)
        assert (gap[2:] > NEARLY_SHUT).all()
        plain = PoseMapping(self.mapping.mean, self.mapping.poses)
        with_shut, without = (
            apply_poses(clip, creature(), m).curve("open") for m in (self.mapping, plain)
        )
        np.testing.assert_array_equal(with_shut[2:], without[2:])
        assert with_shut[0] < with_shut[1] < with_shut[2]

    def test_poses_that_do_not_shut_the_lips_still_map_to_themselves(self) -> None:
        still = [
            (mode, sigma) for mode, sigma in SIDES
            if lip_gap(SHIPPED.points(SHIPPED.pose(mode, sigma)))
            - lip_gap(SHIPPED.points(SHIPPED.offset)) > NEARLY_SHUT
        ]  # fmt: skip
        assert set(SIDES) - set(still) == {(1, -3.0), (2, 3.0)}
        poses = [RigPose(m, s, {"open": m + s / 10}) for m, s in SIDES]
        mapping = PoseMapping({"open": 0.5}, tuple(poses), shut={"open": 0.0})
        for mode, sigma in still:
            p = [sigma if m == mode else 0.0 for m in (1, 2, 3, 4)]
            assert shown(mapping, p)[0, 0] == pytest.approx(mode + sigma / 10, abs=1e-5)

    def test_what_no_mode_shows_follows_its_row(self) -> None:
        mapping = PoseMapping(
            {}, (RigPose(1, 3, {"open": 1}),), rows={"wide": Row({"tongueOut": 2})}
        )
        clip = Clip(("tongueOut", "jawOpen"), 25, np.array([[0.3, 0.0]], np.float32))
        assert apply_poses(clip, creature(), mapping).curve("wide")[0] == pytest.approx(0.6)

    def test_a_control_of_poses_and_of_a_row_is_refused(self) -> None:
        with pytest.raises(ValueError, match="'open' is moved by poses and by a row"):
            PoseMapping({}, (RigPose(1, 3, {"open": 1}),), rows={"open": Row({"jawOpen": 1})})

    def test_the_rig_file_keeps_shut_pose_and_rows(self, tmp_path: Path) -> None:
        mapping = PoseMapping(
            {"open": 0.5}, self.mapping.poses, shut={"open": 0.0},
            rows={"jaw.rx": Row({"eyeBlink": 3.0}, 0.5, (0.0, 2.0))},
        )  # fmt: skip
        save_rig(creature(mapping), tmp_path / "a.json")
        assert load_rig(tmp_path / "a.json").mapping == mapping

    def test_files_without_them_are_read_as_before(self, tmp_path: Path) -> None:
        save_rig(creature(PoseMapping({}, (RigPose(1, 3, {"open": 1}),))), tmp_path / "a.json")
        assert set(json.loads((tmp_path / "a.json").read_text())["mapping"]) == {
            "method", "reference", "mean", "poses",
        }  # fmt: skip
        found = load_rig(tmp_path / "a.json").mapping
        assert isinstance(found, PoseMapping)
        assert (found.shut, found.rows) == ({}, {})


class TestReferenceShape:
    def test_projecting_the_points_of_parameters_gives_them_back(self) -> None:
        p = np.random.default_rng(0).normal(0, 1, (5, 8))
        np.testing.assert_allclose(SHIPPED.project(SHIPPED.points(p)), p, atol=1e-3)
        np.testing.assert_allclose(SHIPPED.points(p[:, :4]), SHIPPED.points(p * (np.arange(8) < 4)))

    def test_canonical_curves_map_to_modes_by_an_affine_map(self) -> None:
        rng = np.random.default_rng(0)
        a, b = rng.uniform(0, 1, (2, 1, len(CANONICAL)))
        p = [SHIPPED.parameters(Clip(CANONICAL, 25, v))[0] for v in (a, b, (a + b) / 2)]
        np.testing.assert_allclose(p[2], (p[0] + p[1]) / 2, atol=1e-5)
        rest = SHIPPED.parameters(Clip(("jawOpen",), 25, np.zeros((1, 1))))
        np.testing.assert_allclose(rest[0], SHIPPED.offset)

    def test_curves_of_modes_are_parameters_as_they_are(self) -> None:
        p = SHIPPED.parameters(modes_clip([1, -2, 0.5, 3]))
        assert p.tolist() == [[1, -2, 0.5, 3, 0, 0, 0, 0]]

    def test_mode_1_is_how_open_the_mouth_is_and_rest_is_shut(self, head: Head) -> None:
        assert lip_gap(SHIPPED.points(SHIPPED.pose(1, 3))) > 0.2
        assert lip_gap(SHIPPED.points(SHIPPED.pose(1, -3))) < -0.1
        assert 0 <= lip_gap(SHIPPED.points(SHIPPED.offset)) < 0.01
        np.testing.assert_allclose(SHIPPED.opening, head.opening, atol=1e-6)

    def test_left_and_right_open_the_mouth_alike(self) -> None:
        for name, other in MIRROR.items():
            one, two = (CANONICAL.index(n) for n in (name, other))
            assert SHIPPED.gains[one, 0] == pytest.approx(SHIPPED.gains[two, 0], abs=0.1), name
            assert SHIPPED.opening[one] == pytest.approx(SHIPPED.opening[two], abs=2e-3), name

    def test_the_file_is_written_as_it_is_read(self) -> None:
        path = Path(load_reference_shape.__code__.co_filename).with_name("grid-s1.json")
        assert shape_to_text(SHIPPED) == path.read_text("utf-8")
        assert "CC BY 4.0" in SHIPPED.license

    @pytest.mark.parametrize(
        ("change", "said"),
        [
            ({"version": 2}, "of version 2.*pip install --upgrade"),
            ({"format": "lipwright-rig"}, "no reference shape"),
            ({"sd": [0.1, 0.2]}, "no reference shape"),
            ({"human": {"mean": {"jaw": 1}}}, "'jaw', no canonical control"),
        ],
    )
    def test_other_files_are_refused_in_a_line(self, tmp_path, change, said) -> None:
        data = {**json.loads(shape_to_text(SHIPPED)), **change}
        (tmp_path / "a.json").write_text(json.dumps(data))
        with pytest.raises(LipwrightError, match=said) as caught:
            load_reference_shape(tmp_path / "a.json")
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("name", ["grid", "none.json", "."])
    def test_a_shape_that_is_not_there_is_refused(self, name, tmp_path, monkeypatch) -> None:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(LipwrightError, match="reference shape"):
            load_reference_shape(name)


class TestHumanFaces:
    def test_speech_through_four_modes_opens_the_mouth_as_before(self, talking, head) -> None:
        moved = apply_poses(talking.clip, canonical_rig(), human_mapping()).select(CANONICAL)
        real, made = (head.aperture_curve(clip.values) for clip in (talking.clip, moved))
        assert np.corrcoef(real, made)[0, 1] > 0.98
        assert 0.8 < np.polyfit(real, made, 1)[0] < 1.1

    def test_the_lips_are_shut_at_every_bilabial(self, talking, head) -> None:
        moved = apply_poses(talking.clip, canonical_rig(), human_mapping()).select(CANONICAL)
        made = head.aperture_curve(moved.values)
        spans = [(start, end) for phone, start, end in talking.track if phone in BILABIALS]
        assert len(spans) > 5
        for start, end in spans:
            first, last = int(start * 50), int(np.ceil(end * 50)) + 1
            assert made[first:last].min() < 0.002, start

    def test_the_shipped_poses_open_the_head_as_the_reference(self, head: Head) -> None:
        for mode, sigma in [(m, s) for m in range(1, 9) for s in (-3.0, 3.0)]:
            weights = SHIPPED.human[f"mode{mode}{sigma:+g}"]
            row = np.array([[weights.get(name, 0.0) for name in CANONICAL]])
            gap = lip_gap(SHIPPED.points(SHIPPED.pose(mode, sigma)))
            gap -= lip_gap(SHIPPED.points(SHIPPED.offset))
            assert head.aperture_curve(row)[0] == pytest.approx(max(gap, 0), abs=0.01), mode

    def test_a_model_of_modes_drives_a_head(self, head: Head) -> None:
        ramp = np.zeros((7, 4), np.float32)
        ramp[:, 0] = np.linspace(-3, 3, 7)
        moved = modes_to_canonical(modes_clip(*ramp.tolist()))
        assert moved.names == CANONICAL
        gaps = head.aperture_curve(moved.values)
        assert gaps[0] == 0
        assert (np.diff(gaps) >= 0).all()
        mean = [SHIPPED.human[MEAN].get(name, 0.0) for name in CANONICAL]
        np.testing.assert_allclose(moved.values[3], mean, atol=1e-6)

    def test_modes_of_another_face_are_told_by_its_vertices(self) -> None:
        face = other_face()
        y = np.array([[0.0, 0.0], [2.0, -1.0]], np.float32)
        found = to_shape_modes(Clip(("joint1", "joint2"), 25, y), face, SHIPPED)
        p = SHIPPED.project(SHIPPED.mean + (face.to_shape(y * face.joint_sd) - face.mean_shape))
        np.testing.assert_allclose(found.values, p, atol=1e-4)
        assert np.abs(found.values[0]).max() < 1e-4
        assert lip_gap(SHIPPED.points(found.values[1])) > lip_gap(SHIPPED.mean) + 0.1


def test_a_shape_whose_arrays_do_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="gains"):
        ReferenceShape("a", "b", "c", SHIPPED.mean, SHIPPED.modes, SHIPPED.sd,
                       SHIPPED.gains[:3], SHIPPED.offset, SHIPPED.opening, {})  # fmt: skip
