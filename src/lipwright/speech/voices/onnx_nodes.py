"""What stands in an ONNX file, as far as a voice from elsewhere must be looked at before it runs.

ONNX files are messages of Protocol Buffers; field numbers are those of onnx.proto of ONNX 1.16.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

# The fields that lead to nodes and tensors, by number.
_LEADS: Final = MappingProxyType({
    "model": {7: "graph", 20: "training", 25: "function"},
    "training": {1: "graph", 2: "graph"},
    "function": {7: "node", 11: "attribute"},
    "graph": {1: "node", 5: "tensor", 15: "sparse"},
    "node": {5: "attribute"},
    "attribute": {5: "tensor", 6: "graph", 10: "tensor", 11: "graph", 22: "sparse", 23: "sparse"},
    "sparse": {1: "tensor", 2: "tensor"},
})  # fmt: skip
_MODEL_GRAPH, _GRAPH_NODE, _GRAPH_OUTPUT = 7, 1, 12
_NODE_INPUT, _NODE_OUTPUT, _NODE_OP_TYPE = 1, 2, 4
_TENSOR_EXTERNAL_DATA, _TENSOR_DATA_LOCATION = 13, 14
_VALUE_NAME: Final = 1
_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_MOST_DEPTH: Final = 100  # messages in messages, as protobuf itself limits them
_MOST_VARINT: Final = 10  # bytes


@dataclass(frozen=True)
class Node:
    """One step of a model."""

    op_type: str
    """such as "Ceil" """
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True)
class Contents:
    """What a model is made of."""

    nodes: tuple[Node, ...]
    """of its main graph"""
    outputs: tuple[str, ...]
    """names of its results, in order"""
    needs_files: bool
    """whether a tensor's numbers are in another file"""


def read_contents(model: bytes) -> Contents:
    """Nodes and outputs of a model.

    Raises:
        ValueError: the bytes are not an ONNX model.
    """
    nodes: list[Node] = []
    outputs: list[str] = []
    for number, graph in _messages(memoryview(model)):
        if number != _MODEL_GRAPH:
            continue
        for kind, part in _messages(graph):
            if kind == _GRAPH_NODE:
                nodes.append(_node(part))
            elif kind == _GRAPH_OUTPUT:
                outputs += [_text(name) for n, name in _messages(part) if n == _VALUE_NAME]
    if not nodes or not outputs:
        raise ValueError("it has no graph")
    return Contents(tuple(nodes), tuple(outputs), _needs_files(model))


def _node(message: memoryview) -> Node:
    fields = list(_messages(message))

    def texts(wanted: int) -> tuple[str, ...]:
        return tuple(_text(value) for number, value in fields if number == wanted)

    return Node("".join(texts(_NODE_OP_TYPE)), texts(_NODE_INPUT), texts(_NODE_OUTPUT))


def _text(value: memoryview) -> str:
    return bytes(value).decode("utf-8", "replace")


def _needs_files(model: bytes) -> bool:
    waiting = [("model", memoryview(model), 0)]
    while waiting:
        kind, message, depth = waiting.pop()
        if depth > _MOST_DEPTH:
            raise ValueError("messages are nested too deeply")
        for number, value in _fields(message):
            if kind == "tensor":
                is_elsewhere = number == _TENSOR_DATA_LOCATION and value == 1
                if number == _TENSOR_EXTERNAL_DATA or is_elsewhere:
                    return True
            elif number in _LEADS[kind] and not isinstance(value, int):
                waiting.append((_LEADS[kind][number], value, depth + 1))
    return False


def _messages(message: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Number and content of the fields that have bytes."""
    return ((number, value) for number, value in _fields(message) if not isinstance(value, int))


def _fields(message: memoryview) -> Iterator[tuple[int, int | memoryview]]:
    """Number and value of each field."""
    place = 0
    while place < len(message):
        key, place = _varint(message, place)
        number, wire = key >> 3, key & 7
        if wire == _VARINT:
            value, place = _varint(message, place)
            yield number, value
            continue
        if wire == _BYTES:
            size, place = _varint(message, place)
        elif wire in (_FIXED64, _FIXED32):
            size = 8 if wire == _FIXED64 else 4
        else:
            raise ValueError(f"a field of the unknown kind {wire}")
        if number == 0 or place + size > len(message):
            raise ValueError("it is cut off or damaged")
        yield number, message[place : place + size]
        place += size


def _varint(message: memoryview, place: int) -> tuple[int, int]:
    """A number of seven bits a byte, and the place after it."""
    value = 0
    for count, byte in enumerate(message[place : place + _MOST_VARINT]):
        value |= (byte & 0x7F) << 7 * count
        if byte < 0x80:
            return value, place + count + 1
    raise ValueError("it is cut off or damaged")
