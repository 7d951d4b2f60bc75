"""Only one program at a time does a thing: a lock on a file, which goes with the process."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lipwright.errors import LipwrightError


@contextmanager
def held(place: Path, unwritable: str, taken: str) -> Iterator[None]:
    """Hold the lock of the file `place`, which is made where it is missing.

    Args:
        place: of the lock.
        unwritable: what to say where it cannot be made; the reason is put behind it.
        taken: what to say where another program holds it.

    Raises:
        LipwrightError: one of both.
    """
    try:
        import fcntl
    except ImportError:  # a system without such locks
        yield
        return
    try:
        # A folder from elsewhere may have a link there, to a file that is not ours.
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW
        file = os.fdopen(os.open(place, flags, 0o666), "r+")
    except OSError as error:
        raise LipwrightError(f"{unwritable}: {error.strerror}") from error
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise LipwrightError(taken) from error
        yield
