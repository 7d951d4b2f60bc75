"""The heads that curves are measured on: ours, and a second one that is only points.

A weight of 0.5 opens the lips of one head wider than those of another. A figure that holds on two
heads, made by different people, is not the head's.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.npz import BROKEN, reason_of

Floats = npt.NDArray[np.float64]

Ruler = Callable[[Clip], Floats]
"""clip to its aperture (T,), in distances between the centres of the head's eyes"""

OUR_HEAD: Final = "our head"
RULER_HEAD: Final = "ruler head"

POINTS: Final = 68  # landmarks of a face: Sagonas et al. 2013, 300 Faces in-the-Wild (iBUG)
UPPER_LIP: Final = (61, 62, 63)  # the inner edge of the upper lip
LOWER_LIP: Final = (67, 66, 65)  # the points below them
EYES: Final = (slice(36, 42), slice(42, 48))  # the outline of either eye

SHORTEST: Final = 0.1  # of the eyes' distance at rest; weights do not bring eyes nearer than that

REMEDY: Final = (
    "a second head is an .npz file with neutral (68, 3), deltas (C, 68, 3) and names (C,) of the "
    "ARKit controls"
)


def our_head() -> Ruler:
    """The installed head.

    Raises:
        LipwrightError: it is not installed.
    """
    from lipwright.face.head import load_head

    head = load_head()
    return lambda clip: head.aperture_curve(clip.select(CANONICAL).values)


def landmark_head(path: Path) -> Ruler:
    """A head of which only 68 landmarks are known, seen from the front as a camera would.

    The points of its inner lips may lie on two surfaces and be apart while its lips touch; what is
    between them at rest is taken off, as a tracker's points fall together on shut lips.

    Args:
        path: an .npz file: `neutral` (68, 3), x to the side, y up or down, z to the camera, in any
            unit; `deltas` (C, 68, 3), what a full weight of each control adds; `names` (C,) of the
            controls, with `_L` and `_R` or `Left` and `Right`. A middle control may come in two
            halves.

    Raises:
        LipwrightError: the file is missing or is not such a head.
    """
    neutral, deltas, names = _read(path)
    used = tuple(dict.fromkeys(names))
    columns = [used.index(name) for name in names]
    resting = neutral[None, :, :2]
    distance = float(_eye_distance(resting)[0])
    if not distance > 0:
        raise LipwrightError(f"{path}: the eyes (points 36 to 47) are in one place; {REMEDY}")
    touching = float((_gaps(resting) / distance)[0])

    def measure(clip: Clip) -> Floats:
        weights = clip.select(used).values.astype(np.float64)[:, columns]  # (T, C)
        points = neutral[:, :2] + np.tensordot(weights, deltas[..., :2], axes=1)  # (T, 68, 2)
        eyes = np.maximum(_eye_distance(points), SHORTEST * distance)
        return np.asarray(np.maximum(_gaps(points) / eyes - touching, 0))

    return measure


def rulers(second: Path | None) -> dict[str, Ruler]:
    """Name to ruler: our head, and the second one of a file where there is one.

    Raises:
        LipwrightError: our head is not installed, or the file is not a head.
    """
    found = {OUR_HEAD: our_head()}
    if second is not None:
        found[RULER_HEAD] = landmark_head(second)
    return found


def _gaps(points: Floats) -> Floats:
    """(T,) mean gap between the inner lips of points (T, 68, 2), in their unit."""
    apart = points[:, UPPER_LIP] - points[:, LOWER_LIP]
    return np.asarray(np.linalg.norm(apart, axis=-1).mean(axis=1))


def _eye_distance(points: Floats) -> Floats:
    """(T,) between the centres of the eyes of points (T, 68, 2), in their unit."""
    left, right = (points[:, eye].mean(axis=1) for eye in EYES)
    return np.asarray(np.linalg.norm(left - right, axis=-1))


def _read(path: Path) -> tuple[Floats, Floats, tuple[str, ...]]:
    """The points at rest, what each control adds, and the canonical names, of a stranger's file."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            arrays: dict[str, npt.NDArray[Any]] = {
                name: np.asarray(stored[name]) for name in ("neutral", "deltas", "names")
            }
    except FileNotFoundError as error:
        raise LipwrightError(f"{path}: no such file; {REMEDY}") from error
    except BROKEN as error:
        raise LipwrightError(
            f"{path}: not a readable head ({reason_of(error)}); {REMEDY}"
        ) from error
    names = arrays["names"]
    if names.ndim != 1 or names.dtype.kind != "U" or not len(names):
        raise LipwrightError(f"{path}: names are not a row of text; {REMEDY}")
    for name, shape in (("neutral", (POINTS, 3)), ("deltas", (len(names), POINTS, 3))):
        array = arrays[name]
        if array.shape != shape or array.dtype.kind != "f":
            raise LipwrightError(
                f"{path}: {name} is {array.dtype} of the shape {array.shape}, not numbers of the "
                f"shape {shape}; {REMEDY}"
            )
        if not np.isfinite(array).all():
            raise LipwrightError(f"{path}: {name} has values that are not finite; {REMEDY}")
    return (
        arrays["neutral"].astype(np.float64),
        arrays["deltas"].astype(np.float64),
        _controls(path, [str(name) for name in names]),
    )


def _controls(path: Path, names: list[str]) -> tuple[str, ...]:
    """The canonical control of each name; two halves of a middle control are both that control."""
    if len(set(names)) != len(names):
        raise LipwrightError(f"{path}: a name of a control repeats; {REMEDY}")
    found = []
    for name in names:
        stem = name.removesuffix("_L").removesuffix("_R")
        sided = stem + {"_L": "Left", "_R": "Right"}.get(name[len(stem) :], "")
        control = next((one for one in (sided, stem) if one in CANONICAL), None)
        if control is None:
            raise LipwrightError(f"{path}: {name[:60]!a} is no ARKit control; {REMEDY}")
        found.append(control)
    return tuple(found)
