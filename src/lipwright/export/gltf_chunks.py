"""The bytes of a GLB: its header, its chunks, and the document in the first of them.

glTF 2.0 (ISO/IEC 12113:2022), section 4.4.
"""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path
from typing import Final

from lipwright.errors import LipwrightError
from lipwright.export.gltf_store import BINARY_CHUNK, JSON_CHUNK, Json

MAX_BYTES: Final = 2**30  # of a file; characters with all textures have some hundred megabytes
MAX_JSON: Final = 2**27
REMEDY: Final = "export it again as glTF 2.0"


def read_content(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        LipwrightError: it cannot be read, or is too large.
    """
    try:
        if path.exists() and not path.is_file():
            raise LipwrightError(f"{path}: is a folder, device or pipe; name a GLB")
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise LipwrightError(f"{path}: larger than {MAX_BYTES // 2**20} MB; name another file")
        return path.read_bytes()
    except FileNotFoundError:
        raise LipwrightError(f"{path}: no such file; check its name") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LipwrightError(f"{path}: cannot be read: {reason}; name another file") from error


def chunks(path: Path, content: memoryview) -> tuple[memoryview, memoryview | None, memoryview]:
    """The JSON, the binary chunk and what follows it, of a GLB.

    Raises:
        LipwrightError: it is of another version, cut off, or does not start with JSON.
    """
    if len(content) < 20:
        raise LipwrightError(f"{path}: is cut off after {len(content)} bytes; copy it again")
    _, version, length = struct.unpack_from("<III", content)
    if version != 2:
        raise LipwrightError(f"{path}: is a GLB of version {version}, not 2; {REMEDY}")
    if length > len(content):
        raise LipwrightError(
            f"{path}: is cut off after {len(content)} of {length} bytes; copy it again"
        )
    content = content[:length]
    text, place = _chunk(path, content, 12, JSON_CHUNK)
    if text is None:
        raise LipwrightError(f"{path}: its first chunk is not JSON; {REMEDY}")
    binary, place = _chunk(path, content, place, BINARY_CHUNK)
    return text, binary, content[place:]


def _chunk(path: Path, content: memoryview, place: int, kind: int) -> tuple[memoryview | None, int]:
    """The chunk at `place` if it is of a kind, and the place after it."""
    if place + 8 > len(content):
        return None, place
    length, found = struct.unpack_from("<II", content, place)
    if place + 8 + length > len(content):
        raise LipwrightError(f"{path}: a chunk reaches beyond the file's end; copy it again")
    if found != kind:
        return None, place
    return content[place + 8 : place + 8 + length], place + 8 + length


def parse(path: Path, text: bytes) -> Json:
    """The document of its JSON.

    Raises:
        LipwrightError: it is broken, or of another version of glTF.
    """
    if len(text) > MAX_JSON:
        raise LipwrightError(f"{path}: more than {MAX_JSON // 2**20} MB of JSON; {REMEDY}")
    try:
        document = json.loads(
            text.decode("utf-8-sig").rstrip("\0"), parse_constant=_finite, parse_float=_finite
        )
    except (ValueError, RecursionError) as error:
        reason = str(error)[:80] or "too deep"
        raise LipwrightError(f"{path}: its JSON is broken: {reason}; {REMEDY}") from None
    if not isinstance(document, dict):
        raise LipwrightError(f"{path}: its JSON is no object; {REMEDY}")
    asset = document.get("asset")
    asset = asset if isinstance(asset, dict) else {}
    version = str(asset.get("minVersion", asset.get("version", "")))
    if not str(asset.get("version", "")).startswith("2.") or version > "2.0":
        raise LipwrightError(f"{path}: is of glTF {version[:8]!r}, not 2.0; {REMEDY}")
    return document


def _finite(text: str) -> float:
    number = float(text)
    if not abs(number) < math.inf:
        raise ValueError(f"{text[:24]} is no number")
    return number
