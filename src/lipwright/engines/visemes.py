"""`Viseme`: a mouth pose for phones that look alike, and the tables of engines that have some."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import CANONICAL, both_sides

Floats = npt.NDArray[np.float64]

POSED: Final = (
    "jawOpen", "jawForward", "mouthClose", "mouthFunnel", "mouthPucker", "mouthSmile",
    "mouthStretch", "mouthFrown", "mouthDimple", "mouthRollLower", "mouthRollUpper",
    "mouthShrugUpper", "mouthPress", "mouthLowerDown", "mouthUpperUp",
    "tongueRaise", "tonguePress", "tongueBack", "tongueOut",
)  # fmt: skip
"""K controls of a viseme; one without its side means both sides, for speech is symmetric (the 2018
thesis, 4.2.2)"""


@dataclass(frozen=True)
class Viseme:
    """One row of a table."""

    name: str
    """a phone, or a class of phones"""
    part: int
    """0 for a whole phone, 1 and 2 for the halves of a diphthong"""
    example: str
    source: str
    """fitted to a real speaker, or a rule of articulation"""
    values: Mapping[str, float]
    """control of POSED to its weight, 0 to 1; what is not here it leaves to its neighbours"""
    timing: Mapping[str, float]
    """the other columns of the table"""

    def pose(self) -> Floats:
        """(K,), 0 where it says nothing."""
        return np.array([self.values.get(control, 0.0) for control in POSED])


@cache
def load_visemes(table: str, timing: tuple[str, ...] = ()) -> tuple[Viseme, ...]:
    """The rows of a table that ships with the engines.

    Args:
        table: its file.
        timing: columns beside those of every table.
    """
    text = files("lipwright.engines").joinpath(table).read_text("utf-8")
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    return tuple(
        Viseme(
            row["name"], int(row["part"]), row["example"], row["source"],
            MappingProxyType({name: float(row[name]) for name in POSED if row[name]}),
            MappingProxyType({name: float(row[name]) for name in timing}),
        )
        for row in rows
    )  # fmt: skip


def by_name(visemes: Iterable[Viseme]) -> MappingProxyType[str, tuple[Viseme, ...]]:
    """Name to its one or two rows."""
    found: dict[str, tuple[Viseme, ...]] = {}
    for viseme in visemes:
        found[viseme.name] = (*found.get(viseme.name, ()), viseme)
    return MappingProxyType(found)


_COLUMNS: Final = np.array([
    [name in both_sides(control) for name in CANONICAL] for control in POSED
], np.float64)  # fmt: skip


def to_canonical(posed: Floats) -> npt.NDArray[np.float32]:
    """(T, C) of all canonical controls, 0 to 1, from those of POSED, (T, K)."""
    return np.asarray(np.clip(posed, 0, 1) @ _COLUMNS, np.float32)
