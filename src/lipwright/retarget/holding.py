"""The cheapest row of labels in which each is held for a while: exact dynamic programming."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def cheapest_labels(costs: npt.ArrayLike, hold: int, switch: float) -> npt.NDArray[np.int64]:
    """(T,) the label of each step: least sum of costs and switches, none shown too briefly.

    Viterbi's algorithm over (steps, label). A label that starts is held for `hold` steps, so that a
    state is reached by holding on, or by a switch `hold` steps before. Those depend on nothing of
    the last `hold` steps, so that as many are found at a time.

    Args:
        costs: (T, S), of showing each label at each step; finite.
        hold: steps that each label lasts at least, from 1 on; all T where T is less.
        switch: cost of a change of label.

    Raises:
        ValueError: no steps, no labels, or a cost that is not finite.
    """
    costs = np.asarray(costs, np.float64)
    if costs.ndim != 2 or 0 in costs.shape or not np.isfinite(costs).all():
        raise ValueError(f"costs have the shape {costs.shape}, or are not all finite")
    steps, labels = costs.shape
    if steps < 2 * hold or labels == 1:
        return np.full(steps, costs.sum(axis=0).argmin())
    summed = np.concatenate([np.zeros((1, labels)), costs.cumsum(axis=0)])
    # What the best way to a label costs more than if that label had shown all along; after t steps,
    # of which the last `hold` showed it.
    more = np.zeros((steps + 1, labels))
    came = np.full((steps + 1, labels), -1)  # the label before, -1 where it was held
    for first in range(2 * hold, steps + 1, hold):
        stop = min(first + hold, steps + 1)
        shown = summed[first - hold : stop - hold]
        before, spent = _cheapest_others(more[first - hold : stop - hold] + shown)
        ways = np.concatenate([more[first - 1 : first], spent - shown + switch])
        least = np.minimum.accumulate(ways)
        more[first:stop] = least[1:]
        came[first:stop] = np.where(least[1:] < least[:-1], before, -1)
    return _trace(more[steps] + summed[steps], came, hold)


def _cheapest_others(costs: Floats) -> tuple[npt.NDArray[np.int64], Floats]:
    """(n, S) the cheapest label other than each, and its cost, of costs (n, S)."""
    rows = np.arange(len(costs))
    best = costs.argmin(axis=1)
    rest = costs.copy()
    rest[rows, best] = np.inf
    second = rest.argmin(axis=1)
    labels = np.tile(best[:, None], costs.shape[1])
    labels[rows, best] = second
    return labels, np.take_along_axis(costs, labels, axis=1)


def _trace(ends: Floats, came: npt.NDArray[np.int64], hold: int) -> npt.NDArray[np.int64]:
    """The labels of the best way back from the end."""
    step = len(came) - 1
    chosen = np.empty(step, np.int64)
    label = int(ends.argmin())
    while step > 0:
        before = int(came[step, label])
        length = 1 if before < 0 else hold
        chosen[step - length : step] = label
        step -= length
        label = label if before < 0 else before
    return chosen
