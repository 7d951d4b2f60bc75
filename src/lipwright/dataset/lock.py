"""Only one program at a time writes to a dataset, a model or a search."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Final

from lipwright.lock import held

LOCK_FILE: Final = ".lock"


def locked(path: Path, what: str = "dataset") -> AbstractContextManager[None]:
    """Hold the lock of the folder `path`, a `what`; the system drops it with the process.

    Raises:
        LipwrightError: another program holds it, or the folder cannot be written to.
    """
    return held(
        path / LOCK_FILE,
        f"{path}: cannot be written",
        f"{path}: another program is writing to this {what}; wait for its end",
    )
