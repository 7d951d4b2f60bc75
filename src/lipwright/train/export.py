"""From weights to a model's folder: the ONNX graph, its meta.json and its golden batch.

The graph is built by hand: it is short, and torch's own exporter needs packages that nothing
else here does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import nn

from lipwright.dataset.folder import sha256_of
from lipwright.dataset.recording import to_json
from lipwright.errors import LipwrightError
from lipwright.network import ModelMeta, check_golden
from lipwright.network.meta import GOLDEN_FILE, META_FILE, MODEL_FILE, Kind
from lipwright.network.runtime import INPUT, OUTPUT
from lipwright.train.checkpoint import Weights
from lipwright.train.config import Config
from lipwright.train.data import Data
from lipwright.train.loop import network_of
from lipwright.train.networks import BothWays, GatedBlock, Net

Floats = npt.NDArray[np.float64]

OPSET: Final = 17
IR_VERSION: Final = 8  # the first with this opset; old runtimes read it
GOLDEN_ROWS: Final = 16  # windows, or frames that a sequence gives


@dataclass(frozen=True, eq=False)
class Weighted:
    """A layer with weights, as they are in the graph."""

    layer: nn.Module
    weight: Floats
    """(units, inputs), or (channels, inputs, kernel)"""
    bias: Floats


def folded(network: Net, data: Data) -> list[Weighted | nn.Module]:
    """The layers of a network that take features and give controls as they are."""
    layers: list[Weighted | nn.Module] = []
    for layer in network.layers:
        if isinstance(layer, nn.Linear | nn.Conv1d):
            layers.append(_weighted(layer))
        elif not isinstance(layer, nn.Dropout):
            layers.append(layer)
    assert isinstance(layers[0], Weighted)
    layers[0] = _fold_inputs(layers[0], data)
    assert isinstance(layers[-1], Weighted)
    layers[-1] = _fold_outputs(layers[-1], data)
    return layers


def _weighted(layer: nn.Linear | nn.Conv1d) -> Weighted:
    assert layer.bias is not None
    weight, bias = layer.weight.detach().numpy(), layer.bias.detach().numpy()
    return Weighted(layer, weight.astype(np.float64), bias.astype(np.float64))


def _fold_inputs(of: Weighted, data: Data) -> Weighted:
    mean, sd = data.scaling.input_mean, data.scaling.input_sd
    if isinstance(of.layer, nn.Linear):
        window = data.features.window
        spans = of.weight.shape[1] - window * len(mean)
        mean = np.concatenate([np.tile(mean, window), np.zeros(spans)])
        sd = np.concatenate([np.tile(sd, window), np.ones(spans)])
    else:
        mean, sd = mean[:, None], sd[:, None]
    weight = of.weight / sd
    shift = (weight * mean).reshape(len(of.bias), -1).sum(axis=1)
    return Weighted(of.layer, weight, of.bias - shift)


def _fold_outputs(of: Weighted, data: Data) -> Weighted:
    frames = len(of.bias) // len(data.controls)
    mean, sd = np.tile(data.scaling.mean, frames), np.tile(data.scaling.sd, frames)
    rows = sd.reshape(-1, *(1,) * (of.weight.ndim - 1))
    return Weighted(of.layer, of.weight * rows, of.bias * sd + mean)


def _memory(part: nn.LSTM) -> Iterator[npt.NDArray[np.float32]]:
    """Weights, recurrent weights and biases of one direction as ONNX has them.

    Its gates are input, output, forget and cell; torch's input, forget, cell and output.
    """
    names = ("weight_ih_l0", "weight_hh_l0", "bias_ih_l0", "bias_hh_l0")
    weights = [getattr(part, name).detach().numpy() for name in names]
    taken, kept, *biases = [np.concatenate([np.split(w, 4)[k] for k in (0, 3, 1, 2)])
                            for w in weights]  # fmt: skip
    yield from (taken, kept, np.concatenate(biases))


class Graph:
    """Nodes and weights of an ONNX graph as they come."""

    def __init__(self) -> None:
        """An empty one."""
        self.nodes: list[onnx.NodeProto] = []
        self.weights: list[onnx.TensorProto] = []

    def weight(self, values: npt.NDArray[Any]) -> str:
        """A constant; its name."""
        name = f"w{len(self.weights)}"
        self.weights.append(numpy_helper.from_array(values, name))
        return name

    def node(self, kind: str, *inputs: str, **attributes: Any) -> str:
        """A node; the name of its output."""
        name = f"x{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, inputs, [name], **attributes))
        return name

    def layer(self, layer: Weighted | nn.Module, given: str) -> str:
        """A layer of `folded`; the name of its output."""
        if isinstance(layer, Weighted):
            parts = [self.weight(part.astype(np.float32)) for part in (layer.weight, layer.bias)]
            if isinstance(layer.layer, nn.Conv1d):
                return self.node("Conv", given, *parts, dilations=list(layer.layer.dilation))
            return self.node("Gemm", given, *parts, transB=1)
        if isinstance(layer, GatedBlock):
            return self.gated(layer, given)
        if isinstance(layer, BothWays):
            return self.both_ways(layer, given)
        if isinstance(layer, nn.LeakyReLU):
            return self.node("LeakyRelu", given, alpha=layer.negative_slope)
        assert isinstance(layer, nn.Tanh), f"no ONNX node for {type(layer).__name__}"
        return self.node("Tanh", given)

    def gated(self, block: GatedBlock, given: str) -> str:
        """A gated convolution and what goes past it; the name of their sum."""
        both, channels = self.layer(_weighted(block.both), given), block.out.in_channels
        value = self.node("Tanh", self.slice(both, 0, channels, axis=1))
        gate = self.node("Sigmoid", self.slice(both, channels, 2 * channels, axis=1))
        added = self.layer(_weighted(block.out), self.node("Mul", value, gate))
        past = self.slice(given, block.cut, -block.cut, axis=2) if block.cut else given
        return self.node("Add", past, added)

    def both_ways(self, layer: BothWays, given: str) -> str:
        """A bidirectional LSTM of frames (T, H); the name of its output (T, U)."""
        units = layer.ahead.hidden_size
        both = [_memory(part) for part in (layer.ahead, layer.back)]
        parts = [self.weight(np.stack(values)) for values in zip(*both, strict=True)]
        single = self.reshape(given, -1, 1, layer.ahead.input_size)
        made = self.node("LSTM", single, *parts, hidden_size=units, direction="bidirectional")
        return self.reshape(made, -1, 2 * units)  # (T, 2, 1, U / 2)

    def reshape(self, given: str, *shape: int) -> str:
        """An array in another shape; its name."""
        return self.node("Reshape", given, self.weight(np.array(shape, np.int64)))

    def slice(self, given: str, first: int, stop: int, axis: int) -> str:
        """Part of an array along one axis; its name."""
        limits = [self.weight(np.array([value], np.int64)) for value in (first, stop, axis)]
        return self.node("Slice", given, *limits)


def make_model(config: Config, data: Data, members: Sequence[Weights]) -> onnx.ModelProto:
    """The ONNX model of the mean of all members."""
    graph, ends = Graph(), []
    given = _opening(graph, config, data)
    for weights in members:
        value = given
        for layer in folded(network_of(config, data, weights), data):
            value = graph.layer(layer, value)
        ends.append(value)
    ports = _close(graph, graph.node("Mean", *ends) if len(ends) > 1 else ends[0], config, data)
    graph.nodes[-1].output[0] = OUTPUT
    taken, made = (
        helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
        for name, shape in zip((INPUT, OUTPUT), ports, strict=True)
    )
    whole = helper.make_graph(graph.nodes, config.name, [taken], [made], graph.weights)
    model = helper.make_model(
        whole, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION,
        producer_name="lipwright",
    )  # fmt: skip
    onnx.checker.check_model(model, full_check=True)
    return model


def _opening(graph: Graph, config: Config, data: Data) -> str:
    """The input as the first layer takes it; its name."""
    if config.is_recurrent:
        return graph.reshape(INPUT, -1, data.features.frame_size)
    return graph.node("Transpose", INPUT, perm=[0, 2, 1]) if config.is_sequence else INPUT


def _close(graph: Graph, value: str, config: Config, data: Data) -> list[list[str | int]]:
    """Bring what the last layer gives into the shape of the output; shapes of both ports."""
    controls, frame = len(data.controls), data.features.frame_size
    if config.is_recurrent:
        graph.reshape(value, 1, -1, controls)
        return [[1, "T", frame], [1, "T", controls]]
    if config.is_sequence:
        graph.node("Transpose", value, perm=[0, 2, 1])
        return [[1, "W", frame], [1, "T", controls]]
    graph.reshape(value, -1, config.output_window, controls)
    return [["N", data.features.size], ["N", config.output_window, controls]]


def kind_of(config: Config) -> Kind:
    """What meta.json calls the network."""
    if config.is_recurrent:
        return "recurrent"
    return "sequence" if config.is_sequence else "windows"


@torch.no_grad()
def golden_batch(
    config: Config, data: Data, members: Sequence[Weights]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Features as they come, from recordings for validation, and what torch makes of them."""
    take = data.validation.takes[0]
    count = len(take.times)
    if config.is_sequence:
        width = min(GOLDEN_ROWS, count)
        frames = data.features.frames(take.track, take.times, take.sound)
        half = config.input_window // 2
        features = np.pad(frames, ((half, half), (0, 0)), mode="edge")[None, : width + 2 * half]
        inputs = data.validation.stretches(torch.tensor([0]), width)
    else:
        chosen = np.linspace(0, count - 1, min(GOLDEN_ROWS, count)).astype(np.int64)
        features = data.features.windows(take.track, take.times, take.sound)[chosen]
        inputs = data.validation.windows(torch.from_numpy(chosen))
    outputs = []
    for weights in members:
        network = network_of(config, data, weights).eval()
        outputs.append(network(inputs).numpy().astype(np.float64))
    controls = np.mean(outputs, axis=0) * data.scaling.sd + data.scaling.mean
    return features.astype(np.float32), controls.astype(np.float32)


def write_model(
    folder: Path, config: Config, data: Data, members: Sequence[Weights],
    facts: dict[str, Any],
) -> None:  # fmt: skip
    """Write model.onnx, golden.npz and meta.json, and run what was written.

    Args:
        folder: where; it is there.
        config: of the training.
        data: what it learnt from.
        members: the weights of each member.
        facts: licence, data and metrics for meta.json.

    Raises:
        LipwrightError: the network is too large for a file, or onnxruntime gives other controls
            than torch.
    """
    try:
        content = make_model(config, data, members).SerializeToString()
    except ValueError as error:  # protobuf's limit of 2 GB
        raise LipwrightError(f"{folder}: the network is too large for ONNX ({error})") from error
    (folder / MODEL_FILE).write_bytes(content)
    features, controls = golden_batch(config, data, members)
    np.savez_compressed(folder / GOLDEN_FILE, features=features, controls=controls)
    meta = ModelMeta(
        name=config.name, kind=kind_of(config),
        features=data.features, output_window=config.output_window, controls=data.controls,
        target=config.targets,
        files={name: sha256_of(folder / name) for name in (MODEL_FILE, GOLDEN_FILE)},
        date=date.today().isoformat(),  # the user's own day
        **facts,
    )  # fmt: skip
    (folder / META_FILE).write_text(to_json(meta.to_json()), "utf-8")
    check_golden(folder)
