"""`Audio`: sound as mono samples; `AudioFile`: a recording of any length, read in pieces."""

from __future__ import annotations

import errno
import math
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import TracebackType
from typing import IO, Final, Protocol, Self, cast

import numpy as np
import numpy.typing as npt

from lipwright.decode import MAX_RATE, MIN_RATE, Block, decode
from lipwright.errors import LipwrightError
from lipwright.files import write_whole

Samples = npt.NDArray[np.float32]
Resampler = Callable[[Samples, bool], Samples]

LEVEL_FLOOR: Final = -120.0  # dBFS, what level_db gives for digital silence
_IN_MEMORY: Final = 16 << 20  # bytes of decoded sound before it goes to disk: 4 minutes at 16 kHz
_PROBE: Final = 1 << 16  # bytes that a full disk does not take
_CANCELLED: Final = 1e-3  # energy of the mean over that of the loudest channel: -30 dB


class Sound(Protocol):
    """What `Audio` and `AudioFile` have in common."""

    @property
    def rate(self) -> int:
        """Samples a second."""

    @property
    def duration(self) -> float:
        """In s."""

    def __len__(self) -> int:
        """The number of samples, N."""

    def read(self, start: float, end: float) -> Audio:
        """The sound from `start` to `end` s, clipped to what there is."""

    def blocks(self, seconds: float = 10.0) -> Iterator[Audio]:
        """The whole sound in pieces of `seconds`, the last one shorter."""


@dataclass(frozen=True, eq=False)
class Audio:
    """N samples of mono sound.

    Raises:
        ValueError: the samples are not a row of finite numbers, or the rate is not positive.
    """

    samples: Samples
    """(N,), full scale is 1; read-only"""
    rate: int
    """samples a second, above 0"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        samples = np.array(self.samples, dtype=np.float32)  # a copy: ours to freeze
        if samples.ndim != 1:
            raise ValueError(f"samples have the shape {samples.shape}, not (N,)")
        if not np.isfinite(samples).all():
            index = int(np.flatnonzero(~np.isfinite(samples))[0])
            raise ValueError(f"sample {index} is not a finite number")
        if self.rate != int(self.rate) or self.rate <= 0:
            raise ValueError(f"rate is {self.rate}, not a whole number above 0")
        samples.setflags(write=False)
        object.__setattr__(self, "samples", samples)
        object.__setattr__(self, "rate", int(self.rate))

    def __len__(self) -> int:
        """The number of samples, N."""
        return len(self.samples)

    @property
    def duration(self) -> float:
        """In s."""
        return len(self) / self.rate

    def read(self, start: float, end: float) -> Audio:
        """The sound from `start` to `end` s, clipped to what there is.

        Raises:
            ValueError: the end is before the start.
        """
        return Audio(self.samples[slice(*_span(self, start, end))], self.rate)

    def blocks(self, seconds: float = 10.0) -> Iterator[Audio]:
        """The whole sound in pieces of `seconds`, the last one shorter."""
        return _blocks(self, seconds)


class AudioFile:
    """A recording, decoded to mono at one rate; made by `open_audio`.

    It holds the decoded samples in a file that has no name, so that nothing is left behind,
    however the program ends.
    """

    def __init__(self, name: str, rate: int, spool: IO[bytes], count: int) -> None:
        """`count` float32 samples in `spool`, which is closed with this."""
        self._name, self._rate, self._spool, self._count = name, rate, spool, count

    @property
    def name(self) -> str:
        """The path as the user wrote it, or "standard input"."""
        return self._name

    @property
    def rate(self) -> int:
        """Samples a second."""
        return self._rate

    @property
    def duration(self) -> float:
        """In s, of the sound that was decoded."""
        return self._count / self._rate

    def __len__(self) -> int:
        """The number of samples, N."""
        return self._count

    def read(self, start: float, end: float) -> Audio:
        """The sound from `start` to `end` s, clipped to what there is.

        Raises:
            ValueError: the end is before the start, or the file is closed.
        """
        first, stop = _span(self, start, end)
        self._spool.seek(first * 4)
        return Audio(np.frombuffer(self._spool.read((stop - first) * 4), np.float32), self._rate)

    def blocks(self, seconds: float = 10.0) -> Iterator[Audio]:
        """The whole sound in pieces of `seconds`, the last one shorter."""
        return _blocks(self, seconds)

    def close(self) -> None:
        """Drop the samples."""
        self._spool.close()

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
        """Drop the samples."""
        self.close()


def _span(sound: Sound, start: float, end: float) -> tuple[int, int]:
    if not start <= end:
        raise ValueError(f"a piece of sound from {start} to {end} s")
    first, stop = (min(max(time * sound.rate, 0), len(sound)) for time in (start, end))
    return round(first), round(stop)


def _blocks(sound: Sound, seconds: float) -> Iterator[Audio]:
    if not seconds > 0:
        raise ValueError(f"blocks of {seconds} s")
    for index in range(math.ceil(sound.duration / seconds)):
        yield sound.read(index * seconds, (index + 1) * seconds)


def open_audio(path: str | os.PathLike[str], rate: int | None = None) -> AudioFile:
    """Decode the sound of a file to mono, at `rate` Hz or else at its own; `-` is standard input.

    Channels are averaged. Where they cancel each other, as in stereo with one side inverted,
    the loudest is taken instead.

    Raises:
        LipwrightError: the file is missing, unreadable, not sound, cut off, damaged or empty.
        ValueError: the rate is out of range.
    """
    if rate is not None and not MIN_RATE <= rate <= MAX_RATE:
        raise ValueError(f"rate is {rate}, not {MIN_RATE} to {MAX_RATE} Hz")
    name = "standard input" if os.fspath(path) == "-" else os.fspath(path)
    try:
        with _open_seekable(path) as file:
            try:
                return _spool(name, decode(file, name), rate)
            except _CancelledError as cancelled:
                return _spool(name, decode(file, name), rate, cancelled.loudest)
    except OSError as error:
        raise _reading_error(name, error) from error


def read_audio(path: str | os.PathLike[str], rate: int | None = None) -> Audio:
    """The whole sound of a short file; like `open_audio`, but in memory.

    Raises:
        LipwrightError: as `open_audio`.
    """
    with open_audio(path, rate) as file:
        return file.read(0, file.duration)


@contextmanager
def _open_seekable(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """The file, or a copy of a pipe in a file without a name."""
    if os.fspath(path) == "-":
        piped = sys.stdin.buffer
        yield piped if piped.seekable() else _copy_of_input(piped)
        return
    if "\0" in os.fspath(path):
        raise OSError(errno.EINVAL, "a NUL in the name")
    with Path(path).open("rb") as file:
        if file.seekable():
            yield file
        else:
            with closing(_copy_of(file)) as copy:
                yield copy


def _copy_of(pipe: IO[bytes]) -> IO[bytes]:
    with ExitStack() as stack:
        copy = stack.enter_context(tempfile.SpooledTemporaryFile(_IN_MEMORY))
        shutil.copyfileobj(pipe, copy)
        stack.pop_all()
        return cast("IO[bytes]", copy)


# Standard input can be read only once, but is opened again: the aligner and a video want its sound.
_copy_of_input = lru_cache(maxsize=1)(_copy_of)


def _reading_error(name: str, error: OSError) -> LipwrightError:
    if isinstance(error, FileNotFoundError):
        return LipwrightError(f"{name}: no such file; check the path")
    if isinstance(error, IsADirectoryError):
        return LipwrightError(f"{name}: is a folder; name a sound file in it")
    if isinstance(error, PermissionError):
        return LipwrightError(f"{name}: may not be read; check its permissions")
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        return LipwrightError(
            f"{name}: its decoded sound does not fit into {tempfile.gettempdir()}; set TMPDIR to a "
            "folder with more room"
        )
    return LipwrightError(f"{name}: cannot be read: {error.strerror}; check the path")


class _CancelledError(Exception):
    """The channels cancel each other in their mean."""

    def __init__(self, loudest: int) -> None:
        self.loudest = loudest


def _spool(
    name: str, blocks: Iterator[tuple[int, Block]], rate: int | None, channel: int | None = None
) -> AudioFile:
    """Decoded, mixed (or one channel) and resampled sound in a file without a name."""
    with ExitStack() as stack:
        spool = stack.enter_context(tempfile.SpooledTemporaryFile(_IN_MEMORY))
        resample: Resampler | None = None
        mixed, energies = 0.0, np.zeros(1)
        for own, block in blocks:
            resample = resample or _resampler(own, rate or own)
            mono = block.mean(axis=0) if channel is None else block[channel]
            mixed += float(np.square(mono, dtype=np.float64).sum())
            energies = energies + np.square(block, dtype=np.float64).sum(axis=1)
            spool.write(resample(np.ascontiguousarray(mono), False).tobytes())
            rate = rate or own
        if resample is not None:
            spool.write(resample(np.empty(0, np.float32), True).tobytes())
        if channel is None and mixed < _CANCELLED * energies.max():
            raise _CancelledError(int(energies.argmax()))
        count = spool.tell() // 4
        if not count or rate is None:
            raise LipwrightError(f"{name}: has no sound samples; export the recording again")
        stack.pop_all()
        return AudioFile(name, rate, cast("IO[bytes]", spool), count)


def _resampler(own: int, rate: int) -> Resampler:
    if own == rate:
        return lambda samples, last: samples
    from soxr import ResampleStream

    return cast("Resampler", ResampleStream(own, rate, 1, dtype="float32").resample_chunk)


def resampled(sound: Audio, rate: int) -> Audio:
    """The same sound at `rate` Hz.

    Raises:
        ValueError: the rate is out of range.
    """
    if not MIN_RATE <= rate <= MAX_RATE:
        raise ValueError(f"rate is {rate}, not {MIN_RATE} to {MAX_RATE} Hz")
    return Audio(_resampler(sound.rate, rate)(sound.samples, True), rate)


def write_wav(path: str | os.PathLike[str], sound: Sound, software: str = "") -> None:
    """Write 16-bit PCM, whole or not at all; louder samples than full scale are clipped.

    Args:
        path: the target.
        sound: what is heard.
        software: what made the sound, for the file's own notes; see `written_by`.

    Raises:
        LipwrightError: the target cannot be written.
    """
    _write_pcm(path, sound, "WAV", software)


def write_flac(path: str | os.PathLike[str], sound: Sound, software: str = "") -> None:
    """The same as FLAC, in about half the bytes.

    Raises:
        LipwrightError: the target cannot be written.
    """
    _write_pcm(path, sound, "FLAC", software)


def written_by(path: str | os.PathLike[str]) -> str:
    """What made a sound, as its file notes it; "" where it does not, or cannot be read."""
    import soundfile

    try:
        with soundfile.SoundFile(_name(path)) as file:
            return str(file.software).partition(" (")[0]  # libsndfile adds its own name
    except (OSError, soundfile.LibsndfileError):
        return ""


def _write_pcm(path: str | os.PathLike[str], sound: Sound, container: str, software: str) -> None:
    import soundfile

    with write_whole(path) as part:
        name = _name(part)
        try:
            with soundfile.SoundFile(name, "w", sound.rate, 1, "PCM_16", format=container) as file:
                if software:
                    file.software = software
                for block in sound.blocks():
                    file.write(block.samples)
        except soundfile.LibsndfileError as error:
            with part.open("ab") as again:  # meets the system's reason, which libsndfile keeps
                again.write(bytes(_PROBE))
            raise OSError(errno.EIO, str(error)) from error


def _name(path: str | os.PathLike[str]) -> str | bytes:
    """A path as soundfile opens it; letters that are not UTF-8 too, which files may have."""
    return os.fspath(path) if os.name == "nt" else os.fsencode(path)


def level_db(sound: Sound, step: float = 0.01) -> Samples:
    """The level of each `step` seconds: (ceil(duration / step),), RMS in dBFS.

    Value i is that of the samples from i * step to (i + 1) * step s.
    """
    count = math.ceil(len(sound) / (step * sound.rate) - 1e-9)
    levels = np.empty(count, np.float32)
    for first in range(0, count, 1000):
        stop = min(first + 1000, count)
        samples = sound.read(first * step, stop * step).samples
        edges = np.round(np.arange(first, stop + 1) * (step * sound.rate)).astype(np.int64)
        edges = np.minimum(edges, len(sound)) - edges[0]
        sums = np.add.reduceat(np.square(samples, dtype=np.float64), edges[:-1])
        powers = sums / np.diff(edges)
        levels[first:stop] = 10 * np.log10(np.maximum(powers, 10 ** (LEVEL_FLOOR / 10)))
    return levels
