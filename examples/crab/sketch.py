"""A first sketch of the pairs that words need and the crab's set lacks; then draw over it.

python examples/crab/sketch.py WORDS.txt

A pair by rule meets the targets of its two phones, each in the middle of its phone. Pairs that are
in the set already stay as they are.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

from lipwright.bigrams.coverage import Counting
from lipwright.bigrams.edits import edit_set, with_bigram
from lipwright.bigrams.fields import SetFile
from lipwright.bigrams.values import Bigram, BigramSet, Points
from lipwright.errors import LipwrightError
from lipwright.formats.source import read_text

SET: Final = Path(__file__).with_name("crab.bigrams.json")
SPREAD: Final = 1 / 12  # of a phone; a spline meets the middle one of three equal points
HOLD: Final = (0.25, 0.75)  # of a phone that shuts the lips
PARTS: Final = (0.3, 0.7)  # of a phone with two targets
ANTICIPATION: Final = 0.45  # of a round mouth, while the phone before it is said
CARRIED: Final = 0.25  # of a round mouth, while the phone after it is said

Target = dict[str, float]

TARGETS: Final[dict[str, tuple[Target, ...]]] = {
    "sil": ({},),
    "ah": ({"mouth open": 0.60, "smile": 0.10},),
    "aa": ({"mouth open": 0.85},),
    "ao": ({"mouth open": 0.55, "mouth OO": 0.50},),
    "eh": ({"mouth open": 0.48, "smile": 0.45},),
    "er": ({"mouth open": 0.25, "mouth OO": 0.45, "tongue up": 0.30},),
    "ih": ({"mouth open": 0.26, "smile": 0.60, "bare teeth": 0.15},),
    "w": ({"mouth OO": 0.95},),
    "ow": ({"mouth open": 0.55, "mouth OO": 0.45}, {"mouth open": 0.10, "mouth OO": 0.90}),
    "aw": ({"mouth open": 0.85, "smile": 0.10}, {"mouth open": 0.15, "mouth OO": 0.80}),
    "oy": ({"mouth open": 0.40, "mouth OO": 0.70}, {"mouth open": 0.30, "smile": 0.60}),
    "ay": ({"mouth open": 0.85}, {"mouth open": 0.35, "smile": 0.60}),
    "h": ({"mouth open": 0.35},),
    "r": ({"mouth open": 0.12, "mouth OO": 0.55, "tongue up": 0.35},),
    "l": ({"mouth open": 0.38, "tongue up": 0.95},),
    "z": ({"bare teeth": 0.55, "smile": 0.25},),
    "sh": ({"mouth OO": 0.60, "bare teeth": 0.30},),
    "th": ({"mouth open": 0.40, "tongue out": 0.65},),
    "f": ({"bare teeth": 0.42, "tongue down": 0.40},),
    "d": ({"mouth open": 0.28, "tongue up": 0.85, "bare teeth": 0.12},),
    "kg": ({"mouth open": 0.36, "tongue down": 0.80},),
    "bmp": ({"frown": 1.0},),
}
"""class to what the crab does for it: ours, by eye"""

SHUT: Final = "bmp"


def sketch(first: str, second: str) -> Bigram:
    """The pair by rule.

    Raises:
        KeyError: there is no target for a class.
    """
    curves: dict[str, Points] = {}
    for pose in sorted({pose for one in (first, second) for t in TARGETS[one] for pose in t}):
        one = [(time / 2, value) for time, value in _half(first, second, pose, ANTICIPATION)]
        other = [(0.5 + time / 2, v) for time, v in _half(second, first, pose, CARRIED)]
        points = ((0.0, 0.0), *one, *other, (1.0, 0.0))
        if any(value for _, value in points):
            curves[pose] = tuple((round(time, 3), round(value, 2)) for time, value in points)
    return Bigram(first, second, curves, source="rule")


def _half(phone: str, neighbour: str, pose: str, share: float) -> list[tuple[float, float]]:
    """The points of one phone, at times from 0 to 1 over it."""
    if phone == SHUT:
        value = TARGETS[phone][0].get(pose, 0.0)
        return [point for time in HOLD for point in _three(time, value)]
    values = [target.get(pose, 0.0) for target in TARGETS[phone]]
    if pose == "mouth OO" and not any(values) and phone != "sil":
        values = [share * TARGETS[neighbour][0 if share == ANTICIPATION else -1].get(pose, 0.0)]
    times = PARTS if len(values) > 1 else (0.5,)
    return [point for at, value in zip(times, values, strict=True) for point in _three(at, value)]


def _three(time: float, value: float) -> list[tuple[float, float]]:
    return [(time - SPREAD, value), (time, value), (time + SPREAD, value)]


def sketch_missing(said: SetFile, whole: BigramSet, text: str) -> SetFile:
    """A set's file with every pair that `text` needs."""
    counting = Counting()
    counting.add_text(text, whole.language)
    for row in counting.coverage(whole).missing:
        said = with_bigram(said, sketch(*row.pair))
    return said


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("name a file of text, such as: python examples/crab/sketch.py line.txt")
    try:
        words = read_text(Path(sys.argv[1]))
    except LipwrightError as error:
        sys.exit(str(error))
    before = edit_set(SET, lambda said, whole: said)
    after = edit_set(SET, lambda said, whole: sketch_missing(said, whole, words))
    print(f"{SET.name}: {len(after.bigrams) - len(before.bigrams)} pairs sketched")
