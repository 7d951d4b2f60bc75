"""Sound out of media files, block by block, by content and not by suffix.

wav, flac, ogg, aiff and their like are read by libsndfile; mp3, m4a, aac and the sound of
videos by libav, which also gets what libsndfile refuses. A file that promises more sound than
it holds is an error, not a shorter recording.

What cannot be noticed: the missing end of an mp3 without a Xing header, of raw AAC cut between
two frames, and of a live-streamed webm without a duration.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import suppress
from typing import IO, TYPE_CHECKING, Any, Final, cast

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError

if TYPE_CHECKING:
    from av import AudioFrame
    from av.container import InputContainer
    from av.packet import Packet
    from av.stream import Stream

Block = npt.NDArray[np.float32]

MIN_RATE: Final = 2_000  # Hz, less cannot carry speech
MAX_RATE: Final = 768_000  # Hz, the highest rate in use
LOUDEST: Final = 1e6  # full scale is 1; float files in units of 16-bit steps reach 32768
_BLOCK: Final = 0.25  # s, read at once; the share of a cut file that can be read is told so finely
_TOLERANCE: Final = 0.15  # s; a stream's duration is rounded to packets, of at most 0.12 s
_OGG_TAIL: Final = 1 << 17  # bytes; an ogg page has at most 65307

# libsndfile is asked only for what begins like this: on anything else it tries mpg123, which
# writes to standard error.
_SNDFILE_MAGIC: Final = (
    b"RIFF",
    b"RIFX",
    b"RF64",
    b"riff",
    b"FORM",
    b"fLaC",
    b"OggS",
    b".snd",
    b"caff",
)
# Only these: libav would follow a playlist to other files, and take a text for a picture.
_AV_FORMATS: Final = (
    "aac,ac3,aiff,amr,amrnb,amrwb,ape,asf,au,avi,caf,dts,eac3,flac,flv,loas,matroska,webm,mov,mp4,"
    "m4a,3gp,mp3,mpeg,mpegts,mxf,nut,ogg,oga,rm,tta,w64,wav,wv"
)
_STREAMED: Final = (0, 0x7FFFFFFF, 0xFFFFFFFF)  # sizes that a program writes into a pipe's header


def decode(file: IO[bytes], name: str) -> Iterator[tuple[int, Block]]:
    """The rate in Hz (always the same) and the samples (channels, n) of each block of `file`.

    Raises:
        LipwrightError: not a sound file, without sound, damaged or cut off; names `name`.
    """
    file.seek(0)
    head = file.read(4)
    if not head:
        raise LipwrightError(f"{name}: is empty; export the recording again")
    end = 0.0
    for rate, block in _blocks(file, name, head):
        if not MIN_RATE <= rate <= MAX_RATE:
            raise LipwrightError(
                f"{name}: has a rate of {rate} Hz, not {MIN_RATE} to {MAX_RATE}; convert it to wav"
            )
        # One comparison finds NaN as well: it is never <= a number.
        fits = np.abs(block) <= LOUDEST
        if not fits.all():
            channel, index = np.argwhere(~fits)[0]
            value = float(block[channel, index])
            raise LipwrightError(
                f"{name}: the sample at {end + index / rate:.3f} s is {value:g}, not a sound "
                "pressure; export the recording again"
            )
        end += block.shape[1] / rate
        yield rate, block


def _blocks(file: IO[bytes], name: str, head: bytes) -> Iterator[tuple[int, Block]]:
    if head in _SNDFILE_MAGIC:
        sound = _open_sndfile(file)
        if sound is not None:
            with sound:
                if head == b"OggS":
                    _check_ogg_end(file, name, sound.frames / sound.samplerate)
                yield from _sndfile_blocks(sound, name)
            return
    yield from _av_blocks(file, name)


def _cut_off(name: str, seconds: float, promised: float | None = None) -> LipwrightError:
    """The error for a file that ends too early, `seconds` of it readable."""
    of = "" if promised is None else f" of {promised:.2f} s"
    return LipwrightError(
        f"{name}: is cut off: {seconds:.2f} s{of} can be read; export it again whole, or cut it "
        "there with an audio editor"
    )


def _damaged(name: str, seconds: float) -> LipwrightError:
    return LipwrightError(f"{name}: is damaged at {seconds:.2f} s; export the recording again")


class _Readable:
    """A file as libsndfile calls it from C, where an exception would go to standard error.

    Damaged headers make it seek to places that there are not.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file

    def seek(self, offset: int, whence: int = 0) -> int:
        with suppress(OSError, ValueError, OverflowError):
            self._file.seek(offset, whence)
        return self._file.tell()

    def tell(self) -> int:
        return self._file.tell()

    def read(self, count: int) -> bytes:
        with suppress(OSError, ValueError, OverflowError, MemoryError):
            return self._file.read(max(count, 0))
        return b""


def _open_sndfile(file: IO[bytes]) -> Any:
    import soundfile

    file.seek(0)
    try:
        sound = soundfile.SoundFile(_Readable(file), "r")
    except soundfile.LibsndfileError:
        return None
    if sound.samplerate <= 0 or sound.channels <= 0:
        sound.close()
        return None
    return sound


def _sndfile_blocks(sound: Any, name: str) -> Iterator[tuple[int, Block]]:
    from soundfile import LibsndfileError

    rate, done = sound.samplerate, 0
    promised = _promised_share(sound.extra_info)
    if promised is not None:
        raise _cut_off(name, sound.frames / rate, sound.frames / rate * promised)
    while True:
        try:
            block = sound.read(math.ceil(_BLOCK * rate), np.float32, always_2d=True)
        except LibsndfileError as error:
            raise _cut_off(name, done / rate, sound.frames / rate) from error
        if not len(block):
            break
        done += len(block)
        yield rate, block.T
    if done < sound.frames and sound.frames < 1 << 60:
        raise _cut_off(name, done / rate, sound.frames / rate)


def _promised_share(log: str) -> float | None:
    """How many times the sound that is there the header promises, or None if it is all there.

    libsndfile corrects such a header by itself and notes it in its log.
    """
    pattern = r"^\s*(?:data|SSND|Data Size|Riff size|riff)\s*:\s*(\d+) \(should be (\d+)\)"
    for promised, found in re.findall(pattern, log, re.MULTILINE):
        if int(promised) not in _STREAMED and int(promised) > int(found):
            return int(promised) / max(int(found), 1)
    return None


def _check_ogg_end(file: IO[bytes], name: str, seconds: float) -> None:
    """Refuse an ogg file whose last whole page is not marked as the end of a stream."""
    position = file.tell()  # libsndfile goes on reading from here
    file.seek(max(0, file.seek(0, 2) - _OGG_TAIL))
    tail = file.read()
    file.seek(position)
    start = len(tail)
    while (start := tail.rfind(b"OggS", 0, start)) >= 0:
        lacing = tail[start + 27 : start + 27 + tail[start + 26]] if start + 26 < len(tail) else b""
        whole = lacing and start + 27 + len(lacing) + sum(lacing) <= len(tail)
        if whole and len(lacing) == tail[start + 26]:
            if tail[start + 5] & 4:
                return
            break
    raise _cut_off(name, seconds)


def _av_blocks(file: IO[bytes], name: str) -> Iterator[tuple[int, Block]]:
    import av

    # With a level, libav's threads call Python for each message, and wait for ever if it waits.
    av.logging.set_level(None)
    marked, short = _has_mp3_length(file), _is_short_avi(file)
    file.seek(0)
    try:
        container = av.open(
            file, "r", options={"format_whitelist": _AV_FORMATS}, metadata_errors="replace"
        )
    except (av.FFmpegError, ValueError, OverflowError) as error:
        raise LipwrightError(
            f"{name}: is not a sound file that can be read, or its index is missing because it is "
            "cut off; convert it to wav, flac, mp3, ogg or m4a"
        ) from error
    with container:
        if not container.streams.audio:
            raise LipwrightError(f"{name}: has no sound; name a file with a sound track")
        if short:
            raise _cut_off(name, (container.duration or 0) / 1e6)
        yield from _av_stream(container, name, marked)


def _is_short_avi(file: IO[bytes]) -> bool:
    """Whether an AVI file is shorter than it says; libav takes what is there for all of it."""
    size = file.seek(0, 2)
    file.seek(0)
    head = file.read(12)
    promised = int.from_bytes(head[4:8], "little")
    is_avi = head.startswith(b"RIFF") and head.endswith(b"AVI ")
    return is_avi and promised not in _STREAMED and promised + 8 > size


def _has_mp3_length(file: IO[bytes]) -> bool:
    """Whether the file begins with an mp3 frame that says how long the recording is."""
    file.seek(0)
    head = file.read(10)
    start = 0
    if len(head) == 10 and head.startswith(b"ID3"):
        a, b, c, d = (byte & 0x7F for byte in head[6:])
        start = 10 + (a << 21) + (b << 14) + (c << 7) + d
    file.seek(start)
    frame = file.read(256)
    return any(mark in frame for mark in (b"Xing", b"Info", b"VBRI"))


def _av_stream(container: InputContainer, name: str, marked: bool) -> Iterator[tuple[int, Block]]:
    """The first sound stream; `marked`: an mp3 has its length in its first frame."""
    from av import AudioResampler, FFmpegError

    stream = container.streams.audio[0]
    to_float = AudioResampler(format="fltp")
    promised, by_all = _av_promise(container, marked)
    rate, done, reached, failed = 0, 0, 0.0, False
    for packet in _packets(container):
        if (by_all or packet.stream is stream) and packet.pts is not None and packet.time_base:
            reached = max(reached, float((packet.pts + (packet.duration or 0)) * packet.time_base))
        if packet.stream is not stream:
            continue
        try:
            frames = cast("list[AudioFrame]", packet.decode())
            blocks = [part.to_ndarray() for frame in frames for part in to_float.resample(frame)]
        except (FFmpegError, ValueError, OverflowError):
            failed = done > 0  # a cut out of an mp3 often begins with half a frame
            continue
        for block in blocks:
            if failed:
                raise _damaged(name, done / rate)
            rate = rate or stream.codec_context.sample_rate
            done += block.shape[1]
            yield rate, np.asarray(block, np.float32)
        failed = failed or packet.is_corrupt
    if promised - reached > _TOLERANCE:
        raise _cut_off(name, done / max(rate, 1), promised)
    if failed and container.format.name != "mp3":  # whose last packet may be a tag
        raise _cut_off(name, done / max(rate, 1))


def _av_promise(container: InputContainer, marked: bool) -> tuple[float, bool]:
    """The time in s that the sound should reach, or that all streams together should.

    0 where libav has only estimated it.
    """
    stream, kind = container.streams.audio[0], container.format.name
    if "mov" in kind or (kind == "mp3" and marked):
        units = (stream.duration or 0) + ((stream.start_time or 0) if "mov" in kind else 0)
        return float(units * (stream.time_base or 0)), False
    if "matroska" in kind:
        return (container.duration or 0) / 1e6, True
    return 0.0, False


def _packets(container: InputContainer) -> Iterator[Packet[Stream]]:
    """All packets up to the end, or to where no more can be found."""
    from av import FFmpegError

    with suppress(FFmpegError, ValueError, OverflowError):
        yield from container.demux()
