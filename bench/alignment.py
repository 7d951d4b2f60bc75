"""How well the aligner agrees with hand-placed phone boundaries and with GRID's word times.

    python bench/alignment.py                    # the four hand-labelled sentences
    python bench/alignment.py --grid 100         # and the first 100 sentences of GRID
    python bench/alignment.py --json figures.json

Reference and estimated phones are matched by edit distance: equal phones cost nothing, phones of
one kind (see `substitution_cost`) cost a part of leaving both unmatched, others are never matched.
The error of a match is the estimated start minus the reference start. Phones without a match are
counted, not measured.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from lipwright.audio import open_audio
from lipwright.errors import LipwrightError
from lipwright.language import get_language
from lipwright.phones import PHONES, is_silence_label, parse_phone
from lipwright.speech import Alignment, align

CORPORA = Path(__file__).parents[2] / "shared" / "corpora"

# Labels of the "ae" database that are not IPA. `ɥ` is the release or aspiration of the stop
# before it. Two letters in one label are two phones that nobody could part: the label starts
# where the first does, and the second stays unmatched. `On` and `Om` are the voiceless beginning
# of the nasal that follows.
RELEASE = "ɥ"
ODD_LABELS = {
    "@:": "ER", "@u": "OW", "oː": "AO", "db": "D", "dH": "D", "zs": "Z", "pt": "P", "kt": "K",
    "On": "N", "Om": "M",
}  # fmt: skip
PARTED = {"CH": ("T", "SH"), "N": ("N", "N"), "M": ("M", "M")}  # one phone under two labels
NEVER = 1e6
GAP = 1.0  # cost of a phone without a match
KINDS = {
    "stop": "stop", "flap": "stop", "affricate": "affricate", "fricative": "fricative",
    "nasal": "nasal", "lateral": "liquid", "approximant": "liquid",
}  # fmt: skip

GRID_WORDS = (
    {"b": "bin", "l": "lay", "p": "place", "s": "set"},
    {"b": "blue", "g": "green", "r": "red", "w": "white"},
    {"a": "at", "b": "by", "i": "in", "w": "with"},
    {letter: letter for letter in "abcdefghijklmnopqrstuvxyz"},
    dict(zip("z123456789", ("zero", "one", "two", "three", "four", "five", "six", "seven",
                            "eight", "nine"), strict=True)),
    {"a": "again", "n": "now", "p": "please", "s": "soon"},
)  # fmt: skip
GRID_UNIT = 25_000  # a second, in the .align files


@dataclass(frozen=True)
class Labelled:
    """A phone with its start."""

    symbol: str
    start: float
    """s"""


@dataclass(frozen=True, eq=False)
class Match:
    """The phones of one sentence, matched."""

    errors: npt.NDArray[np.float64]
    """(K,) s, estimated minus reference start of each matched phone"""
    reference_unmatched: tuple[str, ...]
    estimated_unmatched: tuple[str, ...]
    reference_indices: tuple[int, ...]
    """(K,) which reference phone each match is"""


def read_reference(path: Path) -> list[Labelled]:
    """The phones of a .tsv of hand labels; releases belong to the stop before them."""
    phones: list[Labelled] = []
    for line in path.read_text(encoding="utf-8").splitlines()[1:]:
        start, _, label = line.split("\t")
        if label == RELEASE:
            continue
        symbol = ODD_LABELS.get(label) or parse_phone(label, "ipa")[0]
        phones.append(Labelled(symbol, float(start)))
    merged: list[Labelled] = []
    for phone in phones:
        pair = (merged[-1].symbol if merged else "", phone.symbol)
        whole = next((one for one, parts in PARTED.items() if parts == pair), None)
        if whole:
            merged[-1] = Labelled(whole, merged[-1].start)
        else:
            merged.append(phone)
    return merged


def substitution_cost(reference: str, estimated: str) -> float:
    """0 for the same phone, under two gaps for phones of one kind, never otherwise.

    One kind are vowels (with ER, as accents drop its R), and consonants of one manner, whatever
    their place and voice: transcribers and lexicons differ in "amongst" and "tempting".
    """
    if reference == estimated:
        return 0.0
    one, other = PHONES[reference], PHONES[estimated]
    if one.is_vowel and other.is_vowel:
        return 0.5
    if one.is_consonant and other.is_consonant and KINDS[one.manner] == KINDS[other.manner]:
        return 0.7 if one.place == other.place else 1.2
    return NEVER


def match_phones(reference: Sequence[Labelled], estimated: Sequence[Labelled]) -> Match:
    """Match two rows of phones by edit distance; times play no part."""
    rows, columns = len(reference), len(estimated)
    cost = np.zeros((rows + 1, columns + 1))
    cost[:, 0], cost[0, :] = GAP * np.arange(rows + 1), GAP * np.arange(columns + 1)
    for i, one in enumerate(reference, 1):
        for j, other in enumerate(estimated, 1):
            cost[i, j] = min(
                cost[i - 1, j - 1] + substitution_cost(one.symbol, other.symbol),
                cost[i - 1, j] + GAP,
                cost[i, j - 1] + GAP,
            )
    errors: list[float] = []
    missed: list[str] = []
    added: list[str] = []
    indices: list[int] = []
    i, j = rows, columns
    while i or j:
        one, other = reference[i - 1], estimated[j - 1]
        substitution = substitution_cost(one.symbol, other.symbol)
        if i and j and np.isclose(cost[i, j], cost[i - 1, j - 1] + substitution):
            errors.append(other.start - one.start)
            indices.append(i - 1)
            i, j = i - 1, j - 1
        elif i and np.isclose(cost[i, j], cost[i - 1, j] + GAP):
            missed.append(one.symbol)
            i -= 1
        else:
            added.append(other.symbol)
            j -= 1
    return Match(np.array(errors[::-1]), tuple(missed[::-1]), tuple(added[::-1]),
                 tuple(indices[::-1]))  # fmt: skip


def summarize(errors: npt.NDArray[np.float64]) -> dict[str, float]:
    """The figures of a row of errors in s."""
    size = np.abs(errors)
    return {
        "matched": len(errors),
        "median_ms": 1000 * float(np.median(size)),
        "mean_ms": 1000 * float(size.mean()),
        "bias_ms": 1000 * float(np.median(errors)),
        "p90_ms": 1000 * float(np.quantile(size, 0.9)),
        "p95_ms": 1000 * float(np.quantile(size, 0.95)),
        "within_20ms": float((size <= 0.020).mean()),
        "within_50ms": float((size <= 0.050).mean()),
    }


def align_file(path: Path, text: str) -> Alignment:
    """The alignment of one recording and its text."""
    with open_audio(path, rate=16000) as audio:
        return align(audio, get_language("en").normalize(text))


def bench_phones(folder: Path) -> dict[str, dict[str, float]]:
    """Figures of each hand-labelled sentence, and of all."""
    figures, everything = {}, []
    missed = added = 0
    for path in sorted(folder.glob("*.flac")):
        track = align_file(path, path.with_suffix(".txt").read_text(encoding="utf-8")).track
        estimated = [
            Labelled(p, start) for p, start, _ in track if not is_silence_label(p)
        ]  # fmt: skip
        match = match_phones(read_reference(path.with_suffix(".tsv")), estimated)
        figures[path.stem] = {
            **summarize(match.errors),
            "reference_unmatched": len(match.reference_unmatched),
            "estimated_unmatched": len(match.estimated_unmatched),
        }
        missed += len(match.reference_unmatched)
        added += len(match.estimated_unmatched)
        everything.append(match.errors)
        print(f"{path.stem}: only in the reference: {' '.join(match.reference_unmatched) or '-'}; "
              f"only in the estimate: {' '.join(match.estimated_unmatched) or '-'}")  # fmt: skip
    figures["all"] = {
        **summarize(np.concatenate(everything)),
        "reference_unmatched": missed,
        "estimated_unmatched": added,
    }
    return figures


def grid_text(name: str) -> str:
    """The words of a GRID sentence, from its name."""
    return " ".join(words[letter] for words, letter in zip(GRID_WORDS, name, strict=True))


def read_grid_words(path: Path) -> list[tuple[str, float, float]]:
    """Word, start and end in s of a .align file, without silence."""
    rows = [line.split() for line in path.read_text(encoding="ascii").splitlines()]
    return [
        (word, int(start) / GRID_UNIT, int(end) / GRID_UNIT)
        for start, end, word in rows
        if not is_silence_label(word)
    ]


def bench_grid(folder: Path, count: int) -> dict[str, float]:
    """Figures over the first `count` sentences, sorted by name."""
    starts, ends = [], []
    failures = misfits = 0
    sound = 0.0
    begin = time.perf_counter()
    for path in sorted((folder / "audio").glob("*.flac"))[:count]:
        try:
            alignment = align_file(path, grid_text(path.stem))
        except LipwrightError as error:
            failures += 1
            print(f"{path.stem}: {error}")
            continue
        sound += alignment.track.end
        for misfit in alignment.misfits:
            misfits += 1
            print(f"{path.stem}: {misfit.text!r} does not fit, score {misfit.score:.1f}")
        corpus = read_grid_words(folder / "align" / f"{path.stem}.align")
        if alignment.misfits:
            continue
        for word, (text, start, end) in zip(alignment.track.words, corpus, strict=True):
            assert word.text == text, path
            span = alignment.track.word_span(word)
            starts.append(span[0] - start)
            ends.append(span[1] - end)
    took = time.perf_counter() - begin
    start_error, end_error = np.abs(starts), np.abs(ends)
    return {
        "sentences": count,
        "failures": failures,
        "misfits": misfits,
        "times_real_time": sound / took,
        "start_median_ms": 1000 * float(np.median(start_error)),
        "start_within_50ms": float((start_error <= 0.05).mean()),
        "start_within_100ms": float((start_error <= 0.1).mean()),
        "end_median_ms": 1000 * float(np.median(end_error)),
        "end_within_50ms": float((end_error <= 0.05).mean()),
        "end_within_100ms": float((end_error <= 0.1).mean()),
    }


def print_table(figures: dict[str, dict[str, float]]) -> None:
    """One line a row of figures."""
    names = list(next(iter(figures.values())))
    print(f"{'':10}" + "".join(f"{name:>14.13}" for name in names))
    for row, values in figures.items():
        print(f"{row:10}" + "".join(f"{values[name]:14.4g}" for name in names))


def main() -> None:
    """Run what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--corpora", type=Path, default=CORPORA, help="folder of the recordings")
    parser.add_argument("--grid", type=int, default=0, metavar="N", help="sentences of GRID")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures here as well")
    options = parser.parse_args()
    figures: dict[str, dict[str, dict[str, float]]] = {
        "phones": bench_phones(options.corpora / "aligned-phones")
    }
    print_table(figures["phones"])
    if options.grid:
        figures["grid"] = {"all": bench_grid(options.corpora / "grid-s1", options.grid)}
        for name, value in figures["grid"]["all"].items():
            print(f"{name:20} {value:.4g}")
    if options.json:
        options.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
