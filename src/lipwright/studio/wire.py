"""Bigrams as the JSON that page, journal and server exchange."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from lipwright.bigrams.file import DECIMALS
from lipwright.bigrams.values import Bigram, BigramSet, Pair, Source
from lipwright.errors import LipwrightError

MAX_POINTS: Final = 200  # of one curve; a hand draws some ten
MAX_NOTE: Final = 500  # characters

Curves = Mapping[str, Sequence[Sequence[float]]]


def pair_key(pair: Pair) -> str:
    """Both classes with a space between, as in the file of a set."""
    return " ".join(pair)


def split_key(key: str) -> Pair:
    """The pair of a key.

    Raises:
        LipwrightError: it is no pair of class names.
    """
    first, _, second = key.partition(" ")
    if not first or not second or second.split() != [second]:
        raise LipwrightError(f"{key[:40]!r} is not two classes with a space between")
    return first, second


def bigram_to_json(bigram: Bigram) -> dict[str, Any]:
    """What a pair holds, without its name."""
    return {
        "source": bigram.source,
        "count": bigram.count,
        "note": bigram.note,
        "curves": {pose: [list(point) for point in row] for pose, row in bigram.curves.items()},
        "variance": dict(bigram.variance),
    }


def drawn_bigram(bigrams: BigramSet, pair: Pair, curves: Curves, note: str = "") -> Bigram:
    """The pair as somebody drew it, checked against the set.

    Raises:
        LipwrightError: an unknown class or pose, or points that are no curve.
    """
    return checked_bigram(bigrams, pair, {"source": "drawn", "note": note, "curves": curves})


def checked_bigram(bigrams: BigramSet, pair: Pair, data: Mapping[str, Any]) -> Bigram:
    """What `bigram_to_json` made, or a page or file claims that it made.

    Raises:
        LipwrightError: it is no bigram of this set.
    """
    named = pair_key(pair)
    for name in pair:
        if name not in bigrams.classes:
            raise LipwrightError(f"{named[:40]!r}: the set has no class {name[:40]!r}")
    curves = data.get("curves")
    if not isinstance(curves, Mapping):
        raise LipwrightError(f"{named!r} has no curves")
    for pose, points in curves.items():
        _check_curve(bigrams, named, pose, points)
    source: Source = data.get("source", "drawn")
    try:
        return Bigram(
            *pair,
            {pose: tuple(map(_rounded, row)) for pose, row in curves.items()},
            source,
            int(data.get("count", 0)),
            {str(pose): float(value) for pose, value in dict(data.get("variance", {})).items()},
            str(data.get("note", ""))[:MAX_NOTE],
        )
    except (ValueError, TypeError, OverflowError) as error:
        raise LipwrightError(f"{named!r}: {error}") from error


def _check_curve(bigrams: BigramSet, named: str, pose: object, points: object) -> None:
    if pose not in bigrams.poses:
        raise LipwrightError(f"{named!r}: the set has no pose {str(pose)[:40]!r}")
    if not isinstance(points, list | tuple) or not 1 <= len(points) <= MAX_POINTS:
        raise LipwrightError(f"{named!r}: {pose!r} wants 1 to {MAX_POINTS} control points")
    for number, point in enumerate(points, start=1):
        if not isinstance(point, list | tuple) or len(point) != 2 or not all(map(_plain, point)):
            raise LipwrightError(
                f"{named!r}: {pose!r}: control point {number} is not two finite numbers"
            )


def _rounded(point: Sequence[float]) -> tuple[float, float]:
    """As the file will have it; so an edit that is undone after saving is none."""
    return round(float(point[0]), DECIMALS), round(float(point[1]), DECIMALS)


def _plain(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
