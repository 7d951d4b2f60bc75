"""Phone bigrams in bad hands: what once lost work, or ended in something worse than one line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.file import editing, load_any, load_set, save_set
from lipwright.cli.bigrams import bigrams as command
from lipwright.errors import LipwrightError
from lipwright.language.pace import spoken_track
from lipwright.pipeline import AnimateOptions, animate_track

CORPORA = Path(__file__).parents[2] / "shared" / "corpora"
THEIRS = 'd = m.createDiphone("f", "ah", "s")\nd.addKey("open", 0, 0)\n'


def ran(*arguments: object) -> Result:
    return CliRunner().invoke(command, [str(one) for one in arguments])


@pytest.fixture
def a_set(tmp_path: Path) -> Callable[..., Path]:
    """A child of the English set with these fields."""

    def write(name: str = "hero", **fields: object) -> Path:
        path = tmp_path / f"{name}.json"
        said = {"format": "lipwright-bigrams", "version": 1, "name": name, "parent": "english"}
        path.write_text(json.dumps(said | {"bigrams": {}} | fields, indent=1), "utf-8")
        return path

    return write


class TestNoWorkIsLost:
    def test_a_tiny_number_is_still_one_after_an_edit(self, a_set: Callable[..., Path]) -> None:
        path = a_set(speed_limit=1e-6, smoothing_s=2.5e-7, silence_s=0)
        before = load_set(path)
        save_set(path, before)
        after = load_set(path)
        assert (after.speed_limit, after.smoothing, after.silence) == (1e-6, 2.5e-7, 0)

    def test_an_edit_into_a_file_that_is_there_is_refused(
        self, tmp_path: Path, a_set: Callable[..., Path]
    ) -> None:
        made = tmp_path / "made.json"
        path = a_set()
        assert ran("edit", path, "f ah", "open", "0 0, 1 1", "-o", made).exit_code == 0
        second = ran("edit", path, "f ao", "open", "0 0, 1 1", "-o", made)
        assert isinstance(second.exception, LipwrightError)
        assert "is there already" in str(second.exception)
        assert list(load_set(made).bigrams) == [("f", "ah")]

    def test_an_edit_into_the_set_itself_is_an_edit_of_it(
        self, tmp_path: Path, a_set: Callable[..., Path]
    ) -> None:
        path = a_set()
        assert ran("edit", path, "f ah", "open", "0 0, 1 1", "-o", path).exit_code == 0
        theirs = tmp_path / "theirs.py"
        theirs.write_text(THEIRS, "utf-8")
        refused = ran("edit", theirs, "f ah", "open", "0 0", "-o", theirs)
        assert isinstance(refused.exception, LipwrightError)
        assert theirs.read_text("utf-8") == THEIRS

    @pytest.mark.parametrize("verb", ["import", "export"])
    def test_nothing_is_written_over_what_is_read(self, verb: str, tmp_path: Path) -> None:
        theirs = tmp_path / "theirs.py"
        theirs.write_text(THEIRS, "utf-8")
        refused = ran(verb, theirs, "-o", theirs)
        assert isinstance(refused.exception, LipwrightError)
        assert theirs.read_text("utf-8") == THEIRS

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="a system without named pipes")
    def test_a_pipe_is_not_waited_for_to_be_edited(self, tmp_path: Path) -> None:
        os.mkfifo(tmp_path / "pipe")
        with pytest.raises(LipwrightError, match="no file"), editing(tmp_path / "pipe"):
            pass


class TestOneLine:
    def test_a_version_beyond_every_float(self, a_set: Callable[..., Path]) -> None:
        with pytest.raises(LipwrightError, match="line 3, column 13: is of version a huge number"):
            load_set(a_set(version=10**400))

    def test_a_value_that_no_pose_has(self, a_set: Callable[..., Path]) -> None:
        curves = {"open": [[0, 0], [1, 1e30]]}
        path = a_set(bigrams={"f ah": {"curves": curves}})
        with pytest.raises(LipwrightError, match=r"line \d+, column \d+: control point 2.*1e\+30"):
            load_set(path)

    def test_the_same_in_a_text_of_smartbody(self, tmp_path: Path) -> None:
        path = tmp_path / "theirs.py"
        path.write_text(THEIRS + 'd.addKey("open", 1, 1e30)\n', "utf-8")
        with pytest.raises(LipwrightError, match=r"line 3, column 3: the key is at the value 1e"):
            load_any(path)

    def test_a_thousand_sets_in_one_text_are_not_all_listed(self, tmp_path: Path) -> None:
        path = tmp_path / "theirs.py"
        calls = (f'createDiphone("f", "ah", "s{number}")' for number in range(1000))
        path.write_text("\n".join(calls), "utf-8")
        with pytest.raises(LipwrightError, match="and 980 more") as caught:
            load_any(path)
        assert len(str(caught.value)) < 400

    def test_check_names_the_set_whose_rig_is_not_there(self, a_set: Callable[..., Path]) -> None:
        path = a_set(rig="nope")
        result = ran("check", path)
        assert f"{path}: no rig 'nope'" in result.output

    @pytest.mark.parametrize("words", ["", "...", "\U0001f600"])
    def test_a_text_without_words_is_not_checked_as_if_all_was_well(self, words: str) -> None:
        result = ran("check", "english", "--text", words)
        assert "has no words" in result.output
        assert "nothing to complain of" not in result.output


@pytest.mark.skipif(not CORPORA.is_dir(), reason="needs ../shared/corpora")
@pytest.mark.parametrize("name", ["neutral", "angry"])
def test_a_vowel_between_two_closures_opens_the_mouth(name: str) -> None:
    """Their closures ring on through a short vowel, which C of 0.5 kept shut."""
    track = spoken_track("papa, mum, pop", "en", "words")
    options = AnimateOptions(bigrams=CORPORA / "smartbody-bigrams" / f"{name}.json", fps=100)
    jaw = animate_track(track, options).curve("jawOpen")
    middles = (track.edges[:-1] + track.edges[1:]) / 2
    for phone, middle in zip(track.phones, middles, strict=True):
        if phone in ("AA", "AH"):
            assert jaw[round(middle * 100)] > 0.05
        elif phone in ("P", "M"):
            assert jaw[round(middle * 100)] == 0


@pytest.mark.parametrize("pose", ["a + b", "a\\nb"])
def test_what_is_imported_can_be_read_again(pose: str, tmp_path: Path) -> None:
    text = tmp_path / "theirs.py"
    text.write_text(f'createDiphone("f", "ah", "s")\naddKey("{pose}", 0, 1)\n', "utf-8")
    with pytest.raises(LipwrightError, match="line 2, column"):
        load_any(text)
    curves = f'{{"{pose}": [[0, 1]]}}'
    text.write_text(f'{{"bigrams": [{{"from": "f", "to": "ah", "curves": {curves}}}]}}', "utf-8")
    with pytest.raises(LipwrightError, match="line 1, column 51"):
        load_any(text)


@pytest.mark.parametrize("words", [[], ["nope.txt"]])
def test_the_crabs_sketch_wants_a_text(words: list[str]) -> None:
    script = Path(__file__).parents[1] / "examples" / "crab" / "sketch.py"
    ended = subprocess.run(  # our own
        [sys.executable, script, *words], capture_output=True, text=True, check=False
    )
    assert ended.returncode != 0
    assert len(ended.stderr.splitlines()) == 1


def test_every_set_that_ships_is_within_what_is_allowed() -> None:
    for name in ("english", "swedish", "mandarin"):
        assert load_bigrams(name).bigrams


def test_a_changed_set_that_ships_becomes_its_child(tmp_path: Path) -> None:
    made = tmp_path / "my hero.json"
    assert ran("edit", "english", "f ah", "open", "0 0, 1 1", "-o", made).exit_code == 0
    said = load_set(made)
    assert (said.name, said.parent) == ("my-hero", "english")
    assert list(said.bigrams) == [("f", "ah")]
    assert load_bigrams(made).bigrams["f", "ah"].curves["open"] == ((0.0, 0.0), (1.0, 1.0))


def test_a_rig_that_is_not_there_is_named_with_its_set(a_set: Callable[..., Path]) -> None:
    path = a_set(rig="none.json")
    with pytest.raises(LipwrightError, match=r"the rig of the bigram set 'hero': .*none\.json"):
        animate_track(spoken_track("Hello."), AnimateOptions(bigrams=path))


def test_a_text_that_would_take_minutes_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "long.py"
    path.write_text(THEIRS + "#" * 8_000_000, "utf-8")
    with pytest.raises(LipwrightError, match=r"long\.py: 8,\d+,\d+ letters .* split it"):
        load_any(path)
