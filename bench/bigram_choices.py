"""What the choices behind the English bigram set are worth: fitted anew without each of them.

    python bench/bigram_choices.py DATASET               # on the 50 validation sentences
    python bench/bigram_choices.py DATASET --split test

DATASET is GRID speaker 1, captured (`lipwright capture`). Each row is a set fitted to its
recordings for training, animated and measured as in bench/lips.py; the lower figure of the two
heads. Needs the extra `bench` and `lipwright head install`.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from grid import CORPORA, Sentence, sentences
from heads import Ruler, rulers
from lips import FPS, score
from lipwright.bigrams.values import BigramSet
from lipwright.dataset.folder import Dataset, open_dataset
from lipwright.evaluate.lips import pool
from lipwright.pipeline import AnimateOptions, animate_track
from lipwright.train.bigram_fit import FitOptions
from lipwright.train.bigram_heard import ClosureOptions
from lipwright.train.bigram_set import Naming, fit_set, ruled_set

NAMING = Naming("english")
FITS = {
    "as shipped": FitOptions(),
    "7 control points": FitOptions(points=7),
    "11 control points": FitOptions(points=11),
    "jumps free": FitOptions(jumps=0.0),
    "jumps at a third": FitOptions(jumps=1.0),
    "jumps at three times": FitOptions(jumps=10.0),
    "bends free": FitOptions(bending=0.0),
    "no least rounding": FitOptions(rounding=0.0),
    "full least rounding": FitOptions(rounding=1.0),
    "closures as long as their median": FitOptions(closures=ClosureOptions(sure=0.5)),
}
RUNTIMES = {
    "valleys stay": {"smoothing": 0.0},
    "valleys of 0.04 s": {"smoothing": 0.04},
    "valleys of 0.08 s": {"smoothing": 0.08},
    "0.2 s of pauses": {"silence": 0.2},
    "no constraints": {"constraints": {}},
    "no speed limit": {"speed_limit": 1e6},
}


def sets(dataset: Dataset) -> Iterator[tuple[str, BigramSet]]:
    """Row and set: by rule alone, fitted in several ways, and fitted but played otherwise."""
    ruled = ruled_set(NAMING)
    yield "by rule alone", ruled
    for name, options in FITS.items():
        found = fit_set(dataset, NAMING, options).fit.bigrams
        fitted = replace(ruled, bigrams={**ruled.bigrams, **found})
        yield name, fitted
        if name == "as shipped":
            for change, numbers in RUNTIMES.items():
                yield f"the same, {change}", replace(fitted, **numbers)


def measure(
    bigrams: BigramSet, chosen: list[Sentence], heads: dict[str, Ruler]
) -> dict[str, float]:
    """The worse figure of the two heads."""
    options = AnimateOptions(bigrams=bigrams, fps=FPS)
    scores = [
        score(sentence, sentence.track, animate_track(sentence.track, options), heads)
        for sentence in chosen
    ]
    pooled = [pool([each[head] for each in scores]) for head in heads]
    least = {name: min(row[name] for row in pooled) for name in ("r", "r_best_lag", "closures")}
    return least | {"false": max(row["false_closures_per_s"] for row in pooled)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--split", default="validation", choices=["validation", "test"])
    parser.add_argument("--corpora", type=Path, default=CORPORA)
    options = parser.parse_args()
    heads = rulers(options.corpora)
    chosen = sentences(options.split, options.corpora)
    print(f"{'set':36} {'r':>6} {'best lag':>9} {'closures':>9} {'false /s':>9}")
    for name, bigrams in sets(open_dataset(options.dataset)):
        row = measure(bigrams, chosen, heads)
        figures = f"{row['r']:6.3f} {row['r_best_lag']:9.3f} {row['closures']:9.3f}"
        print(f"{name:36} {figures} {row['false']:9.3f}", flush=True)


if __name__ == "__main__":
    main()
