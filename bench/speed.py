"""How fast and how large: whole processes, medians of several runs.

    python bench/speed.py            # start-up, a 3 s clip, 65 s, 10 minutes
    python bench/speed.py --hour     # and an hour

Long recordings are put together from GRID sentences with pauses between them. Times are wall
clock; memory is the peak resident set of the process, as the kernel counts it.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from grid import CORPORA, sentences
from lipwright.audio import Audio, read_audio, write_wav

RATE = 16000  # Hz


def run(command: list[str]) -> tuple[float, float]:
    """Wall clock in s and peak memory in MB of one process."""
    start = time.perf_counter()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            errors.seek(0)
            raise SystemExit(f"{' '.join(command)}\n{errors.read().decode()}")
    return time.perf_counter() - start, usage.ru_maxrss / 1024


def median_run(command: list[str], runs: int) -> tuple[float, float]:
    """Medians over several runs, after one that is not counted."""
    run(command)
    rows = [run(command) for _ in range(runs)]
    return statistics.median(r[0] for r in rows), statistics.median(r[1] for r in rows)


def make_recording(folder: Path, seconds: float, corpora: Path) -> tuple[Path, Path]:
    """GRID sentences one after the other until `seconds` are full: sound and text."""
    rng = np.random.default_rng(1)
    pool = sentences("all", corpora)
    pieces: list[np.ndarray] = []
    words: list[str] = []
    total = 0
    while total < seconds * RATE:
        sentence = pool[rng.integers(len(pool))]
        samples = read_audio(sentence.audio, RATE).samples
        if total + len(samples) > seconds * RATE and pieces:
            break
        pieces.append(samples)
        words.append(sentence.text + ".")
        total += len(samples)
    pieces.append(np.zeros(max(round(seconds * RATE) - total, 0), np.float32))
    sound, text = folder / f"{seconds:.0f}s.wav", folder / f"{seconds:.0f}s.txt"
    write_wav(sound, Audio(np.concatenate(pieces), RATE))
    text.write_text("\n".join(words), "utf-8")
    return sound, text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--hour", action="store_true", help="also an hour, once")
    parser.add_argument("--corpora", type=Path, default=CORPORA)
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    python = [sys.executable]
    # Made elsewhere, so that this process stays small: a child's peak counts what it began with.
    maker = ProcessPoolExecutor(1)
    lipwright = [sys.executable, "-m", "lipwright"]
    figures: dict[str, dict[str, float]] = {}

    def report(name: str, seconds: float, megabytes: float, length: float = 0.0) -> None:
        figures[name] = {"seconds": seconds, "megabytes": megabytes}
        speed = ""
        if length:
            figures[name]["times_real_time"] = length / seconds
            speed = f"{length / seconds:8.1f} x real time"
        print(f"{name:36} {seconds:8.3f} s {megabytes:8.0f} MB {speed}", flush=True)

    report("python -c pass", *median_run([*python, "-c", "pass"], options.runs))
    report("import numpy", *median_run([*python, "-c", "import numpy"], options.runs))
    report("import lipwright", *median_run([*python, "-c", "import lipwright"], options.runs))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        clip = sentences("test", options.corpora)[0]

        def animate(sound: Path, text: object, out: str) -> list[str]:
            return [*lipwright, "animate", str(sound), "--text", str(text), "-o", f"{folder}/{out}"]

        command = animate(clip.audio, clip.text, "a.csv")
        report("animate 3 s to CSV", *median_run(command, options.runs), 3)
        for seconds, runs in ((65, options.runs), (600, 1), *(((3600, 1),) * options.hour)):
            job = maker.submit(make_recording, folder, seconds, options.corpora)
            command = animate(*job.result(), "b.csv")
            figure = median_run(command, runs) if runs > 1 else run(command)
            report(f"animate {seconds} s to CSV", *figure, seconds)
        command = animate(clip.audio, clip.text, "a.mp4")
        report("animate 3 s to MP4", *median_run(command, options.runs), 3)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1), "utf-8")


if __name__ == "__main__":
    main()
