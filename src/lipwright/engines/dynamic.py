"""The dynamic engine: recorded gestures, found for phone strings and joined (dynamic visemes).

After Taylor, Mahler, Theobald and Matthews, "Dynamic units of visual speech" (2012), as Taylor et
al. (2017), section 8.1, describe it: the units are short movements of the face, each of which can
say many phone strings. The row of units that says a track is the one of least cost: improbable
strings, jumps where two units meet and unusual durations cost. Each unit's gesture is then warped
on to the track's phone edges, and bent so that it begins where the one before it ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip, frame_times
from lipwright.engines.dynamic_path import cheapest_cover
from lipwright.engines.dynamic_speech import Stretch, stretches
from lipwright.engines.dynamic_units import END, REST, SHORTEST_S, Units, pose_at, units_of
from lipwright.engines.learnt import arrange, clip_names, open_arrays_of
from lipwright.network.arrays import ArrayModel
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.audio import Sound

Values = npt.NDArray[np.float32]
Floats = npt.NDArray[np.float64]

BEND_S: Final = 0.3  # s of a unit at most over which it is bent towards its neighbour
BATCH: Final = 256  # pieces that are drawn at once


@dataclass(frozen=True, eq=False)
class Piece:
    """A gesture on the clock of the track."""

    gesture: int
    times: Floats
    """(K,), s, rising, of its joints; the first and last are its ends"""
    marks: Floats
    """(K,), where in the gesture these are, 0 to 1"""


def pieces(units: Units, track: PhoneTrack) -> Iterator[Piece]:
    """The gestures that say a track, in order; each begins where the one before it ends."""
    waiting: Stretch | None = None
    rested = False
    for stretch in stretches(track, units.phones):
        if waiting is not None:
            yield from _say(units, waiting, rested, not stretch.phones)
            rested, waiting = False, None
        if stretch.phones:
            waiting = stretch
        else:
            yield Piece(REST, stretch.edges, np.array([0.0, 1.0]))
            rested = True
    if waiting is not None:
        yield from _say(units, waiting, rested, False)


def _say(units: Units, stretch: Stretch, before: bool, after: bool) -> Iterator[Piece]:
    """The gestures of a stretch; `before` and `after` say whether the face rests there."""
    arcs, chosen = zip(*units.arcs(stretch), strict=True)
    path = cheapest_cover(
        arcs, units.weights.smoothness, units.rest if before else None,
        units.rest if after else None,
    )  # fmt: skip
    which = [int(chosen[place][row]) for place, row in path]
    starts = [place for place, _ in path] + [stretch.joints]
    meets = np.array(starts, np.float64)
    # Where gestures were heard to meet beside a joint, they meet there, between both habits.
    habits = (units.ends[which[:-1], 1] + units.ends[which[1:], 0]) / 2
    meets[1:-1] += np.clip(habits, -END, END)
    for number, unit in enumerate(which):
        first, length = starts[number], int(units.lengths[unit])
        joints = first + np.arange(length + 1, dtype=np.float64)
        joints[0], joints[-1] = meets[number], meets[number + 1]
        marks = units.marks[unit, : length + 1]
        yield Piece(int(units.gesture[unit]), stretch.times(joints), marks)


def curves(units: Units, said: Iterable[Piece], times: Floats) -> Values:
    """(T, C), the controls at rising times in s; beyond the ends the end poses stay.

    Where two pieces meet, both are bent to the mean of their poses.

    Args:
        units: of the model.
        said: the pieces of a track, at least one.
        times: (T,).
    """
    made = np.empty((len(times), units.gestures.shape[2]), np.float32)
    row = iter(said)
    batch = list(islice(row, BATCH))
    jump = np.zeros(made.shape[1], np.float32)
    done = 0
    while batch:
        more = list(islice(row, BATCH))
        poses = _ends(units, batch + more[:1])  # (K, 2, C)
        leaps = (poses[1:, 0] - poses[:-1, 1]) / 2
        stop = int(np.searchsorted(times, batch[-1].times[-1])) if more else len(times)
        last = leaps[-1:] if more else np.zeros((1, made.shape[1]), np.float32)
        ends = leaps if more else np.concatenate([leaps, last])
        starts = np.concatenate([jump[None], -leaps[: len(batch) - 1]])
        made[done:stop] = _poses(units, batch, times[done:stop], starts, ends)
        jump, batch, done = -last[0], more, stop
    return made


def _ends(units: Units, said: list[Piece]) -> Values:
    """(K, 2, C), the first and last pose of each piece."""
    which = np.array([piece.gesture for piece in said])
    marks = np.array([piece.marks[[0, -1]] for piece in said])
    first, last = (pose_at(units.gestures, which, marks[:, end]) for end in (0, 1))
    return np.stack([first, last], axis=1).astype(np.float32)


def _poses(
    units: Units, said: list[Piece], times: Floats, start: npt.NDArray[Any], end: npt.NDArray[Any]
) -> Values:
    """(T, C) at times, of K pieces whose ends move by `start` and `end`, (K, C)."""
    edges = np.array([piece.times[0] for piece in said] + [said[-1].times[-1]])
    owner = np.clip(np.searchsorted(edges, times, "right") - 1, 0, len(said) - 1)
    place = np.empty(len(times))
    for index in np.unique(owner):
        mine = owner == index
        place[mine] = np.interp(times[mine], said[index].times, said[index].marks)
    made = pose_at(units.gestures, np.array([piece.gesture for piece in said])[owner], place)
    reach = np.clip(np.diff(edges), SHORTEST_S, BEND_S)[owner]
    for far, moved in ((times - edges[owner], start), (edges[owner + 1] - times, end)):
        near = 1 - np.clip(far / reach, 0, 1)
        made += (near * near * (3 - 2 * near))[:, None] * moved[owner]
    return made.astype(np.float32)


def predict_at(
    model: ArrayModel, track: PhoneTrack, times: npt.NDArray[np.float64],
    audio: Sound | None = None,
) -> Values:  # fmt: skip
    """(T, C), the model's own controls at (T,) rising `times` in s; the sound is not heard."""
    del audio
    units = units_of(model)
    return curves(units, pieces(units, track), np.asarray(times, np.float64))


def animate(
    track: PhoneTrack,
    fps: float,
    audio: Sound | None = None,
    model: str | Path | ArrayModel | None = None,
) -> Clip:
    """The motion of a track, from 0 s to its end.

    Args:
        track: phones with times.
        fps: frames a second of the clip.
        audio: not heard.
        model: a model's folder, or an open one; none ships.

    Returns:
        Canonical controls (those that the model does not predict are at rest), or modes of a
        reference face where it predicts those alone. Values are not clipped.

    Raises:
        LipwrightError: no model is named, or it cannot be used.
    """
    network = open_network(model)
    values = predict_at(network, track, frame_times(track.end, fps), audio)
    return Clip(clip_names(network), fps, arrange(network, values))


def open_network(model: str | Path | ArrayModel | None = None) -> ArrayModel:
    """The arrays of a model, loaded once while its files stay as they are, and checked.

    Raises:
        LipwrightError: none is named, it cannot be used, or it is one of another engine.
    """
    opened = open_arrays_of(model, "dynamic")
    units_of(opened)
    return opened
