"""`Appearance`: how the pixels of a region of the reference face vary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.face.warp import Grid

Values = npt.NDArray[np.floating[Any]]

LUMA: Final = np.array([0.299, 0.587, 0.114], np.float32)  # ITU-R BT.601, section 2.5.1


def check_modes(name: str, modes: Values, sd: Values, tail: tuple[int, ...]) -> None:
    """Refuse modes that are not orthonormal rows with falling standard deviations.

    Raises:
        ValueError: what is wrong with them.
    """
    if modes.shape[1:] != tail or len(modes) == 0 or sd.shape != (len(modes),):
        raise ValueError(f"{name} modes are {modes.shape} with {sd.shape} deviations, not {tail}")
    if not np.isfinite(modes).all() or not np.isfinite(sd).all():
        raise ValueError(f"{name} modes are not finite")
    if not (sd > 0).all() or (np.diff(sd) > 0).any():
        raise ValueError(f"the standard deviations of the {name} modes do not fall to above 0")
    flat = modes.reshape(len(modes), -1)
    if not np.allclose(flat @ flat.T, np.eye(len(flat)), atol=1e-2):
        raise ValueError(f"{name} modes are not orthonormal")


@dataclass(frozen=True, eq=False)
class Appearance:
    """P pixels of one region, their mean and n modes of variation.

    Raises:
        ValueError: the arrays do not fit together.
    """

    grid: Grid
    """where the P pixels lie"""
    mean: npt.NDArray[np.float32]
    """(P, 3) sRGB, 0 to 255"""
    modes: npt.NDArray[np.float32]
    """(n, P, 3), orthonormal"""
    sd: npt.NDArray[np.float32]
    """(n,) standard deviations of the parameters, falling; their unit is a grey level, in the norm
    of all P x 3 values"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        pixels = (self.grid.count, 3)
        for name in ("mean", "modes", "sd"):
            array = np.array(getattr(self, name), np.float32)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.mean.shape != pixels or not np.isfinite(self.mean).all():
            raise ValueError(f"the mean of a region is {self.mean.shape}, not {pixels} numbers")
        check_modes("appearance", self.modes, self.sd, pixels)

    def __len__(self) -> int:
        """The number of modes, n."""
        return len(self.modes)

    def project(self, pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
        """The parameters (..., n) of pixels (..., P, 3)."""
        apart = np.asarray(pixels, np.float32) - self.mean
        flat = apart.reshape(*apart.shape[:-2], -1)
        return np.asarray(flat @ self.modes.reshape(len(self), -1).T)

    def project_channels(self, pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
        """What red, green and blue of pixels (T, P, 3) add to the parameters: (T, n, 3).

        Their sum less `mean_parameters` is what `project` gives.
        """
        channels = np.ascontiguousarray(np.moveaxis(np.asarray(pixels, np.float32), -1, 0))
        return np.stack([c @ m.T for c, m in zip(channels, self._by_channel, strict=True)], axis=-1)

    @cached_property
    def _by_channel(self) -> npt.NDArray[np.float32]:
        """(3, n, P) the modes, so stored that products with them are fast."""
        return np.ascontiguousarray(np.moveaxis(self.modes, -1, 0))

    @cached_property
    def mean_parameters(self) -> npt.NDArray[np.float32]:
        """(n,) the modes' share of the mean."""
        return np.asarray(self.modes.reshape(len(self), -1) @ self.mean.reshape(-1))

    def pixels(self, parameters: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """The pixels (..., P, 3) of parameters (..., n), not yet clipped to 0 to 255."""
        parameters = np.asarray(parameters, np.float32)
        flat = parameters @ self.modes.reshape(len(self), -1)
        return np.asarray(self.mean + flat.reshape(*parameters.shape[:-1], *self.mean.shape))

    def grey(self, parameters: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """The grey levels (..., P) of parameters (..., n), clipped to 0 to 255."""
        mean, modes = self._in_grey
        found = np.asarray(parameters, np.float32) @ modes
        found += mean
        return np.asarray(np.clip(found, 0, 255, out=found))

    @cached_property
    def _in_grey(self) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
        """(P,) the mean and (n, P) the modes, without colour."""
        return self.mean @ LUMA, np.ascontiguousarray(self.modes @ LUMA)
