"""Datasets keep what was captured: splits, checks and merges on folders of real files."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given
from hypothesis import strategies as st

from lipwright.audio import Audio, write_flac
from lipwright.capture.quality import measure_quality
from lipwright.cli.datasets import dataset as command
from lipwright.dataset.checking import check_dataset
from lipwright.dataset.folder import (
    FORMAT,
    RECORDINGS,
    STATUSES,
    Dataset,
    open_dataset,
    recording_files,
    sha256_of,
)
from lipwright.dataset.lock import locked
from lipwright.dataset.merging import MergeOptions, join_licences, merge_datasets
from lipwright.dataset.recording import Motion, save_motion, write_info
from lipwright.dataset.splits import (
    SPLITS,
    SplitOptions,
    check_hold_outs,
    default_count,
    split_dataset,
    split_names,
    split_options,
    split_order,
)
from lipwright.dataset.summary import rarest, summarise
from lipwright.dataset.transforms import TRANSFORMS
from lipwright.errors import LipwrightError
from lipwright.formats import write_track
from lipwright.track import PhoneTrack, Word

CORPORA = Path(__file__).parents[2] / "shared" / "corpora"
FPS, FRAMES = 25.0, 25
TRACK = PhoneTrack(
    ("sil", "M", "IY", "sil", "B", "AH", "sil"),
    np.array([0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0]),
    (Word("me", 1, 3, 0.9), Word("bu,", 4, 6, 0.8)),
)


def write_recording(folder: Path, *, fps: float = FPS, tracker: str = "mesh 1") -> None:
    folder.mkdir(parents=True)
    flags = np.zeros(FRAMES, np.uint8)
    flags[3] = 1
    weights = np.random.default_rng(len(folder.name)).random((FRAMES, 52), np.float32)
    save_motion(folder / "motion.npz", Motion(fps, flags, weights))
    write_track(folder / "phones.TextGrid", TRACK)
    write_flac(folder / "audio.flac", Audio(np.zeros(int(8000 * FRAMES / fps), np.float32), 8000))
    info = {
        "name": folder.name, "tracker": tracker, "fps": fps, "frames": FRAMES, "start": 0.0,
        "offset": {"seconds": 0.02, "r": 0.9, "r_at_zero": 0.8, "trusted": True},
        "words": [{"text": "me", "start": 0.2, "end": 0.4, "confidence": 0.9},
                  {"text": "Bu,", "start": 0.5, "end": 0.8, "confidence": 0.8}],
        "quality": {"bilabials": 2, "bilabials_closed": 1}, "warnings": [], "reject": [],
    }  # fmt: skip
    write_info(folder, info)


def make(
    path: Path, *names: str, licence: str = "CC-BY-4.0", fps: float = FPS, tracker: str = "mesh 1"
) -> Dataset:
    entries = []
    for name in names:
        folder = path / RECORDINGS / name
        write_recording(folder, fps=fps, tracker=tracker)
        files = {**recording_files(folder), "recording.json": sha256_of(folder / "recording.json")}
        entries.append({"name": name, "status": "captured", "reasons": [], "files": files})
    manifest = {
        "format": FORMAT, "version": 1, "lipwright": "0.1.0", "name": path.name,
        "licence": licence, "options": {}, "recordings": entries,
    }  # fmt: skip
    dataset = split_dataset(Dataset(path, manifest), SplitOptions())
    dataset.save()
    return dataset


def write_face(dataset: Dataset, model: str, rows: int = FRAMES) -> Dataset:
    names = dataset.names()
    for name in names:
        shape = np.zeros((rows, 3), np.float32)
        dataset.save_face(name, {"shape": shape, "model": np.array(model)})
    with_face = dataset.with_files(names)
    with_face.save()
    return with_face


def call(*arguments: object) -> Result:
    return CliRunner().invoke(command, [str(argument) for argument in arguments])


def one_line(caught: pytest.ExceptionInfo[LipwrightError]) -> str:
    assert "\n" not in str(caught.value)
    return str(caught.value)


def everything_in(path: Path) -> dict[str, bytes]:
    return {str(p.relative_to(path)): p.read_bytes() for p in path.rglob("*") if p.is_file()}


@pytest.fixture
def faces(tmp_path: Path) -> Dataset:
    return make(tmp_path / "faces", "anna", "bert", "cleo")


names_of_recordings = st.sets(st.text("abcdef012", min_size=1, max_size=6), max_size=60)


class TestSplitting:
    @pytest.mark.skipif(not CORPORA.is_dir(), reason="the corpora are not here")
    def test_grid_is_split_as_the_benchmarks_split_it(self) -> None:
        names = [path.stem for path in (CORPORA / "grid-s1" / "video").glob("*.mp4")]
        splits = split_names(names)
        order = sorted(names, key=split_order)
        assert order[:3] == ["lgbs6n", "lwws5s", "prip2p"]
        assert {name for name in names if splits[name] == "test"} == set(order[:50])
        assert {name for name in names if splits[name] == "validation"} == set(order[50:100])
        assert list(splits.values()).count("train") == 780

    def test_the_key_is_the_hash_that_the_design_names(self) -> None:
        import hashlib

        assert split_order("a") == hashlib.sha256(b"lipwright-split:a").hexdigest()

    @pytest.mark.parametrize(("names", "count"), [(0, 0), (9, 0), (10, 1), (499, 49), (880, 50)])
    def test_test_and_validation_take_50_and_a_tenth_at_most(self, names: int, count: int) -> None:
        assert default_count(names) == count

    @given(names_of_recordings)
    def test_every_name_is_in_one_split_whatever_the_order(self, names: set[str]) -> None:
        splits = split_names(sorted(names))
        assert splits.keys() == names
        assert splits == split_names(sorted(names, reverse=True))
        values = list(splits.values())
        assert values.count("test") == values.count("validation") == default_count(len(names))

    @given(names_of_recordings, names_of_recordings)
    def test_more_names_bring_none_from_training_into_a_test(
        self, names: set[str], more: set[str]
    ) -> None:
        options = SplitOptions(test=2, validation=2)
        names |= {"w", "x", "y", "z", "zz"}
        before, after = split_names(names, options), split_names(names | more, options)
        assert all(after[name] == "train" for name in names if before[name] == "train")

    @given(names_of_recordings, names_of_recordings)
    def test_kept_names_stay_and_new_ones_fill_what_is_missing(
        self, names: set[str], more: set[str]
    ) -> None:
        before = split_names(names)
        after = split_names(names | more, kept=before)
        assert all(after[name] == before[name] for name in names)
        if len(more - names) >= 12:
            assert list(after.values()).count("test") == default_count(len(after))

    def test_another_seed_gives_another_order(self) -> None:
        names = [str(i) for i in range(100)]
        assert split_names(names, SplitOptions(seed="x")) != split_names(names)

    def test_words_and_patterns_are_held_out_of_training(self, faces: Dataset) -> None:
        held = split_dataset(faces, SplitOptions(hold_out=("b*",)))
        assert held.names("unseen") == ("bert",)
        write_info(faces.folder("cleo"), {"name": "cleo", "words": [{"text": "You"}]})
        held = split_dataset(faces, SplitOptions(hold_out_words=("ME", "bu")))
        assert held.names("unseen") == ("anna", "bert")
        assert held.names("train") == ("cleo",)

    def test_the_manifest_keeps_how_it_was_split(self, faces: Dataset) -> None:
        options = SplitOptions(1, 1, "x", ("a*",), ("me",))
        assert split_options({}) == SplitOptions()
        manifest = json.loads(json.dumps({"split": asdict(options)}))
        assert split_options(manifest) == options

    def test_what_has_a_split_can_keep_it(self, faces: Dataset) -> None:
        for entry, old in zip(faces.manifest["recordings"], ("test", "unseen", None), strict=True):
            entry["split"] = old
        kept = split_dataset(faces, SplitOptions(validation=1), keep=True)
        assert kept.names("test") == ("anna",)
        assert {*kept.names("validation"), *kept.names("train")} == {"bert", "cleo"}

    @pytest.mark.parametrize(
        ("options", "reason"),
        [
            (SplitOptions(test=2, validation=1), "leave none of the 3"),
            (SplitOptions(hold_out=("*",)), "nothing is left"),
            (SplitOptions(hold_out=("x*",)), "a name like 'x*'"),
            (SplitOptions(hold_out_words=("you",)), "says 'you'"),
        ],
    )
    def test_splits_that_cannot_be_are_refused(
        self, faces: Dataset, options: SplitOptions, reason: str
    ) -> None:
        with pytest.raises(LipwrightError, match=r"faces") as caught:  # noqa: PT012
            check_hold_outs(faces, options)
            split_dataset(faces, options)
        assert reason in one_line(caught)

    def test_a_broken_split_in_the_manifest_is_named(self) -> None:
        for broken in ([], {"test": "x"}, {"test": -1}, {"hold_out": 3}):
            with pytest.raises(LipwrightError, match=r"dataset\.json: 'split' is broken"):
                split_options({"split": broken})

    def test_the_command_writes_the_manifest_and_says_the_counts(self, faces: Dataset) -> None:
        names = faces.path / "names.txt"
        names.write_text("anna\nbe*\n")
        done = call("split", faces.path, "--hold-out", names)
        assert done.exit_code == 0
        assert "1 train, 2 unseen" in done.stderr
        assert open_dataset(faces.path).names("unseen") == ("anna", "bert")
        done = call("split", faces.path, "--test", 1, "--seed", "x")
        assert "1 test, 2 train" in done.stderr
        done = call("split", faces.path, "--keep", "--test", 0)
        assert "1 test, 2 train" in done.stderr
        names.write_text("\n")
        for value in (names, faces.path / "recordings/anna/audio.flac"):
            refused = call("split", faces.path, "--hold-out", value)
            assert isinstance(refused.exception, LipwrightError)

    def test_two_programs_do_not_write_at_once(self, faces: Dataset) -> None:
        before = (faces.path / "dataset.json").read_bytes()
        with locked(faces.path):
            refused = call("split", faces.path, "--test", 1)
        assert isinstance(refused.exception, LipwrightError)
        assert "another program" in str(refused.exception)
        assert (faces.path / "dataset.json").read_bytes() == before


def damage(change: Callable[[Path], Any], *wanted: str) -> Any:
    return pytest.param(change, wanted, id=wanted[0])


def rewrite(path: Path, change: Callable[[dict[str, Any]], Any]) -> None:
    value = json.loads(path.read_text())
    change(value)
    path.write_text(json.dumps(value))


def set_entry(key: str, value: object) -> Callable[[Path], None]:
    return lambda path: rewrite(
        path / "dataset.json", lambda manifest: manifest["recordings"][1].update({key: value})
    )


def rehash(path: Path) -> None:
    """The manifest takes all files as they are, so that only what they say can be wrong."""
    dataset = open_dataset(path)
    for entry in dataset.entries:
        for file in entry["files"]:
            dataset = dataset.with_files((entry["name"],), file)
    dataset.save()


ANNA = Path(RECORDINGS) / "anna"


def plant_link(path: Path) -> None:
    (path / ANNA / "audio.flac").rename(path.parent / "audio.flac")
    (path / ANNA / "audio.flac").symlink_to(path.parent / "audio.flac")


def plant_folder_link(path: Path) -> None:
    (path / ANNA).rename(path.parent / "anna")
    (path / ANNA).symlink_to(path.parent / "anna")


def with_objects(path: Path) -> None:
    arrays = dict(np.load(path / ANNA / "motion.npz"))
    np.savez(path / ANNA / "motion.npz", **{**arrays, "arkit": np.array([{}])})
    rehash(path)


def with_other_frames(path: Path) -> None:
    motion = Motion(FPS, np.zeros(20, np.uint8), np.zeros((20, 52)))
    save_motion(path / ANNA / "motion.npz", motion)
    rehash(path)


def with_other_shapes(path: Path) -> None:
    arrays = dict(np.load(path / ANNA / "motion.npz"))
    np.savez(path / ANNA / "motion.npz", **{**arrays, "arkit": np.zeros((25, 51))})
    rehash(path)


def with_long_phones(path: Path) -> None:
    write_track(path / ANNA / "phones.TextGrid", TRACK.padded(0, 1.2))


def with_short_sound(path: Path) -> None:
    write_flac(path / ANNA / "audio.flac", Audio(np.zeros(3000, np.float32), 8000))
    write_track(path / ANNA / "phones.TextGrid", PhoneTrack(("sil",), np.array([0.0, 0.3])))
    rehash(path)


def with_another_name(path: Path) -> None:
    rewrite(path / ANNA / "recording.json", lambda info: info.update(name="zoe"))
    rehash(path)


class TestChecking:
    def test_a_whole_dataset_has_no_problems(self, faces: Dataset) -> None:
        done = call("check", faces.path)
        assert (done.exit_code, done.stdout) == (0, "")
        assert "3 recordings, no problems" in done.stderr

    @pytest.mark.parametrize(
        ("change", "wanted"),
        [
            damage(lambda p: (p / ANNA / "audio.flac").unlink(), "audio.flac: no such file"),
            damage(
                lambda p: (p / ANNA / "motion.npz").write_bytes(b"x"), "motion.npz: has changed"
            ),
            damage(lambda p: (p / ANNA / "x.txt").write_text("x"), "x.txt: the manifest does not"),
            damage(lambda p: (p / ANNA / ".1.part.npz").write_text("x"), ".1.part.npz: was left"),
            damage(lambda p: (p / ANNA / "deep").mkdir(), "deep: is no file"),
            damage(lambda p: (p / ANNA / "x.pkl").write_text(""), "x.pkl: is a pickle"),
            damage(
                lambda p: (p / ANNA / "x.bin").write_bytes(pickle.dumps({})), "x.bin: is a pickle"
            ),
            damage(lambda p: (p / RECORDINGS / "zoe").mkdir(), "zoe: is not in the manifest"),
            damage(lambda p: (p / RECORDINGS / ".zoe.part.1").mkdir(), ".zoe.part.1: was left"),
            damage(lambda p: (p / ANNA).rename(p / "moved"), "anna: no such folder"),
            damage(plant_link, "audio.flac: is no file of this folder"),
            damage(plant_folder_link, "anna: leads out of the dataset"),
            damage(set_entry("split", "exam"), "'bert' has the split 'exam'"),
            damage(with_objects, "motion.npz: not a readable motion"),
            damage(with_other_shapes, "(25, 51)"),
            damage(with_other_frames, "motion.npz: has 20 frames, not 25"),
            damage(with_long_phones, "phones.TextGrid"),
            damage(with_short_sound, "the picture lasts 1.0 s and the sound 0.4 s"),
            damage(with_another_name, "is of 'zoe'"),
        ],
    )
    def test_each_fault_is_one_line_that_names_it(
        self, faces: Dataset, change: Callable[[Path], Any], wanted: tuple[str, ...]
    ) -> None:
        change(faces.path)
        done = call("check", faces.path)
        assert done.exit_code == 2
        assert len(done.stdout.splitlines()) == 1, done.stdout
        assert wanted[0] in done.stdout
        assert "1 problem" in done.stderr

    @pytest.mark.parametrize(
        ("key", "value"),
        [("name", "../anna"), ("name", "/etc"), ("name", ""), ("name", "anna"), ("name", 3),
         ("files", {"../../x": "0"}), ("files", []), ("status", "good")],
    )  # fmt: skip
    def test_a_manifest_that_leads_out_of_its_folder_is_refused(
        self, faces: Dataset, key: str, value: object
    ) -> None:
        set_entry(key, value)(faces.path)
        with pytest.raises(LipwrightError, match=r"dataset\.json") as caught:
            open_dataset(faces.path)
        one_line(caught)

    def test_programs_get_nothing_but_json(self, faces: Dataset) -> None:
        write_track(faces.folder("bert") / "phones.TextGrid", TRACK.padded(0, 1.01))
        for options in ((), ("--accept",)):
            done = call("check", faces.path, "--progress", "json", *options)
            assert [json.loads(line) for line in done.stderr.splitlines()]

    def test_several_faults_are_several_lines(self, faces: Dataset) -> None:
        (faces.path / ANNA / "audio.flac").unlink()
        (faces.path / RECORDINGS / "zoe").mkdir()
        assert len(call("check", faces.path).stdout.splitlines()) == 2

    def test_edited_phones_are_told_and_no_fault(self, faces: Dataset) -> None:
        moved = TRACK.with_edges([0.0, 0.21, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0])
        write_track(faces.folder("bert") / "phones.TextGrid", moved)
        done = call("check", faces.path)
        assert (done.exit_code, done.stdout) == (0, "")
        assert "bert: phones edited since capture" in done.stderr
        assert check_dataset(faces).edited == ("bert",)
        accepted = call("check", faces.path, "--accept")
        assert "1 edited recording accepted" in accepted.stderr
        assert not check_dataset(open_dataset(faces.path)).edited

    def test_a_broken_edit_is_not_accepted(self, faces: Dataset) -> None:
        (faces.folder("bert") / "phones.TextGrid").write_text("File type\n")
        done = call("check", faces.path, "--accept")
        assert done.exit_code == 2
        assert "phones.TextGrid" in done.stdout
        assert open_dataset(faces.path).manifest == faces.manifest

    def test_parameters_of_other_frames_are_a_fault(self, faces: Dataset) -> None:
        write_face(faces, "m", rows=FRAMES - 1)
        problems = check_dataset(open_dataset(faces.path)).problems
        assert len(problems) == 3
        assert "'shape' has the shape (24, 3), not 25 rows" in problems[0]

    def test_what_failed_needs_no_files(self, faces: Dataset) -> None:
        manifest = json.loads(json.dumps(faces.manifest))
        manifest["recordings"].append(
            {"name": "dora", "status": "failed", "reasons": ["no face"], "files": {}}
        )
        assert not check_dataset(Dataset(faces.path, manifest)).problems

    def test_no_dataset_is_one_line(self, tmp_path: Path) -> None:
        refused = call("check", tmp_path)
        assert "has no dataset.json" in str(refused.exception)


class TestSummary:
    def test_the_figures_by_hand(self, faces: Dataset) -> None:
        write_face(faces, "m")
        manifest = json.loads(json.dumps(open_dataset(faces.path).manifest))
        manifest["recordings"][2] |= {"status": "rejected", "reasons": ["too far away"]}
        manifest["recordings"][1] |= {"reasons": ["turned away"]}
        found = summarise(Dataset(faces.path, manifest))
        assert found["statuses"] == {"captured": 2, "rejected": 1}
        assert (found["recordings"], found["advised"]) == (3, 1)
        assert (found["seconds"], found["frames"], found["words"]) == (2.0, 50, 4)
        assert (found["phones"], found["phone_counts"]["sil"]) == (8, 6)
        assert found["tracked"] == 0.96
        assert (found["bilabials"], found["closures_kept"]) == (4, 0.5)
        assert found["offset_ms"] == {"least": 20, "median": 20, "greatest": 20}
        assert found["parameters"] == {"arkit": 2, "face shape 3": 2}
        assert (found["fps"], found["trackers"]) == ({"25": 2}, {"mesh 1": 2})
        assert found["reasons"] == {"cleo": "too far away"}

    def test_the_rarest_phones_come_first_and_silence_not_at_all(self) -> None:
        assert rarest({"sil": 1, "AA": 3, "B": 2, "AH": 2}, 2) == [("AH", 2), ("B", 2)]

    def test_the_command_prints_lines_or_json(self, faces: Dataset) -> None:
        done = call("info", faces.path)
        assert done.exit_code == 0
        assert "recordings  3: 3 captured" in done.stdout
        assert "closures    50.00% of 6 p, b, m" in done.stdout
        assert json.loads(call("info", faces.path, "--json").stdout) == summarise(faces)

    def test_an_empty_dataset_has_figures_too(self, tmp_path: Path) -> None:
        (tmp_path / "none").mkdir()
        make(tmp_path / "none")
        done = call("info", tmp_path / "none")
        assert "recordings  0: none" in done.stdout
        assert call("split", tmp_path / "none").exit_code == 0

    def test_a_broken_file_is_named(self, faces: Dataset) -> None:
        (faces.path / ANNA / "motion.npz").write_bytes(b"PK")
        refused = call("info", faces.path)
        assert "motion.npz" in str(refused.exception)
        assert isinstance(refused.exception, LipwrightError)


class TestMerging:
    def test_files_hashes_and_splits_stay(self, faces: Dataset, tmp_path: Path) -> None:
        more = make(tmp_path / "more", "dora", licence="CC0-1.0")
        split_dataset(faces, SplitOptions(test=1)).save()
        done = call("merge", faces.path, more.path, "-o", tmp_path / "all")
        assert done.exit_code == 0, done.exception
        merged = open_dataset(tmp_path / "all")
        assert merged.names() == ("anna", "bert", "cleo", "dora")
        assert merged.names("test") == open_dataset(faces.path).names("test") != ()
        assert merged.manifest["licence"] == "CC-BY-4.0 AND CC0-1.0"
        assert merged.entry("dora")["files"] == more.entry("dora")["files"]
        assert everything_in(merged.folder("anna")) == everything_in(faces.folder("anna"))
        assert not check_dataset(merged).problems
        assert sorted(p.name for p in tmp_path.iterdir()) == ["all", "faces", "more"]

    def test_the_same_name_twice_is_refused_and_prefixes_help(
        self, faces: Dataset, tmp_path: Path
    ) -> None:
        make(tmp_path / "more", "Anna")
        out = tmp_path / "all"
        refused = call("merge", faces.path, tmp_path / "more", "-o", out)
        assert "'Anna' is in" in str(refused.exception)
        assert "--prefix" in str(refused.exception)
        assert not out.exists()
        prefixes = ("--prefix", "f-", "--prefix", "m-")
        assert call("merge", faces.path, tmp_path / "more", *prefixes, "-o", out).exit_code == 0
        merged = open_dataset(out)
        assert merged.names() == ("f-anna", "f-bert", "f-cleo", "m-Anna")
        assert merged.recording("m-Anna").name == "m-Anna"
        assert not check_dataset(merged).problems

    @pytest.mark.parametrize("prefixes", [("x",), ("../", "y"), ("/", "y")])
    def test_prefixes_that_cannot_be_are_refused(
        self, faces: Dataset, tmp_path: Path, prefixes: tuple[str, ...]
    ) -> None:
        more = make(tmp_path / "more", "dora")
        with pytest.raises(LipwrightError, match="--prefix"):
            merge_datasets([faces, more], tmp_path / "all", MergeOptions(prefixes))

    def test_other_trackers_need_leave_and_other_rates_are_told(
        self, faces: Dataset, tmp_path: Path
    ) -> None:
        more = make(tmp_path / "more", "dora", fps=50.0, tracker="phone")
        refused = call("merge", faces.path, more.path, "-o", tmp_path / "all")
        assert "mesh 1 in" in str(refused.exception)
        done = call("merge", faces.path, more.path, "-o", tmp_path / "all", "--mixed")
        assert done.exit_code == 0
        assert "25, 50 frames a second" in done.stderr
        assert "tracked in different ways" in done.stderr

    def test_parameters_of_two_faces_are_dropped_and_of_one_kept(
        self, faces: Dataset, tmp_path: Path
    ) -> None:
        more = make(tmp_path / "more", "dora")
        faces, more = write_face(faces, "one"), write_face(more, "two")
        merged, notes = merge_datasets([faces, more], tmp_path / "two")
        assert any("2 reference faces" in note for note in notes)
        assert merged.recording("anna").face() is None
        assert not check_dataset(merged).problems
        merged, notes = merge_datasets([faces, write_face(more, "one")], tmp_path / "one")
        assert not notes
        assert merged.recording("dora").face() is not None

    def test_edited_phones_stay_edited_and_damage_is_refused(
        self, faces: Dataset, tmp_path: Path
    ) -> None:
        more = make(tmp_path / "more", "dora")
        moved = TRACK.with_edges([0.0, 0.21, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0])
        write_track(faces.folder("bert") / "phones.TextGrid", moved)
        merged, _ = merge_datasets([faces, more], tmp_path / "all")
        assert check_dataset(merged).edited == ("bert",)
        (faces.path / ANNA / "audio.flac").write_bytes(b"x")
        with pytest.raises(LipwrightError, match=r"audio\.flac: has changed") as caught:
            merge_datasets([faces, more], tmp_path / "other")
        one_line(caught)
        (faces.path / ANNA / "audio.flac").unlink()
        (faces.path / ANNA / "audio.flac").symlink_to(tmp_path)
        with pytest.raises(LipwrightError, match=r"audio\.flac: is a link"):
            merge_datasets([faces, more], tmp_path / "other")
        (faces.path / ANNA / "audio.flac").unlink()
        with pytest.raises(LipwrightError, match=r"audio\.flac: no such file") as caught:
            merge_datasets([faces, more], tmp_path / "other")
        one_line(caught)
        assert sorted(p.name for p in tmp_path.iterdir()) == ["all", "faces", "more"]

    def test_what_is_there_is_never_replaced(self, faces: Dataset, tmp_path: Path) -> None:
        more = make(tmp_path / "more", "dora")
        places = {
            more.path: "already", faces.path / "all": "outside of it",
            tmp_path / "no" / "all": "no folder",
        }  # fmt: skip
        for out, reason in places.items():
            with pytest.raises(LipwrightError, match=reason):
                merge_datasets([faces, more], out)
        with pytest.raises(LipwrightError, match="two datasets"):
            merge_datasets([faces], tmp_path / "all")

    def test_licences_add_up(self) -> None:
        assert join_licences(["MIT", "MIT"]) == "MIT"
        assert join_licences(["", None]) == ""
        assert join_licences(["MIT OR ISC", None, "CC0-1.0"]) == (
            "(MIT OR ISC) AND unknown AND CC0-1.0"
        )

    def test_a_missing_licence_is_told(self, faces: Dataset, tmp_path: Path) -> None:
        more = make(tmp_path / "more", "dora", licence="")
        _, notes = merge_datasets([faces, more], tmp_path / "all")
        assert len(notes) == 1
        assert "names no licence" in notes[0]

    def test_a_failed_recording_comes_along_without_files(
        self, faces: Dataset, tmp_path: Path
    ) -> None:
        more = make(tmp_path / "more", "dora")
        more.manifest["recordings"].append({"name": "emil", "status": "failed", "reasons": ["x"]})
        merged, _ = merge_datasets([faces, more], tmp_path / "all")
        assert merged.entry("emil")["reasons"] == ["x"]
        assert not check_dataset(merged).problems

    def test_a_killed_merge_leaves_no_dataset_and_the_next_one_works(
        self, faces: Dataset, tmp_path: Path
    ) -> None:
        more = make(tmp_path / "more", "dora")
        code = (
            "import sys, time\n"
            "from pathlib import Path\n"
            "from lipwright.dataset.folder import open_dataset\n"
            "from lipwright.dataset.merging import merge_datasets\n"
            "def stop(stage, share):\n"
            "    if share > 0.4:\n"
            "        print('half', flush=True)\n"
            "        time.sleep(60)\n"
            "merge_datasets([open_dataset(p) for p in sys.argv[1:3]], Path(sys.argv[3]),"
            " report=stop)\n"
        )
        out = tmp_path / "all"
        arguments = [sys.executable, "-c", code, faces.path, more.path, out]
        with subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == "half\n"
            with pytest.raises(LipwrightError, match="another program"):
                merge_datasets([faces, more], out)
            os.kill(process.pid, signal.SIGKILL)
        assert not out.exists()
        merged, _ = merge_datasets([faces, more], out)
        assert not check_dataset(merged).problems
        assert sorted(p.name for p in tmp_path.iterdir()) == ["all", "faces", "more"]

    def test_merging_twice_gives_the_same_bytes(self, faces: Dataset, tmp_path: Path) -> None:
        more = make(tmp_path / "more", "dora")
        for place in ("one", "two"):
            (tmp_path / place).mkdir()
            merge_datasets([faces, more], tmp_path / place / "all")
        assert everything_in(tmp_path / "one") == everything_in(tmp_path / "two")


ODD = (None, 3, -1, "x", "", [], {}, [1], {"a": 1}, True)


def places_in(value: object, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The keys that lead to each value in a JSON file."""
    inner = value.items() if isinstance(value, dict) else ()
    inner = enumerate(value[:2]) if isinstance(value, list) else inner
    return [place] + [found for key, part in inner for found in places_in(part, (*place, key))]


def replaced(value: Any, place: tuple[Any, ...], odd: object) -> Any:
    if not place:
        return odd
    changed = value.copy()
    changed[place[0]] = replaced(value[place[0]], place[1:], odd)
    return changed


class TestOddValues:
    @pytest.mark.parametrize("file", ["dataset.json", "recordings/anna/recording.json"])
    def test_an_odd_value_anywhere_is_no_crash_but_at_most_one_line(
        self, faces: Dataset, file: str
    ) -> None:
        path = faces.path / file
        good = json.loads(path.read_text())
        for number, place in enumerate(places_in(good)):
            path.write_text(json.dumps(replaced(good, place, ODD[number % len(ODD)])))
            for arguments in (("info",), ("check",), ("split", "--hold-out-words", "me")):
                error = call(*arguments[:1], faces.path, *arguments[1:]).exception
                assert error is None or isinstance(error, LipwrightError | SystemExit), place
                assert "\n" not in str(error)


class TestPage:
    PAGE = (Path(__file__).parents[1] / "docs" / "dataset.md").read_text("utf-8")

    def test_it_names_every_array_every_figure_and_every_transform(self, faces: Dataset) -> None:
        arrays = [field.name for field in fields(Motion)]
        transforms = [made.__name__ for made in TRANSFORMS.values()]
        motion = faces.recording("anna").motion
        figures = measure_quality(motion, TRACK, 0.0)
        for name in (*arrays, *figures, *transforms, *summarise(faces), *SPLITS, *STATUSES):
            assert f"`{name}" in self.PAGE, name

    def test_its_numpy_example_runs(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        make(tmp_path / "anna", "one")
        code = self.PAGE.split("```python\n")[1].split("```")[0]
        exec(code.replace('"anna/', f'"{tmp_path}/anna/'), {})
        assert capsys.readouterr().out == "25.0 (25, 52)\n"
