"""A z-buffer rasteriser on numpy arrays.

It answers only which triangle is seen where; whoever asks does the shading. Coordinates are
interpolated without perspective, which small triangles far from the camera do not need.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]


def rasterise(
    points: Floats, triangles: Integers, width: int, height: int
) -> tuple[Integers, Integers, Floats]:
    """Which triangle is in front at the centre of each pixel, and where in it.

    Args:
        points: (V, 3) x and y in pixels from the top left corner, and depth, smaller in front.
        triangles: (N, 3); both windings are drawn.
        width: of the picture in pixels.
        height: of the picture in pixels.

    Returns:
        For the n covered pixels: their places (n,) in reading order, their triangles (n,) and
        barycentric coordinates (n, 3).
    """
    corners = points[triangles]
    triangle, row = _rows(corners[:, :, 1], height)
    triangle, row, column = _pixels(corners, triangle, row, width)
    planes = _planes(corners)
    x, y = _centres(column), _centres(row)
    place = row * width + column
    at = planes[:, triangle]
    depth = at[6] * x + at[7] * y + at[8]
    nearest = np.full(width * height, np.inf, np.float32)
    np.minimum.at(nearest, place, depth)
    front = np.flatnonzero(depth <= nearest[place])
    winner = np.full(width * height, -1, np.int32)
    winner[place[front]] = front
    covered = np.flatnonzero(winner >= 0).astype(np.int32)
    chosen = winner[covered]
    at, x, y = at[:, chosen], x[chosen], y[chosen]
    second = at[0] * x + at[1] * y + at[2]
    third = at[3] * x + at[4] * y + at[5]
    shares = np.stack([1 - second - third, second, third], axis=1)
    return covered, triangle[chosen], shares


def _centres(numbers: Integers) -> Floats:
    return numbers.astype(np.float32) + np.float32(0.5)


def _rows(heights: Floats, height: int) -> tuple[Integers, Integers]:
    """Each triangle with each row of pixels whose centre it crosses."""
    first = np.clip(np.ceil(heights.min(axis=1) - 0.5), 0, height).astype(np.int32)
    last = np.clip(np.ceil(heights.max(axis=1) - 0.5), 0, height).astype(np.int32)
    return _runs(first, last - first)


def _runs(first: Integers, counts: Integers) -> tuple[Integers, Integers]:
    """The numbers of the runs, each as often as it is long, and `first`, first + 1, ..."""
    owner = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    starts = (np.cumsum(counts) - counts).astype(np.int32)
    return owner, np.arange(len(owner), dtype=np.int32) + (first - starts)[owner]


def _pixels(
    corners: Floats, triangle: Integers, row: Integers, width: int
) -> tuple[Integers, Integers, Integers]:
    """Triangle, row and column of every pixel whose centre lies in a triangle."""
    y = _centres(row)
    left = np.full(len(row), np.inf, np.float32)
    right = np.full(len(row), -np.inf, np.float32)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        start, end = corners[triangle, a], corners[triangle, b]
        crossed = (start[:, 1] <= y) != (end[:, 1] <= y)
        rise = np.where(crossed, end[:, 1] - start[:, 1], 1)
        x = start[:, 0] + (y - start[:, 1]) / rise * (end[:, 0] - start[:, 0])
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    left = np.where(left > right, 0, left)
    right = np.maximum(right, left)
    first = np.clip(np.ceil(left - 0.5), 0, width).astype(np.int32)
    last = np.clip(np.ceil(right - 0.5), 0, width).astype(np.int32)
    span, column = _runs(first, last - first)
    return triangle[span], row[span], column


def _planes(corners: Floats) -> Floats:
    """(9, N): second and third barycentric coordinate and depth as a x + b y + c."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (corners[:, k].T for k in range(3))
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    inverse = 1 / np.where(area == 0, 1, area)
    second = np.stack([cy - ay, ax - cx, -(cy - ay) * ax - (ax - cx) * ay]) * inverse
    third = np.stack([ay - by, bx - ax, -(ay - by) * ax - (bx - ax) * ay]) * inverse
    depth = second * (bz - az) + third * (cz - az)
    depth[2] += az
    return np.concatenate([second, third, depth])
