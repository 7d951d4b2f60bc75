"""What each entrant makes of a recording: weights that move heads, and modes of the face."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from lipwright.audio import AudioFile, Sound, open_audio
from lipwright.benchmark.entrants import REAL, Entrant
from lipwright.benchmark.peers import animate_peer
from lipwright.clip import Clip, frame_times
from lipwright.controls import ARKIT, CANONICAL
from lipwright.dataset.recording import Recording
from lipwright.engines import ENGINES, OF_BIGRAMS
from lipwright.evaluate.bridge import Bridge
from lipwright.network import find_model
from lipwright.network.folder import read_meta
from lipwright.pipeline import ALIGNMENT_RATE, AnimateOptions, animate_track, moves_heads
from lipwright.track import PhoneTrack

FPS: Final = 60.0  # frames a second of the curves that move heads


@dataclass(frozen=True, eq=False)
class Moves:
    """What an entrant makes of one recording."""

    modes: Clip
    """joint modes, a value for each frame of the recording"""
    animated: Clip | None
    """canonical controls at FPS, as `animate` gives them; None where it moves no head"""
    bare: Clip | None
    """the same without the passes that `animate` applies; None where it has none"""


@dataclass(frozen=True, eq=False)
class Performer:
    """An entrant with what it needs to perform."""

    entrant: Entrant
    model: str | Path | None = None
    curves: Mapping[str, Clip] | None = None
    """of a folder, by recording"""

    @property
    def learns_modes(self) -> bool:
        """Whether it predicts modes itself, so that its errors need no bridge."""
        if self.curves is not None:
            return any(name not in CANONICAL for clip in self.curves.values()
                       for name in clip.names)  # fmt: skip
        return self.entrant.kind == "learnt"

    def perform(self, recording: Recording, bridge: Bridge) -> Moves:
        """Its moves of a recording.

        Raises:
            LipwrightError: its model or curves cannot be used.
        """
        with sound_of(recording) as sound:
            animated, bare = self._head_curves(recording, sound)
            modes = self._modes(recording, sound)
        if modes is None:
            assert animated is not None
            modes = bridge.apply(at_frames(animated, recording))
        return Moves(modes, animated, bare)

    def animate(self, track: PhoneTrack, sound: AudioFile | None = None) -> Clip:
        """Its curves for heads, as `animate` gives them; not those of folders or the real face."""
        if self.entrant.kind == "peer":
            return animate_peer(self.entrant.name, track, FPS)
        return animate_track(track, self._whole, sound)

    @cached_property
    def _whole(self) -> AnimateOptions:
        """Kept, since options keep the bigram set that they have read."""
        return self._options()

    @cached_property
    def _bare(self) -> AnimateOptions:
        return self._options(passes=())

    def _options(self, **changes: Any) -> AnimateOptions:
        if self.entrant.engine == OF_BIGRAMS and self.model is not None:
            return AnimateOptions(bigrams=self.model, fps=FPS, **changes)
        return AnimateOptions(self.entrant.engine, self.model, fps=FPS, **changes)

    def _head_curves(
        self, recording: Recording, sound: AudioFile | None
    ) -> tuple[Clip | None, Clip | None]:
        if self.entrant.name == REAL:
            return captured_clip(recording), None
        if self.curves is not None:
            clip = self.curves[recording.name]
            heads = [name for name in clip.names if name in CANONICAL]
            return (clip.select(heads) if heads else None), None
        animated = self.animate(recording.track, sound)
        if self.entrant.kind == "peer":
            return animated, None
        bare = animate_track(recording.track, self._bare, sound)
        assert moves_heads(animated.names)
        return animated, bare

    def _modes(self, recording: Recording, sound: AudioFile | None) -> Clip | None:
        """The modes at the frames of a recording; None where the bridge has to make them."""
        if not self.learns_modes:
            return None
        if self.curves is not None:
            clip = self.curves[recording.name]
            modes = clip.select([name for name in clip.names if name not in CANONICAL])
            return at_frames(modes, recording)
        assert self.model is not None
        whole = predict_recording(self.model, recording, sound)
        return whole.select([name for name in whole.names if name not in CANONICAL])


def sound_of(recording: Recording) -> AbstractContextManager[AudioFile | None]:
    """The sound of a recording, open as engines want it; None of one without."""
    if recording.audio is None:
        return nullcontext()
    return open_audio(recording.audio, ALIGNMENT_RATE)


def predict_recording(model: str | Path, recording: Recording, sound: Sound | None) -> Clip:
    """What a model says of all frames of a recording, as curves of its own controls.

    Raises:
        LipwrightError: the model cannot be used.
    """
    engine = import_module(ENGINES[read_meta(find_model(model)).engine].module)
    opened = engine.open_network(model)
    fps, start = opened.meta.features.fps, recording.times[0]
    times = start + frame_times(recording.times[-1] - start, fps)  # the model's own clock
    values = engine.predict_at(opened, recording.track, times, sound)
    own = Clip(opened.meta.controls, fps, values)
    return Clip(own.names, recording.motion.fps, own.at(recording.times - start))


def at_frames(clip: Clip, recording: Recording) -> Clip:
    """A clip on the clock of the sound, at the frames of a recording."""
    return Clip(clip.names, recording.motion.fps, clip.at(recording.times))


def captured_clip(recording: Recording) -> Clip:
    """The captured weights of a recording, from 0 s to the end of its track."""
    times = frame_times(recording.track.end, FPS)
    seen = recording.valid
    values = np.zeros((len(times), len(ARKIT)), np.float32)
    for column, weights in enumerate(recording.motion.arkit[seen].T):
        values[:, column] = np.interp(times, recording.times[seen], weights)
    return Clip(ARKIT, FPS, values)
