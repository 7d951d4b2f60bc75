"""`Stream`: the window engine while the track is still being said.

A frame is given as soon as nothing that is said later can change it, with the value that the whole
track would give it.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import MAX_FPS, frame_times
from lipwright.engines.learnt import arrange, clip_names
from lipwright.engines.resample import Resampler
from lipwright.engines.window import CHUNK_FRAMES, FrameMean, Values, predict
from lipwright.features.timing import SIGHT
from lipwright.network import Network
from lipwright.phones import PHONES
from lipwright.track import PhoneTrack

PHONES_BEHIND: Final = 2  # kept before what is seen: a sound of the throat takes a mouth beside it
TOUCHING: Final = 1e-6  # s between the end of a phone and the start of the next


class Stream:
    """Phones in, frames out, as early as they are sure.

        stream = Stream(load_network("lipwright"), fps=60)
        for phone, start, end in phones:
            stream.push(phone, start, end)
            show(stream.frames())
        show(stream.finish())

    A frame is sure when all is known that its network and its neighbours' see, `look_ahead` s
    after it: when the phone that is said then has ended, and where that is a sound of the throat
    that the network never learnt (HH), the next, whose mouth it takes.
    """

    def __init__(self, network: Network, fps: float, *, sound: bool = False) -> None:
        """Frames at `fps` a second; with `sound`, its features are given by `hear`.

        Raises:
            ValueError: the network hears no sound, or fps is not above 0 and at most 1000.
        """
        if not 0 < fps <= MAX_FPS:
            raise ValueError(f"fps is {fps}, not above 0 and at most {MAX_FPS:.0f}")
        meta = network.meta
        if sound and "sound" not in meta.features.kinds:
            raise ValueError("the network hears no sound; leave `sound` out")
        self._network, self._fps, self._listens = network, fps, sound
        self._mean = FrameMean(meta.output_window, len(meta.controls))
        self._resampler = Resampler(meta.features.fps, fps, len(meta.controls))
        self._phones: list[str] = []  # those that windows to come can see
        self._edges: list[float] = []
        self._sound: list[Values] = []  # a row for each frame from _heard on
        self._heard = 0
        self._next = 0  # the frame of the network that the next window is around
        self._finished = False

    @property
    def names(self) -> tuple[str, ...]:
        """C', the controls of the frames."""
        return clip_names(self._network)

    @property
    def look_ahead(self) -> float:
        """How much after a frame must be known before it is given, in s; then phones must end."""
        features = self._network.meta.features
        frames = features.window // 2 + self._network.meta.output_window // 2
        return frames / features.fps + self._sight + self._resampler.look_ahead

    @property
    def _sight(self) -> float:
        """How far the features of one frame look ahead, in s."""
        features = self._network.meta.features
        return max(
            SIGHT if "timing" in features.kinds else 0.0,
            1 / features.fps if "transitions" in features.kinds else 0.0,
        )

    def push(self, phone: str, start: float, end: float) -> None:
        """The next phone, once it has ended.

        Args:
            phone: a symbol of the phone table.
            start: s; the end of the phone before it.
            end: s, after `start`.

        Raises:
            ValueError: an unknown phone, or one that does not follow the last; or the stream is
                finished.
        """
        if self._finished:
            raise ValueError("the stream is finished")
        if phone not in PHONES:
            raise ValueError(f"phone {phone!r} is not in the phone table")
        if not math.isfinite(end) or not 0 <= start < end:
            raise ValueError(f"phone {phone!r} lasts from {start} to {end} s")
        if not self._edges:
            self._edges.append(start)
        elif abs(start - self._edges[-1]) > TOUCHING:
            raise ValueError(
                f"phone {phone!r} starts at {start} s, but the one before ends at {self._edges[-1]}"
            )
        self._phones.append(phone)
        self._edges.append(end)

    def hear(self, rows: npt.ArrayLike) -> None:
        """The next rows (N, S) of sound features, one for each frame of the network's clock.

        They are those of `lipwright.features.sound.sound_features` with a `SoundScale` that is
        known beforehand: a stream cannot measure what is still to come.

        Raises:
            ValueError: the stream was opened without sound or is finished, or rows are no rows.
        """
        if not self._listens or self._finished:
            raise ValueError("the stream takes no sound, or is finished")
        values = np.asarray(rows, np.float32)
        if values.ndim != 2:
            raise ValueError(f"sound features have the shape {values.shape}, not (N, S)")
        self._sound.extend(values)

    def frames(self) -> Values:
        """(N, C'), the frames after those already given that can no longer change."""
        if self._finished or not self._phones:
            return arrange(self._network, self._resampler.nothing)
        known = self._known_frames()
        half = self._network.meta.features.window // 2
        return self._advance(max(known - half, self._next), known)

    def finish(self) -> Values:
        """(N, C'), the rest: the last phone was the end.

        Raises:
            ValueError: no phone was pushed, it was finished before, or sound is missing.
        """
        if self._finished or not self._phones:
            raise ValueError("the stream has no phones, or is finished")
        end = self._edges[-1]
        count = len(frame_times(end, self._network.meta.features.fps))
        heard = self._heard + len(self._sound)
        if self._listens and heard < count:
            raise ValueError(f"sound features of {heard} frames, not {count}")
        self._finished = True
        given = self._advance(count, count)
        last = (self._resampler.add(self._mean.end()), self._resampler.end(end))
        return np.concatenate([given, *(arrange(self._network, values) for values in last)])

    def _known_frames(self) -> int:
        """How many frames of the network's clock have features that can no longer change."""
        features = self._network.meta.features
        count = math.ceil(features.settled(self._track()) * features.fps)
        return max(min(count, self._heard + len(self._sound)) if self._listens else count, 0)

    def _advance(self, stop: int, known: int) -> Values:
        """The frames that the windows before `stop` complete, `known` being the frames there."""
        given = [self._resampler.nothing]
        while self._next < stop:
            until = min(self._next + CHUNK_FRAMES, stop)
            outputs = self._predict(until, known)
            self._next = until
            given.append(self._resampler.add(self._mean.add(outputs)))
        self._forget()
        return arrange(self._network, np.concatenate(given))

    def _predict(self, stop: int, known: int) -> Values:
        features = self._network.meta.features
        first = max(self._next - features.window // 2, 0)
        last = min(stop + features.window // 2, known)
        times = np.arange(first, last) / features.fps
        rows = self._sound[first - self._heard : last - self._heard]
        sound = np.stack(rows) if self._listens else None
        part = slice(self._next - first, stop - first)
        return predict(self._network, self._track(), times, part, sound)

    def _track(self) -> PhoneTrack:
        return PhoneTrack(tuple(self._phones), np.array(self._edges))

    def _forget(self) -> None:
        """Drop what no window to come can see."""
        features = self._network.meta.features
        first = max(self._next - features.window // 2, 0)
        seen = bisect_right(self._edges, first / features.fps - SIGHT) - 1 - PHONES_BEHIND
        if seen > 0:
            del self._phones[:seen], self._edges[:seen]
        if self._listens:
            del self._sound[: max(first - self._heard, 0)]
            self._heard = max(first, self._heard)
