"""Piecewise-affine warps between a shape of 34 vertices and pictures.

Picture coordinates have x to the right and y down, with the first pixel from 0 to 1, so that its
middle is at 0.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from lipwright.errors import MissingExtraError
from lipwright.face.vertices import N

Points = npt.NDArray[np.floating[Any]]
Pixels = npt.NDArray[np.uint8]
_OUTSIDE = -1
_MARGIN = 1  # px that a grid is wider than its triangles, on each side
_SLACK = 1e-6  # of a barycentric weight: pixels on an edge belong to a triangle


def opencv() -> Any:
    """OpenCV.

    Raises:
        MissingExtraError: it is not installed.
    """
    try:
        import cv2
    except ImportError as error:
        raise MissingExtraError("OpenCV, which warps pictures,", "capture") from error
    return cv2


def rasterise(
    points: Points, triangles: npt.NDArray[np.intp], size: tuple[int, int]
) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.float32]]:
    """Which triangle covers the middle of each pixel, and where in it that lies.

    Triangles that are turned over (lips that cross) cover nothing.

    Args:
        points: (34, 2) in pixels.
        triangles: (n, 3), clockwise in the picture.
        size: width and height of the picture.

    Returns:
        (H, W) indices of triangles, -1 outside; (H, W, 3) barycentric weights, 0 outside.
    """
    width, height = size
    index = np.full((height, width), _OUTSIDE, np.int16)
    weights = np.zeros((height, width, 3), np.float32)
    for number, triangle in enumerate(triangles):
        corners = np.asarray(points[triangle], np.float64)
        (ax, ay), (bx, by), (cx, cy) = corners
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if not area > _SLACK:  # NaN too
            continue
        left, top = np.maximum(np.floor(corners.min(0) - 0.5), 0).astype(int)
        right, bottom = np.minimum(np.ceil(corners.max(0) + 0.5), size).astype(int)
        if left >= right or top >= bottom:
            continue
        x, y = np.arange(left, right) + 0.5, np.arange(top, bottom)[:, None] + 0.5
        b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        inside = np.stack([1 - b - c, b, c], axis=-1)
        hit = (inside >= -_SLACK).all(axis=-1)
        index[top:bottom, left:right][hit] = number
        weights[top:bottom, left:right][hit] = inside[hit]
    return index, weights


@dataclass(frozen=True, eq=False)
class Grid:
    """Pixels sampled over some triangles of a shape: the places that an appearance is made of.

    Raises:
        ValueError: a scale or size is not positive, or no pixel lies in the triangles.
    """

    shape: Points
    """(34, 2) eye distances, the shape that is sampled"""
    triangles: npt.NDArray[np.intp]
    """(n, 3) vertex indices"""
    scale: tuple[float, float]
    """pixels an eye distance, across and down"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        shape = np.array(self.shape, np.float64)
        if shape.shape != (N, 2) or not np.isfinite(shape).all():
            raise ValueError(f"the sampled shape is {shape.shape}, not ({N}, 2) finite numbers")
        if not all(0 < side < 1e4 for side in self.scale):
            raise ValueError(f"a scale of {self.scale} pixels an eye distance")
        shape.setflags(write=False)
        object.__setattr__(self, "shape", shape)
        if not self.count:
            raise ValueError("no pixel lies in the triangles")

    @cached_property
    def origin(self) -> npt.NDArray[np.float64]:
        """(2,) eye distances, the outer corner of the first pixel."""
        corner = self.shape[np.unique(self.triangles)].min(0)
        return np.asarray(corner - _MARGIN / np.asarray(self.scale))

    @cached_property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        far = self.to_pixels(self.shape)[np.unique(self.triangles)].max(0)
        width, height = (int(side) for side in np.ceil(far + _MARGIN))
        return width, height

    def to_pixels(self, points: Points) -> Points:
        """Points in eye distances as points in this grid's picture."""
        return np.asarray((points - self.origin) * np.asarray(self.scale))

    @cached_property
    def _raster(self) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.float32]]:
        return rasterise(self.to_pixels(self.shape), self.triangles, self.size)

    @cached_property
    def mask(self) -> npt.NDArray[np.bool_]:
        """(H, W), the P pixels that lie in the triangles."""
        return np.asarray(self._raster[0] != _OUTSIDE)

    @cached_property
    def count(self) -> int:
        """The number of pixels, P."""
        return int(self.mask.sum())

    @cached_property
    def _weights(self) -> npt.NDArray[np.float32]:
        """(P, 34), how each pixel's place hangs on the vertices."""
        index, weights = self._raster
        matrix = np.zeros((self.count, N), np.float32)
        corners = self.triangles[index[self.mask]]
        np.put_along_axis(matrix, corners, weights[self.mask], axis=1)
        return matrix

    @cached_property
    def _nearest(self) -> npt.NDArray[np.intp]:
        """(H, W), the number of the pixel of the mask that is nearest."""
        from scipy.ndimage import distance_transform_edt

        numbers = np.zeros(self.mask.shape, np.intp)
        numbers[self.mask] = np.arange(self.count)
        rows, columns = distance_transform_edt(
            ~self.mask, return_distances=False, return_indices=True
        )
        return np.asarray(numbers[rows, columns])

    def sample(self, picture: Pixels, points: Points) -> Pixels:
        """The pixels (P, 3) of a face whose vertices are at `points` (34, 2) of `picture`."""
        places = self._weights @ np.asarray(points, np.float32) - np.float32(0.5)
        cv2 = opencv()  # cubic: pixels pass through two warps, which blur less so
        # remap takes no more than 32,767 rows or columns; a few long rows do.
        rows = -(-len(places) // 1024)
        padded = np.resize(places, (rows * 1024, 2)).reshape(rows, 1024, 2)
        found = cv2.remap(picture, padded, None, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(found.reshape(-1, 3)[: len(places)])

    def picture(self, pixels: Points) -> npt.NDArray[np.float32]:
        """(H, W, 3), the pixels (P, 3) in their places, and beyond them the nearest."""
        return np.asarray(pixels, np.float32)[self._nearest]

    def paint(self, canvas: npt.NDArray[np.float32], points: Points, pixels: Points) -> None:
        """Draw the pixels (P, 3) on `canvas` (H', W', 3), with the vertices at `points` (34, 2)."""
        height, width = canvas.shape[:2]
        index, weights = rasterise(points, self.triangles, (width, height))
        covered = index != _OUTSIDE
        if not covered.any():
            return
        corners = self.to_pixels(self.shape).astype(np.float32)[self.triangles[index[covered]]]
        places = np.full((height, width, 2), -1, np.float32)
        places[covered] = np.einsum("pk,pkd->pd", weights[covered], corners) - np.float32(0.5)
        cv2 = opencv()
        drawn = cv2.remap(
            self.picture(pixels), places, None, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
        )
        canvas[covered] = drawn[covered]
