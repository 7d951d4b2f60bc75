"""The bridge finds a planted map, and leaves alone what speech does not move."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from lipwright.clip import Clip
from lipwright.controls import ARKIT
from lipwright.evaluate.bridge import PENALTIES, UNTRIED, Bridge, fit_bridge, recalibrated

MODES = ("joint1", "joint2", "joint3")
MOVING = ("jawOpen", "mouthClose", "mouthPucker", "mouthSmileLeft", "mouthSmileRight")
FRAMES, RECORDINGS = 1200, 20

Floats = np.ndarray[Any, Any]


def planted(noise: float = 0.0) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Weights (N, 52), modes, recordings, the map (C, M) and its bias."""
    rng = np.random.default_rng(7)
    weights = np.zeros((FRAMES, len(ARKIT)))
    for name in MOVING[:4]:
        weights[:, ARKIT.index(name)] = rng.uniform(0, 1, FRAMES)
    left, right = (ARKIT.index(f"mouthSmile{side}") for side in ("Left", "Right"))
    weights[:, right] = weights[:, left]  # as the solver ties them
    slopes, bias = rng.normal(size=(len(MOVING), len(MODES))), rng.normal(size=len(MODES))
    slopes[4] = slopes[3]
    modes = weights[:, [ARKIT.index(name) for name in MOVING]] @ slopes + bias
    modes = modes + noise * rng.normal(size=modes.shape)
    return weights, modes, np.repeat(np.arange(RECORDINGS), FRAMES // RECORDINGS), slopes, bias


def test_a_planted_map_is_found_with_sides_that_move_as_one() -> None:
    weights, modes, owners, slopes, bias = planted()
    bridge = fit_bridge(weights, modes, ARKIT, MODES, owners)
    assert set(bridge.controls) == set(MOVING)
    order = [bridge.controls.index(name) for name in MOVING]
    assert bridge.weights[order] == pytest.approx(slopes, abs=1e-3)
    assert bridge.bias == pytest.approx(bias, abs=1e-3)
    assert bridge.penalty == PENALTIES[0]


def test_applied_to_curves_it_reads_names_and_keeps_the_clock() -> None:
    weights, modes, owners, slopes, bias = planted()
    bridge = fit_bridge(weights, modes, ARKIT, MODES, owners)
    clip = Clip(("headYaw", "jawOpen"), 30, np.array([[9, 0], [9, 0.5]], np.float32))
    found = bridge.apply(clip)
    assert (found.names, found.fps) == (MODES, 30)
    assert found.values == pytest.approx(np.stack([bias, bias + slopes[0] / 2]), abs=2e-3)


def test_it_commutes_with_the_mean_of_curves() -> None:
    weights, modes, owners, *_ = planted(0.5)
    bridge = fit_bridge(weights, modes, ARKIT, MODES, owners)
    one, two = weights[:50], weights[50:100]
    apart = [bridge.apply(Clip(ARKIT, 25, values)).values for values in (one, two)]
    together = bridge.apply(Clip(ARKIT, 25, (one + two) / 2)).values
    assert together == pytest.approx(np.mean(apart, axis=0), abs=1e-5)


def test_brows_and_eyes_are_not_read_however_well_they_tell() -> None:
    weights, modes, owners, *_ = planted()
    weights[:, ARKIT.index("browInnerUp")] = modes[:, 0]
    bridge = fit_bridge(weights, modes, ARKIT, MODES, owners)
    assert "browInnerUp" not in bridge.controls


def test_where_recordings_differ_by_chance_cross_validation_shrinks() -> None:
    rng = np.random.default_rng(3)
    owners = np.repeat(np.arange(10), 4)
    weights, modes = rng.uniform(0, 1, (40, len(ARKIT))), rng.normal(size=(40, 3))
    bridge = fit_bridge(weights, modes, ARKIT, MODES, owners)
    assert bridge.penalty >= 1


def test_the_choice_is_that_of_a_plain_cross_validation() -> None:
    """Against fits of each fold by least squares with rows added for the penalty."""
    rng = np.random.default_rng(5)
    owners = np.repeat(np.arange(12), 5)
    names = [n for n in ARKIT if n.startswith(("mouth", "jaw"))]
    x = rng.uniform(0, 1, (60, len(names)))
    y = x[:, :3] * 2 + rng.normal(size=(60, 3))
    scaled, apart = (x - x.mean(axis=0)) / x.std(axis=0), y - y.mean(axis=0)
    errors = []
    for penalty in PENALTIES:
        total = 0.0
        for fold in range(5):
            held = owners % 5 == fold
            ridge = np.sqrt(penalty * (~held).sum()) * np.eye(len(names))
            slopes = np.linalg.lstsq(
                np.concatenate([scaled[~held], ridge]),
                np.concatenate([apart[~held], np.zeros((len(names), 3))]), rcond=None,
            )[0]  # fmt: skip
            total += float(np.square(apart[held] - scaled[held] @ slopes).sum())
        errors.append(total)
    assert fit_bridge(x, y, names, MODES, owners).penalty == PENALTIES[int(np.argmin(errors))]


def test_one_recording_and_a_face_that_never_moves_are_enough() -> None:
    weights, modes, *_ = planted()
    assert fit_bridge(weights, modes, ARKIT, MODES, np.zeros(FRAMES)).penalty == UNTRIED
    still = fit_bridge(np.zeros_like(weights), modes, ARKIT, MODES, np.zeros(FRAMES))
    assert still.controls == ()
    found = still.apply(Clip(("jawOpen",), 25, np.ones((2, 1), np.float32)))
    assert found.values == pytest.approx(np.tile(modes.mean(axis=0), (2, 1)), abs=1e-5)


def test_an_engine_of_another_scale_and_rest_is_brought_to_the_speakers() -> None:
    weights, modes, owners, *_ = planted()
    bridge = fit_bridge(weights, modes, ARKIT, MODES, owners)
    own = weights[:, [ARKIT.index(name) for name in bridge.controls]]
    engine = own * 2.5 + 0.1
    engine[:, 0] = 0.3  # does not move
    found = recalibrated(bridge, own, engine)
    known = slice(1, None)
    assert found.weights[known] == pytest.approx(bridge.weights[known] / 2.5, abs=1e-6)
    assert engine @ found.weights + found.bias == pytest.approx(
        np.concatenate([np.full((FRAMES, 1), own[:, 0].mean()), own[:, 1:]], axis=1)
        @ bridge.weights + bridge.bias, abs=1e-6,
    )  # fmt: skip


@pytest.mark.parametrize(
    "change",
    [
        {"weights": np.zeros((2, 51))},
        {"modes": np.zeros((1, 3))},
        {"recordings": np.zeros(3)},
        {"modes": np.full((2, 3), np.nan)},
        {"weights": np.zeros((0, 52)), "modes": np.zeros((0, 3)), "recordings": np.zeros(0)},
    ],
)
def test_frames_that_do_not_fit_are_refused(change: dict[str, Any]) -> None:
    given: dict[str, Any] = {
        "weights": np.zeros((2, 52)), "modes": np.zeros((2, 3)), "recordings": np.zeros(2),
    }  # fmt: skip
    with pytest.raises(ValueError, match=r"are not those|not finite"):
        fit_bridge(**given | change, controls=ARKIT, mode_names=MODES)


def test_a_bridge_of_the_wrong_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="weights are"):
        Bridge(("jawOpen",), MODES, np.zeros((2, 3)), np.zeros(3), 1.0)
