"""MP4: the rendered head, or another character, with the sound, H.264 and AAC.

Frame i shows the clip at i / fps seconds and the sound starts at 0. The video lasts as long as
the sound (without sound, as long as the clip). Its rate is the clip's, divided by the smallest
whole number that brings it to 30 frames a second or less, so that no frame falls between two
of the clip. Our head turns by the clip's head angles; another character does not.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator
from contextlib import closing
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.audio import Audio, Sound
from lipwright.clip import Clip
from lipwright.controls import HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export.performance import (
    ExportOptions,
    Output,
    Performance,
    prepare_head,
    shown_character,
)
from lipwright.passes.openings import OPENINGS, gaps

if TYPE_CHECKING:
    from av.container import OutputContainer

    from lipwright.face.mesh import Mesh
    from lipwright.face.render import Renderer
    from lipwright.rig import Rig

Frames = Generator[npt.NDArray[np.uint8], None, None]

MAX_VIDEO_FPS: Final = 30.0  # what a player shows smoothly everywhere, and half the work of 60
SOUND_RATE: Final = 48_000  # Hz, the rate of AAC that every player knows
SOUND_BITS: Final = 128_000  # bits a second: more than mono speech needs
MEETING: Final = 0.002  # eye distances; a fiftieth of a mouth that speaks
VIDEO: Final = {"crf": "18", "preset": "fast"}  # x264: no loss that one sees
BT709: Final = 1  # ITU-T H.273: primaries, transfer and matrix of BT.709


def prepare() -> None:
    """Find out before long work whether the head and av are there."""
    prepare_head("av")


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: no head is installed, or the clip moves none of the character.
    """
    rig = performance.rig
    if rig is not None and rig.bones and options.character is None:
        from lipwright.face.head import load_head

        mesh: Mesh = load_head()
    else:
        mesh, rig = shown_character(path, performance.clip, options), None
    return [Output(path, lambda part: _write(path, part, mesh, rig, performance, options))]


def _write(
    path: Path, part: Path, mesh: Mesh, rig: Rig | None, performance: Performance,
    options: ExportOptions,
) -> None:  # fmt: skip
    import av

    fps = video_fps(performance.clip.fps)
    with performance.open_sound() as sound:
        count = frame_count(performance.clip, fps, sound)
        times = picture_times(performance.clip, fps, count)
        with closing(_render(mesh, rig, performance.clip, times, options)) as frames:
            try:
                encode(part, frames, fps, options, sound)
            except av.error.FFmpegError as error:
                raise LipwrightError(f"{path}: cannot be encoded: {error.strerror}") from error


def video_fps(fps: float) -> float:
    """The video's frames a second for a clip's."""
    return fps / math.ceil(fps / MAX_VIDEO_FPS)


def picture_times(clip: Clip, fps: float, count: int) -> npt.NDArray[np.float64]:
    """(count,) s, the times of the clip that the pictures show.

    Each picture stands for the frames of the clip from its own on to the next picture's. Where the
    lips meet at one of them alone, that is the one that is shown: no closure falls between two.
    """
    times = np.arange(count) / fps
    frames = max(round(clip.fps / fps), 1)
    if frames == 1 or not set(clip.names) & set(OPENINGS):
        return times
    apart = gaps(clip).mean(axis=1)
    own = np.minimum(np.arange(count) * frames, len(clip) - 1)
    ahead = np.minimum(own[:, None] + np.arange(frames), len(clip) - 1)
    tightest = ahead[np.arange(count), apart[ahead].argmin(axis=1)]
    meets = (apart[own] > MEETING) & (apart[tightest] <= MEETING)
    return np.asarray(np.where(meets, tightest / clip.fps, times))


def frame_count(clip: Clip, fps: float, sound: Sound | None) -> int:
    """The number of video frames: as long as the sound, or else as the clip."""
    if sound is None:
        return math.floor(clip.duration * fps + 1e-6) + 1
    # A duration that is a whole number of frames must not gain one by rounding.
    return max(math.ceil(sound.duration * fps - 1e-6), 1)


def _render(
    mesh: Mesh, rig: Rig | None, clip: Clip, times: npt.NDArray[np.float64], options: ExportOptions
) -> Frames:
    from lipwright.face.render import Renderer

    width, height = options.size
    with Renderer(mesh, width, height, view=options.view) as renderer:
        for frame, picture in enumerate(_pictures(renderer, mesh, rig, clip, times)):
            yield picture
            if options.progress is not None:
                options.progress(frame + 1, len(times))


def _pictures(
    renderer: Renderer, mesh: Mesh, rig: Rig | None, clip: Clip, times: npt.NDArray[np.float64]
) -> Iterator[npt.NDArray[np.uint8]]:
    """The mesh at each of `times` in s: by its blendshapes, or on the bones of `rig`."""
    if rig is not None:
        from lipwright.retarget.skinned import posed_at, skin_mesh

        yield from map(renderer.draw, posed_at(skin_mesh(mesh, rig), rig, clip, times))
        return
    posed = clip.select(mesh.shape_names)
    turning = clip.select(HEAD_ANGLES) if set(HEAD_ANGLES) & set(clip.names) else None
    for time in times:
        turn = None if turning is None else turning.at([time])[0]
        yield renderer.render(posed.at([time])[0], turn)


def encode(
    part: Path, frames: Frames, fps: float, options: ExportOptions, sound: Sound | None
) -> None:
    """Write an MP4 of rendered frames and sound.

    Args:
        part: where to write.
        frames: pictures (height, width, 3), sRGB.
        fps: frames a second.
        options: size and title.
        sound: the sound from the first frame on.

    Raises:
        av.error.FFmpegError: the encoder fails.
    """
    import av

    # The index stands before the pictures, so that a page plays the file while it loads.
    early = {"movflags": "faststart"}
    with av.open(str(part), "w", format="mp4", container_options=early) as container:
        if options.title:
            container.metadata["title"] = options.title
        video = _VideoStream(container, fps, options.size)
        audio = _AudioStream(container) if sound is not None else None
        blocks = sound.blocks(1.0) if sound is not None else iter(())
        for index, picture in enumerate(frames):
            # Each second of sound goes before its pictures: players want them close together.
            if audio is not None and index >= audio.seconds * fps:
                audio.write(next(blocks, None))
            video.write(picture, index)
        video.end()
        if audio is not None:
            for block in blocks:
                audio.write(block)
            audio.end()


class _VideoStream:
    """H.264 in the colours of BT.709."""

    def __init__(self, container: OutputContainer, fps: float, size: tuple[int, int]) -> None:
        rate = Fraction(fps).limit_denominator(1001)
        self._container = container
        self._stream: Any = container.add_stream("libx264", rate=rate, options=VIDEO)
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt = "yuv420p"
        self._time_base = 1 / rate
        context = self._stream.codec_context
        context.time_base = self._time_base
        context.color_primaries = context.color_trc = context.colorspace = BT709
        context.color_range = 1  # limited, as H.264 players take for granted

    def write(self, picture: npt.NDArray[np.uint8], index: int) -> None:
        import av

        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
        frame = frame.reformat(format="yuv420p", dst_colorspace="ITU709", dst_color_range="MPEG")
        frame.pts, frame.time_base = index, self._time_base
        self._container.mux(self._stream.encode(frame))

    def end(self) -> None:
        self._container.mux(self._stream.encode(None))


class _AudioStream:
    """AAC, mono."""

    def __init__(self, container: OutputContainer) -> None:
        import av

        self._container = container
        self._stream: Any = container.add_stream("aac", rate=SOUND_RATE, layout="mono")
        self._stream.bit_rate = SOUND_BITS
        self._resampler = av.AudioResampler(format="fltp", layout="mono", rate=SOUND_RATE)
        self._samples = 0
        self.seconds = 0.0

    def write(self, block: Audio | None) -> None:
        import av

        if block is None:
            self.seconds = math.inf
            return
        frame = av.AudioFrame.from_ndarray(block.samples[None], format="fltp", layout="mono")
        frame.sample_rate, frame.pts = block.rate, self._samples
        frame.time_base = Fraction(1, block.rate)
        self._samples += len(block)
        self.seconds = self._samples / block.rate
        self._encode(self._resampler.resample(frame))

    def end(self) -> None:
        if self._samples:
            self._encode(self._resampler.resample(None))
        self._encode([None])

    def _encode(self, frames: list[Any]) -> None:
        for frame in frames:
            self._container.mux(self._stream.encode(frame))
