"""Makes the reference shape that retargeting by poses rests on, out of a captured dataset.

    python bench/reference_shape.py DATASET FACE.npz -o src/lipwright/face/grid-s1.json

The modes are the first of the reference face (`lipwright face fit DATASET -o FACE.npz`). The map
from canonical controls to them is that of the head's geometry, corrected by ridge regression on
the solved weights of the train split; of several strengths of the ridge that one is kept which
follows the first four modes best on the validation split, as long as the aperture stays. Figures
are printed for the test split. Needs `lipwright head install`.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.optimize import lsq_linear

from lipwright.capture.correspondence import landmark_shapes
from lipwright.capture.solve import DOUBT, unknowns_of
from lipwright.controls import ARKIT, CANONICAL
from lipwright.dataset.folder import open_dataset
from lipwright.face.head import Head, load_head
from lipwright.face.reference import ReferenceFace, meeting
from lipwright.face.reference_file import load_reference_face
from lipwright.face.shapes import MEAN, SHUT, ReferenceShape, lip_gap, shape_to_text
from lipwright.face.vertices import LANDMARKS
from lipwright.files import write_whole
from lipwright.rig.mapping import MODES, SIGMA

Floats = npt.NDArray[np.float64]

KEPT = 8  # modes
RIDGES = (
    np.inf,
    1e5,
    1e4,
    3e3,
    1e3,
    3e2,
    1e2,
)  # frames with a weight of 1; endless: geometry alone
LOSS = 5e-4  # of the aperture's r, which a correction may cost
MOVED = ("jaw", "mouth", "cheek", "noseSneer")  # beginnings of controls that move the lower face
POSED = ("jawOpen", "mouth")  # beginnings of controls that show the poses
SIDEWAYS = ("mouthLeft", "mouthRight")
APERTURE = 10.0  # weight of the lips' gap among the 68 coordinates, as in capture
RIDGE = 0.03  # cost of a weight of 1 in a pose, eye distances; more where the solver has doubts
LEAST = 0.01  # a weight that is not seen
OPENS = 0.002  # eye distances from which a control counts as one that opens the lips


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of a split."""

    weights: Floats
    """(T, 52)"""
    points: Floats
    """(T, 34, 2) eye distances"""
    gaps: Floats
    """(T,) eye distances"""
    names: npt.NDArray[np.str_]
    """(T,) of the recordings"""


@dataclass(frozen=True, eq=False)
class Map:
    """From weights to standard deviations: weights @ gains + offset."""

    gains: Floats
    """(52, M)"""
    offset: Floats
    """(M,)"""


def read_frames(dataset: Path, split: str) -> Frames:
    found = open_dataset(dataset)
    weights, points, gaps, names = [], [], [], []
    for name in found.names(split):
        motion = found.recording(name).motion
        assert motion.landmarks is not None
        assert motion.aperture is not None
        valid = motion.valid
        weights.append(motion.arkit[valid])
        points.append(motion.landmarks[valid][:, LANDMARKS, :2])
        gaps.append(motion.aperture[valid])
        names += [name] * int(valid.sum())
    return Frames(
        np.concatenate(weights).astype(float), np.concatenate(points).astype(float),
        np.concatenate(gaps).astype(float), np.array(names),
    )  # fmt: skip


def project(face: ReferenceFace, points: Floats) -> Floats:
    """(T, M) standard deviations."""
    return np.asarray(face.project_shape(points)[..., :KEPT] / face.shape_sd[:KEPT], np.float64)


def geometry(face: ReferenceFace, head: Head) -> Floats:
    """(52, M), by how the head's blendshapes move the 34 points."""
    moves = landmark_shapes(head)[:, LANDMARKS, :2].reshape(len(ARKIT), -1)
    flat = face.shape_modes[:KEPT].reshape(KEPT, -1).astype(float)
    return np.asarray(moves @ flat.T / face.shape_sd[:KEPT])


def fit_map(by_geometry: Floats, frames: Frames, p: Floats, ridge: float) -> Map:
    """Least squares with the correction of the geometry's gains held small by `ridge`."""
    left = p - frames.weights @ by_geometry
    if np.isinf(ridge):
        return Map(by_geometry, left.mean(axis=0))
    columns = unknowns_of(tied=True)
    columns = columns[[bool(_named(row, MOVED)) for row in columns]]
    back = np.linalg.pinv(columns)
    seen = np.hstack([frames.weights @ back, np.ones((len(p), 1))])
    costs = np.diag([*[ridge] * len(columns), 0.0])
    found = np.linalg.solve(seen.T @ seen + costs, seen.T @ left)
    return Map(by_geometry + back @ found[:-1], found[-1])


def _named(row: Floats, beginnings: tuple[str, ...]) -> list[str]:
    """The controls of an unknown (52,) whose names begin so."""
    return [ARKIT[index] for index in np.flatnonzero(row) if ARKIT[index].startswith(beginnings)]


def score(face: ReferenceFace, made: Map, frames: Frames) -> tuple[Floats, float, float]:
    """For each mode its r over all frames; mean r of the aperture, by four modes and by all."""
    p, real = frames.weights @ made.gains + made.offset, project(face, frames.points)
    of_modes = np.array([np.corrcoef(p[:, k], real[:, k])[0, 1] for k in range(KEPT)])
    of_gaps = []
    for count in (MODES, KEPT):
        shape = np.zeros((len(p), len(face.shape_sd)))
        shape[:, :count] = p[:, :count] * face.shape_sd[:count]
        gap = lip_gap(face.points(shape))
        rs = [np.corrcoef(gap[own], frames.gaps[own])[0, 1]
              for own in (frames.names == name for name in np.unique(frames.names))]  # fmt: skip
        of_gaps.append(float(np.mean(rs)))
    return of_modes, of_gaps[0], of_gaps[1]


def choose_map(face: ReferenceFace, head: Head, dataset: Path) -> Map:
    train, validation = (read_frames(dataset, split) for split in ("train", "validation"))
    p, by_geometry = project(face, train.points), geometry(face, head)
    maps = {ridge: fit_map(by_geometry, train, p, ridge) for ridge in RIDGES}
    scores = {ridge: score(face, made, validation) for ridge, made in maps.items()}
    needed = max(four for _, four, _ in scores.values()) - LOSS
    chosen = max(
        (ridge for ridge in RIDGES if scores[ridge][1] >= needed),
        key=lambda ridge: scores[ridge][0][:MODES].mean(),
    )
    test = read_frames(dataset, "test")
    print(f"{len(train.names)} frames to fit, {len(validation.names)} to choose, "
          f"{len(test.names)} to test")  # fmt: skip
    for split, frames in (("validation", validation), ("test", test)):
        for ridge, made in maps.items():
            rs, four, every = score(face, made, frames)
            print(
                f"{split:10} ridge {ridge:8g}: r of the modes {rs.round(3)}, of the aperture "
                f"{four:.4f} ({MODES} modes), {every:.4f} ({KEPT})"
                + (" chosen" if ridge == chosen else "")
            )
    return maps[chosen]


def solve_pose(head: Head, moves: Floats, gap: float) -> dict[str, float]:
    """The weights that bring the 34 points and the gap of the lips nearest to `moves` and `gap`.

    Args:
        head: whose blendshapes.
        moves: (34, 2) eye distances from the rest face.
        gap: eye distances between the lips.
    """
    columns = unknowns_of(tied=True)
    names = [_named(row, POSED) for row in columns]
    columns = columns[[bool(own) and not set(own) & set(SIDEWAYS) for own in names]]
    costs = [RIDGE * np.sqrt(_doubt(row)) for row in columns]
    shapes = landmark_shapes(head)[:, LANDMARKS, :2].reshape(len(ARKIT), -1)
    opening = columns @ head.opening[: len(ARKIT)]
    rows = np.vstack([(columns @ shapes).T, APERTURE * opening, np.diag(costs)])
    wanted = np.concatenate([moves.ravel(), [APERTURE * gap], np.zeros(len(columns))])
    weights = lsq_linear(rows, wanted, (0.0, 1.0)).x @ columns
    return {
        name: round(float(weight), 3)
        for name, weight in zip(ARKIT, weights, strict=True) if weight > LEAST
    }  # fmt: skip


def _doubt(row: Floats) -> float:
    name = _named(row, ("",))[0]
    return max([1.0, *(factor for start, factor in DOUBT.items() if name.startswith(start))])


def human_poses(face: ReferenceFace, head: Head, made: Map) -> dict[str, dict[str, float]]:
    """The poses of the modes on the head; where the reference lips overlap, they meet."""
    sd = face.shape_sd[:KEPT]
    padded = np.zeros(len(face.shape_sd))
    padded[:KEPT] = made.offset * sd
    rest = face.points(padded).astype(float)
    shapes = {MEAN: face.mean_shape.astype(float)}
    for mode in range(KEPT):
        for sigma in (-SIGMA, SIGMA):
            step = sigma * sd[mode] * face.shape_modes[mode]
            shapes[f"mode{mode + 1}{sigma:+g}"] = face.mean_shape + step
    poses = {}
    for name, points in shapes.items():
        gap = float(lip_gap(points) - lip_gap(rest))
        drawn = points if gap > 0 else meeting(points)
        poses[name] = solve_pose(head, drawn - rest, max(gap, 0.0))
    opens = (head.opening > OPENS) | (np.array(CANONICAL) == "mouthClose")
    poses[SHUT] = {
        name: 0.0 for name, does in zip(CANONICAL, opens, strict=True)
        if does and name.startswith(POSED)
    }  # fmt: skip
    return poses


def make_shape(name: str, face: ReferenceFace, head: Head, made: Map) -> ReferenceShape:
    gains = np.zeros((len(CANONICAL), KEPT))
    gains[: len(ARKIT)] = made.gains
    return ReferenceShape(
        name=name,
        source=f"shape modes of the reference face fitted to {face.info['dataset']}; made by "
        "bench/reference_shape.py",
        license=str(face.info["licence"]),
        mean=face.mean_shape, modes=face.shape_modes[:KEPT], sd=face.shape_sd[:KEPT],
        gains=gains, offset=made.offset, opening=head.opening,
        human=human_poses(face, head, made),
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("face", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True)
    options = parser.parse_args()
    face, head = load_reference_face(options.face), load_head()
    shape = make_shape(options.out.stem, face, head, choose_map(face, head, options.dataset))
    with write_whole(options.out) as part:
        part.write_text(shape_to_text(shape), "utf-8")


if __name__ == "__main__":
    main()
