"""Curves of files, with what is known beside them."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lipwright.clip import MIN_FPS, Clip
from lipwright.errors import LipwrightError
from lipwright.export import EXPORTERS, reader_of
from lipwright.export.jsonclip import read_performance_json
from lipwright.export.performance import PathLike, Performance, check_rate
from lipwright.formats import read_track
from lipwright.rig import Rig, load_rig

MAX_CLIP: Final = (
    12 * 3600.0
)  # s; formats with a rate of their own need memory by time, not by frames
MAX_VALUES: Final = 2**28  # of a clip, a gigabyte


def read_performance(
    path: PathLike,
    *,
    audio: PathLike | None = None,
    phones: PathLike | None = None,
    rig: str | Path | Rig | None = None,
    fps: float | None = None,
) -> Performance:
    """Curves of a file, with what is known beside them.

    Args:
        path: a clip in a format that can be read back; our JSON may have its phones.
        audio: their sound.
        phones: a file of their phones; then those of the clip's file are not used.
        rig: whose controls they are; None for canonical ones.
        fps: frames a second; None for those of the file.

    Raises:
        LipwrightError: a file or rig cannot be used, or the curves are none of the rig's.
    """
    exporter = reader_of(path)
    ours = exporter is EXPORTERS[".json"]
    found = read_performance_json(path) if ours else Performance(exporter.read(path))
    clip = found.clip
    _check_extent(path, clip, clip.fps)
    if fps is not None and fps != clip.fps:
        check_rate(fps)
        _check_extent(path, clip, fps)
        clip = clip.resample(fps)
    track = found.track if phones is None else read_track(phones)
    known = rig if rig is None or isinstance(rig, Rig) else load_rig(rig)
    if known is not None and not set(clip.names) & set(known.names):
        raise LipwrightError(
            f"{path}: has none of the controls of the rig {known.name!r}, such as "
            f"{', '.join(known.names[:3])}; it has {', '.join(clip.names[:3])}"
        )
    return Performance(clip, track, audio, known)


def _check_extent(path: PathLike, clip: Clip, fps: float) -> None:
    """Refuse curves that would take more memory than there is."""
    if clip.fps < MIN_FPS:
        raise LipwrightError(f"{path}: has {clip.fps:g} frames a second; at least {MIN_FPS:g}")
    if clip.duration > MAX_CLIP or clip.duration * fps * len(clip.names) > MAX_VALUES:
        raise LipwrightError(
            f"{path}: lasts {clip.duration:.0f} s, with {len(clip.names)} controls at {fps:g} "
            "frames a second; convert it in parts"
        )
