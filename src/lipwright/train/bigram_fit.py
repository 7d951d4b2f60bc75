"""Phone bigrams fitted to captured faces (Xu et al. 2013, section 4.1).

Captured animation is projected on the poses, and the control points of all pairs together are
those under which the stitched curves come nearest to it: what the maximum of two pairs hides costs
nothing. Poses that no camera sees (the tongue, the lip behind the teeth, lips pressed shut) and
pairs that were not heard come from rules. Closures are exact: their curve reaches 1 while the lips
of the speaker are shut.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from lipwright.bigrams.runtime import spans, stitch
from lipwright.bigrams.values import Bigram, BigramSet, Pair, constraint_key
from lipwright.face.head import Head
from lipwright.phones import SILENCE
from lipwright.rig import Rig
from lipwright.train.bigram_design import Design
from lipwright.train.bigram_heard import CLOSURE, ClosureOptions, Heard, shut_pairs
from lipwright.train.bigram_targets import Floats, Projector

Report = Callable[[str, float], None]

ROUNDED: Final = "W"
OPENING: Final = ("open", "wide")
FITTED: Final = (ROUNDED, *OPENING)
"""poses that a camera sees whole"""
SHOWN: Final = ("ShCh", "FV", "PBM")
"""poses that are made by rule and take part in the captured motion"""

LEAST_PEAK: Final = 0.02  # of a full pose; a curve that stays lower is left out
DENSE_FPS: Final = 240.0  # of the rule's curves, before they are read at the frames of a video


@dataclass(frozen=True)
class FitOptions:
    """How curves are fitted."""

    points: int = 9
    """control points of a curve, evenly over both phones"""
    ridge: float = 0.3
    """frames' worth of error that a control point costs when it is 1 from the rule's curve"""
    jumps: float = 3.0
    """the same of a jump by 1 where one pair takes over from another"""
    bending: float = 0.5
    """the same of a bend by 1 between three control points"""
    least: int = 3
    """times that a pair must be heard; others stay as they are by rule"""
    steps: int = 300
    """of the optimiser, at most"""
    rounding: float = 0.85
    """share of the rule's W that a fitted one keeps at least: some speakers hardly round"""
    closures: ClosureOptions = field(default_factory=ClosureOptions)
    """how lips are shut"""


@dataclass(frozen=True)
class Fit:
    """What was learnt."""

    bigrams: Mapping[Pair, Bigram]
    """the pairs that were heard often enough"""
    explained: Mapping[str, float]
    """pose to the share of its variance that the stitched curves explain"""


def fit(
    takes: Sequence[Heard], rules: BigramSet, rig: Rig, head: Head,
    options: FitOptions | None = None, report: Report | None = None,
) -> Fit:  # fmt: skip
    """The pairs of a set, fitted to recordings.

    Args:
        takes: what was captured.
        rules: a set that has the pairs by rule; its numbers are kept.
        rig: of the set's poses.
        head: that shows how they look.
        options: how.
        report: told how far it is.
    """
    options = options or FitOptions()
    counts = Counter(span.pair for take in takes for span in spans(rules, take.track))
    pairs = [pair for pair in rules.bigrams if counts[pair] >= options.least]
    if not pairs:
        return Fit({}, {})
    base = rules
    for bigram in shut_pairs(takes, rules, pairs, options.closures):
        base = base.with_bigram(bigram)
    design = Design(takes, base, pairs, options.points)
    known = [_at_frames(base, take) for take in takes]
    results: dict[str, PoseFit] = {}
    # What is rounder than the speaker opens the lips less: the other poses are found beside it.
    for poses, found in ((FITTED, (ROUNDED,)), (OPENING, OPENING)):
        captured = _project(takes, known, Projector(head, rig, poses), report)
        for pose in found:
            bound = np.concatenate([_bound(base, pose, shown) for shown in known])
            wanted = captured[:, poses.index(pose)]
            results[pose] = _fit_pose(design, base, pose, wanted, bound, options)
            if report is not None:
                report("fit", len(results) / len(FITTED))
        for shown, weights in zip(known, design.split(results[ROUNDED].stitched), strict=True):
            shown[ROUNDED] = weights
    made = {
        pair: _bigram(base.bigrams[pair], counts[pair], row, results, design)
        for row, pair in enumerate(pairs)
    }
    return Fit(made, {pose: results[pose].explained for pose in FITTED})


def _project(
    takes: Sequence[Heard], known: Sequence[Mapping[str, Floats]], projector: Projector,
    report: Report | None,
) -> Floats:  # fmt: skip
    """(frames, K), the weights of the projector's poses beside those that are known."""
    targets = []
    for number, (take, shown) in enumerate(zip(takes, known, strict=True), 1):
        targets.append(_from_rest(projector(take.arkit, shown), take))
        if report is not None:
            report("project", number / len(takes))
    return np.concatenate(targets)


def _at_frames(base: BigramSet, take: Heard) -> dict[str, Floats]:
    """The poses of SHOWN at the frames of a recording."""
    clip = stitch(base, take.track, DENSE_FPS)
    values = clip.at(take.times).astype(np.float64)
    return {pose: values[:, clip.column(pose)] for pose in SHOWN}


def _from_rest(weights: Floats, take: Heard) -> Floats:
    """The weights (T, K) above those of silence: a speaker need not rest as the head does."""
    track = take.track
    phone = np.searchsorted(track.edges, take.times, side="right") - 1
    silent = np.array(track.phones)[np.clip(phone, 0, len(track) - 1)] == SILENCE
    if not silent.any():
        return weights
    return np.maximum(weights - np.median(weights[silent], axis=0), 0.0)


def _bound(base: BigramSet, pose: str, shown: Mapping[str, Floats]) -> Floats:
    """(T,), what constraints leave a pose beside those of SHOWN."""
    bound = np.full(len(shown[CLOSURE]), np.inf)
    for other in SHOWN:
        weights = shown[other]
        if base.poses[other].priority > base.poses[pose].priority:
            most = base.constraints.get(constraint_key(pose, other), base.otherwise)
            bound = np.minimum(bound, np.maximum(most - weights, 0.0))
    return bound


@dataclass(frozen=True, eq=False)
class PoseFit:
    """One pose, fitted."""

    points: Floats
    """(pairs, points), values of the control points"""
    stitched: Floats
    """(frames,), the curve that they make"""
    wanted: Floats
    """(frames,), the captured one"""

    @property
    def explained(self) -> float:
        """Share of the captured curve's variance that the stitched one explains."""
        spread = ((self.wanted - self.wanted.mean()) ** 2).sum()
        return 1 - float(((self.stitched - self.wanted) ** 2).sum() / max(spread, 1e-12))


def _fit_pose(
    design: Design, base: BigramSet, pose: str, wanted: Floats, bound: Floats, options: FitOptions
) -> PoseFit:
    """The control points of all pairs under which a pose comes nearest to the captured one."""
    from scipy.optimize import minimize

    one, other = design.layers
    ruled = design.control_points(base, pose)
    beside = design.others(base, pose)
    floor = options.rounding * ruled if pose == ROUNDED else np.zeros_like(ruled)
    bends = np.diff(np.eye(design.points), 2, axis=0)

    def cost(points: Floats) -> tuple[float, Floats]:
        left, right = one @ points, other @ points
        first = left >= right
        greater = np.where(first, left, right)
        stitched = np.minimum(np.maximum(greater, beside), bound)
        error = stitched - wanted
        pull = error * ((greater < bound) & (greater >= beside))
        slope = one.T @ (pull * first) + other.T @ (pull * ~first)
        away = (points - ruled).reshape(-1, design.points)
        bent = points.reshape(-1, design.points) @ bends.T
        jump = np.maximum(design.seams @ points, 0.0)
        slope += (options.ridge * away + options.bending * bent @ bends).ravel()
        slope += options.jumps * (design.seams.T @ jump)
        price = options.ridge * (away**2).sum() + options.bending * (bent**2).sum()
        price += options.jumps * (jump @ jump)
        return float(error @ error + price) / 2, slope

    limits = [
        (0.0, 0.0) if rests else (least, None)
        for rests, least in zip(design.rests(), floor, strict=True)
    ]
    # From the means of what each control point sees; from the rules it ends in a worse optimum.
    seen = one + other
    means = (seen.T @ wanted) / np.maximum(seen.T @ np.ones(len(wanted)), 1e-3)
    start = np.where(design.rests(), 0.0, np.maximum(means, floor))
    found = minimize(cost, start, jac=True, method="L-BFGS-B", bounds=limits,
                     options={"maxiter": options.steps, "maxfun": 2 * options.steps})  # fmt: skip
    stitched = np.minimum(np.maximum.reduce([one @ found.x, other @ found.x, beside]), bound)
    return PoseFit(found.x.reshape(-1, design.points), stitched, wanted)


def _bigram(
    ruled: Bigram, count: int, row: int, results: Mapping[str, PoseFit], design: Design
) -> Bigram:
    """The rule's pair with the curves that were fitted."""
    frames = design.members[ruled.pair]
    drawn = {pose: points for pose, points in ruled.curves.items() if pose not in FITTED}
    variance = {}
    for pose, result in results.items():
        values = [round(float(value), 3) for value in result.points[row]]
        if max(values) >= LEAST_PEAK:
            drawn[pose] = tuple(zip(design.times.tolist(), values, strict=True))
        if len(frames):
            error = result.stitched[frames] - result.wanted[frames]
            variance[pose] = round(float(np.mean(error**2)), 4)
    return Bigram(*ruled.pair, drawn, source="fitted", count=count, variance=variance)
