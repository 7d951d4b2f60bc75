"""Spans: does a phone last from frame j to frame k of a window (Taylor et al. 2017, section 5.2).

Columns are ordered by phone, then by first frame, then by last frame.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lipwright.features.timeline import Indices


def span_count(window: int) -> int:
    """Spans of one phone that a window of W frames can hold."""
    return window * (window + 1) // 2


def span_names(phones: Sequence[str], window: int) -> tuple[str, ...]:
    """The columns, such as `S spans frames 2 to 4`; a window's first frame is 0."""
    return tuple(
        f"{phone} spans frames {j} to {k}"
        for phone in phones
        for j in range(window)
        for k in range(j, window)
    )


def spans(runs: Indices, kinds: Indices, window: int) -> tuple[Indices, Indices]:
    """The spans of each window, as row and column of an array of 0 and 1.

    Args:
        runs: (N + W - 1,), which phone of a track each frame lies in; never falling. Window i
            holds the frames i to i + W - 1.
        kinds: (N + W - 1,), the place of that phone among the phones with columns.
        window: W.

    Returns:
        Rows (0 to N - 1, rising) and columns, as many as there are phones in each window.
    """
    if len(runs) < window:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    begins = np.flatnonzero(np.diff(runs, prepend=runs[0] - 1))  # first frame of each run
    stops = np.append(begins[1:], len(runs))
    of_frame = np.repeat(np.arange(len(begins)), stops - begins)
    first = np.arange(len(runs) - window + 1)
    held = of_frame[window - 1 :] - of_frame[first] + 1  # runs in each window
    row = np.repeat(first, held)
    run = of_frame[row] + np.arange(len(row)) - np.repeat(np.cumsum(held) - held, held)
    j = np.maximum(begins[run] - row, 0)
    k = np.minimum(stops[run] - row, window) - 1
    column = kinds[begins[run]] * span_count(window) + j * window - j * (j - 1) // 2 + (k - j)
    return row, column
