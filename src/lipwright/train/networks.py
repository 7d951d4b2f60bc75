"""The networks: what a configuration says, as torch modules."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, cast

import torch
from torch import Tensor, nn

from lipwright.train.config import Config

LAST_SD: Final = 0.05  # of the weights of layers without ReLU (thesis, section 4.4.6)


class Windows(nn.Module):
    """Fully connected layers from windows (N, D) to windows (N, Ky, C)."""

    is_sequence: Final = False

    def __init__(self, config: Config, inputs: int, controls: int) -> None:
        """`inputs` is D, `controls` C."""
        super().__init__()
        self.shape = (config.output_window, controls)
        sizes = (inputs, *config.network.layers)
        parts: list[nn.Module] = []
        for size, units, drop in zip(sizes, sizes[1:], config.network.drops, strict=False):
            parts += [nn.Linear(size, units), _activation(config), *_dropout(drop)]
        parts.append(nn.Linear(sizes[-1], config.output_window * controls))
        self.layers = nn.Sequential(*parts)

    def forward(self, features: Tensor) -> Tensor:
        """(N, D) to (N, Ky, C)."""
        return cast(Tensor, self.layers(features)).view(-1, *self.shape)


class GatedBlock(nn.Module):
    """A convolution that adds to what it was given as much as its gate lets through.

    After van den Oord et al., "WaveNet" (2016), section 2.3, without its causality.
    """

    def __init__(self, channels: int, kernel: int, dilation: int, drop: float) -> None:
        """`drop` is the share of the inputs of the convolution that is dropped."""
        super().__init__()
        self.drop = nn.Dropout(drop)
        self.both = nn.Conv1d(channels, 2 * channels, kernel, dilation=dilation)
        self.out = nn.Conv1d(channels, channels, 1)
        self.cut = dilation * (kernel - 1) // 2

    def forward(self, frames: Tensor) -> Tensor:
        """(N, H, W) to (N, H, W - 2 cut)."""
        value, gate = self.both(self.drop(frames)).chunk(2, dim=1)
        added = self.out(torch.tanh(value) * torch.sigmoid(gate))
        return cast(Tensor, frames[:, :, self.cut : frames.shape[2] - self.cut] + added)


class Sequence(nn.Module):
    """Valid convolutions over frames: (N, W, F) to (N, W - Kx + 1, C)."""

    is_sequence: Final = True

    def __init__(self, config: Config, inputs: int, controls: int) -> None:
        """`inputs` is F, `controls` C."""
        super().__init__()
        layers = _gated if config.network.kind == "gated" else _plain
        self.layers = nn.Sequential(*layers(config, inputs, controls))

    def forward(self, features: Tensor) -> Tensor:
        """(N, W, F) to (N, W - Kx + 1, C)."""
        return cast(Tensor, self.layers(features.transpose(1, 2))).transpose(1, 2)


def _plain(config: Config, inputs: int, controls: int) -> Iterator[nn.Module]:
    network = config.network
    sizes = (inputs, *network.layers)
    for index, (kernel, dilation) in enumerate(network.taps):
        yield nn.Conv1d(sizes[index], sizes[index + 1], kernel, dilation=dilation)
        yield from (_activation(config), *_dropout(network.drops[index]))
    yield nn.Conv1d(sizes[-1], controls, 1)


def _gated(config: Config, inputs: int, controls: int) -> Iterator[nn.Module]:
    network = config.network
    channels, last = network.layers[0], network.drops[-1]
    yield nn.Conv1d(inputs, channels, 1)
    for (kernel, dilation), drop in zip(network.taps, network.drops, strict=True):
        yield GatedBlock(channels, kernel, dilation, drop)
    yield from (_activation(config), *_dropout(last), nn.Conv1d(channels, channels, 1))
    yield from (_activation(config), *_dropout(last), nn.Conv1d(channels, controls, 1))


class BothWays(nn.Module):
    """A bidirectional LSTM: (N, T, H) to (N, T, U), the first half of U from before."""

    def __init__(self, inputs: int, units: int) -> None:
        """`inputs` is H, `units` U."""
        super().__init__()
        self.ahead = nn.LSTM(inputs, units // 2, batch_first=True)
        self.back = nn.LSTM(inputs, units // 2, batch_first=True)

    def forward(self, frames: Tensor, turned: Tensor) -> Tensor:
        """`turned` (N, T) names the frames of each sequence from its end to its start.

        What pads the end of a sequence comes last both ways, and so changes none of its frames.
        """
        rows = torch.arange(len(frames))[:, None]
        before, _ = self.ahead(frames)
        after, _ = self.back(frames[rows, turned])
        return torch.cat([before, after[rows, turned]], dim=-1)


class Recurrent(nn.Module):
    """A fully connected layer and LSTMs both ways over frames: (N, T, F) to (N, T, C).

    After Fan et al., "Photo-real talking head with deep bidirectional LSTM" (2015).
    """

    is_sequence: Final = True

    def __init__(self, config: Config, inputs: int, controls: int) -> None:
        """`inputs` is F, `controls` C."""
        super().__init__()
        first, *others = config.network.layers
        drop, *drops = config.network.drops
        parts: list[nn.Module] = [nn.Linear(inputs, first), _activation(config), *_dropout(drop)]
        size = first
        for units, share in zip(others, drops, strict=True):
            parts += [BothWays(size, units), *_dropout(share)]
            size = units
        self.layers = nn.ModuleList([*parts, nn.Linear(size, controls)])

    def forward(self, features: Tensor, lengths: Tensor | None = None) -> Tensor:
        """(N, T, F) to (N, T, C); `lengths` (N,) are frames before the padding, T by default."""
        frames = torch.arange(features.shape[1])
        if lengths is None:
            lengths = torch.full((len(features),), features.shape[1])
        turned = lengths[:, None] - 1 - frames
        turned = torch.where(turned >= 0, turned, frames)  # its own inverse
        value = features
        for layer in self.layers:
            value = layer(value, turned) if isinstance(layer, BothWays) else layer(value)
        return value


Net = Windows | Sequence | Recurrent


def make_network(config: Config, inputs: int, controls: int) -> Net:
    """A network with fresh weights, drawn from torch's generator.

    Args:
        config: what to make.
        inputs: columns of a window (D), or of a frame (F) for convolutions.
        controls: C.
    """
    made: Net
    if config.is_recurrent:
        made = Recurrent(config, inputs, controls)
    else:
        made = (Sequence if config.is_sequence else Windows)(config, inputs, controls)
    if config.network.init == "torch":
        return made
    for part in made.modules():
        if isinstance(part, nn.LSTM):
            _draw_memory(part)
    weighted = [part for part in made.layers if isinstance(part, nn.Linear | nn.Conv1d)]
    for part in weighted:
        _draw(part, config, is_last=part is weighted[-1])
    return made


def _draw(part: nn.Linear | nn.Conv1d, config: Config, *, is_last: bool) -> None:
    network = config.network
    nn.init.zeros_(cast(Tensor, part.bias))
    if network.init == "glorot":
        nn.init.xavier_uniform_(part.weight)
    elif is_last:
        nn.init.normal_(part.weight, std=LAST_SD)
    else:
        slope = network.slope if network.activation == "leaky_relu" else 0.0
        nn.init.kaiming_normal_(part.weight, a=slope, nonlinearity="leaky_relu")


def _draw_memory(part: nn.LSTM) -> None:
    """First weights of an LSTM as Keras, with which Taylor et al. trained, draws them."""
    nn.init.xavier_uniform_(cast(Tensor, part.weight_ih_l0))
    nn.init.orthogonal_(cast(Tensor, part.weight_hh_l0))
    for bias in (part.bias_ih_l0, part.bias_hh_l0):
        nn.init.zeros_(cast(Tensor, bias))
    # Gates remember at first: Jozefowicz et al., "An empirical exploration of recurrent network
    # architectures" (2015).
    units = part.hidden_size
    nn.init.ones_(cast(Tensor, part.bias_ih_l0)[units : 2 * units])


def _activation(config: Config) -> nn.Module:
    if config.network.activation == "tanh":
        return nn.Tanh()
    return nn.LeakyReLU(config.network.slope)


def _dropout(share: float) -> list[nn.Module]:
    return [nn.Dropout(share)] if share else []


def make_optimizer(config: Config, network: nn.Module) -> torch.optim.Optimizer:
    """What moves the weights of a network; its rate is set before each epoch."""
    chosen, rate = config.optimizer, config.rates.first
    weights = network.parameters()
    if chosen.kind == "sgd":
        return torch.optim.SGD(weights, rate, momentum=chosen.momentum)
    if chosen.kind == "adam":
        return torch.optim.Adam(weights, rate)
    return torch.optim.AdamW(weights, rate, weight_decay=chosen.weight_decay)
