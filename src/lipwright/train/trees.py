"""The learner of the engine trees: regression trees over windows of phones.

After Kim, Yue, Taylor and Matthews, "A decision tree framework for spatiotemporal sequence
prediction" (2015), with the sizes of Taylor et al. 2017, section 8.1. scikit-learn grows the trees
on whole windows of motion, each control over its standard deviation; what they learnt is written
as plain arrays. Of a forest each tree sees windows drawn anew, with replacement (Breiman, "Random
forests", 2001).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.engines.trees import LEAF, MAX_DEPTH
from lipwright.errors import LipwrightError
from lipwright.features import KINDS, FeatureSet, seen_phones
from lipwright.train.config import WIDEST, need
from lipwright.train.learner import Fitted, LearnerConfig, Report, silence_first
from lipwright.train.takes import Corpus, Take

Floats = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]
Arrays = dict[str, npt.NDArray[Any]]

HEARD: Final = "sound"  # trees see the phones alone


@dataclass(frozen=True, kw_only=True)
class TreesConfig(LearnerConfig):
    """Without values of its own it is one tree, as Taylor et al. 2017 had it.

    Raises:
        MisfitError: a value is out of range.
    """

    features: tuple[str, ...] = ("raw", "attributes", "transitions")
    """kinds of features"""
    input_window: int = 11
    """frames, Kx (Taylor et al. 2017, section 8.1)"""
    output_window: int = 5
    """frames, Ky (the same)"""
    min_leaf: int = 10
    """windows of training in a leaf, at least (the same)"""
    trees: int = 1
    """of the forest; a single one sees every window and every column"""
    columns: float = 1.0
    """share of the columns that a split of a tree of a forest is chosen among"""

    def __post_init__(self) -> None:
        """Check."""
        super().__post_init__()
        for key, least, most in (
            ("input_window", 1, WIDEST), ("output_window", 1, WIDEST),
            ("min_leaf", 1, 1_000_000), ("trees", 1, 1000),
        ):  # fmt: skip
            fits = least <= getattr(self, key) <= most
            need(fits, key, f"is {getattr(self, key)}, not {least} to {most}")
        for key in ("input_window", "output_window"):
            need(getattr(self, key) % 2 == 1, key, f"is {getattr(self, key)}, not odd")
        need(0 < self.columns <= 1, "columns", "must be above 0 and at most 1")
        known = [kind for kind in KINDS if kind != HEARD]
        need(bool(self.features), "features", "must name one at least")
        need(len(set(self.features)) == len(self.features), "features", "has a name twice")
        for kind in self.features:
            need(kind in known, "features", f"has {kind!r}, not one of: {', '.join(known)}")


CONFIG = TreesConfig


def fit(corpus: Corpus, config: TreesConfig, report: Report) -> Fitted:
    """Grow the trees on the takes for training.

    Args:
        corpus: takes by split.
        config: sizes.
        report: told "train" and how much of it is done.

    Raises:
        LipwrightError: no window of training shows a face in all of its frames, or too few do, or
            all say the same.
    """
    takes = corpus.of("train")
    phones = config.phones or seen_phones(take.track for take in takes)
    kinds = tuple(kind for kind in KINDS if kind in config.features)
    features = FeatureSet(kinds, config.input_window, corpus.fps, silence_first(phones))
    windows, seen = see(takes, features, config.output_window)
    motion = np.concatenate([motions(take, config.output_window) for take in takes])
    if len(motion) < 2 * config.min_leaf:
        raise LipwrightError(
            f"{corpus.path}: {len(motion)} windows for training show a face in all of their "
            f"{config.output_window} frames, fewer than two leaves of {config.min_leaf}; record "
            "more, or lower 'min_leaf'"
        )
    if not len(seen):
        raise LipwrightError(
            f"{corpus.path}: all windows for training say the same, and there is nothing to ask; "
            "record more"
        )
    mean, spread = _scale(motion)
    motion -= mean
    motion /= spread
    grown = _grow_all(windows, motion.reshape(len(motion), -1), config, report)
    leaf = (config.output_window, len(corpus.controls))
    parts = [flatten(tree.tree_, seen, leaf) for tree in grown]
    for part in parts:
        part["leaves"] = (part["leaves"] * spread + mean).astype(np.float32)
    arrays = join(parts)
    return Fitted("trees", arrays, features, tuple(_notes(config, arrays, len(motion))),
                  config.output_window)  # fmt: skip


def see(
    takes: Sequence[Take], features: FeatureSet, output_window: int
) -> tuple[Values, npt.NDArray[np.int64]]:
    """What the trees may ask.

    Returns:
        (N, K) the columns, of the windows whose motion is known, that are not the same in all;
        (K,) their places among the D columns of a window.
    """
    low, high = np.full(features.size, np.inf), np.full(features.size, -np.inf)
    count = 0
    for rows in _windows(takes, features, output_window):
        low = np.minimum(low, rows.min(axis=0, initial=np.inf))
        high = np.maximum(high, rows.max(axis=0, initial=-np.inf))
        count += len(rows)
    seen = np.flatnonzero(high > low)
    windows = np.empty((count, len(seen)), np.float32)  # once: this is most of the memory
    stop = 0
    for rows in _windows(takes, features, output_window):
        start, stop = stop, stop + len(rows)
        windows[start:stop] = rows[:, seen]
    return windows, seen


def _windows(takes: Sequence[Take], features: FeatureSet, output_window: int) -> Iterator[Values]:
    for take in takes:
        yield features.windows(take.track, take.times)[_known(take, output_window)]


def motions(take: Take, output_window: int) -> Floats:
    """(N, Ky, C), the motion around each frame of a take; past the ends the end frames repeat.

    Windows in which a frame shows no face are left out.
    """
    known = _known(take, output_window)
    return take.targets[_around(take, output_window)[known]].astype(np.float64)


def _known(take: Take, output_window: int) -> npt.NDArray[np.bool_]:
    """(T,) whether all frames around each show a face."""
    return np.asarray(take.valid[_around(take, output_window)].all(axis=1))


def _around(take: Take, output_window: int) -> npt.NDArray[np.int64]:
    """(T, Ky) the frames around each."""
    count, half = len(take.times), output_window // 2
    frames = np.arange(count)[:, None] + np.arange(-half, half + 1)
    return np.clip(frames, 0, count - 1)


def _scale(motion: Floats) -> tuple[Floats, Floats]:
    """(C,) mean and standard deviation of each control; 1 for those that never change."""
    flat = motion.reshape(-1, motion.shape[-1])
    spread = flat.std(axis=0)
    return flat.mean(axis=0), np.where(spread > 0, spread, 1.0)


def _grow_all(
    windows: Values, motion: Floats, config: TreesConfig, report: Report
) -> list[Any]:  # fmt: skip
    """The trees; each has a seed of its own, so that it is the same however many grow at once."""
    grown = []
    with ThreadPoolExecutor(min(config.trees, _cores())) as pool:
        for tree in pool.map(_grower(windows, motion, config), range(config.trees)):
            grown.append(tree)
            report("train", len(grown) / config.trees)
    return grown


def _cores() -> int:
    """Processor cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)
    return len(usable(0)) if usable else os.cpu_count() or 1


def _grower(windows: Values, motion: Floats, config: TreesConfig) -> Callable[[int], Any]:
    from sklearn.tree import DecisionTreeRegressor

    def grow(number: int) -> Any:
        random = np.random.default_rng((config.seed, number))
        count, drawn = len(windows), None
        if config.trees > 1:
            chosen = random.integers(count, size=count)
            drawn = np.bincount(chosen, minlength=count).astype(np.float64)
        tree = DecisionTreeRegressor(
            min_samples_leaf=config.min_leaf, max_depth=MAX_DEPTH,
            max_features=config.columns if config.trees > 1 else None,
            random_state=int(random.integers(2**31)),
        )  # fmt: skip
        # Windows that were not drawn have no weight, and then scikit-learn counts none in leaves.
        return tree.fit(windows, motion, sample_weight=drawn)

    return grow


def flatten(tree: Any, seen: npt.NDArray[np.int64], leaf: tuple[int, int]) -> Arrays:
    """The arrays of `engines.trees.Forest` of one tree.

    Args:
        tree: as scikit-learn keeps it.
        seen: (K,) places of its columns among all of a window.
        leaf: Ky, C.
    """
    ends = tree.children_left < 0
    rows = np.cumsum(ends) - 1
    return {
        "roots": np.zeros(1, np.int32),
        "columns": np.where(ends, LEAF, seen[np.maximum(tree.feature, 0)]).astype(np.int32),
        "thresholds": np.where(ends, 0, _at_most(tree.threshold)).astype(np.float32),
        "low": np.where(ends, rows, tree.children_left).astype(np.int32),
        "high": np.where(ends, 0, tree.children_right).astype(np.int32),
        "leaves": tree.value[ends].reshape(-1, *leaf),
    }


def _at_most(thresholds: Floats) -> Values:
    """The largest float32 that is not above each: windows, float32 too, go the same way."""
    near = thresholds.astype(np.float32)
    return np.where(near > thresholds, np.nextafter(near, np.float32(-np.inf)), near)


def join(parts: Sequence[Arrays]) -> Arrays:
    """The arrays of several trees as those of one forest."""
    moved, nodes, leaves = [], 0, 0
    for part in parts:
        ends = part["columns"] == LEAF
        moved.append({
            **part,
            "roots": part["roots"] + np.int32(nodes),
            "low": part["low"] + np.where(ends, leaves, nodes).astype(np.int32),
            "high": part["high"] + np.where(ends, 0, nodes).astype(np.int32),
        })  # fmt: skip
        nodes, leaves = nodes + len(ends), leaves + len(part["leaves"])
    return {name: np.concatenate([part[name] for part in moved]) for name in parts[0]}


def _notes(config: TreesConfig, arrays: Arrays, windows: int) -> Iterator[str]:
    kinds = ", ".join(kind for kind in KINDS if kind in config.features)
    trees = "1 tree" if config.trees == 1 else f"{config.trees} trees"
    yield (
        f"{trees} with {len(arrays['leaves'])} leaves of {config.min_leaf} windows or more, grown "
        f"on {windows} windows"
    )
    yield f"{kinds} of {config.input_window} frames to {config.output_window} frames of motion"
    if config.trees > 1:
        yield f"each split is chosen among {100 * config.columns:.0f} % of the columns"
