"""Drawings of the reference face's outline, with words beside them, in numpy alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.face.vertices import OUTLINES

Floats = npt.NDArray[np.float64]
Picture = npt.NDArray[np.uint8]

PAPER: Final = (250, 249, 246)
LIPS: Final = (178, 58, 72)
LINE: Final = (90, 96, 104)
PALE: Final = (208, 208, 204)
_COLOURS: Final = (LIPS, LIPS, LINE, LINE)
"""of the rows of `OUTLINES`: outer and inner lips, jaw, nostrils"""

# Strokes of letters: points of two digits, x from 0 to 4 and y from 0, the top, to 6.
_GLYPHS: Final = MappingProxyType(
    {
        "0": ("103041453616050110",), "1": ("012026", "1636"), "2": ("01103041420646",),
        "3": ("0110304142334445361605", "1333"), "4": ("36300444",), "5": ("400003334445361605",),
        "6": ("30100105163645443303",), "7": ("004016",),
        "8": ("13334241301001021304051636454433",), "9": ("43130201103041453616",),
        "+": ("2125", "0343"), "-": ("0343",), ".": ("1516",),
        "a": ("4332120305163645", "4246"), "d": ("4332120305163645", "4046"),
        "e": ("044443321203051646",), "h": ("0006", "0312324346"),
        "m": ("0602", "03122326", "23324346"), "n": ("0206", "0312324346"),
        "o": ("123243453616050312",), "s": ("4212031434453606",), "t": ("20253646", "0242"),
        "u": ("0205163645", "4246"),
    }
)  # fmt: skip


def draw_outline(
    points: npt.ArrayLike, size: int, box: tuple[Floats, Floats], behind: npt.ArrayLike | None
) -> Picture:
    """The outline of the vertices (34, 2), y down, in a picture (size, size, 3).

    Args:
        points: eye distances.
        size: px.
        box: the least and the greatest corner that must be seen, eye distances.
        behind: another shape, in pale.
    """
    low, high = box
    scale = size / float((high - low).max())
    shift = (size - scale * (high - low)) / 2 - scale * low
    canvas = np.tile(np.array(PAPER, np.float64), (size, size, 1))
    for shape, pale in ((behind, True), (points, False)):
        if shape is None:
            continue
        placed = np.asarray(shape, np.float64) * scale + shift
        for outline, colour in zip(OUTLINES, _COLOURS, strict=True):
            draw_line(canvas, placed[list(outline)], PALE if pale else colour, size / 120)
    return np.asarray(np.rint(canvas), np.uint8)


def draw_line(canvas: Floats, points: npt.ArrayLike, colour: Iterable[int], width: float) -> None:
    """Draw a line through points (n, 2), x and y in px, `width` px wide, onto (H, W, 3)."""
    points = np.asarray(points, np.float64)
    shares = np.zeros(canvas.shape[:2])
    for start, end in pairwise(points):
        low = np.maximum(np.floor(np.minimum(start, end) - width - 1), 0).astype(int)
        high = np.ceil(np.maximum(start, end) + width + 2).astype(int)
        rows, columns = np.mgrid[low[1] : high[1], low[0] : high[0]]
        window = shares[low[1] : high[1], low[0] : high[0]]
        at = np.stack([columns, rows], axis=-1)[: window.shape[0], : window.shape[1]] - start
        step = end - start
        along = np.clip(at @ step / max(float(step @ step), 1e-12), 0.0, 1.0)
        away = np.linalg.norm(at - along[..., None] * step, axis=-1)
        np.maximum(window, np.clip(width / 2 + 0.5 - away, 0.0, 1.0), out=window)
    canvas += shares[..., None] * (np.array([*colour], np.float64) - canvas)


def draw_words(
    picture: Picture, words: str, height: float, colour: Iterable[int] = LINE
) -> Picture:
    """The picture with words in its lower left corner, `height` px a capital.

    There are digits, plus, minus and the letters of the poses' names.
    """
    colour = tuple(colour)
    canvas = picture.astype(np.float64)
    unit = height / 6
    x, y = 2.0 * unit, canvas.shape[0] - 9 * unit
    for letter in words:
        for stroke in _GLYPHS.get(letter, ()):
            numbers = np.array([int(digit) for digit in stroke], np.float64).reshape(-1, 2)
            draw_line(canvas, numbers * unit + (x, y), colour, 0.8 * unit)
        x += 5.5 * unit
    return np.asarray(np.rint(canvas), np.uint8)


def sheet(rows: Sequence[Sequence[Picture]]) -> Picture:
    """Pictures of one size as one, row by row."""
    return np.vstack([np.hstack(row) for row in rows])
