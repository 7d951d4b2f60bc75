"""Files are written whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lipwright.errors import LipwrightError


@contextmanager
def write_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A path beside `path` to write to; it takes the place of `path` when the block ends well.

    The part keeps the suffixes of `path`, since some writers choose their format by them.
    Whatever ends the block early, an error, Ctrl-C or a full disk, removes the part and leaves
    an older `path` as it was.

    Raises:
        LipwrightError: the target is a folder, or its folder is missing, full or read-only.
    """
    target = Path(path)
    if target.is_dir():
        raise LipwrightError(f"{target}: is a folder; name a file")
    part = target.with_name(f".{secrets.token_hex(4)}.part.{target.name}")
    try:
        yield part
        os.replace(part, target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise LipwrightError(f"{target}: cannot be written: {reason}") from error
    finally:
        with suppress(OSError):
            part.unlink()
