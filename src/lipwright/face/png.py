"""PNG files of RGB pictures."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lipwright.files import write_whole


def encode_png(pixels: NDArray[np.uint8]) -> bytes:
    """The bytes of a PNG file of `pixels` (H, W, 3).

    Raises:
        ValueError: `pixels` are not 8-bit RGB.
    """
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8 or not pixels.size:
        raise ValueError(f"pixels are {pixels.shape} {pixels.dtype}, not (H, W, 3) uint8")
    height, width, _ = pixels.shape
    # Each row less the one above it ("Up", filter type 2) compresses well and is one subtraction.
    rows = np.diff(pixels.reshape(height, -1), axis=0, prepend=np.zeros((1, width * 3), np.uint8))
    filtered = np.hstack([np.full((height, 1), 2, np.uint8), rows])
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            _chunk(b"IHDR", header),
            _chunk(b"sRGB", b"\0"),
            _chunk(b"IDAT", zlib.compress(filtered.tobytes(), 6)),
            _chunk(b"IEND", b""),
        ]
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    checksum = zlib.crc32(kind + data)
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum)


def write_png(path: str | Path, pixels: NDArray[np.uint8]) -> None:
    """Write `pixels` (H, W, 3) to `path`, whole or not at all.

    Raises:
        ValueError: `pixels` are not 8-bit RGB.
        LipwrightError: the file cannot be written.
    """
    data = encode_png(pixels)
    with write_whole(path) as part:
        part.write_bytes(data)
