"""`ReferenceFace`: the statistical model of a recorded speaker's lower face.

After Taylor et al. 2017, section 4.1: N = 34 vertices vary in M shape modes; the pixels of k = 2
regions, the inner mouth and the rest, sampled at the mean shape, vary in modes of their own; q
joint modes (equation 1) tie all three together, since lips, teeth and skin move as one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt

from lipwright.face.appearance import Appearance, Values, check_modes
from lipwright.face.vertices import HULL, LOWER_INNER, UPPER_INNER, N, aperture

Kind = Literal["shape", "inner", "outer", "joint"]
Floats = npt.NDArray[np.float32]
PARTS: Final[tuple[Kind, ...]] = ("shape", "inner", "outer")

VISIBLE: Final = 0.03  # eye distances of aperture from which the inner mouth is seen
APART: Final = 0.01  # eye distances of aperture from which there is something between the lips


@dataclass(frozen=True, eq=False)
class FaceParameters:
    """What the face does: parameters of shape and of the two regions.

    Raises:
        ValueError: the parts differ in their leading axes.
    """

    shape: Floats
    """(..., M) eye distances, in the norm of all 68 coordinates"""
    inner: Floats
    """(..., n1) grey levels, in the norm of all values of the inner mouth"""
    outer: Floats
    """(..., n2) the same of the rest"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        for name in PARTS:
            array = np.array(getattr(self, name), np.float32)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if not self.shape.shape[:-1] == self.inner.shape[:-1] == self.outer.shape[:-1]:
            raise ValueError("parameters of shape and appearance differ in their frames")

    def __getitem__(self, index: Any) -> FaceParameters:
        """Those of one frame, or of some."""
        return FaceParameters(self.shape[index], self.inner[index], self.outer[index])


@dataclass(frozen=True, eq=False)
class ReferenceFace:
    """The model; all arrays are read-only.

    Raises:
        ValueError: the arrays do not fit together.
    """

    mean_shape: Floats
    """(34, 2) eye distances from midway between the eyes' centres; x to the right in the picture,
    y down"""
    depth: Floats
    """(34,) eye distances, mean depth of the vertices, away from the camera"""
    shape_modes: Floats
    """(M, 34, 2), orthonormal"""
    shape_sd: Floats
    """(M,) standard deviations of the parameters, falling"""
    inner: Appearance
    """the inner mouth, out of the frames that show it"""
    outer: Appearance
    """the rest of the lower face"""
    weight: float
    """w of equation 1: grey levels an eye distance"""
    joint_mean: Floats
    """(M + n1 + n2,) of weighted shape and of appearance parameters"""
    joint_modes: Floats
    """(q, M + n1 + n2), orthonormal"""
    joint_sd: Floats
    """(q,) standard deviations of the parameters, falling"""
    info: Mapping[str, Any] = field(default_factory=dict)
    """what it was made from and how well it fits; plain JSON"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        for name in ("mean_shape", "depth", "shape_modes", "shape_sd",
                     "joint_mean", "joint_modes", "joint_sd"):  # fmt: skip
            array = np.array(getattr(self, name), np.float32)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.mean_shape.shape != (N, 2) or not np.isfinite(self.mean_shape).all():
            raise ValueError(f"the mean shape is {self.mean_shape.shape}, not ({N}, 2) numbers")
        if self.depth.shape != (N,) or not np.isfinite(self.depth).all():
            raise ValueError(f"depths are {self.depth.shape}, not ({N},) numbers")
        check_modes("shape", self.shape_modes, self.shape_sd, (N, 2))
        size = (sum(self.sizes),)
        if self.joint_mean.shape != size or not np.isfinite(self.joint_mean).all():
            raise ValueError(f"the joint mean is {self.joint_mean.shape}, not {size} numbers")
        check_modes("joint", self.joint_modes, self.joint_sd, size)
        if not 0 < self.weight < np.inf:
            raise ValueError(f"the weight of the shape is {self.weight}, not above 0")

    @property
    def sizes(self) -> tuple[int, int, int]:
        """The numbers of modes M, n1 and n2."""
        return len(self.shape_modes), len(self.inner), len(self.outer)

    def sd(self, kind: Kind) -> Floats:
        """The standard deviations of a kind of parameters."""
        return {
            "shape": self.shape_sd, "inner": self.inner.sd, "outer": self.outer.sd,
            "joint": self.joint_sd,
        }[kind]  # fmt: skip

    def join(self, parameters: FaceParameters) -> Floats:
        """The joint parameters y (..., q)."""
        parts = (self.weight * parameters.shape, parameters.inner, parameters.outer)
        apart = np.concatenate(parts, axis=-1) - self.joint_mean
        return np.asarray(apart @ self.joint_modes.T, np.float32)

    def split(self, y: npt.ArrayLike) -> FaceParameters:
        """The parameters of shape and appearance that joint parameters (..., q) stand for."""
        parts = np.asarray(y, np.float32) @ self.joint_modes + self.joint_mean
        shapes, inner, _ = self.sizes
        return FaceParameters(
            parts[..., :shapes] / np.float32(self.weight),
            parts[..., shapes : shapes + inner],
            parts[..., shapes + inner :],
        )

    def project_shape(self, points: npt.ArrayLike) -> Floats:
        """The shape parameters (..., M) of vertices (..., 34, 2)."""
        apart = np.asarray(points, np.float32) - self.mean_shape
        return np.asarray(
            apart.reshape(*apart.shape[:-2], -1) @ self.shape_modes.reshape(-1, N * 2).T
        )

    def points(self, shape: npt.ArrayLike) -> Floats:
        """The vertices (..., 34, 2) of shape parameters (..., M)."""
        shape = np.asarray(shape, np.float32)
        flat = shape @ self.shape_modes.reshape(-1, N * 2)
        return np.asarray(self.mean_shape + flat.reshape(*shape.shape[:-1], N, 2))

    def to_shape(self, y: npt.ArrayLike) -> Floats:
        """The vertices (..., 34, 2) of joint parameters (..., q)."""
        return self.points(self.split(y).shape)

    def to_pixels(self, y: npt.ArrayLike) -> npt.NDArray[np.uint8]:
        """Pictures (..., H, W, 3) of joint parameters (..., q), all warped to the mean shape."""
        y = np.asarray(y, np.float32)
        parameters, grid = self.split(y.reshape(-1, y.shape[-1])), self.outer.grid
        at = grid.to_pixels(self.mean_shape)
        drawn = [self.draw(parameters[index], at, grid.size)[0] for index in range(y[..., 0].size)]
        return np.stack(drawn).reshape(*y.shape[:-1], *drawn[0].shape)

    def draw(
        self, parameters: FaceParameters, points: Values, size: tuple[int, int],
        light: npt.ArrayLike = 1.0,
    ) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.bool_]]:  # fmt: skip
        """The appearance of one frame, warped to a shape in a picture.

        The inner mouth is drawn where the lips are apart; else they meet.

        Args:
            parameters: of one frame; the shape among them is not used.
            points: (34, 2) pixels, where the vertices are to lie.
            size: width and height of the picture.
            light: (3,) red, green and blue of a recording over those of the model.

        Returns:
            (H, W, 3) sRGB, black outside; (H, W) where it was drawn.
        """
        points = np.asarray(points, np.float64)
        unit = np.linalg.norm(np.ptp(points[HULL], axis=0)) / self._hull_size
        is_open = aperture(points) > APART * unit
        canvas = np.full((size[1], size[0], 3), np.nan, np.float32)
        if is_open:
            self.inner.grid.paint(canvas, points, self.inner.pixels(parameters.inner))
        self.outer.grid.paint(
            canvas, points if is_open else meeting(points), self.outer.pixels(parameters.outer)
        )
        drawn = ~np.isnan(canvas[..., 0])
        canvas[~drawn] = 0
        canvas *= np.asarray(light, np.float32)
        return np.clip(np.rint(canvas), 0, 255).astype(np.uint8), drawn

    @property
    def _hull_size(self) -> float:
        return float(np.linalg.norm(np.ptp(self.mean_shape[HULL], axis=0)))

    def project(
        self, points: npt.ArrayLike, picture: npt.NDArray[np.uint8], at: Values,
        light: npt.ArrayLike = 1.0,
    ) -> npt.NDArray[np.float32]:  # fmt: skip
        """The joint parameters (q,) of one frame.

        Where the lips are shut, the inner mouth is taken for the mean; over time,
        `lipwright.capture` fills it from the frames before and after.

        Args:
            points: (34, 2) the vertices without the head's pose, eye distances.
            picture: (H, W, 3) sRGB.
            at: (34, 2) pixels, the vertices in the picture.
            light: (3,) red, green and blue of the recording over those of the model.
        """
        points, light = np.asarray(points, np.float32), np.asarray(light, np.float32)
        inner: Floats = np.zeros(len(self.inner), np.float32)
        if aperture(points) >= VISIBLE:
            inner = self.inner.project(self.inner.grid.sample(picture, at) / light)
        outer = self.outer.project(self.outer.grid.sample(picture, at) / light)
        return self.join(FaceParameters(self.project_shape(points), inner, outer))

    def pose(self, mode: int, sigma: float, kind: Kind = "joint") -> FaceParameters:
        """The mean face but for one mode, `sigma` standard deviations from the mean.

        Args:
            mode: from 0 on.
            sigma: Taylor et al. show -3 and 3.
            kind: joint modes move shape and appearance; modes of the others only their part, as
                the poses of section 6 do.

        Raises:
            ValueError: there is no such mode.
        """
        sd = self.sd(kind)
        if not 0 <= mode < len(sd):
            raise ValueError(f"no {kind} mode {mode}; they are 0 to {len(sd) - 1}")
        y = np.zeros(len(sd), np.float32)
        y[mode] = sigma * sd[mode]
        if kind == "joint":
            return self.split(y)
        zeros = {part: np.zeros(len(self.sd(part)), np.float32) for part in PARTS}
        return FaceParameters(**{**zeros, kind: y})

    def summary(self) -> dict[str, str]:
        """What the model is made of, a line each."""
        facts = self.info.get("modes", {})
        shape, inner, outer = self.sizes

        def modes(name: str, count: int) -> str:
            share = facts.get(name, {}).get("share")
            return f"{count}" if share is None else f"{count}, {share:.1%} of the variance"

        energy = np.square(self.shape_sd) / np.square(self.shape_sd).sum()
        return {
            "vertices": f"{N}",
            "shape modes": modes("shape", shape),
            "first four of them": f"{energy[:4].sum():.1%} of what the modes hold",
            "inner mouth": f"{self.inner.grid.count} pixels, modes: {modes('inner', inner)}",
            "rest of the lower face": f"{self.outer.grid.count} pixels, modes: "
            f"{modes('outer', outer)}",
            "joint modes": modes("joint", len(self.joint_modes)),
            "dataset": str(self.info.get("dataset", "")),
            "licence": str(self.info.get("licence", "")),
        }


def meeting(points: Values) -> Values:
    """The shape (34, 2) with the inner lips brought together, halfway."""
    shut = np.array(points)
    shut[UPPER_INNER] = shut[LOWER_INNER] = (points[UPPER_INNER] + points[LOWER_INNER]) / 2
    return shut
