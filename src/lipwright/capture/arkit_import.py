"""Recordings of ARKit weights: reading them, and finding them and their sound in a folder."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Final

from lipwright.capture.arkitjson import read_arkit_json
from lipwright.capture.video import LEAST_FPS
from lipwright.errors import LipwrightError
from lipwright.export.arkit_recording import ArkitRecording
from lipwright.export.livelink_read import is_live_link, read_live_link

SOUND_SUFFIXES: Final = (
    ".wav", ".flac", ".aif", ".aiff", ".mov", ".mp4", ".m4v", ".m4a", ".mkv", ".webm", ".avi",
    ".mp3", ".ogg", ".opus", ".aac",
)  # fmt: skip
"""the same stem with several: what comes first is nearest to what the microphone gave"""

# With a calibration the app writes three tables of a take: the weights less those of the neutral
# pose, as they were, and the pose.
_PARTS: Final = ("", "cal", "raw")
_PART: Final = re.compile(r"(?:_(cal|raw|neutral)|\.livelink)$", re.IGNORECASE)
_DEVICE: Final = re.compile(r"_i(?:phone|pad)[\w ]*$", re.IGNORECASE)


def read_arkit(path: str | os.PathLike[str], timecode_fps: int | None = None) -> ArkitRecording:
    """The recording of a .csv or .json file.

    Args:
        path: the file; a table with a time and ARKit's names, or a JSON of one of the layouts of
            `arkitjson`.
        timecode_fps: frames a second that time codes count; None finds it out.

    Raises:
        LipwrightError: the file is of another format or broken; names line or frame.
    """
    suffix = Path(path).suffix.casefold()
    if suffix == ".csv":
        return read_live_link(path, timecode_fps, LEAST_FPS)
    if suffix == ".json":
        return read_arkit_json(path, timecode_fps)
    raise LipwrightError(f"{path}: no recording of ARKit weights; name a .csv or .json file")


def take_stem(path: str | os.PathLike[str]) -> str:
    """The name of a take without what the app, or our export, adds to it.

    `A_1_iPhone_cal.csv` is of `A_1_iPhone`, `talk.livelink.csv` of `talk`.
    """
    return _PART.sub("", Path(path).stem)


def _part(path: Path) -> str:
    match = _PART.search(path.stem)
    return match[1].casefold() if match and match[1] else ""


def find_takes(files: Iterable[Path]) -> tuple[Path, ...]:
    """The Live Link Face recordings among `files`, one of each take, sorted.

    A take with a calibration has several tables: the calibrated one is preferred to the raw one,
    and that of the neutral pose is none.
    """
    tables = sorted(path for path in files if is_live_link(path))
    takes: dict[tuple[Path, str], Path] = {}
    for part in _PARTS:
        for path in tables:
            if _part(path) == part:
                takes.setdefault((path.parent, take_stem(path)), path)
    return tuple(sorted(takes.values()))


def take_names(path: str | os.PathLike[str]) -> tuple[str, ...]:
    """Stems that files of the same take may have, the most exact first.

    `A_1_iPhone_cal.csv` goes with `A_1_iPhone_cal`, `A_1_iPhone` and `A_1`.
    """
    stem = take_stem(path)
    return tuple(dict.fromkeys((Path(path).stem, stem, _DEVICE.sub("", stem))))


def sounds_beside(path: str | os.PathLike[str]) -> tuple[Path, ...]:
    """The sounds and movies of a recording's take in its folder, the best first."""
    folder = Path(path).parent
    names = [name.casefold() for name in take_names(path)]
    found: list[tuple[int, int, Path]] = []
    with suppress(OSError):
        for file in sorted(os.listdir(folder)):  # noqa: PTH208  # folders of thousands of files
            stem, suffix = os.path.splitext(file.casefold())  # noqa: PTH122  # the same
            if stem in names and suffix in SOUND_SUFFIXES and (folder / file).is_file():
                found.append((names.index(stem), SOUND_SUFFIXES.index(suffix), folder / file))
    return tuple(file for _, _, file in sorted(found))


def find_sound(path: str | os.PathLike[str]) -> Path | None:
    """The sound or movie beside a recording: of its name, or of its take's without the device."""
    return next(iter(sounds_beside(path)), None)
