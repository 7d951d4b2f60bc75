"""Training on what cannot be trained on: one clear line each, before the work begins."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.cli import run
from lipwright.errors import LipwrightError

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")

from lipwright.train.place import TrainOptions, move  # noqa: E402  # needs the extra

pytestmark = pytest.mark.usefixtures("one_torch_thread")

SMALL: dict[str, Any] = {
    "name": "small", "features": ["raw"], "input_window": 5, "output_window": 3,
    "network": {"layers": [8], "dropout": [0.2]}, "optimizer": {"kind": "adam"},
    "rates": {"first": 0.01}, "batch": 20, "epochs": 2,
}  # fmt: skip
Edit = Callable[[Path], None]


@pytest.fixture(scope="module")
def split(speakers: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three recordings, one a split, and the reference face of two of them."""
    place = tmp_path_factory.mktemp("trouble")
    both = place / "both"
    command = ["dataset", "merge", str(speakers / "anna"), str(speakers / "bert"), "-o", str(both)]
    assert run(command) == 0
    assert run(["dataset", "split", str(both), "--test", "1", "--validation", "1"]) == 0
    shutil.copyfile(speakers / "anna-face.npz", place / "both-face.npz")
    return place


@pytest.fixture
def place(split: Path, tmp_path: Path) -> Path:
    """A copy of it, with a small configuration."""
    copy = tmp_path / "place"
    shutil.copytree(split, copy)
    (copy / "small.json").write_text(json.dumps(SMALL))
    return copy


def train(place: Path, *more: str) -> int:
    names = ["both", "-c", "small.json", "-o", "model"]
    command = [name if name == "-c" or name == "-o" else str(place / name) for name in names]
    return run(["train", *command, *more])


def refusal(place: Path, capsys: pytest.CaptureFixture[str], *more: str) -> str:
    """What is said on the one line, after nothing was trained and no model was made."""
    capsys.readouterr()
    assert train(place, *more) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert not (place / "model").exists()
    return line.removeprefix("lipwright: ")


def configure(place: Path, **changes: Any) -> None:
    (place / "small.json").write_text(json.dumps({**SMALL, **changes}))


# --- configurations ---


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layers": [3]}, "'layers' is unknown; known are: name, "),
        ({"network": {"units": 3}}, "'network.units' is unknown; known are: kind, layers"),
        ({"network": {"layers": [2.5]}}, "'network.layers' is 2.5, not a whole number"),
        ({"network": {"layers": 8}}, "'network.layers' is 8, not a list"),
        ({"network": {"layers": [True]}}, "'network.layers' is True, not a whole number"),
        ({"network": {"layers": [4, 4], "dropout": [1.0]}}, "'network.dropout' must be from 0"),
        ({"network": {"layers": [4, 4], "dropout": [0, 0, 0]}}, "must be one number, or 2"),
        ({"network": {"activation": "relu"}}, "'relu', not one of: 'tanh', 'leaky_relu'"),
        ({"network": {"kernels": [3]}}, "'network.kernels' are for networks of the kind 'conv'"),
        ({"network": {"kind": "conv", "layers": [4], "kernels": [3]}, "output_window": 1},
         "'input_window' must be 3, as kernels see"),
        ({"network": 3}, "'network' is 3, not an object"),
        ({"optimizer": {"kind": "magic"}}, "'optimizer.kind' is 'magic', not one of: 'sgd'"),
        ({"rates": {}}, "'rates.first' is missing"),
        ({"rates": {"first": 0}}, "'rates.first' must be above 0"),
        ({"rates": {"first": "0.1"}}, "'rates.first' is '0.1', not a number"),
        ({"loss": {"motion": -1}}, "'loss.motion' must be 0 or more"),
        ({"input_window": 4}, "'input_window' is 4, not odd"),
        ({"input_window": 0}, "'input_window' is 0, not 1 to 101"),
        ({"output_window": 3000}, "'output_window' is 3000, not 1 to 101"),
        ({"features": ["raw", "smell"]}, "'features' has 'smell', not one of: raw, spans"),
        ({"features": []}, "'features' must name one at least"),
        ({"features": ["raw", "raw"]}, "'features' has a name twice"),
        ({"phones": ["sil", "XX"]}, "'phones' has 'XX', which the phone table lacks"),
        ({"phones": ["AA"]}, "'phones' must have 'sil'"),
        ({"targets": "pixels"}, "'targets' is 'pixels', not one of: 'arkit', 'shape', 'joint'"),
        ({"patience": 0}, "'patience' must be 1 or more, or null"),
        ({"name": ""}, "'name' must be a name"),
    ],
)  # fmt: skip
def test_a_configuration_that_cannot_be_names_file_and_key(
    changes: dict[str, Any], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    configure(tmp_path, **changes)
    line = refusal(tmp_path, capsys)
    assert line.startswith(f"{tmp_path / 'small.json'}: ")
    assert said in line


@pytest.mark.parametrize(
    ("text", "said"),
    [("{", "not JSON"), ("[1]", "'the file' is [1], not an object"), ('{"name": NaN}', "not JSON"),
     ("[" * 100_000, "not JSON")],
)  # fmt: skip
def test_a_file_that_is_no_configuration_is_named(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "small.json").write_text(text)
    assert said in refusal(tmp_path, capsys)


def test_a_configuration_that_is_nowhere_gives_the_names_that_there_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refusal(tmp_path, capsys)
    assert "no such configuration; name a file, or: " in line
    assert "lipwright, lstm, thesis, trees, window" in line


# --- datasets ---


def edit_manifest(place: Path, edit: Callable[[list[dict[str, Any]]], None]) -> None:
    path = place / "both" / "dataset.json"
    manifest = json.loads(path.read_text())
    edit(manifest["recordings"])
    path.write_text(json.dumps(manifest))


def name_of(place: Path, split: str) -> str:
    entries = json.loads((place / "both" / "dataset.json").read_text())["recordings"]
    return next(str(entry["name"]) for entry in entries if entry["split"] == split)


def test_a_folder_that_is_no_dataset_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "both").mkdir()
    configure(tmp_path)
    assert "not a dataset" in refusal(tmp_path, capsys)


@pytest.mark.parametrize("empty", ["train", "validation"])
def test_an_empty_split_is_named(
    empty: str, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def move(entries: list[dict[str, Any]]) -> None:
        for entry in entries:
            entry["split"] = "test" if entry["split"] == empty else entry["split"]

    edit_manifest(place, move)
    line = refusal(place, capsys)
    assert line == (f"{place / 'both'}: no recording is for {empty}; run: lipwright dataset split")


def test_a_dataset_without_a_test_split_trains_and_its_card_says_so(place: Path) -> None:
    def move(entries: list[dict[str, Any]]) -> None:
        for entry in entries:
            entry["split"] = "train" if entry["split"] == "test" else entry["split"]

    edit_manifest(place, move)
    assert train(place) == 0
    assert "keeps no recording for the test" in (place / "model" / "card.md").read_text()


@pytest.mark.parametrize("part", ["train", "validation", "test"])
def test_a_split_in_which_no_face_is_seen_is_named_before_the_work(
    part: str, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = place / "both" / "recordings" / name_of(place, part) / "motion.npz"
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    np.savez(path, **{**arrays, "flags": np.full_like(arrays["flags"], 1)})
    assert f"no frame for {part} shows a face; run: " in refusal(place, capsys)


def test_modes_without_a_fitted_face_give_the_command_that_fits_it(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refusal(place, capsys, "--targets", "joint")
    assert "has no face.npz, and so no joint modes; run: lipwright face fit" in line


def test_modes_of_another_reference_face_are_refused(
    place: Path, speakers: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    face = speakers / "anna" / "recordings" / "anna1" / "face.npz"
    with np.load(face) as stored:
        arrays = {**{name: stored[name] for name in stored.files}, "model": np.array("0" * 64)}
    for folder in (place / "both" / "recordings").iterdir():
        np.savez(folder / "face.npz", **arrays)
    line = refusal(place, capsys, "--targets", "shape")
    assert "is of another reference face than" in line
    assert "--face" in line


def test_parameters_that_are_no_numbers_name_recording_and_frame(
    place: Path, speakers: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("anna1", "anna2"):
        path = place / "both" / "recordings" / name / "face.npz"
        with np.load(speakers / "anna" / "recordings" / name / "face.npz") as stored:
            arrays = {key: stored[key] for key in stored.files}
        arrays["shape"][7, 0] = np.nan
        np.savez(path, **arrays)
    keep = ("anna1", "anna2")

    def only(entries: list[dict[str, Any]]) -> None:
        entries[:] = [entry for entry in entries if entry["name"] in keep]
        for entry, split in zip(entries, ("train", "validation"), strict=True):
            entry["split"] = split

    edit_manifest(place, only)
    line = refusal(place, capsys, "--targets", "shape")
    assert line.startswith(f"{place / 'both' / 'recordings' / 'anna1'}: ")
    assert "shape is not a number at frame 7, where a face was seen" in line


def test_a_control_that_the_dataset_lacks_is_named(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    configure(place, controls=["jawOpen", "jawOpened"])
    assert "has no control 'jawOpened' among its arkit targets" in refusal(place, capsys)


def test_recordings_of_several_frame_rates_need_one_that_is_named(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = place / "both" / "recordings" / name_of(place, "validation") / "motion.npz"
    with np.load(path) as stored:
        arrays = {**{name: stored[name] for name in stored.files}, "fps": np.array(30.0)}
    np.savez(path, **arrays)
    line = refusal(place, capsys)
    assert "has 25 frames a second, " in line
    assert "has 30; name one rate as 'fps' in the configuration, or --fps" in line
    assert train(place, "--fps", "25") == 0


def test_a_window_longer_than_a_recording_names_the_recording(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    configure(place, input_window=101)
    line = refusal(place, capsys)
    assert "fewer than the window of 101; narrow the window, or reject the recording" in line
    assert "the recording '" in line


def test_a_phone_that_nobody_knows_is_named_with_its_file(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = place / "both" / "recordings" / name_of(place, "train") / "phones.TextGrid"
    path.write_text(path.read_text().replace('"AY"', '"AYAY"'))
    line = refusal(place, capsys)
    assert str(path) in line
    assert "AYAY" in line


# --- the model's folder ---


def test_a_model_below_a_file_cannot_be_made(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (place / "file").write_text("mine")
    both, small = str(place / "both"), str(place / "small.json")
    assert run(["train", both, "-c", small, "-o", str(place / "file" / "model")]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert "cannot be made: Not a directory" in line
    assert run(["train", both, "-c", small, "-o", str(place / "file")]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line == f"lipwright: {place / 'file'}: is a file; name a new folder"


def test_a_folder_with_files_of_somebody_else_is_left_alone_even_by_force(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (place / "model").mkdir()
    (place / "model" / "thesis.tex").write_text("mine")
    for more in ([], ["--force"]):
        assert train(place, *more) == 2
        assert "is a folder with other files; name a new folder" in capsys.readouterr().err
    assert (place / "model" / "thesis.tex").read_text() == "mine"


@pytest.mark.parametrize("name", ["", ".", "/", "model/.."])
def test_a_path_without_a_name_of_its_own_is_no_new_folder(
    name: str, place: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)
    assert run(["train", "both", "-c", "small.json", "-o", name]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line.endswith("is no name of a new folder; give the model one")


def test_only_the_model_itself_is_replaced_and_nothing_that_came_meanwhile(place: Path) -> None:
    for name in ("model", "model.part", "model.old"):
        (place / name).mkdir()
    (place / "model" / "meta.json").write_text("{}")
    (place / "model.part" / "meta.json").write_text("{}")
    (place / "model.old" / "thesis.tex").write_text("mine")
    move(place / "model.part", place / "model", TrainOptions(force=True))
    assert not (place / "model.part").exists()
    (place / "model.part").mkdir()
    with pytest.raises(LipwrightError, match="is a finished model; add --force"):
        move(place / "model.part", place / "model", TrainOptions())
    (place / "model" / "meta.json").rename(place / "model" / "thesis.tex")
    with pytest.raises(LipwrightError, match="with other files"):
        move(place / "model.part", place / "model", TrainOptions(force=True))
    assert (place / "model.old" / "thesis.tex").read_text() == "mine"
    assert (place / "model" / "thesis.tex").is_file()
    assert (place / "model.part").is_dir()


def interrupted_training(place: Path) -> Path:
    """A training that has got as far as a checkpoint; its path."""
    from lipwright.dataset.folder import open_dataset
    from lipwright.train.config_file import load_config
    from lipwright.train.data import make_data
    from lipwright.train.run import fit_in
    from lipwright.train.takes import read_corpus

    folder = place / "model.part" / "training"
    folder.mkdir(parents=True)
    config = load_config(str(place / "small.json"))
    fit_in(folder, config, make_data(read_corpus(open_dataset(place / "both"), config), config))
    return folder / "checkpoint.pt"


def halved(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def with_text(path: Path) -> None:
    path.write_text("not a checkpoint\n" * 50)


def with_code(path: Path) -> None:
    torch.save({"format": "lipwright-checkpoint", "version": 1, "code": Path("/")}, path)


def of_another_kind(path: Path) -> None:
    torch.save([1, 2, 3], path)


def newer(path: Path) -> None:
    torch.save({**torch.load(path, weights_only=True), "version": 99}, path)


@pytest.mark.parametrize("edit", [halved, emptied, with_text, with_code, of_another_kind, newer])
def test_a_broken_checkpoint_is_one_line_and_force_starts_anew(
    edit: Edit, place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = interrupted_training(place)
    edit(path)
    line = refusal(place, capsys)
    assert line.startswith(f"{path}: ")
    assert line.endswith("start anew with --force, or name another folder")
    assert train(place, "--force") == 0


def test_a_checkpoint_of_another_configuration_or_other_recordings_says_which(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    interrupted_training(place)
    line = refusal(place, capsys, "--seed", "3", "--epochs", "9")
    assert "is of a configuration with another 'epochs', 'seed'; start anew" in line
    path = place / "both" / "recordings" / name_of(place, "train") / "motion.npz"
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    arrays["arkit"] = arrays["arkit"] * 0.5
    np.savez(path, **arrays)
    assert "is of a training on other recordings; start anew" in refusal(place, capsys)


def test_a_loss_without_bounds_ends_the_training(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    configure(place, optimizer={"kind": "sgd"}, rates={"first": 100}, epochs=50)
    capsys.readouterr()
    assert train(place) == 2
    *_, line = capsys.readouterr().err.splitlines()
    assert "the loss grew beyond all bounds at the rate 100; lower 'rates.first'" in line


def test_ctrl_c_says_how_to_go_on(place: Path) -> None:
    configure(place, network={"layers": [1000, 1000]}, epochs=1000, patience=None)
    command = [sys.executable, "-m", "lipwright", "train", str(place / "both"),
               "-c", str(place / "small.json"), "-o", str(place / "model")]  # fmt: skip
    threads = {**os.environ, "OMP_NUM_THREADS": "1"}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=threads) as process:
        assert process.stderr is not None
        lines = []
        for line in process.stderr:
            lines.append(line)
            if line.startswith("epoch 2:"):
                process.send_signal(signal.SIGINT)
    assert process.returncode == 1
    assert lines[-1] == (
        f"lipwright: interrupted; what was learnt is kept in {place / 'model.part'}; "
        "run the same command to go on\n"
    )
    assert (place / "model.part" / "training" / "checkpoint.pt").is_file()


# --- searches ---


@pytest.mark.parametrize(
    ("search", "said"),
    [
        ([], "nothing to vary; add --grid"),
        (["--grid", "epochs"], "not KEY=VALUE,VALUE"),
        (["--grid", "depth=1,2"], "'depth' is no key of a configuration"),
        (["--grid", "network.depth=1,2"], "'network.depth' is no key of a configuration"),
        (["--grid", "input_window=5,6"], "'input_window' is 6, not odd"),
        (["--grid", "seed=1", "--grid", "seed=2"], "a key is varied twice"),
        (["--range", "rates.first=0.1:1"], "a range has no points of a grid; add --random N"),
        (["--random", "2", "--range", "rates.first=1:0.1"], "not KEY=LOW:HIGH"),
        (["--random", "2", "--range", "rates.first=0:0.1:log"], "not KEY=LOW:HIGH"),
        (["--random", "2", "--range", "rates.first=0.1"], "not KEY=LOW:HIGH"),
    ],
)
def test_a_search_that_cannot_be_is_one_line_before_anything_is_trained(
    search: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    configure(tmp_path)
    command = ["tune", str(tmp_path / "both"), "-c", str(tmp_path / "small.json")]
    assert run([*command, "-o", str(tmp_path / "found"), *search]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert said in line
    assert not (tmp_path / "found").exists()


def test_results_of_another_search_or_broken_ones_are_left_alone(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = place / "found"
    command = ["tune", str(place / "both"), "-c", str(place / "small.json"), "-o", str(out)]
    assert run([*command, "--grid", "seed=1,2"]) == 0
    capsys.readouterr()
    assert run([*command, "--grid", "seed=1,3"]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line == f"lipwright: {out}: holds another search; name another folder"
    (out / "journal.log").write_text("not a journal\n")
    assert run([*command, "--grid", "seed=1,2"]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line.startswith(f"lipwright: {out / 'journal.log'}: not readable")


@pytest.mark.parametrize("share", [0.01, 0.5, 0.999])
def test_a_search_goes_on_with_what_a_kill_left_of_its_journal(
    share: float, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)  # optuna's lock of a relative path is a link to nowhere
    command = ["tune", "both", "-c", "small.json", "-o", "found", "--grid", "seed=1,2"]
    assert run(command) == 0
    before = (place / "found" / "trials.csv").read_text()
    journal = place / "found" / "journal.log"
    journal.write_bytes(journal.read_bytes()[: int(journal.stat().st_size * share)])
    (place / "found" / "journal.log.lock").symlink_to("found/journal.log")
    assert run(command) == 0
    assert run(command) == 0
    after = (place / "found" / "trials.csv").read_text()
    assert [line.split(",")[:3] for line in after.splitlines()] == [
        line.split(",")[:3] for line in before.splitlines()
    ]


def test_a_search_leaves_folders_of_somebody_else_alone(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (place / "mine").mkdir()
    (place / "mine" / "trials.csv").write_text("mine")
    for out in (place / "mine", place / "both"):
        before = sorted(path.name for path in out.iterdir())
        command = ["tune", str(place / "both"), "-c", str(place / "small.json"), "-o", str(out)]
        assert run([*command, "--grid", "seed=1,2"]) == 2
        [line] = capsys.readouterr().err.splitlines()
        assert line == f"lipwright: {out}: is a folder with other files; name a new folder"
        assert sorted(path.name for path in out.iterdir()) == before
    assert (place / "mine" / "trials.csv").read_text() == "mine"


def test_a_trial_that_fails_is_listed_last_with_its_reason(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = place / "found"
    command = ["tune", str(place / "both"), "-c", str(place / "small.json"), "-o", str(out)]
    assert run([*command, "--grid", "input_window=101,5"]) == 0
    rows = (out / "trials.csv").read_text().splitlines()
    assert rows[1].startswith("5,")
    assert rows[2].startswith("101,,")
    assert "fewer than the window of 101" in rows[2]
