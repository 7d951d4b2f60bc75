"""`FeatureSet`: which numbers a network sees, and what they are for a track."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from lipwright.features.known import check_phones, is_lent, known_track, lent_track
from lipwright.features.linguistic import (
    ATTRIBUTES,
    TRANSITIONS,
    attribute_table,
    transition_table,
)
from lipwright.features.spans import span_count, span_names, spans
from lipwright.features.timeline import CODES, ROUNDING, Floats, Indices, Timeline, timeline
from lipwright.features.timing import SIGHT, TIMING, timing
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

Values = npt.NDArray[np.float32]

KINDS: Final[tuple[str, ...]] = ("raw", "spans", "attributes", "transitions", "timing", "sound")
"""the groups of features; docs/features.md describes them"""

HEARD: Final = "sound"  # the column that says whether there is sound: 1, or 0 and zeros beside it

ALL: Final = slice(None)


@dataclass(frozen=True)
class FeatureSet:
    """F numbers of a frame, and the D numbers of a window of W frames.

    A window is the F numbers of its frames, frame after frame, and then its spans. A frame's
    numbers depend on the track and its time alone, so a part of a track gives the same as the
    whole.

    Raises:
        ValueError: kinds out of order, a window that is no odd number, fps that is no rate, or
            phones without silence first, repeated, or not in the phone table.
    """

    kinds: tuple[str, ...]
    """some of KINDS, in that order"""
    window: int
    """W, odd, in frames; the middle one is the frame that a window is for"""
    fps: float
    """frames a second"""
    phones: tuple[str, ...]
    """with a column of their own: those seen in training (`seen_phones`); sil first"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        kinds, phones = tuple(self.kinds), tuple(self.phones)
        for kind in kinds:
            if kind not in KINDS:
                raise ValueError(f"there are no features {kind!r}; there are {', '.join(KINDS)}")
        if not kinds or kinds != tuple(kind for kind in KINDS if kind in kinds):
            raise ValueError(f"features are not some of {', '.join(KINDS)}, each once, in order")
        if type(self.window) is not int or self.window < 1 or self.window % 2 == 0:
            raise ValueError(f"the window is {self.window!r} frames, not an odd number from 1 on")
        if not 0 < self.fps < 2.0**1023:  # of a whole number, too, that has no float
            raise ValueError(f"fps is {self.fps!r}, not a number above 0")
        check_phones(phones)
        if phones[0] != SILENCE or len(set(phones)) != len(phones):
            raise ValueError(f"phones repeat, or the first is not {SILENCE!r}")
        object.__setattr__(self, "kinds", kinds)
        object.__setattr__(self, "phones", phones)
        object.__setattr__(self, "fps", float(self.fps))

    # --- names ---

    @cached_property
    def frame_names(self) -> tuple[str, ...]:
        """F names of the columns of one frame."""
        names: dict[str, tuple[str, ...]] = {
            "raw": self.phones,
            "attributes": ATTRIBUTES,
            "transitions": TRANSITIONS,
            "timing": TIMING,
        }
        if "sound" in self.kinds:
            names["sound"] = _sound_names()
        return tuple(name for kind in self.kinds for name in names.get(kind, ()))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """D names of the columns of a window, each once; its first frame is 0."""
        pairs = frozenset(TRANSITIONS)
        frames = tuple(
            f"{name} at frames {k} and {k + 1}" if name in pairs else f"{name} at frame {k}"
            for k in range(self.window)
            for name in self.frame_names
        )
        whole = span_names(self.phones, self.window) if "spans" in self.kinds else ()
        return frames + whole

    @property
    def frame_size(self) -> int:
        """F."""
        return len(self.frame_names)

    @property
    def size(self) -> int:
        """D."""
        held = len(self.phones) * span_count(self.window) if "spans" in self.kinds else 0
        return self.window * self.frame_size + held

    # --- values ---

    def frames(
        self, track: PhoneTrack, times: npt.ArrayLike, sound: npt.ArrayLike | None = None
    ) -> Values:
        """(T, F), float32, one row for each of `times` (T,) in s.

        Args:
            track: any phones; those without a column take that of one that looks like them.
            times: 1 / fps apart.
            sound: (T, S), the columns of features/sound.py at `times`; None where there is none.

        Raises:
            ValueError: times that are not 1 / fps apart, or sound of another shape.
        """
        clock = self._clock(times)
        return self._frames(track, clock, self._sound(sound, len(clock)))

    def windows(
        self, track: PhoneTrack, times: npt.ArrayLike, sound: npt.ArrayLike | None = None,
        rows: slice = ALL,
    ) -> Values:  # fmt: skip
        """(N, D), float32, the windows around `times`; past the ends the end frames repeat.

        Args:
            track: as for `frames`.
            times: (T,), s, 1 / fps apart.
            sound: as for `frames`.
            rows: which of the T windows, without a step; all by default. A long track fits in
                memory by parts: `windows(..., rows=slice(a, b))` equals `windows(...)[a:b]`.

        Raises:
            ValueError: as for `frames`, or rows with a step.
        """
        clock = self._clock(times)
        heard = self._sound(sound, len(clock))
        count, frame = self._reach(len(clock), rows)
        first, stop = (int(frame[0]), int(frame[-1]) + 1) if count else (0, 0)
        part = None if heard is None else heard[first:stop]
        frames = self._frames(track, clock[first:stop], part)
        values = np.zeros((count, self.size), np.float32)
        if count:
            seen = sliding_window_view(frames[frame - first], self.window, axis=0)  # (N, F, W)
            flat = values[:, : self.window * self.frame_size]
            flat.reshape(count, self.window, -1)[:] = seen.transpose(0, 2, 1)
            if "spans" in self.kinds:
                row, column = self._spans(track, clock[frame])
                values[row, flat.shape[1] + column] = 1
        return values

    def span_indices(
        self, track: PhoneTrack, times: npt.ArrayLike, rows: slice = ALL
    ) -> tuple[Indices, Indices]:
        """Row and column of each 1 among the spans of `windows(track, times, rows=rows)`.

        Columns count from the first span, so that D - F * W is their number.

        Raises:
            ValueError: as for `windows`.
        """
        clock = self._clock(times)
        count, frame = self._reach(len(clock), rows)
        return self._spans(track, clock[frame]) if count else (frame, frame)

    def settled(self, track: PhoneTrack) -> float:
        """Until when (s) the frames of a track stay as they are, whatever phones follow it.

        For a track that grows: `frames` at times before this, and so windows whose frames all
        lie before it, are final.
        """
        lent = is_lent(track.phones[-1], self.phones)
        until = float(track.edges[-2]) if lent else track.end
        if "transitions" in self.kinds:
            until -= 1 / self.fps
        if "timing" in self.kinds:
            until = min(until, track.end - SIGHT)
        return until - 2 * ROUNDING

    def _spans(self, track: PhoneTrack, times: Floats) -> tuple[Indices, Indices]:
        _, line = _timelines(track, self.phones)
        run = line.at(times)
        return spans(run, self._columns[line.codes[run]], self.window)

    def _reach(self, count: int, rows: slice) -> tuple[int, Indices]:
        """N, and the frames that N windows see: (N + W - 1,) of 0 to count - 1, not falling."""
        if rows.step not in (None, 1):
            raise ValueError("rows of windows are without a step")
        first, stop, _ = rows.indices(count)
        if stop <= first:
            return 0, np.empty(0, np.int64)
        half = self.window // 2
        return stop - first, np.clip(np.arange(first - half, stop + half), 0, count - 1)

    def _frames(self, track: PhoneTrack, times: Floats, sound: Values | None) -> Values:
        line, known = _timelines(track, self.phones)
        parts: list[Values] = []
        if "raw" in self.kinds:
            one_hot = np.eye(len(self.phones), dtype=np.float32)
            parts.append(one_hot[self._columns[known.codes[known.at(times)]]])
        if "attributes" in self.kinds:
            parts.append(attribute_table()[line.codes[line.at(times)]])
        if "transitions" in self.kinds:
            here, after = line.codes[line.at(times)], line.codes[line.at(times + 1 / self.fps)]
            parts.append(transition_table()[here, after])
        if "timing" in self.kinds:
            parts.append(timing(line, times))
        if "sound" in self.kinds:
            parts.append(_with_heard(sound, len(times)))
        empty = np.zeros((len(times), 0), np.float32)
        return np.concatenate([empty, *parts], axis=1)

    @cached_property
    def _columns(self) -> Indices:
        """Row of the phone table to its place among the phones with a column, or -1."""
        columns = np.full(len(CODES), -1, np.int64)
        columns[[CODES[phone] for phone in self.phones]] = np.arange(len(self.phones))
        return columns

    def _clock(self, times: npt.ArrayLike) -> Floats:
        clock = np.asarray(times, np.float64)
        if clock.ndim != 1 or not np.isfinite(clock).all():
            raise ValueError(f"times have the shape {clock.shape}, or are not all numbers")
        if not np.allclose(np.diff(clock) * self.fps, 1, rtol=0, atol=0.01):
            raise ValueError(f"times are not 1/{self.fps:g} s apart")
        return clock

    def _sound(self, sound: npt.ArrayLike | None, count: int) -> Values | None:
        if sound is None or "sound" not in self.kinds:
            return None
        values, wanted = np.asarray(sound, np.float32), len(_sound_names()) - 1
        if values.shape != (count, wanted):
            raise ValueError(f"sound has the shape {values.shape}, not ({count}, {wanted})")
        return values

    # --- JSON ---

    def to_json(self) -> dict[str, Any]:
        """As values of JSON, with the names of a frame's columns, to notice other versions."""
        return {
            "kinds": list(self.kinds),
            "window": self.window,
            "fps": self.fps,
            "phones": list(self.phones),
            "frame": list(self.frame_names),
        }

    @classmethod
    def from_json(cls, value: Any) -> FeatureSet:
        """The set that `to_json` wrote.

        Raises:
            ValueError: it is no such set, or its columns are not those of this version.
        """
        keys = ("kinds", "window", "fps", "phones", "frame")
        if not isinstance(value, Mapping) or not value.keys() >= set(keys):
            raise ValueError(f"features are not an object with {', '.join(keys)}")
        for key in ("kinds", "phones", "frame"):
            names = value[key]
            if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
                raise ValueError(f"{key!r} of features is not a list of names")
        if type(value["fps"]) not in (int, float):
            raise ValueError(f"fps is {value['fps']!r}, not a number above 0")
        made = cls(tuple(value["kinds"]), value["window"], value["fps"], tuple(value["phones"]))
        if list(made.frame_names) != value["frame"]:
            raise ValueError("the features are not those of this version")
        return made


@lru_cache(maxsize=16)
def _timelines(track: PhoneTrack, phones: tuple[str, ...]) -> tuple[Timeline, Timeline]:
    """The mouths of a track, and the same in phones with a column."""
    known = frozenset(phones)
    return timeline(lent_track(track, known)), timeline(known_track(track, known))


def _sound_names() -> tuple[str, ...]:
    from lipwright.features.sound import SOUND_NAMES

    return (HEARD, *SOUND_NAMES)


def _with_heard(sound: Values | None, count: int) -> Values:
    """(T, 1 + S), whether there is sound, and it."""
    if sound is None:
        return np.zeros((count, len(_sound_names())), np.float32)
    return np.concatenate([np.ones((count, 1), np.float32), sound], axis=1)
