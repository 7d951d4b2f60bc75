"""What stands in the bytes of an ONNX file, read without the package that reads ONNX.

That package is not among those that running a model needs, but one from elsewhere must be looked
at before it runs: the names of files with its weights stand in the model and may lead anywhere,
and onnxruntime would follow them. ONNX files are messages of Protocol Buffers.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import MappingProxyType
from typing import Final

# The fields that lead to tensors, by number: onnx.proto of ONNX 1.16 (IR version 10).
_FIELDS: Final = MappingProxyType({
    "model": {7: "graph", 20: "training", 25: "function"},
    "training": {1: "graph", 2: "graph"},
    "function": {7: "node", 11: "attribute"},
    "graph": {1: "node", 5: "tensor", 15: "sparse"},
    "node": {5: "attribute"},
    "attribute": {5: "tensor", 6: "graph", 10: "tensor", 11: "graph", 22: "sparse", 23: "sparse"},
    "sparse": {1: "tensor", 2: "tensor"},
    "tensor": {},
})  # fmt: skip
_EXTERNAL: Final = frozenset((13, 14))  # of a tensor: external_data, data_location

_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_MOST_BYTES: Final = 10  # of a varint
_MOST_DEPTH: Final = 100  # messages in messages, as protobuf itself limits them


def has_external_data(content: bytes) -> bool:
    """Whether a tensor of the model says that its numbers are elsewhere.

    Raises:
        ValueError: the bytes are not a protobuf message.
    """
    waiting = [("model", memoryview(content), 0)]
    while waiting:
        message, data, depth = waiting.pop()
        if depth > _MOST_DEPTH:
            raise ValueError("messages are nested too deeply")
        for field, value in fields(data):
            if message == "tensor" and field in _EXTERNAL:
                if field == 13 or value:  # data_location 0 is the default: in the file
                    return True
            elif field in _FIELDS[message]:
                if isinstance(value, int):
                    raise ValueError(f"field {field} of {message} is a number, not a message")
                waiting.append((_FIELDS[message][field], value, depth + 1))
    return False


def messages(data: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Number and content of the fields that have bytes; as `fields`."""
    return ((number, value) for number, value in fields(data) if not isinstance(value, int))


def fields(data: memoryview) -> Iterator[tuple[int, int | memoryview]]:
    """Number and value of each field of a message.

    Raises:
        ValueError: the bytes are not a protobuf message.
    """
    place = 0
    while place < len(data):
        key, place = _varint(data, place)
        field, kind = key >> 3, key & 7
        value: int | memoryview
        if kind == _VARINT:
            value, place = _varint(data, place)
        else:
            if kind == _BYTES:
                size, place = _varint(data, place)
            elif kind in (_FIXED64, _FIXED32):
                size = 8 if kind == _FIXED64 else 4
            else:
                raise ValueError(f"it is not an ONNX model: a field of the unknown kind {kind}")
            value, place = data[place : place + size], place + size
        if place > len(data) or field == 0:
            raise ValueError("it is cut off or damaged")
        yield field, value


def _varint(data: memoryview, place: int) -> tuple[int, int]:
    """A number of seven bits a byte, and the place after it."""
    number = 0
    for index in range(_MOST_BYTES):
        if place + index >= len(data):
            break
        byte = data[place + index]
        number |= (byte & 0x7F) << 7 * index
        if byte < 0x80:
            return number, place + index + 1
    raise ValueError("it is cut off or damaged")
