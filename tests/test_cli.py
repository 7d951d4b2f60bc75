"""The command line as users and programs meet it: whole processes on real files."""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from lipwright.audio import Audio, read_audio, write_wav
from lipwright.cli import run as run_here
from lipwright.errors import LipwrightError
from lipwright.formats import read_track, write_track
from lipwright.pipeline import animate
from lipwright.track import PhoneTrack

EXAMPLES = Path(__file__).parents[1] / "examples"
HELLO = EXAMPLES / "hello.flac"
HELLO_TEXT = EXAMPLES / "hello.txt"


@dataclass(frozen=True)
class Finished:
    """How a command ended."""

    returncode: int
    stdout: bytes
    stderr: bytes


def in_process_of_its_own(*arguments: object, stdin: bytes = b"") -> Finished:
    """Run the command line as a shell would."""
    run = subprocess.run(
        [sys.executable, "-m", "lipwright", *map(str, arguments)],
        input=stdin, capture_output=True, check=False, timeout=300,
    )  # fmt: skip
    return Finished(run.returncode, run.stdout, run.stderr)


def lipwright(*arguments: object, cwd: Path | None = None, **environment: str) -> Finished:
    """Run the command line here, since starting a process for each refusal takes a second."""
    out, errors = io.StringIO(), io.StringIO()
    before = signal.getsignal(signal.SIGTERM)
    with (
        contextlib.chdir(cwd or Path.cwd()),
        mock.patch.dict(os.environ, environment),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(errors),
    ):
        try:
            status = run_here([str(argument) for argument in arguments])
        finally:
            signal.signal(signal.SIGTERM, before)
    return Finished(status, out.getvalue().encode(), errors.getvalue().encode())


def assert_refused(run: Finished, *needles: str) -> None:
    """One clear line on standard error, status 2, no traceback."""
    message = run.stderr.decode()
    assert run.returncode == 2, message
    assert message.startswith("lipwright: ")
    assert message.count("\n") == 1, message
    assert "Traceback" not in message
    for needle in needles:
        assert needle in message


@pytest.fixture
def track(tmp_path: Path) -> Path:
    """A TextGrid that covers hello.flac, made by hand."""
    path = tmp_path / "hello.TextGrid"
    duration = read_audio(HELLO).duration
    edges = np.array([0.0, 0.6, 0.7, 0.75, 0.84, 1.0, duration])
    write_track(path, PhoneTrack(("sil", "HH", "EH", "L", "OW", "sil"), edges))
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, aligned and animated once to three files."""
    folder = tmp_path_factory.mktemp("whole")
    run = lipwright("align", HELLO, "--text", HELLO_TEXT, "-o", "hello.TextGrid", cwd=folder)
    assert run.returncode == 0, run.stderr.decode()
    run = lipwright(
        "animate", HELLO, "--phones", "hello.TextGrid",
        "-o", "hello.csv", "-o", "hello.json", "-o", "hello.livelink.csv", cwd=folder,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr.decode()
    return folder


def test_align_then_animate_makes_every_named_file_and_says_what_it_did(whole: Path) -> None:
    assert sorted(path.name for path in whole.iterdir()) == [
        "hello.TextGrid", "hello.csv", "hello.json", "hello.livelink.csv",
    ]  # fmt: skip
    words = [word.text for word in read_track(whole / "hello.TextGrid").words]
    assert words[:4] == ["hello", "i", "am", "a"]
    assert words[-1] == "wish"


def test_animating_a_corrected_textgrid_uses_its_times_and_nothing_else(
    tmp_path: Path, track: Path
) -> None:
    run = lipwright("animate", HELLO, "--phones", track, "-o", tmp_path / "a.csv", "--fps", "50")
    assert run.returncode == 0, run.stderr.decode()
    table = np.genfromtxt(tmp_path / "a.csv", delimiter=",", names=True)
    jaw = table["jawOpen"]
    assert jaw[(table["time"] > 0.6) & (table["time"] < 1.0)].max() > 0.1
    assert jaw[table["time"] > 1.3].max() == 0  # the hand-made track is silent there


def test_text_and_its_alignment_give_the_same_motion(whole: Path, tmp_path: Path) -> None:
    run = lipwright("animate", HELLO, "--text", HELLO_TEXT, "-o", tmp_path / "a.csv")
    assert run.returncode == 0, run.stderr.decode()
    one = np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    other = np.loadtxt(whole / "hello.csv", delimiter=",", skiprows=1)
    # TextGrids keep times to a tenth of a millisecond or better.
    assert np.abs(one - other).max() < 0.02


def test_sound_through_a_pipe_and_curves_to_a_pipe(whole: Path) -> None:
    run = in_process_of_its_own(
        "animate", "-", "--phones", whole / "hello.TextGrid", "-o", "-", "--format", "csv",
        stdin=HELLO.read_bytes(),
    )  # fmt: skip
    assert run.returncode == 0, run.stderr.decode()
    assert run.stdout == (whole / "hello.csv").read_bytes()


def test_progress_json_prints_one_object_a_line_and_nothing_else(
    track: Path, tmp_path: Path
) -> None:
    run = lipwright(
        "animate", HELLO, "--phones", track, "-o", tmp_path / "a.csv", "--progress", "json"
    )
    rows = [json.loads(line) for line in run.stderr.decode().splitlines()]
    assert run.returncode == 0
    assert {row["stage"] for row in rows} == {"read", "animate"}
    assert all(0 <= row["done"] <= 1 for row in rows)


def test_words_that_do_not_fit_are_warned_about_with_time_and_score(tmp_path: Path) -> None:
    text = HELLO_TEXT.read_text().replace("numbers", "marmalade sandwiches")
    run = lipwright("animate", HELLO, "--text", text, "-o", tmp_path / "a.csv")
    assert run.returncode == 0, run.stderr.decode()
    warnings = [line for line in run.stderr.decode().splitlines() if line.startswith("warning")]
    assert any("marmalade" in line and " s (score " in line for line in warnings)


def test_speech_without_words_is_warned_about_with_its_time(tmp_path: Path) -> None:
    run = lipwright("align", HELLO, "--text", "hello", "-o", tmp_path / "a.TextGrid")
    assert run.returncode == 0, run.stderr.decode()
    assert b" s has no words" in run.stderr


@pytest.mark.parametrize("command", ["animate", "align"])
@pytest.mark.parametrize(
    ("name", "content", "needle"),
    [
        ("missing.wav", None, "no such file"),
        ("empty.wav", b"", "empty"),
        ("note.wav", b"this is not sound, whatever its name says" * 20, "not"),
    ],
)
def test_recordings_that_cannot_be_read_are_refused(
    command: str, name: str, content: bytes | None, needle: str, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    run = lipwright(command, name, "--text", "hello", "-o", "out.json", cwd=tmp_path)
    assert_refused(run, name, needle)
    assert not (tmp_path / "out.json").exists()


def test_a_folder_is_no_recording(tmp_path: Path) -> None:
    (tmp_path / "talk.wav").mkdir()
    assert_refused(
        lipwright("animate", "talk.wav", "--text", "hi", "-o", "a.csv", cwd=tmp_path),
        "talk.wav", "folder",
    )  # fmt: skip


def test_a_truncated_recording_is_refused(tmp_path: Path) -> None:
    (tmp_path / "cut.flac").write_bytes(HELLO.read_bytes()[:60_000])
    run = lipwright("animate", "cut.flac", "--text", HELLO_TEXT, "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "cut.flac")


@pytest.mark.parametrize("seconds", [0.0, 2.0])
def test_a_silent_or_empty_recording_is_refused(seconds: float, tmp_path: Path) -> None:
    write_wav(tmp_path / "quiet.wav", Audio(np.zeros(int(16000 * seconds), np.float32), 16000))
    run = lipwright("animate", "quiet.wav", "--text", "hello", "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "quiet.wav")
    assert not (tmp_path / "a.csv").exists()


@pytest.mark.parametrize(
    ("text", "needle"),
    [
        ("", "--text"),
        ("  ... !?", "--text"),
        ("Привет, как дела", "line 1"),
        ("你好", "line 1"),
        ("missing.txt", "no such file"),
        ("the quick brown fox jumps over the lazy dog while nobody is looking at it", "fit"),
    ],
)
def test_texts_that_cannot_be_used_are_refused(text: str, needle: str, tmp_path: Path) -> None:
    run = lipwright("animate", HELLO, "--text", text, "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, needle)
    assert not list(tmp_path.iterdir())


def test_a_text_file_that_is_not_text_is_refused_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "words.txt").write_bytes(b"hello\nthere \xff\xfe\xfa")
    run = lipwright("animate", HELLO, "--text", "words.txt", "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "words.txt", "line 2", "UTF-8")


@pytest.mark.parametrize("body", ["sil 0 1\n", "xmin = 0\nxmax = 1\n", "", "\0\0\0"])
def test_broken_phone_files_are_refused(body: str, tmp_path: Path) -> None:
    (tmp_path / "p.TextGrid").write_text(body)
    run = lipwright("animate", HELLO, "--phones", "p.TextGrid", "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "p.TextGrid")


def test_phones_past_the_end_of_the_sound_are_refused(tmp_path: Path) -> None:
    write_track(
        tmp_path / "late.TextGrid",
        PhoneTrack(("sil", "AA", "sil"), np.array([0.0, 50.0, 51.0, 60.0])),
    )
    run = lipwright("animate", HELLO, "--phones", "late.TextGrid", "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "late.TextGrid", "end")


@pytest.mark.parametrize(
    ("target", "needle"),
    [("a.fbx", ".glb"), ("a", ".csv"), ("none/a.csv", "none"), ("folder.csv", "folder")],
)
def test_targets_that_cannot_be_written_are_refused_before_the_work(
    target: str, needle: str, track: Path, tmp_path: Path
) -> None:
    (tmp_path / "folder.csv").mkdir()
    run = lipwright("animate", HELLO, "--phones", track, "-o", target, cwd=tmp_path)
    assert_refused(run, target, needle)


def test_a_full_disk_leaves_no_file_and_says_so(track: Path, tmp_path: Path) -> None:
    # A limit on file sizes fails as a full disk does: in the middle of writing.
    code = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000));"
        "from lipwright.cli import run; sys.exit(run(sys.argv[1:]))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, "animate", str(HELLO), "--phones", str(track), "-o", "a.csv"],
        cwd=tmp_path, capture_output=True, check=False, timeout=120,
    )  # fmt: skip
    assert_refused(Finished(run.returncode, run.stdout, run.stderr), "a.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["hello.TextGrid"]


@pytest.mark.parametrize(
    "arguments",
    [
        ("animate", HELLO),
        ("animate", HELLO, "-o", "a.wav"),
        ("animate", HELLO, "-o", "a.csv", "--listen", "closely"),
        ("animate", HELLO, "--text", "hi", "--phones", "p.TextGrid", "-o", "a.csv"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--engine", "magic"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--fps", "0"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--fps", "nan"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--intensity", "-1"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--intensity", "nan"),
        ("animate", HELLO, "--text", "hi", "-o", "a.mp4", "--size", "big"),
        ("animate", HELLO, "--text", "hi", "-o", "a.mp4", "--size", "511x512"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--language", "xx"),
        ("animate", HELLO, "--text", "hi", "-o", "a.csv", "--dictionary", "none.dict"),
        ("animate", "-", "--text", "-", "-o", "a.csv"),
        ("animate", HELLO, "--text", "hi", "-o", "-"),
        ("align", HELLO),
        ("align", HELLO, "-o", "a.csv"),
        ("head", "show", "a.png", "--set", "jawOpen"),
        ("head", "show", "a.png", "--set", "nose=1"),
        ("nothing",),
        ("animate", HELLO, "--unknown"),
    ],
)
def test_options_that_make_no_sense_are_refused(
    arguments: tuple[object, ...], tmp_path: Path
) -> None:
    assert_refused(lipwright(*arguments, cwd=tmp_path))
    assert not list(tmp_path.iterdir())


def test_the_recording_is_never_overwritten(tmp_path: Path) -> None:
    copy = tmp_path / "talk.mp4"
    copy.write_bytes(HELLO.read_bytes())
    run = lipwright("animate", "talk.mp4", "--text", "hi", "-o", "talk.mp4", cwd=tmp_path)
    assert_refused(run, "recording")
    assert copy.read_bytes() == HELLO.read_bytes()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_nothing_behind(number: int, tmp_path: Path) -> None:
    long = np.tile(read_audio(HELLO, 16000).samples, 12)
    write_wav(tmp_path / "long.wav", Audio(long, 16000))
    (tmp_path / "long.txt").write_text(" ".join([HELLO_TEXT.read_text()] * 12))
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "lipwright", "animate", "long.wav", "--text", "long.txt",
         "-o", "a.csv", "--progress", "json"],
        cwd=tmp_path, stderr=subprocess.PIPE, env={**os.environ, "TMPDIR": str(scratch)},
    )  # fmt: skip
    assert process.stderr is not None
    for line in process.stderr:
        if b'"align"' in line:
            break
    process.send_signal(number)
    _, rest = process.communicate(timeout=60)
    assert process.returncode == 1
    assert json.loads(rest.splitlines()[-1]) == {"error": "interrupted; nothing was written"}
    assert b"Traceback" not in rest
    assert sorted(path.name for path in tmp_path.iterdir()) == ["long.txt", "long.wav", "scratch"]
    assert not list(scratch.iterdir())


def test_help_of_every_command_ends_in_examples() -> None:
    for command in ("animate", "align", "phones", "formats", "doctor"):
        run = lipwright(command, "--help")
        assert run.returncode == 0
        assert b"Example" in run.stdout


def test_phones_lists_the_whole_table_as_text_and_json() -> None:
    from lipwright.phones import PHONES

    lines = lipwright("phones").stdout.decode().splitlines()
    assert [line.split()[0] for line in lines[1:]] == list(PHONES)
    table = json.loads(lipwright("phones", "--json").stdout)
    assert table["AA"]["ipa"] == "ɑ"


def test_formats_lists_every_registered_suffix() -> None:
    from lipwright.export import known_exports
    from lipwright.formats import known_formats

    out = lipwright("formats").stdout.decode()
    for suffix in (*known_formats(), *known_exports()):
        assert suffix in out


def test_doctor_names_each_part_and_the_command_for_a_missing_one(tmp_path: Path) -> None:
    run = lipwright("doctor", LIPWRIGHT_HOME=str(tmp_path / "empty"))
    assert run.returncode == 1  # the head is needed and not there
    assert b"lipwright head install" in run.stdout
    rows = json.loads(lipwright("doctor", "--json").stdout)
    assert rows["aligner"]["installed"]


def test_glb_without_the_head_says_how_to_install_it(track: Path, tmp_path: Path) -> None:
    run = lipwright(
        "animate", HELLO, "--phones", track, "-o", "a.glb", cwd=tmp_path,
        LIPWRIGHT_HOME=str(tmp_path / "empty"),
    )  # fmt: skip
    assert_refused(run, "lipwright head install")
    assert not (tmp_path / "a.glb").exists()


def test_a_missing_extra_gives_the_command_that_installs_it() -> None:
    code = (
        "import sys; sys.modules['mediapipe'] = None\n"
        "from lipwright.capture.tracker import Tracker\n"
        "from lipwright.errors import LipwrightError\n"
        "try:\n    Tracker()\nexcept LipwrightError as error:\n    print(error)\n"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout
    assert out.decode().strip() == (
        "the face tracker is not installed; run: pip install 'lipwright[capture]'"
    )


def test_output_that_nobody_reads_ends_without_a_traceback() -> None:
    process = subprocess.Popen(
        f"{sys.executable} -m lipwright phones --json | head -c 10",
        shell=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    _, errors = process.communicate(timeout=60)
    assert b"Traceback" not in errors


def test_a_missing_package_is_named_with_its_command_only_where_it_is_needed(
    tmp_path: Path, track: Path
) -> None:
    # The patch forgets what is imported under it, and soxr aborts where it is imported twice.
    importlib.import_module("soxr")
    with mock.patch.dict(sys.modules, {"moderngl": None, "av": None}):
        run = lipwright("animate", HELLO, "--phones", track, "-o", "a.csv", cwd=tmp_path)
        assert run.returncode == 0, run.stderr.decode()
        run = lipwright("animate", HELLO, "--phones", track, "-o", "a.mp4", cwd=tmp_path)
        assert_refused(run, "av", "pip install av")


@pytest.mark.parametrize("name", ["a" * 300 + ".csv", "a" * 300 + "/a.csv", "a" * 5000])
def test_names_that_are_too_long_are_refused(name: str, tmp_path: Path, track: Path) -> None:
    run = lipwright("animate", HELLO, "--phones", track, "-o", name, "-f", "csv", cwd=tmp_path)
    assert_refused(run, name)
    run = lipwright("animate", name, "--phones", track, "-o", "b.csv", cwd=tmp_path)
    assert_refused(run, name)


def test_an_output_never_takes_the_place_of_another_input(tmp_path: Path, track: Path) -> None:
    words, names = tmp_path / "words.lab", tmp_path / "names.ctm"
    words.write_text("hello", "utf-8")
    names.write_text("hello HH AH L OW", "utf-8")
    before = track.read_bytes()
    (tmp_path / "link.csv").symlink_to(track)
    for out in (track, tmp_path / "link.csv"):
        run = lipwright("animate", HELLO, "--phones", track, "-o", out, "-f", "csv")
        assert_refused(run, str(out), "is also read")
    assert track.read_bytes() == before
    for out in (words, names):
        run = lipwright("align", HELLO, "--text", words, "--dictionary", names, "-o", out)
        assert_refused(run, str(out), "is also read")


def test_two_outputs_may_not_be_one_file_or_one_pipe(tmp_path: Path, track: Path) -> None:
    (tmp_path / "link.csv").symlink_to("a.csv")
    run = lipwright(
        "animate", HELLO, "--phones", track, "-o", "a.csv", "-o", "link.csv", cwd=tmp_path
    )
    assert_refused(run, "link.csv", "two outputs")
    run = lipwright("animate", HELLO, "--phones", track, "-o", "-", "-o", "-", "-f", "csv")
    assert_refused(run, "standard output is named twice")


def test_devices_and_links_to_nowhere_are_refused_before_the_work(
    tmp_path: Path, track: Path
) -> None:
    (tmp_path / "link.csv").symlink_to("nowhere/a.csv")
    silence = tmp_path / "silence.wav"  # which would be refused later
    write_wav(silence, Audio(np.zeros(16000, np.float32), 16000))
    run = lipwright("align", silence, "--text", "hello", "-o", "/dev/null", "-f", "ctm")
    assert_refused(run, "/dev/null: is a device or pipe")
    run = lipwright("align", silence, "--text", "hello", "-o", tmp_path / "link.csv", "-f", "ctm")
    assert_refused(run, "nowhere does not exist")


def test_a_text_that_nobody_could_say_in_that_time_is_refused_at_once(tmp_path: Path) -> None:
    words = tmp_path / "words.txt"
    words.write_text("hello there " * 1_000_000, "utf-8")
    run = lipwright("align", HELLO, "--text", words, "-o", tmp_path / "a.ctm")
    assert_refused(run, str(words), "2000000 words", "9.3 s")


def test_a_word_without_end_is_refused_by_its_place(tmp_path: Path) -> None:
    run = lipwright("align", HELLO, "--text", "hello " + "b" * 3000, "-o", tmp_path / "a.ctm")
    assert_refused(run, "--text: line 1, column 7", "3000 characters")
    assert len(run.stderr) < 300


def test_words_may_come_from_a_named_pipe(tmp_path: Path) -> None:
    pipe = tmp_path / "words"
    os.mkfifo(pipe)
    writer = subprocess.Popen(["/bin/sh", "-c", f"echo '!!!' > {pipe}"])
    run = lipwright("align", HELLO, "--text", pipe, "-o", tmp_path / "a.ctm")
    writer.wait()
    assert_refused(run, f"{pipe}: has no words")


def test_text_that_is_not_utf_8_is_refused_by_line(tmp_path: Path) -> None:
    words = tmp_path / "words.txt"
    words.write_bytes(b"hello\ncaf\xe9")
    run = lipwright("align", HELLO, "--text", words, "-o", tmp_path / "a.ctm")
    assert_refused(run, f"{words}: line 2: byte 9 is not UTF-8 text")


def test_a_dictionary_that_would_not_be_used_is_refused(tmp_path: Path, track: Path) -> None:
    run = lipwright(
        "animate", HELLO, "--phones", track, "--dictionary", "my.dict", "-o", tmp_path / "a.csv"
    )
    assert_refused(run, "my.dict", "--phones")


def test_a_folder_as_dictionary_is_named_as_it_was_given(tmp_path: Path) -> None:
    run = lipwright(
        "align", HELLO, "--text", "hello", "--dictionary", tmp_path, "-o", tmp_path / "a.ctm"
    )
    assert_refused(run, f"lipwright: {tmp_path}: cannot be read")


def test_phones_without_a_known_suffix_are_not_sent_to_an_option_of_the_output(
    tmp_path: Path,
) -> None:
    (tmp_path / "a.xyz").write_text("", "utf-8")
    run = lipwright("animate", HELLO, "--phones", "a.xyz", "-o", "a.csv", cwd=tmp_path)
    assert_refused(run, "a.xyz", ".textgrid")
    assert b"--format" not in run.stderr


def test_with_json_every_line_of_standard_error_is_json(tmp_path: Path) -> None:
    text = "xqzptlk " + HELLO_TEXT.read_text("utf-8")
    run = lipwright(
        "align", HELLO, "--text", text, "--progress", "json", "-o", "a.ctm", cwd=tmp_path
    )
    lines = [json.loads(line) for line in run.stderr.splitlines()]
    assert run.returncode == 0
    assert "'xqzptlk'" in lines[-1]["warning"]
    for arguments in (["--progress=json"], ["--progress", "json", "--nonsense"]):
        run = lipwright("align", "nowhere.wav", "--text", "a", "-o", "a.ctm", *arguments)
        assert run.returncode == 2
        assert list(json.loads(run.stderr.splitlines()[-1])) == ["error"]


@pytest.mark.parametrize("value", ["nan", "inf", "1e30"])
def test_head_show_refuses_weights_that_no_pose_has(value: str, tmp_path: Path) -> None:
    run = lipwright("head", "show", tmp_path / "a.png", "--set", f"jawOpen={value}")
    assert_refused(run, value, "from -10 to 10")


def test_head_show_writes_no_png_under_another_name(tmp_path: Path) -> None:
    assert_refused(lipwright("head", "show", tmp_path / "a.jpg"), "a.jpg", ".png")


SWALLOWING = """
import os, signal, sys
from lipwright import cli, decode

read = decode._Readable.read
def read_and_stop(self, count):
    if not cli._stops:
        os.kill(os.getpid(), signal.SIGINT)
    return read(self, count)

decode._Readable.read = read_and_stop
sys.argv[0] = "lipwright"
cli.main()
"""


def test_an_interrupt_that_libsndfile_swallows_still_ends_in_one_line(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", SWALLOWING, "align", HELLO, "--text", HELLO_TEXT, "-o", "a.ctm"],
        cwd=tmp_path, capture_output=True, check=False, timeout=60,
    )  # fmt: skip
    assert run.stderr == b"lipwright: interrupted; nothing was written\n"
    assert run.returncode == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("animate - --phones {track} -o a.csv <&-", "standard input is closed"),
        ("align {hello} --text - -o a.ctm <&-", "standard input is closed"),
        ("animate {hello} --phones {track} -o - -f csv >&-", "standard output is closed"),
        ("animate {hello} --phones {track} -o - -f csv >/dev/full", "No space left on device"),
        ("phones >/dev/full", "No space left on device"),
    ],
)
def test_closed_and_full_pipes_are_refused_in_one_line(
    command: str, message: str, tmp_path: Path, track: Path
) -> None:
    line = command.format(hello=HELLO, track=track)
    run = subprocess.run(
        ["/bin/sh", "-c", f"{sys.executable} -m lipwright {line}"],
        cwd=tmp_path, capture_output=True, check=False, timeout=60,
    )  # fmt: skip
    assert_refused(Finished(run.returncode, run.stdout, run.stderr), message)
    assert not list(tmp_path.glob("a.*"))


def test_closed_standard_error_changes_nothing_but_the_words(tmp_path: Path, track: Path) -> None:
    line = f"animate {HELLO} --phones {track} -o {tmp_path / 'a.csv'} <&- >&- 2>&-"
    run = subprocess.run(
        ["/bin/sh", "-c", f"{sys.executable} -m lipwright {line}"], check=False, timeout=60
    )
    assert run.returncode == 0
    assert (tmp_path / "a.csv").read_bytes().startswith(b"time,")


def test_sound_from_a_named_pipe_is_read_once_and_used_twice(tmp_path: Path, track: Path) -> None:
    pipe = tmp_path / "sound"
    os.mkfifo(pipe)
    writer = subprocess.Popen(["/bin/sh", "-c", f"cat {HELLO} > {pipe}"])
    run = lipwright("animate", pipe, "--phones", track, "-o", tmp_path / "a.glb")
    writer.wait()
    if b"head install" in run.stderr:
        pytest.skip("the head is not installed")
    assert run.returncode == 0, run.stderr.decode()
    assert read_audio(tmp_path / "a.wav").duration == pytest.approx(read_audio(HELLO).duration)


def test_a_phone_track_longer_than_the_sound_is_refused_like_the_file_of_one(track: Path) -> None:
    longer = read_track(track).padded(0.0, 60.0)
    longer = PhoneTrack((*longer.phones[:-1], "AA"), longer.edges)
    with pytest.raises(LipwrightError, match=r"phone 7 .* past the end of the sound \(9\.300 s\)"):
        animate(HELLO, phones=longer)


@pytest.mark.parametrize("fps", ["0.09", "1e-9", "nan"])
def test_a_rate_too_slow_for_any_clock_is_refused(fps: str, tmp_path: Path, track: Path) -> None:
    run = lipwright("animate", HELLO, "--phones", track, "--fps", fps, "-o", tmp_path / "a.mp4")
    assert_refused(run, "fps is", "from 0.1 to 1000")


def test_an_empty_name_is_told_to_be_one(tmp_path: Path) -> None:
    run = lipwright("align", "", "--text", "hello", "-o", tmp_path / "a.ctm")
    assert_refused(run, "empty name")


def test_a_missing_wheel_is_named_once(tmp_path: Path) -> None:
    run = lipwright("head", "install", "--wheel", tmp_path / "no.whl")
    assert_refused(run, f"lipwright: {tmp_path / 'no.whl'}: No such file or directory; fetch")
