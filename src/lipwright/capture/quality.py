"""How good a captured recording is, in figures.

Every figure is one small function of arrays; `measure_quality` puts them together for
recording.json. A figure that cannot be had is None.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.dataset.recording import Flag, Motion
from lipwright.evaluate.lips import CLOSED, LOUD_PERCENTILE, OPEN, runs
from lipwright.phones import BILABIALS
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.floating]
Mask = npt.NDArray[np.bool_]

REST_PERCENTILE: Final = 5  # the opening at rest
QUIET: Final = 0.25  # share of the frames, those with the slowest lips, that show the jitter
TURN_PERCENTILE: Final = 95  # of the frames: a short look aside does no harm

LIP_LANDMARKS: Final = (
    61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291, 185, 40, 39, 37, 0, 267, 269, 270, 409,
    78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308, 191, 80, 81, 82, 13, 312, 311, 310, 415,
)  # fmt: skip
"""landmarks on the outer and inner edge of the lips"""


def rounded(value: float | None, decimals: int = 4) -> float | None:
    """`value` for a JSON file: None where it is missing, NaN or infinite."""
    return None if value is None or not math.isfinite(value) else round(float(value), decimals)


def tracked_share(motion: Motion) -> float:
    """Of the frames that the video has, the share with a face, 0 to 1."""
    there = (motion.flags & Flag.DROPPED) == 0
    return float(motion.valid[there].mean()) if there.any() else 0.0


def eye_distance(head_pose: Floats) -> float:
    """The median distance of the eyes' centres over the frames of (T, 3, 4), px."""
    return _nan_median(np.linalg.norm(head_pose[:, :, 0], axis=1))


def head_turns(head_pose: Floats) -> npt.NDArray[np.float64]:
    """(T,), degrees between the way the face looks and the camera's axis; NaN where lost."""
    forward = head_pose[:, :, 2].astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = forward[:, 2] / np.linalg.norm(forward, axis=1)
        return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def lip_jitter(landmarks_raw: Floats) -> float:
    """How far the tracker's points on resting lips are off from frame to frame, eye distances.

    The standard deviation of a point's place, had it the same noise in every frame: each frame is
    compared with the middle between its neighbours, which a steady movement leaves at zero.

    Args:
        landmarks_raw: (T, 478, 3), before smoothing, in the head's frame; NaN where lost.
    """
    lips = landmarks_raw[:, list(LIP_LANDMARKS), :2].astype(np.float64)
    if len(lips) < 3:
        return float("nan")
    before, here, after = lips[:-2], lips[1:-1], lips[2:]
    # A frame less the mean of two others has 1 + 1/2 times the variance of one.
    variance = ((here - (before + after) / 2) ** 2).sum(axis=-1).mean(axis=1) / 1.5
    steps = [np.linalg.norm(step, axis=-1).mean(axis=1) for step in (here - before, after - here)]
    speed = np.maximum(*steps)  # both: at the top of an opening the neighbours are alike
    known = np.flatnonzero(np.isfinite(variance))
    if not len(known):
        return float("nan")
    quiet = known[np.argsort(speed[known], kind="stable")[: math.ceil(QUIET * len(known))]]
    return float(np.sqrt(variance[quiet].mean()))


def mean_confidence(track: PhoneTrack) -> float:
    """Of the words that were judged, 0 to 1; NaN where none was."""
    values = [word.confidence for word in track.words if word.confidence is not None]
    return float(np.mean(values)) if values else float("nan")


@dataclass(frozen=True)
class Closure:
    """What the lips did at one p, b or m."""

    phone: str
    start: float
    """s"""
    end: float
    """s"""
    share: float | None
    """the least aperture near the phone over the recording's loud opening; None: not seen"""

    @property
    def closed(self) -> bool:
        """Whether the lips were seen to close."""
        return self.share is not None and self.share < CLOSED


def loud_aperture(aperture: Floats) -> float:
    """The opening (T,) that shares are taken of; NaN where the face is lost all through."""
    known = aperture[np.isfinite(aperture)]
    return float(np.percentile(known, LOUD_PERCENTILE)) if len(known) else float("nan")


def bilabial_closures(
    aperture: Floats, times: Floats, step: float, track: PhoneTrack
) -> list[Closure]:
    """The bilabials of a track, judged by the frames within one frame of each phone.

    A phone is not seen where frames near it are lost, or the picture does not reach it, and the
    other frames show no closure.

    Args:
        aperture: (T,), NaN where lost.
        times: (T,), s, on the clock of the sound, rising.
        step: the time from frame to frame, s.
        track: the phones.
    """
    loud = loud_aperture(aperture)
    found = []
    for phone, start, end in track:
        if phone not in BILABIALS:
            continue
        first = np.searchsorted(times, start - step, side="left")
        near = aperture[first : np.searchsorted(times, end + step, side="right")]
        seen = near[np.isfinite(near)]
        share = float(seen.min()) / loud if len(seen) and loud > 0 else None
        reached = times[0] - step <= start and end <= times[-1] + step
        if share is not None and share >= CLOSED and (len(seen) < len(near) or not reached):
            share = None
        found.append(Closure(phone, start, end, share))
    return found


def mean_share(closures: Iterable[Closure]) -> float:
    """The mean share of the bilabials that were seen; NaN where none was."""
    shares = [closure.share for closure in closures if closure.share is not None]
    return float(np.mean(shares)) if shares else float("nan")


def agreement(reference_aperture: Floats, estimated_aperture: Floats) -> tuple[float, float]:
    """Correlation and gain (slope of the estimate over the reference), both (T,) apertures.

    Both are NaN where one of them does not move.
    """
    known = np.isfinite(reference_aperture) & np.isfinite(estimated_aperture)
    x = reference_aperture[known].astype(np.float64)
    y = estimated_aperture[known].astype(np.float64)
    if len(x) < 3 or np.ptp(x) == 0 or np.ptp(y) == 0:
        return float("nan"), float("nan")
    covariance = float(np.mean((x - x.mean()) * (y - y.mean())))
    return covariance / float(x.std() * y.std()), covariance / float(x.var())


def measure_quality(
    motion: Motion,
    track: PhoneTrack,
    lag: float,
    *,
    misfits: int = 0,
    landmarks_raw: Floats | None = None,
    arkit_aperture: Floats | None = None,
) -> dict[str, Any]:
    """The figures of a recording, as docs/dataset.md describes them under `quality`.

    Args:
        motion: what the face did.
        track: what was said, on the clock of the sound.
        lag: by how much a frame's time is ahead of the clock of the sound, s: the offset, less the
            picture's start.
        misfits: words that do not fit the sound.
        landmarks_raw: (T, 478, 3), `motion.landmarks` before smoothing; without them there is
            no jitter.
        arkit_aperture: (T,), the aperture of the head posed by `motion.arkit`.

    Returns:
        Numbers, lists and None, ready for JSON.
    """
    quality: dict[str, Any] = {
        "tracked": rounded(tracked_share(motion)),
        "dropped": int(((motion.flags & Flag.DROPPED) != 0).sum()),
        "frames": len(motion),
        "second_face": rounded(float(((motion.flags & Flag.CROWD) != 0).mean())),
        "blinks": len(runs((motion.flags & Flag.BLINK) != 0)),
        "confidence": rounded(mean_confidence(track)),
        "words": len(track.words),
        "misfits": misfits,
        **_pose_figures(motion.head_pose),
        **_closure_figures(motion, track, lag),
    }
    jitter = None
    if landmarks_raw is not None:
        jitter = lip_jitter(landmarks_raw)
    quality["jitter"] = rounded(jitter, 6)
    r = gain = None
    if motion.aperture is not None and arkit_aperture is not None:
        r, gain = agreement(motion.aperture, arkit_aperture)
    quality["arkit_r"], quality["arkit_gain"] = rounded(r), rounded(gain)
    return quality


def _pose_figures(head_pose: Floats | None) -> dict[str, Any]:
    if head_pose is None or not np.isfinite(head_pose).any():
        return {"eye_distance_px": None, "turn_deg": None, "turn_usual_deg": None}
    turns = head_turns(head_pose)
    return {
        "eye_distance_px": rounded(eye_distance(head_pose), 2),
        "turn_deg": rounded(float(np.nanmax(turns)), 2),
        "turn_usual_deg": rounded(float(np.nanpercentile(turns, TURN_PERCENTILE)), 2),
    }


def _closure_figures(motion: Motion, track: PhoneTrack, lag: float) -> dict[str, Any]:
    keys = (
        "bilabials", "bilabials_unseen", "bilabials_closed", "bilabials_closed_before",
        "bilabials_open", "unclosed", "closure_share_before", "closure_share_after", "opening",
    )  # fmt: skip
    if motion.aperture is None or motion.aperture_raw is None:
        return dict.fromkeys(keys)
    times = (np.arange(len(motion)) + 0.5) / motion.fps - lag
    step = 1 / motion.fps
    before = bilabial_closures(motion.aperture_raw, times, step, track)
    after = bilabial_closures(motion.aperture, times, step, track)
    known = motion.aperture[np.isfinite(motion.aperture)]
    rest = float(np.percentile(known, REST_PERCENTILE)) if len(known) else float("nan")
    unclosed = [
        {"phone": c.phone, "start": rounded(c.start), "end": rounded(c.end),
         "share": rounded(c.share)}
        for c in after if c.share is not None and not c.closed
    ]  # fmt: skip
    values = (
        sum(c.share is not None for c in after), sum(c.share is None for c in after),
        sum(c.closed for c in after), sum(c.closed for c in before),
        sum(c.share is not None and c.share > OPEN for c in after), unclosed,
        rounded(mean_share(before)), rounded(mean_share(after)),
        rounded(loud_aperture(motion.aperture) - rest),
    )  # fmt: skip
    return dict(zip(keys, values, strict=True))


def _nan_median(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else float("nan")
