"""`Motion` and `Recording`: what a face did while it spoke, and the files that hold it."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from enum import IntFlag
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT
from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.formats import read_track
from lipwright.npz import BROKEN, reason_of
from lipwright.track import PhoneTrack

LANDMARKS: Final = 478  # points of the tracker's face mesh, irises included
ANGLES: Final = 9  # yaw, pitch and roll of the head, of the left and of the right eye

MOTION_FILE: Final = "motion.npz"
PHONES_FILE: Final = "phones.TextGrid"
AUDIO_FILE: Final = "audio.flac"
INFO_FILE: Final = "recording.json"
FACE_FILE: Final = "face.npz"
PICTURE_FILE: Final = "contact.jpg"

REMEDY: Final = "capture it again"

Array = npt.NDArray[np.float32]


class Flag(IntFlag):
    """What is odd about a frame."""

    LOST = 1
    """no face was found"""
    DROPPED = 2
    """the video has no frame there"""
    BLINK = 4
    """the eyes are shut"""
    CROWD = 8
    """a second face is in the picture"""


@dataclass(frozen=True, eq=False)
class Motion:
    """What a face did; frame i of T is at (i + 0.5) / fps s of the picture.

    Frames LOST or DROPPED are NaN in all arrays, and no other frame has a NaN.

    Raises:
        ValueError: shapes do not match, fps is not positive, or a NaN is out of place.
    """

    fps: float
    """frames a second"""
    flags: npt.NDArray[np.uint8]
    """(T,), bits of `Flag`"""
    arkit: Array
    """(T, 52), 0 to 1, in the order of `controls.ARKIT`"""
    landmarks: Array | None = None
    """(T, 478, 3), smoothed, without the head's pose: the origin midway between the eyes' centres,
    the unit their distance, x to the right in the picture, y down, z away from the camera"""
    head_pose: Array | None = None
    """(T, 3, 4), the head's place in the picture: pixels (x, y, z) = head_pose @ (landmark, 1)"""
    aperture: Array | None = None
    """(T,), mean distance of the inner-lip pairs in the picture over that of the eyes' centres"""
    aperture_raw: Array | None = None
    """(T,), the same before smoothing"""
    angles: Array | None = None
    """(T, 9), rad: yaw, pitch and roll of the head, of the left eye, of the right eye"""

    def __post_init__(self) -> None:
        """Check and freeze."""
        flags = np.array(self.flags, np.uint8)
        if flags.ndim != 1 or not len(flags):
            raise ValueError(f"flags have the shape {flags.shape}, not (T,) with frames")
        if not 0 < self.fps < np.inf:
            raise ValueError(f"fps is {self.fps}, not above 0")
        flags.setflags(write=False)
        object.__setattr__(self, "flags", flags)
        missing = ~self.valid
        for name, tail in _TAILS.items():
            value = getattr(self, name)
            if value is None and name != "arkit":
                continue
            array = np.array(value, np.float32)
            if array.shape != (len(flags), *tail):
                wanted = ", ".join(map(str, (len(flags), *tail)))
                raise ValueError(f"{name} has the shape {array.shape}, not ({wanted})")
            finite = np.asarray(np.isfinite(array.reshape(len(flags), -1)).all(axis=1))
            if not finite[~missing].all():
                frame = int(np.flatnonzero(~finite & ~missing)[0])
                raise ValueError(f"{name} is not finite at frame {frame}, which is not marked lost")
            array[missing] = np.nan
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        """The number of frames, T."""
        return len(self.flags)

    @property
    def valid(self) -> npt.NDArray[np.bool_]:
        """(T,), where a face was seen."""
        return (self.flags & (Flag.LOST | Flag.DROPPED)) == 0

    @property
    def duration(self) -> float:
        """s, all frames."""
        return len(self) / self.fps


_TAILS: Final[dict[str, tuple[int, ...]]] = {
    "arkit": (len(ARKIT),),
    "landmarks": (LANDMARKS, 3),
    "head_pose": (3, 4),
    "aperture": (),
    "aperture_raw": (),
    "angles": (ANGLES,),
}
"""array to its shape after T"""

LONGEST_WHOLE: Final = 16  # digits and sign that a number as float holds too
DECIMALS: Final = 5  # of eye distances and weights: a thousandth of a pixel in most videos


def save_motion(path: Path, motion: Motion) -> None:
    """Write `motion` as .npz; the same motion gives the same bytes.

    Raises:
        LipwrightError: the file cannot be written.
    """
    arrays = {name: getattr(motion, name) for name in _TAILS if getattr(motion, name) is not None}
    rounded = {
        name: array if name == "head_pose" else array.round(DECIMALS)
        for name, array in arrays.items()
    }
    with write_whole(path) as part:
        np.savez_compressed(part, fps=motion.fps, flags=motion.flags, **rounded)


def load_motion(path: Path) -> Motion:
    """The motion of a file that `save_motion` wrote.

    Raises:
        LipwrightError: the file is missing or broken.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in _TAILS if name in stored.files}
            return Motion(float(stored["fps"]), stored["flags"], **arrays)
    except FileNotFoundError as error:
        raise LipwrightError(f"{path}: no such file; {REMEDY}") from error
    except BROKEN as error:
        raise LipwrightError(
            f"{path}: not a readable motion ({reason_of(error)}); {REMEDY}"
        ) from error


@dataclass(frozen=True, eq=False)
class Recording:
    """One recording of a dataset."""

    name: str
    motion: Motion
    track: PhoneTrack
    offset: float
    """s, by how much the picture is late against the sound; 0 where nobody could tell"""
    info: dict[str, Any]
    """recording.json, as docs/dataset.md describes it"""
    folder: Path
    start: float = 0.0
    """s, when the picture begins on the clock of the sound"""

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """(T,), s, the middle of each frame on the clock of the sound."""
        frames = np.arange(len(self.motion), dtype=np.float64)
        return (frames + 0.5) / self.motion.fps + self.start - self.offset

    @property
    def valid(self) -> npt.NDArray[np.bool_]:
        """(T,), where a face was seen."""
        return self.motion.valid

    @property
    def audio(self) -> Path | None:
        """The sound."""
        path = self.folder / AUDIO_FILE
        return path if path.is_file() else None

    def face(self) -> dict[str, npt.NDArray[Any]] | None:
        """The parameters of the reference face by name, each (T, ...); None before `face fit`.

        Raises:
            LipwrightError: the file is broken.
        """
        path = self.folder / FACE_FILE
        if not path.is_file():
            return None
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
                return {name: stored[name] for name in stored.files}
        except BROKEN as error:
            raise LipwrightError(f"{path}: not readable; run: lipwright face fit") from error


def read_info(folder: Path) -> dict[str, Any]:
    """The recording.json of a recording's folder.

    Raises:
        LipwrightError: it is missing or not what `capture` writes.
    """
    path = folder / INFO_FILE
    try:
        info = from_json(path.read_text("utf-8"))
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be read: {error.strerror}; {REMEDY}") from error
    except (ValueError, RecursionError) as error:
        raise LipwrightError(f"{path}: not JSON ({error}); {REMEDY}") from error
    if not isinstance(info, dict) or not isinstance(info.get("name"), str):
        raise LipwrightError(f"{path}: has no name of a recording; {REMEDY}")
    return info


def read_recording(folder: Path) -> Recording:
    """A recording out of its folder.

    Raises:
        LipwrightError: a file is missing or broken.
    """
    info = read_info(folder)
    offset: Any = info.get("offset")
    is_trusted = isinstance(offset, dict) and offset.get("trusted") is True
    return Recording(
        name=info["name"],
        motion=load_motion(folder / MOTION_FILE),
        track=read_track(folder / PHONES_FILE),
        offset=_seconds(folder, offset, "seconds") if is_trusted else 0.0,
        info=info,
        folder=folder,
        start=_seconds(folder, info, "start"),
    )


def _seconds(folder: Path, values: dict[str, Any], key: str) -> float:
    seconds = values.get(key, 0.0)
    if isinstance(seconds, bool) or not isinstance(seconds, int | float):
        raise LipwrightError(f"{folder / INFO_FILE}: {key!r} is not a number of s; {REMEDY}")
    return float(seconds)


def from_json(text: str) -> Any:
    """What JSON text says; unlike `json.loads`, no endless numbers and no NaN.

    Raises:
        ValueError: it is not JSON.
        RecursionError: it is nested too deeply.
    """
    return json.loads(text, parse_constant=_finite, parse_float=_finite, parse_int=_whole)


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is not a finite number")
    return value


def _whole(text: str) -> int:
    if len(text) > LONGEST_WHOLE:
        raise ValueError(f"{text[:LONGEST_WHOLE]}... is too large a number")
    return int(text)


def to_json(value: Any) -> str:
    """`value` as the JSON files of a dataset are written: the same value, the same text."""
    text = json.dumps(value, ensure_ascii=False, indent=1, allow_nan=False) + "\n"
    # Names of files that are not UTF-8: a backslash and `u` is how JSON writes them too.
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def write_info(folder: Path, info: dict[str, Any]) -> None:
    """Write recording.json.

    Raises:
        LipwrightError: it cannot be written.
    """
    with write_whole(folder / INFO_FILE) as part:
        part.write_text(to_json(info), "utf-8")


_UNSAFE: Final = frozenset('/\\:*?"<>|')  # in the names of files, on one system or another
LONGEST_NAME: Final = 200  # bytes; parts of files add a few


def safe_name(text: str) -> str:
    """`text` as the name of a recording: what no file's name may have becomes `_`."""
    allowed = "".join(c if c.isprintable() and c not in _UNSAFE else "_" for c in text)
    cut = allowed.encode("utf-8", "replace")[:LONGEST_NAME].decode("utf-8", "ignore").strip(" .")
    return cut or "_"


def is_safe_name(name: object) -> bool:
    """Whether `name` can name a recording: it stays in its folder on every system."""
    return (
        isinstance(name, str)
        and 0 < len(name.encode("utf-8", "replace")) <= LONGEST_NAME
        and name == name.strip(" .")
        and not set(name) & _UNSAFE
        and name.isprintable()
        and os.path.basename(name) == name  # noqa: PTH119  # of any text, not of a path
    )
