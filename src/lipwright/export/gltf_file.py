"""`GltfFile`: a GLB, VRM or `.gltf` that others made, checked before it is used.

glTF 2.0 (ISO/IEC 12113:2022), sections 3.6 (accessors) and 4 (GLB). Nothing in the file is trusted:
indices, ranges, sizes and types are checked before memory is taken, and buffers are read only from
the file's own folder.
"""

from __future__ import annotations

import os
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, NoReturn, TypeGuard

import numpy as np
import numpy.typing as npt

from lipwright.errors import LipwrightError
from lipwright.export.gltf_buffers import read_buffer
from lipwright.export.gltf_chunks import MAX_BYTES, REMEDY, chunks, parse, read_content
from lipwright.export.gltf_store import MAGIC, Json

MAX_NUMBERS: Final = 2**27  # of one accessor, a gigabyte as float64

TYPES: Final = {
    5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32,
    5126: np.float32,
}  # fmt: skip
SIZES: Final = {
    "SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A document and its buffers."""

    path: Path
    document: Json
    buffers: tuple[bytes | memoryview | None, ...]
    """None where an extension provides the data"""
    other_chunks: bytes | memoryview = b""
    """what follows the binary chunk of a GLB"""
    _lists: dict[str, list[Json]] = field(default_factory=dict, repr=False)

    def fail(self, what: str) -> NoReturn:
        """Refuse the file.

        Raises:
            LipwrightError: always.
        """
        raise LipwrightError(f"{self.path}: {what}; {REMEDY}")

    def tables(self, key: str, holder: Json | None = None, where: str = "") -> list[Json]:
        """A list of objects, of the document or of `holder`; empty where there is none."""
        if holder is None and key in self._lists:
            return self._lists[key]
        items = (self.document if holder is None else holder).get(key, [])
        if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
            self.fail(f"{where}{key!r} is not a list of objects")
        if holder is None:
            self._lists[key] = items
        return items

    def table(self, key: str, holder: Json | None = None) -> Json:
        """An object, of the document or of `holder`; empty where there is none, or another value.

        Raises nothing, since `extras` may be anything.
        """
        found = (self.document if holder is None else holder).get(key)
        return found if isinstance(found, dict) else {}

    def index(self, holder: Json, key: str, count: int, where: str) -> int:
        """A whole number from 0 to `count` - 1."""
        value = holder.get(key)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < count:
            self.fail(f"{where}: {key!r} is {str(value)[:24]!r}, not one of {count}")
        return value

    def whole(self, holder: Json, key: str, where: str, default: int | None = None) -> int:
        """A whole number from 0 on."""
        value = holder.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            self.fail(f"{where}: {key!r} is {str(value)[:24]!r}, not a whole number")
        return value

    def numbers(self, holder: Json, key: str, default: list[float], where: str) -> list[float]:
        """As many finite numbers as `default` has."""
        values = holder.get(key, default)
        if (
            not isinstance(values, list)
            or len(values) != len(default)
            or not all(is_number(value) for value in values)
        ):
            self.fail(f"{where}: {key!r} is not {len(default)} numbers")
        return [float(value) for value in values]

    def name(self, holder: Json) -> str:
        """The name of an item; empty where it has none."""
        name = holder.get("name")
        return name if isinstance(name, str) else ""

    def accessor(self, number: int, where: str) -> npt.NDArray[np.float64]:
        """(count, size), the values of an accessor; normalised integers as what they stand for."""
        accessors = self.tables("accessors")
        if not 0 <= number < len(accessors):
            self.fail(f"{where}: there is no accessor {number}")
        item, place = accessors[number], f"accessor {number}"
        kind, size, count = self._layout(item, place)
        if count * size > MAX_NUMBERS:
            self.fail(f"{place} has {count} values, which no animation has")
        values = np.zeros((count, size), kind)
        if "bufferView" in item:
            offset = self.whole(item, "byteOffset", place, 0)
            values = self._values(item["bufferView"], offset, kind, size, count, place)
        if "sparse" in item:
            values = values.copy()
            self._replace(values, self.table("sparse", item), place)
        if item.get("normalized") is True and kind is not np.float32:
            info = np.iinfo(kind)
            return np.asarray(np.maximum(values / info.max, -1.0 if info.min < 0 else 0.0))
        return values.astype(np.float64)

    def _replace(self, values: npt.NDArray[Any], sparse: Json, place: str) -> None:
        """Put a sparse accessor's few values in."""
        count = self.whole(sparse, "count", place)
        indices, deltas = self.table("indices", sparse), self.table("values", sparse)
        kind = TYPES.get(self.whole(indices, "componentType", place))
        if kind not in {np.uint8, np.uint16, np.uint32}:
            self.fail(f"{place}: its sparse indices are no whole numbers")
        places = self._values(
            indices.get("bufferView"), self.whole(indices, "byteOffset", place, 0), kind, 1, count,
            place,
        )[:, 0]  # fmt: skip
        if len(places) and int(places.max()) >= len(values):
            self.fail(f"{place}: a sparse index is beyond its {len(values)} values")
        offset = self.whole(deltas, "byteOffset", place, 0)
        values[places] = self._values(
            deltas.get("bufferView"), offset, values.dtype.type, values.shape[1], count, place
        )

    def _layout(self, item: Json, place: str) -> tuple[Any, int, int]:
        """Component type, numbers a value and values of an accessor."""
        kind = TYPES.get(self.whole(item, "componentType", place))
        size = SIZES.get(str(item.get("type")))
        if kind is None or size is None:
            self.fail(f"{place}: its type is unknown")
        return kind, size, self.whole(item, "count", place)

    def _values(
        self, view: Any, offset: int, kind: Any, size: int, count: int, place: str
    ) -> npt.NDArray[Any]:
        """(count, size), out of a buffer view."""
        start, length, stride, buffer = self._view(view, place)
        width = np.dtype(kind).itemsize * size
        stride = stride or width
        if count == 0:
            return np.zeros((0, size), kind)
        if stride < width or offset + stride * (count - 1) + width > length:
            self.fail(f"{place} reaches beyond its buffer view")
        content = self.buffers[buffer]
        if content is None:
            self.fail(f"{place}: its data is compressed by an extension that is not read")
        block = np.frombuffer(content, np.uint8)[start + offset :]
        rows = np.lib.stride_tricks.as_strided(block, (count, width), (stride, 1), writeable=False)
        return np.ascontiguousarray(rows).view(np.dtype(kind).newbyteorder("<"))

    def _view(self, number: Any, place: str) -> tuple[int, int, int, int]:
        """Start and length in bytes, stride (0: packed) and buffer of a buffer view."""
        views = self.tables("bufferViews")
        view = views[self.index({"bufferView": number}, "bufferView", len(views), place)]
        where = f"buffer view {number}"
        buffers = self.tables("buffers")
        buffer = self.index(view, "buffer", len(buffers), where)
        start = self.whole(view, "byteOffset", where, 0)
        length = self.whole(view, "byteLength", where)
        if start + length > self.whole(buffers[buffer], "byteLength", f"buffer {buffer}"):
            self.fail(f"{where} reaches beyond its buffer")
        return start, length, self.whole(view, "byteStride", where, 0), buffer

    def check_data(self) -> None:
        """Refuse buffer views that leave their buffers and accessors that leave their views."""
        for number in range(len(self.tables("bufferViews"))):
            self._view(number, f"buffer view {number}")
        for number, item in enumerate(self.tables("accessors")):
            place = f"accessor {number}"
            kind, size, count = self._layout(item, place)
            if "bufferView" in item and count:
                _, length, stride, _ = self._view(item["bufferView"], place)
                width = np.dtype(kind).itemsize * size
                last = self.whole(item, "byteOffset", place, 0) + (stride or width) * (count - 1)
                if last + width > length:
                    self.fail(f"{place} reaches beyond its buffer view")


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value out of JSON is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e30


def read_gltf(path: str | os.PathLike[str]) -> GltfFile:
    """The document and the buffers of a `.glb`, `.vrm` or `.gltf`.

    Raises:
        LipwrightError: the file cannot be read, is none of these, is of another version, is cut
            off, or names data outside its own folder.
    """
    path = Path(path)
    content = read_content(path)
    if content[:4] != struct.pack("<I", MAGIC):
        if not content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
            raise LipwrightError(f"{path}: is no GLB, VRM or .gltf; {REMEDY}")
        return _with_buffers(path, parse(path, content), None, b"")
    text, binary, rest = chunks(path, memoryview(content))
    return _with_buffers(path, parse(path, bytes(text)), binary, rest)


def _with_buffers(
    path: Path, document: Json, binary: memoryview | None, rest: bytes | memoryview
) -> GltfFile:
    file = GltfFile(path, document, (), rest)
    buffers = []
    for number, item in enumerate(file.tables("buffers")):
        length = file.whole(item, "byteLength", f"buffer {number}")
        content: bytes | memoryview | None = None
        if "uri" in item:
            content = read_buffer(path, f"buffer {number}", item["uri"], MAX_BYTES)
        elif number == 0 and binary is not None:
            content = binary
        if content is not None and len(content) < length:
            file.fail(f"buffer {number} has {len(content)} of {length} bytes")
        buffers.append(None if content is None else content[:length])
    file = GltfFile(path, document, tuple(buffers), rest)
    file.check_data()
    return file
