"""Likeliest curves of rows of Gaussians: against a dense solve, and laws."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import solveh_banded

from lipwright.engines.mlpg import WINDOWS, _solve, _system, likeliest, with_deltas

Values = npt.NDArray[np.float64]


def asked(count: int, controls: int = 3) -> tuple[Values, ...]:
    rng = np.random.default_rng(count)
    return rng.normal(size=(count, 3, controls)), rng.uniform(0.1, 9, (count, 3, controls))


def dense(
    means: npt.NDArray[np.float64], weights: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """The same by Tokuda's W, written out, and least squares."""
    count, _, controls = means.shape
    rows, place = [], []
    for order, window in enumerate(WINDOWS):
        for frame in range(count):
            if order and not 0 < frame < count - 1:
                continue
            row = np.zeros(count)
            for offset, weight in zip((-1, 0, 1), window, strict=True):
                if weight:
                    row[frame + offset] = weight
            rows.append(row)
            place.append((frame, order))
    w, (frames, orders) = np.array(rows), np.array(place).T
    curves = np.empty((count, controls))
    for control in range(controls):
        root = np.sqrt(weights[frames, orders, control])
        curves[:, control] = np.linalg.lstsq(
            w * root[:, None], means[frames, orders, control] * root, rcond=None
        )[0]
    return curves


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 60])
def test_the_banded_solve_is_the_dense_one(count: int) -> None:
    np.testing.assert_allclose(likeliest(*asked(count)), dense(*asked(count)), atol=1e-9)


def test_the_solver_is_that_of_lapack() -> None:
    bands, right = _system(*asked(300))
    lapack = [solveh_banded(bands[:, :, c], right[:, c], lower=True) for c in range(3)]
    np.testing.assert_allclose(_solve(bands.copy(), right), np.transpose(lapack), atol=1e-10)


def test_a_system_that_has_no_answer_is_an_error() -> None:
    bands = np.array([[[1.0], [1.0], [1.0]], [[2.0], [2.0], [0.0]], [[0.0], [0.0], [0.0]]])
    with pytest.raises(np.linalg.LinAlgError):
        _solve(bands, np.ones((3, 1)))


def test_without_slopes_and_bends_the_curve_is_the_means() -> None:
    means, weights = asked(40)
    weights[:, 1:] = 0  # of infinite variance
    np.testing.assert_allclose(likeliest(means, weights), means[:, 0], atol=1e-12)


def test_a_curve_that_all_agree_on_is_given_back() -> None:
    curve = np.cumsum(np.random.default_rng(0).normal(size=(30, 2)), axis=0)
    means = np.zeros((30, 3, 2))
    means[:, 0] = curve
    means[1:-1] = with_deltas(curve)
    _, weights = asked(30, 2)
    np.testing.assert_allclose(likeliest(means, weights), curve, atol=1e-9)


def test_slopes_and_bends_of_a_parabola_are_its_derivatives() -> None:
    t = np.arange(9.0)[:, None]
    found = with_deltas(t**2)[:, :, 0]
    np.testing.assert_allclose(found, np.stack([t**2, 2 * t, 0 * t + 2], 1)[1:-1, :, 0])


def test_a_step_between_states_becomes_smooth() -> None:
    means, weights = np.zeros((60, 3, 1)), np.ones((60, 3, 1))
    means[30:, 0] = 1
    weights[:, 1:] = 100
    curve = likeliest(means, weights)[:, 0]
    assert np.abs(np.diff(curve)).max() < 0.2
    assert curve[2] < 0.1 < 0.4 < curve[29] < 0.6 < 0.9 < curve[-3]


def test_what_cannot_be_solved_is_a_mistake_of_the_caller() -> None:
    means, weights = asked(5)
    with pytest.raises(ValueError, match="not \\(T, 3, C\\)"):
        likeliest(means[:, :2], weights[:, :2])
    with pytest.raises(ValueError, match="not above 0"):
        likeliest(means, weights * 0)
    with pytest.raises(ValueError, match="below 0"):
        likeliest(means, weights * [[1], [-1], [1]])
