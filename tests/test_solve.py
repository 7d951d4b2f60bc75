"""ARKit weights out of landmarks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from lipwright.capture import solve as solver
from lipwright.capture.correspondence import (
    REGIONS,
    correspondence,
    landmark_points,
    landmark_shapes,
)
from lipwright.capture.pose import remove_pose
from lipwright.capture.solve import (
    REGION_WEIGHTS,
    Basis,
    SolveOptions,
    lip_gap,
    neutral_face,
    solve_arkit,
    unknowns_of,
)
from lipwright.capture.tracker import Tracker
from lipwright.controls import ARKIT, CANONICAL, MIRROR
from lipwright.dataset.recording import LANDMARKS
from lipwright.face.head import Head

GRID = Path(__file__).parents[2] / "shared" / "corpora" / "grid-s1"
FPS = 25.0

Floats = npt.NDArray[np.float64]


def faces_of(head: Head, weights: Floats) -> tuple[Floats, Floats]:
    """Landmarks (T, 478, 3) and aperture (T,) of the head under weights (T, 52)."""
    rest = landmark_points(head.vertices) / head.eye_distance * [1, -1, -1]
    faces = rest + np.tensordot(weights, landmark_shapes(head), axes=1)
    full = np.zeros((len(weights), len(CANONICAL)))
    full[:, : len(ARKIT)] = weights
    return faces, head.aperture_curve(full) + lip_gap(rest)


def rest_of(head: Head) -> Floats:
    return faces_of(head, np.zeros((1, len(ARKIT))))[0][0]


def planted(frames: int, **controls: float) -> Floats:
    """Weights (T, 52) that swell to the named values and back; both sides alike."""
    weights = np.zeros((frames, len(ARKIT)))
    swell = np.sin(np.linspace(0, np.pi, frames)) ** 2
    for name, value in controls.items():
        for side in {name, MIRROR[name]}:
            weights[:, ARKIT.index(side)] = value * swell
    return weights


def column(weights: npt.NDArray[np.floating], name: str) -> npt.NDArray[np.floating]:
    return weights[:, ARKIT.index(name)]


def speech(frames: int, seed: int = 0) -> Floats:
    """Weights (T, 52) of a mouth that babbles."""
    rng = np.random.default_rng(seed)
    weights = np.zeros((frames, len(ARKIT)))
    time = np.arange(frames) / FPS
    for name, most in (("jawOpen", 0.3), ("mouthPucker", 0.3), ("mouthUpperUpLeft", 0.3),
                       ("mouthSmileLeft", 0.3)):  # fmt: skip
        wave = np.sin(2 * np.pi * rng.uniform(1, 3) * time + rng.uniform(0, 6))
        for side in {name, MIRROR[name]}:
            weights[:, ARKIT.index(side)] = most * np.maximum(wave, 0)
    return weights


def test_the_table_puts_the_aperture_on_the_heads_own_lip_pairs(head: Head) -> None:
    table = correspondence()
    for pair, vertices in zip(((13, 14), (312, 317), (82, 87)), head.lip_pairs, strict=True):
        for landmark, vertex in zip(pair, vertices, strict=True):
            assert table.vertices[landmark][table.weights[landmark] > 0].tolist() == [vertex]


def test_the_table_is_mirror_symmetric_and_names_known_regions(head: Head) -> None:
    points = landmark_points(head.vertices)
    for right, left in ((61, 291), (33, 263), (468, 473), (172, 397), (105, 334), (95, 324)):
        assert points[left] == pytest.approx(points[right] * [-1, 1, 1], abs=1e-6)
    assert set(correspondence().regions) == set(REGIONS) == set(REGION_WEIGHTS)
    assert np.ptp(correspondence().weights.sum(axis=1)) < 1e-9


def test_points_of_a_pose_move_by_the_shapes(head: Head) -> None:
    weights = np.zeros(len(CANONICAL))
    weights[CANONICAL.index("jawOpen")] = 0.4
    moved = landmark_points(head.pose(weights)) - landmark_points(head.vertices)
    expected = 0.4 * landmark_shapes(head)[ARKIT.index("jawOpen")]
    assert moved / head.eye_distance * [1, -1, -1] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    "controls",
    [
        {"jawOpen": 0.5},
        {"jawOpen": 0.2, "mouthPucker": 0.6},
        {"jawOpen": 0.2, "mouthSmileLeft": 0.5},
        {"jawOpen": 0.1, "mouthUpperUpLeft": 0.5, "browInnerUp": 0.6},
        {"mouthFunnel": 0.5, "browDownLeft": 0.7},
    ],
)
def test_planted_weights_are_found(head: Head, controls: dict[str, float]) -> None:
    truth = planted(40, **controls)
    faces, aperture = faces_of(head, truth)
    found = solve_arkit(faces, aperture, head, FPS, rest_of(head))
    for name, value in controls.items():
        assert column(found, name).max() == pytest.approx(value, abs=0.12)
        assert np.corrcoef(column(found, name), column(truth, name))[0, 1] > 0.98
    own = [ARKIT.index(n) for c in controls for n in (c, MIRROR[c])]
    assert np.delete(found, own, axis=1).max() < 0.12
    again = faces_of(head, found.astype(float))[1]
    assert again == pytest.approx(aperture, abs=0.004)


def test_shut_lips_stay_shut_while_the_jaw_moves(head: Head) -> None:
    truth = planted(30, jawOpen=0.3, mouthClose=0.3)
    faces, aperture = faces_of(head, truth)
    found = solve_arkit(faces, aperture, head, FPS, rest_of(head)).astype(float)
    assert column(found, "jawOpen").max() > 0.15
    assert faces_of(head, found)[1].max() - lip_gap(rest_of(head)) < 0.002


def test_a_blink_of_the_speakers_own_lids_is_a_whole_blink(head: Head) -> None:
    rest = rest_of(head)
    faces = np.repeat(rest[None], 25, axis=0)
    shut = np.exp(-(((np.arange(25) - 12) / 2.0) ** 2))
    regions = correspondence().regions
    upper = [n for n in range(LANDMARKS) if regions[n] == "eyes" and rest[n, 1] < rest[33, 1]]
    gap = solver.lid_gaps(rest)
    # Lids meet at the height of the corners' line or below; the middle travels furthest.
    full = landmark_shapes(head)[[ARKIT.index(n) for n in solver.BLINKS]].sum(axis=0)
    travel = solver.LID_TRAVEL * gap / full[159, 1]
    faces[:, upper] += (shut[:, None, None] * travel * full[upper]).astype(float)
    found = solve_arkit(faces, np.full(25, lip_gap(rest)), head, FPS, rest)
    assert column(found, "eyeBlinkLeft")[12] > 0.7
    assert column(found, "eyeBlinkLeft")[[0, -1]].max() < 0.05


def test_the_rest_face_gives_no_weights(head: Head) -> None:
    faces, aperture = faces_of(head, np.zeros((20, len(ARKIT))))
    noise = 0.001 * np.random.default_rng(0).standard_normal(faces.shape)
    found = solve_arkit(faces + noise, aperture, head, FPS, rest_of(head))
    assert found.max() < 0.02


def test_tied_weights_are_symmetric_and_gaze_is_conjugate(head: Head) -> None:
    rng = np.random.default_rng(1)
    faces, aperture = faces_of(head, np.zeros((10, len(ARKIT))))
    found = solve_arkit(
        faces + 0.05 * rng.standard_normal(faces.shape), aperture + 0.1, head, FPS, rest_of(head)
    )
    for name in ARKIT:
        if name in {"jawLeft", "jawRight", "mouthLeft", "mouthRight", "tongueOut"}:
            assert not column(found, name).any()
        elif not name.startswith(("eyeLookIn", "eyeLookOut")):
            assert (column(found, name) == column(found, MIRROR[name])).all()
    assert (column(found, "eyeLookInLeft") == column(found, "eyeLookOutRight")).all()
    assert ((found >= 0) & (found <= 1)).all()


def test_untied_weights_find_a_smile_of_one_side_and_a_jaw_to_the_left(head: Head) -> None:
    truth = np.zeros((12, len(ARKIT)))
    truth[:, ARKIT.index("mouthSmileLeft")] = 0.6
    truth[:, ARKIT.index("jawLeft")] = 0.4
    faces, aperture = faces_of(head, truth)
    found = solve_arkit(faces, aperture, head, FPS, rest_of(head), SolveOptions(tied=False))
    assert column(found, "mouthSmileLeft").mean() == pytest.approx(0.6, abs=0.15)
    assert column(found, "mouthSmileRight").max() < 0.1
    assert column(found, "jawLeft").mean() > 0.2
    assert column(found, "jawRight").max() < 0.05


def test_lost_frames_stay_nan_and_part_the_runs(head: Head) -> None:
    faces, aperture = faces_of(head, speech(40))
    faces[15:20] = np.nan
    aperture[30] = np.nan
    found = solve_arkit(faces, aperture, head, FPS, rest_of(head))
    lost = [*range(15, 20), 30]
    assert np.isnan(found[lost]).all()
    assert np.isfinite(np.delete(found, lost, axis=0)).all()
    alone = solve_arkit(faces[:15], aperture[:15], head, FPS, rest_of(head))
    assert found[:15] == pytest.approx(alone, abs=1e-6)


def test_no_frames_give_no_weights(head: Head) -> None:
    found = solve_arkit(np.zeros((0, LANDMARKS, 3)), np.zeros(0), head, FPS, rest_of(head))
    assert found.shape == (0, len(ARKIT))


def test_blocks_give_the_values_of_one_piece(head: Head, monkeypatch: pytest.MonkeyPatch) -> None:
    faces, aperture = faces_of(head, speech(300))
    whole = solve_arkit(faces, aperture, head, FPS, rest_of(head))
    monkeypatch.setattr(solver, "BLOCK", 70)
    assert solve_arkit(faces, aperture, head, FPS, rest_of(head)) == pytest.approx(whole, abs=1e-4)


def test_newtons_method_finds_what_scipy_finds(head: Head) -> None:
    from scipy.optimize import minimize

    faces, aperture = faces_of(head, speech(8, seed=3))
    basis = Basis(head, SolveOptions(), FPS)
    pull = basis.pull(faces, rest_of(head))
    target = aperture - lip_gap(rest_of(head))
    ours = basis.minimise(pull, target)

    def cost(flat: Floats) -> tuple[float, Floats]:
        value, slope, _ = basis.cost(flat.reshape(pull.shape), pull, target)
        return value, slope.ravel()

    theirs = minimize(
        cost, np.full(pull.size, 0.1), jac=True, method="L-BFGS-B", bounds=[(0, 1)] * pull.size,
        options={"maxiter": 20000, "maxfun": 40000, "ftol": 1e-15, "gtol": 1e-10},
    )  # fmt: skip
    assert cost(ours.ravel())[0] <= theirs.fun + 1e-10
    assert ours.ravel() == pytest.approx(theirs.x, abs=2e-3)


def test_every_control_that_can_be_seen_has_one_unknown() -> None:
    tied, untied = unknowns_of(tied=True), unknowns_of(tied=False)
    assert untied.shape == (51, 52)
    assert set(tied.sum(axis=0)) == {0.0, 1.0}
    hidden = {ARKIT[i] for i in np.flatnonzero(tied.sum(axis=0) == 0)}
    assert hidden == {"jawLeft", "jawRight", "mouthLeft", "mouthRight", "tongueOut"}


def test_shapes_that_do_not_match_are_refused(head: Head) -> None:
    with pytest.raises(ValueError, match="do not match"):
        solve_arkit(np.zeros((3, LANDMARKS, 3)), np.zeros(4), head, FPS, rest_of(head))


def marked(frames: int) -> Floats:
    """Faces whose points all hold the number of their frame."""
    return np.broadcast_to(np.arange(frames, dtype=float)[:, None, None], (frames, LANDMARKS, 3))


def test_the_rest_face_is_of_quiet_frames_with_shut_lips() -> None:
    aperture = np.array([0.0, 0.0, 0.0, 0.2, 0.3, 0.3, 0.0, 0.0, 0.0, 0.2])
    quiet = np.array([1, 1, 1, 1, 0, 0, 0, 0, 0, 1], bool)
    assert (neutral_face(marked(10), aperture, quiet) == 1).all()


def test_without_quiet_shut_frames_the_tightest_are_taken() -> None:
    aperture = np.linspace(0.1, 0.3, 30)
    late = np.arange(30) >= 15
    assert (neutral_face(marked(30), aperture, late) == 17).all()  # of 15 to 19
    assert (neutral_face(marked(30), aperture, np.zeros(30, bool)) == 1).all()  # of 0 to 2


def test_a_recording_without_a_face_has_no_rest_face() -> None:
    with pytest.raises(ValueError, match="no frame"):
        neutral_face(np.full((5, LANDMARKS, 3), np.nan), np.full(5, np.nan), np.ones(5, bool))


@pytest.mark.skipif(not GRID.exists(), reason="the GRID recordings are not here")
def test_a_real_sentence_is_followed(head: Head) -> None:
    points = Tracker().track_video(GRID / "video" / "lgbs6n.mp4").points
    faces = remove_pose(points, FPS)[0].astype(float)
    gaps = np.array([lip_gap(face) for face in faces])
    quiet = np.arange(len(gaps)) < 12
    neutral = neutral_face(faces, gaps, quiet)
    found = solve_arkit(faces, gaps, head, FPS, neutral)
    posed = head.aperture_curve(np.pad(found, ((0, 0), (0, len(CANONICAL) - len(ARKIT)))))
    real = np.maximum(gaps - lip_gap(neutral), 0)
    assert np.corrcoef(real, posed)[0, 1] > 0.98
    assert 0.95 < np.polyfit(real, posed, 1)[0] < 1.05
    shut = real < 0.15 * np.percentile(real, 95)
    assert (posed[shut] < 0.15 * np.percentile(posed, 95)).mean() > 0.98
    for name in ("mouthFrownLeft", "mouthShrugLower", "mouthPressLeft", "noseSneerLeft"):
        assert column(found[quiet], name).mean() < 0.03


def test_a_speaker_who_never_shuts_the_lips_is_not_taken_for_one_with_shut_lips(
    head: Head,
) -> None:
    points, gaps = (values[8:22] for values in faces_of(head, planted(30, jawOpen=0.4)))
    assert gaps.min() > 0.1
    rest = neutral_face(points, gaps, np.ones(14, bool))
    _, opened = faces_of(head, solve_arkit(points, gaps, head, 25.0, rest))
    assert opened.min() > 0.8 * gaps.min()
