"""What a pass is, and the curve by which passes begin and end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.curves import bezier_ease
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]

Pass = Callable[[Clip, PhoneTrack], Clip]


def ease(x: npt.ArrayLike) -> Floats:
    """The cubic Bezier curve of the 2018 thesis (section 4.6.5), flat at both ends.

    Values of the shape of `x`, from 0 (for x at or below 0) to 1 (for x at or above 1).
    """
    return bezier_ease(x, 0.5, 0.5)


def sides_of(name: str) -> tuple[str, ...]:
    """The canonical controls of a name with or without its side; none where there are none.

    `mouth` is no control without a side: mouthLeft moves the whole mouth to the left.
    """
    names = both_sides(name)
    return names if set(names) <= set(CANONICAL) - (_DIRECTIONS - {name}) else ()


_DIRECTIONS = frozenset(f"{part}{side}" for part in ("jaw", "mouth") for side in ("Left", "Right"))
