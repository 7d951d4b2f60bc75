"""Clips to files, one module a format, and some of them back."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from lipwright.audio import Sound
from lipwright.clip import Clip
from lipwright.errors import LipwrightError
from lipwright.export.csvclip import read_clip_csv
from lipwright.export.jsonclip import read_clip_json, read_performance_json
from lipwright.export.performance import ExportOptions, Output, PathLike, Performance
from lipwright.export.rigged import as_seen, for_rig
from lipwright.files import write_whole
from lipwright.formats.suffixes import by_suffix
from lipwright.rig import load_rig
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
    "reader_of",
]


CANONICAL_RIG: Final = "arkit"


@dataclass(frozen=True)
class Exporter:
    """One way to write a performance, in a module of its own that is imported when it is used."""

    about: str
    """one line for people"""
    module: str
    """the module's name; it has `outputs`, and where this entry says so `read` and `prepare`"""
    rig: str = ""
    """the rig in whose controls it writes; canonical curves are retargeted to it"""
    reads: bool = False
    """whether such a file can be read back as a clip"""
    prepares: bool = False
    """whether it needs a head or a package that may be missing"""
    shows: bool = False
    """whether it shows a head: curves of another rig are shown as they look on it"""

    def outputs(self, path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
        """The files to write for a target, after all that can be checked before the work."""
        found: list[Output] = self._module.outputs(path, performance, options)
        return found

    def read(self, path: PathLike) -> Clip:
        """The clip of such a file."""
        clip: Clip = self._module.read(path)
        return clip

    def prepare(self) -> None:
        """Find out before long work what is missing.

        Raises:
            LipwrightError: no head is installed, or an extra is missing.
            ImportError: a package is missing.
        """
        if self.prepares:
            self._module.prepare()

    @property
    def _module(self) -> Any:
        return import_module(self.module)


EXPORTERS: Final = MappingProxyType({
    ".json": Exporter("Lipwright clip", "lipwright.export.jsonclip", reads=True),
    ".csv": Exporter(
        "table: time and one column a control", "lipwright.export.csvclip", reads=True
    ),
    ".livelink.csv": Exporter(
        "Live Link Face recording, for Unreal", "lipwright.export.livelink", rig="arkit",
        reads=True,
    ),
    ".glb": Exporter(
        "animated head, with its sound beside it as WAV", "lipwright.export.glb", reads=True,
        prepares=True, shows=True,
    ),
    ".vrma": Exporter("VRM animation: expressions and head", "lipwright.export.vrma", rig="vrm1",
                      reads=True),
    ".usda": Exporter("USD as text, blendshapes", "lipwright.export.usd", prepares=True),
    ".usdc": Exporter("USD with blendshapes", "lipwright.export.usd", prepares=True),
    ".usd": Exporter("USD, the same as .usdc", "lipwright.export.usd", prepares=True),
    ".anim": Exporter("Unity animation clip", "lipwright.export.unity"),
    ".tres": Exporter("Godot 4 animation", "lipwright.export.godot"),
    ".unreal.csv": Exporter("Unreal curve table", "lipwright.export.unreal"),
    ".unreal.json": Exporter("Unreal curve table, as JSON", "lipwright.export.unrealjson"),
    ".maya.anim": Exporter("Maya animation curves, for animImport", "lipwright.export.maya"),
    ".mel": Exporter("Maya script that sets the curves", "lipwright.export.mel"),
    ".a2f.json": Exporter(
        "Audio2Face blendshape weights", "lipwright.export.audio2face", rig="arkit"
    ),
    ".rhubarb.tsv": Exporter("Rhubarb Lip Sync mouth cues", "lipwright.export.rhubarb"),
    ".rhubarb.xml": Exporter(
        "Rhubarb Lip Sync mouth cues, as XML", "lipwright.export.rhubarbxml"
    ),
    ".rhubarb.json": Exporter(
        "Rhubarb Lip Sync mouth cues, as JSON", "lipwright.export.rhubarbjson"
    ),
    ".dat": Exporter("Moho and OpenToonz switch data", "lipwright.export.moho"),
    ".pgo": Exporter("Papagayo lip sync", "lipwright.export.papagayo"),
    ".motion3.json": Exporter("Live2D Cubism motion", "lipwright.export.live2d", rig="live2d"),
    ".spine.json": Exporter("Spine skeleton with a mouth that switches", "lipwright.export.spine"),
    ".vmd": Exporter("MikuMikuDance motion", "lipwright.export.vmd", rig="mmd"),
    ".bones.csv": Exporter(
        "table of bones: places and turns", "lipwright.export.bone_csv", rig="bones"
    ),
    ".bvh": Exporter("BVH skeleton and motion", "lipwright.export.bvh", rig="bones"),
    ".srt": Exporter("SubRip subtitles of the words", "lipwright.export.subtitles"),
    ".vtt": Exporter("WebVTT subtitles of the words", "lipwright.export.webvtt"),
    ".mp4": Exporter("video of the head with sound", "lipwright.export.mp4", prepares=True,
                     shows=True),
})  # fmt: skip
"""suffix to exporter; the longest suffix wins"""


def known_exports() -> dict[str, str]:
    """Suffix of each export format, and what it is."""
    back = {True: "; read back too", False: ""}
    return {suffix: entry.about + back[entry.reads] for suffix, entry in EXPORTERS.items()}


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
        outputs += exporter.outputs(path, in_rig_of(exporter, performance, options), options)
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


def in_rig_of(exporter: Exporter, performance: Performance, options: ExportOptions) -> Performance:
    """The performance in the controls that an exporter writes, where it can be had in them.

    What is in another rig goes by what that looks like on a human face.

    Raises:
        LipwrightError: the exporter's rig does not say how it follows speech.
    """
    own = performance.rig
    of_head = exporter.shows and options.onto is None and options.character is None
    wanted = CANONICAL_RIG if of_head else exporter.rig
    if not wanted or (own is not None and own.name == wanted):
        return performance
    seen = as_seen(performance)
    if of_head:
        return seen
    from lipwright.retarget import is_retargetable

    # Where it is not, the exporter says what it misses.
    return for_rig(seen, load_rig(wanted)) if is_retargetable(seen.clip) else seen


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
    """The clip of a file in a format that can be read back.

    Raises:
        LipwrightError: the format is unknown or cannot be read back, or the file is wrong.
    """
    return reader_of(path, format).read(path)


def reader_of(
    path: PathLike,
    format: str | None = None,  # noqa: A002  # as the command line calls it
) -> Exporter:
    """The exporter whose files are read back like this one.

    Raises:
        LipwrightError: there is none; lists those that can be read back.
    """
    known = ", ".join(suffix for suffix, entry in EXPORTERS.items() if entry.reads)
    unreadable = LipwrightError(f"{path}: cannot be read back as a clip; readable are {known}")
    try:
        exporter = by_suffix(EXPORTERS, path, format, "clip")
    except LipwrightError:
        raise unreadable from None
    if not exporter.reads:
        raise unreadable
    return exporter
