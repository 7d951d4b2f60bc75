"""Named points of our head's surface, and files that say where they are on another.

`head_landmarks.csv` gives each name three vertices of the head with their weights, and the number
of the face tracker's landmark that it is.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError
from lipwright.face.mesh import Mesh
from lipwright.face.surface import Surface

TABLE: Final = Path(__file__).with_name("head_landmarks.csv")
LEAST: Final = 4  # landmarks; fewer do not place a head
MOST_BYTES: Final = 4_000_000
HEADERS: Final = (("landmark", "vertex"), ("landmark", "x", "y", "z"))


@dataclass(frozen=True, eq=False)
class HeadPoint:
    """A point of the head's surface."""

    vertices: NDArray[np.int64]
    """(3,) of the head's V"""
    weights: NDArray[np.float64]
    """(3,), 1 in all"""
    tracker: int
    """the number of the face tracker's landmark"""


@cache
def named_points() -> Mapping[str, HeadPoint]:
    """Name to point, read once."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    found = {}
    for row in rows:
        weights = np.array([float(row[f"weight{k}"]) for k in (1, 2, 3)])
        vertices = np.array([int(row[f"vertex{k}"]) for k in (1, 2, 3)])
        found[row["landmark"]] = HeadPoint(vertices, weights / weights.sum(), int(row["tracker"]))
    return found


@dataclass(frozen=True, eq=False)
class LandmarkPairs:
    """L points of the head and where they are on a target.

    Raises:
        ValueError: there are fewer than four.
    """

    names: tuple[str, ...]
    vertices: NDArray[np.int64]
    """(L, 3) of the head's V"""
    weights: NDArray[np.float64]
    """(L, 3), in each row 1 in all"""
    points: NDArray[np.float64]
    """(L, 3) in the target's axes and unit"""

    def __post_init__(self) -> None:
        """Check."""
        if len(self.names) < LEAST:
            raise ValueError(
                f"{len(self.names)} landmarks do not place a head; give {LEAST} or more"
            )

    def on(self, vertices: NDArray[np.floating]) -> NDArray[np.float64]:
        """(L, 3), where the landmarks are on a head with `vertices` (V, 3)."""
        corners = np.asarray(vertices, np.float64)[self.vertices]
        return np.asarray((corners * self.weights[..., None]).sum(axis=1))


def pairs(head: Mesh, points: Mapping[str, NDArray[np.floating]]) -> LandmarkPairs:
    """Landmarks out of names, or numbers of head vertices, and points (3,) on the target.

    Raises:
        ValueError: a name is unknown, or there are fewer than four.
    """
    known = named_points()
    vertices, weights = [], []
    for name in points:
        if name in known:
            vertices.append(known[name].vertices)
            weights.append(known[name].weights)
        elif name.isdecimal() and int(name) < len(head.vertices):
            vertices.append(np.full(3, int(name)))
            weights.append(np.array([1.0, 0.0, 0.0]))
        else:
            raise ValueError(
                f"no landmark {name!r}; give a vertex of the head, or one of {', '.join(known)}"
            )
    shape = (-1, 3)
    return LandmarkPairs(
        tuple(points),
        np.reshape(np.array(vertices, np.int64), shape),
        np.reshape(np.array(weights, np.float64), shape),
        np.reshape(np.array(list(points.values()), np.float64), shape),
    )


def read_landmarks(path: str | os.PathLike[str], head: Mesh, target: Surface) -> LandmarkPairs:
    """The landmarks of a CSV file.

    Its first line is `landmark,vertex`, for vertices of the target's file, counted from 0, or
    `landmark,x,y,z`, for points in the target's unit. A landmark is a name of `named_points`, or
    a vertex of the head.

    Raises:
        LipwrightError: the file cannot be read, a row is wrong, or there are too few.
    """
    path = Path(path)
    try:
        if path.stat().st_size > MOST_BYTES:
            raise ValueError("too large for a list of landmarks")  # noqa: TRY301  # told below
        text = path.read_text("utf-8-sig")
        rows = list(csv.reader(text.splitlines()))
        header = tuple(field.strip() for field in rows[0]) if rows else ()
        if header not in HEADERS:
            raise ValueError(  # noqa: TRY301  # told below
                f"line 1: {','.join(header)!r} is neither 'landmark,vertex' nor 'landmark,x,y,z'"
            )
        points: dict[str, NDArray[np.float64]] = {}
        for number, row in enumerate(rows[1:], start=2):
            if not any(field.strip() for field in row):
                continue
            name, point = _row(row, len(header), number, target)
            if name in points:
                raise ValueError(f"line {number}: {name} stands twice")  # noqa: TRY301
            points[name] = point
        return pairs(head, points)
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise LipwrightError(f"{path}: not UTF-8 text") from error
    except (ValueError, csv.Error) as error:
        raise LipwrightError(f"{path}: {error}") from error


def _row(
    row: list[str], columns: int, number: int, target: Surface
) -> tuple[str, NDArray[np.float64]]:
    name, *fields = (field.strip() for field in row)
    if len(row) != columns:
        raise ValueError(f"line {number}: has {len(row)} columns, not {columns}")
    try:
        values = [float(field) for field in fields]
    except ValueError:
        raise ValueError(f"line {number}: {','.join(fields)!r} are not numbers") from None
    if not np.isfinite(values).all():
        raise ValueError(f"line {number}: {','.join(fields)!r} are not finite numbers")
    if columns > 2:
        return name, np.array(values)
    vertex = int(values[0])
    if vertex != values[0] or not 0 <= vertex < len(target.vertices):
        raise ValueError(f"line {number}: the target has no vertex {fields[0]} of 0 to "
                         f"{len(target.vertices) - 1}")  # fmt: skip
    return name, target.vertices[vertex]
