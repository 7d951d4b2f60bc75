"""Speech made longer or shorter at the same pitch."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

Samples = npt.NDArray[np.float32]

WINDOW: Final = 0.03  # s, two or more periods of any voice's pitch
SEARCH: Final = 0.008  # s, a period of 125 Hz: how far a window may move to fit the one before


def stretch(samples: Samples, rate: int, factor: float) -> Samples:
    """The sound `factor` times as long; what is at t comes to about factor * t.

    Waveform similarity overlap-add (Verhelst and Roelands 1993): windows are laid half over each
    other, each taken from where it goes on best from the one before.

    Args:
        samples: (N,).
        rate: samples a second.
        factor: above 0.

    Returns:
        (round(N * factor),).
    """
    count = round(len(samples) * factor)
    half = round(WINDOW * rate / 2)
    reach = round(SEARCH * rate)
    if count == 0 or len(samples) < 2 * half + 2 * reach:
        return np.zeros(count, np.float32)
    window = np.hanning(2 * half + 1)[: 2 * half]
    padded = np.pad(samples.astype(np.float64), (half + reach, 3 * half + reach))
    out = np.zeros(count + 3 * half)
    weight = np.zeros_like(out)
    follows: npt.NDArray[np.float64] | None = None
    for place in range(0, count + half, half):  # of the window's middle
        origin = min(round(place / factor), len(samples))  # in `padded`, first reachable start
        if follows is None:
            taken = origin + reach
        else:
            around = padded[origin : origin + 2 * half + 2 * reach]
            taken = origin + int(np.argmax(np.correlate(around, follows, "valid")))
        out[place : place + 2 * half] += window * padded[taken : taken + 2 * half]
        weight[place : place + 2 * half] += window
        follows = padded[taken + half : taken + 3 * half]
    found = out[half : half + count] / np.maximum(weight[half : half + count], 1e-6)
    return found.astype(np.float32)
