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
    an older `path` as it was. A link is followed: the file that it names is replaced.

    Raises:
        LipwrightError: the target is a folder, device or pipe, or its folder is missing, full or
            read-only.
    """
    target = Path(os.path.realpath(path))
    # The end of a long name, with its suffixes: four bytes a letter, the part's name fits in 255.
    part = target.with_name(f".{secrets.token_hex(4)}.part.{target.name[-60:]}")
    try:
        if target.is_dir():
            raise LipwrightError(f"{path}: is a folder; name a file")
        if os.path.exists(path) and not target.is_file():  # noqa: PTH110  # a link to a pipe too
            raise LipwrightError(f"{path}: is a device or pipe; name a file")
        yield part
        part.replace(target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise LipwrightError(f"{path}: cannot be written: {reason}") from error
    finally:
        with suppress(OSError):
            part.unlink()
