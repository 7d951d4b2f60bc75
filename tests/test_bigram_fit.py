"""Sets fitted to captured faces: planted motion comes back, and closures are exact."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.file import load_set
from lipwright.bigrams.runtime import stitch
from lipwright.bigrams.spline import dense
from lipwright.bigrams.values import BigramSet, Pair, Points, Pose
from lipwright.cli import run
from lipwright.clip import Clip
from lipwright.controls import ARKIT, CANONICAL
from lipwright.curves import Floats
from lipwright.dataset.folder import open_dataset
from lipwright.dataset.recording import Flag, Motion, save_motion
from lipwright.engines.bigram import animate
from lipwright.face.head import Head
from lipwright.passes import apply_passes, bigram_passes, constrain
from lipwright.phones import BILABIALS
from lipwright.rig import load_rig
from lipwright.track import PhoneTrack
from lipwright.train.bigram_fit import FITTED, Fit, FitOptions, fit
from lipwright.train.bigram_heard import ClosureOptions, Heard, shut_pairs
from lipwright.train.bigram_set import Naming, ruled_set
from lipwright.train.bigram_targets import Projector
from studio_server import write_faceless_set, write_set

FPS = 50.0
MOTIONS = ("arkit", "landmarks", "head_pose", "aperture", "aperture_raw", "angles")
SAID = ("AA", "IY", "S", "OW")
SHUTTING = (*SAID, "M")
LITTLE = FitOptions(least=2, ridge=0.01, bending=0.01, rounding=0.0)  # of the rules
RULES = ruled_set(Naming("planted"))
FACEFX = load_rig("facefx")


def bump(height: float, middle: float) -> Points:
    """Nine even control points, from rest to rest."""
    times = np.linspace(0, 1, 9)
    values = height * np.exp(-(((times - middle) / 0.25) ** 2))
    values[[0, -1]] = 0
    return tuple(zip(times.tolist(), values.tolist(), strict=True))


def planted_set() -> BigramSet:
    """The rules with other curves of the poses that a camera sees."""
    rng = np.random.default_rng(5)
    made = RULES
    for bigram in RULES.bigrams.values():
        drawn = {
            pose: bump(rng.uniform(0.2, 0.6), rng.uniform(0.35, 0.65)) for pose in ("open", "wide")
        }
        made = made.with_bigram(replace(bigram, curves={**bigram.curves, **drawn}))
    return made


PLANTED = planted_set()


def said_track(seed: int, among: tuple[str, ...] = SAID, count: int = 60) -> PhoneTrack:
    rng = np.random.default_rng(seed)
    phones = ("sil", *(str(phone) for phone in rng.choice(among, count)), "sil")
    lengths = np.concatenate([[0.5], rng.uniform(0.08, 0.16, count), [0.5]])
    return PhoneTrack(phones, np.cumsum([0.0, *lengths]))


TRACKS = [said_track(seed) for seed in range(12)]
TRACKS[3] = replace(TRACKS[3], phones=(*TRACKS[3].phones[:30], "ER", *TRACKS[3].phones[31:]))
UNSEEN = [said_track(seed) for seed in range(100, 104)]


def at_video(track: PhoneTrack) -> Floats:
    """(T,), the times of the frames of a video."""
    return np.asarray(np.arange(0.5, track.end * FPS) / FPS, np.float64)


def planted_poses(track: PhoneTrack) -> Clip:
    clip = stitch(PLANTED, track, 1000)
    return constrain(PLANTED)(clip, track)


def heard(track: PhoneTrack) -> Heard:
    """What a camera would have seen of the planted set."""
    poses = planted_poses(track)
    times = at_video(track)
    arkit = FACEFX.to_canonical(poses).at(times)[:, : len(ARKIT)].astype(np.float64)
    shut = poses.at(times)[:, poses.column("PBM")] > 0.7
    return Heard(times, arkit, shut, track)


@pytest.fixture(scope="module")
def learnt(head: Head) -> Fit:
    return fit([heard(track) for track in TRACKS], RULES, FACEFX, head, LITTLE)


@pytest.fixture(scope="module")
def shutting(head: Head) -> BigramSet:
    """Fitted with the usual options, to phones with bilabials among them."""
    takes = [heard(said_track(seed, SHUTTING)) for seed in range(6)]
    return with_pairs(fit(takes, RULES, FACEFX, head))


def with_pairs(made: Fit) -> BigramSet:
    return replace(RULES, bigrams={**RULES.bigrams, **made.bigrams})


def pairs_of(tracks: list[PhoneTrack]) -> Counter[Pair]:
    return Counter(pair for track in tracks for pair in pairwise(map(RULES.class_of, track.phones)))


class TestPlanted:
    def test_poses_are_found_again_in_a_face(self, head: Head) -> None:
        rng = np.random.default_rng(0)
        weights = rng.uniform(0, 0.6, (50, 3))
        shown = FACEFX.to_canonical(Clip(FITTED, 50, weights.astype(np.float32)))
        arkit = shown.values[:, : len(ARKIT)].astype(np.float64)
        found = Projector(head, FACEFX, FITTED)(arkit)
        assert found == pytest.approx(weights, abs=0.01)

    def test_poses_that_are_there_already_are_taken_off_first(self, head: Head) -> None:
        weights = np.random.default_rng(0).uniform(0, 0.6, (50, 2))
        shown = FACEFX.to_canonical(Clip(("open", "PBM"), 50, weights.astype(np.float32)))
        arkit = shown.values[:, : len(ARKIT)].astype(np.float64)
        found = Projector(head, FACEFX, ("open",))(arkit, {"PBM": weights[:, 1]})
        assert found[:, 0] == pytest.approx(weights[:, 0], abs=0.01)

    @pytest.mark.parametrize("pose", FITTED)
    def test_motion_that_was_not_seen_comes_back(self, pose: str, learnt: Fit) -> None:
        fitted = with_pairs(learnt)
        one, other = [], []
        for track in UNSEEN:
            clip, planted = stitch(fitted, track, 1000), planted_poses(track)
            one.append(clip.at(at_video(track))[:, clip.column(pose)])
            other.append(planted.at(at_video(track))[:, planted.column(pose)])
        assert np.corrcoef(np.concatenate(one), np.concatenate(other))[0, 1] > 0.98

    def test_nearly_all_of_the_motion_is_explained(self, learnt: Fit) -> None:
        for pose in FITTED:
            assert learnt.explained[pose] > 0.95
        for bigram in learnt.bigrams.values():
            assert bigram.source == "fitted"
            assert max(bigram.variance.values()) < 0.01

    def test_pairs_say_how_often_they_were_heard_and_rare_ones_stay_by_rule(
        self, learnt: Fit
    ) -> None:
        counts = pairs_of(TRACKS)
        often = {pair: count for pair, count in counts.items() if count >= LITTLE.least}
        assert {pair: bigram.count for pair, bigram in learnt.bigrams.items()} == often
        rare = (RULES.class_of(TRACKS[3].phones[29]), "er")
        assert counts[rare] == 1
        assert with_pairs(learnt).bigrams[rare].source == "rule"

    def test_the_tongue_and_what_no_camera_sees_stay_by_rule(self, learnt: Fit) -> None:
        for pair, bigram in learnt.bigrams.items():
            ruled = RULES.bigrams[pair].curves
            for pose in ("tRoof", "tBack", "tTeeth", "FV", "ShCh"):
                assert bigram.curves.get(pose) == ruled.get(pose)

    def test_control_points_are_even_and_never_below_rest(self, learnt: Fit) -> None:
        for bigram in learnt.bigrams.values():
            for pose in FITTED:
                points = bigram.curves.get(pose, ())
                assert len(points) in (0, LITTLE.points)
                assert all(value >= 0 for _, value in points)

    def test_nothing_heard_often_enough_is_nothing_fitted(self, head: Head) -> None:
        learnt = fit([heard(UNSEEN[0])], RULES, FACEFX, head, FitOptions(least=1000))
        assert not learnt.bigrams


class TestClosures:
    @pytest.mark.parametrize("fps", [25, 60])
    def test_every_bilabial_shuts_the_lips(self, fps: float, shutting: BigramSet) -> None:
        assert shutting.bigrams["aa", "bmp"].source == "fitted"
        for seed in range(100, 104):
            track = said_track(seed, SHUTTING)
            clip = apply_passes(animate(track, fps, None, shutting), track, bigram_passes(shutting))
            shut = (clip.curve("PBM") >= 0.999) & (clip.curve("open") == 0)
            for phone, start, end in track:
                if phone in BILABIALS:
                    assert shut[(clip.times >= start - 0.04) & (clip.times <= end + 0.04)].any()

    def test_a_closure_is_when_the_lips_of_the_speaker_are_shut(self) -> None:
        # Here they shut in the last quarter of "AA M".
        takes = []
        for seed in range(6):
            track = said_track(seed, SHUTTING)
            take = heard(track)
            late = np.zeros(len(take.times), bool)
            for index, pair in enumerate(pairwise(track.phones)):
                if pair == ("AA", "M"):
                    start, end = track.edges[index], track.edges[index + 2]
                    late |= (take.times >= start + 0.75 * (end - start)) & (take.times <= end)
            takes.append(replace(take, shut=late))
        (bigram,) = shut_pairs(takes, RULES, [("aa", "bmp")], ClosureOptions())
        curve = dense(bigram.curves["PBM"])
        times = np.linspace(0, 1, len(curve))
        assert curve.max() > 0.999
        assert 0.8 < times[curve > 0.999].mean() < 0.95
        assert curve[times < 0.5].max() < 0.2


def test_frames_without_a_face_are_left_out(workplace: Path) -> None:
    whole = Heard.of(open_dataset(workplace / "anna").recording("anna1"))
    lose(workplace / "anna", slice(10, 20))
    part = Heard.of(open_dataset(workplace / "anna").recording("anna1"))
    assert whole is not None
    assert part is not None
    assert sorted(set(whole.times) - set(part.times)) == whole.times[10:20].tolist()
    assert np.isfinite(part.arkit).all()


def test_weights_without_lips_that_were_measured_say_nothing_of_closures(workplace: Path) -> None:
    recording = open_dataset(workplace / "anna").recording("anna1")
    seen = recording.motion
    take = Heard.of(replace(recording, motion=Motion(seen.fps, seen.flags, seen.arkit)))
    assert take is not None
    assert not take.shut.any()
    assert not list(shut_pairs([take], RULES, list(RULES.bigrams), ClosureOptions(least=1)))


def lose(dataset: Path, frames: slice) -> None:
    """Take the face out of some frames of all recordings."""
    opened = open_dataset(dataset)
    for name in opened.names():
        motion = opened.recording(name).motion
        flags = motion.flags.copy()
        flags[frames] |= np.uint8(Flag.LOST)
        kept = {field: getattr(motion, field) for field in MOTIONS}
        arrays = {field: array.copy() for field, array in kept.items() if array is not None}
        for array in arrays.values():
            array[frames] = np.nan
        path = dataset / "recordings" / name / "motion.npz"
        save_motion(path, Motion(motion.fps, flags, **arrays))
    opened.with_files(opened.names()).save()


@pytest.fixture
def place(workplace: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(workplace)
    return workplace


def fit_anna(*more: str) -> int:
    return run(["bigrams", "fit", "anna", *more])


class TestCommand:
    def test_a_set_says_what_was_heard_and_what_is_by_rule(
        self, place: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert fit_anna("-o", "a.json", "--licence", "CC0", "--least", "1") == 0
        made = load_bigrams("a.json")
        sources = Counter(bigram.source for bigram in made.bigrams.values())
        assert sources["fitted"] > 20
        assert sources["fitted"] + sources["rule"] == len(made.bigrams) == 22 * 22 - 1
        tracks = [open_dataset("anna").recording(name).track for name in ("anna1", "anna2")]
        for pair, count in pairs_of(tracks).items():
            assert made.bigrams[pair].count == count or pair == ("sil", "sil")
        assert made.licence == "CC0"
        assert "'anna', CC0" in made.source
        first, second = capsys.readouterr().err.splitlines()
        assert first == (
            f"a.json: {sources['fitted']} pairs fitted to 2 recordings, {sources['rule']} by rule"
        )
        assert second.startswith("share of the captured motion that the curves explain: W ")
        assert run(["bigrams", "check", "a.json"]) == 0

    def test_the_fitted_set_moves_as_the_recordings_did(self, place: Path) -> None:
        # The videos were drawn from known curves; the sum of all is how far the mouth is open.
        assert fit_anna("-o", "a.json", "--least", "1") == 0
        made = load_bigrams("a.json")
        recording = open_dataset("anna").recording("anna1")
        track = recording.track
        poses = apply_passes(animate(track, 60, None, made), track, bigram_passes(made))
        jaw = FACEFX.to_canonical(poses).at(recording.times)[:, CANONICAL.index("jawOpen")]
        captured = recording.motion.arkit[:, ARKIT.index("jawOpen")]
        seen = recording.valid
        assert np.corrcoef(jaw[seen], captured[seen])[0, 1] > 0.7

    def test_the_same_recordings_give_the_same_file(self, place: Path) -> None:
        for name in ("a.json", "b.json"):
            assert fit_anna("-o", name, "--name", "anna") == 0
        assert (place / "a.json").read_bytes() == (place / "b.json").read_bytes()

    def test_a_child_has_only_what_was_heard_and_inherits_the_rest(
        self, place: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert fit_anna("-o", "a.json", "--parent", "english", "--least", "1") == 0
        said = load_set("a.json")
        assert said.parent == "english"
        assert {bigram.source for bigram in said.bigrams.values()} == {"fitted"}
        assert "by rule" not in capsys.readouterr().err
        whole, english = load_bigrams("a.json"), load_bigrams("english")
        assert whole.classes == english.classes
        for pair, bigram in english.bigrams.items():
            if pair not in said.bigrams:
                assert whole.bigrams[pair].curves == bigram.curves

    def test_programs_read_json_lines(
        self, place: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert fit_anna("-o", "a.json", "--progress", "json") == 0
        lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
        assert {line["stage"] for line in lines} == {"project", "fit"}

    def test_no_face_is_one_line(self, place: Path, capsys: pytest.CaptureFixture[str]) -> None:
        lose(place / "anna", slice(None))
        assert "anna: no recording for training shows a face" in refused(capsys, "-o", "a.json")

    @pytest.mark.parametrize(
        ("arguments", "reason"),
        [
            (["bert.json", "-o", "a.json"], "bert.json"),
            (["videos", "-o", "a.json"], "videos: not a dataset"),
            (["anna", "-o", "a.json", "--least", "1000"], "anna: no pair of phones is heard 1000"),
            (["anna", "-o", "anna1.csv"], "anna1.csv: is there already"),
            (["anna", "-o", ".json"], "name the set with --name"),
            (["anna", "-o", "a.json", "--parent", "klingon"], "no set 'klingon'"),
            (["anna", "-o", "a.json", "--parent", "small.json"], "small.json: has no pose 'wide'"),
            (
                ["anna", "-o", "a.json", "--parent", "box.bigrams.json"],
                "box.bigrams.json: has no look of 'W' on a face",
            ),
            (["anna", "-o", "a.json", "--points", "3"], "--points"),
            (["anna", "-o", "no/such/folder/a.json"], "no/such/folder"),
        ],
    )
    def test_what_cannot_be_fitted_is_one_line(
        self, arguments: list[str], reason: str, place: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        write_set(place / "small.json")
        poses = {name: Pose(name) for name in ("open", "W", "wide", "ShCh", "FV", "PBM")}
        write_faceless_set(place / "box.bigrams.json")
        controls = [{"name": name} for name in poses]
        rig = {"name": "box", "controls": controls, "mirror": [], "source": "", "license": ""}
        (place / "box.json").write_text(json.dumps(rig))
        write_set(place / "box.bigrams.json", rig="box.json", poses=poses)
        before = sorted(place.rglob("*"))
        capsys.readouterr()
        assert run(["bigrams", "fit", *arguments]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert reason in line
        assert sorted(place.rglob("*")) == before


def refused(capsys: pytest.CaptureFixture[str], *more: str) -> str:
    capsys.readouterr()
    assert fit_anna(*more) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line
