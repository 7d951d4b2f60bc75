"""Peers of the benchmark, and folders of others' curves."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from lipwright.benchmark import peers
from lipwright.benchmark.curve_folders import read_curves, write_curves
from lipwright.benchmark.peers import PEERS, Peer, animate_peer
from lipwright.clip import Clip, frame_times
from lipwright.controls import ARKIT, CANONICAL
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.export import export_clip
from lipwright.formats import write_track
from lipwright.phones import PHONES, SILENCE
from lipwright.track import PhoneTrack


def spoken(*phones: str, seconds: float = 0.1) -> PhoneTrack:
    row = (SILENCE, *phones, SILENCE)
    return PhoneTrack(row, seconds * np.arange(len(row) + 1))


def random_clip(names: tuple[str, ...], fps: float, seed: int) -> Clip:
    random = np.random.default_rng(seed)
    return Clip(names, fps, random.uniform(0, 1, (40, len(names))).astype(np.float32))


class TestOpenFaceFX:
    @pytest.fixture(autouse=True)
    def installed(self) -> None:
        pytest.importorskip("openfacefx")

    def test_it_gives_what_its_own_command_writes(self, tmp_path: Path) -> None:
        track = spoken("HH", "AH", "L", "OW", "P", "AA", "M", "IY")
        grid, out = tmp_path / "a.TextGrid", tmp_path / "a.json"
        write_track(grid, track)
        subprocess.run(
            [sys.executable, "-m", "openfacefx", "mfa", "--textgrid", str(grid), "--retarget",
             "arkit", "--fps", "60", "-o", str(out)],
            check=True, capture_output=True,
        )  # fmt: skip
        clip = animate_peer("openfacefx", track, 60.0)
        times = frame_times(track.end, 60.0)
        assert clip.fps == 60
        assert len(clip) == len(times)
        channels = {c["name"]: c["keys"] for c in json.loads(out.read_text())["channels"]}
        assert set(clip.names) == {name for name, keys in channels.items() if keys}
        for name in clip.names:
            when, values = zip(*channels[name], strict=True)
            assert clip.curve(name) == pytest.approx(np.interp(times, when, values), abs=2e-3)

    def test_its_controls_are_arkits_and_its_lips_shut_at_p(self) -> None:
        clip = animate_peer("openfacefx", spoken("AA", "P", "AA", seconds=0.15), 60.0)
        assert set(clip.names) <= set(ARKIT)
        in_p, in_vowel = round(0.375 * 60), round(0.225 * 60)
        assert clip.curve("mouthPressLeft")[in_p] > 5 * clip.curve("mouthPressLeft")[in_vowel]
        assert clip.curve("jawOpen")[in_p] < 0.7 * clip.curve("jawOpen")[in_vowel]

    @pytest.mark.parametrize("fps", [24.0, 100.0])
    def test_phones_of_every_language_and_silence_alone_go_through(self, fps: float) -> None:
        everything = spoken(*PHONES)
        assert len(animate_peer("openfacefx", everything, fps)) == len(
            frame_times(everything.end, fps)
        )
        assert animate_peer("openfacefx", PhoneTrack((SILENCE,), np.array([0.0, 1.0])), fps)


class TestTrouble:
    def test_an_unknown_peer_is_refused_with_the_known_ones(self) -> None:
        with pytest.raises(LipwrightError, match=r"no peer 'faceworks'.*openfacefx"):
            animate_peer("faceworks", spoken("AA"), 60.0)

    def test_a_missing_package_says_what_to_install(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "openfacefx", None)
        with pytest.raises(MissingExtraError, match=r"pip install 'lipwright\[bench\]'"):
            animate_peer("openfacefx", spoken("AA"), 60.0)

    def test_a_peer_that_fails_is_one_line_for_the_user(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(track: PhoneTrack, fps: float) -> Clip:
            raise IndexError(f"no key\nat {fps} of {len(track)}")

        broken = Peer("broken", "Broken", "", "openfacefx", fail)
        monkeypatch.setattr(peers, "PEERS", {"broken": broken})
        with pytest.raises(LipwrightError, match="Broken failed on a track of 3 phones") as caught:
            animate_peer("broken", spoken("AA"), 60.0)
        assert "\n" not in str(caught.value)

    def test_each_peer_is_described(self) -> None:
        for name, peer in PEERS.items():
            assert peer.name == name == name.lower()
            assert peer.title
            assert peer.about.endswith(".")


class TestFolders:
    @pytest.mark.parametrize(
        "names",
        [CANONICAL, ("joint1", "joint2", "joint30"), ("joint1", "jawOpen", "tongueRaise")],
        ids=["canonical", "modes", "both"],
    )
    @pytest.mark.parametrize("fps", [25.0, 60.0 / 1.001, 60.0])
    def test_what_is_written_is_read_back(
        self, tmp_path: Path, names: tuple[str, ...], fps: float
    ) -> None:
        clips = {f"take{seed}": random_clip(names, fps, seed) for seed in range(2)}
        write_curves(tmp_path / "new" / "folder", clips)
        found = read_curves(tmp_path / "new" / "folder", clips)
        assert list(found) == list(clips)
        for name, clip in clips.items():
            assert found[name].names == names
            assert found[name].fps == pytest.approx(fps, rel=1e-6)
            assert found[name].values == pytest.approx(clip.values, abs=1e-4)

    def test_modes_may_be_below_0_and_many_deviations(self, tmp_path: Path) -> None:
        clip = Clip(("joint1",), 60, np.linspace(-9, 9, 30)[:, None].astype(np.float32))
        write_curves(tmp_path, {"a": clip})
        assert read_curves(tmp_path, ["a"])["a"].values == pytest.approx(clip.values, abs=1e-4)

    def test_only_the_wanted_recordings_are_read(self, tmp_path: Path) -> None:
        write_curves(tmp_path, {"b": random_clip(("jawOpen",), 60, 0)})
        (tmp_path / "a.csv").write_text("not a table")
        (tmp_path / "notes.txt").write_text("mine")
        assert list(read_curves(tmp_path, ["b"])) == ["b"]

    def test_live_link_face_recordings_are_read(self, tmp_path: Path) -> None:
        clip = random_clip(ARKIT, 60, 3)
        export_clip(tmp_path / "a.livelink.csv", clip)
        (found,) = read_curves(tmp_path, ["a"]).values()
        assert set(found.names) == set(ARKIT)
        assert found.curve("jawOpen") == pytest.approx(clip.curve("jawOpen"), abs=1e-4)

    def test_missing_recordings_are_listed(self, tmp_path: Path) -> None:
        write_curves(tmp_path, {"here": random_clip(("jawOpen",), 60, 0)})
        with pytest.raises(LipwrightError, match=r"no curves of 'b1', 'b2', .* and 3 more, 8 of 9"):
            read_curves(tmp_path, ["here", *(f"b{n}" for n in range(1, 9))])

    def test_a_folder_that_is_not_there_is_named(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match="nowhere: is no folder"):
            read_curves(tmp_path / "nowhere", ["a"])

    @pytest.mark.parametrize(
        ("text", "told"),
        [
            ("time,jawOpen\n0,0.1\n0.04,x\n", r"a\.csv: line 3"),
            ("time,jawOpen\n0,0.1\n0.04\n", r"a\.csv: line 3"),
            ("time,jaw,mouth\n0,0,0\n", r"a\.csv: line 1: unknown controls 'jaw', 'mouth'"),
            ("time\n0\n", r"a\.csv: line 1: no controls"),
            ("time,jawOpen\n0,87\n", r"a\.csv: the control jawOpen goes up to 87"),
            ("", r"a\.csv: line 1"),
        ],
    )
    def test_a_file_that_cannot_be_used_is_named(
        self, tmp_path: Path, text: str, told: str
    ) -> None:
        (tmp_path / "a.csv").write_text(text)
        with pytest.raises(LipwrightError, match=told) as caught:
            read_curves(tmp_path, ["a"])
        assert "\n" not in str(caught.value)

    def test_two_files_of_one_recording_are_refused(self, tmp_path: Path) -> None:
        export_clip(tmp_path / "a.livelink.csv", random_clip(ARKIT, 60, 3))
        write_curves(tmp_path, {"a": random_clip(("jawOpen",), 60, 0)})
        with pytest.raises(LipwrightError, match="has both"):
            read_curves(tmp_path, ["a"])

    @pytest.mark.parametrize("name", ["../a", "a/b", ""])
    def test_a_name_that_leads_out_of_the_folder_is_refused(
        self, tmp_path: Path, name: str
    ) -> None:
        with pytest.raises(LipwrightError):
            write_curves(tmp_path / "in", {name: random_clip(("jawOpen",), 60, 0)})
        assert not (tmp_path / "in").exists()

    def test_unknown_controls_are_not_written(self, tmp_path: Path) -> None:
        with pytest.raises(LipwrightError, match="unknown controls 'wing'"):
            write_curves(tmp_path, {"a": random_clip(("wing",), 60, 0)})
