"""The model card: what a network is, what it learnt from, how well it does, what it cannot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any, Final

from lipwright.network.meta import TARGETS
from lipwright.phones import PHONES
from lipwright.train.config import Config
from lipwright.train.data import Data
from lipwright.train.takes import Corpus, Take
from lipwright.version import VERSION

FEW: Final = 20  # times in training under which a phone is named as rare


def describe_data(corpus: Corpus) -> str:
    """What a model was trained on, in a line."""
    takes = corpus.of("train")
    licence = corpus.licence or "no licence named"
    return (
        f"{corpus.name}: {len(takes)} recordings, {_minutes(takes, corpus):.1f} minutes; {licence}"
    )


def _minutes(takes: Sequence[Take], corpus: Corpus) -> float:
    return sum(len(take.times) for take in takes) / corpus.fps / 60


def write_card(
    config: Config, data: Data, history: Sequence[dict[str, Any]], metrics: dict[str, Any],
    licence: str, day: str,
) -> str:  # fmt: skip
    """The card as Markdown.

    Args:
        config: of the training.
        data: what it learnt from.
        history: the epochs of all members.
        metrics: split to figures, as `measure` gives them.
        licence: of the weights.
        day: YYYY-MM-DD.
    """
    lines = [
        f"# {config.name}",
        "",
        f"A network of Lipwright {VERSION} from speech to {TARGETS[config.targets]}: "
        f"{len(data.controls)} controls at {data.corpus.fps:g} frames a second. Trained on {day}.",
        "", "## Data", "", *_data_lines(data),
        "", "## Network", "", *_network_lines(config, data),
        "", "## Training", "", *_training_lines(config, history),
        "", "## How well it does", "", *metric_lines(metrics),
        "", "## Licence of the weights", "", licence,
        "", "## Limits", "", *_limit_lines(config, data), "",
    ]  # fmt: skip
    return "\n".join(lines)


def _data_lines(data: Data) -> Iterator[str]:
    corpus = data.corpus
    yield f"- {describe_data(corpus)}"
    for split in ("validation", "test"):
        takes = corpus.of(split)
        yield f"- {split}: {len(takes)} recordings, {_minutes(takes, corpus):.1f} minutes"
    count = Counter(phone for take in corpus.of("train") for phone in take.track.phones)
    known = data.features.phones
    yield "- phones with columns of their own, and how often they are heard in training: " + (
        ", ".join(f"{phone} {count[phone]}" for phone in known)
    )
    yield f"- phones that it never learnt, which take the mouth of others: {_unknown(data)}"


def _unknown(data: Data) -> str:
    return ", ".join(phone for phone in PHONES if phone not in data.features.phones) or "none"


def _network_lines(config: Config, data: Data) -> Iterator[str]:
    network = config.network
    features, columns = ", ".join(data.features.kinds), data.features
    window = f"{config.input_window} frames ({1000 * config.input_window / columns.fps:.0f} ms)"
    sight = "all frames in sight" if config.is_recurrent else f"in sight for {window}"
    yield f"- features: {features}; {columns.frame_size} numbers a frame, {sight}"
    if config.is_recurrent:
        first, *others = network.layers
        shape = f"fully connected, {first} units; then bidirectional LSTMs of {_numbers(others)}"
    elif config.is_sequence:
        taps = ", ".join(map(str, network.kernels))
        shape = f"convolutions of {_numbers(network.layers)} channels over {taps} frames"
    else:
        shape = f"fully connected, {_numbers(network.layers)} hidden units; {columns.size} inputs"
    yield f"- {shape}; {network.activation}, dropout {_numbers(network.drops)}"
    if not config.is_sequence:
        yield f"- predicts {config.output_window} frames at once; overlapping ones are averaged"
    if config.members > 1:
        yield f"- the mean of {config.members} such networks"


def _numbers(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values) or "no"


def _training_lines(config: Config, history: Sequence[dict[str, Any]]) -> Iterator[str]:
    seconds = sum(epoch["seconds"] for epoch in history)
    loss = ", ".join(f"{name} {w:g}" for name, w in config.to_json()["loss"].items() if w)
    rates = config.rates
    yield f"- {config.optimizer.kind}, learning rate {rates.first:g}, {rates.schedule}"
    yield f"- weights of the loss: {loss}"
    for member in range(config.members):
        epochs = [epoch for epoch in history if epoch["member"] == member]
        best = min(epochs, key=lambda epoch: epoch["validation"])
        yield f"- {len(epochs)} epochs, the best {best['epoch']}: validation loss " + (
            f"{best['validation']:.4g}"
        )
    yield f"- {seconds / 60:.1f} minutes in all; seed {config.seed}"
    if config.comment:
        yield f"- {config.comment}"


def metric_lines(metrics: dict[str, Any]) -> Iterator[str]:
    """What `measure` found in each split, as Markdown."""
    yield "Squared errors are in variances of each control in training; r is Pearson's."
    yield ""
    yield "| split | recordings | error | r of the lips' aperture |"
    yield "| --- | --- | --- | --- |"
    for split, figures in metrics.items():
        r = _figure(figures["aperture_r"])
        yield f"| {split} | {figures['recordings']} | {_figure(figures['error'])} | {r} |"
    if "test" not in metrics:
        yield ""
        yield "The dataset keeps no recording for the test."
    split, figures = list(metrics.items())[-1]
    yield ""
    yield f"| control ({split}) | error | r |"
    yield "| --- | --- | --- |"
    for name, of in figures["controls"].items():
        yield f"| {name} | {_figure(of['error'])} | {_figure(of['r'])} |"


def _figure(value: float | None) -> str:
    return "none" if value is None else f"{value:.3f}"


def _limit_lines(config: Config, data: Data) -> Iterator[str]:
    count = Counter(phone for take in data.corpus.of("train") for phone in take.track.phones)
    rare = [phone for phone in data.features.phones if count[phone] < FEW]
    yield "- It moves as the recorded speaker does, at that speaker's rate and loudness."
    yield f"- Heard fewer than {FEW} times in training: {', '.join(rare) or 'no phone'}."
    if "sound" not in config.features:
        yield "- It knows phones and their times only, not how they are said."
    if config.targets in {"shape", "joint"}:
        yield "- Its controls are modes of one reference face; a head needs ARKit weights."
