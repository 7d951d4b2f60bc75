"""Pictures of a training and of a search."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lipwright.files import write_whole

TRAIN_COLOUR, VALIDATION_COLOUR = "#1f618d", "#c0392b"


def write_losses(path: Path, history: Sequence[dict[str, Any]]) -> None:
    """The losses of all members over the epochs, on a logarithmic scale.

    Raises:
        LipwrightError: the file cannot be written.
    """
    figure, axes = _figure()
    for member in sorted({epoch["member"] for epoch in history}):
        epochs = [epoch for epoch in history if epoch["member"] == member]
        numbers = [epoch["epoch"] for epoch in epochs]
        for loss, colour in (("train", TRAIN_COLOUR), ("validation", VALIDATION_COLOUR)):
            label = loss if member == 0 else None
            values = [epoch[loss] for epoch in epochs]
            axes.plot(numbers, values, ".-", color=colour, label=label)
        best = min(epochs, key=lambda epoch: epoch["validation"])
        axes.plot(best["epoch"], best["validation"], "o", color=VALIDATION_COLOUR, fillstyle="none")
    axes.set(xlabel="epoch", ylabel="loss", yscale="log")
    axes.legend(loc="upper right")  # "best" warns of its own slowness on a busy machine
    _save(figure, path)


def write_trials(path: Path, keys: Sequence[str], trials: Sequence[dict[str, Any]]) -> None:
    """The validation loss of each trial against each value that was varied.

    Raises:
        LipwrightError: the file cannot be written.
    """
    figure, axes = _figure(len(keys))
    for place, key in zip(axes if len(keys) > 1 else [axes], keys, strict=True):
        values = [trial[key] for trial in trials]
        numbers = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)
        if numbers and min(values) > 0 and max(values) >= 100 * min(values):
            place.set_xscale("log")
        shown = values if numbers else [str(value) for value in values]
        place.plot(shown, [trial["validation"] for trial in trials], "o", color=VALIDATION_COLOUR)
        place.set(xlabel=key, ylabel="validation loss")
    _save(figure, path)


def _figure(count: int = 1) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4 * count, 4.8), layout="constrained")
    return figure, figure.subplots(1, count)


def _save(figure: Any, path: Path) -> None:
    with write_whole(path) as part:
        figure.savefig(part, format="png", dpi=100, metadata={"Software": None})
