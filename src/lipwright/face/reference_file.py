"""Reference faces as .npz files, without pickles; the same model gives the same bytes."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.errors import LipwrightError
from lipwright.face.appearance import Appearance
from lipwright.face.reference import ReferenceFace
from lipwright.face.vertices import LANDMARKS, REGIONS, TRIANGLES
from lipwright.face.warp import Grid
from lipwright.files import write_whole
from lipwright.npz import BROKEN, reason_of

FORMAT: Final = 1  # raise when the arrays of the file change
REMEDY: Final = "make it with: lipwright face fit"
_PLAIN: Final = (
    "mean_shape", "depth", "shape_modes", "shape_sd", "joint_mean", "joint_modes", "joint_sd",
)  # fmt: skip


def save_reference_face(path: str | os.PathLike[str], face: ReferenceFace) -> None:
    """Write `face`; its pixel modes as half floats, as the fit has rounded them.

    Raises:
        LipwrightError: the file cannot be written.
    """
    arrays: dict[str, Any] = {name: getattr(face, name) for name in _PLAIN}
    for region in REGIONS:
        appearance: Appearance = getattr(face, region)
        arrays[f"{region}_scale"] = np.asarray(appearance.grid.scale, np.float64)
        arrays[f"{region}_shape"] = appearance.grid.shape
        arrays[f"{region}_mean"] = appearance.mean
        arrays[f"{region}_modes"] = appearance.modes.astype(np.float16)
        arrays[f"{region}_sd"] = appearance.sd
    info = json.dumps(dict(face.info), sort_keys=True, ensure_ascii=False, allow_nan=False)
    with write_whole(path) as part, part.open("wb") as file:
        np.savez_compressed(
            file, format=FORMAT, landmarks=LANDMARKS, weight=face.weight, info=info, **arrays
        )


def load_reference_face(path: str | os.PathLike[str]) -> ReferenceFace:
    """The model of a file that `save_reference_face` wrote.

    Raises:
        LipwrightError: the file is missing, broken, or of another version.
    """
    try:
        with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as stored:
            return _read(path, stored)
    except FileNotFoundError as error:
        raise LipwrightError(f"{path}: no such file; {REMEDY}") from error
    except IsADirectoryError as error:
        raise LipwrightError(f"{path}: is a folder; name the .npz of a reference face") from error
    except BROKEN as error:
        raise LipwrightError(
            f"{path}: not a reference face ({reason_of(error)}); {REMEDY}"
        ) from error


def _read(path: str | os.PathLike[str], stored: Any) -> ReferenceFace:
    if int(stored["format"]) != FORMAT:
        raise LipwrightError(
            f"{path}: format {int(stored['format'])} of reference faces, not {FORMAT}; {REMEDY}"
        )
    if not np.array_equal(stored["landmarks"], LANDMARKS):
        raise LipwrightError(f"{path}: a reference face on other landmarks; {REMEDY}")
    info = json.loads(str(stored["info"]))
    if not isinstance(info, dict):
        raise ValueError("info is not an object")  # noqa: TRY004  # a broken file, as the rest
    plain = {name: stored[name] for name in _PLAIN}
    inner, outer = (_read_region(region, stored) for region in REGIONS)
    return ReferenceFace(
        inner=inner, outer=outer, weight=float(stored["weight"]), info=info, **plain
    )


def _read_region(region: str, stored: Any) -> Appearance:
    across, down = (float(side) for side in stored[f"{region}_scale"])
    grid = Grid(stored[f"{region}_shape"], TRIANGLES[region], (across, down))
    return Appearance(
        grid, stored[f"{region}_mean"], stored[f"{region}_modes"], stored[f"{region}_sd"]
    )
