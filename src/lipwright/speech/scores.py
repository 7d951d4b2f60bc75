"""How much better each senone explains each frame than the best row of any phones would.

The alternative is a loop in which each phone, pause and noise may follow each other. Ratios
against it do not move with loudness, noise or the speaker as plain likelihoods do.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.speech.acoustic import AcousticModel
from lipwright.speech.features import Floats, with_differences
from lipwright.speech.held import frame_weights

_AT_ONCE: Final = 300  # frames
LOOP_COST: Final = 3.7  # nats to go on to another phone, log 42: all are as likely


class PhoneLoop:
    """Any phones in any order: the best likelihood so far, frame by frame."""

    def __init__(self, model: AcousticModel) -> None:
        """No frame was heard yet."""
        n_phones = len(model.base_phones)
        self.senones = model.sequences[:n_phones]  # (B, 3)
        self._stay = model.transitions[:, :, 0].T  # (3, B)
        self._leave = model.transitions[:, :, 1].T
        self._scores = np.full((3, n_phones), -1e30, np.float32)
        self._scores[2] = 0.0

    def advance(self, likelihoods: Floats) -> Floats:
        """(T,) how much each next frame adds to the best likelihood.

        `likelihoods` is (T, 3, B), of the states of the phones without context.
        """
        gains = np.empty(len(likelihoods), np.float32)
        scores = self._scores
        arrive = np.empty_like(scores)
        for frame, heard in enumerate(likelihoods):
            left = scores + self._leave
            arrive[1:] = left[:2]
            arrive[0] = left[2].max() - LOOP_COST
            scores = np.maximum(scores + self._stay, arrive) + heard
            best = scores.max()
            gains[frame] = best
            scores -= best
        self._scores = scores
        return gains


class Scores:
    """Log-likelihood ratios of senones over the frames of one recording."""

    def __init__(self, model: AcousticModel, static: Floats) -> None:
        """`static` are cepstra (T, 13) with their mean taken off."""
        self.model = model
        self.static = static
        self.weights = frame_weights(static)
        """(T,) how much each frame counts in a search; less where a sound is held for long"""
        self._loop = PhoneLoop(model)
        self._gains = np.empty(len(static), np.float32)
        self._known = 0  # frames whose gain is known

    def __len__(self) -> int:
        """The number of frames, T."""
        return len(self.static)

    def ratios(self, start: int, stop: int, senones: npt.NDArray[np.integer]) -> Floats:
        """(stop - start, len(senones)) nats by which a senone beats any speech."""
        if stop <= self._known:
            return self.likelihoods(start, stop, senones) - self._gains[start:stop, None]
        assert start <= self._known  # the loop hears every frame in turn
        heard = self.likelihoods(start, stop, np.concatenate([senones, self._loop.senones.ravel()]))
        fresh = heard[self._known - start :, len(senones) :]
        shape = (len(fresh), *self._loop.senones.shape)
        self._gains[self._known : stop] = self._loop.advance(
            fresh.reshape(shape).transpose(0, 2, 1)
        )
        self._known = stop
        return heard[:, : len(senones)] - self._gains[start:stop, None]

    def hear(self, stop: int) -> None:
        """Let the loop of any phones hear every frame before `stop`, which later ratios need."""
        for start in range(self._known, stop, _AT_ONCE):
            self.ratios(start, min(start + _AT_ONCE, stop), np.zeros(0, np.intp))

    def likelihoods(self, start: int, stop: int, senones: npt.NDArray[np.integer]) -> Floats:
        """(stop - start, len(senones)) natural logarithms of likelihood densities."""
        low, high = max(start - 3, 0), min(stop + 3, len(self))
        features = with_differences(self.static[low:high])[start - low : stop - low]
        return self.model.score(features, senones)
