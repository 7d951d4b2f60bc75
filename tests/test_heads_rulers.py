"""Rulers measure planted openings, and refuse files that are no heads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.evaluate.heads import EYES, LOWER_LIP, POINTS, UPPER_LIP, landmark_head, rulers
from lipwright.face.head import Head

RULER = Path(__file__).parents[2] / "shared" / "corpora" / "rulers" / "ict-landmarks.npz"
GAP, OPENING = 0.02, 0.5  # eye distances: between the points at rest, and of a full jawOpen


def planted(**changes: Any) -> dict[str, np.ndarray[Any, Any]]:
    """A head twice as large as its unit: eyes 2 apart; half of the brows' points move."""
    neutral = np.zeros((POINTS, 3), np.float32)
    neutral[EYES[0], 0], neutral[EYES[1], 0] = -1, 1
    neutral[list(LOWER_LIP), 1] = -2 * GAP
    deltas = np.zeros((5, POINTS, 3), np.float32)
    deltas[0][list(LOWER_LIP), 1] = -2 * OPENING
    deltas[1][list(LOWER_LIP), 1] = 2
    for half in (2, 3):  # the two halves of a middle control
        deltas[half][list(UPPER_LIP), 1] = 0.1
    deltas[4][list(UPPER_LIP), 2] = 3  # to the camera: not seen
    names = np.array(["jawOpen", "mouthClose", "cheekPuff_L", "cheekPuff_R", "mouthSmile_L"])
    return {"neutral": neutral, "deltas": deltas, "names": names} | changes


def write(path: Path, arrays: dict[str, Any]) -> Path:
    np.savez(path, **arrays)
    return path


def curve(name: str, *values: float) -> Clip:
    return Clip((name,), 60, np.array(values, np.float32)[:, None])


def test_a_planted_opening_is_measured_in_eye_distances_without_the_gap_at_rest(
    tmp_path: Path,
) -> None:
    measure = landmark_head(write(tmp_path / "head.npz", planted()))
    found = measure(curve("jawOpen", 0, 0.5, 1))
    assert found == pytest.approx([0, OPENING / 2, OPENING], abs=1e-6)


def test_lips_that_meet_are_shut_and_depth_is_not_seen(tmp_path: Path) -> None:
    measure = landmark_head(write(tmp_path / "head.npz", planted()))
    assert measure(curve("mouthClose", GAP)) == pytest.approx([0], abs=1e-6)
    assert measure(curve("mouthSmileLeft", 1)) == pytest.approx([0], abs=1e-6)
    assert measure(curve("browDownLeft", 1)) == pytest.approx([0], abs=1e-6)


def test_both_halves_of_a_middle_control_count(tmp_path: Path) -> None:
    measure = landmark_head(write(tmp_path / "head.npz", planted()))
    assert measure(curve("cheekPuff", 1)) == pytest.approx([0.1], abs=1e-6)


def test_the_size_of_the_head_does_not_matter(tmp_path: Path) -> None:
    arrays = planted()
    large = {name: arrays[name] * np.float32(30) for name in ("neutral", "deltas")}
    clip = curve("jawOpen", 0.3)
    small, big = (
        landmark_head(write(tmp_path / f"{number}.npz", one))(clip)
        for number, one in enumerate((arrays, arrays | large))
    )
    assert big == pytest.approx(small, rel=1e-5)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"neutral": np.zeros((60, 3), np.float32)}, "neutral is float32 of the shape"),
        ({"deltas": np.zeros((4, POINTS, 3), np.float32)}, "deltas is float32 of the shape"),
        ({"neutral": np.full((POINTS, 3), np.nan, np.float32)}, "not finite"),
        ({"neutral": np.zeros((POINTS, 3), np.int64)}, "neutral is int64"),
        ({"neutral": np.zeros((POINTS, 3), np.float32)}, "the eyes"),
        ({"names": np.array(["jawOpen"] * 5)}, "repeats"),
        ({"names": np.array(["jawOpen", "a", "b", "c", "d"])}, "'a' is no ARKit control"),
        ({"names": np.arange(5)}, "names are not a row of text"),
        ({"names": np.array(["jawOpen"], object)}, "not a readable head"),
    ],
)
def test_what_is_no_head_is_one_line_with_file_and_remedy(
    tmp_path: Path, changes: dict[str, Any], told: str
) -> None:
    path = write(tmp_path / "stranger.npz", planted(**changes))
    with pytest.raises(LipwrightError) as caught:
        landmark_head(path)
    assert told in str(caught.value)
    assert str(path) in str(caught.value)
    assert "(C, 68, 3)" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_are_missing_or_damaged_are_told(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="no such file"):
        landmark_head(tmp_path / "none.npz")
    whole = write(tmp_path / "head.npz", planted()).read_bytes()
    for number, data in enumerate((b"", b"no zip", whole[: len(whole) // 2])):
        path = tmp_path / f"{number}.npz"
        path.write_bytes(data)
        with pytest.raises(LipwrightError, match="not a readable head"):
            landmark_head(path)


def test_weights_out_of_all_range_give_numbers(tmp_path: Path) -> None:
    arrays = planted()
    arrays["deltas"][4][EYES[0], 0] = 2  # a smile that moves one eye onto the other
    measure = landmark_head(write(tmp_path / "head.npz", arrays))
    assert np.isfinite(measure(curve("mouthSmileLeft", 1, 1e6))).all()


def test_our_head_opens_with_the_jaw_and_is_shut_at_rest(head: Head) -> None:
    assert head.eye_distance > 0
    found = rulers(None)
    assert list(found) == ["our head"]
    opening = found["our head"](curve("jawOpen", 0, 0.5, 1))
    assert opening[0] == pytest.approx(0, abs=0.005)
    assert np.diff(opening).min() > 0.1


@pytest.mark.skipif(not RULER.is_file(), reason="the second head is not here")
def test_both_heads_tell_the_same_story_of_jaw_and_lips(head: Head) -> None:
    assert head.eye_distance > 0
    found = rulers(RULER)
    assert list(found) == ["our head", "ruler head"]
    values = np.random.default_rng(0).uniform(0, 0.6, (200, 2)).astype(np.float32)
    values[:, 1] *= values[:, 0]  # lips that close against an open jaw do not cross
    clip = Clip(("jawOpen", "mouthClose"), 60, values)
    ours, theirs = (measure(clip) for measure in found.values())
    assert np.corrcoef(ours, theirs)[0, 1] > 0.95
