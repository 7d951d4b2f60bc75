"""`ReferenceShape`: the shape modes of a recorded speaker, and how curves show them.

What retargeting by poses needs of a reference face (Taylor et al. 2017, section 6): the mean shape,
its first modes and their standard deviations; the affine map from canonical controls to those
modes; and the canonical weights that show each pose on a human face. `bench/reference_shape.py`
makes the file of one out of a captured dataset.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.face.appearance import check_modes
from lipwright.face.vertices import LIP_PAIRS, N

if TYPE_CHECKING:
    from lipwright.face.reference import ReferenceFace

Floats = npt.NDArray[np.float64]

FORMAT: Final = "lipwright-shape"
VERSION: Final = 1  # raise when the fields of the file change
MAX_BYTES: Final = 16_000_000  # of a file; those that ship have some hundred thousand
SHAPES: Final = ("grid-s1",)
"""names of the reference shapes that ship"""

MEAN: Final = "mean"  # the name of the mean pose in tables and files
SHUT: Final = "shut"  # that of the pose with the lips shut
_MODE: Final = re.compile(r"shape([1-9][0-9]{0,3})")


@dataclass(frozen=True, eq=False)
class ReferenceShape:
    """The mean and M modes of 34 vertices; all arrays are read-only.

    Raises:
        ValueError: the arrays do not fit together.
    """

    name: str
    source: str
    """whose face, and what was done with it"""
    license: str
    """terms of use, in a few words"""
    mean: Floats
    """(34, 2) eye distances from midway between the eyes' centres; x to the right in the picture,
    y down"""
    modes: Floats
    """(M, 34, 2), orthonormal"""
    sd: Floats
    """(M,) standard deviations of the parameters, eye distances, falling"""
    gains: Floats
    """(C, M) standard deviations that a canonical control at 1 adds to each mode"""
    offset: Floats
    """(M,) standard deviations where all canonical controls rest: the speaker's shut rest face"""
    opening: Floats
    """(C,) eye distances that a canonical control at 1 adds to the gap of the lips"""
    human: Mapping[str, Mapping[str, float]]
    """`mean`, `shut` and poses such as `mode1-3`, to the canonical weights that show them best"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        for name in ("mean", "modes", "sd", "gains", "offset", "opening"):
            array = np.array(getattr(self, name), np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.mean.shape != (N, 2) or not np.isfinite(self.mean).all():
            raise ValueError(f"the mean shape is {self.mean.shape}, not ({N}, 2) numbers")
        check_modes("shape", self.modes, self.sd, (N, 2))
        wanted = {"gains": (len(CANONICAL), len(self)), "offset": (len(self),),
                  "opening": (len(CANONICAL),)}  # fmt: skip
        for name, size in wanted.items():
            array = getattr(self, name)
            if array.shape != size or not np.isfinite(array).all():
                raise ValueError(f"{name} are {array.shape}, not {size} numbers")
        for pose, weights in self.human.items():
            if unknown := sorted(set(weights) - set(CANONICAL)):
                raise ValueError(f"the pose {pose!r} has {unknown[0]!r}, no canonical control")
        human = {pose: MappingProxyType(dict(weights)) for pose, weights in self.human.items()}
        object.__setattr__(self, "human", MappingProxyType(human))

    def __len__(self) -> int:
        """The number of modes, M."""
        return len(self.modes)

    def points(self, p: npt.ArrayLike) -> Floats:
        """The vertices (..., 34, 2) of p (..., m) standard deviations of the first m modes."""
        p = np.asarray(p, np.float64)
        count = p.shape[-1]
        moved = (p * self.sd[:count]) @ self.modes[:count].reshape(count, -1)
        return np.asarray(self.mean + moved.reshape(*p.shape[:-1], N, 2))

    def project(self, points: npt.ArrayLike) -> Floats:
        """The standard deviations (..., M) of vertices (..., 34, 2)."""
        apart = np.asarray(points, np.float64) - self.mean
        flat = apart.reshape(*apart.shape[:-2], -1)
        return np.asarray(flat @ self.modes.reshape(len(self), -1).T / self.sd)

    def pose(self, mode: int, sigma: float) -> Floats:
        """(M,), `sigma` standard deviations of one mode, numbered from 1, and the mean of others.

        Raises:
            ValueError: there is no such mode.
        """
        if not 1 <= mode <= len(self):
            raise ValueError(f"no shape mode {mode}; they are 1 to {len(self)}")
        return np.asarray(sigma * np.eye(len(self))[mode - 1])

    def parameters(self, clip: Clip) -> Floats:
        """(T, M), the standard deviations of curves: `shape1` and on, or canonical controls.

        Modes that a clip of modes lacks are at the mean.

        Raises:
            LipwrightError: the clip has neither.
        """
        if _is_of_modes(clip):
            names = tuple(f"shape{number}" for number in range(1, len(self) + 1))
            return clip.select(names).values.astype(np.float64)
        self._check_canonical(clip)
        return np.asarray(clip.select(CANONICAL).values @ self.gains + self.offset)

    def gap(self, clip: Clip) -> Floats:
        """(T,), eye distances between the inner lips, 0 where they meet, below where they press.

        Raises:
            LipwrightError: the clip has neither shape modes nor canonical controls.
        """
        if _is_of_modes(clip):
            shut = lip_gap(self.points(self.offset))
            return np.asarray(lip_gap(self.points(self.parameters(clip))) - shut)
        self._check_canonical(clip)
        return np.asarray(clip.select(CANONICAL).values @ self.opening)

    def _check_canonical(self, clip: Clip) -> None:
        if not set(clip.names) & set(CANONICAL):
            raise LipwrightError(
                f"curves of {', '.join(clip.names[:3])}... show no shape modes of "
                f"{self.name}; give canonical ones, such as jawOpen, or shape1 to shape{len(self)}"
            )


def lip_gap(points: npt.NDArray[np.floating[Any]]) -> Floats:
    """(...,), how far the inner lips of shapes (..., 34, 2) are apart; below 0 they overlap."""
    heights = points[..., 1]
    return np.asarray((heights[..., LIP_PAIRS[:, 1]] - heights[..., LIP_PAIRS[:, 0]]).mean(axis=-1))


def _is_of_modes(clip: Clip) -> bool:
    return any(_MODE.fullmatch(name) for name in clip.names)


def to_shape_modes(clip: Clip, face: ReferenceFace, shape: ReferenceShape) -> Clip:
    """The curves of a reference face's modes, `joint1` and on, as `shape1` and on of `shape`.

    Faces of other speakers are told by how their vertices leave their own mean.

    Raises:
        LipwrightError: the clip has controls that are no modes of the face.
    """
    from lipwright.face.faceclip import clip_to_parameters

    moved = face.points(clip_to_parameters(face, clip).shape) - face.mean_shape
    names = tuple(f"shape{number}" for number in range(1, len(shape) + 1))
    return Clip(names, clip.fps, shape.project(shape.mean + moved).astype(np.float32))


def load_reference_shape(name: str | Path = SHAPES[0]) -> ReferenceShape:
    """A reference shape that ships, by name, or that of a JSON file.

    Raises:
        LipwrightError: no such shape, lists the known ones; or the file cannot be used.
    """
    if str(name) in SHAPES:
        return _shipped(str(name))
    path = Path(name)
    if path.suffix != ".json":
        raise LipwrightError(
            f"no reference shape {str(name)!r}; there are {', '.join(SHAPES)}, or name a .json file"
        )
    if path.exists() and not (path.is_file() and path.stat().st_size <= MAX_BYTES):
        raise LipwrightError(f"{path}: is no file, or too large; name a reference shape")
    try:
        return _from_json(json.loads(path.read_text("utf-8")))
    except OSError as error:
        raise LipwrightError(
            f"{path}: cannot be read ({error.strerror}); name a reference shape"
        ) from error
    except LipwrightError as error:
        raise LipwrightError(f"{path}: {error}") from error
    except (
        LookupError,
        TypeError,
        ValueError,
        ArithmeticError,
        AttributeError,
        RecursionError,
    ) as error:
        raise LipwrightError(
            f"{path}: is no reference shape ({error}); make it with bench/reference_shape.py"
        ) from error


@cache
def _shipped(name: str) -> ReferenceShape:
    text = files("lipwright.face").joinpath(f"{name}.json").read_text("utf-8")
    return _from_json(json.loads(text))


def _from_json(data: Any) -> ReferenceShape:
    if data["format"] != FORMAT:
        raise ValueError(f"format {str(data['format'])[:40]!r}")
    if data["version"] != VERSION:
        raise LipwrightError(
            f"is a reference shape of version {str(data['version'])[:24]}, and this Lipwright "
            f"reads {VERSION}; run: pip install --upgrade lipwright"
        )
    sd = np.asarray(data["sd"], np.float64)
    gains = {name: np.asarray(row, np.float64) for name, row in data["gains"].items()}
    still = np.zeros(len(sd))
    return ReferenceShape(
        name=str(data["name"]),
        source=str(data["source"]),
        license=str(data["license"]),
        mean=np.asarray(data["mean"]).reshape(N, 2),
        modes=np.asarray(data["modes"]).reshape(len(sd), N, 2),
        sd=sd,
        gains=np.stack([gains.get(name, still) for name in CANONICAL]),
        offset=np.asarray(data["offset"]),
        opening=np.array([data["opening"].get(name, 0.0) for name in CANONICAL]),
        human=data["human"],
    )


def shape_to_text(shape: ReferenceShape) -> str:
    """The JSON of a reference shape: one mode, control or pose a line."""

    def row(values: npt.ArrayLike, decimals: int) -> str:
        numbers = np.round(np.asarray(values, np.float64).ravel(), decimals) + 0.0  # no -0.0
        return json.dumps(numbers.tolist())

    def table(rows: Mapping[str, str]) -> str:
        return "{\n" + ",\n".join(f"    {json.dumps(k)}: {v}" for k, v in rows.items()) + "\n  }"

    modes = ",\n".join(f"    {row(mode, 6)}" for mode in shape.modes)
    moved = [(i, name) for i, name in enumerate(CANONICAL) if shape.gains[i].any()]
    opened = {n: round(float(shape.opening[i]), 6) for i, n in enumerate(CANONICAL)}
    fields = {
        "format": json.dumps(FORMAT),
        "version": str(VERSION),
        "name": json.dumps(shape.name),
        "source": json.dumps(shape.source, ensure_ascii=False),
        "license": json.dumps(shape.license, ensure_ascii=False),
        "mean": row(shape.mean, 6),
        "sd": row(shape.sd, 6),
        "modes": f"[\n{modes}\n  ]",
        "offset": row(shape.offset, 4),
        "gains": table({name: row(shape.gains[i], 4) for i, name in moved}),
        "opening": json.dumps({name: value for name, value in opened.items() if value}),
        "human": table({pose: json.dumps(dict(w)) for pose, w in shape.human.items()}),
    }
    return "{\n" + ",\n".join(f'  "{key}": {value}' for key, value in fields.items()) + "\n}\n"
