"""`Config`: everything that shapes a network and its training, as a JSON file says it."""

from __future__ import annotations

import dataclasses
import json
import math
from dataclasses import asdict, dataclass
from typing import Any, Final, Literal

from lipwright.features import KINDS
from lipwright.network.meta import Target
from lipwright.phones import PHONES, SILENCE

WIDEST: Final = 101  # frames of a window


class MisfitError(ValueError):
    """A value that cannot be, and the key that has it."""

    def __init__(self, key: str, text: str) -> None:
        """`key` is dotted from the top of the file."""
        super().__init__(f"{key!r} {text}")
        self.key, self.text = key, text


def need(fits: bool, key: str, text: str) -> None:
    """Refuse a value of `key` that does not fit.

    Raises:
        MisfitError: it does not.
    """
    if not fits:
        raise MisfitError(key, text)


@dataclass(frozen=True)
class Network:
    """The network's shape.

    Raises:
        MisfitError: a value is out of range.
    """

    kind: Literal["dense", "conv", "gated", "recurrent"] = "dense"
    """dense: windows in, windows out; conv: valid convolutions over all frames of a sequence;
    gated: the same, each with a gate, added to what it was given; recurrent: a fully connected
    layer and bidirectional LSTMs over all frames"""
    layers: tuple[int, ...] = (3000, 3000, 3000)
    """units of each hidden layer; of conv, channels; of an LSTM, of both directions together"""
    dropout: tuple[float, ...] = (0.5,)
    """share of each hidden layer's units that is dropped; one number is for all layers"""
    activation: Literal["tanh", "leaky_relu"] = "tanh"
    slope: float = 0.1
    """of the leaky ReLU below 0"""
    init: Literal["he", "glorot", "torch"] = "glorot"
    """he: normal, with a standard deviation of 0.05 in the last layer (thesis, section 4.4.6);
    torch: what torch's layers begin with"""
    kernels: tuple[int, ...] = ()
    """frames of each hidden convolution"""
    dilations: tuple[int, ...] = ()
    """frames from one of its taps to the next; none for 1 everywhere"""

    def __post_init__(self) -> None:
        """Check."""
        count = len(self.layers)
        need(all(1 <= size <= 100_000 for size in self.layers), "layers", "must be 1 to 100000")
        need(len(self.dropout) in {1, count}, "dropout", f"must be one number, or {count}")
        need(all(0 <= p < 1 for p in self.dropout), "dropout", "must be from 0 to below 1")
        need(0 <= self.slope < 1, "slope", "must be from 0 to below 1")
        if self.kind in {"dense", "recurrent"}:
            need(not self.kernels, "kernels", "are for networks of the kind 'conv'")
            need(not self.dilations, "dilations", "are for networks of the kind 'conv'")
            if self.kind == "recurrent":
                need(count >= 2, "layers", "of a recurrent network are 2 or more, the first dense")
                need(all(size % 2 == 0 for size in self.layers[1:]), "layers", "of LSTMs are even")
            return
        need(count > 0, "layers", "must name a layer at least")
        need(len(self.kernels) == count, "kernels", f"must be {count}, one a layer")
        need(all(k >= 1 for k in self.kernels), "kernels", "must be 1 or more")
        if self.kind == "gated":
            need(len(set(self.layers)) == 1, "layers", "of a gated network are all of one size")
            need(all(k % 2 == 1 for k in self.kernels), "kernels", "of a gated network are odd")
        need(len(self.dilations) in {0, count}, "dilations", f"must be {count}, one a layer")
        need(all(d >= 1 for d in self.dilations), "dilations", "must be 1 or more")

    @property
    def drops(self) -> tuple[float, ...]:
        """The dropout of each hidden layer."""
        return (
            self.dropout
            if len(self.dropout) == len(self.layers)
            else self.dropout * len(self.layers)
        )

    @property
    def taps(self) -> tuple[tuple[int, int], ...]:
        """Kernel and dilation of each convolution."""
        dilations = self.dilations or (1,) * len(self.kernels)
        return tuple(zip(self.kernels, dilations, strict=True))

    @property
    def reach(self) -> int:
        """Frames that one output of a convolution sees."""
        return 1 + sum((kernel - 1) * dilation for kernel, dilation in self.taps)


@dataclass(frozen=True)
class Optimizer:
    """How weights move.

    Raises:
        MisfitError: a value is out of range.
    """

    kind: Literal["sgd", "adam", "adamw"] = "sgd"
    momentum: float = 0.0
    """of sgd"""
    weight_decay: float = 0.0
    """of adamw"""
    longest: float | None = None
    """norm to which a longer gradient is cut; null for none"""

    def __post_init__(self) -> None:
        """Check."""
        need(0 <= self.momentum < 1, "momentum", "must be from 0 to below 1")
        need(0 <= self.weight_decay < 1, "weight_decay", "must be from 0 to below 1")
        need(self.longest is None or self.longest > 0, "longest", "must be above 0, or null")


@dataclass(frozen=True)
class Rates:
    """The learning rate over the epochs.

    Raises:
        MisfitError: a value is out of range.
    """

    first: float
    schedule: Literal["constant", "series", "cosine", "one_cycle"] = "constant"
    """series: 10^a, 5 10^(a-1), 10^(a-1), 5 10^(a-2), ... (thesis, section 4.3), one step whenever
    the loss that it watches is higher than an epoch before; cosine: down to 0 at the last epoch;
    one_cycle: up over the first tenth of all steps, then down to 0 (Smith and Topin 2018)"""
    watches: Literal["train", "validation"] = "train"
    """which loss the series watches; the thesis: that of training"""

    def __post_init__(self) -> None:
        """Check."""
        need(0 < self.first <= 100, "first", "must be above 0 and at most 100")


@dataclass(frozen=True)
class Loss:
    """The weights of the loss's terms; losses.py has the terms.

    Raises:
        MisfitError: a value is out of range.
    """

    squared: float = 1.0
    """mean squared error"""
    motion: float = 0.0
    """difference of the movement from frame to frame (thesis, section 4.3)"""
    l2: float = 0.0
    """squares of all weights"""
    lips: float = 0.0
    """aperture of the lips on the head; targets other than arkit do without it"""

    def __post_init__(self) -> None:
        """Check."""
        for field in dataclasses.fields(self):
            need(0 <= getattr(self, field.name) < math.inf, field.name, "must be 0 or more")


@dataclass(frozen=True)
class Augment:
    """What is changed of the sound while training, anew for each example.

    Raises:
        MisfitError: a value is out of range.
    """

    voices: tuple[float, ...] = ()
    """factors of the formants of other voices"""
    voiced: float = 0.0
    """share of the examples that have one of them"""
    deaf: float = 0.0
    """share of the examples without sound, so that the network does without it too"""
    noise: float = 0.0
    """standard deviation of what is added to scaled sound features, in each frame and for all"""

    def __post_init__(self) -> None:
        """Check."""
        need(all(0.5 <= v <= 2 for v in self.voices), "voices", "must be 0.5 to 2")
        need(0 <= self.voiced <= 1, "voiced", "must be 0 to 1")
        need(bool(self.voices) or not self.voiced, "voiced", "needs 'voices'")
        need(0 <= self.deaf <= 1, "deaf", "must be 0 to 1")
        need(0 <= self.noise < math.inf, "noise", "must be 0 or more")


@dataclass(frozen=True)
class Config:
    """A whole configuration; without values of its own it is that of Taylor et al. 2017.

    Raises:
        MisfitError: a value is out of range, or two do not fit together.
    """

    name: str
    rates: Rates
    network: Network = Network()
    optimizer: Optimizer = Optimizer()
    loss: Loss = Loss()
    targets: Target = "arkit"
    controls: tuple[str, ...] | None = None
    """of the targets; null for all that move in training, of arkit those of the lower face"""
    phones: tuple[str, ...] | None = None
    """with columns of their own; null for those heard in training"""
    fps: float | None = None
    """frames a second of the network; null for that of the dataset"""
    features: tuple[str, ...] = ("raw",)
    """kinds of features"""
    input_window: int = 11
    """frames, Kx"""
    output_window: int = 5
    """frames, Ky; 1 for conv"""
    scaling: Literal["each", "common", "none"] = "each"
    """each: controls less their mean, over their standard deviation in training; common: over that
    of all controls together; none: as they come"""
    batch: int = 100
    """windows before each step; 0 for all of one recording; of conv, stretches; of recurrent
    networks, whole recordings"""
    stretch: int = 50
    """frames that conv learns from at once"""
    epochs: int = 100
    """at most"""
    patience: int | None = 10
    """epochs without a validation gain after which it stops; null for never"""
    members: int = 1
    """networks whose mean is the model"""
    augment: Augment = Augment()
    average: float = 0.0
    """share of the weights of each step in the running mean that is judged and kept; 0: no mean"""
    precision: Literal["float32", "bfloat16"] = "float32"
    """of the products of matrices in training; bfloat16 where the processor multiplies it faster"""
    seed: int = 0
    comment: str = ""

    def __post_init__(self) -> None:
        """Check."""
        need(bool(self.name) and self.name.isprintable(), "name", "must be a name")
        for key, least, most in (
            ("input_window", 1, WIDEST), ("output_window", 1, WIDEST), ("batch", 0, 1_000_000),
            ("stretch", 1, 100_000), ("epochs", 1, 1_000_000), ("members", 1, 100),
            ("seed", 0, 2**31),
        ):  # fmt: skip
            fits = least <= getattr(self, key) <= most
            need(fits, key, f"is {getattr(self, key)}, not {least} to {most}")
        for key in ("input_window", "output_window"):
            need(getattr(self, key) % 2 == 1, key, f"is {getattr(self, key)}, not odd")
        need(self.patience is None or self.patience >= 1, "patience", "must be 1 or more, or null")
        need(self.fps is None or 1 <= self.fps <= 1000, "fps", "must be 1 to 1000, or null")
        self._check_names()
        need(0 <= self.average < 1, "average", "must be from 0 to below 1")
        hears = self.is_sequence and not self.is_recurrent and "sound" in self.features
        need(hears or self.augment == Augment(), "augment", "needs a conv network with 'sound'")
        if self.is_sequence:
            reach = self.network.reach
            kind = "recurrent" if self.is_recurrent else "conv"
            need("spans" not in self.features, "features", f"of a {kind} network have no 'spans'")
            need(self.output_window == 1, "output_window", f"of a {kind} network is 1")
            need(self.input_window == reach, "input_window", f"must be {reach}, as kernels see")

    def _check_names(self) -> None:
        for key in ("features", "controls", "phones"):
            names = getattr(self, key)
            if names is not None:
                need(bool(names), key, "must name one at least")
                need(len(set(names)) == len(names), key, "has a name twice")
        for kind in self.features:
            need(kind in KINDS, "features", f"has {kind!r}, not one of: {', '.join(KINDS)}")
        for phone in self.phones or ():
            need(phone in PHONES, "phones", f"has {phone!r}, which the phone table lacks")
        need(self.phones is None or SILENCE in self.phones, "phones", f"must have {SILENCE!r}")

    @property
    def is_sequence(self) -> bool:
        """Whether the network runs over all frames at once."""
        return self.network.kind != "dense"

    @property
    def is_recurrent(self) -> bool:
        """Whether each frame that it gives depends on all frames."""
        return self.network.kind == "recurrent"

    def to_json(self) -> dict[str, Any]:
        """Plain values, as `config_from` reads them."""
        return dict(json.loads(json.dumps(asdict(self))))
