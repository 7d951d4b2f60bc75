"""Curves of phone bigrams out of JSON: control points, and which of them is wrong."""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

from lipwright.bigrams.jsonvalues import Path, is_number, kind_of, named, shown
from lipwright.bigrams.places import Fault
from lipwright.bigrams.values import Points, check_points


def read_curve(rows: object, path: Path) -> Points:
    """The control points of a curve.

    Raises:
        Fault: one is wrong, or there are none.
    """
    points = read_points(rows, path)
    check_curve(points, path)
    return points


def read_points(rows: Any, path: Path) -> Points:
    """Pairs of numbers, which `check_curve` has still to look at.

    Raises:
        Fault: something else is among them.
    """
    try:
        return tuple([_point(*row) for row in rows])
    except (TypeError, OverflowError):
        raise _wrong(rows, path) from None


def _point(time: float, value: float) -> tuple[float, float]:
    if type(time) is bool or type(value) is bool:
        raise TypeError
    return time + 0.0, value + 0.0


def _wrong(rows: object, path: Path) -> Fault:
    """What is wrong with control points that are no pairs of numbers."""
    if not isinstance(rows, list):
        return Fault(
            path, f"{named(path)} is {kind_of(rows)}, not a list of control points [time, value]"
        )
    for place, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != 2:
            return Fault((*path, place), f"control point {place + 1} is no [time, value]")
        for part, number in enumerate(row):
            if not is_number(number):
                what = ("time", "value")[part]
                return Fault(
                    (*path, place, part),
                    f"the {what} of control point {place + 1} is {shown(number)}, not a number",
                )
    return Fault(path, "is no list of control points [time, value]")


def check_curve(points: Points, path: Path) -> None:
    """Refuse control points as `check_points` does, with the place of the first wrong one."""

    def reason(count: int) -> str:
        try:
            check_points(points[:count])
        except ValueError as error:
            return str(error)
        return ""

    if points and not reason(len(points)):
        return
    # The shortest beginning that is refused ends in the point that is wrong.
    first = bisect_left(range(1, len(points) + 1), True, key=lambda count: bool(reason(count)))
    raise Fault((*path, first) if points else path, reason(first + 1))
