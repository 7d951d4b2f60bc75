"""A tiny Piper voice: its network says a tone for each phoneme, for as long as a table has it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

HOP = 256
RATE = 22050
SYMBOLS = "_^$ !?,.:;'abcdefhijklmnopqrstuvwxyzæçðøŋœɐɑɒɔɕəɚɛɜɡɣɧɪɫɭɲɳɵɹɾʁʂʃʈʉʊʋʌʏʐʒʔʰʲˈˌːθχᵻ̩̃ɖɥɝβ"
IDS = {symbol: [number] for number, symbol in enumerate(SYMBOLS)}
QUIET = "_^$ !?,.:;ˈˌː"
"""symbols without a tone"""


def frames(symbol: str) -> int:
    """How many frames the voice gives a symbol at the length scale 1."""
    if symbol in "^$":
        return 8
    if symbol in "_ˈˌːʰ̩̃":
        return 0
    if symbol == " ":
        return 2
    if symbol in ".,;:?!":
        return 14
    return 6 + SYMBOLS.index(symbol) % 5


def tone(symbol: str) -> float:
    """Hz; 0 is silence."""
    return 0.0 if symbol in QUIET else 200.0 + 25 * SYMBOLS.index(symbol)


def config(**other: Any) -> dict[str, Any]:
    return {
        "audio": {"sample_rate": RATE, "quality": "test"},
        "espeak": {"voice": "en-us"},
        "inference": {"noise_scale": 0.667, "length_scale": 1, "noise_w": 0.8},
        "phoneme_type": "espeak",
        "num_symbols": len(SYMBOLS),
        "num_speakers": 1,
        "speaker_id_map": {},
        "phoneme_id_map": IDS,
        "language": {"code": "en_US"},
        **other,
    }


def model(speakers: bool = False, shown: bool = False, ceils: str = "one") -> onnx.ModelProto:
    """The network.

    Args:
        speakers: it takes the number of a speaker, who is so many Hz higher.
        shown: the durations are its second output, as newer exports have it.
        ceils: "one"; "two", of which one is counted up; "none", so that nothing can be told.
    """
    lasts = np.array([frames(symbol) for symbol in SYMBOLS], np.float32)
    tones = np.array([tone(symbol) for symbol in SYMBOLS], np.float32)
    constants = {
        "lasts": lasts, "tones": tones, "one_index": np.array([1], np.int64),
        "axis": np.array(1, np.int64), "zero": np.array(0, np.float32),
        "step": np.array(1, np.float32), "hop": np.array(HOP, np.float32),
        "turn": np.array(2 * np.pi / RATE, np.float32), "row": np.array([-1, 1], np.int64),
        "line": np.array([1, -1], np.int64), "flat": np.array([-1], np.int64),
        "out": np.array([1, 1, 1, -1], np.int64), "half": np.array(0.5, np.float32),
        "third": np.array([1, 1, -1], np.int64), "count": np.array([1], np.int64),
    }  # fmt: skip

    def node(kind: str, inputs: str, output: str, **attributes: Any) -> onnx.NodeProto:
        return helper.make_node(kind, inputs.split(), [output], **attributes)

    rounded = node("Ceil", "w", "w_ceil") if ceils != "none" else node("Round", "w", "w_ceil")
    nodes = [
        node("Gather", "lasts input", "w_table"),
        node("Gather", "scales one_index", "length"),
        node("Mul", "w_table length", "w_flat"),
        node("Reshape", "w_flat third", "w"),
        rounded,
        node("Reshape", "w_ceil flat", "w_line"),
        node("CumSum", "w_line zero_axis" if ceils != "two" else "w_ceil axis2", "ends"),
        node("ReduceSum", "w_line", "total_frames", keepdims=0),
        node("Mul", "total_frames hop", "total"),
        node("Range", "zero total step", "sample"),
        node("Div", "sample hop", "frame_at"),
        node("Floor", "frame_at", "frame"),
        node("Reshape", "frame row", "frame_row"),
        node("Reshape", "ends line", "ends_line"),
        node("GreaterOrEqual", "frame_row ends_line", "passed"),
        node("Cast", "passed", "passed_number", to=TensorProto.INT64),
        node("ReduceSum", "passed_number count", "index", keepdims=0),
        node("Reshape", "input flat", "ids"),
        node("Gather", "ids index", "id"),
        node("Gather", "tones id", "hertz"),
    ]  # fmt: skip
    constants["zero_axis"] = np.array(0, np.int64)
    constants["axis2"] = np.array(2, np.int64)
    hertz = "hertz"
    if speakers:
        nodes += [
            node("Cast", "sid", "sid_number", to=TensorProto.FLOAT),
            node("Sign", "hertz", "voiced"), node("Mul", "voiced sid_number", "raise"),
            node("Add", "hertz raise", "hertz_speaker"),
        ]  # fmt: skip
        hertz = "hertz_speaker"
    nodes += [
        node("Mul", f"{hertz} sample", "turns"), node("Mul", "turns turn", "phase"),
        node("Sin", "phase", "wave"), node("Mul", "wave half", "quiet_wave"),
        node("Reshape", "quiet_wave out", "output"),
    ]  # fmt: skip
    if ceils == "two":
        nodes.append(node("Ceil", "scales", "unused"))
    inputs = [
        helper.make_tensor_value_info("input", TensorProto.INT64, ["batch", "phonemes"]),
        helper.make_tensor_value_info("input_lengths", TensorProto.INT64, ["batch"]),
        helper.make_tensor_value_info("scales", TensorProto.FLOAT, [3]),
    ]
    if speakers:
        inputs.append(helper.make_tensor_value_info("sid", TensorProto.INT64, ["batch"]))
    shape = ["batch", "time", "channel", "samples"]
    outputs = [helper.make_tensor_value_info("output", TensorProto.FLOAT, shape)]
    if shown:
        nodes.append(node("Identity", "w_ceil", "durations"))
        outputs.append(helper.make_tensor_value_info("durations", TensorProto.FLOAT, None))
    tensors = [numpy_helper.from_array(value, name) for name, value in constants.items()]
    graph = helper.make_graph(nodes, "voice", inputs, outputs, tensors)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 15)], ir_version=8)


def write_voice(folder: Path, name: str = "voice", settings: dict[str, Any] | None = None,
                **options: Any) -> Path:  # fmt: skip
    """The two files of a voice; the path of its model."""
    path = folder / f"{name}.onnx"
    path.write_bytes(model(**options).SerializeToString())
    path.with_name(f"{name}.onnx.json").write_text(json.dumps(settings or config()), "utf-8")
    return path
