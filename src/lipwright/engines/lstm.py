"""The lstm engine: a recurrent network that reads all that is said and remembers both ways.

After Fan et al., "Photo-real talking head with deep bidirectional LSTM" (2015), as Taylor et al.
2017, section 8.1, ran it. What is longer than `window.CHUNK_FRAMES` frames goes through the network
in parts, each with `CONTEXT` s around it, which the network sees and which are then cut off. An
hour so needs little more memory than a minute, and differs from the network's run over the whole by
what it remembers for longer than `CONTEXT`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip, frame_times
from lipwright.engines.learnt import arrange, clip_names, named, open_network_of
from lipwright.engines.window import curves_of, frames_of, heard_at
from lipwright.network import Network
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.audio import Sound

Times = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]

CONTEXT: Final = 4.0  # s; a test holds parts to within 1e-4 of the whole


def predict(
    network: Network, track: PhoneTrack, times: Times, rows: slice, sound: Values | None = None
) -> Values:
    """(N, 1, C), the motion at some frames of the network's clock.

    Args:
        network: a recurrent one.
        track: what is said.
        times: (T,), s, of all frames that count.
        rows: the N frames to predict.
        sound: (T, S), the columns of features/sound.py at `times`, where it is heard.
    """
    first, stop, _ = rows.indices(len(times))
    context = round(CONTEXT * network.meta.features.fps)
    part = slice(max(first - context, 0), min(stop + context, len(times)))
    heard = None if sound is None else sound[part]
    frames = network.meta.features.frames(track, times[part], heard)
    return network.run(frames[None])[0][first - part.start : stop - part.start, None]


def predict_at(
    network: Network, track: PhoneTrack, times: Times, audio: Sound | None = None
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
        audio: the sound, for networks that hear it.
        model: a network, or a model's folder; none ships.

    Returns:
        Canonical controls, or modes of a reference face where the network predicts only those.
        Values are not clipped.

    Raises:
        LipwrightError: no model is named, or it cannot be used.
    """
    network = open_network(model)
    heard = heard_at(network, frame_times(track.end, network.meta.features.fps), audio)
    curves = curves_of(
        lambda times, rows: predict(network, track, times, rows, heard),
        network.meta, track.end, fps,
    )  # fmt: skip
    return Clip(clip_names(network), fps, arrange(network, curves))


def open_network(model: str | Path | Network | None = None) -> Network:
    """The network of a model, loaded once while its files stay as they are.

    Raises:
        LipwrightError: no model is named, it cannot be used, or is one of another engine.
    """
    if isinstance(model, Network):
        return model
    return open_network_of(named(model, "lstm"), ("recurrent",))
