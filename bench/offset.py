"""How well the offset between sound and picture is found.

Each GRID recording's tracked lips are moved by a random offset of up to 0.4 s, and the estimate of
the moved lips is compared with that of the lips as they were. Then the shares of p, b and m whose
lips come under 15 % of the 95th percentile within some time of the phone, without and with offsets.

    python bench/offset.py [--split test|validation|train|all]
"""

from __future__ import annotations

import argparse
from multiprocessing import Pool

import numpy as np

from grid import Sentence, sentences
from lipwright.capture.offset import Offset, estimate_offset
from lipwright.capture.quality import bilabial_closures
from lipwright.evaluate.lips import Aperture

PLANTED = 0.4  # s, at most, either way
WRONG = 0.06  # s; a larger error is another syllable


def measure(sentence: Sentence) -> tuple[str, Offset, float, Offset]:
    """Name, the recording's own offset, the planted one, and what is found then."""
    lips = sentence.aperture
    seed = int.from_bytes(sentence.name.encode(), "big")
    planted = float(np.random.default_rng(seed).uniform(-PLANTED, PLANTED))
    moved = Aperture(lips.times + planted, lips.values)
    return (
        sentence.name,
        estimate_offset(lips, sentence.track),
        planted,
        estimate_offset(moved, sentence.track),
    )


def closed_share(rows: list[tuple[Sentence, float]], within: float) -> float:
    """Of all bilabials, those that close within so many s of the phone; rows with their lag."""
    closures = [
        closure
        for sentence, lag in rows
        for closure in bilabial_closures(
            sentence.aperture.values, sentence.aperture.times - lag, within, sentence.track
        )
    ]
    return float(np.mean([closure.closed for closure in closures]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--split", default="test")
    options = parser.parse_args()
    chosen = sentences(options.split)
    with Pool(2) as pool:
        rows = pool.map(measure, chosen, chunksize=10)
    own = np.array([row[1].seconds for row in rows])
    applied = np.array([row[1].trusted for row in rows])
    print(f"{len(rows)} recordings; their own offsets, ms, 5th, 50th and 95th percentile:",
          *np.percentile(own * 1000, [5, 50, 95]).round(1))  # fmt: skip
    print(
        f"applied to {applied.sum()}; over 100 ms:",
        ", ".join(f"{n} {1000 * o.seconds:.0f}" for n, o, _, _ in rows if abs(o.seconds) > 0.1),
    )
    trusted = np.array([row[3].trusted for row in rows])
    errors = np.abs([row[3].seconds - row[2] - row[1].seconds for row in rows])[trusted]
    print(
        f"planted: {100 * trusted.mean():.1f} % applied; error of these, ms, median and "
        f"95th percentile: {1000 * np.median(errors):.1f} {1000 * np.percentile(errors, 95):.1f}; "
        f"wrong by over {1000 * WRONG:.0f} ms: {100 * (errors > WRONG).mean():.2f} %"
    )
    without = [(sentence, 0.0) for sentence in chosen]
    lags = [row[1].seconds if row[1].trusted else 0.0 for row in rows]
    for within in (0.0, 0.02, 0.04):
        shares = [
            closed_share(each, within) for each in (without, list(zip(chosen, lags, strict=True)))
        ]
        print(
            f"p, b, m closed within {1000 * within:.0f} ms: "
            f"{100 * shares[0]:.2f} %, with offsets {100 * shares[1]:.2f} %"
        )


if __name__ == "__main__":
    main()
