"""What goes wrong when an .npz file is damaged."""

from __future__ import annotations

import lzma
import struct
import zipfile
import zlib
from typing import Final

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
