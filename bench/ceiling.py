"""The speaker against himself: how alike two takes of the same words are.

    python bench/ceiling.py DATASET FACE.npz [--split test] [--words 4]

Recordings that begin with the same words (GRID: four of six) are brought to each other's phone
times and compared as engines are, over these words only. Rows: every pair; pairs whose phones are
the same, pauses among them. Columns: r with both takes on the clocks of their videos (the offsets
of both pictures are left in), with the partner as an engine (its offset taken off, that of the
recording left in, as in all r of the lips), and with both on the clocks of their sounds. Then every
measure, of the partners one by one and of the mean of all partners, with what the mean of so many
takes should reach (`of_mean`).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lipwright.dataset.folder import open_dataset, sha256_of
from lipwright.evaluate.ceiling import Himself, Pair, himself, load_recorded, of_mean
from lipwright.evaluate.measures import Rows
from lipwright.evaluate.shared_words import FIRST_WORDS, partners, words_of
from lipwright.face.reference_file import load_reference_face


def line(title: str, pairs: Sequence[Pair]) -> str:
    """Mean and median r of some pairs."""
    found = [title, str(len(pairs))]
    for name in ("r_of_videos", "r", "r_on_sound"):
        values = [getattr(pair, name) for pair in pairs]
        known = np.array([value for value in values if np.isfinite(value)])
        mean = float(known.mean()) if len(known) else math.nan
        found += [f"{mean:.3f}", f"{np.median(known) if len(known) else math.nan:.3f}",
                  f"{of_mean(max(mean, 1e-9), math.inf):.3f}"]  # fmt: skip
    return "| " + " | ".join(found) + " |"


def print_means(found: Himself) -> None:
    """Every measure of partners one by one and of their mean, where there are two or more."""
    counts = np.array([sum(p.recording == name for p in found.pairs) for name in found.recordings])
    several = counts > 1
    print(f"\n{several.sum()} recordings with two or more partners, "
          f"{counts[several].mean() if several.any() else 0:.2f} in the mean")  # fmt: skip
    print("| measure | all | one partner, of these recordings | mean of all partners |")
    print("| --- | --- | --- | --- |")
    for name, rows in found.own.items():
        one = Rows(rows.sums * several, rows.counts * several).value
        mean = found.mean_of_takes.get(name)
        print(f"| {name} | {rows.value:.4g} | {one:.4g} | {mean.value if mean else math.nan:.4g} |")
    if several.any():
        rs = found.own["r"].each[several]
        expected = [of_mean(max(r, 1e-9), n) for r, n in zip(rs, counts[several], strict=True)]
        print(f"r expected of the mean of so many takes: {np.nanmean(expected):.3f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("face", type=Path, help="the reference face, .npz")
    parser.add_argument("--split", default="test", help="or all")
    parser.add_argument("--words", type=int, default=FIRST_WORDS)
    options = parser.parse_args()
    dataset, face = open_dataset(options.dataset), load_reference_face(options.face)
    face_hash = sha256_of(options.face)
    names = dataset.names(None if options.split == "all" else options.split)
    found = partners(words_of(dataset), names, options.words)
    needed = dict.fromkeys(name for one, others in found.items() for name in (one, *others))
    loaded = {name: load_recorded(dataset.recording(name), face_hash) for name in needed}
    known = {name: one for name, one in loaded.items() if one is not None}
    result = himself(face, known, found, options.words)
    if result is None:
        raise SystemExit(f"{options.dataset}: no two recordings begin with the same words")
    print(f"{len(names)} recordings ({options.split}), {len(result.recordings)} with a partner, "
          f"{len(result.pairs)} pairs")  # fmt: skip
    print(
        "| pairs | n | r, videos | median | sqrt | "
        "r, as an engine | median | sqrt | r, sounds | median | sqrt |"
    )
    print("|" + " --- |" * 11)
    print(line("all", result.pairs))
    print(line("the same phones", [pair for pair in result.pairs if pair.is_same]))
    print(line("other phones", [pair for pair in result.pairs if not pair.is_same]))
    print_means(result)


if __name__ == "__main__":
    main()
