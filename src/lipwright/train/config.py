"""`Config`: everything that shapes a network and its training, as a JSON file says it.

A command's own name of a configuration, `window` or `thesis`, is a file of `configs/`.
"""

from __future__ import annotations

import dataclasses
import json
import math
import types
import typing
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, Literal

from lipwright.dataset.recording import from_json
from lipwright.errors import LipwrightError
from lipwright.features import KINDS
from lipwright.phones import PHONES, SILENCE

Target = Literal["arkit", "shape", "joint"]

WIDEST: Final = 101  # frames of a window
CONFIGS: Final = ("window", "thesis", "lipwright")


class MisfitError(ValueError):
    """A value that cannot be, and the key that has it."""

    def __init__(self, key: str, text: str) -> None:
        """`key` is dotted from the top of the file."""
        super().__init__(f"{key!r} {text}")
        self.key, self.text = key, text


def _need(fits: bool, key: str, text: str) -> None:
    if not fits:
        raise MisfitError(key, text)


@dataclass(frozen=True)
class Network:
    """The network's shape.

    Raises:
        MisfitError: a value is out of range.
    """

    kind: Literal["dense", "conv"] = "dense"
    """dense: windows in, windows out; conv: valid convolutions over all frames of a sequence"""
    layers: tuple[int, ...] = (3000, 3000, 3000)
    """units of each hidden layer; of conv, channels"""
    dropout: tuple[float, ...] = (0.5,)
    """share of each hidden layer's units that is dropped; one number is for all layers"""
    activation: Literal["tanh", "leaky_relu"] = "tanh"
    slope: float = 0.1
    """of the leaky ReLU below 0"""
    init: Literal["he", "glorot"] = "glorot"
    """he: normal, with a standard deviation of 0.05 in the last layer (thesis, section 4.4.6)"""
    kernels: tuple[int, ...] = ()
    """frames of each hidden convolution"""
    dilations: tuple[int, ...] = ()
    """frames from one of its taps to the next; none for 1 everywhere"""

    def __post_init__(self) -> None:
        """Check."""
        count = len(self.layers)
        _need(all(1 <= size <= 100_000 for size in self.layers), "layers", "must be 1 to 100000")
        _need(len(self.dropout) in {1, count}, "dropout", f"must be one number, or {count}")
        _need(all(0 <= p < 1 for p in self.dropout), "dropout", "must be from 0 to below 1")
        _need(0 <= self.slope < 1, "slope", "must be from 0 to below 1")
        if self.kind == "dense":
            _need(not self.kernels, "kernels", "are for networks of the kind 'conv'")
            _need(not self.dilations, "dilations", "are for networks of the kind 'conv'")
            return
        _need(count > 0, "layers", "must name a layer at least")
        _need(len(self.kernels) == count, "kernels", f"must be {count}, one a layer")
        _need(all(k >= 1 for k in self.kernels), "kernels", "must be 1 or more")
        _need(len(self.dilations) in {0, count}, "dilations", f"must be {count}, one a layer")
        _need(all(d >= 1 for d in self.dilations), "dilations", "must be 1 or more")

    @property
    def drops(self) -> tuple[float, ...]:
        """The dropout of each hidden layer."""
        return (
            self.dropout
            if len(self.dropout) == len(self.layers)
            else self.dropout * len(self.layers)
        )

    @property
    def reach(self) -> int:
        """Frames that one output of a convolution sees."""
        dilations = self.dilations or (1,) * len(self.kernels)
        return 1 + sum((k - 1) * d for k, d in zip(self.kernels, dilations, strict=True))


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

    def __post_init__(self) -> None:
        """Check."""
        _need(0 <= self.momentum < 1, "momentum", "must be from 0 to below 1")
        _need(0 <= self.weight_decay < 1, "weight_decay", "must be from 0 to below 1")


@dataclass(frozen=True)
class Rates:
    """The learning rate over the epochs.

    Raises:
        MisfitError: a value is out of range.
    """

    first: float
    schedule: Literal["constant", "series", "cosine"] = "constant"
    """series: 10^a, 5 10^(a-1), 10^(a-1), 5 10^(a-2), ... (thesis, section 4.3), one step whenever
    the loss that it watches is higher than an epoch before; cosine: down to 0 at the last epoch"""
    watches: Literal["train", "validation"] = "train"
    """which loss the series watches; the thesis: that of training"""

    def __post_init__(self) -> None:
        """Check."""
        _need(0 < self.first <= 100, "first", "must be above 0 and at most 100")


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

    def __post_init__(self) -> None:
        """Check."""
        for field in dataclasses.fields(self):
            _need(0 <= getattr(self, field.name) < math.inf, field.name, "must be 0 or more")


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
    """windows before each step; 0 for all of one recording; of conv, stretches"""
    stretch: int = 50
    """frames that conv learns from at once"""
    epochs: int = 100
    """at most"""
    patience: int | None = 10
    """epochs without a validation gain after which it stops; null for never"""
    members: int = 1
    """networks whose mean is the model"""
    seed: int = 0
    comment: str = ""

    def __post_init__(self) -> None:
        """Check."""
        _need(bool(self.name) and self.name.isprintable(), "name", "must be a name")
        for key, least, most in (
            ("input_window", 1, WIDEST), ("output_window", 1, WIDEST), ("batch", 0, 1_000_000),
            ("stretch", 1, 100_000), ("epochs", 1, 1_000_000), ("members", 1, 100),
            ("seed", 0, 2**31),
        ):  # fmt: skip
            fits = least <= getattr(self, key) <= most
            _need(fits, key, f"is {getattr(self, key)}, not {least} to {most}")
        for key in ("input_window", "output_window"):
            _need(getattr(self, key) % 2 == 1, key, f"is {getattr(self, key)}, not odd")
        _need(self.patience is None or self.patience >= 1, "patience", "must be 1 or more, or null")
        _need(self.fps is None or 1 <= self.fps <= 1000, "fps", "must be 1 to 1000, or null")
        self._check_names()
        if self.network.kind == "conv":
            reach = self.network.reach
            _need("spans" not in self.features, "features", "of a conv network have no 'spans'")
            _need(self.output_window == 1, "output_window", "of a conv network is 1")
            _need(self.input_window == reach, "input_window", f"must be {reach}, as kernels see")

    def _check_names(self) -> None:
        for key in ("features", "controls", "phones"):
            names = getattr(self, key)
            if names is not None:
                _need(bool(names), key, "must name one at least")
                _need(len(set(names)) == len(names), key, "has a name twice")
        for kind in self.features:
            _need(kind in KINDS, "features", f"has {kind!r}, not one of: {', '.join(KINDS)}")
        for phone in self.phones or ():
            _need(phone in PHONES, "phones", f"has {phone!r}, which the phone table lacks")
        _need(self.phones is None or SILENCE in self.phones, "phones", f"must have {SILENCE!r}")

    @property
    def is_sequence(self) -> bool:
        """Whether the network runs over all frames at once."""
        return self.network.kind == "conv"

    def to_json(self) -> dict[str, Any]:
        """Plain values, as `config_from` reads them."""
        return dict(json.loads(json.dumps(asdict(self))))


def load_config(source: str) -> Config:
    """The configuration of a name in `CONFIGS`, or of a JSON file.

    Raises:
        LipwrightError: there is none, or a key of it is unknown or has a value that cannot be.
    """
    shipped = files("lipwright.train") / "configs" / f"{source}.json"
    path = Path(source)
    try:
        if source in CONFIGS and shipped.is_file():
            text = shipped.read_text("utf-8")
        else:
            text = path.read_text("utf-8")
    except FileNotFoundError as error:
        known = ", ".join(CONFIGS)
        raise LipwrightError(
            f"{source}: no such configuration; name a file, or: {known}"
        ) from error
    except (OSError, ValueError) as error:
        raise LipwrightError(f"{source}: cannot be read as text: {error}") from error
    try:
        values = from_json(text)
    except (ValueError, RecursionError) as error:
        raise LipwrightError(f"{source}: not JSON ({error})") from error
    return config_from(values, source)


def config_from(values: Any, source: str) -> Config:
    """The configuration that plain values say.

    Args:
        values: as JSON has them.
        source: named in errors.

    Raises:
        LipwrightError: a key is unknown or missing, or has a value that cannot be.
    """
    try:
        return typing.cast(Config, _build(Config, values, ""))
    except MisfitError as error:
        raise LipwrightError(f"{source}: {error}") from error


def override(config: Config, changes: Mapping[str, Any], source: str) -> Config:
    """The configuration with other values.

    Args:
        config: what to change.
        changes: key, such as `network.layers`, to plain value.
        source: named in errors.

    Raises:
        LipwrightError: as `config_from`.
    """
    values = config.to_json()
    for key, value in changes.items():
        place = values
        *path, last = key.split(".")
        for part in path:
            inner = place.get(part)
            if not isinstance(inner, dict):
                raise LipwrightError(f"{source}: {key!r} is no key of a configuration")
            place = inner
        if last not in place:
            raise LipwrightError(f"{source}: {key!r} is no key of a configuration")
        place[last] = value
    return config_from(values, source)


def _build(kind: Any, value: Any, key: str) -> Any:
    """`value` as the type `kind`, which a field of a configuration has."""
    if dataclasses.is_dataclass(kind):
        return _build_class(typing.cast(type[Any], kind), value, key)
    arguments = typing.get_args(kind)
    match typing.get_origin(kind):
        case types.UnionType:  # X | None
            return None if value is None else _build(arguments[0], value, key)
        case typing.Literal:
            choices = ", ".join(map(repr, arguments))
            _need(value in arguments, key, f"is {value!r}, not one of: {choices}")
            return value
        case origin if origin is tuple:
            _need(isinstance(value, list), key, f"is {value!r}, not a list")
            return tuple(_build(arguments[0], item, key) for item in value)
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    fits = isinstance(value, kind) and not (isinstance(value, bool) and kind is not bool)
    _need(fits, key, f"is {value!r}, not {_NOUNS[kind]}")
    return value


_NOUNS: Final = {str: "text", int: "a whole number", float: "a number"}


def _build_class(kind: type[Any], value: Any, key: str) -> Any:
    before = f"{key}." if key else ""
    _need(isinstance(value, dict), key or "the file", f"is {value!r}, not an object")
    hints = typing.get_type_hints(kind)
    for name in value:
        _need(name in hints, before + name, f"is unknown; known are: {', '.join(hints)}")
    for field in dataclasses.fields(kind):
        optional = field.default is not dataclasses.MISSING
        _need(optional or field.name in value, before + field.name, "is missing")
    built = {name: _build(hints[name], item, before + name) for name, item in value.items()}
    try:
        return kind(**built)
    except MisfitError as error:
        raise MisfitError(before + error.key, error.text) from error
