"""What a capture of GRID takes, and whether it gives the same again, killed in its middle too.

    python bench/capture.py --out FOLDER [--first N] [--against DATASET]

Captures the recordings into FOLDER/1/grid, then once more into FOLDER/2/grid, where the first
process is killed (SIGKILL) when half of the recordings are there, and a second one goes on. Prints
seconds, figures of the dataset, and the files that differ. `--against` takes an earlier run's
dataset, of the same folder name, for the first.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

from grid import CORPORA, sentences
from lipwright.capture.summary import closure_totals, read_row
from lipwright.dataset.folder import open_dataset
from lipwright.dataset.summary import summarise

LICENCE = "CC BY 4.0 (GRID audiovisual sentence corpus, speaker 1)"


def command(videos: list[Path], words: Path, out: Path) -> list[str]:
    return [
        sys.executable, "-m", "lipwright", "capture", *map(str, videos), "--audio",
        str(CORPORA / "grid-s1" / "audio"), "-t", str(words), "-o", str(out),
        "--licence", LICENCE, "--progress", "none",
    ]  # fmt: skip


def write_words(words: Path) -> None:
    words.mkdir(parents=True, exist_ok=True)
    for sentence in sentences():
        (words / f"{sentence.name}.txt").write_text(sentence.text + "\n")


def done_in(dataset: Path) -> list[Path]:
    return list(dataset.glob("recordings/[!.]*/recording.json"))


def run(arguments: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(arguments, check=True)
    return time.perf_counter() - start


def run_and_kill(arguments: list[str], dataset: Path, count: int) -> int:
    """Kill the run when `count` recordings are there; how many there are then."""
    with subprocess.Popen(arguments, stderr=subprocess.DEVNULL) as process:
        while len(done_in(dataset)) < count and process.poll() is None:
            time.sleep(0.2)
        os.kill(process.pid, signal.SIGKILL)
    return len(done_in(dataset))


def digests(dataset: Path) -> dict[str, str]:
    return {
        str(path.relative_to(dataset)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(dataset.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def print_dataset(path: Path) -> None:
    dataset = open_dataset(path)
    summary = summarise(dataset)
    rows = [read_row(dataset, entry)[0] for entry in dataset.entries]
    print(f"{summary['statuses']}, {summary['frames']} frames, "
          f"{100 * summary['tracked']:.3f} % of them tracked")  # fmt: skip
    print(
        "p, b, m:", {key: round(v, 4) for key, v in closure_totals(rows).items() if v is not None}
    )
    for key in ("arkit_r", "arkit_gain"):
        values = sorted(v for row in rows if (v := row.figure(key)) is not None)
        print(f"{key}: {values[0]:.4f} to {values[-1]:.4f}, median {values[len(values) // 2]:.4f}")
    reasons = Counter(reason.split("(")[0].strip() for row in rows for reason in row.reasons)
    print(f"advised against: {sum(row.advised for row in rows)}", dict(reasons))
    print("offsets applied, ms:", summary["offset_ms"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--first", type=int, help="only the first recordings, by name")
    parser.add_argument("--against", type=Path)
    options = parser.parse_args()
    words = options.out / "words"
    write_words(words)
    videos = sorted((CORPORA / "grid-s1" / "video").glob("*.mp4"))[: options.first]
    first = options.against or options.out / "1" / "grid"
    second = options.out / "2" / first.name
    if options.against is None:
        print(f"{len(videos)} recordings in {run(command(videos, words, first)):.0f} s", flush=True)
    print_dataset(first)
    there = run_and_kill(command(videos, words, second), second, len(videos) // 2)
    print(f"killed with {there} recordings there", flush=True)
    print(f"the others in {run(command(videos, words, second)):.0f} s")
    one, two = digests(first), digests(second)
    different = sorted(name for name in one.keys() | two.keys() if one.get(name) != two.get(name))
    print(f"{len(one)} files, {len(different)} differ", *different[:10])


if __name__ == "__main__":
    main()
