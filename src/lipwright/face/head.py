"""`Head`: a face mesh with its blendshapes, and how it is installed and loaded."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import MISSING, dataclass, fields
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.mesh import Mesh, Part
from lipwright.files import write_whole
from lipwright.npz import BROKEN, reason_of
from lipwright.wheels import data_home

HEAD_FILE: Final = "head.npz"
HEAD_FORMAT: Final = 2  # raise when the fields of the file change

REMEDY: Final = "run: lipwright head install"


@dataclass(frozen=True, eq=False, kw_only=True)
class Head(Mesh):
    """A head at rest and its 55 blendshapes, in the order of `controls.CANONICAL`.

    The origin is the joint of head and neck.
    """

    name: str = "head"
    source: str = "MakeHuman base mesh and its ARKit face shapes"
    license: str = "CC0 1.0"
    shape_names: tuple[str, ...] = CANONICAL
    lip_pairs: NDArray[np.int32]
    """(3, 2) upper and lower inner-lip vertices: centre, left, right"""

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


_ARRAYS: Final = tuple(
    field.name for field in fields(Head) if field.default is MISSING and field.name != "parts"
)
"""what the file holds, besides the parts"""


def head_path() -> Path:
    """Where the installed head lies."""
    return data_home() / HEAD_FILE


def save_head(head: Head, path: Path) -> None:
    """Write `head` to `path`, whole or not at all.

    Raises:
        LipwrightError: the file cannot be written.
    """
    arrays = {name: getattr(head, name) for name in _ARRAYS}
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
        arrays = {name: stored[name] for name in _ARRAYS}
        parts = _parts(stored["part_names"].tolist(), stored["part_spans"].tolist())
    return Head(parts=parts, **arrays)


def _parts(names: Iterable[list[str]], spans: Iterable[list[int]]) -> tuple[Part, ...]:
    return tuple(
        Part(name, material, slice(v0, v1), slice(t0, t1))
        for (name, material), (v0, v1, t0, t1) in zip(names, spans, strict=True)
    )
