"""What a pass is, and the curve by which passes begin and end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]

Pass = Callable[[Clip, PhoneTrack], Clip]


def _ease_table(first: float, second: float) -> tuple[Floats, Floats]:
    t = np.linspace(0, 1, 257)
    x = 3 * first * (1 - t) ** 2 * t + 3 * second * (1 - t) * t**2 + t**3
    y = 3 * (1 - t) * t**2 + t**3
    return x, y


_EASE = _ease_table(0.5, 0.5)


def ease(x: npt.ArrayLike) -> Floats:
    """The cubic Bezier curve of the 2018 thesis (section 4.6.5), flat at both ends.

    Values of the shape of `x`, from 0 (for x at or below 0) to 1 (for x at or above 1).
    """
    return np.interp(np.asarray(x, np.float64), *_EASE)


def sides_of(name: str) -> tuple[str, ...]:
    """The canonical controls of a name with or without its side; none where there are none.

    `mouth` is no control without a side: mouthLeft moves the whole mouth to the left.
    """
    names = both_sides(name)
    return names if set(names) <= set(CANONICAL) - (_DIRECTIONS - {name}) else ()


_DIRECTIONS = frozenset(f"{part}{side}" for part in ("jaw", "mouth") for side in ("Left", "Right"))
