"""The examples run, and what the documents say of the repository is so."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from lipwright.cli import run as cli
from lipwright.cli.app import app
from lipwright.export import read_clip
from lipwright.face.head import Head
from lipwright.formats import read_track

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))


def tracked_files() -> list[str]:
    """The files of the repository, below its root; those too that are about to be added."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        pytest.skip("not a git checkout")
    return [name for name in listed.stdout.decode().splitlines() if (ROOT / name).is_file()]


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_prints_something(script: Path, tmp_path: Path, head: Head) -> None:
    del head
    run = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, capture_output=True, check=False, timeout=300
    )
    assert run.returncode == 0, run.stderr.decode()
    assert run.stdout.strip()


def mapped_files() -> set[str]:
    """The paths in the README's file map: two spaces below a folder, or at the margin."""
    readme = (ROOT / "README.md").read_text("utf-8")
    block = readme.partition("## File map")[2].split("```")[1]
    paths: set[str] = set()
    folders: list[str] = []
    for line in block.strip("\n").split("\n"):
        name, about = line.split(maxsplit=1)
        assert about, line
        depth = (len(line) - len(line.lstrip())) // 2
        folders = folders[:depth]
        if name.endswith("/"):
            folders.append(name)
        else:
            path = "".join(folders) + name
            assert path not in paths, f"{path} stands twice"
            paths.add(path)
    return paths


def test_the_file_map_has_one_line_for_each_file() -> None:
    files = set(tracked_files())
    assert files - mapped_files() == set(), "the README's file map lacks files"
    assert mapped_files() - files == set(), "the README's file map has files that are gone"


def test_the_five_lines_of_python_run_as_written(tmp_path: Path, head: Head) -> None:
    del head
    readme = (ROOT / "README.md").read_text("utf-8")
    block = readme.partition("```python\n")[2].partition("```")[0]
    assert sum(map(bool, block.splitlines())) == 5
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    subprocess.run([sys.executable, "-c", block], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "hello.glb").stat().st_size > 0
    assert (tmp_path / "hello.csv").stat().st_size > 0


TRACKS = {
    "Praat TextGrid": "a.TextGrid", "CTM": "a.ctm", "HTK label": "a.lab",
    "Lipwright phone track (JSON)": "a.json", "MBROLA .pho": "a.pho",
}  # fmt: skip
CLIPS = {"Lipwright clip (JSON)": "a.json", "CSV table": "a.csv"}


@pytest.mark.parametrize(("heading", "name"), [*TRACKS.items(), *CLIPS.items()])
def test_the_example_of_a_documented_format_is_read(
    heading: str, name: str, tmp_path: Path
) -> None:
    page = (ROOT / "docs" / "formats.md").read_text("utf-8")
    section = page.partition(f"\n### {heading}\n")[2]
    path = tmp_path / name
    path.write_text(re.split(r"```\w*\n", section)[1].split("```")[0], "utf-8")
    if heading in TRACKS:
        assert "HH" in read_track(path).phones
    else:
        assert read_clip(path).curve("jawOpen").tolist() == [0.0, 0.125, 0.25]


def test_the_python_of_the_documents_runs_as_written(workplace: Path) -> None:
    for page in sorted((ROOT / "docs").glob("*.md")):
        for block in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
            subprocess.run(
                [sys.executable, "-c", block], cwd=workplace, check=True, capture_output=True
            )


EVALUATING = ("lipwright evaluate",)  # needs a recording for the test
TRAINING = ("lipwright train", "lipwright tune")  # need a recording for validation
DOWNLOADS = ("lipwright asr fetch",)  # gigabytes from a network that tests do without


def commands(group: click.Group, path: str = "lipwright") -> Iterator[tuple[str, click.Command]]:
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, f"{path} {name}")
        else:
            yield f"{path} {name}", command


@pytest.mark.parametrize(("path", "command"), [pytest.param(*c, id=c[0]) for c in commands(app)])
def test_the_help_ends_in_an_example_with_what_it_really_prints(
    path: str, command: click.Command, workplace: Path
) -> None:
    assert command.epilog
    (workplace / "examples").symlink_to(ROOT / "examples")
    _, line, *shown = command.epilog.split("\b\n")[1].splitlines()
    assert line.strip().startswith(path)
    assert shown
    if path in DOWNLOADS:
        pytest.skip("downloads a model")
    if path in TRAINING:
        assert cli(["dataset", "split", str(workplace / "anna"), "--validation", "1"]) == 0
    if path in EVALUATING:
        split = ["--test", "1", "--validation", "0"]
        assert cli(["dataset", "split", str(workplace / "anna"), *split]) == 0
    run = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)],
        cwd=workplace, capture_output=True, check=True, text=True,
        env={**os.environ, "HF_HUB_CACHE": str(workplace)},  # none of the user's models
    )  # fmt: skip
    printed = (run.stdout + run.stderr).splitlines()
    # The list of parts is wider where one is missing.
    rows = [[row.split() for row in lines] for lines in (shown, printed[: len(shown)])]
    # Drawn faces differ a little from machine to machine, and with them what is learnt of them.
    if path.startswith("lipwright face ") or path in (*TRAINING, *EVALUATING):
        rows = [[[re.sub(r"[\d.]+", "#", cell) for cell in row] for row in lines] for lines in rows]
    assert rows[0] == rows[1]


def test_links_in_the_documents_lead_somewhere() -> None:
    for page in (*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text("utf-8")):
            if not target.startswith("http"):
                assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_readme_begins_with_a_picture() -> None:
    assert (ROOT / "README.md").read_text("utf-8").startswith("![")
    assert (ROOT / "docs" / "hello.png").read_bytes().startswith(b"\x89PNG")


def test_nothing_of_a_machine_is_written_down() -> None:
    # Put together here, so that this file does not hold what it looks for.
    paths = ["/" + "root/", "/" + "work/", "/" + "home/", "pypi" + ".org", "python" + "hosted"]
    for name in tracked_files():
        path = ROOT / name
        if path.suffix in (".py", ".md", ".toml", ".json", ".csv", ""):
            text = path.read_text("utf-8", errors="replace")
            for needle in paths:
                assert needle not in text, f"{name} holds {needle}"
