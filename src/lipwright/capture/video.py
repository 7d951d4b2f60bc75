"""The pictures of a video, upright, on a grid of constant rate.

Phones record at a rate that varies, rotate pictures by a note in the file, and leave frames out.
Every later stage wants a constant rate, so `open_video` lays a grid over the frames: grid frame i
is at (i + 0.5) / fps s after the first frame's start. A video of constant rate has its own frames
on the grid; where a video has none, the grid frame is dropped, never invented.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final, cast

import numpy as np

from lipwright.capture.timing import Grid, Seconds, frame_rate, make_grid
from lipwright.capture.upright import Picture, upright, upright_size
from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from av import AudioFrame, VideoFrame
    from av.container import InputContainer
    from av.packet import Packet
    from av.stream import Stream
    from av.video.stream import VideoStream

LEAST_FPS: Final = 15.0  # frames a second; a closure of 60 ms needs at least one
LARGEST: Final = 8192  # pixels, the longer side; 8K and a bit
MISSING_END: Final = 0.15  # s of a promised end that may be missing: durations are rounded
DAMAGED_SHARE: Final = 0.1  # of the frames that may be undecodable before the file is refused

# Only these: libav would follow a playlist to other files, and take a text for a picture.
_FORMATS: Final = (
    "asf,avi,dv,flv,h264,hevc,ivf,matroska,webm,mov,mp4,m4a,3gp,mpeg,mpegts,mpegvideo,mxf,nut,ogg,"
    "rm,yuv4mpegpipe,aac,aiff,amr,caf,flac,mp3,wav"
)
# Containers that give each frame one packet with its time, for codecs without hidden frames: there
# the times are known without decoding.
_TIMED_FORMATS: Final = ("mov", "matroska")
_TIMED_CODECS: Final = ("h264", "hevc", "vp9", "av1", "mpeg4", "mjpeg", "prores")


@dataclass(frozen=True, eq=False)
class Video:
    """What is known of a video before its pictures are read; made by `open_video`."""

    path: str
    times: Seconds
    """(N,), when each of its N frames is shown, s after the first, rising"""
    size: tuple[int, int]
    """width and height of the upright picture, square pixels"""
    start: float
    """s from the first sample of the file's own sound to the first frame; 0 without sound"""
    grid: Grid
    """the constant rate, and which frames are on it"""

    @property
    def fps(self) -> float:
        """Frames a second of the grid."""
        return self.grid.fps


def open_video(path: str | os.PathLike[str]) -> Video:
    """Find the frames' times and the rate of a video, without keeping any picture.

    Raises:
        LipwrightError: the file is missing, not a video, cut off, damaged, too large, without a
            moving picture, or has too few frames a second for speech.
    """
    size, first, times = _scan(path)
    sound_start = _sound_start(path)
    start = 0.0 if sound_start is None else first - sound_start
    if len(times) < 2:
        raise LipwrightError(f"{path}: has {len(times)} frames; name a video, not a picture")
    fps = frame_rate(times)
    if fps < LEAST_FPS:
        raise LipwrightError(
            f"{path}: {fps:.3g} frames a second are too few for speech; record at 24 or more"
        )
    try:
        grid = make_grid(times, fps)
    except ValueError as error:
        raise LipwrightError(f"{path}: {error}; convert it to a constant frame rate") from error
    return Video(os.fspath(path), times, size, start, grid)


def read_frames(
    video: Video, wanted: Collection[int] | None = None
) -> Iterator[tuple[int, Picture]]:
    """The index among `video.times` and the picture of the frames, or of those `wanted`, in order.

    Frames that cannot be decoded are left out.

    Raises:
        LipwrightError: the file has changed, or too many of its frames cannot be decoded.
    """
    last = None if wanted is None else max(wanted, default=-1)
    decoded, count, origin = -1, 0, None
    with _open(video.path) as (container, stream):
        for time, frame in _decode(stream, container):
            origin = time if origin is None else origin
            index = int(np.argmin(np.abs(video.times - (time - origin))))
            if index <= decoded:
                continue
            decoded, count = index, count + 1
            if last is not None and index > last:
                return
            if wanted is None or index in wanted:
                yield index, upright(frame, video.size)
    if wanted is None and count < (1 - DAMAGED_SHARE) * len(video.times):
        raise LipwrightError(
            f"{video.path}: is damaged: {len(video.times) - count} of {len(video.times)} frames "
            "cannot be decoded; export the video again"
        )


def read_pictures(
    path: str | os.PathLike[str] | Video, wanted: Collection[int] | None = None
) -> Iterator[tuple[int, Picture]]:
    """The index on the grid and the picture of all frames of a video, or of those `wanted`.

    Between two frames of a variable rate the nearer one is given. Dropped frames are left out.

    Raises:
        LipwrightError: as `open_video`.
    """
    video = path if isinstance(path, Video) else open_video(path)
    nearest = video.grid.nearest
    indices = range(len(nearest)) if wanted is None else wanted
    chosen = np.unique(np.array(list(indices), np.int64))
    shown: dict[int, list[int]] = {}
    for index in chosen[nearest[chosen] >= 0]:
        shown.setdefault(int(nearest[index]), []).append(int(index))
    for frame, picture in read_frames(video, shown.keys()):
        for index in shown[frame]:
            yield index, picture


@contextmanager
def _open(path: str | os.PathLike[str]) -> Iterator[tuple[InputContainer, VideoStream]]:
    """The container and its moving picture."""
    import av

    av.logging.set_level(None)  # with a level, threads that decode wait for Python
    with _open_file(path) as file:
        try:
            container = av.open(
                file, "r", options={"format_whitelist": _FORMATS}, metadata_errors="replace"
            )
        except (av.FFmpegError, ValueError, OverflowError) as error:
            raise LipwrightError(
                f"{path}: is not a video that can be read, or its index is missing because it is "
                "cut off; convert it to MP4, MOV, MKV, WebM or AVI"
            ) from error
        with container:
            yield container, _moving_picture(path, container)


@contextmanager
def _open_file(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    try:
        with Path(path).open("rb") as file:
            if not file.seekable():
                raise LipwrightError(f"{path}: is a pipe; save the video to a file")
            if not file.read(1):
                raise LipwrightError(f"{path}: is empty; export the video again")
            file.seek(0)
            yield file
    except FileNotFoundError as error:
        raise LipwrightError(f"{path}: no such file; check the path") from error
    except IsADirectoryError as error:
        raise LipwrightError(f"{path}: is a folder; name a video in it") from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        remedy = "check its permissions" if error.errno == errno.EACCES else "check the disk"
        raise LipwrightError(f"{path}: cannot be read: {reason}; {remedy}") from error


def _moving_picture(path: str | os.PathLike[str], container: InputContainer) -> VideoStream:
    from av.stream import Disposition

    for stream in container.streams.video:
        if not stream.disposition & Disposition.attached_pic:  # the cover of a piece of music
            break
    else:
        what = "only sound" if container.streams.audio else "no picture"
        raise LipwrightError(f"{path}: has {what}; name a video file")
    if max(stream.width, stream.height) > LARGEST:
        raise LipwrightError(
            f"{path}: is {stream.width} x {stream.height} pixels; scale it to {LARGEST} or less"
        )
    # One thread: with more, closing a decoder before its end can wait for ever for a thread that
    # waits for the interpreter. Several videos are tracked at once anyway.
    stream.codec_context.thread_count = 1
    return stream


def _scan(path: str | os.PathLike[str]) -> tuple[tuple[int, int], float, Seconds]:
    """Size of the upright picture, time of the first frame in s, times of all after it."""
    with _open(path) as (container, stream):
        first, frame = next(_decode(stream, container), (0.0, None))
        if frame is None:
            raise LipwrightError(f"{path}: no frame can be decoded; export the video again")
        size = upright_size(frame, stream.sample_aspect_ratio)
        is_timed = (
            any(name in container.format.name for name in _TIMED_FORMATS)
            and stream.codec_context.name in _TIMED_CODECS
        )
    with _open(path) as (container, stream):
        promised, count = _promise(container, stream), stream.frames
        times, reached = _packet_times(container, stream)
        is_short_avi = container.format.name == "avi" and len(times) < count
    if is_short_avi:
        rate = float(stream.average_rate or 25)
        promised, reached = count / rate, len(times) / rate
    if promised - reached > MISSING_END:
        raise LipwrightError(
            f"{path}: is cut off: {max(reached, 0):.2f} s of {promised:.2f} s can be read; export "
            "it again whole, or cut it there with a video editor"
        )
    if not is_timed or any(time is None for time in times):
        with _open(path) as (container, stream):
            times = [time for time, _ in _decode(stream, container)]
    rising = np.unique(np.asarray(times, np.float64))
    return size, first, rising[rising >= first - 1e-6] - first


def _promise(container: InputContainer, stream: VideoStream) -> float:
    """The time in s that the packets should reach; 0 where libav has only estimated it."""
    if "mov" in container.format.name:
        units = (stream.duration or 0) + (stream.start_time or 0)
        return float(units * (stream.time_base or 0))
    if "matroska" in container.format.name:
        return (container.duration or 0) / 1e6
    return 0.0


def _packet_times(
    container: InputContainer, stream: VideoStream
) -> tuple[list[float | None], float]:
    """The time in s of each frame's packet, in the file's order; the end of the last packet."""
    by_all = "matroska" in container.format.name  # whose promise is the longest stream's
    times: list[float | None] = []
    reached = 0.0
    for packet in _packets(container, None if by_all else stream):
        if packet.pts is not None and packet.time_base:
            reached = max(reached, float((packet.pts + (packet.duration or 0)) * packet.time_base))
        if packet.stream_index == stream.index and packet.size and not packet.is_discard:
            time = None if packet.pts is None else packet.pts * (packet.time_base or 0)
            times.append(None if time is None else float(time))
    return times, reached


def _packets(container: InputContainer, stream: Stream | None) -> Iterator[Packet[Stream]]:
    """All packets, or a stream's, up to the end, or to where no more can be found."""
    from av import FFmpegError

    with suppress(FFmpegError, ValueError, OverflowError):
        yield from container.demux() if stream is None else container.demux(stream)


def _decode(stream: VideoStream, container: InputContainer) -> Iterator[tuple[float, VideoFrame]]:
    """The time in s and the frame of all that can be decoded; damaged ones are left out."""
    from av import FFmpegError

    count = 0
    for packet in _packets(container, stream):
        try:
            frames = cast("list[VideoFrame]", packet.decode())
        except (FFmpegError, ValueError, OverflowError):
            continue
        for frame in frames:
            time = frame.time if frame.time is not None else count / (stream.average_rate or 25)
            count += 1
            if not frame.is_corrupt:
                yield float(time), frame


def _sound_start(path: str | os.PathLike[str]) -> float | None:
    """When the first sample of the file's sound is heard, s; None without sound."""
    from av import FFmpegError

    with _open(path) as (container, _):
        if not container.streams.audio:
            return None
        for packet in _packets(container, container.streams.audio[0]):
            with suppress(FFmpegError, ValueError, OverflowError):
                for frame in cast("list[AudioFrame]", packet.decode()):
                    if frame.time is not None:
                        return float(frame.time)
    return None
