"""The pixels of takes, sampled at the mean shape, and the light that they were taken in.

Light and white balance differ from recording to recording, and no sentence tells them. So that
they do not pass for modes of speech, each recording has one light: red, green and blue of its skin
over those of the model's, by which its pixels are divided (compare the normalisation of Cootes et
al. 2001, section 2.2, which does so for each picture).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.takes import Take
from lipwright.face.appearance import Appearance
from lipwright.face.reference import FaceParameters
from lipwright.face.vertices import REGIONS, TRIANGLES, aperture
from lipwright.face.warp import Grid, opencv

Report = Callable[[float], None]
Bytes = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float32]

WIDE: Final = 95  # percentile of aperture at which the inner mouth gets a row for each of a pixel
MOST_ROWS: Final = 8.0  # times the rows of the mean shape, at most
_BATCH: Final = 50  # frames that are projected at a time
COARSE: Final = 1.5  # times the grid's pixels from which a picture is shrunk before it is sampled


@dataclass(frozen=True, eq=False)
class Samples:
    """The pixels of some frames."""

    pixels: Mapping[str, Bytes]
    """region to (n, P, 3)"""
    frames: Sequence[tuple[Take, int]]
    """n takes and frames of them"""

    @property
    def visible(self) -> npt.NDArray[np.bool_]:
        """(n,) whether the inner mouth is seen."""
        visible = {take.name: take.visible for take, _ in self.frames}
        return np.array([visible[take.name][frame] for take, frame in self.frames], bool)

    def every(self, most: int) -> Samples:
        """At most so many of them, evenly spread."""
        chosen = _spread(len(self.frames), most)
        pixels = {region: values[chosen] for region, values in self.pixels.items()}
        return Samples(pixels, [self.frames[index] for index in chosen])


def make_grids(
    takes: Sequence[Take], mean_shape: npt.NDArray[np.floating[Any]], most: int
) -> dict[str, Grid]:
    """A grid for each region with a sample a pixel of the usual frame, and at most `most` in all.

    The inner mouth is low at the mean shape, since the lips are often shut; it gets as many rows
    as a wide mouth has, or its teeth would be lost.
    """
    shapes = np.concatenate([take.shapes[take.valid] for take in takes])
    wide = float(np.percentile(aperture(shapes), WIDE))
    rows = min(max(wide / max(float(aperture(mean_shape)), 1e-6), 1.0), MOST_ROWS)
    scale = float(np.median(np.concatenate([take.unit[take.valid] for take in takes])))
    for _ in range(20):
        grids = {
            "inner": Grid(mean_shape, TRIANGLES["inner"], (scale, scale * rows)),
            "outer": Grid(mean_shape, TRIANGLES["outer"], (scale, scale)),
        }
        count = sum(grid.count for grid in grids.values())
        if count <= most:
            break
        scale *= 0.995 * math.sqrt(most / count)
    return grids


def _spread(count: int, most: int) -> npt.NDArray[np.intp]:
    """At most `most` of `count` indices, evenly spaced."""
    if count <= most:
        return np.arange(count)
    return ((np.arange(most) + 0.5) * count / most).astype(np.intp)


def sample_takes(
    takes: Sequence[Take], grids: Mapping[str, Grid], most: int, report: Report
) -> Samples:
    """The pixels of at most `most` frames, evenly spread over the frames with a face.

    Raises:
        LipwrightError: a video cannot be read.
    """
    places = [(take, frame) for take in takes for frame in np.flatnonzero(take.valid).tolist()]
    wanted: dict[str, set[int]] = {}
    for index in _spread(len(places), most):
        take, frame = places[index]
        wanted.setdefault(take.name, set()).add(frame)
    found: list[tuple[Take, int]] = []
    values: dict[str, list[Bytes]] = {region: [] for region in REGIONS}
    for number, take in enumerate(takes):
        report(number / len(takes))
        if take.name not in wanted:
            continue
        for frame, picture in take.pictures(wanted[take.name]):
            found.append((take, frame))
            for region, pixels in sample_frame(picture, take, frame, grids).items():
                values[region].append(pixels)
    report(1.0)
    return Samples(
        {
            region: np.array(values.pop(region), np.uint8).reshape(-1, grid.count, 3)
            for region, grid in grids.items()
        },
        found,
    )


def sample_frame(
    picture: Bytes, take: Take, frame: int, grids: Mapping[str, Grid]
) -> dict[str, Bytes]:
    """Region to pixels (P, 3) of one frame."""
    at, shrink = take.at[frame], float(take.unit[frame]) / grids["outer"].scale[0]
    if shrink > COARSE:
        cv2 = opencv()
        height, width = picture.shape[:2]
        small = max(round(width / shrink), 1), max(round(height / shrink), 1)
        picture = cv2.resize(picture, small, interpolation=cv2.INTER_AREA)
        at = at * np.array([small[0] / width, small[1] / height], np.float32)
    return {region: grid.sample(picture, at) for region, grid in grids.items()}


def take_parameters(
    take: Take, project_shape: Callable[[Floats], Floats], regions: Mapping[str, Appearance]
) -> tuple[FaceParameters, Floats]:
    """The parameters (T, ...) of all frames, NaN where no face was seen or read, and the light.

    Args:
        take: the recording.
        project_shape: shapes (T, 34, 2) to shape parameters (T, M).
        regions: the appearance of each.

    Raises:
        LipwrightError: the video cannot be read.
    """
    pixels, light = _project_pixels(take, regions)
    missing = ~np.isfinite(pixels["outer"]).all(axis=1)
    parts = {
        "shape": np.array(project_shape(take.shapes), np.float32),
        "inner": fill_inner(pixels["inner"], take.visible & ~missing),
        "outer": pixels["outer"],
    }
    for part in parts.values():
        part[missing] = np.nan
    return FaceParameters(**parts), light


def _project_pixels(
    take: Take, regions: Mapping[str, Appearance]
) -> tuple[dict[str, Floats], Floats]:
    """Region to parameters (T, n), and the light (3,)."""
    grids = {region: appearance.grid for region, appearance in regions.items()}
    # Projection is linear: red, green and blue are projected apart, and put together in the end,
    # when the light of the whole recording is known.
    channels: dict[str, Floats] = {
        region: np.full((len(take), len(appearance), 3), np.nan, np.float32)
        for region, appearance in regions.items()
    }
    colours = np.full((len(take), 3), np.nan, np.float32)
    pictures = take.pictures()
    while batch := list(islice(pictures, _BATCH)):
        frames = [frame for frame, _ in batch]
        samples = [sample_frame(picture, take, frame, grids) for frame, picture in batch]
        for region, appearance in regions.items():
            pixels = np.stack([sample[region] for sample in samples]).astype(np.float32)
            channels[region][frames] = appearance.project_channels(pixels)
            if region == "outer":
                colours[frames] = pixels.mean(axis=1)
    light = light_of(colours, regions["outer"].mean.mean(axis=0))
    return {
        region: (channels[region] / light).sum(axis=-1) - appearance.mean_parameters
        for region, appearance in regions.items()
    }, light


def light_of(colours: Floats, model: Floats) -> Floats:
    """The light (3,) of a recording with mean colours (T, 3), NaN where lost, against (3,)."""
    known = np.isfinite(colours).all(axis=1)
    if not known.any():
        return np.ones(3, np.float32)
    return np.asarray(np.maximum(colours[known].mean(axis=0), 1) / np.maximum(model, 1), np.float32)


def lights_of(samples: Samples) -> dict[str, Floats]:
    """Recording to its light (3,), against the mean of all samples."""
    colours = samples.pixels["outer"].mean(axis=1, dtype=np.float32)
    of_take: dict[str, list[Floats]] = {}
    for (take, _), colour in zip(samples.frames, colours, strict=True):
        of_take.setdefault(take.name, []).append(colour)
    model = colours.mean(axis=0)
    return {name: light_of(np.stack(values), model) for name, values in of_take.items()}


def fill_inner(inner: Floats, visible: npt.NDArray[np.bool_]) -> Floats:
    """Parameters (T, n1) of the inner mouth, those of frames that do not show it interpolated.

    In time, between the frames that show it, and held before the first and after the last; the
    mean where none does.
    """
    seen = np.flatnonzero(visible & np.isfinite(inner).all(axis=1))
    if not len(seen):
        return np.zeros_like(inner)
    frames = np.arange(len(inner))
    columns = [np.interp(frames, seen, inner[seen, column]) for column in range(inner.shape[1])]
    return np.stack(columns, axis=1).astype(np.float32)
