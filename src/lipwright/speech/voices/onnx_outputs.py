"""Makes an inner value of an ONNX model one of its outputs, in its bytes.

ONNX files are messages of Protocol Buffers. Two serialised messages one after the other are read
as one, with their lists joined (protobuf.dev, "Encoding", "Last One Wins"): so a few bytes behind
a model add an output to its graph, and nothing needs to be parsed or written but those.
"""

from __future__ import annotations

from typing import Final

from lipwright.onnx_bytes import messages

# Field numbers of onnx.proto3 (ModelProto, GraphProto, NodeProto, ValueInfoProto).
_MODEL_GRAPH: Final = 7
_GRAPH_NODE, _GRAPH_OUTPUT = 1, 12
_NODE_INPUT, _NODE_OP_TYPE = 1, 4
_VALUE_NAME: Final = 1
_BYTES: Final = 2  # wire type


def input_of(model: bytes, op_type: str) -> str:
    """The name of the first input of the only node of that kind.

    Raises:
        ValueError: there is no such node, or more than one, or the bytes are no ONNX model.
    """
    names = []
    wanted = _field(_NODE_OP_TYPE, op_type.encode())
    for number, graph in messages(memoryview(model)):
        if number != _MODEL_GRAPH:
            continue
        for kind, node in messages(graph):
            if kind != _GRAPH_NODE:
                continue
            if wanted not in bytes(node):  # most nodes need not be read
                continue
            fields = list(messages(node))
            if any(n == _NODE_OP_TYPE and bytes(v) == op_type.encode() for n, v in fields):
                names.append(next(bytes(v).decode() for n, v in fields if n == _NODE_INPUT))
    if len(names) != 1:
        raise ValueError(f"{len(names)} nodes of the kind {op_type}, not one")
    return names[0]


def with_output(model: bytes, name: str) -> bytes:
    """The model with the value `name` as one more output, after its own."""
    value = _field(_VALUE_NAME, name.encode())
    return model + _field(_MODEL_GRAPH, _field(_GRAPH_OUTPUT, value))


def _field(number: int, content: bytes) -> bytes:
    return _varint(number << 3 | _BYTES) + _varint(len(content)) + content


def _varint(value: int) -> bytes:
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])
