"""Recordings of ARKit weights: Live Link Face CSV, JSON of other apps, their motion and sound."""

from __future__ import annotations

import json
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lipwright.capture.arkit_import import (
    find_sound,
    find_takes,
    read_arkit,
    sounds_beside,
    take_names,
    take_stem,
)
from lipwright.capture.arkit_motion import to_motion
from lipwright.clip import Clip
from lipwright.controls import ARKIT
from lipwright.dataset.recording import Flag
from lipwright.errors import LipwrightError
from lipwright.export import export_clip
from lipwright.export.arkit_names import ANGLES, control_column
from lipwright.export.arkit_recording import ArkitRecording
from lipwright.export.livelink_read import is_live_link
from lipwright.export.timecode import codes_to_clock, parse_timecode

NAMES = tuple(name[0].upper() + name[1:] for name in ARKIT + ANGLES)
JAW = ARKIT.index("jawOpen")
IN_FOLDER = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=150
)


def app_code(time: float, base: int = 60) -> str:
    """The app's time code of `time` s: frames of `base` a second and thousandths of a frame."""
    frames, part = divmod(round(time % 86400 * base * 1000), 1000)
    seconds, frame = divmod(frames, base)
    return f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}:{frame:02}.{part:03}"


def millisecond_code(time: float, mark: str = ".") -> str:
    seconds, part = divmod(round(time % 86400 * 1000), 1000)
    return f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}{mark}{part:03}"


def drop_frame_code(number: int, rate: int) -> str:
    """Independent of the reader: count the frames minute by minute."""
    minute = 0
    while True:
        skipped = 0 if minute % 10 == 0 else rate // 15
        length = 60 * rate - skipped
        if number < length:
            break
        number -= length
        minute += 1
    second, frame = divmod(number + skipped, rate)
    return f"{minute // 60:02}:{minute % 60:02}:{second:02};{frame:02}"


def weights(count: int, seed: int = 1) -> npt.NDArray[np.float64]:
    """(count, 61), weights that move smoothly, and angles."""
    phases = np.random.default_rng(seed).random(len(NAMES)) * 6
    return np.round(0.5 + 0.4 * np.sin(np.arange(count)[:, None] * 0.13 + phases), 10)


def table(
    path: Path,
    codes: list[str],
    values: npt.NDArray[np.float64] | None = None,
    names: tuple[str, ...] = NAMES,
    end: str = "\n",
) -> Path:
    values = weights(len(codes)) if values is None else values
    lines = [",".join(("Timecode", "BlendShapeCount", *names))]
    lines += [
        f"{code},61," + ",".join(f"{value:.10f}" for value in row)
        for code, row in zip(codes, values, strict=True)
    ]
    path.write_bytes((end.join(lines) + end).encode())
    return path


def app_table(path: Path, count: int = 150, fps: float = 60.0, start: float = 44879.9) -> Path:
    return table(path, [app_code(start + i / fps) for i in range(count)])


def edit(path: Path, change: Any) -> Path:
    lines = path.read_text().split("\n")
    change(lines)
    path.write_text("\n".join(lines))
    return path


def error_of(path: Path) -> str:
    with pytest.raises(LipwrightError) as caught:
        read_arkit(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message.removeprefix(f"{path}: ")


def note_of(recording: ArkitRecording) -> str:
    return "; ".join(recording.notes)


# --- Live Link Face ---


def test_the_apps_table_is_read_as_it_stands(tmp_path: Path) -> None:
    recording = read_arkit(app_table(tmp_path / "a.csv"))
    assert recording.fps == 60
    assert recording.timecode == app_code(44879.9)
    assert recording.source == "Live Link Face CSV, time code of 60 frames a second"
    assert recording.notes == ()
    assert np.abs(recording.times - 44879.9 - np.arange(150) / 60).max() < 1e-4
    assert np.array_equal(recording.values, weights(150)[:, :52].astype(np.float32))
    assert recording.angles is not None
    assert np.array_equal(recording.angles, weights(150)[:, 52:].astype(np.float32))


def test_a_phone_at_30_writes_every_second_code_of_60(tmp_path: Path) -> None:
    # With a clock that runs a little off the time code, as the app's does.
    path = table(tmp_path / "a.csv", [app_code(44867.78 + i / 30.006) for i in range(200)])
    recording = read_arkit(path)
    assert recording.fps == 30
    assert "of 60 frames" in recording.source
    assert np.diff(recording.times).mean() == pytest.approx(1 / 30.006, abs=1e-5)


@pytest.mark.parametrize("fps", [15, 23.976, 24, 25, 29.97, 30, 48, 50, 59, 59.94, 60, 90, 120])
def test_our_export_comes_back(tmp_path: Path, fps: float) -> None:
    clip = Clip(ARKIT, fps, weights(round(fps * 2.5))[:, :52].astype(np.float32))
    export_clip(tmp_path / "a.livelink.csv", clip)
    recording = read_arkit(tmp_path / "a.livelink.csv")
    assert recording.fps == pytest.approx(fps, rel=2e-5)
    assert np.abs(recording.times - clip.times).max() < 1e-4
    assert np.abs(recording.values - clip.values).max() < 1e-6
    motion = to_motion(recording, fps=None)
    assert len(motion) == len(clip)
    assert motion.valid.all()
    assert np.abs(motion.arkit - clip.values).max() < 2e-3


@pytest.mark.parametrize("suffix", [".csv", ".json"])
def test_our_other_tables_come_back(tmp_path: Path, suffix: str) -> None:
    clip = Clip(ARKIT, 25, weights(60)[:, :52].astype(np.float32))
    export_clip(tmp_path / f"a{suffix}", clip)
    recording = read_arkit(tmp_path / f"a{suffix}")
    assert recording.fps == 25
    assert np.abs(recording.times - clip.times).max() < 1e-6
    assert np.abs(recording.values - clip.values).max() < 1e-5


@pytest.mark.parametrize("base", [24, 25, 30, 48, 50, 60, 100])
def test_codes_of_frames_tell_their_rate_at_the_turn_of_a_second(base: int) -> None:
    places = [f"{i // base // 60:02}:{i // base % 60:02}:{i % base:02}" for i in range(3 * base)]
    codes = [parse_timecode("a", "line 2", f"10:{code}") for code in places]
    clock = codes_to_clock(codes)
    assert clock.layout == f"{base} frames a second"
    assert not clock.assumed
    assert np.abs(np.diff(clock.times) - 1 / base).max() < 1e-9


def test_a_missing_frame_at_a_turn_of_a_second_does_not_change_the_rate() -> None:
    times = [i / 24 for i in range(24 * 6) if i not in {24, 71}]
    clock = codes_to_clock([parse_timecode("a", "", app_code(t, 24)) for t in times])
    assert clock.layout == "24 frames a second"
    assert np.abs(clock.times - times).max() < 1e-4


def test_a_second_without_a_turn_is_of_the_apps_rate_and_says_so(tmp_path: Path) -> None:
    path = table(tmp_path / "a.csv", [f"10:00:00:{i:02}.000" for i in range(20)])
    recording = read_arkit(path)
    assert recording.fps == 60
    assert "taken as 60 frames a second" in note_of(recording)
    known = read_arkit(path, timecode_fps=25)
    assert known.fps == 25
    assert known.notes == ()


@pytest.mark.parametrize("rate", [30, 60])
def test_drop_frame_codes_keep_real_time(tmp_path: Path, rate: int) -> None:
    # Over the first minute, which skips codes.
    numbers = range(59 * rate, 61 * rate)
    path = table(tmp_path / "a.csv", [drop_frame_code(n, rate) for n in numbers])
    recording = read_arkit(path)
    assert recording.fps == pytest.approx(rate * 1000 / 1001)
    assert "drop-frame" in recording.source
    expected = np.array(numbers) * 1001 / (1000 * rate)
    assert np.abs(recording.times - expected).max() < 1e-6


@pytest.mark.parametrize("mark", [".", ":", ","])
def test_milliseconds_are_told_from_frames(tmp_path: Path, mark: str) -> None:
    times = 7.9 + np.arange(30) / 60  # also the codes below 60 ms
    codes = [millisecond_code(time, mark) for time in times]
    path = table(tmp_path / "a.csv", [f'"{code}"' for code in codes])
    recording = read_arkit(path)
    assert recording.fps == 60
    assert recording.source == "Live Link Face CSV, time code of milliseconds"
    assert np.abs(recording.times - times).max() < 0.00051


def test_midnight_is_passed(tmp_path: Path) -> None:
    recording = read_arkit(app_table(tmp_path / "a.csv", start=86399.0))
    assert recording.times[-1] == pytest.approx(86399 + 149 / 60, abs=1e-4)
    assert recording.notes == ()
    assert to_motion(recording).valid.all()


def test_rows_without_a_face_are_lost_not_zero(tmp_path: Path) -> None:
    def lose(lines: list[str]) -> None:
        lines[11] = lines[11].split(",")[0] + ",0"
        lines[12] = lines[12].split(",")[0] + ",0" + ",0.0" * 61
        lines[13] = ",".join([*lines[13].split(",")[:2], *[""] * 61])

    recording = read_arkit(edit(app_table(tmp_path / "a.csv"), lose))
    assert np.flatnonzero(~recording.valid).tolist() == [10, 11, 12]
    assert np.isnan(recording.values[10:13]).all()
    assert "3 frames without a face" in note_of(recording)
    motion = to_motion(recording, fps=None)
    assert np.flatnonzero(motion.flags & Flag.LOST).tolist() == [10, 11, 12]


def test_line_ends_marks_order_and_spelling_of_the_header_do_not_matter(tmp_path: Path) -> None:
    plain = read_arkit(app_table(tmp_path / "a.csv"))
    order = np.random.default_rng(3).permutation(len(NAMES))
    names = tuple(NAMES[i][0].lower() + NAMES[i][1:] for i in order)
    codes = [app_code(44879.9 + i / 60) for i in range(150)]
    path = table(tmp_path / "b.csv", codes, weights(150)[:, order], names, end="\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    other = read_arkit(path)
    assert is_live_link(path)
    assert np.array_equal(other.values, plain.values)
    assert np.array_equal(other.times, plain.times)
    assert plain.angles is not None
    assert other.angles is not None
    assert np.array_equal(other.angles, plain.angles)


def test_an_old_table_without_angles_and_a_table_of_excel_are_read(tmp_path: Path) -> None:
    codes = [app_code(1 + i / 60) for i in range(100)]
    old = read_arkit(table(tmp_path / "a.csv", codes, weights(100)[:, :52], NAMES[:52]))
    assert old.angles is None
    text = (tmp_path / "a.csv").read_text().replace(",", ";").replace("0.", "0,")
    (tmp_path / "b.csv").write_text(text)
    assert is_live_link(tmp_path / "b.csv")
    assert np.array_equal(read_arkit(tmp_path / "b.csv").values, old.values)


def test_a_cut_last_line_is_left_out(tmp_path: Path) -> None:
    path = app_table(tmp_path / "a.csv")
    whole = path.read_bytes()
    last = whole.rindex(b"\n", 0, -1) + 1
    for length in (last + 3, last + 14, last + 300, len(whole) - 13):
        path.write_bytes(whole[:length])
        recording = read_arkit(path)
        assert len(recording) == 149
        assert "the last line (151) is cut" in note_of(recording)


def test_repeated_and_misplaced_rows_are_put_right(tmp_path: Path) -> None:
    def shuffle(lines: list[str]) -> None:
        lines.insert(20, lines[20])
        lines[50], lines[51] = lines[51], lines[50]

    recording = read_arkit(edit(app_table(tmp_path / "a.csv"), shuffle))
    assert np.array_equal(recording.values, weights(150)[:, :52].astype(np.float32))
    assert "1 frame out of order" in note_of(recording)
    assert "1 frame with a repeated time" in note_of(recording)


def test_of_a_repeated_time_the_row_with_a_face_counts(tmp_path: Path) -> None:
    def repeat(lines: list[str]) -> None:
        lines.insert(20, lines[20].split(",")[0] + ",0")

    recording = read_arkit(edit(app_table(tmp_path / "a.csv"), repeat))
    assert recording.valid.all()
    assert len(recording) == 150


def test_values_are_clamped_and_counted_and_percent_is_noticed(tmp_path: Path) -> None:
    values = weights(100)
    values[3, JAW], values[4, JAW] = 1.02, -0.3
    codes = [app_code(1 + i / 60) for i in range(100)]
    recording = read_arkit(table(tmp_path / "a.csv", codes, values))
    assert recording.values[3, JAW] == 1
    assert recording.values[4, JAW] == 0
    assert note_of(recording) == "2 values outside 0 to 1, clamped"
    percent = weights(100) * ([100] * 52 + [1] * 9)
    recording = read_arkit(table(tmp_path / "a.csv", codes, percent))
    assert np.abs(recording.values - weights(100)[:, :52]).max() < 1e-6
    assert note_of(recording) == "weights in percent, divided by 100"


def test_angles_in_degrees_become_radians(tmp_path: Path) -> None:
    values = weights(100)
    values[:, 52:] *= 30
    recording = read_arkit(
        table(tmp_path / "a.csv", [app_code(1 + i / 60) for i in range(100)], values)
    )
    assert recording.angles is not None
    assert np.abs(recording.angles - np.radians(values[:, 52:])).max() < 1e-5


def set_cell(line: int, column: int, cell: str) -> Any:
    def change(lines: list[str]) -> None:
        cells = lines[line - 1].split(",")
        cells[column] = cell
        lines[line - 1] = ",".join(cells)

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (set_cell(9, 19, "open"), "line 9: JawOpen is 'open', not a number"),
        (set_cell(9, 19, "inf"), "line 9: JawOpen is 'inf', not a number"),
        (set_cell(9, 19, "0_1"), "line 9: JawOpen is '0_1', not a number"),
        (set_cell(9, 19, "7.5"), "line 9: jawOpen is 7.5, no weight from 0 to 1"),
        (set_cell(9, 0, "noon"), "line 9: the time code is 'noon', not HH:MM:SS:FF"),
        (set_cell(9, 0, "25:00:00:00"), "line 9: the time code is '25:00:00:00', no time of a day"),
        (set_cell(9, 0, "12:00:00:00"), "line 9: the time goes back by 1680."),
        (set_cell(80, 0, "13:00:00:00"), "line 81: the time goes back by"),
        (lambda lines: lines.__setitem__(8, "12:28:00:00,61,0.5"), "line 9: 3 columns, not 63"),
        (lambda lines: lines.__setitem__(8, lines[8] + ",1"), "line 9: 64 columns, not 63"),
        (lambda lines: lines.__delitem__(0), "line 1: no column 'Timecode'"),
        (set_cell(1, 5, "JawOpen"), "'JawOpen' and 'JawOpen' are the same control"),
        (lambda lines: lines.__delitem__(slice(2, None)), "has 1 frame with a time of its own"),
        (lambda lines: lines.__delitem__(slice(1, None)), "has a header and no frames"),
        (lambda lines: lines.clear(), "is empty"),
    ],
)
def test_what_is_wrong_in_a_table_is_named(tmp_path: Path, change: Any, message: str) -> None:
    assert error_of(edit(app_table(tmp_path / "a.csv"), change)).startswith(message)


def test_a_recording_needs_arkits_names_a_face_and_a_rate(tmp_path: Path) -> None:
    codes = [app_code(1 + i / 60) for i in range(100)]
    few = table(tmp_path / "a.csv", codes, weights(100)[:, :9], NAMES[:9])
    assert error_of(few).startswith("9 of ARKit's 52 names are there, fewer than 10")
    path = tmp_path / "b.csv"
    path.write_text("\n".join([few.read_text().split("\n")[0], *(f"{c},0" for c in codes)]))
    assert "fewer than 10" in error_of(path)
    faceless = edit(
        app_table(tmp_path / "c.csv", 20),
        lambda lines: lines.__setitem__(slice(1, 21), [f"{c},0" for c in codes[:20]]),
    )
    assert error_of(faceless).startswith("no frame has a face")
    slow = app_table(tmp_path / "d.csv", fps=2)
    assert error_of(slow).startswith("2 frames a second are too few for speech")
    long = table(tmp_path / "e.csv", [*codes, *(app_code(80 + i / 60) for i in range(100))])
    assert error_of(long).startswith("line 102: 77.3 s without a frame before it")
    assert error_of(tmp_path / "missing.csv").startswith("no such file")
    assert "name a .csv or .json file" in error_of(tmp_path / "a.txt")


def test_unknown_and_missing_names_are_noted(tmp_path: Path) -> None:
    names = ("Frown", *NAMES[1:])
    codes = [app_code(1 + i / 60) for i in range(100)]
    recording = read_arkit(table(tmp_path / "a.csv", codes, names=names))
    assert not recording.values[:, 0].any()
    assert "missing and left at rest: eyeBlinkLeft" in note_of(recording)
    assert "unknown and left out: Frown" in note_of(recording)


@pytest.mark.parametrize(
    ("spelling", "name"),
    [
        ("eyeBlink_L", "eyeBlinkLeft"),
        ("EYEBLINKRIGHT", "eyeBlinkRight"),
        ("mouthSmile_R", "mouthSmileRight"),
        ("blendShape1.JawOpen", "jawOpen"),
        ("jaw_open", "jawOpen"),
        ("Mouth-Left", "mouthLeft"),
    ],
)
def test_spellings_of_apps_are_known(spelling: str, name: str) -> None:
    assert control_column(spelling) == ARKIT.index(name)


def test_every_name_is_known_by_its_own_and_only_once() -> None:
    assert [control_column(name) for name in ARKIT + ANGLES] == list(range(61))
    short = [name.replace("Left", "_L").replace("Right", "_R") for name in ARKIT]
    assert [control_column(name) for name in short] == list(range(52))


# --- JSON ---


def write_json(path: Path, content: Any) -> Path:
    path.write_text(json.dumps(content))
    return path


def audio2face(count: int = 40) -> dict[str, Any]:
    return {
        "exportFps": 60.0,
        "trackPath": "speech.wav",
        "numPoses": 52,
        "numFrames": count,
        "facsNames": list(ARKIT),
        "weightMat": weights(count)[:, :52].tolist(),
    }


def frames(count: int = 40, scale: float = 1.0, origin: float = 0.0) -> list[dict[str, Any]]:
    return [
        {
            "timestamp": origin + i / 60 * scale,
            "blendShapes": dict(zip(ARKIT, row[:52].tolist(), strict=True)),
        }
        for i, row in enumerate(weights(count))
    ]


def assert_same(recording: ArkitRecording, count: int = 40) -> None:
    assert recording.fps == 60
    assert np.abs(recording.values - weights(count)[:, :52]).max() < 1e-6
    assert np.abs(recording.times - recording.times[0] - np.arange(count) / 60).max() < 1e-3


def test_audio2face_is_read(tmp_path: Path) -> None:
    recording = read_arkit(write_json(tmp_path / "a.json", audio2face()))
    assert_same(recording)
    assert recording.source == "Audio2Face JSON, 60 frames a second"
    assert recording.notes == ()


@pytest.mark.parametrize(
    ("scale", "origin", "unit"),
    [
        (1, 0, "seconds"),
        (1, 1700000000, "seconds"),
        (1e3, 5000, "milliseconds"),
        (1e6, 0, "microseconds"),
        (1e9, 1.7e18, "nanoseconds"),
    ],
)
def test_frames_with_times_of_any_unit(
    tmp_path: Path, scale: float, origin: float, unit: str
) -> None:
    recording = read_arkit(write_json(tmp_path / "a.json", frames(40, scale, origin)))
    assert_same(recording)
    assert recording.source == f"JSON of frames, times in {unit}"
    assert (recording.notes == ()) == (unit == "seconds")


@pytest.mark.parametrize("number", range(8))
def test_layouts_of_frames(tmp_path: Path, number: int) -> None:
    short = [name.replace("Left", "_L").replace("Right", "_R") for name in ARKIT]
    rows = weights(40)[:, :52].tolist()
    pairs = [
        [{"categoryName": name, "score": v} for name, v in zip(ARKIT, row, strict=True)]
        for row in rows
    ]
    named = [dict(zip(short, row, strict=True)) for row in rows]
    content: list[Any] = [
        {"names": ARKIT, "frames": [{"time": i / 60, "weights": r} for i, r in enumerate(rows)]},
        {"fps": 60, "frames": [{"frame": i, "blendshapes": w} for i, w in enumerate(named)]},
        {"frameRate": 60, "data": [{"weights": w} for w in named]},
        [{"timestamp_ms": round(i / 0.06), "faces": 1, **w} for i, w in enumerate(named)],
        [{"t": i / 60, "blendshapes": p} for i, p in enumerate(pairs)],
        [{"timecode": app_code(59.9 + i / 60), "blendShapes": w} for i, w in enumerate(named)],
        {"blend_shape_keys": ARKIT, "blend_shape_values": rows, "fps": 60},
        {"names": short, "values": rows, "timestamps": [i / 60 for i in range(40)]},
    ]
    assert_same(read_arkit(write_json(tmp_path / "a.json", content[number])))


def test_json_without_a_face_is_lost(tmp_path: Path) -> None:
    content = frames()
    content[5]["blendShapes"] = None
    content[6]["blendShapes"] = {}
    content[7]["isTracked"] = False
    recording = read_arkit(write_json(tmp_path / "a.json", content))
    assert np.flatnonzero(~recording.valid).tolist() == [5, 6, 7]


def test_json_angles_and_missing_frames(tmp_path: Path) -> None:
    rows = weights(40).tolist()
    kept = [i for i in range(40) if i not in {10, 11, 12}]
    content = {"names": NAMES, "frames": [{"time": i / 60, "weights": rows[i]} for i in kept]}
    recording = read_arkit(write_json(tmp_path / "a.json", content))
    assert recording.angles is not None
    assert len(recording) == 37
    motion = to_motion(recording, fps=None)
    assert np.flatnonzero(motion.flags & Flag.DROPPED).tolist() == [10, 11, 12]


def broken(**fields: Any) -> str:
    return json.dumps({**audio2face(), **fields})


def broken_frame(**fields: Any) -> str:
    content = frames()
    content[7].update(fields)
    return json.dumps(content)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1, column 1: not JSON"),
        ('{"fps": 30,\n}', "line 2, column 1: not JSON"),
        ("[" * 100000, "nested too deeply"),
        ("[" + "9" * 5000 + "]", "nested too deeply or a number too long"),
        ("3", "has neither names with rows"),
        ("{}", "has neither names with rows"),
        ("[]", "has neither names with rows"),
        ("[[1, 2]]", "frame 0 is '[1, 2]', not an object"),
        ('[{"timestamp": 1}, {"timestamp": 2}]', "0 of ARKit's 52 names"),
        (broken(exportFps="fast"), "the rate is 'fast', not a number"),
        (broken(exportFps=None), "neither 'fps' nor 'times'"),
        (broken(facsNames=["a"] * 52), "0 of ARKit's 52 names"),
        (broken(weightMat=[[0.1] * 52, [0.1] * 51]), "frame 1 has 51 weights, not one for each"),
        (broken(weightMat=[[0.1] * 52, ["x"] * 52]), "frame 1: eyeBlinkLeft is 'x', not a number"),
        (broken(weightMat=[[0.1] * 52, [None] * 52]), "frame 1: eyeBlinkLeft is 'None', not a"),
        (broken(weightMat=[[0.1] * 52, [np.nan] * 52]), "frame 1: eyeBlinkLeft is 'nan', not a"),
        (broken(weightMat=[[0.1] * 52, [10**400] * 52]), "frame 1: eyeBlinkLeft is '1000"),
        (broken(weightMat=[[0.1] * 52, [1e300] * 52]), "frame 1: eyeBlinkLeft is 1e+300, no weigh"),
        (broken_frame(timestamp="late"), "frame 7: the time is 'late', not a number"),
        (broken_frame(timestamp=None), "frame 7: the time is 'None', not a number"),
        (broken_frame(timestamp=1e30), "frame 7: the time is '1e+30', not a number"),
        (broken_frame(blendShapes="none"), "frame 7: its weights are 'none'"),
        (broken_frame(blendShapes=[1, 2]), "frame 7: its weights are a list without names"),
        (broken_frame(blendShapes=[{"x": 1}]), "frame 7: the weight \"{'x': 1}\" has no name"),
        (broken_frame(blendShapes={"jawOpen": "a"}), "frame 7: jawOpen is 'a', not a number"),
        (broken_frame(blendShapes={"jawOpen": True}), "frame 7: jawOpen is 'True', not a number"),
        (broken_frame(timestamp=-5), "frame 7: the time goes"),
    ],
)
def test_what_is_wrong_in_json_is_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "a.json"
    path.write_text(text)
    assert error_of(path).startswith(message)


# --- motion ---


def recording_at(
    numbers: list[int], fps: float = 60.0, lost: tuple[int, ...] = ()
) -> ArkitRecording:
    """Frames with the given numbers; each weight is a hundredth of its frame's number."""
    values = np.repeat(np.array(numbers)[:, None] / 100, 52, axis=1)
    values[[numbers.index(number) for number in lost]] = np.nan
    return ArkitRecording(fps, np.array(numbers) / fps, values.astype(np.float32))


def test_from_60_to_30_is_linear_as_in_the_thesis() -> None:
    motion = to_motion(recording_at(list(range(40))))
    assert motion.fps == 30
    assert len(motion) == 20
    # Frame i of 30 is midway between the frames 2i and 2i + 1 of 60.
    assert np.abs(motion.arkit[:, 0] - (np.arange(20) * 2 + 0.5) / 100).max() < 1e-6
    assert not motion.flags.any()


def test_the_phones_own_rate_changes_nothing() -> None:
    recording = recording_at(list(range(40)))
    motion = to_motion(recording, fps=None)
    assert motion.fps == 60
    assert np.abs(motion.arkit - recording.values).max() < 1e-6


def test_gaps_are_dropped_and_not_filled() -> None:
    numbers = [n for n in range(40) if n not in {8, 20, 21, 22, 23}]
    motion = to_motion(recording_at(numbers), fps=None)
    assert np.flatnonzero(motion.flags).tolist() == [8, 20, 21, 22, 23]
    assert set(motion.flags[motion.flags > 0]) == {int(Flag.DROPPED)}
    assert np.isnan(motion.arkit[motion.flags > 0]).all()
    assert np.abs(motion.arkit[motion.valid, 0] - np.array(numbers) / 100).max() < 1e-6
    half = to_motion(recording_at(numbers))
    assert np.flatnonzero(half.flags & Flag.DROPPED).tolist() == [4, 10, 11]


def test_lost_frames_stay_lost_and_do_not_spread() -> None:
    motion = to_motion(recording_at(list(range(40)), lost=(8, 9, 20)), fps=None)
    assert np.flatnonzero(motion.flags).tolist() == [8, 9, 20]
    assert set(motion.flags[motion.flags > 0]) == {int(Flag.LOST)}
    half = to_motion(recording_at(list(range(40)), lost=(8, 9, 20)))
    assert np.flatnonzero(half.flags).tolist() == [4, 10]


def test_shut_eyes_are_marked() -> None:
    recording = recording_at(list(range(60)))
    motion = to_motion(recording, fps=None)
    assert np.flatnonzero(motion.flags & Flag.BLINK).tolist() == list(range(51, 60))


def test_a_rate_out_of_range_is_refused() -> None:
    with pytest.raises(ValueError, match="fps is 0"):
        to_motion(recording_at([0, 1]), fps=0)


@given(
    numbers=st.sets(st.integers(0, 120), min_size=2).map(sorted),
    jitter=st.floats(0, 0.2),
    fps=st.sampled_from([None, 24.0, 30.0, 60.0, 100.0]),
    lost=st.sets(st.integers(0, 120)),
)
@settings(deadline=None)
def test_a_motion_never_goes_beyond_its_neighbours(
    numbers: list[int], jitter: float, fps: float | None, lost: set[int]
) -> None:
    seen = [n for n in numbers if n not in lost]
    if not seen:
        return
    recording = recording_at(numbers, lost=tuple(set(numbers) & lost))
    shaken = recording.times + jitter / 60 * np.sin(np.arange(len(numbers)))
    motion = to_motion(ArkitRecording(60.0, shaken, recording.values), fps)
    assert len(motion) == max(round((shaken[-1] - shaken[0] + 1 / 60) * motion.fps), 1)
    good = motion.arkit[motion.valid, 0]
    assert (good >= np.float32(min(seen) / 100) - 1e-6).all()
    assert (good <= np.float32(max(seen) / 100) + 1e-6).all()
    times = (np.flatnonzero(motion.valid) + 0.5) / motion.fps
    rows = (np.array(seen) - numbers[0]) / 60 + 0.5 / 60
    for time in times:  # a frame of the phone is near every frame that has weights
        assert np.abs(rows - time).min() < (0.75 + 2 * jitter + 0.5) / 60
    assert all(a <= b + 1e-6 for a, b in pairwise(good.tolist()))  # the numbers rise


# --- folders ---


def test_takes_are_told_by_their_header_and_counted_once(tmp_path: Path) -> None:
    for name in ("A_1_iPhone_cal", "A_1_iPhone_raw", "A_2_iPhone", "A_2_iPhone_raw", "B_raw"):
        app_table(tmp_path / f"{name}.csv", 3)
    app_table(tmp_path / "A_1_iPhone_neutral.csv", 1)
    (tmp_path / "frame_log.csv").write_text("kind,index\nV,0\n")
    (tmp_path / "binary.csv").write_bytes(bytes(range(256)))
    (tmp_path / "empty.csv").write_text("")
    found = [path.name for path in find_takes(tmp_path.iterdir())]
    assert found == ["A_1_iPhone_cal.csv", "A_2_iPhone.csv", "B_raw.csv"]
    assert take_stem(found[0]) == "A_1_iPhone"
    assert not is_live_link(tmp_path / "frame_log.csv")
    assert not is_live_link(tmp_path / "missing.csv")
    assert not is_live_link(tmp_path)


@pytest.mark.parametrize(
    ("recording", "sound", "found"),
    [
        ("A_1_iPhone.csv", ["A_1_iPhone.mov"], "A_1_iPhone.mov"),
        ("A_1_iPhone_cal.csv", ["A_1_iPhone.MOV"], "A_1_iPhone.MOV"),
        ("A_1_iPhone_raw.csv", ["A_1.mov"], "A_1.mov"),
        ("A_1_Evans_Iphone.csv", ["A_1_Evans.mov"], "A_1_Evans.mov"),
        ("A.csv", ["A.mov", "A.wav"], "A.wav"),
        ("talk.livelink.csv", ["talk.wav"], "talk.wav"),
        ("A.json", ["A.flac", "B.wav"], "A.flac"),
        ("A_1.csv", ["A.wav"], None),
        ("A.csv", ["A.txt", "AB.wav"], None),
    ],
)
def test_sound_is_found_beside(
    tmp_path: Path, recording: str, sound: list[str], found: str | None
) -> None:
    for name in (recording, *sound):
        (tmp_path / name).touch()
    expected = None if found is None else tmp_path / found
    assert find_sound(tmp_path / recording) == expected


def test_all_sounds_of_a_take_are_found_the_best_first(tmp_path: Path) -> None:
    for name in ("A_1.wav", "A_1_iPhone.mov", "A_1_iPhone.wav", "A_2.wav", "A_1_iPhone_cal.csv"):
        (tmp_path / name).touch()
    found = [path.name for path in sounds_beside(tmp_path / "A_1_iPhone_cal.csv")]
    assert found == ["A_1_iPhone.wav", "A_1_iPhone.mov", "A_1.wav"]
    assert take_names("A_1_iPhone_cal.csv") == ("A_1_iPhone_cal", "A_1_iPhone", "A_1")


def test_sound_of_a_recording_in_no_folder_is_none(tmp_path: Path) -> None:
    assert find_sound(tmp_path / "gone" / "a.csv") is None


# --- anything at all ---

CELLS = st.sampled_from(
    ["0", "1", "61", "0.5", "-0.1", "", "nan", "inf", "x", '"', "1e400", "10:00:00:01", "9:9:9.5",
     "10:00:01;59.5", "10:00:00:999", "23:59:59:59", "00:00:00:00", "Timecode", "time", "ü", "\0"]
)  # fmt: skip


def read_or_refuse(path: Path) -> None:
    """Nothing but an error for the user may come out."""
    with suppress(LipwrightError):
        to_motion(read_arkit(path))


@given(rows=st.lists(st.lists(CELLS, max_size=70), max_size=6), cut=st.integers(0, 40))
@IN_FOLDER
def test_any_table_is_read_or_refused(tmp_path: Path, rows: list[list[str]], cut: int) -> None:
    path = app_table(tmp_path / "a.csv", 5)
    text = path.read_text() + "\n".join(",".join(row) for row in rows)
    path.write_text(text[: len(text) - cut])
    read_or_refuse(path)


@given(codes=st.lists(CELLS | st.text("0123456789:;.,", max_size=13), min_size=1, max_size=8))
@IN_FOLDER
def test_any_times_are_read_or_refused(tmp_path: Path, codes: list[str]) -> None:
    path = table(tmp_path / "a.csv", codes)
    read_or_refuse(path)


@given(content=st.binary(max_size=300), suffix=st.sampled_from([".csv", ".json"]))
@IN_FOLDER
def test_any_bytes_are_read_or_refused(tmp_path: Path, content: bytes, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_bytes(content)
    with pytest.raises(LipwrightError):
        read_arkit(path)


KEYS = st.sampled_from(
    ["timestamp", "time", "frame", "fps", "facsNames", "names", "weightMat", "frames", "values",
     "blendShapes", "weights", "format", "version", "isTracked", "jawOpen", "x"]
)  # fmt: skip
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.sampled_from([*ARKIT, "", "x"]),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(KEYS, inner, max_size=4)
        | st.just(list(ARKIT))
        | st.just(dict.fromkeys(ARKIT, 0.2))
        | st.lists(
            st.fixed_dictionaries(
                {"time": inner, "blendShapes": st.just(dict.fromkeys(ARKIT, 0.2))}
            ),
            max_size=4,
        )
    ),
    max_leaves=12,
)


ODD: st.SearchStrategy[Any] = st.sampled_from(
    [None, True, 0, -1, 1e308, 9e18, 10**300, float("nan"), float("inf"), "", "x", "1",
     "10:00:00:01.5", [], {}, [1], {"a": 1}, [[]], 0.5, 2, 1e5]
)  # fmt: skip


@given(data=st.data(), kind=st.integers(0, 2))
@IN_FOLDER
def test_any_change_of_json_is_read_or_refused(
    tmp_path: Path, data: st.DataObject, kind: int
) -> None:
    rows = weights(6).tolist()
    layouts: list[Any] = [
        audio2face(6),
        frames(6),
        {"names": [*NAMES], "frames": [{"time": i / 60, "weights": r} for i, r in enumerate(rows)]},
    ]
    content = place = layouts[kind]
    for _ in range(data.draw(st.integers(0, 3))):
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        key = data.draw(st.sampled_from(keys))
        if not isinstance(place[key], dict | list):
            break
        place = place[key]
    keys = list(place) if isinstance(place, dict) else list(range(len(place)))
    place[data.draw(st.sampled_from(keys))] = data.draw(ODD)
    read_or_refuse(write_json(tmp_path / "a.json", content))


@given(content=VALUES)
@IN_FOLDER
def test_any_json_is_read_or_refused(tmp_path: Path, content: Any) -> None:
    path = write_json(tmp_path / "a.json", content)
    read_or_refuse(path)
