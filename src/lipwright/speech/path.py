"""The best path through a recording of any length, one stretch after the other.

A stretch is searched as a whole. What the search decided well before its end is kept up to a
pause, and the next stretch begins there: what comes later could not change it any more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from lipwright.speech.graph import FILLER_WORD, Graph
from lipwright.speech.search import Search, Segment

STRETCH: Final = 4000  # frames that are searched at once, 40 s
LAG: Final = 800  # frames before the end of a stretch that may yet change, 8 s


def find_path(search: Search, report: Callable[[float], None]) -> list[Segment]:
    """The best path over all frames; `report` hears of the share that is done."""
    n_frames = len(search.scores)
    path: list[Segment] = []
    start, hub = 0, 0
    while True:
        stop = min(start + STRETCH, n_frames)
        if n_frames - stop < LAG:
            stop = n_frames
        found = search.run(start, stop, hub, to_end=stop == n_frames)
        if stop == n_frames:
            report(1.0)
            return path + found
        start, hub, kept = _cut(search.graph, found, start, stop)
        path += kept
        report(start / n_frames)


def _cut(
    graph: Graph, path: list[Segment], start: int, stop: int
) -> tuple[int, int, list[Segment]]:
    """Where to go on, frame and hub, and the path up to there.

    That is in the longest pause of the last stretch that is sure, or else of the one before.
    """
    high = stop - LAG
    pauses = [s for s in path if graph.pronunciation[s.node] == FILLER_WORD]
    for low in (high - LAG, start + LAG):
        longest = max(pauses, key=lambda s: _overlap(s, low, high), default=None)
        if longest is not None and _overlap(longest, low, high) > 0:
            frame = (min(longest.stop, high) + max(longest.start, low)) // 2
            break
    else:
        starts = [s for s in path if graph.position[s.node] == 0 and start + LAG < s.start <= high]
        longest = starts[-1] if starts else path[-1]
        frame = longest.start
    kept = [s for s in path if s.stop <= frame]
    if longest.start < frame:
        share = (frame - longest.start) / (longest.stop - longest.start)
        kept.append(replace(longest, stop=frame, score=longest.score * share))
    return frame, int(graph.hub[longest.node]), kept


def _overlap(segment: Segment, low: int, high: int) -> int:
    return min(segment.stop, high) - max(segment.start, low)
