"""Edits of exported curves survive new results, later phones, and a stop at any moment."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lipwright.clip import Clip
from lipwright.edits import Edits, export_with_edits, keeping, load_edits, save_edits
from lipwright.edits.values import SAME, added, difference
from lipwright.errors import LipwrightError
from lipwright.export import Performance, export_all, export_clip, read_clip
from lipwright.face.head import Head
from lipwright.retarget import retarget
from lipwright.rig import load_rig
from lipwright.track import PhoneTrack

TRACK = PhoneTrack(("sil", "M", "AA", "sil"), np.array([0, 0.2, 0.5, 0.8, 1.0]))
LATER = TRACK.with_edges(np.array([0, 0.4, 0.7, 1.0, 1.2]))
NAMES = ("jawOpen", "mouthClose", "mouthPucker")


def waves(seconds: float = 1.0, phase: float = 0.0, fps: float = 60.0) -> Clip:
    times = np.arange(round(seconds * fps) + 1) / fps
    rows = [0.5 + 0.4 * np.sin(5 * times + phase + number) for number in range(3)]
    return Clip(NAMES, fps, np.stack(rows, axis=1).astype(np.float32))


def edit(path: Path, frames: slice, name: str, by: float) -> None:
    """What an animator does: read the file, change a curve, save it."""
    clip = read_clip(path)
    values = clip.values.copy()
    values[frames, clip.column(name)] += by
    export_clip(path, clip.with_values(values))


@pytest.fixture(params=[".csv", ".json"])
def output(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    return tmp_path / f"talk{request.param}"


class TestRunAgain:
    def test_an_edit_stays_where_the_automatic_result_changes_below_it(self, output: Path) -> None:
        kept = output.with_name("talk.edits.json")
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(20, 30), "jawOpen", 0.25)
        said = export_with_edits([output], Performance(waves(phase=1.0), TRACK), kept)
        wanted = waves(phase=1.0).values.copy()
        wanted[20:30, 0] += 0.25
        assert read_clip(output).values == pytest.approx(wanted, abs=2e-5)
        assert (said.controls, said.unrecorded) == (("jawOpen",), False)
        assert said.seconds == pytest.approx(10 / 60)

    def test_edits_of_two_sessions_add_up_and_are_not_applied_twice(self, output: Path) -> None:
        kept = output.with_name("talk.edits.json")
        for phase in (0.0, 0.3):
            export_with_edits([output], Performance(waves(phase=phase), TRACK), kept)
            edit(output, slice(5, 9), "mouthPucker", 0.1)
        for phase in (0.6, 0.9, 1.2):
            export_with_edits([output], Performance(waves(phase=phase), TRACK), kept)
        wanted = waves(phase=1.2).values.copy()
        wanted[5:9, 2] += 0.2
        assert read_clip(output).values == pytest.approx(wanted, abs=5e-5)

    def test_an_edit_that_is_taken_back_is_gone(self, output: Path) -> None:
        kept = output.with_name("talk.edits.json")
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(5, 9), "jawOpen", 0.1)
        edit(output, slice(5, 9), "mouthClose", 0.1)
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(5, 9), "jawOpen", -0.1)
        said = export_with_edits([output], Performance(waves(), TRACK), kept)
        assert (said.controls, said.put_back) == (("mouthClose",), False)

    def test_a_run_that_knew_of_no_edits_loses_none(self, output: Path) -> None:
        kept = output.with_name("talk.edits.json")
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(5, 9), "jawOpen", 0.1)
        export_with_edits([output], Performance(waves(), TRACK), kept)
        export_clip(output, waves())
        said = export_with_edits([output], Performance(waves(), TRACK), kept)
        assert (said.controls, said.put_back) == (("jawOpen",), True)
        wanted = waves().values.copy()
        wanted[5:9, 0] += 0.1
        assert read_clip(output).values == pytest.approx(wanted, abs=3e-5)
        assert not export_with_edits([output], Performance(waves(), TRACK), kept).put_back

    def test_without_a_record_the_differences_from_this_result_are_the_edits(
        self, output: Path
    ) -> None:
        export_clip(output, waves())
        edit(output, slice(20, 30), "jawOpen", 0.25)
        kept = output.with_name("talk.edits.json")
        said = export_with_edits([output], Performance(waves(), TRACK), kept)
        assert said.unrecorded
        assert said.controls == ("jawOpen",)
        assert read_clip(output).curve("jawOpen")[25] == pytest.approx(
            waves().curve("jawOpen")[25] + 0.25, abs=2e-5
        )

    def test_other_outputs_of_the_run_have_the_edits_too(self, tmp_path: Path) -> None:
        output, other = tmp_path / "a.csv", tmp_path / "b.json"
        kept = tmp_path / "edits.json"
        export_with_edits([output, other], Performance(waves(), TRACK), kept)
        edit(output, slice(0, 3), "jawOpen", -0.1)
        export_with_edits([output, other], Performance(waves(), TRACK), kept)
        assert read_clip(other).values == pytest.approx(read_clip(output).values, abs=2e-5)
        assert difference(read_clip(other), waves()) is not None

    def test_edits_move_with_their_phones(self, output: Path) -> None:
        kept = output.with_name("talk.edits.json")
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(15, 25), "jawOpen", 0.3)  # within M, 0.2 to 0.5 s
        export_with_edits([output], Performance(waves(1.2), LATER), kept)
        found = read_clip(output).values - waves(1.2).values
        assert np.flatnonzero(np.abs(found[:, 0]) > 1e-3).tolist() == list(range(27, 37))

    def test_a_column_that_the_animator_dropped_or_added_is_no_harm(self, output: Path) -> None:
        kept = output.with_name("talk.edits.json")
        export_with_edits([output], Performance(waves(), TRACK), kept)
        clip = read_clip(output)
        changed = clip.select(("jawOpen", "browInnerUp")).with_curves(
            {"browInnerUp": np.full(len(clip), 0.5)}
        )
        export_clip(output, changed)
        export_with_edits([output], Performance(waves(), TRACK), kept)
        again = read_clip(output)
        assert again.names == (*NAMES, "browInnerUp")
        assert again.curve("browInnerUp") == pytest.approx(np.full(61, 0.5))
        assert again.select(NAMES).values == pytest.approx(waves().values, abs=2e-5)


class TestFormats:
    """Edits in other formats than our tables."""

    @pytest.mark.parametrize("suffix", [".glb", ".livelink.csv"])
    def test_an_edit_of_a_head_or_a_recording_stays(
        self, suffix: str, tmp_path: Path, head: Head
    ) -> None:
        del head
        output, kept = tmp_path / f"talk{suffix}", tmp_path / "edits.json"
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(20, 30), "jawOpen", -0.05)
        said = export_with_edits([output], Performance(waves(phase=1.0), TRACK), kept)
        assert said.controls == ("jawOpen",)
        wanted = waves(phase=1.0).curve("jawOpen").copy()
        wanted[20:30] -= 0.05
        assert read_clip(output).curve("jawOpen") == pytest.approx(wanted, abs=2e-5)

    def test_a_format_may_be_named_where_the_suffix_does_not_say_it(self, tmp_path: Path) -> None:
        output, kept = tmp_path / "talk.txt", tmp_path / "edits.json"
        export_with_edits([output], Performance(waves(), TRACK), kept, format=".csv")
        assert output.read_text().startswith("time,jawOpen,")
        assert export_with_edits([output], Performance(waves(), TRACK), kept, format=".csv")

    def test_an_edit_in_the_controls_of_a_rig_stays(self, tmp_path: Path) -> None:
        rig, output, kept = load_rig("vrm1"), tmp_path / "talk.vrma", tmp_path / "edits.json"
        first, later = (
            Performance(retarget(waves(phase=phase), rig), TRACK, rig=rig) for phase in (0.0, 1.0)
        )
        export_with_edits([output], first, kept)
        clip = read_clip(output).select(rig.names)
        changed = clip.with_curves({"happy": np.full(len(clip), 0.5)})
        export_all([output], Performance(changed, rig=rig))
        assert export_with_edits([output], later, kept).controls == ("happy",)
        assert read_clip(output).curve("happy") == pytest.approx(np.full(61, 0.5), abs=1e-5)


class TestStops:
    """A kill is an exception that nothing catches, at each of the writes in turn."""

    @pytest.mark.parametrize("stop", range(1, 5))
    def test_no_stop_loses_an_edit_or_applies_it_twice(
        self, stop: int, output: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        kept = output.with_name("talk.edits.json")
        export_with_edits([output], Performance(waves(), TRACK), kept)
        edit(output, slice(20, 30), "jawOpen", 0.25)
        writes = 0

        def killed(write):  # type: ignore[no-untyped-def]
            def until(*arguments: object, **more: object) -> None:
                nonlocal writes
                writes += 1
                if writes == stop:
                    raise KeyboardInterrupt
                write(*arguments, **more)

            return until

        with monkeypatch.context() as patch:
            patch.setattr(keeping, "save_edits", killed(keeping.save_edits))
            patch.setattr(keeping, "export_all", killed(keeping.export_all))
            with pytest.raises(KeyboardInterrupt):
                export_with_edits([output], Performance(waves(phase=1.0), TRACK), kept)
        export_with_edits([output], Performance(waves(phase=1.0), TRACK), kept)
        wanted = waves(phase=1.0).values.copy()
        wanted[20:30, 0] += 0.25
        assert read_clip(output).values == pytest.approx(wanted, abs=3e-5)


class TestFile:
    def test_edits_come_back_as_they_were(self, tmp_path: Path) -> None:
        path = tmp_path / "edits.json"
        edits = Edits(waves(), TRACK, (waves(phase=1.0), waves(phase=2.0)))
        save_edits(edits, path)
        back = load_edits(path)
        assert back.changes is not None
        assert back.track is not None
        assert back.changes.values == pytest.approx(waves().values, abs=1e-7)
        assert back.track.phones == TRACK.phones
        assert [clip.names for clip in back.written] == [NAMES, NAMES]

    def test_no_edits_come_back_as_none(self, tmp_path: Path) -> None:
        save_edits(Edits(), tmp_path / "edits.json")
        back = load_edits(tmp_path / "edits.json")
        assert (back.changes, back.track, back.written) == (None, None, ())

    @pytest.mark.parametrize(
        ("change", "reason"),
        [
            ({"version": 2}, "is of version 2 of lipwright-edits, not 1"),
            ({"format": "lipwright-clip"}, "is of the format 'lipwright-clip'"),
            ({"written": 3}, "'written' is no list of curves"),
            ({"written": [3]}, "'written' has no 'fps'"),
            ({"changes": {"fps": 60, "names": ["a"], "values": [["x"]]}}, "frame 0 is no list of"),
            ({"changes": {"fps": 60, "names": ["a"], "values": []}}, "'changes' is no clip"),
            ({"track": 3}, "'track' is no object"),
        ],
    )
    def test_a_file_that_holds_no_edits_is_refused_and_nothing_is_written(
        self, change: dict[str, object], reason: str, tmp_path: Path
    ) -> None:
        path, output = tmp_path / "edits.json", tmp_path / "a.csv"
        save_edits(Edits(), path)
        path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
        with pytest.raises(LipwrightError, match=reason) as refused:
            export_with_edits([output], Performance(waves(), TRACK), path)
        assert str(refused.value).startswith(f"{path}: ")
        assert not output.exists()

    def test_an_output_that_cannot_be_read_any_more_is_not_replaced(self, tmp_path: Path) -> None:
        output, path = tmp_path / "a.csv", tmp_path / "edits.json"
        export_with_edits([output], Performance(waves(), TRACK), path)
        output.write_text("time,jawOpen\n0,half\n")
        with pytest.raises(LipwrightError, match=r"a\.csv: line 2"):
            export_with_edits([output], Performance(waves(), TRACK), path)
        assert output.read_text() == "time,jawOpen\n0,half\n"

    @pytest.mark.parametrize("suffix", [".mp4", ".vrma"])
    def test_outputs_that_cannot_be_read_back_in_the_same_controls_are_refused(
        self, suffix: str, tmp_path: Path
    ) -> None:
        with pytest.raises(LipwrightError, match=r"--edits needs an output .*: \.json, \.csv"):
            export_with_edits([tmp_path / f"a{suffix}"], Performance(waves()), tmp_path / "e.json")
        assert list(tmp_path.iterdir()) == []


CURVES = arrays(np.float32, (6, 2), elements=st.floats(-1, 1, width=32))


class TestLaws:
    @given(CURVES, CURVES)
    def test_the_difference_added_to_the_base_is_what_was_found(
        self, base: np.ndarray, found: np.ndarray
    ) -> None:
        base_clip, found_clip = (Clip(("a", "b"), 30, values) for values in (base, found))
        edits = Edits(difference(found_clip, base_clip))
        assert edits.applied(base_clip).values == pytest.approx(found, abs=SAME + 1e-6)

    @given(CURVES, CURVES)
    def test_changes_add_up_whichever_came_first(self, a: np.ndarray, b: np.ndarray) -> None:
        first, second = (Clip(("a", "b"), 30, values) for values in (a, b))
        one, other = added(first, second), added(second, first)
        total = np.zeros((6, 2)) if one is None else one.select(("a", "b")).values
        assert total == pytest.approx(a + b, abs=3 * SAME)
        assert other is None or other.select(("a", "b")).values == pytest.approx(
            total, abs=3 * SAME
        )

    def test_moving_to_the_same_track_changes_nothing(self) -> None:
        edits = Edits(waves(), TRACK)
        moved = edits.moved_to(TRACK).changes
        assert moved is not None
        assert moved.values.tolist() == waves().values.tolist()

    def test_a_word_put_in_between_moves_what_follows(self) -> None:
        spike = waves().with_values(np.zeros((61, 3)))
        spike = spike.with_curves({"jawOpen": np.eye(61)[39]})  # 0.65 s, middle of AA
        more = PhoneTrack(
            ("sil", "M", "IY", "sil", "M", "AA", "sil"),
            np.array([0, 0.2, 0.4, 0.6, 0.8, 1.1, 1.4, 1.6]),
        )
        moved = Edits(spike, TRACK).moved_to(more).changes
        assert moved is not None
        peak = int(np.abs(moved.curve("jawOpen")).argmax())
        assert peak / 60 == pytest.approx(1.25, abs=0.02)

    def test_gathering_twice_adds_nothing(self) -> None:
        edits = Edits(None, TRACK, (waves(),))
        found = waves().with_curves({"jawOpen": np.ones(61)})
        once = edits.gathered(found)
        twice = once.gathered(found)
        assert once.changes is not None
        assert twice.changes is not None
        assert once.changes.values.tolist() == twice.changes.values.tolist()
