"""How well a reference face gives back what it was shown: points and grey levels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.pixels import Samples
from lipwright.capture.takes import Take
from lipwright.face.appearance import LUMA
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.vertices import REGIONS

DECIMALS: Final = 5
_BATCH: Final = 100  # frames of which pixels are made at a time

Errors = dict[str, Any]


def measure_errors(
    face: ReferenceFace,
    takes: Sequence[Take],
    parameters: Mapping[str, FaceParameters],
    lights: Mapping[str, npt.NDArray[np.float32]],
    samples: Samples,
) -> Errors:
    """Round-trip errors of each stage.

    Args:
        face: the model.
        takes: of one split.
        parameters: of each take by its name, as the model's modes give them.
        lights: of each take by its name.
        samples: pixels of some of the frames, as the videos have them.

    Returns:
        `shape` and `joint` have `points` (rms distance in eye distances) and `px` (the same in
        pixels of the video) over all frames; `appearance` and `joint` have `inner` and `outer`
        (`mae` and `rms` grey levels, 0 to 255) over the samples, `inner` over those that show it.
    """
    through_joint = {
        name: face.split(face.join(parts)) for name, parts in parameters.items()
        if any(take.name == name for take in takes)
    }  # fmt: skip
    return {
        "recordings": len(takes),
        "frames": int(sum(take.valid.sum() for take in takes)),
        "sampled_frames": len(samples.frames),
        "shape": _point_errors(face, takes, parameters),
        "appearance": _grey_errors(face, parameters, lights, samples),
        "joint": {
            **_point_errors(face, takes, through_joint),
            **_grey_errors(face, through_joint, lights, samples),
        },
    }


def _point_errors(
    face: ReferenceFace, takes: Sequence[Take], parameters: Mapping[str, FaceParameters]
) -> dict[str, float]:
    squares, square_pixels, count = 0.0, 0.0, 0
    for take in takes:
        ok = take.valid & np.isfinite(parameters[take.name].outer).all(axis=1)
        apart = face.points(parameters[take.name].shape[ok]) - take.shapes[ok]
        distances = np.square(apart, dtype=np.float64).sum(axis=-1)  # (T, 34)
        squares += distances.sum()
        square_pixels += (distances * np.square(take.unit[ok])[:, None]).sum()
        count += distances.size
    return {
        "points": round(float(np.sqrt(squares / max(count, 1))), DECIMALS),
        "px": round(float(np.sqrt(square_pixels / max(count, 1))), DECIMALS),
    }


def _grey_errors(
    face: ReferenceFace,
    parameters: Mapping[str, FaceParameters],
    lights: Mapping[str, npt.NDArray[np.float32]],
    samples: Samples,
) -> dict[str, dict[str, float]]:
    shown = {"inner": samples.visible, "outer": np.ones(len(samples.frames), bool)}
    return {region: _region_errors(face, region, parameters, lights, samples, shown[region])
            for region in REGIONS}  # fmt: skip


def _region_errors(
    face: ReferenceFace, region: str, parameters: Mapping[str, FaceParameters],
    lights: Mapping[str, npt.NDArray[np.float32]], samples: Samples,
    shown: npt.NDArray[np.bool_],
) -> dict[str, float]:  # fmt: skip
    appearance = getattr(face, region)
    chosen = np.flatnonzero(shown)
    absolute, squares, count = 0.0, 0.0, 0
    for first in range(0, len(chosen), _BATCH):
        batch = chosen[first : first + _BATCH]
        rows = [samples.frames[index] for index in batch]
        values = np.stack([getattr(parameters[t.name], region)[frame] for t, frame in rows])
        light = np.stack([lights[take.name] for take, _ in rows])[:, None]
        made = np.clip(appearance.pixels(values) * light, 0, 255)
        apart = (made - samples.pixels[region][batch]) @ LUMA
        absolute += float(np.abs(apart).sum(dtype=np.float64))
        squares += float(np.square(apart, dtype=np.float64).sum())
        count += apart.size
    if not count:
        return {}
    return {
        "mae": round(absolute / count, DECIMALS),
        "rms": round(float(np.sqrt(squares / count)), DECIMALS),
    }
