"""The state of a training after an epoch, as a file: all that the next epoch depends on.

There are no random states in it: those of an epoch follow from the seed, the member and the
number of the epoch.
"""

from __future__ import annotations

import pickle  # the class of an error; nothing is unpickled
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import torch
from torch import Tensor

from lipwright.errors import LipwrightError
from lipwright.files import write_whole
from lipwright.npz import BROKEN, reason_of

FORMAT: Final = "lipwright-checkpoint"
VERSION: Final = 1  # raise when the fields change
CHECKPOINT_FILE: Final = "checkpoint.pt"

Weights = dict[str, Tensor]


@dataclass
class Checkpoint:
    """Where a training is."""

    config: dict[str, Any]
    """the configuration as plain values"""
    data: str
    """digest of the corpus"""
    members: list[Weights] = field(default_factory=list)
    """the best weights of each member that is done"""
    history: list[dict[str, Any]] = field(default_factory=list)
    """each epoch so far, of all members: member, epoch, rate, losses, seconds"""
    weights: Weights | None = None
    """of the member at work, after its last epoch"""
    best: Weights | None = None
    """of the member at work, after its best epoch"""
    average: Weights | None = None
    """the running mean of the weights of the member at work"""
    optimizer: dict[str, Any] | None = None

    def epochs(self, member: int) -> list[dict[str, Any]]:
        """The epochs of one member."""
        return [epoch for epoch in self.history if epoch["member"] == member]


def save_checkpoint(path: Path, state: Checkpoint) -> None:
    """Write the state; a reader finds the old one or this one, never a part.

    Raises:
        LipwrightError: it cannot be written.
    """
    fields = {name: getattr(state, name) for name in state.__dataclass_fields__}
    with write_whole(path) as part:
        torch.save({"format": FORMAT, "version": VERSION, **fields}, part)


def load_checkpoint(path: Path, config: dict[str, Any], data: str) -> Checkpoint | None:
    """The state to go on from; None where there is none.

    Args:
        path: of the file.
        config: what must be trained.
        data: digest of what it must be trained on.

    Raises:
        LipwrightError: the file is broken, of another version, or of another training.
    """
    remedy = "start anew with --force, or name another folder"
    if not path.is_file():
        return None
    try:
        values = torch.load(path, map_location="cpu", weights_only=True)
        if values.pop("format") != FORMAT:
            raise ValueError("it is no checkpoint")
        version = values.pop("version")
        if version == VERSION:
            state = Checkpoint(**values)
    except (*BROKEN, pickle.UnpicklingError) as error:
        raise LipwrightError(
            f"{path}: not a readable checkpoint ({reason_of(error)}); {remedy}"
        ) from error
    if version != VERSION:
        raise LipwrightError(f"{path}: version {version!r} of checkpoints, not {VERSION}; {remedy}")
    if state.config != config:
        keys = ", ".join(_differing(state.config, config))
        raise LipwrightError(f"{path}: is of a configuration with another {keys}; {remedy}")
    if state.data != data:
        raise LipwrightError(f"{path}: is of a training on other recordings; {remedy}")
    return state


def _differing(old: Any, new: Any, before: str = "") -> list[str]:
    """The dotted keys in which two configurations differ."""
    found = []
    for key in {**old, **new}:
        one, other = old.get(key), new.get(key)
        if isinstance(one, dict) and isinstance(other, dict):
            found += _differing(one, other, f"{before}{key}.")
        elif one != other:
            found.append(repr(before + key))
    return found
