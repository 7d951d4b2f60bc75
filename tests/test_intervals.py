"""Intervals and paired tests: against scipy, planted data, and every swap counted out."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt
import pytest
from scipy import stats

from lipwright.evaluate.intervals import (
    FLIPS,
    Comparison,
    compare,
    compare_all,
    holm,
    interval,
)
from lipwright.evaluate.measures import Rows

Floats = npt.NDArray[np.float64]


def planted(seed: int, recordings: int = 60) -> tuple[Rows, Rows]:
    """Two engines that find the same recordings hard, the second a tenth worse."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(40, 110, recordings).astype(float)
    hard = rng.gamma(4, 1, recordings)
    first, second = (
        factor * hard * rng.uniform(0.9, 1.1, recordings) for factor in (1.0, 1.1)
    )  # fmt: skip
    return Rows(first * counts, counts), Rows(second * counts, counts)


def pooled(sums: Floats, counts: Floats, axis: int = -1) -> Floats:
    return np.asarray(sums.sum(axis=axis) / counts.sum(axis=axis))


def test_an_interval_is_that_of_scipys_bootstrap() -> None:
    rows, _ = planted(1)
    found = interval(rows)
    theirs = stats.bootstrap(
        (rows.sums, rows.counts), pooled, paired=True, vectorized=True, method="percentile",
        n_resamples=20_000, rng=np.random.default_rng(2),
    ).confidence_interval  # fmt: skip
    width = theirs.high - theirs.low
    assert found.value == rows.value
    assert found.low == pytest.approx(theirs.low, abs=0.06 * width)
    assert found.high == pytest.approx(theirs.high, abs=0.06 * width)


def test_the_interval_of_a_difference_is_that_of_scipys_paired_bootstrap() -> None:
    first, second = planted(3)

    def apart(a: Floats, b: Floats, n: Floats, axis: int = -1) -> Floats:
        return pooled(a, n, axis) - pooled(b, n, axis)

    theirs = stats.bootstrap(
        (first.sums, second.sums, first.counts), apart, paired=True, vectorized=True,
        method="percentile", n_resamples=20_000, rng=np.random.default_rng(4),
    ).confidence_interval  # fmt: skip
    difference, low, high, p = compare(first, second)
    width = theirs.high - theirs.low
    assert difference == pytest.approx(first.value - second.value)
    assert low == pytest.approx(theirs.low, abs=0.06 * width)
    assert high == pytest.approx(theirs.high, abs=0.06 * width)
    assert high < 0
    assert p == 1 / (FLIPS + 1)


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """Of 200 samples of 50 recordings; chance alone moves such a share by 0.03."""
    rng = np.random.default_rng(5)
    true, held = 3.0, 0
    for trial in range(200):
        counts = rng.integers(50, 100, 50).astype(float)
        found = interval(Rows(rng.gamma(9, true / 9, 50) * counts, counts), trial, 500)
        held += found.low <= true <= found.high
    assert 0.90 <= held / 200 <= 0.98


def test_pairing_sees_what_two_intervals_hide() -> None:
    first, second = planted(6)
    one, other = interval(first), interval(second)
    assert other.low < one.high  # they overlap
    assert compare(first, second)[2] < 0
    scaled = Rows(0.9 * first.sums, first.counts)
    difference, low, high, _ = compare(scaled, first)
    assert (difference, low, high) == pytest.approx(
        (-0.1 * one.value, -0.1 * one.high, -0.1 * one.low), rel=1e-9
    )


# --- p ---


def swapped(first: Rows, second: Rows, which: tuple[bool, ...]) -> float:
    """The difference where engines are swapped in some recordings, the long way."""
    swap = np.array(which)
    a = [np.where(swap, y, x).sum() for x, y in
         ((first.sums, second.sums), (first.counts, second.counts))]  # fmt: skip
    b = [np.where(swap, x, y).sum() for x, y in
         ((first.sums, second.sums), (first.counts, second.counts))]  # fmt: skip
    return float(a[0] / a[1] - b[0] / b[1])


@pytest.mark.parametrize("seed", range(4))
def test_p_of_few_recordings_counts_every_swap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 5, (2, 8)).astype(float)
    first, second = (Rows(rng.normal(1 + 0.4 * row, 0.6, 8) * n, n)
                     for row, n in enumerate(counts))  # fmt: skip
    apart = first.value - second.value
    ways = [abs(swapped(first, second, which))
            for which in itertools.product((False, True), repeat=8)]  # fmt: skip
    assert compare(first, second)[3] == np.mean([way >= abs(apart) - 1e-9 for way in ways])


def test_p_of_few_recordings_is_scipys_exact_one() -> None:
    rng = np.random.default_rng(7)
    a, b = rng.normal(0, 1, 11), rng.normal(0.7, 1, 11)
    theirs = stats.permutation_test(
        (a, b), lambda x, y, axis: x.mean(axis=axis) - y.mean(axis=axis),
        permutation_type="samples", vectorized=True, n_resamples=5000,
    )  # fmt: skip
    found = compare(Rows(a, np.ones(11)), Rows(b, np.ones(11)))
    assert found[0] == pytest.approx(theirs.statistic)
    assert found[3] == pytest.approx(theirs.pvalue)


def test_p_of_many_recordings_is_near_scipys_and_the_rank_test() -> None:
    rng = np.random.default_rng(8)
    a = rng.normal(0, 1, 80)
    b = a + rng.normal(0.12, 0.5, 80)
    theirs = stats.permutation_test(
        (a, b), lambda x, y, axis: x.mean(axis=axis) - y.mean(axis=axis),
        permutation_type="samples", vectorized=True, n_resamples=10_000,
        rng=np.random.default_rng(9),
    ).pvalue  # fmt: skip
    p = compare(Rows(a, np.ones(80)), Rows(b, np.ones(80)))[3]
    assert 0.005 < p < 0.5
    assert p == pytest.approx(theirs, abs=0.015)
    assert p == pytest.approx(stats.wilcoxon(a, b).pvalue, abs=0.1)


def test_p_is_uniform_where_engines_are_alike() -> None:
    """Counts differ too; Kolmogorov and Smirnov see no departure in 120 pairs."""
    rng = np.random.default_rng(10)
    ps = []
    for _ in range(120):
        hard = rng.gamma(4, 1, 16)
        counts = rng.integers(3, 9, (2, 16)).astype(float)
        pair = [Rows(hard * rng.gamma(9, 1 / 9, 16) * n, n) for n in counts]
        ps.append(compare(*pair)[3])
    assert stats.kstest(ps, "uniform").pvalue > 0.05


def test_who_is_first_changes_only_the_sign() -> None:
    first, second = planted(11, 20)
    second = Rows(second.sums * np.linspace(0.7, 1.1, 20), second.counts)
    one, other = compare(first, second), compare(second, first)
    assert one[0] == -other[0]
    assert one[1:3] == pytest.approx((-other[2], -other[1]))
    assert one[3] == other[3] < 1


def test_engines_that_are_the_same_do_not_differ() -> None:
    first, _ = planted(12)
    assert compare(first, first) == (0, 0, 0, 1)
    noise = Rows(first.sums * (1 + 1e-15), first.counts)
    assert compare(first, noise)[3] == 1


# --- gaps ---


def test_a_draw_without_the_measure_is_left_out() -> None:
    rare = Rows(np.array([1.0, 0, 2, 0, 0, 0]), np.array([1.0, 0, 1, 0, 0, 0]))
    found = interval(rare)
    assert (found.value, found.low, found.high) == (1.5, 1.0, 2.0)


def test_one_recording_has_no_interval_and_none_no_figure() -> None:
    one = interval(Rows(np.array([3.0, 0]), np.array([2.0, 0])))
    assert one.value == 1.5
    assert np.isnan([one.low, one.high]).all()
    for size in (0, 2):
        none = Rows(np.zeros(size), np.zeros(size))
        found = interval(none)
        assert np.isnan([found.value, found.low, found.high]).all()
        assert np.isnan(compare(none, none)).all()


def test_an_engine_without_the_measure_is_not_compared() -> None:
    first, _ = planted(13, 10)
    assert np.isnan(compare(first, Rows(np.zeros(10), np.zeros(10)))).all()


def test_other_recordings_cannot_be_paired() -> None:
    with pytest.raises(ValueError, match="not the same"):
        compare(planted(1, 5)[0], planted(1, 6)[0])


def test_a_recording_that_only_one_has_counts_in_both_figures() -> None:
    first = Rows(np.array([0.9, 0.8, 0.7]), np.ones(3))
    second = Rows(np.array([0.5, 0.6, 0.0]), np.array([1.0, 1, 0]))
    difference, _, _, p = compare(first, second)
    assert difference == pytest.approx(0.8 - 0.55)
    assert 0 < p <= 1


# --- many ---


def test_every_pair_is_compared_once_and_again_to_the_bit() -> None:
    first, second = planted(14)
    rows = {"a": first, "b": second, "c": Rows(np.zeros(60), np.zeros(60))}
    found = compare_all(rows, seed=3)
    assert [(one.first, one.second) for one in found] == [("a", "b"), ("a", "c"), ("b", "c")]
    assert found[0] == Comparison("a", "b", *compare(first, second, seed=3), recordings=60)
    assert repr(compare_all(rows, seed=3)) == repr(found)
    assert compare_all(rows, seed=4)[0].low != found[0].low
    assert interval(first, 3) == interval(first, 3) != interval(first, 4)


def test_holm_steps_down() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx((0.03, 0.06, 0.06, 0.02))
    assert holm([0.9, 0.8]) == (1, 1)
    assert holm([]) == ()
    adjusted = holm([0.02, float("nan"), 0.01])
    assert adjusted[0] == adjusted[2] == pytest.approx(0.02)
    assert np.isnan(adjusted[1])


def test_holm_never_promises_more_than_bonferroni_nor_less_than_p() -> None:
    ps = np.random.default_rng(15).uniform(0, 0.2, 30)
    adjusted = np.array(holm(ps.tolist()))
    assert (adjusted >= ps).all()
    assert (adjusted <= np.minimum(30 * ps, 1)).all()
    assert (np.diff(adjusted[np.argsort(ps)]) >= 0).all()
