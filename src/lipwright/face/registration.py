"""Registration: our head bent to the shape of another, and which triangles belong together.

Landmarks place the head (turn, scale, shift) and bend space around it. Then its skin is drawn to
the closest points of the target that face the same way, and its motion is kept smooth: iterated
closest points under a thin-plate stiffness that falls from round to round, as in Amberg et al.
2007, "Optimal Step Nonrigid ICP Algorithms for Surface Registration". Of what is inside, the eyes,
teeth and tongue, the head's own go where the skin around them goes. Partners are then the closest
triangles that face the same way (Sumner and Popovic 2004, section 4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError
from lipwright.face.closest import Finder
from lipwright.face.contacts import Contacts, lip_contacts
from lipwright.face.gradients import surface_gradient
from lipwright.face.head import Head
from lipwright.face.head_landmarks import LandmarkPairs
from lipwright.face.pairing import find_partners
from lipwright.face.partners import Partners
from lipwright.face.surface import Surface, mesh_surface
from lipwright.face.transfer import best_similarity, factorised

Floats = NDArray[np.float64]

SKIN: Final = "skin"
FACE: Final = (SKIN, "mouth")
"""the parts of the head that are one surface"""
WORN: Final = frozenset(("shirt",))
"""parts of the head that are none of it"""

# The length under which bends are smoothed away, in spreads of the landmarks (their distance from
# their middle, about 6 cm), in rounds from stiff to soft; and how often each is repeated.
STIFFNESS: Final = tuple(np.geomspace(0.8, 0.07, 9))
REPEATS: Final = 2
REACH: Final = (0.8, 0.15)  # spreads: how far the target may be, in the first and the last round
FACING: Final = 0.5  # cosine between the normals of points that may meet
LANDMARK_PULL: Final = (0.5, 0.02)  # of a landmark, against the whole skin, first and last round
CARRIED_BY: Final = 40  # points of the skin that carry a point beneath it


@dataclass(frozen=True, eq=False)
class Registration:
    """Our head in the shape of a target."""

    source: Surface
    """our head at rest, without what it wears"""
    placed: Floats
    """(P, 3), the places of `source` bent to the target, in its axes and unit"""
    partners: Partners
    contacts: Contacts
    mean_distance: float
    """of the skin that found a place on the target, in the target's unit"""
    worst_distance: float
    """the same, the 95th percentile"""
    landmark_distance: float
    """from the landmarks' places to where the head's ended up, mean, in the target's unit"""
    scale: float
    """how much larger the target is than the head, in its own unit"""
    covered: float
    """share of the head's skin that found a place on the target"""


def register(mesh: Head, target: Surface, landmarks: LandmarkPairs) -> Registration:
    """Bend our head to a target, and pair their triangles.

    Args:
        mesh: our head, with the parts skin and mouth.
        target: of any topology; whole bodies and masks of a face too.
        landmarks: the more around the mouth, the better.

    Raises:
        LipwrightError: the landmarks lie on a line, or the head lands nowhere on the target.
    """
    source = mesh_surface(mesh, [p.name for p in mesh.parts if p.name not in WORN])
    try:
        start = best_similarity(
            landmarks.on(mesh.vertices), landmarks.points, np.ones(len(landmarks.names))
        )
    except ValueError as error:
        raise LipwrightError(f"the landmarks do not place a head: {error}") from None
    marks = start.apply(landmarks.on(mesh.vertices))
    spread = float(np.linalg.norm(marks - marks.mean(axis=0), axis=1).mean())
    bend = _bent(marks, landmarks.points)
    rest = bend(start.apply(source.places))
    face = mesh_surface(mesh, FACE)
    fit = _SkinFit(source, face, rest, mesh, target, landmarks, spread)
    moves = fit.run()
    placed = rest + _carried(rest, moves, fit.known)
    hits = fit.closest(placed, REACH[1] * spread)
    if not hits.weights.any():
        raise LipwrightError("the head lands nowhere on the target; check the landmarks")
    far = hits.distances[hits.weights > 0]
    found = landmarks.on(placed[source.place_of])
    return Registration(
        source,
        placed,
        find_partners(mesh, source, placed, target, landmarks, spread),
        lip_contacts(mesh, source, placed, target, spread),
        float(far.mean()),
        float(np.percentile(far, 95)),
        float(np.linalg.norm(found - landmarks.points, axis=1).mean()),
        start.scale,
        float((hits.weights > 0).mean()),
    )


def _bent(marks: Floats, aims: Floats) -> Any:
    """A map of space that takes the landmarks to their aims and is smooth between them."""
    from scipy.interpolate import RBFInterpolator

    # The distance itself is the thin plate of three dimensions; of degree 0, since landmarks of a
    # face say nothing of how the back of the head leans.
    fit = RBFInterpolator(marks, aims - marks, kernel="linear", degree=0)
    return lambda points: points + fit(points)


@dataclass(frozen=True, eq=False)
class _Matches:
    points: Floats
    weights: Floats
    distances: Floats


class _SkinFit:
    """The skin of the head on its way to the target."""

    def __init__(
        self,
        source: Surface,
        face: Surface,
        rest: Floats,
        mesh: Head,
        target: Surface,
        landmarks: LandmarkPairs,
        spread: float,
    ) -> None:
        """Gather what stays the same in all rounds."""
        place_of = source.place_of
        used = np.unique(face.triangles)
        self.known = np.unique(place_of[used])
        number = np.full(len(rest), -1)
        number[self.known] = np.arange(len(self.known))
        skin = next(p for p in mesh.parts if p.name == SKIN)
        self._seen = np.unique(number[place_of[mesh.triangles[skin.triangles]]])
        self._rest = rest[self.known]
        corners = number[place_of[face.triangles]]
        self._corners = corners
        self._target, self._finder, self._spread = target, Finder(target), spread
        shape = Surface(self._rest, corners)
        self._border = shape.border
        self._stiff, self._mass = _bending(shape)
        self._marks = _mark_table(landmarks, number[place_of], len(self.known))
        self._aims = landmarks.points - self._marks @ self._rest

    def run(self) -> Floats:
        """(n, 3), how far each place of the skin moves."""
        moves = np.zeros_like(self._rest)
        for share, length in zip(np.linspace(0, 1, len(STIFFNESS)), STIFFNESS, strict=True):
            reach = REACH[0] * (REACH[1] / REACH[0]) ** share * self._spread
            pull = LANDMARK_PULL[0] * (LANDMARK_PULL[1] / LANDMARK_PULL[0]) ** share
            for _ in range(REPEATS):
                moves = self._step(moves, length * self._spread, reach, pull)
        return moves

    def _step(self, moves: Floats, length: float, reach: float, pull: float) -> Floats:
        from scipy.sparse import dia_array

        match = self._match(self._rest + moves, reach)
        weights = match.weights * self._mass
        count = len(weights)
        each = pull * self._mass.sum() / self._marks.shape[0]
        system = (
            dia_array((weights[None], 0), shape=(count, count))
            + length**4 * self._stiff
            + each * (self._marks.T @ self._marks)
        )
        right = weights[:, None] * (match.points - self._rest) + each * (self._marks.T @ self._aims)
        return np.asarray(factorised(system).solve(right))

    def closest(self, placed: Floats, reach: float) -> _Matches:
        """Where the visible skin of the placed head meets the target."""
        match = self._match(placed[self.known], reach)
        return _Matches(
            match.points[self._seen], match.weights[self._seen], match.distances[self._seen]
        )

    def _match(self, places: Floats, reach: float) -> _Matches:
        """The aims of the places and how much they count; the mouth's inside has none."""
        normals = Surface(places, self._corners).place_normals[self._seen]
        hits = self._finder.closest(places[self._seen], normals, FACING)
        closeness = np.maximum(1 - (hits.distances / reach) ** 2, 0) ** 2
        counted = closeness * ~hits.on_border * ~self._border[self._seen]
        points, weights = places.copy(), np.zeros(len(places))
        distances = np.full(len(places), np.inf)
        points[self._seen], weights[self._seen] = hits.points, counted
        distances[self._seen] = hits.distances
        return _Matches(points, weights, distances)


def _bending(shape: Surface) -> tuple[Any, Floats]:
    """The energy of bent displacements (P, P) sparse, and the area (P,) around each place."""
    from scipy.sparse import dia_array

    gradient = surface_gradient(shape)
    areas = np.repeat(shape.areas, 3)
    laplacian = gradient.T @ dia_array((areas[None], 0), shape=(len(areas),) * 2) @ gradient
    mass = np.bincount(shape.corners.ravel(), np.repeat(shape.areas / 3, 3), len(shape.places))
    inverse = 1 / np.maximum(mass, 1e-3 * mass.mean())
    middle = dia_array((inverse[None], 0), shape=laplacian.shape)
    return (laplacian @ middle @ laplacian).tocsr(), np.asarray(mass, np.float64)


def _mark_table(landmarks: LandmarkPairs, number: NDArray[np.int64], count: int) -> Any:
    """(L', count) sparse: the landmarks that lie on the skin, from its places."""
    from scipy.sparse import csr_array

    corners = number[landmarks.vertices]
    if (corners < 0).any():
        name = landmarks.names[int(np.argmax((corners < 0).any(axis=1)))]
        raise LipwrightError(f"landmark {name} is not on the skin of the head")
    rows = np.repeat(np.arange(len(corners)), 3)
    return csr_array(
        (landmarks.weights.ravel(), (rows, corners.ravel())), shape=(len(corners), count)
    )


def _carried(rest: Floats, moves: Floats, known: NDArray[np.int64]) -> Floats:
    """(P, 3), how far all places move: those beneath the skin as the skin around them."""
    from scipy.interpolate import RBFInterpolator

    found = np.zeros_like(rest)
    found[known] = moves
    others = np.setdiff1d(np.arange(len(rest)), known)
    if len(others):
        fit = RBFInterpolator(
            rest[known], moves, kernel="linear", degree=0, neighbors=CARRIED_BY,
            smoothing=float(np.ptp(rest[known], axis=0).max()) * 0.05,
        )  # fmt: skip
        found[others] = fit(rest[others])
    return found
