"""Files of phone bigrams: what they say, what is wrong with them, and what they inherit."""

from __future__ import annotations

import json
import os
import random
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lipwright.bigrams.coverage import Counting, cover
from lipwright.bigrams.edits import parse_pair, parse_points
from lipwright.bigrams.exporting import export_set
from lipwright.bigrams.families import (
    MAX_PARENTS,
    flatten,
    load_bigrams,
    load_family,
    merge,
    moved,
    origins,
    shipped_sets,
)
from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.file import MAX_BYTES, editing, load_any, load_set, save_set, set_to_text
from lipwright.bigrams.fresh import COMMON_CLASSES, FACEFX_POSES, fresh_set
from lipwright.bigrams.missing import UNLIKE, missing, needed_pairs, stand_in
from lipwright.bigrams.places import locate, parse
from lipwright.bigrams.smartbody import EXPRESSIVE_CLASSES
from lipwright.bigrams.smartbody_text import is_smartbody_text, text_to_set
from lipwright.bigrams.values import (
    SILENCE_REACH,
    SMOOTHING,
    Bigram,
    BigramSet,
    Pair,
    Pose,
)
from lipwright.errors import LipwrightError
from lipwright.phones import COMMON, PHONES, phone_distance
from lipwright.track import PhoneTrack

SMARTBODY = Path(__file__).parents[2] / "shared" / "corpora" / "smartbody-bigrams"
needs_smartbody = pytest.mark.skipif(
    not SMARTBODY.is_dir(), reason="the sets of SmartBody are not beside the repository"
)

BASE: dict[str, Any] = {
    "format": "lipwright-bigrams",
    "version": 1,
    "name": "base",
    "language": "en",
    "licence": "CC0",
    "source": "drawn for a test",
    "rig": "facefx",
    "smoothing_s": 0.05,
    "classes": {"ah": ["AE", "AH", "AX"], "f": ["F", "V"], "bmp": ["P", "B", "M"], "sil": ["sil"]},
    "poses": {
        "open": {"priority": 0},
        "FV": {"priority": 4, "limit": "widen"},
        "PBM": {"priority": 5, "limit": "widen"},
    },
    "constraints": {"open + PBM": 0.5, "otherwise": 2.0},
    "bigrams": {
        "f ah": {
            "source": "fitted",
            "count": 3,
            "curves": {
                "FV": [[0, 0], [0.2, 1], [0.5, 0]],
                "open": [[0.25, 0], [0.75, 0.5], [1, 0]],
            },
            "variance": {"FV": 0.01},
        },
        "bmp ah": {"curves": {"PBM": [[0, 1], [0.5, 0]]}, "note": "drawn by hand"},
        "sil f": {"curves": {}},
    },
}


def base(**changes: Any) -> dict[str, Any]:
    return {**json.loads(json.dumps(BASE)), **changes}


def write(path: Path, content: dict[str, Any] | str) -> Path:
    path.write_text(content if isinstance(content, str) else json.dumps(content, indent=1))
    return path


def child(path: Path, parent: str, **fields: Any) -> Path:
    said = {"format": "lipwright-bigrams", "version": 1, "name": path.stem, "parent": parent}
    return write(path, {**said, **fields})


def curves(bigrams: BigramSet | SetFile) -> dict[Pair, dict[str, Any]]:
    return {pair: dict(bigram.curves) for pair, bigram in bigrams.bigrams.items()}


# What a file says


def test_a_file_says_what_stands_in_it(tmp_path: Path) -> None:
    said = load_set(write(tmp_path / "base.json", base()))
    assert (said.name, said.language, said.licence, said.rig) == ("base", "en", "CC0", "facefx")
    assert (said.smoothing, said.speed_limit, said.otherwise) == (0.05, None, 2.0)
    assert said.classes["f"] == ("F", "V")
    assert said.poses["PBM"] == Pose("PBM", 5, "widen")
    assert said.constraints == {("open", "PBM"): 0.5}
    pair = said.bigrams["f", "ah"]
    assert (pair.source, pair.count, dict(pair.variance)) == ("fitted", 3, {"FV": 0.01})
    assert pair.curves["FV"] == ((0.0, 0.0), (0.2, 1.0), (0.5, 0.0))
    assert said.bigrams["bmp", "ah"].note == "drawn by hand"
    assert not said.bigrams["sil", "f"].curves


def test_what_is_saved_is_what_is_loaded_and_its_text_never_changes(tmp_path: Path) -> None:
    said = load_set(write(tmp_path / "base.json", base()))
    save_set(tmp_path / "again.json", said)
    text = (tmp_path / "again.json").read_text()
    assert set_to_text(load_set(tmp_path / "again.json")) == text
    assert '   "FV": [[0, 0], [0.2, 1], [0.5, 0]]\n' in text
    assert [line for line in text.splitlines() if line.endswith('": {') and " " in line[2:-3]] == [
        ' "f ah": {', ' "bmp ah": {', ' "sil f": {'
    ]  # fmt: skip


numbers = st.integers(-20000, 20000).map(lambda number: number / 10000)


@st.composite
def sets(draw: st.DrawFn) -> SetFile:
    """Files of a few classes and poses, with numbers of at most four decimals."""
    names = draw(st.lists(st.sampled_from([*COMMON]), min_size=1, max_size=4, unique=True))
    poses = draw(
        st.lists(
            st.text(st.characters(codec="utf-8", categories=("L", "N", "P")), min_size=1),
            min_size=1, max_size=4, unique=True,
        )
    )  # fmt: skip
    times = st.lists(st.integers(0, 10000), min_size=1, max_size=6).map(sorted)
    bigrams = {}
    for first, second in draw(st.lists(st.tuples(*[st.sampled_from(names)] * 2), max_size=4)):
        drawn = {
            pose: tuple((time / 10000, draw(numbers)) for time in draw(times))
            for pose in draw(st.lists(st.sampled_from(poses), max_size=3, unique=True))
        }
        heard = {pose: abs(draw(numbers)) for pose in drawn} if draw(st.booleans()) else {}
        note = draw(st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=5))
        bigrams[first, second] = Bigram(
            first, second, drawn, "fitted", draw(st.integers(0, 99)), heard, note
        )
    return SetFile(
        "drawn", "en", "CC0", "by hypothesis", "", "facefx", abs(draw(numbers)), 15.5, None,
        {name: COMMON_CLASSES[name] for name in names},
        {pose: Pose(pose, draw(numbers)) for pose in poses},
        {pair: abs(draw(numbers)) for pair in pairwise(poses)}, draw(st.none() | st.just(2.0)),
        bigrams,
    )  # fmt: skip


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(said=sets())
def test_every_set_survives_a_file(said: SetFile, tmp_path: Path) -> None:
    save_set(tmp_path / "set.json", said)
    again = load_set(tmp_path / "set.json")
    assert set_to_text(again) == set_to_text(said)
    assert curves(again) == curves(said)
    assert dict(again.poses) == dict(said.poses)
    assert dict(again.constraints) == dict(said.constraints)
    assert {p: b.variance for p, b in again.bigrams.items()} == {
        p: b.variance for p, b in said.bigrams.items()
    }
    merge_again = load_bigrams(tmp_path / "set.json")
    assert curves(merge_again) == curves(said)


def test_the_writer_keeps_what_the_reader_of_a_reader_would_see(tmp_path: Path) -> None:
    # A second reader: plain json.
    save_set(tmp_path / "set.json", fresh_set("new", "en", "CC0", "facefx", [*FACEFX_POSES]))
    content = json.loads((tmp_path / "set.json").read_text())
    assert list(content) == [
        "format", "version", "name", "language", "licence", "source", "rig", "smoothing_s",
        "speed_limit", "silence_s", "classes", "poses", "constraints", "bigrams",
    ]  # fmt: skip
    assert content["constraints"] == {
        "open + ShCh": 0.5, "open + FV": 0.5, "open + PBM": 0.5, "otherwise": 2,
    }  # fmt: skip
    priorities = {name: pose["priority"] for name, pose in content["poses"].items()}
    order = ["open", "W", "wide", "ShCh", "FV", "PBM"]  # Xu et al. 2013, section 2.2.2
    assert sorted(order, key=priorities.__getitem__) == order
    assert len({priorities[pose] for pose in order}) == len(order)


def test_the_classes_of_a_new_set_hold_every_phone_once() -> None:
    said = fresh_set("new", "en", "", "facefx", ["open"])
    held = [phone for phones in said.classes.values() for phone in phones]
    assert sorted(held) == sorted(PHONES)


DOCUMENT = Path(__file__).parents[1] / "docs" / "bigram-format.md"


def test_the_example_of_the_documents_is_a_set_as_we_write_it(tmp_path: Path) -> None:
    text = DOCUMENT.read_text("utf-8").split("```json\n")[1].split("```")[0]
    assert set_to_text(load_set(write(tmp_path / "hero.json", text))) == text
    assert load_bigrams(tmp_path / "hero.json").constraints == {("FV", "open"): 0.5}


def test_the_error_of_the_documents_is_as_shown(tmp_path: Path) -> None:
    page = DOCUMENT.read_text("utf-8")
    text = page.split("```json\n")[1].split("```")[0]
    shown = page.split("```\nhero.json")[1]
    wrong = text.replace("[0.2, 1], [0.5, 0]", "[0.2, 1], [0.1, 0]")
    with pytest.raises(LipwrightError) as caught:
        load_set(write(tmp_path / "hero.json", wrong))
    assert str(caught.value).partition("hero.json")[2] == shown.splitlines()[0]


def test_the_defaults_of_the_documents_are_those_of_the_code() -> None:
    page = DOCUMENT.read_text("utf-8")
    assert f"section 2.2.1); {SMOOTHING:g} if no set says it" in page
    assert f"that the pairs at its ends reach into; {SILENCE_REACH:g} " in page


def test_the_class_table_of_the_documents_is_that_of_the_code() -> None:
    for name, phones in EXPRESSIVE_CLASSES.items():
        cell = "_" if name == "sil" else name
        assert f"| `{cell}` | {' '.join(phones)} |" in DOCUMENT.read_text("utf-8")


# What is wrong with a file


def at(content: dict[str, Any], *path: str | int) -> dict[str, Any]:
    """The object or list that the path leads to."""
    found: Any = content
    for step in path:
        found = found[step]
    return found


def put(*path: Any) -> Callable[[dict[str, Any]], None]:
    """A change: the last value is put where the rest leads."""
    *way, last, value = path

    def change(content: dict[str, Any]) -> None:
        at(content, *way)[last] = value

    return change


FV = ("bigrams", "f ah", "curves", "FV")
WRONG: dict[str, tuple[Callable[[dict[str, Any]], None], str, str]] = {
    "times that fall": (put(*FV, 2, [0.1, 0]), "control point 3 is at 0.1, before", "[0.1"),
    "a time after the end": (put(*FV, 2, [1.5, 0]), "point 3 is at 1.5, not within", "[1.5"),
    "not a number": (put(*FV, 1, [float("nan"), 0]), "control point 2 is .* not finite", "[NaN"),
    "endless": (put(*FV, 1, [0.3, float("inf")]), "not finite", "[0.3"),
    "a text for a time": (put(*FV, 1, ["x", 0]), "time of control point 2 is 'x'", '"x"'),
    "true for a value": (put(*FV, 1, [0.3, True]), "value of control point 2 is a truth", "true"),
    "three numbers": (put(*FV, 1, [0.3, 1, 2]), r"control point 2 is no \[time, value\]", "[0.3"),
    "no control points": (put(*FV, []), "no control points", "[],"),
    "a curve that is an object": (put(*FV, {"a": 1}), "is an object, not a list of", '{"a"'),
    "a curve that is null": (put(*FV, None), "is null, not a list of", "null"),
    "a huge number": (put(*FV, 1, [0.3, 10**400]), "a huge number, not a number", "1000"),
    "curves missing": (put("bigrams", "f ah", {}), 'has no "curves"', "{}"),
    "curves of null": (put("bigrams", "f ah", "curves", None), 'has no "curves"', "{"),
    "an unknown pose": (
        put("bigrams", "f ah", "curves", "tail", [[0, 0]]), "'tail'; known are: open", '"tail"',
    ),
    "an unknown pose of a variance": (
        put("bigrams", "f ah", "variance", "tail", 1), "unknown pose 'tail'", '"tail"',
    ),
    "an unknown class": (
        put("bigrams", "q ah", {"curves": {}}), "unknown class 'q'", '"q ah"',
    ),
    "a pair of one": (put("bigrams", "ah", {"curves": {}}), "'ah' is not two classes", '"ah": {'),
    "a pair with two spaces": (put("bigrams", "f  ah", {}), "is not two classes", '"f  ah"'),
    "an unknown key of a pair": (
        put("bigrams", "f ah", "colour", 1), "key 'colour'; known are: source, count", '"colour"',
    ),
    "an unknown key": (put("colour", 1), "unknown key 'colour'; known are: format", '"colour"'),
    "an unknown key of a pose": (put("poses", "FV", "x", 1), "known are: priority, limit", '"x"'),
    "an unknown source": (put("bigrams", "f ah", "source", "me"), "one of drawn, fitted", '"me"'),
    "a count below 0": (put("bigrams", "f ah", "count", -1), "a whole number from 0 on", "-1"),
    "a count of a half": (put("bigrams", "f ah", "count", 0.5), "a whole number", "0.5"),
    "a variance below 0": (put("bigrams", "f ah", "variance", {"FV": -1}), "below 0", "-1"),
    "a note that is a list": (put("bigrams", "f ah", "note", []), "is a list, not a text", "[]"),
    "an unknown limit": (put("poses", "FV", "limit", "up"), "not one of lower, widen", '"up"'),
    "a priority of null": (put("poses", "FV", "priority", None), "is null, not a finite", "null"),
    "a pose without a name": (put("poses", " ", {}), "has no name", '" "'),
    "an unknown phone": (put("classes", "f", ["F", "Ø"]), "'Ø' is no phone", '"\\u00d8"'),
    "a phone in two classes": (put("classes", "f", ["F", "AH"]), "AH is in the class", '"AH"\n'),
    "a phone that is a number": (put("classes", "f", ["F", 7]), "7 is no phone", "7"),
    "a class with a space": (put("classes", "f v", []), "has white space", '"f v"'),
    "a class of a text": (put("classes", "f", "F"), "'f' is a text, not a list", '"F"'),
    "a constraint of one pose": (put("constraints", "open", 1), 'not "POSE \\+ POSE"', '"open": 1'),
    "a constraint twice": (put("constraints", "PBM + open", 1), "stands twice", '"PBM + open"'),
    "a constraint of no pose": (put("constraints", "open + tail", 1), "unknown pose", '"open + t'),
    "a constraint below 0": (put("constraints", "open + FV", -1), "below 0", "-1"),
    "no name": (lambda content: content.pop("name"), 'has no "name"', "{"),
    "a name of two lines": (put("name", "a\nb"), "do not print", '"a\\nb"'),
    "half a letter": (put("source", "\ud800"), "half a letter", '"\\ud800"'),
    "no licence and no parent": (lambda content: content.pop("licence"), 'nor a "parent"', "{"),
    "a smoothing below 0": (put("smoothing_s", -1), "from 0 on", "-1"),
    "a speed limit of 0": (put("speed_limit", 0), "above 0", "0\n"),
    "a newer version": (put("version", 2), "of version 2, and this Lipwright reads up to 1", "2,"),
    "a version that is true": (put("version", True), "has no version", "true"),
    "another format": (put("format", "lipwright-track"), "is no set of phone", '"lipwright-t'),
    "classes that are a list": (put("classes", []), "'classes' is a list, not an object", "[]"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "reason", "place"), WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_is_named_with_its_line_and_column(
    change: Callable[[dict[str, Any]], None], reason: str, place: str, tmp_path: Path
) -> None:
    content = base()
    change(content)
    text = json.dumps(content, indent=1)
    path = write(tmp_path / "wrong.json", text)
    with pytest.raises(LipwrightError, match=reason) as caught:
        load_bigrams(path)
    message = str(caught.value)
    assert "\n" not in message
    line, column = _place(message)
    rest = "\n".join(text.split("\n")[line - 1 :])[column - 1 :]
    assert "".join(rest.split()).startswith("".join(place.split())), rest[:60]


def _place(message: str) -> tuple[int, int]:
    where = message.partition(": line ")[2]
    line, _, column = where.partition(", column ")
    return int(line), int(column.partition(":")[0])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "is empty"),
        (" \n", "is empty"),
        ("[]", "line 1, column 1: the file is a list"),
        ("7", "line 1, column 1: the file is a number"),
        ("{", "line 1, column 2: not JSON"),
        ('{"format": "lipwright-bigrams",\r\n "a": }', "line 2, column 7: not JSON"),
        ('{"a": 1,\r "a": 2}', "line 2, column 2: 'a' stands twice"),
        ('{"a": {"b": [{"c": 1, "c": 2}]}}', "line 1, column 23: 'c' stands twice"),
        ("[" * 100000, "nested too deeply"),
        ('{"a":' * 100000, "nested too deeply"),
        ("hello", "line 1, column 1: not JSON"),
    ],
)
def test_what_is_no_set_is_one_clear_line(text: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "set.json"
    path.write_bytes(text.encode())
    with pytest.raises(LipwrightError, match=reason) as caught:
        load_bigrams(path)
    assert "\n" not in str(caught.value)


def test_a_pair_that_stands_twice_is_named_where_it_stands_again(tmp_path: Path) -> None:
    text = json.dumps(base(), indent=1).replace('"bmp ah"', '"f ah"')
    with pytest.raises(LipwrightError, match="'f ah' stands twice") as caught:
        load_set(write(tmp_path / "twice.json", text))
    line, column = _place(str(caught.value))
    assert text.split("\n")[line - 1][column - 1 :].startswith('"f ah"')
    assert line > text.split("\n").index('  "f ah": {') + 1


def test_files_that_cannot_be_read_are_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "latin.json").write_bytes('{"name": "é"}'.encode("latin-1"))
    (tmp_path / "binary.json").write_bytes(b'{"a": \0}')
    with (tmp_path / "large.json").open("wb") as file:
        file.truncate(MAX_BYTES + 1)
    for name, reason in (
        ("latin.json", "not UTF-8"),
        ("binary.json", "binary data"),
        ("large.json", "larger than 64 MB"),
        (".", "is a folder"),
        ("gone.json", "no such file"),
    ):
        with pytest.raises(LipwrightError, match=reason):
            load_bigrams(tmp_path / name)
    with pytest.raises(LipwrightError, match="no set 'x\\\\x00y'"):
        load_bigrams("x\0y")


def test_a_mark_at_the_start_and_other_ends_of_lines_are_read(tmp_path: Path) -> None:
    text = json.dumps(base(), indent=1)
    (tmp_path / "a.json").write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert load_set(tmp_path / "a.json").name == "base"


def test_places_are_found_by_a_second_count(tmp_path: Path) -> None:
    text = '{"a": [1, {"b\\"c": "x"}],\r\n\t"é": [[0.5,\n [2, 3]]]}'
    assert parse(tmp_path, text) == {"a": [1, {'b"c': "x"}], "é": [[0.5, [2, 3]]]}
    for path, needle in (
        (("a", 0), "1"), (("a", 1, 'b"c'), '"x"'), (("é",), "[[0.5"), (("é", 0, 1, 1), "3"),
    ):  # fmt: skip
        line, column = locate(text, path)
        assert text.split("\n")[line - 1][column - 1 :].startswith(needle)
    line, column = locate(text, ("a", 1, 'b"c'), of_key=True)
    assert text.split("\n")[line - 1][column - 1 :].startswith('"b')


SEEDS = [set_to_text(load_any(Path(__file__).parents[1] / "examples" / "diphones.txt").said)]
SEEDS += [json.dumps(base()), (Path(__file__).parents[1] / "examples" / "diphones.txt").read_text()]
SEEDS += ['{"set": "a", "bigrams": [{"from": "_", "to": "ah", "curves": {"open": [[0, 1]]}}]}']


@settings(
    max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seed=st.sampled_from(SEEDS), luck=st.randoms(use_true_random=False), data=st.data())
def test_a_damaged_file_is_read_or_refused_but_never_breaks(
    seed: str, luck: random.Random, data: st.DataObject, tmp_path: Path
) -> None:
    damaged = seed
    for _ in range(luck.randint(1, 4)):
        start = luck.randrange(len(damaged) + 1)
        stop = min(len(damaged), start + luck.choice((0, 1, 3, 20)))
        bits = ("{", "}", "[", "]", '"', ",", ":", "null", "-1", "1e999", "NaN", "true", "(", "sil")
        new = data.draw(st.sampled_from(bits) | st.text(max_size=3))
        damaged = damaged[:start] + new + damaged[stop:]
    path = tmp_path / "damaged"
    path.write_bytes(damaged.encode("utf-8", errors="replace"))
    try:
        load_bigrams(path)
    except LipwrightError as error:
        wrong = str(error)
    else:
        wrong = str(path)
    assert wrong.startswith(str(path))
    assert "\n" not in wrong


# Families


def test_a_child_adds_and_replaces(tmp_path: Path) -> None:
    write(tmp_path / "base.json", base())
    path = child(
        tmp_path / "hero.json", "base.json", speed_limit=9,
        classes={"m": ["M"]}, poses={"tail": {}}, constraints={"PBM + open": 1, "FV + tail": 0.2},
        bigrams={"f ah": {"curves": {"tail": [[0, 1]]}}, "m ah": {"curves": {"open": [[0, 1]]}}},
    )  # fmt: skip
    whole = load_bigrams(path)
    assert (whole.name, whole.parent, whole.rig, whole.licence) == (
        "hero", "base.json", "facefx", "CC0",
    )  # fmt: skip
    assert (whole.speed_limit, whole.smoothing, whole.silence) == (9.0, 0.05, SILENCE_REACH)
    assert whole.class_of("M") == "m"
    assert whole.classes["bmp"] == ("P", "B")
    assert list(whole.poses) == ["open", "FV", "PBM", "tail"]
    assert whole.constraints == {("PBM", "open"): 1.0, ("FV", "tail"): 0.2}
    assert curves(whole)["f", "ah"] == {"tail": ((0.0, 1.0),)}  # as a whole
    assert curves(whole)["bmp", "ah"] == {"PBM": ((0.0, 1.0), (0.5, 0.0))}
    assert origins(load_family(path)) == {
        ("f", "ah"): "hero", ("m", "ah"): "hero", ("bmp", "ah"): "base", ("sil", "f"): "base",
    }  # fmt: skip


def test_a_flat_copy_is_the_same_set(tmp_path: Path) -> None:
    write(tmp_path / "base.json", base())
    path = child(tmp_path / "hero.json", "base.json", bigrams={"ah f": {"curves": {}}})
    whole = load_bigrams(path)
    export_set(tmp_path / "flat.json", whole)
    flat = load_bigrams(tmp_path / "flat.json")
    assert set_to_text(flatten(flat)) == set_to_text(flatten(whole))
    assert not flat.parent


def test_circles_of_parents_are_named(tmp_path: Path) -> None:
    child(tmp_path / "a.json", "b.json")
    child(tmp_path / "b.json", "c.json")
    child(tmp_path / "c.json", "b.json")
    child(tmp_path / "self.json", "./self.json")
    with pytest.raises(LipwrightError, match=r"circle: b\.json -> c\.json -> b\.json;"):
        load_bigrams(tmp_path / "a.json")
    with pytest.raises(LipwrightError, match=r"circle: self\.json -> self\.json;"):
        load_bigrams(tmp_path / "self.json")


def test_a_circle_through_a_link_is_found(tmp_path: Path) -> None:
    child(tmp_path / "a.json", "link.json")
    (tmp_path / "link.json").symlink_to("a.json")
    with pytest.raises(LipwrightError, match="circle"):
        load_bigrams(tmp_path / "a.json")


def test_too_many_parents_are_refused(tmp_path: Path) -> None:
    write(tmp_path / "0.json", base())
    for number in range(1, MAX_PARENTS + 2):
        child(tmp_path / f"{number}.json", f"{number - 1}.json")
    assert load_bigrams(tmp_path / f"{MAX_PARENTS}.json").bigrams
    with pytest.raises(LipwrightError, match="more than 20 parents"):
        load_bigrams(tmp_path / f"{MAX_PARENTS + 1}.json")


@pytest.mark.parametrize("parent", ["gone.json", "no-such-set", "..", "x" * 5000, "a\tb"])
def test_a_parent_that_is_not_there_is_named_with_its_place(parent: str, tmp_path: Path) -> None:
    path = child(tmp_path / "orphan.json", parent)
    with pytest.raises(LipwrightError, match=r"orphan\.json: line 5, column 12: .*(no set|print)"):
        load_bigrams(path)


def test_what_a_parent_lacks_is_the_childs_fault(tmp_path: Path) -> None:
    write(tmp_path / "base.json", base())
    path = child(tmp_path / "hero.json", "base.json", bigrams={"zz ah": {"curves": {}}})
    with pytest.raises(LipwrightError, match=r"hero\.json: line 7, column 3: .* class 'zz'"):
        load_bigrams(path)


def test_relative_paths_lead_to_the_same_files_from_another_folder(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two" / "deep").mkdir(parents=True)
    write(tmp_path / "base.json", base())
    old = child(tmp_path / "one" / "a.json", "../base.json", rig="crab.json")
    new = tmp_path / "two" / "deep" / "a.json"
    said = moved(load_set(old), old, new)
    assert (said.parent, said.rig) == ("../../base.json", "../../one/crab.json")
    save_set(new, said)
    assert curves(load_bigrams(new)) == curves(load_bigrams(old))
    assert os.path.realpath(load_bigrams(new).rig) == os.path.realpath(load_bigrams(old).rig)


def test_an_edit_waits_for_another_and_a_replaced_file_is_locked_anew(tmp_path: Path) -> None:
    import threading

    path = write(tmp_path / "base.json", base())
    order: list[str] = []

    def second() -> None:
        with editing(path):
            order.append(load_set(path).name)

    with editing(path):
        waiting = threading.Thread(target=second)
        waiting.start()
        waiting.join(0.1)
        assert not order
        save_set(path, SetFile("changed", "en", "", "", "", "facefx"))
    waiting.join()
    assert order == ["changed"]
    assert list(tmp_path.iterdir()) == [path]


def test_every_set_that_ships_loads() -> None:
    for name, path in shipped_sets().items():
        whole = load_bigrams(name)
        assert whole.name == name
        assert path.read_text("utf-8") == set_to_text(load_set(path)), "write it with save_set"


# What stands in


@pytest.fixture
def small(tmp_path: Path) -> BigramSet:
    return load_bigrams(write(tmp_path / "base.json", base()))


def track(*phones: str) -> PhoneTrack:
    return PhoneTrack(phones, np.arange(len(phones) + 1) / 10)


def test_pairs_are_counted_by_class_and_a_long_silence_is_one(small: BigramSet) -> None:
    said = track("sil", "sil", "F", "AH", "V", "AE", "sil", "sil", "M")
    assert needed_pairs(small, [said]) == {
        ("sil", "f"): 1, ("f", "ah"): 2, ("ah", "f"): 1, ("ah", "sil"): 1, ("sil", "bmp"): 1,
    }  # fmt: skip
    assert missing(small, said) == [
        (("ah", "f"), 1, None),
        (("ah", "sil"), 1, None),
        (("sil", "bmp"), 1, ("sil", "f")),
    ]


def test_the_stand_in_changes_one_side_before_both_and_the_most_alike_first() -> None:
    said = fresh_set("new", "en", "", "facefx", ["open"])

    def having(*pairs: Pair) -> BigramSet:
        bigrams = {pair: Bigram(*pair, {}) for pair in pairs}
        return BigramSet("new", "en", "", "", "facefx", said.classes, said.poses, bigrams)

    whole = having(("f", "ah"), ("th", "ah"), ("aa", "aa"))
    assert stand_in(whole, ("f", "ah")) == (whole.bigrams["f", "ah"], ("f", "ah"))
    near = {
        name: min(phone_distance(a, b) for a in said.classes["bmp"] for b in said.classes[name])
        for name in ("f", "th")
    }
    assert stand_in(whole, ("bmp", "ah"))[1] == (min(near, key=near.__getitem__), "ah")
    assert stand_in(having(("aa", "aa")), ("ao", "ay"))[1] == ("aa", "aa")
    assert stand_in(having(("sil", "ah")), ("f", "ah")) == (None, None)
    assert stand_in(having(("f", "ah")), ("sil", "ah")) == (None, None)
    assert stand_in(having(("bmp", "ah")), ("ah", "f")) == (None, None)
    assert stand_in(having(), ("f", "ah")) == (None, None)
    assert stand_in(having(("f", "ah")), ("", "ah")) == (None, None)


def test_stand_ins_are_those_of_an_exhaustive_search() -> None:
    said = fresh_set("new", "en", "", "facefx", ["open"])
    luck = random.Random(6)
    names = list(said.classes)
    pairs = [(a, b) for a in names for b in names]
    there = luck.sample(pairs, 40)
    whole = BigramSet("new", "en", "", "", "facefx", said.classes, said.poses,
                      {pair: Bigram(*pair, {}) for pair in there})  # fmt: skip

    @cache
    def likeness(one: str, other: str) -> float:
        if one == other:
            return 0.0
        if "sil" in (one, other):
            return np.inf
        least = min(phone_distance(a, b) for a in said.classes[one] for b in said.classes[other])
        return least if least < UNLIKE else np.inf

    for pair in pairs:
        costs = [
            (
                (one != pair[0]) + (other != pair[1]),
                likeness(one, pair[0]) + likeness(other, pair[1]),
            )
            for one, other in there
        ]
        best = min((cost for cost in costs if cost[1] < np.inf), default=None)
        found = stand_in(whole, pair)[1]
        if best is None:
            assert found is None
        else:
            assert found is not None
            cost = likeness(found[0], pair[0]) + likeness(found[1], pair[1])
            assert ((found[0] != pair[0]) + (found[1] != pair[1]), cost) == pytest.approx(best)


# Coverage


def test_coverage_orders_pairs_and_adds_them_up(small: BigramSet) -> None:
    found = cover(small, {("f", "ah"): 6, ("ah", "f"): 3, ("sil", "f"): 1})
    assert [(row.rank, row.pair, row.share) for row in found.rows] == [
        (1, ("f", "ah"), 0.6), (2, ("ah", "f"), 0.3), (3, ("sil", "f"), 0.1),
    ]  # fmt: skip
    assert [row.cumulative for row in found.rows] == [0.6, 0.9, 1.0]
    assert [row.source for row in found.rows] == ["fitted", "", "drawn"]
    assert (found.enough(0.6), found.enough(0.61), found.enough()) == (1, 2, 3)
    assert found.possible == 3 * 3 + 2 * 3
    assert found.never == 12
    assert [row.pair for row in found.missing] == [("ah", "f")]


def test_text_is_silent_at_its_ends_and_punctuation_but_not_after_abbreviations() -> None:
    counting = Counting()
    counting.add_text("Mr. Lee, no.\n\n---\nNo", "en")
    words = ["sil M IH S T ER L IY sil", "sil N OW sil", "sil N OW sil"]
    expected: dict[Pair, int] = {}
    for line in words:
        for pair in pairwise(line.split()):
            expected[pair] = expected.get(pair, 0) + 1
    assert counting.pairs == expected
    assert not counting.refused


def test_lines_that_cannot_be_read_are_left_out_and_named() -> None:
    counting = Counting()
    counting.add_text("Hello\nпривет", "en", "corpus.txt")
    assert counting.pairs["HH", "AH"] == 1
    (reason,) = counting.refused
    assert reason.startswith("corpus.txt: line 2")
    with pytest.raises(LipwrightError, match="unknown language"):
        counting.add_text("Hello", "xx")


# SmartBody

TEXT = '''
def run():
    # diphone.addKey("not", 0, "this")
	d = scene.getDiphoneManager()   # a tab
    one = d.createDiphone('f', "ah", "mine"); one.addKey("open", -.0, 1e-1)
    two = d.createDiphone("_", "f",
        "mine")
    one.addKey( "open" ,
        +.5 , .6,)
    """ createDiphone("a", "b", "c") """
    two.addKey('FV', 1, -0.25)
    createDiphone("f", "ah", "other")
    addKey("open", 1.02, 0)
'''


def test_text_of_smartbody_is_read_by_its_calls() -> None:
    assert is_smartbody_text(TEXT)
    mine = text_to_set("x.py", TEXT, "mine").said
    assert curves(mine) == {
        ("f", "ah"): {"open": ((0.0, 0.1), (0.5, 0.6))}, ("sil", "f"): {"FV": ((1.0, -0.25),)},
    }  # fmt: skip
    other = text_to_set("x.py", TEXT, "other")
    assert curves(other.said) == {("f", "ah"): {"open": ((1.0, 0.0),)}}
    assert other.notes == ("1 control points lay a little out of 0 to 1 and are now at it",)
    with pytest.raises(LipwrightError, match="--name: mine, other"):
        text_to_set("x.py", TEXT)
    with pytest.raises(LipwrightError, match="no set 'third'"):
        text_to_set("x.py", TEXT, "third")


def test_a_pair_that_stands_twice_in_text_is_the_later_one() -> None:
    text = 'createDiphone("f", "ah")\naddKey("open", 0, 1)\ncreateDiphone("f", "ah")\n'
    found = text_to_set("x.py", text)
    assert curves(found.said) == {("f", "ah"): {}}
    assert found.notes == ("the pair 'f ah' stands twice; the later one is taken, as in SmartBody",)
    assert found.said.name == "default"


MAKE = 'createDiphone("f", "ah", "a")\n'


@pytest.mark.parametrize(
    ("text", "place", "reason"),
    [
        ('addKey("open", 0, 0)', (1, 1), "addKey before any"),
        (MAKE + ' addKey("open", 0)', (2, 2), "takes .pose., time and value"),
        (MAKE + 'addKey("open", 0, x)', (2, 19), "'x' is no plain text or number"),
        (MAKE + 'addKey("open", 0, 0 * 2)', (2, 21), r"'\*' is no plain"),
        (
            MAKE + 'addKey("open", 0, __import__("os").getcwd())',
            (2, 19),
            "'__import__' is no plain",
        ),
        (MAKE + 'addKey(f"open", 0, 0)', (2, 8), "no plain text"),
        (MAKE + 'addKey("open", 0, 0', (2, 7), "never ends"),
        (MAKE + 'addKey("open", 0 0)', (2, 18), "'0' is no plain"),
        (MAKE + 'addKey("open", --0, 0)', (2, 17), "'-' is no plain"),
        (MAKE + 'addKey("open", 0.5, 0)\n\naddKey("open", 0.4, 0)', (4, 1), "before the last one"),
        (MAKE + 'addKey("open", 3, 0)', (2, 1), "the key is at 3, not within"),
        (MAKE + 'addKey("open", 1e999, 0)', (2, 1), "not finite"),
        ('createDiphone("f ah", "ah", "a")', (1, 1), "white space"),
        ('createDiphone("f")', (1, 1), 'takes "class", "class" and "set"'),
        ('createDiphone("f", 2)', (1, 1), "takes"),
    ],
)
def test_what_is_wrong_in_text_is_named_with_line_and_column(
    text: str, place: tuple[int, int], reason: str
) -> None:
    with pytest.raises(LipwrightError, match=reason) as caught:
        text_to_set("x.py", text)
    assert _place(str(caught.value)) == place


@settings(max_examples=25, deadline=None)
@given(said=sets())
def test_sets_survive_the_text_of_smartbody(said: SetFile) -> None:
    from lipwright.bigrams import smartbody_text
    from lipwright.bigrams.families import Member

    whole = merge([Member(Path("x.json"), said)])
    text = smartbody_text.set_to_text(whole)
    if whole.bigrams:
        again = text_to_set("x.py", text).said
        assert curves(again) == curves(whole)
        assert again.name == whole.name


@needs_smartbody
@pytest.mark.parametrize(
    ("name", "pairs", "rig"),
    [("default", 458, "facefx"), ("neutral", 169, "smartbody"), ("angry", 169, "smartbody")],
)
def test_the_sets_of_smartbody_load_and_hold_every_phone(name: str, pairs: int, rig: str) -> None:
    whole = load_bigrams(SMARTBODY / f"{name}.json")
    assert len(whole.bigrams) == pairs
    assert whole.rig == rig
    used = {one for pair in whole.bigrams for one in pair}
    for phone in PHONES:
        if not (phone == "sil" and name == "default"):
            assert whole.class_of(phone) in used
    assert whole.class_of("sil") == ("" if name == "default" else "sil")
    content = json.loads((SMARTBODY / f"{name}.json").read_text())
    theirs = {"_": "sil"}
    for entry in content["bigrams"]:
        pair = tuple(theirs.get(entry[end], entry[end]) for end in ("from", "to"))
        if pair == ("kg", "w"):
            continue  # it stands twice
        for pose, points in entry["curves"].items():
            found = np.array(whole.bigrams[pair].curves[pose])
            assert np.abs(found - points).max() <= 0.0157  # clipped times, nothing else
            assert (found[:, 1] == np.array(points)[:, 1]).all()


@needs_smartbody
@pytest.mark.parametrize("name", ["default", "neutral", "angry"])
def test_the_sets_of_smartbody_survive_every_file(name: str, tmp_path: Path) -> None:
    whole = load_bigrams(SMARTBODY / f"{name}.json")
    export_set(tmp_path / "set.py", whole)
    assert curves(load_bigrams(tmp_path / "set.py")) == curves(whole)
    export_set(tmp_path / "set.json", whole)
    ours = load_bigrams(tmp_path / "set.json")
    for pair, drawn in curves(whole).items():
        for pose, points in drawn.items():
            assert np.abs(np.array(curves(ours)[pair][pose]) - points).max() <= 0.00005001
    export_set(tmp_path / "set.csv", whole)
    rows = (tmp_path / "set.csv").read_text().splitlines()
    points = sum(len(curve) for drawn in curves(whole).values() for curve in drawn.values())
    assert len(rows) == 1 + points + sum(not drawn for drawn in curves(whole).values())


@needs_smartbody
def test_the_later_of_two_pairs_is_taken_and_said() -> None:
    found = load_any(SMARTBODY / "default.json")
    assert "the pair 'kg w' stands twice; the later one is taken, as in SmartBody" in found.notes
    content = json.loads((SMARTBODY / "default.json").read_text())
    both = [e for e in content["bigrams"] if (e["from"], e["to"]) == ("kg", "w")]
    assert set(found.said.bigrams["kg", "w"].curves) == set(both[-1]["curves"])


def test_the_table_of_the_expressive_sets_holds_every_arpabet_phone_once() -> None:
    held = [phone for phones in EXPRESSIVE_CLASSES.values() for phone in phones]
    assert len(held) == len(set(held))
    assert set(held) <= set(PHONES)
    foreign = {phone for phone in PHONES if phone.startswith("X")}
    assert set(PHONES) - set(held) == foreign  # other languages': their nearest phone's class


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ({"bigrams": [{"from": "a", "to": "b"}]}, 'has no "curves"'),
        ({"bigrams": [7]}, "is a number, not an object"),
        ({"bigrams": [{"from": "a b", "to": "b", "curves": {}}]}, "white space"),
        ({"bigrams": [{"from": 1, "to": "b", "curves": {}}]}, "is a number, not a text"),
        ({"bigrams": [{"from": "a", "to": "b", "curves": {"x": [[1, 0], [0, 0]]}}]}, "point 2 is"),
        ({"bigrams": [], "colour": 1}, "known are: set, classes"),
        ({"bigrams": [{"from": "a", "to": "b", "curves": {"x": [[9, 0]]}}]}, "not within 0 to 1"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_json_of_smartbody_is_named(
    content: dict[str, Any], reason: str, tmp_path: Path
) -> None:
    with pytest.raises(LipwrightError, match=rf"x\.json: line 1, column \d+: .*{reason}"):
        load_bigrams(write(tmp_path / "x.json", json.dumps(content)))


# What people type


def test_points_and_pairs_are_read_as_they_are_typed() -> None:
    assert parse_pair(" f  ah ") == ("f", "ah")
    assert parse_points("0 0, 0.4 .6,1 0") == ((0.0, 0.0), (0.4, 0.6), (1.0, 0.0))
    for wrong in ("", "0", "0 0,", "0 0 0", "0 x"):
        with pytest.raises(LipwrightError, match="control point"):
            parse_points(wrong)
    for wrong in ("", "f", "f ah b"):
        with pytest.raises(LipwrightError, match="no pair"):
            parse_pair(wrong)
