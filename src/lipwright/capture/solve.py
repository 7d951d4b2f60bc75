"""Weights of the 52 ARKit shapes that move the head's surface as tracked landmarks move.

For all frames of a run together: the least squared difference of displacements from the rest
face, in eye distances, under bounds 0 to 1, with a small cost on every weight, so that shapes
which explain nothing stay at rest, and on its change over time. The aperture of the lips counts
far more than any point: shut lips must be shut and open lips as open as the speaker's.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.capture.correspondence import correspondence, landmark_shapes
from lipwright.capture.landmarks import LIP_PAIRS
from lipwright.controls import ARKIT, CANONICAL, MIRROR
from lipwright.evaluate.lips import runs
from lipwright.face.head import Head

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

LIDS: Final = ((159, 145), (386, 374))  # upper and lower lid's middle, of the right and left eye
BLINKS: Final = ("eyeBlinkRight", "eyeBlinkLeft")

REGION_WEIGHTS: Final = MappingProxyType(
    {
        "lips outer": 1.0, "lips middle": 0.5, "lips inner": 0.5, "jaw": 0.7, "cheeks": 0.3,
        "nose": 0.2, "eyes": 1.0, "lids": 0.2, "brows": 2.0, "forehead": 0.2, "irises": 0.3,
    }
)  # fmt: skip
"""how much the mean over a region's landmarks counts"""

LID_TRAVEL: Final = 0.77  # of the rest gap of the lids, how far a blink takes the upper one; GRID

DEPTH_WEIGHT: Final = 0.1  # of z against x and y; the tracker only guesses depth

BLOCK: Final = 500  # frames solved together
OVERLAP: Final = 50  # frames on either side that are solved with them and then dropped
STEPS: Final = 50  # of Newton's method, at most
TOLERANCE: Final = 1e-6  # change of a weight at which it ends

CLOSED: Final = 0.15  # share of the 95th percentile under which lips count as shut
FEW: Final = 3  # frames that a rest face needs
LARGEST_GAP: Final = 0.02  # eye distances between points of shut lips; up to 0.011 in GRID


@dataclass(frozen=True)
class SolveOptions:
    """What the solver prefers, other things being equal; costs are in squared eye distances."""

    tied: bool = True
    """left and right move alike, and both eyes look the same way"""
    aperture: float = 10.0
    """weight of the aperture's squared error; that of the landmarks is about 1"""
    sparsity: float = 2e-4
    """cost of a weight of 1"""
    ridge: float = 4e-4
    """cost of the square of a weight of 1"""
    change: float = 1e-6
    """cost of the square of a change by 1 a second"""


DOUBT: Final = MappingProxyType(
    {
        "jawForward": 10.0, "cheekPuff": 10.0,  # hardly seen from the front
        "mouthFrown": 4.0, "mouthShrugLower": 4.0, "mouthShrugUpper": 4.0, "mouthRollUpper": 2.0,
        "noseSneer": 4.0, "eyeWide": 4.0, "eyeSquint": 3.0,
    }
)  # fmt: skip
"""beginning of a name to how many times dearer the control is than those without such doubts"""


def neutral_face(landmarks: npt.ArrayLike, aperture: npt.ArrayLike, quiet: npt.ArrayLike) -> Floats:
    """(478, 3), the speaker's rest face: the median of quiet frames whose lips are shut.

    Without three such frames, the quiet third with the least aperture; without quiet frames,
    the tenth of all frames with the least aperture.

    Args:
        landmarks: (T, 478, 3) in the head frame, eye distances; NaN where lost.
        aperture: (T,) eye distances.
        quiet: (T,) whether nobody speaks.

    Raises:
        ValueError: no frame has a face.
    """
    points = np.asarray(landmarks)
    gaps = np.asarray(aperture, np.float64)
    known = ~np.isnan(points[:, 0, 0]) & ~np.isnan(gaps)
    if not known.any():
        raise ValueError("no frame has a face")
    still = known & np.asarray(quiet, bool)
    shut = still & (gaps < CLOSED * np.percentile(gaps[known], 95))
    if shut.sum() < FEW:
        pool, share = (still, 1 / 3) if still.sum() >= FEW else (known, 0.1)
        shut = pool & (gaps <= np.quantile(gaps[pool], share))
    return np.asarray(np.median(points[shut].astype(np.float64), axis=0))


def solve_arkit(
    landmarks: npt.ArrayLike,
    aperture: npt.ArrayLike,
    head: Head,
    fps: float,
    neutral: npt.ArrayLike,
    options: SolveOptions | None = None,
) -> npt.NDArray[np.float32]:
    """The weights (T, 52), 0 to 1, in the order of `ARKIT`; NaN where the face is lost.

    Args:
        landmarks: (T, 478, 3) in the head frame, eye distances, y down; NaN where lost.
        aperture: (T,) the measured gap of the inner lips, eye distances.
        head: the head whose blendshapes are to follow.
        fps: frames a second.
        neutral: (478, 3) the speaker's rest face, as from `neutral_face`.
        options: what to prefer.

    Raises:
        ValueError: shapes that do not match.
    """
    points, gaps = np.asarray(landmarks), np.asarray(aperture, np.float64)
    rest = np.asarray(neutral, np.float64)
    if points.ndim != 3 or points.shape[1:] != rest.shape or gaps.shape != points.shape[:1]:
        raise ValueError(
            f"landmarks {points.shape}, aperture {gaps.shape} and rest {rest.shape} do not match"
        )
    basis = Basis(head, options or SolveOptions(), fps)
    known = ~np.isnan(points[:, 0, 0]) & ~np.isnan(gaps)
    # A speaker who never shuts his lips rests with open ones.
    target = np.maximum(gaps - min(lip_gap(rest), LARGEST_GAP), 0.0)
    solved = np.full((len(points), len(ARKIT)), np.nan, np.float32)
    for first, last in runs(known):
        for start in range(first, last, BLOCK):
            end = min(start + BLOCK, last)
            span = slice(max(start - OVERLAP, first), min(end + OVERLAP, last))
            pull = basis.pull(points[span], rest)
            unknowns = basis.minimise(pull, target[span])
            inner = slice(start - span.start, end - span.start)
            solved[start:end] = np.clip(unknowns[inner] @ basis.columns, 0, 1)
    return solved


def lip_gap(points: Floats) -> float:
    """The mean distance of the inner-lip pairs of one face (478, 3), as the picture shows it."""
    gaps = [np.linalg.norm(points[a, :2] - points[b, :2]) for a, b in LIP_PAIRS]
    return float(np.mean(gaps))


def lid_gaps(points: npt.NDArray[np.floating]) -> Floats:
    """(...,), the mean distance of the lids of faces (..., 478, 3), as the picture shows it."""
    gaps = [np.linalg.norm(points[..., a, :2] - points[..., b, :2], axis=-1) for a, b in LIDS]
    return np.mean(gaps, axis=0)


def unknowns_of(tied: bool) -> Floats:
    """(U, 52), which controls each unknown moves; what cannot be seen is in none."""
    skipped = {"tongueOut"}
    partner = {name: name for name in ARKIT}
    if tied:
        skipped |= {"jawLeft", "jawRight", "mouthLeft", "mouthRight"}
        partner = {name: MIRROR[name] for name in ARKIT}
        partner |= {"eyeLookInLeft": "eyeLookOutRight", "eyeLookOutLeft": "eyeLookInRight"}
    rows = []
    for name in ARKIT:
        if name not in skipped:
            row = np.zeros(len(ARKIT))
            row[[ARKIT.index(name), ARKIT.index(partner[name])]] = 1.0
            rows.append(row)
            skipped |= {name, partner[name]}
    return np.stack(rows)


class Basis:
    """The blendshapes as the solver sees them, U unknowns.

    Attributes:
        columns: (U, 52) which controls each unknown moves.
    """

    def __init__(self, head: Head, options: SolveOptions, fps: float) -> None:
        """Weigh the landmarks' displacements and the aperture of `head`."""
        self.columns = unknowns_of(options.tied)
        table = correspondence()
        counts = {region: table.regions.count(region) for region in REGION_WEIGHTS}
        share = np.array([REGION_WEIGHTS[r] / counts[r] for r in table.regions])
        self._weights = share[:, None] * [1.0, 1.0, DEPTH_WEIGHT]
        self._irises, self._eyes = (
            np.array([region == name for region in table.regions]) for name in ("irises", "eyes")
        )
        single = landmark_shapes(head)
        self._blink = float(
            np.mean([single[ARKIT.index(n), a, 1] for n, (a, _) in zip(BLINKS, LIDS, strict=True)])
        )
        shapes = np.tensordot(self.columns, single, axes=1)
        size = len(self.columns)
        self._pulled = (shapes * self._weights).reshape(size, -1).T  # (478 * 3, U)
        doubt = np.array(
            [
                next((d for start, d in DOUBT.items() if name.startswith(start)), 1.0)
                for name in ARKIT
            ]
        )
        each = (self.columns * doubt).max(axis=1)
        self._linear = options.sparsity * each
        self._square = shapes.reshape(size, -1) @ self._pulled
        self._square += np.diag(options.ridge * each)
        self._open, self._overlap = _mean_gap(head)
        self._open = self.columns @ self._open
        self._aperture = options.aperture
        self._change = options.change * fps * fps

    def pull(self, points: npt.NDArray[np.floating], rest: Floats) -> Floats:
        """(T, U), how much the landmarks (T, 478, 3) speak for each unknown.

        Moves of the lids count in shares of the speaker's own eyes, so that a blink is a blink.
        The irises cannot be seen behind a lid; there they say nothing.
        """
        moves = points - rest
        gaps = lid_gaps(points)
        resting = max(float(lid_gaps(rest)), 1e-6)
        moves[:, self._eyes, 1] *= self._blink / (LID_TRAVEL * resting)
        seen = np.clip(gaps / resting / 0.4 - 0.75, 0, 1)
        moves[:, self._irises] *= seen[:, None, None]
        return np.asarray(moves.reshape(len(moves), -1) @ self._pulled)

    def cost(self, x: Floats, pull: Floats, target: Floats) -> tuple[float, Floats, Floats]:
        """Half the cost of the unknowns `x` (T, U), its slope (T, U), the aperture's say (T,)."""
        miss, strict = self._miss(x, target)
        fit = x @ self._square
        change = np.diff(x, axis=0)
        value = (
            0.5 * (x * fit).sum() - (x * (pull - self._linear)).sum()
            + 0.5 * (strict * miss * miss).sum() + 0.5 * self._change * (change * change).sum()
        )  # fmt: skip
        slope = fit - pull + self._linear + (strict * miss)[:, None] * self._open
        slope[1:] += self._change * change
        slope[:-1] -= self._change * change
        return float(value), slope, strict

    def _miss(self, x: Floats, target: Floats) -> tuple[Floats, Floats]:
        """By how much (T,) the lips are too open, and how much that counts.

        Lips that should be shut may press together as they like.
        """
        touch = np.clip(target / (2 * self._overlap), 0, 1)  # the overlap opens first
        miss = x @ self._open - (target + self._overlap * touch)
        return miss, self._aperture * np.where(miss > 0, 1.0, touch)

    def minimise(self, pull: Floats, target: Floats) -> Floats:
        """The unknowns (T, U) of least cost: Newton's method on those that are not at a bound."""
        x = np.zeros_like(pull)
        value, slope, strict = self.cost(x, pull, target)
        for _ in range(STEPS):
            free = ~(((x <= 0) & (slope > 0)) | ((x >= 1) & (slope < 0)))
            step = self._newton(slope, strict, free)
            for length in (1.0, 0.5, 0.25, 0.1, 0.03, 0.01, 0.001):
                tried = np.clip(x - length * step, 0, 1)
                found = self.cost(tried, pull, target)
                if found[0] <= value:
                    break
            else:
                break
            moved = float(np.abs(tried - x).max())
            x, (value, slope, strict) = tried, found
            if moved < TOLERANCE:
                break
        return x

    def _newton(self, slope: Floats, strict: Floats, free: Bools) -> Floats:
        """The step (T, U) to the least cost if the free unknowns had no bounds."""
        from scipy.linalg import solveh_banded

        frames, size = slope.shape
        band = np.zeros((size + 1, frames, size))  # by distance from the diagonal
        for off in range(size):
            both = free[:, : size - off] & free[:, off:]
            value = np.diagonal(self._square, off) + np.outer(
                strict, self._open[: size - off] * self._open[off:]
            )
            band[off, :, : size - off] = value * both
        ends = np.full(frames, 2.0)
        ends[[0, -1]] -= 1.0
        band[0] += self._change * ends[:, None] * free + ~free
        if frames > 1:
            band[size, :-1] = -self._change * (free[:-1] & free[1:])
        flat = band.reshape(size + 1, -1)
        step = solveh_banded(flat, (slope * free).ravel(), lower=True, check_finite=False)
        return np.asarray(step.reshape(frames, size))


def _mean_gap(head: Head) -> tuple[Floats, float]:
    """What each of `ARKIT` adds to the mean gap of the lip pairs (52,), and the overlap at rest."""

    def gap(vertices: npt.NDArray[np.floating]) -> float:
        heights = vertices[head.lip_pairs, 1].astype(np.float64)
        return float((heights[:, 0] - heights[:, 1]).mean() / head.eye_distance)

    resting = gap(head.vertices)
    one = np.eye(len(CANONICAL), dtype=np.float32)
    added = [gap(head.pose(one[CANONICAL.index(name)])) - resting for name in ARKIT]
    return np.array(added), max(-resting, 1e-4)
