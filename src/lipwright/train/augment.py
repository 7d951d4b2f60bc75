"""What a network hears while it trains: other voices, noise, or nothing."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from lipwright.features.sound import SOUND_NAMES
from lipwright.train.config import Augment
from lipwright.train.data import Arrays


def augmented(
    arrays: Arrays, chosen: Tensor, length: int, augment: Augment, random: np.random.Generator
) -> Tensor:
    """(B, W, F), what convolutions need for `length` frames from `chosen` (B,) on.

    Each example has a voice of its own; frames of phones stay as they are.
    """
    inputs = arrays.stretches(chosen, length)
    if augment == Augment():
        return inputs
    columns = len(SOUND_NAMES)  # S, the last of a frame; before them whether there is sound
    heard = inputs[:, :, -columns:]
    silent = (heard == 0).flatten(1).all(dim=1)  # recordings without sound stay without
    if augment.voiced and len(arrays.voices):
        voice = random.integers(len(arrays.voices), size=len(chosen))
        other = random.random(len(chosen)) < augment.voiced
        for row in np.flatnonzero(other):
            heard[row] = arrays.voiced_stretch(int(voice[row]), int(chosen[row]), length)
    if augment.noise:
        for shape in (heard.shape, (len(chosen), 1, columns)):
            heard += augment.noise * torch.from_numpy(random.standard_normal(shape, np.float32))
    deaf = torch.from_numpy(random.random(len(chosen)) < augment.deaf)
    inputs[deaf | silent, :, -columns - 1 :] = 0
    return inputs
