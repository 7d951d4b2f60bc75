"""`Edits`: differences of curves, and how they move when the words move."""

from __future__ import annotations

from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.track import PhoneTrack

SAME: Final = 2e-5  # units of a control; tables have five decimals, and two of them may be off


@dataclass(frozen=True, eq=False)
class Edits:
    """What people changed in the curves of one file.

    They are differences: what is automatic may change below them.
    """

    changes: Clip | None = None
    """control to what was added to it, on the clock of `track`; None where nothing was changed"""
    track: PhoneTrack | None = None
    """the phones that the changed curves followed"""
    written: tuple[Clip, ...] = ()
    """the curves that Lipwright wrote to the file; two where it may have been stopped between"""

    def gathered(self, found: Clip) -> Edits:
        """The edits with those that the file has since it was written.

        Args:
            found: the curves that are in the file now.

        Curves without any of the edits were written by a run that knew nothing of them: then the
        edits stay. To drop them all, delete their file.

        Returns:
            Edits whose `written` is what was found: gathering twice adds nothing.
        """
        if not self.written:
            return replace(self, written=(found,))
        news = self.news(found)
        if self.undone(news):
            return replace(self, written=(found,))
        return replace(self, changes=added(self.changes, news), written=(found,))

    def news(self, found: Clip) -> Clip | None:
        """How the curves in the file differ from what was written there; None for not at all."""
        return min((difference(found, base) for base in self.written), key=_size, default=None)

    def undone(self, news: Clip | None) -> bool:
        """Whether a difference takes all changes back and does nothing else."""
        return self.changes is not None and news is not None and added(self.changes, news) is None

    def moved_to(self, track: PhoneTrack | None) -> Edits:
        """The edits where the same phones are said at other times.

        Phones that both tracks have in the same order carry their edits along; between them time
        is stretched.
        """
        if self.changes is None or track is None or self.track is None:
            return replace(self, track=track if track is not None else self.track)
        old, new = _anchors(self.track, track)
        if np.array_equal(old, new):
            return replace(self, track=track)
        length = max(round(float(np.interp(self.changes.duration, old, new)) * self.changes.fps), 0)
        times = np.arange(length + 1) / self.changes.fps
        # Beyond the last phone time runs on as before.
        back = np.interp(times, new, old) + np.maximum(times - new[-1], 0)
        moved = self.changes.with_values(self.changes.at(back))
        return replace(self, changes=moved, track=track)

    def applied(self, clip: Clip) -> Clip:
        """The automatic curves with the edits; controls that only the edits have come last."""
        if self.changes is None:
            return clip
        more = tuple(name for name in self.changes.names if name not in clip.names)
        values = clip.select((*clip.names, *more)).values.copy()
        inside = clip.times <= self.changes.duration + 0.5 / self.changes.fps
        columns = np.array([(*clip.names, *more).index(name) for name in self.changes.names])
        values[np.ix_(np.flatnonzero(inside), columns)] += self.changes.at(clip.times[inside])
        return Clip((*clip.names, *more), clip.fps, values)


def difference(found: Clip, base: Clip) -> Clip | None:
    """What `found` has more than `base` where both have a control, or only it; None for nothing."""
    values = found.values - base.select(found.names).at(found.times)
    values[np.abs(values) <= SAME] = 0
    changed = np.flatnonzero(values.any(axis=0))
    if not len(changed):
        return None
    names = tuple(found.names[column] for column in changed)
    return Clip(names, found.fps, values[:, changed])


def added(first: Clip | None, second: Clip | None) -> Clip | None:
    """The sum of two changes, on the clock of the second; what comes to nothing is left out."""
    if first is None or second is None:
        return second if first is None else first
    names = tuple(dict.fromkeys((*first.names, *second.names)))
    count = max(round(first.duration * second.fps), len(second) - 1) + 1
    times = np.arange(count) / second.fps
    values = _held(second.select(names), times) + _held(first.select(names), times)
    values[np.abs(values) <= SAME] = 0
    kept = np.flatnonzero(values.any(axis=0))
    if not len(kept):
        return None
    return Clip(tuple(names[column] for column in kept), second.fps, values[:, kept])


def _held(clip: Clip, times: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """The clip at `times`; nothing after its end."""
    values = clip.at(times)
    values[times > clip.duration + 0.5 / clip.fps] = 0
    return values


def _size(change: Clip | None) -> float:
    return 0.0 if change is None else float(np.abs(change.values).sum())


def _anchors(
    old: PhoneTrack, new: PhoneTrack
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Times (n,) that are the same moment in both tracks: edges of phones that both have."""
    if old.phones == new.phones:
        return old.edges, new.edges
    pairs = {(0.0, 0.0), (old.end, new.end)}
    for block in SequenceMatcher(
        None, old.phones, new.phones, autojunk=False
    ).get_matching_blocks():
        if block.size:
            here, there = slice(block.a, block.a + block.size + 1), slice(block.b, None)
            pairs |= set(zip(old.edges[here].tolist(), new.edges[there].tolist(), strict=False))
    rising = sorted(pairs)
    kept = [rising[0]]
    for pair in rising[1:]:
        if pair[0] > kept[-1][0] and pair[1] > kept[-1][1]:
            kept.append(pair)
    points = np.array(kept)
    return points[:, 0], points[:, 1]
