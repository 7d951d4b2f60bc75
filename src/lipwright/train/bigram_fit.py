"""Phone bigrams fitted to captured faces (Xu et al. 2013, section 4.1).

Captured animation is projected on the poses, and the control points of all pairs together are
those under which the stitched curves come nearest to it: what the maximum of two pairs hides costs
nothing. Poses that no camera sees (the tongue, the lip behind the teeth, lips pressed shut) and
pairs that were not heard come from rules. Closures are exact: their curve reaches 1 while the lips
of the speaker are shut.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.runtime import Span, spans, stitch
from lipwright.bigrams.spline import SAMPLES, dense
from lipwright.bigrams.values import Bigram, BigramSet, Pair, Points, constraint_key
from lipwright.dataset.recording import Recording
from lipwright.face.head import Head
from lipwright.phones import BILABIALS, SILENCE
from lipwright.rig import Rig
from lipwright.track import PhoneTrack
from lipwright.train.bigram_targets import Floats, Projector

Report = Callable[[str, float], None]

ROUNDED: Final = "W"
OPENING: Final = ("open", "wide")
FITTED: Final = (ROUNDED, *OPENING)
"""poses that a camera sees whole"""
SHOWN: Final = ("ShCh", "FV", "PBM")
"""poses that are made by rule and take part in the captured motion"""
CLOSURE: Final = "PBM"

SHUT: Final = 0.15  # of a recording's 95th percentile; under it lips are shut (DESIGN.md)
BESIDE: Final = 0.04  # s around a phone in which its closure is looked for: one frame of video
LEAST_PEAK: Final = 0.02  # of a full pose; a curve that stays lower is left out
LATER: Final = 0.5  # normalised time of a pair before which its second phone shuts no lips
DENSE_FPS: Final = 240.0  # of the rule's curves, before they are read at the frames of a video


@dataclass(frozen=True)
class FitOptions:
    """How curves are fitted."""

    points: int = 9
    """control points of a curve, evenly over both phones"""
    ridge: float = 0.3
    """frames' worth of error that a control point costs when it is 1 from the rule's curve"""
    ends: float = 1.0
    """the same of the first and the last point, which jump where another pair takes over"""
    bending: float = 3.0
    """the same of a bend by 1 between three control points"""
    least: int = 3
    """times that a pair must be heard; others stay as they are by rule"""
    steps: int = 300
    """of the optimiser, at most"""
    rounding: float = 0.65
    """share of the rule's W that a fitted one keeps at least: some speakers hardly round"""
    ramp: float = 0.1
    """half the normalised time in which a closure is reached"""
    sure: float = 0.7
    """share of the closures that were seen which have begun when that of the curve begins, and
    which have not ended when it ends"""


@dataclass(frozen=True, eq=False)
class Heard:
    """What a fit needs of one recording; frames without a face are left out."""

    times: Floats
    """(T,), s on the clock of the track"""
    arkit: Floats
    """(T, 52)"""
    shut: npt.NDArray[np.bool_]
    """(T,), the lips touch"""
    track: PhoneTrack

    @classmethod
    def of(cls, recording: Recording) -> Heard | None:
        """The recording's frames; None where no face was seen."""
        seen = recording.valid
        if not seen.any():
            return None
        arkit = recording.motion.arkit[seen].astype(np.float64)
        aperture = recording.motion.aperture
        # Without a tracked aperture (weights imported from a phone) no closure is looked for.
        gaps = np.ones(len(arkit)) if aperture is None else aperture[seen].astype(np.float64)
        shut = np.asarray(gaps < SHUT * np.percentile(gaps, 95))
        return cls(recording.times[seen], arkit, shut, recording.track)


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
    base = rules
    for bigram in shut_pairs(takes, rules, pairs, options):
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


def shut_pairs(
    takes: Sequence[Heard], rules: BigramSet, pairs: Sequence[Pair], options: FitOptions
) -> Iterator[Bigram]:
    """The pairs with a bilabial, whose closure is when the lips of the speaker are shut."""
    found: dict[Pair, list[tuple[float, float]]] = defaultdict(list)
    bilabial = {rules.class_of(phone) for phone in BILABIALS}
    for take in takes:
        for span in spans(rules, take.track):
            for index in (span.index, span.index + 1):
                if not span.within_pause and take.track.phones[index] in BILABIALS:
                    found[span.pair] += _closure(take, span, index)
    for pair in pairs:
        if len(found[pair]) >= options.least:
            starts, ends = np.array(found[pair]).T
            start, end = np.quantile(starts, options.sure), np.quantile(ends, 1 - options.sure)
            # Elsewhere the two phones share their time otherwise: the half of the other is free.
            low = LATER if pair[0] != pair[1] and pair[1] in bilabial else 0.0
            high = 1 - LATER if pair[0] != pair[1] and pair[0] in bilabial else 1.0
            bigram = rules.bigrams[pair]
            points = closure_points(*np.clip((start, end), low, high).tolist(), ramp=options.ramp)
            yield replace(bigram, curves={**bigram.curves, CLOSURE: points})


def closure_points(start: float, end: float, ramp: float) -> Points:
    """Control points that are over a half from about `start` to `end`, and 1 between.

    Args:
        start: normalised time.
        end: normalised time; where it is not well after `start`, the closure is around both.
        ramp: half the time that it takes to reach 1.
    """
    middle = (start + end) / 2
    half = max(end - start, 2.5 * ramp) / 2
    start, end = middle - half, middle + half
    inner = (start + ramp, middle - ramp / 4, middle + ramp / 4, end - ramp)
    times = [(start - ramp, 0.0), *((time, 1.0) for time in inner), (end + ramp, 0.0)]
    points = [(0.0, 0.0), *times, (1.0, 0.0)]
    return tuple((round(min(max(time, 0.0), 1.0), 4), value) for time, value in points)


def _closure(take: Heard, span: Span, index: int) -> list[tuple[float, float]]:
    """Normalised start and end of the shut run at phone `index`, if the camera saw one."""
    start, end = take.track.edges[index] - BESIDE, take.track.edges[index + 1] + BESIDE
    frames = np.flatnonzero(take.shut & (take.times >= start) & (take.times <= end))
    if not len(frames):
        return []
    # A frame stands for the time around it.
    step = float(np.median(np.diff(take.times)))
    times = np.array([take.times[frames[0]] - step / 2, take.times[frames[-1]] + step / 2])
    one, other = (times - span.start) / (span.end - span.start)
    return [(float(one), float(other))]


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


class Design:
    """How the control points of all pairs make the frames of all recordings.

    Each frame is held by at most two pairs, one in each of two sparse tables; the curve is the
    greater of the two.
    """

    def __init__(
        self, takes: Sequence[Heard], base: BigramSet, pairs: Sequence[Pair], points: int
    ) -> None:
        """Lay all pairs over all frames."""
        from scipy.sparse import coo_matrix

        self.pairs = tuple(pairs)
        self.times = np.linspace(0, 1, points)
        self.table = unit_curves(points)
        self.points = points
        row_of = {pair: row for row, pair in enumerate(pairs)}
        layers: tuple[list[tuple[Floats, ...]], ...] = ([], [])
        members: dict[Pair, list[npt.NDArray[np.int64]]] = {pair: [] for pair in pairs}
        first = 0
        for take in takes:
            for span in spans(base, take.track):
                frames = np.flatnonzero((take.times >= span.start) & (take.times < span.end))
                row = row_of.get(span.pair)
                if row is None or not len(frames):
                    continue
                place = (take.times[frames] - span.start) / (span.end - span.start)
                weights = self._weights(place)
                columns = row * self.points + np.arange(self.points)
                cells = np.broadcast_arrays(frames[:, None] + first, columns[None, :], weights)
                layers[span.index % 2].append(tuple(cell.ravel() for cell in cells))
                members[span.pair].append(frames + first)
            first += len(take.times)
        self.ends = np.cumsum([len(take.times) for take in takes])
        self.members = {pair: np.concatenate([*lists, ()]).astype(np.int64)
                        for pair, lists in members.items()}  # fmt: skip
        shape = (first, len(pairs) * self.points)
        self.layers = []
        for cells_of in layers:
            frame, column, weight = (np.concatenate(part) for part in zip(*cells_of, strict=True))
            self.layers.append(coo_matrix((weight, (frame, column)), shape=shape).tocsr())

    def rests(self) -> npt.NDArray[np.bool_]:
        """(pairs * points,), control points in a pause, where no other pair is to take over."""
        silent = np.zeros((len(self.pairs), self.points), bool)
        silent[:, 0] = [first == SILENCE for first, _ in self.pairs]
        silent[:, -1] = [second == SILENCE for _, second in self.pairs]
        return silent.ravel()

    def split(self, values: Floats) -> list[Floats]:
        """Values (frames,) of all recordings as those of each."""
        return np.split(values, self.ends[:-1])

    def control_points(self, base: BigramSet, pose: str) -> Floats:
        """(pairs * points,), what the curves of a set are at the times of the control points."""
        even = np.linspace(0, 1, SAMPLES)
        rows = []
        for pair in self.pairs:
            points = base.bigrams[pair].curves.get(pose, ((0.0, 0.0),))
            rows.append(np.interp(self.times, even, dense(points)))
        return np.concatenate(rows)

    def _weights(self, place: Floats) -> Floats:
        """(n, points), of the control points at normalised times."""
        even = place * (SAMPLES - 1)
        low = np.minimum(even.astype(np.int64), SAMPLES - 2)
        share = (even - low)[:, None]
        return (1 - share) * self.table[low] + share * self.table[low + 1]


def unit_curves(points: int) -> Floats:
    """(SAMPLES, points), the curve of each of evenly spaced control points alone."""
    times = np.linspace(0, 1, points)
    return np.stack([dense(tuple(zip(times, row, strict=True))) for row in np.eye(points)], axis=1)


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
    floor = options.rounding * ruled if pose == ROUNDED else np.zeros_like(ruled)
    dear = np.full(design.points, options.ridge)
    dear[[0, -1]] = options.ends
    bends = np.diff(np.eye(design.points), 2, axis=0)

    def cost(points: Floats) -> tuple[float, Floats]:
        left, right = one @ points, other @ points
        first = left >= right
        stitched = np.where(first, left, right)
        free = stitched < bound
        error = np.minimum(stitched, bound) - wanted
        pull = error * free
        slope = one.T @ (pull * first) + other.T @ (pull * ~first)
        away = (points - ruled).reshape(-1, design.points)
        bent = points.reshape(-1, design.points) @ bends.T
        slope += (dear * away + options.bending * bent @ bends).ravel()
        price = (dear * away**2).sum() + options.bending * (bent**2).sum()
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
    stitched = np.minimum(np.maximum(one @ found.x, other @ found.x), bound)
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
