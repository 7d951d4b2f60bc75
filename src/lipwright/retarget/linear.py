"""Linear mapping between named controls: gain, offset, clamp and correctives."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import CANONICAL, both_sides
from lipwright.rig import LinearMapping, Rig
from lipwright.rig.values import as_weights


def apply_linear(clip: Clip, rig: Rig, mapping: LinearMapping) -> Clip:
    """The canonical clip in the rig's controls, each within its clamp and range.

    A control is its offset, or its rest where it has no row, plus the gains times its sources,
    plus what correctives add.
    """
    sources = clip.select(CANONICAL).values.astype(np.float64)
    values = np.tile(rig.rest.astype(np.float64), (len(clip), 1))
    for control, row in mapping.rows.items():
        column = rig.names.index(control)
        values[:, column] = row.offset
        for source, gain in row.gains.items():
            values[:, column] += gain * _source(sources, source)
    for corrective in mapping.correctives:
        product = np.prod([_source(sources, source) for source in corrective.of], axis=0)
        values[:, rig.names.index(corrective.control)] += corrective.gain * product
    for control, row in mapping.rows.items():
        if row.clamp is not None:
            column = rig.names.index(control)
            values[:, column] = np.clip(values[:, column], *row.clamp)
    return rig.fit(Clip(rig.names, clip.fps, as_weights(values)))


def _source(values: npt.NDArray[np.float64], name: str) -> npt.NDArray[np.float64]:
    """(T,), one canonical control, or the mean of both sides of one."""
    columns = [CANONICAL.index(side) for side in both_sides(name)]
    return np.asarray(values[:, columns].mean(axis=1))
