"""The terms of the loss.

Controls are (N, L, C): N windows or stretches of L frames. A mask (N, L) is 1 where a face was
seen and 0 elsewhere, where `reference_` values are any finite numbers.
"""

from __future__ import annotations

from typing import Final

import torch
from torch import Tensor, nn

from lipwright.train.config import Loss

APERTURE_UNIT: Final = 0.1  # eye distances; about the standard deviation in speech


def squared_error(reference_controls: Tensor, estimated_controls: Tensor, mask: Tensor) -> Tensor:
    """The mean squared error of frames and controls."""
    missed = (estimated_controls - reference_controls).square().mean(dim=-1)
    return _mean(missed, mask)


def motion_error(reference_controls: Tensor, estimated_controls: Tensor, mask: Tensor) -> Tensor:
    """How wrongly controls move from a frame to the next: phi of the thesis, section 4.3.

    The absolute difference, summed over controls, as its mean over the pairs of frames of a window.
    """
    moved = (estimated_controls - reference_controls).diff(dim=1).abs().sum(dim=-1)
    return _mean(moved, mask[:, 1:] * mask[:, :-1])


def aperture_error(
    reference_controls: Tensor, estimated_controls: Tensor, mask: Tensor, opening: Tensor
) -> Tensor:
    """The mean squared error of the lips' aperture on the head, in `APERTURE_UNIT`.

    `opening` (C,) is how far each scaled control opens them. Controls that open and close the lips
    at once may be right one by one and still leave a closure open; here their sum counts.
    """
    missed = ((estimated_controls - reference_controls) @ opening).square()
    return _mean(missed / APERTURE_UNIT**2, mask)


def weight_norm(network: nn.Module) -> Tensor:
    """The sum of the squares of all weights, biases left out."""
    squares = [part.square().sum() for part in network.parameters() if part.ndim > 1]
    return torch.stack(squares).sum()


def _mean(values: Tensor, mask: Tensor) -> Tensor:
    return (values * mask).sum() / mask.sum().clamp(min=1)


def total_loss(
    weights: Loss,
    network: nn.Module,
    reference_controls: Tensor,
    estimated_controls: Tensor,
    mask: Tensor,
    opening: Tensor | None = None,
) -> Tensor:
    """The weighted sum of the terms; those that weigh nothing are not computed."""
    loss = weights.squared * squared_error(reference_controls, estimated_controls, mask)
    if weights.motion and mask.shape[1] > 1:
        loss = loss + weights.motion * motion_error(reference_controls, estimated_controls, mask)
    if opening is not None:
        loss = loss + weights.lips * aperture_error(
            reference_controls, estimated_controls, mask, opening
        )
    if weights.l2:
        loss = loss + weights.l2 * weight_norm(network)
    return loss
