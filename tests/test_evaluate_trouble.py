"""Evaluating what cannot be evaluated, and strangers' models: one clear line each, nothing lost."""

from __future__ import annotations

import io
import json
import resource
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.audio import Audio, write_flac
from lipwright.cli import run
from lipwright.dataset.folder import RECORDINGS, Dataset, recording_files, sha256_of
from lipwright.dataset.lock import locked
from lipwright.dataset.recording import Motion, save_motion, write_info
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.reference_file import save_reference_face
from lipwright.face.vertices import LANDMARKS
from lipwright.formats import write_track
from lipwright.npz import MOST, read_arrays
from lipwright.track import PhoneTrack
from test_reference import FPS, FRAMES, planted, random_parameters

for needed in ("torch", "sklearn", "jinja2", "matplotlib", "PIL"):
    pytest.importorskip(needed, reason="the extra `bench` is not installed")

ROOT = Path(__file__).resolve().parents[1]
CRAB = ROOT / "examples" / "crab" / "crab.bigrams.json"
NAMES = ("anna", "bert", "cleo", "dora", "emil", "fred")
SPLITS = ("test", "validation", "train", "train", "train", "train")
SAID = ("sil", "M", "AA", "S", "IH", "sil")
TREES = {"engine": "trees", "name": "small", "min_leaf": 3}
Edit = Callable[[Path], None]


def write_recording(folder: Path, face: ReferenceFace, digest: str, number: int) -> None:
    """A recording of planted parameters, whose jaw follows the first mode."""
    folder.mkdir(parents=True)
    parameters = random_parameters(face, number)
    landmarks = np.zeros((FRAMES, 478, 3))
    landmarks[:, LANDMARKS, :2] = face.points(parameters.shape)
    weights = np.zeros((FRAMES, 52))
    wave = np.sin(np.arange(FRAMES) / 4 + number)
    weights[:, 17:30] = 0.3 + 0.3 * wave[:, None] * np.linspace(0.2, 1, 13)
    poses = np.broadcast_to(np.eye(3, 4), (FRAMES, 3, 4))
    aperture = 0.2 + 0.2 * wave
    save_motion(
        folder / "motion.npz",
        Motion(FPS, np.zeros(FRAMES, np.uint8), weights, landmarks, poses, aperture, aperture),
    )
    edges = np.array([0, 5, 9, 15, 20, 25, FRAMES]) / FPS
    write_track(folder / "phones.TextGrid", PhoneTrack(SAID, edges))
    write_flac(folder / "audio.flac", Audio(np.zeros(9600, np.float32), 8000))
    write_info(folder, {"name": folder.name, "source": {}})
    np.savez(
        folder / "face.npz", model=np.array(digest), joint=face.join(parameters),
        inner_visible=np.ones(FRAMES, bool), **vars_of(parameters),
    )  # fmt: skip


def vars_of(parameters: FaceParameters) -> dict[str, Any]:
    return {part: getattr(parameters, part) for part in ("shape", "inner", "outer")}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset with its face beside it, and a report on it whose trees are trained."""
    place = tmp_path_factory.mktemp("evaluated")
    face = planted()
    save_reference_face(place / "set-face.npz", face)
    digest = sha256_of(place / "set-face.npz")
    entries = []
    for number, (name, split) in enumerate(zip(NAMES, SPLITS, strict=True)):
        folder = place / "set" / RECORDINGS / name
        write_recording(folder, face, digest, number)
        entry = {"name": name, "status": "captured", "reasons": [], "split": split}
        entries.append({**entry, "files": recording_files(folder)})
    manifest = {"format": "lipwright-dataset", "version": 1, "name": "set", "licence": "CC0-1.0"}
    Dataset(place / "set", {**manifest, "recordings": entries}).save()
    assert evaluate(place, "--engines", "static,trees") == 0
    return place


@pytest.fixture
def place(made: Path, tmp_path: Path) -> Path:
    """A copy of both."""
    return shutil.copytree(made, tmp_path / "place", ignore=shutil.ignore_patterns("new"))


def evaluate(place: Path, *more: str, out: str = "report") -> int:
    fixed = ["--quick", "--videos", "0", "-o", str(place / out)]
    return run(["evaluate", str(place / "set"), *fixed, *more])


def line_of(capsys: pytest.CaptureFixture[str]) -> str:
    [line] = capsys.readouterr().err.splitlines()
    return line.removeprefix("lipwright: ")


def refusal(place: Path, capsys: pytest.CaptureFixture[str], *more: str, out: str = "new") -> str:
    """What is said on the one line; nothing was measured."""
    before = sorted(place.rglob("report.json"))
    capsys.readouterr()
    assert evaluate(place, *more, out=out) == 2
    assert sorted(place.rglob("report.json")) == before
    return line_of(capsys)


def figures(place: Path) -> bytes:
    return (place / "report" / "report.json").read_bytes()


# --- what is asked for ---


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--engines", "static,nobody"), "no entrant 'nobody'; they are: all, lipwright"),
        (("--engines", ","), "nobody takes part; name an engine"),
        (("--model", "mine"), "--model mine: give it as NAME=MODEL"),
        (("--curves", "=folder"), "--curves =folder: give it as NAME=FOLDER"),
        (("--model", "a/b=lipwright"), "'a/b' is no name for somebody who takes part"),
        (("--model", "captured=lipwright"), "two take part as 'captured'"),
        (("--model", "mine=nowhere"), "no model 'nowhere': no such folder"),
        (("--model", f"mine={'x' * 300}"), "no such folder"),
        (("--model", f"mine={CRAB}"), "has no looks on a human face; leave it out"),
        (("--curves", "mine=nowhere"), "nowhere: is no folder"),
        (("--curves", f"mine={'x' * 300}"), "is no folder"),
        (("--face", "nowhere.npz"), "nowhere.npz: no such reference face"),
        (("--face", "x" * 300), "no such reference face"),
        (("--hold-out", "zzz*"), "no recording has a name like 'zzz*'"),
        (("--hold-out", "*"), "nothing is left to train on; hold out less"),
        (("--hold-out-words", "zebra"), "no recording says 'zebra'"),
    ],
)
def test_what_cannot_be_asked_for_is_refused(
    made: Path, capsys: pytest.CaptureFixture[str], more: tuple[str, ...], said: str
) -> None:
    assert said in refusal(made, capsys, "--engines", "static", *more)


def test_words_that_leave_nothing_for_validation_are_found_before_the_training(
    made: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = refusal(made, capsys, "--engines", "trees", "--hold-out", "bert")
    assert "nothing is left for validation; hold out less" in said
    assert not list((made / "new").rglob("*.npz"))


def test_a_model_of_modes_alone_is_refused_as_it_moves_no_head(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ("--targets", "joint", "-o", str(place / "modes"), "--progress", "none")
    (place / "small.json").write_text(json.dumps(TREES))
    assert run(["train", str(place / "set"), "--config", str(place / "small.json"), *given]) == 0
    said = refusal(place, capsys, "--engines", "static", "--model", f"mine={place / 'modes'}")
    assert "moves no head; train it with --targets both" in said


def test_a_damaged_model_is_found_before_the_training(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = place / "report" / "models" / "trees-test"
    (model / "model.npz").write_bytes((model / "model.npz").read_bytes()[:500])
    said = refusal(place, capsys, "--engines", "trees", "--model", f"mine={model}")
    assert "model.npz: is not the file that meta.json was written with" in said
    assert not (place / "new").exists()


@pytest.mark.parametrize("name", ["set-face.npz", "set", "set-face.npz/new", "x" * 300])
def test_a_report_lands_in_a_folder_of_its_own(
    place: Path, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    before = sorted(place.rglob("*"))
    assert str(place) in refusal(place, capsys, "--engines", "static", out=name)
    assert sorted(place.rglob("*")) == before


# --- curves of others ---


def table(names: str, value: str = "0.1", rows: int = 90, fps: float = 60.0) -> str:
    cells = "," + ",".join([value] * (names.count(",") + 1))
    return "\n".join([f"time,{names}", *(f"{row / fps:.6f}{cells}" for row in range(rows))]) + "\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (table("jawOpen", "nan"), "anna.csv: line 2: column 2 is 'nan', not a number"),
        (table("nose"), "anna.csv: line 1: unknown controls 'nose'"),
        (table("jawOpen", "50"), "anna.csv: the control jawOpen goes up to 50"),
        (table("joint1", "1e30"), "anna.csv: the mode joint1 goes up to 1e+30"),
        (table("joint1", rows=1), "anna.csv: has one frame, which is no motion"),
        (table("joint99"), "the curves have joint99, and the reference face 7 joint modes"),
        (table("joint1,shape1"), "the curves have joint and shape modes; keep either"),
        (table("inner1"), "the curves have no joint and no shape modes"),
        (table("jawOpen", fps=1e5), "are more than 1000 a second"),
        ("", "anna.csv: line 1: the first column is not 'time'"),
    ],
)
def test_curves_that_cannot_be_measured_are_refused_with_their_place(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    (tmp_path / "anna.csv").write_text(text)
    found = refusal(made, capsys, "--engines", "static", "--curves", f"mine={tmp_path}")
    assert said in found
    assert str(tmp_path) in found


def test_curves_have_the_same_kind_of_controls_for_every_recording(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    split_as(place, "bert", "test")
    (tmp_path / "anna.csv").write_text(table("jawOpen,joint1"))
    (tmp_path / "bert.csv").write_text(table("jawOpen"))
    said = refusal(place, capsys, "--engines", "static", "--curves", f"mine={tmp_path}")
    assert "the curves of 'bert' have no modes of the reference face, and others have" in said


@pytest.mark.parametrize("names", ["joint1,joint2", "shape1", "jawOpen,joint1", "jawOpen"])
def test_curves_of_any_kind_take_part(place: Path, tmp_path: Path, names: str) -> None:
    (tmp_path / "anna.csv").write_text(table(names, rows=40))
    assert evaluate(place, "--engines", "static", "--curves", f"mine={tmp_path}", out="new") == 0
    assert '"mine"' in (place / "new" / "report.json").read_text("utf-8")


# --- recordings ---


def split_as(place: Path, name: str, split: str) -> None:
    path = place / "set" / "dataset.json"
    content = json.loads(path.read_text("utf-8"))
    for entry in content["recordings"]:
        if entry["name"] == name:
            entry["split"] = split
    path.write_text(json.dumps(content))


def arrays_as(file: str, **changes: Any) -> Edit:
    """Arrays of a recording's file as a function makes them of what they were; None for away."""

    def edit(folder: Path) -> None:
        arrays: dict[str, Any] = read_arrays((folder / file).read_bytes())
        changed = {name: change and change(arrays[name]) for name, change in changes.items()}
        kept = {name: array for name, array in {**arrays, **changed}.items() if array is not None}
        np.savez(folder / file, **kept)

    return edit


def fall_silent(folder: Path) -> None:
    write_track(folder / "phones.TextGrid", PhoneTrack(("sil",), np.array([0.0, FRAMES / FPS])))


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (fall_silent, "shows no face or says nothing; reject it with"),
        (arrays_as("motion.npz", flags=np.ones_like), "shows no face or says nothing"),
        (arrays_as("motion.npz", aperture=None), "has no aperture of the lips"),
        (arrays_as("motion.npz", landmarks=None), "has no parameters; run: lipwright face fit"),
        (lambda folder: (folder / "face.npz").unlink(), "has no parameters"),
        (lambda folder: (folder / "face.npz").write_bytes(b"PK"), "face.npz: not readable"),
        (arrays_as("face.npz", model=lambda _: np.array("0" * 64)), "of another reference face"),
        (arrays_as("face.npz", shape=lambda a: a[:, 1:]), "face.npz: shape has values that cannot"),
        (arrays_as("face.npz", outer=lambda a: a * np.nan), "face.npz: outer has values that can"),
        (lambda folder: write_info(folder, {"name": "../x", "source": {}}), "anna"),
    ],
)
def test_recordings_that_cannot_be_measured_are_named_before_the_training(
    place: Path, capsys: pytest.CaptureFixture[str], edit: Edit, said: str
) -> None:
    folder = place / "set" / RECORDINGS / "anna"
    edit(folder)
    found = refusal(place, capsys, "--engines", "trees")
    assert said in found
    assert str(folder) in found
    assert not list((place / "new").rglob("*.npz"))


@pytest.mark.parametrize("split", ["train", "validation", "test"])
def test_each_split_is_needed(place: Path, capsys: pytest.CaptureFixture[str], split: str) -> None:
    for name, given in zip(NAMES, SPLITS, strict=True):
        if given == split:
            split_as(place, name, "unused")
    said = refusal(place, capsys, "--engines", "trees")
    assert f"no recording is for {split}; run: lipwright dataset split" in said


def test_names_of_strangers_are_text_in_every_part_of_the_report(place: Path) -> None:
    path = place / "set" / "dataset.json"
    content = json.loads(path.read_text("utf-8"))
    odd = "=cmd&'é #1;,"
    content |= {"name": "<script>x</script>", "licence": "<b>"}
    content["recordings"][0]["name"] = odd
    path.write_text(json.dumps(content))
    folder = place / "set" / RECORDINGS / "anna"
    write_info(folder, {"name": odd, "source": {}, "text": "<img src=x>"})
    folder.rename(folder.with_name(odd))
    assert evaluate(place, "--engines", "static", "--keep-curves", out="new") == 0
    page = (place / "new" / "index.html").read_text("utf-8")
    assert "<script>x" not in page
    assert "<img src=x" not in page
    assert f'''"'{odd}"''' in (place / "new" / "recordings.csv").read_text("utf-8")
    assert (place / "new" / "curves" / "static" / "test" / f"{odd}.csv").is_file()


# --- models that are kept ---


def test_progress_is_json_lines_only(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = figures(place)
    assert evaluate(place, "--engines", "static,trees", "--progress", "json") == 0
    lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert {"trained", "stage"} <= {key for line in lines for key in line}
    assert figures(place) == before


@pytest.mark.parametrize(
    "text", ["[1]", "{", "[" * 100_000, '{"digest": DIGEST, "seconds": NaN}',
             '{"digest": DIGEST, "seconds": 1e999}', '{"digest": DIGEST, "seconds": -1}'],
    ids=["list", "cut", "deep", "nan", "endless", "negative"],
)  # fmt: skip
def test_a_note_that_somebody_edited_is_not_believed(place: Path, text: str) -> None:
    before = figures(place)
    note = place / "report" / "models" / "trees-test.json"
    digest = json.loads(note.read_text())["digest"]
    note.write_text(text.replace("DIGEST", json.dumps(digest)))
    assert evaluate(place, "--engines", "static,trees") == 0
    assert 0 <= json.loads(note.read_text())["seconds"] < 600
    assert figures(place) == before


@pytest.mark.parametrize("file", ["model.npz", "meta.json", "golden.npz"])
def test_a_kept_model_that_is_damaged_is_trained_again(place: Path, file: str) -> None:
    before = figures(place)
    path = place / "report" / "models" / "trees-test" / file
    path.write_bytes(path.read_bytes()[:300])
    assert evaluate(place, "--engines", "static,trees") == 0
    assert figures(place) == before


def test_one_command_at_a_time_writes_to_a_report(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = figures(place)
    capsys.readouterr()
    with locked(place / "report", "report"):
        assert evaluate(place, "--engines", "static") == 2
    assert "another program is writing to this report; wait for its end" in line_of(capsys)
    assert figures(place) == before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_stopped_command_leaves_no_half_model_and_goes_on(
    place: Path, number: signal.Signals
) -> None:
    before = figures(place)
    shutil.rmtree(place / "report")
    command = [sys.executable, "-m", "lipwright.cli", "evaluate", str(place / "set"), "--quick"]
    command += ["--videos", "0", "--engines", "static,trees", "-o", str(place / "report")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        part = place / "report" / "models" / "trees-test.part"
        while not part.exists() and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(number)
        said = process.communicate()[1]
    if process.returncode != 0:  # a fast machine may be done before
        assert not (place / "report" / "report.json").exists()
        if number == signal.SIGINT:
            assert process.returncode == 1
            assert "interrupted; models that were trained are kept in" in said
    assert evaluate(place, "--engines", "static,trees") == 0
    assert figures(place) == before


def test_a_full_disk_is_named_and_nothing_counts_as_done(place: Path) -> None:
    script = "import sys; from lipwright.cli import main; main()"
    command = [sys.executable, "-c", script, "evaluate", str(place / "set"), "--engines", "trees"]
    done = subprocess.run(
        [*command, "--quick", "-o", str(place / "new")], capture_output=True, text=True,
        check=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)),
    )  # fmt: skip
    assert done.returncode == 2
    [line] = done.stderr.splitlines()
    assert "trees-test.part: cannot be written: File too large" in line
    assert not (place / "new" / "models" / "trees-test").exists()


# --- models of strangers ---


def rehash(model: Path) -> None:
    path = model / "meta.json"
    content = json.loads(path.read_text("utf-8"))
    content["files"] = {name: sha256_of(model / name) for name in content["files"]}
    path.write_text(json.dumps(content))


def change(
    name: str, at: Any, value: Any, file: str = "model.npz", kind: str | None = None
) -> Edit:
    def edit(model: Path) -> None:
        arrays = read_arrays((model / file).read_bytes())
        arrays[name] = arrays[name].astype(kind or arrays[name].dtype)
        arrays[name][at] = value
        np.savez(model / file, **arrays)  # type: ignore[arg-type]

    return edit


def put(name: str, array: Any, file: str = "model.npz") -> Edit:
    def edit(model: Path) -> None:
        arrays: dict[str, Any] = read_arrays((model / file).read_bytes())
        np.savez(model / file, **{**arrays, name: array})

    return edit


def promise(size: int) -> Edit:
    """An array whose header says it is larger than the machine."""

    def edit(model: Path) -> None:
        header = io.BytesIO()
        form = {"descr": "<f4", "fortran_order": False, "shape": (size,)}
        np.lib.format.write_array_header_1_0(header, form)
        with zipfile.ZipFile(model / "model.npz", "a") as archive:
            archive.writestr("more.npy", header.getvalue())

    return edit


def bomb(model: Path) -> None:
    """A member that says that it unpacks to 4 GB."""
    with zipfile.ZipFile(model / "model.npz", "a") as archive:
        archive.writestr("more.npy", b"")
    content = bytearray((model / "model.npz").read_bytes())
    entry = content.rindex(b"PK\x01\x02")
    content[entry + 24 : entry + 28] = (2 * MOST).to_bytes(4, "little")
    (model / "model.npz").write_bytes(content)


def other_kind(kind: str) -> Edit:
    def edit(model: Path) -> None:
        content = json.loads((model / "meta.json").read_text("utf-8"))
        (model / "meta.json").write_text(json.dumps({**content, "kind": kind}))

    return edit


def other_features(**changes: Any) -> Edit:
    def edit(model: Path) -> None:
        content = json.loads((model / "meta.json").read_text("utf-8"))
        content["features"] |= changes
        (model / "meta.json").write_text(json.dumps(content))

    return edit


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda model: (model / "model.npz").write_bytes(b"PK"), "damaged"),
        (change("low", 0, 10**6, kind="i8"), "'children' has a number that is not from 0"),
        (change("low", 0, 0), "a child comes before its parent"),
        (change("thresholds", 0, np.nan), "'thresholds' has values that are not finite"),
        (change("leaves", (0, 0, 0), 1e300, kind="f8"), "'leaves' has values over 1e+09"),
        (put("roots", np.zeros(10**6, np.int32)), "there are 1000000 trees, more than 1000"),
        (put("roots", np.array([{}], object)), "Object arrays cannot be loaded"),
        (promise(10**13), "damaged"),
        (bomb, "unpacks to 4.3 GB"),
        (other_kind("hmm"), "has no array 'means'"),
        (other_kind("dynamic"), "has no array 'gestures'"),
        (other_kind("windows"), "lacks the SHA-256 of model.onnx"),
        (other_features(fps=1000), "golden.npz: does not fit meta.json (times are not 1/1000 s"),
        (other_features(fps=1e9), "'features' are of 1e+09 fps"),
        (other_features(window=10**9 + 1), "a window of more than 1001 frames"),
        (change("times", 0, np.nan, "golden.npz"), "golden.npz: damaged ('times' does not rise"),
        (change("times", -1, 1e300, "golden.npz"), "golden.npz: damaged ('times' does not rise"),
        (put("times", np.array(["x"]), "golden.npz"), "golden.npz: damaged ('times' is <U1"),
        (put("controls", np.array(["x"]), "golden.npz"), "golden.npz: damaged ('controls' is <U1"),
        (put("edges", np.array([0, np.inf]), "golden.npz"), "golden.npz: damaged"),
    ],
)
def test_a_model_of_a_stranger_is_refused_by_its_file(
    place: Path, capsys: pytest.CaptureFixture[str], edit: Edit, said: str
) -> None:
    model = place / "report" / "models" / "trees-test"
    edit(model)
    rehash(model)
    capsys.readouterr()
    assert run(["models", "check", str(model)]) == 2
    found = line_of(capsys)
    assert said in found
    assert str(model) in found


# --- trainings ---


def trained(place: Path, config: dict[str, Any]) -> int:
    (place / "small.json").write_text(json.dumps(config))
    given = ("--config", str(place / "small.json"), "-o", str(place / "model"))
    return run(["train", str(place / "set"), *given, "--progress", "none"])


@pytest.mark.parametrize("engine", ["trees", "hmm", "dynamic"])
@pytest.mark.parametrize(
    ("named", "said"),
    [
        ([], "'controls' must name one at least, or be null"),
        (["jawOpen", "jawOpen"], "'controls' has a name twice"),
        (["nose"], "has no control 'nose' among its arkit targets"),
    ],
)
def test_controls_of_a_learner_are_some_and_each_once(
    place: Path, capsys: pytest.CaptureFixture[str], engine: str, named: list[str], said: str
) -> None:
    capsys.readouterr()
    assert trained(place, {"engine": engine, "name": "small", "controls": named}) == 2
    assert said in line_of(capsys)


@pytest.mark.parametrize("engine", ["trees", "hmm", "dynamic"])
def test_learners_refuse_recordings_in_which_nothing_is_said(
    place: Path, capsys: pytest.CaptureFixture[str], engine: str
) -> None:
    for name in NAMES:
        fall_silent(place / "set" / RECORDINGS / name)
    capsys.readouterr()
    assert trained(place, {"engine": engine, "name": "small"}) == 2
    assert str(place / "set") in line_of(capsys)


@pytest.mark.parametrize("engine", ["trees", "hmm", "dynamic"])
def test_phones_are_named_in_any_order(place: Path, engine: str) -> None:
    phones = ["M", "AA", "sil", "S", "IH"]
    few = {"trees": {"min_leaf": 3}, "dynamic": {"clusters": 2}}.get(engine, {})
    assert trained(place, {"engine": engine, "name": "small", "phones": phones, **few}) == 0
    assert run(["models", "check", str(place / "model")]) == 0


@pytest.mark.parametrize("engine", ["trees", "hmm", "dynamic"])
def test_learners_without_passes_are_not_tuned(
    place: Path, capsys: pytest.CaptureFixture[str], engine: str
) -> None:
    capsys.readouterr()
    given = ("--config", engine, "--grid", "seed=0,1", "-o", str(place / "tries"))
    assert run(["tune", str(place / "set"), *given]) == 2
    assert "only networks are tuned; name the configuration of one" in line_of(capsys)
