"""Only one program at a time writes to a dataset, a model or a search."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError

LOCK_FILE: Final = ".lock"


@contextmanager
def locked(path: Path, what: str = "dataset") -> Iterator[None]:
    """Hold the lock of the folder `path`, a `what`; the system drops it with the process.

    Raises:
        LipwrightError: another program holds it, or the folder cannot be written to.
    """
    try:
        import fcntl
    except ImportError:  # a system without such locks
        yield
        return
    try:
        # A dataset from elsewhere may have a link there, to a file that is not ours.
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW
        file = os.fdopen(os.open(path / LOCK_FILE, flags, 0o666), "r+")
    except OSError as error:
        raise LipwrightError(f"{path}: cannot be written: {error.strerror}") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise LipwrightError(
                f"{path}: another program is writing to this {what}; wait for its end"
            ) from error
        yield
