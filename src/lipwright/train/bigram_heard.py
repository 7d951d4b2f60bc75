"""What phone bigrams are fitted to: recordings, and when their lips are shut."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.bigrams.runtime import Span, spans
from lipwright.bigrams.values import Bigram, BigramSet, Pair, Points
from lipwright.dataset.recording import Recording
from lipwright.phones import BILABIALS
from lipwright.track import PhoneTrack
from lipwright.train.bigram_targets import Floats

CLOSURE: Final = "PBM"
SHUT: Final = 0.15  # of a recording's 95th percentile; under it lips are shut (DESIGN.md)
BESIDE: Final = 0.04  # s around a phone in which its closure is looked for: one frame of video
LATER: Final = 0.5  # normalised time of a pair before which its second phone shuts no lips


@dataclass(frozen=True)
class ClosureOptions:
    """How closures are drawn."""

    least: int = 3
    """times that one must be seen; others stay as they are by rule"""
    ramp: float = 0.1
    """half the normalised time in which it is reached"""
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


def shut_pairs(
    takes: Sequence[Heard], rules: BigramSet, pairs: Sequence[Pair], options: ClosureOptions
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
            start, end = np.clip((start, end), low, high)
            points = closure_points(float(start), float(end), options.ramp)
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
    # Two points at rest before the ramp and after it, or the spline would leave rest far away.
    before, after = (start - 2 * ramp, start - ramp), (end + ramp, end + 2 * ramp)
    rest = [(0.0, 0.0), *((time, 0.0) for time in before)]
    points = [*rest, *((time, 1.0) for time in inner), *((time, 0.0) for time in after), (1.0, 0.0)]
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
