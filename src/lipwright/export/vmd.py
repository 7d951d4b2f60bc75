"""Motions of MikuMikuDance, `.vmd`, little-endian binary at 30 frames a second.

There is no published specification; the layout is what MikuMikuDance's users found and its other
readers share (MMD wiki, "VMD file format"; documentation of babylon-mmd). 30 bytes `Vocaloid Motion
Data 0002`, 20 of the model's name; a count and 111 bytes a bone key (name of 15 bytes, frame,
position, rotation as a quaternion, 64 bytes of its curve); a count and 23 bytes a morph key (name
of 15 bytes, frame, weight as a 4-byte float); then counts of keys of camera, light, shadow and
switches, which are 0. Names are Shift-JIS. A turn of the head turns the bone of that name; bones of
the rig are left out.

Weights are joined by straight lines, so that a key is left out where its neighbours say the same,
to within 0.0001 or what the options allow. Frames of clips at other rates fall between ours, which
are nearest: half a frame is 17 ms.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip
from lipwright.controls import HEAD_ANGLES
from lipwright.errors import LipwrightError
from lipwright.export.bonemotion import shape_names
from lipwright.export.performance import ExportOptions, Output, Performance
from lipwright.face.turning import head_quaternions, head_turns

Floats = npt.NDArray[np.float64]

FPS: Final = 30.0
SIGNATURE: Final = b"Vocaloid Motion Data 0002"
MODEL: Final = b"Lipwright"  # whose motion it is; MikuMikuDance asks before another model moves
NAME_BYTES: Final = 15
ENCODING: Final = "cp932"  # Microsoft's Shift-JIS
HEAD_BONE: Final = "頭"
SMALLEST: Final = 1e-4  # of a weight; less is not seen
EASE: Final = bytes([20] * 8 + [107] * 8)  # handles of a straight line, out of 127
CURVE: Final = b"".join(EASE[shift:] + bytes(shift) for shift in range(4))
SECTIONS_AFTER: Final = 4  # camera, light, shadow, switches

MORPH: Final = np.dtype([("name", f"S{NAME_BYTES}"), ("frame", "<u4"), ("weight", "<f4")])
BONE: Final = np.dtype([
    ("name", f"S{NAME_BYTES}"), ("frame", "<u4"), ("at", "<f4", 3), ("turn", "<f4", 4),
    ("curve", "V64"),
])  # fmt: skip


def outputs(path: Path, performance: Performance, options: ExportOptions) -> list[Output]:
    """The one file.

    Raises:
        LipwrightError: a control's name does not fit into 15 bytes of Shift-JIS, or all are bones.
    """
    clip = performance.clip
    names = {name: _encoded(path, name) for name in shape_names(performance)}
    if not names and not set(clip.names) & set(HEAD_ANGLES):
        raise LipwrightError(
            f"{path}: the curves move bones alone, and it holds morphs; retarget to the rig mmd"
        )
    error = SMALLEST if options.keys is None else options.keys
    return [Output(path, lambda part: _write(part, clip, names, error))]


def _encoded(path: Path, name: str) -> bytes:
    try:
        encoded = name.encode(ENCODING)
    except UnicodeEncodeError:
        encoded = b""
    if not 0 < len(encoded) <= NAME_BYTES:
        raise LipwrightError(
            f"{path}: the control {name!r} does not fit into {NAME_BYTES} bytes of Shift-JIS, as "
            "MikuMikuDance's morphs must; retarget to the rig mmd"
        )
    return encoded


def _write(part: Path, clip: Clip, names: dict[str, bytes], error: float) -> None:
    motion = clip if clip.fps == FPS else clip.resample(FPS)
    morphs = [_morph_keys(motion, name, encoded, error) for name, encoded in names.items()]
    bones = _head_keys(motion)
    with part.open("wb") as file:
        file.write(SIGNATURE.ljust(30, b"\0") + MODEL.ljust(20, b"\0"))
        file.write(struct.pack("<I", len(bones)) + bones.tobytes())
        file.write(struct.pack("<I", sum(map(len, morphs))))
        for keys in morphs:
            file.write(keys.tobytes())
        file.write(bytes(4 * SECTIONS_AFTER))


def _morph_keys(motion: Clip, name: str, encoded: bytes, error: float) -> npt.NDArray[np.void]:
    values = motion.curve(name).astype(np.float64)
    frames = line_keys(values, error)
    keys = np.zeros(len(frames), MORPH)
    keys["name"], keys["frame"], keys["weight"] = encoded, frames, values[frames]
    return keys


def _head_keys(motion: Clip) -> npt.NDArray[np.void]:
    """Every frame of a turning head; in MikuMikuDance z points to its back."""
    angles = head_turns(motion)
    if angles is None or not angles.any():
        return np.zeros(0, BONE)
    keys = np.zeros(len(angles), BONE)
    keys["name"], keys["frame"] = HEAD_BONE.encode(ENCODING), np.arange(len(angles))
    keys["turn"] = head_quaternions(angles) * [-1, -1, 1, 1]
    keys["curve"] = np.void(CURVE)
    return keys


def line_keys(values: Floats, error: float) -> list[int]:
    """The frames of keys whose straight lines stay within `error` of `values` (T,).

    From each key the longest line that does; a control that never changes gets one key.
    """
    if np.ptp(values) == 0:
        return [0]
    points = values.tolist()
    keys, low, high = [0], -np.inf, np.inf
    start, base = 0, points[0]
    for frame in range(1, len(points)):
        slope = (points[frame] - base) / (frame - start)
        if not low <= slope <= high:
            start, base = frame - 1, points[frame - 1]
            keys.append(start)
            low, high = -np.inf, np.inf
            slope = points[frame] - base
        reach = error / (frame - start)
        low, high = max(low, slope - reach), min(high, slope + reach)
    return [*keys, len(points) - 1]
