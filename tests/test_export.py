"""Clips to files, and back from those of ours."""

from __future__ import annotations

import csv
import errno
import io
import json
import os
import re
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lipwright.audio import Audio, open_audio
from lipwright.clip import Clip
from lipwright.controls import ARKIT, CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export import (
    EXPORTERS,
    ExportOptions,
    Performance,
    check_targets,
    export_all,
    export_clip,
    known_exports,
    livelink,
    mp4,
    read_clip,
    read_clip_csv,
    read_clip_json,
    read_performance_json,
)
from lipwright.export.glb import mesh_to_glb
from lipwright.export.mp4 import picture_times
from lipwright.face.head import Head, Part, save_head
from lipwright.track import PhoneTrack, Word

IN_FOLDER = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=60
)
SMALL = ExportOptions(size=(64, 64))
TRACK = PhoneTrack(
    ("sil", "B", "AA"), np.array([0.0, 0.2, 0.3, 0.5]), (Word("bah", 1, 3, 0.5),), (None, None, 1)
)


def open_and_shut(seconds: float, fps: float = 60.0) -> Clip:
    """The jaw open in the second half."""
    count = round(seconds * fps) + 1
    return Clip(CANONICAL, fps, np.zeros((count, len(CANONICAL)))).with_curves(
        {"jawOpen": np.arange(count) >= count / 2}
    )


CLIP = open_and_shut(0.5)


def square(low: float, high: float, depth: float) -> np.ndarray:
    corners = [(-0.08, low), (0.08, low), (0.08, high), (-0.08, high)]
    return np.array([(x, y, depth) for x, y in corners], np.float32)


@pytest.fixture(scope="module")
def head() -> Head:
    """A white face of two squares, the lower of which the jaw drops off a dark throat."""
    two = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    moved = CANONICAL.index("jawOpen")
    return Head(
        vertices=np.concatenate(
            [square(0, 0.1, 0.1), square(-0.1, 0, 0.1), square(-0.1, 0.1, 0.05)]
        ),
        triangles=np.concatenate([two, two + 4, two + 8]),
        parts=(
            Part("skin", "skin", slice(0, 8), slice(0, 4)),
            Part("mouth", "mouth", slice(8, 12), slice(4, 6)),
        ),
        tints=np.repeat(np.array([1, 0.01], np.float32), [8, 4])[:, None] * np.ones(3, np.float32),
        uvs=np.full((12, 2), 0.5, np.float32),
        texture=np.full((4, 4, 3), 255, np.uint8),
        welds=np.arange(12, dtype=np.int32),
        shape_starts=np.array([0] * (moved + 1) + [4] * (len(CANONICAL) - moved), np.int32),
        shape_vertices=np.arange(4, 8, dtype=np.int32),
        shape_deltas=np.tile(np.array([0, -0.08, 0], np.float32), (4, 1)),
        lip_pairs=np.array([[0, 7], [1, 6], [0, 7]], np.int32),
    )


@pytest.fixture
def installed(head: Head, tmp_path_factory: pytest.TempPathFactory, monkeypatch: Any) -> Head:
    home = tmp_path_factory.mktemp("home")
    monkeypatch.setenv("LIPWRIGHT_HOME", str(home))
    save_head(head, home / "head.npz")
    return head


@pytest.fixture
def tone() -> Audio:
    """0.51 s of a tone with a click at 0.25 s."""
    times = np.arange(round(0.51 * 16_000)) / 16_000
    samples = 0.02 * np.sin(2 * np.pi * 220 * times)
    samples[4000:4040] = 0.9
    return Audio(samples.astype(np.float32), 16_000)


def names_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


class TestChoice:
    def test_every_format_of_the_table_writes(
        self, tmp_path: Path, installed: Head, tone: Audio
    ) -> None:
        paths = [tmp_path / f"a{suffix}" for suffix in EXPORTERS]
        export_all(paths, Performance(CLIP, TRACK, tone), options=SMALL)
        assert names_in(tmp_path) == {f"a{suffix}" for suffix in EXPORTERS} | {"a.wav"}

    def test_the_longest_suffix_wins(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.LiveLink.csv", CLIP)
        assert (tmp_path / "a.LiveLink.csv").read_text().startswith("Timecode,")

    def test_a_named_format_goes_before_the_suffix(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.txt", CLIP, format="csv")
        assert (tmp_path / "a.txt").read_text().startswith("time,")
        assert len(read_clip(tmp_path / "a.txt", "csv")) == len(CLIP)

    def test_an_unknown_suffix_lists_the_known_ones(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError) as caught:
            export_clip(tmp_path / "a.fbx", CLIP)
        assert all(suffix in str(caught.value) for suffix in known_exports())

    def test_what_cannot_be_read_back_says_so(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match=r"readable are \.json, \.csv, "):
            read_clip(tmp_path / "a.mp4")

    @pytest.mark.parametrize("size", [(511, 512), (512, 14), (512, 5000)])
    def test_an_odd_or_extreme_video_size_is_refused(self, size: tuple[int, int]) -> None:
        with pytest.raises(LipwrightError, match="choose even numbers from 16 to 4096"):
            ExportOptions(size=size)


class TestTargets:
    def test_a_folder_is_refused(self, tmp_path: Path) -> None:
        (tmp_path / "a.csv").mkdir()
        with pytest.raises(LipwrightError, match=r"a\.csv: is a folder"):
            check_targets([tmp_path / "a.csv"])

    def test_a_missing_folder_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match="does not exist; create it first"):
            export_clip(tmp_path / "none" / "a.csv", CLIP)

    def test_a_read_only_folder_is_refused(self, tmp_path: Path) -> None:
        folder = tmp_path
        if os.geteuid() == 0:  # permissions do not hold root back; no file fits into this folder
            folder = Path("/proc/self")
            if not folder.is_dir():
                pytest.skip("root, and no folder that refuses it")
        else:
            tmp_path.chmod(0o500)
        with pytest.raises(LipwrightError, match=r"a\.csv: cannot be written: .*; name another"):
            check_targets([folder / "a.csv"])

    def test_two_outputs_of_one_name_are_refused(self, tmp_path: Path) -> None:
        (tmp_path / "b").mkdir()
        with pytest.raises(LipwrightError, match="two outputs have this name"):
            check_targets([tmp_path / "a.csv", tmp_path / "b" / ".." / "a.csv"])

    def test_the_recording_is_never_replaced(
        self, tmp_path: Path, installed: Head, tone: Audio
    ) -> None:
        recording = tmp_path / "a.mp4"
        recording.write_bytes(b"the recording")
        with pytest.raises(LipwrightError, match="is the recording itself; name another output"):
            export_clip(recording, CLIP, audio=recording)
        assert recording.read_bytes() == b"the recording"

    def test_nothing_is_left_by_the_check(self, tmp_path: Path) -> None:
        check_targets([tmp_path / "a.csv", tmp_path / "a.json"])
        assert names_in(tmp_path) == set()

    def test_an_older_file_is_replaced(self, tmp_path: Path) -> None:
        (tmp_path / "a.csv").write_text("old")
        export_clip(tmp_path / "a.csv", CLIP)
        assert (tmp_path / "a.csv").read_text().startswith("time,")


class Broken:
    """Sound that ends in the middle with an error."""

    rate = 16_000
    duration = 5.0

    def __init__(self, error: BaseException) -> None:
        self.error = error

    def __len__(self) -> int:
        return 80_000

    def read(self, start: float, end: float) -> Audio:
        raise self.error

    def blocks(self, seconds: float = 10.0) -> Iterator[Audio]:
        yield Audio(np.zeros(round(seconds * 16_000) // 20, np.float32), 16_000)
        raise self.error


@pytest.mark.parametrize("suffix", [".mp4", ".glb"])
class TestWholeOrNotAtAll:
    @pytest.mark.parametrize("error", [KeyboardInterrupt(), LipwrightError("cut off")])
    def test_an_interrupt_leaves_nothing_and_older_files_as_they_were(
        self, tmp_path: Path, installed: Head, suffix: str, error: BaseException
    ) -> None:
        (tmp_path / "a.json").write_text("old")
        paths = [tmp_path / "a.json", tmp_path / f"a{suffix}", tmp_path / "a.csv"]
        with pytest.raises(type(error)):
            export_all(paths, Performance(CLIP, None, Broken(error)), options=SMALL)
        assert names_in(tmp_path) == {"a.json"}
        assert (tmp_path / "a.json").read_text() == "old"

    def test_a_full_disk_names_the_file(self, tmp_path: Path, installed: Head, suffix: str) -> None:
        full = Broken(OSError(errno.ENOSPC, "No space left on device"))
        paths = [tmp_path / f"a{suffix}", tmp_path / "z.csv"]
        named = "a.mp4" if suffix == ".mp4" else "a.wav"
        with pytest.raises(LipwrightError, match=rf"{named}: cannot be written: No space left"):
            export_all(paths, Performance(CLIP, None, full), options=SMALL)
        assert names_in(tmp_path) == set()

    def test_a_sound_that_is_missing_is_an_error(
        self, tmp_path: Path, installed: Head, suffix: str
    ) -> None:
        with pytest.raises(LipwrightError, match=r"none\.wav: no such file"):
            export_clip(tmp_path / f"a{suffix}", CLIP, audio=tmp_path / "none.wav", options=SMALL)
        assert names_in(tmp_path) == set()

    def test_a_head_that_is_missing_is_an_error(
        self, tmp_path: Path, monkeypatch: Any, suffix: str
    ) -> None:
        monkeypatch.setenv("LIPWRIGHT_HOME", str(tmp_path))
        with pytest.raises(LipwrightError, match="lipwright head install"):
            export_clip(tmp_path / f"a{suffix}", CLIP)

    def test_curves_of_another_rig_are_refused(
        self, tmp_path: Path, installed: Head, suffix: str
    ) -> None:
        with pytest.raises(LipwrightError, match="have none of the head's controls"):
            export_clip(tmp_path / f"a{suffix}", Clip(("viseme_aa",), 60, np.zeros((2, 1))))


control_names = st.text(
    st.characters(exclude_categories=("Cs", "Cc", "Zl", "Zp")), min_size=1, max_size=8
).filter(lambda name: name == name.strip())


@st.composite
def clips(draw: st.DrawFn) -> Clip:
    names = draw(st.lists(control_names, max_size=4, unique=True))
    rates = st.sampled_from([24.0, 25.0, 29.97, 30.0, 59.94, 60.0, 1000.0]) | st.floats(1.0, 1000.0)
    count = draw(st.integers(1, 6))
    weights = st.floats(-2, 2, width=32)
    rows = [draw(st.lists(weights, min_size=len(names), max_size=len(names))) for _ in range(count)]
    return Clip(tuple(names), draw(rates), np.array(rows, np.float32).reshape(count, len(names)))


class TestJson:
    @IN_FOLDER
    @given(clip=clips())
    def test_a_written_clip_reads_back(self, tmp_path: Path, clip: Clip) -> None:
        export_clip(tmp_path / "a.json", clip)
        back = read_clip_json(tmp_path / "a.json")
        assert (back.names, back.fps) == (clip.names, clip.fps)
        assert np.abs(back.values - clip.values).max(initial=0) <= 0.51e-5

    def test_the_track_reads_back_with_its_words(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.json", CLIP, track=TRACK)
        track = read_performance_json(tmp_path / "a.json").track
        assert track is not None
        assert (track.phones, track.words, track.stress) == (
            TRACK.phones, TRACK.words, TRACK.stress,
        )  # fmt: skip
        assert track.edges.tolist() == TRACK.edges.tolist()

    def test_it_is_plain_json_of_a_known_version(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.json", CLIP)
        content = json.loads((tmp_path / "a.json").read_text())
        assert (content["format"], content["version"]) == ("lipwright-clip", 1)
        assert np.shape(content["values"]) == (31, 55)

    HEAD = '{"format": "lipwright-clip", "version": 1, "fps": 60, "names": ["jawOpen"], '

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            (HEAD + '"values": [[0], [0, 1]]}', "frame 1 has 2 values, not one for each of the 1 "),
            (HEAD + '"values": [[null]]}', "frame 0: 'jawOpen' is 'None', not a number; correct"),
            (HEAD + '"values": [[1e300]]}', "frame 0: 'jawOpen' is too large a number; correct"),
            (HEAD + '"values": [[1e999]]}', "frame 0: 'jawOpen' is 'inf', not a number; correct"),
            (HEAD + '"values": [[1' + "0" * 400 + "]]}",
             "frame 0: 'jawOpen' is '100000000000000000000000', not a number; correct it"),
            (HEAD + '"values": []}', "'values' is not a list of frames; correct it"),
            (HEAD + '"values": [[0]], "track": 3}', "'track' is not an object; correct it or "),
            (HEAD.replace("60", "0") + '"values": [[0]]}', "'fps' is 0, not a rate up to 1000 a "),
            (HEAD.replace('["jawOpen"]', '["a", "a"]') + '"values": [[0, 0]]}',
             "the control 'a' stands twice; delete one"),
            (HEAD.replace('"jawOpen"', '""') + '"values": [[0]]}',
             "control 1 has no name; name it or delete it"),
            ('{"format": "lipwright-track", "version": 1}',
             "is of the format 'lipwright-track'; expected \"format\": \"lipwright-clip\""),
        ],
    )  # fmt: skip
    def test_an_error_names_the_field_and_the_remedy(
        self, tmp_path: Path, text: str, expected: str
    ) -> None:
        (tmp_path / "a.json").write_text(text)
        with pytest.raises(LipwrightError, match=re.escape(f"a.json: {expected}")):
            read_clip_json(tmp_path / "a.json")


class TestCsv:
    @IN_FOLDER
    @given(clip=clips())
    def test_a_written_clip_reads_back(self, tmp_path: Path, clip: Clip) -> None:
        export_clip(tmp_path / "a.csv", clip)
        back = read_clip_csv(tmp_path / "a.csv")
        assert back.names == clip.names
        assert np.abs(back.values - clip.values).max(initial=0) <= 0.51e-5
        if len(clip) > 1:
            assert back.times == pytest.approx(clip.times, abs=2e-6)

    @pytest.mark.parametrize("fps", [24, 25, 30, 48, 50, 60, 120])
    def test_a_whole_rate_comes_back_exactly(self, tmp_path: Path, fps: int) -> None:
        export_clip(tmp_path / "a.csv", open_and_shut(1.0, fps))
        assert read_clip_csv(tmp_path / "a.csv").fps == fps

    def test_a_table_of_another_tool_with_times_in_ms_digits_reads(self, tmp_path: Path) -> None:
        (tmp_path / "a.csv").write_text("Time, jawOpen\r\n0, 0\r\n0.017, .5\r\n0.033, 1\r\n\r\n")
        clip = read_clip_csv(tmp_path / "a.csv")
        assert clip.names == ("jawOpen",)
        assert clip.fps == 60
        assert clip.values[:, 0].tolist() == [0, 0.5, 1]

    def test_pythons_reader_sees_times_and_columns(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.csv", CLIP)
        with (tmp_path / "a.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert tuple(rows[0]) == ("time", *CANONICAL)
        assert [float(row["time"]) for row in rows] == pytest.approx(CLIP.times, abs=1e-6)
        assert [float(row["jawOpen"]) for row in rows] == CLIP.curve("jawOpen").tolist()

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("jawOpen\n0\n", "line 1: the first column is not 'time'; add the header"),
            ("time,jawOpen\n", "has a header and no frames; export the clip again"),
            ("time,jawOpen\n0,1\n1\n", "line 3: 1 columns, not 2 as in the header; correct it"),
            ("time,jawOpen\n0,x\n", "line 2: column 2 is 'x', not a number; correct it"),
            ("time,a\n5,0\n6,0\n",
             "line 2: the time of the first frame is 5 s, not 0; subtract it from all times"),
            ("time,a\n0,0\n0.1,0\n0.3,0\n",
             "line 3: the time 0.1 s does not keep the even spacing of 6.667 frames a second; "
             "resample the curves"),
            ("time,a\n0,0\n0.00001,0\n",
             "line 3: 2 frames in 1e-05 s are more than 1000 a second; times are in seconds"),
            ("time,a\n0,0\n0,0\n",
             "line 3: 2 frames in 0 s are more than 1000 a second; times are in seconds"),
            ("time,a\n0,0\n-1,0\n",
             "line 3: 2 frames in -1 s are more than 1000 a second; times are in seconds"),
        ],
    )  # fmt: skip
    def test_an_error_names_line_and_remedy(self, tmp_path: Path, text: str, expected: str) -> None:
        (tmp_path / "a.csv").write_text(text)
        with pytest.raises(LipwrightError, match=re.escape(f"a.csv: {expected}")):
            read_clip_csv(tmp_path / "a.csv")


def read_or_refuse(path: Path, content: bytes) -> None:
    """Whatever a file holds, it is a clip or one clear line."""
    path.write_bytes(content)
    try:
        clip = read_clip(path)
    except LipwrightError as error:
        message = str(error)
    else:
        assert isinstance(clip, Clip)
        return
    assert message.startswith(f"{path}: ")
    assert "\n" not in message


NUMBERS = (
    "9" * 400,
    "nan",
    "-1",
    "1e308",
    "1e999",
    "999999999",
    "0",
    "",
    "٣",
    "1_0",
    "true",
    "null",
    "[",
)


@pytest.mark.parametrize("suffix", [".json", ".csv"])
class TestFuzz:
    @IN_FOLDER
    @given(content=st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
    def test_any_bytes_and_text(self, tmp_path: Path, suffix: str, content: bytes) -> None:
        read_or_refuse(tmp_path / f"a{suffix}", content)

    @settings(IN_FOLDER, max_examples=200)
    @given(data=st.data())
    def test_a_valid_file_with_some_things_changed(
        self, tmp_path: Path, suffix: str, data: st.DataObject
    ) -> None:
        path = tmp_path / f"a{suffix}"
        export_clip(path, Clip(("a", "b"), 60, np.eye(2)), track=TRACK)
        pieces = re.split(r"([-\w.]+)", path.read_text(encoding="utf-8"))
        for _ in range(data.draw(st.integers(1, 3))):
            at = data.draw(st.integers(0, len(pieces) - 1))
            pieces[at] = data.draw(
                st.sampled_from([*NUMBERS, pieces[at] * 2]) | st.text(max_size=5)
            )
        read_or_refuse(path, "".join(pieces).encode("utf-8", "replace"))


@IN_FOLDER
@given(
    times=st.lists(
        st.sampled_from(["0", "0.0", "0.1", "1", "-1", "2", "1e-9", "1e300", "5e-324", "0.01667"]),
        min_size=1,
        max_size=5,
    )
)
def test_any_times_give_a_clip_or_one_clear_line(tmp_path: Path, times: list[str]) -> None:
    table = "time,a\n" + "".join(f"{time},0\n" for time in times)
    read_or_refuse(tmp_path / "a.csv", table.encode())


class TestLiveLink:
    def test_the_layout_is_that_of_the_app(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.livelink.csv", CLIP)
        rows = list(csv.reader(io.StringIO((tmp_path / "a.livelink.csv").read_text())))
        assert rows[0][:4] == ["Timecode", "BlendShapeCount", "EyeBlinkLeft", "EyeLookDownLeft"]
        assert rows[0][53:] == [
            "TongueOut", "HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch",
            "LeftEyeRoll", "RightEyeYaw", "RightEyePitch", "RightEyeRoll",
        ]  # fmt: skip
        assert {len(row) for row in rows} == {63}
        assert {row[1] for row in rows[1:]} == {"61"}

    def test_the_columns_are_arkits_controls_in_order(self) -> None:
        assert [name.casefold() for name in livelink.COLUMNS[:52]] == [n.casefold() for n in ARKIT]

    def test_values_stay_between_rest_and_full(self, tmp_path: Path) -> None:
        clip = CLIP.with_curves({"jawOpen": np.linspace(-0.5, 1.5, len(CLIP))})
        export_clip(tmp_path / "a.livelink.csv", clip)
        with (tmp_path / "a.livelink.csv").open(newline="") as file:
            found = [float(row["JawOpen"]) for row in csv.DictReader(file)]
        assert found == pytest.approx(np.clip(clip.curve("jawOpen"), 0, 1), abs=1e-6)

    @pytest.mark.parametrize(
        ("frame", "fps", "expected"),
        [
            (0, 60.0, "00:00:00:00.000"),
            (61, 60.0, "00:00:01:01.000"),
            (31, 30.0, "00:00:01:01.000"),
            (60 * 3661, 60.0, "01:01:01:00.000"),
            (1, 120.0, "00:00:00:00.500"),
            (60, 59.94, "00:00:01:00.060"),
        ],
    )
    def test_the_timecode_counts_frames(self, frame: int, fps: float, expected: str) -> None:
        base = int(fps) if fps in {30.0, 60.0} else 60
        assert livelink.timecode(frame / fps, base) == expected

    def test_curves_of_another_rig_are_refused(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match="have no ARKit controls"):
            export_clip(tmp_path / "a.livelink.csv", Clip(("viseme_aa",), 60, np.zeros((2, 1))))


def load_glb(content: bytes) -> Any:
    import pygltflib

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pygltflib.GLTF2().load_from_bytes(content)


SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
TYPES = {5126: np.float32, 5123: np.uint16, 5125: np.uint32}


def view_array(document: Any, index: int, kind: Any, count: int, offset: int = 0) -> np.ndarray:
    view = document.bufferViews[index]
    assert view.byteOffset % 4 == 0
    assert offset + count * np.dtype(kind).itemsize <= view.byteLength
    start = view.byteOffset + offset
    return np.frombuffer(document.binary_blob(), kind, count, start)


def accessor_array(document: Any, index: int) -> np.ndarray:
    """The values of an accessor, as a second implementation of the glTF standard reads them."""
    accessor = document.accessors[index]
    size, kind = SIZES[accessor.type], TYPES[accessor.componentType]
    values = np.zeros((accessor.count, size), kind)
    if accessor.bufferView is not None:
        flat = view_array(document, accessor.bufferView, kind, accessor.count * size)
        values = flat.reshape(-1, size).copy()
    if accessor.sparse is not None:
        sparse = accessor.sparse
        places = view_array(
            document, sparse.indices.bufferView, TYPES[sparse.indices.componentType], sparse.count
        )
        assert (np.diff(places.astype(int)) > 0).all()
        flat = view_array(document, sparse.values.bufferView, kind, sparse.count * size)
        values[places] = flat.reshape(-1, size)
    if accessor.min:
        assert values.min(axis=0).tolist() == accessor.min
        assert values.max(axis=0).tolist() == accessor.max
    return values


class TestGlb:
    def test_every_blendshape_is_a_named_morph_target(self, head: Head) -> None:
        document = load_glb(mesh_to_glb(head, CLIP))
        mesh = document.meshes[0]
        assert mesh.extras["targetNames"] == list(CANONICAL)
        assert len(mesh.primitives) == len(head.parts)
        assert {len(primitive.targets) for primitive in mesh.primitives} == {len(CANONICAL)}

    def test_the_parts_make_up_the_head_in_every_pose(self, head: Head) -> None:
        document = load_glb(mesh_to_glb(head, CLIP))
        weights = np.linspace(0, 1, len(CANONICAL), dtype=np.float32)
        posed, triangles = [], []
        for primitive in document.meshes[0].primitives:
            vertices = accessor_array(document, primitive.attributes.POSITION)
            faces = accessor_array(document, primitive.indices).reshape(-1, 3)
            triangles.append(faces + sum(map(len, posed)))
            for weight, target in zip(weights, primitive.targets, strict=True):
                position = target["POSITION"] if isinstance(target, dict) else target.POSITION
                vertices = vertices + weight * accessor_array(document, position)
            posed.append(vertices)
        assert np.concatenate(posed) == pytest.approx(head.pose(weights), abs=1e-6)
        assert np.concatenate(triangles).tolist() == head.triangles.tolist()

    def test_the_animation_decodes_to_the_clips_frames(self, head: Head) -> None:
        clip = replace(CLIP, fps=59.94)
        document = load_glb(mesh_to_glb(head, clip))
        (animation,) = document.animations
        (channel,), (sampler,) = animation.channels, animation.samplers
        assert (channel.target.path, sampler.interpolation) == ("weights", "LINEAR")
        times = accessor_array(document, sampler.input)[:, 0]
        weights = accessor_array(document, sampler.output).reshape(len(times), -1)
        assert times == pytest.approx(clip.times, abs=1e-6)
        assert weights.tolist() == clip.values.tolist()

    def test_normals_colours_texture_and_materials_are_there(self, head: Head) -> None:
        document = load_glb(mesh_to_glb(head, CLIP))
        for primitive, part in zip(document.meshes[0].primitives, head.parts, strict=True):
            normals = accessor_array(document, primitive.attributes.NORMAL)
            assert np.linalg.norm(normals, axis=1) == pytest.approx(1, abs=1e-5)
            tints = accessor_array(document, primitive.attributes.COLOR_0)
            assert tints.tolist() == head.tints[part.vertices].tolist()
            material = document.materials[primitive.material]
            assert material.doubleSided == part.material.double_sided
            assert material.pbrMetallicRoughness.roughnessFactor == part.material.roughness
        image = document.bufferViews[document.images[0].bufferView]
        assert document.binary_blob()[image.byteOffset :][:8] == b"\x89PNG\r\n\x1a\n"

    def test_the_asset_names_the_maker_the_head_and_the_sound(
        self, tmp_path: Path, installed: Head, tone: Audio
    ) -> None:
        export_clip(tmp_path / "a.glb", CLIP, audio=tone)
        asset = load_glb((tmp_path / "a.glb").read_bytes()).asset
        assert asset.version == "2.0"
        assert asset.generator.startswith("Lipwright ")
        assert asset.extras["sound"] == "a.wav"
        assert "CC0" in asset.extras["head"]

    def test_the_sound_lies_beside_it(self, tmp_path: Path, installed: Head, tone: Audio) -> None:
        export_clip(tmp_path / "a.glb", CLIP, audio=tone)
        samples, rate = soundfile.read(tmp_path / "a.wav", dtype="float32")
        assert rate == 16_000
        assert samples == pytest.approx(tone.samples, abs=1e-4)

    def test_the_recording_serves_as_its_own_sidecar(
        self, tmp_path: Path, installed: Head, tone: Audio
    ) -> None:
        soundfile.write(tmp_path / "a.wav", tone.samples, tone.rate, "FLOAT")
        before = (tmp_path / "a.wav").read_bytes()
        export_clip(tmp_path / "a.glb", CLIP, audio=str(tmp_path / "a.wav"))
        with open_audio(tmp_path / "a.wav") as opened:
            export_clip(tmp_path / "a.glb", CLIP, audio=opened)
        assert (tmp_path / "a.wav").read_bytes() == before

    def test_another_recording_beside_it_is_not_replaced_but_our_own_sidecar_is(
        self, tmp_path: Path, installed: Head, tone: Audio
    ) -> None:
        soundfile.write(tmp_path / "a.wav", tone.samples, tone.rate)
        with pytest.raises(LipwrightError, match=r"a\.wav: is another recording"):
            export_clip(tmp_path / "a.glb", CLIP, audio=tone)
        (tmp_path / "a.wav").unlink()
        for rate in (16_000, 8_000):
            export_clip(tmp_path / "a.glb", CLIP, audio=replace(tone, rate=rate))
        assert soundfile.info(tmp_path / "a.wav").samplerate == 8_000


def decode(path: Path) -> tuple[np.ndarray, list[float], np.ndarray, Any]:
    """Pictures (T, H, W, 3), their times, the samples of the sound, and the container's facts."""
    import av

    with av.open(str(path)) as container:
        video = container.streams.video[0]
        facts = (container.metadata, float(video.average_rate), container.duration / 1e6)
        pictures = [(f.to_ndarray(format="rgb24"), f.time) for f in container.decode(video)]
    samples = np.zeros(0, np.float32)
    with av.open(str(path)) as container:
        if container.streams.audio:
            blocks = [f.to_ndarray()[0] for f in container.decode(container.streams.audio[0])]
            samples = np.concatenate(blocks)
    return np.stack([p for p, _ in pictures]), [t for _, t in pictures], samples, facts


class TestPictureTimes:
    """Which moments of a clip the pictures of a video show."""

    @staticmethod
    def jaw(*opening: float) -> Clip:
        return Clip(("jawOpen",), 60, np.array(opening, np.float32)[:, None])

    def test_lips_that_meet_between_two_pictures_are_shown_in_the_first_of_them(self) -> None:
        clip = self.jaw(0.5, 0.5, 0.5, 0.0, 0.5, 0.5)
        assert picture_times(clip, 30, 3) * 60 == pytest.approx([0, 3, 4])

    def test_other_pictures_show_their_own_moment(self) -> None:
        clip = self.jaw(0.5, 0.4, 0.0, 0.5, 0.3, 0.2, 0.0, 0.0)
        assert picture_times(clip, 30, 4) * 60 == pytest.approx([0, 2, 4, 6])
        assert picture_times(clip, 60, 8) * 60 == pytest.approx(range(8))

    def test_a_video_that_is_longer_than_the_clip_goes_on(self) -> None:
        times = picture_times(self.jaw(0.5, 0.0), 30, 4) * 60
        assert times == pytest.approx([1, 2, 4, 6])

    def test_curves_that_move_no_lips_are_shown_as_they_are(self) -> None:
        clip = Clip(("ears",), 60, np.zeros((4, 1), np.float32))
        assert picture_times(clip, 30, 2).tolist() == [0, 1 / 30]


class TestMp4:
    def test_pictures_sound_and_title_are_in_step(
        self, tmp_path: Path, installed: Head, tone: Audio
    ) -> None:
        seen: list[tuple[int, int]] = []
        options = replace(SMALL, title="Hello", progress=lambda *done: seen.append(done))
        export_clip(tmp_path / "a.mp4", CLIP, audio=tone, options=options)
        pictures, times, samples, (metadata, fps, duration) = decode(tmp_path / "a.mp4")
        assert pictures.shape == (16, 64, 64, 3)  # 0.51 s at 30 a second
        assert times == pytest.approx(np.arange(16) / 30, abs=1e-4)
        assert (fps, metadata["title"]) == (30.0, "Hello")
        assert duration == pytest.approx(0.53, abs=0.01)
        assert seen == [(frame, 16) for frame in range(1, 17)]
        click = int(np.abs(samples).argmax()) / 48_000
        assert click == pytest.approx(0.25, abs=0.005)

    def test_the_picture_changes_in_the_frame_in_which_the_mouth_opens(
        self, tmp_path: Path, installed: Head
    ) -> None:
        export_clip(tmp_path / "a.mp4", CLIP, options=SMALL)
        pictures, _, samples, _ = decode(tmp_path / "a.mp4")
        lower = pictures[:, 34:44, 20:44].mean(axis=(1, 2, 3))  # below the middle: the throat
        assert len(samples) == 0
        assert len(pictures) == 16
        opens = int(np.ceil(np.argmax(CLIP.curve("jawOpen") > 0) / 2))
        assert np.ptp(lower[:opens]) < 8
        assert np.ptp(lower[opens:]) < 8
        assert lower[0] - lower[-1] > 40

    def test_the_index_stands_before_the_pictures(self, tmp_path: Path, installed: Head) -> None:
        export_clip(tmp_path / "a.mp4", CLIP, options=SMALL)
        content = (tmp_path / "a.mp4").read_bytes()
        assert content.index(b"moov") < content.index(b"mdat")

    def test_the_last_pose_is_held_while_the_sound_goes_on(
        self, tmp_path: Path, installed: Head
    ) -> None:
        sound = Audio(np.zeros(2 * 8000, np.float32), 8000)
        export_clip(tmp_path / "a.mp4", CLIP, audio=sound, options=SMALL)
        pictures, _, _, (_, _, duration) = decode(tmp_path / "a.mp4")
        assert len(pictures) == 60
        assert duration == pytest.approx(2.0, abs=0.03)

    @pytest.mark.parametrize(
        ("clip_fps", "expected"),
        [(24, 24), (25, 25), (30, 30), (48, 24), (50, 25), (60, 30), (59.94, 29.97), (120, 30)],
    )
    def test_the_rate_divides_the_clips(self, clip_fps: float, expected: float) -> None:
        assert mp4.video_fps(clip_fps) == pytest.approx(expected)

    @pytest.mark.parametrize("duration", [0.5, 1.0, 1 / 3, 2.97, 10.0])
    def test_a_whole_number_of_frames_gains_none(self, duration: float) -> None:
        sound = Audio(np.zeros(round(duration * 48_000), np.float32), 48_000)
        assert mp4.frame_count(CLIP, 30.0, sound) == int(np.ceil(round(duration * 30, 4)))


def test_one_file_may_be_named_without_a_list_and_a_nul_in_a_name_is_refused(
    tmp_path: Path,
) -> None:
    clip = Clip(("jawOpen",), 30.0, np.zeros((3, 1)))
    export_all(str(tmp_path / "a.csv"), Performance(clip))
    assert (tmp_path / "a.csv").is_file()
    with pytest.raises(LipwrightError, match="cannot be written"):
        export_all([tmp_path / "a\0b.csv"], Performance(clip))
