"""The speaker against himself: other takes of the same first words, warped by phone edges.

Nobody says a sentence twice alike. Two takes of the same words, brought to the same phone times,
correlate by some r; an engine can hardly be asked to be nearer to a take than its speaker is.

What may be concluded. Let a take be what the phones and their times determine, plus what is this
take's own, independent of other takes, and let rho be the share of the variance that the phones
determine. Then two takes correlate by rho; the mean of n takes and another one by
sqrt(n rho^2 / (1 + (n - 1) rho)) (`of_mean`; the formula of Spearman and Brown, 1910); and the
best that phones alone allow, the mean of endlessly many takes, by sqrt(rho). So an engine above
the r of two takes is no wonder: it predicts a mean. One above sqrt(rho) knows more than this warp
does: the sound, how long phones last (a hurried vowel opens less), or the words after the shared
ones. And rho is measured low by what spoils both takes: edges that the aligner misplaced, pictures
late by offsets that differ, a linear warp inside phones. So sqrt(rho) is a guide, not a bound.

The other take stands where an engine would: on the clock of the sound, its picture's offset taken
off. r is measured on the clock of the recording's video, as all r of the lips; with that offset
taken off too, rho is measured without it (`Pair.r_on_sound`).

All is measured over the shared words only, which are easier or harder than whole sentences: an
engine is compared with the ceiling over the same words of the same recordings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.dataset.recording import Recording
from lipwright.evaluate.errors import Truth, face_r, frame_errors, load_truth
from lipwright.evaluate.lip_rows import lip_rows, lower
from lipwright.evaluate.lips import Aperture, correlation, evaluate
from lipwright.evaluate.measures import Rows, Scores
from lipwright.evaluate.shared_words import (
    FIRST_WORDS,
    Shared,
    first_words,
    shared_span,
    times_in_other,
    warp,
)
from lipwright.face.faceclip import control_names
from lipwright.face.reference import ReferenceFace
from lipwright.track import PhoneTrack

Floats = npt.NDArray[np.float64]
Figures = dict[str, tuple[float, float]]
"""name of a measure to what is summed, and over how much"""

LEFT_OUT: Final = frozenset(("silence",))
"""measures that words alone do not have"""


@dataclass(frozen=True, eq=False)
class Recorded:
    """What a take is compared by."""

    truth: Truth
    lips: Aperture
    """of the tracked lips, on the clock of the video"""
    offset: float = 0.0
    """s, by how much the picture is late against the sound"""


@dataclass(frozen=True)
class Pair:
    """A recording and another take of its first words."""

    recording: str
    partner: str
    is_same: bool
    """whether the phones are the same, pauses among them"""
    r: float
    """of the tracked apertures, as an engine's: the partner on the clock of its sound, the
    recording on that of its video; NaN where either does not move"""
    r_of_videos: float
    """both on the clocks of their videos: the offsets of both pictures are left in"""
    r_on_sound: float
    """both on the clocks of their sounds: the offsets of both are taken off"""


@dataclass(frozen=True, eq=False)
class Himself:
    """The speaker against himself; all figures are over the shared words."""

    words: int
    """first words that are shared"""
    recordings: tuple[str, ...]
    """S' that have a partner, the order of all rows"""
    pairs: tuple[Pair, ...]
    own: Scores
    """rows over `recordings`; each is the mean over its partners"""
    mean_of_takes: Scores
    """the mean of all partners' curves as an estimate; counts are 0 where there is one partner"""

    @property
    def median_r(self) -> float:
        """Of the tracked apertures, over the pairs; NaN where no pair has one."""
        known = [pair.r for pair in self.pairs if np.isfinite(pair.r)]
        return float(np.median(known)) if known else float("nan")


def of_mean(r: float, takes: float) -> float:
    """The r of the mean of some takes and another one, where two takes have `r`, 0 to 1.

    With endless takes (`math.inf`) it is sqrt(r), what phones alone allow (see above).
    """
    return float(np.sqrt(r * r / (1 / takes + (1 - 1 / takes) * r)))


def load_recorded(recording: Recording, face_hash: str) -> Recorded | None:
    """What a take is compared by; None where no lips were tracked.

    Raises:
        LipwrightError: it has no parameters of the reference face with that SHA-256.
    """
    values = recording.motion.aperture
    truth = load_truth(recording, face_hash)
    if values is None or len(values) < 2 or len(truth.times) < 2 or not np.isfinite(values).any():
        return None
    return Recorded(
        truth,
        Aperture(recording.times + recording.offset, values.astype(np.float64)),
        recording.offset,
    )


def span_scores(
    face: ReferenceFace, recorded: Sequence[Recorded], modes: Sequence[Clip],
    by_head: Mapping[str, Sequence[Aperture]], count: int = FIRST_WORDS,
) -> Scores:  # fmt: skip
    """Any engine over the first words of recordings, as the speaker is measured.

    Args:
        face: the reference face.
        recorded: S' recordings with such words.
        modes: of each, a value for each frame of the recording; none where it has no modes.
        by_head: head to the aperture of its curves for each recording, on the clock of the sound;
            empty where it moves no head. Those of the head where r is lower are taken.
        count: of the first words.

    Raises:
        LipwrightError: modes are of another face.
        ValueError: there are not as many curves as recordings, or fewer words than `count`.
    """
    spans = [_need_span(one.truth.track, count) for one in recorded]
    found: Scores = {}
    if modes:
        found = _rows([
            [_errors(face, one, clip, span)]
            for one, clip, span in zip(recorded, modes, spans, strict=True)
        ])  # fmt: skip
    if not by_head:
        return found
    lips = {
        head: _rows([
            [_lips(one, curve, span)]
            for one, curve, span in zip(recorded, curves, spans, strict=True)
        ])
        for head, curves in by_head.items()
    }  # fmt: skip
    return {**found, **lower(lips)[1]}


def himself(
    face: ReferenceFace, recorded: Mapping[str, Recorded],
    found: Mapping[str, Sequence[str]], count: int = FIRST_WORDS,
) -> Himself | None:  # fmt: skip
    """The speaker against himself.

    Args:
        face: the reference face.
        recorded: recordings by name; partners that are not there are left out.
        found: recording to its partners, as `partners` finds them.
        count: of the first words.

    Returns:
        None where no recording has a partner.
    """
    names, pairs = [], []
    own: list[list[Figures]] = []
    means: list[list[Figures]] = []
    for name, others in found.items():
        one = recorded.get(name)
        span = None if one is None else first_words(one.truth.track, count)
        if one is None or span is None:
            continue
        takes = list(_takes(face, one, [recorded[o] for o in others if o in recorded], count))
        if not takes:
            continue
        names.append(name)
        pairs += [take.pair for take in takes]
        own.append([_figures(face, one, take.modes, take.lips, span) for take in takes])
        means.append([] if len(takes) < 2 else [_figures(face, one, *_mean(takes), span)])
    if not names:
        return None
    return Himself(count, tuple(names), tuple(pairs), _rows(own), _rows(means))


@dataclass(frozen=True, eq=False)
class _Warped:
    """Another take in the time of a recording."""

    pair: Pair
    modes: Clip
    """a value for each frame of the recording"""
    lips: Aperture
    """on the clock of the recording's video"""


def _takes(
    face: ReferenceFace, own: Recorded, others: Sequence[Recorded], count: int
) -> Iterator[_Warped]:
    names, sd = control_names(face, "joint"), face.sd("joint")
    for other in others:
        shared = shared_span(own.truth.track, other.truth.track, count)
        if shared is None:
            continue
        frames = own.lips.times - own.offset
        modes = warp(
            face.join(other.truth.parameters) / sd, other.truth.times, shared, frames
        )  # fmt: skip
        lips = _in_time_of(own.lips.times, other, shared)
        span = _need_span(own.truth.track, count)
        on_sound = Aperture(frames, own.lips.values)
        pair = Pair(
            own.truth.name, other.truth.name, shared.is_same,
            r=correlation(own.lips, lips, span),
            r_of_videos=correlation(
                own.lips, _in_time_of(own.lips.times, replace(other, offset=0.0), shared), span
            ),
            r_on_sound=correlation(on_sound, _in_time_of(frames, other, shared), span),
        )  # fmt: skip
        yield _Warped(pair, Clip(names, 1 / own.lips.step, modes.astype(np.float32)), lips)


def _in_time_of(times: Floats, other: Recorded, shared: Shared) -> Aperture:
    """The aperture of another take, its offset taken off, at the same phones at `times`."""
    return Aperture(times, other.lips.at(times_in_other(shared, times) + other.offset))


def _need_span(track: PhoneTrack, count: int) -> PhoneTrack:
    span = first_words(track, count)
    if span is None:
        raise ValueError(f"a track has not {count} words that are spoken")
    return span


def _mean(takes: Sequence[_Warped]) -> tuple[Clip, Aperture]:
    modes = np.mean([take.modes.values for take in takes], axis=0)
    lips = np.mean([take.lips.values for take in takes], axis=0)
    return takes[0].modes.with_values(modes), Aperture(takes[0].lips.times, lips)


def _figures(
    face: ReferenceFace, own: Recorded, modes: Clip, lips: Aperture, span: PhoneTrack
) -> Figures:
    return {**_errors(face, own, modes, span), **_lips(own, lips, span)}


def _errors(face: ReferenceFace, own: Recorded, modes: Clip, span: PhoneTrack) -> Figures:
    found: Figures = {}
    for name, values in frame_errors(face, own.truth, modes).items():
        times = own.truth.counted(name)
        inside = (times >= span.start) & (times <= span.end)
        found[name] = float(values[inside].sum()), float(inside.sum())
    r = face_r(face, replace(own.truth, track=span), modes)
    found["face_r"] = (r, 1.0) if np.isfinite(r) else (0.0, 0.0)
    return found


def _lips(own: Recorded, lips: Aperture, span: PhoneTrack) -> Figures:
    rows = lip_rows([evaluate(own.lips, lips, span)])
    return {name: (float(row.sums[0]), float(row.counts[0]))
            for name, row in rows.items() if name not in LEFT_OUT}  # fmt: skip


def _rows(found: Sequence[Sequence[Figures]]) -> Scores:
    """Rows over recordings, each the mean over its figures; none counts nothing."""
    names = dict.fromkeys(name for each in found for one in each for name in one)
    sums, counts = (
        {name: np.array([np.mean([one[name][part] for one in each]) if each else 0.0
                         for each in found]) for name in names}
        for part in (0, 1)
    )  # fmt: skip
    return {name: Rows(sums[name], counts[name]) for name in names}
