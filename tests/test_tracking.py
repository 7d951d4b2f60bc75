"""From a video to landmarks in the head's frame."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.capture.blinks import eye_openness, find_blinks
from lipwright.capture.following import Follower
from lipwright.capture.landmarks import EYES, aperture, eye_centres, eye_distance
from lipwright.capture.pose import RIGID, fit_similarities, remove_pose, to_head, to_picture
from lipwright.capture.smooth import CUTOFF, low_pass, smooth
from lipwright.capture.timing import USUAL_FPS, frame_rate, make_grid
from lipwright.capture.video import open_video, read_frames, read_pictures
from lipwright.dataset.recording import Flag
from lipwright.errors import LipwrightError
from lipwright.evaluate.lips import runs

CORPORA = Path(__file__).parents[2] / "shared" / "corpora"
CLIP = CORPORA / "grid-s1" / "video" / "bbal6n.mp4"

Pictures = npt.NDArray[np.uint8]
Array = npt.NDArray[Any]


def encode(
    path: Path,
    pictures: Iterable[Pictures],
    fps: int = 25,
    times: Iterable[float] | None = None,
    sound: float = 0.0,
    codec: str = "libx264",
    **options: str,
) -> Path:
    """A video of pictures at `fps` or at `times` (s), with `sound` s of silence or none."""
    import av

    shown = list(pictures)
    ticks = range(len(shown)) if times is None else [round(1000 * time) for time in times]
    base = Fraction(1, fps if times is None else 1000)
    with av.open(str(path), "w", options=options) as container:
        stream = container.add_stream(codec, rate=fps, options={"crf": "12"})
        stream.width, stream.height = shown[0].shape[1], shown[0].shape[0]
        stream.codec_context.time_base = base
        stream.pix_fmt = "yuvj420p" if codec == "mjpeg" else "yuv420p"
        voice = container.add_stream("aac", rate=16000, layout="mono") if sound else None
        for tick, picture in zip(ticks, shown, strict=True):
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
            frame.pts, frame.time_base = tick, base
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
        if voice is not None:
            silence = np.zeros((1, round(sound * 16000)), np.float32)
            block = av.AudioFrame.from_ndarray(silence, format="fltp", layout="mono")
            block.rate, block.pts = 16000, 0
            container.mux(voice.encode(block))
            container.mux(voice.encode())
    return path


def flat_pictures(count: int, size: tuple[int, int] = (64, 48)) -> list[Pictures]:
    """Grey pictures, each a little lighter than the one before."""
    width, height = size
    return [np.full((height, width, 3), 20 + 3 * (i % 70), np.uint8) for i in range(count)]


def turned(path: Path, matrix: tuple[int, int, int, int]) -> Path:
    """The same MP4 with a display matrix a, b, c, d in its track header."""
    data = bytearray(path.read_bytes())
    place = data.index(b"tkhd") + 44  # ISO 14496-12, 8.3.2
    a, b, c, d = (value << 16 for value in matrix)
    rows = (a, b, 0, c, d, 0, 0, 0, 1 << 30)
    data[place : place + 36] = b"".join(value.to_bytes(4, "big", signed=True) for value in rows)
    path.write_bytes(data)
    return path


# Timing -----------------------------------------------------------------------------------------


@given(st.sampled_from(USUAL_FPS), st.integers(2, 400), st.booleans())
def test_a_constant_rate_passes_frame_for_frame(fps: float, count: int, in_ms: bool) -> None:
    times = np.arange(count) / fps
    if in_ms:
        times = np.round(times, 3)  # as in WebM
    if count >= 30 or not in_ms:
        assert frame_rate(times) == pytest.approx(fps, rel=1e-9 if not in_ms else 2e-3)
    grid = make_grid(times, frame_rate(times))
    assert np.array_equal(grid.before, np.arange(count))
    assert not grid.weight.any()
    values = np.random.default_rng(0).normal(size=(count, 2)).astype(np.float32)
    assert grid.mean(values) is values


@pytest.mark.parametrize("fps", [29.83, 27.5, 119.2])
def test_an_unusual_constant_rate_is_kept_without_drift(fps: float) -> None:
    times = np.arange(3000) / fps
    grid = make_grid(times, frame_rate(times))
    assert grid.fps == pytest.approx(fps, rel=1e-4)
    assert np.array_equal(grid.nearest, np.arange(3000))


def test_a_gap_is_dropped_and_never_filled() -> None:
    times = np.delete(np.arange(60) / 30, slice(20, 30))
    grid = make_grid(times, frame_rate(times))
    assert len(grid) == 60
    assert np.array_equal(np.flatnonzero(grid.dropped), np.arange(20, 30))
    values = grid.mean(times[:, None].astype(np.float32))
    assert np.isnan(values[20:30]).all()
    assert np.allclose(np.delete(values, slice(20, 30), axis=0)[:, 0], times)


def test_frames_at_uneven_times_are_interpolated_where_they_belong() -> None:
    rng = np.random.default_rng(1)
    times = np.cumsum(rng.uniform(0.029, 0.041, 300))
    times -= times[0]
    grid = make_grid(times, frame_rate(times))
    place = grid.mean(times.astype(np.float32)[:, None])[:, 0]
    error = np.abs(place - np.arange(len(grid)) / grid.fps)
    assert not grid.dropped.any()
    assert error.max() <= 0.25 / grid.fps + 1e-6


def test_time_stamps_that_jump_are_refused() -> None:
    times = np.concatenate([np.arange(50) / 25, 9000 + np.arange(50) / 25])
    with pytest.raises(ValueError, match=r"jump by 8998 s at 1\.96 s"):
        make_grid(times, 25.0)


# Videos -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("matrix", "stored"),
    [
        ((0, 1, -1, 0), lambda p: np.rot90(p, 1)),
        ((-1, 0, 0, -1), lambda p: np.rot90(p, 2)),
        ((0, -1, 1, 0), lambda p: np.rot90(p, 3)),
        ((-1, 0, 0, 1), lambda p: p[:, ::-1]),
        ((1, 0, 0, -1), lambda p: p[::-1]),
        ((0, 1, 1, 0), lambda p: p.transpose(1, 0, 2)),
    ],
)
def test_a_rotated_video_is_set_upright(tmp_path: Path, matrix: Any, stored: Any) -> None:
    picture = np.zeros((48, 80, 3), np.uint8)
    picture[:24, :40], picture[:24, 40:], picture[24:, :40] = (255, 0, 0), (0, 255, 0), (0, 0, 255)
    path = turned(encode(tmp_path / "phone.mp4", [stored(picture)] * 4), matrix)
    video = open_video(path)
    assert video.size == (80, 48)
    for _, seen in read_frames(video):
        assert seen.shape == (48, 80, 3)
        assert np.abs(seen[8:16, 8:32].mean((0, 1)) - [255, 0, 0]).max() < 25
        assert np.abs(seen[8:16, 48:72].mean((0, 1)) - [0, 255, 0]).max() < 25
        assert np.abs(seen[32:40, 8:32].mean((0, 1)) - [0, 0, 255]).max() < 25


def test_pixels_that_are_not_square_are_made_so(tmp_path: Path) -> None:
    import av

    path = tmp_path / "wide.mkv"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        stream.codec_context.sample_aspect_ratio = Fraction(4, 3)
        for picture in flat_pictures(5):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())
    video = open_video(path)
    assert video.size == (85, 48)
    assert all(picture.shape == (48, 85, 3) for _, picture in read_frames(video))


@pytest.mark.parametrize(
    ("name", "codec"),
    [("a.mp4", "libx264"), ("a.mkv", "libx264"), ("a.webm", "libvpx"), ("a.avi", "mpeg4"),
     ("a.ts", "libx264"), ("a.mov", "mjpeg"), ("a.flv", "libx264")],
)  # fmt: skip
def test_every_container_gives_each_frame_once_in_order(
    tmp_path: Path, name: str, codec: str
) -> None:
    path = encode(tmp_path / name, flat_pictures(50), codec=codec)
    video = open_video(path)
    assert video.fps == 25
    seen = list(read_pictures(path))
    assert [index for index, _ in seen] == list(range(50))
    levels = np.array([picture.mean() for _, picture in seen])
    assert np.corrcoef(levels, np.arange(50))[0, 1] > 0.99


def test_chosen_pictures_are_those_of_the_whole(tmp_path: Path) -> None:
    path = encode(tmp_path / "a.mp4", flat_pictures(30))
    every = dict(read_pictures(path))
    chosen = dict(read_pictures(path, [17, 3, 29]))
    assert list(chosen) == [3, 17, 29]
    assert all(np.array_equal(chosen[index], every[index]) for index in chosen)
    assert dict(read_pictures(path, [])) == {}


def test_leaving_off_in_the_middle_of_long_videos_does_not_wait(tmp_path: Path) -> None:
    path = encode(tmp_path / "a.mp4", flat_pictures(60))
    for _ in range(30):
        assert len(dict(read_pictures(path, [2]))) == 1


def test_the_pictures_of_a_variable_rate_stand_on_its_grid(tmp_path: Path) -> None:
    times = np.concatenate([np.arange(20) / 30, 1 + np.arange(20) / 30])
    path = encode(tmp_path / "phone.mp4", flat_pictures(40), fps=30, times=times)
    video = open_video(path)
    assert video.fps == pytest.approx(30)
    indices = [index for index, _ in read_pictures(video)]
    assert indices == [*range(20), *range(30, 50)]


def test_the_start_is_told_on_the_clock_of_the_sound(tmp_path: Path) -> None:
    times = 0.2 + np.arange(30) / 25
    late = encode(tmp_path / "late.mkv", flat_pictures(30), times=times, sound=1.6)
    assert open_video(late).start == pytest.approx(0.2, abs=0.03)
    silent = encode(tmp_path / "silent.mkv", flat_pictures(30), times=times)
    assert open_video(silent).start == 0


def _text(path: Path) -> Path:
    path.write_text("no video")
    return path


def _empty(path: Path) -> Path:
    path.touch()
    return path


def _sound(path: Path, cover: bool = False) -> Path:
    import av

    with av.open(str(path), "w") as container:
        voice = container.add_stream("aac", rate=16000, layout="mono")
        picture = container.add_stream("mjpeg", rate=1) if cover else None
        block = av.AudioFrame.from_ndarray(
            np.zeros((1, 16000), np.float32), format="fltp", layout="mono"
        )
        block.rate = 16000
        if picture is not None:
            picture.width, picture.height, picture.pix_fmt = 64, 48, "yuvj420p"
            picture.disposition = av.stream.Disposition.attached_pic
            frame = av.VideoFrame.from_ndarray(flat_pictures(1)[0], format="rgb24")
            container.mux(picture.encode(frame))
            container.mux(picture.encode())
        container.mux(voice.encode(block))
        container.mux(voice.encode())
    return path


def _cut(path: Path, **options: str) -> Path:
    rng = np.random.default_rng(0)
    noise = [rng.integers(0, 255, (48, 64, 3)).astype(np.uint8) for _ in range(50)]
    encode(path, noise, **options)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) * 6 // 10])
    return path


def encode_gif(path: Path) -> Path:
    from PIL import Image

    first, *rest = (Image.fromarray(picture) for picture in flat_pictures(5))
    first.save(path, save_all=True, append_images=rest, duration=40)
    return path


REFUSED = {
    "missing.mp4": (lambda p: p, "no such file"),
    "folder.mp4": (lambda p: (p.mkdir(), p)[1], "is a folder"),
    "note.mp4": (_text, "not a video that can be read"),
    "empty.mp4": (_empty, "is empty"),
    "voice.m4a": (_sound, "has only sound"),
    "music.mp4": (lambda p: _sound(p, cover=True), "has only sound"),
    "slow.mp4": (lambda p: encode(p, flat_pictures(8), fps=2), "2 frames a second are too few"),
    "still.mp4": (lambda p: encode(p, flat_pictures(1)), "1 frame"),
    "anim.gif": (encode_gif, "not a video that can be read"),
    "cut.mp4": (_cut, "cut off"),
    "cut-early-index.mp4": (lambda p: _cut(p, movflags="faststart"), r"1\.\d+ s of 2\.00 s"),
    "cut.mkv": (_cut, "s of 2.* s can be read"),
    "cut.avi": (lambda p: _cut(p, codec="mpeg4"), "cut off"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_video_of_speech_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    make, message = REFUSED[name]
    path = make(tmp_path / name)
    with pytest.raises(LipwrightError, match=message) as caught:
        open_video(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_damaged_frames_are_left_out_and_too_many_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    noise = [rng.integers(0, 255, (48, 64, 3)).astype(np.uint8) for _ in range(50)]
    path = encode(tmp_path / "worn.mov", noise)
    whole = path.read_bytes()
    place = whole.index(b"mdat") + len(whole) // 2
    few = len(whole) // 20  # two or three frames
    path.write_bytes(whole[:place] + bytes(few) + whole[place + few :])
    video = open_video(path)
    assert len(video.times) == 50
    assert 45 <= len(dict(read_frames(video))) < 50
    many = len(whole) // 3
    path.write_bytes(whole[:place] + bytes(many) + whole[place + many :])
    with pytest.raises(LipwrightError, match=r"worn\.mov: is damaged: \d+ of 50 frames"):
        list(read_frames(open_video(path)))


# Faces ------------------------------------------------------------------------------------------


def face_at(x: float, y: float, size: float = 60.0) -> npt.NDArray[np.float32]:
    """The rigid table's face, the other points around it, with eyes `size` pixels apart."""
    face = np.random.default_rng(3).normal(0, 0.5, (478, 3))
    face[list(RIGID)] = list(RIGID.values())
    return (face * size + [x, y, 0]).astype(np.float32)


def test_the_larger_face_is_followed_even_when_it_is_found_second() -> None:
    follower = Follower()
    left, right = face_at(100, 100, 60), face_at(500, 100, 50)
    seen = follower.follow([right, left], 0.0)
    assert seen.face is left
    assert seen.is_crowd
    grown = face_at(500, 100, 65)
    assert follower.follow([grown, left], 0.04).face is left


def test_a_jump_and_back_is_lost_and_a_cut_is_taken_up_again() -> None:
    follower = Follower()
    follower.follow([face_at(100, 100)], 0.0)
    assert follower.follow([face_at(600, 100)], 0.04).face is None
    assert follower.follow([face_at(100, 100)], 0.08).face is not None
    found = [follower.follow([face_at(600, 100)], 0.12 + i / 25).face for i in range(10)]
    assert found[0] is None
    assert found[-1] is not None


def test_eyes_that_collapse_are_no_data() -> None:
    follower = Follower()
    follower.follow([face_at(100, 100)], 0.0)
    assert follower.follow([face_at(100, 100, 10)], 0.04).face is None


def test_a_small_or_overlapping_face_is_no_crowd() -> None:
    assert not Follower().follow([face_at(300, 300), face_at(900, 300, 20)], 0).is_crowd
    assert not Follower().follow([face_at(300, 300), face_at(310, 300)], 0).is_crowd


@pytest.fixture(scope="module")
def tracker() -> Any:
    """The tracker, loaded once."""
    pytest.importorskip("mediapipe", reason="the face tracker is not installed")
    if not CLIP.exists():
        pytest.skip("the GRID recordings are not beside the checkout")
    from lipwright.capture.tracker import Tracker

    return Tracker()


@pytest.fixture(scope="module")
def pictures(tracker: Any) -> list[Pictures]:
    """The first second and a half of a GRID recording."""
    del tracker  # skips where there is none
    return [picture for _, picture in read_pictures(CLIP, range(36))]


@pytest.fixture(scope="module")
def plain_video(pictures: list[Pictures], tmp_path_factory: Any) -> Path:
    """A video of them; encoding again on a busy machine may give other bytes."""
    return encode(tmp_path_factory.mktemp("plain") / "plain.mp4", pictures)


@pytest.fixture(scope="module")
def plain(tracker: Any, plain_video: Path) -> Any:
    """Its landmarks."""
    return tracker.track_video(plain_video)


def test_real_faces_are_tracked_in_every_frame_and_alike_each_time(
    tracker: Any, plain: Any, plain_video: Path
) -> None:
    shares: list[float] = []
    from lipwright.capture.tracker import check_faces, face_warnings, track_video

    again = track_video(plain_video, tracker, shares.append)
    assert np.array_equal(again.points, plain.points)
    assert (plain.fps, plain.size, len(plain)) == (25.0, (360, 288), 36)
    assert not plain.flags.any()
    assert plain.tracked.all()
    assert shares == sorted(shares)
    assert shares[-1] == 1
    check_faces(plain, "plain.mp4")
    assert face_warnings(plain) == []


def test_a_rotated_phone_video_gives_the_same_landmarks(
    tracker: Any, plain: Any, pictures: list[Pictures], tmp_path: Path
) -> None:
    path = encode(tmp_path / "phone.mp4", [np.rot90(picture) for picture in pictures[:10]])
    track = tracker.track_video(turned(path, (0, 1, -1, 0)))
    assert track.size == (360, 288)
    assert np.abs(track.points - plain.points[:10])[..., :2].max() < 4
    assert np.abs(track.points - plain.points[:10])[..., :2].mean() < 0.5


def test_a_gap_of_a_variable_rate_is_marked_and_empty(
    tracker: Any, plain: Any, pictures: list[Pictures], tmp_path: Path
) -> None:
    from lipwright.capture.tracker import face_warnings

    kept = [*range(12), *range(18, 30)]
    times = [index / 25 for index in kept]
    path = encode(tmp_path / "gap.mp4", [pictures[index] for index in kept], times=times)
    track = tracker.track_video(path)
    assert np.array_equal(np.flatnonzero(track.has(Flag.DROPPED)), np.arange(12, 18))
    assert np.isnan(track.points[12:18]).all()
    assert np.abs(track.points[kept] - plain.points[kept])[..., :2].mean() < 0.5
    assert face_warnings(track) == ["the video has no frames from 0.48 to 0.72 s"]


def test_two_faces_are_refused(tracker: Any, pictures: list[Pictures], tmp_path: Path) -> None:
    from lipwright.capture.tracker import check_faces

    both = [np.concatenate([p, p if i > 4 else 0 * p], 1) for i, p in enumerate(pictures[:16])]
    path = encode(tmp_path / "both.mp4", both)
    track = tracker.track_video(path)
    assert np.ptp(eye_centres(track.points).mean(1)[:, 0]) < 30  # one of them all the time
    with pytest.raises(LipwrightError, match=r"both\.mp4: two faces from 0\.20 to 0\.64 s; record"):
        check_faces(track, path)


def test_a_face_that_leaves_is_told_and_none_at_all_is_refused(
    tracker: Any, pictures: list[Pictures], tmp_path: Path
) -> None:
    from lipwright.capture.tracker import check_faces, face_warnings

    leaving = [p if i < 12 else 0 * p for i, p in enumerate(pictures[:18])]
    path = encode(tmp_path / "leaves.mp4", leaving)
    track = tracker.track_video(path)
    check_faces(track, path)
    assert face_warnings(track) == ["the face is lost from 0.48 to 0.72 s"]
    assert np.isnan(track.points[12:]).all()
    black = encode(tmp_path / "black.mp4", [0 * picture for picture in pictures[:10]])
    with pytest.raises(LipwrightError, match=r"black\.mp4: no face in 100 % of the frames"):
        check_faces(tracker.track_video(black), black)


def test_the_tracker_writes_nothing_to_standard_error(tracker: Any) -> None:
    del tracker
    code = (
        "from lipwright.capture.tracker import get_tracker\n"
        "import numpy as np\n"
        "get_tracker('mediapipe').track_frame(np.zeros((64, 64, 3), np.uint8))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert done.stdout + done.stderr == b""


def test_an_unknown_tracker_is_refused_with_the_choices() -> None:
    from lipwright.capture.tracker import get_tracker

    with pytest.raises(LipwrightError, match="no tracker 'magic'; choose mediapipe"):
        get_tracker("magic")


# Head pose --------------------------------------------------------------------------------------


def rotation(degrees: Array) -> Array:
    from scipy.spatial.transform import Rotation

    return Rotation.from_euler("yxz", degrees, degrees=True).as_matrix()


def talking_face(frames: int, seed: int = 0) -> npt.NDArray[np.float64]:
    """A head at rest in its own frame, whose other points move."""
    rng = np.random.default_rng(seed)
    face = np.tile(rng.normal(0, 0.7, (478, 3)), (frames, 1, 1))
    face[:, list(RIGID)] = list(RIGID.values())
    moving = np.setdiff1d(np.arange(478), list(RIGID))
    steps = np.sin(np.arange(frames)[:, None, None] * rng.uniform(0.1, 0.8, (1, len(moving), 3)))
    face[:, moving] += 0.05 * steps
    return face


@settings(max_examples=25, deadline=None)
@given(
    st.tuples(*[st.floats(-30, 30)] * 3), st.floats(20, 400), st.floats(0, 2000), st.floats(0, 2000)
)
def test_a_turned_moved_and_scaled_head_gives_the_same_landmarks(
    turn: tuple[float, float, float], size: float, x: float, y: float
) -> None:
    face = talking_face(20)
    pixels = size * face @ rotation(np.array(turn)).T + [x, y, 0]
    landmarks, poses = remove_pose(pixels, 25.0)
    assert np.abs(landmarks - face).max() < 1e-4
    assert np.abs(to_picture(landmarks, poses) - pixels).max() < 1e-2


def test_a_head_that_turns_slowly_while_it_talks_gives_the_same_landmarks() -> None:
    face = talking_face(100)
    share = np.sin(np.arange(100) / 25 * np.pi / 2)[:, None]  # a quarter of a Hz
    turns = rotation(share * [30.0, 15.0, 10.0])
    pixels = 60 * np.einsum("tij,tnj->tni", turns, face) + 100 + 40 * share[:, None]
    landmarks, poses = remove_pose(pixels, 25.0)
    assert np.abs(landmarks - face)[5:-5].max() < 0.01
    assert np.abs(to_picture(landmarks, poses) - pixels).max() < 1e-2


def test_lost_frames_stay_lost_and_do_not_touch_the_others() -> None:
    pixels = 60 * talking_face(30) + 100
    whole, _ = remove_pose(pixels, 25.0)
    pixels[10:14] = np.nan
    landmarks, poses = remove_pose(pixels, 25.0)
    assert np.isnan(landmarks[10:14]).all()
    assert np.isnan(poses[10:14]).all()
    rest = np.r_[:10, 14:30]
    assert np.abs(landmarks[rest] - whole[rest]).max() < 1e-5


def test_the_similarity_is_the_planted_one_and_never_a_reflection() -> None:
    table = np.array(list(RIGID.values()))
    planted = np.concatenate([50 * rotation(np.array([20.0, -10, 5])), [[3], [4], [5]]], axis=1)
    points = table @ planted[:, :3].T + planted[:, 3]
    assert np.allclose(fit_similarities(table, points[None])[0], planted)
    mirrored = fit_similarities(table, (points * [1, 1, -1])[None])
    assert np.linalg.det(mirrored[0, :, :3]) > 0
    assert np.allclose(to_head(points[None], planted[None])[0], table)


def test_the_table_of_the_skull_is_the_frame_that_it_defines() -> None:
    table = np.full((478, 3), np.nan)
    table[list(RIGID)] = list(RIGID.values())
    left, right = eye_centres(table)
    assert np.allclose((left + right) / 2, 0, atol=1e-3)
    assert np.allclose(right - left, [1, 0, 0], atol=2e-3)
    assert np.isclose(table[list(RIGID), 0].sum(), 0, atol=1e-9)  # both sides alike


def test_on_a_real_face_the_lips_are_as_open_in_the_heads_frame_as_in_the_picture(
    plain: Any,
) -> None:
    landmarks, poses = remove_pose(plain.points, plain.fps)
    real, seen = aperture(plain.points), aperture(landmarks)
    assert np.corrcoef(real, seen)[0, 1] > 0.998
    assert np.polyfit(real, seen, 1)[0] == pytest.approx(1, abs=0.02)
    assert np.abs(to_picture(landmarks, poses) - plain.points).max() < 1e-3
    assert eye_distance(landmarks).mean() == pytest.approx(1, abs=0.02)


# Smoothing --------------------------------------------------------------------------------------


def noisy_face(frames: int = 60, seed: int = 0) -> npt.NDArray[np.float64]:
    rng = np.random.default_rng(seed)
    return talking_face(frames, seed) + rng.normal(0, 0.003, (frames, 478, 3))


@pytest.mark.parametrize("fps", [25.0, 60.0])
def test_smoothing_has_no_direction_of_time(fps: float) -> None:
    face = noisy_face()
    assert np.allclose(smooth(face[::-1], fps)[::-1], smooth(face, fps), atol=1e-6)


@given(st.floats(-5, 5), st.sampled_from([24.0, 25.0, 30.0, 60.0, 120.0]))
def test_what_does_not_move_stays(value: float, fps: float) -> None:
    still = np.full((40, 3), value)
    still[10:13] = np.nan
    assert np.allclose(low_pass(still, fps, CUTOFF), still, equal_nan=True, atol=1e-12)


def test_a_gap_splits_the_signal_and_nothing_rings_over_it() -> None:
    values = np.zeros((60, 1))
    values[:20], values[20:25] = 1.0, np.nan
    smoothed = low_pass(values, 60.0, CUTOFF)
    assert np.allclose(smoothed[:20], 1)
    assert np.allclose(smoothed[25:], 0)
    assert np.isnan(smoothed[20:25]).all()


def test_half_of_the_power_passes_at_the_cutoff_at_any_rate() -> None:
    for fps in (60.0, 120.0, 240.0):
        wave = np.sin(2 * np.pi * CUTOFF * np.arange(400) / fps)
        passed = low_pass(wave, fps, CUTOFF)[100:300].std() / wave[100:300].std()
        assert passed == pytest.approx(np.sqrt(0.5), abs=0.01)


def test_jitter_goes_at_60_fps_and_hardly_anything_at_25() -> None:
    still = np.random.default_rng(0).normal(0, 1, (4000, 1))
    assert low_pass(still, 60.0, CUTOFF).std() < 0.65
    assert low_pass(still, 25.0, CUTOFF).std() > 0.95


def lips(gaps: Array) -> npt.NDArray[np.float64]:
    """A face whose inner lips are `gaps` (T,) apart."""
    face = np.zeros((len(gaps), 478, 3))
    for side, eye in zip((-0.5, 0.5), EYES, strict=True):
        face[:, eye, 0] = side
    face[:, [14, 87, 317], 1] = gaps[:, None]
    return face


@pytest.mark.parametrize("fps", [25.0, 30.0, 60.0, 120.0])
@pytest.mark.parametrize("length", [0.02, 0.04, 0.08])
def test_a_closure_is_as_tight_after_smoothing_as_before(fps: float, length: float) -> None:
    times = np.arange(round(fps)) / fps
    gaps = np.where(np.abs(times - 0.5) <= length / 2 + 0.5 / fps, 0.01, 0.2)
    smoothed = aperture(smooth(lips(gaps), fps))
    assert smoothed.min() <= 0.01 + 1e-6
    assert smoothed.argmin() == pytest.approx(gaps.argmin(), abs=length * fps)


def test_closures_of_real_lips_are_kept(plain: Any) -> None:
    landmarks, _ = remove_pose(plain.points, plain.fps)
    before, after = aperture(landmarks), aperture(smooth(landmarks, plain.fps))
    deepest = int(before.argmin())
    assert after[deepest] <= before[deepest] + 1e-5
    assert np.corrcoef(before, after)[0, 1] > 0.999


def test_runs_are_found_at_the_edges_too() -> None:
    assert runs(np.array([1, 1, 0, 1, 0, 0, 1], bool)) == [(0, 2), (3, 4), (6, 7)]
    assert runs(np.zeros(3, bool)) == []


# Blinks -----------------------------------------------------------------------------------------


def test_a_blink_is_found_and_a_glance_down_is_none(plain: Any) -> None:
    from lipwright.capture.blinks import LIDS

    still = np.repeat(plain.points[:1], 80, axis=0).astype(float)
    share = np.ones(80)
    share[20:24] = 0.5, 0.1, 0.2, 0.6  # a blink
    share[50:65] = 0.7  # a glance down
    for pairs in LIDS:
        for upper, lower in pairs:
            gap = still[:, upper] - still[:, lower]
            still[:, upper] = still[:, lower] + share[:, None] * gap
    still[70:72] = np.nan
    assert np.array_equal(np.flatnonzero(find_blinks(still, 25.0)), np.arange(20, 24))
    assert np.isnan(eye_openness(still)[70:72]).all()


def test_without_a_face_there_is_no_blink() -> None:
    assert not find_blinks(np.full((5, 478, 3), np.nan), 25.0).any()
