"""What exporters write: a clip with its track and sound."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lipwright.audio import Sound, open_audio
from lipwright.clip import MAX_FPS, MIN_FPS, Clip
from lipwright.errors import LipwrightError
from lipwright.rig import Rig
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.face.mesh import Mesh
    from lipwright.face.shading import Camera, View

PathLike = str | os.PathLike[str]

MAX_SIDE = 4096  # px; H.264 level 5.2 ends near it
_BLOCK = 1000  # frames


@dataclass(frozen=True, eq=False)
class Performance:
    """Curves, and what is said and heard with them."""

    clip: Clip
    track: PhoneTrack | None = None
    """the phones that the curves follow"""
    audio: Sound | PathLike | None = None
    """the sound from the clip's first frame on, or its file"""
    rig: Rig | None = None
    """whose controls the curves are; None for canonical ones, and for modes of a face"""

    @property
    def audio_path(self) -> Path | None:
        """The file of the sound, where that is known."""
        name = self.audio
        if name is not None and not isinstance(name, str | os.PathLike):
            name = getattr(name, "name", None)
        return None if name is None else Path(name)

    @contextmanager
    def open_sound(self) -> Iterator[Sound | None]:
        """The sound, or None where there is none.

        Raises:
            LipwrightError: the file of the sound cannot be read.
        """
        if self.audio is None or not isinstance(self.audio, str | os.PathLike):
            yield self.audio
        else:
            with open_audio(self.audio) as sound:
                yield sound


@dataclass(frozen=True)
class ExportOptions:
    """Choices of single formats; the others pass over them.

    Raises:
        LipwrightError: a side of the video is odd or out of range.
    """

    size: tuple[int, int] = (512, 512)
    """width and height of a video in pixels; even, since H.264 halves the colours"""
    title: str = ""
    """of a video"""
    character: Mesh | None = None
    """whom GLB and MP4 show, moved by the curves that its blendshapes are named like; our head by
    default"""
    view: View | Camera = "face"
    """from where a video shows it"""
    keys: float | None = None
    """in formats that keep curves between keys, as few keys as stay within this of every frame, in
    units of the control; None for one key a frame"""
    node: str = ""
    """the node of the scene that has the blendshapes: in Unity the path of the renderer, in Godot
    of the MeshInstance3D, in Maya the blendShape; by default as our GLB or Maya calls it"""
    onto: Path | None = None
    """the GLB or VRM of a character that a GLB is to animate"""
    progress: Callable[[int, int], None] | None = field(default=None, compare=False)
    """called with the video frames that are done and their number in all"""

    def __post_init__(self) -> None:
        """Check."""
        if self.keys is not None and not 0 < self.keys < math.inf:
            raise LipwrightError(
                f"keys within {self.keys} cannot be had; give a number above 0, such as 0.01"
            )
        if any(side % 2 or not 16 <= side <= MAX_SIDE for side in self.size):
            raise LipwrightError(
                f"a video of {self.size[0]} x {self.size[1]} pixels cannot be made; choose even "
                f"numbers from 16 to {MAX_SIDE}"
            )


@dataclass(frozen=True)
class Output:
    """One file that an exporter makes."""

    path: Path
    """where it will be"""
    write: Callable[[Path], None]
    """writes it to another path first"""


def check_rate(fps: float) -> None:
    """Refuse a frame rate that curves are not made at.

    Raises:
        LipwrightError: it is below `MIN_FPS` or above `MAX_FPS`.
    """
    if not MIN_FPS <= fps <= MAX_FPS:
        raise LipwrightError(f"fps is {fps:g}; give a number from {MIN_FPS:g} to {MAX_FPS:.0f}")


def rounded_rows(values: npt.NDArray[np.float32], decimals: int) -> Iterator[list[float]]:
    """The rows of (T, C), rounded, in blocks: an hour of them as a list would take a gigabyte."""
    for first in range(0, len(values), _BLOCK):
        block = values[first : first + _BLOCK].astype(np.float64).round(decimals) + 0.0  # no -0.0
        yield from block.tolist()


def text_output(path: Path, make_lines: Callable[[], Iterable[str]]) -> Output:
    """An output of UTF-8 text with Unix line ends, made line by line when it is written."""

    def write(part: Path) -> None:
        with part.open("w", encoding="utf-8", newline="") as file:
            file.writelines(make_lines())

    return Output(path, write)


def shown_character(path: Path, clip: Clip, options: ExportOptions) -> Mesh:
    """The character that a GLB or MP4 at `path` shows.

    Raises:
        LipwrightError: no head is installed, or the clip moves none of the character.
    """
    if options.character is None:
        from lipwright.face.head import load_head

        mesh: Mesh = load_head()
        whose, remedy = "the head's controls (ARKit's, such as jawOpen)", "the ARKit rig"
    else:
        mesh = options.character
        whose = f"the blendshapes of the {mesh.name} ({', '.join(mesh.shape_names[:4])}, ...)"
        remedy = "those"
    if not set(clip.names) & set(mesh.shape_names):
        raise LipwrightError(
            f"{path}: the curves have none of {whose}; "
            f"retarget them to {remedy} or export another format"
        )
    return mesh


def prepare_head(package: str) -> None:
    """Find out before long work whether the head, and the package that writes it, are there.

    Raises:
        LipwrightError: no head is installed.
        ImportError: the package is not installed.
    """
    from lipwright.face.head import load_head

    import_module(package)
    load_head()
