"""Least squares for gains whose results are held within ranges, few of them and readable.

A control of the rig is x = clip(rest + G p), with p the canonical sources of a pose; what the rig
shows is T (x - rest), and what it should show is s. The gains G are found by Gauss-Newton steps on

    mean over poses (|T (x - rest) - s|^2 + thrift |x - rest|_1 + sure |x - known|^2) + ridge |G|^2

where rows of gaps count only as far as they are open: shut lips are shut, however hard they press.
Gains that matter least are then dropped and the rest fitted again ("optimal brain damage", LeCun
et al. 1990).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

STEPS: Final = 40  # Gauss-Newton steps at most; ten usually do
HALVINGS: Final = 8  # of a step that makes it worse
SETTLED: Final = 1e-4  # share of the error; a step that gains less is the last
DROPPED: Final = 3e-3  # share of the error; a gain that matters less is dropped


@dataclass(frozen=True, eq=False)
class Problem:
    """What is fitted to what: N poses of P sources, K controls of the rig, F things seen."""

    poses: Floats
    """(N, P), canonical sources, products of them too"""
    weights: Floats
    """(N,), of the poses; their sum is 1"""
    shown: Floats
    """(F, K), what each control of the rig shows at 1 more than rest"""
    wanted: Floats
    """(N, F), what the poses show"""
    gaps: Floats
    """(G, K), how far each control opens the lips at G places, weighed"""
    wanted_gaps: Floats
    """(N, G), how far the poses open them"""
    rest_gaps: Floats
    """(G,), at rest, below 0 for lips that press"""
    known: Floats
    """(N, K), what the controls should be, less rest, where that is known"""
    sure: Floats
    """(N,), weight of that; 0 where it is not"""
    low: Floats
    """(K,), the least values of the controls, less rest"""
    high: Floats
    """(K,), the greatest, less rest"""
    ridge: float
    """weight of the squares of the gains"""
    thrift: float
    """weight of the controls' sizes: few controls at once, and those that show much"""

    def moved(self, gains: Floats) -> Floats:
        """(N, K), the controls less rest under the gains (K, P)."""
        return np.clip(self.poses @ gains.T, self.low, self.high)

    def error(self, gains: Floats) -> float:
        """What is made small."""
        moved = self.moved(gains)
        seen = ((moved @ self.shown.T - self.wanted) ** 2).sum(axis=1)
        gap = self.open_gaps(moved @ self.gaps.T) - self.open_gaps(self.wanted_gaps)
        each = seen + (gap**2).sum(axis=1) + self.thrift * np.abs(moved).sum(axis=1)
        each += self.sure * ((moved - self.known) ** 2).sum(axis=1)
        return float(self.weights @ each + self.ridge * (gains**2).sum())

    def open_gaps(self, gaps: Floats) -> Floats:
        """Gaps from those less rest: 0 where the lips are shut."""
        return np.maximum(gaps + self.rest_gaps, 0.0)

    def normal(self, gains: Floats) -> tuple[Floats, Floats]:
        """The normal matrix (K P, K P) and the downhill side (K P,) of a Gauss-Newton step."""
        reached = self.poses @ gains.T
        free = (reached >= self.low) & (reached <= self.high)
        moved = np.clip(reached, self.low, self.high)
        opened = moved @ self.gaps.T
        # A gap that should be open pulls, though it be shut; one that should be shut does not.
        alive = (opened + self.rest_gaps > 0) | (self.wanted_gaps + self.rest_gaps > 0)
        gap = (self.open_gaps(opened) - self.open_gaps(self.wanted_gaps)) * alive
        left = (moved @ self.shown.T - self.wanted) @ self.shown + gap @ self.gaps
        left += self.thrift / 2 * np.sign(moved) + self.sure[:, None] * (moved - self.known)
        bend = (self.shown.T @ self.shown)[None] + np.einsum(
            "ng,gk,gl->nkl", alive.astype(np.float64), self.gaps, self.gaps
        )
        bend += self.sure[:, None, None] * np.eye(len(self.low))
        bend *= free[:, :, None] & free[:, None, :]
        outer = self.poses[:, :, None] * self.poses[:, None, :] * self.weights[:, None, None]
        count, sources = len(self.low), self.poses.shape[1]
        matrix = np.tensordot(bend, outer, axes=(0, 0)).transpose(0, 2, 1, 3)
        matrix = matrix.reshape(count * sources, count * sources)
        slope = ((left * free * self.weights[:, None]).T @ self.poses).ravel()
        flat = np.arange(count * sources)
        matrix[flat, flat] += self.ridge
        return matrix, -slope - self.ridge * gains.ravel()


def solve(problem: Problem, gains: Floats, used: Bools) -> Floats:
    """(K, P), the best gains where `used` (K, P) allows one, from `gains` on."""
    gains = gains * used
    chosen = np.flatnonzero(used.ravel())
    error = problem.error(gains)
    for _ in range(STEPS if len(chosen) else 0):
        matrix, downhill = problem.normal(gains)
        step = np.zeros(gains.size)
        step[chosen] = np.linalg.solve(matrix[np.ix_(chosen, chosen)], downhill[chosen])
        for halving in range(HALVINGS):
            tried = gains + step.reshape(gains.shape) / 2**halving
            if (worse := problem.error(tried)) < error:
                break
        else:
            return gains
        settled = error - worse < SETTLED * error
        gains, error = tried, worse
        if settled:
            return gains
    return gains


def solve_few(problem: Problem, used: Bools, least: float, kept: Bools | None = None) -> Floats:
    """(K, P), gains of which each matters: at least `least`, and more error without it.

    Args:
        problem: what is fitted.
        used: (K, P), where there may be a gain.
        least: the smallest gain.
        kept: (K, P), where a gain of that size stays though little error goes with it.
    """
    gains = solve(problem, np.zeros(used.shape), used)
    while used.any():
        curved = np.diag(problem.normal(gains)[0]).reshape(used.shape)
        matters = gains**2 * curved / max(problem.error(gains), 1e-30)
        light = matters < DROPPED if kept is None else (matters < DROPPED) & ~kept
        weak = used & ((np.abs(gains) < least) | light)
        if not weak.any():
            break
        # Half of them at a time, the weakest first: what is left takes over their part.
        ranked = np.where(weak, matters, np.inf).ravel().argsort(kind="stable")
        used = used.copy()
        used.ravel()[ranked[: (weak.sum() + 1) // 2]] = False
        gains = solve(problem, gains, used)
    return gains


def best_product(
    problem: Problem, gains: Floats, products: Floats, controls: Bools
) -> tuple[int, int, float]:
    """The product (N, M) of sources that helps most, for which control, by what share of the error.

    Args:
        problem: what was fitted.
        gains: (K, P), that came out.
        products: (N, M), the candidates.
        controls: (K,), which controls may have one.
    """
    reached = problem.poses @ gains.T
    free = (reached >= problem.low) & (reached <= problem.high) & controls
    moved = np.clip(reached, problem.low, problem.high)
    opened = moved @ problem.gaps.T
    gap = problem.open_gaps(opened) - problem.open_gaps(problem.wanted_gaps)
    alive = (opened + problem.rest_gaps > 0).astype(np.float64)
    left = (moved @ problem.shown.T - problem.wanted) @ problem.shown + (gap * alive) @ problem.gaps
    bend = (problem.shown**2).sum(axis=0) + alive @ problem.gaps**2
    slope = (left * free * problem.weights[:, None]).T @ products
    curve = (bend * free * problem.weights[:, None]).T @ products**2 + problem.ridge
    helps = slope**2 / curve / max(problem.error(gains), 1e-30)
    control, product = np.unravel_index(int(helps.argmax()), helps.shape)
    return int(product), int(control), float(helps[control, product])
