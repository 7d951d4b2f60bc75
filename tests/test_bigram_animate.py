"""`animate` with phone bigrams, from options to files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.bigrams.families import load_bigrams
from lipwright.cli import run
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export import read_clip
from lipwright.face.head import Head
from lipwright.formats import write_track
from lipwright.language.pace import spoken_track
from lipwright.phones import BILABIALS
from lipwright.pipeline import AnimateOptions, animate_track
from lipwright.track import PhoneTrack
from studio_server import write_faceless_set, write_set

HELLO = Path(__file__).resolve().parents[1] / "examples" / "hello.flac"
ENGLISH = load_bigrams("english")
TRACK = spoken_track("Maybe Bob will find the way.")


class TestOptions:
    @pytest.mark.parametrize(
        ("options", "other"),
        [
            ({"model": "lipwright"}, "--model"),
            ({"engine": "dominance"}, "the engine dominance"),
            ({"engine": "window"}, "the engine window"),
            ({"engine": "bigram", "model": "english"}, "--model"),
        ],
    )
    def test_a_set_beside_another_engine_or_model_is_refused(
        self, options: dict[str, Any], other: str
    ) -> None:
        with pytest.raises(
            LipwrightError, match=f"--bigrams is for the engine bigram, not for {other}; leave"
        ):
            AnimateOptions(bigrams="english", **options)

    def test_a_set_is_named_given_or_the_default(self, tmp_path: Path) -> None:
        named = animate_track(TRACK, AnimateOptions(bigrams="english"))
        for options in (
            AnimateOptions(bigrams=ENGLISH),
            AnimateOptions(engine="bigram"),
            AnimateOptions(engine="bigram", model="english"),
            AnimateOptions(engine="bigram", bigrams="english"),
        ):
            assert options.bigram_set is not None
            assert options.controls() == CANONICAL
            assert animate_track(TRACK, options).values.tolist() == named.values.tolist()
        path = write_set(tmp_path / "small.json")
        for place in (path, str(path)):
            assert AnimateOptions(bigrams=place).bigram_set is not None

    def test_other_engines_have_no_set(self) -> None:
        assert AnimateOptions().bigram_set is None
        assert AnimateOptions(engine="dominance").bigram_set is None

    def test_an_unknown_set_is_refused_before_anything_is_done(self) -> None:
        with pytest.raises(LipwrightError, match="no set 'klingon'"):
            animate_track(TRACK, AnimateOptions(bigrams="klingon"))

    def test_a_pose_that_the_rig_lacks_is_named_with_those_that_it_has(self) -> None:
        stranger = replace(ENGLISH, rig="smartbody")
        with pytest.raises(
            LipwrightError,
            match=r"the bigram set 'english' moves the pose 'open', which the rig 'smartbody' "
            r"lacks; it has ah, bmp, ee, .*tTeeth$",
        ):
            animate_track(TRACK, AnimateOptions(bigrams=stranger))

    def test_a_set_of_a_rig_that_is_gone_is_refused(self) -> None:
        with pytest.raises(LipwrightError, match=r"gone\.json: cannot be read"):
            animate_track(TRACK, AnimateOptions(bigrams=replace(ENGLISH, rig="gone.json")))


class TestMotion:
    def test_a_set_with_looks_moves_the_canonical_controls_within_their_range(self) -> None:
        clip = animate_track(TRACK, AnimateOptions(bigrams="english"))
        assert clip.names == CANONICAL
        assert clip.values.min() >= 0
        assert clip.values.max() <= 1
        assert clip.curve("jawOpen").max() > 0.1
        assert clip.curve("mouthSmileLeft").tolist() == clip.curve("mouthSmileRight").tolist()

    def test_the_lips_are_shut_and_the_face_rests_before_the_first_and_after_the_last_sound(
        self, head: Head
    ) -> None:
        clip = animate_track(TRACK, AnimateOptions(bigrams="english"))
        reach = ENGLISH.silence + 2 * ENGLISH.smoothing + 1 / ENGLISH.speed_limit
        before = clip.times < TRACK.edges[1] - reach
        after = clip.times > TRACK.edges[-2] + reach
        assert not clip.values[before | after].any()
        apertures = head.aperture_curve(clip.values)
        for phone, start, end in TRACK:
            if phone in BILABIALS:
                said = (clip.times >= start - 0.01) & (clip.times <= end + 0.01)
                assert apertures[said].min() < 0.15 * np.percentile(apertures, 95)

    def test_intensity_scales_the_motion_and_keeps_the_range(self) -> None:
        spread = {}
        for amount in (0.5, 1.0, 1.5):
            options = AnimateOptions(bigrams="english", intensity=amount)
            clip = animate_track(TRACK, options)
            assert 0 <= clip.values.min() <= clip.values.max() <= 1
            spread[amount] = clip.curve("jawOpen").max()
        assert spread[0.5] == pytest.approx(spread[1.0] / 2, rel=1e-5)
        assert spread[1.5] > spread[1.0]
        still = animate_track(TRACK, AnimateOptions(bigrams="english", intensity=0))
        assert not still.curve("jawOpen").any()

    @pytest.mark.parametrize("amount", [0.3, 2.0])
    def test_lips_shut_at_any_intensity(self, amount: float, head: Head) -> None:
        clip = animate_track(TRACK, AnimateOptions(bigrams="english", intensity=amount))
        apertures = head.aperture_curve(clip.values)
        for phone, start, end in TRACK:
            if phone in BILABIALS:
                said = (clip.times >= start - 0.01) & (clip.times <= end + 0.01)
                assert apertures[said].min() < 0.15 * np.percentile(apertures, 95)

    def test_passes_of_the_callers_take_the_place_of_the_sets(self) -> None:
        bare = animate_track(TRACK, AnimateOptions(bigrams="english", passes=()))
        whole = animate_track(TRACK, AnimateOptions(bigrams="english"))
        assert bare.values.tolist() != whole.values.tolist()

    def test_a_creature_moves_its_own_poses(self, tmp_path: Path) -> None:
        path = write_faceless_set(tmp_path / "crab.json")
        options = AnimateOptions(bigrams=path)
        assert options.controls() == ("open", "FV", "W")
        clip = animate_track(spoken_track("Fat cat."), options)
        assert clip.names == ("open", "FV", "W")
        assert clip.curve("FV").max() == pytest.approx(0.5, abs=0.05)  # of a parabola
        assert not clip.curve("W").any()


@pytest.fixture
def phones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A track of `fat map` with the length of the example recording, in the folder we are in."""
    monkeypatch.chdir(tmp_path)
    said = PhoneTrack(
        ("sil", "F", "AE", "T", "M", "AE", "P", "sil"),
        np.array([0, 0.5, 0.6, 0.75, 0.85, 0.95, 1.1, 1.2, 9.3]),
    )
    write_track(tmp_path / "said.TextGrid", said)
    return tmp_path / "said.TextGrid"


def animate(*arguments: object) -> int:
    return run(["animate", str(HELLO), *map(str, arguments)])


def refused(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The one line that the command says; nothing is written."""
    before = sorted(Path.cwd().rglob("*"))
    capsys.readouterr()
    assert animate(*arguments) == 2
    assert sorted(Path.cwd().rglob("*")) == before
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    return lines[0]


class TestCommand:
    def test_a_whole_set_animates_without_a_warning(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        assert animate("--phones", phones, "--bigrams", "english", "-o", "a.csv") == 0
        assert capsys.readouterr().err.splitlines() == ["a.csv: 9.3 s, 8 phones, 0 words"]
        clip = read_clip(Path("a.csv"))
        assert clip.curve("jawOpen").max() > 0.1
        assert clip.values[clip.times > 2].max() == 0

    def test_missing_pairs_are_named_with_what_was_used(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        small = write_set(phones.with_name("small.json"))
        assert animate("--phones", phones, "--bigrams", small, "-o", "a.json") == 0
        lines = capsys.readouterr().err.splitlines()
        assert lines[-1] == "a.json: 9.3 s, 8 phones, 0 words"
        # P and M are in no class: of the phones that have one, T and D are the most like them.
        assert lines[:-1] == [
            f"warning: small has no pair {missed}"
            for missed in (
                "'d ah' (1 times); used 'f ah'",
                "'d d' (1 times); the mouth rests there",
                "'d sil' (1 times); the mouth rests there",
                "'sil f' (1 times); the mouth rests there",
            )
        ]

    def test_pauses_that_a_set_has_no_class_for_are_named(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        small = write_set(
            phones.with_name("small.json"), classes={"f": ("F",), "ah": ("AE",), "d": ("T",)}
        )
        assert animate("--phones", phones, "--bigrams", small, "-o", "a.json") == 0
        errors = capsys.readouterr().err
        assert "small has no pair 'sil f' (1 times); the mouth rests there" in errors
        assert "small has no pair 'd sil' (1 times); the mouth rests there" in errors

    def test_a_creature_is_written_as_a_table_of_its_poses(self, phones: Path) -> None:
        box = write_faceless_set(phones.with_name("crab.json"))
        assert animate("--phones", phones, "--bigrams", box, "-o", "a.csv", "-o", "b.json") == 0
        for path in ("a.csv", "b.json"):
            assert read_clip(Path(path)).names == ("open", "FV", "W")

    @pytest.mark.parametrize("suffix", [".glb", ".mp4", ".livelink.csv"])
    def test_no_head_shows_a_creature(
        self, suffix: str, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        box = write_faceless_set(phones.with_name("crab.json"))
        line = refused(
            capsys, "--phones", phones, "--bigrams", box, "-o", "ok.csv", "-o", f"a{suffix}"
        )
        assert f"a{suffix}: small moves poses of a creature (open to W)" in line

    def test_a_broken_set_is_refused_in_a_line(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = write_set(phones.with_name("broken.json"))
        path.write_text(path.read_text().replace("[0.2, 1]", "[0.7, 1]"))
        line = refused(capsys, "--phones", phones, "--bigrams", path, "-o", "a.csv")
        assert "broken.json:" in line
        assert "control point 3 is at 0.5, before the last one at 0.7" in line

    def test_a_set_whose_rig_lacks_a_pose_is_refused_in_a_line(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        write_faceless_set(phones.with_name("crab.json"))
        rig = json.loads(Path("box.json").read_text())
        rig["controls"] = rig["controls"][:2]
        Path("box.json").write_text(json.dumps(rig))
        line = refused(capsys, "--phones", phones, "--bigrams", "crab.json", "-o", "a.csv")
        assert "the bigram set 'small' moves the pose 'W', which the rig 'box' lacks" in line
        assert "it has open, FV" in line

    @pytest.mark.parametrize("name", ["none.json", "klingon", "."])
    def test_a_set_that_is_not_there_is_refused_in_a_line(
        self, name: str, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        line = refused(capsys, "--phones", phones, "--bigrams", name, "-o", "a.csv")
        assert name in line

    def test_a_set_and_a_model_are_refused_in_a_line(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        more = ("--model", "lipwright", "-o", "a.csv")
        line = refused(capsys, "--phones", phones, "--bigrams", "english", *more)
        assert "--bigrams is for the engine bigram, not for --model" in line

    def test_a_set_is_never_written_over(
        self, phones: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        small = write_set(phones.with_name("small.json"))
        before = small.read_bytes()
        line = refused(capsys, "--phones", phones, "--bigrams", small, "-o", small)
        assert "small.json" in line
        assert small.read_bytes() == before
