"""Data that a `.gltf` names: `data:` URIs, and files in its own folder."""

from __future__ import annotations

import base64
import binascii
import os
import re
from pathlib import Path
from typing import Final
from urllib.parse import unquote

from lipwright.errors import LipwrightError

_DATA: Final = re.compile(r"data:([\w.+-]*/?[\w.+-]*)(?:;[^,;]*)*;base64,")


def read_buffer(path: Path, what: str, uri: object, largest: int) -> bytes:
    """The bytes behind a URI of a glTF file.

    Args:
        path: the file.
        what: what they are, for errors: `buffer 0`.
        uri: as the file has it.
        largest: bytes at the most.

    Raises:
        LipwrightError: it is neither base64 data nor a file in the folder of `path`, or too large.
    """
    if not isinstance(uri, str):
        raise LipwrightError(f"{path}: {what}: its URI is no text; export it again as GLB")
    if uri.startswith("data:"):
        head = _DATA.match(uri[:200])
        if head is None:
            raise LipwrightError(f"{path}: {what}: its data is not base64; export it again as GLB")
        try:
            return base64.b64decode(uri[head.end() :], validate=True)
        except (binascii.Error, ValueError):
            raise LipwrightError(
                f"{path}: {what}: its base64 data is broken; export it again as GLB"
            ) from None
    place = contained(path, what, uri)
    try:
        if place.stat().st_size > largest:
            raise LipwrightError(f"{path}: {what}: {uri[:80]!r} is too large; name another file")
        return place.read_bytes()
    except OSError as error:
        raise LipwrightError(
            f"{path}: {what}: {uri[:80]!r} cannot be read: {error.strerror}; put it beside "
            f"{path.name}"
        ) from None


def contained(path: Path, what: str, uri: str) -> Path:
    """The file that a relative URI names, in the folder of `path` or below.

    Raises:
        LipwrightError: it is elsewhere, no file, or missing.
    """
    name = unquote(uri)
    folder = Path(os.path.realpath(path.parent))
    place = None
    if name and not re.search(r"[\0-\x1f\\:]|^/|^~", name) and len(name) < 1024:
        place = Path(os.path.realpath(folder / name))  # links are followed
    if place is None or not place.is_relative_to(folder):
        raise LipwrightError(
            f"{path}: {what} is at {uri[:80]!r}, outside its own folder; export it again as GLB"
        )
    if not place.is_file():
        raise LipwrightError(f"{path}: {what}: {uri[:80]!r} is not there; put it beside it")
    return place


def data_type(uri: str) -> str:
    """The media type of a `data:` URI; empty where it says none."""
    head = _DATA.match(uri[:200])
    return head[1] if head else ""
