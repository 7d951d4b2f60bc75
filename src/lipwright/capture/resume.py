"""Whether a recording is captured already: what it depends on, and what its user has edited."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from lipwright.capture.sources import Source
from lipwright.capture.tracker import TRACKERS
from lipwright.dataset.folder import sha256_of
from lipwright.dataset.recording import INFO_FILE, PHONES_FILE, read_info, to_json
from lipwright.errors import LipwrightError
from lipwright.face.head import HEAD_FORMAT
from lipwright.formats import read_track
from lipwright.track import PhoneTrack
from lipwright.version import VERSION

if TYPE_CHECKING:
    from lipwright.capture.job import CaptureOptions

LAYOUT: Final = 1  # raise when what is captured of the same files changes


def key_of(source: Source, options: CaptureOptions, hashes: Mapping[str, str]) -> str:
    """What the captured files depend on, as a hash."""
    inputs: dict[str, Any] = {"layout": LAYOUT, "lipwright": VERSION, "text": source.text}
    inputs |= hashes
    inputs |= options.shaping()
    inputs["head"] = HEAD_FORMAT
    if source.is_video:
        inputs["tracker_version"] = TRACKERS[options.tracker].version()
    return hashlib.sha256(to_json(inputs).encode()).hexdigest()


def files_of(source: Source) -> dict[str, Path]:
    """Role to file: `video` or `arkit`, `audio`, `phones`."""
    roles = {
        "video" if source.is_video else "arkit": source.face,
        "audio": source.audio, "phones": source.phones,
    }  # fmt: skip
    return {role: file for role, file in roles.items() if file is not None}


def finished(folder: Path, key: str) -> dict[str, Any] | None:
    """The recording.json of a folder that holds all that this capture would give.

    Phones that were corrected since are not what it would give: all that follows from them.
    """
    if not (folder / INFO_FILE).is_file():
        return None
    try:
        info = read_info(folder)
    except LipwrightError:
        return None
    files = info.get("files")
    if info.get("key") != key or not isinstance(files, dict):
        return None
    whole = all((folder / file).is_file() for file in files) and all(
        sha256_of(folder / file) == digest for file, digest in files.items()
    )
    return info if whole else None


def edited_phones(folder: Path) -> PhoneTrack | None:
    """The phones of an earlier capture that somebody has corrected since; None without any.

    Where nothing tells whether they were corrected, they are taken for it.

    Raises:
        LipwrightError: they cannot be read.
    """
    path = folder / PHONES_FILE
    if not path.is_file():
        return None
    try:
        info = read_info(folder)
    except LipwrightError:
        info = {}
    files = info.get("files")
    known = files.get(PHONES_FILE) if isinstance(files, dict) else None
    if known == sha256_of(path) and info.get("edited_phones") is not True:
        return None
    try:
        return read_track(path)
    except LipwrightError as error:
        raise LipwrightError(f"{error}; or delete the file to align again") from error
