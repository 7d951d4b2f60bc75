"""Clips to files; one module a format, and the two of ours back from files."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final

from lipwright.audio import Sound
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export import csvclip, glb, jsonclip, livelink, mp4
from lipwright.export.csvclip import read_clip_csv
from lipwright.export.jsonclip import read_clip_json, read_performance_json
from lipwright.export.performance import ExportOptions, Output, PathLike, Performance
from lipwright.files import write_whole
from lipwright.formats.suffixes import by_suffix
from lipwright.track import PhoneTrack

__all__ = [
    "EXPORTERS",
    "ExportOptions",
    "Exporter",
    "Performance",
    "check_targets",
    "export_all",
    "export_clip",
    "known_exports",
    "read_clip",
    "read_clip_csv",
    "read_clip_json",
    "read_performance_json",
]


@dataclass(frozen=True)
class Exporter:
    """One way to write a performance."""

    about: str
    """one line for people"""
    outputs: Callable[[Path, Performance, ExportOptions], list[Output]]
    """the files to write for a target, after all that can be checked before the work"""
    read: Callable[[PathLike], Clip] | None = None
    """the clip of such a file, where it can be read back"""
    prepare: Callable[[], object] | None = None
    """raises LipwrightError or ImportError where a head or package that it needs is missing"""


EXPORTERS: Final = MappingProxyType({
    ".json": Exporter("Lipwright clip", jsonclip.outputs, read_clip_json),
    ".csv": Exporter("table: time and one column a control", csvclip.outputs, read_clip_csv),
    ".livelink.csv": Exporter("Live Link Face recording, for Unreal", livelink.outputs),
    ".glb": Exporter(
        "animated head, with its sound beside it as WAV", glb.outputs, prepare=glb.prepare
    ),
    ".mp4": Exporter("video of the head with sound", mp4.outputs, prepare=mp4.prepare),
})  # fmt: skip
"""suffix to exporter; the longest suffix wins"""


def known_exports() -> dict[str, str]:
    """Suffix of each export format, and what it is."""
    return {suffix: entry.about for suffix, entry in EXPORTERS.items()}


def export_clip(
    path: PathLike,
    clip: Clip,
    *,
    track: PhoneTrack | None = None,
    audio: Sound | PathLike | None = None,
    format: str | None = None,  # noqa: A002  # as the command line calls it
    options: ExportOptions | None = None,
) -> None:
    """Write a clip in the format of the file's suffix, whole or not at all.

    Args:
        path: the file; an older one is replaced.
        clip: the curves.
        track: the phones that they follow; kept by JSON.
        audio: the sound from the clip's first frame on, or its file; kept by MP4 and GLB.
        format: a suffix of `known_exports`, where that of the file does not say it.
        options: choices of single formats.

    Raises:
        LipwrightError: as `export_all`.
    """
    export_all([path], Performance(clip, track, audio), format=format, options=options)


def export_all(
    paths: PathLike | Iterable[PathLike],
    performance: Performance,
    *,
    format: str | None = None,  # noqa: A002  # as the command line calls it
    options: ExportOptions | None = None,
) -> None:
    """Write a performance to several files, each whole or not at all.

    No file takes its place before all are written, so that a failure leaves older files as they
    were.

    Args:
        paths: the files, or one file; older ones are replaced.
        performance: what to write.
        format: a suffix of `known_exports` for all files, where theirs do not say it.
        options: choices of single formats.

    Raises:
        LipwrightError: a format is unknown or cannot hold the performance, two files are the
            same, one is the recording itself, or one cannot be written.
    """
    options = options or ExportOptions()
    paths = [paths] if isinstance(paths, str | os.PathLike) else paths
    outputs: list[Output] = []
    for path in map(Path, paths):
        exporter = by_suffix(EXPORTERS, path, format, "export")
        outputs += exporter.outputs(path, performance, options)
    check_targets([output.path for output in outputs], performance.audio_path)
    with ExitStack() as stack:
        for output in outputs:
            # Parts of finished files wait for the last one; the stack then moves them all.
            part = stack.enter_context(write_whole(output.path))
            try:
                output.write(part)
            except OSError as error:
                reason = error.strerror or str(error)
                raise LipwrightError(f"{output.path}: cannot be written: {reason}") from error


def check_targets(
    paths: Iterable[PathLike],
    recording: PathLike | None = None,
    inputs: Iterable[PathLike] = (),
) -> None:
    """Find out before long work whether files can be written.

    Args:
        paths: the files.
        recording: a file that none of them may replace.
        inputs: other files that none of them may replace, such as the words.

    Raises:
        LipwrightError: two of them are the same, or one is a folder, a device, an input, or in a
            folder that is missing or read-only.
    """
    inputs = tuple(inputs)
    seen: set[Path] = set()
    for path in map(Path, paths):
        _check_target(path)
        place = Path(os.path.realpath(path))  # links are followed when files are written
        if place in seen:
            raise LipwrightError(f"{path}: two outputs have this name; give each its own")
        seen.add(place)
        if recording is not None and _is_same(path, Path(recording)):
            raise LipwrightError(f"{path}: is the recording itself; name another output")
        if any(_is_same(path, Path(other)) for other in inputs):
            raise LipwrightError(f"{path}: is also read; name another output")


def _is_same(path: Path, other: Path) -> bool:
    try:
        return path.samefile(other)
    except OSError:  # one of them is not there, or cannot be
        return False


def _check_target(path: Path) -> None:
    try:
        if path.is_dir():
            raise LipwrightError(f"{path}: is a folder; name a file")
        if path.exists() and not path.is_file():
            raise LipwrightError(f"{path}: is a device or pipe; name a file, or - for a pipe")
        folder = Path(os.path.realpath(path)).parent  # where a link leads to
        if not folder.is_dir():
            missing = folder if path.is_symlink() else path.parent
            raise LipwrightError(f"{path}: its folder {missing} does not exist; create it first")
        # Permissions alone do not tell: the file system may be read-only, the user root.
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".lipwright-"):
            pass
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(f"{path}: cannot be written: {reason}; name another file") from error


def read_clip(
    path: PathLike,
    format: str | None = None,  # noqa: A002  # as the command line calls it
) -> Clip:
    """The clip of a JSON or CSV file that was exported.

    Raises:
        LipwrightError: the format is unknown or cannot be read back, or the file is wrong.
    """
    exporter = by_suffix(EXPORTERS, path, format, "clip")
    if exporter.read is None:
        known = ", ".join(suffix for suffix, entry in EXPORTERS.items() if entry.read)
        raise LipwrightError(f"{path}: cannot be read back as a clip; readable are {known}")
    return exporter.read(path)
