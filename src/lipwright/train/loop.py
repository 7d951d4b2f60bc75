"""The training itself, an epoch at a time; after each, its state is on the disk.

Every random number follows from the seed, the member and the number of the epoch, so that a
training that was killed and goes on gives the same weights as one that was not.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import Any, Final

import numpy as np
import torch
from torch import Tensor

from lipwright.errors import LipwrightError
from lipwright.train.batches import batches, examples
from lipwright.train.checkpoint import Checkpoint, Weights
from lipwright.train.config import Config, Rates
from lipwright.train.data import Arrays, Data, Scaling
from lipwright.train.losses import squared_error, total_loss
from lipwright.train.networks import Net, make_network, make_optimizer
from lipwright.train.takes import Report

Keep = Callable[[Checkpoint], None]

CHUNK: Final = 2048  # windows that are predicted at once
RISE: Final = 0.1  # share of all steps in which the rate of one cycle rises
RISE_FROM: Final = 25.0  # its highest rate over its first


def fit(config: Config, data: Data, state: Checkpoint, report: Report, keep: Keep) -> None:
    """Train all members, or those that are not done.

    Args:
        config: of the training.
        data: to learn from.
        state: where to begin; at the end it has the best weights of each member.
        report: told how far it is.
        keep: given the state after each epoch, to write it down.

    Raises:
        LipwrightError: the loss grew beyond all bounds.
    """
    with deterministic():
        while len(state.members) < config.members:
            _fit_member(config, data, state, report, keep)


@contextmanager
def deterministic() -> Iterator[None]:
    """Only algorithms that give the same bits each time, and a generator of our own."""
    before = torch.get_deterministic_debug_mode()
    settings: Any = torch.utils.deterministic
    filled = settings.fill_uninitialized_memory
    # As torch.use_deterministic_algorithms(True), which loads a compiler of some seconds first.
    torch.set_deterministic_debug_mode("error")
    settings.fill_uninitialized_memory = False  # a search for mistakes, an eighth of LSTMs' time
    try:
        with torch.random.fork_rng(devices=[]):
            yield
    finally:
        torch.set_deterministic_debug_mode(before)
        settings.fill_uninitialized_memory = filled


def _seed(config: Config, member: int, epoch: int) -> np.random.Generator:
    """Seed torch for an epoch; the generator for its order. Epoch 0 draws the first weights."""
    sequence = np.random.SeedSequence([config.seed, member, epoch])
    torch.manual_seed(int(sequence.generate_state(1)[0]))
    return np.random.default_rng(sequence)


def network_of(config: Config, data: Data, weights: Weights | None = None) -> Net:
    """The network of a configuration, with weights that were learnt."""
    columns = data.features.frame_size if config.is_sequence else data.features.size
    network = make_network(config, columns, len(data.controls))
    if weights is not None:
        network.load_state_dict(weights)
    return network


def _fit_member(config: Config, data: Data, state: Checkpoint, report: Report, keep: Keep) -> None:
    """Train the next member to its end."""
    member = len(state.members)
    _seed(config, member, 0)
    network = network_of(config, data, state.weights)
    mute(network, data.train)
    optimizer = make_optimizer(config, network)
    if state.optimizer is not None:
        optimizer.load_state_dict(state.optimizer)
    while len(state.members) == member:
        epochs = state.epochs(member)
        number, rate = len(epochs) + 1, rate_at(config.rates, config.epochs, epochs)
        set_rate(optimizer, rate)
        if config.average and state.average is None:
            state.average = copy_of(network)

        def tick(share: float, number: int = number) -> None:
            done = member + (number - 1 + share) / config.epochs
            report("train", done / config.members)

        begun = time.perf_counter()
        loss = _run_epoch(config, data, network, optimizer, state.average, (member, number), tick)
        kept = network if state.average is None else network_of(config, data, state.average)
        judged = judge(predict(kept, data.validation), data.validation, data.scaling)
        epoch = {
            "member": member, "epoch": number, "rate": optimizer.param_groups[0]["lr"],
            "train": loss, **judged,
            "seconds": round(time.perf_counter() - begun, 3),
        }  # fmt: skip
        _refuse_endless(epoch)
        state.history.append(epoch)
        if all(epoch["validation"] < old["validation"] for old in epochs):
            state.best = copy_of(kept)
        state.weights, state.optimizer = network.state_dict(), optimizer.state_dict()
        if is_done(config, state.epochs(member)):
            _finish_member(state)
        keep(state)


@torch.no_grad()
def mute(network: Net, arrays: Arrays) -> None:
    """Let columns that training never sees, such as spans of rare phones, count for nothing."""
    first = network.layers[0]
    assert isinstance(first, torch.nn.Linear | torch.nn.Conv1d)
    first.weight[:, ~arrays.taught(windows=not network.is_sequence)] = 0.0


def _finish_member(state: Checkpoint) -> None:
    assert state.best is not None
    state.members.append(state.best)
    state.weights = state.best = state.average = state.optimizer = None


def halves(config: Config) -> bool:
    """Whether matrices are multiplied in bfloat16: asked for, and faster on this processor."""
    if config.precision != "bfloat16":
        return False
    asked = ("_is_amx_tile_supported", "_is_avx512_bf16_supported")
    return any(getattr(torch.cpu, name, bool)() for name in asked)


def copy_of(network: Net) -> Weights:
    """The weights of a network as they are now."""
    return {key: value.clone() for key, value in network.state_dict().items()}


@torch.no_grad()
def blend(average: Weights | None, network: Net, share: float) -> None:
    """Bring a running mean of weights nearer to those of the network."""
    if average is not None:
        for key, value in network.state_dict().items():
            average[key].lerp_(value, share)


def set_rate(optimizer: torch.optim.Optimizer, rate: float) -> None:
    """Set the learning rate of all weights."""
    for group in optimizer.param_groups:
        group["lr"] = rate


def one_cycle(config: Config, epochs: float) -> float:
    """The learning rate after so many epochs and parts of one."""
    share, rise = epochs / config.epochs, RISE
    if share < rise:
        low, high, place = config.rates.first / RISE_FROM, config.rates.first, share / rise
    else:
        low, high, place = 0.0, config.rates.first, 1 - (share - rise) / (1 - rise)
    return low + (high - low) * (1 - math.cos(math.pi * place)) / 2


def _refuse_endless(epoch: dict[str, Any]) -> None:
    if not all(math.isfinite(epoch[loss]) for loss in ("train", "validation")):
        raise LipwrightError(
            f"epoch {epoch['epoch']}: the loss grew beyond all bounds at the rate "
            f"{epoch['rate']:g}; lower 'rates.first' of the configuration"
        )


def is_done(config: Config, epochs: list[dict[str, Any]]) -> bool:
    """Whether a member has trained enough: all epochs, or too many without a validation gain."""
    if not epochs:
        return False
    losses = [epoch["validation"] for epoch in epochs]
    since = len(losses) - 1 - losses.index(min(losses))
    return len(losses) >= config.epochs or (
        config.patience is not None and since >= config.patience
    )


def rate_at(rates: Rates, total: int, epochs: list[dict[str, Any]]) -> float:
    """The learning rate of the epoch after `epochs`, of `total` at most."""
    if rates.schedule == "cosine":
        return rates.first * (1 + math.cos(math.pi * len(epochs) / total)) / 2
    if rates.schedule in {"constant", "one_cycle"}:  # one_cycle is set at each step
        return rates.first
    losses = [epoch[rates.watches] for epoch in epochs]
    falls = sum(later > earlier for earlier, later in pairwise(losses))
    return float(rates.first * 10.0 ** -(falls // 2) * (0.5 if falls % 2 else 1.0))


def _run_epoch(
    config: Config, data: Data, network: Net, optimizer: torch.optim.Optimizer,
    average: Weights | None, place: tuple[int, int], tick: Callable[[float], None],
) -> float:  # fmt: skip
    """One pass over the frames for training; the mean loss of its steps."""
    arrays = data.train
    random = _seed(config, *place)
    is_halved = halves(config)
    steps = list(batches(arrays, config, random))
    network.train()
    total = weight = 0.0
    for number, chosen in enumerate(steps):
        if config.rates.schedule == "one_cycle":
            set_rate(optimizer, one_cycle(config, place[1] - 1 + number / len(steps)))
        given = examples(arrays, chosen, config, random)
        optimizer.zero_grad(set_to_none=True)
        with torch.autocast("cpu", torch.bfloat16, enabled=is_halved):
            estimated = network(*given.inputs).float()
        loss = total_loss(
            config.loss, network, given.reference, estimated, given.mask, data.opening
        )
        loss.backward()  # type: ignore[no-untyped-call]
        if config.optimizer.longest is not None:
            torch.nn.utils.clip_grad_norm_(network.parameters(), config.optimizer.longest)
        optimizer.step()
        blend(average, network, config.average)
        total += loss.item() * len(chosen)
        weight += len(chosen)
        tick((number + 1) / len(steps))
    return total / weight


@torch.no_grad()
def predict(network: Net, arrays: Arrays) -> Tensor:
    """(N, C), scaled controls; windows that overlap are averaged frame by frame."""
    network.eval()
    if network.is_sequence:
        parts = [
            network(arrays.stretches(torch.tensor([start]), stop - start))[0]
            for start, stop in pairwise(arrays.starts)
        ]
        return torch.cat(parts)
    sums = torch.zeros(len(arrays.frames), arrays.targets.shape[1])
    counts = torch.zeros(len(arrays.frames), 1)
    for chosen in torch.split(torch.arange(len(arrays)), CHUNK):
        values = network(arrays.windows(chosen))
        half = values.shape[1] // 2
        rows = (arrays.rows[chosen, None] + torch.arange(-half, half + 1)).flatten()
        sums.index_add_(0, rows, values.flatten(0, 1))
        counts.index_add_(0, rows, torch.ones(len(rows), 1))
    return sums[arrays.rows] / counts[arrays.rows]


def judge(estimated: Tensor, arrays: Arrays, scaling: Scaling) -> dict[str, float]:
    """The squared error of (N, C).

    `validation` is as the loss scales controls, `error` in standard deviations of each, by which
    configurations that scale otherwise compare.
    """
    reference, mask = arrays.targets[arrays.rows][None], arrays.mask[arrays.rows][None]
    ratio = torch.from_numpy((scaling.sd / scaling.spread).astype(np.float32))
    return {
        "validation": squared_error(reference, estimated[None], mask).item(),
        "error": squared_error(reference * ratio, estimated[None] * ratio, mask).item(),
    }
