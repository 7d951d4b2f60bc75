"""The nodes and outputs of an ONNX model, as far as a voice must be looked at before it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from lipwright.onnx_bytes import has_external_data, messages

# Field numbers of onnx.proto of ONNX 1.16.
_MODEL_GRAPH, _GRAPH_NODE, _GRAPH_OUTPUT = 7, 1, 12
_NODE_INPUT, _NODE_OUTPUT, _NODE_OP_TYPE = 1, 2, 4
_VALUE_NAME: Final = 1


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
    for number, graph in messages(memoryview(model)):
        if number != _MODEL_GRAPH:
            continue
        for kind, part in messages(graph):
            if kind == _GRAPH_NODE:
                nodes.append(_node(part))
            elif kind == _GRAPH_OUTPUT:
                outputs += [_text(name) for n, name in messages(part) if n == _VALUE_NAME]
    if not nodes or not outputs:
        raise ValueError("it has no graph")
    return Contents(tuple(nodes), tuple(outputs), has_external_data(model))


def _node(message: memoryview) -> Node:
    fields = list(messages(message))

    def texts(wanted: int) -> tuple[str, ...]:
        return tuple(_text(value) for number, value in fields if number == wanted)

    return Node("".join(texts(_NODE_OP_TYPE)), texts(_NODE_INPUT), texts(_NODE_OUTPUT))


def _text(value: memoryview) -> str:
    return bytes(value).decode("utf-8", "replace")
