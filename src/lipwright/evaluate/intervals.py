"""How sure a figure is, and whether two engines differ: by recordings drawn again.

Frames of a recording are alike, so that recordings are drawn, not frames. Intervals are of the
percentile bootstrap (Efron and Tibshirani 1993, section 13.3); p is that of a permutation test on
pairs: if two engines were alike, which is which would not matter in any recording (ibid., chapter
15); many p are adjusted after Holm (1979).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.evaluate.measures import Floats, Rows

DRAWS: Final = 2000  # of the bootstrap
FLIPS: Final = 10_000  # of which engine is which
PERCENTILES: Final = (2.5, 97.5)  # of the draws: 95 %
_ALIKE: Final = 1e-12  # of a figure; differences less apart are rounding, and count as equal


@dataclass(frozen=True)
class Interval:
    """A figure with its 95 % interval; NaN where there is none."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Comparison:
    """Two engines by one measure."""

    first: str
    """name of an engine"""
    second: str
    difference: float
    """the first's figure less the second's"""
    low: float
    """of its 95 % interval"""
    high: float
    p: float
    """two-sided; not adjusted"""
    recordings: int
    """in which either has the measure"""


def interval(rows: Rows, seed: int = 0, draws: int = DRAWS) -> Interval:
    """The figure over all recordings, with its interval.

    The interval is NaN where fewer than two recordings have the measure. Draws that hold none of it
    are left out.

    Args:
        rows: of S recordings.
        seed: the same seed, the same draws.
        draws: how many.
    """
    return Interval(rows.value, *_limits(_drawn(rows, seed, draws), rows.counts > 0))


def compare(first: Rows, second: Rows, seed: int = 0) -> tuple[float, float, float, float]:
    """The first's figure less the second's, its interval (low, high), and p.

    Both see the same drawn recordings. p is exact where engines differ in so few recordings that
    each way to swap them can be tried, else at least 1 / (FLIPS + 1). NaN as in `interval`, and p
    where either has no figure.

    Args:
        first: of S recordings.
        second: of the same recordings.
        seed: the same seed, the same draws and flips.

    Raises:
        ValueError: the recordings are not as many.
    """
    if first.sums.shape != second.sums.shape:
        raise ValueError(
            f"{len(first.sums)} and {len(second.sums)} recordings are not the same ones"
        )
    apart = _drawn(first, seed, DRAWS) - _drawn(second, seed, DRAWS)
    low, high = _limits(apart, (first.counts > 0) | (second.counts > 0))
    difference = first.value - second.value
    return difference, low, high, _permuted(first, second, difference, seed)


def compare_all(rows: Mapping[str, Rows], seed: int = 0) -> tuple[Comparison, ...]:
    """Each engine with each that follows it, by one measure.

    Args:
        rows: engine to its rows, all of the same recordings.
        seed: the same seed, the same figures.
    """
    return tuple(
        Comparison(
            one, other, *compare(rows[one], rows[other], seed),
            int(((rows[one].counts > 0) | (rows[other].counts > 0)).sum()),
        )
        for one, other in itertools.combinations(rows, 2)
    )  # fmt: skip


def holm(ps: Sequence[float]) -> tuple[float, ...]:
    """The p of many tests, adjusted so that one false finding among all is as rare as each says.

    Step-down after Holm (1979). NaN are no tests, and stay.
    """
    adjusted = np.full(len(ps), np.nan)
    known = np.flatnonzero(np.isfinite(np.asarray(ps, float)))
    order = known[np.argsort(np.asarray(ps, float)[known], kind="stable")]
    scaled = np.asarray(ps, float)[order] * np.arange(len(order), 0, -1)
    adjusted[order] = np.minimum(np.maximum.accumulate(scaled), 1)
    return tuple(adjusted.tolist())


def _drawn(rows: Rows, seed: int, draws: int) -> Floats:
    """(draws,) the figure of each draw; NaN where it holds none."""
    times = _times_drawn(len(rows.sums), seed, draws)
    return _ratio(_weighted(times, rows.sums), _weighted(times, rows.counts))


def _limits(values: Floats, has: npt.NDArray[np.bool_]) -> tuple[float, float]:
    known = values[np.isfinite(values)]
    if has.sum() < 2 or not len(known):
        return float("nan"), float("nan")
    low, high = np.percentile(known, PERCENTILES)
    return float(low), float(high)


def _permuted(first: Rows, second: Rows, difference: float, seed: int) -> float:
    """How often a difference is as large where engines are swapped in some recordings."""
    if not np.isfinite(difference):
        return float("nan")
    sums, counts = first.sums - second.sums, first.counts - second.counts
    differ = (sums != 0) | (counts != 0)
    is_exact = 2.0 ** differ.sum() <= FLIPS
    columns = differ if is_exact else np.ones_like(differ)
    signs = _every_sign(int(differ.sum())) if is_exact else _signs(len(sums), seed)
    total = _both(first.sums, second.sums, sums, signs, columns)
    share = _both(first.counts, second.counts, counts, signs, columns)
    swapped = _ratio(total[0], share[0]) - _ratio(total[1], share[1])
    # Where a swap leaves one engine without the measure, nothing speaks for a difference.
    limit = abs(difference) - _ALIKE * max(abs(first.value), abs(second.value))
    extreme = int((~(np.abs(swapped) < limit)).sum())
    return extreme / len(signs) if is_exact else (extreme + 1) / (len(signs) + 1)


def _both(
    first: Floats, second: Floats, apart: Floats, signs: Floats, columns: npt.NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Twice what each engine has in all, by which is which: (F,), or (1,) where it is all one."""
    total = np.atleast_1d((first + second).sum())
    if not apart.any():
        return total, total
    moved = _weighted(signs, apart[columns])
    return total + moved, total - moved


def _weighted(weights: Floats, values: Floats) -> Floats:
    # Not `@`: the sums of BLAS differ in their last bits with the number of threads.
    return np.einsum("ds,s->d", weights, values)


def _ratio(sums: Floats, counts: Floats) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(counts > 0, sums / counts, np.nan)


@lru_cache(maxsize=4)
def _times_drawn(recordings: int, seed: int, draws: int) -> Floats:
    """(draws, S) how often each recording is in each draw."""
    chosen = np.random.default_rng(seed).integers(recordings, size=(draws, recordings))
    rows = np.arange(draws)[:, None] * recordings
    counts = np.bincount((chosen + rows).reshape(-1), minlength=draws * recordings)
    return counts.reshape(draws, recordings).astype(float)


@lru_cache(maxsize=4)
def _signs(recordings: int, seed: int) -> Floats:
    """(FLIPS, S) 1 or -1, which engine is which."""
    return np.random.default_rng(seed).choice(np.array([-1.0, 1.0]), (FLIPS, recordings))


@lru_cache(maxsize=4)
def _every_sign(recordings: int) -> Floats:
    """(2^S, S) each row of signs once."""
    numbers = np.arange(2**recordings)[:, None]
    return np.where(numbers >> np.arange(recordings) & 1, 1.0, -1.0)
