"""Pictures of a reference face: its modes, as in Taylor et al. 2017, figure 3, and its vertices."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.errors import MissingExtraError
from lipwright.face.reference import FaceParameters, ReferenceFace
from lipwright.face.vertices import OUTLINES, VERTICES
from lipwright.face.warp import opencv
from lipwright.files import write_whole

SIGMAS: Final = (-3.0, 0.0, 3.0)
ZOOM: Final = 160  # px an eye distance
MARGIN: Final = 0.12  # eye distances around a drawn face
EDGE: Final = 0.1  # eye distances over which a face passes into the page
PAGE: Final = 255  # white
REGION_COLOURS: Final = {
    "outer lips": "#c0392b", "inner lips": "#8e44ad", "jaw": "#1f618d", "chin": "#117864",
    "nostrils": "#b9770e",
}  # fmt: skip


def draw_face(face: ReferenceFace, parameters: FaceParameters) -> npt.NDArray[np.uint8]:
    """One frame on white, (H, W, 3); the same size for all frames of a model."""
    low, high = _box(face)
    size = tuple(int(side) for side in np.ceil((high - low) * ZOOM))
    points = (face.points(parameters.shape) - low) * ZOOM
    drawn, covered = face.draw(parameters, points, (size[0], size[1]))
    inwards = opencv().distanceTransform(covered.astype(np.uint8), opencv().DIST_L2, 5)
    share = np.clip(inwards / (EDGE * ZOOM), 0, 1)[..., None]
    return np.asarray(np.rint(share * drawn + (1 - share) * PAGE), np.uint8)


def _box(face: ReferenceFace) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Corners of a box around the faces of the first modes."""
    shapes = [face.points(face.pose(0, sigma, "shape").shape) for sigma in SIGMAS]
    return np.min(shapes, axis=(0, 1)) - MARGIN, np.max(shapes, axis=(0, 1)) + MARGIN


def _figure(width: float, height: float) -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("matplotlib, which draws the modes,", "capture") from error
    return Figure(figsize=(width, height), layout="constrained")


def _save(figure: Any, path: Path) -> None:
    with write_whole(path) as part:
        figure.savefig(part, format="png", dpi=100, metadata={"Software": None})


def write_modes(path: Path, face: ReferenceFace, count: int = 3) -> None:
    """A picture of the first shape modes as outlines and the first joint modes as faces.

    Raises:
        LipwrightError: the file cannot be written.
    """
    count = min(count, len(face.shape_modes), len(face.joint_modes))
    figure = _figure(2.2 * 2 * len(SIGMAS), 1.75 * count)
    axes = figure.subplots(count, 2 * len(SIGMAS), squeeze=False)
    for mode in range(count):
        for column, sigma in enumerate(SIGMAS):
            shown = f"{mode + 1}, {sigma:+.0f} sd" if sigma else f"{mode + 1}, mean"
            left, right = axes[mode, column], axes[mode, column + len(SIGMAS)]
            _draw_outline(left, face, face.points(face.pose(mode, sigma, "shape").shape))
            left.set_title(f"shape {shown}", fontsize=8)
            right.imshow(draw_face(face, face.pose(mode, sigma)))
            right.set_axis_off()
            right.set_title(f"joint {shown}", fontsize=8)
    _save(figure, path)


def _draw_outline(axes: Any, face: ReferenceFace, points: npt.NDArray[Any]) -> None:
    low, high = _box(face)
    for outline in OUTLINES:
        axes.plot(*points[list(outline)].T, color="#555555", linewidth=0.8)
    colours = [REGION_COLOURS[vertex.region] for vertex in VERTICES]
    axes.scatter(*points.T, s=5, c=colours, zorder=3)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(high[1], low[1])
    axes.set_aspect("equal")
    axes.set_axis_off()


def write_vertices(path: Path, face: ReferenceFace) -> None:
    """A picture of the 34 vertices with their numbers, on a face with open lips.

    Raises:
        LipwrightError: the file cannot be written.
    """
    parameters = face.pose(0, 2.5)
    points = (face.points(parameters.shape) - _box(face)[0]) * ZOOM
    figure = _figure(9, 5.6)
    axes = figure.subplots()
    axes.imshow(draw_face(face, parameters), alpha=0.6)
    for outline in OUTLINES:
        axes.plot(*points[list(outline)].T, color="#555555", linewidth=0.8)
    middle = points.mean(axis=0)
    for vertex, (x, y) in zip(VERTICES, points, strict=True):
        colour = REGION_COLOURS[vertex.region]
        axes.plot(x, y, "o", color=colour, markersize=4)
        inwards = vertex.region == "inner lips"
        shift = (7 if not inwards else -8) * (1 if y > middle[1] else -1)
        axes.annotate(str(vertex.index), (x, y), (0, -shift), textcoords="offset points",
                      ha="center", va="center", fontsize=8, color=colour)  # fmt: skip
    axes.set_axis_off()
    _save(figure, path)
