"""The reference face: its table and warps, and a fit that finds the modes a video was made with."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.audio import Audio, write_flac
from lipwright.clip import Clip
from lipwright.dataset.checking import check_dataset
from lipwright.dataset.folder import RECORDINGS, Dataset, open_dataset, recording_files, sha256_of
from lipwright.dataset.recording import Flag, Motion, save_motion, write_info
from lipwright.errors import LipwrightError
from lipwright.export import read_clip
from lipwright.face.appearance import Appearance
from lipwright.face.faceclip import clip_to_parameters, parameters_to_clip
from lipwright.face.reference import FaceParameters, ReferenceFace, meeting
from lipwright.face.reference_file import load_reference_face, save_reference_face
from lipwright.face.vertices import (
    HULL,
    LANDMARKS,
    LIP_PAIRS,
    MIRRORED,
    TRIANGLES,
    VERTICES,
    N,
    aperture,
)
from lipwright.face.warp import Grid, rasterise
from lipwright.formats import write_track
from lipwright.track import PhoneTrack

cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed")
pytest.importorskip("sklearn", reason="scikit-learn is not installed")

# The mean of a speaker, made symmetric, in eye distances.
MEAN = np.array([
    (-0.43, 1.28), (-0.32, 1.21), (-0.13, 1.13), (0.0, 1.15), (0.13, 1.13), (0.32, 1.21),
    (0.43, 1.28), (0.33, 1.39), (0.13, 1.51), (0.0, 1.52), (-0.13, 1.51), (-0.33, 1.39),
    (-0.39, 1.28), (-0.27, 1.26), (-0.1, 1.26), (0.0, 1.26), (0.1, 1.26), (0.27, 1.26),
    (0.39, 1.28), (0.27, 1.3), (0.1, 1.33), (0.0, 1.33), (-0.1, 1.33), (-0.27, 1.3),
    (-1.1, 0.91), (-0.92, 1.46), (-0.52, 1.88), (0.0, 2.04), (0.52, 1.88), (0.92, 1.46),
    (1.1, 0.91), (0.27, 0.81), (0.0, 0.83), (-0.27, 0.81),
])  # fmt: skip
FPS, FRAMES, EYES_PX, SIZE = 25.0, 30, 36.0, (128, 112)
NAMES = [f"take{number:02}" for number in range(10)]
SPLIT = dict(zip(NAMES, ["test"] * 2 + ["validation"] + ["train"] * 7, strict=True))
LOST = 7


def orthonormal(rows: Any) -> np.ndarray[Any, Any]:
    rows = np.asarray(rows, float)
    flat = np.linalg.qr(rows.reshape(len(rows), -1).T)[0].T.copy()
    flat *= np.sign((flat * rows.reshape(len(rows), -1)).sum(axis=1))[:, None]
    return flat.reshape(rows.shape)


def shape_modes() -> np.ndarray[Any, Any]:
    """Jaw down, mouth wide, jaw to the side."""
    modes = np.zeros((3, N, 2))
    lower = MEAN[:, 1] > 1.29
    modes[0, lower, 1] = 1
    modes[1, :24, 0] = MEAN[:24, 0]
    modes[2, lower, 0] = 1
    return orthonormal(modes)


def waves(grid: Grid, *frequencies: float) -> np.ndarray[Any, Any]:
    """(n, P, 3): smooth patterns over a grid."""
    rows, columns = np.nonzero(grid.mask)
    x, y = columns / grid.size[0], rows / grid.size[1]
    patterns = [np.stack([np.sin(f * x + c) * np.cos(f * y) for c in range(3)], -1)
                for f in frequencies]  # fmt: skip
    return np.asarray(patterns)


def planted() -> ReferenceFace:
    """A model that videos are drawn with."""
    parts = {}
    for region, scale, colour in (
        ("inner", (36.0, 110.0), (150, 130, 120)), ("outer", (36.0, 36.0), (180, 140, 120))
    ):  # fmt: skip
        grid = Grid(MEAN, TRIANGLES[region], scale)
        mean = np.asarray(colour) + 25 * waves(grid, 9.0)[0]
        modes = orthonormal(waves(grid, 3.0, 6.0))
        # About ten grey levels a pixel.
        sd = np.sqrt(grid.count * 3) * np.array([10.0, 5.0])
        parts[region] = Appearance(grid, mean, modes, sd)
    return ReferenceFace(
        mean_shape=MEAN, depth=np.zeros(N), shape_modes=shape_modes(),
        shape_sd=np.array([0.3, 0.15, 0.1]), inner=parts["inner"], outer=parts["outer"],
        weight=1.0, joint_mean=np.zeros(7), joint_modes=np.eye(7), joint_sd=np.arange(7.0, 0, -1),
        info={"dataset": "planted"},
    )  # fmt: skip


@pytest.fixture(scope="module")
def truth() -> ReferenceFace:
    return planted()


def random_parameters(face: ReferenceFace, seed: int) -> FaceParameters:
    """Slow curves; the mouth opens and shuts."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0, 2 * np.pi, FRAMES)

    def curves(sd: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        phases, rates = rng.uniform(0, 6, len(sd)), rng.uniform(1, 3, len(sd))
        return sd * 1.2 * np.sin(time[:, None] * rates + phases)

    shape = curves(face.shape_sd)
    shape[:, 0] = np.maximum(shape[:, 0], -0.25)  # lips meet, no more
    return FaceParameters(shape, curves(face.inner.sd), curves(face.outer.sd))


def write_video(path: Path, pictures: list[np.ndarray[Any, Any]]) -> None:
    import av

    with av.open(str(path), "w") as container:
        stream: Any = container.add_stream("ffv1", rate=25)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "bgr0"
        for picture in pictures:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode(None))


def write_take(folder: Path, video: Path, face: ReferenceFace, number: int) -> None:
    parameters = random_parameters(face, number)
    rng = np.random.default_rng(1000 + number)
    landmarks = np.broadcast_to(rng.normal(size=(478, 3)), (FRAMES, 478, 3)).copy()
    landmarks[:, LANDMARKS, :2], landmarks[:, LANDMARKS, 2] = face.points(parameters.shape), 0
    poses = np.zeros((FRAMES, 3, 4))
    for frame, angle in enumerate(np.linspace(-0.05, 0.05, FRAMES)):
        c, s = np.cos(angle), np.sin(angle)
        poses[frame, :, :3] = EYES_PX * np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        poses[frame, :2, 3] = 64 + 0.1 * frame, 15
    light = 1 + 0.03 * number * np.array([1, 0, -1])
    pictures = []
    for frame in range(FRAMES):
        at = landmarks[frame, LANDMARKS] @ poses[frame, :2, :3].T + poses[frame, :2, 3]
        drawn, covered = face.draw(parameters[frame], at, SIZE, light)
        pictures.append(np.where(covered[..., None], drawn, np.uint8((60, 90, 160))[None, None]))
    write_video(video, pictures)
    folder.mkdir(parents=True)
    flags = np.zeros(FRAMES, np.uint8)
    flags[LOST] = Flag.LOST
    save_motion(folder / "motion.npz",
                Motion(FPS, flags, np.zeros((FRAMES, 52)), landmarks, poses))  # fmt: skip
    write_rest(folder, {"video": {"path": str(video), "sha256": sha256_of(video)}})


def write_rest(folder: Path, source: dict[str, Any]) -> None:
    write_track(folder / "phones.TextGrid", PhoneTrack(("sil",), np.array([0.0, FRAMES / FPS])))
    sound = np.sin(np.arange(round(8000 * FRAMES / FPS)) / 9).astype(np.float32) / 4
    write_flac(folder / "audio.flac", Audio(sound, 8000))
    write_info(folder, {"name": folder.name, "source": source})


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, truth: ReferenceFace) -> Dataset:
    """Ten videos drawn with the planted model, and a recording of weights alone."""
    root = tmp_path_factory.mktemp("reference")
    path, videos = root / "set", root / "videos"
    videos.mkdir()
    for number, name in enumerate(NAMES):
        write_take(path / RECORDINGS / name, videos / f"{name}.mkv", truth, number)
    bare = path / RECORDINGS / "weights"
    bare.mkdir()
    save_motion(bare / "motion.npz",
                Motion(FPS, np.zeros(FRAMES, np.uint8), np.zeros((FRAMES, 52))))  # fmt: skip
    write_rest(bare, {"csv": {"path": "weights.csv"}})
    entries = [
        {"name": name, "status": "captured", "reasons": [], "split": SPLIT.get(name, "train"),
         "files": recording_files(path / RECORDINGS / name)}
        for name in [*NAMES, "weights"]
    ]  # fmt: skip
    dataset = Dataset(path, {
        "format": "lipwright-dataset", "version": 1, "name": "planted", "licence": "CC0-1.0",
        "recordings": entries,
    })  # fmt: skip
    dataset.save()
    return dataset


@pytest.fixture(scope="module")
def fitted(made: Dataset) -> tuple[Path, Any]:
    from lipwright.capture.face_of_dataset import fit_dataset

    out = made.path.parent / "face.npz"
    return out, fit_dataset(made, out)


# The table


def test_each_vertex_is_another_landmark_and_mirrors_to_one_of_the_same_region() -> None:
    assert N == 34 == len(set(LANDMARKS.tolist()))
    assert MIRRORED[MIRRORED].tolist() == list(range(N))
    for vertex in VERTICES:
        other = VERTICES[vertex.mirror]
        assert vertex.region == other.region
        swapped = vertex.name.replace("left", "\0").replace("right", "left").replace("\0", "right")
        assert other.name == swapped


def test_the_triangles_cover_the_lower_face_once_and_mirror_to_each_other() -> None:
    triangles = np.concatenate(list(TRIANGLES.values()))
    sides = Counter(frozenset((a, b)) for t in triangles for a, b in zip(t, np.roll(t, 1)))  # noqa: B905
    around = {frozenset((a, b)) for a, b in zip(HULL, np.roll(HULL, 1))}  # noqa: B905
    assert {side for side, count in sides.items() if count == 1} == around
    assert max(sides.values()) == 2
    for region in TRIANGLES.values():
        found = {frozenset(triangle) for triangle in region.tolist()}
        assert found == {frozenset(MIRRORED[list(triangle)].tolist()) for triangle in found}
    corners = MEAN[triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    assert (first[:, 0] * second[:, 1] > first[:, 1] * second[:, 0]).all()


def test_the_inner_mouth_has_only_vertices_of_the_inner_lips() -> None:
    assert {VERTICES[index].region for index in TRIANGLES["inner"].ravel()} == {"inner lips"}


def test_the_aperture_is_that_of_the_tracked_lips() -> None:
    from lipwright.capture.landmarks import LIP_PAIRS as TRACKED

    assert [tuple(LANDMARKS[list(pair)].tolist()) for pair in LIP_PAIRS] == list(TRACKED)
    assert aperture(MEAN) == pytest.approx(0.07)


# Warps


def test_a_pixel_belongs_to_the_triangle_that_scipy_finds() -> None:
    from scipy.spatial import Delaunay

    points = np.random.default_rng(1).uniform(2, 60, (34, 2))
    other = Delaunay(points)
    corners = points[other.simplices]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turned = first[:, 0] * second[:, 1] < first[:, 1] * second[:, 0]
    triangles = np.where(turned[:, None], other.simplices[:, ::-1], other.simplices)
    index, weights = rasterise(points, triangles, (64, 62))
    y, x = np.mgrid[:62, :64] + 0.5
    places = np.stack([x, y], -1)
    assert np.array_equal(index, other.find_simplex(places))
    inside = index >= 0
    rebuilt = np.einsum("pk,pkd->pd", weights[inside], points[triangles[index[inside]]])
    assert np.allclose(rebuilt, places[inside], atol=1e-4)


def test_triangles_turned_over_cover_nothing() -> None:
    index, _ = rasterise(MEAN * 40, TRIANGLES["outer"][:, ::-1], (80, 90))
    assert (index == -1).all()


@settings(deadline=None, max_examples=30)  # a busy machine takes its time
@given(st.floats(-0.2, 0.2), st.floats(0.8, 1.3), st.floats(40, 60))
def test_a_ramp_sampled_through_an_affine_warp_is_a_ramp(
    angle: float, size: float, left: float
) -> None:
    grid = Grid(MEAN, TRIANGLES["outer"], (30.0, 30.0))
    turn = size * 25 * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    at = MEAN @ turn.T + (left, 5)
    y, x = np.mgrid[:90, :110] + 0.5
    ramp = np.stack([x, y, x + y], -1).astype(np.uint8)
    rows, columns = np.nonzero(grid.mask)
    places = (np.stack([columns, rows], -1) + 0.5) / 30.0 + grid.origin
    wanted = places @ turn.T + (left, 5)
    got = grid.sample(ramp, at).astype(float)
    assert np.abs(got[:, :2] - wanted).max() < 1.1  # 8-bit ramps, rounded down and in the sample


def test_what_is_painted_at_a_shape_is_sampled_there_again() -> None:
    grid = Grid(MEAN, TRIANGLES["outer"], (40.0, 40.0))
    pixels = 128 + 60 * waves(grid, 5.0)[0]
    at = MEAN * 80 + (100, -40)
    canvas = np.zeros((150, 200, 3), np.float32)
    grid.paint(canvas, at, pixels)
    apart = np.abs(grid.sample(np.rint(canvas).astype(np.uint8), at) - pixels)
    assert np.median(apart) < 0.5
    assert (apart < 2).mean() > 0.9  # the rest lies on the edge, where the canvas is black


def test_lips_that_meet_leave_no_gap() -> None:
    shut = meeting(MEAN)
    assert aperture(shut) == 0
    index, _ = rasterise(shut * 100, np.concatenate(list(TRIANGLES.values())), (120, 210))
    assert (index[115:180, 0:30] >= 0).all()


# The value


def test_joint_parameters_and_shapes_come_back(truth: ReferenceFace) -> None:
    parameters = random_parameters(truth, 5)
    again = truth.split(truth.join(parameters))
    for name in ("shape", "inner", "outer"):
        wanted = getattr(parameters, name)
        assert np.allclose(getattr(again, name), wanted, atol=1e-3 * np.abs(wanted).max())
    points = truth.points(parameters.shape)
    assert np.allclose(truth.project_shape(points), parameters.shape, atol=1e-5)
    assert np.allclose(truth.to_shape(truth.join(parameters)), points, atol=1e-5)


def test_a_pose_is_the_mean_but_for_its_mode(truth: ReferenceFace) -> None:
    assert np.allclose(truth.points(truth.pose(0, 0).shape), MEAN, atol=1e-6)
    opened = truth.points(truth.pose(0, 3, "shape").shape)
    assert np.allclose(opened - MEAN, 3 * 0.3 * truth.shape_modes[0], atol=1e-6)
    joint = truth.join(truth.pose(2, -3))
    assert np.allclose(joint, [0, 0, -3 * truth.joint_sd[2], 0, 0, 0, 0], atol=1e-5)
    with pytest.raises(ValueError, match="no shape mode 3; they are 0 to 2"):
        truth.pose(3, 1, "shape")


def test_a_drawn_face_projects_to_its_parameters(truth: ReferenceFace) -> None:
    wanted = truth.pose(0, 2.0, "joint")
    points = truth.points(wanted.shape)
    at = points * 150 + (200, 0)
    light = np.array([0.9, 1.0, 1.1])
    picture, _ = truth.draw(wanted, at, (400, 420), light)
    got = truth.split(truth.project(points, picture, at, light))
    assert np.allclose(got.shape, wanted.shape, atol=1e-3)
    assert np.abs(got.outer / truth.outer.sd).max() < 0.1


def test_faces_of_many_frames_are_pictures_at_the_mean_shape(truth: ReferenceFace) -> None:
    width, height = truth.outer.grid.size
    assert truth.to_pixels(np.zeros(7)).shape == (height, width, 3)
    assert truth.to_pixels(np.zeros((2, 2, 7))).shape == (2, 2, height, width, 3)


def test_arrays_that_do_not_fit_together_are_refused(truth: ReferenceFace) -> None:
    with pytest.raises(ValueError, match="not orthonormal"):
        replace(truth, shape_modes=truth.shape_modes * 2)
    with pytest.raises(ValueError, match="do not fall"):
        replace(truth, shape_sd=truth.shape_sd[::-1])
    with pytest.raises(ValueError, match="mean shape"):
        replace(truth, mean_shape=MEAN[:20])
    with pytest.raises(ValueError, match="joint"):
        replace(truth, joint_mean=np.zeros(3))


def test_curves_of_a_clip_and_parameters_are_the_same_thing(truth: ReferenceFace) -> None:
    parameters = random_parameters(truth, 9)
    for joint in (True, False):
        clip = parameters_to_clip(truth, parameters, FPS, joint=joint)
        again = clip_to_parameters(truth, clip)
        assert np.allclose(again.shape, parameters.shape, atol=1e-4)
    assert clip.names[:4] == ("shape1", "shape2", "shape3", "inner1")
    for names in (("shape4",), ("jawOpen",), ("shape01",)):
        with pytest.raises(LipwrightError, match=f"no mode '{names[0]}'"):
            clip_to_parameters(truth, Clip(names, FPS, np.zeros((2, 1))))
    with pytest.raises(LipwrightError, match="beside others"):
        clip_to_parameters(truth, Clip(("joint1", "shape1"), FPS, np.zeros((2, 2))))


def test_a_saved_face_is_the_same_and_has_the_same_bytes(
    truth: ReferenceFace, tmp_path: Path
) -> None:
    save_reference_face(tmp_path / "a.npz", truth)
    again = load_reference_face(tmp_path / "a.npz")
    save_reference_face(tmp_path / "b.npz", again)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    assert again.info == {"dataset": "planted"}
    assert np.array_equal(again.shape_modes, truth.shape_modes)
    assert again.outer.grid.size == truth.outer.grid.size


def test_a_broken_file_is_one_clear_line(truth: ReferenceFace, tmp_path: Path) -> None:
    path = tmp_path / "face.npz"
    with pytest.raises(LipwrightError, match="no such file"):
        load_reference_face(path)
    save_reference_face(path, truth)
    whole = path.read_bytes()
    for broken in (b"", b"no archive", whole[: len(whole) // 2], whole[:-40]):
        path.write_bytes(broken)
        with pytest.raises(LipwrightError, match=r"face\.npz: not a reference face") as caught:
            load_reference_face(path)
        assert "\n" not in str(caught.value)
    save_reference_face(path, truth)
    with np.load(path) as stored:
        arrays = dict(stored)
    for name, wrong in (("joint_sd", np.zeros(7)), ("info", np.array("[]")), ("depth", np.ones(2)),
                        ("outer_scale", np.array([np.nan, 1.0])), ("format", np.array(99)),
                        ("shape_modes", np.array([{}], object))):  # fmt: skip
        np.savez(path, **{**arrays, name: wrong})
        with pytest.raises(LipwrightError, match=r"face\.npz: "):
            load_reference_face(path)


def test_loading_a_face_needs_numpy_alone(truth: ReferenceFace, tmp_path: Path) -> None:
    save_reference_face(tmp_path / "face.npz", truth)
    code = (
        "import sys; from lipwright.face.reference_file import load_reference_face as load\n"
        f"face = load({str(tmp_path / 'face.npz')!r}); face.to_shape([0] * 7)\n"
        "print(*(n for n in ('sklearn', 'cv2', 'scipy', 'matplotlib') if n in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


# Modes


def test_modes_are_those_of_the_singular_vectors_and_point_one_way() -> None:
    from lipwright.capture.modes import find_modes

    rng = np.random.default_rng(2)
    rows = rng.normal(size=(200, 6)) * [5, 3, 2, 0.1, 0.1, 0.1] + 7
    found = find_modes(rows, 0.99, 6)
    _, sizes, wanted = np.linalg.svd(rows - rows.mean(0), full_matrices=False)
    assert len(found.modes) == 3
    assert np.allclose(np.abs(np.sum(found.modes * wanted[:3], axis=1)), 1, atol=1e-5)
    assert np.allclose(found.sd, sizes[:3] / np.sqrt(199), rtol=1e-5)
    assert (found.modes[np.arange(3), np.abs(found.modes).argmax(1)] > 0).all()
    assert found.share == pytest.approx(np.square(sizes[:3]).sum() / np.square(sizes).sum())
    with pytest.raises(ValueError, match="do not vary"):
        find_modes(np.ones((5, 4)), 0.9, 3)


def test_hidden_inner_mouths_are_filled_in_time() -> None:
    from lipwright.capture.pixels import fill_inner

    inner = np.array([[9.0], [1.0], [9.0], [9.0], [4.0], [9.0]], np.float32)
    seen = np.array([False, True, False, False, True, False])
    assert fill_inner(inner, seen).ravel().tolist() == [1, 1, 2, 3, 4, 4]
    assert fill_inner(inner, np.zeros(6, bool)).ravel().tolist() == [0] * 6


# The fit


def test_the_fit_finds_the_modes_that_the_videos_were_made_with(
    fitted: tuple[Path, Any], truth: ReferenceFace
) -> None:
    face = fitted[1].face
    assert len(face.shape_modes) == 3
    overlap = face.shape_modes.reshape(3, -1) @ truth.shape_modes.reshape(3, -1).T
    assert np.linalg.svd(overlap, compute_uv=False).min() > 0.999
    assert face.info["dataset"] == "planted"
    assert face.info["licence"] == "CC0-1.0"


def test_held_out_videos_come_back_in_points_and_grey_levels(fitted: tuple[Path, Any]) -> None:
    errors = fitted[1].face.info["errors"]
    for split, recordings in (("train", 7), ("test", 2)):
        assert errors[split]["recordings"] == recordings
        assert errors[split]["shape"]["px"] < 0.05
        assert errors[split]["joint"]["px"] < 0.3
        assert errors[split]["appearance"]["outer"]["mae"] < 3
        assert errors[split]["joint"]["inner"]["mae"] < 6
        assert errors[split]["appearance"]["inner"]["mae"] <= errors[split]["joint"]["inner"]["mae"]


def test_the_parameters_lie_beside_each_recording(
    fitted: tuple[Path, Any], made: Dataset, truth: ReferenceFace
) -> None:
    out, done = fitted
    assert done.used == tuple(NAMES)
    assert done.skipped == ("weights: has no landmarks or no video; skipped",)
    dataset, face = open_dataset(made.path), load_reference_face(out)
    for number, name in enumerate(NAMES):
        kept = dataset.recording(name).face()
        assert kept is not None
        assert str(kept["model"]) == sha256_of(out)
        assert dataset.entry(name)["files"]["face.npz"] == sha256_of(
            dataset.folder(name) / "face.npz"
        )
        assert np.flatnonzero(np.isnan(kept["joint"]).any(axis=1)).tolist() == [LOST]
        wanted = truth.points(random_parameters(truth, number).shape)
        seen = np.delete(np.arange(FRAMES), LOST)
        assert np.abs(face.points(kept["shape"][seen]) - wanted[seen]).max() < 0.01
        visible = aperture(wanted) >= 0.03
        assert (kept["inner_visible"][seen] == visible[seen]).mean() > 0.9
    assert dataset.recording("weights").face() is None
    problems = check_dataset(dataset).problems
    assert not [line for line in problems if "face.npz" in line]


def test_the_light_of_a_recording_is_no_mode(fitted: tuple[Path, Any], made: Dataset) -> None:
    dataset = open_dataset(made.path)
    lights = np.stack([dataset.recording(name).face()["light"][0] for name in NAMES])  # type: ignore[index]
    wanted = 1 + 0.03 * np.arange(10)[:, None] * np.array([1, 0, -1])
    assert np.corrcoef(lights[:, 0], wanted[:, 0])[0, 1] > 0.98
    assert np.corrcoef(lights[:, 2], wanted[:, 2])[0, 1] > 0.98


def test_two_fits_are_the_same_to_the_byte(fitted: tuple[Path, Any], made: Dataset) -> None:
    from lipwright.capture.face_of_dataset import fit_dataset

    kept = (made.folder(NAMES[3]) / "face.npz").read_bytes()
    out = made.path.parent / "again.npz"
    fit_dataset(made, out)
    assert out.read_bytes() == fitted[0].read_bytes()
    assert (made.folder(NAMES[3]) / "face.npz").read_bytes() == kept


def test_a_video_that_is_gone_or_has_changed_is_said_and_found_elsewhere(
    made: Dataset, tmp_path: Path
) -> None:
    from lipwright.capture.takes import make_take

    recording = made.recording(NAMES[0])
    video = made.path.parent / "videos" / f"{NAMES[0]}.mkv"
    whole, elsewhere = video.read_bytes(), tmp_path / "deep" / video.name
    try:
        video.write_bytes(whole + b"\0")
        with pytest.raises(LipwrightError, match=r"not the video that .* was captured from"):
            make_take(recording, "train")
        video.unlink()
        with pytest.raises(LipwrightError, match="does not exist; name its folder with --videos"):
            make_take(recording, "train")
        with pytest.raises(LipwrightError, match="is nowhere in"):
            make_take(recording, "train", tmp_path)
        elsewhere.parent.mkdir()
        elsewhere.write_bytes(whole)
        take = make_take(recording, "train", elsewhere.parent)
        assert take is not None
        assert take.video == elsewhere
    finally:
        video.write_bytes(whole)


def test_a_face_that_never_moves_is_refused(made: Dataset, tmp_path: Path) -> None:
    from lipwright.capture.face_of_dataset import fit_dataset

    path, entries = tmp_path / "still", []
    moving = made.recording(NAMES[3])
    motion = moving.motion
    landmarks = np.array(motion.landmarks)
    landmarks[:] = landmarks[np.nanargmax(aperture(landmarks[:, LANDMARKS]))]
    still = Motion(FPS, motion.flags, motion.arkit, landmarks, motion.head_pose)
    for name in ("one", "two"):
        folder = path / RECORDINGS / name
        folder.mkdir(parents=True)
        save_motion(folder / "motion.npz", still)
        write_rest(folder, moving.info["source"])
        entries.append({"name": name, "status": "captured", "split": "train", "files": {}})
    manifest = {**made.manifest, "recordings": entries}
    Dataset(path, manifest).save()
    with pytest.raises(LipwrightError, match=r"no reference face can be fitted: .* do not vary"):
        fit_dataset(open_dataset(path), tmp_path / "face.npz")
    assert not (tmp_path / "face.npz").exists()


def test_too_little_speech_is_refused(made: Dataset) -> None:
    from lipwright.capture.fit_face import fit_reference_face
    from lipwright.capture.takes import make_take

    take = make_take(made.recording(NAMES[4]), "train")
    assert take is not None
    with pytest.raises(LipwrightError, match="29 frames of the train split show a face"):
        fit_reference_face([take])


# The commands


def run(*arguments: object) -> Any:
    from lipwright.cli.faces import face

    return CliRunner().invoke(face, [str(argument) for argument in arguments])


def test_the_overlay_changes_the_lower_face_alone(fitted: tuple[Path, Any], made: Dataset) -> None:
    from lipwright.capture.overlay import overlay_pictures, own_parameters
    from lipwright.capture.takes import make_take

    face = load_reference_face(fitted[0])
    take = make_take(made.recording(NAMES[0]), "test")
    assert take is not None
    parameters, light = own_parameters(face, take)
    pictures = list(overlay_pictures(face, take, parameters, light))
    assert len(pictures) == FRAMES
    height, width = pictures[0].shape[:2]
    for frame, picture in enumerate(pictures):
        original, made_up = picture[:, : width // 2], picture[:, width // 2 :]
        apart = np.abs(original.astype(int) - made_up).max(axis=-1)
        if frame == LOST:
            assert not apart.any()
            continue
        index, _ = rasterise(take.at[frame] * height / SIZE[1], HULL_FAN, (width // 2, height))
        assert not apart[cv2.erode((index < 0).astype(np.uint8), np.ones((9, 9))) > 0].any()
        assert 0 < apart.mean() < 4


HULL_FAN = np.array([(HULL[0], HULL[i], HULL[i + 1]) for i in range(1, len(HULL) - 1)])[:, ::-1]


def test_a_clip_of_modes_becomes_a_video_with_sound(
    fitted: tuple[Path, Any], made: Dataset, tmp_path: Path
) -> None:
    import av

    face = load_reference_face(fitted[0])
    table = tmp_path / "guess.csv"
    table.write_text("time,shape1\n0,0\n0.04,1\n0.08,3\n0.12,-2\n")
    assert clip_to_parameters(face, read_clip(table)).shape.shape == (4, 3)
    out = tmp_path / "guess.mp4"
    done = run("overlay", fitted[0], made.path, NAMES[1], "-o", out, "--params", table)
    assert done.exit_code == 0, done.output
    with av.open(str(out)) as container:
        assert container.streams.video[0].frames == FRAMES
        assert len(container.streams.audio) == 1
        assert float(container.duration or 0) / 1e6 == pytest.approx(FRAMES / FPS, abs=0.1)


def test_commands_fit_describe_and_draw(made: Dataset, tmp_path: Path) -> None:
    out = tmp_path / "face.npz"
    done = run("fit", made.path, "-o", out, "--frames", 60)
    assert done.exit_code == 0, done.output
    assert "3 shape" in done.output
    assert "test: points 0.00" in done.output
    done = run("info", out)
    assert "vertices: 34" in done.output
    assert "shape modes: 3, 100.0 % of the variance" in done.output.replace("%", " %")
    for options in ([], ["--vertices"]):
        picture = tmp_path / "modes.png"
        assert run("show", out, "-o", picture, *options).exit_code == 0
        drawn = cv2.imread(str(picture))
        assert min(drawn.shape[:2]) > 200
        assert drawn.std() > 10
        picture.unlink()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("fit", "SET", "-o", "face.json"), "written as .npz"),
        (("fit", "SET", "-o", "face.npz", "--pixel-share", 2), "pixel_share is 2.0"),
        (("fit", "SET", "-o", "face.npz", "--frames", 3), "frames is 3"),
        (("fit", "nowhere", "-o", "face.npz"), "not a dataset"),
        (("overlay", "FACE", "SET", "weights", "-o", "a.mp4"), "no landmarks or no video"),
        (("overlay", "FACE", "SET", "nobody", "-o", "a.mp4"), "no recording 'nobody'"),
        (("show", "SET", "-o", "a.png"), "is a folder"),
    ],
)
def test_wrong_arguments_are_one_clear_line(
    fitted: tuple[Path, Any], made: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[object, ...], message: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    places: dict[object, object] = {"SET": made.path, "FACE": fitted[0]}
    done = run(*(places.get(argument, argument) for argument in arguments))
    assert isinstance(done.exception, LipwrightError)
    assert message in str(done.exception)
    assert not list(tmp_path.iterdir())


def test_the_manifest_stays_json_that_opens(fitted: tuple[Path, Any], made: Dataset) -> None:
    manifest = json.loads((made.path / "dataset.json").read_text("utf-8"))
    assert len(manifest["recordings"]) == len(NAMES) + 1


@pytest.mark.parametrize(
    ("start", "offset"), [(0, 0), (0, 0.2), (0, -0.2), (0.1, 0), (-0.1, 0), (0.05, 0.4)]
)
def test_the_sound_of_an_overlay_is_in_step_with_the_picture(
    tmp_path: Path, start: float, offset: float
) -> None:
    from lipwright.audio import Audio, write_flac
    from lipwright.capture.overlay import _sound_of_picture
    from lipwright.dataset.recording import Motion, Recording
    from lipwright.track import PhoneTrack

    samples = np.zeros(16000, np.float32)
    samples[8000] = 0.9  # a click at 0.5 s
    write_flac(tmp_path / "audio.flac", Audio(samples, 16000))
    motion = Motion(25.0, np.zeros(25, np.uint8), np.zeros((25, 52), np.float32))
    track = PhoneTrack(("sil",), np.array([0.0, 1.0]))
    sound = _sound_of_picture(Recording("a", motion, track, offset, {}, tmp_path, start))
    assert sound is not None
    [click] = np.flatnonzero(sound.samples > 0.5)
    assert click / 16000 == pytest.approx(0.5 - start + offset, abs=1e-4)
