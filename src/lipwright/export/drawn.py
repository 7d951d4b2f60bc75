"""What exporters of drawn mouths have in common: which shape shows when, and the sound's name."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Final

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.export.performance import Performance
from lipwright.retarget import is_retargetable
from lipwright.retarget.poses import modes_to_canonical
from lipwright.retarget.shapes import ShownShape, check_drawn, choose_shapes, shown_shapes
from lipwright.rig import Rig, load_rig

DRAWN_FPS: Final = 24.0  # frames a second of film; Rhubarb's, Papagayo's and Moho's default
FASTEST_FPS: Final = 30.0  # faster clips are not drawn frame by frame


def drawn_shapes(
    path: Path, performance: Performance, name: str, *, own: bool = True
) -> tuple[Rig, Callable[[], tuple[ShownShape, ...]]]:
    """The rig of drawings of a performance, and what chooses among them.

    Args:
        path: where they will be written, for messages.
        performance: in a rig of drawings, or in any rig that says what its controls look like.
        name: the rig of drawings for a performance that is in no such rig.
        own: whether drawings of other rigs may stay what they are.

    Raises:
        LipwrightError: shapes cannot be chosen for these curves.
    """
    clip, rig = performance.clip, performance.rig
    if rig is not None and rig.discrete and (own or rig.name == name):
        return rig, lambda: shown_shapes(clip, rig)
    target = load_rig(name)
    try:
        if rig is not None and rig.looks:
            clip = rig.to_canonical(clip)
        elif is_retargetable(clip) and not set(clip.names) & set(CANONICAL):
            clip = modes_to_canonical(clip)
        check_drawn(clip, target, target.names)
    except LipwrightError as error:
        raise LipwrightError(f"{path}: {error}") from error
    return target, lambda: choose_shapes(clip, target, performance.track)


def drawn_fps(performance: Performance) -> float:
    """Frames a second for drawings: the clip's where it is slow enough to be drawn, else 24."""
    fps = performance.clip.fps
    return fps if DRAWN_FPS - 0.1 <= fps <= FASTEST_FPS else DRAWN_FPS


def shape_frames(shown: tuple[ShownShape, ...], fps: float) -> list[tuple[int, str]]:
    """First frame, from 0 on, and name of each shape; of two in one frame the later one stays.

    A shape starts with the frame that is nearest to its time.
    """
    frames: dict[int, str] = {}
    for shape in shown:
        frames[round(shape.start * fps)] = shape.name
    kept: list[tuple[int, str]] = []
    for frame, name in frames.items():
        if not kept or kept[-1][1] != name:
            kept.append((frame, name))
    return kept


_NOT_TEXT: Final = re.compile("[\x00-\x1f\x7f\ufffe\uffff]")


def sound_name(performance: Performance) -> str:
    """The path of the sound in letters that every text file can hold; empty where none is known."""
    path = performance.audio_path
    if path is None:
        return ""
    return _letters(os.fsencode(path))


def as_text(path: Path) -> str:
    """A path with `/`, in letters that every text file can hold."""
    return _letters(os.fsencode(path.as_posix()))


def _letters(name: bytes) -> str:
    return _NOT_TEXT.sub("\ufffd", name.decode("utf-8", "replace"))
