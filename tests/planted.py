"""Tiny networks with planted weights, written as model folders."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import onnx
from onnx import TensorProto, helper, numpy_helper

from lipwright.features import FeatureSet

PHONES = ("sil", "AA", "IH", "M", "S")
FEATURES = FeatureSet(("raw",), 3, 25, PHONES)
HASHED = ("model.onnx", "golden.npz")


def windows_graph(
    weights: npt.NDArray[np.floating], bias: npt.NDArray[np.floating]
) -> onnx.ModelProto:
    """features (N, D) @ weights (D, Ky * C) + bias (Ky, C)."""
    output_window, controls = bias.shape
    tensors = {
        "weights": weights.astype(np.float32),
        "bias": bias.reshape(-1).astype(np.float32),
        "shape": np.array([-1, output_window, controls]),
    }
    nodes = [
        helper.make_node("Gemm", ["features", "weights", "bias"], ["flat"]),
        helper.make_node("Reshape", ["flat", "shape"], ["controls"]),
    ]
    return graph(nodes, tensors, ["N", len(weights)], ["N", output_window, controls])


def sequence_graph(kernel: npt.NDArray[np.floating]) -> onnx.ModelProto:
    """features (1, W, F), convolved with a kernel (C, F, Kx)."""
    controls, frame, _ = kernel.shape
    nodes = [
        helper.make_node("Transpose", ["features"], ["columns"], perm=[0, 2, 1]),
        helper.make_node("Conv", ["columns", "kernel"], ["motion"]),
        helper.make_node("Transpose", ["motion"], ["controls"], perm=[0, 2, 1]),
    ]
    tensors = {"kernel": kernel.astype(np.float32)}
    return graph(nodes, tensors, [1, "W", frame], [1, "V", controls])


def graph(
    nodes: Sequence[onnx.NodeProto],
    tensors: dict[str, npt.NDArray[Any]],
    takes: list[int | str] | None,
    gives: list[int | str] | None,
    names: tuple[str, str] = ("features", "controls"),
    element: int = TensorProto.FLOAT,
) -> onnx.ModelProto:
    """A model of one input and one output."""
    return helper.make_model(
        helper.make_graph(
            nodes,
            "planted",
            [helper.make_tensor_value_info(names[0], element, takes)],
            [helper.make_tensor_value_info(names[1], element, gives)],
            [numpy_helper.from_array(array, name) for name, array in tensors.items()],
        ),
        opset_imports=[helper.make_opsetid("", 17)],
        ir_version=8,
    )


def write_model(
    folder: Path,
    model: onnx.ModelProto,
    features: FeatureSet,
    controls: Sequence[str],
    golden: tuple[npt.NDArray[Any], npt.NDArray[Any]] | None = None,
    **fields: Any,
) -> Path:
    """The folder of a model; `fields` go into its meta.json."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.onnx").write_bytes(model.SerializeToString())
    empty = np.zeros((0, 0), np.float32)
    taken, given = golden or (empty, empty)
    np.savez(folder / "golden.npz", features=taken, controls=given)
    meta = {
        "format": "lipwright-model", "version": 1, "lipwright": "0.1.0", "name": "planted",
        "kind": "windows", "features": features.to_json(), "output_window": 1,
        "controls": list(controls), "target": "arkit", "files": {}, "licence": "CC0",
        "data": "nothing", "metrics": {"r": 0.5}, "date": "2018-01-31", **fields,
    }  # fmt: skip
    (folder / "meta.json").write_text(json.dumps(meta))
    rehash(folder)
    return folder


def change_meta(folder: Path, **fields: Any) -> None:
    """Other fields in the meta.json of a model; None takes one out."""
    path = folder / "meta.json"
    meta = json.loads(path.read_text()) | fields
    path.write_text(json.dumps({name: value for name, value in meta.items() if value is not None}))


def rehash(folder: Path) -> None:
    """Make the hashes of meta.json those of the files that are there."""
    files = {
        name: hashlib.sha256((folder / name).read_bytes()).hexdigest()
        for name in HASHED
        if (folder / name).is_file()
    }
    change_meta(folder, files=files)


def middle_frame(folder: Path, phones: Sequence[str] = ("M", "AA")) -> Path:
    """A windows model of FEATURES whose controls are 1 while `phones` are said, else 0.

    The first phone moves mouthClose, the second jawOpen.
    """
    columns = [f"{phone} at frame 1" for phone in phones]
    weights = np.stack([np.array(FEATURES.names) == name for name in columns], axis=1)
    taken = np.eye(FEATURES.size, dtype=np.float32)
    given = weights.astype(np.float32)[:, None]
    model = windows_graph(weights, np.zeros((1, len(phones))))
    return write_model(folder, model, FEATURES, ("mouthClose", "jawOpen"), (taken, given))


def middle_frame_sequence(folder: Path, phones: Sequence[str] = ("M", "AA")) -> Path:
    """The same as a sequence model."""
    kernel = np.zeros((len(phones), len(PHONES), 3))
    for row, phone in enumerate(phones):
        kernel[row, PHONES.index(phone), 1] = 1
    taken = np.eye(len(PHONES), dtype=np.float32)[None]
    given = kernel[:, :, 1].T[None, 1:-1].astype(np.float32)
    return write_model(
        folder, sequence_graph(kernel), FEATURES, ("mouthClose", "jawOpen"), (taken, given),
        kind="sequence",
    )  # fmt: skip
