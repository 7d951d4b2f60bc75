"""How far each control opens the lips, and when speech has shut them.

The table is that of our head, written by bench/lip_openings.py; passes need no head.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

import numpy as np

from lipwright.clip import Clip
from lipwright.passes.kinds import Floats, ease
from lipwright.passes.resting import speech_share
from lipwright.phones import BILABIALS, PHONES
from lipwright.track import PhoneTrack

OPENINGS: Final = MappingProxyType({
    "jawForward": (0.0243, 0.0225, 0.0225),
    "jawRight": (0.0, 0.0017, -0.0052),
    "jawLeft": (0.0, -0.0052, 0.0017),
    "jawOpen": (0.6035, 0.5515, 0.5515),
    "mouthClose": (-0.6035, -0.5515, -0.5515),
    "mouthFunnel": (0.2272, 0.1543, 0.1543),
    "mouthPucker": (-0.0416, -0.0382, -0.0382),
    "mouthRight": (-0.0243, -0.0208, -0.0295),
    "mouthLeft": (-0.0243, -0.0295, -0.0208),
    "mouthSmileLeft": (-0.0243, -0.0191, -0.0225),
    "mouthSmileRight": (-0.0243, -0.0225, -0.0191),
    "mouthFrownLeft": (0.0005, -0.0017, -0.0003),
    "mouthFrownRight": (0.0005, -0.0003, -0.0017),
    "mouthDimpleLeft": (-0.0006, -0.0015, -0.0017),
    "mouthDimpleRight": (-0.0006, -0.0017, -0.0015),
    "mouthStretchLeft": (0.0001, 0.0001, 0.0001),
    "mouthStretchRight": (0.0001, 0.0001, 0.0001),
    "mouthRollLower": (-0.0555, -0.0434, -0.0434),
    "mouthRollUpper": (-0.0208, -0.0139, -0.0139),
    "mouthShrugLower": (-0.0867, -0.0728, -0.0728),
    "mouthShrugUpper": (0.0607, 0.0538, 0.0538),
    "mouthPressLeft": (-0.0208, -0.0208, -0.0104),
    "mouthPressRight": (-0.0208, -0.0104, -0.0208),
    "mouthLowerDownLeft": (0.0329, 0.059, 0.0139),
    "mouthLowerDownRight": (0.0329, 0.0139, 0.059),
    "mouthUpperUpLeft": (0.0434, 0.0694, 0.0191),
    "mouthUpperUpRight": (0.0434, 0.0191, 0.0694),
    "cheekPuff": (-0.0208, -0.0173, -0.0173),
    "noseSneerLeft": (0.0017, -0.0035, 0.0035),
    "noseSneerRight": (0.0017, 0.0035, -0.0035),
})  # fmt: skip
"""control to how far it opens the centre, left and right of the inner lips at full weight, in
distances of the eyes; below 0 it shuts them. A control that is not here does neither."""

LOUD: Final = 95  # percentile of the aperture of which shares are taken, as in evaluation
SHUT: Final = 0.18  # share of it under which speech means its lips to be shut; 0.15 is judged
OPEN: Final = 0.35  # share of it from which it does not
NEAR: Final = 0.04  # s around a sound that shuts the lips in which they are shut
HOLDING: Final = 0.08  # s before and after that, over which the hold grows and goes

LIP_SOUNDS: Final = BILABIALS | {p.symbol for p in PHONES.values() if p.place == "labiodental"}
"""the phones at which a lip touches the other lip or the teeth"""


def gaps(clip: Clip) -> Floats:
    """(T, 3), how far the controls open the inner lips; below 0 they press on each other."""
    names = [name for name in clip.names if name in OPENINGS]
    table = np.array([OPENINGS[name] for name in names]).reshape(-1, 3)
    return clip.values[:, [clip.column(n) for n in names]].astype(np.float64) @ table


def lips_held(clip: Clip, track: PhoneTrack) -> Floats:
    """(T,), 1 where speech shuts the lips or holds one to the teeth, 0 where it does not.

    The lips are held by p b m f v, and wherever the aperture of the speech itself is shut.
    """
    times = clip.times
    held = np.zeros(len(times))
    for phone, start, end in track:
        if phone in LIP_SOUNDS:
            first, stop = np.searchsorted(times, (start - NEAR - HOLDING, end + NEAR + HOLDING))
            inside = times[first:stop]
            away = np.maximum(start - inside, inside - end) - NEAR
            held[first:stop] = np.maximum(held[first:stop], ease(1 - away / HOLDING))
    aperture = np.maximum(gaps(clip), 0).mean(axis=1)
    spoken = speech_share(track, times)
    if not (aperture * (spoken == 1)).any():
        return np.asarray(np.maximum(held, spoken))
    share = aperture / np.percentile(aperture, LOUD)
    shut = ease((OPEN - share) / (OPEN - SHUT)) * spoken
    return np.maximum(held, shut)


def shut_again(
    values: Floats,
    names: tuple[str, ...],
    more: Floats,
    hold: Floats,
    open_up: Floats,
) -> Floats:
    """Values (T, C) in which the lips are as far apart as before something was added to them.

    Args:
        values: (T, C), at most 1.
        names: the C controls; without both `jawOpen` and `mouthClose` nothing is done.
        more: (T, 3), how far it opened each place of the lips.
        hold: (T,), share of what it opened that is shut by `mouthClose`.
        open_up: (T,), share of what it shut that is opened by `jawOpen`.
    """
    if not {"jawOpen", "mouthClose"} <= set(names):
        return values
    result = values.copy()
    # The place that opened most and that which was shut least decide: none opens in the end.
    most = (more / OPENINGS["jawOpen"]).max(axis=1)
    closing = np.maximum(most, 0) * hold
    opening = np.maximum(-most, 0) * open_up
    for name, by in (("mouthClose", closing), ("jawOpen", opening)):
        column = result[:, names.index(name)]
        column += np.minimum(by, np.maximum(1 - column, 0))
    return result
