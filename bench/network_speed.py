"""How fast networks run, against what the machine can multiply.

    python bench/network_speed.py                  # random weights, the three configurations
    python bench/network_speed.py MODEL...         # models, by name or folder
    python bench/network_speed.py MODEL --animate  # and 65 s of speech, from sound to curves

Frames a second from whole windows (or a sequence of frames) to controls: the network and the mean
of its overlapping outputs, in chunks as the engine makes them. The machine's rate is that of a
float32 product of matrices as large as Taylor's, by numpy and by onnxruntime, the faster of the
two. Network and product take turns, and of each the best round counts, since other programs only
slow down. The share is the network's useful multiplications and additions (two for each weight and
frame) over that rate. Speed does not depend on the weights. Needs the extra `train`.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lipwright.controls import ARKIT, GROUPS
from lipwright.engines.window import CHUNK_FRAMES, FrameMean
from lipwright.files import write_whole
from lipwright.network import Network, load_network
from lipwright.network.meta import MODEL_FILE
from lipwright.onnx_session import import_onnxruntime
from lipwright.phones import SILENCE
from lipwright.track import PhoneTrack

if TYPE_CHECKING:
    from lipwright.train.config import Config
    from lipwright.train.takes import Corpus

ROUNDS = 7
PRODUCT = (CHUNK_FRAMES, 3000, 3000)  # a hidden layer of Taylor et al. 2017 on one chunk
FRAMES = 4 * CHUNK_FRAMES  # of each round
VIDEO_FPS = 25.0
CMU = (
    "AA", "AE", "AH", "AO", "AW", "AY", "B", "CH", "D", "DH", "EH", "ER", "EY", "F", "G", "HH",
    "IH", "IY", "JH", "K", "L", "M", "N", "NG", "OW", "OY", "P", "R", "S", "SH", "T", "TH", "UH",
    "UW", "V", "W", "Y", "Z", "ZH",
)  # fmt: skip

Floats = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Speed:
    """What one network does."""

    frames_per_s: float
    """the best round"""
    median_frames_per_s: float
    work: float
    """multiplications and additions a frame"""
    rate: float
    """of the machine, the best round, multiplications and additions a second"""

    @property
    def share(self) -> float:
        """Of the machine's rate that the network uses."""
        return self.frames_per_s * self.work / self.rate


def seconds(work: Callable[[], object]) -> float:
    """How long some work takes, in s."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def products() -> dict[str, Callable[[], object]]:
    """The same product of matrices, by the two libraries."""
    from onnx import TensorProto, helper, numpy_helper

    onnxruntime = import_onnxruntime()
    rows, inner, columns = PRODUCT
    rng = np.random.default_rng(0)
    left = rng.standard_normal((rows, inner), dtype=np.float32)
    right = rng.standard_normal((inner, columns), dtype=np.float32)
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["x", "w"], ["y"])], "product",
        [helper.make_tensor_value_info("x", TensorProto.FLOAT, [None, inner])],
        [helper.make_tensor_value_info("y", TensorProto.FLOAT, [None, columns])],
        [numpy_helper.from_array(right, "w")],
    )  # fmt: skip
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = len(os.sched_getaffinity(0))
    session = onnxruntime.InferenceSession(
        model.SerializeToString(), options, providers=["CPUExecutionProvider"]
    )
    return {"numpy": lambda: left @ right, "onnxruntime": lambda: session.run(None, {"x": left})}


def work_of(path: Path) -> float:
    """Multiplications and additions a frame of an ONNX model: two for each weight of its layers."""
    import onnx

    graph = onnx.load(str(path)).graph
    sizes = {weight.name: float(np.prod(weight.dims)) for weight in graph.initializer}
    return sum(
        2 * max(sizes.get(name, 0.0) for name in node.input)
        for node in graph.node
        if node.op_type in {"MatMul", "Gemm", "Conv"}
    )


def make_input(network: Network, frames: int) -> list[Floats]:
    """Zeros and ones, in chunks as the engine makes them."""
    rng = np.random.default_rng(0)
    features = network.meta.features
    if network.meta.kind == "windows":
        shapes: list[tuple[int, ...]] = [(CHUNK_FRAMES, features.size)]
    else:
        shapes = [(1, CHUNK_FRAMES + features.window - 1, features.frame_size)]
    chunk = (rng.random(shapes[0]) < 0.05).astype(np.float32)
    return [chunk] * (frames // CHUNK_FRAMES)


def to_controls(network: Network, chunks: list[Floats]) -> Floats:
    """What the engine does with its windows: (T, C)."""
    mean = FrameMean(network.meta.output_window, len(network.meta.controls))
    parts = []
    for chunk in chunks:
        values = network.run(chunk)
        parts.append(mean.add(values if network.meta.kind == "windows" else values[0][:, None]))
    return np.concatenate([*parts, mean.end()])


def measure(network: Network, rounds: int) -> Speed:
    """Network and product in turns."""
    chunks, other = make_input(network, FRAMES), products()
    to_controls(network, chunks[:1])
    taken, multiplied = [], []
    for _ in range(rounds):
        multiplied += [min(seconds(product) for _ in range(2)) for product in other.values()]
        taken.append(seconds(lambda: to_controls(network, chunks)))
    frames = len(chunks) * CHUNK_FRAMES
    return Speed(
        frames / min(taken), frames / float(np.median(taken)), work_of(network.path / MODEL_FILE),
        2 * float(np.prod(PRODUCT)) / min(multiplied),
    )  # fmt: skip


def random_models(folder: Path, configs: list[str]) -> dict[str, Network]:
    """Configuration to a network of its shape with random weights, exported as training does."""
    from lipwright.train.config_file import load_config
    from lipwright.train.data import make_data
    from lipwright.train.export import write_model
    from lipwright.train.loop import network_of

    found = {}
    for name in configs:
        config = replace(load_config(name), targets="arkit", controls=None)
        data = make_data(random_corpus(config), config)
        members = [network_of(config, data).state_dict() for _ in range(config.members)]
        place = folder / str(len(found))
        place.mkdir()
        facts = {"licence": "", "data": "random numbers", "metrics": {}}
        write_model(place, config, data, members, facts)
        found[name] = load_network(place)
    return found


def random_corpus(config: Config) -> Corpus:
    """One recording that says every phone of CMUdict, with ARKit weights of the lower face."""
    from lipwright.train.data import HEARD
    from lipwright.train.takes import SPOKEN, Corpus, Take

    rng, fps = np.random.default_rng(0), config.fps or VIDEO_FPS
    phones = (SILENCE, *CMU) * HEARD
    track = PhoneTrack(phones, 0.08 * np.arange(len(phones) + 1))
    times = np.arange(int(track.end * fps)) / fps
    lower = [name for group in SPOKEN for name in GROUPS[group]]
    controls = tuple(name for name in ARKIT if name in lower)
    heard = None
    if "sound" in config.features:
        from lipwright.features.sound import SOUND_NAMES

        heard = rng.random((len(times), len(SOUND_NAMES)), np.float32)
    targets = rng.random((len(times), len(controls)), np.float32)
    take = Take("random", times, targets, np.ones(len(times), bool), track, heard)
    splits: dict[str, tuple[Take, ...]] = {"train": (take,), "validation": (take,), "test": ()}
    return Corpus(splits, controls, fps, "random", "", Path("random"))


def time_animate(model: str, length: float) -> dict[str, float]:
    """How long `length` s of GRID speech take, in s, with phones at hand and with words."""
    from grid import CORPORA
    from lipwright.pipeline import AnimateOptions, animate
    from speed import make_recording

    options = AnimateOptions(engine="window", model=model)
    with tempfile.TemporaryDirectory() as name:
        sound, text = make_recording(Path(name), length, CORPORA)
        words = text.read_text("utf-8")
        start = time.perf_counter()
        track = animate(sound, words, options=options).track
        whole = time.perf_counter() - start
        taken = [seconds(lambda: animate(sound, phones=track, options=options)) for _ in range(3)]
    return {"from words": whole, "from phones": min(taken)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", help="names or folders; none for random weights")
    parser.add_argument("--configs", nargs="+", default=["window", "thesis", "lipwright"],
                        help="configurations to draw random weights for")  # fmt: skip
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--animate", action="store_true", help="also 65 s of speech")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args()
    figures = {}
    with tempfile.TemporaryDirectory() as name:
        networks = {model: load_network(model) for model in options.models}
        networks = networks or random_models(Path(name), options.configs)
        print(f"{len(os.sched_getaffinity(0))} cores, {FRAMES} frames a round")
        for label, network in networks.items():
            speed = measure(network, options.rounds)
            figures[label] = {**asdict(speed), "share": speed.share}
            print(f"{label}: {speed.frames_per_s:.0f} frames/s (median "
                  f"{speed.median_frames_per_s:.0f}), {speed.work / 1e6:.2f} M operations a frame, "
                  f"{speed.share:.1%} of {speed.rate / 1e9:.1f} GFLOPS")  # fmt: skip
            if options.animate and network.meta.moves_heads:
                for what, taken in time_animate(str(network.path), 65.0).items():
                    figures[label][what] = taken
                    print(f"  65 s {what}: {taken:.3f} s, {65 / taken:.0f} times real time")
    if options.json:
        with write_whole(options.json) as part:
            part.write_text(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
