"""How well predicted lips follow real lips.

Conventions: apertures are curves over time, never negative, divided by the distance between the
eyes' centres, so that they have no unit. A `reference_` aperture comes from a real face, one
value a video frame; an `estimated_` aperture comes from an animation at any rate. Times are in s.
Frame i of a video at 25 fps is at (i + 0.5) / 25 s, the middle of its exposure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lipwright.phones import BILABIALS, SILENCE
from lipwright.track import PhoneTrack

LOUD_PERCENTILE = 95  # the opening that a recording's shares are taken of
CLOSED = 0.15  # share of it under which lips count as closed
SHUT = 0.10  # share of it under which lips count as shut, for false closures
OPEN = 0.30  # share of it over which lips are surely open
CLOSURE_TOLERANCE = 0.04  # s
FALSE_CLOSURE_MIN = 0.03  # s
MAX_LAG = 0.2  # s, range in which the best lag is looked for


@dataclass(frozen=True, eq=False)
class Aperture:
    """An aperture curve with its times."""

    times: npt.NDArray[np.float64]
    """(T,), s, rising"""
    values: npt.NDArray[np.float64]
    """(T,), finite, not negative; NaN where the face was lost, but not everywhere"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        times = np.array(self.times, np.float64)
        values = np.array(self.values, np.float64)
        if times.shape != values.shape or times.ndim != 1 or len(times) < 2:
            raise ValueError(
                f"times {times.shape} and values {values.shape} are not two or more (T,)"
            )
        if not np.isfinite(times).all() or not (np.diff(times) > 0).all():
            raise ValueError("times are not finite or do not rise")
        if (values < 0).any() or np.isinf(values).any():
            raise ValueError("an aperture is negative or infinite")
        if np.isnan(values).all():
            raise ValueError("the face is lost in every frame")
        times.setflags(write=False)
        values.setflags(write=False)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    def at(self, times: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """(len(times),), linear between the known frames, held at the ends; `times` in s."""
        known = ~np.isnan(self.values)
        return np.interp(np.asarray(times), self.times[known], self.values[known])

    @property
    def loud(self) -> float:
        """The 95th percentile, of which shares are taken."""
        return float(np.nanpercentile(self.values, LOUD_PERCENTILE))

    @property
    def step(self) -> float:
        """The usual time between frames in s."""
        return float(np.median(np.diff(self.times)))


def video_times(frames: int, fps: float) -> npt.NDArray[np.float64]:
    """(T,) s, the middles of T = `frames` video frames."""
    return np.asarray((np.arange(frames) + 0.5) / fps, np.float64)


def speech_span(track: PhoneTrack) -> tuple[float, float]:
    """From the start of the first to the end of the last phone that is not silence, s.

    Raises:
        ValueError: the track is all silence.
    """
    spoken = [index for index, phone in enumerate(track.phones) if phone != SILENCE]
    if not spoken:
        raise ValueError("the track is all silence")
    return float(track.edges[spoken[0]]), float(track.edges[spoken[-1] + 1])


def correlation(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack, lag: float = 0.0
) -> float:
    """Pearson's r at the video's frames inside speech; the estimate is read `lag` s later.

    NaN where either does not move.
    """
    start, end = speech_span(track)
    times = reference_aperture.times
    inside = (times >= start) & (times <= end) & ~np.isnan(reference_aperture.values)
    if inside.sum() < 3:
        return float("nan")
    real = reference_aperture.values[inside]
    guess = estimated_aperture.at(times[inside] + lag)
    if np.ptp(real) == 0 or np.ptp(guess) == 0:
        return float("nan")
    return float(np.corrcoef(real, guess)[0, 1])


def best_lag(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack
) -> tuple[float, float]:
    """The lag in s, within 0.2 s, at which r is highest, and that r."""
    lags = np.arange(-MAX_LAG, MAX_LAG + 1e-9, 0.005).round(3)  # 0 is 0
    values = [
        correlation(reference_aperture, estimated_aperture, track, float(lag)) for lag in lags
    ]
    if np.isnan(values).all():
        return 0.0, float("nan")
    best = int(np.nanargmax(values))
    return float(lags[best]), float(values[best])


def real_closures(reference_aperture: Aperture, track: PhoneTrack) -> list[float]:
    """The time of the tightest video frame of each p, b or m whose real lips close.

    A phone shorter than a video frame is judged by the frame that covers its middle.
    """
    times, values = reference_aperture.times, reference_aperture.values
    limit = CLOSED * reference_aperture.loud
    found = []
    for phone, start, end in track:
        if phone not in BILABIALS:
            continue
        inside = np.flatnonzero((times >= start) & (times <= end) & ~np.isnan(values))
        if not len(inside):
            inside = np.array([np.argmin(np.abs(times - (start + end) / 2))])
        tightest = inside[np.argmin(values[inside])]
        if values[tightest] < limit:
            found.append(float(times[tightest]))
    return found


def closures(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack
) -> tuple[int, int]:
    """How many real closures the estimate makes within 40 ms, and how many there are."""
    limit = CLOSED * estimated_aperture.loud
    moments = real_closures(reference_aperture, track)
    steps = np.linspace(-CLOSURE_TOLERANCE, CLOSURE_TOLERANCE, 33)
    hits = sum(bool((estimated_aperture.at(moment + steps) < limit).any()) for moment in moments)
    return hits, len(moments)


def _mean(values: npt.ArrayLike) -> float:
    known = np.asarray(values, np.float64)
    known = known[~np.isnan(known)]
    return float(known.mean()) if len(known) else float("nan")


def runs(mask: npt.ArrayLike) -> list[tuple[int, int]]:
    """First and stop of each run of true values of (T,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def false_closures(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack
) -> int:
    """How often, in speech, the estimate is shut for 30 ms or more while real lips stay open.

    They stay open if they never come near closing all the while that the estimate is shut.
    """
    shut, is_open = _shut_and_open(reference_aperture, estimated_aperture, track)
    return sum(bool(is_open[first:last].all()) for first, last in _long_runs(shut))


def mistimed_closures(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack
) -> int:
    """How often, in speech, the estimate is shut and the real lips are open for 30 ms or more.

    Besides the false closures these are real ones that come too early, too late or too long.
    """
    shut, is_open = _shut_and_open(reference_aperture, estimated_aperture, track)
    return len(_long_runs(shut & is_open))


_STEP = 0.005  # s between the instants at which shut and open lips are compared


def _shut_and_open(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack
) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Whether the estimate is shut, and whether the real lips are open, all through speech."""
    times = np.arange(*speech_span(track), _STEP)
    shut = estimated_aperture.at(times) < SHUT * estimated_aperture.loud
    return shut, reference_aperture.at(times) > OPEN * reference_aperture.loud


def _long_runs(mask: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    needed = round(FALSE_CLOSURE_MIN / _STEP)
    return [(first, last) for first, last in runs(mask) if last - first >= needed]


def silence_share(estimated_aperture: Aperture, track: PhoneTrack, margin: float = 0.0) -> float:
    """Mean aperture in silence over the 95th percentile; NaN without silence or any opening.

    Lips open before the sound and shut after it, on real faces too; `margin` s beside speech
    can be left out to see how much of the figure that is.
    """
    times = estimated_aperture.times
    inside = np.zeros(len(times), bool)
    for index, (phone, start, end) in enumerate(track):
        if phone == SILENCE:
            first = start + (margin if index > 0 else 0.0)
            last = end - (margin if index < len(track) - 1 else 0.0)
            inside |= (times >= first) & (times <= last)
    if estimated_aperture.loud == 0:
        return float("nan")
    return _mean(estimated_aperture.values[inside]) / estimated_aperture.loud


@dataclass(frozen=True)
class LipScore:
    """One recording, or the pool of many."""

    r: float
    """-1 to 1, without lag; NaN where either aperture does not move"""
    r_best_lag: float
    """-1 to 1, at `lag`"""
    lag: float
    """s; positive where the estimate is late"""
    closures_hit: int
    """of the real closures, how many the estimate makes"""
    closures_real: int
    false_closures: int
    speech: float
    """s, from the first phone to the last"""
    silence: float
    mistimed_closures: int = 0
    """the false ones among them"""
    """mean aperture in silence over the 95th percentile; NaN without silence"""


def evaluate(
    reference_aperture: Aperture, estimated_aperture: Aperture, track: PhoneTrack
) -> LipScore:
    """All figures of one recording."""
    start, end = speech_span(track)
    hit, real = closures(reference_aperture, estimated_aperture, track)
    lag, r_best = best_lag(reference_aperture, estimated_aperture, track)
    return LipScore(
        r=correlation(reference_aperture, estimated_aperture, track),
        r_best_lag=r_best,
        lag=lag,
        closures_hit=hit,
        closures_real=real,
        false_closures=false_closures(reference_aperture, estimated_aperture, track),
        speech=end - start,
        silence=silence_share(estimated_aperture, track),
        mistimed_closures=mistimed_closures(reference_aperture, estimated_aperture, track),
    )


def pool(scores: list[LipScore]) -> dict[str, float]:
    """Figures of many recordings: means of r, lag and silence, shares and rates of the counts.

    A figure that no recording has is NaN.

    Raises:
        ValueError: no recordings.
    """
    if not scores:
        raise ValueError("no recordings to pool")
    rs = [score.r for score in scores]
    real = sum(score.closures_real for score in scores)
    speech = sum(score.speech for score in scores)
    return {
        "recordings": len(scores),
        "r": _mean(rs),
        "r_median": float(np.nanmedian(rs)) if not np.isnan(rs).all() else float("nan"),
        "r_best_lag": _mean([score.r_best_lag for score in scores]),
        "lag_ms": 1000 * _mean([score.lag for score in scores]),
        "closures_real": real,
        "closures": sum(score.closures_hit for score in scores) / real if real else float("nan"),
        "false_closures_per_s": sum(score.false_closures for score in scores) / speech,
        "mistimed_closures_per_s": sum(score.mistimed_closures for score in scores) / speech,
        "silence": _mean([score.silence for score in scores]),
    }
