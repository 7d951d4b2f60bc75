"""How fast phone bigrams run: from phones to curves, and from an edit to new curves.

    python bench/bigram_speed.py                  # the English set; 10 s, a minute and an hour
    python bench/bigram_speed.py crab.json        # another set
    nice -n -10 python bench/bigram_speed.py --json speed.json

Phones and set are at hand: what is timed is the engine's stitching and every pass of the set, at 60
frames a second, to the final curves of the poses. Text gets its times from `spoken_track`; longer
lines repeat it. An edit is one pair drawn anew (`BigramSet.with_bigram`) and all curves of the line
made again. Of the rounds the best and the median are told; other programs only slow down.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.missing import stand_in
from lipwright.bigrams.runtime import spans
from lipwright.bigrams.values import Bigram, BigramSet
from lipwright.clip import Clip
from lipwright.engines.bigram import DEFAULT_SET, animate
from lipwright.files import write_whole
from lipwright.language.pace import spoken_track
from lipwright.passes import apply_passes, bigram_passes
from lipwright.track import PhoneTrack, join_tracks

FPS = 60.0
LINE = (
    "I will call you tomorrow at nine, and then we can talk about the whole plan before the others "
    "come home for dinner. Maybe Bob knows the way to the old mill by now."
)
LENGTHS = {"10 s": 10.0, "a minute": 60.0, "an hour": 3600.0}
ROUNDS = {"10 s": 50, "a minute": 20, "an hour": 5}
EDITS = 50


@dataclass(frozen=True)
class Taken:
    """Seconds that some work took."""

    best: float
    median: float


def taken(work: Callable[[int], object], rounds: int) -> Taken:
    """Time some work, which is told the number of the round; the first round is not counted."""
    seconds = []
    for number in range(rounds + 1):
        start = time.perf_counter()
        work(number)
        seconds.append(time.perf_counter() - start)
    return Taken(min(seconds[1:]), float(np.median(seconds[1:])))


def line_of(seconds: float) -> PhoneTrack:
    """The line, over and over, cut to `seconds`."""
    once = spoken_track(LINE)
    times = math.ceil(seconds / once.end)
    whole = join_tracks([once.shifted(number * once.end) for number in range(times)])
    count = int(np.searchsorted(whole.edges, seconds - 1e-9))
    return PhoneTrack(whole.phones[:count], np.append(whole.edges[:count], seconds))


def final_curves(bigrams: BigramSet, track: PhoneTrack) -> Clip:
    """All that `lipwright animate` does with phones, before a rig puts poses on a face."""
    return apply_passes(animate(track, FPS, None, bigrams), track, bigram_passes(bigrams))


def edited(bigrams: BigramSet, track: PhoneTrack, number: int) -> BigramSet:
    """The set with one of the pairs of a line drawn anew, otherwise each time."""
    pairs = [stand_in(bigrams, span.pair)[1] for span in spans(bigrams, track)]
    known = [pair for pair in pairs if pair is not None]
    bigram = bigrams.bigrams[known[number % len(known)]]
    pose = next(iter(bigrams.poses))
    points = ((0.0, 0.0), (0.5, (number % 10) / 10), (1.0, 0.0))
    return bigrams.with_bigram(replace(bigram, curves={**bigram.curves, pose: points}))


def measure_line(bigrams: BigramSet, track: PhoneTrack, rounds: int) -> Taken:
    """From phones to curves."""
    return taken(lambda _: final_curves(bigrams, track), rounds)


def measure_edits(bigrams: BigramSet, track: PhoneTrack) -> Taken:
    """From a drawn pair to the new curves of a line."""
    drawn: list[Bigram] = []
    for number in range(EDITS + 1):
        other = edited(bigrams, track, number)
        drawn += [pair for key, pair in other.bigrams.items() if pair is not bigrams.bigrams[key]]
    return taken(lambda number: final_curves(bigrams.with_bigram(drawn[number]), track), EDITS)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("set", nargs="?", default=DEFAULT_SET, help="name or file")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    bigrams = load_bigrams(options.set)
    print(
        f"{bigrams.name}: {len(bigrams.bigrams)} pairs, {len(bigrams.poses)} poses, {FPS:.0f} fps"
    )
    figures: dict[str, dict[str, float]] = {}
    for name, seconds in LENGTHS.items():
        track = line_of(seconds)
        work = measure_line(bigrams, track, ROUNDS[name])
        figures[name] = {"best": seconds / work.best, "median": seconds / work.median}
        print(f"{name}, {len(track)} phones: {seconds / work.best:.0f} times real time "
              f"(median {seconds / work.median:.0f}), {1000 * work.best:.1f} ms")  # fmt: skip
    edit = measure_edits(bigrams, line_of(LENGTHS["10 s"]))
    figures["edit"] = {"best": 1000 * edit.best, "median": 1000 * edit.median}
    print(f"edit of a pair to new curves of 10 s: {1000 * edit.best:.1f} ms "
          f"(median {1000 * edit.median:.1f})")  # fmt: skip
    if options.json:
        with write_whole(options.json) as part:
            part.write_text(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
