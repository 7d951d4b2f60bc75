"""The cheapest row of units that covers a stretch of speech, by dynamic programming."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

BEAM: Final = 64  # of the ways to reach a place, the cheapest that are kept


@dataclass(frozen=True, eq=False)
class Arcs:
    """B units that may begin at one place; they go to later places."""

    stops: Indices
    """(B,), the place that each ends at"""
    costs: Floats
    """(B,), of each for itself"""
    first: Floats
    """(B, D), the pose that each begins with"""
    last: Floats
    """(B, D), the pose that each ends with"""


@dataclass(frozen=True, eq=False)
class _Reached:
    """The kept ways to reach a place, by their last unit."""

    costs: Floats
    poses: Floats
    steps: Indices  # (S, 3): the place the unit began at, its row there, the way before it


def cheapest_cover(
    arcs: Sequence[Arcs], smoothness: float, before: Floats | None = None,
    after: Floats | None = None, beam: int = BEAM,
) -> list[tuple[int, int]]:  # fmt: skip
    """The units that lead from place 0 to the last one at the least cost.

    A cover costs the sum of its units' costs, and `smoothness` times the squared distance of the
    poses wherever two units meet. Of equal covers the first is taken.

    Args:
        arcs: of the places 0 to J - 1; the last place is J.
        smoothness: weight of the distances, 0 or more.
        before: (D,), the pose that the first unit joins on to; None for any.
        after: (D,), the pose that joins on to the last unit; None for any.
        beam: how many ways to reach a place are kept; exact if there are no more.

    Returns:
        Place and row in its arcs of each unit.

    Raises:
        ValueError: no row of units leads to the last place.
    """
    last = len(arcs)
    found: list[list[_Reached]] = [[] for _ in range(last + 1)]
    reached: list[_Reached | None] = [None] * (last + 1)
    dimensions = arcs[0].first.shape[1] if arcs else 0
    start = np.zeros((1, dimensions)) if before is None else before[None]
    reached[0] = _Reached(np.zeros(1), start, np.full((1, 3), -1, np.intp))
    for place, here in enumerate(arcs):
        if place:
            reached[place] = _keep(found[place], beam)
            found[place] = []
        ways = reached[place]
        if ways is None or not len(here.costs):
            continue
        weight = smoothness if place or before is not None else 0.0
        total = ways.costs[:, None] + weight * _distances(ways.poses, here.first)  # (S, B)
        best = total.argmin(axis=0)
        costs = total[best, np.arange(len(best))] + here.costs
        steps = np.stack([np.full(len(best), place), np.arange(len(best)), best], axis=1)
        for stop in dict.fromkeys(here.stops.tolist()):
            chosen = here.stops == stop
            found[stop].append(_Reached(costs[chosen], here.last[chosen], steps[chosen]))
        # The poses are needed no more.
        reached[place] = _Reached(ways.costs, ways.poses[:0], ways.steps)
    ends = _keep(found[last], max(beam, 1)) if last else reached[0]
    if ends is None:
        raise ValueError("no row of units covers the stretch")
    total_end = ends.costs
    if after is not None:
        total_end = total_end + smoothness * _distances(ends.poses, after[None])[:, 0]
    reached[last] = ends
    return _trace(reached, int(total_end.argmin()))


def _trace(reached: Sequence[_Reached | None], way: int) -> list[tuple[int, int]]:
    """The units that lead to a way to reach the last place."""
    path: list[tuple[int, int]] = []
    place = len(reached) - 1
    while place > 0:
        ways = reached[place]
        assert ways is not None
        place, row, way = (int(step) for step in ways.steps[way])
        path.append((place, row))
    return path[::-1]


def _keep(parts: list[_Reached], beam: int) -> _Reached | None:
    """The cheapest of the ways to reach a place, in the order in which they were found."""
    if not parts:
        return None
    costs = np.concatenate([part.costs for part in parts])
    kept = np.sort(np.argsort(costs, kind="stable")[:beam])
    poses = np.concatenate([part.poses for part in parts])[kept]
    return _Reached(costs[kept], poses, np.concatenate([part.steps for part in parts])[kept])


def _distances(one: Floats, other: Floats) -> Floats:
    """(S, B), squared, of the rows of (S, D) and (B, D)."""
    squares = np.square(one).sum(axis=1)[:, None] + np.square(other).sum(axis=1)
    return np.maximum(squares - 2 * one @ other.T, 0.0)
