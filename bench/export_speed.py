"""Seconds and bytes of each export of a 10-minute clip, and how much smaller few keys make it.

    python bench/export_speed.py [--minutes 10] [--only .anim .vrma]

The curves are examples/hello.flac as `lipwright animate` moves it, again and again; MP4, which
draws every picture, is left out. Each export runs in a process of its own.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import EXPORTERS, ExportOptions, Performance, export_all
from lipwright.formats import write_track
from lipwright.pipeline import animate
from lipwright.track import PhoneTrack, join_tracks

EXAMPLES = Path(__file__).parents[1] / "examples"
LEFT_OUT = (".mp4",)
BOUND = 0.01  # of a control


def long_performance(minutes: float) -> Performance:
    """The example over and over, at 60 frames a second, with its phones and words."""
    said = animate(EXAMPLES / "hello.flac", (EXAMPLES / "hello.txt").read_text("utf-8"))
    times = round(minutes * 60 / said.clip.duration + 0.5)
    values = np.tile(said.clip.values, (times, 1))[: round(minutes * 60 * said.clip.fps)]
    step = len(said.clip) / said.clip.fps
    tracks: list[PhoneTrack] = [said.track.shifted(index * step) for index in range(times)]
    return Performance(Clip(said.clip.names, said.clip.fps, values), join_tracks(tracks))


def one(suffix: str, keys: float | None, stored: Path) -> None:
    """Export once and print seconds, bytes and the peak of the process's memory in MB."""
    from lipwright.formats import read_track

    with np.load(stored) as arrays:
        clip = Clip(tuple(arrays["names"].tolist()), float(arrays["fps"]), arrays["values"])
    performance = Performance(clip, read_track(stored.with_suffix(".json")))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"talk{suffix}"
        started = time.perf_counter()
        export_all([path], performance, options=ExportOptions(keys=keys))
        seconds = time.perf_counter() - started
        size = sum(file.stat().st_size for file in Path(folder).iterdir())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"{seconds} {size} {peak / 1024}")


def measure(suffix: str, keys: float | None, stored: Path) -> tuple[float, int, float] | str:
    """What `one` prints, or why it failed."""
    command = [sys.executable, __file__, "--one", suffix, "--stored", str(stored)]
    command += [] if keys is None else ["--keys", str(keys)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode:
        return run.stderr.strip().splitlines()[-1]
    seconds, size, peak = run.stdout.split()
    return float(seconds), int(size), float(peak)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    parser.add_argument("--stored", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--keys", type=float, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.one:
        one(chosen.one, chosen.keys, chosen.stored)
        return
    suffixes = chosen.only or [suffix for suffix in EXPORTERS if suffix not in LEFT_OUT]
    with tempfile.TemporaryDirectory() as folder:
        stored = Path(folder) / "long.npz"
        performance = long_performance(chosen.minutes)
        clip = performance.clip
        np.savez(stored, names=np.array(clip.names), fps=clip.fps, values=clip.values)
        assert performance.track is not None  # long_performance sets it
        write_track(stored.with_suffix(".json"), performance.track)
        print(f"{len(clip):,} frames of {len(clip.names)} controls")
        print(f"{'format':16} {'s':>6} {'MB':>7} {'MB RAM':>8}   {'s, keys':>8} {'MB':>7} {'x':>6}")
        for suffix in suffixes:
            row(suffix, stored)


def row(suffix: str, stored: Path) -> None:
    """One line of the table."""
    baked, sparse = measure(suffix, None, stored), measure(suffix, BOUND, stored)
    if isinstance(baked, str) or isinstance(sparse, str):
        print(f"{suffix:16} {baked if isinstance(baked, str) else sparse}")
        return
    ratio = baked[1] / sparse[1]
    print(
        f"{suffix:16} {baked[0]:6.2f} {baked[1] / 1e6:7.2f} {baked[2]:8.0f}   "
        f"{sparse[0]:8.2f} {sparse[1] / 1e6:7.2f} {ratio:6.1f}",
        flush=True,
    )


if __name__ == "__main__":
    try:
        main()
    except LipwrightError as error:
        sys.exit(str(error))
