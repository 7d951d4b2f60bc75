"""The window engine: a network that predicts the motion around each frame from what is said there.

After Taylor et al., "A deep learning approach for generalized speech animation" (2017), section 5:
each frame's window of phones gives a window of motion, and where these overlap a frame is their
mean. A sequence network does the same as a convolution over all frames. The network's frames are
at i / fps s of its own clock; the clip's are taken from them by monotone cubics.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip, frame_times
from lipwright.engines import DEFAULT_MODEL
from lipwright.engines.learnt import arrange, clip_names, open_network_of
from lipwright.engines.resample import Resampler
from lipwright.network import Network
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.audio import Sound
    from lipwright.network.meta import ModelMeta

Times = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]
Predict = Callable[[Times, slice], Values]
"""(N, Ky, C), the motion around N of the frames at (T,) times in s"""

CHUNK_FRAMES: Final = 1024  # windows at once, so that an hour needs no more memory than a minute


class FrameMean:
    """The frame-wise mean of overlapping windows of motion, given in turn."""

    def __init__(self, output_window: int, controls: int) -> None:
        """Windows of `output_window` frames (Ky, odd) around each frame, of C controls."""
        self._half = output_window // 2
        self._window = 0  # the frame that the next window is around
        self._first = 0  # the frame that the sums begin with
        self._sums: npt.NDArray[np.float64] = np.zeros((0, controls))
        self._counts: npt.NDArray[np.float64] = np.zeros((0, 1))

    def add(self, outputs: Values) -> Values:
        """The frames (N', C) that the next windows (N, Ky, C) complete."""
        count = len(outputs)
        if not count:
            return self._take(self._first)
        more = self._window + count + self._half - self._first - len(self._sums)
        self._sums = np.pad(self._sums, ((0, more), (0, 0)))
        self._counts = np.pad(self._counts, ((0, more), (0, 0)))
        for offset in range(-self._half, self._half + 1):
            first = self._window + offset - self._first
            skip = max(-first, 0)  # before the first frame
            part = slice(first + skip, max(first + count, 0))
            self._sums[part] += outputs[skip:, self._half + offset]
            self._counts[part] += 1
        self._window += count
        return self._take(max(self._window - self._half, self._first))

    def end(self) -> Values:
        """The last frames: no window comes any more."""
        return self._take(self._window)

    def _take(self, stop: int) -> Values:
        count = stop - self._first
        mean = self._sums[:count] / self._counts[:count]
        self._first, self._sums, self._counts = stop, self._sums[count:], self._counts[count:]
        return mean.astype(np.float32)


def predict(
    network: Network, track: PhoneTrack, times: npt.NDArray[np.float64], rows: slice,
    sound: Values | None = None,
) -> Values:  # fmt: skip
    """(N, Ky, C), the motion around some frames of the network's clock.

    Args:
        network: of either kind.
        track: what is said.
        times: (T,), s, of all frames that count; past the ends the end frames repeat.
        rows: the N frames to predict around.
        sound: (T, S), the columns of features/sound.py at `times`, where it is heard.
    """
    features = network.meta.features
    if network.meta.kind == "windows":
        return network.run(features.windows(track, times, sound, rows))
    first, stop, _ = rows.indices(len(times))
    half = features.window // 2
    seen = np.clip(np.arange(first - half, stop + half), 0, len(times) - 1)
    part = slice(int(seen[0]), int(seen[-1]) + 1)
    frames = features.frames(track, times[part], None if sound is None else sound[part])
    return network.run(frames[seen - seen[0]][None])[0][:, None]


def predict_at(
    network: Network, track: PhoneTrack, times: npt.NDArray[np.float64], audio: Sound | None = None
) -> Values:
    """(T, C), the network's own controls at (T,) `times` in s, one frame of its clock apart."""
    heard = heard_at(network, times, audio)
    parts = frames_of(
        lambda times, rows: predict(network, track, times, rows, heard), network.meta, times
    )
    return np.concatenate(list(parts))


def animate(
    track: PhoneTrack,
    fps: float,
    audio: Sound | None = None,
    model: str | Path | Network | None = None,
) -> Clip:
    """The motion of a track, from 0 s to its end.

    Args:
        track: phones with times.
        fps: frames a second of the clip; the network has its own.
        audio: the sound, for networks that hear it; without it they follow the phones alone.
        model: a network, the name of a model that ships, or a model's folder; by default the
            default model.

    Returns:
        Canonical controls (those that the network does not predict are at rest), or modes of a
        reference face where it predicts those. Values are not clipped.

    Raises:
        LipwrightError: the model cannot be used.
    """
    network = open_network(model)
    heard = heard_at(network, frame_times(track.end, network.meta.features.fps), audio)
    curves = curves_of(
        lambda times, rows: predict(network, track, times, rows, heard),
        network.meta, track.end, fps,
    )  # fmt: skip
    return Clip(clip_names(network), fps, arrange(network, curves))


def frames_of(predict: Predict, meta: ModelMeta, times: Times) -> Iterator[Values]:
    """The frames at `times`, each the mean of the windows that cover it, in parts (N, C)."""
    mean = FrameMean(meta.output_window, len(meta.controls))
    for first in range(0, len(times), CHUNK_FRAMES):
        yield mean.add(predict(times, slice(first, min(first + CHUNK_FRAMES, len(times)))))
    yield mean.end()


def curves_of(predict: Predict, meta: ModelMeta, duration: float, fps: float) -> Values:
    """(T, C), the model's own controls at another rate, from 0 s to the end of `duration` s.

    Args:
        predict: what the model says, on its own clock.
        meta: of the model.
        duration: s.
        fps: frames a second of the curves.
    """
    resampler = Resampler(meta.features.fps, fps, len(meta.controls))
    times = frame_times(duration, meta.features.fps)
    parts = [resampler.add(values) for values in frames_of(predict, meta, times)]
    return np.concatenate([*parts, resampler.end(duration)])


def heard_at(network: Network, times: Times, audio: Sound | None) -> Values | None:
    """(T, S), what a network hears at `times` (T,) s; None of one that listens to nothing."""
    if audio is None or "sound" not in network.meta.features.kinds:
        return None
    from lipwright.features.sound import sound_features

    return sound_features(audio, times)


def open_network(model: str | Path | Network | None = None) -> Network:
    """The network of a model, loaded once while its files stay as they are.

    Raises:
        LipwrightError: the model cannot be used, or is one of another engine.
    """
    return open_network_of(DEFAULT_MODEL if model is None else model, ("windows", "sequence"))
