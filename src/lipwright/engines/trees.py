"""The trees engine: regression trees that predict the motion around each frame from what is said.

After Kim, Yue, Taylor and Matthews, "A decision tree framework for spatiotemporal sequence
prediction" (2015), as Taylor et al. 2017, section 8.1, ran it: each frame's window of phones leads
to a leaf, whose mean window of motion is the prediction, and where windows overlap a frame is
their mean. Of several trees it is the mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.engines.learnt import arrange, clip_names, open_arrays_of
from lipwright.engines.window import curves_of, frames_of
from lipwright.errors import LipwrightError
from lipwright.network.arrays import ArrayModel
from lipwright.network.folder import REMEDY
from lipwright.network.meta import ARRAYS_FILE
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.audio import Sound

Times = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]
Indices = npt.NDArray[np.integer[Any]]

MAX_DEPTH: Final = 256  # questions from a root to a leaf; a damaged file could ask without end
MAX_TREES: Final = 1000  # of a forest, all asked for each of many windows
LEAF: Final = -1  # the column that a leaf asks for


@dataclass(frozen=True, eq=False)
class Forest:
    """R trees in one list of B nodes, of which L are leaves; a node comes after its parent.

    Raises:
        ValueError: the arrays are no such trees.
    """

    roots: Indices
    """(R,) the first node of each tree"""
    columns: Indices
    """(B,) the column of a window, of D, that a node asks for; LEAF at leaves"""
    thresholds: Values
    """(B,) a window whose column is at most this goes `low`, else `high`"""
    low: Indices
    """(B,) a node; at leaves the row of `leaves`"""
    high: Indices
    """(B,) a node; at leaves 0"""
    leaves: Values
    """(L, Ky, C), the mean windows of motion, each in the controls' own range"""
    width: int
    """D"""

    def __post_init__(self) -> None:
        """Check that every way ends at a leaf, after MAX_DEPTH questions at most."""
        asks = np.flatnonzero(self.columns != LEAF)
        ends = np.flatnonzero(self.columns == LEAF)
        below = np.concatenate([self.low[asks], self.high[asks]])
        begun = np.concatenate([self.roots, below])
        _need_within("columns", self.columns[asks], self.width)
        _need_within("roots", self.roots, len(self.columns))
        _need_within("children", below, len(self.columns))
        _need_within("leaves", self.low[ends], len(self.leaves))
        if not len(self.roots):
            raise ValueError("there is no tree")
        if len(self.roots) > MAX_TREES:
            raise ValueError(f"there are {len(self.roots)} trees, more than {MAX_TREES}")
        if not (below > np.concatenate([asks, asks])).all():
            raise ValueError("a child comes before its parent")
        if (np.bincount(begun, minlength=len(self.columns)) != 1).any():
            raise ValueError("a node is the child of two others, or of none")
        level = self.roots
        for _ in range(MAX_DEPTH):
            level = level[self.columns[level] != LEAF]
            if not len(level):
                return
            level = np.concatenate([self.low[level], self.high[level]])
        if (self.columns[level] != LEAF).any():
            raise ValueError(f"a tree asks more than {MAX_DEPTH} questions")

    def find(self, windows: Values) -> npt.NDArray[np.int64]:
        """(N, R), the row of `leaves` that each window (N, D) comes to in each tree."""
        count = len(self.roots)
        node = np.tile(self.roots.astype(np.int64), len(windows))
        going = np.arange(len(node))
        while len(going):
            at = node[going]
            inner = self.columns[at] != LEAF
            going, at = going[inner], at[inner]
            answer = windows[going // count, self.columns[at]] <= self.thresholds[at]
            node[going] = np.where(answer, self.low[at], self.high[at])
        return self.low[node].reshape(len(windows), count).astype(np.int64)

    def run(self, windows: Values) -> Values:
        """(N, Ky, C), the motion for windows (N, D): the mean of the leaves of all trees."""
        total = np.zeros((len(windows), *self.leaves.shape[1:]))
        for rows in self.find(windows).T:
            total += self.leaves[rows]
        return (total / len(self.roots)).astype(np.float32)


def _need_within(name: str, indices: Indices, count: int) -> None:
    if len(indices) and not 0 <= int(indices.min()) <= int(indices.max()) < count:
        raise ValueError(f"{name!r} has a number that is not from 0 to {count - 1}")


def predict_at(
    model: ArrayModel, track: PhoneTrack, times: Times, audio: Sound | None = None
) -> Values:
    """(T, C), the model's own controls at (T,) `times` in s, one frame of its clock apart."""
    del audio
    forest, features = _forest(model), model.meta.features
    return np.concatenate(list(frames_of(
        lambda clock, rows: forest.run(features.windows(track, clock, rows=rows)),
        model.meta, times,
    )))  # fmt: skip


def animate(
    track: PhoneTrack,
    fps: float,
    audio: Sound | None = None,
    model: str | Path | ArrayModel | None = None,
) -> Clip:
    """The motion of a track, from 0 s to its end.

    Args:
        track: phones with times.
        fps: frames a second of the clip; the model has its own.
        audio: not listened to.
        model: a model, or its folder.

    Returns:
        Canonical controls (those that the model does not predict are at rest), or modes of a
        reference face where it predicts those alone. Values are not clipped.

    Raises:
        LipwrightError: there is no model, or it cannot be used.
    """
    del audio
    opened = open_network(model)
    forest, features = _forest(opened), opened.meta.features
    curves = curves_of(
        lambda times, rows: forest.run(features.windows(track, times, rows=rows)),
        opened.meta, track.end, fps,
    )  # fmt: skip
    return Clip(clip_names(opened), fps, arrange(opened, curves))


def open_network(model: str | Path | ArrayModel | None = None) -> ArrayModel:
    """The trees of a model, loaded once while its files stay as they are.

    Raises:
        LipwrightError: no model is named, it cannot be used, or it is one of another engine.
    """
    opened = open_arrays_of(model, "trees")
    _forest(opened)
    return opened


@lru_cache(maxsize=2)
def _forest(model: ArrayModel) -> Forest:
    """The trees of a model, checked.

    Raises:
        LipwrightError: they are none that could run.
    """
    meta, place = model.meta, model.path / ARRAYS_FILE
    if "sound" in meta.features.kinds:
        raise LipwrightError(f"{place}: listens, which trees do not; {REMEDY}")
    columns = model.array("columns", "i", (None,))
    nodes = (len(columns),)
    thresholds = model.array("thresholds", "f", nodes)
    low, high = (model.array(name, "i", nodes) for name in ("low", "high"))
    leaves = model.array("leaves", "f", (None, meta.output_window, len(meta.controls)))
    roots = model.array("roots", "i", (None,))
    try:
        return Forest(roots, columns, thresholds, low, high, leaves, meta.features.size)
    except ValueError as error:
        raise LipwrightError(f"{place}: {error}; {REMEDY}") from error
