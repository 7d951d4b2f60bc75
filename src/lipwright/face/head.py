"""`Head`: a face mesh with its blendshapes, and how it is installed and loaded."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.materials import MATERIALS, Material, srgb_to_linear
from lipwright.files import write_whole
from lipwright.npz import BROKEN, reason_of
from lipwright.wheels import data_home

HEAD_FILE: Final = "head.npz"
HEAD_FORMAT: Final = 2  # raise when the fields of the file change

REMEDY: Final = "run: lipwright head install"


@dataclass(frozen=True)
class Part:
    """A run of vertices and triangles with one material."""

    name: str
    material_name: str
    vertices: slice
    """of the head's V vertices"""
    triangles: slice
    """of the head's triangles, which use only the part's own vertices"""

    @property
    def material(self) -> Material:
        """The material by its name."""
        return MATERIALS[self.material_name]


@dataclass(frozen=True, eq=False)
class Head:
    """A head at rest and its 55 blendshapes, in the order of `controls.CANONICAL`.

    In metres; y up, z forward, +x to the character's own left; the origin is the joint of
    head and neck. All arrays are read-only.
    """

    vertices: NDArray[np.float32]
    """(V, 3) at rest, m"""
    triangles: NDArray[np.int32]
    """(N, 3) vertex numbers, counter-clockwise seen from outside"""
    parts: tuple[Part, ...]
    """in order, covering all vertices and triangles"""
    tints: NDArray[np.float32]
    """(V, 3) linear RGB, 0 to 1, multiplied with the texture: shade and tone"""
    uvs: NDArray[np.float32]
    """(V, 2) places in the texture, 0 to 1, v from its top row downwards"""
    texture: NDArray[np.uint8]
    """(H, W, 3) sRGB"""
    welds: NDArray[np.int32]
    """(V,) the first vertex at the same place in the same surface, for smooth normals"""
    shape_starts: NDArray[np.int32]
    """(C + 1,) where each control's displacements start in the two arrays below"""
    shape_vertices: NDArray[np.int32]
    """(D,) the vertices that move"""
    shape_deltas: NDArray[np.float32]
    """(D, 3) how far they move at weight 1, m"""
    lip_pairs: NDArray[np.int32]
    """(3, 2) upper and lower inner-lip vertices: centre, left, right"""

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    @property
    def shape_names(self) -> tuple[str, ...]:
        """The names of the C blendshapes."""
        return CANONICAL

    def shape(self, name: str) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """The vertices that the blendshape `name` moves and their displacements (n, 3), m."""
        index = CANONICAL.index(name)
        span = slice(self.shape_starts[index], self.shape_starts[index + 1])
        return self.shape_vertices[span], self.shape_deltas[span]

    def pose(self, weights: ArrayLike) -> NDArray[np.float32]:
        """The vertices (V, 3) in m under `weights` (C,), one for each of `CANONICAL`.

        Raises:
            ValueError: there are more or fewer weights than controls.
        """
        values = np.asarray(weights, np.float32)
        if values.shape != (len(CANONICAL),):
            raise ValueError(f"weights have the shape {values.shape}, not ({len(CANONICAL)},)")
        posed = self.vertices.copy()
        for index in np.flatnonzero(values):
            span = slice(self.shape_starts[index], self.shape_starts[index + 1])
            posed[self.shape_vertices[span]] += values[index] * self.shape_deltas[span]
        return posed

    def pose_many(self, weights: ArrayLike) -> NDArray[np.float32]:
        """The vertices (T, V, 3) in m under the weights (T, C) of T frames."""
        return np.stack([self.pose(row) for row in np.asarray(weights, np.float32)])

    @cached_property
    def eye_distance(self) -> float:
        """Distance of the centres of the two eyeballs in m."""
        centres = [
            self.vertices[part.vertices].mean(axis=0)
            for part in self.parts
            if part.name in {"eyeLeft", "eyeRight"}
        ]
        return float(np.linalg.norm(centres[0] - centres[1]))

    def aperture(self, vertices: NDArray[np.floating]) -> NDArray[np.float64]:
        """The gap between the inner lips over the distance of the eyes, 0 for shut lips.

        The mean of three vertical gaps as seen from the front, at the centre and on either
        side (MediaPipe's landmarks 13-14, 312-317 and 82-87); a pair that overlaps counts as
        shut.

        Args:
            vertices: (..., V, 3), of one pose or of many.
        """
        heights = np.asarray(vertices, np.float64)[..., self.lip_pairs, 1]
        gaps = np.maximum(heights[..., 0] - heights[..., 1], 0.0)
        return np.asarray(gaps.mean(axis=-1) / self.eye_distance)

    def aperture_curve(self, weights: ArrayLike) -> NDArray[np.float64]:
        """`aperture` (T,) under the weights (T, C), without posing the whole head."""
        rest, deltas = self._lip_heights
        heights = rest + np.tensordot(np.asarray(weights, np.float64), deltas, axes=1)
        gaps = np.maximum(heights[..., 0] - heights[..., 1], 0.0)
        return np.asarray(gaps.mean(axis=-1) / self.eye_distance)

    @property
    def opening(self) -> NDArray[np.float64]:
        """(C,), how far each canonical control opens the lips, in eye distances a full weight."""
        _, deltas = self._lip_heights
        return np.asarray((deltas[..., 0] - deltas[..., 1]).mean(axis=1) / self.eye_distance)

    @cached_property
    def _lip_heights(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Heights (3, 2) of the lip pairs at rest and what each control adds (C, 3, 2), m."""
        deltas = np.zeros((len(CANONICAL), len(self.vertices)))
        for index, name in enumerate(CANONICAL):
            moved, by = self.shape(name)
            deltas[index, moved] = by[:, 1]
        return self.vertices[self.lip_pairs, 1].astype(np.float64), deltas[:, self.lip_pairs]

    def normals(self, vertices: NDArray[np.floating]) -> NDArray[np.float32]:
        """Unit normals (V, 3) of the posed `vertices` (V, 3), weighted by area."""
        x, y, z = np.ascontiguousarray(vertices.T, np.float32)
        a, b, c = (self.triangles[:, k] for k in range(3))
        x1, y1, z1 = x[b] - x[a], y[b] - y[a], z[b] - z[a]
        x2, y2, z2 = x[c] - x[a], y[c] - y[a], z[c] - z[a]
        order, starts, place = self._corners
        sums = np.stack(
            [
                np.add.reduceat(face[order], starts)
                for face in (y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2)
            ],
            axis=1,
        )
        lengths = np.sqrt(np.einsum("vc,vc->v", sums, sums))
        return np.asarray((sums / np.maximum(lengths, 1e-20)[:, None])[place], np.float32)

    @cached_property
    def _corners(self) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
        """Triangles sorted by their welded corners, the start of each run, each vertex's run."""
        corners = self.welds[self.triangles].ravel()
        order = np.argsort(corners, kind="stable")
        used, starts = np.unique(corners[order], return_index=True)
        run = np.zeros(len(self.vertices), np.intp)
        run[used] = np.arange(len(used))
        return order // 3, starts, run[self.welds]

    @cached_property
    def rest_normals(self) -> NDArray[np.float32]:
        """Unit normals (V, 3) at rest."""
        return self.normals(self.vertices)

    @cached_property
    def colors(self) -> NDArray[np.float32]:
        """(V, 3) linear RGB, 0 to 1: texture times tint at each vertex, for untextured use."""
        height, width = self.texture.shape[:2]
        rows = np.clip(self.uvs[:, 1] * height, 0, height - 1).astype(int)
        columns = np.clip(self.uvs[:, 0] * width, 0, width - 1).astype(int)
        return np.asarray(srgb_to_linear(self.texture[rows, columns]) * self.tints, np.float32)

    def summary(self) -> dict[str, object]:
        """Counts and sizes, for people."""
        size = self.vertices.max(axis=0) - self.vertices.min(axis=0)
        return {
            "vertices": len(self.vertices),
            "triangles": len(self.triangles),
            "blendshapes": len(CANONICAL),
            "parts": [part.name for part in self.parts],
            "size_m": [round(float(length), 3) for length in size],
            "texture": f"{self.texture.shape[1]}x{self.texture.shape[0]}",
            "rest_aperture": round(float(self.aperture(self.vertices)), 4),
        }


def head_path() -> Path:
    """Where the installed head lies."""
    return data_home() / HEAD_FILE


def save_head(head: Head, path: Path) -> None:
    """Write `head` to `path`, whole or not at all.

    Raises:
        LipwrightError: the file cannot be written.
    """
    arrays = {f.name: getattr(head, f.name) for f in fields(head) if f.name != "parts"}
    names = np.array([[part.name, part.material_name] for part in head.parts])
    spans = np.array(
        [
            [p.vertices.start, p.vertices.stop, p.triangles.start, p.triangles.stop]
            for p in head.parts
        ],
        np.int32,
    )
    with write_whole(path) as part:
        np.savez_compressed(part, format=HEAD_FORMAT, part_names=names, part_spans=spans, **arrays)


def load_head(path: Path | None = None) -> Head:
    """The installed head, or the one in `path`; the same file is read once.

    Raises:
        LipwrightError: no head is installed, or the file is broken or of another version.
    """
    source = path or head_path()
    try:
        return _read_head(source, source.stat().st_mtime_ns)
    except FileNotFoundError as error:
        raise LipwrightError(f"the head is not installed; {REMEDY}") from error
    except BROKEN as error:
        raise LipwrightError(
            f"{source}: not a readable head ({reason_of(error)}); {REMEDY}"
        ) from error


@lru_cache(maxsize=1)
def _read_head(path: Path, _modified_ns: int) -> Head:
    # Given a path, np.load leaves the file open when it is no archive.
    with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
        if int(stored["format"]) != HEAD_FORMAT:
            raise LipwrightError(f"{path}: the head is of another version; {REMEDY}")
        arrays = {f.name: stored[f.name] for f in fields(Head) if f.name != "parts"}
        parts = _parts(stored["part_names"].tolist(), stored["part_spans"].tolist())
    return Head(parts=parts, **arrays)


def _parts(names: Iterable[list[str]], spans: Iterable[list[int]]) -> tuple[Part, ...]:
    return tuple(
        Part(name, material, slice(v0, v1), slice(t0, t1))
        for (name, material), (v0, v1, t0, t1) in zip(names, spans, strict=True)
    )
