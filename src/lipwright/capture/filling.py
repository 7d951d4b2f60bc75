"""A recording's folder is there whole or not at all, and keeps what its user has put into it."""

from __future__ import annotations

import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from lipwright.dataset.recording import (
    AUDIO_FILE,
    FACE_FILE,
    INFO_FILE,
    MOTION_FILE,
    PHONES_FILE,
    PICTURE_FILE,
)
from lipwright.errors import LipwrightError

OURS: Final = (AUDIO_FILE, FACE_FILE, INFO_FILE, MOTION_FILE, PHONES_FILE, PICTURE_FILE)
"""files that are of a capture, and go when another takes its place"""
_MARKED: Final = re.compile(r"\.[0-9a-f]{8}\.(part|old)\.(.+)", re.DOTALL)


@contextmanager
def filled(folder: Path) -> Iterator[Path]:
    """A folder to fill, which takes the place of `folder` when the block ends well.

    Raises:
        LipwrightError: it cannot be written.
    """
    token = secrets.token_hex(4)
    part = folder.with_name(f".{token}.part.{folder.name}")
    old = folder.with_name(f".{token}.old.{folder.name}")
    try:
        part.mkdir(parents=True)
        yield part
        if folder.exists():
            folder.rename(old)
        part.rename(folder)
        _discard(old, folder)
    except OSError as error:
        raise LipwrightError(f"{folder}: cannot be written: {error.strerror or error}") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if old.exists() and not folder.exists():
            with suppress(OSError):  # the next run tries again
                old.rename(folder)


def sweep(recordings: Path) -> None:
    """Remove what killed runs were filling, and put back what they were about to replace.

    Raises:
        LipwrightError: it cannot be done.
    """
    try:
        for path in sorted(recordings.iterdir()):
            marked = _MARKED.fullmatch(path.name)
            if marked is None:
                continue
            folder = path.with_name(marked[2])
            if marked[1] == "part":
                shutil.rmtree(path, ignore_errors=True)
            elif folder.exists():
                _discard(path, folder)
            else:
                path.rename(folder)
    except OSError as error:
        raise LipwrightError(f"{recordings}: cannot be written: {error.strerror}") from error


def _discard(old: Path, folder: Path) -> None:
    """Remove the files of an earlier capture; others go to `folder`, where they were."""
    if old.is_symlink():
        old.unlink()
    if not old.is_dir():
        return
    for path in sorted(old.iterdir()):
        if path.name not in OURS and not (folder / path.name).exists():
            path.rename(folder / path.name)
    shutil.rmtree(old, ignore_errors=True)
