"""The trainings of a benchmark: one for the test, one without the unseen words."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from lipwright.benchmark.options import BenchmarkOptions
from lipwright.dataset.folder import Dataset
from lipwright.dataset.splits import TEST, TRAIN, UNSEEN, VALIDATION, SplitOptions, hold_out
from lipwright.errors import LipwrightError


@dataclass(frozen=True, eq=False)
class Variant:
    """A way to split the dataset, and the recordings that are measured with it."""

    name: Literal["test", "unseen"]
    dataset: Dataset
    """split so"""
    recordings: tuple[str, ...]
    """that are measured"""
    about: str

    @property
    def trained_on(self) -> tuple[str, ...]:
        """The recordings for training."""
        return self.dataset.names(TRAIN)

    def digest(self) -> str:
        """A hash of all that a training on it sees."""
        seen = [
            (entry["name"], entry.get("split"), sorted(entry.get("files", {}).items()))
            for entry in self.dataset.entries
            if entry["status"] == "captured" and entry.get("split") in {TRAIN, VALIDATION, TEST}
        ]
        return hashlib.sha256(json.dumps(seen).encode()).hexdigest()


def make_variants(
    dataset: Dataset, options: BenchmarkOptions, *, trains: bool = True
) -> tuple[Variant, ...]:
    """The test, and the unseen words where some are held out.

    Args:
        dataset: with its splits.
        options: what is held out.
        trains: whether anything is trained, which needs recordings for validation.

    Raises:
        LipwrightError: no recording is for the test, for training or for validation, or nothing
            is held out by a pattern or word.
    """
    for split in (TRAIN, VALIDATION, TEST) if trains else (TRAIN, TEST):
        if not dataset.names(split):
            raise LipwrightError(
                f"{dataset.path}: no recording is for {split}; run: lipwright dataset split"
            )
    return tuple(_variants(dataset, options, trains))


def _variants(dataset: Dataset, options: BenchmarkOptions, trains: bool) -> Iterator[Variant]:
    tested = dataset.names(TEST)
    learnt = f"learnt from {len(dataset.names(TRAIN))} others"
    yield Variant("test", dataset, tested, f"{len(tested)} held-out recordings; {learnt}")
    held = SplitOptions(hold_out=options.hold_out, hold_out_words=options.hold_out_words)
    if held.hold_out or held.hold_out_words:
        without = hold_out(dataset, held)
        words = ", ".join((*held.hold_out, *held.hold_out_words))
        what = f"recordings held out by {words}"
    else:
        without, what = dataset, "recordings with words that are held out"
    if trains and not without.names(VALIDATION):
        raise LipwrightError(
            f"{dataset.path}: nothing is left for {VALIDATION}; hold out less, or run: lipwright "
            "dataset split"
        )
    names = without.names(UNSEEN)
    if names:
        learnt = f"learnt from {len(without.names(TRAIN))} others"
        yield Variant("unseen", without, names, f"{len(names)} {what}; {learnt}")
