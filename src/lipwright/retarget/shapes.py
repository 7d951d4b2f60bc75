"""Drawn mouths: which of a rig's shapes shows when, chosen for the whole clip at once."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import both_sides
from lipwright.errors import LipwrightError
from lipwright.phones import BILABIALS, SILENCE
from lipwright.retarget.holding import cheapest_labels
from lipwright.retarget.seeing import SEEN, SHUT, are_shut, scaled, seen_at, seen_of
from lipwright.rig import Rig
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]

UNDRAWN: Final = 0.4  # a tongue that is not drawn is missed less than one too many is seen

STEP: Final = 0.01  # s, the grid of times: that of Rhubarb Lip Sync's files
HOLD: Final = 0.08  # s; a drawing shows for two frames of 24 a second or more
SWITCH: Final = 0.02  # s at a distance of one unit that a change of drawing is worth
CLOSURE: Final = 0.15  # of the 95th percentile of aperture; below, p, b and m are closures
PAUSE: Final = 0.2  # s; shorter silences are part of speech
QUIET: Final = 0.3  # s; where nobody says what is spoken, lips that are shut for longer rest
UNFIT: Final = 1.0  # units²; the rest shape in speech, and pressed lips in a pause
FORBIDDEN: Final = 1e5  # units²; beside it no other cost counts
REACH: Final = 2.5  # a mouth that opens little is taken for this many times as open at the most
RESTING: Final = ("X", "rest", "sil")  # names of the drawing of pauses, where a rig has one
WIDEST: Final = 97.0  # percentile of the aperture that counts as a speaker's wide open mouth


@dataclass(frozen=True)
class ShownShape:
    """One drawing and when it shows.

    Raises:
        ValueError: it ends before it starts, or at once.
    """

    start: float
    """s"""
    end: float
    """s, above `start`"""
    name: str
    """a control of the rig"""

    def __post_init__(self) -> None:
        """Check."""
        if not 0 <= self.start < self.end:
            raise ValueError(f"{self.name!r} shows from {self.start} to {self.end} s")


def choose_shapes(
    clip: Clip,
    rig: Rig,
    track: PhoneTrack | None = None,
    *,
    names: Iterable[str] | None = None,
    hold: float = HOLD,
    switch: float = SWITCH,
) -> tuple[ShownShape, ...]:
    """The shapes of a rig that look most like a clip, one after the other without gaps.

    Of all rows of drawings that are held for `hold` or longer, the one with the least sum of
    differences from the clip and of switches. Each closure of the lips shows a shut mouth, and
    pauses show the rest shape. Times are multiples of 10 ms but for the last.

    Args:
        clip: canonical curves.
        rig: its controls are drawings that `looks` describes.
        track: the phones that the clip follows. With it, closures are the p, b and m during which
            the clip shuts the lips; without it, all shut lips but those that rest.
        names: the shapes that are drawn; all by default.
        hold: s that a drawing shows at least.
        switch: s for which a drawing that is plainly wrong is borne to save one change.

    Raises:
        LipwrightError: the rig does not say what its shapes look like, or the clip moves no mouth.
    """
    names = rig.names if names is None else tuple(names)
    check_drawn(clip, rig, names)
    looks = seen_of(rig.look_of(names).astype(np.float64))  # (S, 5)
    rest = names.index(rest_shape(rig, names))
    costs = _costs(clip, track, looks, rest, _shut_shapes(looks, rest))
    labels = cheapest_labels(costs, max(1, round(hold / STEP)), switch / STEP)
    return _runs([names[label] for label in labels], STEP, max(clip.duration, STEP))


def _costs(
    clip: Clip, track: PhoneTrack | None, looks: Floats, rest: int, shut: list[int]
) -> Floats:
    """(T, S), units², of showing each shape at each step."""
    steps = max(1, math.ceil(clip.duration / STEP - 1e-6))
    middles = np.asarray((np.arange(steps) + 0.5) * STEP, np.float64)
    seen = seen_at(clip, middles)
    seen[:, 0] *= _reach(seen[:, 0], looks[:, 0])
    wrong = scaled(seen)[:, None] - scaled(looks)  # (T, S, 5)
    wrong[:, :, 4] *= np.where(wrong[:, :, 4] > 0, UNDRAWN, 1.0)
    costs = (wrong**2).sum(axis=2)
    pauses, closures = _pauses_and_closures(clip, track)
    quiet = np.zeros(steps, bool)
    for start, end in pauses:
        quiet |= (middles >= start) & (middles < end)
    if rest not in shut:
        costs[~quiet, rest] += UNFIT
        costs[np.ix_(quiet.nonzero()[0], np.array(shut))] += UNFIT
    tightest = np.minimum((np.array(closures) / STEP + 1e-6).astype(int), steps - 1)
    for label in range(len(looks)):
        if label not in shut:
            costs[tightest, label] = FORBIDDEN
    return np.asarray(costs)


def check_drawn(clip: Clip, rig: Rig, names: Iterable[str]) -> None:
    """Refuse what shapes cannot be chosen for.

    Raises:
        LipwrightError: as `choose_shapes`.
    """
    names = tuple(names)
    rig.check_controls(names, "the choice of shapes")
    if not any(rig.looks.get(name) for name in names):
        raise LipwrightError(
            f"the rig {rig.name!r} does not say what its shapes look like; add 'looks' to its file"
        )
    if not set(clip.names) & {side for name in SEEN for side in both_sides(name)}:
        raise LipwrightError(
            f"curves of {', '.join(clip.names[:3])}... move no mouth that the shapes of the rig "
            f"{rig.name!r} could show; give canonical ones, such as jawOpen"
        )


def shape_curves(shown: Iterable[ShownShape], rig: Rig, fps: float, frames: int) -> Clip:
    """Curves (T, C) of which one at a time is in full: what shows in the middle of each frame."""
    shown = tuple(shown)
    middles = (np.arange(frames) + 0.5) / fps
    index = np.searchsorted([shape.end for shape in shown[:-1]], middles, side="right")
    columns = np.array([rig.names.index(shape.name) for shape in shown])[index]
    values = np.zeros((frames, len(rig.names)), np.float32)
    values[np.arange(frames), columns] = 1.0
    return rig.fit(Clip(rig.names, fps, values))


def shown_shapes(clip: Clip, rig: Rig) -> tuple[ShownShape, ...]:
    """The shapes of curves of a rig of drawings: the largest of each frame, from its time on."""
    values = rig.fit(clip).values
    return _runs(
        [rig.names[column] for column in values.argmax(axis=1)],
        1 / clip.fps,
        max(clip.duration, 1 / clip.fps),
    )


def _runs(labels: list[str], step: float, end: float) -> tuple[ShownShape, ...]:
    starts = [i for i in range(len(labels)) if i == 0 or labels[i] != labels[i - 1]]
    times = [round(start * step, 6) for start in starts]
    if len(times) > 1 and times[-1] >= end:  # the last frame of curves lasts no time
        times.pop()
    edges = [*times, end]
    return tuple(
        ShownShape(edges[i], edges[i + 1], labels[starts[i]]) for i in range(len(edges) - 1)
    )


def _reach(apertures: Floats, drawn: Floats) -> float:
    """What to multiply apertures by, so that a speaker's wide open mouth is the widest drawing."""
    wide = float(np.percentile(apertures, WIDEST))
    return float(np.clip(drawn.max() / wide, 1.0, REACH)) if wide > SHUT else 1.0


def rest_shape(rig: Rig, names: Iterable[str] | None = None) -> str:
    """The drawing of pauses, of all or of `names`: one that is called so, or looks most like it."""
    names = rig.names if names is None else tuple(names)
    if usual := [name for name in RESTING if name in names]:
        return usual[0]
    looks = seen_of(rig.look_of(names).astype(np.float64))
    return names[int((scaled(looks) ** 2).sum(axis=1).argmin())]


def _shut_shapes(looks: Floats, rest: int) -> list[int]:
    """The shapes that show a closure: those but `rest` that are shut, if any."""
    closed = are_shut(looks)
    shut = [int(label) for label in np.flatnonzero(closed) if label != rest]
    return shut or [rest if closed[rest] else int(looks[:, 0].argmin())]


def _pauses_and_closures(
    clip: Clip, track: PhoneTrack | None
) -> tuple[list[tuple[float, float]], list[float]]:
    """Start and end in s of where nobody speaks, and the times in s at which lips have to meet."""
    # Steps miss a frame between them that alone is shut, and frames the edges of phones.
    times = np.union1d(clip.times, np.arange(0, clip.duration, STEP))
    seen = seen_at(clip, times)
    apertures = seen[:, 0].clip(min=0)
    limit = SHUT
    if track is None:
        spans = _spans(are_shut(seen))
        lasting = [(float(times[first]), float(times[stop - 1])) for first, stop in spans]
        pauses = [(start, end) for start, end in lasting if end - start >= QUIET]
        spoken = [span for span, shut in zip(spans, lasting, strict=True) if shut not in pauses]
    else:
        limit = max(SHUT, CLOSURE * float(np.percentile(apertures, 95)))
        pauses = [(0.0, track.start), (track.end, np.inf)]
        pauses += [
            (start, end) for phone, start, end in track
            if phone == SILENCE and end - start >= PAUSE
        ]  # fmt: skip
        labials = [(start, end) for phone, start, end in track if phone in BILABIALS]
        spoken = [(int(first), int(stop)) for first, stop in np.searchsorted(times, labials)]
    return pauses, [
        float(times[first + _tightest(apertures[first:stop])])
        for first, stop in spoken
        if apertures[first:stop].min(initial=np.inf) < limit
    ]


def _tightest(apertures: Floats) -> int:
    """The middle of where an aperture is least."""
    least = np.flatnonzero(apertures == apertures.min())
    return int(least[len(least) // 2])


def _spans(mask: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and stop of each run of true steps."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(first), int(stop)) for first, stop in edges.reshape(-1, 2)]
