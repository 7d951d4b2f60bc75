"""What one sees of a mouth: aperture, lip width, pout, lip on teeth and tongue."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides

Floats = npt.NDArray[np.float64]

SEEN: Final = MappingProxyType({
    "jawForward": (0.023, -0.003, 0.023),
    "jawOpen": (0.569, -0.059, 0.011),
    "mouthClose": (-0.569, 0.068, -0.004),
    "mouthFunnel": (0.179, -0.080, 0.075),
    "mouthPucker": (-0.039, -0.146, 0.034),
    "mouthSmile": (-0.022, 0.121, 0.048),
    "mouthFrown": (-0.001, 0.019, 0.000),
    "mouthDimple": (-0.001, 0.087, 0.032),
    "mouthStretch": (0.000, 0.087, 0.031),
    "mouthRollLower": (-0.047, 0.005, -0.040),
    "mouthRollUpper": (-0.016, 0.010, -0.061),
    "mouthShrugLower": (-0.077, -0.003, 0.029),
    "mouthShrugUpper": (0.056, 0.000, 0.005),
    "mouthPress": (-0.017, 0.104, 0.001),
    "mouthLowerDown": (0.035, 0.002, 0.003),
    "mouthUpperUp": (0.044, -0.007, 0.000),
    "cheekPuff": (-0.018, -0.101, -0.030),
})  # fmt: skip
"""canonical control (one without a side stands for either) to what a full weight adds on our head,
in distances of its eyes: aperture, width between the corners of the lips, and how far their middle
stands before the corners; a test measures the head again"""

OVERLAP: Final = 0.005  # eye distances; lips at rest touch, and open once they no longer overlap
LIP_ON_TEETH: Final = ("mouthRollLower",)
TONGUE_UP: Final = ("tongueRaise", "tonguePress", "tongueOut")

# What is plainly another mouth. The aperture counts by its square root: a little light between
# shut lips shows more than as much again in an open mouth. Spread lips count half: many speakers
# do not smile as drawings do.
UNITS: Final = (
    0.2,  # square root of eye distances of aperture
    0.06,  # eye distances of width
    0.1,  # eye distances of pout, which shows little from the front
    0.25,  # weight of lips on teeth
    0.6,  # weight of tongue
)
SHUT: Final = 0.005  # eye distances of aperture; below, lips look shut


def _table() -> Floats:
    """(55, 5), what a full weight of each canonical control adds to what is seen."""
    table = np.zeros((len(CANONICAL), len(UNITS)))
    for name, row in SEEN.items():
        for side in both_sides(name):
            table[CANONICAL.index(side), :3] = row
    for column, controls in ((3, LIP_ON_TEETH), (4, TONGUE_UP)):
        for name in controls:
            table[CANONICAL.index(name), column] = 1.0
    return table


def seen_of(weights: Floats) -> Floats:
    """(n, 5), aperture, width, pout, lip on teeth and tongue of canonical weights (n, 55)."""
    return np.asarray(weights @ _table() - [OVERLAP, 0, 0, 0, 0])


def seen_at(clip: Clip, times: Floats) -> Floats:
    """(len(times), 5), linear between the clip's frames, as its weights are."""
    frames = seen_of(clip.select(CANONICAL).values.astype(np.float64))
    return np.stack([np.interp(times, clip.times, column) for column in frames.T], axis=1)


def scaled(seen: Floats) -> Floats:
    """(n, 5), in units of what is plainly another mouth."""
    scaled = seen.copy()
    scaled[:, 0] = np.sqrt(np.maximum(seen[:, 0], 0))
    scaled[:, 1] = np.minimum(seen[:, 1], seen[:, 1] / 2)
    scaled[:, 4] = np.clip(seen[:, 4], 0, 1)
    return np.asarray(scaled / UNITS)


def are_shut(seen: Floats) -> npt.NDArray[np.bool_]:
    """(n,), whether lips are shut as for p, b, m and at rest: not those of f, nor round ones."""
    return (seen[:, 0] < SHUT) & (seen[:, 1] > -UNITS[1]) & (seen[:, 3] < UNITS[3])
