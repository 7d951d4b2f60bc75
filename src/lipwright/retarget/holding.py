"""The cheapest row of labels in which each is held for a while: exact dynamic programming."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def cheapest_labels(costs: npt.ArrayLike, hold: int, switch: float) -> npt.NDArray[np.int64]:
    """(T,) the label of each step: least sum of costs and switches, none shown too briefly.

    Viterbi's algorithm over (steps, label). A label that starts is held for `hold` steps, so that a
    state is reached by holding on, or by a switch `hold` steps before.

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
    entering = summed[hold:] - summed[:-hold] + switch  # (T - hold + 1, S), the first `hold` steps
    best = np.full((steps + 1, labels), np.inf)  # after t steps, the last `hold` of them the same
    came = np.full((steps + 1, labels), -1)  # the label before, -1 where it was held
    best[hold] = summed[hold]
    for step in range(hold + 1, steps + 1):
        held = best[step - 1] + costs[step - 1]
        if step < 2 * hold:
            best[step] = held
            continue
        before = best[step - hold]
        first = before.argmin()
        entered = entering[step - hold] + before[first]
        others = before.copy()
        others[first] = np.inf
        second = others.argmin()
        entered[first] = entering[step - hold, first] + before[second]  # from another label
        switched = entered < held
        best[step] = np.where(switched, entered, held)
        came[step, switched] = first
        if switched[first]:
            came[step, first] = second
    return _trace(best[steps], came, hold)


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
