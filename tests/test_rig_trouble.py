"""What careless and malicious people do to rigs, curves, exporters and characters."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from lipwright.cli import run
from lipwright.errors import LipwrightError
from lipwright.face.shapes import load_reference_shape
from lipwright.rig import load_rig

RIG: dict[str, Any] = {
    "format": "lipwright-rig", "version": 1, "name": "hero", "source": "", "license": "",
    "controls": [{"name": "jaw"}, {"name": "a_L"}, {"name": "a_R"}], "mirror": [["a_L", "a_R"]],
    "mapping": {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": 1}}}},
}  # fmt: skip
HUGE = 10**400


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Files lie in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def rig_file(**changes: Any) -> str:
    Path("hero.json").write_text(json.dumps({**RIG, **changes}))
    return "hero.json"


def refusal(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line of a command that ends with status 2."""
    assert run(arguments) == 2
    line = capsys.readouterr().err.strip()
    assert "\n" not in line
    return line


def linear(**row: Any) -> dict[str, Any]:
    return {"method": "linear", "controls": {"jaw": {"from": {"jawOpen": 1}, **row}}}


class TestRigs:
    @pytest.mark.parametrize(
        ("changes", "place"),
        [
            ({"controls": 3}, "'controls' is 3, not a list"),
            ({"controls": [{"name": "jaw", "high": HUGE}]}, "'controls' 1: 'high' is 1000"),
            ({"controls": [{"name": "jaw", "high": True}]}, "'controls' 1: 'high' is true"),
            ({"mirror": [7]}, "'mirror' 1 is 7, not a list"),
            ({"bones": [{"name": "jaw", "at": [HUGE, 0, 0]}]}, "'bones' 1: 'at' 1 is 1000"),
            ({"bones": [{"name": "jaw", "parent": None}]}, "'bones' 1: 'parent' is null, not text"),
            ({"mapping": linear(clamp=[0, HUGE])}, "'jaw': 'clamp' 2 is 1000"),
            ({"mapping": linear(ofset=0.1)}, "'ofset' is no field here; the fields are from, off"),
            ({"mapping": {**linear(), "reference": 7}}, "'mapping': 'reference' is 7, not text"),
            ({"lacks": {"tongueOut": ["x"]}}, "'lacks': 'tongueOut' is [\"x\"], not text"),
            ({"discrete": "no"}, "'discrete' is \"no\", not true or false"),
            ({"title": "\ud800"}, r"'title' has '\ud800', with a control character"),
            ({"controls": [{"name": "\x1b[2J"}]}, r"'name' has '\x1b[2J', with a control char"),
            ({"controls": [{"name": "a\nb"}]}, r"'name' has 'a\nb', with a control character"),
        ],
    )
    def test_a_field_of_the_wrong_kind_is_named_by_its_place(
        self, changes: dict[str, Any], place: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        line = refusal(["rigs", "check", rig_file(**changes)], capsys)
        assert line.startswith("lipwright: hero.json: is no rig: ")
        assert place in line

    def test_a_key_that_stands_twice_is_not_passed_over(self) -> None:
        text = json.dumps(RIG).replace('"controls": {', '"controls": {"jaw": {"from": {}}, ')
        Path("hero.json").write_text(text)
        with pytest.raises(LipwrightError, match=r"hero\.json: the key 'jaw' stands twice"):
            load_rig("hero.json")

    @pytest.mark.parametrize("load", [load_rig, load_reference_shape])
    def test_a_pipe_is_no_rig_and_is_not_waited_for(self, load: Any) -> None:
        os.mkfifo("pipe.json")
        with pytest.raises(LipwrightError, match=r"pipe\.json: is (a folder, device or|no file)"):
            load("pipe.json")
