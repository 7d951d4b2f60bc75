"""PC2 point caches: where every vertex of a mesh is at every frame, for meshes without a rig.

A header of 32 bytes, then (T, V, 3) float32, all little-endian: `POINTCACHE2` and a zero byte,
int32 version 1, int32 V, float32 first frame, float32 frames a sample, int32 T (Footools' Point
Cache 2, description of the PC2 format). Blender's Mesh Cache modifier, 3ds Max and Houdini read it
onto a mesh with the same vertices in the same order.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

SUFFIX: Final = ".pc2"
HEADER: Final = struct.Struct("<12siiffi")


def write_point_cache(
    path: Path, poses: Iterable[NDArray[np.floating]], frames: int, vertices: int
) -> None:
    """Write `frames` poses (V, 3), one after another, to `path` as it stands."""
    with path.open("wb") as file:
        file.write(HEADER.pack(b"POINTCACHE2\0", 1, vertices, 0.0, 1.0, frames))
        for pose in poses:
            file.write(np.asarray(pose, "<f4").tobytes())
