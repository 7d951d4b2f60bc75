"""What one step of an epoch learns from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from lipwright.train.augment import augmented
from lipwright.train.config import Config
from lipwright.train.data import Arrays

Indices = npt.NDArray[np.int64]

LONGEST: Final = 1500  # frames, a minute of video; ten such fill a gigabyte in a wide LSTM


def batches(arrays: Arrays, config: Config, random: np.random.Generator) -> Iterator[Tensor]:
    """The frames of each step of an epoch, in random order.

    They are the middles of windows, or the firsts of stretches of `stretch_of` frames, or those of
    `parts_of`.
    """
    if config.batch == 0 and not config.is_sequence:
        for take in random.permutation(len(arrays.takes)):
            yield torch.arange(arrays.starts[take], arrays.starts[take + 1])
        return
    order = random.permutation(_firsts(arrays, config, random))
    for part in np.array_split(order, range(config.batch or 1, len(order), config.batch or 1)):
        yield torch.from_numpy(part)


def stretch_of(arrays: Arrays, config: Config) -> int:
    """How many frames one example of a batch gives: Ky of windows."""
    if not config.is_sequence:
        return config.output_window
    return min(config.stretch, *(len(take.times) for take in arrays.takes))


def parts_of(arrays: Arrays) -> Indices:
    """(P + 1,) the first frame of each of the P parts for a recurrent network, and N.

    A part is a recording; those longer than `LONGEST` are cut into parts of about one length.
    """
    firsts = [
        np.linspace(start, stop, -(-(stop - start) // LONGEST), endpoint=False)
        for start, stop in pairwise(arrays.starts)
    ]
    return np.concatenate([*firsts, [arrays.starts[-1]]]).astype(np.int64)


def _firsts(arrays: Arrays, config: Config, random: np.random.Generator) -> Indices:
    if config.is_recurrent:
        return parts_of(arrays)[:-1]
    if not config.is_sequence:
        return np.arange(len(arrays))
    length = stretch_of(arrays, config)
    firsts = []
    for start, stop in pairwise(arrays.starts):
        shift = int(random.integers(length))
        places = np.arange(start - shift, stop, length)
        firsts.append(np.unique(np.clip(places, start, stop - length)))
    return np.concatenate(firsts)


@dataclass(frozen=True, eq=False)
class Examples:
    """What goes into a network at one step, and what should come out."""

    inputs: tuple[Tensor, ...]
    """windows (B, D), stretches (B, W, F), or parts (B, L, F) and their lengths (B,)"""
    reference: Tensor
    """(B, L, C)"""
    mask: Tensor
    """(B, L) 1 where a face was seen and nothing is padded, else 0"""


def examples(
    arrays: Arrays, chosen: Tensor, config: Config, random: np.random.Generator
) -> Examples:
    """The examples of `chosen` (B,), of `batches`."""
    if config.is_recurrent:
        return _whole_parts(arrays, chosen)
    length = stretch_of(arrays, config)
    half = 0 if config.is_sequence else length // 2
    if config.is_sequence:
        inputs = augmented(arrays, chosen, length, config.augment, random)
    else:
        inputs = arrays.windows(chosen)
    return Examples((inputs,), *arrays.reference(chosen, half, length - 1 - half))


def _whole_parts(arrays: Arrays, chosen: Tensor) -> Examples:
    """Parts of several lengths; after its end a part repeats its last frame."""
    edges = torch.from_numpy(parts_of(arrays))
    lengths = edges[torch.searchsorted(edges, chosen, right=True)] - chosen
    places = torch.arange(int(lengths.max()))
    rows = arrays.rows[chosen, None] + torch.minimum(places, lengths[:, None] - 1)
    mask = arrays.mask[rows] * (places < lengths[:, None])
    return Examples((arrays.frames[rows], lengths), arrays.targets[rows], mask)
