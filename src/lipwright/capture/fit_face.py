"""Fitting the reference face to the recordings of a dataset: Taylor et al. 2017, section 4.1.

Shape modes come from all frames of the train split, pixel modes from frames spread evenly over
it, joint modes from the parameters of all its frames. Errors are measured on the train split and
on the test split, which no mode has seen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.face_errors import measure_errors
from lipwright.capture.modes import Modes, find_modes
from lipwright.capture.pixels import Samples, lights_of, make_grids, sample_takes, take_parameters
from lipwright.capture.takes import Take
from lipwright.errors import LipwrightError
from lipwright.face.appearance import Appearance
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.vertices import REGIONS, N
from lipwright.face.warp import Grid

Report = Callable[[str, float], None]

MAX_PIXELS: Final = 40_000  # Taylor et al. 2017, section 4.1
PIXEL_MEMORY: Final = 1 << 30  # bytes of the pixels as float32; fewer frames are used beyond it
MOST_JOINT: Final = 1000  # modes; more than shape and two regions have
LEAST_FRAMES: Final = 50  # of the train split, and of those that show the inner mouth
ERROR_FRAMES: Final = 1000  # of each split on which grey levels are compared


@dataclass(frozen=True)
class FitOptions:
    """How a reference face is fitted.

    Raises:
        LipwrightError: an option is out of range.
    """

    shape_share: float = 0.99
    """of the shapes' variance; Taylor et al. 2017 keep 0.99"""
    pixel_share: float = 0.95
    """of the variance of each region's pixels"""
    joint_share: float = 0.99
    """of the variance of shape and pixel parameters together"""
    most_modes: int = 100
    """of a region, whatever the share: modes beyond are the camera's noise"""
    frames: int = 4000
    """from which pixel modes are found, at most"""
    pixels: int = MAX_PIXELS
    """samples of both regions together, at most; low-resolution video gives fewer"""

    def __post_init__(self) -> None:
        """Check."""
        for name in ("shape_share", "pixel_share", "joint_share"):
            if not 0 < getattr(self, name) <= 1:
                raise LipwrightError(f"{name} is {getattr(self, name)}; give a share above 0 to 1")
        for name, least in (("most_modes", 1), ("frames", LEAST_FRAMES), ("pixels", 500)):
            if getattr(self, name) < least:
                raise LipwrightError(f"{name} is {getattr(self, name)}; give {least} or more")


@dataclass(frozen=True, eq=False)
class FaceFit:
    """A reference face and the recordings it was fitted to."""

    face: ReferenceFace
    parameters: dict[str, FaceParameters]
    """recording to its parameters (T, ...), NaN where the face was lost"""
    lights: dict[str, npt.NDArray[np.float32]]
    """recording to its light (3,)"""


def fit_reference_face(
    takes: Sequence[Take], options: FitOptions | None = None, report: Report | None = None
) -> FaceFit:
    """The model, and what it makes of each take.

    The same takes and options give the same model.

    Raises:
        LipwrightError: too few frames, or a video cannot be read.
    """
    options, report = options or FitOptions(), report or (lambda stage, share: None)
    train, test = ([t for t in takes if t.split == split] for split in ("train", "test"))
    _check_frames(train)
    shape = find_modes(_all_shapes(train).reshape(-1, 2 * N), options.shape_share, 2 * N)
    grids = make_grids(train, shape.mean.reshape(N, 2), options.pixels)
    samples = sample_takes(
        train, grids, _frames_in_memory(options.frames, grids), lambda x: report("sample", x)
    )
    modes = _pixel_modes(samples, options, report)
    regions = {region: _appearance(grids[region], modes[region]) for region in REGIONS}
    parameters, lights = _project_takes(takes, shape, regions, report)
    face, joint = _join(train, parameters, shape, regions, options)
    errors = _errors(face, {"train": train, "test": test}, parameters, lights, samples, report)
    info = {
        "options": asdict(options),
        "modes": _mode_facts(shape, modes, joint),
        "frames": {"shape": len(_all_shapes(train)), "pixels": len(samples.frames),
                   "inner": int(samples.visible.sum())},
        "eye_distance_px": round(float(np.median(np.concatenate([t.unit[t.valid] for t in train]))),
                                 3),
        "errors": errors,
    }  # fmt: skip
    return FaceFit(replace(face, info=info), parameters, lights)


def _check_frames(train: Sequence[Take]) -> None:
    seen = int(sum(take.valid.sum() for take in train))
    shown = int(sum(take.visible.sum() for take in train))
    if seen < LEAST_FRAMES:
        raise LipwrightError(
            f"{seen} frames of the train split show a face; a reference face needs {LEAST_FRAMES}: "
            "capture more recordings"
        )
    if shown < LEAST_FRAMES:
        raise LipwrightError(
            f"{shown} frames of the train split show the inner mouth; a reference face needs "
            f"{LEAST_FRAMES}: capture more speech"
        )


def _all_shapes(takes: Sequence[Take]) -> npt.NDArray[np.float32]:
    return np.concatenate([take.shapes[take.valid] for take in takes])


def _frames_in_memory(most: int, grids: Mapping[str, Grid]) -> int:
    size = max(grid.count for grid in grids.values()) * 3 * 4
    return max(min(most, PIXEL_MEMORY // size), LEAST_FRAMES)


def _pixel_modes(samples: Samples, options: FitOptions, report: Report) -> dict[str, Modes]:
    found, lights = {}, lights_of(samples)
    light = np.stack([lights[take.name] for take, _ in samples.frames])
    for number, region in enumerate(REGIONS):
        report("modes", number / len(REGIONS))
        chosen = samples.visible if region == "inner" else np.ones(len(light), bool)
        pixels = samples.pixels[region][chosen] / light[chosen, None]
        rows = pixels.reshape(len(pixels), -1)
        found[region] = find_modes(rows, options.pixel_share, options.most_modes)
    report("modes", 1.0)
    return found


def _appearance(grid: Grid, modes: Modes) -> Appearance:
    # The file keeps half floats; parameters must be those of the modes that it gives back.
    rounded = modes.modes.astype(np.float16).astype(np.float32)
    pixels = (grid.count, 3)
    return Appearance(grid, modes.mean.reshape(pixels), rounded.reshape(-1, *pixels), modes.sd)


def _project_takes(
    takes: Sequence[Take], shape: Modes, regions: Mapping[str, Appearance], report: Report
) -> tuple[dict[str, FaceParameters], dict[str, npt.NDArray[np.float32]]]:
    """Name to the parameters of all frames, NaN where no face was seen, and to the light."""

    def project_shape(shapes: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        apart = shapes.reshape(len(shapes), -1) - shape.mean
        return np.asarray(apart @ shape.modes.T, np.float32)

    parameters, lights = {}, {}
    for number, take in enumerate(takes):
        report("project", number / len(takes))
        parameters[take.name], lights[take.name] = take_parameters(take, project_shape, regions)
    report("project", 1.0)
    return parameters, lights


def _join(
    train: Sequence[Take], parameters: Mapping[str, FaceParameters], shape: Modes,
    regions: Mapping[str, Appearance], options: FitOptions,
) -> tuple[ReferenceFace, Modes]:  # fmt: skip
    """Joint modes, equation 1, of all frames of the train split."""
    parts = [parameters[take.name] for take in train]
    rows = [np.concatenate([getattr(p, name) for p in parts])
            for name in ("shape", "inner", "outer")]  # fmt: skip
    known = np.isfinite(rows[2]).all(axis=1)
    of_shape, inner, outer = (row[known].astype(np.float64) for row in rows)
    # Cootes et al. 2001, section 3.3: the ratio of the total variances balances the two.
    grey = inner.var(axis=0).sum() + outer.var(axis=0).sum()
    weight = float(np.sqrt(grey / of_shape.var(axis=0).sum()))
    joint = find_modes(
        np.concatenate([weight * of_shape, inner, outer], axis=1),
        options.joint_share, MOST_JOINT,
    )  # fmt: skip
    depth = np.concatenate([take.points[take.valid][..., 2] for take in train]).mean(axis=0)
    face = ReferenceFace(
        mean_shape=shape.mean.reshape(N, 2), depth=depth,
        shape_modes=shape.modes.reshape(-1, N, 2), shape_sd=shape.sd,
        inner=regions["inner"], outer=regions["outer"], weight=weight,
        joint_mean=joint.mean, joint_modes=joint.modes, joint_sd=joint.sd,
    )  # fmt: skip
    return face, joint


def _errors(
    face: ReferenceFace, splits: Mapping[str, Sequence[Take]],
    parameters: Mapping[str, FaceParameters], lights: Mapping[str, npt.NDArray[np.float32]],
    samples: Samples, report: Report,
) -> dict[str, Any]:  # fmt: skip
    """Split to its errors; splits without recordings are left out."""
    grids = {region: getattr(face, region).grid for region in REGIONS}
    errors = {"train": measure_errors(face, splits["train"], parameters, lights,
                                      samples.every(ERROR_FRAMES))}  # fmt: skip
    if splits["test"]:
        unseen = sample_takes(splits["test"], grids, ERROR_FRAMES, lambda x: report("errors", x))
        errors["test"] = measure_errors(face, splits["test"], parameters, lights, unseen)
    return errors


def _mode_facts(shape: Modes, regions: Mapping[str, Modes], joint: Modes) -> dict[str, Any]:
    return {
        name: {"modes": len(found.modes), "share": round(found.share, 5),
               "variance": round(found.variance, 6)}
        for name, found in (("shape", shape), *regions.items(), ("joint", joint))
    }  # fmt: skip
