"""By how much the picture of a recording is late against its sound.

The lips that the rule-based engine gives to the phones of the sound are laid over the tracked
lips; the shift at which they agree best is the offset.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from lipwright.evaluate.lips import Aperture, correlation, speech_span
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

MAX_OFFSET: Final = 0.5  # s; further apart, syllables match their neighbours
STEP: Final = 0.005  # s
LEAST_R: Final = 0.6  # under it the lips do not follow the sound at any shift
R_A_SECOND: Final = 0.6  # by how much more r must be there for each s of shift
LEAST_GAIN: Final = 0.03  # of r; less is no better than no shift
LEAST_OFFSET: Final = 0.02  # s, half a frame at 25 fps; less cannot be told
DISTRUST: Final = 1.0  # of r a s^2: far shifts must agree better than near ones
LEAST_SPEECH: Final = 0.8  # s; in less there is too little to compare
REFERENCE_FPS: Final = 100.0


@dataclass(frozen=True)
class Offset:
    """How far sound and picture are apart."""

    seconds: float
    """by how much the picture is late; negative where it is early"""
    r: float
    """agreement of the lips with the sound at that offset, -1 to 1; NaN where nothing moves"""
    r_at_zero: float
    """the same without any"""
    trusted: bool
    """whether the offset is taken off, and the rest taken for measuring error"""

    def to_info(self) -> dict[str, float | bool | None]:
        """As recording.json keeps it; None where there is no figure."""
        r, zero = (None if np.isnan(v) else round(v, 4) for v in (self.r, self.r_at_zero))
        return {
            "seconds": round(self.seconds, 4), "r": r, "r_at_zero": zero, "trusted": self.trusted,
        }  # fmt: skip


def estimate_offset(aperture: Aperture, track: PhoneTrack) -> Offset:
    """The offset of a tracked `aperture` against the phones of the sound.

    Raises:
        LipwrightError: the head that the engine's curves are measured on is not installed.
    """
    nothing = Offset(0.0, float("nan"), float("nan"), trusted=False)
    if all(phone == SILENCE for phone in track.phones):
        return nothing
    expected = expected_aperture(track)
    count = round(MAX_OFFSET / STEP)
    lags = np.arange(-count, count + 1) * STEP
    found = np.array([correlation(aperture, expected, track, float(lag)) for lag in lags])
    if np.isnan(found).all():
        return nothing
    best = int(np.nanargmax(found - DISTRUST * lags**2))
    r, zero = float(found[best]), float(found[count])
    start, end = speech_span(track)
    # The expected lips are read `lag` later where the picture is early.
    seconds = -float(lags[best])
    trusted = (
        r >= LEAST_R + R_A_SECOND * abs(seconds)
        and r - zero >= LEAST_GAIN
        and abs(seconds) >= LEAST_OFFSET
        and abs(seconds) < MAX_OFFSET
        and end - start >= LEAST_SPEECH
    )
    return Offset(seconds, r, zero, trusted)


def expected_aperture(track: PhoneTrack) -> Aperture:
    """The aperture of our head as the engine speaks the track.

    Raises:
        LipwrightError: the head is not installed.
    """
    from lipwright.face.head import load_head
    from lipwright.pipeline import AnimateOptions, animate_track

    clip = animate_track(track, AnimateOptions(fps=REFERENCE_FPS))
    return Aperture(clip.times, load_head().aperture_curve(clip.values))
