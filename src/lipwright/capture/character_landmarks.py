"""Landmarks of a character without anyone's help: the face tracker looks at its picture.

The character must look somewhat human, stand upright (y up) and face along z, as glTF has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.tracker import Tracker
from lipwright.errors import LipwrightError
from lipwright.face.head_landmarks import named_points, pairs
from lipwright.face.mesh import Mesh
from lipwright.face.render import Renderer
from lipwright.face.shading import Camera
from lipwright.face.surface import Surface
from lipwright.face.target_mesh import character
from lipwright.face.transfer import best_similarity

Floats = npt.NDArray[np.float64]

SIDE: Final = 768  # px
FIELD_DEG: Final = 14.0  # of view, vertically
TALL_M: Final = 0.30  # what is looked at is drawn as large as a head
FAR: Final = 0.35  # spreads of the landmarks that one may be from where our head has it
TOPS: Final = (1.0, 0.5, 0.28, 0.16)  # shares of the character's height that may be its head


def find_landmarks(surface: Surface, head: Mesh) -> Mapping[str, Floats]:
    """Name to point (3,), for the landmarks of `named_points` that lie on the surface.

    Raises:
        LipwrightError: no face is seen, or too little of one.
        MissingExtraError: the tracker is not installed.
    """
    best: tuple[float, Floats, Floats, float] | None = None
    tracker = Tracker()
    for share in TOPS:
        middle, scale = _framing(surface, share)
        with Renderer(_drawn(surface, middle, scale), SIDE, SIDE, view=_camera()) as renderer:
            picture = renderer.render(np.zeros(0))
        faces = tracker.track_frame(picture)
        if len(faces) == 1:
            places = np.asarray(faces[0][:, :2], float)
            size = float(np.ptp(places[:, 1]))
            if best is None or size > best[0]:
                best = size, places, middle, scale
    if best is None:
        raise LipwrightError(
            "no face is seen in the mesh; it must stand upright (y up) and face along z; or give "
            "--landmarks"
        )
    _, places, middle, scale = best
    vertices = (surface.vertices - middle) * scale
    found = {}
    for name, point in named_points().items():
        hit = _cast(vertices, surface.triangles, places[point.tracker] / SIDE)
        if hit is not None:
            found[name] = hit / scale + middle
    try:
        return _plausible(found, head)
    except ValueError as error:  # too few landmarks, or all on a line
        raise LipwrightError(
            f"too little of a face is seen in the mesh ({error}); give --landmarks"
        ) from error


def _plausible(found: Mapping[str, Floats], head: Mesh) -> Mapping[str, Floats]:
    """Without those that are far from where a head's would be: looked at through a gap."""
    while True:
        marks = pairs(head, found)
        ours = marks.on(head.vertices)
        placed = best_similarity(ours, marks.points, np.ones(len(ours))).apply(ours)
        far = np.linalg.norm(placed - marks.points, axis=1)
        spread = np.linalg.norm(placed - placed.mean(axis=0), axis=1).mean()
        if far.max() < FAR * spread:
            return found
        worst = marks.names[int(np.argmax(far))]
        found = {name: point for name, point in found.items() if name != worst}


def _framing(surface: Surface, share: float) -> tuple[Floats, float]:
    """The middle of the upper `share` of the character, and how it is scaled to be drawn."""
    used = surface.vertices[np.unique(surface.triangles)]
    low, high = used.min(axis=0), used.max(axis=0)
    tall = (high[1] - low[1]) * share
    top = used[used[:, 1] > high[1] - tall]
    middle = (top.min(axis=0) + top.max(axis=0)) / 2
    middle[0] = np.median(top[:, 0])
    return np.asarray(middle), TALL_M / float(tall)


def _drawn(surface: Surface, middle: Floats, scale: float) -> Mesh:
    moved = Surface((surface.vertices - middle) * scale, surface.triangles, surface.welds)
    return character(moved)


def _camera() -> Camera:
    distance = TALL_M * 0.6 / np.tan(np.radians(FIELD_DEG) / 2)
    return Camera((0.0, 0.0, float(distance)), (0.0, 0.0, 0.0), FIELD_DEG)


def _cast(vertices: Floats, triangles: npt.NDArray[np.int64], place: Floats) -> Floats | None:
    """The front-most point (3,) at `place` (2,) of the picture, in shares of its side."""
    clip = np.c_[vertices, np.ones(len(vertices))] @ _camera().matrix(1.0).T
    depth = clip[:, 3]
    screen = np.stack([clip[:, 0] / depth + 1, 1 - clip[:, 1] / depth], axis=1) / 2
    a, b, c = (screen[triangles[:, k]] - place for k in range(3))
    weights = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=1)
    area = weights.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = weights / area[:, None]
    hit = (weights >= -1e-9).all(axis=1) & (area < 0)  # those seen from outside; y runs down
    if not hit.any():
        return None
    rows = np.flatnonzero(hit)
    far = (weights[rows] * depth[triangles[rows]]).sum(axis=1)
    best = rows[np.argmin(far)]
    # Shares on the screen are not those in space.
    true = weights[best] / depth[triangles[best]]
    return np.asarray((true / true.sum()) @ vertices[triangles[best]])


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
