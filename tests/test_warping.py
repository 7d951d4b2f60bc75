"""Dynamic time warping: planted warps, laws, and a plain second implementation."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

BENCH = Path(__file__).resolve().parents[1] / "bench" / "warping.py"
SPEC = importlib.util.spec_from_file_location("warping", BENCH)
assert SPEC is not None
assert SPEC.loader is not None
warping = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(warping)
move_times, warp = warping.move_times, warping.warp


def walk(count, seed=0):
    steps = np.random.default_rng(seed).standard_normal((count, 8))
    return np.cumsum(steps, axis=0).astype(np.float32)


@settings(max_examples=20, deadline=None)
@given(st.integers(20, 1500), st.floats(0.4, 2.5), st.floats(0.1, 0.9), st.integers(0, 99))
def test_a_planted_warp_is_found(count, factor, middle, seed):
    reference = walk(count, seed)
    knee = middle * (count - 1)
    first = np.linspace(0, knee, max(round(knee * factor), 2), endpoint=False)
    second = np.linspace(knee, count - 1, max(round(count - knee), 2))
    places = np.concatenate([first, second])
    beside = warp(reference, reference[np.round(places).astype(int)])
    assert np.all(np.diff(beside) >= 0)
    sampled = np.round(places)[beside]
    assert np.quantile(np.abs(sampled - np.arange(count)), 0.95) <= 2


def test_a_recording_is_beside_itself():
    rows = walk(1200)
    np.testing.assert_array_equal(warp(rows, rows), np.arange(1200))


def test_the_cost_is_that_of_a_plain_search():
    one, other = walk(30, 1), walk(41, 2)
    distance = np.linalg.norm(one[:, None] - other[None], axis=2).astype(float)
    extra = 0.3 * distance[0].mean()
    cost = np.full((31, 42), np.inf)
    cost[0, 0] = 0
    for i in range(1, 31):
        for j in range(1, 42):
            steps = (cost[i - 1, j - 1], cost[i - 1, j] + extra, cost[i, j - 1] + extra)
            cost[i, j] = min(steps) + distance[i - 1, j - 1]
    beside = warp(one, other)
    i, j, visited = 30, 41, set()
    while i > 1 or j > 1:
        visited.add((i - 1, j - 1))
        steps = {(i - 1, j - 1): cost[i - 1, j - 1], (i - 1, j): cost[i - 1, j] + extra,
                 (i, j - 1): cost[i, j - 1] + extra}  # fmt: skip
        i, j = min(steps, key=steps.__getitem__)
    visited.add((0, 0))
    assert {(row, int(column)) for row, column in enumerate(beside)} <= visited


def test_times_move_with_the_frames():
    beside = 2 * np.arange(100)
    np.testing.assert_allclose(move_times([0.2, 0.5], beside, 100.0), [0.395, 0.995], atol=1e-9)


def test_nothing_is_refused():
    with pytest.raises(ValueError, match="nothing to warp"):
        warp(walk(0), walk(3))
