"""A z-buffer rasteriser on numpy arrays.

It answers only which triangle is seen where; whoever asks does the shading. Coordinates are
interpolated without perspective, which small triangles far from the camera do not need.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]


def rasterise(
    points: Floats, triangles: Integers, width: int, height: int
) -> tuple[Integers, Integers]:
    """Which triangle is in front at the centre of each pixel.

    Args:
        points: (V, 3) x and y in pixels from the top left corner, and depth, smaller in front.
        triangles: (N, 3); both windings are drawn.
        width: of the picture in pixels.
        height: of the picture in pixels.

    Returns:
        The n covered pixels: their places (n,) in reading order and their triangles (n,).
    """
    corners = points[triangles]
    triangle, row = _rows(corners[:, :, 1], height)
    first, counts = _spans(corners, triangle, row, width)
    some = np.flatnonzero(counts)
    triangle, row, first, counts = triangle[some], row[some], first[some], counts[some]
    planes = _planes(corners)
    slope = planes[6, triangle]
    start = slope * _centres(first) + planes[7, triangle] * _centres(row) + planes[8, triangle]
    steps = np.arange(counts.sum(), dtype=np.int32)
    steps -= np.repeat((np.cumsum(counts) - counts).astype(np.int32), counts)
    place = np.repeat(row * width + first, counts) + steps
    depth = np.repeat(start, counts) + np.repeat(slope, counts) * steps.astype(np.float32)
    nearest = np.full(width * height, np.inf, np.float32)
    np.minimum.at(nearest, place, depth)
    front = np.flatnonzero(depth <= nearest[place]).astype(np.int32)
    winner = np.full(width * height, -1, np.int32)
    winner[place[front]] = np.repeat(triangle, counts)[front]
    covered = np.flatnonzero(winner >= 0).astype(np.int32)
    return covered, winner[covered]


def barycentric(
    points: Floats, triangles: Integers, places: Integers, chosen: Integers, width: int
) -> Floats:
    """Where in its triangle each pixel is: the shares (n, 3) of the three corners.

    Args:
        points: as for `rasterise`.
        triangles: as for `rasterise`.
        places: (n,) of pixels in reading order.
        chosen: (n,) the triangle at each.
        width: of the picture in pixels.
    """
    planes = _planes(points[triangles])
    x, y = _centres(places % width), _centres(places // width)
    second = planes[0, chosen] * x + planes[1, chosen] * y + planes[2, chosen]
    third = planes[3, chosen] * x + planes[4, chosen] * y + planes[5, chosen]
    return np.stack([1 - second - third, second, third], axis=1)


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


def _spans(
    corners: Floats, triangle: Integers, row: Integers, width: int
) -> tuple[Integers, Integers]:
    """The first column of each triangle in each of its rows, and how many columns follow."""
    y = _centres(row)
    left: NDArray[Any] = np.full(len(row), np.inf, np.float32)
    right: NDArray[Any] = np.full(len(row), -np.inf, np.float32)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        (ax, ay, _), (bx, by, _) = corners[:, a].T, corners[:, b].T
        rise = by - ay
        slope = (bx - ax) / np.where(rise == 0, 1, rise)
        ay, by, x = ay[triangle], by[triangle], ax[triangle]
        x = x + (y - ay) * slope[triangle]
        crossed = (ay <= y) != (by <= y)
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    empty = left > right
    first = np.clip(np.ceil(np.where(empty, 0, left) - 0.5), 0, width).astype(np.int32)
    last = np.clip(np.ceil(np.where(empty, 0, right) - 0.5), 0, width).astype(np.int32)
    return first, np.maximum(last - first, 0)


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
