"""Keys of curves as text, whole columns at a time: a call of Python a number would take minutes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.keys import KeyedCurve


def key_rows(form: str, *columns: npt.ArrayLike) -> str:
    """The `%` template `form` once a key, filled with a number of each column, each (K,)."""
    # + 0.0: minus zero is zero.
    table = np.stack([np.asarray(column, np.float64) for column in columns], axis=1) + 0.0
    return form * len(table) % tuple(table.ravel().tolist())


def number(value: float, digits: int = 7) -> str:
    """A number in at most `digits` digits, as `%g` writes it."""
    return f"{value + 0.0:.{digits}g}"


def is_smooth(curve: KeyedCurve) -> npt.NDArray[np.bool_]:
    """(K,), whether the slopes on both sides of a key are one."""
    return np.asarray(np.isclose(curve.arriving, curve.leaving, rtol=1e-6, atol=1e-9))


def check_controls(path: Path, clip: Clip, what: str, forbidden: str = "") -> None:
    """Refuse curves that a text format cannot name.

    Args:
        path: the file, for the message.
        clip: the curves.
        what: who reads the file.
        forbidden: characters that its names cannot have; control characters are none's.

    Raises:
        LipwrightError: there are no controls, or a name has such a character.
    """
    if not clip.names:
        raise LipwrightError(f"{path}: the curves have no controls; {what} needs one at least")
    for name in clip.names:
        for letter in name:
            if letter in forbidden or not (letter.isprintable() or letter == " "):
                raise LipwrightError(
                    f"{path}: {what} cannot have {letter!r} in the name of the control "
                    f"{name[:40]!r}; rename it in the rig"
                )
