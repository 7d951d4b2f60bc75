"""Training learners that are no networks: from a dataset to a model that runs, by the commands."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from lipwright.cli import run
from lipwright.cli.modelling import models
from lipwright.dataset.folder import Dataset
from lipwright.dataset.splits import SplitOptions, split_dataset
from lipwright.engines.golden import check_model
from lipwright.errors import LipwrightError
from lipwright.formats import write_track
from test_dataset import TRACK, make

pytest.importorskip("torch", reason="the extra `train` is not installed")
pytest.importorskip("sklearn", reason="the extra `train` is not installed")

SMALL = {"engine": "trees", "name": "small", "min_leaf": 3, "trees": 2, "columns": 0.5}


@pytest.fixture
def faces(tmp_path: Path) -> Dataset:
    made = make(tmp_path / "faces", "anna", "bert", "cleo", "dora")
    split = split_dataset(made, SplitOptions(test=1, validation=1))
    split.save()
    return split


def train(
    dataset: Dataset, out: Path, *options: str, config: dict[str, object] | None = None
) -> int:
    path = out.with_name("small.json")
    path.write_text(json.dumps(config or SMALL))
    given = (str(dataset.path), "--config", str(path), "-o", str(out), "--progress", "none")
    return run(["train", *given, *options])


def ask(*arguments: object) -> Result:
    return CliRunner().invoke(models, [str(argument) for argument in arguments])


def test_a_model_of_trees_is_trained_described_checked_and_run(
    faces: Dataset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model"
    assert train(faces, out) == 0
    found = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    wanted = {"card.md", "golden.npz", "meta.json", "model.npz", "training/config.json"}
    assert found == wanted
    assert "2 trees with" in (out / "card.md").read_text("utf-8")
    assert "predicts: ARKit weights" in ask("info", out).output
    assert "gives its golden output" in ask("check", out).output
    write_track(tmp_path / "said.TextGrid", TRACK)
    said, curves = tmp_path / "said.TextGrid", tmp_path / "x.csv"
    sound = faces.path / "recordings" / "anna" / "audio.flac"
    given = (str(sound), "--phones", str(said), "--model", str(out), "-o", str(curves))
    for engine in ((), ("--engine", "trees")):
        assert run(["animate", *given, *engine]) == 0
        values = np.genfromtxt(curves, delimiter=",", names=True)
        assert len(values) == 61
        assert np.ptp(values["jawOpen"]) > 0
    capsys.readouterr()
    for engine, remedy in (("window", "--engine trees"), ("static", "leave one of them out")):
        assert run(["animate", *given, "--engine", engine]) == 2
        assert remedy in capsys.readouterr().err


def test_the_same_training_gives_the_same_bytes_and_another_seed_others(
    faces: Dataset, tmp_path: Path
) -> None:
    (tmp_path / "two.part" / "training").mkdir(parents=True)  # as one that was killed leaves
    assert train(faces, tmp_path / "one") == 0
    assert train(faces, tmp_path / "two") == 0
    assert train(faces, tmp_path / "three", "--seed", "1") == 0
    one, two, three = (
        (tmp_path / name / "model.npz").read_bytes() for name in ("one", "two", "three")
    )
    assert one == two
    assert one != three
    assert not (tmp_path / "two.part").exists()


def test_a_finished_model_stays_unless_it_is_forced(
    faces: Dataset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model"
    assert train(faces, out) == 0
    before = (out / "model.npz").read_bytes()
    assert train(faces, out, "--seed", "1") == 2
    assert "add --force to replace it" in capsys.readouterr().err
    assert (out / "model.npz").read_bytes() == before
    assert train(faces, out, "--seed", "1", "--force") == 0
    assert (out / "model.npz").read_bytes() != before


@pytest.mark.parametrize(
    ("changes", "options", "reason"),
    [
        ({"leaf": 3}, (), "'leaf' is unknown; known are: engine, name"),
        ({"engine": "forest"}, (), "'engine' is 'forest', not one of: hmm, dynamic, trees"),
        ({"min_leaf": 10_000}, (), "lower 'min_leaf'"),
        ({"controls": ["nose"]}, (), "has no control 'nose'"),
        ({}, ("--epochs", "3"), "'epochs' is no key of a configuration"),
        ({}, ("--targets", "both"), "run: lipwright face fit"),
    ],
)
def test_what_cannot_be_trained_is_refused_in_one_line(
    changes: dict[str, object], options: tuple[str, ...], reason: str, faces: Dataset,
    tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    assert train(faces, tmp_path / "model", *options, config={**SMALL, **changes}) == 2
    said = capsys.readouterr().err
    assert reason in said
    assert said.count("\n") == 1
    assert not (tmp_path / "model").exists()


def test_a_model_whose_arrays_were_changed_is_refused(faces: Dataset, tmp_path: Path) -> None:
    out = tmp_path / "model"
    assert train(faces, out) == 0
    assert check_model(out) == 0
    content = (out / "model.npz").read_bytes()
    (out / "model.npz").write_bytes(content[:-100])
    with pytest.raises(LipwrightError, match="cut off") as caught:
        check_model(out)
    assert "\n" not in str(caught.value)


def test_objects_in_arrays_are_never_unpickled(
    faces: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from lipwright.engines import trees
    from lipwright.network import arrays

    out = tmp_path / "model"
    assert train(faces, out) == 0
    np.savez(out / "other.npz", roots=np.array([print], dtype=object))
    content = (out / "other.npz").read_bytes()
    monkeypatch.setattr(arrays, "read_hashed", lambda *_: content)
    arrays._load.cache_clear()
    with pytest.raises(LipwrightError, match="damaged") as caught:
        trees.open_network(out)
    assert "\n" not in str(caught.value)
