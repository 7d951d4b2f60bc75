"""The dominance engine: every phone pulls each articulator towards its target.

After Cohen and Massaro, "Modeling coarticulation in synthetic visual speech" (1993), as the 2018
thesis describes it in 2.1.2: a phone's pull rises before it and falls after it as a negative
exponential, and a control is the mean of all targets, weighted by their pulls. Jaw, lips and
tongue have pulls of their own, so that a consonant can own the tongue and leave the lips to the
vowels around it. The pulls have a fixed width in time: in fast speech they overlap more, and
targets are reached less.

Targets and pulls are in `dominance_targets.csv`, one row a phone, two a diphthong. Rows with the
source "fitted" come from a real speaker (bench/fit_dominance.py), the others from articulation.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Sound
from lipwright.clip import Clip, frame_times
from lipwright.controls import CANONICAL
from lipwright.phones import PHONES, nearest_phones
from lipwright.track import PhoneTrack

ARTICULATORS: Final = MappingProxyType(
    {
        "jaw": ("jawOpen", "mouthLowerDown", "mouthUpperUp"),
        "lips": ("mouthFunnel", "mouthPucker", "mouthSmile", "mouthStretch", "jawForward"),
        "tongue": ("tongueRaise", "tonguePress", "tongueBack", "tongueOut"),
    }
)
"""articulator to the target columns that it moves; a column without a side means both sides"""

TARGET_COLUMNS: Final = tuple(column for columns in ARTICULATORS.values() for column in columns)


@dataclass(frozen=True)
class Pull:
    """The shape of the pull of one articulator, by kind of phone (silence, vowel, consonant)."""

    rise: tuple[float, float, float]
    """1/s, how steeply the pull rises before a phone"""
    fall: tuple[float, float, float]
    """1/s, how steeply it falls after it"""
    power: float
    """exponent of time; 1 is Cohen and Massaro's cusp, 2 a bell"""
    plateau: float
    """share of a phone around its middle in which the pull is full"""
    lead: float
    """s by which the articulator is ahead of the sound"""


# Fitted on the training sentences of GRID s1 by bench/fit_dominance.py, which prints them;
# the tongue cannot be seen there: its pull is as quick as a consonant's closure.
PULLS: Final = MappingProxyType(
    {
        "jaw": Pull((6.01, 31.89, 21.66), (79.4, 21.22, 20.18), 1.25, 0.261, 0.0037),
        "lips": Pull((6.0, 21.8, 14.35), (7.14, 13.28, 12.08), 0.889, 0.991, -0.006),
        "tongue": Pull((20.0, 20.0, 28.0), (20.0, 20.0, 28.0), 1.5, 0.6, 0.01),
    }
)


# A held vowel stays open to its end, and what follows a long pause does not begin in its middle.
MAX_SKIRT = 0.25  # s inside each edge of a phone in which its pull may be less than full


@dataclass(frozen=True)
class Target:
    """One row of the table: where a phone, or one part of a diphthong, wants the face."""

    phone: str
    part: int
    """0 for a whole phone, 1 and 2 for the halves of a diphthong"""
    example: str
    source: str
    values: tuple[float, ...]
    """one for each of TARGET_COLUMNS; below 0 means further than rest, as lips pressed shut"""
    dominance: tuple[float, float, float]
    """strength of the pull on jaw, lips and tongue, above 0"""


@cache
def load_targets() -> MappingProxyType[str, tuple[Target, ...]]:
    """Phone to its one or two targets, from the table."""
    text = files("lipwright.engines").joinpath("dominance_targets.csv").read_text("utf-8")
    targets: dict[str, tuple[Target, ...]] = {}
    for row in csv.DictReader(line for line in text.splitlines() if not line.startswith("#")):
        pulls = (float(row["pull_jaw"]), float(row["pull_lips"]), float(row["pull_tongue"]))
        target = Target(
            phone=row["phone"],
            part=int(row["part"]),
            example=row["example"],
            source=row["source"],
            values=tuple(float(row[column]) for column in TARGET_COLUMNS),
            dominance=pulls,
        )
        targets[target.phone] = (*targets.get(target.phone, ()), target)
    return MappingProxyType(targets)


def targets_of(phone: str) -> tuple[Target, ...]:
    """The targets of a phone, or of the nearest phone that the table has."""
    table = load_targets()
    if phone in table:
        return table[phone]
    return table[nearest_phones(phone, table)[0]]


def _kind(phone: str) -> int:
    return 0 if PHONES[phone].is_silence else 1 if PHONES[phone].is_vowel else 2


@dataclass(frozen=True, eq=False)
class Segments:
    """The track as S targets with times; a diphthong is two."""

    targets: tuple[Target, ...]
    start: npt.NDArray[np.float64]  # (S,) s
    end: npt.NDArray[np.float64]  # (S,) s

    @classmethod
    def of(cls, track: PhoneTrack) -> Segments:
        """Split each diphthong at its middle."""
        targets: list[Target] = []
        starts: list[float] = []
        ends: list[float] = []
        for phone, start, end in track:
            parts = targets_of(phone)
            edges = np.linspace(start, end, len(parts) + 1)
            targets += parts
            starts += edges[:-1].tolist()
            ends += edges[1:].tolist()
        return cls(tuple(targets), np.array(starts), np.array(ends))


def pulls(
    segments: Segments, articulator: str, times: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """(T, S), the share of each segment in the articulator at each time; rows sum to 1."""
    pull = PULLS[articulator]
    index = tuple(ARTICULATORS).index(articulator)
    kinds = [_kind(target.phone) for target in segments.targets]
    rise, fall = np.array(pull.rise)[kinds], np.array(pull.fall)[kinds]
    strength = np.array([target.dominance[index] for target in segments.targets])
    middle = (segments.start + segments.end) / 2
    length = segments.end - segments.start
    half = np.maximum(pull.plateau * length, length - 2 * MAX_SKIRT) / 2
    now = times[:, None] + pull.lead  # (T, 1)
    before = np.maximum(middle - half - now, 0) * rise
    after = np.maximum(now - middle - half, 0) * fall
    # Logarithms, since far from everything all pulls are tiny and still one is the strongest.
    exponent = np.log(strength) - before**pull.power - after**pull.power
    share = np.exp(exponent - exponent.max(axis=1, keepdims=True))
    return share / share.sum(axis=1, keepdims=True)


CHUNK_FRAMES = 512  # frames computed at once, so that an hour needs no more memory than a minute
REACH = 1.5  # s around a chunk beyond which no pull matters


def _chunk(track: PhoneTrack, times: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    first = int(np.searchsorted(track.edges, times[0] - REACH, side="right")) - 1
    last = int(np.searchsorted(track.edges, times[-1] + REACH, side="left"))
    first, last = max(first, 0), min(max(last, first + 1), len(track))
    near = PhoneTrack(track.phones[first:last], track.edges[first : last + 1])
    segments = Segments.of(near)
    wanted = np.array([target.values for target in segments.targets])  # (S, columns)
    values = np.zeros((len(times), len(CANONICAL)), np.float32)
    for articulator, columns in ARTICULATORS.items():
        share = pulls(segments, articulator, times)
        for column in columns:
            curve = share @ wanted[:, TARGET_COLUMNS.index(column)]
            for name in (column, f"{column}Left", f"{column}Right"):
                if name in CANONICAL:
                    values[:, CANONICAL.index(name)] = np.clip(curve, 0, 1)
    return values


def animate(track: PhoneTrack, fps: float, audio: Sound | None = None) -> Clip:
    """The motion of a track, in the canonical controls; `audio` is not listened to."""
    del audio
    times = frame_times(track.end, fps)
    parts = [
        _chunk(track, times[start : start + CHUNK_FRAMES])
        for start in range(0, len(times), CHUNK_FRAMES)
    ]
    return Clip(CANONICAL, fps, np.concatenate(parts))
