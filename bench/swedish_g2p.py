"""Train the field that says Swedish words that no lexicon has.

    python bench/swedish_g2p.py                        # on all words, into the package
    python bench/swedish_g2p.py --hold-out -o held.crf # without the words that are measured

Takes about ten minutes on one core. bench/swedish_pronunciation.py measures what comes out.
"""

from __future__ import annotations

import argparse
import random
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import pycrfsuite

from lipwright.language.swedish.guess import MODEL, SILENT, features
from lipwright.language.swedish.lexicon import SwedishLexicon, align

HELD_OUT: Final = 0.1
"""share of the lexicon's words that `--hold-out` does not learn"""
_FEWEST: Final = 5  # words with a label, below which it is a mistake, or a loan like no other
_SPELT_OUT: Final = 1.5  # cost of an alignment from which an entry is an abbreviation


def words(lexicon: SwedishLexicon) -> tuple[list[str], list[str]]:
    """Words to learn from, and words to measure with, always the same."""
    known = sorted(word for word in lexicon.words() if word.isalpha() and word in lexicon)
    random.Random(1).shuffle(known)
    count = int(len(known) * HELD_OUT)
    return known[count:], known[:count]


def labels(word: str, sounds: Sequence[str]) -> list[str] | None:
    """For each letter its sounds, apart by spaces; None if word and sounds do not fit."""
    cost, places = align(word, sounds)
    if cost >= _SPELT_OUT:
        return None
    said: list[list[str]] = [[] for _ in word]
    last = 0
    for sound, place in zip(sounds, places, strict=True):
        last = last if place is None else place
        said[last].append(sound)
    return [" ".join(sounds) or SILENT for sounds in said]


def main() -> None:
    """Train."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--hold-out", action="store_true", help="leave a tenth of the words out")
    parser.add_argument("-o", "--output", type=Path, default=MODEL, help="model file")
    options = parser.parse_args()
    lexicon = SwedishLexicon()
    learnt, held = words(lexicon)
    trainer = pycrfsuite.Trainer(verbose=False)
    chosen = learnt if options.hold_out else learnt + held
    rows = {word: row for word in chosen if (row := labels(word, lexicon.lookup(word)[0]))}
    often = Counter(label for row in rows.values() for label in set(row))
    for word, row in rows.items():
        if all(often[label] >= _FEWEST for label in row):
            trainer.append(features(word), row)
    trainer.set_params({"c1": 0.05, "c2": 0.01, "max_iterations": 80, "feature.minfreq": 2})
    trainer.train(str(options.output))
    print(f"{options.output}: {len(rows)} words, {options.output.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
