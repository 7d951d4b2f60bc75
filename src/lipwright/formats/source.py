"""The text of a file that others wrote, and where in it something is."""

from __future__ import annotations

import codecs
import math
import os
from pathlib import Path

from lipwright.errors import LipwrightError

MAX_BYTES = 256 * 1024 * 1024  # two hours of curves at 60 frames a second, a month of phones
MAX_SECONDS = 1e6  # eleven days; a later time is a slip of the pen

_BOMS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """The bytes of a file of labels or curves.

    Raises:
        LipwrightError: it is missing, a folder, unreadable or too large to be such a file.
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise LipwrightError(f"{path}: no such file; check its name") from None
    except IsADirectoryError:
        raise LipwrightError(f"{path}: is a folder; name a file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(f"{path}: cannot be read: {reason}") from error
    if len(content) > MAX_BYTES:
        raise LipwrightError(
            f"{path}: larger than {MAX_BYTES // 2**20} MB, no such file; name another"
        )
    return content


def decode_text(path: str | os.PathLike[str], content: bytes) -> str:
    """The text of UTF-8, with or without a byte order mark, or of UTF-16 with one.

    Raises:
        LipwrightError: the bytes are not such text; names the first one that is wrong.
    """
    mark, encoding = next(
        ((bom, name) for bom, name in _BOMS if content.startswith(bom)), (b"", "utf-8")
    )
    try:
        text = content[len(mark) :].decode(encoding)
    except UnicodeDecodeError as error:
        raise LipwrightError(
            f"{path}: byte {error.start + len(mark)}: not {encoding.upper()} text; save the file "
            "as UTF-8"
        ) from None
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise LipwrightError(f"{path}: line {line}: binary data, not text; save the file as UTF-8")
    return text


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a file; see `read_bytes` and `decode_text`."""
    return decode_text(path, read_bytes(path))


def text_lines(text: str) -> list[str]:
    """The lines of a text, whatever ends them: Unix, Windows or old Macintosh."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def parse_number(path: str | os.PathLike[str], place: str, what: str, text: str) -> float:
    """A finite number out of `text`.

    Raises:
        LipwrightError: it is none; names `place` and `what` it should be.
    """
    try:
        # float() takes 1_000 and digits of every script; label files mean neither.
        number = float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise LipwrightError(f"{path}: {place}: {what} is {text[:24]!r}, not a number; correct it")
    return number
