"""The examples run, and what the documents say of the repository is so."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from lipwright.face.head import Head

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9]*.py"))


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_prints_something(script: Path, tmp_path: Path, head: Head) -> None:
    del head
    run = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, capture_output=True, check=False, timeout=300
    )
    assert run.returncode == 0, run.stderr.decode()
    assert run.stdout.strip()


def test_the_file_map_names_every_module_and_folder() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    for path in sorted((ROOT / "src" / "lipwright").iterdir()):
        if path.name.startswith("_") or path.suffix not in ("", ".py") or path.name == "version.py":
            continue
        assert f"{path.name}" in readme, f"the README's file map lacks {path.name}"


def test_links_in_the_documents_lead_somewhere() -> None:
    for page in (*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")):
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text("utf-8")):
            if not target.startswith("http"):
                assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_readme_begins_with_a_picture() -> None:
    assert (ROOT / "README.md").read_text("utf-8").startswith("![")
    assert (ROOT / "docs" / "hello.png").read_bytes().startswith(b"\x89PNG")


def test_nothing_of_a_machine_is_written_down() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        pytest.skip("not a git checkout")
    # Put together here, so that this file does not hold what it looks for.
    paths = ["/" + "root/", "/" + "work/", "/" + "home/", "pypi" + ".org", "python" + "hosted"]
    for name in listed.stdout.decode().split("\n"):
        path = ROOT / name
        if path.suffix in (".py", ".md", ".toml", ".json", ".csv", "") and path.is_file():
            text = path.read_text("utf-8", errors="replace")
            for needle in paths:
                assert needle not in text, f"{name} holds {needle}"
