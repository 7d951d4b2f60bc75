"""The whole benchmark on GRID speaker 1: capture, reference face, all engines, report.

    python bench/benchmark.py -o report              # 880 sentences
    python bench/benchmark.py --dataset DATASET -o report   # of a capture that is there
    python bench/benchmark.py --small -o report      # 40 sentences, small networks: minutes

What is captured and trained is kept; the same command goes on where it was stopped. The unseen
words are the sentences with the letters m, v and y, which a second training does without.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from grid import CACHE, CORPORA, UNSEEN, Sentence, sentences
from lipwright.cli import run
from lipwright.dataset.folder import open_dataset

LICENCE = "CC BY 4.0 (GRID audiovisual sentence corpus, speaker 1)"
SMALL = 40  # sentences


def small_choice(chosen: Sequence[Sentence]) -> list[Sentence]:
    """Few sentences, of which many share their first four words, some with the unseen letters."""
    alike: dict[str, list[Sentence]] = defaultdict(list)
    for sentence in chosen:
        alike[sentence.name[:4]].append(sentence)
    pairs = sorted((group for group in alike.values() if len(group) > 1), key=len, reverse=True)
    return [sentence for group in pairs for sentence in group[:2]][:SMALL]


def make_dataset(place: Path, chosen: Sequence[Sentence]) -> Path:
    """The captured dataset of some sentences, with the parameters of its reference face."""
    dataset, words = place / "grid", place / "words"
    words.mkdir(parents=True, exist_ok=True)
    for sentence in chosen:
        (words / f"{sentence.name}.txt").write_text(sentence.text + "\n")
    videos = [str(sentence.video) for sentence in chosen]
    root = chosen[0].root
    if not (dataset / "dataset.json").exists() or not open_dataset(dataset).names("test"):
        command = ["capture", *videos, "--audio", str(root / "audio"), "-t", str(words)]
        need([*command, "-o", str(dataset), "--licence", LICENCE])
    first = open_dataset(dataset)
    if first.recording(first.names()[0]).face() is None:
        need(["face", "fit", str(dataset), "-o", str(face_of(dataset))])
    return dataset


def face_of(dataset: Path) -> Path:
    """Where its reference face lies."""
    return dataset.with_name(f"{dataset.name}-face.npz")


def need(command: Sequence[str]) -> None:
    """Run a command of ours; stop where it fails."""
    status = run(list(command))
    if status:
        sys.exit(status)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--corpora", type=Path, default=CORPORA)
    parser.add_argument("--dataset", type=Path, help="captured before, with face parameters")
    parser.add_argument("--small", action="store_true", help="40 sentences, small networks")
    parser.add_argument("--engines", default="all")
    parser.add_argument("--videos", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the report")
    options = parser.parse_args()
    dataset = options.dataset
    if dataset is None:
        chosen = sentences("all", options.corpora)
        chosen = small_choice(chosen) if options.small else chosen
        place = options.output.with_name(f"{options.output.name}-data") if options.small else CACHE
        dataset = make_dataset(place, chosen)
    smartbody = options.corpora / "smartbody-bigrams" / "default.json"
    second_head = options.corpora / "rulers" / "ict-landmarks.npz"
    quick = ["--quick"] if options.small else []
    need([
        "evaluate", str(dataset), "--engines", options.engines, "--model", f"smartbody={smartbody}",
        "--second-head", str(second_head), "--hold-out", f"???[{UNSEEN}]??", *quick,
        "--videos", str(options.videos), "-o", str(options.output),
    ])  # fmt: skip


if __name__ == "__main__":
    main()
