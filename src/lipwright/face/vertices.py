"""The 34 vertices of the reference face, on the lower face and jaw, and the triangles on them.

The number and the place are those of Taylor et al. 2017, figure 3a. Tables: `vertices34.csv`
(index, landmark of the tracker, name, region, index of the mirrored vertex) and
`triangles34.csv` (three indices and the region of pixels, clockwise in the picture). Left and right
are the character's own, so that what is named right stands at the left of a picture.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Final

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Vertex:
    """One of the 34."""

    index: int
    landmark: int
    """of the tracker's 478"""
    name: str
    region: str
    """outer lips, inner lips, jaw, chin or nostrils"""
    mirror: int
    """index of the vertex of the other side; its own in the middle"""


def _rows(name: str) -> list[dict[str, str]]:
    text = files("lipwright.face").joinpath(name).read_text("utf-8")
    return list(csv.DictReader(text.splitlines()))


def _frozen(values: Any) -> npt.NDArray[np.intp]:
    array = np.asarray(values, np.intp)
    array.setflags(write=False)
    return array


VERTICES: Final = tuple(
    Vertex(int(r["index"]), int(r["landmark"]), r["name"], r["region"], int(r["mirror"]))
    for r in _rows("vertices34.csv")
)
N: Final = len(VERTICES)
LANDMARKS: Final = _frozen([vertex.landmark for vertex in VERTICES])
"""(34,) landmarks of the tracker"""
MIRRORED: Final = _frozen([vertex.mirror for vertex in VERTICES])
"""(34,) the vertex of the other side"""

REGIONS: Final = ("inner", "outer")
"""of pixels: the inner mouth; the rest of the lower face"""
TRIANGLES: Final = {
    region: _frozen(
        [[int(r[k]) for k in "abc"] for r in _rows("triangles34.csv") if r["region"] == region]
    )
    for region in REGIONS
}
"""region of pixels to its triangles (n, 3), vertex indices"""


def indices(*landmarks: int) -> list[int]:
    """The vertices of the tracker's landmarks.

    Raises:
        ValueError: one of them is none of the 34.
    """
    return [LANDMARKS.tolist().index(landmark) for landmark in landmarks]


LIP_PAIRS: Final = _frozen([indices(13, 14), indices(82, 87), indices(312, 317)])
"""(3, 2) inner lips, upper and lower: where the aperture is measured"""

UPPER_INNER: Final = _frozen(indices(80, 82, 13, 312, 310))
"""(5,) the inner edge of the upper lip without its corners"""
LOWER_INNER: Final = _frozen(indices(88, 87, 14, 317, 318))
"""(5,) the vertices of the lower lip below those"""

_REGION_OF: Final = [vertex.region for vertex in VERTICES]


def _of(*regions: str) -> list[int]:
    return [index for index, region in enumerate(_REGION_OF) if region in regions]


OUTLINES: Final = (
    (*_of("outer lips"), 0),
    (*_of("inner lips"), _of("inner lips")[0]),
    tuple(_of("jaw", "chin")),
    tuple(_of("nostrils")),
)
"""rows of vertices that a drawing joins: the lips closed, jaw and nostrils open"""
HULL: Final = _frozen(_of("jaw", "chin", "nostrils"))
"""the vertices around the lower face, in order"""


def aperture(points: npt.NDArray[np.floating[Any]]) -> npt.NDArray[np.floating[Any]]:
    """(...,) mean distance of the inner-lip pairs of shapes (..., 34, 2), in their unit."""
    gaps = points[..., LIP_PAIRS[:, 0], :2] - points[..., LIP_PAIRS[:, 1], :2]
    return np.linalg.norm(gaps, axis=-1).mean(axis=-1)
