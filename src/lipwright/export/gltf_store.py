"""`Store`: the data of a glTF document as it grows, for files of our own and for those of others.

glTF 2.0 (ISO/IEC 12113:2022): accessors are arrays, buffer views the bytes that they lie in, and a
GLB is a header, the document as JSON, and one binary chunk. Documents are plain JSON here: what
others wrote into theirs, known or not, stays as it is.
"""

from __future__ import annotations

import json
import struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

# glTF 2.0, section 5: component types and buffer view targets.
FLOAT: Final = 5126
UINT8: Final = 5121
UINT16: Final = 5123
UINT32: Final = 5125
VERTICES: Final = 34962
INDICES: Final = 34963

# glTF 2.0, section 4.4.
MAGIC: Final = 0x46546C67  # "glTF"
JSON_CHUNK: Final = 0x4E4F534A
BINARY_CHUNK: Final = 0x004E4942

_COMPONENTS: Final = {"<f4": FLOAT, "|u1": UINT8, "<u4": UINT32}

Json = dict[str, Any]


class Store:
    """The binary chunk as it grows, with its views and accessors.

    All that is added lies in buffer 0, which is the binary chunk.
    """

    def __init__(self, document: Json | None = None, data: bytes | memoryview = b"") -> None:
        """Append to `document`, whose buffer 0 holds `data`; both start empty."""
        self.document: Json = {} if document is None else document
        self.data = bytearray(data)
        self._still: dict[int, int] = {}  # vertex count to the accessor of a shape that moves none
        self._times: dict[bytes, int] = {}

    def view(self, content: bytes, target: int | None = None) -> int:
        """A buffer view of `content`."""
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content)}
        if target is not None:
            view["target"] = target
        self.data += content
        return self.add("bufferViews", view)

    def accessor(
        self, values: npt.NDArray[Any], kind: str, target: int | None = None, bounds: bool = False
    ) -> int:
        """An accessor of all `values`; `bounds` where glTF asks for minimum and maximum."""
        accessor: Json = {
            "bufferView": self.view(np.ascontiguousarray(values).tobytes(), target),
            "componentType": _COMPONENTS[values.dtype.str],
            "count": len(values),
            "type": kind,
        }
        return self.add("accessors", accessor | (_bounds(values) if bounds else {}))

    def times(self, times: npt.NDArray[np.floating]) -> int:
        """An accessor of the times of keys in s; the same times are stored once."""
        stored = times.astype(np.float32)
        key = stored.tobytes()
        if key not in self._times:
            self._times[key] = self.accessor(stored, "SCALAR", bounds=True)
        return self._times[key]

    def sparse(self, vertices: npt.NDArray[Any], deltas: npt.NDArray[Any], count: int) -> int:
        """An accessor of `count` vectors that are 0 but for `deltas` (n, 3) at `vertices` (n,)."""
        if len(vertices) == 0:
            if count not in self._still:
                still = _zeros(count, np.zeros((1, 3), np.float32))
                self._still[count] = self.add("accessors", still)
            return self._still[count]
        small = count <= 65535
        indices = np.asarray(vertices, np.uint16 if small else np.uint32)
        deltas = np.asarray(deltas, np.float32)
        everything = deltas if len(deltas) == count else np.vstack([deltas, np.zeros((1, 3))])
        accessor = _zeros(count, everything.astype(np.float32))
        accessor["sparse"] = {
            "count": len(indices),
            "indices": {
                "bufferView": self.view(indices.tobytes()),
                "componentType": UINT16 if small else UINT32,
            },
            "values": {"bufferView": self.view(deltas.tobytes())},
        }
        return self.add("accessors", accessor)

    def add(self, key: str, item: Json) -> int:
        """Append to one of the document's lists; the item's index."""
        items: list[Json] = self.document.setdefault(key, [])
        items.append(item)
        return len(items) - 1

    def to_glb(self, other_chunks: bytes | memoryview = b"") -> bytes:
        """The bytes of a GLB; `other_chunks` follow the binary one as they are."""
        self.data += bytes(-len(self.data) % 4)
        buffers = self.document.setdefault("buffers", [])
        if not buffers:
            buffers.append({})
        buffers[0]["byteLength"] = len(self.data)
        text = json.dumps(self.document, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        length = 28 + len(text) + len(self.data) + len(other_chunks)
        return b"".join((
            struct.pack("<IIIII", MAGIC, 2, length, len(text), JSON_CHUNK),
            text,
            struct.pack("<II", len(self.data), BINARY_CHUNK),
            self.data,
            other_chunks,
        ))  # fmt: skip


def _zeros(count: int, values: npt.NDArray[Any]) -> Json:
    """Without a buffer view, an accessor is of zeros."""
    return {"componentType": FLOAT, "count": count, "type": "VEC3", **_bounds(values)}


def _bounds(values: npt.NDArray[Any]) -> Json:
    columns = values.reshape(len(values), -1)
    return {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}
