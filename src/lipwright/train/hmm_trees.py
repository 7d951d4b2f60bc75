"""Decision trees that put Gaussians of like contexts together (Odell 1995).

A node is split by the question that makes the data likeliest, as long as that shortens the
description of the data: the gain in log likelihood must pay for the numbers of one more Gaussian
(minimum description length, Shinoda and Watanabe 2000).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.sparse import csc_array

from lipwright.engines.hmm import PLACES, Forest
from lipwright.train.hmm_questions import Questions

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Statistics:
    """What was seen in U contexts: sums over observations of D numbers."""

    contexts: Indices
    """(U, 5), phones as numbers"""
    table: Floats
    """(U, 1 + 2 D): how many, their sum, the sum of their squares"""

    @property
    def size(self) -> int:
        """D."""
        return (self.table.shape[1] - 1) // 2


@dataclass(frozen=True)
class Stopping:
    """When a node is a leaf."""

    least: float
    """observations of a leaf"""
    weight: float
    """observations that each of the counts stands for"""
    price: float = 1.0
    """of a number, in those of the minimum description length"""


@dataclass
class Grown:
    """A forest as it grows; `forest` is the finished one."""

    questions: Questions
    place: list[int] = field(default_factory=list)
    asked: list[int] = field(default_factory=list)
    branches: list[tuple[int, int]] = field(default_factory=list)
    leaf: list[int] = field(default_factory=list)
    leaves: list[Floats] = field(default_factory=list)
    """of each leaf the sums, (1 + 2 D,)"""

    def add(self) -> int:
        """A new node, of which nothing is known yet."""
        self.place.append(0)
        self.asked.append(0)
        self.branches.append((-1, -1))
        self.leaf.append(-1)
        return len(self.leaf) - 1

    @property
    def forest(self) -> Forest:
        """As the engine reads it."""
        return Forest(
            np.array(self.place, np.int64), self.questions.members[self.asked],
            np.array(self.branches, np.int64).reshape(-1, 2), np.array(self.leaf, np.int64),
        )  # fmt: skip


def variances(table: Floats, floor: Floats) -> tuple[Floats, Floats]:
    """Means and variances (..., D) of sums (..., 1 + 2 D); no variance is under its floor (D,)."""
    size = len(floor)
    count = np.maximum(table[..., :1], np.finfo(float).tiny)
    mean = table[..., 1 : 1 + size] / count
    return mean, np.maximum(table[..., 1 + size :] / count - mean**2, floor)


def log_likelihood(table: Floats, floor: Floats) -> Floats:
    """(...,) of the data of sums (..., 1 + 2 D) under their own Gaussian, without constants."""
    size = len(floor)
    count = np.maximum(table[..., :1], np.finfo(float).tiny)
    mean = table[..., 1 : 1 + size] / count
    own = table[..., 1 + size :] / count - mean**2
    held = np.maximum(own, floor)
    each = np.log(held) + np.minimum(own / held, 1)
    found: Floats = -0.5 * table[..., 0] * each.sum(axis=-1)
    return found


def grow(grown: Grown, data: Statistics, floor: Floats, stopping: Stopping) -> int:
    """A tree of all the data; the number of its root.

    Args:
        grown: where its nodes go.
        data: of one state.
        floor: (D,), the least variance.
        stopping: when a node is a leaf.
    """
    total = float(data.table[:, 0].sum()) * stopping.weight
    price = stopping.price * data.size * np.log(max(total, 1.0))  # mean and variance: 2 D / 2 log W
    one_hot = _one_hot(data.contexts, grown.questions.members.shape[1])
    root = grown.add()
    waiting = [(root, np.arange(len(data.contexts)))]
    while waiting:
        node, rows = waiting.pop()
        sums = data.table[rows].sum(axis=0)
        split = _best(grown.questions, one_hot, data, rows, sums, floor, stopping)
        if split is None or split[0] * stopping.weight <= price:
            grown.leaf[node] = len(grown.leaves)
            grown.leaves.append(sums)
            continue
        _, place, asked = split
        yes = grown.questions.members[asked, data.contexts[rows, place]]
        grown.place[node], grown.asked[node] = place, asked
        grown.branches[node] = (grown.add(), grown.add())
        waiting += zip(grown.branches[node], (rows[~yes], rows[yes]), strict=True)
    return root


def _one_hot(contexts: Indices, phones: int) -> csc_array:
    """(5 P, U) of 0 and 1: which phone is where."""
    rows = (contexts + phones * np.arange(PLACES)).ravel()
    columns = np.repeat(np.arange(len(contexts)), PLACES)
    shape = (PLACES * phones, len(contexts))
    return csc_array((np.ones(len(rows)), (rows, columns)), shape=shape)


def _best(
    questions: Questions, one_hot: csc_array, data: Statistics, rows: Indices, sums: Floats,
    floor: Floats, stopping: Stopping,
) -> tuple[float, int, int] | None:  # fmt: skip
    """The gain of the best question of a node, where it asks, and its number; None without any."""
    if sums[0] * stopping.weight < 2 * stopping.least or len(rows) < 2:
        return None
    held = (one_hot[:, rows] @ data.table[rows]).reshape(PLACES, -1, data.table.shape[1])
    own = float(log_likelihood(sums, floor))
    best: tuple[float, int, int] | None = None
    for place in range(PLACES):
        for asked, gain in _gains(questions, held[place], sums, floor, stopping):
            if best is None or gain - own > best[0] + 1e-9 * abs(own):
                best = (gain - own, place, asked)
    return best


def _gains(
    questions: Questions, held: Floats, sums: Floats, floor: Floats, stopping: Stopping
) -> Iterator[tuple[int, float]]:
    """Questions about one place, and the log likelihood of both sides of the best of them.

    Args:
        questions: all.
        held: (P, 1 + 2 D), sums of each phone that may stand there.
        sums: (1 + 2 D,), of all.
        floor: as in `grow`.
        stopping: as in `grow`.
    """
    present = np.flatnonzero(held[:, 0] > 0)
    if len(present) < 2:
        return
    # Here only some phones occur, so that many questions ask the same.
    kinds, first = np.unique(questions.members[:, present], axis=0, return_index=True)
    counts = kinds @ held[present, 0]
    least = stopping.least / stopping.weight
    fits = (counts >= least) & (sums[0] - counts >= least)
    kinds, first = kinds[fits], first[fits]
    if not len(first):
        return
    yes = kinds.astype(np.float64) @ held[present]
    gains = log_likelihood(yes, floor) + log_likelihood(sums - yes, floor)
    order = np.lexsort((first, -gains))
    yield int(first[order[0]]), float(gains[order[0]])
