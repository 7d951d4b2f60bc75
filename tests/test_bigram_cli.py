"""`lipwright bigrams`: what people do with sets of phone bigrams."""

from __future__ import annotations

import csv
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.file import load_set
from lipwright.cli import run

DIPHONES = Path(__file__).parents[1] / "examples" / "diphones.txt"


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def mine() -> Path:
    """A new set with a few pairs."""
    assert run(["bigrams", "new", "mine", "-o", "mine.json", "--licence", "CC0"]) == 0
    for pair, pose, points in (
        ("f ah", "FV", "0 0, 0.2 1, 0.5 0"),
        ("f ah", "open", "0.3 0, 0.7 0.6, 1 0"),
        ("ah f", "open", "0 0, 0.3 0.6, 0.7 0"),
        ("sil f", "FV", "0.5 0, 1 1"),
    ):
        assert run(["bigrams", "edit", "mine.json", pair, pose, points]) == 0
    return Path("mine.json")


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that a command says when it refuses."""
    capsys.readouterr()
    assert run(["bigrams", *arguments]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def test_a_new_set_is_drawn_pair_by_pair(mine: Path) -> None:
    said = load_set(mine)
    assert list(said.bigrams) == [("ah", "f"), ("f", "ah"), ("sil", "f")]
    assert said.bigrams["f", "ah"].curves == {
        "open": ((0.3, 0.0), (0.7, 0.6), (1.0, 0.0)), "FV": ((0.0, 0.0), (0.2, 1.0), (0.5, 0.0)),
    }  # fmt: skip
    assert said.bigrams["f", "ah"].source == "drawn"


def test_a_new_set_never_takes_the_place_of_a_file(
    mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = mine.read_bytes()
    assert "is there already" in refused(["new", "other", "-o", str(mine)], capsys)
    assert mine.read_bytes() == before


def test_a_new_set_has_the_poses_of_its_rig() -> None:
    assert run(["bigrams", "new", "sb", "--rig", "smartbody", "-o", "sb.json"]) == 0
    whole = load_bigrams("sb.json")
    assert "lowerLipDown" in whole.poses
    assert not whole.constraints
    assert whole.rig == "smartbody"


def test_a_child_in_another_folder_inherits(mine: Path) -> None:
    Path("deep").mkdir()
    command = ["bigrams", "new", "hero", "--parent", str(mine), "-o", "deep/hero.json"]
    assert run(command) == 0
    assert load_set("deep/hero.json").parent == "../mine.json"
    whole = load_bigrams("deep/hero.json")
    assert (whole.name, whole.licence) == ("hero", "CC0")
    assert len(whole.bigrams) == 3


def test_a_pair_of_the_parent_is_copied_whole_when_it_is_edited(mine: Path) -> None:
    before = mine.read_bytes()
    assert run(["bigrams", "new", "hero", "--parent", "mine.json", "-o", "hero.json"]) == 0
    assert run(["bigrams", "edit", "hero.json", "f ah", "open", "0 0, 1 1"]) == 0
    said = load_set("hero.json")
    assert list(said.bigrams) == [("f", "ah")]
    assert set(said.bigrams["f", "ah"].curves) == {"FV", "open"}
    assert mine.read_bytes() == before
    assert run(["bigrams", "edit", "hero.json", "f ah", "FV", "--remove"]) == 0
    assert set(load_set("hero.json").bigrams["f", "ah"].curves) == {"open"}
    assert run(["bigrams", "edit", "hero.json", "f ah", "--remove"]) == 0
    assert not load_set("hero.json").bigrams
    assert set(load_bigrams("hero.json").bigrams["f", "ah"].curves) == {"FV", "open"}


def test_a_drawn_pair_is_no_longer_what_captures_gave(mine: Path) -> None:
    content = json.loads(mine.read_text())
    content["bigrams"]["f ah"] |= {"source": "fitted", "count": 7, "variance": {"FV": 0.1}}
    mine.write_text(json.dumps(content))
    assert run(["bigrams", "edit", "mine.json", "f ah", "open", "0 0, 1 1"]) == 0
    pair = load_set(mine).bigrams["f", "ah"]
    assert (pair.source, pair.count, dict(pair.variance)) == ("drawn", 0, {})


def test_an_edit_may_go_to_another_file(mine: Path) -> None:
    before = mine.read_bytes()
    assert run(["bigrams", "edit", "mine.json", "f f", "FV", "0 1, 1 1", "-o", "more.json"]) == 0
    assert mine.read_bytes() == before
    assert len(load_bigrams("more.json").bigrams) == 4


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["f ah", "open", "0 0, 0.4 1, 0.2 0"], "control point 3 is at 0.2, before the last one"),
        (["f ah", "open", "0 0, nan 1"], "not finite"),
        (["f ah", "open", "0 0, 3 1"], "not within 0 to 1"),
        (["f ah", "open", "half"], "control point 1 is 'half'"),
        (["f ah", "tail", "0 0"], "no pose 'tail'; the poses are: open, W"),
        (["f qq", "open", "0 0"], "no class 'qq'; the classes are: ah, aa"),
        (["f", "open", "0 0"], "is no pair"),
        (["f ah", "open"], "give a pose and its control points, or --remove"),
        (["f ah"], "or --remove"),
        (["f ah", "open", "0 0", "--remove"], "or --remove"),
        (["f ah", "PBM", "--remove"], "has no curve of 'PBM'"),
        (["ah ah", "--remove"], "no such pair to take out"),
        (["f ah", "open", "0 0", "--source", "guess"], "'guess' is not one of"),
        ([], "name what to edit"),
    ],
)
def test_a_wrong_edit_is_one_line_and_changes_nothing(
    arguments: list[str], reason: str, mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = mine.read_bytes()
    assert reason in refused(["edit", "mine.json", *arguments], capsys)
    assert mine.read_bytes() == before


def test_what_ships_is_never_written(
    mine: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = Path("sets").absolute()
    folder.mkdir()
    shipped = folder / "ours.json"
    shipped.write_bytes(mine.read_bytes())
    monkeypatch.setattr("lipwright.bigrams.families.SETS", folder)
    before = shipped.read_bytes()
    for name in ("ours", str(shipped)):
        wrong = refused(["edit", name, "f ah", "open", "0 0"], capsys)
        assert "bigrams new NAME --parent" in wrong
    Path("link.json").symlink_to(shipped)
    refused(["edit", "link.json", "f ah", "open", "0 0"], capsys)
    refused(["import", str(DIPHONES), "-o", str(folder / "x.json")], capsys)
    refused(["export", "ours", "-o", str(shipped)], capsys)
    assert shipped.read_bytes() == before
    assert run(["bigrams", "new", "hero", "--parent", "ours", "-o", "hero.json"]) == 0
    assert load_set("hero.json").parent == "ours"
    assert run(["bigrams", "edit", "hero.json", "f ah", "open", "0 0"]) == 0
    assert run(["bigrams", "edit", "ours", "f ah", "open", "0 0", "-o", "copy.json"]) == 0


def test_sets_of_another_format_are_imported_before_they_are_edited(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("a.txt").write_bytes(DIPHONES.read_bytes())
    assert "bigrams import" in refused(["edit", "a.txt", "f ay", "open", "0 0"], capsys)
    assert Path("a.txt").read_bytes() == DIPHONES.read_bytes()
    assert run(["bigrams", "edit", "a.txt", "f ay", "open", "0 0", "-o", "a.json"]) == 0
    wrong = refused(["import", "a.json", "-o", "b.json"], capsys)
    assert "is a set of ours; make a child of it" in wrong


def _edit(number: int) -> None:
    assert run(["bigrams", "edit", "mine.json", "f ah", "wide", f"0 0, 1 {number}"]) == 0
    names = ("aa", "ao", "eh", "er")
    assert run(["bigrams", "edit", "mine.json", f"f {names[number]}", "wide", "0 0, 1 1"]) == 0


def test_edits_at_the_same_time_all_arrive(mine: Path) -> None:
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        pool.map(_edit, range(4))
    said = load_set(mine)
    assert {("f", name) for name in ("aa", "ao", "eh", "er")} <= set(said.bigrams)
    assert sorted(os.listdir()) == ["mine.json"]  # noqa: PTH208  # names only


def test_a_killed_edit_leaves_the_old_set_or_the_new_one(mine: Path) -> None:
    code = (
        "import lipwright.cli as c, itertools\n"
        "for n in itertools.count():\n"
        "    c.run(['bigrams', 'edit', 'mine.json', 'f ah', 'wide', f'0 0, 1 {n}'])\n"
    )
    for _ in range(2):
        edits = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE)
        assert edits.stderr is not None
        edits.stderr.readline()
        time.sleep(0.02)
        edits.send_signal(signal.SIGKILL)
        edits.wait()
        edits.stderr.close()
        assert len(load_set(mine).bigrams) == 3
    assert run(["bigrams", "edit", "mine.json", "f ah", "wide", "0 0"]) == 0  # the lock is free


def test_info_says_what_is_in_a_set(mine: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["bigrams", "new", "hero", "--parent", "mine.json", "-o", "hero.json"]) == 0
    assert run(["bigrams", "edit", "hero.json", "f ah", "W", "0 0, 1 1"]) == 0
    capsys.readouterr()
    assert run(["bigrams", "info", "hero.json"]) == 0
    rows = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert rows["parents"] == "mine"
    assert rows["from"] == "mine 2, hero 1"
    assert rows["pairs"] == "3 of 483"
    assert run(["bigrams", "info", "hero.json", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["from"] == {"mine": 2, "hero": 1}
    assert facts["made"] == {"drawn": 3}


def test_a_strangers_set_cannot_steer_the_terminal(
    mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = json.loads(mine.read_text()) | {"licence": "\x1b]0;owned\x07"}
    mine.write_text(json.dumps(content))
    capsys.readouterr()
    assert run(["bigrams", "info", "mine.json"]) == 0
    assert "\x1b" not in capsys.readouterr().out


def test_check_names_missing_pairs_and_what_stands_in(
    mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert run(["bigrams", "check", str(mine), "--text", "a love"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert "warning: mine.json: no pair sil ah; every pose rests" in lines
    assert "warning: mine.json: no pair ah l; ah f stands in" in lines
    assert lines[-1] == "mine.json: 1 of 5 pairs"


def test_check_goes_through_all_sets_and_tells_the_unusable(
    mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = json.loads(mine.read_text())
    Path("tail.json").write_text(json.dumps(content | {"poses": content["poses"] | {"tail": {}}}))
    priorities = {name: {"priority": 1} for name in content["poses"]}
    Path("ties.json").write_text(json.dumps(content | {"poses": priorities}))
    capsys.readouterr()
    assert run(["bigrams", "check", "tail.json", "ties.json", "gone.json"]) == 2
    said = capsys.readouterr().err
    assert "tail.json: the rig facefx lacks the poses tail;" in said
    assert "have the same priority 1" in said
    assert "gone.json" in said


def test_coverage_counts_texts_tracks_and_datasets(
    mine: Path, speakers: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("text.txt").write_text("A love.\nOf a love!\n")
    Path("track.lab").write_text("0 1000000 sil\n1000000 2000000 F\n2000000 3000000 AH\n")
    capsys.readouterr()
    command = ["bigrams", "coverage", str(mine), "text.txt", "track.lab", "--json"]
    assert run([*command, "-o", "pairs.csv"]) == 0
    found = json.loads(capsys.readouterr().out)
    pairs = {row["pair"]: row for row in found["pairs"]}
    assert pairs["ah f"]["count"] == "3"
    assert pairs["ah f"]["source"] == "drawn"
    assert pairs["ah l"]["stand-in"] == "ah f"
    assert pairs["f ah"]["from"] == "mine"
    assert found["missing"] == sum(not row["source"] for row in found["pairs"])
    with Path("pairs.csv").open() as file:
        assert [dict(row) for row in csv.DictReader(file)] == found["pairs"]
    assert run(["bigrams", "coverage", str(mine), str(speakers / "anna"), "--top", "1"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[0].split() == [
        "rank", "pair", "count", "percent", "cumulative", "source", "from", "stand-in",
    ]  # fmt: skip
    assert len(printed) == 3


def test_coverage_draws_figure_2(mine: Path) -> None:
    pytest.importorskip("matplotlib")
    Path("text.txt").write_text("A love of a love")
    assert run(["bigrams", "coverage", str(mine), "text.txt", "-o", "pairs.png"]) == 0
    assert Path("pairs.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("text", "options", "reason"),
    [
        ("", [], "has no pairs"),
        ("hello", ["-o", "x.gif"], "one of the suffixes .csv, .png"),
        ("hello", ["--language", "xx"], "unknown language 'xx'"),
    ],
)
def test_coverage_of_nothing_is_one_line(
    text: str, options: list[str], reason: str, mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("text.txt").write_text(text)
    assert reason in refused(["coverage", str(mine), "text.txt", *options], capsys)


def test_import_and_export_give_the_same_curves(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["bigrams", "import", str(DIPHONES), "-o", "a.json"]) == 0
    assert capsys.readouterr().err == "a.json: example, 2 pairs of 2 classes\n"
    assert run(["bigrams", "export", "a.json", "-o", "a.py"]) == 0
    assert run(["bigrams", "import", "a.py", "-o", "b.json"]) == 0
    first, second = json.loads(Path("a.json").read_text()), json.loads(Path("b.json").read_text())
    assert first == second


def test_import_says_what_it_changed(capsys: pytest.CaptureFixture[str]) -> None:
    pair = 'createDiphone("f", "zz", "a")\naddKey("open", -0.01, 1)\n'
    Path("a.py").write_text(pair * 2 + 'createDiphone("f", "f", "b")\n')
    assert "choose one of these with --name: a, b" in refused(
        ["import", "a.py", "-o", "a.json"], capsys
    )
    assert run(["bigrams", "import", "a.py", "--name", "a", "-o", "a.json"]) == 0
    said = capsys.readouterr().err
    assert "the pair 'f zz' stands twice" in said
    assert "1 control points lay a little out of 0 to 1" in said
    assert "no phone is in these classes: zz" in said


def test_text_is_parsed_and_never_executed() -> None:
    Path("evil.py").write_text(
        'open("ran", "w").write("x")\n' + DIPHONES.read_text() + '\n__import__("os").mkdir("ran")\n'
    )
    assert run(["bigrams", "import", "evil.py", "-o", "a.json"]) == 0
    assert not Path("ran").exists()


def test_an_unknown_suffix_of_an_export_is_one_line(
    mine: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ".json, .py, .txt, .csv" in refused(["export", str(mine), "-o", "a.xml"], capsys)
    assert not Path("a.xml").exists()
