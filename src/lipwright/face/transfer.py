"""Deformation transfer: a surface moves as another one does.

Sumner and Popovic 2004, "Deformation Transfer for Triangle Meshes": each triangle of the target is
to be deformed as its partners of the source are, and the vertices are those of least squared
error. Two things are as in Botsch et al. 2006, "Deformation Transfer for Detail-Preserving Surface
Editing": triangles count by their area, so that the result does not hang on how finely the target
is cut; and the fourth vertex of each target triangle, which only that triangle has, is eliminated.
What is left is a Poisson equation over the target's vertices, factorised once.

Gradients leave each connected piece free to be anywhere. It is put where its triangles have moved
on the whole as their partners have, those that move least counting most: the skull stays. Lips that
touch are near in space and far on the surface, so that they part as the source's by equations of
their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from lipwright.errors import LipwrightError
from lipwright.face.contacts import Contacts
from lipwright.face.gradients import GradientMeter, surface_gradient
from lipwright.face.partners import Partners
from lipwright.face.surface import Surface

if TYPE_CHECKING:
    from lipwright.face.mesh import Mesh

Floats = NDArray[np.float64]

STILL: Final = 0.03  # of the greatest motion; triangles that move less anchor a piece alike
CONTACT_PULL: Final = 10.0  # of a pair that touches, against cotangents of about 1
SPREAD_PULL: Final = 1e-4  # a triangle's pull to rest against that of a neighbour


@dataclass(frozen=True, eq=False)
class Similarity:
    """A turn, a scale and a shift."""

    rotation: Floats
    """(3, 3)"""
    scale: float
    shift: Floats
    """(3,)"""

    def apply(self, points: NDArray[np.floating[Any]]) -> Floats:
        """Points (..., 3), moved."""
        return np.asarray(self.scale * (points @ self.rotation.T) + self.shift)


def best_similarity(source: Floats, target: Floats, weights: Floats) -> Similarity:
    """What takes the points `source` (n, 3) nearest to `target` (n, 3); Umeyama 1991.

    Raises:
        ValueError: the points of one side lie on a line.
    """
    share = weights / weights.sum()
    middle, aim = share @ source, share @ target
    ours, theirs = source - middle, target - aim
    u, strengths, vt = np.linalg.svd((theirs * share[:, None]).T @ ours)
    if strengths[1] <= 1e-9 * strengths[0] or not strengths[0] > 0:
        raise ValueError("the points lie on one line")
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = (u * signs) @ vt
    scale = float(strengths @ signs / (share @ (ours**2).sum(axis=1)))
    return Similarity(rotation, scale, aim - scale * rotation @ middle)


class TransferSolver:
    """Carries poses of a source surface over to a target surface.

    Attributes:
        target: the surface that is moved.
        placement: takes the source to the place, size and direction of the target.
    """

    def __init__(
        self,
        source: Surface,
        target: Surface,
        partners: Partners,
        contacts: Contacts | None = None,
    ) -> None:
        """Factorise.

        Args:
            source: at rest.
            target: at rest.
            partners: which triangles belong together.
            contacts: points that are to part as far as the source's do.

        Raises:
            LipwrightError: no triangle has a partner, or all that have one lie on a line.
        """
        self.target = target
        usable = partners.matched & ~target.flat
        if not usable.any():
            raise LipwrightError(
                "no triangle of the target has a partner on the head; check the landmarks"
            )
        middles = partners.weights @ source.centroids
        try:
            self.placement = best_similarity(
                middles[usable], target.centroids[usable], target.areas[usable]
            )
        except ValueError as error:
            raise LipwrightError(f"the matched triangles cannot be placed: {error}") from None
        self._source = source
        placed = Surface(self.placement.apply(source.vertices), source.triangles, source.welds)
        self._rest = placed.places
        self._meter = GradientMeter(placed)
        self._anchors = _Anchors(source, target, partners.weights, usable)
        self._spread = _Spread(target, partners.weights, usable)
        self._contacts = contacts
        self._poisson = _Poisson(target, self._anchors.held, contacts)

    def displacements(self, posed: NDArray[np.floating[Any]]) -> Floats:
        """(V, 3), how far the target's vertices move when the source's are at `posed` (V', 3)."""
        places = self.placement.apply(self._source.at_places(posed))
        turned = self._spread.apply(self._meter.gradients(places) - np.eye(3))
        parted = None if self._contacts is None else self._contacts.source @ (places - self._rest)
        moves = self._poisson.solve(turned, parted)
        moves = self._anchors.settle(moves, places - self._rest)
        return np.asarray(moves[self.target.place_of])

    def shape(self, posed: NDArray[np.floating[Any]]) -> Floats:
        """(V, 3), the target's vertices when the source's are at `posed` (V', 3)."""
        return self.target.vertices + self.displacements(posed)

    def frames(self, poses: Iterable[NDArray[np.floating[Any]]]) -> Iterator[Floats]:
        """The target's vertices (V, 3) for each pose (V', 3) of the source, one after another."""
        return map(self.shape, poses)

    def blendshapes(self, mesh: Mesh, names: Sequence[str] | None = None) -> Floats:
        """(C, V, 3), how far each of the mesh's blendshapes, or of `names`, moves the target."""
        rest = mesh.vertices.astype(np.float64)
        found = []
        for name in mesh.shape_names if names is None else names:
            moved, by = mesh.shape(name)
            posed = rest.copy()
            posed[moved] += by
            found.append(self.displacements(posed))
        return np.stack(found)


class _Poisson:
    """Displacements out of deformation gradients, up to the shift of each piece."""

    def __init__(
        self, target: Surface, held: NDArray[np.int64], contacts: Contacts | None = None
    ) -> None:
        from scipy.sparse import dia_array

        gradient = surface_gradient(target)
        areas = np.repeat(target.areas, 3)
        self._divergence = (
            gradient.T @ dia_array((areas[None], 0), shape=(len(areas),) * 2)
        ).tocsr()
        laplacian = self._divergence @ gradient
        # The right side adds up to 0 in each piece, so that holding one place costs nothing.
        diagonal = np.zeros(len(target.places))
        diagonal[held] = laplacian.diagonal().max()
        self._pull = None if contacts is None else CONTACT_PULL * contacts.target.T
        if contacts is not None:
            laplacian = laplacian + self._pull @ contacts.target
        self._factors = factorised(laplacian + dia_array((diagonal[None], 0), laplacian.shape))

    def solve(self, turned: Floats, parted: Floats | None = None) -> Floats:
        """(P, 3) for gradients less the identity (N, 3, 3), and how contacts part (K, 3)."""
        aims = turned.transpose(0, 2, 1).reshape(-1, 3)  # rows by axis, columns by coordinate
        right = np.asarray(self._divergence @ aims)
        if self._pull is not None and parted is not None:
            right += self._pull @ parted
        return np.asarray(self._factors.solve(right))


class _Spread:
    """The gradients of all target triangles, also of those without partners.

    Between triangles with partners the gradients of the others are as smooth as can be, with a
    slight pull to rest. In pieces without any partner they are at rest.
    """

    def __init__(self, target: Surface, weights: Any, usable: NDArray[np.bool_]) -> None:
        from scipy.sparse import coo_array, dia_array

        self._weights = weights
        self._alone = np.flatnonzero(~usable & ~target.flat)
        if not len(self._alone):
            return
        n = len(target.corners)
        a, b = target.neighbours.T
        ends = np.concatenate([a, b]), np.concatenate([b, a])
        graph = coo_array((np.ones(2 * len(a)), ends), shape=(n, n)).tocsr()[self._alone]
        degree = np.asarray(graph.sum(axis=1)).ravel() + SPREAD_PULL
        inner = dia_array((degree[None], 0), (len(degree),) * 2) - graph[:, self._alone]
        self._factors = factorised(inner)
        known = dia_array((usable.astype(float)[None], 0), (n, n))
        self._around = (graph @ known).tocsr()

    def apply(self, turned: Floats) -> Floats:
        """(N, 3, 3) for the source's gradients less the identity, (N', 3, 3)."""
        found = np.asarray(self._weights @ turned.reshape(-1, 9))
        if len(self._alone):
            found[self._alone] = self._factors.solve(np.asarray(self._around @ found))
        return found.reshape(-1, 3, 3)


def factorised(matrix: Any) -> Any:
    """The factors of a sparse, symmetric, positive definite matrix: `solve` divides by it."""
    from scipy.sparse.linalg import splu

    return splu(
        matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )  # fmt: skip


class _Anchors:
    """Where the pieces of the target are put."""

    def __init__(
        self, source: Surface, target: Surface, weights: Any, usable: NDArray[np.bool_]
    ) -> None:
        from scipy.sparse import coo_array

        matched = np.flatnonzero(usable)
        self._areas = target.areas[matched]
        self._corners = target.corners[matched]
        # Motion of the source's places to that of the partners' middles.
        n = len(source.corners)
        rows = np.repeat(np.arange(n), 3)
        thirds = coo_array(
            (np.full(3 * n, 1 / 3), (rows, source.corners.ravel())), shape=(n, len(source.places))
        ).tocsr()
        self._middles = (weights[matched] @ thirds).tocsr()
        good = np.zeros(len(target.places), bool)
        good[target.corners[~target.flat]] = True
        led = np.zeros(target.pieces.max() + 1, bool)
        led[target.pieces[self._corners[:, 0]]] = True
        self._piece = np.unique(target.pieces[self._corners[:, 0]], return_inverse=True)[1]
        self._pieces, self._piece_of = _renumbered(target.pieces, led)
        self._moved = good & led[target.pieces]
        self._followed = _nearest(target.places, self._moved)
        held = np.flatnonzero(~self._moved)  # they follow, and are held where they are meanwhile
        firsts = np.unique(np.where(self._moved, target.pieces, -1), return_index=True)
        self.held = np.concatenate([held, firsts[1][firsts[0] >= 0]])

    def settle(self, moves: Floats, source_moves: Floats) -> Floats:
        """The places' displacements (P, 3) with each piece shifted, and what follows, following."""
        wanted = np.asarray(self._middles @ source_moves)
        far = np.linalg.norm(wanted, axis=1)
        weights = self._areas / (far / max(far.max(), np.finfo(float).tiny) + STILL) ** 2
        missing = (wanted - moves[self._corners].mean(axis=1)) * weights[:, None]
        sums = np.stack([np.bincount(self._piece, c, self._pieces) for c in missing.T], axis=1)
        shifts = sums / np.bincount(self._piece, weights, self._pieces)[:, None]
        moves = moves + shifts[self._piece_of]
        return np.asarray(moves[self._followed])


def _renumbered(pieces: NDArray[np.int64], led: NDArray[np.bool_]) -> tuple[int, NDArray[np.int64]]:
    """How many pieces are led, and the new number of each place's piece, 0 for others."""
    numbers = np.cumsum(led) - 1
    return int(led.sum()), np.where(led[pieces], numbers[pieces], 0)


def _nearest(places: Floats, among: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(P,), for each place itself, or the nearest of `among` where it is none of them."""
    from scipy.spatial import cKDTree

    found = np.arange(len(places))
    others = np.flatnonzero(~among)
    if len(others):
        known = np.flatnonzero(among)
        found[others] = known[cKDTree(places[known]).query(places[others])[1]]
    return found
