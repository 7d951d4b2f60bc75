"""Reads the JSON of Lipwright's clips: every frame (version 1) or keys with slopes (version 2)."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

FORMAT = "lipwright-clip"
VERSIONS = (1, 2)


class ClipError(Exception):
    """The file cannot be used; one line says why."""


@dataclass(frozen=True)
class Curve:
    """K keys of one control."""

    times: np.ndarray
    """(K,) s, rising"""
    values: np.ndarray
    """(K,)"""
    slopes: np.ndarray | None = None
    """(K, 2) units a second, before and after each key; None for straight lines"""

    def at(self, times: np.ndarray) -> np.ndarray:
        """The values at other times."""
        if self.slopes is None or len(self.times) == 1:
            return np.interp(times, self.times, self.values)
        when = np.clip(times, self.times[0], self.times[-1])
        left = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self.times) - 2)
        span = np.diff(self.times)[left]
        u = (when - self.times[left]) / span
        start, end = self.values[left], self.values[left + 1]
        out, into = span * self.slopes[left, 1], span * self.slopes[left + 1, 0]
        s = 1 - u
        hill = u * s * (s * out - u * into)
        return s * s * (1 + 2 * u) * start + u * u * (3 - 2 * u) * end + hill


@dataclass(frozen=True)
class ClipFile:
    """Curves with one clock."""

    fps: float
    """frames a second"""
    frames: int
    """how many there are; the last is at (frames - 1) / fps"""
    curves: dict[str, Curve]
    """control to its keys"""


def read_clip(path) -> ClipFile:
    """The clip of a file.

    Raises:
        ClipError: it cannot be read, is no Lipwright clip, or is of a newer version.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        raise ClipError(f"{path.name}: cannot be read: {error}") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise ClipError(f"{path.name}: is no Lipwright clip; export one with: -o {path.stem}.json")
    if content.get("version") not in VERSIONS:
        raise ClipError(
            f"{path.name}: is of version {content.get('version')!r}; update this add-on"
        )
    try:
        clip = _keys(content) if content["version"] == 2 else _every_frame(content)
        _check(clip)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise ClipError(f"{path.name}: is damaged ({error}); export it again") from None
    return clip


def _every_frame(content: dict) -> ClipFile:
    values = np.array(content["values"], float)
    names, fps = content["names"], float(content["fps"])
    if values.ndim != 2 or values.shape[1] != len(names):
        raise ValueError("its rows are not of one value a name")
    times = np.arange(len(values)) / fps
    curves = {}
    for name, column in zip(names, values.T, strict=True):
        moves = np.ptp(column) > 0
        curves[str(name)] = Curve(times, column) if moves else Curve(times[:1], column[:1])
    return ClipFile(fps, len(values), curves)


def _keys(content: dict) -> ClipFile:
    fps = float(content["fps"])
    curves = {}
    for name, keys in content["keys"].items():
        sides = [keys.get("slopes", keys.get(side)) for side in ("arriving", "leaving")]
        curves[name] = Curve(
            np.array(keys["frames"], float) / fps,
            np.array(keys["values"], float),
            np.array(sides, float).T,
        )
    return ClipFile(fps, int(content["frames"]), curves)


def _check(clip: ClipFile) -> None:
    if not 0 < clip.fps <= 1000 or not clip.curves or clip.frames < 1:
        raise ValueError("no rate, frames or curves")
    for name, curve in clip.curves.items():
        slopes = np.zeros((len(curve.times), 2)) if curve.slopes is None else curve.slopes
        if curve.values.shape != curve.times.shape or slopes.shape != (len(curve.times), 2):
            raise ValueError(f"the lists of {name!r} differ in length")
        if not len(curve.times) or (np.diff(curve.times) <= 0).any():
            raise ValueError(f"the times of {name!r} do not rise")
        if not (np.isfinite(curve.values).all() and np.isfinite(slopes).all()):
            raise ValueError(f"{name!r} has what is no number")
