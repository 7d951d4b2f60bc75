"""What engines are measured by: the measures, and their rows over recordings.

Every measure is a ratio of two sums over recordings: squared error over frames, closures made over
closures, false closures over seconds, r over recordings. So it can be pooled, drawn again for an
interval, and compared between engines on the same recordings.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Better = Literal["lower", "higher", "zero"]
Group = Literal["error", "lips"]


@dataclass(frozen=True)
class Measure:
    """One figure."""

    name: str
    title: str
    """for people"""
    unit: str
    """empty for none"""
    better: Better
    group: Group
    """error: against the parameters of a reference face; lips: against the tracked lips"""
    about: str
    """how it is measured, a sentence"""


MEASURES: Final[Mapping[str, Measure]] = MappingProxyType({
    measure.name: measure for measure in (
        Measure("joint_sd", "parameters, each over its deviation", "sd²", "lower", "error",
                "Mean squared error of the joint modes, each over its standard deviation."),
        Measure("joint", "parameters", "", "lower", "error",
                "Mean squared error of the joint modes as they are: the large modes weigh most."),
        Measure("shape", "shape modes", "", "lower", "error",
                "Mean squared error of the shape modes as they are."),
        Measure("vertices", "vertices", "eye distances²", "lower", "error",
                "Mean squared distance of the 34 vertices from the tracked ones."),
        Measure("inner", "pixels, inner mouth", "grey levels²", "lower", "error",
                "Mean squared error of the drawn inner mouth, where it is seen."),
        Measure("outer", "pixels, the rest", "grey levels²", "lower", "error",
                "Mean squared error of the drawn face around the mouth."),
        Measure("face_r", "r of the aperture, reference face", "", "higher", "error",
                "Correlation of the aperture of predicted and tracked vertices in speech."),
        Measure("r", "r of the aperture", "", "higher", "lips",
                "Correlation with the tracked lips in speech, on the clock of the video, no lag."),
        Measure("r_best_lag", "r at the best lag", "", "higher", "lips",
                "The same at the best lag of each recording within 0.2 s."),
        Measure("lag", "lag", "ms", "zero", "lips",
                "The best lag; above 0 where the animation is late."),
        Measure("closures", "closures", "", "higher", "lips",
                "Of the p, b, m at which the real lips close, the share that close within 40 ms."),
        Measure("false_closures", "false closures", "1/s", "lower", "lips",
                "Shut for 30 ms or more while the real lips stay open, a second of speech."),
        Measure("silence", "opening in silence", "", "lower", "lips",
                "Mean aperture in silence over the clip's 95th percentile."),
    )
})  # fmt: skip
"""name to measure, in the order of tables"""


@dataclass(frozen=True, eq=False)
class Rows:
    """A measure of S recordings: what is summed, and over how much.

    Raises:
        ValueError: the shapes differ, a number is not finite, or a count is below 0.
    """

    sums: Floats
    """(S,)"""
    counts: Floats
    """(S,), 0 where a recording has none of it"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        sums, counts = np.array(self.sums, float), np.array(self.counts, float)
        if sums.shape != counts.shape or sums.ndim != 1:
            raise ValueError(f"sums {sums.shape} and counts {counts.shape} are not both (S,)")
        if not (np.isfinite(sums).all() and np.isfinite(counts).all()) or (counts < 0).any():
            raise ValueError("a sum or count is not finite, or a count is below 0")
        for name, array in (("sums", sums), ("counts", counts)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def value(self) -> float:
        """The figure over all recordings; NaN where there is nothing."""
        total = float(self.counts.sum())
        return float(self.sums.sum()) / total if total else float("nan")

    @property
    def each(self) -> Floats:
        """(S,) the figure of each recording, NaN where it has none."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.counts > 0, self.sums / self.counts, np.nan)


Scores = Mapping[str, Rows]
"""name of a measure to its rows, all over the same recordings in the same order"""
