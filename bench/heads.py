"""The two heads that curves are measured on: ours, and the ruler head's lip points."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from grid import CORPORA
from lipwright.clip import Clip
from lipwright.controls import CANONICAL

# iBUG points of the inner lips (upper, lower) and of the eyes.
PAIRS = ((61, 67), (62, 66), (63, 65))
EYES = (slice(36, 42), slice(42, 48))

Ruler = Callable[[Clip], npt.NDArray[np.float64]]
"""clip to its aperture (T,)"""


def our_head() -> Ruler:
    """The installed head."""
    from lipwright.face.head import load_head

    head = load_head()
    return lambda clip: np.asarray(head.aperture_curve(clip.select(CANONICAL).values), float)


def _frontal_aperture(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    flat = points[..., :2]
    eyes = np.linalg.norm(flat[:, EYES[0]].mean(1) - flat[:, EYES[1]].mean(1), axis=-1)
    gaps = [np.linalg.norm(flat[:, a] - flat[:, b], axis=-1) for a, b in PAIRS]
    return np.asarray(np.mean(gaps, axis=0) / eyes)


def ruler_head(corpora: Path = CORPORA) -> Ruler:
    """The second head, seen from the front as a camera would.

    Its inner-lip points lie on two surfaces and are apart by 0.015 eye distances while its lips
    touch; that gap is taken off, as a tracker's points fall together on shut lips.
    """
    data = np.load(corpora / "rulers" / "ict-landmarks.npz")
    neutral, deltas = data["neutral"].astype(float), data["deltas"].astype(float)
    names = [str(n).replace("_L", "Left").replace("_R", "Right") for n in data["names"]]
    # ARKit has one inner brow control, the ruler two halves.
    targets = ["browInnerUp" if n.startswith("browInnerUp") else n for n in names]
    resting = float(_frontal_aperture(neutral[None])[0])

    def measure(clip: Clip) -> npt.NDArray[np.float64]:
        weights = np.stack([clip.select([n]).values[:, 0] for n in targets], axis=1)
        points = neutral + np.einsum("tc,cpx->tpx", weights.astype(float), deltas)
        return np.maximum(_frontal_aperture(points) - resting, 0)

    return measure


def rulers(corpora: Path = CORPORA) -> dict[str, Ruler]:
    """Name to ruler."""
    return {"our head": our_head(), "ruler head": ruler_head(corpora)}
