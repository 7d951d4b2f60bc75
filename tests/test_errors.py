"""Errors against a reference face: planted parameters, the drawn pictures, and what is refused."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.dataset.folder import open_dataset, sha256_of
from lipwright.dataset.recording import FACE_FILE, Recording
from lipwright.errors import LipwrightError
from lipwright.evaluate.errors import (
    OF_FRAMES,
    OF_SHAPE,
    Truth,
    error_rows,
    face_r,
    frame_errors,
    load_truth,
)
from lipwright.evaluate.lip_rows import lip_rows, lower
from lipwright.evaluate.lips import LipScore, pool
from lipwright.evaluate.measures import MEASURES, Rows
from lipwright.face.appearance import LUMA
from lipwright.face.faceclip import control_names
from lipwright.face.reference import ReferenceFace
from lipwright.face.reference_file import load_reference_face
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack


@dataclass(frozen=True, eq=False)
class Planted:
    """A recording whose answers are known."""

    face: ReferenceFace
    face_hash: str
    recording: Recording
    truth: Truth

    def own(self, kind: str = "joint") -> Clip:
        """The recording's own parameters as curves."""
        modes = "joint" if kind == "joint" else "shape"
        stored = self.recording.face()
        assert stored is not None
        values = np.nan_to_num(stored[modes] / self.face.sd(modes))
        return Clip(control_names(self.face, modes), self.recording.motion.fps, values)


@pytest.fixture(scope="module")
def anna(speakers: Path) -> Planted:
    path = speakers / "anna-face.npz"
    recording, known = open_dataset(speakers / "anna").recording("anna1"), sha256_of(path)
    return Planted(load_reference_face(path), known, recording, load_truth(recording, known))


# --- errors of frames ---


def test_a_perfect_prediction_has_no_error_but_what_the_modes_lose(anna: Planted) -> None:
    found = frame_errors(anna.face, anna.truth, anna.own())
    assert tuple(found) == OF_FRAMES
    assert found["joint_sd"].max() < 1e-6
    assert 0 < found["vertices"].mean() < 0.01**2
    assert len(found["outer"]) == len(found["joint"]) == anna.truth.valid.sum()
    assert len(found["inner"]) == anna.truth.visible.sum()
    assert face_r(anna.face, anna.truth, anna.own()) > 0.98


@pytest.mark.parametrize("mode", [0, 2])
def test_one_mode_that_is_off_by_a_deviation_costs_its_share(anna: Planted, mode: int) -> None:
    clip, sd = anna.own(), anna.face.joint_sd
    moved = clip.with_curves({clip.names[mode]: clip.values[:, mode] + 1})
    found = frame_errors(anna.face, anna.truth, moved)
    assert found["joint_sd"] == pytest.approx(1 / len(sd), rel=1e-3)
    assert found["joint"] == pytest.approx(sd[mode] ** 2 / len(sd), rel=1e-3)


def test_errors_of_pixels_are_those_of_the_drawn_pictures(anna: Planted) -> None:
    """A second way: colours drawn, clipped each, and then made grey."""
    clip = anna.own()
    moved = clip.with_values(0.5 * clip.values + 0.3)
    found = frame_errors(anna.face, anna.truth, moved)
    real = anna.truth.parameters
    made = anna.face.split(moved.values[anna.truth.valid] * anna.face.joint_sd)
    for region, seen in (("inner", anna.truth.visible), ("outer", slice(None))):
        appearance = getattr(anna.face, region)
        drawn = [np.clip(appearance.pixels(getattr(one, region)[seen]), 0, 255).astype(float) @ LUMA
                 for one in (made, real)]  # fmt: skip
        expected = np.square(drawn[0] - drawn[1]).mean(axis=1)
        assert found[region] == pytest.approx(expected, rel=0.02)
    apart = anna.face.points(made.shape) - anna.truth.points
    assert found["vertices"] == pytest.approx(np.square(apart).sum(axis=2).mean(axis=1), rel=1e-4)
    shape = np.square(made.shape - real.shape).mean(axis=1)
    assert found["shape"] == pytest.approx(shape, rel=1e-4)


def test_grey_levels_are_clipped_to_what_a_picture_holds(anna: Planted) -> None:
    wild = np.zeros((2, len(anna.face.outer)), np.float32)
    wild[:, 0] = (1e6, -1e6)
    levels = anna.face.outer.grey(wild)
    assert levels.min() == 0
    assert levels.max() == pytest.approx(255)


def test_curves_of_shape_modes_have_no_pixels(anna: Planted) -> None:
    found = error_rows(anna.face, [anna.truth], [anna.own("shape")])
    assert set(found) == {*OF_SHAPE, "face_r"}
    assert found["shape"].value < 1e-9
    assert found["face_r"].value > 0.98


def test_controls_that_are_no_modes_change_nothing(anna: Planted) -> None:
    clip = anna.own()
    beside = np.full((len(clip), 2), 0.7, np.float32)
    both = Clip(("jawOpen", *clip.names[::-1], "mouthFunnel"), clip.fps,
                np.hstack([beside[:, :1], clip.values[:, ::-1], beside[:, 1:]]))  # fmt: skip
    mine, other = (frame_errors(anna.face, anna.truth, one) for one in (clip, both))
    for name, values in mine.items():
        assert np.array_equal(values, other[name])


def test_only_the_errors_asked_for_are_found_and_are_the_same(anna: Planted) -> None:
    every = frame_errors(anna.face, anna.truth, anna.own())
    for name in OF_FRAMES:
        found = frame_errors(anna.face, anna.truth, anna.own(), (name,))
        assert list(found) == [name]
        assert np.array_equal(found[name], every[name])


def test_frames_without_a_face_count_for_nobody(anna: Planted) -> None:
    kept = np.arange(len(anna.truth.times)) % 3 > 0
    valid = anna.truth.valid.copy()
    valid[np.flatnonzero(valid)[~kept]] = False
    part = replace(
        anna.truth, times=anna.truth.times[kept], valid=valid, visible=anna.truth.visible[kept],
        parameters=anna.truth.parameters[kept], points=anna.truth.points[kept],
    )  # fmt: skip
    clip = anna.own().with_values(anna.own().values + 0.2)
    whole, some = (frame_errors(anna.face, truth, clip) for truth in (anna.truth, part))
    assert some["joint_sd"] == pytest.approx(whole["joint_sd"][kept])
    assert some["inner"] == pytest.approx(whole["inner"][kept[anna.truth.visible]])
    wild = clip.with_values(np.where(valid[:, None], clip.values, 1e6))
    again = frame_errors(anna.face, part, wild)
    assert all(np.array_equal(again[name], some[name]) for name in OF_FRAMES)


def test_a_recording_without_any_face_has_no_frames(anna: Planted) -> None:
    none = np.zeros(len(anna.truth.times), bool)
    empty = replace(
        anna.truth, times=anna.truth.times[none], valid=np.zeros_like(anna.truth.valid),
        visible=anna.truth.visible[none], parameters=anna.truth.parameters[none],
        points=anna.truth.points[none],
    )  # fmt: skip
    found = error_rows(anna.face, [empty, anna.truth], [anna.own(), anna.own()])
    assert set(found) == {name for name, one in MEASURES.items() if one.group == "error"}
    for rows in found.values():
        assert rows.counts[0] == 0 < rows.counts[1]


def test_rows_pool_frames_and_not_recordings(anna: Planted) -> None:
    off = anna.own().with_values(anna.own().values + 1)
    found = error_rows(anna.face, [anna.truth] * 3, [anna.own(), off, off])
    assert found["joint_sd"].value == pytest.approx(2 / 3, rel=1e-3)
    assert found["joint_sd"].counts == pytest.approx(3 * [anna.truth.valid.sum()])
    assert found["inner"].counts == pytest.approx(3 * [anna.truth.visible.sum()])
    assert found["face_r"].counts == pytest.approx([1, 1, 1])


def test_lips_that_do_not_move_and_silence_have_no_r(anna: Planted) -> None:
    still = anna.own().with_values(np.zeros_like(anna.own().values))
    assert np.isnan(face_r(anna.face, anna.truth, still))
    silent = PhoneTrack((SILENCE,), np.array([0.0, anna.truth.track.end]))
    assert np.isnan(face_r(anna.face, replace(anna.truth, track=silent), anna.own()))
    rows = error_rows(anna.face, [anna.truth] * 2, [still, anna.own()])["face_r"]
    assert rows.counts == pytest.approx([0, 1])
    assert rows.value == pytest.approx(face_r(anna.face, anna.truth, anna.own()))


# --- what is refused ---


@pytest.mark.parametrize(
    ("names", "complaint"),
    [
        (("jawOpen",), "no joint and no shape modes"),
        (("joint1", "shape1"), "keep either"),
        (("joint1", "joint9999"), "joint9999, and the reference face"),
    ],
)
def test_curves_that_are_not_of_this_face_are_refused(
    anna: Planted, names: tuple[str, ...], complaint: str
) -> None:
    clip = Clip(names, 25, np.zeros((len(anna.truth.valid), len(names)), np.float32))
    with pytest.raises(LipwrightError, match=complaint):
        frame_errors(anna.face, anna.truth, clip)


def test_curves_of_another_length_are_refused(anna: Planted) -> None:
    with pytest.raises(ValueError, match="frames of curves"):
        frame_errors(anna.face, anna.truth, anna.own().with_values(anna.own().values[1:]))


def test_parameters_that_are_missing_foreign_or_broken_are_refused(
    anna: Planted, tmp_path: Path
) -> None:
    bare = replace(anna.recording, folder=tmp_path)
    with pytest.raises(LipwrightError, match="has no parameters; run: lipwright face fit"):
        load_truth(bare, anna.face_hash)
    with pytest.raises(LipwrightError, match="another reference face"):
        load_truth(anna.recording, "0" * 64)
    stored = anna.recording.face()
    assert stored is not None
    for name, broken in (("inner", stored["inner"][1:]), ("inner_visible", np.zeros(3)),
                         ("shape", np.array(["no", "numbers"]))):  # fmt: skip
        np.savez(tmp_path / FACE_FILE, **{**stored, name: broken})
        with pytest.raises(LipwrightError, match=f"{FACE_FILE}: {name} is not"):
            load_truth(bare, anna.face_hash)
    np.savez(tmp_path / FACE_FILE, model=anna.face_hash)
    with pytest.raises(LipwrightError, match="joint is not"):
        load_truth(bare, anna.face_hash)


# --- rows of lips ---

GOOD = LipScore(0.9, 0.95, 0.02, 2, 3, 1, 2.0, 0.1)
FAIR = LipScore(0.5, 0.7, -0.04, 1, 1, 0, 1.0, float("nan"))
STILL = LipScore(float("nan"), float("nan"), 0.0, 0, 2, 0, 2.0, 0.4)


def test_rows_of_lips_are_the_pooled_figures() -> None:
    rows, pooled = lip_rows([GOOD, FAIR]), pool([GOOD, FAIR])
    assert set(rows) == {name for name, one in MEASURES.items() if one.group == "lips"}
    names = {"lag": "lag_ms", "false_closures": "false_closures_per_s"}
    for name, one in rows.items():
        assert one.value == pytest.approx(pooled[names.get(name, name)])


def test_lips_that_do_not_move_have_no_r_and_no_lag_but_miss_their_closures() -> None:
    rows = lip_rows([GOOD, STILL])
    assert [rows[name].counts[1] for name in ("r", "r_best_lag", "lag")] == [0, 0, 0]
    assert rows["lag"].value == pytest.approx(20)
    assert rows["closures"].value == pytest.approx(2 / 5)
    assert rows["silence"].value == pytest.approx(0.25)
    assert all(len(one.sums) == 0 for one in lip_rows([]).values())


def test_the_head_with_the_lower_r_is_chosen() -> None:
    good, fair, still = (lip_rows([one]) for one in (GOOD, FAIR, STILL))
    assert lower({"a": good, "b": fair}) == ("b", fair)
    assert lower({"a": fair, "b": good}) == ("a", fair)
    assert lower({"a": still, "b": good}) == ("b", good)
    assert lower({"a": still, "b": still}) == ("a", still)
    assert lower({"a": good, "b": dict(good)})[0] == "a"
    with pytest.raises(ValueError, match="no head"):
        lower({})


def test_rows_refuse_what_is_no_number() -> None:
    with pytest.raises(ValueError, match="not finite"):
        Rows(np.array([np.nan]), np.array([1.0]))
