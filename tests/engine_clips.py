"""Clips that tests of exports for engines and 3D programs share."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import PPoly

from lipwright.clip import Clip
from lipwright.export import Performance
from lipwright.export.jsonclip import read_performance_json
from lipwright.rig import Bone, Control, Rig

BOUND = 0.01  # of sparse keys
HELLO_CLIP = Path(__file__).parents[1] / "examples" / "hello.clip.json"


def wave(name: str, fps: float, frames: int = 150) -> np.ndarray:
    """A smooth curve from 0 to 1 that each name has another one of."""
    speed = 1 + sum(map(ord, name)) % 7
    return 0.5 + 0.5 * np.sin(np.arange(frames) / fps * speed + len(name))


def waves(*names: str, fps: float = 60.0, frames: int = 150, still: str = "still") -> Clip:
    """Waves, and a control that stays at 0.25."""
    values = [wave(name, fps, frames) for name in names]
    values += [np.full(frames, 0.25)] if still else []
    return Clip((*names, *([still] if still else [])), fps, np.stack(values, axis=1))


def jaw_of_bones() -> Performance:
    """A blendshape and a jaw that turns, pushed forward, below a head that stays."""
    names = ("smile", "jaw.tz", "jaw.rx", "jaw.rz", "head.rx")
    values = np.stack([wave(name, 30, 40) for name in names], axis=1)
    values[:, 1] *= 0.01  # m
    values[:, 2] *= 20  # degrees
    values[:, 3] *= -15
    values[:, 4] = 0
    rig = Rig(
        "puppet",
        tuple(Control(name, -90, 90) for name in names),
        {},
        bones=(Bone("head", "", (0, 0.1, 0.0)), Bone("jaw", "head", (0.01, 0.06, 0.02))),
    )
    return Performance(Clip(names, 30, values), rig=rig)


def least_at_closures(curve: np.ndarray) -> list[float]:
    """The least value of a curve (T,) in the time of each p, b and m of `HELLO_CLIP`."""
    performance = read_performance_json(HELLO_CLIP)
    track, fps = performance.track, performance.clip.fps
    assert track is not None
    return [
        float(curve[int(start * fps) : int(np.ceil(end * fps))].min())
        for phone, start, end in zip(track.phones, track.edges[:-1], track.edges[1:], strict=True)
        if phone in {"P", "B", "M"}
    ]


def hermite(
    times: np.ndarray, values: np.ndarray, before: np.ndarray, after: np.ndarray, when: np.ndarray
) -> np.ndarray:
    """Cubic spans with slopes before and after each key, a second implementation on scipy's."""
    if len(times) == 1:
        return np.full(len(when), values[0])
    span = np.diff(times)
    start, end, out, into = values[:-1], values[1:], after[:-1] * span, before[1:] * span
    coefficients = np.stack(
        [
            (2 * start - 2 * end + out + into) / span**3,
            (-3 * start + 3 * end - 2 * out - into) / span**2,
            out / span,
            start,
        ]
    )
    found: np.ndarray = PPoly(coefficients, times)(np.clip(when, times[0], times[-1]))
    return found
