"""Arrays of .npz files that come from strangers, and what goes wrong when one is damaged."""

from __future__ import annotations

import io
import lzma
import struct
import zipfile
import zlib
from typing import Any, Final

import numpy as np
import numpy.typing as npt

MOST: Final = 2**31 - 1  # bytes unpacked; a small file can promise a thousand times its size

BROKEN: Final = (
    OSError, ValueError, KeyError, IndexError, TypeError, AttributeError, EOFError, OverflowError,
    MemoryError,  # a header that promises a huge array
    RuntimeError,  # an encrypted member, a method that nobody knows
    struct.error, zipfile.BadZipFile, zlib.error, lzma.LZMAError,
)  # fmt: skip
"""what reading the arrays of a damaged archive may raise"""


def reason_of(error: BaseException) -> str:
    """What is wrong, as one short line."""
    return " ".join(str(error).split())[:160] or type(error).__name__


def read_arrays(content: bytes) -> dict[str, npt.NDArray[Any]]:
    """The arrays of an archive by name; nothing is unpickled.

    Raises:
        BROKEN: it is damaged, holds objects, or would unpack to more than MOST bytes.
    """
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        size = sum(member.file_size for member in archive.infolist())
    if size > MOST:
        raise ValueError(f"unpacks to {size / 1e9:.1f} GB")
    with np.load(io.BytesIO(content), allow_pickle=False) as stored:
        return {name: np.asarray(stored[name]) for name in stored.files}
