"""Which points of the head's surface the tracker's landmarks are.

`landmarks_on_head.csv` holds, for each of the 478 landmarks, three vertices of the head, their
weights and a region of the face; `bench/map_landmarks.py` makes it.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT
from lipwright.dataset.recording import LANDMARKS
from lipwright.face.head import Head

TABLE: Final = Path(__file__).with_name("landmarks_on_head.csv")

REGIONS: Final = (
    "brows", "cheeks", "eyes", "forehead", "irises", "jaw", "lids", "lips inner", "lips middle",
    "lips outer", "nose",
)  # fmt: skip

# From the head's axes (y up, z forward) to those of landmarks (y down, z away from the camera).
_TO_PICTURE: Final = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Correspondence:
    """The landmarks as points of the head's surface."""

    vertices: npt.NDArray[np.int64]
    """(478, 3) of the head's V"""
    weights: npt.NDArray[np.float64]
    """(478, 3), 0 to 1, in each row 1 in all"""
    regions: tuple[str, ...]
    """(478,) of `REGIONS`"""

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        self.vertices.setflags(write=False)
        self.weights.setflags(write=False)


@cache
def correspondence() -> Correspondence:
    """The table, read once."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    vertices = np.array([[int(row[f"vertex{k}"]) for k in (1, 2, 3)] for row in rows])
    weights = np.array([[float(row[f"weight{k}"]) for k in (1, 2, 3)] for row in rows])
    if len(rows) != LANDMARKS:
        raise ValueError(f"{TABLE.name} has {len(rows)} rows, not {LANDMARKS}")
    return Correspondence(
        vertices, weights / weights.sum(axis=1, keepdims=True), tuple(row["region"] for row in rows)
    )


def landmark_points(vertices: npt.NDArray[np.floating]) -> npt.NDArray[np.float64]:
    """(..., 478, 3) m, where the landmarks of the posed `vertices` (..., V, 3) are."""
    table = correspondence()
    corners = np.asarray(vertices, np.float64)[..., table.vertices, :]
    return np.asarray((corners * table.weights[..., None]).sum(axis=-2))


def landmark_shapes(head: Head) -> npt.NDArray[np.float64]:
    """(52, 478, 3), how far each of `ARKIT` moves the landmarks at weight 1.

    In the axes and unit of landmarks: eye distances, x to the right in the picture, y down, z
    away from the camera.
    """
    table = correspondence()
    shapes = np.zeros((len(ARKIT), LANDMARKS, 3))
    for index, name in enumerate(ARKIT):
        moves = np.zeros((len(head.vertices), 3))
        moved, by = head.shape(name)
        moves[moved] = by
        shapes[index] = (moves[table.vertices] * table.weights[..., None]).sum(axis=1)
    return shapes * _TO_PICTURE / head.eye_distance
