"""How much of what is tested was heard in training: phones with their neighbours.

    python bench/contexts.py DATASET [--hold-out PATTERN ...]

For phones alone, with one neighbour to each side (triphones) and with two (quinphones): the share
of the spoken phones of held-out recordings that occur in training, and how often one does there in
the median. Silence is a neighbour like any other; beyond the ends there is silence.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from lipwright.benchmark.options import BenchmarkOptions
from lipwright.benchmark.variants import make_variants
from lipwright.dataset.folder import Dataset, open_dataset
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

NAMES = {0: "phones", 1: "triphones", 2: "quinphones"}


def contexts(track: PhoneTrack, reach: int) -> Iterator[tuple[str, ...]]:
    """Each spoken phone with `reach` neighbours to each side."""
    padded = (SILENCE,) * reach + tuple(track.phones) + (SILENCE,) * reach
    for place, phone in enumerate(track.phones):
        if phone != SILENCE:
            yield padded[place : place + 2 * reach + 1]


def heard(dataset: Dataset, names: tuple[str, ...], reach: int) -> Counter[tuple[str, ...]]:
    """Contexts and how often they occur in some recordings."""
    return Counter(
        context for name in names for context in contexts(dataset.recording(name).track, reach)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--hold-out", nargs="*", default=[])
    options = parser.parse_args()
    dataset = open_dataset(options.dataset)
    held = BenchmarkOptions(hold_out=tuple(options.hold_out))
    print("| tested | contexts | of them heard in training | times in training, median |")
    print("| --- | --- | --- | --- |")
    for variant in make_variants(dataset, held):
        for reach, name in NAMES.items():
            learnt = heard(variant.dataset, variant.trained_on, reach)
            tested = heard(variant.dataset, variant.recordings, reach)
            counts = np.array([learnt[one] for one in tested.elements()])
            print(f"| {variant.name} | {len(counts)} {name} | {(counts > 0).mean():.1%} | "
                  f"{np.median(counts):.0f} |")  # fmt: skip


if __name__ == "__main__":
    main()
