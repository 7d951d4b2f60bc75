"""Blendshapes to bones: planted bones are found again, laws hold, and the shipped rig speaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.face.mesh import Mesh
from lipwright.face.pieces import Piece, assemble_mesh
from lipwright.face.skeleton import Skeleton, rotation_matrices
from lipwright.face.skinning import SkinnedMesh
from lipwright.face.turning import head_rotations
from lipwright.pipeline import animate
from lipwright.retarget import retarget
from lipwright.retarget.bone_rig import (
    fit_character,
    moving_shapes,
    other_side,
    placed_bones,
)
from lipwright.retarget.bone_weights import solve_weights
from lipwright.retarget.bones import FitOptions, fit_bones, residuals
from lipwright.retarget.skinned import bone_channels, posed_at, shape_transforms, skin_mesh
from lipwright.rig import CHANNELS, Bone, Control, LinearMapping, Rig, Row, load_rig

Floats = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[1]
HELLO = ROOT / "examples" / "hello"
GRID = ROOT.parent / "shared" / "corpora" / "grid-s1" / "audio"
SENTENCES = {
    "pwip8p": "place white in P eight please",
    "swbp1a": "set white by P one again",
    "brwg6n": "bin red with G six now",
    "lwws5s": "lay white with S five soon",
}
SHIPPED = load_rig("bones")

BONES = (
    Bone("base"),
    Bone("arm", "base", (0.10, 0.0, 0.0)),
    Bone("hand", "arm", (0.20, 0.0, 0.0)),
)
RNG = np.random.default_rng(5)
POINTS = RNG.uniform((-0.02, -0.02, -0.02), (0.26, 0.02, 0.02), (90, 3))


def made_mesh(rest: Floats, **posed: Floats) -> Mesh:
    """A mesh with blendshapes to `posed` (V, 3), whose triangles nobody looks at."""
    posed = posed or {"still": rest}
    shapes = {name: target - rest for name, target in posed.items()}
    piece = Piece("blob", "skin", rest, np.array([[0, 1, 2]]), shapes)
    return assemble_mesh([piece], tuple(posed), name="blob", source="a test", license="none")


def planted() -> tuple[SkinnedMesh, Floats]:
    """A mesh on three bones, and their channels (5, 3, 6) in five poses."""
    along = np.clip(POINTS[:, :1] / 0.26, 0, 1)
    middles = np.array([[0.0, 0.45, 0.9]])
    weights = np.exp(-0.5 * ((along - middles) / 0.15) ** 2)
    weights /= weights.sum(axis=1, keepdims=True)
    channels = np.random.default_rng(6).uniform(-1, 1, (5, 3, 6)) * [0.01, 0.01, 0.01, 12, 12, 12]
    channels[:, 0] = 0.0
    rest = POINTS.astype(np.float32).astype(np.float64)
    return SkinnedMesh(made_mesh(rest), Skeleton.of(BONES), weights), channels


def names_of(count: int) -> list[str]:
    return [f"pose{number}" for number in range(count)]


class TestSkeleton:
    @given(st.lists(st.floats(-180, 180), min_size=3, max_size=3))
    def test_rotations_are_those_of_scipy_about_fixed_axes(self, degrees: list[float]) -> None:
        expected = Rotation.from_euler("xyz", degrees, degrees=True).as_matrix()
        np.testing.assert_allclose(rotation_matrices(degrees), expected, atol=1e-12)

    def test_at_rest_bones_move_nothing(self) -> None:
        matrices = Skeleton.of(BONES).matrices(np.zeros((3, 6)))
        np.testing.assert_allclose(matrices, np.tile(np.eye(3, 4), (3, 1, 1)), atol=1e-15)

    def test_a_bone_carries_its_children_about_its_own_place(self) -> None:
        channels = np.zeros((3, 6))
        channels[1, 5] = 90.0  # the arm turns about z
        channels[2, 0] = 0.01  # the hand moves along its parent's x, which now points up
        hand = Skeleton.of(BONES).matrices(channels)[2]
        np.testing.assert_allclose(hand @ [0.2, 0, 0, 1], [0.10, 0.11, 0], atol=1e-12)

    def test_a_turn_of_the_head_turns_all(self) -> None:
        _, channels = planted()
        turn = head_rotations([0.3, -0.2, 0.1])
        skeleton = Skeleton.of(BONES)
        straight, turned = skeleton.matrices(channels[0]), skeleton.matrices(channels[0], turn)
        np.testing.assert_allclose(turned, turn @ straight, atol=1e-12)

    def test_many_frames_are_those_one_by_one(self) -> None:
        _, channels = planted()
        skeleton = Skeleton.of(BONES)
        together = skeleton.matrices(channels)
        np.testing.assert_allclose(together, [skeleton.matrices(c) for c in channels], atol=1e-15)

    @pytest.mark.parametrize("parents", [(0, 0, 0), (-1, 2, 0), (-2, 0, 0)])
    def test_a_parent_that_is_not_before_its_child_is_refused(self, parents: Sequence[int]) -> None:
        with pytest.raises(ValueError, match="does not stand before"):
            Skeleton(("a", "b", "c"), np.array(parents), np.zeros((3, 3)))

    def test_an_unknown_parent_is_refused(self) -> None:
        with pytest.raises(ValueError, match="'body' of 'arm' is no bone"):
            Skeleton.of([Bone("arm", "body")])


class TestSkin:
    def test_one_bone_turns_the_mesh_as_a_whole(self) -> None:
        skinned, _ = planted()
        weights = np.zeros_like(skinned.weights)
        weights[:, 1] = 1.0
        channels = np.zeros((3, 6))
        channels[1] = 0.01, 0.02, -0.01, 30, -20, 10
        place = np.array(BONES[1].at)
        rotated = (skinned.mesh.vertices - place) @ rotation_matrices([30, -20, 10]).T + place
        posed = SkinnedMesh(skinned.mesh, skinned.skeleton, weights).pose(channels)
        np.testing.assert_allclose(posed, rotated + np.array([0.01, 0.02, -0.01]), atol=1e-7)

    def test_wrong_weights_are_refused(self) -> None:
        skinned, _ = planted()
        for change in (skinned.weights * 1.1, -skinned.weights, skinned.weights[:, :2]):
            with pytest.raises(ValueError, match="skin weights"):
                replace(skinned, weights=change)

    def test_more_than_four_bones_a_vertex_are_refused(self) -> None:
        skeleton = Skeleton.of([Bone(name) for name in "abcde"])
        with pytest.raises(ValueError, match="more than 4"):
            SkinnedMesh(made_mesh(POINTS), skeleton, np.full((len(POINTS), 5), 0.2))


class TestFit:
    def test_weights_of_a_mesh_that_follows_known_bones_are_found(self) -> None:
        skinned, channels = planted()
        targets = np.array([skinned.pose(values) for values in channels])
        found = solve_weights(skinned.mesh.vertices, targets, skinned.skeleton, channels)
        np.testing.assert_allclose(found, skinned.weights, atol=2e-3)

    def test_a_mesh_that_follows_bones_is_shown_again(self) -> None:
        skinned, channels = planted()
        posed = dict(zip(names_of(5), map(skinned.pose, channels), strict=True))
        mesh = made_mesh(skinned.mesh.vertices, **posed)
        options = FitOptions(still=("base",), ridge=1e-8, rounds=25)
        fit = fit_bones(mesh, BONES, options=options)
        assert max(row.worst_mm for row in fit.residuals) < 0.15  # poses move it by up to 40 mm
        assert max(row.share for row in fit.residuals) < 0.005

    def test_the_best_rotation_of_one_bone_is_that_of_kabsch(self) -> None:
        place = POINTS.mean(axis=0)
        noise = RNG.normal(0, 0.001, POINTS.shape)
        bent = (POINTS - place) @ rotation_matrices([10, 20, -15]).T + place + noise
        mesh = made_mesh(POINTS, bent=bent)
        bone = Bone("all", "", tuple(place))
        fit = fit_bones(mesh, [bone], options=FitOptions(ridge=0.0))
        expected, _ = Rotation.align_vectors(bent - bent.mean(axis=0), POINTS - place)
        np.testing.assert_allclose(
            rotation_matrices(fit.transforms[0, 0, 3:]), expected.as_matrix(), atol=1e-5
        )

    def test_a_translation_is_a_translation(self) -> None:
        by = np.array([0.01, -0.02, 0.005])
        mesh = made_mesh(POINTS, moved=POINTS + by)
        fit = fit_bones(mesh, [Bone("all")], options=FitOptions(ridge=0.0))
        np.testing.assert_allclose(fit.transforms[0, 0], [*by, 0, 0, 0], atol=1e-5)

    def test_a_shape_that_moves_nothing_moves_no_bone(self) -> None:
        mesh = made_mesh(POINTS, moved=POINTS + 0.01, still=POINTS)
        fit = fit_bones(mesh, BONES, options=FitOptions(still=("base",), rounds=3))
        np.testing.assert_allclose(fit.transforms[1], 0, atol=1e-9)
        assert fit.residuals[1].worst_mm < 1e-4
        assert fit.residuals[1].share == 0

    def test_still_bones_keep_still(self) -> None:
        skinned, channels = planted()
        mesh = made_mesh(skinned.mesh.vertices, bent=skinned.pose(channels[0]))
        fit = fit_bones(mesh, BONES, options=FitOptions(still=("base", "hand"), rounds=3))
        assert not fit.transforms[:, [0, 2]].any()

    def test_what_is_unknown_is_named_with_what_there_is(self) -> None:
        mesh = made_mesh(POINTS, moved=POINTS + 0.01)
        with pytest.raises(LipwrightError, match=r"no blendshape 'jawOpen'; it has moved$"):
            fit_bones(mesh, BONES, ["jawOpen"])
        with pytest.raises(LipwrightError, match=r"no bone 'leg'; it has base, arm, hand$"):
            fit_bones(mesh, BONES, options=FitOptions(still=("leg",)))

    def test_a_mesh_that_does_not_move_is_refused(self) -> None:
        with pytest.raises(LipwrightError, match="none of still moves it"):
            fit_bones(made_mesh(POINTS, still=POINTS), BONES)


def small_rig() -> Rig:
    """The planted bones, moved by two canonical controls."""
    names = [f"{bone.name}.{channel}" for bone in BONES for channel in ("tx", "ty", "rz")]
    return Rig(
        "small",
        tuple(Control(name, -90, 90) for name in names),
        {},
        bones=BONES,
        mapping=LinearMapping(
            {
                "arm.rz": Row({"jawOpen": 30.0}),
                "hand.ty": Row({"jawOpen": 0.01, "mouthClose": 0.02}),
            }
        ),
    )


FACE = ("jawOpen", "mouthClose", "mouthSmileLeft", "mouthSmileRight", "jawForward")


def face_mesh(size: float = 1.0, shift: Sequence[float] = (0, 0, 0)) -> Mesh:
    """The planted mesh under names of the face, larger and elsewhere."""
    skinned, channels = planted()
    place = size * skinned.mesh.vertices.astype(np.float64) + shift
    posed = dict(zip(FACE, channels, strict=True))
    return made_mesh(place, **{n: size * skinned.pose(c) + shift for n, c in posed.items()})


class TestOtherCharacters:
    def test_bones_are_placed_where_the_face_moves(self) -> None:
        rig = small_rig()
        bones, size = placed_bones(rig, face_mesh(), face_mesh(3.0, (0.5, 1.6, -0.2)), FACE)
        assert size == pytest.approx(3.0, rel=1e-5)
        for bone, own in zip(bones, rig.bones, strict=True):
            expected = 3 * np.array(own.at) + [0.5, 1.6, -0.2]
            np.testing.assert_allclose(bone.at, expected, atol=1e-5)

    def test_a_fit_becomes_a_rig_that_gives_the_fitted_transforms(self) -> None:
        mesh = face_mesh()
        bare = replace(small_rig(), mapping=None)
        fit, rig = fit_character(mesh, bare, BONES, 1.0)
        given = shape_transforms(rig, FACE)
        height = float(np.ptp(mesh.vertices[:, 1]))
        np.testing.assert_allclose(given[..., :3], fit.transforms[..., :3], atol=1.5e-4 * height)
        np.testing.assert_allclose(given[..., 3:], fit.transforms[..., 3:], atol=0.5)
        assert rig.bones == BONES
        assert all(control.name.startswith(("base.", "arm.", "hand.")) for control in rig.controls)

    def test_a_mirrored_face_is_refused(self) -> None:
        with pytest.raises(LipwrightError, match="upright face that looks along z"):
            placed_bones(small_rig(), face_mesh(), face_mesh(-1.0), FACE)

    def test_too_few_blendshapes_are_refused(self) -> None:
        with pytest.raises(LipwrightError, match="has 2 blendshapes of the blob's names"):
            placed_bones(small_rig(), face_mesh(), face_mesh(), FACE[:2])

    def test_a_character_without_the_names_is_refused(self) -> None:
        with pytest.raises(LipwrightError, match="such as jawOpen; it has other"):
            fit_character(made_mesh(POINTS, other=POINTS + 0.01), small_rig(), BONES, 1.0)


class TestShippedRig:
    def test_it_has_the_ten_bones_of_the_thesis_below_the_head(self) -> None:
        """Thesis, section 4.6.2: seven of the lips, two of the tongue, one of the jaw."""
        names = [bone.name for bone in SHIPPED.bones]
        assert names[:2] == ["body", "head"]
        assert sum(name.startswith("lip_") for name in names) == 7
        assert sum(name.startswith("tongue_") for name in names) == 2
        assert names.count("jaw") == 1
        assert len(names) == 12

    def test_each_channel_of_a_side_mirrors_that_of_the_other(self) -> None:
        assert all(other_side(name) == SHIPPED.mirror[name] for name in SHIPPED.mirror)
        left = shape_transforms(SHIPPED, ["mouthSmileLeft"])[0]
        right = shape_transforms(SHIPPED, ["mouthSmileRight"])[0]
        names = [bone.name for bone in SHIPPED.bones]
        swapped = left[[names.index(other_side(name)) for name in names]]
        np.testing.assert_allclose(swapped * [-1, 1, 1, 1, -1, -1], right, atol=1e-5)

    def test_no_blendshape_takes_a_channel_out_of_its_range(self) -> None:
        shapes = sorted(SHIPPED.mapping.sources)
        gains = np.zeros((len(shapes), len(SHIPPED.bones), 6))
        numbers = {bone.name: number for number, bone in enumerate(SHIPPED.bones)}
        for control, row in SHIPPED.mapping.rows.items():
            bone, channel = control.split(".")
            for shape, gain in row.gains.items():
                gains[shapes.index(shape), numbers[bone], CHANNELS.index(channel)] = gain
        np.testing.assert_allclose(shape_transforms(SHIPPED, shapes), gains, atol=1e-6)

    def test_what_bones_cannot_show_of_each_blendshape_is_little(
        self, boned: tuple[Head, SkinnedMesh]
    ) -> None:
        head, skinned = boned
        shapes = moving_shapes(head, SHIPPED)
        rows = residuals(skinned, shapes, shape_transforms(SHIPPED, shapes))
        assert max(row.rms_mm for row in rows) < 2.0
        assert max(row.worst_mm for row in rows) < 7.0
        assert max(row.share for row in rows) < 0.36

    def test_teeth_are_held_by_jaw_and_head_alone_nearly(
        self, boned: tuple[Head, SkinnedMesh]
    ) -> None:
        head, skinned = boned
        held = {
            part.name: skinned.weights[part.vertices].mean(axis=0)
            for part in head.parts
            if part.name.startswith("teeth")
        }
        assert held["teethUpper"][skinned.skeleton.names.index("head")] == 1
        assert held["teethLower"][skinned.skeleton.names.index("jaw")] > 0.9

    def test_the_shirt_stays_with_the_body(self, boned: tuple[Head, SkinnedMesh]) -> None:
        head, skinned = boned
        (shirt,) = (part for part in head.parts if part.name == "shirt")
        assert (skinned.weights[shirt.vertices, 0] == 1).all()

    def test_speech_opens_and_shuts_the_lips_as_blendshapes_do(
        self, boned: tuple[Head, SkinnedMesh]
    ) -> None:
        said = animate(HELLO.with_suffix(".flac"), HELLO.with_suffix(".txt").read_text())
        check_lips(*boned, said.clip)

    @pytest.mark.skipif(not GRID.exists(), reason="the corpora are not here")
    def test_sentences_open_and_shut_the_lips_as_blendshapes_do(
        self, boned: tuple[Head, SkinnedMesh]
    ) -> None:
        for name, text in SENTENCES.items():
            check_lips(*boned, animate(GRID / f"{name}.flac", text).clip)


@pytest.fixture(scope="module")
def boned(head: Head) -> tuple[Head, SkinnedMesh]:
    """The head, and on the bones that ship."""
    return head, skin_mesh(head, SHIPPED)


def check_lips(head: Head, skinned: SkinnedMesh, clip: Clip) -> None:
    """Apertures go together, and where the blendshapes shut the lips the bones do."""
    own = head.aperture_curve(clip.select(CANONICAL).values)
    channels = bone_channels(retarget(clip, SHIPPED), SHIPPED)
    boned = np.array([float(head.aperture(posed)) for posed in skinned.pose_many(channels)])
    assert np.corrcoef(own, boned)[0, 1] > 0.995
    shut = own < 0.05 * np.percentile(own, 95)
    assert shut.any()
    assert (boned[shut] < 0.10 * np.percentile(boned, 95)).all()


class TestRigOfBones:
    def test_bones_are_set_to_the_linear_combination_of_their_configurations(self) -> None:
        """Thesis, section 4.6.3."""
        rig = small_rig()
        parts = shape_transforms(rig, ["jawOpen", "mouthClose"])
        clip = Clip(("jawOpen", "mouthClose"), 30, np.array([[0.25, 0.5]]))
        together = bone_channels(retarget(clip, rig), rig)[0]
        np.testing.assert_allclose(together, 0.25 * parts[0] + 0.5 * parts[1], atol=1e-7)

    def test_channels_that_a_clip_lacks_rest(self) -> None:
        clip = Clip(("arm.tx",), 30, np.array([[0.5], [0.25]]))
        channels = bone_channels(clip, small_rig())
        assert channels.shape == (2, 3, 6)
        assert channels[1, 1, 0] == 0.25
        assert np.count_nonzero(channels) == 2

    def test_a_rig_without_bones_is_refused(self, head: Head) -> None:
        with pytest.raises(LipwrightError, match="'arkit' has no bones"):
            skin_mesh(head, load_rig("arkit"))

    def test_a_mesh_that_moves_no_bone_is_refused(self) -> None:
        with pytest.raises(LipwrightError, match="no blendshape that moves the rig 'small'"):
            skin_mesh(made_mesh(POINTS, other=POINTS + 0.01), small_rig())

    def test_frames_are_posed_at_any_time_and_turn_with_the_head(self) -> None:
        rig, (skinned, _) = small_rig(), planted()
        values = np.array([[0, 0], [10, 0.2]])
        clip = Clip(("arm.rz", HEAD_ANGLES[0]), 10, values)
        (posed,) = posed_at(skinned, rig, clip, [0.05])
        channels = np.zeros((3, 6))
        channels[1, 5] = 5.0
        np.testing.assert_allclose(
            posed, skinned.pose(channels) @ head_rotations([0.1, 0, 0]).T, atol=1e-6
        )
