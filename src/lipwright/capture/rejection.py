"""Which recordings training should do without, and why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final


@dataclass(frozen=True)
class RejectLimits:
    """What a recording may be like before it does training more harm than good.

    Set on the 880 recordings of GRID's first speaker, which are good ones: they turn by up to
    12 degrees, open by 0.10 to 0.29 eye distances and rest with a jitter of up to 0.006. These
    limits leave out 35 of them: wrong words or times, or the face lost in a tenth of the frames.
    """

    tracked: float = 0.95
    """least share of the frames with a face; the gaps of fewer lie in speech sooner or later"""
    dropped: float = 0.05
    """largest share of the frames that the video lacks"""
    second_face: float = 0.05
    """largest share of the frames with a second face, which the tracker may follow instead"""
    turn_deg: float = 30.0
    """degrees: largest turn in all but a twentieth of the frames; beyond it one side of the lips
    is guessed"""
    eye_distance_px: float = 20.0
    """px, least: below it the 15 % mark of closures is about half a pixel"""
    jitter: float = 0.01
    """eye distances, largest, of lips at rest: a third of the 15 % mark of closures"""
    offset: float = 0.2
    """s, largest that is trusted: recorders are seldom further apart, so more is rather a wrong
    match"""
    offset_r: float = 0.3
    """least correlation of lips and words: below it they have nothing to do with each other"""
    confidence: float = 0.6
    """least mean confidence of the words, 0 to 1"""
    misfits: float = 0.1
    """largest share of the words that do not fit the sound"""
    bilabials_open: float = 0.1
    """largest share of p, b, m with open lips: the words or their times are others"""
    opening: float = 0.03
    """eye distances, least between rest and the 95th percentile: lips that speak move more"""


DEFAULT_LIMITS: Final = RejectLimits()


def reject_reasons(
    quality: Mapping[str, Any],
    offset: Mapping[str, Any] | None = None,
    limits: RejectLimits = DEFAULT_LIMITS,
) -> list[str]:
    """One line for each reason to leave a recording out; none for a good one.

    Args:
        quality: what `measure_quality` gives; a figure that is None is not judged.
        offset: what recording.json has under `offset`, to judge it too.
        limits: what is still good enough.
    """
    return [
        *_picture_reasons(quality, limits),
        *_lip_reasons(quality, limits),
        *_speech_reasons(quality, limits),
        *_offset_reasons(offset or {}, limits),
    ]


def _picture_reasons(quality: Mapping[str, Any], limits: RejectLimits) -> Iterator[str]:
    frames = quality.get("frames") or 1
    if (share := quality.get("tracked")) is not None and share < limits.tracked:
        yield f"a face in {100 * share:.1f} % of the frames, under {100 * limits.tracked:.0f} %"
    if (dropped := quality.get("dropped") or 0) > limits.dropped * frames:
        yield f"{dropped} of {frames} frames are missing, over {100 * limits.dropped:.0f} %"
    if (share := quality.get("second_face") or 0.0) > limits.second_face:
        limit = 100 * limits.second_face
        yield f"a second face in {100 * share:.1f} % of the frames, over {limit:.0f} %"
    if (turn := quality.get("turn_usual_deg")) is not None and turn > limits.turn_deg:
        yield f"the face is turned away by {turn:.0f} degrees, over {limits.turn_deg:.0f}"
    if (eyes := quality.get("eye_distance_px")) is not None and eyes < limits.eye_distance_px:
        yield f"the eyes are {eyes:.0f} pixels apart, under {limits.eye_distance_px:.0f}"
    if (jitter := quality.get("jitter")) is not None and jitter > limits.jitter:
        yield f"lips at rest tremble by {jitter:.4f} eye distances, over {limits.jitter:g}"


def _lip_reasons(quality: Mapping[str, Any], limits: RejectLimits) -> Iterator[str]:
    if (opening := quality.get("opening")) is not None and opening < limits.opening:
        yield f"the lips hardly move: {opening:.3f} eye distances, under {limits.opening:g}"
    bilabials, wide = quality.get("bilabials") or 0, quality.get("bilabials_open") or 0
    if wide > limits.bilabials_open * bilabials:
        limit = limits.bilabials_open
        yield f"the lips stay open at {wide} of {bilabials} p, b, m, over {100 * limit:.0f} %"


def _speech_reasons(quality: Mapping[str, Any], limits: RejectLimits) -> Iterator[str]:
    confidence = quality.get("confidence")
    if confidence is not None and confidence < limits.confidence:
        yield f"the words fit the sound by {confidence:.2f}, under {limits.confidence:g}"
    words, misfits = quality.get("words") or 0, quality.get("misfits") or 0
    if misfits > limits.misfits * words:
        yield f"{misfits} of {words} words do not fit the sound, over {100 * limits.misfits:.0f} %"


def _offset_reasons(offset: Mapping[str, Any], limits: RejectLimits) -> Iterator[str]:
    """An offset that is not trusted is not taken off: then the agreement without it counts."""
    is_trusted, seconds = offset.get("trusted") is True, offset.get("seconds")
    r = offset.get("r" if is_trusted else "r_at_zero")
    if r is not None and r < limits.offset_r:
        yield f"lips and words do not go together (r {r:.2f}, under {limits.offset_r:g})"
    elif is_trusted and seconds is not None and abs(seconds) > limits.offset:
        late = "late" if seconds > 0 else "early"
        yield f"the picture is {abs(seconds) * 1000:.0f} ms {late}, over {limits.offset * 1000:.0f}"
