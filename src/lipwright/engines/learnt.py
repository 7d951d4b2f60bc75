"""What engines that run learnt models share: opening them, and the clips that they make."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lipwright.controls import CANONICAL
from lipwright.errors import LipwrightError
from lipwright.network import Network, find_model, load_network
from lipwright.network.arrays import ArrayModel, check_kind, open_arrays, stamps
from lipwright.network.folder import read_meta

if TYPE_CHECKING:
    from lipwright.network.meta import Kind

Values = npt.NDArray[np.float32]
Learnt = Network | ArrayModel


def clip_names(model: Learnt) -> tuple[str, ...]:
    """The controls of the clips that a model makes: canonical ones, or its modes."""
    return CANONICAL if model.meta.moves_heads else model.meta.controls


def arrange(model: Learnt, values: Values) -> Values:
    """Values (T, C) of the model's controls as those (T, C') of its clips.

    Modes of a model that has both are left out.
    """
    names = clip_names(model)
    place = {name: index for index, name in enumerate(names)}
    chosen = [index for index, name in enumerate(model.meta.controls) if name in place]
    placed = np.zeros((len(values), len(names)), np.float32)
    placed[:, [place[model.meta.controls[index]] for index in chosen]] = values[:, chosen]
    return placed


def open_network_of(model: str | Path | Network, kinds: tuple[Kind, ...]) -> Network:
    """A network of some kinds, loaded once while its files stay as they are.

    Raises:
        LipwrightError: the model cannot be used, or is one of another engine.
    """
    if isinstance(model, Network):
        return model
    folder = find_model(model)
    return _load(folder, kinds, stamps(folder))


@lru_cache(maxsize=2)
def _load(folder: Path, kinds: tuple[Kind, ...], stamps: tuple[tuple[int, int], ...]) -> Network:
    del stamps
    check_kind(folder, read_meta(folder), kinds)
    return load_network(folder)


def open_arrays_of(model: str | Path | ArrayModel | None, kind: Kind) -> ArrayModel:
    """The arrays of a model of an engine that ships none.

    Raises:
        LipwrightError: no model is named, it cannot be used, or it is one of another engine.
    """
    if isinstance(model, ArrayModel):
        return model
    return open_arrays(named(model, kind), kind)


def named(model: str | Path | None, engine: str) -> str | Path:
    """The model that was named.

    Raises:
        LipwrightError: none was; says how to train one.
    """
    if model is None:
        raise LipwrightError(
            f"the engine {engine} needs a model, and none ships: train one with: lipwright train "
            f"DATASET --config {engine} -o MODEL, and name it with --model"
        )
    return model
