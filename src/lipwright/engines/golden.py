"""The golden output of models that are arrays: what their engine made of a track when trained."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.engines import ENGINES
from lipwright.errors import LipwrightError
from lipwright.network import check_golden as check_network
from lipwright.network import find_model
from lipwright.network.arrays import ArrayModel
from lipwright.network.folder import REMEDY, read_hashed, read_meta
from lipwright.network.meta import GOLDEN_FILE, NETWORKS
from lipwright.network.runtime import GOLDEN_TOLERANCE
from lipwright.npz import BROKEN, read_arrays, reason_of
from lipwright.track import PhoneTrack

FRAMES: Final = 256  # of the golden output, at most
LATEST: Final = 1e6  # s, of a frame; eleven days


def golden_of(
    predicted: npt.NDArray[np.float32], track: PhoneTrack, times: npt.NDArray[np.float64]
) -> dict[str, npt.NDArray[Any]]:
    """The arrays of golden.npz: controls (T, C) of a track at (T,) times in s."""
    return {
        "phones": np.array(track.phones), "edges": np.asarray(track.edges, np.float64),
        "times": np.asarray(times, np.float64), "controls": np.asarray(predicted, np.float32),
    }  # fmt: skip


def check_model(model: str | Path) -> float:
    """The largest difference of a model's output from its golden output, of any engine.

    Raises:
        LipwrightError: the model cannot be loaded, its golden.npz is damaged, or this machine
            does not reproduce it to 1e-4 of a full range.
    """
    folder = find_model(model)
    meta = read_meta(folder)
    if meta.kind in NETWORKS:
        return check_network(model)
    engine = import_module(ENGINES[meta.engine].module)
    opened: ArrayModel = engine.open_network(folder)
    path = folder / GOLDEN_FILE
    content = read_hashed(folder, meta, GOLDEN_FILE)
    try:
        track, times, controls = _read_golden(content, len(meta.controls))
    except BROKEN as error:
        raise LipwrightError(f"{path}: damaged ({reason_of(error)}); {REMEDY}") from error
    try:
        predicted = engine.predict_at(opened, track, times)
    except ValueError as error:  # times of another clock than that of meta.json
        raise LipwrightError(f"{path}: does not fit meta.json ({error}); {REMEDY}") from error
    difference = np.abs(predicted - controls)
    worst = float(difference.max(initial=0.0))
    if not worst <= GOLDEN_TOLERANCE:
        name = meta.controls[int(difference.max(axis=0).argmax())]
        raise LipwrightError(
            f"{path}: not reproduced: {name} differs by {worst:.2g}, more than "
            f"{GOLDEN_TOLERANCE:g}; {REMEDY}"
        )
    return worst


def _read_golden(
    content: bytes, count: int
) -> tuple[PhoneTrack, npt.NDArray[np.float64], npt.NDArray[np.float32]]:
    """A track, (T,) times in s, and the (T, C) of `count` controls at them.

    Raises:
        BROKEN: the file does not hold these.
    """
    stored = read_arrays(content)
    track = PhoneTrack(tuple(map(str, stored["phones"])), stored["edges"])
    times, controls = stored["times"], stored["controls"]
    if times.dtype.kind != "f" or not 0 < times.size <= FRAMES or times.ndim != 1:
        raise ValueError(f"'times' is {times.dtype} of the shape {times.shape}")
    if not ((np.abs(times) <= LATEST).all() and (np.diff(times) > 0).all()):
        raise ValueError("'times' does not rise, or is no time")
    if controls.dtype.kind != "f" or controls.shape != (len(times), count):
        raise ValueError(f"'controls' is {controls.dtype} of the shape {controls.shape}")
    return track, times, controls
